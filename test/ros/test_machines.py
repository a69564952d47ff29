# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Machines of dyads through the real node: topics, services, bag, live changes."""
import random

from builtin_interfaces.msg import Time
from fourbar_msgs.msg import LinkageState, Motion
from fourbar_ros.extrema.find import find_extrema
from fourbar_ros.mechanisms.quantities import select
from fourbar_ros.pipeline.stepper import Stepper, Wanted
from fourbar_ros.scene import scene
from fourbar_ros.scene.files import read_values
from fourbar_ros.scene.topics import OUTPUTS
from support.harness import fields_of, recomputed, recording_in, set_parameters
from support.samples import some


@some('name', ['lift_table', 'jansen'], 1)
def test_topics_services_and_bag_are_those_of_the_core(name, run_node, client, tmp_path):
    parameters = {**read_values(name), 'drive.source': 'motion', 'outputs': [*OUTPUTS],
                  **recording_in(tmp_path)}
    its = scene.from_values(parameters)
    node, stepper, rng = run_node(parameters), Stepper(its), random.Random(5)
    (low, high), = its.linkage.input_ranges
    client.listen(its.topics)
    send = client.driving(position=0.5 * (low + high))
    for number in range(1, 41):
        sent = Motion(position=rng.uniform(0.98 * low + 0.02 * high, 0.02 * low + 0.98 * high),
                      velocity=rng.uniform(-5.0, 5.0), acceleration=rng.uniform(-90.0, 90.0))
        sent.header.stamp = Time(sec=number)
        send(sent)
        client.until(lambda number=number: all(heard and heard[-1].header.stamp.sec == number
                                               for heard in client.received.values()),
                     f'answer {number} on every topic')
        answers = {topic: heard[-1] for topic, heard in client.received.items()}
        status, expected = stepper.step(sent.position, sent.velocity, sent.acceleration,
                                        Wanted(True, its.topics))
        assert status == LinkageState.STATUS_OK
        for topic, message in answers.items():          # NaN is NaN here
            assert repr(fields_of(its.layout, topic, message)) == repr(
                its.layout.expected(topic, expected))
    check_meaning(answers, its.linkage, sent)
    check_services(client, its)
    assert node.stop() == 0
    found = recomputed(tmp_path / 'run')
    assert found.inputs > 40 and len({d.topic for d in found.differences}) == 1 + len(its.topics)


def check_meaning(answers, linkage, sent):
    """Compare messages with the core by the names that a user reads."""
    motion, loads = linkage.step(sent.position, sent.velocity, sent.acceleration)
    for link in linkage.LINKS:
        message, expected = answers[f'links/{link.name}'], linkage.link_motion(motion, link.name)
        assert (message.x, message.velocity_y, message.angular_velocity,
                message.angular_acceleration) == (expected.x, expected.v_y, expected.omega,
                                                  expected.alpha)
    for reaction in linkage.REACTIONS:
        wrench = answers[f'reactions/{reaction.joint}'].wrench
        assert (wrench.force.x, wrench.force.y) == (getattr(loads, f'{reaction.joint}_x'),
                                                    getattr(loads, f'{reaction.joint}_y'))
        assert wrench.torque.z == (getattr(loads, reaction.couple) if reaction.couple else 0.0)
    assert list(answers['joint_states'].name) == [joint.place for joint in linkage.JOINTS]
    state = answers['state']
    assert state.mode == linkage.mode and sent.position == (
        state.slide if linkage.is_driven_by_slide else state.theta1)


def check_services(client, its):
    """Compare the answers of the services with the core."""
    linkage, fields = its.linkage, ('quantity', 'mode', 'theta1', 'slide', 'value', 'is_global')
    reaction, rate = linkage.REACTIONS[2].joint, linkage.outputs[0].coordinate.rate
    names = [reaction, rate, 'shaking_force', *(f'{point}.speed' for point in its.points)]
    answer = client.call('find_extrema', velocity=2.0, acceleration=3.0, quantities=names)
    expected = find_extrema(linkage, select(names, linkage, its.point_quantities), 2.0, 3.0)
    assert expected and ({repr([getattr(one, name) for name in fields]) for one in answer.extrema}
                         == {repr([getattr(one, name) for name in fields]) for one in expected})
    low, high = linkage.input_ranges[0]
    middle = low + 0.55 * (high - low)
    answer = client.call('evaluate', position=middle, velocity=2.0, acceleration=-3.0)
    assert answer.result == answer.RESULT_OK and answer.has_loads
    motion, loads = linkage.step(middle, 2.0, -3.0)
    for value in answer.values:
        assert value.value == getattr(loads if value.name in loads._fields else motion, value.name)
    units = {value.name: value.unit for value in answer.values}
    assert (units[reaction], units[rate]) == ('N', 'rad/s')
    answer = client.call('evaluate', position=middle, mode=2 if linkage.mode == 1 else 1)
    assert answer.result == answer.RESULT_INVALID_REQUEST and 'mode = ' in answer.message


def test_a_dyad_is_changed_live_and_a_wrong_one_refused(run_node, client):
    parameters = {**read_values('jansen'), 'outputs': ['links']}
    run_node(parameters)
    changed = {'dyads.leg.length_2': 0.37, 'bodies.f.mass': 0.2, 'bodies.f.inertia': 0.001}
    assert set_parameters(client, changed, atomically=True)[0].successful
    answer = client.call('evaluate', position=0.7, velocity=4.0)
    found = {value.name: value.value for value in answer.values}
    motion, loads = scene.from_values({**parameters, **changed}).linkage.step(0.7, 4.0, 0.0)
    assert (found['omega_foot'], found['driving_torque']) == (motion.omega_foot,
                                                              loads.driving_torque)
    refused = set_parameters(client, {'dyads.leg.length_2': 9.0})[0]
    assert refused.reason == ('dyads.leg: cannot close at any input at which those before it do; '
                              'its rods are 0.394 and 9 m long')
    refused = set_parameters(client, {'dyads.leg.kind': 'RRP'})[0]
    assert not refused.successful
