# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Bags of simulated runs: as a node would write them."""
from fourbar_ros.bag.overview import info
from fourbar_ros.bag.reader import Bag
from fourbar_ros.bag.recomputation import recompute
from fourbar_ros.cli.main import main
from fourbar_ros.errors import BagError
from fourbar_ros.pipeline.stepper import Stepper
from fourbar_ros.ros.offline import write_bag
from fourbar_ros.scene import files, scene
from fourbar_ros.scene.simulated import simulate_scene
import numpy as np
import pytest
from support.scenes import kite_angle, PAPER, RODS

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
    again = recompute(path)
    assert not again.problems() and again.largest == 0.0 and again.inputs == 201
    assert again.compared == 201 * 7 and done[-1] == 201
    assert again.stepped == 0           # another integrator made it
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
    assert not recompute(tmp_path / 'run').problems()
    assert main(['bag', 'recompute', str(tmp_path / 'run')]) == 0


def test_two_runs_of_a_scene_have_the_same_bag(tmp_path):
    """They are compared by their stamps, which begin at 1 s."""
    paths = [str(tmp_path / name) for name in ('one', 'two')]
    for path in paths:
        assert main(['simulate', 'released', '--until', '0.2', '--torque', '20', '-o', path]) == 0
    assert main(['bag', 'diff', *paths]) == 0
    first, *_ = Bag(paths[0]).records(['/fourbar/driven'])
    assert (first.time, first.message.header.stamp.sec) == (1_000_000_000, 1)


RELEASED = {**PAPER, **RODS, 'drive.source': 'torque', 'gravity.y': -9.81, 'drive.rate': 1000.0,
            'outputs': ['state', 'joint_states', 'loads', 'links']}
TOGGLES = {'linkage.a1': 1.2, 'linkage.a2': 0.4, 'drive.start': -0.5}
KITE = {'linkage.a1': 0.5, 'linkage.a2': 1.0, 'linkage.a3': 1.0, 'linkage.a4': 0.5,
        'drive.start': 1.0, 'drive.start_speed': 9.0}


def test_a_run_through_flat_positions_has_a_bag_of_one_branch(tmp_path):
    found = simulate_scene(scene.from_values({**RELEASED, **KITE}), 2.0, 1e-7)
    assert found.run.position[-1] > 4.0 * np.pi and set(found.run.modes.tolist()) == {2}
    again = recompute(write_bag(found, tmp_path / 'run', id))
    assert not again.problems() and again.largest == 0.0 and again.other_branch == 0
    states = [record.message for record in Bag(tmp_path / 'run').records(['/fourbar/state'])]
    theta1, theta4 = (np.array([getattr(state, name) for state in states])
                      for name in ('theta1', 'theta4'))
    assert np.abs(np.sin(0.5 * (theta4 - kite_angle(0.5, 1.0, 2, theta1)))).max() < 1e-13


def test_a_run_through_both_modes_has_a_bag_of_both(tmp_path, monkeypatch):
    values = {**RELEASED, **TOGGLES}
    found = simulate_scene(scene.from_values(values), 2.0, 1e-7)
    assert set(found.run.modes.tolist()) == {1, 2}
    path = write_bag(found, tmp_path / 'run', id)
    again = recompute(path)
    assert not again.problems() and again.largest == 0.0 and again.inputs == 2001
    assert info(path, check=True).is_sound
    states = [record.message for record in Bag(path).records(['/fourbar/state'])]
    assert [m.mode for m in states] == found.run.modes.tolist()
    linkage = found.scene.linkage
    for m in states[::50]:
        motion = linkage.in_mode(m.mode).motion(m.theta1, m.omega1, m.alpha1)
        assert (m.theta4, m.omega4, m.alpha4) == (motion.theta4, motion.omega4, motion.alpha4)
    step = Stepper.step
    monkeypatch.setattr(Stepper, 'step', lambda self, *given: step(self, *given[:4], self.mode))
    assert recompute(path).problems()


def test_a_machine_through_toggles_has_a_bag_of_both_modes(tmp_path):
    values = {**files.read_values('watt'), **RELEASED, 'dyads.one.first.along': 1.2,
              'dyads.one.length_1': 0.4, 'dyads.two.length_1': 1.5, 'dyads.two.length_2': 1.4,
              'drive.start': 0.7, 'drive.rate': 200.0, 'outputs': ['state', 'loads', 'links']}
    there = scene.from_values({name: value for name, value in values.items()
                               if name not in ('linkage.a1', 'linkage.a2', 'linkage.a3',
                                               'linkage.a4', 'drive.speed')
                               and not name.startswith('points.')})
    found = simulate_scene(there, 1.5, 1e-6)
    assert set(found.run.modes.tolist()) == {3, 4}
    again = recompute(write_bag(found, tmp_path / 'run', id))
    assert not again.problems() and again.largest == 0.0 and again.inputs == 301


def test_a_mode_that_messages_cannot_tell_has_no_bag(tmp_path, monkeypatch):
    values = {**RELEASED, **TOGGLES}
    found = simulate_scene(scene.from_values(values), 1.5, 1e-6)
    monkeypatch.setitem(found.run.__dict__, 'modes', 255 * (found.run.modes - 1) + 1)
    with pytest.raises(BagError, match='other assembly mode at'):
        write_bag(found, tmp_path / 'run', id)
    assert not (tmp_path / 'run').exists()
