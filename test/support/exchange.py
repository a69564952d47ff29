# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Inputs sent to a real node, and all that it answers and records compared with the core."""
import random

from fourbar_lab.clients.node_client import name_on
from fourbar_msgs.msg import LinkageState, Motion
from fourbar_ros.bag.recomputation import recompute
from fourbar_ros.extrema.find import find_extrema
from fourbar_ros.pipeline.stepper import Stepper
from support.harness import fields_of

# what makes a node answer messages and record
BY_MESSAGES = {'drive.source': 'motion', 'drive.timeout': 0.0, 'recording.start': True,
               'recording.name': 'run'}


def inputs_of(linkage, count):
    """Return random inputs inside the range, in messages."""
    rng = random.Random(5)
    messages = []
    for k in range(count):
        low, high = rng.choice(linkage.input_ranges)
        message = Motion(position=rng.uniform(low + 0.02 * (high - low),
                                              high - 0.02 * (high - low)),
                         velocity=rng.uniform(-5.0, 5.0), acceleration=rng.uniform(-90.0, 90.0))
        message.header.stamp.sec = k + 1
        messages.append(message)
    return messages


def check_topics(client, its, count=40):
    """Send inputs and compare every message of every topic with the core; return the inputs."""
    stepper = Stepper(its)
    client.listen(its.topics)
    publisher, (first, *inputs) = client.publisher(), inputs_of(its.linkage, count + 1)
    client.handshake(lambda: publisher.publish(first))

    def answers(messages):
        """Return them without those of the handshake, which may come late."""
        return [message for message in messages if message.header.stamp != first.header.stamp]
    for k, message in enumerate(inputs):        # one by one: no queue is too short
        publisher.publish(message)
        client.until(lambda k=k: all(len(answers(m)) > k
                                     for m in client.received.values()),
                     f'answer {k} on every topic')
    for topic, messages in client.received.items():
        for sent, message in zip(inputs, answers(messages)):
            status, expected = stepper.step(sent.position, sent.velocity, sent.acceleration, True,
                                            True)
            assert status == LinkageState.STATUS_OK and message.header.stamp == sent.header.stamp
            # NaN is NaN here
            assert repr(fields_of(its.layout, topic,
                                  message)) == repr(its.layout.expected(topic, expected))
    return inputs


def check_extrema(client, linkage, expected_of, **request):
    """Return the answer of the service and the extrema of the core, compared with each other."""
    answer = client.call('find_extrema', velocity=2.0, acceleration=3.0, **request)
    assert answer.result == answer.RESULT_OK, answer.message
    expected = find_extrema(linkage, expected_of, 2.0, 3.0)
    fields = ('quantity', 'mode', 'theta1', 'slide', 'value', 'is_global')
    assert expected and ({repr([getattr(e, f) for f in fields]) for e in answer.extrema}
                         == {repr([getattr(e, f) for f in fields]) for e in expected})
    return answer, expected


def check_bag(folder, its, count):
    """Recompute the bag: every topic is in it, more inputs than ``count``, no difference."""
    found = recompute(folder)
    topics = {name_on('fourbar', topic) if topic.topic[0] == '~' else f'/{topic.topic}'
              for topic in its.topics.values()}
    assert found.inputs > count and found.unmatched == 0
    assert {d.topic for d in found.differences} - {'/fourbar/driven'} == topics
    assert max(d.largest for d in found.differences) == 0.0
