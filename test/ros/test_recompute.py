# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Bags of a real node: split while written, recomputed from the received inputs."""
import math

from fourbar_msgs.msg import Motion
from fourbar_ros.bag.overview import info
from fourbar_ros.bag.reader import Bag
from fourbar_ros.bag.recomputation import recompute
from rosbags.rosbag2 import Reader
from support.harness import ALL_OUTPUTS
from support.samples import some
from support.scenes import PAPER, RODS


@some('split', [{'recording.split_duration': 0.3},
                {'recording.split_size': 0.03}, {'recording.keep': 2.0}], 1,
      ids=['duration', 'size', 'keep'])
def test_a_node_splits_its_bag_by_its_parameters(run_node, client, tmp_path, split):
    node = run_node({**PAPER, **RODS, 'drive.speed': 25.0, 'drive.rate': 200.0,
                     'outputs': ALL_OUTPUTS,
                     'recording.directory': str(tmp_path / 'bags'), 'recording.name': 'run',
                     'recording.start': True, **split})
    last = 14 if 'recording.keep' in split else 3
    client.until(lambda: (tmp_path / f'bags/run/run_{last}.mcap').exists(), 'the parts')
    assert node.stop() == 0
    path = tmp_path / 'bags/run'
    found = info(path, check=True)
    assert found.is_sound and found.missing == 0 and found.parts >= 3 and info(path).is_sound
    recomputed = recompute(path)
    assert not recomputed.problems() and recomputed.inputs > 100 and recomputed.uncertain == 0
    for file in Bag(path).files[:3]:
        assert not recompute(file).problems() and info(file, check=True).is_sound
    assert (path / 'run_0.mcap').exists() == ('recording.keep' not in split)
    with Reader(path) as reader:
        assert reader.message_count == sum(1 for _ in reader.messages())


@some('given', ['everything', 'velocity', 'position'], ('position',))
def test_the_driven_joint_is_computed_again_from_what_came_in(run_node, client, tmp_path, given):
    node = run_node({**PAPER, **RODS, 'drive.source': 'motion', 'drive.timeout': 60.0,
                     'outputs': ['state', 'loads'],
                     'recording.directory': str(tmp_path), 'recording.name': 'whole',
                     'recording.start': True})
    client.listen(['state'])
    publisher, sent = client.publisher(), []
    began = client.node.get_clock().now().nanoseconds

    def send():
        k = len(sent)
        sent.append(k)
        message = Motion()
        stamp = began + k * 10**7                # even, however busy the machine is
        message.header.stamp.sec, message.header.stamp.nanosec = divmod(stamp, 10**9)
        message.position = math.sin(0.05 * k)
        message.velocity = math.nan if given == 'position' else 5.0 * math.cos(0.05 * k)
        message.acceleration = 0.1 if given == 'everything' else math.nan
        publisher.publish(message)

    def step(count):
        for _ in range(count):
            send()
            heard = len(client.received['state'])
            client.until(lambda heard=heard: len(client.received['state']) > heard, 'an answer')
    client.handshake(send)
    step(30)
    assert client.call('stop_recording').success
    step(5)
    assert client.call('start_recording', name='late').success
    step(30)
    assert node.stop() == 0
    whole, late = recompute(tmp_path / 'whole'), recompute(tmp_path / 'late')
    for found in (whole, late):
        assert not found.problems() and found.largest == 0.0, found
        assert f'{found.inputs} recomputed from /fourbar/input' in found.driven
    assert whole.inputs >= 30 and 'estimated' not in whole.driven
    assert late.inputs == 30 and ('estimated' in late.driven) == (given != 'everything')
    changed = [d for d in late.differences if d.topic == '/fourbar/driven']
    assert {d.field for d in changed} >= {'position', 'velocity', 'acceleration', 'header.stamp',
                                          'header.frame_id'}
