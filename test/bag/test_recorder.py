# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The recorder against what can go wrong.

Bad arguments, a slow or full disk, names, clocks, threads.
"""
import os
import subprocess
import sys
import threading
import time

from fourbar_ros.bag.info import info
from fourbar_ros.bag.reader import Bag
from fourbar_ros.bag.recover import recover
from fourbar_ros.bag.write import recorder as intake
from fourbar_ros.bag.write import recorder as writer_module
from fourbar_ros.bag.recorder import BagError, BagWriter
from mcap.reader import make_reader
import pytest
from rosbags.highlevel import AnyReader
from support import bags, TEST
from support.bags import MOTION, motion
import yaml

PATIENCE = 120.0


def open_bag(directory, name='run', **kwargs):
    return BagWriter(directory, name, [MOTION, bags.channel('/other', 'std_msgs/msg/String')],
                     {'who': 'test'},
                     **kwargs)


def numbers(path):
    """Return the numbers that the Motion messages of a bag carry."""
    return [record.message.position for record in Bag(path).records([MOTION.topic])]


def until(condition, what):
    end = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < end, what
        time.sleep(0.002)


def assert_every_reader_takes(path, count):
    """Read a bag with libraries that share no code with ours; every message is there."""
    file, = path.glob('*.mcap')
    with open(file, 'rb') as stream:
        reader = make_reader(stream, validate_crcs=True)
        assert sum(1 for _ in reader.iter_messages()) == count
        assert reader.get_summary().statistics.message_count == count
    for source in (path, file):
        with AnyReader([source]) as reader:
            assert sum(1 for _ in reader.messages()) == count == reader.message_count
    told = yaml.safe_load((path / 'metadata.yaml').read_text())['rosbag2_bagfile_information']
    assert told == Bag(path).metadata() and told['message_count'] == count


@pytest.mark.parametrize('bad', [
    (-1, motion(0)), (2, motion(0)), (2**32, motion(0)), ('0', motion(0)), (None, motion(0)),
    (0.0, motion(0)),
    (0, 'text'), (0, None), (0, [1, 2]), (0, 7), (0, b''), (0, b'abc')])
def test_a_bad_argument_is_refused_and_spoils_nothing(tmp_path, bad):
    writer = open_bag(tmp_path)
    writer.write(0, motion(0))
    with pytest.raises(BagError, match='channel|data'):
        writer.write(*bad)
    for k in range(1, 50):
        assert writer.write(0, motion(k))
    path = writer.close()
    assert numbers(path) == list(range(50))
    assert_every_reader_takes(path, 50)


@pytest.mark.parametrize('bad', [
    {'topic': 'relative'}, {'topic': None}, {'type': 'Motion'}, {'type': 7}, {'schema': b'bytes'},
    {'hash': None},
    {'depth': '10'}])
def test_a_bad_channel_is_refused_before_anything_is_made(tmp_path, bad):
    for channels in ([MOTION._replace(**bad)], [MOTION, MOTION], ['/topic']):
        with pytest.raises(BagError, match='must be|twice'):
            BagWriter(tmp_path, 'run', channels, {})
    for periods in ({'flush_period': 0.0}, {'flush_period': float('nan')}, {'sync_period': -1.0}):
        with pytest.raises(BagError, match='period'):
            BagWriter(tmp_path, 'run', [MOTION], {}, **periods)
    assert not list(tmp_path.iterdir())


def test_buffers_are_copied(tmp_path):
    writer = open_bag(tmp_path)
    buffer = bytearray(motion(1))
    writer.write(0, buffer)
    buffer[:] = motion(2)
    writer.write(0, memoryview(buffer))
    buffer[:] = bytes(len(buffer))
    assert numbers(writer.close()) == [1, 2]


@pytest.mark.parametrize('name', ['../escape', 'a/b', '..', '.', '/absolute', 'new\nline', 'nul\0',
                                  'x' * 300,
                                  'x' * 250, 7])
def test_a_name_that_leads_elsewhere_is_refused_and_leaves_nothing(tmp_path, name):
    with pytest.raises(BagError):
        open_bag(tmp_path / 'bags', name)
    assert (not list((tmp_path / 'bags').glob('*'))
            and [p.name for p in tmp_path.iterdir()] in ([], ['bags']))


def test_a_link_in_the_recording_directory_is_not_followed(tmp_path):
    (tmp_path / 'bags').mkdir()
    (tmp_path / 'bags/link').symlink_to(tmp_path / 'elsewhere')
    with pytest.raises(BagError, match='exists already'):
        open_bag(tmp_path / 'bags', 'link')
    assert not (tmp_path / 'elsewhere').exists()


def test_two_recorders_on_one_name_the_second_is_refused_and_the_first_goes_on(tmp_path):
    first = open_bag(tmp_path)
    first.write(0, motion(0))
    with pytest.raises(BagError, match='exists already'):
        open_bag(tmp_path)
    first.write(0, motion(1))
    assert numbers(first.close()) == [0, 1]
    with pytest.raises(BagError, match='exists already'):
        open_bag(tmp_path)


def test_fresh_names_are_made_when_none_is_given(tmp_path):
    assert len({open_bag(tmp_path, '').close() for _ in range(5)}) == 5


@pytest.mark.parametrize('directory', ['file/below', '/proc/fourbar', '/sys/fourbar'])
def test_a_directory_that_cannot_be_written_is_one_clear_error(tmp_path, directory):
    (tmp_path / 'file').write_text('')
    with pytest.raises(BagError, match='directory|ermitted|denied|such|Read-only|exists'):
        open_bag(tmp_path / directory)


def test_write_after_close_is_refused_and_the_bag_stays_whole(tmp_path):
    writer = open_bag(tmp_path)
    writer.write(0, motion(0))
    path = writer.close()
    assert writer.write(0, motion(1)) is False
    assert writer.close() == path
    assert_every_reader_takes(path, 1)


def test_a_clock_that_steps_back_an_hour_leaves_no_trace(tmp_path, monkeypatch):
    writer = open_bag(tmp_path)
    writer.write(0, motion(0))
    real = time.time_ns
    monkeypatch.setattr(time, 'time_ns', lambda: real() - 3600 * 10**9)
    monkeypatch.setattr(time, 'time', lambda: real() * 1e-9 - 3600)
    for k in range(1, 100):
        writer.write(0, motion(k))
    path = writer.close()
    times = [record.time for record in Bag(path).records()]
    assert times == sorted(times) and times[-1] - times[0] < 60 * 10**9


class SlowDisk:
    """Holds every flush of a writer until released."""

    def __init__(self, writer):
        self.released, self.held = threading.Event(), threading.Event()
        container = writer._parts.container
        append = container._append

        def slow(data):
            self.held.set()
            assert self.released.wait(PATIENCE)
            append(data)
        container._append = slow


def test_a_disk_that_hangs_never_holds_up_the_caller_and_drops_are_counted(tmp_path, monkeypatch):
    monkeypatch.setattr(intake, 'QUEUE_MESSAGES', 100)
    told = []
    writer = open_bag(tmp_path, tell=told.append)
    disk = SlowDisk(writer)
    writer.write(0, motion(0))
    assert disk.held.wait(PATIENCE)
    # a caller that waited for the disk would never come to its release
    accepted = [writer.write(0, motion(k)) for k in range(1, 1001)]
    assert not disk.released.is_set()
    disk.released.set()
    path = writer.close()
    assert (accepted == [True] * 100 + [False] * 900 and writer.dropped == 900 and writer.accepted
            == 101)
    assert len(told) == 1 and 'dropped' in told[0]
    assert numbers(path) == list(range(101))
    # the gap is at the end, no later number shows it
    found = info(path)
    assert (found.dropped == found.missing == 900 and not found.is_sound and found.ended
            == 'stopped')
    checked = info(path, check=True)
    assert [topic.missing for topic in found.topics] == [topic.missing for topic in checked.topics]


def test_dropped_messages_leave_a_gap_that_info_counts(tmp_path, monkeypatch):
    writer = open_bag(tmp_path)
    for k in range(10):
        writer.write(0, motion(k))
    monkeypatch.setattr(intake, 'QUEUE_BYTES', 0)
    for k in range(10, 17):
        assert not writer.write(0, motion(k))
    monkeypatch.undo()
    writer.write(0, motion(17))
    path = writer.close()
    assert [raw.sequence for raw in Bag(path).raw()] == [*range(10), 17]
    for check in (False, True):
        found = info(path, check)
        assert ([topic.missing for topic in found.topics] == [7, 0] and not found.is_sound
                and found.dropped == 7)


def test_each_message_of_a_step_that_is_dropped_counts(tmp_path, monkeypatch):
    writer = open_bag(tmp_path)
    step = [(0, motion(1)), (1, bags.encode('std_msgs/msg/String', data='x'))]
    assert writer.write_all(step)
    monkeypatch.setattr(intake, 'QUEUE_BYTES', 0)
    assert not writer.write_all(step) and not writer.write_all(step)
    assert (writer.accepted, writer.dropped) == (2, 4)
    monkeypatch.undo()
    found = info(writer.close())
    assert [topic.missing for topic in found.topics] == [2, 2] and found.dropped == 4


def test_a_message_that_would_be_more_than_the_queue_may_hold_is_dropped(monkeypatch):
    monkeypatch.setattr(intake, 'QUEUE_BYTES', 10)
    told = []
    queue = intake.Intake(1, lambda: told.append('dropped'))
    assert not queue.put([(0, b'x' * 11)]) and queue.put([(0, b'x' * 10)])
    assert not queue.put([(0, b'x')]) and not queue.put([(0, b'x')])
    queue.drain(lambda *_: None)
    assert queue.put([(0, b'x' * 4), (0, b'x' * 6)])
    assert (queue.accepted, queue.dropped, queue.waiting, told) == (3, 3, 2, ['dropped'])
    queue.count(2)                      # the disk took two of the six that were given
    assert (queue.accepted, queue.dropped) == (2, 4)


def test_sequence_numbers_take_all_32_bits_and_begin_again():
    queue, taken = intake.Intake(2, print), []
    queue.given[0] = 2**32 - 2
    for _ in range(4):
        assert queue.put([(0, b'data')])
    queue.drain(lambda _, messages: taken.extend(messages))
    assert [sequence for _, sequence, _ in taken] == [2**32 - 2, 2**32 - 1, 0, 1]
    assert {channel for channel, *_ in taken} == {1} and queue.given == [2**32 + 2, 0]


@pytest.mark.slow
def test_a_jointstate_of_a_million_joints_is_recorded_or_dropped_never_fatal(
        tmp_path, monkeypatch):
    import numpy as np
    count = 1_000_000
    data = bags.encode('sensor_msgs/msg/JointState', header=bags.stamp(1), name=[''] * count,
                       position=np.arange(float(count)), velocity=np.zeros(count),
                       effort=np.zeros(count))
    writer = BagWriter(tmp_path, 'big',
                       [bags.channel('/joint_states', 'sensor_msgs/msg/JointState')], {})
    assert writer.write(0, data)
    monkeypatch.setattr(intake, 'QUEUE_BYTES', len(data) - 1)
    assert not writer.write(0, data) and writer.dropped == 1
    path = writer.close()
    raw, = Bag(path).raw()
    assert raw.data == data
    file, = path.glob('*.mcap')
    with open(file, 'rb') as stream:
        assert sum(1 for _ in make_reader(stream, validate_crcs=True).iter_messages()) == 1


@pytest.mark.slow
def test_many_threads_lose_nothing_and_time_never_goes_back(tmp_path):
    writer = open_bag(tmp_path)

    def work(first):
        for k in range(first, first + 3000):
            writer.write(0, motion(k))
    threads = [threading.Thread(target=work, args=(10_000 * i,)) for i in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    path = writer.close()
    raws = list(Bag(path).raw())
    assert [raw.sequence for raw in raws] == list(range(12_000))
    assert sorted(numbers(path)) == [10_000 * i + k for i in range(4) for k in range(3000)]
    assert all(a.time <= b.time for a, b in zip(raws, raws[1:]))


FULL = """
import resource, sys, time
sys.path[:0] = [{test!r}]
from support import bags
from fourbar_ros.bag.recorder import BagError, BagWriter
import os
resource.setrlimit(resource.RLIMIT_FSIZE, (60_000, 60_000))
told = []
writer = BagWriter({path!r}, 'run', [bags.MOTION], {{}}, tell=told.append, flush_period=0.01)
k = 0
end = time.monotonic() + 30
while not writer.error and time.monotonic() < end:
    writer.write(0, bags.encode('fourbar_msgs/msg/Motion', header=bags.stamp(k), position=float(k),
                                velocity=float(int.from_bytes(os.urandom(7), 'big')),
                                acceleration=0.0))
    flushed = sum(writer._parts.container.counts.values())
    k += 1
    time.sleep(0.0001)
assert not writer.write(0, bags.motion(k))
try:
    writer.close()
except BagError as error:
    assert len(told) == 1 and str(error) == told[0], (told, error)
    print(flushed, error)
"""


def test_a_full_disk_is_reported_once_the_caller_lives_and_the_bag_holds_all_that_was_flushed(
        tmp_path):
    done = subprocess.run([sys.executable, '-c', FULL.format(test=str(TEST), path=str(tmp_path))],
                          capture_output=True, text=True, timeout=60, check=False, env=os.environ)
    assert done.returncode == 0, done.stderr
    flushed, said = done.stdout.split(' ', 1)
    assert 'File too large' in said
    found = numbers(tmp_path / 'run')
    assert found == list(range(len(found))) and len(found) >= int(flushed) > 100
    if 'whole' in said:
        assert_every_reader_takes(tmp_path / 'run', len(found))
    else:
        assert 'fourbar bag recover' in said
    recovered = recover(tmp_path / 'run', tmp_path / 'again')
    assert numbers(recovered.path) == found
    assert_every_reader_takes(recovered.path, len(found))


def test_a_disk_that_gets_full_ends_the_bag_whole_while_there_is_room(tmp_path, monkeypatch):
    monkeypatch.setattr(writer_module, 'SPACE_PERIOD', 0.0)
    told = []
    writer = open_bag(tmp_path, tell=told.append)
    for k in range(20):
        writer.write(0, motion(k))
    usage = type('Usage', (), {'free': writer_module.SPACE_LEFT - 1})
    monkeypatch.setattr(writer_module.shutil, 'disk_usage', lambda path: usage)
    until(lambda: told, 'the recorder ends')
    with pytest.raises(BagError, match='MiB free.*the bag is whole, 20 messages'):
        writer.close()
    assert_every_reader_takes(tmp_path / 'run', 20)
    with pytest.raises(BagError, match='MiB free'):
        open_bag(tmp_path, 'next')
    assert not (tmp_path / 'next').exists()


def test_an_empty_bag_passes_every_reader(tmp_path):
    path = open_bag(tmp_path).close()
    assert_every_reader_takes(path, 0)
    assert list(Bag(path).raw()) == [] and info(path, check=True).is_sound


def test_a_bag_says_that_it_is_being_written_and_can_be_read_and_followed_meanwhile(tmp_path):
    writer = open_bag(tmp_path, flush_period=0.01)
    path = writer.path
    followed = []
    reader = threading.Thread(target=lambda: followed.extend(
        record.message.position for record in Bag(path).records([MOTION.topic], follow=True)))
    reader.start()
    for k in range(50):
        writer.write(0, motion(k))
    until(lambda: len(followed) == 50, 'the follower')
    assert info(path).state == 'being written' and numbers(path) == list(range(50))
    with pytest.raises(BagError, match='being written'):
        recover(path)
    for k in range(50, 60):
        writer.write(0, motion(k))
    writer.close()
    reader.join(PATIENCE)
    assert followed == list(range(60)) and info(path).state == 'finished'
