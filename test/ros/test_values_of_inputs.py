# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Each number of a message on an input topic acts as it was sent: sign, axis, clock, limit."""
import math

from builtin_interfaces.msg import Time
from fourbar_msgs.msg import DriveState, LinkageState, Motion
from fourbar_ros.mechanics.bodies import Applied
from fourbar_ros.scene import scene
from geometry_msgs.msg import WrenchStamped
import pytest
from ros.test_trouble import Simulation
from rosgraph_msgs.msg import Clock
from support.harness import set_parameters
from support.scenes import PAPER, RODS

SECOND = 10**9
NAN = math.nan


@pytest.fixture
def motions(run_node, client):
    """Return the function that starts a node and gives (node, answer to a motion at a time)."""
    def start(parameters):
        node = run_node({**PAPER, 'drive.source': 'motion', 'outputs': ['state'], **parameters})
        client.listen(['state'])
        publisher = client.publisher()
        client.handshake(lambda: publisher.publish(Motion(position=0.1)))

        def answer(stamp, *motion):
            message = Motion(**dict(zip(('position', 'velocity', 'acceleration'), motion)))
            message.header.stamp = Time(sec=stamp // SECOND, nanosec=stamp % SECOND)
            client.received['state'].clear()
            publisher.publish(message)
            client.until(lambda: client.received['state'], 'an answer')
            return client.received['state'][0]
        return node, answer
    return start


def test_an_acceleration_that_is_given_is_not_estimated_and_a_stamp_ahead_is_said(motions, client):
    node, answer = motions({})
    now = client.node.get_clock().now().nanoseconds
    states = [answer(now + k * SECOND // 100, 0.04 * k, NAN, 7.0) for k in range(8)]
    assert states[-1].status == LinkageState.STATUS_OK and states[-1].alpha1 == 7.0
    assert states[-1].omega1 == pytest.approx(4.0, rel=1e-9)
    ahead = client.node.get_clock().now().nanoseconds + 9 * SECOND
    assert answer(ahead, 0.3, 1.0, 0.0).theta1 == 0.3
    client.until(lambda: 's ahead of the clock' in node.said, 'the warning')


def test_after_a_timeout_the_estimate_starts_afresh(motions, client):
    """On simulated time, which stands until the answers have come."""
    simulation = Simulation(client)
    _, answer = motions({'drive.timeout': 1.0, 'drive.window': 3, 'use_sim_time': True})
    simulation.stands = True
    now = simulation.now
    states = [answer(now + k * SECOND // 100, 0.04 * k, NAN, NAN) for k in range(4)]
    assert states[-1].status == LinkageState.STATUS_OK
    for _ in range(3):                  # it is told once
        simulation.now += 2 * SECOND
        client.until(lambda: client.received['state'][-1].status
                     == LinkageState.STATUS_INPUT_TIMEOUT, 'the timeout')
        client.spin(0.2)
    assert len(client.received['state']) == 2
    # by its stamp it follows at once
    after = answer(now + 4 * SECOND // 100, 0.16, NAN, NAN)
    assert after.status == LinkageState.STATUS_RATES_UNKNOWN and math.isnan(after.omega1)


def test_on_simulated_time_the_angle_goes_on_at_a_new_speed(run_node, client):
    run_node({**PAPER, 'drive.speed': 2.0, 'drive.rate': 100.0, 'outputs': ['state'],
              'use_sim_time': True})
    client.listen(['state'])
    clock = client.node.create_publisher(Clock, '/clock', 10)
    now, states = [100 * SECOND], client.received['state']

    def tick():
        now[0] += SECOND // 100
        clock.publish(Clock(clock=Time(sec=now[0] // SECOND, nanosec=now[0] % SECOND)))
    client.until(lambda: tick() or len(states) > 5, 'the stream')
    assert set_parameters(client, {'drive.speed': -3.0})[0].successful
    client.until(lambda: tick() or states[-1].omega1 == -3.0, 'the new speed')
    count = len(states)
    client.until(lambda: tick() or len(states) > count + 5, 'the stream')
    times = [state.header.stamp.sec + 1e-9 * state.header.stamp.nanosec for state in states]
    for k in range(1, len(states)):
        assert states[k].theta1 - states[k - 1].theta1 == pytest.approx(
            states[k].omega1 * (times[k] - times[k - 1]), abs=1e-9)


SLIDE = {**RODS, 'bodies.output.mass': 2.0, 'linkage.kind': 'slider_crank',
         'linkage.input': 'slide', 'linkage.a1': 0.4, 'linkage.a2': 1.2, 'drive.start': 1.2}


@pytest.mark.parametrize('values, part, axis', [
    (PAPER, 'torque', 'z'), (SLIDE, 'force', 'x')])
def test_a_torque_or_force_is_cut_to_its_limit_on_both_sides(run_node, client, values, part, axis):
    run_node({**values, **RODS, 'drive.source': 'torque', 'drive.torque_limit': 20.0,
              'drive.timeout': 0.0, 'drive.rate': 50.0, 'outputs': ['state']})
    heard = []
    client.node.create_subscription(DriveState, '/fourbar/drive_state', heard.append, 10)
    publisher = client.node.create_publisher(WrenchStamped, '/fourbar/torque', 10)
    message = WrenchStamped()
    message.wrench.torque.x = message.wrench.force.x = message.wrench.force.y = 1.0
    message.wrench.torque.z = 2.0
    for sent, acts in ((-500.0, -20.0), (500.0, 20.0), (-3.0, -3.0)):
        setattr(getattr(message.wrench, part), axis, sent)

        def acted():
            publisher.publish(message)
            return heard and heard[-1].command not in (0.0, before)
        before = heard[-1].command if heard else 0.0
        client.until(acted, 'the torque')
        assert heard[-1].command == acts


def test_a_wrench_in_no_frame_acts_with_all_three_numbers(run_node, client):
    run_node({**PAPER, **RODS, 'external.output.from_topic': True, 'external.output.along': 0.5,
              'drive.source': 'motion', 'outputs': ['loads']})
    client.listen(['loads'])
    inputs = client.publisher()
    wrenches = client.node.create_publisher(WrenchStamped, '/fourbar/external/output', 10)
    wrench = WrenchStamped()
    wrench.wrench.force.x, wrench.wrench.force.y, wrench.wrench.torque.z = 3.0, 5.0, 0.7
    given = {'external.output.force_x': 3.0, 'external.output.force_y': 5.0,
             'external.output.couple': 0.7, 'external.output.along': 0.5}
    linkage = scene.from_values({**PAPER, **RODS, **given}).linkage
    assert linkage.external.output == Applied(3.0, 5.0, 0.5, 0.0, 0.7)
    expected = linkage.loads(0.3, 2.0, 0.0).driving_torque

    def acted():
        wrenches.publish(wrench)
        inputs.publish(Motion(position=0.3, velocity=2.0))
        last = client.received['loads'][-1:]
        return last and last[0].status == LinkageState.STATUS_OK
    client.until(acted, 'the loads with the wrench')
    assert client.received['loads'][-1].driving_torque == expected
