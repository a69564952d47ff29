# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""kill -9 at any moment: what is lost is the newest, and no older than a flush takes."""
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
from fourbar_ros.bag.overview import info
from fourbar_ros.bag.reader import Bag
from fourbar_ros.bag.recorder import FLUSH
from fourbar_ros.bag.recovery import recover
import pytest
from support import TEST
from support.samples import more

SLACK = 0.5     # [s] for a flush; its thread waits for a processor as long as the writer's does
RATES = {'fast': 6000.0, 'slow': 50.0, 'split': 1000.0, 'closing': None}

# The child writes numbered messages; number and time of each go to memory it shares with us.
CHILD = """
import mmap, struct, sys, time
sys.path.insert(0, {test!r})
from support import bags
from fourbar_ros.bag.recorder import BagWriter
kind, rate = {kind!r}, {rate!r}
with open({log!r}, 'r+b') as file:
    log = mmap.mmap(file.fileno(), 0)
message = [bags.motion(k) for k in range(1000)]
writer = BagWriter({path!r}, 'run', [bags.MOTION], {{}},
                   split_duration=0.4 if kind == 'split' else 0.0)
def mark(number):
    struct.pack_into('<q', log, 8, number)
def write(k):
    assert writer.write(0, message[k % 1000])
    struct.pack_into('<d', log, 8 * k + 16, time.monotonic())
    struct.pack_into('<q', log, 0, k + 1)
mark(1)
if kind == 'closing':
    for k in range(3000):
        write(k)
    mark(2)
    writer.close()
    time.sleep(60)
else:
    k, began = 0, time.monotonic()
    while k < 60000:
        time.sleep(0.001)
        while k < (time.monotonic() - began) * rate:
            write(k)
            k += 1
"""


def kill_once(kind, seed):
    """Kill a recorder at a random moment; what is lost is younger than a flush."""
    wait = random.Random(seed).uniform
    with tempfile.TemporaryDirectory(prefix='fourbar_crash_') as folder:
        path, log = Path(folder) / 'run', Path(folder) / 'log'
        log.write_bytes(bytes(8 * 61_000))
        with open(log, 'r+b') as file, mmap.mmap(file.fileno(), 0) as shared:
            code = CHILD.format(test=str(TEST), path=folder, log=str(log), kind=kind,
                                rate=RATES[kind])
            process = subprocess.Popen([sys.executable, '-c', code], stderr=subprocess.PIPE,
                                       env=os.environ)
            end = time.monotonic() + PATIENCE
            while struct.unpack_from('<q', shared, 8)[0] < 1 + (kind == 'closing'):
                assert process.poll() is None, process.stderr.read()
                assert time.monotonic() < end
                time.sleep(0.001)
            time.sleep(wait(0.0, 0.02) if kind == 'closing' else wait(0.2, 1.5))
            moment = time.monotonic()
            process.kill()
            process.wait()
            process.stderr.close()
            count, = struct.unpack_from('<q', shared, 0)
            times = struct.unpack_from(f'<{count}d', shared, 16)
        found = numbers(path)
        assert found == [k % 1000 for k in range(len(found))]       # in order, without a gap
        assert [raw.sequence for raw in Bag(path).raw()] == list(range(len(found)))
        # the last message may be in the bag before the child could note it
        age = max([moment - t for t in times[len(found):]], default=0.0)
        waited = max(b - a for a, b in zip(times, (*times[1:], moment)))
        assert age <= FLUSH + SLACK + 3.0 * waited
        state = info(path, check=True)
        assert not state.damage and not state.missing
        if found:
            recovered = recover(path, Path(folder) / 'whole')
            assert not recovered.damage and recovered.messages == len(found)
            assert_every_reader_takes(recovered.path, len(found))


@pytest.mark.parametrize('seed', range(1, more(2, 5)))
@pytest.mark.parametrize('kind', RATES)
def test_a_kill_loses_at_most_what_was_not_yet_flushed(kind, seed):
    kill_once(kind, seed)
