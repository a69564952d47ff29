# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Springs, dampers, tables and friction through the real node: topics, services and the bag."""
from builtin_interfaces.msg import Time
from fourbar_msgs.msg import LinkageState, Motion
from fourbar_ros.extrema.find import find_extrema
from fourbar_ros.scene import scene
from support.acting import CASES, inputs_of, RUBBING, values_of
from support.harness import recomputed, recording_in
from support.samples import some

OUTPUTS = ['state', 'loads', 'shaking_wrench', 'reactions']
QUICK = ['slider_crank, all', *RUBBING[:1]]


@some('case', [*CASES, *RUBBING], QUICK)
def test_topics_services_and_bag_are_those_of_the_core(case, run_node, client, tmp_path):
    parameters = {**values_of(case), 'drive.source': 'motion', 'outputs': OUTPUTS,
                  **recording_in(tmp_path)}
    there = scene.from_values(parameters)
    linkage, speed = there.linkage, there.drive.speed
    node = run_node(parameters)
    client.listen(there.topics)
    send = client.driving(position=sum(linkage.input_ranges[0]) / 2)
    for number, (position, rate, acceleration) in enumerate(
            inputs_of(linkage, speed)[:12].tolist(), 1):
        sent = Motion(position=position, velocity=rate, acceleration=acceleration)
        sent.header.stamp = Time(sec=number)
        send(sent)
        client.until(lambda number=number: all(
            heard and heard[-1].header.stamp.sec == number
            for heard in client.received.values()), f'answer {number} on every topic')
        heard = {topic: messages[-1] for topic, messages in client.received.items()}
        assert heard['state'].status == LinkageState.STATUS_OK
        loads = linkage.loads(position, rate, acceleration)
        for name in (linkage.drive_load, 'driving_power'):
            assert getattr(heard['loads'], name) == getattr(loads, name)
        shaking = heard['shaking_wrench'].wrench
        assert (shaking.force.x, shaking.force.y, shaking.torque.z) == (
            loads.shaking_force_x, loads.shaking_force_y, loads.shaking_moment)
        for reaction in linkage.REACTIONS:
            force = heard[f'reactions/{reaction.joint}'].wrench.force
            assert (force.x, force.y) == (getattr(loads, reaction.x), getattr(loads, reaction.y))
    names = [linkage.drive_load, linkage.REACTIONS[1].magnitude]
    answer = client.call('find_extrema', velocity=speed, quantities=names)
    expected = [found for name in names for found in find_extrema(linkage, name, speed)]
    assert [(found.quantity, found.value) for found in answer.extrema] == [
        (found.quantity, found.value) for found in expected] and expected
    assert node.stop() == 0
    assert recomputed(tmp_path / 'run').inputs >= 12
