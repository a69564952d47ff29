# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Bags of a real node: split while they are written, recomputed as one and file by file."""
from fourbar_ros.bag.overview import info
from fourbar_ros.bag.reader import Bag
from rosbags.rosbag2 import Reader
from support.harness import ALL_OUTPUTS, recomputed, recording_in
from support.scenes import PAPER, RODS


def test_a_node_splits_its_bag_by_its_parameters(run_node, client, tmp_path):
    node = run_node({**PAPER, **RODS, 'drive.speed': 25.0, 'drive.rate': 200.0,
                     'outputs': ALL_OUTPUTS, **recording_in(tmp_path),
                     'recording.split_duration': 0.3})
    path = tmp_path / 'run'
    client.until(lambda: (path / 'run_3.mcap').exists(), 'the files')
    assert node.stop() == 0
    found = info(path, check=True)
    assert found.is_sound and found.missing == 0 and found.files > 3 and info(path).is_sound
    whole = recomputed(path)
    assert whole.inputs > 100 and not whole.skipped
    for file in Bag(path).files[:3]:
        recomputed(file)
        assert info(file, check=True).is_sound
    with Reader(path) as reader:
        assert reader.message_count == sum(1 for _ in reader.messages())
