# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Input streams as they are in the field: rates missing, late, repeated, silent, out of range."""
import json
import math

from diagnostic_msgs.msg import DiagnosticStatus
from fourbar_msgs.msg import LinkageState, Motion
from fourbar_ros.ros.messages import to_stamp
from fourbar_ros.scene import scene
from fourbar_ros.scene.topics import OUTPUTS
import pytest
from rcl_interfaces.msg import Parameter, ParameterValue
from rcl_interfaces.srv import SetParameters
from sensor_msgs.msg import JointState
from support.harness import (
    in_bag,
    nanoseconds,
    recomputed,
    recording_in,
    set_parameters,
    SimulatedClock,
)
from support.scenes import PAPER, ROCKER

SECOND = 10**9


def stamped(message, time):
    """Return a message with a stamp [ns]."""
    message.header.stamp = to_stamp(time)
    return message


@pytest.fixture
def drive(run_node, client):
    """Return the function that starts a ``node`` and gives (send, message) for its input."""
    def start(parameters, source='joint_state'):
        start.node = run_node({**PAPER, 'drive.source': source, 'drive.joint': 'motor',
                               'outputs': ['state'], **parameters})
        client.listen(['state'])
        began = client.node.get_clock().now().nanoseconds - 100 * SECOND

        def message(seconds, position, velocity=None):
            made = JointState(name=['motor'], position=[position],
                              velocity=[] if velocity is None else [velocity])
            return stamped(made, began + round(seconds * 1e9))

        # far before what the tests send: the estimate starts afresh after it
        publisher = client.publisher(source)
        first = message(-50.0, 0.3) if source == 'joint_state' else Motion(position=0.1)
        client.handshake(lambda: publisher.publish(first))
        return publisher.publish, message
    return start


def answers(client, send, messages):
    """Send and return one state for each."""
    client.received['state'].clear()
    for message in messages:
        send(message)
    client.until(lambda: len(client.received['state']) >= len(messages),
                 f'{len(messages)} answers')
    return client.received['state']


def test_missing_rates_are_estimated_and_belong_to_the_input(drive, client):
    send, message = drive({'drive.window': 3, 'drive.top_speed': 5.0})
    times = [0.0, 0.01, 0.021, 0.03, 0.04, 0.049]
    states = answers(client, send, [message(t, (3.0 + 4.0 * t - t * t + math.pi) % math.tau
                                            - math.pi) for t in times])
    assert [s.status for s in states[:2]] == [LinkageState.STATUS_RATES_UNKNOWN] * 2
    assert math.isfinite(states[0].theta4) and math.isnan(states[0].omega4)
    assert math.isfinite(states[1].omega4) and math.isnan(states[1].alpha4)
    linkage = scene.from_values(PAPER).linkage
    for t, state in zip(times[2:], states[2:]):
        assert state.status == LinkageState.STATUS_OK
        # stamps of 1e9 s held as doubles are good to 2.4e-7 s: over steps of 10 ms
        assert state.omega1 == pytest.approx(4.0 - 2.0 * t, abs=4.0 * 3 * 2.4e-7 / 0.009)
        expected = linkage.motion(state.theta1, state.omega1, state.alpha1)
        assert (state.theta4, state.omega4, state.alpha4) == (expected.theta4, expected.omega4,
                                                              expected.alpha4)


def test_an_acceleration_that_is_given_is_not_estimated_and_a_stamp_ahead_is_said(drive, client):
    send, _ = drive({}, source='motion')
    now = client.node.get_clock().now().nanoseconds
    state = answers(client, send, [
        stamped(Motion(position=0.04 * k, velocity=math.nan, acceleration=7.0),
                now + k * SECOND // 100) for k in range(8)])[-1]
    assert state.status == LinkageState.STATUS_OK and state.alpha1 == 7.0
    assert state.omega1 == pytest.approx(4.0, rel=1e-9)
    ahead = stamped(Motion(position=0.3), client.node.get_clock().now().nanoseconds + 9 * SECOND)
    assert answers(client, send, [ahead])[0].theta1 == 0.3
    client.until(lambda: 's ahead of the clock' in drive.node.said, 'the warning')


def test_missing_rates_are_those_of_all_inputs_before_also_of_complete_ones(drive, client):
    """
    Once in a period of a swing they are missing: those inputs alone would be at rest.

    Complete ones reach the estimator of new settings too.
    """
    send, _ = drive({}, source='motion')
    count, size, speed, step = 40, 0.3, math.tau * 10.0, SECOND // 400       # 10 Hz at 400 Hz
    began = client.node.get_clock().now().nanoseconds - SECOND
    jerk, h = size * speed**3, step * 1e-9
    for period in range(3):
        if period == 2:
            assert set_parameters(client, {'drive.window': 3})[0].successful
        sent = []
        for k in range(period * count + 1, (period + 1) * count + 1):
            angle = speed * k * h
            sent.append(stamped(Motion(
                position=size * math.sin(angle), velocity=size * speed * math.cos(angle),
                acceleration=-size * speed**2 * math.sin(angle)), began + k * step))
        sent[-1].velocity = sent[-1].acceleration = math.nan
        state = answers(client, send, sent)[-1]
        assert state.status == LinkageState.STATUS_OK
        assert state.omega1 == pytest.approx(size * speed, abs=1.5 * jerk * h**2)  # as documented
        assert state.alpha1 == pytest.approx(0.0, abs=2.1 * jerk * h)       # for a window of 5


def test_after_a_timeout_the_estimate_starts_afresh(drive, client):
    """On simulated time: while it stands no input can come, and that is no timeout."""
    clock = SimulatedClock(client, 100 * SECOND, repeats=True)
    send, _ = drive({'drive.timeout': 1.0, 'drive.window': 3, 'use_sim_time': True}, 'motion')

    def moved(k):
        message = Motion(position=0.04 * k, velocity=math.nan, acceleration=math.nan)
        return answers(client, send, [stamped(message, 100 * SECOND + k * SECOND // 100)])[0]
    assert [moved(k) for k in range(4)][-1].status == LinkageState.STATUS_OK
    client.spin(1.5)
    assert len(client.received['state']) == 1
    for _ in range(3):                  # it is told once
        clock.now += 2 * SECOND
        client.until(lambda: client.received['state'][-1].status
                     == LinkageState.STATUS_INPUT_TIMEOUT, 'the timeout')
        client.spin(0.2)
    assert len(client.received['state']) == 2 and drive.node.said.count('no input for') == 1
    # by its stamp it follows at once
    after = moved(4)
    assert after.status == LinkageState.STATUS_RATES_UNKNOWN and math.isnan(after.omega1)


def test_a_joint_without_a_position_is_named(run_node, client):
    node = run_node({**PAPER, 'drive.source': 'joint_state', 'drive.joint': 'motor',
                     'outputs': ['state']})
    client.listen(['state'])
    publisher = client.publisher('joint_state')
    short = JointState(name=['other', 'motor'], position=[0.1])
    long = JointState(name=['motor', 'other'], position=[0.1, 0.2, 0.3])     # whose are they?
    twice = JointState(name=['motor', 'motor'], position=[0.1, 0.2])

    def is_said():
        for message in (short, long, twice):
            publisher.publish(message)
        return "no position of joint 'motor' in the input message" in node.said
    client.until(is_said, 'the reason')
    assert 'did you mean' not in node.said and not client.received['state']
    good = JointState(name=['motor', 'other'], position=[0.1, 0.2], velocity=[3.0])
    client.handshake(lambda: publisher.publish(good))
    publisher.publish(good)
    client.until(lambda: client.received['state'], 'an answer')
    assert client.received['state'][0].omega1 != 3.0         # unknown, or of those before


# --- changes while it runs -----------------------------------------------------------------------

def test_parameters_and_outputs_change_between_two_steps_or_are_refused_with_the_reason(
        drive, client):
    send, _ = drive({}, source='motion')
    assert set_parameters(client, {'linkage.a1': 0.5})[0].successful
    state, = answers(client, send, [Motion(position=0.2)])
    assert (state.theta4
            == scene.from_values({**PAPER, 'linkage.a1': 0.5}).linkage.motion(0.2).theta4)
    assert set_parameters(client, {'linkage.a1': '45cm'})[0].successful
    state, = answers(client, send, [Motion(position=0.2)])
    assert (state.theta4
            == scene.from_values({**PAPER, 'linkage.a1': 0.45}).linkage.motion(0.2).theta4)
    for bad, reason in (({'linkage.a1': -1.0}, 'must be positive'),
                        ({'linkage.a1': math.nan}, 'NaN is not a number in m'),
                        ({'linkage.a1': '0,4'}, 'must be written 0.4'),
                        ({'linkage.a1': '3kg'}, 'must be a number in m, or with one of'),
                        ({'linkage.a4': 9.0}, 'cannot close'),
                        ({'outputs': ['loads']}, 'bodies.crank.mass'), ({'linkage.mode': 3}, ''),
                        ({'drive.source': 'timer'}, 'read-only')):
        result, = set_parameters(client, bad)
        assert not result.successful and reason in result.reason
    # one by one these would not close on the way; together they are good
    new = {'linkage.a1': 8.0, 'linkage.a2': 14.0, 'linkage.a3': 9.0, 'linkage.a4': 17.0,
           'linkage.mode': 1}
    assert not set_parameters(client, {'linkage.a4': 17.0})[0].successful
    assert set_parameters(client, new, atomically=True)[0].successful
    state, = answers(client, send, [Motion(position=0.2)])
    assert state.theta4 == scene.from_values(new).linkage.motion(0.2).theta4 and state.mode == 1
    # outputs come and go
    client.listen(['output'])
    assert set_parameters(client, {'outputs': ['state', 'output']})[0].successful
    client.until(lambda: client.node.count_publishers('/fourbar/output') == 1, 'the new output')
    client.handshake(lambda: send(Motion(position=0.1)))
    answers(client, send, [Motion(position=0.2)])
    client.until(lambda: client.received['output'], 'the new output')
    assert set_parameters(client, {'outputs': ['state']})[0].successful
    client.received['output'].clear()
    answers(client, send, [Motion(position=0.3 + 0.01 * k) for k in range(5)])
    assert not client.received['output']                 # there, and silent


@pytest.mark.slow
def test_a_change_that_a_picture_cannot_show_is_refused(drive, client):
    """The gear turns the coupler the other way, for which URDF has no joint."""
    send, _ = drive({'joint_states.ratios': [-3.0, -2.0, 1.0, 1.0]}, source='motion')
    refused, = set_parameters(client, {'outputs': ['state', 'robot_description']})
    assert not refused.successful and 'ratio of' in refused.reason
    assert set_parameters(client, {'outputs': ['state', 'output']})[0].successful
    assert answers(client, send, [Motion(position=0.2)])


@pytest.mark.slow
def test_outputs_change_while_subscribers_come_and_go(drive, client):
    """Rclpy's events executor does not survive a publisher that is destroyed meanwhile."""
    send, _ = drive({}, source='motion')
    client.listen(['output', 'joint_states'])
    for k in range(25):
        outputs = [['state', 'output'], ['state', 'joint_states', 'tf'],
                   ['state', 'traces']][k % 3]
        assert set_parameters(client, {'outputs': outputs})[0].successful
        if k % 5 == 0:
            client.listen(['output', 'joint_states'])
    assert answers(client, send, [Motion(position=0.2)])


@pytest.mark.slow
def test_what_no_parameter_can_be_is_answered(drive, client):
    """A type that is none ends a bare rclpy node, and a name that is empty."""
    send, _ = drive({}, source='motion')
    for name, kind in (('', 3), ('motor.geer', 3), ('outputs', 0), ('linkage.a1', 0),
                       ('outputs', 5)):
        result, = client.ask(SetParameters, parameters=[
            Parameter(name=name, value=ParameterValue(type=kind))]).results
        # five is an empty list of bytes: no outputs at all
        assert result.successful == (kind == 5) and (kind == 5 or result.reason)
    assert set_parameters(client, {'outputs': ['state'], 'linkage.a2': 1},
                          atomically=True)[0].successful
    state, = answers(client, send, [Motion(position=0.2)])
    assert state.theta4 == scene.from_values({**PAPER, 'linkage.a2': 1.0}).linkage.motion(
        0.2).theta4


def test_a_timer_stays_on_its_grid_while_readers_come_and_go_and_goes_on_at_a_new_speed(
        run_node, client):
    speed, rate = 3.0, 200
    run_node({**PAPER, 'drive.speed': speed, 'drive.start': 0.3, 'drive.rate': float(rate),
              'outputs': ['state']})
    states, linkage = [], scene.from_values(PAPER).linkage

    def hear(count):
        """Listen until there are more states."""
        subscription = client.subscribe(OUTPUTS['state'], states.append, depth=1000)
        before = len(states)
        client.until(lambda: len(states) > before + count, 'the stream')
        return subscription
    for _ in range(2):
        client.node.destroy_subscription(hear(40))
        client.spin(0.3)
    for state in states:
        passed = nanoseconds(state) - nanoseconds(states[0])
        assert (passed + 2) % (SECOND // rate) <= 4          # two stamps to 1 ns
        assert (state.omega1, state.alpha1) == (speed, 0.0)
        assert state.theta4 == linkage.motion(state.theta1, speed).theta4
        assert state.theta1 - states[0].theta1 == pytest.approx(
            speed * passed / SECOND, abs=speed * 2e-9 + 1e-15 * state.theta1)
    hear(20)
    assert set_parameters(client, {'drive.speed': -3.0, 'drive.rate': 250.0},
                          atomically=True)[0].successful
    client.until(lambda: states[-1].omega1 == -3.0, 'the new speed')
    count = len(states)
    client.until(lambda: len(states) > count + 20, 'the stream')
    for a, b in zip(states, states[1:]):
        step = 1e-9 * (nanoseconds(b) - nanoseconds(a))
        if a.omega1 == b.omega1:
            assert b.theta1 - a.theta1 == pytest.approx(b.omega1 * step, abs=3.0 * 2e-9)
        else:           # a late tick changes the speed between two samples: there is no jump
            assert abs(b.theta1 - a.theta1) <= 3.0 * (step + 2e-9)
    assert step == pytest.approx(0.004, abs=2e-9)


def test_a_change_is_in_the_bag_and_recompute_follows_it(run_node, client, tmp_path):
    node = run_node({**PAPER, 'drive.rate': 200.0, 'outputs': ['state'],
                     **recording_in(tmp_path)})
    client.listen(['state'])
    client.until(lambda: len(client.received['state']) > 20, 'the stream')
    assert set_parameters(client, {'linkage.a2': 1.1})[0].successful
    result, = set_parameters(client, {'outputs': ['state', 'output']})
    assert not result.successful and 'while recording' in result.reason
    count = len(client.received['state'])
    client.until(lambda: len(client.received['state']) > count + 20, 'the stream')
    assert node.stop() == 0
    scenes = [json.loads(message.data) for message in in_bag(tmp_path / 'run', '/fourbar/scene')]
    assert [values['linkage.a2'] for values in scenes] == [1.2, 1.1]
    recomputed(tmp_path / 'run')


@pytest.mark.slow
def test_diagnostics_say_how_it_runs(run_node, client, diagnosed):
    run_node({**ROCKER, 'drive.speed': 0.1, 'drive.start': 0.5, 'drive.rate': 50.0,
              'outputs': ['state']})
    client.listen(['state'])
    client.until(lambda: client.received['state'], 'the stream')

    # the limit is at 0.5368 rad
    client.until(lambda: 'out of range' in diagnosed()[0].message, 'the warning')
    client.until(lambda: float(diagnosed()[1]['rate [Hz]']) == pytest.approx(50.0, rel=0.2),
                 'a second that is not disturbed')
    status, values = diagnosed()
    assert status.level == DiagnosticStatus.WARN
    # six digits
    assert (values['recording'] == 'off' and float(values['change-point margin'])
            == pytest.approx(3.0 / 17.0, abs=5e-7))
