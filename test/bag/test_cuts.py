# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
What is left of a bag: cut anywhere, followed by zeros, with a flipped bit.

Read and recovered.
"""
from collections import Counter
import random
import shutil

from bag.test_recorder import assert_every_reader_takes, numbers
from fourbar_ros.bag import rosbag2
from fourbar_ros.bag.mcap.records import encoded, HEAD, MAGIC
from fourbar_ros.bag.mcap.writer import Container
from fourbar_ros.bag.info import info
from fourbar_ros.bag.reader import Bag
from fourbar_ros.bag.recover import recover
from fourbar_ros.bag.recorder import BagWriter
from fourbar_ros.errors import BagError
from mcap.opcode import Opcode
from mcap.records import Channel, Schema
from mcap.writer import CompressionType, Writer
import pytest
from support import bags
from support.bags import MOTION, motion
from support.samples import some

COUNT = 700


@pytest.fixture(scope='module')
def whole(tmp_path_factory):
    """Return the path of a bag of many small chunks."""
    path = tmp_path_factory.mktemp('whole')
    writer = BagWriter(path, 'run', [MOTION, bags.channel('/text', 'std_msgs/msg/String')],
                       {'who': 'test'})
    writer._stop.set()
    for thread in writer._threads:                        # what they do is done here
        thread.join()
    for k in range(COUNT):
        writer.write(0, motion(k))
        if k % 10 == 0:
            writer.write(1, bags.encode('std_msgs/msg/String', data=f'number {k}'))
            writer._drain()
            writer._parts.container.flush()
    return writer.close()


def raws(path):
    return [(raw.topic, raw.sequence, raw.time, raw.data) for raw in Bag(path).raw()]


@some('count', [25, 200], 1)
def test_random_cuts_each_leave_an_exact_prefix_that_recover_makes_whole(whole, tmp_path, count):
    file = whole / 'run_0.mcap'
    data, everything = file.read_bytes(), raws(whole)
    assert len(everything) == COUNT * 11 // 10
    shuffled = random.Random(5)
    cuts = sorted([0, 1, 7, 8, 9, len(data) - 1, len(data),
                   *(shuffled.randrange(len(data)) for _ in range(count))])
    lengths = []
    for cut in cuts:
        cut_file = tmp_path / 'cut_0.mcap'
        cut_file.write_bytes(data[:cut])
        bag = Bag(cut_file)
        found = raws(cut_file)
        lengths.append(len(found))
        assert found == everything[:len(found)]
        state = info(cut_file, check=True)
        assert state.state == ('finished' if cut == len(data) else 'cut')
        assert sum(topic.messages for topic in state.topics) == len(found) and not state.damage
        try:
            recovered = recover(cut_file, tmp_path / 'out')
        except BagError as error:
            assert ('nothing to recover' in str(error) and not found
                    and not (tmp_path / 'out').exists())
            continue
        assert raws(recovered.path) == found and recovered.messages == len(found)
        assert recovered.was_whole == (cut == len(data)) and 0 <= recovered.lost < cut + 1
        if cut % 10 == 0:
            assert_every_reader_takes(recovered.path, len(found))
        shutil.rmtree(recovered.path)
        assert bag.file == cut_file and cut_file.read_bytes() == data[:cut]
    assert lengths == sorted(lengths) and lengths[-1] == len(everything)
    assert len(set(lengths)) > count // 4


def test_what_is_lost_is_the_record_that_was_cut(whole, tmp_path):
    """An MCAP record is an opcode of one byte, its length in eight, and so many bytes."""
    data, at, starts = (whole / 'run_0.mcap').read_bytes(), 8, []
    while data[at] != Opcode.DATA_END:
        starts.append(at)
        at += 9 + int.from_bytes(data[at + 1:at + 9], 'little')
    chunks = [start for start in starts if data[start] == Opcode.CHUNK]
    for start, rest in ((chunks[2], 0), (chunks[4], 5), (chunks[5], 25)):   # before its messages
        (tmp_path / 'cut_0.mcap').write_bytes(data[:start + rest])
        recovered = recover(tmp_path / 'cut_0.mcap')
        assert recovered.lost == rest and not recovered.was_whole
        shutil.rmtree(recovered.path)


def test_a_recovered_bag_keeps_what_the_recorder_noted(whole, tmp_path):
    (tmp_path / 'run_0.mcap').write_bytes((whole / 'run_0.mcap').read_bytes()[:20_000])
    recovered = recover(tmp_path / 'run_0.mcap')
    assert recovered.path == tmp_path / 'run_recovered'
    told = Bag(recovered.path).metadata()
    assert told['custom_data']['who'] == 'test' and 'recovered_by' in told['custom_data']
    first, last = raws(recovered.path)[0], raws(recovered.path)[-1]
    assert told['starting_time']['nanoseconds_since_epoch'] == first[2]
    assert told['duration']['nanoseconds'] == last[2] - first[2]
    assert_every_reader_takes(recovered.path, len(raws(recovered.path)))
    with pytest.raises(BagError, match='exists already'):
        recover(tmp_path / 'run_0.mcap')


def test_zeros_behind_the_data_as_a_power_cut_leaves_them_are_a_cut(whole, tmp_path):
    data = (whole / 'run_0.mcap').read_bytes()
    (tmp_path / 'zeros.mcap').write_bytes(data[:30_000] + bytes(50_000))
    found = raws(tmp_path / 'zeros.mcap')
    assert found == raws(whole)[:len(found)] and len(found) > 100
    assert recover(tmp_path / 'zeros.mcap').messages == len(found)


@some('seed', [6, 7, 8], 1)
def test_flipped_bits_are_seen_and_cost_at_most_what_they_hit(whole, tmp_path, seed):
    data, everything, shuffled = ((whole / 'run_0.mcap').read_bytes(), raws(whole),
                                  random.Random(seed))
    for _ in range(20):
        place, bit = shuffled.randrange(len(data)), shuffled.randrange(8)
        seen, kept = flipped(tmp_path / 'spoiled.mcap', data, place, bit, everything,
                             recovering=True)
        assert seen and len(kept) >= len(everything) - 11, (seed, place, bit)


# --- every byte of a small bag -------------------------------------------------------------------

FLIPPED = ['finished', 'cut', *(f'{state}, {kind.name}' for state in ('finished', 'cut')
                                for kind in CompressionType)]
# What no checksum covers in a file that was cut, and nobody reads or loses: the index of a chunk,
# made anew by recover; the name of the library; the name of the checksum of a metadata record;
# bits of compressed data that do not matter, as they unpack to the same content.
HARMLESS_IN_CUT = {'MESSAGE_INDEX body', 'HEADER body', "METADATA body, 'crc32'", 'CHUNK content'}


def text(number):
    return bags.encode('std_msgs/msg/String', data=f'number {number}')


def small_bag(path):
    """
    Write a bag as the recorder does, without its long texts.

    Returns its bytes and where its messages end.
    """
    with open(path, 'x+b', buffering=0) as file:
        container = Container(file, 'ros2', 'test')
        schema = container.add_schema('std_msgs/msg/String', 'string data')
        channels = [container.add_channel(topic, schema, {'a': 'b'}) for topic in ('/a', '/b')]
        container.add_metadata(rosbag2.RECORD, {rosbag2.KEY: 'custom_data: {who: test}'})
        for k in range(12):
            container.add_message(channels[k % 2], k // 2, 10**18 + k, text(k))
            if k % 4 == 3:
                container.flush()
        end = container.size
        container.add_metadata(rosbag2.RECORD, {rosbag2.KEY: 'custom_data: {who: test}'})
        container.finish()
    return path.read_bytes(), end


def foreign_bag(path, compression):
    """Write the same with the mcap library."""
    with open(path, 'xb') as file:
        writer = Writer(file, chunk_size=250, compression=compression, enable_data_crcs=True)
        writer.start('ros2', 'test')
        schema = writer.register_schema('std_msgs/msg/String', 'ros2msg', b'string data')
        channels = [writer.register_channel(topic, 'cdr', schema, {'a': 'b'})
                    for topic in ('/a', '/b')]
        for k in range(12):
            writer.add_message(channels[k % 2], 10**18 + k, text(k), 10**18 + k, k // 2)
        writer.finish()
    data = path.read_bytes()
    return data, data.index(b'\x0f\x04' + bytes(7))           # the mark for the end of the data


def kind_of(data, place):
    """Return what a byte of a file belongs to."""
    at, size = len(MAGIC), HEAD.size
    while at <= place and at + size <= len(data):
        opcode, length = HEAD.unpack_from(data, at)
        end, name, within = at + size + length, Opcode(opcode).name, place - at - size
        if place < end:
            if within < 0:
                return f'{name} {"opcode" if place == at else "length"}'
            if (opcode == Opcode.METADATA and data.find(b'crc32', at) <= place
                    < data.find(b'crc32', at) + 5):
                return f"{name} body, 'crc32'"
            head = 40 + int.from_bytes(data[at + 37:at + 41], 'little')
            part = 'body' if opcode != Opcode.CHUNK else 'head' if within < head else 'content'
            return f'{name} {part}'
        at = end
    return 'magic'


def is_part(few, all_of_them):
    rest = iter(all_of_them)
    return all(item in rest for item in few)


def flipped(file, data, place, bit, everything, recovering):
    """
    Flip a bit; return whether it was seen, and what recover keeps.

    Asserts that nothing is altered or added.
    """
    spoiled = bytearray(data)
    spoiled[place] ^= 1 << bit
    file.write_bytes(spoiled)
    read, said = [], ''
    try:
        for raw in Bag(file).raw():
            read.append((raw.topic, raw.sequence, raw.time, raw.data))
    except BagError as error:
        said = str(error)
        assert 'at byte' in said and 'fourbar bag recover' in said
    assert read == everything[:len(read)] and (said or len(read) == len(everything)), (place, bit)
    found = info(file, check=True)
    assert ('byte' in found.damage or not found.damage) and not (found.is_sound and found.damage)
    assert found.damage or not said, (place, bit)
    if not recovering:
        return bool(found.damage), everything
    recovered = recover(file, file.parent / 'out')
    kept, again = raws(recovered.path), info(recovered.path, check=True)
    shutil.rmtree(recovered.path)
    assert (again.state == 'finished' and not again.damage
            and is_part(kept, everything)), (place, bit)
    assert (len(kept) == recovered.messages and bool(recovered.damaged)
            == bool(found.damage)), (place, bit)
    return bool(found.damage), kept


def flip_all(tmp_path, case, bits, recovering):
    """
    Flip bits(place) of every byte, recover where recovering(place).

    Returns what was not seen.
    """
    state, _, kind = case.partition(', ')
    file = tmp_path / 'small.mcap'
    data, end = foreign_bag(file, CompressionType[kind]) if kind else small_bag(file)
    if state == 'cut':
        data = data[:end]
    file.write_bytes(data)
    everything, largest = raws(file), max(len(chunk) for chunk in Bag(file).chunks())
    assert len(everything) == 12 and largest < 8
    unseen = Counter()
    for place in range(len(data)):
        for bit in bits(place):
            seen, kept = flipped(file, data, place, bit, everything, recovering(place))
            # The first chunk of the library's own writer holds the only names of the topics, in a
            # file that was cut.
            assert (len(everything) - len(kept) <= (12 if kind and state == 'cut'
                                                    else largest)), (place, bit)
            if not seen:
                unseen[kind_of(data, place)] += 1
    return unseen


@some('case', FLIPPED, 1)
def test_a_flipped_bit_in_a_fourth_of_all_bytes_is_seen_or_without_effect(tmp_path, case):
    shuffled = random.Random(case)
    unseen = flip_all(tmp_path, case,
                      lambda place: [] if place % 4 else [shuffled.randrange(8)],
                      lambda place: place % 32 == 0)
    assert unseen.keys() <= (HARMLESS_IN_CUT if 'cut' in case else set()), unseen


@pytest.mark.slow
@pytest.mark.parametrize('case', FLIPPED)
def test_every_bit_flipped_is_seen_or_without_effect(tmp_path, case):
    unseen = flip_all(tmp_path, case, lambda place: range(8), lambda place: place % 4 == 0)
    assert unseen.keys() <= (HARMLESS_IN_CUT if 'cut' in case else set()), unseen


def test_larger_damage_costs_what_it_hits(whole, tmp_path):
    data, everything, shuffled = (whole / 'run_0.mcap').read_bytes(), raws(whole), random.Random(3)
    end = data.rindex(b'\x0f\x04' + bytes(7))
    for i in range(40):
        size = shuffled.choice([2, 30, 512, 4096])
        place = shuffled.randrange(len(data) - size)
        hit = bytes(size) if i % 2 and size > 2 else shuffled.randbytes(size)
        file = tmp_path / 'spoiled.mcap'
        file.write_bytes(data[:place] + hit + data[place + size:])
        assert not info(file, check=True).is_sound
        recovered = recover(file, tmp_path / 'out')
        kept = raws(recovered.path)
        assert is_part(kept, everything) and recovered.damaged
        again, missing = info(recovered.path), len(everything) - len(kept)
        assert again.missing == sum(recovered.missing.values()) == missing or place + size > end
        assert again.is_sound == (not again.missing)
        # chunks of 11 messages have more than 300 bytes
        cost = 22 + 11 * size / 300 if place < end else 0
        assert len(kept) >= len(everything) - cost, (i, size, place, len(everything) - len(kept))
        shutil.rmtree(recovered.path)


@pytest.mark.parametrize('content', [b'', b'\x89MCAP0\r\n', b'not a bag at all', bytes(1000)])
def test_files_that_are_no_bags_are_named_in_one_line(tmp_path, content):
    file = tmp_path / 'none.mcap'
    file.write_bytes(content)
    for work in (recover, lambda path: Bag(path).metadata()):
        with pytest.raises(BagError, match='none.mcap'):
            work(file)
    for missing in (tmp_path / 'nowhere', tmp_path):
        if missing != tmp_path:
            with pytest.raises(BagError, match='no such bag'):
                Bag(missing)


def test_bags_of_other_writers_are_read_and_recovered(tmp_path):
    from mcap.writer import IndexType
    for i, options in enumerate(({'use_chunking': False}, {'compression': CompressionType.LZ4},
                                 {'enable_crcs': False},
                                 {'compression': CompressionType.NONE,
                                  'index_types': IndexType.NONE})):
        file = tmp_path / f'other{i}_0.mcap'
        with open(file, 'wb') as stream:
            writer = Writer(stream, chunk_size=2000, **options)
            writer.start('ros2', 'test')
            number = writer.register_channel(MOTION.topic, 'cdr', writer.register_schema(
                MOTION.type, 'ros2msg', MOTION.schema.encode()), MOTION.metadata)
            for k in range(300):
                writer.add_message(number, 10 * k + 5, motion(k), 10 * k, k)
            writer.finish()
        assert numbers(file) == list(range(300)) and not Bag(file).cut
        data = file.read_bytes()
        file.write_bytes(data[:len(data) // 3])
        found = numbers(file)
        recovered = recover(file)
        assert (found == numbers(recovered.path) == list(range(len(found))) and 10 < len(found)
                < 300)
        assert_every_reader_takes(recovered.path, len(found))


def test_a_channel_of_unknown_schema_says_so(tmp_path):
    writer = BagWriter(tmp_path, 'run', [rosbag2.Channel('/odd', 'odd/msg/Odd',
                                                         'other/Missing field\n', '', 10)], {})
    writer.write(0, motion(0))
    path = writer.close()
    assert len(raws(path)) == 1
    with pytest.raises(BagError, match='does not define other/Missing'):
        list(Bag(path).records())


# --- gaps and order ------------------------------------------------------------------------------

CRC = 33            # [bytes] place of the checksum in a chunk


def chunk_places(data):
    """Return [(begin, end)] of every chunk of a file with the message index behind it."""
    places, at = [], len(MAGIC)
    while at + HEAD.size <= len(data) - len(MAGIC):
        opcode, length = HEAD.unpack_from(data, at)
        end = at + HEAD.size + length
        if opcode == Opcode.CHUNK:
            places.append([at, end])
        elif opcode == Opcode.MESSAGE_INDEX:
            places[-1][1] = end
        at = end
    return places


@pytest.mark.parametrize('state', ['finished', 'cut'])
@some('which', [0, 1, 35, -1], (0,))
def test_a_lost_chunk_at_either_end_or_between_is_in_the_recovered_bag_and_in_its_verdict(
        whole, tmp_path, which, state):
    data, everything = bytearray((whole / 'run_0.mcap').read_bytes()), raws(whole)
    places = chunk_places(data)
    if state == 'cut':
        del data[places[-1][1]:]
    data[places[which][0] + CRC] ^= 4
    (tmp_path / 'hit_0.mcap').write_bytes(data)
    recovered = recover(tmp_path / 'hit_0.mcap')
    lost = Counter(raw[0] for raw in everything) - Counter(raw[0] for raw in raws(recovered.path))
    # how many came after the last whole one nobody knows
    if (which, state) == (-1, 'cut'):
        assert sum(lost.values()) and not recovered.missing and recovered.damaged
        assert 'wrong checksum' in info(recovered.path).lost
        return
    assert sum(lost.values()) >= 1 and recovered.missing == lost
    for check in (False, True):
        found = info(recovered.path, check)
        assert ({t.topic: t.missing for t in found.topics if t.missing} == lost
                and not found.is_sound)
        assert found.ended.startswith('stopped' if state == 'finished' else 'without an end')
        assert not found.damage and 'wrong checksum' in found.lost


def test_a_recovered_bag_of_a_cut_one_knows_what_it_lacks_when_it_is_recovered_again(
        whole, tmp_path):
    data = bytearray((whole / 'run_0.mcap').read_bytes())
    places = chunk_places(data)
    data[places[3][0] + CRC] ^= 1
    (tmp_path / 'cut_0.mcap').write_bytes(data[:places[40][1]])
    first = recover(tmp_path / 'cut_0.mcap', tmp_path / 'first')
    again = recover(first.path, tmp_path / 'again')
    assert first.missing == again.missing == {MOTION.topic: 10, '/text': 1} and not again.damaged
    assert not info(again.path).is_sound and info(again.path).lost == info(first.path).lost


@pytest.mark.parametrize('state', ['finished', 'cut'])
def test_chunks_that_stand_twice_or_are_swapped_are_named(whole, tmp_path, state):
    data, everything = (whole / 'run_0.mcap').read_bytes(), raws(whole)
    places = chunk_places(data)
    end = len(data) if state == 'finished' else places[-1][1]
    (a, b), (c, d) = places[10], places[20]
    file = tmp_path / 'twice_0.mcap'
    file.write_bytes(data[:b] + data[a:b] + data[b:end])
    with pytest.raises(BagError, match=f'at byte {b}: a copy of the chunk at byte {a}'):
        raws(file)
    assert f'at byte {b}: a copy of the chunk at byte {a}' in info(file, check=True).damage
    recovered = recover(file)
    assert (raws(recovered.path) == everything and not recovered.missing
            and info(recovered.path, check=True).is_sound)
    file = tmp_path / 'swapped_0.mcap'
    file.write_bytes(data[:a] + data[c:d] + data[b:c] + data[a:b] + data[d:end])
    found = info(file, check=True)
    assert ('out of order' in found.damage and 'no chunk has' not in found.damage
            and not found.missing)
    recovered = recover(file)
    assert (sorted(raws(recovered.path)) == sorted(everything)
            and 'out of order' in recovered.damaged[0])


# --- definitions ---------------------------------------------------------------------------------

def loose_bag(path, count=6):
    """Write a bag with definitions outside of its chunks and in its first two."""
    data, _ = small_bag(path)
    first = chunk_places(data)[0][0]
    loose = b''.join(encoded(record)
                     for record in (Schema(1, b'string data', 'ros2msg', 'std_msgs/msg/String'),
                                    Channel(1, '/a', 'cdr', {'a': 'b'}, 1),
                                    Channel(2, '/b', 'cdr', {'a': 'b'}, 1)))
    return data[:first], loose, data[first:chunk_places(data)[-1][1]]


def test_definitions_outside_of_chunks_cost_no_chunk_and_no_name(tmp_path):
    file = tmp_path / 'loose_0.mcap'
    head, loose, rest = loose_bag(file)
    everything = [raw[:2] for raw in raws(file)]
    for place in range(len(loose)):
        spoiled = bytearray(loose)
        spoiled[place] ^= 1
        file.write_bytes(head + spoiled + rest)
        recovered = recover(file, tmp_path / 'out')
        assert [raw[:2] for raw in raws(recovered.path)] == everything, place
        shutil.rmtree(recovered.path)


@pytest.mark.slow
@pytest.mark.parametrize('hit', [0, 1])
def test_what_recover_makes_keeps_its_definitions_under_the_checksums_of_two_chunks(tmp_path, hit):
    """Cut a bag, damage its first chunk, recover it, cut and flip every byte again."""
    file = tmp_path / 'one_0.mcap'
    data, end = small_bag(file)
    everything = raws(file)
    place = chunk_places(data)[hit][0] + CRC
    file.write_bytes(data[:place] + bytes([data[place] ^ 1]) + data[place + 1:end])
    once = recover(file, tmp_path / 'once')
    kept = raws(once.path)
    assert len(kept) == len(everything) - 4 and is_part(kept, everything)
    data = next(once.path.glob('*.mcap')).read_bytes()
    places = chunk_places(data)
    at = len(MAGIC)
    while at < places[-1][1]:                       # no definition outside of a chunk
        opcode, length = HEAD.unpack_from(data, at)
        assert opcode not in (Opcode.SCHEMA, Opcode.CHANNEL)
        at += HEAD.size + length
    cut = data[:places[-1][1]]
    for place in range(len(cut)):
        spoiled = bytearray(cut)
        spoiled[place] ^= 1 << place % 8
        file.write_bytes(spoiled)
        again = recover(file, tmp_path / 'again')
        found = raws(again.path)
        shutil.rmtree(again.path)
        assert is_part(found, kept) and len(found) >= len(kept) - 4, place
