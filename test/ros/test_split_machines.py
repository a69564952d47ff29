# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Machines split over nodes, each a process, as launch/chain.launch.py starts them.

The driving torque of the first node and the output of the last are those of the whole machine.
"""
import json

from builtin_interfaces.msg import Time
from fourbar_msgs.msg import Motion
from fourbar_ros import InvalidParameter
from fourbar_ros.scene.chain import remappings
from fourbar_ros.scene.files import read_values
from fourbar_ros.scene.scene import load
import pytest
from support import ROOT
from support.power import power

CHAINS = {'watt': ('four_bar', 'dyad'), 'quick_return': ('lever', 'ram')}
INPUTS = [(0.4, 2.0, 1.0), (2.9, -3.0, 5.0), (-1.2, 4.0, 0.0)]


def file_of(machine):
    return ROOT / f'config/chains/{machine}.yaml'


def test_every_chain_of_the_tree_is_tested():
    assert {path.stem for path in file_of('*').parent.glob('*.yaml')} == set(CHAINS)


@pytest.fixture(params=CHAINS)
def chain(request, run_node, client):
    """Return (machine, inboxes of the first node's loads and of the last one's output, send)."""
    machine, (first, *_, last) = request.param, CHAINS[request.param]
    for name, rules in remappings(file_of(machine), CHAINS[machine]).items():
        values = read_values(f'{file_of(machine)}:{name}')
        run_node(values | {'drive.source': 'motion', 'external.timeout': 0.0}, name=name,
                 remaps=[f'{one}:={other}' for one, other in rules])
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


def written(tmp_path, change):
    """Return a file of the first chain with some parameters changed: {node: {name: value}}."""
    file, machine = tmp_path / 'chain.yaml', next(iter(CHAINS))
    sections = {name: read_values(f'{file_of(machine)}:{name}') | change.get(name, {})
                for name in CHAINS[machine]}
    file.write_text(json.dumps({name: {'ros__parameters': values}
                                for name, values in sections.items()}))
    return file, CHAINS[machine]


@pytest.mark.parametrize('change, why', [
    ({'four_bar': {'outputs': ['loads']}}, 'four_bar: outputs .*must contain output'),
    ({'dyad': {'outputs': ['output']}}, 'dyad: outputs .*must contain drive_wrench'),
    ({'dyad': {'drive.source': 'timer'}}, 'dyad: drive.source .*must be motion'),
    ({'four_bar': {'external.coupler.from_topic': True}}, 'from_topic must be true of one link'),
])
def test_what_is_no_chain_is_refused_in_one_line(tmp_path, change, why):
    with pytest.raises(InvalidParameter, match=why) as caught:
        remappings(*written(tmp_path, change))
    assert '\n' not in str(caught.value)


def test_motion_alone_may_pass(tmp_path):
    file, names = written(tmp_path, {'four_bar': {'external.rocker.from_topic': False}})
    assert remappings(file, names) == {'four_bar': [], 'dyad': [('~/input', 'four_bar/output')]}


def test_names_are_relative_so_that_a_chain_can_be_in_a_namespace():
    assert remappings(file_of('watt'), CHAINS['watt']) == {
        'four_bar': [('~/external/rocker', 'dyad/drive_wrench')],
        'dyad': [('~/input', 'four_bar/output')]}
