# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""A live change is made beside the stream: no input waits for it."""
from itertools import count
from math import inf, isnan

from fourbar_ros import Base
from fourbar_ros.scene.files import read_values
from fourbar_ros.scene.scene import from_values
import pytest
from rcl_interfaces.msg import LoggerLevel
from rcl_interfaces.srv import (
    DescribeParameters,
    GetLoggerLevels,
    SetLoggerLevels,
    SetParameters,
)
from rclpy.parameter import Parameter
from sensor_msgs.msg import Imu, JointState
from support.harness import set_parameters
from support.scenes import PAPER, RODS

LOADED = {**PAPER, **RODS, 'drive.source': 'motion', 'outputs': ['loads', 'state']}
# a change waits, once it is at work, until there is a file 'go'
WAITING = """
from pathlib import Path
import time
from fourbar_ros.scene.scene import Scene
make = Scene.with_values
def make_late(scene, changes, pause):
    if changes.get('gravity.y') == -2.0:
        print('at work', flush=True)
        while not Path('go').exists():
            time.sleep(0.01)
    return make(scene, changes, pause)
Scene.with_values = make_late
"""


def changing(client):
    """Return the function that asks for another gravity and returns the future of the answer."""
    service = client.node.create_client(SetParameters, '/fourbar/set_parameters')
    client.until(service.service_is_ready, 'the parameter service')
    return lambda value: service.call_async(SetParameters.Request(parameters=[
        Parameter('gravity.y', value=value).to_parameter_msg()]))


def torque_at(position, **changes):
    """Return the driving torque of the loaded linkage at rest."""
    return from_values({**LOADED, **changes}).linkage.step(position, 0.0, 0.0)[1].driving_torque


@pytest.fixture
def torque(lockstep):
    """Return the function that asks for the driving torque at rest, one input after another."""
    ask, times = lockstep('loads'), count(1)
    return lambda: ask(next(times), 0.5, 0.0, 0.0).loads.driving_torque


def test_inputs_are_answered_while_a_change_is_made(run_node, client, torque, tmp_path):
    """In order of events, not by the clock: the change may take as long as it likes."""
    node = run_node(LOADED, first=WAITING)
    torque()
    change = changing(client)(-2.0)
    client.until(lambda: 'at work' in node.said, 'the change')
    old, new = torque_at(0.5), torque_at(0.5, **{'gravity.y': -2.0})
    assert old != new
    for _ in range(10):
        assert torque() == old
    assert not change.done()
    client.call('evaluate', position=0.5)                # nor does a service wait for it
    (tmp_path / 'go').touch()
    client.until(change.done, 'the answer')
    assert change.result().results[0].successful
    assert torque() == new


def test_the_ninth_change_that_waits_is_refused_and_a_node_ends_within_one(run_node, client):
    node, change, asked = run_node(LOADED, first=WAITING), changing(client), []
    change(-2.0)
    client.until(lambda: 'at work' in node.said, 'the change')
    for number in range(9):
        asked.append(change(float(number)))
        client.call('evaluate', position=0.5)            # the node has taken the request
    client.until(lambda: asked[-1].done(), 'the answer to the last')
    assert [each.done() for each in asked] == [False] * 8 + [True]
    refused, = asked[-1].result().results
    assert not refused.successful and refused.reason == (
        '8 requests wait for an answer already: ask again later')


def test_a_change_that_fails_after_the_swap_leaves_the_old_scene(run_node, client, torque):
    broken = """
from fourbar_ros.errors import FourBarError
from fourbar_ros.ros.node.recording import Recording
note = Recording.note
def fail(self, key, text):
    if '"gravity.y": -2.0' in text:
        raise FourBarError('as a test')
    if '"gravity.y": -2.5' in text:
        raise ValueError('ours')
    note(self, key, text)
Recording.note = fail
"""
    node = run_node(LOADED, first=broken)
    for value, why in ((-2.0, 'as a test'),
                       (-2.5, "a fault in the node, see its log: ValueError('ours')")):
        refused, = set_parameters(client, {'gravity.y': value})
        assert not refused.successful and why in refused.reason
        assert torque() == torque_at(0.5)
    client.until(lambda: 'Traceback' in node.said, 'the line of its log')
    node.said = node.said.replace('Traceback', '')       # this one was asked for
    assert set_parameters(client, {'gravity.y': -3.0})[0].successful
    assert torque() == torque_at(0.5, **{'gravity.y': -3.0})


def test_an_imu_keeps_its_rates_through_a_change_of_something_else(run_node, client, lockstep):
    given = {**LOADED, 'base.topic': 'imu', 'base.timeout': 0.0, 'outputs': ['loads'],
             'points.p.link': 'output'}
    run_node(given)
    ask, imu, linkage = lockstep('loads'), Imu(), from_values(given).linkage
    imu.linear_acceleration.y = 9.81

    def torque_with(number, slope):
        """Return the difference of an answer, the base turning faster by a step, from the due."""
        imu.angular_velocity.z = 0.01 * number
        base = Base(0.0, 9.81, imu.angular_velocity.z, slope)
        return (ask(0.01 * number, 0.5, 2.0, 3.0, imu).loads.driving_torque
                - linkage.loads(0.5, 2.0, 3.0, base=base).driving_torque)
    assert isnan(torque_with(1, 1.0))
    for number in range(2, 7):
        assert abs(torque_with(number, 1.0)) < 1e-9
        assert set_parameters(client, {'points.p.along': 0.1 * number})[0].successful
    assert set_parameters(client, {'base.rotation': [0.0, 0.0, 0.0]})[0].successful
    assert isnan(torque_with(7, 1.0)) and abs(torque_with(8, 1.0)) < 1e-9


def test_an_estimate_goes_on_through_a_change_of_something_else(run_node, client):
    run_node({**LOADED, 'drive.source': 'joint_state', 'drive.joint': 'motor'})
    client.listen(['state'])
    send, number = client.driving('joint_state', name=['motor'], position=[0.1]), count(1)

    def rates():
        """Return the rates of the answer to the next position, at 5 rad/s."""
        k, heard = next(number), len(client.received['state'])
        message = JointState(name=['motor'], position=[0.05 * k])
        message.header.stamp.sec, message.header.stamp.nanosec = divmod(10**10 + 10**7 * k, 10**9)
        send(message)
        client.until(lambda: len(client.received['state']) > heard, 'an answer')
        return client.received['state'][-1].omega1, client.received['state'][-1].alpha1
    for _ in range(3):
        rates()
    for name, value in {'drive.speed': 3.0, 'drive.out_of_range': 'hold', 'gravity.y': -9.0,
                        'drive.torque_limit': 5.0, 'linkage.a1': 0.41}.items():
        assert set_parameters(client, {name: value})[0].successful
        assert rates() == pytest.approx((5.0, 0.0), abs=1e-8)
    assert set_parameters(client, {'drive.window': 3})[0].successful
    assert isnan(rates()[0])


def test_what_depends_on_structure_alone_is_not_made_again():
    """Ranges and toggles of a machine are searched once, and are those of a new machine."""
    values = read_values('jansen')
    one = from_values(values).linkage
    assert one.change_point_margin > 0.0 and one.singular_inputs     # searches for toggles
    other = from_values({**values, 'gravity.y': -1.0}).linkage
    assert other.singular_inputs is one.singular_inputs and other.gravity == (0.0, -1.0)
    alone = type(one)(**{name: getattr(other, name) for name in (
        'dyads', 'input', 'output', 'cylinder', 'bodies', 'gravity', 'external', 'stroke')})
    assert alone.singular_inputs == one.singular_inputs
    assert alone.singular_inputs is not one.singular_inputs
    assert alone.step(1.0, 2.0, 3.0) == other.step(1.0, 2.0, 3.0) != one.step(1.0, 2.0, 3.0)
    longer = from_values({**values, 'gravity.y': -1.0, 'linkage.output': ''}).linkage
    assert longer.singular_inputs is not one.singular_inputs


@pytest.mark.parametrize('change', [{'gravity.y': -2.0}, {'drive.speed': 3.0}])
def test_messages_are_packed_anew_only_for_another_frame_or_structure(change):
    from fourbar_ros.ros.node.stream import writer_of
    from fourbar_ros.scene.topics import OUTPUTS
    scene, other = from_values(LOADED), from_values({**LOADED, **change})
    longer = from_values({**LOADED, 'linkage.a3': 0.81})
    for name in ('state', 'loads'):
        writer = writer_of(OUTPUTS[name], scene, scene.layout, None)
        assert writer_of(OUTPUTS[name], other, other.layout, writer) is writer
        again = writer_of(OUTPUTS[name], longer, longer.layout, writer)
        assert (again is writer) is (name == 'loads')    # the state has the change-point margin


def test_descriptors_have_the_limits_of_the_table_and_a_refusal_says_them(run_node, client):
    run_node({**LOADED, 'drive.source': 'timer'})
    described = {each.name: each for each in client.ask(DescribeParameters, names=[
        'drive.rate', 'linkage.a1', 'pictures.rate', 'drive.speed', 'linkage.mode',
        'linkage.offset', 'drive.top_speed']).descriptors}
    limits = {name: [(limit.from_value, limit.to_value) for limit in (
        *each.floating_point_range, *each.integer_range)] for name, each in described.items()}
    assert limits == {'drive.rate': [(0.001, 5000.0)], 'linkage.a1': [],
                      'pictures.rate': [(0.0, inf)], 'drive.speed': [],
                      'linkage.mode': [(1, 2)], 'linkage.offset': [],
                      'drive.top_speed': []}       # may be not given: NaN
    for name, value, words in (
            ('drive.rate', 5001.0, 'drive.rate = 5001.0: must lie in [0.001, 5000]'),
            ('pictures.rate', -1.0, 'pictures.rate = -1.0: must'),
            ('linkage.mode', 3, 'linkage.mode = 3: must')):
        (answer,) = set_parameters(client, {name: value})
        assert not answer.successful and answer.reason.startswith(words), answer.reason
    (answer,) = set_parameters(client, {'drive.rate': 5000.0})
    assert answer.successful, answer.reason


def test_the_level_of_the_log_is_set_by_a_service(run_node, client):
    run_node(LOADED)
    debug = LoggerLevel.LOG_LEVEL_DEBUG
    (answer,) = client.ask(SetLoggerLevels, levels=[LoggerLevel(name='fourbar', level=debug)]
                           ).results
    assert answer.successful, answer.reason
    (level,) = client.ask(GetLoggerLevels, names=['fourbar']).levels
    assert level.level == debug


def test_evaluate_lists_what_a_scene_has_by_name_and_unit(run_node, client):
    run_node(LOADED)
    values = {each.name: each.unit for each in client.call('evaluate', position=0.5).values}
    assert values['theta4'] == 'rad' and values['f41'] == 'N' and values['driving_torque'] == 'N m'
