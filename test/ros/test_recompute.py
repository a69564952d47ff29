# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Bags of a real node: split while they are written, recomputed as one and file by file."""
from fourbar_ros.bag.overview import info
from fourbar_ros.bag.reader import Bag
from fourbar_ros.bag.recomputation import recompute
from rosbags.rosbag2 import Reader
from support.harness import ALL_OUTPUTS
from support.scenes import PAPER, RODS


def test_a_node_splits_its_bag_by_its_parameters(run_node, client, tmp_path):
    node = run_node({**PAPER, **RODS, 'drive.speed': 25.0, 'drive.rate': 200.0,
                     'outputs': ALL_OUTPUTS,
                     'recording.directory': str(tmp_path / 'bags'), 'recording.name': 'run',
                     'recording.start': True, 'recording.split_duration': 0.3})
    client.until(lambda: (tmp_path / 'bags/run/run_3.mcap').exists(), 'the files')
    assert node.stop() == 0
    path = tmp_path / 'bags/run'
    found = info(path, check=True)
    assert found.is_sound and found.missing == 0 and found.files > 3 and info(path).is_sound
    recomputed = recompute(path)
    assert not recomputed.problems() and recomputed.inputs > 100 and not recomputed.skipped
    for file in Bag(path).files[:3]:
        assert not recompute(file).problems() and info(file, check=True).is_sound
    with Reader(path) as reader:
        assert reader.message_count == sum(1 for _ in reader.messages())
