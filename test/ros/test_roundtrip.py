# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Every field of every recorded message type, through the recorder and out by three readers."""
from itertools import count
import math

from fourbar_ros.bag.reader import records
from fourbar_ros.bag.recorder import BagWriter
from fourbar_ros.ros.messages import resolve
from fourbar_ros.ros.schemas import channel
from fourbar_ros.scene.topics import DRIVEN, INPUTS, OUTPUTS, SCENE
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
import pytest
from rclpy.serialization import serialize_message
from ros.test_bag import plain
from rosbags.highlevel import AnyReader

TOPICS = [*INPUTS.values(), DRIVEN, SCENE, *OUTPUTS.values()]


def fill(message, numbers, nan_at):
    """Give every field a value of its own, not zero; every ``nan_at``-th float is NaN."""
    for name, kind in message.get_fields_and_field_types().items():
        if hasattr(getattr(message, name), 'get_fields_and_field_types'):
            fill(getattr(message, name), numbers, nan_at)
        else:
            setattr(message, name, value_of(kind, numbers, nan_at))
    return message


def value_of(kind, numbers, nan_at):
    if kind.startswith('sequence<'):
        return [value_of(kind[9:-1], numbers, nan_at) for _ in range(3)]
    number = next(numbers)
    if kind == 'string':
        return f'text {number} é'
    if kind == 'double':
        return math.nan if nan_at and number % nan_at == 0 else number + 0.1
    return number % 120 + 1


@pytest.fixture(scope='module')
def bag(tmp_path_factory):
    """Return (path of a bag with every type, {topic: [message, ...]} as sent)."""
    names = [f'/test/{topic.name}' for topic in TOPICS]
    writer = BagWriter(tmp_path_factory.mktemp('round'), 'trip',
                       [channel(t, n) for t, n in zip(TOPICS, names)], {})
    sent, numbers = {name: [] for name in names}, count(1)
    for nan_at in (0, 3, 1):
        for i, topic in enumerate(TOPICS):
            message = fill(resolve(topic.type)(), numbers, nan_at)
            sent[names[i]].append(plain(message))
            writer.write(i, serialize_message(message))
    return writer.close(), sent


def test_ours_mcap_and_rosbags_read_every_field_as_it_was_sent(bag):
    path, sent = bag
    values = [v for messages in sent.values() for v in flat(messages[0])]
    assert len(set(map(str, values))) > 100 and 0 not in values and '' not in values
    assert any(v == 'NaN' for messages in sent.values() for m in messages for v in flat(m))
    ours, theirs, others = ({topic: [] for topic in sent} for _ in range(3))
    for record in records(path):
        ours[record.topic].append(plain(record.message))
    with open(path / 'trip_0.mcap', 'rb') as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        for item in reader.iter_decoded_messages():
            theirs[item.channel.topic].append(plain(item.decoded_message))
    with AnyReader([path]) as reader:
        for connection, _, data in reader.messages():
            others[connection.topic].append(plain(reader.deserialize(data, connection.msgtype)))
    assert ours == sent
    assert theirs == sent
    assert others == sent


def flat(value):
    if isinstance(value, dict):
        return [leaf for child in value.values() for leaf in flat(child)]
    return ([leaf for child in value for leaf in flat(child)] if isinstance(value, list)
            else [value])
