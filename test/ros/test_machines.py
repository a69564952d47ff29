# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Machines of dyads through the real node: topics, services, bag, live changes, 500 Hz."""
from fourbar_msgs.msg import LinkageState
from fourbar_ros.mechanisms.quantities import select
from fourbar_ros.scene import scene
from fourbar_ros.scene.files import read_values
import pytest
from support.exchange import BY_MESSAGES, check_bag, check_extrema, check_topics
from support.harness import set_parameters
from support.samples import some

ALL = ['state', 'output', 'joint_states', 'loads', 'shaking_wrench', 'drive_wrench', 'links',
       'reactions', 'points']


@some('name', ['lift_table', 'jansen'], 1)
def test_topics_services_and_bag_are_those_of_the_core(name, run_node, client, tmp_path):
    parameters = {**read_values(name), **BY_MESSAGES, 'outputs': ALL}
    its = scene.from_values(parameters)
    run_node(parameters)
    inputs = check_topics(client, its)
    check_meaning(client.received, its, inputs[-1])
    check_services(client, its)
    assert client.call('stop_recording').success
    check_bag(tmp_path / 'bags/run', its, len(inputs))


def check_meaning(received, its, sent):
    """Compare the last messages with the core by the names that a user reads."""
    motion, loads = its.linkage.step(sent.position, sent.velocity, sent.acceleration)
    for link in its.linkage.LINKS:
        message = received[f'links/{link.name}'][-1]
        expected = its.linkage.link_motion(motion, link.name)
        assert (message.x, message.velocity_y, message.angular_velocity,
                message.angular_acceleration) == (expected.x, expected.v_y, expected.omega,
                                                  expected.alpha)
    for reaction in its.linkage.REACTIONS:
        wrench = received[f'reactions/{reaction.joint}'][-1].wrench
        assert (wrench.force.x, wrench.force.y) == (getattr(loads, f'{reaction.joint}_x'),
                                                    getattr(loads, f'{reaction.joint}_y'))
        assert wrench.torque.z == (getattr(loads, reaction.couple) if reaction.couple else 0.0)
    joints = received['joint_states'][-1]
    assert list(joints.name) == [joint.place for joint in its.linkage.JOINTS]
    state, driven = received['state'][-1], sent.position
    assert (state.slide if its.linkage.is_driven_by_slide else state.theta1) == driven
    assert state.mode == its.linkage.mode


def check_services(client, its):
    """Compare the answers of the services with the core."""
    linkage = its.linkage
    names = [linkage.REACTIONS[2].joint, linkage.outputs[0].coordinate.rate, 'shaking_force',
             *(f'{point}.speed' for point in its.points)]
    check_extrema(client, linkage, select(names, linkage, its.point_quantities), quantities=names)
    low, high = linkage.input_ranges[0]
    middle = low + 0.55 * (high - low)
    answer = client.call('evaluate', position=middle, velocity=2.0, acceleration=-3.0)
    assert answer.result == answer.RESULT_OK and answer.has_loads
    motion, loads = linkage.step(middle, 2.0, -3.0)
    for value in answer.values:
        assert value.value == getattr(loads if value.name in loads._fields else motion, value.name)
    named = {value.name: value.unit for value in answer.values}
    assert named[linkage.REACTIONS[2].joint] == 'N'
    assert named[linkage.outputs[0].coordinate.rate] == 'rad/s'
    answer = client.call('evaluate', position=middle, mode=2 if linkage.mode == 1 else 1)
    assert answer.result == answer.RESULT_INVALID_REQUEST and 'mode = ' in answer.message


def test_a_dyad_is_changed_live_and_a_wrong_one_refused(run_node, client):
    parameters = {**read_values('jansen'), 'outputs': ['links']}
    run_node(parameters)
    client.listen({name: topic for name, topic in scene.from_values(parameters).topics.items()
                   if name in ('links/foot', 'links/crank')})
    client.until(lambda: client.received['links/foot'], 'the stream')
    changed = {'dyads.leg.length_2': 0.37, 'bodies.f.mass': 0.2, 'bodies.f.inertia': 0.001}
    assert set_parameters(client, changed, atomically=True)[0].successful
    its = scene.from_values({**parameters, **changed})
    before = len(client.received['links/foot'])
    client.until(lambda: len(client.received['links/foot']) > before + 50
                 and len(client.received['links/crank']) > before + 60, 'the other leg')
    message = client.received['links/foot'][-1]
    crank = next(m for m in client.received['links/crank']
                 if m.header.stamp == message.header.stamp)
    expected = its.linkage.motion(crank.angle, 4.0)
    assert its.linkage.bodies.f.mass == 0.2 and message.status == LinkageState.STATUS_OK
    assert message.angular_velocity == pytest.approx(expected.omega_foot, abs=1e-9)
    refused = set_parameters(client, {'dyads.leg.length_2': 9.0})[0]
    assert refused.reason == ('dyads.leg: cannot close at any input at which those before it do')
    refused = set_parameters(client, {'dyads.leg.kind': 'RRP'})[0]
    assert not refused.successful
