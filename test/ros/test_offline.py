# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Bags of simulated runs: as a node would write them."""
from fourbar_ros.bag.info import info
from fourbar_ros.bag.reader import Bag
from fourbar_ros.bag.recompute import compare
from fourbar_ros.cli.main import main
from fourbar_ros.errors import BagError
from fourbar_ros.ros.offline import write_bag
from fourbar_ros.scene import scene
from fourbar_ros.scene.simulated import simulate_scene
import pytest
from support.scenes import PAPER, RODS

MOTOR = {**PAPER, **RODS, 'drive.source': 'motor', 'motor.stall_torque': 400.0,
         'motor.free_speed': 26.0, 'motor.rotor_inertia': 0.5, 'shaft.stiffness': 1e5,
         'drive.rate': 500.0, 'points.middle.along': 0.6, 'springs.back.second.link': 'output',
         'springs.back.first.along': 1.5, 'springs.back.stiffness': 800.0,
         'outputs': ['state', 'output', 'joint_states', 'loads', 'shaking_wrench', 'drive_wrench',
                     'points']}


def test_the_bag_of_a_run_recomputes_to_zero_and_has_its_own_time(tmp_path):
    found = simulate_scene(scene.from_values(MOTOR), 0.4, 1e-7)
    done = []
    path = write_bag(found, tmp_path / 'run', done.append)
    again = compare(path)
    assert not again.problems() and again.largest == 0.0 and again.inputs == 201
    assert again.compared == 201 * 7 and done[-1] == 201
    assert 'tolerance' in again.driven and '0 of these states stepped' in again.driven
    assert info(path, check=True).is_sound
    driven = list(Bag(path).records(['/fourbar/driven']))
    assert [record.message.position for record in driven] == found.run.position.tolist()
    assert driven[-1].time - driven[0].time == 400_000_000


def test_a_constant_torque_is_in_the_bag_and_is_checked(tmp_path, capsys):
    assert main(['simulate', 'released', '--until', '0.2', '--torque', '20', '-o',
                 str(tmp_path / 'run')]) == 0
    assert f'wrote {tmp_path / "run"}' in capsys.readouterr().out
    torque, = (record.message for record in Bag(tmp_path / 'run').records(['/fourbar/torque']))
    assert torque.wrench.torque.z == 20.0
    assert not compare(tmp_path / 'run').problems()
    assert main(['bag', 'recompute', str(tmp_path / 'run')]) == 0


def test_a_run_through_both_modes_has_no_bag(tmp_path):
    values = {**PAPER, **RODS, 'linkage.a1': 1.2, 'linkage.a2': 0.4, 'drive.source': 'torque',
              'drive.start': -0.5, 'gravity.y': -9.81, 'outputs': ['state'], 'drive.rate': 100.0}
    found = simulate_scene(scene.from_values(values), 2.0, 1e-6)
    assert len(set(found.run.modes.tolist())) == 2
    with pytest.raises(BagError, match='other assembly mode at'):
        write_bag(found, tmp_path / 'run', print)
    assert not (tmp_path / 'run').exists()
