# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The node over the wire: every topic, every service, against the core to the last bit."""
import math
import random

from builtin_interfaces.msg import Time
from fourbar_msgs.msg import LinkageState, Motion
from fourbar_ros import load_scene
from fourbar_ros.extrema.find import find_extrema
from fourbar_ros.mechanisms.inertia import held_rigid, input_equation
from fourbar_ros.pipeline import stepper as codes
from fourbar_ros.scene import scene
from fourbar_ros.scene.files import find, read_values
import pytest
from support.harness import ALL_OUTPUTS, fields_of, nanoseconds
from support.scenes import PAPER, ROCKER, RODS

DRIVEN = {**PAPER, **RODS, 'drive.source': 'motion', 'outputs': ALL_OUTPUTS, 'frame_id': 'machine'}


def motion(position, velocity=0.0, acceleration=0.0, stamp=0):
    message = Motion(position=position, velocity=velocity, acceleration=acceleration)
    message.header.stamp = Time(sec=stamp, nanosec=stamp + 1)
    return message


def send_all(client, inputs):
    """Send the inputs after a handshake; return {output: messages} when each has been answered."""
    send = client.driving()
    for k, message in enumerate(inputs):        # one by one: no queue is too short
        send(message)
        client.until(lambda k=k: all(len(m) > k for m in client.received.values()),
                     f'answer {k} on every topic')
    return client.received


def test_every_topic_carries_the_values_of_the_core_to_the_last_bit(run_node, client):
    run_node(DRIVEN)
    client.listen()
    random.seed(1)
    inputs = [motion(random.uniform(-20, 20), random.uniform(-50, 50), random.uniform(-900, 900),
                     k)
              for k in range(60)]
    received = send_all(client, inputs)
    linkage, layout = scene.from_values(DRIVEN).linkage, scene.from_values(DRIVEN).layout
    for name, messages in received.items():
        assert len(messages) == len(inputs)
        for sent, message in zip(inputs, messages):
            motion_and_loads = linkage.step(sent.position, sent.velocity, sent.acceleration)
            torque = motion_and_loads[1].driving_torque
            equation = input_equation(linkage, sent.position, sent.velocity)
            values = (*sum(motion_and_loads, ()), *equation, torque,
                      *held_rigid(linkage, motion_and_loads[0]), 0.0, 0.0, -torque)
            # NaN is NaN here
            assert repr(fields_of(layout, name, message)) == repr(layout.expected(name, values))
            assert message.header.stamp == sent.header.stamp
            assert message.header.frame_id == 'machine'
            if hasattr(message, 'status'):
                assert getattr(message, 'change_point_margin',
                               linkage.change_point_margin) == linkage.change_point_margin
                assert (message.status, message.mode) == (LinkageState.STATUS_OK,
                                                          LinkageState.MODE_OPEN)
    assert list(received['joint_states'][0].name) == ['crank', 'coupler', 'coupler_output',
                                                      'output']


def test_bad_numbers_are_reported_and_the_next_good_message_works(run_node, client):
    run_node({**DRIVEN, 'joint_states.when_unknown': 'send_nan'})
    client.listen()
    bad = [(math.nan, 1.0, 0.0), (0.1, math.inf, 0.0), (0.1, 1.0, -math.inf), (0.1, 1e300, 0.0)]
    received = send_all(client, [
        each for one in bad for each in (motion(*one, stamp=5), motion(0.2, 1.0))])
    for k in range(0, 8, 2):
        state, good = received['state'][k:k + 2]
        loads = received['loads'][k]
        assert state.status == loads.status == LinkageState.STATUS_INVALID_INPUT
        assert math.isnan(state.theta4) and math.isnan(loads.f41)
        assert math.isnan(received['shaking_wrench'][k].wrench.force.x)
        assert state.header.stamp.sec == 5
        assert good.status == LinkageState.STATUS_OK and math.isfinite(good.theta4)


def test_a_rocker_says_where_its_input_ends(run_node, client):
    run_node({**ROCKER, 'drive.source': 'motion', 'outputs': ['state', 'output']})
    client.listen(['state', 'output'])
    received = send_all(client, [motion(1.0, 1.0), motion(0.2, 1.0)])
    out, good = received['state']
    assert (out.status == LinkageState.STATUS_OUT_OF_RANGE and out.theta1 == 1.0
            and math.isnan(out.theta4))
    assert math.isnan(received['output'][0].position)
    assert good.status == LinkageState.STATUS_OK
    answer = client.call('evaluate', position=1.0)
    assert answer.result == answer.RESULT_OUT_OF_RANGE and '0.536750177' in answer.message
    assert not answer.has_loads and math.isnan(answer.loads.f41)
    answer = client.call('find_extrema', quantities=['omega4'], velocity=1.0)
    ends = [e for e in answer.extrema if e.place == e.PLACE_LIMIT]
    assert len(ends) == 2 and all(math.isinf(e.value) and e.side != 0 for e in ends)


def test_status_numbers_are_those_of_the_message():
    for name in ('OK', 'OUT_OF_RANGE', 'INVALID_INPUT', 'TOGGLE', 'RATES_UNKNOWN', 'INPUT_TIMEOUT',
                 'LOADS_UNKNOWN'):
        assert getattr(codes, name) == getattr(LinkageState, f'STATUS_{name}')


# --- services ------------------------------------------------------------------------------------

def test_find_extrema_answers_what_the_core_finds_and_a_proof_does_not_hold_up_the_stream(
        run_node, client):
    """The stream of the timer is in the order of its stamps, without a gap."""
    run_node({**PAPER, **RODS, 'drive.speed': 25.0, 'drive.rate': 200.0, 'outputs': ['state']})
    answer = client.call('find_extrema', mode=3)
    assert (answer.result, answer.message) == (answer.RESULT_OK, '')
    linkage = scene.from_values({**PAPER, **RODS}).linkage
    expected = [e for mode in (1, 2) for e in find_extrema(linkage.in_mode(mode), (), 25.0)]
    found = {(e.quantity, e.mode, e.theta1, e.value, e.is_global) for e in answer.extrema}
    assert found == {(e.quantity, e.mode, e.theta1, e.value, e.is_global) for e in expected}
    assert len(answer.extrema) == len(expected) > 60
    force = max((e for e in answer.extrema if e.quantity == 'shaking_force' and e.mode == 2),
                key=lambda e: e.value)
    assert force.value == pytest.approx(2512.318373, abs=5e-7)
    assert force.theta1 == pytest.approx(0.10962848, abs=5e-9)
    client.listen(['state'])
    client.until(lambda: client.received['state'], 'the stream')
    client.received['state'].clear()
    answer = client.call('find_extrema', quantities=['omega4', 'alpha4'], mode=3, certify=True)
    assert answer.result == answer.RESULT_OK
    assert all(extremum.proof == 'interval bounds' for extremum in answer.extrema)
    stamps = [nanoseconds(s) for s in client.received['state']]
    steps = {round((b - a) / 5e6) for a, b in zip(stamps, stamps[1:])}
    assert steps <= {1}                                          # every sample of the 200 Hz grid


def test_find_extrema_where_a_robot_moves(run_node, client):
    run_node({**read_values(find('bucket')), 'drive.source': 'motion', 'outputs': ['state']})
    answer = client.call('find_extrema', quantities=['driving_force'], velocity=0.1,
                         range=[1.6, 2.0])
    assert answer.result == answer.RESULT_OK and len(answer.extrema) == 2
    largest = max(answer.extrema, key=lambda e: abs(e.value))
    assert largest.place == largest.PLACE_LIMIT and largest.slide == 1.6 and largest.is_global
    truth = load_scene('bucket').linkage.loads(1.6, 0.1).driving_force
    assert largest.value == pytest.approx(truth, rel=1e-12)
    answer = client.call('find_extrema', velocity=0.1, range=[0.3, 0.4])
    assert (answer.result == answer.RESULT_INVALID_REQUEST
            and answer.message.startswith('range = (0.3, 0.4): the links close at none'))


def test_find_extrema_refuses_with_a_reason(run_node, client):
    run_node({**PAPER, 'drive.source': 'motion', 'outputs': ['state']})
    for request, said in (({'velocity': 0.0}, 'velocity'), ({'velocity': math.nan}, 'velocity'),
                          ({'velocity': 1e160}, 'velocity = 1e+160: must be at most 1e+100'),
                          ({'velocity': 1.0, 'acceleration': math.inf}, 'acceleration = inf'),
                          ({'velocity': 1.0, 'quantities': ['f41']}, 'no masses'),
                          ({'velocity': 1.0, 'mode': 7}, 'mode = 7')):
        answer = client.call('find_extrema', **request)
        assert answer.result == answer.RESULT_INVALID_REQUEST and said in answer.message
    answer = client.call('find_extrema', quantities=['nonsense'], velocity=1.0)
    assert answer.result == answer.RESULT_UNKNOWN_QUANTITY and 'nonsense' in answer.message
    once, twice = (repr(client.call('find_extrema', velocity=1.0,
                                    quantities=['omega4'] * n).extrema)
                   for n in (1, 2))
    assert 'omega4' in once and twice == once
    answer = client.call('find_extrema', velocity=2.0)                       # and it still answers
    assert (answer.result == answer.RESULT_OK and {e.quantity for e in answer.extrema}
            >= {'omega4', 'alpha4'})
    assert not any(e.unit == 'N' for e in answer.extrema)


def test_evaluate_answers_the_values_of_the_core(run_node, client):
    run_node(DRIVEN)
    linkage, layout = scene.from_values(DRIVEN).linkage, scene.from_values(DRIVEN).layout
    for mode in (0, 1, 2):
        answer = client.call('evaluate', position=0.7, velocity=25.0, acceleration=-3.0, mode=mode)
        assert (answer.result, answer.has_loads) == (answer.RESULT_OK, True)
        values = sum(linkage.in_mode(mode or 2).step(0.7, 25.0, -3.0), ())
        for name in ('state', 'loads'):
            assert repr(fields_of(layout, name,
                                  getattr(answer, name))) == repr(layout.expected(name, values))
        assert answer.state.mode == (mode or 2) and answer.state.header.frame_id == 'machine'
    bad = client.call('evaluate', position=math.nan)
    assert bad.result == bad.RESULT_INVALID_REQUEST and 'finite' in bad.message
    bad = client.call('evaluate', position=0.1, velocity=math.nan)
    assert bad.result == bad.RESULT_INVALID_REQUEST and 'finite' in bad.message
    bad = client.call('evaluate', position=0.1, mode=9)
    assert bad.result == bad.RESULT_INVALID_REQUEST and 'mode = 9' in bad.message
