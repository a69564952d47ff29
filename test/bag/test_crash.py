"""
kill -9 at random moments.

Nothing older than one flush period plus one flush is lost, nothing is missing in between, and
what recover makes passes every reader.
"""
import mmap
import os
from pathlib import Path
import random
import struct
import subprocess
import sys
import tempfile
import time

from bag.test_recorder import assert_every_reader_takes, numbers, PATIENCE
from fourbar_ros.bag.info import info
from fourbar_ros.bag.reader import Bag
from fourbar_ros.bag.recover import recover
from fourbar_ros.bag.recorder import FLUSH_PERIOD
import pytest
from support import TEST
from support.samples import some

# One flush, and the thread being woken: both wait for a processor, which on a busy machine takes a
# while.
# The promise itself is FLUSH_PERIOD; bench/recording.py states what is really lost.
SLACK = 0.3
RATE = {'busy': 1000.0, 'slow': 50.0, 'burst': None, 'silent': None, 'closing': None}
FAST, SLOW = 8, 40

# The child writes numbered messages; behind each, number and time go to memory it shares with us.
CHILD = """
import mmap, struct, sys, time
sys.path.insert(0, {test!r})
from support import bags
from fourbar_ros.bag.recorder import BagWriter
kind, rate = {kind!r}, {rate!r}
with open({log!r}, 'r+b') as file:
    log = mmap.mmap(file.fileno(), 0)
message = [bags.motion(k) for k in range(4000)]
writer = BagWriter({path!r}, 'run', [bags.MOTION], {{}})
def write(k):
    assert writer.write(0, message[k % 4000][:])
    struct.pack_into('<dq', log, 16 * (k + 1), time.monotonic(), k)
    struct.pack_into('<q', log, 0, k + 1)
def mark(number):
    struct.pack_into('<q', log, 8, number)
mark(1)
if kind == 'silent':
    time.sleep(60)
elif kind == 'burst':
    for k in range(30):
        write(k)
    mark(2)
    time.sleep(60)
elif kind == 'closing':
    for k in range(3000):
        write(k)
    mark(2)
    writer.close()
    mark(3)
    time.sleep(60)
else:
    began = time.monotonic()
    for k in range(60000):
        time.sleep(max(0.0, began + k / rate - time.monotonic()))
        write(k)
"""


class Child:
    """A recorder in a process of its own, and the memory it shares with us."""

    def __init__(self, folder, kind):
        self.path = folder / 'run'
        log = folder / 'log'
        log.write_bytes(bytes(16 * 70_000))
        with open(log, 'r+b') as file:
            self._log = mmap.mmap(file.fileno(), 0)
        code = CHILD.format(
            test=str(TEST),
            path=str(folder),
            log=str(log),
            kind=kind,
            rate=RATE[kind])
        self.process = subprocess.Popen(
            [sys.executable, '-c', code], stderr=subprocess.PIPE, env=os.environ)

    @property
    def count(self):
        """Return how many messages were accepted."""
        return struct.unpack_from('<q', self._log, 0)[0]

    def wait_for(self, mark):
        """Wait until the child has come to a mark."""
        end = time.monotonic() + PATIENCE
        while struct.unpack_from('<q', self._log, 8)[0] < mark:
            assert self.process.poll() is None, self.process.stderr.read()
            assert time.monotonic() < end
            time.sleep(0.001)

    def kill(self):
        """Kill it; return (messages accepted, their times, time of the kill)."""
        moment = time.monotonic()
        self.process.kill()
        self.process.wait()
        self.process.stderr.close()
        count = self.count
        return [struct.unpack_from('<d', self._log, 16 * (k + 1))[0] for k in range(count)], moment


def kill_once(kind, seed):
    """Kill a recorder at a random moment; return how much was lost [s]."""
    wait = random.Random(seed).uniform
    with tempfile.TemporaryDirectory(prefix='fourbar_crash_') as folder:
        child = Child(Path(folder), kind)
        child.wait_for(2 if kind in ('burst', 'closing') else 1)
        waits = {'busy': (0.2, 1.5), 'slow': (0.2, 1.5), 'burst': (FLUSH_PERIOD + SLACK, 0.8),
                 'silent': (0.0, 0.3), 'closing': (0.0, 0.02)}
        time.sleep(wait(*waits[kind]))
        times, moment = child.kill()
        found = numbers(child.path)
        expected = [k % 4000 for k in range(len(found))]
        # in order, without a gap
        assert found == expected
        assert [raw.sequence for raw in Bag(child.path).raw()] == list(range(len(found)))
        # the last message may be in the bag before the child could note it
        lost = [t for t in times[len(found):] if t < moment]
        assert all(moment - t <= FLUSH_PERIOD + SLACK for t in lost), moment - lost[0]
        if kind == 'burst':
            assert len(found) == 30
        state = info(child.path, check=True)
        assert not state.damage and all(not topic.missing for topic in state.topics)
        recovered = recover(child.path, Path(folder) / 'whole')
        assert numbers(recovered.path) == expected and not recovered.damaged
        assert_every_reader_takes(recovered.path, len(expected))
        return moment - lost[0] if lost else 0.0


def kinds(kills):
    return [
        pytest.param(
            list(RATE)[
                i %
                len(RATE)],
            i,
            id=f'{list(RATE)[i % len(RATE)]}-{i}') for i in range(kills)]


@some('kind, seed', kinds(FAST), 1)
def test_a_kill_loses_at_most_one_flush_period(kind, seed):
    kill_once(kind, seed)


@pytest.mark.slow
@pytest.mark.parametrize(('kind', 'seed'), kinds(SLOW))
def test_a_kill_loses_at_most_one_flush_period_40_times(kind, seed):
    kill_once(kind, 1000 + seed)
