# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
What is left of a bag: whole, cut anywhere, with flipped bits, by other writers, of version 1.

Every case is read, checked and recovered.
"""
from pathlib import Path
import shutil
from struct import pack, unpack_from
import tracemalloc

from bag.test_recorder import assert_every_reader_takes, numbers, told_by
from fourbar_ros.bag import metadata
from fourbar_ros.bag.overview import info
from fourbar_ros.bag.reader import Bag, ROOM
from fourbar_ros.bag.recomputation import recompute
from fourbar_ros.bag.recorder import BagWriter
from fourbar_ros.bag.recovery import NO_END, recover
from fourbar_ros.cli.main import main
from fourbar_ros.errors import BagError
from hypothesis import example, given
from hypothesis import strategies as st
from mcap.opcode import Opcode
from mcap.writer import CompressionType, Writer
import numpy as np
import pytest
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin
from rosbags.rosbag2 import Writer as RosbagsWriter
from support import bags
from support.bags import MOTION, motion
from support.scenes import PAPER
import zstandard

STRING, COUNT, CHUNK = 'std_msgs/msg/String', 400, 11
SCENE = {**PAPER, 'outputs': ['state'], 'drive.source': 'motion'}
CRC = 33        # where the checksum of a chunk stands in its record
BEFORE = Path(__file__).parent.parent / 'support' / 'data' / 'split_before'


def text(value):
    return bags.encode(STRING, data=value)


@pytest.fixture(scope='module')
def whole(tmp_path_factory):
    """Return the path of a bag of many chunks, each of 11 messages."""
    writer = BagWriter(tmp_path_factory.mktemp('whole'), 'run',
                       [MOTION, bags.channel('/text', STRING)], {'topics': '{}'})
    writer._is_closed.set()
    for thread in writer._threads:                        # what they do is done here
        thread.join()
    for k in range(COUNT):
        writer.write(0, motion(k))
        if k % 10 == 9:
            writer.write(1, text(f'number {k}'))
            writer._flush()
    writer._finish('stopped')
    writer._file.stream.close()
    return writer.path


def raws(path):
    return [(raw.topic, raw.sequence, raw.time, raw.data) for raw in Bag(path).raw()]


def is_part(few, all_of_them):
    rest = iter(all_of_them)
    return all(item in rest for item in few)


def records_of(data):
    """Return [(opcode, begin, end)] of the records of a file."""
    at, found = 8, []
    while at + 9 < len(data):
        opcode, length = unpack_from('<BQ', data, at)
        found.append((opcode, at, at + 9 + length))
        at += 9 + length
    return found


# --- cut -----------------------------------------------------------------------------------------

@given(st.floats(0.0, 1.0))
@example(0.0)
@example(1e-4)
@example(1.0)
def test_a_cut_leaves_an_exact_prefix_that_recover_makes_whole(whole, tmp_path, share):
    data, everything, cut_file = ((whole / 'run_0.mcap').read_bytes(), raws(whole),
                                  tmp_path / 'cut_0.mcap')
    cut = round(share * len(data))
    cut_file.write_bytes(data[:cut])
    found, state = raws(cut_file), info(cut_file, check=True)
    # what is lost is less than a chunk: its index alone may follow it
    chunks = sum(code == Opcode.CHUNK and end <= cut for code, _, end in records_of(data))
    assert found == everything[:CHUNK * chunks] and not state.damage
    assert state.is_finished == (cut == len(data)) and not state.missing
    assert sum(topic.messages for topic in state.topics) == len(found)
    if not state.topics:
        with pytest.raises(BagError, match='nothing to recover'):
            recover(cut_file, tmp_path / 'out')
        return
    recovered = recover(cut_file, tmp_path / 'out')
    assert raws(recovered.path) == found and recovered.messages == len(found)
    assert not recovered.damage and recovered.was_whole == state.is_finished
    assert_every_reader_takes(recovered.path, len(found))
    shutil.rmtree(recovered.path)
    assert [path.name for path in tmp_path.iterdir()] == ['cut_0.mcap']


def test_a_recovered_bag_keeps_what_the_recorder_noted(whole, tmp_path):
    (tmp_path / 'run_0.mcap').write_bytes((whole / 'run_0.mcap').read_bytes()[:20_000])
    recovered = recover(tmp_path / 'run_0.mcap')
    assert recovered.path == tmp_path / 'run_recovered' and not recovered.was_whole
    told, kept = told_by(recovered.path), raws(recovered.path)
    assert told['custom_data'] == {'topics': '{}', 'ended': NO_END}
    assert told['starting_time']['nanoseconds_since_epoch'] == kept[0][2]
    assert told['duration']['nanoseconds'] == kept[-1][2] - kept[0][2]
    bag, old = Bag(recovered.path), Bag(whole)
    assert bag.types == old.types and bag.channel_of('/text') == old.channel_of('/text') != {}
    with pytest.raises(BagError, match='exists already'):
        recover(tmp_path / 'run_0.mcap')


def damaged(whole, path, chunks, end=True):
    """Write a bag again with a wrong byte in these chunks, with or without its end."""
    data = bytearray((whole / 'run_0.mcap').read_bytes())
    places = [begin for opcode, begin, _ in records_of(data) if opcode == Opcode.CHUNK]
    for which in chunks:
        data[places[which] + CRC] ^= 1
    path.write_bytes(data if end else data[:places[-1]])
    return path


@pytest.mark.parametrize('end', [True, False])
def test_a_recovered_bag_knows_what_was_lost_and_has_the_chunks_of_the_recorder(
        whole, tmp_path, capsys, end):
    """A byte in the recovered bag costs its chunk too, and no later reading calls it whole."""
    new = recover(damaged(whole, tmp_path / 'run_0.mcap', [1, 20], end), tmp_path / 'new').path
    lost = info(new).lost
    assert lost.startswith('run_0.mcap, at byte ') and 'its checksum is wrong' in lost
    assert told_by(new)['custom_data']['lost'] == lost == Bag(new).about['lost']
    state = info(new, check=True)
    assert not state.damage and state.missing == 2 * CHUNK and not state.is_sound
    assert main(['bag', 'info', str(new)]) == 3 and 'lost' in capsys.readouterr().out
    file = new / 'new_0.mcap'
    chunks = [begin for opcode, begin, _ in records_of(file.read_bytes())
              if opcode == Opcode.CHUNK]
    kept = raws(new)
    assert len(kept) == CHUNK * len(chunks)
    data = bytearray(file.read_bytes())
    data[chunks[0] + CRC] ^= 1          # the first one
    file.write_bytes(data)
    assert raws(new) == kept[CHUNK:] and info(new, check=True).missing == 3 * CHUNK
    again = recover(new, tmp_path / 'again')
    assert info(again.path, check=True).missing == 3 * CHUNK
    assert info(again.path).lost.startswith(f'{lost}; new_0.mcap, at byte ')


def test_a_damaged_record_of_metadata_is_one_short_line(whole, tmp_path, capsys):
    whole_file, file = (whole / 'run_0.mcap').read_bytes(), tmp_path / 'run_0.mcap'
    metadata_at = [(begin, end) for opcode, begin, end in records_of(whole_file)
                   if opcode == Opcode.METADATA]
    for which, length in ((0, metadata_at[-1][0]), (-1, len(whole_file))):      # cut, finished
        data = bytearray(whole_file[:length])
        data[metadata_at[which][1] - 9] = 0xff
        file.write_bytes(data)
        for code, *verb in ((3, 'info'), (3, 'info', '--check'), (1, 'export', '-o', 'no'),
                            (3, 'recover', '-o', str(tmp_path / f'out{which}'))):
            assert main(['bag', verb[0], str(file), *verb[1:]]) == code, verb
            printed = ''.join(capsys.readouterr())
            assert 'a text is not UTF-8' in printed
            assert max(map(len, printed.splitlines())) < 200 + len(str(file)), printed


def test_zeros_behind_the_data_as_a_power_cut_leaves_them_cost_nothing(whole, tmp_path):
    data, file = (whole / 'run_0.mcap').read_bytes(), tmp_path / 'zeros.mcap'
    for length in (30_000, records_of(data)[40][2]):
        file.write_bytes(data[:length] + bytes(50_000))
        found = raws(file)
        file.write_bytes(data[:length])
        assert found == raws(file) and len(found) > 50
    file.write_bytes(data[:30_000] + bytes(50_000))
    assert recover(file).messages == len(raws(file)) and not info(file, check=True).is_sound


# --- flipped bits --------------------------------------------------------------------------------

def flip(file, data, place, bit, everything):
    """Flip a bit; assert that nothing read is wrong; return (whether it was seen, kept)."""
    spoiled = bytearray(data)
    spoiled[place] ^= 1 << bit
    file.write_bytes(spoiled)
    state, read = info(file, check=True), raws(file)
    assert is_part(read, everything), (place, bit)
    recovered = recover(file, file.parent / 'out')
    kept = raws(recovered.path)
    assert kept == read and info(recovered.path, check=True).is_finished
    assert_every_reader_takes(recovered.path, len(kept))
    shutil.rmtree(recovered.path)
    return not state.is_sound, kept


@given(st.floats(0.0, 1.0, exclude_max=True), st.integers(0, 7))
def test_a_flipped_bit_is_seen_and_costs_its_chunk_at_most(whole, tmp_path, share, bit):
    data, everything = (whole / 'run_0.mcap').read_bytes(), raws(whole)
    place = 8 + int(share * (len(data) - 8))         # behind what every MCAP file begins with
    seen, kept = flip(tmp_path / 'spoiled.mcap', data, place, bit, everything)
    assert seen and len(everything) - len(kept) in (0, CHUNK)


def test_a_summary_that_is_hit_renames_no_type(whole, tmp_path):
    data, everything = (whole / 'run_0.mcap').read_bytes(), raws(whole)
    end = next(begin for opcode, begin, _ in records_of(data) if opcode == Opcode.DATA_END)
    place = data.index(STRING.encode(), end)
    assert flip(tmp_path / 'spoiled.mcap', data, place, 0, everything) == (True, everything)


def test_the_head_of_a_chunk_may_be_hit_anywhere(whole, tmp_path):
    """Its length, its sizes, the name of its compression: the index at the end knows better."""
    data, everything = (whole / 'run_0.mcap').read_bytes(), raws(whole)
    _, begin, _ = [record for record in records_of(data) if record[0] == Opcode.CHUNK][20]
    for place in range(begin, begin + 61, 9):
        for bit in (place % 8, 7):
            seen, kept = flip(tmp_path / 'spoiled.mcap', data, place, bit, everything)
            assert seen and len(everything) - len(kept) in (0, CHUNK), (place, bit)


def test_a_chunk_hit_in_a_cut_file_is_named_and_the_others_are_kept(whole, tmp_path, capsys):
    data, everything = (whole / 'run_0.mcap').read_bytes(), raws(whole)
    chunks = [record for record in records_of(data) if record[0] == Opcode.CHUNK]
    for which in (1, 20, 29):           # 29: the last one
        spoiled, file = bytearray(data[:chunks[29][2]]), tmp_path / 'cut_0.mcap'
        spoiled[chunks[which][1] + CRC] ^= 1
        file.write_bytes(spoiled)
        expected = everything[:which * CHUNK] + everything[(which + 1) * CHUNK:30 * CHUNK]
        assert raws(file) == expected, which
        assert info(file).damage and not info(file).is_sound
        assert main(['bag', 'recover', str(file), '-o', str(tmp_path / f'out{which}')]) == 3
        said = capsys.readouterr().out
        assert said.count('damaged: cut_0.mcap, at byte') == 1 and 'nothing lost' not in said
        assert raws(tmp_path / f'out{which}') == expected
    # the first one describes the topics: without it, and without an end, messages have none
    spoiled = bytearray(data[:chunks[29][2]])
    spoiled[chunks[0][1] + CRC] ^= 1
    file.write_bytes(spoiled)
    assert not raws(file) and len(info(file, check=True).damage.split(' (and 2 more)')) == 2


def test_larger_damage_costs_what_it_hits(whole, tmp_path):
    data, everything = bytearray((whole / 'run_0.mcap').read_bytes()), raws(whole)
    data[10_000:14_000] = bytes(4000)
    (tmp_path / 'hit.mcap').write_bytes(data)
    kept = raws(tmp_path / 'hit.mcap')
    assert is_part(kept, everything) and info(tmp_path / 'hit.mcap', check=True).damage
    hit = [begin for opcode, begin, end in records_of((whole / 'run_0.mcap').read_bytes())
           if opcode == Opcode.CHUNK and begin < 14_000 and end > 10_000]
    assert len(everything) - len(kept) == CHUNK * len(hit) > CHUNK
    with pytest.raises(BagError, match='fourbar bag recover keeps the rest'):
        recompute(_with_scene(tmp_path, data))


def _with_scene(folder, data):
    """Return a damaged bag of a scene."""
    path = bags.run(folder, 'scene', SCENE, [(0.05 * k, 25.0, 0.1) for k in range(30)])
    file = path / 'scene_0.mcap'
    data = bytearray(file.read_bytes())
    _, begin, _ = [record for record in records_of(data) if record[0] == Opcode.CHUNK][0]
    data[begin + CRC] ^= 1
    file.write_bytes(data)
    return path


@pytest.mark.parametrize('content', [b'', b'\x89MCAP', b'not a bag' * 100, bytes(1000),
                                     b'\x89MCAP0\r\n' + b'\xff' * 500], ids=range(5))
def test_files_that_are_no_bags_are_one_line_for_every_verb(tmp_path, capsys, content):
    file = tmp_path / 'a.mcap'
    file.write_bytes(content)
    for verb in (['recover'], ['recompute'], ['scene'], ['export', '-o', str(tmp_path / 'out')]):
        code = main(['bag', verb[0], str(file), *verb[1:]])
        said = capsys.readouterr()
        assert code == 1 and said.err.startswith('fourbar: ') and said.err.count('\n') == 1, verb
    assert main(['bag', 'info', str(file)]) == (
        3 if content[:8] == b'\x89MCAP0\r\n'[:len(content)] else 1)
    assert [path.name for path in tmp_path.iterdir()] == ['a.mcap']


# --- other writers -------------------------------------------------------------------------------

def by_rosbags(folder, mode):
    """Write a bag of three topics with the library rosbags."""
    writer = RosbagsWriter(folder, version=9, storage_plugin=StoragePlugin.MCAP)
    writer.set_compression(mode, CompressionFormat.ZSTD)
    with writer:
        connections = {name: writer.add_connection(name, kind, typestore=bags.STORE)
                       for name, kind in (('/a', STRING), ('/b', MOTION.type), ('/c', STRING))}
        for k in range(60):
            for name, connection in connections.items():
                writer.write(connection, 10**9 + k,
                             motion(k) if name == '/b' else text(f'{name} {k}'))
    return folder


@pytest.mark.parametrize('mode', [CompressionMode.NONE, CompressionMode.MESSAGE,
                                  CompressionMode.STORAGE])
def test_bags_of_the_library_rosbags_are_read_as_written(tmp_path, mode):
    path = by_rosbags(tmp_path / 'foreign', mode)
    bag = Bag(path)
    found = list(bag.records())
    assert len(found) == 180 and not bag.damage and info(path, check=True).is_sound
    assert [record.message.position for record in found if record.topic == '/b'] == list(range(60))
    assert [record.message.data for record in found if record.topic == '/c'] == [
        f'/c {k}' for k in range(60)]
    assert raws(recover(path, tmp_path / 'new').path) == raws(path)
    assert main(['bag', 'diff', str(path), str(tmp_path / 'new')]) == 0


@pytest.mark.parametrize('compression', CompressionType)
def test_bags_of_the_library_mcap_are_read_as_written_and_cut(tmp_path, compression):
    """Two publishers of one topic are two channels."""
    file = tmp_path / 'foreign.mcap'
    with open(file, 'wb') as stream:
        writer = Writer(stream, chunk_size=500, compression=compression)
        writer.start('ros2', 'test')
        kinds = {kind: writer.register_schema(kind, 'ros2msg', bags.text_of(kind).encode())
                 for kind in (STRING, MOTION.type)}
        channels = [writer.register_channel(topic, 'cdr', kinds[kind], {'by': by})
                    for topic, kind, by in (('/a', STRING, 'one'), ('/b', MOTION.type, ''),
                                            ('/a', STRING, 'two'))]
        for k in range(90):
            writer.add_message(channels[k % 3], k, motion(k) if k % 3 == 1 else text(str(k)), k)
        writer.finish()
    assert [raw.time for raw in Bag(file).raw()] == list(range(90))
    assert [record.message.data for record in Bag(file).records(['/a'])] == [
        str(k) for k in range(90) if k % 3 != 1]
    assert [record.message.position for record in Bag(file).records(['/b'])] == [
        k for k in range(90) if k % 3 == 1]
    assert sum(len(columns.times) for columns in Bag(file).columns()) == 90
    new = recover(file).path
    assert raws(new) == raws(file) and told_by(new)['message_count'] == 90
    data, everything = file.read_bytes(), raws(file)
    file.write_bytes(data[:len(data) // 2])
    assert raws(file) == everything[:len(raws(file))] and len(raws(file)) > 10


def test_two_types_on_one_topic_are_one_line(tmp_path, capsys):
    file = tmp_path / 'two.mcap'
    with open(file, 'wb') as stream:
        writer = Writer(stream)
        writer.start('ros2', 'test')
        for k, kind in enumerate((STRING, MOTION.type)):
            writer.add_message(writer.register_channel('/a', 'cdr', writer.register_schema(
                kind, 'ros2msg', bags.text_of(kind).encode())), k, motion(k), k)
        writer.finish()
    assert main(['bag', 'export', str(file), '-o', str(tmp_path / 'out')]) == 1
    assert '/a has two types, ' in capsys.readouterr().err


@pytest.mark.parametrize('second, says', [
    ('float64 y\nfloat64 x\n', '/a has two definitions of a/msg/P'),
    ('float64 x  # [m]\nfloat64 y\nuint8 NEW=1\n', '')])
def test_two_definitions_on_one_topic_are_one_line_if_fields_differ(
        tmp_path, capsys, second, says):
    """As in bags of two versions that were merged: the older messages took the newer fields."""
    file = tmp_path / 'two.mcap'
    with open(file, 'wb') as stream:
        writer = Writer(stream)
        writer.start('ros2', 'test')
        for k, definition in enumerate(('float64 x\nfloat64 y\n', second)):
            writer.add_message(writer.register_channel('/a', 'cdr', writer.register_schema(
                'a/msg/P', 'ros2msg', definition.encode())), k, b'\0\1\0\0' + pack('<dd', 1, 2), k)
        writer.finish()
    assert main(['bag', 'export', str(file), '-o', str(tmp_path / 'out.npz')]) == bool(says)
    assert says in capsys.readouterr().err
    assert says or np.load(tmp_path / 'out.npz')['a/x'].tolist() == [1.0, 1.0]
    assert recover(file).messages == 2


def test_bags_of_other_kinds_say_what_to_do_first(tmp_path, capsys):
    for name, said in (('a.db3', 'rosbags-convert'), ('a.bag', 'ROS 1'),
                       ('a.mcap.zst', 'unpack it first'), ('a.txt', 'holds no .mcap files')):
        folder = tmp_path / name.replace('.', '_')
        folder.mkdir()
        (folder / name).write_bytes(b'some')
        assert main(['bag', 'info', str(folder)]) == 1
        assert said in capsys.readouterr().err
    with pytest.raises(BagError, match='no such bag'):
        Bag(tmp_path / 'nothing')
    for number, names in enumerate((('a_0', 'b_0'), ('run', 'walk'))):
        folder = tmp_path / f'several_{number}'
        folder.mkdir()
        for name in names:
            (folder / f'{name}.mcap').write_bytes(b'')
        with pytest.raises(BagError, match='different bags, name one'):
            Bag(folder)


def test_definitions_that_cannot_be_read_and_messages_that_do_not_fit_are_one_line(
        tmp_path, capsys):
    for number, (encoding, definition, data) in enumerate((
            ('ros2msg', 'no/Such[ x\n', text('a')), ('ros2idl', 'struct', text('a')),
            ('ros2msg', 'wstring data\n', text('a')), ('ros2msg', 'Such[2] x\n', text('a')),
            ('ros2msg', 'string data\n', text('a')[:9]),
            ('ros2msg', 'string data\n', text('a') + bytes(8)),
            ('ros2msg', 'float64 x\n', text('a')[:7]),
            ('ros2msg', 'string data\n', b'\0\1\0\0' + pack('<I', 2**31) + b'abc\0'),
            ('ros2msg', 'float64[] x\n', b'\0\1\0\0' + pack('<I', 2**31) + bytes(8)),
            ('ros2msg', 'string[] x\n', b'\0\1\0\0' + pack('<I', 2**31) + bytes(8)))):
        file = tmp_path / f'{number}.mcap'
        with open(file, 'wb') as stream:
            writer = Writer(stream)
            writer.start('ros2', 'test')
            channel = writer.register_channel('/a', 'cdr', writer.register_schema(
                'a/msg/T', encoding, definition.encode()))
            writer.add_message(channel, 1, data, 1)
            writer.finish()
        assert main(['bag', 'export', str(file), '-o', str(tmp_path / 'out')]) == 1, definition
        said = capsys.readouterr().err
        assert said.startswith(f'fourbar: {file}: /a: ') and said.count('\n') == 1, said
        with pytest.raises(BagError):
            list(Bag(file).records())
        has_definition = 4 <= number
        assert main(['bag', 'info', str(file), '--check']) == (3 if has_definition else 0)
        assert info(file, True).misfits == has_definition and not info(file).misfits
        assert recover(file, tmp_path / f'new{number}').messages == 1
    capsys.readouterr()


@pytest.mark.parametrize(('kind', 'count', 'most'),
                         [('images', 64, 3 * ROOM), ('poses', 100, ROOM)])
def test_a_check_holds_some_megabytes_whatever_the_messages(kind, count, most, tmp_path):
    """
    Of large messages: what waits, the same as an array, and a chunk.

    Of messages of 0, 1, 2, ... poses, 1 MB in all: one layout, not those of all.
    """
    type_name = {'images': 'sensor_msgs/msg/PointCloud2', 'poses': 'tf2_msgs/msg/TFMessage'}[kind]
    message = bags.zero(type_name)
    if kind == 'images':
        message.data = np.zeros(2**20, np.uint8)
    with RosbagsWriter(tmp_path / 'bag', version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        channel = writer.add_connection('/a', type_name, typestore=bags.STORE)
        for number in range(count):
            if kind == 'poses':
                message.transforms = [bags.zero('geometry_msgs/msg/TransformStamped')] * number
            data = bags.STORE.serialize_cdr(message, type_name)
            writer.write(channel, number, data[:-9] if number % 8 == 1 else data)
    tracemalloc.start()
    found = info(tmp_path / 'bag', check=True).misfits
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert found == len(range(1, count, 8)) and peak < most


@pytest.mark.parametrize('kind', ['zstd', 'lz4', ''])
def test_a_chunk_that_says_it_is_huge_is_refused(tmp_path, kind):
    import lz4.frame
    zeros = bytes(2**29)
    packed = {'zstd': lambda: zstandard.compress(zeros), '': lambda: bytes(100),
              'lz4': lambda: lz4.frame.compress(zeros)}[kind]()
    name = kind.encode()
    body = (pack('<QQQII', 0, 0, 2**29, 0, len(name)) + name + pack('<Q', len(packed)) + packed)
    (tmp_path / 'bomb.mcap').write_bytes(
        b'\x89MCAP0\r\n' + pack('<BQ', Opcode.HEADER, 8) + bytes(8)
        + pack('<BQ', Opcode.CHUNK, len(body)) + body)
    bag = Bag(tmp_path / 'bomb.mcap')
    assert not list(bag.raw()) and 'a chunk of 536870912 bytes' in bag.damage[0]


def test_a_chunk_that_unpacks_to_more_than_it_says_is_refused(tmp_path):
    packed = zstandard.compress(bytes(2**29))
    body = pack('<QQQII', 0, 0, 100, 0, 4) + b'zstd' + pack('<Q', len(packed)) + packed
    (tmp_path / 'bomb.mcap').write_bytes(
        b'\x89MCAP0\r\n' + pack('<BQ', Opcode.CHUNK, len(body)) + body)
    bag = Bag(tmp_path / 'bomb.mcap')
    assert not list(bag.raw()) and 'packed data of more than 100 bytes' in bag.damage[0]


def test_a_chunk_of_an_unknown_compression_is_named(whole, tmp_path):
    data = (whole / 'run_0.mcap').read_bytes().replace(b'zstd', b'lzma')
    (tmp_path / 'other.mcap').write_bytes(data[:20_000])
    bag = Bag(tmp_path / 'other.mcap')
    assert not list(bag.raw()) and 'compressed by lzma, which is not known' in bag.damage[0]


# --- of version 1 --------------------------------------------------------------------------------

ROUNDING = 1e-12  # of the kinds, which were no machines then


def test_a_split_bag_of_version_1_is_read_without_the_messages_it_repeats():
    bag = Bag(BEFORE)
    assert [sum(1 for _ in Bag(file).raw()) for file in bag.files] == [91, 95, 94]
    of_topic = [raw.sequence for raw in bag.raw(['/fourbar/state'])]
    assert of_topic == list(range(90)) and info(BEFORE, check=True).is_sound
    found = recompute(BEFORE)
    assert (found.inputs, found.compared, found.problems(ROUNDING)) == (90, 180, [])
    for place, file in enumerate(bag.files):        # each begins with the scene in force
        found = recompute(file)
        assert (found.compared, found.problems(ROUNDING)) == (60 + 2 * (place > 0), [])


def test_a_killed_split_bag_of_version_1_is_recovered_without_losing_or_doubling_one(tmp_path):
    killed = tmp_path / 'split'
    shutil.copytree(BEFORE, killed)
    data = (killed / 'split_2.mcap').read_bytes()
    end = [end for opcode, _, end in records_of(data) if opcode == Opcode.CHUNK][-1]
    (killed / 'split_2.mcap').write_bytes(data[:end])
    (killed / 'metadata.yaml').unlink()
    for path in (killed, recover(killed).path):
        assert [raw.sequence for raw in Bag(path).raw(['/fourbar/state'])] == list(range(90))
        assert not info(path, check=True).missing and not info(path).damage
        found = recompute(path)
        assert (found.inputs, found.compared, found.problems(ROUNDING)) == (90, 180, [])
    assert Bag(tmp_path / 'split_recovered').about['ended'] == NO_END


# --- split bags ----------------------------------------------------------------------------------

def test_files_are_in_the_order_of_their_numbers_and_metadata_may_be_lost(tmp_path, capsys):
    path = bags.run(tmp_path, 'run', SCENE, [(0.05 * k, 25.0, 0.1) for k in range(300)],
                    {150: {'linkage.a1': 0.35}}, paced=True, step_ns=10**7)
    new = _resplit(path, tmp_path / 'new', 12)
    assert [metadata.number_of(file) for file in Bag(new).files] == list(range(12))
    for _ in range(2):
        found = recompute(new)
        assert (found.inputs, found.compared, found.problems()) == (300, 300, [])
        assert info(new, check=True).is_sound and raws(new) == raws(path)
        (new / 'metadata.yaml').unlink(missing_ok=True)
    # one is lost, and one is cut
    (new / 'new_4.mcap').unlink()
    state = info(new)
    assert state.is_finished and state.missing == 50 and not state.is_sound
    assert main(['bag', 'recover', str(new), '-o', str(tmp_path / 'rest')]) == 0
    said = capsys.readouterr().out
    assert 'without its end or a file' in said and 'nothing lost' not in said
    data = (new / 'new_7.mcap').read_bytes()
    (new / 'new_7.mcap').write_bytes(data[:len(data) - 40])
    state = info(new, check=True)
    assert not state.is_finished and state.missing == 50
    again = recover(new)
    assert raws(again.path) == raws(new) and not again.damage and not again.was_whole
    assert [file.name for file in Bag(again.path).files] == [
        f'new_recovered_{k}.mcap' for k in range(12) if k != 4]


def _resplit(path, new, parts):
    """Write a bag again as one of so many files."""
    old, everything = Bag(path), list(Bag(path).raw())
    new.mkdir()
    for k, rows in enumerate(np.array_split(np.arange(len(everything)), parts)):
        with open(new / f'{new.name}_{k}.mcap', 'wb') as stream:
            writer = Writer(stream, enable_data_crcs=True)
            writer.start('ros2', 'test')
            channels = {topic: writer.register_channel(topic, 'cdr', writer.register_schema(
                kind, 'ros2msg', bags.text_of(kind).encode())) for topic, kind in
                        sorted(old.types.items(), reverse=k % 2)}
            for raw in (everything[row] for row in rows):
                writer.add_message(channels[raw.topic], raw.time, raw.data, raw.time, raw.sequence)
            writer.add_metadata(metadata.RECORD, {metadata.KEY: metadata.dumped(
                {'custom_data': old.about})})
            writer.finish()
    (new / 'metadata.yaml').write_text('')
    return new


def test_bytes_that_fast_cdr_leaves_behind_an_empty_sequence_do_no_harm(tmp_path):
    kind = 'sensor_msgs/msg/JointState'
    writer = BagWriter(tmp_path, 'run', [bags.channel('/joints', kind)], {})
    for names in (['a'], ['a', 'b']):
        data = bags.encode(kind, header=bags.stamp(1), name=names, effort=np.zeros(0),
                           position=np.ones(len(names)), velocity=np.zeros(len(names)))
        writer.write(0, data + b'\x20\xc6\x7d\xbd')
    path = writer.close()
    assert [record.message.name for record in Bag(path).records()] == [['a'], ['a', 'b']]
    assert [columns.records['position'].tolist() for columns in Bag(path).columns()] == [
        [[1.0]], [[1.0, 1.0]]]


def test_a_bag_from_a_time_on(whole):
    everything = raws(whole)
    assert numbers(whole) == list(range(COUNT))
    start = everything[300][2]
    assert [raw.sequence for raw in Bag(whole).raw(['/text'], start)] == [
        sequence for topic, sequence, time, _ in everything if topic == '/text' and time >= start]
