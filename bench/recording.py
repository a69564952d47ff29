# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Recording: what a message costs, what a kill costs, how fast a long bag is written and read."""
from contextlib import contextmanager
import json
import os
from pathlib import Path
from statistics import median
import struct
import tempfile
import threading
import time

MINUTES = float(os.environ.get('MINUTES', '6'))     # of the long bag; 60 for the whole hour
RATE = 1000                                         # [Hz] all outputs
PERIOD = 5                                          # [s] after which the recorded motion repeats
ROUNDS = 5
KILLS = 4
KINDS = {'fast': '6 kHz', 'slow': '50 Hz'}
STAMP = struct.Struct('<iI')


def rss():
    """Return the resident memory [MB]."""
    return int(Path('/proc/self/statm').read_text().split()[1]) * os.sysconf('SC_PAGE_SIZE') / 1e6


def steps():
    """Return (values, channels, about, [[bytes of every topic] of every step of a period])."""
    from fourbar_ros.pipeline.stepper import Stepper
    from fourbar_ros.scene import scene as scenes
    from fourbar_ros.scene.topics import DRIVEN
    from support import bags
    from support.scenes import OUTPUTS, PAPER, RODS
    scene = scenes.from_values({**PAPER, **RODS, 'drive.speed': 25.0,
                                'outputs': [name for name in OUTPUTS if name != 'points']})
    topics = [DRIVEN, *scene.topics.values()]
    names = {topic.name: f'/{topic.topic.replace("~", "fourbar")}' for topic in topics}
    about = {'scene': json.dumps(scene.values), 'topics': json.dumps(names)}
    stepper, messages = Stepper(scene), []
    for k in range(PERIOD * RATE):
        crank = (25.0 * k / RATE, 25.0, 0.0)
        status, values = stepper.step(*crank, True, True)
        messages.append([bags.output_message(name, 1, status, values, scene)
                         for name in ('driven', *scene.outputs)])
    return [bags.channel(names[t.name], t.type) for t in topics], about, messages


def stamped(step, k):
    """Return the messages of a step with the stamp of sample k."""
    stamp = STAMP.pack(*divmod((k + 1) * (10**9 // RATE), 10**9))
    return [data[:4] + stamp + data[12:] for data in step]


def fill_ours(folder, channels, about, messages):
    """Write messages as the node does; return CPU seconds a message: in the caller, in all."""
    from fourbar_ros.bag.recorder import BagWriter
    writer = BagWriter(folder, '', channels, about)
    begin, caller = time.process_time(), 0.0
    for step in messages:
        before = time.thread_time()
        writer.write_all(list(enumerate(step)))
        caller += time.thread_time() - before
    assert not writer.dropped
    writer.close()
    count = len(messages) * len(channels)
    return caller / count, (time.process_time() - begin) / count


def fill_library(folder, channels, about, messages):
    """Write the same with the library's Writer, flushed by a thread under a lock."""
    from mcap.writer import Writer
    lock, stop = threading.Lock(), threading.Event()
    with open(Path(folder) / f'{time.time_ns()}.mcap', 'wb') as file:
        writer = Writer(file)
        writer.start('ros2', 'bench')
        ids = [writer.register_channel(c.topic, 'cdr', writer.register_schema(c.type, 'ros2msg',
                                                                              c.schema.encode()),
                                       c.metadata) for c in channels]

        def flush():
            while not stop.wait(0.1):
                with lock:
                    writer.flush()
        thread = threading.Thread(target=flush)
        begin, caller = time.process_time(), 0.0
        thread.start()
        for step in messages:
            before = time.thread_time()
            for number, data in zip(ids, step):
                with lock:
                    stamp = time.time_ns()
                    writer.add_message(number, stamp, data, stamp)
            caller += time.thread_time() - before
        stop.set()
        thread.join()
        writer.finish()
    count = len(messages) * len(channels)
    return caller / count, (time.process_time() - begin) / count


def cost_table(channels, about, messages):
    """Print the cost of a message beside that of the library's Writer."""
    found = {fill_ours: [], fill_library: []}
    for _ in range(ROUNDS):
        for fill, costs in found.items():
            with tempfile.TemporaryDirectory() as folder:
                costs.append(fill(folder, channels, about, messages))
    ours, library = ([1e6 * median(column) for column in zip(*found[fill])]
                     for fill in (fill_ours, fill_library))
    print(f'One message of {len(channels)} topics in turn, CPU, median of {ROUNDS} rounds in '
          'turn:\n')
    print('| | in the caller [us] | in all [us] | ratio |\n| --- | --- | --- | --- |')
    print(f'| `BagWriter` | {ours[0]:.2f} | {ours[1]:.2f} | {ours[1] / library[1]:.2f} |')
    print(f'| `mcap.Writer`, lock and flush thread | {library[0]:.2f} | {library[1]:.2f} | 1 |')


def node_table():
    """Print the CPU of a node at RATE, recorder off and on, with every topic subscribed."""
    from bench.node import recorder
    import rclpy
    rclpy.init()
    print('\nA node whose recorder is off and on in turns; on, the motion of the input is a sixth '
          'message:\n')
    try:
        recorder(float(RATE))
    finally:
        rclpy.try_shutdown()


def kill_table():
    """Print what kills cost."""
    from bag.test_crash import kill_once
    print(f'\nkill -9 at random moments, {KILLS} each, what was lost:\n')
    print('| recorder | median [ms] | worst [ms] |\n| --- | --- | --- |')
    for kind in KINDS:
        lost = [1e3 * kill_once(kind, 5000 + seed) for seed in range(KILLS)]
        print(f'| {KINDS[kind]} | {median(lost):.0f} | {max(lost):.0f} |')


@contextmanager
def measured(what, count, rows):
    """Time a piece of work over ``count`` messages; keep a row with the growth of the memory."""
    before, begin, cpu = rss(), time.perf_counter(), time.process_time()
    yield
    seconds, cpu = time.perf_counter() - begin, time.process_time() - cpu
    rows.append(f'| {what} | {seconds:.2f} | {1e6 * cpu / count:.2f} | '
                f'{60 * MINUTES / seconds:.0f} | {rss() - before:+.0f} |')


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


def long_table(channels, about, messages):
    """Print speed and memory of a long bag: written, read, checked, recomputed, exported."""
    from fourbar_ros.bag import export, info, recompute, recover
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
    print(f'\nA bag of {MINUTES:g} minutes at {RATE} Hz, {len(channels)} topics, {count} '
          f'messages, {size / 1e6:.0f} MB:\n')
    print('| | [s] | CPU a message [us] | times real time | memory [MB] |\n| --- | --- | --- | '
          '--- | --- |')
    print('\n'.join(rows))
    print('\nMemory while writing, at each tenth [MB]: ' + ', '.join(f'{m:.0f}' for m in memory))


def main():
    """Print all tables."""
    channels, about, messages = steps()
    cost_table(channels, about, messages)
    node_table()
    kill_table()
    long_table(channels, about, messages)


if __name__ == '__main__':
    main()
