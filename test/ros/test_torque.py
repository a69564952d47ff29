# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""A real node that is driven by torque, of a topic or of a motor; its bags are stepped again."""
from math import inf, isnan, nan, pi, tau

from fourbar_lab.clients.node_client import NoAnswer
from fourbar_msgs.msg import DriveState, LinkageState
from fourbar_ros.bag.overview import info
from fourbar_ros.dynamics import node_step
from fourbar_ros.scene.files import folder, read_values
from geometry_msgs.msg import WrenchStamped
import numpy as np
import pytest
from rclpy.serialization import serialize_message
from support.harness import (
    in_bag,
    nanoseconds,
    recomputed,
    recording_in,
    set_parameters,
    SimulatedClock,
)
from support.scenes import PAPER, RODS

TORQUE_DRIVEN = {**PAPER, **RODS, 'gravity.y': -9.81, 'drive.source': 'torque',
                 'drive.rate': 200.0, 'outputs': ['state', 'loads']}
AT_LIMIT = DriveState.STATUS_AT_LIMIT
MOTOR_DRIVEN = {**TORQUE_DRIVEN, 'drive.source': 'motor', 'motor.stall_torque': 400.0,
                'motor.free_speed': 26.0, 'motor.rotor_inertia': 0.5, 'shaft.stiffness': 1e9,
                'shaft.damping': 100.0, 'drive.rate': 1000.0}
SLIDE = {**RODS, 'bodies.output.mass': 2.0, 'linkage.kind': 'slider_crank',
         'linkage.input': 'slide', 'linkage.a1': 0.4, 'linkage.a2': 1.2,
         'linkage.range': [1.0, 1.4], 'drive.start': 1.2, 'drive.source': 'torque',
         'drive.rate': 200.0, 'drive.when_silent': 'hold', 'outputs': ['state', 'loads']}


def states(client):
    """Listen to the state of the drive; return the growing list of messages."""
    return client.hear(DriveState, '/fourbar/drive_state')


def torques(client, axis='z'):
    """Return the function that sends a torque, along x a force."""
    publisher = client.node.create_publisher(WrenchStamped, '/fourbar/torque', 10)
    client.until(publisher.get_subscription_count, 'the node at the torque topic')

    def send(torque):
        message = WrenchStamped()
        setattr(message.wrench.torque if axis == 'z' else message.wrench.force, axis, torque)
        publisher.publish(message)
        return True
    return send


def test_the_numbers_of_the_status_are_those_of_the_message():
    names = ('OK', 'SILENT', 'BUDGET', 'AT_LIMIT', 'FAILED')
    assert [getattr(DriveState, f'STATUS_{name}') for name in names] == [
        node_step.OK, node_step.SILENT, node_step.OUT_OF_BUDGET, node_step.AT_LIMIT,
        node_step.NOT_FINITE]
    fields = list(DriveState.get_fields_and_field_types())
    assert tuple(fields[fields.index('step'):]) == node_step.DriveValues._fields


def test_a_torque_topic_with_gaps_nan_and_jumps(run_node, client, tmp_path):
    node = run_node({**TORQUE_DRIVEN, **recording_in(tmp_path), 'drive.timeout': 0.3,
                     'drive.torque_limit': 50.0})
    heard = states(client)
    send = torques(client)
    client.until(lambda: heard, 'a state')
    assert heard[-1].status == DriveState.STATUS_SILENT and heard[-1].command == 0.0
    # the first may come before the node knows the publisher
    client.until(lambda: heard[-1].command == 5.0 or not send(5.0), 'the torque in effect')
    for bad in (nan, inf, -inf):
        send(bad)
    send(1e300)                                          # a jump, to the limit
    client.until(lambda: heard[-1].command == 50.0, 'the limited torque')
    send(-1e300)
    client.until(lambda: heard[-1].command == -50.0, 'the limited torque, backwards')
    send(-20.0)
    client.until(lambda: heard[-1].command == -20.0, 'the torque after the jump')
    client.until(lambda: heard[-1].status == DriveState.STATUS_SILENT, 'silence')
    assert heard[-1].command == 0.0
    send(3.0)
    client.until(lambda: heard[-1].command == 3.0, 'the torque after the gap')
    assert set_parameters(client, {'drive.when_silent': 'hold'})[0].successful
    client.until(lambda: (heard[-1].command, heard[-1].status)
                 == (3.0, DriveState.STATUS_SILENT), 'a silence that holds')
    assert set_parameters(client, {'drive.torque_limit': 2.0})[0].successful
    client.until(lambda: heard[-1].command == 2.0, 'the limit of a torque that came before')
    assert node.stop() == 0
    assert {m.command for m in heard} <= {0.0, 5.0, 50.0, -50.0, -20.0, 3.0, 2.0}
    assert all(np.isfinite([m.position, m.velocity, m.acceleration]).all() for m in heard)
    assert 'not finite' in node.said and 'drive.torque_limit' in node.said
    recomputed(tmp_path / 'run')
    assert len(in_bag(tmp_path / 'run', '/fourbar/torque')) >= 7


def test_a_torque_moves_a_crank_to_the_end_of_its_range_and_back(run_node, client, tmp_path):
    node = run_node({**TORQUE_DRIVEN, **recording_in(tmp_path), 'linkage.range': [-0.5, 0.85],
                     'drive.start': 0.2, 'drive.when_silent': 'hold', 'gravity.y': 0.0})
    heard, send = states(client), torques(client)
    client.until(lambda: heard and heard[-1].status == AT_LIMIT or not send(20.0), 'the limit')
    # held where the last step began: of 20 N m over 0.65 rad some 0.05 rad long
    assert heard[-1].velocity == 0.0 and 0.78 < heard[-1].position < 0.85
    client.until(lambda: heard[-1].velocity < 0.0 or not send(-20.0), 'the way back')
    client.until(lambda: heard[-1].status == AT_LIMIT, 'the other limit')
    assert -0.5 < heard[-1].position < -0.42
    assert node.stop() == 0
    recomputed(tmp_path / 'run')


def test_a_force_on_a_slide_is_cut_to_its_limit_and_moves_it_to_that_of_its_stroke(
        run_node, client, diagnosed, tmp_path):
    node = run_node({**SLIDE, **recording_in(tmp_path), 'drive.torque_limit': 20.0})
    heard, send = states(client), torques(client, 'x')
    for sent, acts in ((-500.0, -20.0), (-3.0, -3.0), (500.0, 20.0)):
        client.until(lambda: heard and heard[-1].command == acts or not send(sent), 'the force')
    client.until(lambda: heard[-1].status == AT_LIMIT, 'the limit')
    held = heard[-1]
    assert held.velocity == 0.0 and 1.39 < held.position < SLIDE['linkage.range'][1]
    client.until(lambda: any('held at a limit' in array.status[0].message
                             for array in diagnosed.messages), 'diagnostics that say so')
    client.until(lambda: heard[-1].velocity < 0.0 or not send(-20.0), 'the way back')
    assert node.stop() == 0 and 'drive: held at a limit' in node.said
    recomputed(tmp_path / 'run')


def test_a_torque_whose_text_ros_alone_can_read_is_recorded_readable(run_node, client, tmp_path):
    """A text without its final zero: ROS takes it, readers of bags refuse it."""
    node = run_node({**TORQUE_DRIVEN, **recording_in(tmp_path)})
    heard, publisher = states(client), client.node.create_publisher(WrenchStamped,
                                                                    '/fourbar/torque', 10)
    client.until(publisher.get_subscription_count, 'the node at the torque topic')
    message = WrenchStamped()
    message.header.frame_id, message.wrench.torque.z = 'abcd', 7.0
    data = bytes(serialize_message(message)).replace(b'abcd\0', b'abcde')
    client.until(lambda: publisher.publish(data) or (heard and heard[-1].command == 7.0),
                 'the torque in effect')
    node.stop()
    assert any(torque.wrench.torque.z == 7.0 for torque in in_bag(tmp_path / 'run',
                                                                  '/fourbar/torque'))
    recomputed(tmp_path / 'run')


def test_parameters_change_while_it_runs_and_the_state_goes_on(run_node, client, tmp_path):
    node = run_node({**MOTOR_DRIVEN, **recording_in(tmp_path)})
    heard = states(client)
    client.until(lambda: len(heard) > 20, 'states')
    assert set_parameters(client, {'motor.stall_torque': 100.0})[0].successful
    mark = len(heard)
    client.until(lambda: len(heard) > mark + 40, 'states after the change')
    refused, = set_parameters(client, {'motor.kind': 'dc'})
    assert not refused.successful and 'motor.voltage' in refused.reason
    change = {'motor.kind': 'controller', 'motor.speed': 5.0, 'motor.proportional': 50.0,
              'motor.integral': 10.0}
    assert set_parameters(client, change, atomically=True)[0].successful
    client.until(lambda: not isnan(heard[-1].speed_error_integral), 'the controller')
    mark = len(heard)
    client.until(lambda: len(heard) > mark + 20, 'states of the controller')
    assert node.stop() == 0
    steps = [b.position - a.position for a, b in zip(heard, heard[1:])]
    assert max(map(abs, steps)) < 26.0 * 2 * 0.001       # nowhere a jump
    recomputed(tmp_path / 'run')


def test_a_kite_turns_on_in_its_mode(run_node, client, tmp_path):
    """Through its flat position, in one mode; it repeats after two turns."""
    node = run_node({**MOTOR_DRIVEN, **recording_in(tmp_path), 'linkage.a1': 0.5,
                     'linkage.a2': 1.0, 'linkage.a3': 1.0, 'linkage.a4': 0.5, 'drive.start': 1.0})
    heard, outputs = states(client), client.hear(LinkageState, '/fourbar/state')
    client.until(lambda: outputs and outputs[-1].theta1 > 5.0 * tau, 'five turns')
    assert node.stop() == 0 and {m.mode for m in heard} == {m.mode for m in outputs} == {2}
    x = np.array([m.theta1 for m in outputs])
    r = 0.5 * np.cos(0.5 * x) + np.sqrt(1.0 - 0.25 * np.sin(0.5 * x)**2)      # B on the bisector
    exact = np.arctan2(r * np.sin(0.5 * x), r * np.cos(0.5 * x) - 0.5)
    error = [np.remainder(m.theta4 - y + pi, tau) - pi for m, y in zip(outputs, exact)]
    assert np.abs(error).max() <= 1e-13
    assert recomputed(tmp_path / 'run').stepped >= len(in_bag(
        tmp_path / 'run', '/fourbar/drive_state')) - 2


ROCKER = {**TORQUE_DRIVEN, 'linkage.a1': 1.2, 'linkage.a2': 0.4, 'drive.start': -0.5}


def test_a_released_rocker_swings_through_its_toggles(run_node, client, tmp_path):
    node = run_node({**ROCKER, 'drive.rate': 500.0, 'outputs': ['state', 'loads', 'links'],
                     **recording_in(tmp_path)})
    heard, outputs = states(client), client.hear(LinkageState, '/fourbar/state')

    def toggles(messages):
        return np.count_nonzero(np.diff([m.mode for m in messages]))

    client.until(lambda: toggles(heard) > 3 and toggles(outputs) > 3, 'four toggles')
    assert node.stop() == 0
    path = tmp_path / 'run'
    again = recomputed(path).stepped
    assert info(path, check=True).is_sound
    there = in_bag(path, '/fourbar/drive_state')
    assert toggles(there) > 3 and {m.mode for m in there} == {m.mode for m in outputs} == {1, 2}
    assert {m.status for m in there} == {DriveState.STATUS_SILENT}
    # after a gap of a late node no state is stepped again until it is away from toggles
    stamps = [nanoseconds(m) for m in there]
    if np.diff(stamps).max() < 3_000_000:
        assert again == len(there) - 1
    assert again > len(there) // 2
    assert [m.mode for m in in_bag(path, '/fourbar/state')] == [m.mode for m in there]


def test_simulated_time_moves_the_state_and_starts_again_when_it_goes_back(run_node, client,
                                                                           tmp_path):
    node = run_node({**MOTOR_DRIVEN, **recording_in(tmp_path), 'drive.rate': 100.0,
                     'drive.budget': 1000, 'use_sim_time': True})
    heard, clock = states(client), SimulatedClock(client, step=5_000_000)
    client.until(lambda: clock.tick() or len(heard) > 20, 'states in simulated time')
    first, last = heard[0], heard[-1]    # the very first may come before the node knows of us
    assert 0.0 <= first.position < last.position
    passed = nanoseconds(last) - nanoseconds(first)
    assert sum(m.step for m in heard[1:]) == pytest.approx(1e-9 * passed)
    clock.now = 10**9
    count = len(heard)                   # several may come at once
    client.until(lambda: clock.tick() or any(m.step == 0.0 for m in heard[count:]),
                 'a start in time that goes back')
    assert all(m.position == 0.0 for m in heard[count:] if m.step == 0.0)
    assert node.stop() == 0 and 'went back' in node.said
    recomputed(tmp_path / 'run')
    start = in_bag(tmp_path / 'run', '/fourbar/drive_state')[0]
    assert start.step == start.position == 0.0


@pytest.mark.slow
def test_silence_runs_on_simulated_time_that_may_pause_and_go_back(run_node, client, tmp_path):
    """The clock of a simulation rests for longer than the timeout: no torque is missed by it."""
    silent, period = DriveState.STATUS_SILENT, 10_000_000
    node = run_node({**TORQUE_DRIVEN, **recording_in(tmp_path), 'drive.timeout': 0.3,
                     'drive.rate': 100.0, 'drive.budget': 1000, 'use_sim_time': True})
    heard, send = states(client), torques(client)
    clock = SimulatedClock(client, 5 * 10**9, period)

    def tick(torque=None, patience=None):
        """Go on by a period, and until there is the state of that time; return it."""
        if torque is not None:
            send(torque)
            client.spin(0.05)                # of two topics, the order is not told
        clock.tick()
        client.until(lambda: heard and nanoseconds(heard[-1]) == clock.now, 'the state', patience)
        return heard[-1]

    def ticked(torque, status):
        try:
            return tick(torque, 2.0).status == status
        except NoAnswer:                     # not discovered yet, or a timer that begins anew
            return False
    client.until(lambda: ticked(30.0, DriveState.STATUS_OK), 'a torque in effect')
    for _ in range(3):
        client.spin(0.5)                     # simulated: nothing
        assert {tick(30.0).status} | {tick().status for _ in range(5)} == {DriveState.STATUS_OK}
    given = clock.now - 6 * period              # of the last torque, or a step before
    while (last := tick()).status != silent:
        assert last.torque == 30.0 and nanoseconds(last) - given <= 3 * 10**8 + period
    assert nanoseconds(last) - given >= 3 * 10**8 and last.torque == 0.0
    tick(-20.0)
    assert tick().torque == -20.0
    clock.now, count = 10**9, len(heard)        # it starts again, as it started
    client.until(lambda: ticked(None, silent), 'a start in time that goes back')
    assert heard[count].step == 0.0 and node.stop() == 0
    assert {(m.status, m.torque) for m in heard[count:]} == {(silent, 0.0)}
    recomputed(tmp_path / 'run')


def test_an_engine_turns_by_its_gas_and_is_stepped_again(run_node, client, tmp_path):
    values = {**read_values('engine'), **recording_in(tmp_path), 'forces.gas.table': 'gas.csv'}
    for name in ('places', 'place_unit', 'values', 'value_unit'):
        del values[f'forces.gas.{name}']        # they stand in the file, beside that of the scene
    german = (folder() / 'engine.csv').read_text().replace(',', ';').replace('.', ',')
    (tmp_path / 'gas.csv').write_text(german)
    node, heard = run_node(values), states(client)
    client.until(lambda: heard and heard[-1].position > 3.0 * tau, 'three turns')
    table = {'forces.gas.places': list(range(0, 725, 5)),
             'forces.gas.values': [f'{value}bar' for value in read_values('engine')[
                 'forces.gas.values']], 'forces.gas.factor': -0.003}
    assert all(answer.successful for answer in set_parameters(client, table))
    for name, wrong in (('forces.gas.values', [1.0, 2.0]), ('forces.gas.acts', 'up')):
        refused, = set_parameters(client, {name: wrong})
        assert not refused.successful and name in refused.reason
    mark = len(heard)
    client.until(lambda: len(heard) > mark + 50, 'states after the change')
    assert node.stop() == 0
    found = recomputed(tmp_path / 'run')
    stamps = [nanoseconds(state) for state in in_bag(tmp_path / 'run', '/fourbar/drive_state')]
    # a node that the machine keeps more than a second late leaves samples out
    gaps = int((np.diff(stamps) > 1.5e9 / values['drive.rate']).sum())
    assert found.stepped == found.inputs - 1 - gaps > 10 * gaps
