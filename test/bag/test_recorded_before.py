# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Bags recorded before the code was restructured compute again to the last bit."""
from pathlib import Path

from fourbar_ros.bag.comparison.recompute import compare
import pytest

RECORDED = Path(__file__).parent.parent / 'support' / 'data' / 'recorded'
SCENES = {'paper': 5, 'slides_7_6': 3, 'slides_7_7': 3, 'slider_crank': 6, 'cylinder': 5}


def test_there_is_a_bag_of_every_scene():
    assert {path.name for path in RECORDED.iterdir()} == set(SCENES)


@pytest.mark.parametrize('scene', SCENES)
def test_a_bag_recorded_before_computes_again_exactly(scene):
    found = compare(RECORDED / scene)
    assert found.inputs > 90
    assert found.compared == SCENES[scene] * found.inputs
    assert found.problems() == []
