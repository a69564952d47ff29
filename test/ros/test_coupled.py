# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""What a larger simulation takes from a node: equation of motion, inertia, the rest, in step."""
from math import isnan

from fourbar_ros import Base, InvalidParameter
from fourbar_ros.clients import Late, LockStep
from fourbar_ros.mechanisms.inertia import held_rigid, mean_rigid
from fourbar_ros.scene.scene import from_values
from fourbar_ros.scene.topics import INPUTS
import numpy as np
import pytest
from sensor_msgs.msg import Imu
from support.harness import PATIENCE, recomputed, recording_in
from support.scenes import PAPER, RODS

LOADED = {**PAPER, **RODS, 'gravity.y': -9.81, 'drive.source': 'motion', 'drive.timeout': 0.0}


def test_equation_and_inertia_are_those_of_the_linkage_and_recompute(run_node, lockstep,
                                                                     tmp_path):
    outputs = ['equation', 'inertia', 'loads', 'state']
    given = {**LOADED, 'outputs': outputs, 'drive.carried_inertia': 0.5,
             **recording_in(tmp_path)}
    node, ask = run_node(given), lockstep(*outputs)
    linkage = from_values(given).linkage
    for number in range(1, 40):
        x, rate, acceleration = 0.2 * number, 3.0 - 0.1 * number, 0.5 * number - 7.0
        answer = ask(0.001 * number, x, rate, acceleration)
        equation, inertia, torque = answer.equation, answer.inertia.inertia, (
            answer.loads.driving_torque)
        assert (equation.position, equation.velocity) == (x, rate)
        assert equation.inertia == linkage.inertia(x) and equation.bias == linkage.bias(x, rate)
        assert equation.inertia * acceleration + equation.bias == pytest.approx(torque, rel=1e-12)
        assert equation.bias == pytest.approx(
            0.5 * equation.inertia_slope * rate**2 + equation.static_torque, rel=1e-12)
        assert equation.torque_of_rest == torque - 0.5 * acceleration
        held = held_rigid(linkage, linkage.motion(x))
        assert (inertia.m, inertia.com.x, inertia.com.y, inertia.izz) == held
    node.stop()
    assert recomputed(tmp_path / 'run').compared >= 4 * 39


def test_the_wrench_is_that_of_the_rest_of_what_the_simulator_carries(run_node, lockstep):
    given = {**LOADED, 'gravity.y': 0.0, 'outputs': ['shaking_wrench', 'loads'],
             'base.topic': 'motion_of_base', 'base.timeout': 0.0, 'base.carried.mean': True}
    run_node(given)
    ask, linkage = lockstep(*given['outputs']), from_values(given).linkage
    mean = mean_rigid(linkage)
    base = Base(3.0, 9.0, 2.0, -5.0)
    answer = ask(0.001, 0.3, 2.0, 3.0, base)
    whole = linkage.loads(0.3, 2.0, 3.0, base=base)
    x, y = mean.x, mean.y
    force = mean.mass * np.array([3.0 + 5.0 * y - 4.0 * x, 9.0 - 5.0 * x - 4.0 * y])
    wrench = answer.shaking_wrench.wrench
    assert [wrench.force.x, wrench.force.y] == pytest.approx(
        [whole.shaking_force_x + force[0], whole.shaking_force_y + force[1]], rel=1e-12)
    assert wrench.torque.z == pytest.approx(
        whole.shaking_moment + x * force[1] - y * force[0] - 5.0 * mean.inertia, rel=1e-12)
    assert answer.loads.driving_torque == whole.driving_torque
    assert answer.loads.shaking_moment == wrench.torque.z


def test_an_imu_in_step_and_what_another_base_is_told(run_node, lockstep, monkeypatch):
    given = {**LOADED, 'gravity.y': 0.0, 'outputs': ['loads'], 'base.topic': 'imu',
             'base.timeout': 0.0}
    run_node(given)
    ask, imu = lockstep('loads'), Imu()
    imu.linear_acceleration.y = 9.81
    assert isnan(ask(0.001, 0.3, 2.0, 3.0, imu).loads.f41)      # one rate tells no acceleration
    imu.angular_velocity.z = 0.01
    due = from_values(given).linkage.loads(0.3, 2.0, 3.0, base=Base(0.0, 9.81, 0.01, 10.0))
    assert ask(0.002, 0.3, 2.0, 3.0, imu).loads.f41 == pytest.approx(due.f41, rel=1e-9)
    monkeypatch.setattr(ask, '_patience', 0.5)
    with pytest.raises(Late, match=r'does its scene have base\.topic: motion_of_base\?'):
        ask(0.003, 0.3, 2.0, 3.0, Base(0.0, 9.81))


def test_lock_step_says_what_is_late(run_node, lockstep):
    node = run_node({**LOADED, 'outputs': ['state']})
    ask = lockstep('state', patience=0.5)
    assert ask(0.1, 0.3, 1.0, 0.0).state.theta1 == 0.3
    with pytest.raises(InvalidParameter, match='a stamp of 0 is none'):
        ask(0.0, 0.3)
    with pytest.raises(InvalidParameter, match='must be one of state, output'):
        lockstep('stat')
    node.stop()
    with pytest.raises(Late, match=r'no answer of 0\.200000000 s on state from fourbar'):
        ask(0.2, 0.4, 1.0, 0.0)


def test_a_question_at_the_time_of_the_last_one_or_before_has_its_own_answer(run_node, lockstep,
                                                                             tmp_path):
    """As the stages of a Runge-Kutta step; the base moves too, and there are several outputs."""
    outputs = ('shaking_wrench', 'state', 'loads')
    given = {**LOADED, 'gravity.y': 0.0, 'outputs': list(outputs), 'base.topic': 'motion_of_base',
             'base.timeout': 0.0, **recording_in(tmp_path)}
    node, ask, linkage = run_node(given), lockstep(*outputs), from_values(given).linkage
    rng, asked = np.random.default_rng(7), 0
    for step in range(25):
        for share in (0.0, 0.5, 0.5, 1.0):
            x, force = rng.uniform(-3.0, 3.0, 2).tolist()
            base = Base(0.0, 9.81 + force)
            answer = ask(1.0 + 0.01 * (step + share), x, 25.0, 0.0, base)
            due = linkage.loads(x, 25.0, 0.0, base=base)
            assert answer.shaking_wrench.wrench.force.y == due.shaking_force_y
            assert (answer.state.theta1, answer.loads.f41) == (x, due.f41)
            asked += 1
    without_base = ask(1.0, 0.3, 25.0, 0.0)
    assert without_base.state.theta1 == 0.3
    for estimated in ({'rate': 25.0}, {'acceleration': 0.0},
                      {'rate': 2.0, 'acceleration': 0.0, 'base': Imu()}):
        with pytest.raises(InvalidParameter, match=r'time = 1\.0: must be above the last one, '
                                                   r'1\.25.*: rates are estimated from'):
            ask(1.0, 0.3, **estimated)
    node.stop()
    assert recomputed(tmp_path / 'run').compared >= 3 * asked


def test_lock_step_hears_joint_states_in_the_namespace_of_its_node(run_node):
    run_node({**PAPER, 'drive.source': 'motion', 'outputs': ['state', 'joint_states']},
             name='boom', remaps=('__ns:=/left',))
    lockstep = LockStep('left/boom', ('state', 'joint_states'), PATIENCE)
    try:
        answer = lockstep(1.0, 0.3, 2.0, 0.0)
    finally:
        lockstep.close()
    assert answer.joint_states.position[0] == answer.state.theta1 == 0.3


def test_a_second_lock_step_on_one_node_is_said(run_node, lockstep):
    run_node({**LOADED, 'outputs': ['state']})
    ask, other = lockstep('state', patience=0.5), lockstep('state', patience=0.5)
    assert ask(0.1, 0.3, 1.0, 0.0).state.theta1 == 0.3
    other._publisher(INPUTS['motion'])
    with pytest.raises(Late, match='/fourbar/input has 1 other publisher: one LockStep alone'):
        for number in range(2, 10**6):
            ask(0.1 * number, 0.3, 1.0, 0.0)
    other.close()
    assert ask(2e5, 0.4, 1.0, 0.0).state.theta1 == 0.4


def test_torques_act_in_the_step_they_are_for(run_node, lockstep):
    """The clock of each step follows its torque; every step says which torque it took."""
    given = {**LOADED, 'drive.source': 'torque', 'drive.rate': 1000.0, 'use_sim_time': True,
             'outputs': ['state', 'loads'], 'drive.when_silent': 'hold'}
    run_node(given)
    ask = lockstep('state', 'loads')
    torques = [float(5.0 * np.sin(0.1 * k)) for k in range(1, 200)]
    rates = [ask.push(1.0 + 0.001 * k, torque).state.omega1 for k, torque in enumerate(torques)]
    assert np.ptp(rates) > 0.1
    for time, why in ((1.198, r'must be above the last one, 1\.198: the clock'),
                      (1.1, r'must be above the last one, 1\.198'),
                      (4.198, r'must be at most 1 s above the last one, 1\.198: the node skips')):
        with pytest.raises(InvalidParameter, match=why):
            ask.push(time, 1.0)
    assert ask.push(2.198, 1.0).drive_state.step == 0.001
