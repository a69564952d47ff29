# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Nodes in a chain: the output of one is the input of the next, whose torque loads the one before.

Over real topics, compared with one computation without ROS: to the last bit; power to 1e-12.
"""
from builtin_interfaces.msg import Time
from fourbar_msgs.msg import Motion
from fourbar_ros import External
from fourbar_ros.mechanics.bodies import Applied
from fourbar_ros.scene.scene import from_values
import pytest
from support.power import power
from support.samples import more
from support.scenes import PAPER, RODS, SLIDES_7_6

SMALL = {name: 0.1 * value for name, value in SLIDES_7_6.items()}
CHAIN = (PAPER, SMALL, {**PAPER, 'linkage.mode': 1}, SMALL)
COMMON = {**RODS, 'gravity.y': -9.81, 'drive.source': 'motion', 'drive.timeout': 0.0,
          'external.timeout': 0.0, 'outputs': ['output', 'loads', 'drive_wrench', 'state']}


def start(run_node, count):
    """Start a chain; all but the last are loaded by the next."""
    for place, lengths in enumerate(CHAIN[:count]):
        remaps = [f'~/input:=/node{place - 1}/output'] if place else []
        loaded = place + 1 < count
        if loaded:
            remaps.append(f'~/external/output:=/node{place + 1}/drive_wrench')
        run_node({**lengths, **COMMON, 'external.output.from_topic': loaded},
                 name=f'node{place}', remaps=remaps)


def directly(count, given):
    """Return ([(mechanism, its input)], [driving torque]) of a chain in one computation."""
    steps = []
    for lengths in CHAIN[:count]:
        mechanism = from_values({**lengths, **COMMON}).linkage
        steps.append((mechanism, given))
        motion = mechanism.motion(*given)
        given = motion.theta4, motion.omega4, motion.alpha4
    torques, couple = [], 0.0
    for mechanism, its in reversed(steps):
        if torques:
            mechanism = mechanism.with_external(External(output=Applied(couple=couple)))
        torques.insert(0, mechanism.loads(*its).driving_torque)
        couple = -torques[0]
    return steps, torques


@pytest.mark.parametrize('count', [more(2, 4)])
def test_a_chain_is_one_computation_to_the_last_bit_and_conserves_power(run_node, client, count):
    start(run_node, count)
    inboxes = {}
    for place in range(count):
        client.listen(['loads', 'state'], node=f'node{place}')
        inboxes[place] = client.received['loads'], client.received['state']
        client.received = {}
    publisher = client.publisher(node='node0')
    for stamp, given in enumerate([(0.4, 2.0, 1.0), (1.1, -3.0, 5.0), (2.5, 4.0, 0.0)], 1):
        steps, torques = directly(count, given)
        message = Motion(position=given[0], velocity=given[1], acceleration=given[2])
        message.header.stamp = Time(sec=stamp)

        def steady(stamp=stamp, torques=torques):
            newest = [next((m for m in reversed(loads) if m.header.stamp.sec == stamp), None)
                      for loads, _ in inboxes.values()]
            return (all(newest) and [m.driving_torque for m in newest] == torques
                    and all(any(m.header.stamp.sec == stamp for m in states)
                            for _, states in inboxes.values()))

        def send(message=message, steady=steady):
            publisher.publish(message)
            client.executor.spin_once(timeout_sec=0.05)
            return steady()
        client.until(send, 'the torques of one computation, to the last bit')
        for place, (_, its) in enumerate(steps):
            state = next(m for m in reversed(inboxes[place][1]) if m.header.stamp.sec == stamp)
            assert (state.theta1, state.omega1, state.alpha1) == its
        taken = [power(mechanism, *its) for mechanism, its in steps]
        balance = torques[0] * given[1] - sum(one for one, _ in taken)
        assert abs(balance) <= 1e-12 * sum(size for _, size in taken)
