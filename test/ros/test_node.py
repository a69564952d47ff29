# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The node over the wire: every topic, every service, against the core to the last bit."""
import math
import random

from fourbar_msgs.msg import LinkageState
from fourbar_msgs.srv import FindExtrema
from fourbar_ros import load_scene
from fourbar_ros.errors import FourBarError
from fourbar_ros.extrema.find import find_extrema
from fourbar_ros.mechanisms.inertia import held_rigid, input_equation
from fourbar_ros.pipeline import stepper as codes
from fourbar_ros.pipeline.joints import SceneJoints
from fourbar_ros.ros.node import services
from fourbar_ros.ros.node.entities import WAITING
from fourbar_ros.scene import scene
from fourbar_ros.scene.files import find, read_values
import pytest
from rclpy.qos import QoSProfile
from support.harness import ALL_OUTPUTS, fields_of, nanoseconds
from support.scenes import PAPER, ROCKER, RODS

DRIVEN = {**PAPER, **RODS, 'drive.source': 'motion', 'outputs': ALL_OUTPUTS, 'frame_id': 'machine'}


def test_every_topic_carries_the_values_of_the_core_to_the_last_bit(run_node, lockstep):
    run_node(DRIVEN)
    ask, rng, its = lockstep(*ALL_OUTPUTS), random.Random(1), scene.from_values(DRIVEN)
    linkage, layout, joints = its.linkage, its.layout, SceneJoints(its)
    for k in range(1, 61):
        position, rate, acceleration = (rng.uniform(-size, size) for size in (20, 50, 900))
        answer = ask(k, position, rate, acceleration)
        motion, loads = linkage.step(position, rate, acceleration)
        torque = loads.driving_torque
        values = (*motion, *loads, *input_equation(linkage, position, rate), torque,
                  *held_rigid(linkage, motion), 0.0, 0.0, -torque)
        values += joints.of(values)
        for name, message in vars(answer).items():
            # NaN is NaN here
            assert repr(fields_of(layout, name, message)) == repr(layout.expected(name, values))
            assert message.header.frame_id == 'machine'
            if hasattr(message, 'status'):
                assert getattr(message, 'change_point_margin',
                               linkage.change_point_margin) == linkage.change_point_margin
                assert (message.status, message.mode) == (LinkageState.STATUS_OK,
                                                          LinkageState.MODE_OPEN)
    assert list(answer.joint_states.name) == ['crank', 'coupler', 'coupler_output', 'output']


def test_a_rocker_says_where_its_input_ends(run_node, client, lockstep):
    run_node({**ROCKER, 'drive.source': 'motion', 'outputs': ['state', 'output']})
    ask = lockstep('state', 'output')
    out = ask(1, 1.0, 1.0, 0.0)
    assert (out.state.status == LinkageState.STATUS_OUT_OF_RANGE and out.state.theta1 == 1.0
            and math.isnan(out.state.theta4))
    assert math.isnan(out.output.position)
    assert ask(2, 0.2, 1.0, 0.0).state.status == LinkageState.STATUS_OK
    answer = client.call('evaluate', position=1.0)
    assert answer.result == answer.RESULT_OUT_OF_RANGE and '0.536750177' in answer.message
    assert not answer.has_loads and math.isnan(answer.loads.f41)
    answer = client.call('find_extrema', quantities=['omega4'], velocity=1.0)
    ends = [e for e in answer.extrema if e.place == e.PLACE_LIMIT]
    assert len(ends) == 2 and all(math.isinf(e.value) and e.side != 0 for e in ends)


def test_a_crank_with_a_range_says_where_its_input_ends(run_node, client, lockstep):
    run_node({**PAPER, 'linkage.range': ['0deg', '48deg'], 'drive.source': 'motion',
              'outputs': ['state', 'output']})
    ask, tau = lockstep('state', 'output'), 2.0 * math.pi
    for k, (position, status) in enumerate((
            (1.0, 'OUT_OF_RANGE'), (0.5, 'OK'), (0.5 - 3.0 * tau, 'OK'),
            (-0.1, 'OUT_OF_RANGE')), 1):
        state = ask(k, position, 1.0, 0.0).state
        assert state.status == getattr(LinkageState, f'STATUS_{status}')
        assert math.isnan(state.theta4) == (status != 'OK')
    answer = client.call('evaluate', position=1.0)
    assert answer.result == answer.RESULT_OUT_OF_RANGE and '0.837758041' in answer.message
    answer = client.call('find_extrema', quantities=['omega4'], velocity=1.0)
    assert {e.theta1 for e in answer.extrema if e.place == e.PLACE_LIMIT} == {
        0.0, math.radians(48.0)}


def test_status_numbers_are_those_of_the_message():
    for name in ('OK', 'OUT_OF_RANGE', 'INVALID_INPUT', 'TOGGLE', 'RATES_UNKNOWN', 'INPUT_TIMEOUT',
                 'LOADS_UNKNOWN', 'LOCKED'):
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


def test_an_error_in_the_second_mode_leaves_no_extrema_of_the_first():
    service, paper = FindExtrema, scene.from_values({**PAPER, **RODS})
    calls = []

    def search(mode, most):
        def check():
            calls.append(mode)
            if len(calls) > most:
                raise FourBarError('the node ends')
        return services.search(paper, service.Request(mode=mode, velocity=25.0,
                                                      quantities=['omega4', 'f41']),
                               check, service.Response())
    search(3, math.inf)         # what is searched once is asked fewer times
    calls.clear()
    of_first = search(1, math.inf)
    ended = len(calls)
    calls.clear()
    assert of_first.result == of_first.RESULT_OK and len(of_first.extrema) > 4
    answer = search(3, ended)
    assert answer.result == answer.RESULT_UNSUPPORTED and answer.message == 'the node ends'
    assert not answer.extrema and len(calls) == ended + 1


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


def test_find_extrema_of_what_is_at_rest_needs_no_velocity(run_node, client):
    run_node({**read_values(find('jansen')), 'drive.source': 'motion', 'outputs': ['state']})
    linkage = load_scene('jansen').linkage
    for name in ('holding_torque', 'mechanical_advantage'):
        answer = client.call('find_extrema', quantities=[name])
        assert answer.result == answer.RESULT_OK, answer.message
        expected = find_extrema(linkage, (name,), 2.0)          # at any rate
        assert [e.value for e in answer.extrema] == [e.value for e in expected]
    for name in ('bias', 'driving_torque'):
        answer = client.call('find_extrema', quantities=['holding_torque', name])
        assert answer.result == answer.RESULT_INVALID_REQUEST
        assert answer.message.startswith('velocity = 0.0: must not be zero')


def test_find_extrema_refuses_with_a_reason(run_node, client):
    run_node({**PAPER, 'drive.source': 'motion', 'outputs': ['state']})
    for request, said in (({'velocity': 0.0}, 'velocity'), ({'velocity': math.nan}, 'velocity'),
                          ({'velocity': 1e160}, 'velocity = 1e+160: must be at most 1e+100'),
                          ({'velocity': 1.0, 'acceleration': math.inf}, 'acceleration = inf'),
                          ({'velocity': 1.0, 'quantities': ['f41']}, 'loads need masses'),
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


def test_each_of_three_hundred_requests_at_once_is_answered(run_node, client):
    """By a client that keeps as many answers: its queue is its own."""
    run_node({**PAPER, 'outputs': ['state']})
    many = client.node.create_client(FindExtrema, '/fourbar/find_extrema',
                                     qos_profile=QoSProfile(depth=1000))
    client.until(many.service_is_ready, 'the service')
    wanted = FindExtrema.Request(quantities=['theta4'], velocity=10.0)
    client.introduce(many, 'find_extrema')
    asked = [many.call_async(wanted) for _ in range(300)]
    client.until(lambda: all(each.done() for each in asked), 'all answers')
    results = [each.result().result for each in asked]
    assert set(results) == {FindExtrema.Response.RESULT_OK, FindExtrema.Response.RESULT_BUSY}


PROOF = FindExtrema.Request(mode=0, velocity=10.0, certify=True)     # of every quantity
JANSEN = {**read_values('config/jansen.yaml'), 'outputs': ['state']}


def test_only_proofs_wait_for_a_proof_and_eight_of_them(run_node, client):
    """In order of events: a proof takes as long as hundreds of evaluations."""
    node, asked = run_node(JANSEN), 14
    wanted = {'quantities': ['driving_torque'], 'velocity': 10.0}
    service, alone = client.service('find_extrema'), client.call('find_extrema', **wanted)
    proofs = []

    def answered():
        client.spin(0.01)
        return [number for number, proof in enumerate(proofs) if proof.done()]
    for _ in range(asked):
        proofs.append(service.call_async(PROOF))
        client.call('evaluate', position=0.5)
    client.until(lambda: proofs[-1].done(), 'the answer to the last')
    busy = list(range(1 + WAITING, asked))               # before them one at work, eight that wait
    assert answered() == busy
    for number in busy:
        answer = proofs[number].result()
        assert answer.result == answer.RESULT_BUSY and not answer.extrema
        assert answer.message == '8 requests wait for an answer already: ask again later'
    assert repr(client.call('find_extrema', **wanted)) == repr(alone) and alone.extrema
    assert answered() == busy
    assert node.stop() == 0                              # in the middle of it
