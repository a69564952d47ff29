# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The recorder against what can go wrong.

Bad arguments, names, threads, clocks, a slow, full or lost disk; files that follow each other.
"""
import re
import subprocess
import sys
import threading
import time

from fourbar_ros.bag import recorder
from fourbar_ros.bag.overview import info
from fourbar_ros.bag.reader import Bag
from fourbar_ros.bag.recorder import BagWriter
from fourbar_ros.bag.recovery import recover
from fourbar_ros.errors import BagError
from mcap.reader import make_reader
import pytest
from rosbags.highlevel import AnyReader
from support import bags, TEST
from support.bags import MOTION, motion
import yaml

PATIENCE = 120.0
TEXT = bags.channel('/other', 'std_msgs/msg/String')


def open_bag(directory, name='run', **kwargs):
    return BagWriter(directory, name, [MOTION, TEXT], {'who': 'test'}, **kwargs)


def numbers(path):
    """Return the numbers that the Motion messages of a bag carry."""
    return [record.message.position for record in Bag(path).records([MOTION.topic])]


def until(condition, what):
    end = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < end, what
        time.sleep(0.002)


def told_by(path):
    """Return the content of metadata.yaml."""
    return yaml.safe_load((path / 'metadata.yaml').read_text())['rosbag2_bagfile_information']


def assert_every_reader_takes(path, count):
    """Read a bag with the readers of two libraries; every message is there."""
    found = 0
    for file in path.glob('*.mcap'):
        with open(file, 'rb') as stream:
            reader = make_reader(stream, validate_crcs=True)
            read = sum(1 for _ in reader.iter_messages())
            assert read == reader.get_summary().statistics.message_count
            found += read
    assert found == count == told_by(path)['message_count']
    with AnyReader([path]) as reader:
        assert sum(1 for _ in reader.messages()) == count == reader.message_count


# --- arguments, names ----------------------------------------------------------------------------

def test_buffers_are_copied(tmp_path):
    writer = open_bag(tmp_path)
    buffer = bytearray(motion(1))
    writer.write(0, buffer)
    buffer[:] = motion(2)
    writer.write(0, memoryview(buffer))
    buffer[:] = bytes(len(buffer))
    assert numbers(writer.close()) == [1, 2]


@pytest.mark.parametrize('name', ['../escape', 'a/b', '..', '.', '/absolute', 'new\nline', 'nul\0',
                                  'x' * 300, 'x' * 250, 7])
def test_a_name_that_leads_elsewhere_is_refused_and_leaves_nothing(tmp_path, name):
    with pytest.raises(BagError):
        open_bag(tmp_path / 'bags', name)
    assert not list((tmp_path / 'bags').glob('*'))
    assert [path.name for path in tmp_path.iterdir()] in ([], ['bags'])


def test_a_bag_or_a_link_of_that_name_is_not_touched_and_names_from_the_clock_differ(tmp_path):
    first = open_bag(tmp_path)
    first.write(0, motion(0))
    with pytest.raises(BagError, match='exists already'):
        open_bag(tmp_path)
    first.write(0, motion(1))
    assert numbers(first.close()) == [0, 1]
    (tmp_path / 'link').symlink_to(tmp_path / 'elsewhere')
    with pytest.raises(BagError, match='exists already'):
        open_bag(tmp_path, 'link')
    assert not (tmp_path / 'elsewhere').exists()
    fresh = open_bag(tmp_path, '').close()
    time.sleep(0.002)
    assert open_bag(tmp_path, '').close() != fresh


@pytest.mark.parametrize('directory', ['file/below', '/proc/fourbar', '/sys/fourbar'])
def test_a_directory_that_cannot_be_written_is_one_clear_error(tmp_path, directory):
    (tmp_path / 'file').write_text('')
    with pytest.raises(BagError, match='directory|ermitted|denied|such|Read-only|exists'):
        open_bag(tmp_path / directory)


def test_closing_twice_and_writing_after_it_leave_the_bag_whole(tmp_path):
    writer = open_bag(tmp_path)
    writer.write(0, motion(0))
    path = writer.close('because')
    assert writer.write(0, motion(1)) is False and writer.close('again') == path
    assert_every_reader_takes(path, 1)
    assert info(path).ended == 'because' and Bag(path).about['who'] == 'test'


def test_an_empty_bag_passes_every_reader(tmp_path):
    path = open_bag(tmp_path).close()
    assert_every_reader_takes(path, 0)
    assert not list(Bag(path).raw()) and info(path, check=True).is_sound
    assert Bag(path).types == {MOTION.topic: MOTION.type, TEXT.topic: TEXT.type}


def test_a_bag_can_be_read_while_it_is_written(tmp_path):
    writer = open_bag(tmp_path)
    for k in range(50):
        writer.write(0, motion(k))
    until(lambda: len(numbers(writer.path)) == 50, 'a flush')
    assert not info(writer.path).is_finished
    # rosbag2 plays from the start that metadata.yaml gives
    until(lambda: told_by(writer.path)['message_count'], 'the metadata')
    assert told_by(writer.path)['starting_time']['nanoseconds_since_epoch'] == next(
        Bag(writer.path).raw()).time
    assert info(writer.close()).is_finished


# --- threads, clocks, numbers --------------------------------------------------------------------

def test_threads_lose_nothing_and_time_never_goes_back(tmp_path, monkeypatch):
    writer = open_bag(tmp_path)
    real = time.time_ns
    monkeypatch.setattr(time, 'time_ns', lambda: real() - 3600 * 10**9)

    def work(first):
        for k in range(first, first + 1000):
            writer.write(0, motion(k))
    threads = [threading.Thread(target=work, args=(10_000 * i,)) for i in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    path = writer.close()
    raws = list(Bag(path).raw())
    assert [raw.sequence for raw in raws] == list(range(4000))
    assert sorted(numbers(path)) == [10_000 * i + k for i in range(4) for k in range(1000)]
    assert all(0 <= b.time - a.time < 600 * 10**9 for a, b in zip(raws, raws[1:]))


def test_the_messages_of_a_step_have_one_time(tmp_path):
    writer = open_bag(tmp_path)
    text = bags.encode(TEXT.type, data='x')
    for k in range(9):
        assert writer.write_all([(0, motion(k)), (1, text), (1, text)])
    times = [raw.time for raw in Bag(writer.close()).raw()]
    assert len(times) == 27 and all(len(set(times[k:k + 3])) == 1 for k in range(0, 27, 3))


def test_sequence_numbers_go_round_after_32_bits(tmp_path):
    writer = open_bag(tmp_path)
    writer._sequence[0] = 2**32 - 2
    for k in range(4):
        writer.write(0, motion(k))
    path = writer.close()
    assert [raw.sequence for raw in Bag(path).raw()] == [2**32 - 2, 2**32 - 1, 0, 1]
    assert info(path, check=True).is_sound


# --- disks ---------------------------------------------------------------------------------------

class SlowDisk:
    """Holds every write of a writer until released."""

    def __init__(self, writer):
        self.released, self.held = threading.Event(), threading.Event()
        file = writer._file.stream
        write = file.write

        def slow(data):
            self.held.set()
            assert self.released.wait(PATIENCE)
            write(data)
        file.write = slow


def test_a_disk_that_hangs_never_holds_up_the_caller_and_drops_are_counted(tmp_path, monkeypatch):
    monkeypatch.setattr(recorder, 'MOST_MESSAGES', 100)
    told = []
    writer = open_bag(tmp_path, tell=told.append)
    disk = SlowDisk(writer)
    writer.write(0, motion(0))
    assert disk.held.wait(PATIENCE)
    # a caller that waited for the disk would never come to its release
    accepted = [writer.write_all([(0, motion(k)), (0, motion(k + 1))]) for k in range(1, 1001, 2)]
    assert accepted == [True] * 50 + [False] * 450
    disk.released.set()
    path = writer.close()
    assert (writer.dropped, writer.accepted) == (900, 101)
    assert len(told) == 1 and 'dropped' in told[0]
    assert numbers(path) == list(range(101))
    found = info(path)          # the gap is at the end: no later number shows it
    assert found.dropped == 900 and not found.is_sound


def test_what_is_written_makes_room_for_more(tmp_path, monkeypatch):
    monkeypatch.setattr(recorder, 'MOST_BYTES', 3 * len(motion(0)))
    writer = open_bag(tmp_path)
    for k in range(8):
        assert writer.write(0, motion(k))
        until(lambda: not writer.waiting, 'a flush')
    assert numbers(writer.close()) == list(range(8)) and not writer.dropped


def test_dropped_messages_leave_a_gap_that_info_counts(tmp_path, monkeypatch):
    writer = open_bag(tmp_path)
    for k in range(10):
        writer.write(0, motion(k))
    monkeypatch.setattr(recorder, 'MOST_BYTES', 0)
    for k in range(10, 17):
        assert not writer.write(0, motion(k))
    monkeypatch.undo()
    writer.write(0, motion(17))
    found = info(writer.close(), check=True)
    assert [topic.missing for topic in found.topics] == [7, 0] and found.dropped == 7
    assert not found.is_sound


def test_a_disk_that_gets_full_ends_the_bag_whole_while_there_is_room(tmp_path, monkeypatch):
    told = []
    writer = open_bag(tmp_path, tell=told.append)
    for k in range(20):
        writer.write(0, motion(k))
    usage = type('Usage', (), {'free': recorder.ROOM - 1})
    monkeypatch.setattr(recorder.shutil, 'disk_usage', lambda path: usage)
    until(lambda: told, 'the recorder ends')
    with pytest.raises(BagError, match='MiB free; the bag is whole, 20 messages'):
        writer.close()
    assert_every_reader_takes(tmp_path / 'run', 20)
    assert info(tmp_path / 'run').ended == recorder.NO_ROOM
    with pytest.raises(BagError, match='MiB free'):
        open_bag(tmp_path, 'next')
    assert not (tmp_path / 'next').exists()


FULL = """
import resource, sys, time
sys.path[:0] = [{test!r}]
from support import bags
from fourbar_ros.bag.recorder import BagError, BagWriter
import os
resource.setrlimit(resource.RLIMIT_FSIZE, (60_000, 60_000))
told = []
writer = BagWriter({path!r}, 'run', [bags.MOTION], {{}}, tell=told.append)
k = flushed = 0
while not writer.error:
    writer.write(0, bags.encode('fourbar_msgs/msg/Motion', header=bags.stamp(k), position=float(k),
                                velocity=float(int.from_bytes(os.urandom(7), 'big')),
                                acceleration=0.0))
    k += 1
    flushed = k - writer.waiting if k < 300 else flushed
    time.sleep(0.0003)
assert not writer.write(0, bags.motion(k))
try:
    writer.close()
except BagError as error:
    assert told == [str(error)], (told, error)
    print(error)
"""


def test_a_refused_write_is_told_once_and_leaves_a_cut_bag_that_recover_finishes(tmp_path):
    code = FULL.format(test=str(TEST), path=str(tmp_path))
    done = subprocess.run([sys.executable, '-B', '-c', code],
                          text=True, capture_output=True, timeout=PATIENCE, check=False)
    assert done.returncode == 0, done.stderr
    assert 'File too large; what was flushed is in the file: fourbar bag recover' in done.stdout
    state = info(tmp_path / 'run', check=True)
    assert not state.is_finished and not state.damage and state.size <= 60_000
    found = numbers(tmp_path / 'run')
    assert found == list(range(len(found))) and len(found) > 100
    recovered = recover(tmp_path / 'run')
    assert numbers(recovered.path) == found and not recovered.damage
    assert_every_reader_takes(recovered.path, len(found))


@pytest.mark.parametrize('change', ['removed', 'replaced', 'folder removed'])
def test_a_file_that_is_lost_while_it_is_recorded_is_noticed(tmp_path, change):
    told = []
    writer = open_bag(tmp_path, tell=told.append)
    writer.write(0, motion(0))
    file = writer.path / 'run_0.mcap'
    until(lambda: told_by(writer.path)['message_count'], 'a flush')
    file.unlink()
    if change == 'replaced':
        file.write_bytes(b'another')
    elif change == 'folder removed':
        (writer.path / 'metadata.yaml').unlink()
        writer.path.rmdir()
    until(lambda: told, 'the recorder notices')
    # where the folder goes too, the write of metadata.yaml may notice first
    said = 'removed or replaced|No such file' if 'folder' in change else 'removed or replaced'
    assert re.search(said, told[0]) and len(told) == 1
    with pytest.raises(BagError, match=said):
        writer.close()
    assert not writer.write(0, motion(1))


def test_an_error_of_any_kind_in_the_thread_is_told(tmp_path):
    told = []
    writer = open_bag(tmp_path, tell=told.append, clock=lambda: -1)
    writer.write(0, motion(0))
    until(lambda: told, 'the error')
    assert 'recording stopped: error(' in told[0]
    with pytest.raises(BagError, match='recording stopped'):
        writer.close()


def test_a_disk_that_does_not_answer_holds_up_no_message_at_a_split(tmp_path, monkeypatch):
    monkeypatch.setattr(recorder, 'SYNC', 0.0)
    answers = threading.Event()
    monkeypatch.setattr(recorder.os, 'fsync', lambda number: answers.wait(PATIENCE))
    writer = open_bag(tmp_path, split_size=1)
    for k in range(4):
        writer.write(0, motion(k))
        until(lambda: not writer.waiting, 'a flush')
    until(lambda: numbers(writer.path) == [0, 1, 2, 3], 'the messages in four files')
    answers.set()
    until(lambda: not writer._ended, 'the next sync')
    assert numbers(writer.close()) == [0, 1, 2, 3]


def test_files_of_splits_do_not_stay_open_until_the_next_sync(tmp_path, monkeypatch):
    monkeypatch.setattr(recorder, 'SYNC', PATIENCE)
    monkeypatch.setattr(recorder, 'MOST_FILES', 2)
    writer = open_bag(tmp_path, split_size=1)
    for k in range(8):
        writer.write(0, motion(k))
        until(lambda: not writer.waiting, 'a flush')
    until(lambda: writer._file.path.name == 'run_7.mcap', 'the splits')
    assert len(writer._ended) <= 2
    assert numbers(writer.close()) == list(range(8))


def test_a_sync_that_fails_stops_the_recording_with_what_was_flushed(tmp_path, monkeypatch):
    monkeypatch.setattr(recorder, 'SYNC', 0.1)
    told = []

    def sync(number):
        raise OSError(5, 'Input/output error')
    monkeypatch.setattr(recorder.os, 'fsync', sync)
    writer = open_bag(tmp_path, tell=told.append)
    writer.write(0, motion(0))
    until(lambda: told, 'the error')
    with pytest.raises(BagError, match='Input/output error'):
        writer.close()
    assert numbers(writer.path) in ([], [0]) and len(told) == 1


# --- split bags ----------------------------------------------------------------------------------

def split_bag(directory, count=60, **how):
    """Return a bag of 60 messages 10 ms apart, ten at a time, and its writer."""
    writer = open_bag(directory, **(how or {'split_duration': 0.1}))
    for k in range(count):
        writer.clock = lambda k=k: 10**18 + k * 10**7
        writer.write_all([(0, motion(k)), *([(1, bags.encode(TEXT.type, data='x'))] * (k == 0))])
        if k % 10 == 9:
            until(lambda: not writer.waiting, 'a flush')
    return writer


def test_closing_does_not_wait_for_more_files_than_there_are(tmp_path):
    writer = open_bag(tmp_path, split_size=1)
    for k in range(2000):
        writer.write(0, motion(k))
    assert numbers(writer.close()) == list(range(2000))
    assert len(list(writer.path.glob('*.mcap'))) < 200


@pytest.mark.parametrize('how', [{'split_duration': 0.1}, {'split_size': 3000}])
def test_a_bag_is_split_without_losing_a_message(tmp_path, how):
    writer = split_bag(tmp_path, **how)
    writer.note('scene', 'new')
    path = writer.close('the end')
    files = sorted(path.glob('*.mcap'))
    counts = [sum(topic.messages for topic in info(file).topics) for file in files]
    spans = [(info(file).start, info(file).end) for file in files]
    if how == {'split_duration': 0.1}:
        assert counts == [11, *[10] * 5]
    else:
        assert len(files) > 2 and all(before[1] <= after[0] for before, after in
                                      zip(spans, spans[1:]))
    assert numbers(path) == list(range(60)) and info(path, check=True).is_sound
    assert [raw.sequence for raw in Bag(path).raw([MOTION.topic])] == list(range(60))
    assert_every_reader_takes(path, 61)
    assert [Bag(path).about_of(k)['ended'] for k in (0, -1)] == ['split', 'the end']
    assert Bag(path).about['ended'] == 'the end'
    told = told_by(path)
    assert told['relative_file_paths'] == [f'run_{k}.mcap' for k in range(len(files))]
    assert told['duration']['nanoseconds'] == 59 * 10**7
    assert {topic['topic_metadata']['name']: topic['message_count'] for topic in
            told['topics_with_message_count']} == {MOTION.topic: 60, TEXT.topic: 1}


def test_a_later_file_has_the_texts_noted_before_it_began(tmp_path):
    writer = split_bag(tmp_path, 15)
    writer.note('who', 'changed')
    writer.clock = lambda: 10**18 + 10**9
    writer.write(0, motion(15))
    until(lambda: not writer.waiting, 'a flush')
    path = writer.close()
    assert [Bag(path).about_of(k)['who'] for k in range(3)] == ['test', 'test', 'changed']
    assert Bag(path).about['who'] == 'test'


def test_a_disk_that_is_full_at_a_split_leaves_the_file_before_whole(tmp_path, monkeypatch):
    writer = split_bag(tmp_path, 10)

    def full(*_):
        raise OSError(28, 'No space left on device')
    monkeypatch.setattr(recorder, 'BagFile', full)
    writer.clock = lambda: 10**18 + 10**9
    writer.write(0, motion(10))
    until(lambda: writer.error, 'the error')
    with pytest.raises(BagError, match='No space left'):
        writer.close()
    assert info(writer.path, check=True).is_finished
    assert numbers(writer.path)[:10] == list(range(10))
