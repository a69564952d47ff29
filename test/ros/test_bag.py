# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""A bag of a real run, and one of every type, read back by independent readers."""
from itertools import count
import json
import math
from pathlib import Path
import signal
from types import SimpleNamespace
from unittest.mock import MagicMock

from ament_index_python.packages import get_package_share_directory
from diagnostic_msgs.msg import DiagnosticStatus
from fourbar_ros.bag.overview import info
from fourbar_ros.bag.reader import records
from fourbar_ros.bag.recorder import BagWriter
from fourbar_ros.errors import BagError, NameTaken
from fourbar_ros.ros.messages import resolve
from fourbar_ros.ros.node.recording import about_of, Recording
from fourbar_ros.ros.schemas import channel as channel_of
from fourbar_ros.ros.schemas import definition, type_hash
from fourbar_ros.scene.scene import from_values
from fourbar_ros.scene.topics import DRIVEN, INPUTS, OUTPUTS, SCENE
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
import pytest
from rclpy.serialization import serialize_message
from rosbags.highlevel import AnyReader
from rosbags.rosbag2 import Reader
from rosbags.typesys import get_types_from_msg, get_typestore, Stores
from support.harness import ALL_OUTPUTS, Client, NodeProcess, recording_in
from support.scenes import PAPER, RODS
import yaml


@pytest.fixture(scope='module')
def bag(tmp_path_factory):
    """Return (directory of a bag, messages heard while it was written)."""
    folder, client = tmp_path_factory.mktemp('node'), Client()
    node = NodeProcess({**PAPER, **RODS, 'drive.speed': 25.0, 'drive.rate': 200.0,
                        'outputs': ALL_OUTPUTS,
                        'recording.directory': str(folder / 'deep/bags')}, folder)
    client.listen()
    client.until(lambda: all(client.received.values()), 'the stream')
    # says that there is none: both sides know each other now
    client.call('stop_recording')
    answer = client.call('start_recording', name='run')
    assert answer.success and answer.path == str(folder / 'deep/bags/run')
    count = len(client.received['state'])
    client.until(lambda: len(client.received['state']) > count + 100, '100 more samples')
    answer = client.call('stop_recording')
    assert answer.success and answer.message == str(folder / 'deep/bags/run')
    assert node.stop(signal.SIGINT) == 0
    client.close()
    return folder / 'deep/bags/run', client.received


def plain(message, skip=('__msgtype__',)):
    """Return a message of any library as nested plain values, NaN as text."""
    if hasattr(message, 'get_fields_and_field_types'):
        return {name: plain(getattr(message, name))
                for name in message.get_fields_and_field_types()}
    if type(message) is SimpleNamespace:
        return {name: plain(value) for name, value in vars(message).items()}
    if hasattr(message, '__dataclass_fields__'):
        return {name: plain(getattr(message, name)) for name in message.__dataclass_fields__
                if name not in skip and not name.isupper()}
    if hasattr(message, '__slots__') and not isinstance(message, (str, bytes)):
        return {name.lstrip('_'): plain(getattr(message, name)) for name in message.__slots__}
    if hasattr(message, '__len__') and not isinstance(message, str):
        return [plain(item) for item in message]
    return 'NaN' if isinstance(message, float) and math.isnan(message) else message


def test_rosbags_reads_the_directory_and_every_value_is_what_was_received(bag):
    path, heard = bag
    by_stamp = {(name, m.header.stamp.sec, m.header.stamp.nanosec): plain(m)
                for name, messages in heard.items() for m in messages}
    compared = dict.fromkeys(heard, 0)
    for source in (path, path / 'run_0.mcap'):
        with AnyReader([source], default_typestore=None) as reader:
            topics = {connection.topic: connection for connection in reader.connections}
            assert set(topics) == {'/fourbar/driven', '/fourbar/scene', '/joint_states',
                                   '/fourbar/state', '/fourbar/output',
                                   '/fourbar/loads', '/fourbar/shaking_wrench',
                                   '/fourbar/drive_wrench', '/fourbar/equation',
                                   '/fourbar/inertia'}
            for connection, _, data in reader.messages():
                name = connection.topic.rsplit('/', 1)[-1]
                message = reader.deserialize(data, connection.msgtype)
                if name == 'scene':
                    assert json.loads(message.data)['linkage.a1'] == 0.4
                    continue
                stamp = message.header.stamp
                if (key := (name, stamp.sec, stamp.nanosec)) in by_stamp:
                    assert plain(message) == by_stamp[key]
                    compared[name] += 1
    assert min(compared.values()) >= 150


def test_the_file_is_what_the_mcap_library_and_rosbag2_expect(bag):
    path, _ = bag
    with open(path / 'run_0.mcap', 'rb') as file:
        reader = make_reader(file, validate_crcs=True)
        summary = reader.get_summary()
        assert reader.get_header().profile == 'ros2'
        counts = {summary.channels[i].topic: n
                  for i, n in summary.statistics.channel_message_counts.items()}
        times, sequences = [], {}
        for _, channel, message in reader.iter_messages(log_time_order=False):
            times.append(message.log_time)
            assert message.sequence == sequences.get(channel.topic, 0)          # no gap
            sequences[channel.topic] = message.sequence + 1
    assert counts == sequences and counts.pop('/fourbar/scene') == 1
    assert len(set(counts.values())) == 1 and min(counts.values()) >= 100
    assert times == sorted(times)
    for channel in summary.channels.values():
        qos, = yaml.safe_load(channel.metadata['offered_qos_profiles'])
        durability = 'transient_local' if channel.topic == '/fourbar/scene' else 'volatile'
        assert (qos['history'], qos['reliability'], qos['durability']) == ('keep_last', 'reliable',
                                                                           durability)
        assert (channel.metadata['topic_type_hash'].startswith('RIHS01_')
                and channel.message_encoding == 'cdr')
    about = yaml.safe_load((path / 'metadata.yaml').read_text())['rosbag2_bagfile_information']
    assert (about['version'], about['storage_identifier']) == (9, 'mcap')
    assert about['message_count'] == 1 + sum(counts.values()) == summary.statistics.message_count
    assert about['starting_time']['nanoseconds_since_epoch'] == min(times)
    assert about['duration']['nanoseconds'] == max(times) - min(times)
    with Reader(path) as strict:
        assert strict.message_count == 1 + sum(counts.values())


@pytest.mark.parametrize('package', ['fourbar_msgs', 'geometry_msgs', 'sensor_msgs',
                                     'diagnostic_msgs', 'rcl_interfaces'])
def test_definitions_of_installed_messages_hash_as_an_independent_parser_computes(package):
    """Constants, bounds, defaults, nested types of its own and of other packages."""
    names = [f'{package}/msg/{file.stem}'
             for file in Path(get_package_share_directory(package)).glob('msg/*.msg')]
    assert names
    for name in names:
        store = get_typestore(Stores.EMPTY)
        store.register(get_types_from_msg(definition(name), name))
        assert store.hash_rihs01(name) == type_hash(name), name


def test_recording_refuses_with_a_reason_and_the_stream_goes_on(run_node, client, tmp_path):
    run_node({**PAPER, 'outputs': ['state'], 'recording.directory': str(tmp_path / 'bags')})
    client.listen(['state'])
    answer = client.call('stop_recording')
    assert not answer.success and answer.message == 'not recording'
    for name in ('../escape', 'a/b', '..', '/abs'):
        answer = client.call('start_recording', name=name)
        assert not answer.success and 'plain name' in answer.message
    assert client.call('start_recording', name='once').success
    answer = client.call('start_recording', name='twice')
    assert not answer.success and 'already recording' in answer.message
    assert client.call('stop_recording').success
    answer = client.call('start_recording', name='once')
    assert not answer.success and 'exists already' in answer.message
    fresh = client.call('start_recording')
    assert fresh.success and fresh.path.startswith(str(tmp_path / 'bags/fourbar_'))
    client.received['state'].clear()
    client.until(lambda: len(client.received['state']) > 20, 'the stream')
    assert sorted(p.name for p in tmp_path.iterdir()) == ['bags', 'fourbar.yaml']


@pytest.mark.slow
def test_a_name_that_is_taken_does_not_stop_the_node_it_records_under_the_next_free_one(
        run_node, client, diagnosed, tmp_path):
    for name in ('run', 'run_2'):
        (tmp_path / 'bags' / name).mkdir(parents=True)
    node = run_node({**PAPER, 'outputs': ['state'], **recording_in(tmp_path / 'bags')})
    client.until(lambda: diagnosed.messages, 'diagnostics')
    assert diagnosed()[1]['recording'] == str(tmp_path / 'bags/run_3')
    assert node.stop(signal.SIGINT) == 0
    found = info(tmp_path / 'bags/run_3')
    assert found.is_sound and found.ended == 'the node ended by SIGINT'
    assert not any(list((tmp_path / 'bags' / name).iterdir()) for name in ('run', 'run_2'))


def test_nodes_that_start_at_once_take_a_name_each(tmp_path):
    """Another node takes the free name after this one has found it."""
    scene = from_values({**PAPER, **recording_in(tmp_path)})
    recording, others = Recording(MagicMock()), ['run', 'run_2']

    def start(name):
        for other in others[:1]:
            (tmp_path / others.pop(0)).mkdir()
        recording.attach((BagWriter(tmp_path, name, [], {}), {}))
    recording.begin(scene, start)
    assert recording.report()[0]['recording'] == str(tmp_path / 'run_3')
    recording.close(recording.detach(), 'the test ended')
    (tmp_path / 'file').touch()
    with pytest.raises(BagError) as refused:         # no name is free there
        BagWriter(tmp_path / 'file', 'run', [], {})
    assert not isinstance(refused.value, NameTaken)


@pytest.mark.slow
def test_where_nothing_can_be_recorded_the_node_streams_and_says_so(run_node, client, diagnosed,
                                                                    tmp_path):
    (tmp_path / 'file').write_text('')
    node = run_node({**PAPER, 'outputs': ['state'], 'recording.start': True,
                     'recording.directory': str(tmp_path / 'file/below')})
    client.listen(['state'])
    client.until(lambda: len(client.received['state']) > 20, 'the stream')
    client.until(lambda: diagnosed.messages, 'diagnostics')
    status, values = diagnosed()
    assert status.level == DiagnosticStatus.ERROR and values['recording'] == 'off'
    assert 'not recording' in status.message and str(tmp_path / 'file/below') in status.message
    assert node.stop(signal.SIGINT) == 0


# --- every field of every recorded type ----------------------------------------------------------

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


def test_no_scene_is_recorded_that_no_reader_takes(tmp_path):
    many = from_values({**PAPER, **{f'points.p{k}.link': 'output' for k in range(1000)}})
    with pytest.raises(BagError, match='a scene with 10.. names .* a bag may have 1000'):
        about_of(many, {}, '/fourbar')
    most = from_values({**PAPER, **{f'points.p{k}.link': 'output' for k in range(980)}})
    assert json.loads(about_of(most, {}, '/fourbar')['scene'])['points.p979.link'] == 'output'


@pytest.fixture(scope='module')
def trip(tmp_path_factory):
    """Return (path of a bag with every type, {topic: [message, ...]} as sent)."""
    names = [f'/test/{topic.name}' for topic in TOPICS]
    writer = BagWriter(tmp_path_factory.mktemp('round'), 'trip',
                       [channel_of(t, n) for t, n in zip(TOPICS, names)], {})
    sent, numbers = {name: [] for name in names}, count(1)
    for nan_at in (0, 3, 1):
        for i, topic in enumerate(TOPICS):
            message = fill(resolve(topic.type)(), numbers, nan_at)
            sent[names[i]].append(plain(message))
            writer.write(i, serialize_message(message))
    return writer.close(), sent


def test_ours_mcap_and_rosbags_read_every_field_as_it_was_sent(trip):
    path, sent = trip
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
