# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The shelf of real loops: each says where it is from and agrees with MuJoCo's own tree."""
from bench.robots import mimic, ours, ROBOTS, Tree
from fourbar_ros.scene.files import folder
from fourbar_ros.scene.scene import load
import numpy as np
import pytest

SCENES = sorted(file.stem for file in (folder() / 'robots').glob('*.yaml'))
EPS = 2.0**-52


def test_every_robot_is_measured():
    assert sorted(ROBOTS) == SCENES


@pytest.mark.parametrize('name', SCENES)
def test_a_robot_moves_over_its_range_as_its_file_says(name):
    pytest.importorskip('mujoco', reason='mujoco is not installed')
    text = (folder() / 'robots' / f'{name}.yaml').read_text(encoding='utf-8')
    assert text.startswith('# ') and '# Figures: ' in text and '# Left out: ' in text
    scene = load(name)
    (low, high), = scene.linkage.input_ranges
    assert [low, high] == scene.values['linkage.range'] and scene.warnings == []
    assert low < scene.drive.start < high
    gap, force = ours(Tree(scene), low, high)
    # of the size of some roundings: positions of joints, the chain of frames, sums of forces
    assert gap < 1000.0 * EPS * sum(map(abs, scene.linkage.lengths)) and force < 1e-12


def test_a_straight_mimic_is_right_where_the_loop_is_a_parallelogram_and_not_else():
    errors = {name: mimic(Tree(scene), *scene.linkage.input_ranges[0])
              for name in SCENES for scene in [load(name)]}
    assert max(errors['xarm_hand'], errors['toddlerbot_knee']) < 1e-4
    assert 0.01 < errors['robotiq_2f85'] < errors['cassie_foot'] < 0.22
    assert errors['excavator_bucket'] > 1.0
    assert np.isfinite([*errors.values()]).all()
