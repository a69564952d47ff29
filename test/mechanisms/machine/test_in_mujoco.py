# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Machines released from rest: accelerations of all joints beside MuJoCo's."""
from fourbar_ros import load_scene
import pytest
from support.in_mujoco import worst

pytest.importorskip('mujoco', reason='mujoco is not installed')


@pytest.mark.parametrize('name', ['watt', 'stephenson', 'quick_return', 'jansen'])
def test_accelerations_are_those_of_mujoco_but_for_its_softness(name):
    """What differs shrinks with the softness of MuJoCo's constraints, by what that shrinks."""
    scene = load_scene(name)
    soft, hard = worst(scene, 1.0, 0.999), worst(scene, 1.0, 0.9999)
    assert hard < 5e-3
    assert 5.0 < soft / hard < 20.0
