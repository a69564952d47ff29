"""What is left of a bag: cut anywhere, followed by zeros, with a flipped bit; read and recovered."""
import random
import shutil

import pytest

import bags
from bags import MOTION, motion
from fourbar_ros.bag import BagError
from fourbar_ros.bag.info import info
from fourbar_ros.bag.reader import Bag
from fourbar_ros.bag.recover import recover
from fourbar_ros.bag.rosbag2 import Channel
from fourbar_ros.bag.writer import BagWriter
from test_bag_writer import assert_every_reader_takes, numbers

COUNT = 700


@pytest.fixture(scope='module')
def whole(tmp_path_factory):
    """Return the path of a bag of many small chunks."""
    path = tmp_path_factory.mktemp('whole')
    writer = BagWriter(path, 'run', [MOTION, bags.channel('/text', 'std_msgs/msg/String')], {'who': 'test'})
    for k in range(COUNT):
        writer.write(0, motion(k))
        if k % 10 == 0:
            writer.write(1, bags.encode('std_msgs/msg/String', data=f'number {k}'))
            with writer._lock:                            # a flush here and now
                writer._drain()
                writer._container.flush()
    return writer.close()


def raws(path):
    return [(raw.topic, raw.sequence, raw.time, raw.data) for raw in Bag(path).raw()]


def test_200_random_cuts_each_leave_an_exact_prefix_that_recover_makes_whole(whole, tmp_path):
    file = whole / 'run_0.mcap'
    data, everything = file.read_bytes(), raws(whole)
    assert len(everything) == COUNT * 11 // 10
    shuffled = random.Random(5)
    cuts = sorted([0, 1, 7, 8, 9, len(data) - 1, len(data), *(shuffled.randrange(len(data)) for _ in range(200))])
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
            assert 'nothing to recover' in str(error) and not found and not (tmp_path / 'out').exists()
            continue
        assert raws(recovered.path) == found and recovered.messages == len(found)
        assert recovered.was_whole == (cut == len(data)) and 0 <= recovered.lost < cut + 1
        if cut % 10 == 0:
            assert_every_reader_takes(recovered.path, len(found))
        shutil.rmtree(recovered.path)
        assert bag.file == cut_file and cut_file.read_bytes() == data[:cut]
    assert lengths == sorted(lengths) and lengths[-1] == len(everything) and len(set(lengths)) > 50


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


@pytest.mark.slow        # other seeds and clocks find flips that are not seen: open, see CHANGELOG
def test_flipped_bits_are_seen_and_cost_at_most_what_they_hit(whole, tmp_path):
    data, everything = (whole / 'run_0.mcap').read_bytes(), raws(whole)
    shuffled = random.Random(6)
    seen = 0
    for _ in range(60):
        place = shuffled.randrange(9000, len(data) - 20_000)       # behind the schemas, before the summary
        spoiled = bytearray(data)
        spoiled[place] ^= 1 << shuffled.randrange(8)
        file = tmp_path / 'spoiled.mcap'
        file.write_bytes(spoiled)
        try:
            read = raws(file)
        except BagError as error:
            assert 'at byte' in str(error) and 'fourbar bag recover' in str(error)
            assert info(file, check=True).damage
            seen += 1
        else:
            # In an index nothing is lost, in a length all behind it; a record whose type was hit is skipped,
            # as the format asks for unknown types, and the numbers of the messages show the gap.
            assert set(read) <= set(everything) and read == sorted(read, key=everything.index)
            if read != everything[:len(read)]:
                assert not info(file, check=True).is_sound
        recovered = recover(file, tmp_path / 'out')
        kept = raws(recovered.path)
        assert set(kept) <= set(everything) and kept == sorted(kept, key=everything.index)
        if 0 < recovered.lost < 1000:                              # but a wrong length swallows what follows
            assert len(kept) >= len(everything) - 11 * len(recovered.damaged) - 1
        shutil.rmtree(recovered.path)
    assert seen > 30


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
    from mcap.writer import CompressionType, IndexType, Writer
    for i, options in enumerate(({'use_chunking': False}, {'compression': CompressionType.LZ4}, {'enable_crcs': False},
                                 {'compression': CompressionType.NONE, 'index_types': IndexType.NONE})):
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
        assert found == numbers(recovered.path) == list(range(len(found))) and 10 < len(found) < 300
        assert_every_reader_takes(recovered.path, len(found))


def test_a_channel_of_unknown_schema_says_so(tmp_path):
    writer = BagWriter(tmp_path, 'run', [Channel('/odd', 'odd/msg/Odd', 'other/Missing field\n', '', 10)], {})
    writer.write(0, motion(0))
    path = writer.close()
    assert len(raws(path)) == 1
    with pytest.raises(BagError, match='does not define other/Missing'):
        list(Bag(path).records())
