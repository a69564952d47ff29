# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Every field of every recorded message type, through the recorder and out by four readers."""
import hashlib
from itertools import count
import json
import math
from pathlib import Path
import shutil
import subprocess
import tempfile

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
from support import SUPPORT

TOPICS = [*INPUTS.values(), DRIVEN, SCENE, *OUTPUTS.values()]
# What Foxglove and Lichtblick read bags with.
NPM = ('@mcap/core@2.2.2', '@mcap/support@1.1.0', '@foxglove/rosmsg@5.0.5',
       '@foxglove/rosmsg2-serialization@3.1.0')


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


@pytest.fixture(scope='session')
def foxglove():
    """
    Return the folder of an npm project with Foxglove's readers, kept between runs.

    Skip without.
    """
    if not shutil.which('npm') or not shutil.which('node'):
        pytest.skip('node and npm are not installed')
    script = (SUPPORT / 'foxglove.mjs').read_text()
    key = hashlib.sha256(' '.join(NPM).encode()).hexdigest()[:12]
    folder = Path(tempfile.gettempdir()) / f'fourbar_npm_{key}'
    folder.mkdir(exist_ok=True)
    if not (folder / 'done').exists():
        (folder / 'package.json').write_text('{"private": true, "type": "module"}')
        done = subprocess.run(['npm', 'install', '--no-audit', '--no-fund', '--loglevel=error',
                               *NPM], cwd=folder,
                              capture_output=True, text=True, check=False)
        if done.returncode:
            pytest.skip(f'npm cannot install: {" ".join(done.stderr.split())[:200]}')
        (folder / 'done').touch()
    (folder / 'foxglove.mjs').write_text(script)
    return folder


def test_what_foxglove_reads_with_reads_every_field_as_it_was_sent(bag, foxglove):
    path, sent = bag
    done = subprocess.run(['node', 'foxglove.mjs', path / 'trip_0.mcap'], cwd=foxglove,
                          capture_output=True,
                          text=True, check=False)
    assert done.returncode == 0, done.stderr
    found = {topic: [] for topic in sent}
    for line in done.stdout.splitlines():
        item = json.loads(line)
        found[item['topic']].append(item['message'])
    assert found == sent
