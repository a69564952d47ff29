# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Bags of several files: as rosbag2 splits them, and as our recorder does."""
import math
import shutil
import subprocess
import sys
import threading
import time

from fourbar_ros.bag import rosbag2 as rosbag2_folder
from fourbar_ros.bag.diff import diff
from fourbar_ros.bag.recompute import recompute
from fourbar_ros.bag.mcap import scan
from fourbar_ros.bag.info import info
from fourbar_ros.bag.origin import origin_of
from fourbar_ros.bag.read.playback import play
from fourbar_ros.bag.reader import Bag
from fourbar_ros.bag.recover import recover
from fourbar_ros.bag.write import recorder as intake
from fourbar_ros.bag.recorder import BagWriter, Split
from fourbar_ros.cli.main import main
from fourbar_ros.errors import BagError
from mcap.reader import make_reader
from mcap.writer import Writer
import pytest
from rosbags.highlevel import AnyReader
from rosbags.rosbag2 import Reader
from support import bags
from support.samples import some
from support.scenes import OUTPUTS, PAPER, ROCKER, RODS, TIP
import yaml

FULL = {**PAPER, **RODS, **TIP, 'outputs': OUTPUTS, 'drive.source': 'motion'}
STEPS = 300


@pytest.fixture(scope='module')
def bag(tmp_path_factory):
    """Return a bag of one file, steps 1 ms apart."""
    return bags.run(tmp_path_factory.mktemp('split'), 'run', FULL,
                    [(0.05 * k, 25.0, 0.1 * k) for k in range(STEPS)],
                    paced=True, flush_period=0.01)


def as_rosbag2_splits(bag, directory, bounds, name='run', about=True, reverse=True):
    """
    Write a bag again with the mcap library as rosbag2 lays out a split one.

    Channels numbered anew in each file.
    """
    folder = directory / name
    folder.mkdir()
    metadata = Bag(bag).metadata()
    raws, files = list(Bag(bag).raw()), []
    source = Bag(bag)
    list(source.chunks())
    for part, (begin, end) in enumerate(zip((0, *bounds), (*bounds, len(raws)))):
        files.append(f'{name}_{part}.mcap')
        with open(folder / files[-1], 'wb') as file:
            writer = Writer(file, chunk_size=20_000)
            writer.start('ros2', 'libmcap 1.3.0')
            channels = sorted(source.channels.values(), key=lambda c: c.topic, reverse=reverse
                              and part % 2 == 1)
            numbers, schemas = {}, {}
            for channel in channels:
                type_name = source.type_of(channel.topic)
                if type_name not in schemas:
                    schemas[type_name] = writer.register_schema(type_name, 'ros2msg',
                                                                bags.text_of(type_name).encode())
                numbers[channel.topic] = writer.register_channel(channel.topic, 'cdr',
                                                                 schemas[type_name],
                                                                 channel.metadata)
            for raw in raws[begin:end]:
                writer.add_message(numbers[raw.topic], raw.time, raw.data, raw.time, 0)
            told = {**metadata, 'relative_file_paths': [files[-1]],
                    'custom_data': metadata['custom_data'] if about else {}}
            writer.add_metadata('rosbag2', {'serialized_metadata': yaml.safe_dump(told)})
            writer.finish()
    (folder / 'metadata.yaml').write_text(yaml.safe_dump({'rosbag2_bagfile_information': {
        **metadata, 'relative_file_paths': files}}))
    return folder


def content(path, **kwargs):
    return [(raw.topic, raw.type, raw.time, raw.data) for raw in Bag(path).raw(**kwargs)]


def test_a_bag_split_by_rosbag2_is_read_as_one(bag, tmp_path):
    split = as_rosbag2_splits(bag, tmp_path, (700, 701, 1500))
    assert content(split) == content(bag) and len(Bag(split).files) == 4
    assert (len({channel.id for channel in Bag(split / 'run_1.mcap').summary().channels.values()})
            == len(OUTPUTS) + 2)
    for topic in ('/fourbar/state', '/fourbar/points/tip'):
        assert content(split, topics=[topic]) == content(bag, topics=[topic])
    assert {topic.topic: topic.messages for topic in info(split).topics} == {
        topic.topic: topic.messages for topic in info(bag, check=True).topics}
    assert all(topic.is_same() for topic in diff(bag, split))
    found = recompute(split)
    assert (found.inputs == STEPS and found.unmatched == 0
            and max(d.largest for d in found.differences) == 0.0)
    assert [raw.data for raw in play(split, rate=math.inf)] == [raw.data for raw in Bag(bag).raw()]
    assert content(split / 'run_2.mcap') == content(bag)[701:1500]


def test_parts_are_in_the_order_of_their_numbers_not_of_their_names(bag, tmp_path):
    split = as_rosbag2_splits(bag, tmp_path, tuple(range(100, 1200, 100)))
    (split / 'metadata.yaml').unlink()
    assert [file.name for file in Bag(split).files] == [f'run_{k}.mcap' for k in range(12)]
    assert content(split) == content(bag)


def test_files_of_different_bags_in_one_folder_are_not_mixed(bag, tmp_path):
    split = as_rosbag2_splits(bag, tmp_path, (700,))
    (split / 'other_0.mcap').write_bytes((bag / 'run_0.mcap').read_bytes())
    with pytest.raises(BagError, match='of different bags, name one'):
        Bag(split)


def test_only_the_chunks_that_can_matter_are_read(bag, tmp_path, monkeypatch):
    split = as_rosbag2_splits(bag, tmp_path, (700, 1500))
    read = []
    record_at = scan.Scan._record_at
    monkeypatch.setattr(scan.Scan, '_record_at',
                        lambda self, offset, wait=False: read.append(offset) or record_at(
                            self, offset, wait))
    times = [raw.time for raw in Bag(split).raw()]
    everything = len(read)
    for share in (0.5, 0.9, 0.99):
        start = times[0] + round((times[-1] - times[0]) * share)
        read.clear()
        assert content(split, start=start) == [item for item in content(bag) if item[2] >= start]
        read.clear()
        list(Bag(split).raw(start=start))
        # message indices are passed over as well
        assert len(read) < (1.2 - share) * everything / 2
    read.clear()
    assert len(list(Bag(split).raw(['/fourbar/scene']))) == 1 and len(read) < everything / 10


def test_a_damaged_chunk_that_is_read_by_the_index_is_an_error(bag, tmp_path):
    split = as_rosbag2_splits(bag, tmp_path, (700,))
    file = split / 'run_1.mcap'
    chunk = max(Bag(file).summary().chunk_indexes, key=lambda chunk: chunk.chunk_length)
    data = bytearray(file.read_bytes())
    data[chunk.chunk_start_offset + chunk.chunk_length // 2] ^= 4
    file.write_bytes(data)
    with pytest.raises(BagError, match=r'run_1.mcap: at byte \d+: chunk'):
        list(Bag(split).raw(['/fourbar/state']))


# --- our recorder --------------------------------------------------------------------------------

def split_run(directory, split, steps=600, step_ns=10**6, values=FULL, changes=(), name='run',
              **kwargs):
    """Record a run with a small flush period into a split bag."""
    cranks = [(0.05 * k, 25.0, 0.1 * k) for k in range(steps)]
    return bags.run(directory, name, values, cranks, changes, step_ns=step_ns, paced=True,
                    flush_period=0.01,
                    sync_period=0.0, split=split, **kwargs)


def numbers_of(path):
    """Return {topic: sequence numbers} of all messages."""
    found = {}
    for raw in Bag(path).raw():
        found.setdefault(raw.topic, []).append(raw.sequence)
    return found


SPLITS = {'duration': Split(duration=0.1, head=0), 'any message': Split(duration=0.0371),
          'size': Split(size=10_000, head=0)}


@some('split', SPLITS.values(), 2, ids=SPLITS)
def test_a_bag_is_split_without_losing_a_message(tmp_path, split):
    path = split_run(tmp_path, split)
    files = Bag(path).files
    # by size, a part ends at a flush, and a busy machine flushes less often
    assert len(files) > (1 if split.size else 2)
    assert [file.name for file in files] == [f'run_{k}.mcap' for k in range(len(files))]
    for sequences in numbers_of(path).values():
        assert sequences == list(range(len(sequences)))
    whole = split_run(tmp_path, Split(), name='whole')
    assert len(Bag(whole).files) == 1
    assert [(raw.topic, raw.data) for raw in Bag(path).raw()] == [(raw.topic, raw.data)
                                                                  for raw in Bag(whole).raw()]
    for check in (False, True):
        found = info(path, check=check)
        assert (found.is_sound and found.parts == len(files) and found.missing == 0 and found.ended
                == 'stopped')
        assert {topic.topic: topic.messages for topic in found.topics} == {
            topic.topic: topic.messages for topic in info(whole).topics}
    found = recompute(path)
    assert not found.problems() and found.inputs == 600 and found.uncertain == 0


def test_each_part_can_be_read_alone(tmp_path):
    changes = {250: {'linkage.a1': 0.35}}
    path = split_run(tmp_path, Split(duration=0.1, head=0), changes=changes)
    files = Bag(path).files
    for k, file in enumerate(files):
        found = info(file, check=True)
        assert found.is_sound and found.ended == ('stopped' if file == files[-1]
                                                  else 'split'), file
        first = next(Bag(file).raw())
        assert first.topic == '/fourbar/scene'
        recomputed = recompute(file)
        assert (not recomputed.problems() and recomputed.inputs >= 100 - (k == 0)
                and recomputed.largest == 0.0)
        assert origin_of(file).scene.linkage.lengths[0] == (0.35 if k > 2 else 0.4)
        begun = [raw.topic for raw in list(Bag(file).raw())[:len(OUTPUTS) + 2]]
        assert sorted(begun) == sorted({raw.topic for raw in Bag(path).raw()})
        assert_every_reader_takes(file, sum(1 for _ in Bag(file).raw()))
    assert not recompute(path).problems()


def assert_every_reader_takes(path, count):
    with open(path, 'rb') as file:
        assert sum(1 for _ in make_reader(file, validate_crcs=True).iter_messages()) == count
    with AnyReader([path]) as reader:
        assert sum(1 for _ in reader.messages()) == count


def test_the_folder_is_laid_out_as_rosbag2_lays_out_a_split_bag(tmp_path):
    path = split_run(tmp_path, Split(duration=0.1, head=0))
    told = yaml.safe_load((path / 'metadata.yaml').read_text())['rosbag2_bagfile_information']
    counts, begins, ends = [], [], []
    for file in Bag(path).files:
        with open(file, 'rb') as opened:
            statistics = make_reader(opened).get_summary().statistics
        counts.append(statistics.message_count)
        begins.append(statistics.message_start_time)
        ends.append(statistics.message_end_time)
    assert (told['version'] == 9 and told['relative_file_paths']
            == [file.name for file in Bag(path).files])
    assert [file['path'] for file in told['files']] == told['relative_file_paths']
    assert ([file['message_count'] for file in told['files']] == counts and told['message_count']
            == sum(counts))
    assert [file['starting_time']['nanoseconds_since_epoch'] for file in told['files']] == begins
    assert told['starting_time']['nanoseconds_since_epoch'] == begins[0]
    assert told['duration']['nanoseconds'] == ends[-1] - begins[0]
    assert sum(topic['message_count']
               for topic in told['topics_with_message_count']) == sum(counts)
    with Reader(path) as reader:
        assert reader.message_count == sum(counts) == sum(1 for _ in reader.messages())


def test_only_the_newest_parts_are_kept(tmp_path):
    path = split_run(tmp_path, Split(keep=0.2, head=0), steps=1500)
    files = Bag(path).files
    assert (10 <= len(files) <= 12 and files[-1].name == 'run_74.mcap'
            and sorted(path.glob('*.mcap')) == sorted(files))
    stamps = [r.message.header.stamp.nanosec for r in Bag(path).records(['/fourbar/state'])]
    assert stamps[-1] == stamps[0] // 10**9 + 1_500 * 10**6 % 10**9 and 200 <= len(stamps) < 250
    assert [b - a for a, b in zip(stamps[1:], stamps[2:])] == [10**6] * (len(stamps) - 2)
    found = info(path, check=True)
    assert found.is_sound and info(path).is_sound and found.missing == 0
    assert not recompute(path).problems()
    told = yaml.safe_load((path / 'metadata.yaml').read_text())['rosbag2_bagfile_information']
    assert told['relative_file_paths'] == [file.name for file in files]
    with Reader(path) as reader:
        assert reader.message_count == sum(1 for _ in reader.messages())


@pytest.mark.slow
def test_dropped_messages_are_counted_over_the_whole_bag(tmp_path, monkeypatch):
    path = split_run(tmp_path, Split(duration=0.1, head=0))
    intake.QUEUE_MESSAGES, old = 50, intake.QUEUE_MESSAGES
    try:
        path = split_run(tmp_path, Split(duration=0.05, head=0), name='full', steps=4000)
    finally:
        intake.QUEUE_MESSAGES = old
    for check in (False, True):
        found = info(path, check=check)
        assert found.parts > 3 and not found.is_sound and found.missing == found.dropped > 0
    assert (sum(len(s) for s in numbers_of(path).values()) + found.missing == (len(OUTPUTS) + 1)
            * 4000 + 1)


def test_values_held_from_before_a_part_are_not_called_wrong(tmp_path):
    values = {**ROCKER, **RODS, 'outputs': ['state', 'loads', 'joint_states'],
              'drive.out_of_range': 'hold'}
    cranks = [(0.3 if k < 50 else 3.0, 1.0, 0.0) for k in range(400)]
    path = bags.run(tmp_path, 'run', values, cranks, paced=True, sync_period=0.0,
                    split=Split(duration=0.1, head=0))
    assert not recompute(path).problems() and recompute(path).uncertain == 0
    for file in Bag(path).files[1:]:
        found = recompute(file)
        assert found.uncertain > 100 and found.problems() == ['nothing could be compared']


def test_a_split_bag_being_written_is_followed_into_its_next_parts(tmp_path):
    channel = bags.MOTION
    writer = BagWriter(tmp_path, 'run', [channel], {}, flush_period=0.01, sync_period=0.0,
                       split=Split(duration=0.02))
    heard = []
    reader = threading.Thread(target=lambda: heard.extend(
        raw.sequence for raw in Bag(tmp_path / 'run').raw(follow=True)))
    writer.write(0, bags.motion(0))
    reader.start()
    for k in range(1, 300):
        writer.write(0, bags.motion(k))
        time.sleep(0.001)
    writer.close()
    reader.join(60)
    assert (not reader.is_alive() and heard == list(range(300))
            and len(Bag(tmp_path / 'run').files) > 3)


def test_a_killed_recorder_leaves_whole_parts_and_a_cut_one(tmp_path):
    code = f"""
import sys, time
sys.path.insert(0, {str(bags.ROOT / 'test')!r})
from support import bags
from fourbar_ros.bag.recorder import BagWriter, Split
writer = BagWriter({str(tmp_path)!r}, 'run', [bags.MOTION], {{}}, split=Split(duration=0.15))
k = 0
while True:
    writer.write(0, bags.motion(k))
    k += 1
    time.sleep(0.001)
"""
    child = subprocess.Popen([sys.executable, '-c', code])
    try:
        end = time.monotonic() + 60
        while time.monotonic() < end and not (tmp_path / 'run/run_3.mcap').exists():
            time.sleep(0.02)
        time.sleep(0.1)
    finally:
        child.kill()
        child.wait()
    found = info(tmp_path / 'run')
    assert found.state == 'cut' and not found.damage and found.missing == 0 and found.parts >= 4
    sequences = numbers_of(tmp_path / 'run')['/fourbar/driven']
    assert sequences == list(range(len(sequences))) and len(sequences) >= found.parts - 1
    for file in Bag(tmp_path / 'run').files[:3]:
        assert info(file, check=True).is_sound


def test_a_disk_that_is_full_at_a_split_leaves_the_part_before_whole(tmp_path, monkeypatch):
    created = []

    def create(folder, number):
        created.append(number)
        raise OSError(28, 'No space left on device')
    monkeypatch.setattr(rosbag2_folder, 'create_part', create)
    writer = BagWriter(tmp_path, 'run', [bags.MOTION], {}, flush_period=0.01, sync_period=0.0,
                       split=Split(duration=0.02))
    end = time.monotonic() + 60
    while not writer.error and time.monotonic() < end:
        writer.write(0, bags.motion(1))
        time.sleep(0.001)
    with pytest.raises(BagError, match='No space left'):
        writer.close()
    found = info(tmp_path / 'run', check=True)
    assert (created == [1] and found.state == 'finished' and 'No space left' in found.ended
            and found.parts == 1)


def test_a_split_bag_that_was_killed_is_recovered_part_by_part(tmp_path):
    path = split_run(tmp_path, Split(duration=0.1, head=0))
    before = [(raw.topic, raw.sequence, raw.data) for raw in Bag(path).raw()]
    last = Bag(path).files[-1]
    last.write_bytes(last.read_bytes()[:-900])                 # without its end
    made = recover(path)
    assert made.path == tmp_path / 'run_recovered' and not made.missing
    assert [file.name for file in Bag(made.path).files] == [
        f'run_recovered_{k}.mcap' for k in range(len(Bag(path).files))]
    there = [(raw.topic, raw.sequence, raw.data) for raw in Bag(made.path).raw()]
    assert there == [(raw.topic, raw.sequence, raw.data)
                     for raw in Bag(path).raw()] == before[:len(there)]
    assert len(there) > 0.8 * len(before)
    assert info(made.path).state == 'finished' and info(made.path, check=True).missing == 0
    assert info(made.path / f'run_recovered_{len(Bag(path).files) - 1}.mcap',
                check=True).missing == 0
    assert not recompute(made.path).problems() or len(there) < len(before)
    with Reader(made.path) as reader:
        assert reader.message_count == sum(1 for _ in reader.messages())
    with pytest.raises(BagError, match='exists already'):
        recover(path)
    assert sorted(p.name for p in tmp_path.iterdir()) == ['run', 'run_recovered']


def as_a_kill_leaves_it(directory, steps=100):
    """Copy a split bag of two topics while it is written, once all is flushed: a killed one."""
    other = bags.channel('/other', 'std_msgs/msg/String')
    writer = BagWriter(directory, 'run', [bags.MOTION, other], {}, flush_period=0.01,
                       sync_period=0.0, split=Split(duration=0.03, head=0))
    for k in range(steps):
        writer.clock.now = lambda k=k: 10**18 + k * 10**6
        writer.write_all([(0, bags.motion(k)), (1, bags.encode(other.type, data=str(k)))])
    while writer.waiting or sum(1 for _ in Bag(writer.path).raw()) < 2 * steps:
        time.sleep(0.001)
    shutil.copytree(directory / 'run', directory / 'killed')
    writer.close()
    return directory / 'killed'


def test_recovery_of_a_killed_split_bag_misses_and_doubles_nothing(tmp_path):
    path = as_a_kill_leaves_it(tmp_path)
    found = info(path, check=True)
    assert (found.parts, found.missing, found.ended) == (4, 0, '')
    made = recover(path)
    assert (made.messages, made.lost, made.missing) == (200, 0, {})
    assert numbers_of(made.path) == {'/fourbar/driven': list(range(100)),
                                     '/other': list(range(100))}
    found = info(made.path, check=True)
    assert found.is_sound and [topic.messages for topic in found.topics] == [100, 100]
    assert 'without an end' in found.ended


def test_recovery_of_a_split_bag_whose_end_is_in_metadata_alone_doubles_nothing(tmp_path):
    path = as_a_kill_leaves_it(tmp_path)        # as a full disk leaves it: it took the small file
    text = (tmp_path / 'run/metadata.yaml').read_text().replace('run_', 'killed_')
    (path / 'metadata.yaml').write_text(text.replace('ended: stopped', 'ended: disk full'))
    for part in path.glob('run_*.mcap'):
        part.rename(path / part.name.replace('run_', 'killed_'))
    made = recover(path)
    assert (made.messages, made.lost, made.missing) == (200, 0, {})
    assert info(made.path, check=True).is_sound and info(made.path).ended == 'disk full'


def test_a_damaged_part_is_named_and_the_others_are_kept(tmp_path):
    path = split_run(tmp_path, Split(duration=0.1, head=0))
    file = Bag(path).files[1]
    chunk = max(Bag(file).summary().chunk_indexes, key=lambda chunk: chunk.chunk_length)
    data = bytearray(file.read_bytes())
    data[chunk.chunk_start_offset + chunk.chunk_length // 2] ^= 4
    file.write_bytes(data)
    made = recover(path, tmp_path / 'new')
    assert (made.damaged and all(text.startswith('run_1.mcap: ') for text in made.damaged)
            and not made.was_whole)
    found = info(tmp_path / 'new', check=True)
    assert found.parts == len(Bag(path).files) and found.missing == sum(made.missing.values()) > 0


def test_recovery_counts_each_message_once(tmp_path):
    path = split_run(tmp_path, Split(duration=0.1, head=0))
    messages = sum(topic.messages for topic in info(path).topics)
    made = recover(path, tmp_path / 'again')
    assert (made.messages, made.lost, made.missing, made.was_whole) == (messages, 0, {}, True)
    assert sum(1 for _ in Bag(made.path).raw()) == messages and info(made.path).is_sound


def test_recovery_counts_what_a_lost_part_held(tmp_path, capsys):
    path = split_run(tmp_path, Split(duration=0.1, head=0))
    counts = {topic.topic: topic.messages for topic in info(path).topics}
    (path / 'run_2.mcap').unlink()
    left = {topic.topic: topic.messages for topic in info(path, check=True).topics}
    gone = {topic: count - left[topic] for topic, count in counts.items() if count > left[topic]}
    assert set(gone.values()) == {100} and len(gone) == len(counts) - 1      # not the scene
    made = recover(path, tmp_path / 'again')
    assert made.missing == gone and made.messages == sum(left.values())
    found = info(made.path)
    assert not found.is_sound and found.missing == sum(gone.values())
    assert main(['bag', 'recover', str(path), '-o', str(tmp_path / 'third')]) == 3
    assert '100' in capsys.readouterr().out
    damaged = path / 'run_3.mcap'
    damaged.write_bytes(b'nothing of a bag' * 100)
    made = recover(path, tmp_path / 'fourth')
    assert set(made.missing.values()) == {200} and 'run_3.mcap' in made.damaged[0]
