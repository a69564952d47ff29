# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Each number of a message on an input topic acts as it was sent: sign, axis, clock, limit."""
import math

from fourbar_msgs.msg import DriveState, LinkageState, Motion
from geometry_msgs.msg import WrenchStamped
import pytest
from ros.test_inputs import SECOND, stamped
from support.harness import SimulatedClock
from support.scenes import PAPER, RODS

NAN = math.nan


@pytest.fixture
def motions(run_node, client):
    """Return the function that starts a node and gives (node, answer to a motion at a time)."""
    def start(parameters):
        node = run_node({**PAPER, 'drive.source': 'motion', 'outputs': ['state'], **parameters})
        client.listen(['state'])
        send = client.driving()

        def answer(stamp, *motion):
            message = Motion(**dict(zip(('position', 'velocity', 'acceleration'), motion)))
            client.received['state'].clear()
            send(stamped(message, stamp))
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
    """On simulated time: while it stands no input can come, and that is no timeout."""
    clock = SimulatedClock(client, 100 * SECOND, repeats=True)
    _, answer = motions({'drive.timeout': 1.0, 'drive.window': 3, 'use_sim_time': True})
    now = clock.now
    states = [answer(now + k * SECOND // 100, 0.04 * k, NAN, NAN) for k in range(4)]
    assert states[-1].status == LinkageState.STATUS_OK
    client.spin(1.5)
    assert len(client.received['state']) == 1
    for _ in range(3):                  # it is told once
        clock.now += 2 * SECOND
        client.until(lambda: client.received['state'][-1].status
                     == LinkageState.STATUS_INPUT_TIMEOUT, 'the timeout')
        client.spin(0.2)
    assert len(client.received['state']) == 2
    # by its stamp it follows at once
    after = answer(now + 4 * SECOND // 100, 0.16, NAN, NAN)
    assert after.status == LinkageState.STATUS_RATES_UNKNOWN and math.isnan(after.omega1)


SLIDE = {**RODS, 'bodies.output.mass': 2.0, 'linkage.kind': 'slider_crank',
         'linkage.input': 'slide', 'linkage.a1': 0.4, 'linkage.a2': 1.2, 'drive.start': 1.2}


def test_a_force_on_a_slide_is_cut_to_its_limit_on_both_sides(run_node, client):
    run_node({**SLIDE, 'drive.source': 'torque', 'drive.torque_limit': 20.0,
              'drive.timeout': 0.0, 'drive.rate': 50.0, 'outputs': ['state']})
    heard = client.hear(DriveState, '/fourbar/drive_state')
    publisher = client.node.create_publisher(WrenchStamped, '/fourbar/torque', 10)
    message = WrenchStamped()
    message.wrench.torque.x = message.wrench.torque.z = message.wrench.force.y = 1.0
    for sent, acts in ((-500.0, -20.0), (500.0, 20.0), (-3.0, -3.0)):
        message.wrench.force.x = sent

        def acted():
            publisher.publish(message)
            return heard and heard[-1].command not in (0.0, before)
        before = heard[-1].command if heard else 0.0
        client.until(acted, 'the torque')
        assert heard[-1].command == acts
