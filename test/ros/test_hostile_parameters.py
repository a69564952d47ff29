# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
No live change of a parameter ends a node: it is taken, or refused with the reason.

``make soak`` tries values of every scene, for SOAK_MINUTES together.
"""
import os
import random
import time

from fourbar_ros.ros.messages import resolve
from fourbar_ros.scene.files import folder
from fourbar_ros.scene.parameters import find_parameter, of_name
from fourbar_ros.scene.scene import load
from fourbar_ros.scene.topics import full_name, OUTPUTS
import pytest
from rcl_interfaces.srv import ListParameters
import rclpy
from support.harness import ALL_OUTPUTS, set_parameters
from support.strategies import hostile

MINUTES = float(os.environ.get('SOAK_MINUTES', '0'))
SCENES = (sorted(file.stem for file in folder().glob('*.yaml')) if MINUTES
          else ['paper', 'cylinder', 'engine', 'jansen', 'motor'])
SOME = 150             # changes at least
MEMORY = 6 << 30       # [B] more than any change may take
LIMITED = f'import resource; resource.setrlimit(resource.RLIMIT_AS, ({MEMORY},) * 2)'


@pytest.fixture
def hearing(client):
    """Return a node whose subscriptions are never taken from."""
    node = rclpy.create_node('hearing')
    yield node
    node.destroy_node()


def start(run_node, client, hearing, given, **more):
    """
    Start a node; return it when it answers. Each of its topics has a subscriber.

    No executor takes their messages. Taken by that of the client, they stand in one queue with
    the answers: on a loaded machine 5000 messages a second kept an answer of the node waiting for
    two minutes.
    """
    node = run_node({**given, 'recording.directory': 'bags'}, first=LIMITED, **more)
    for name in ALL_OUTPUTS:
        hearing.create_subscription(resolve(OUTPUTS[name].type),
                                    full_name(OUTPUTS[name].topic, 'fourbar'),
                                    lambda message: None, 1)
    client.call('evaluate', position=0.5)
    return node


def attack(client, node, values, until, seed):
    """
    Set hostile values one by one; those that are taken pile up, and are taken back now and then.

    Return how many were taken, of how many.
    """
    rng, count, taken = random.Random(seed), 0, 0
    declared = [name for name in client.ask(ListParameters).result.names
                if (parameter := find_parameter(name)) and parameter.live]

    def put(values):
        return set_parameters(client, values, atomically=True)[0]
    while not until(count):
        name = rng.choice(declared)
        value = hostile(rng, name)
        result = put({name: value})
        assert result.successful or result.reason and 'fault' not in result.reason, (
            name, value, result.reason, node.said)
        taken, count = taken + result.successful, count + 1
        if count % 10 == 0 or until(count):
            back = put({name: values[name] for name in declared})
            assert back.successful, back.reason
        assert node.process.poll() is None, node.said
    return taken, count


@pytest.mark.slow
@pytest.mark.parametrize('name', SCENES)
def test_hostile_values_of_every_scene(run_node, client, hearing, name):
    scene = load(name)
    given = {key: value for key, value in scene.values.items()
             if value == value and value != of_name(key).default}
    node = start(run_node, client, hearing, {**given, 'recording.start': False})
    end = time.monotonic() + MINUTES * 60.0 / len(SCENES)
    taken, count = attack(client, node, scene.values,
                          lambda count: count >= SOME and time.monotonic() > end, name)
    print(f'{name}: {count} changes, {taken} taken')
    assert 0 < taken < count
