# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Recording: how fast a long bag is written and read, and what memory that takes."""
from contextlib import contextmanager
import json
from math import cos, pi, sin
import os
from pathlib import Path
import struct
import tempfile
import time

from .pages import table

MINUTES = float(os.environ.get('MINUTES', '6'))     # of the long bag; 60 for the whole hour
RATE = 1000                                         # [Hz] all outputs
PERIOD = 5                                          # [s] of a swing, after which all repeats
LARGEST = 25.0                                      # [rad/s] rate of the crank
STAMP = struct.Struct('<iI')


def rss():
    """Return the resident memory [MB]."""
    return int(Path('/proc/self/statm').read_text().split()[1]) * os.sysconf('SC_PAGE_SIZE') / 1e6


def steps():
    """Return (values, channels, about, [[bytes of every topic] of every step of a period])."""
    from fourbar_ros.pipeline import joints
    from fourbar_ros.pipeline.stepper import Stepper, Wanted
    from fourbar_ros.scene import scene as scenes
    from fourbar_ros.scene.topics import DRIVEN
    from support import bags
    from support.scenes import OUTPUTS, PAPER, RODS
    scene = scenes.from_values({**PAPER, **RODS, 'drive.speed': LARGEST,
                                'outputs': [name for name in OUTPUTS if name != 'points']})
    topics = [DRIVEN, *scene.topics.values()]
    names = {topic.name: f'/{topic.topic.replace("~", "fourbar")}' for topic in topics}
    about = {'scene': json.dumps(scene.values), 'topics': json.dumps(names),
             joints.KEY: joints.CONTINUOUS}
    stepper, wanted, messages = Stepper(scene), Wanted.of(scene), []
    # the crank swings: after full turns one way, positions in /joint_states would go on and on
    frequency = 2.0 * pi / PERIOD
    for k in range(PERIOD * RATE):
        phase = frequency * k / RATE
        crank = (LARGEST / frequency * sin(phase), LARGEST * cos(phase),
                 -LARGEST * frequency * sin(phase))
        status, values = stepper.step(*crank, wanted)
        messages.append([bags.output_message(name, 1, status, values, scene)
                         for name in ('driven', *scene.outputs)])
    return [bags.channel(names[t.name], t.type) for t in topics], about, messages


def stamped(step, k):
    """Return the messages of a step with the stamp of sample k."""
    stamp = STAMP.pack(*divmod((k + 1) * (10**9 // RATE), 10**9))
    return [data[:4] + stamp + data[12:] for data in step]


@contextmanager
def measured(what, count, rows):
    """Measure work over ``count`` messages; keep a row, with the growth of the memory."""
    before, begin = rss(), time.process_time()
    yield
    cpu = time.process_time() - begin
    rows.append((what, f'{1e6 * cpu / count:.2f}', f'{60 * MINUTES / cpu:.0f}',
                 f'{rss() - before:+.0f}'))


def write_long(folder, channels, about, messages, total):
    """Write a long bag as fast as it goes; return (path, memory at each tenth [MB])."""
    from fourbar_ros.bag import recorder
    recorder.FLUSH = 0.005      # [s] here: a chunk is then about that of 0.1 s of the run
    writer = recorder.BagWriter(folder, 'long', channels, about)
    memory = []
    for k in range(total):
        if k % 1000 == 0:
            while writer.waiting > recorder.MOST_MESSAGES // 10:
                time.sleep(0.001)
        if k % (total // 10) == 0:
            memory.append(rss())
        writer.write_all(list(enumerate(stamped(messages[k % len(messages)], k))))
    assert not writer.dropped
    return writer.close(), memory


def main():
    """Print speed and memory of a long bag: written, read, checked, recomputed, exported."""
    from fourbar_ros.bag import export, info, recompute, recover
    channels, about, messages = steps()
    total, rows = int(60 * MINUTES * RATE), []
    count = total * len(channels)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        with measured('write', count, rows):
            path, memory = write_long(folder, channels, about, messages, total)
        with measured('`info`', count, rows):
            info(path)
        with measured('`info --check`', count, rows):
            assert info(path, check=True).is_sound
        with measured('`recover`', count, rows):
            recover(path, folder / 'again')
        with measured('`recompute`', count, rows):
            found = recompute(path)
            assert found.inputs == total and found.largest == 0.0
        with measured('`export` npz', count, rows):
            export(path, folder / 'long.npz', 'npz')
        (folder / 'long.npz').unlink()
        with measured('`export` csv, state only', total, rows):
            export(path, folder / 'csv', topics=['/fourbar/state'])
        size = sum(f.stat().st_size for f in path.iterdir())
    print(f'A bag of {MINUTES:g} minutes at {RATE} Hz, {len(channels)} topics, {count} '
          f'messages, {size / 1e6:.0f} MB:\n')
    table(('', 'CPU a message [us]', 'run over CPU time', 'memory [MB]'), rows)
    print('Memory while writing, at each tenth [MB]: ' + ', '.join(f'{m:.0f}' for m in memory))
