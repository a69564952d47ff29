# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Machines split over nodes, each a process, as examples/nodes/*.launch.yaml start them.

The driving torque of the first node and the output of the last are those of the whole machine.
"""
from builtin_interfaces.msg import Time
from fourbar_msgs.msg import Motion
from fourbar_ros.scene.files import read_values
from fourbar_ros.scene.scene import load
import pytest
from ros.test_launch_files import EXAMPLES, nodes_of
from support.power import power

MACHINES = 'watt', 'quick_return'
INPUTS = [(0.4, 2.0, 1.0), (2.9, -3.0, 5.0), (-1.2, 4.0, 0.0)]


@pytest.fixture(params=MACHINES)
def chain(request, run_node, client):
    """Return (machine, inboxes of the first node's loads and of the last one's output, send)."""
    machine = request.param
    nodes = nodes_of(EXAMPLES / f'{machine}.launch.yaml')
    for node in nodes:
        values = read_values(f'{EXAMPLES / machine}.yaml:{node["name"]}')
        run_node(values | {'drive.source': 'motion', 'external.timeout': 0.0}, name=node['name'],
                 remaps=[f'{rule["from"]}:={rule["to"]}' for rule in node['remap']])
    first, last = nodes[0]['name'], nodes[-1]['name']
    client.listen(['loads'], node=first)
    client.listen(['output'], node=last)
    publisher = client.publisher(node=first)
    return machine, client.received, publisher.publish


def newest(messages, stamp):
    return [message for message in messages if message.header.stamp.sec == stamp]


def test_a_split_machine_is_the_whole_one(chain, client):
    machine, received, publish = chain
    whole = load(machine).linkage
    coordinate = whole.outputs[0].coordinate
    for stamp, given in enumerate(INPUTS, 1):
        message = Motion(position=given[0], velocity=given[1], acceleration=given[2])
        message.header.stamp = Time(sec=stamp)
        motion, loads = whole.step(*given)
        bound = 1e-12 * max(1.0, motion.condition)
        allowed = bound * power(whole, *given)[1] / abs(given[1])

        def settled(stamp=stamp, message=message, loads=loads, allowed=allowed):
            """Send a pose until the wrench that it causes acts, a step later at the earliest."""
            publish(message)
            client.executor.spin_once(timeout_sec=0.05)
            return newest(received['output'], stamp) and any(
                abs(m.driving_torque - loads.driving_torque) <= allowed
                for m in newest(received['loads'], stamp))
        client.until(settled, 'the torque of the whole machine')
        output = newest(received['output'], stamp)[-1]
        for field, name in zip(('position', 'velocity', 'acceleration'), coordinate):
            want = getattr(motion, name)
            assert abs(getattr(output, field) - want) <= bound * max(1.0, abs(want))
