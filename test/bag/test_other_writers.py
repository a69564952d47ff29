# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
One run, written by other writers of MCAP with every option: each verb reads all of it or refuses.

Statistics, indexes and metadata.yaml that say something else than the file are found.
"""
from functools import reduce
from itertools import combinations
from operator import or_
from re import escape
from struct import pack_into
from zlib import crc32

from bag.test_reader import records_of
from fourbar_ros.bag import metadata
from fourbar_ros.bag.comparison import diff
from fourbar_ros.bag.overview import info
from fourbar_ros.bag.reader import Bag, CONTENT, records
from fourbar_ros.bag.recomputation import recompute
from fourbar_ros.bag.recovery import recover
from fourbar_ros.bag.tables import export
from fourbar_ros.cli.main import main
from fourbar_ros.errors import BagError
from mcap.opcode import Opcode
from mcap.records import Attachment
from mcap.writer import CompressionType, IndexType, Writer
import pytest
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin
from rosbags.rosbag2 import Writer as RosbagsWriter
from support import bags
from support.scenes import PAPER
import zstandard

MOTIONS = 40
KINDS = [kind for kind in IndexType if kind not in (IndexType.NONE, IndexType.ALL)]
INDEXES = {'+'.join(kind.name for kind in some) or 'NONE': reduce(or_, some, IndexType.NONE)
           for count in range(len(KINDS) + 1) for some in combinations(KINDS, count)}
NO_SUMMARY = {'index_types': IndexType.NONE, 'repeat_channels': False, 'repeat_schemas': False,
              'use_statistics': False, 'use_summary_offsets': False}
ALL = IndexType.ALL
# rosbag2's presets and options of its storage, and what they are for the library mcap
ROSBAG2 = {
    'fastwrite': {'use_chunking': False, 'enable_crcs': False},
    'zstd_fast': {'enable_crcs': False},
    'zstd_small': {'chunk_size': 4 * 2**20},
    'noChunking': {'use_chunking': False},
    'noChunkCRC': {'enable_crcs': False},
    'enableDataCRC': {'enable_data_crcs': True},
    'noMessageIndex': {'index_types': ALL & ~IndexType.MESSAGE},
    'noChunkIndex': {'index_types': ALL & ~IndexType.CHUNK},
    'noMetadataIndex': {'index_types': ALL & ~IndexType.METADATA},
    'noStatistics': {'use_statistics': False},
    'noSummaryOffsets': {'use_summary_offsets': False},
    'noRepeatedChannels': {'repeat_channels': False},
    'noRepeatedSchemas': {'repeat_schemas': False},
    'noSummary': NO_SUMMARY,
    'noSummary, noChunking': {**NO_SUMMARY, 'use_chunking': False}}
MCAP = {**{f'rosbag2 {name}': options for name, options in ROSBAG2.items()},
        **{f'compression {kind.name}': {'compression': kind} for kind in CompressionType},
        **{f'{"chunks" if chunks else "no chunks"}, index {name}': {
            'use_chunking': chunks, 'index_types': kinds}
           for chunks in (True, False) for name, kinds in INDEXES.items()}}
FOXGLOVE = {'default': {}, 'no compression': {'compression': None},
            **{name: {name: False} for name in (
                'use_chunks', 'emit_statistics', 'emit_summary_offsets', 'emit_message_indexes',
                'emit_chunk_indexes', 'repeat_channels', 'repeat_schemas',
                'calculate_data_section_crc', 'calculate_summary_section_crc')},
            # without those of chunks, 0.30.3 writes a wrong one of the data
            'no CRC': {'calculate_chunk_crcs': False, 'calculate_data_section_crc': False},
            'disable_seeking': {'disable_seeking': True}}


@pytest.fixture(scope='module')
def run(tmp_path_factory):
    """Return the path of a run as our recorder writes it."""
    return bags.run(tmp_path_factory.mktemp('other'), 'run', {
        **PAPER, 'outputs': ['state', 'joint_states'], 'drive.source': 'motion'},
        [(0.05 * k, 25.0, 0.1) for k in range(MOTIONS)], paced=True)


def content(path):
    return sorted((raw.topic, raw.time, raw.data) for raw in Bag(path).raw())


def attachments(path):
    bag = Bag(path)
    return [record for index in range(len(bag.files)) for records in bag.contents(index, CONTENT)
            for record in records if isinstance(record, Attachment)]


def by_mcap(run, path, messages=None, about=None, **options):
    """Write a run again, or some of its messages, with the library mcap; metadata in between."""
    bag = Bag(run)
    with open(path, 'wb') as stream:
        writer = Writer(stream, **{'chunk_size': 2000, **options})
        writer.start('ros2', 'test')
        writer.add_metadata('mine', {'key': 'value'})
        if about:
            writer.add_metadata(metadata.RECORD, {metadata.KEY: metadata.dumped(about)})
        channels = {topic: writer.register_channel(topic, 'cdr', writer.register_schema(
            kind, 'ros2msg', bags.text_of(kind).encode())) for topic, kind in bag.types.items()}
        for raw in messages or bag.raw():
            writer.add_message(channels[raw.topic], raw.time, raw.data, raw.time)
        writer.add_attachment(1, 1, 'a', 'text/plain', b'some' * 100)
        writer.finish()
    return path


def by_rosbags(run, folder, mode, version):
    """Write a run again with the library rosbags."""
    bag, writer = Bag(run), RosbagsWriter(folder, version=version,
                                          storage_plugin=StoragePlugin.MCAP)
    writer.set_compression(mode, CompressionFormat.ZSTD)
    with writer:
        connections = {topic: writer.add_connection(topic, kind, typestore=bags.STORE)
                       for topic, kind in bag.types.items()}
        for raw in bag.raw():
            writer.write(connections[raw.topic], raw.time, raw.data)
    return folder


def by_foxglove(run, path, options):
    """Write a run again with foxglove-sdk."""
    foxglove = pytest.importorskip('foxglove')
    from foxglove.mcap import MCAPWriteOptions
    bag, context = Bag(run), foxglove.Context()
    with foxglove.open_mcap(path, context=context, writer_options=MCAPWriteOptions(
            profile='ros2', **{'chunk_size': 2000, **options})):
        channels = {topic: foxglove.Channel(
            topic, message_encoding='cdr', context=context, schema=foxglove.Schema(
                name=kind, encoding='ros2msg', data=bags.text_of(kind).encode()))
                    for topic, kind in bag.types.items()}
        for raw in bag.raw():
            channels[raw.topic].log(raw.data, log_time=raw.time)
    return path


def assert_all_is_read(path, run, tmp_path):
    """Assert that every verb sees every message of the run in another file or folder of it."""
    everything = content(run)
    for check in (True, False):
        found = info(path, check)
        assert found.is_sound and sum(topic.messages for topic in found.topics) == len(everything)
    assert content(path) == everything
    recovered = recover(path, tmp_path / 'recovered')
    assert recovered.was_whole and content(recovered.path) == everything
    assert attachments(recovered.path) == attachments(path)
    assert info(recovered.path, check=True).is_sound
    rows = export(path, tmp_path / 'tables')
    assert sum(rows.values()) == len(everything)
    assert all(topic.is_same() for topic in diff(path, run))
    again = recompute(path)
    assert (again.inputs, again.compared, again.problems()) == (MOTIONS, 2 * MOTIONS, [])
    assert not again.is_cut


@pytest.mark.parametrize('options', MCAP.values(), ids=MCAP)
def test_every_option_of_the_library_mcap(run, tmp_path, options):
    assert_all_is_read(by_mcap(run, tmp_path / 'run_0.mcap', **options), run, tmp_path)


@pytest.mark.parametrize('version', [8, 9])
@pytest.mark.parametrize('mode', [CompressionMode.NONE, CompressionMode.MESSAGE,
                                  CompressionMode.STORAGE])
def test_every_option_of_the_library_rosbags(run, tmp_path, mode, version):
    assert_all_is_read(by_rosbags(run, tmp_path / 'run', mode, version), run, tmp_path)


@pytest.mark.parametrize('options', FOXGLOVE.values(), ids=FOXGLOVE)
def test_every_option_of_the_foxglove_sdk(run, tmp_path, options):
    assert_all_is_read(by_foxglove(run, tmp_path / 'run_0.mcap', options), run, tmp_path)


@pytest.mark.parametrize('options', [{'use_chunking': False}, {'index_types': IndexType.MESSAGE}],
                         ids=str)
def test_a_second_file_of_a_bag_without_an_index_is_read_too(run, tmp_path, options):
    everything, folder = list(Bag(run).raw()), tmp_path / 'run'
    folder.mkdir()
    by_mcap(run, folder / 'run_0.mcap', everything[:60])
    by_mcap(run, folder / 'run_1.mcap', everything[60:], **options)
    assert_all_is_read(folder, run, tmp_path)


# --- what does not agree -------------------------------------------------------------------------

def assert_every_verb_says(path, said, tmp_path, capsys):
    """Assert that no verb succeeds over a file that is not what its numbers say."""
    out = str(tmp_path / 'out')
    for code, verb in ((3, ['info', '--check']), (3, ['info']),
                       (3, ['recover', '-o', out]), (1, ['export', '-o', out + '2']),
                       (1, ['recompute']), (1, ['diff', str(path)]),
                       (1, ['plot', 'state.theta4', '-o', out + '.png'])):
        assert main(['bag', verb[0], str(path), *verb[1:]]) == code, verb
        printed = ' '.join(''.join(capsys.readouterr()).split())
        assert said in printed, (verb, printed)
    assert not info(out, check=True).is_sound and said in info(out).lost
    with pytest.raises(BagError, match=escape(said)):
        list(records(path))
    assert not (tmp_path / 'out2').exists() and not (tmp_path / 'out.png').exists()


def spoilt(path, opcode, change, which=0):
    """Change a record of the summary by a function of (data, begin); mend its checksum."""
    data = bytearray(path.read_bytes())
    places = [(code, begin) for code, begin, _ in records_of(data)]
    end = [begin for code, begin in places if code == Opcode.DATA_END][0]
    change(data, [begin for code, begin in places if code == opcode and begin > end][which] + 9)
    footer = len(data) - 37
    start = int.from_bytes(data[footer + 9:footer + 17], 'little')
    pack_into('<I', data, footer + 25, crc32(data[start:footer + 25]))
    path.write_bytes(data)
    return path


@pytest.mark.parametrize('options', [{}, {'use_chunking': False},
                                     {'index_types': IndexType.MESSAGE}], ids=str)
@pytest.mark.parametrize('more', [7, -7])
def test_statistics_that_say_something_else_are_found(run, tmp_path, capsys, options, more):
    count = len(content(run))
    path = spoilt(by_mcap(run, tmp_path / 'run_0.mcap', **options), Opcode.STATISTICS,
                  lambda data, begin: pack_into('<Q', data, begin, count + more))
    assert_every_verb_says(path, f'holds {count} messages that can be read, its statistics count '
                                 f'{count + more}', tmp_path, capsys)


def test_statistics_of_channels_that_say_something_else_are_found(run, tmp_path, capsys):
    """As many messages in all, but one of another channel."""
    def change(data, begin):
        first, second = begin + 48, begin + 58      # behind the number of a channel, 2 bytes
        for at, more in ((first, 1), (second, -1)):
            pack_into('<Q', data, at, int.from_bytes(data[at:at + 8], 'little') + more)

    path = spoilt(by_mcap(run, tmp_path / 'run_0.mcap'), Opcode.STATISTICS, change)
    assert main(['bag', 'info', str(path), '--check']) == 3
    assert main(['bag', 'export', str(path), '-o', str(tmp_path / 'out')]) == 1
    said = ' '.join(''.join(capsys.readouterr()).split())
    assert said.count('holds 1 messages of channel 2 that can be read, its statistics count 2') \
        == said.count('(and 1 more)') == 2


def test_metadata_yaml_that_counts_more_is_found(run, tmp_path, capsys):
    folder = by_rosbags(run, tmp_path / 'run', CompressionMode.NONE, 9)
    text, count = (folder / 'metadata.yaml').read_text(), len(content(run))
    (folder / 'metadata.yaml').write_text(text.replace(
        f'message_count: {count}\n', f'message_count: {count + 5}\n'))
    assert_every_verb_says(folder, f'metadata.yaml counts {count + 5}', tmp_path, capsys)


def test_a_file_that_metadata_yaml_names_and_nobody_has_is_found(run, tmp_path, capsys):
    folder, everything = tmp_path / 'run', list(Bag(run).raw())
    folder.mkdir()
    by_mcap(run, folder / 'run_0.mcap', everything[:60])
    metadata.write(folder, {'message_count': len(everything)})
    assert_every_verb_says(folder, f'holds 60 messages that can be read, metadata.yaml counts '
                                   f'{len(everything)}', tmp_path, capsys)


@pytest.mark.parametrize('offset', [1, -30, 2**40])
def test_an_index_that_leads_elsewhere_costs_no_message_without_a_word(run, tmp_path, offset):
    path = by_mcap(run, tmp_path / 'run_0.mcap')
    whole = content(path)

    def change(data, begin):
        place = int.from_bytes(data[begin + 16:begin + 24], 'little')
        pack_into('<Q', data, begin + 16, place + offset)

    spoilt(path, Opcode.CHUNK_INDEX, change, which=1)
    bag = Bag(path)
    found = sorted((raw.topic, raw.time, raw.data) for raw in bag.raw())
    assert set(found) <= set(whole) and (bag.damage or found == whole)
    assert not info(path, check=True).is_sound or found == whole


def test_a_damaged_head_in_a_file_without_a_summary_costs_no_message_without_a_word(
        run, tmp_path):
    """The walk passes the end of the data, or meets zeros."""
    path = by_mcap(run, tmp_path / 'run_0.mcap', **NO_SUMMARY)
    whole, data = content(path), path.read_bytes()
    for _, begin, _ in records_of(data)[:-2]:
        for place, value in ((1, 255), (2, 255), (4, 1)):
            path.write_bytes(data[:begin + place] + bytes([value]) + data[begin + place + 1:])
            bag = Bag(path)
            found = sorted((raw.topic, raw.time, raw.data) for raw in bag.raw())
            assert set(found) <= set(whole) and (bag.damage or found == whole)
    path.write_bytes(data[:3000] + bytes(2000) + data[5000:])
    assert content(path) != whole and info(path).damage and not info(path).is_sound


def test_a_log_time_that_ros_does_not_have_is_one_line(run, tmp_path, capsys):
    raw = next(Bag(run).raw())
    path = by_mcap(run, tmp_path / 'run_0.mcap', [raw._replace(time=2**63)])
    assert main(['bag', 'export', str(path), '-o', str(tmp_path / 'out')]) == 1
    said = capsys.readouterr().err
    assert 'a log time of 9223372036854775808 ns is none of ROS' in said and said.count('\n') == 1


@pytest.mark.parametrize('ours, theirs', [(b'64 acceleration', b'64 accelerat_on'),
                                          (b'float64 position ', b'int8[8] position ')])
def test_a_definition_that_is_not_ours_is_one_line(run, tmp_path, capsys, ours, theirs):
    data = by_mcap(run, tmp_path / 'run_0.mcap', compression=CompressionType.NONE,
                   enable_crcs=False).read_bytes()
    (tmp_path / 'run_0.mcap').write_bytes(data.replace(ours, theirs))
    assert main(['bag', 'recompute', str(tmp_path / 'run_0.mcap')]) == 1
    said = capsys.readouterr().err
    assert 'a definition of a message is not ours' in said and said.count('\n') == 1


@pytest.mark.parametrize('options', [{}, {'index_types': IndexType.CHUNK}, NO_SUMMARY], ids=str)
def test_an_attachment_is_recovered_or_named(run, tmp_path, options, capsys):
    path = by_mcap(run, tmp_path / 'run_0.mcap', **options)
    kept, = attachments(recover(path, tmp_path / 'new').path)
    assert (kept.name, kept.media_type, kept.data) == ('a', 'text/plain', b'some' * 100)
    data = path.read_bytes()
    path.write_bytes(data.replace(b'somesome', b'sameSome', 1))
    assert main(['bag', 'recover', str(path), '-o', str(tmp_path / 'rest')]) == 3
    assert 'its checksum is wrong' in capsys.readouterr().out
    assert content(tmp_path / 'rest') == content(run)


def test_packed_messages_of_a_bag_that_rosbag2_did_not_finish_are_unpacked(run, tmp_path):
    """Its file says how, before all messages; metadata.yaml comes at the end alone."""
    everything = [raw._replace(data=zstandard.compress(raw.data)) for raw in Bag(run).raw()]
    path = by_mcap(run, tmp_path / 'run_0.mcap', everything, about={
        'compression_format': 'zstd', 'compression_mode': 'MESSAGE'})
    for data in (path.read_bytes(), path.read_bytes()[:-3000]):
        path.write_bytes(data)
        found = content(path)
        assert found and {*found} <= {*content(run)} and not info(path, check=True).misfits
    assert recompute(recover(path).path).largest == 0.0


def test_a_chunk_missing_in_the_index_is_read(run, tmp_path):
    """Its index becomes a record of a kind that nobody knows."""
    path = by_mcap(run, tmp_path / 'run_0.mcap')

    def change(data, begin):
        data[begin - 9] = 0x70

    spoilt(path, Opcode.CHUNK_INDEX, change, which=1)
    assert_all_is_read(path, run, tmp_path)
