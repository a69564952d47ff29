# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The node beside a bare rclpy node that publishes or echoes the same bytes."""
from contextlib import contextmanager, ExitStack
from statistics import median
import tempfile
import time

from bench.processes import (
    bare,
    FULL,
    KINEMATICS,
    Listener,
    ours,
    percentile,
    sent,
    Slice,
    undisturbed,
)

ROUNDS, SLICES, SECONDS = 3, 2, 3.0


@contextmanager
def running(*children, outputs=KINEMATICS, poked=False, **listening):
    """
    Yield the (child, listener) of children that run side by side, all found.

    ``listening``: what the Listeners are made with besides.
    """
    with ExitStack() as stack:
        pairs = []
        for child in children:
            stack.callback(child.stop)
            listener = Listener(child.name, outputs, **listening)
            stack.callback(listener.close)
            pairs.append((child, listener))
        for _, listener in pairs:
            listener.wait(listener.send if poked else None)
        yield pairs


def side_by_side(theirs, mine, outputs, work, poked=False, **listening):
    """
    Return the slices of two children that run at once, during ``work(listeners)``.

    Started anew several times, each first in turn: two processes of one kind may differ by a
    tenth.
    """
    parts = [], []
    for k in range(ROUNDS):
        order = (theirs, mine)[::1 - 2 * (k % 2)]
        with running(*(make() for make in order), outputs=outputs, poked=poked,
                     **listening) as pairs:
            pairs = pairs[::1 - 2 * (k % 2)]
            for _ in range(SLICES):
                with Slice(*pairs[0]) as first, Slice(*pairs[1]) as second:
                    work([listener for _, listener in pairs])
                parts[0].append(first)
                parts[1].append(second)
    return parts


def beside(theirs, mine, take):
    """Return (column of medians of bare, of ours, of their ratio slice by slice)."""
    rows = [[take(part) for part in parts] for parts in (theirs, mine)]
    ratios = [[b / a for a, b in zip(*both)] for both in zip(*rows)]
    return [[median(column) for column in zip(*found)] for found in (*rows, ratios)]


def print_beside(what, columns, digits=1):
    """Print three rows: bare, ours, ratio."""
    for name, values in zip(('bare', 'fourbar'), columns):
        print(f'| {what} | {name} | ' + ' | '.join(f'{value:.{digits}f}' for value in values)
              + ' |')
    print('| | ratio | ' + ' | '.join(f'{value:.2f}' for value in columns[2]) + ' |')


def timers():
    """Print the timer table: both run side by side, each slice gives a ratio."""
    print('| stream | node | rate got [Hz] | late p50 [us] | late p99 [us] | CPU a step [us] |')
    print('| --- | --- | --- | --- | --- | --- |')
    for what, rate, outputs in (('kinematics only, 1000 Hz', 1000.0, KINEMATICS),
                                ('full loads, 5 topics, 500 Hz', 500.0, FULL)):
        parts = side_by_side(lambda: bare('timer', outputs, rate),
                             lambda: ours(outputs, drive__rate=rate), outputs,
                             lambda listeners: time.sleep(SECONDS))
        print_beside(what, beside(*parts, lambda p: (len(p.late) / p.seconds,
                                                     percentile(p.late, 0.5),
                                                     percentile(p.late, 0.99), p.per_step)))
    print()


def echoes():
    """Print the latency table: inputs go to both in turns, half a millisecond apart."""
    print('| input to output, 1 kHz | node | lost [%] | p50 [us] | p99 [us] | CPU a message [us] '
          '|')
    print('| --- | --- | --- | --- | --- | --- |')
    counts = []

    def work(listeners):
        counts.append(sent(2000.0, SECONDS, [listener.send for listener in listeners]) // 2)
        time.sleep(0.3)

    for outputs in (KINEMATICS, FULL):
        counts.clear()
        parts = side_by_side(lambda: bare('echo', outputs),
                             lambda: ours(outputs, drive__source='motion'), outputs,
                             work, poked=True)
        total = sum(counts)
        columns = beside(*parts, lambda p: (percentile(p.late, 0.5), percentile(p.late, 0.99),
                                            p.per_step))
        lost = [100.0 * (1.0 - sum(len(p.late) for p in side) / total) for side in parts]
        topics = f'{len(outputs)} output' + 's' * (len(outputs) > 1)
        for name, values, missing in zip(('bare', 'fourbar'), columns, lost):
            print(f'| {topics} | {name} | {missing:.2f} | '
                  + ' | '.join(f'{v:.1f}' for v in values) + ' |')
        print('| | ratio | | ' + ' | '.join(f'{v:.2f}' for v in columns[2]) + ' |')
    print()


def recorder(rate=500.0):
    """Print what recording costs: the same process with its recorder off and on in turns."""
    from fourbar_msgs.srv import StartRecording
    from std_srvs.srv import Trigger
    print(f'| {rate:g} Hz, 5 topics heard | CPU a step [us] | late p99 [us] |\n| --- | --- | --- '
          '|')
    with tempfile.TemporaryDirectory() as folder, running(
            ours(FULL, drive__rate=rate, recording__directory=folder), outputs=FULL) as [pair]:
        services = [(pair[1].node.create_client(kind, f'/fourbar/{name}'), kind) for kind, name in
                    ((Trigger, 'stop_recording'), (StartRecording, 'start_recording'))]
        parts = [[], []]
        for k in range(2 * ROUNDS * SLICES):
            client, kind = services[k % 2]
            client.wait_for_service(20.0)
            future = client.call_async(kind.Request())
            while not future.done():
                time.sleep(0.01)
            time.sleep(0.3)
            with Slice(*pair) as part:
                time.sleep(SECONDS)
            parts[k % 2].append(part)
    columns = beside(*parts, lambda p: (p.per_step, percentile(p.late, 0.99)))
    for what, values in zip(('recorder off', 'recorder on', 'ratio'), columns):
        print(f'| {what} | ' + ' | '.join(f'{v:.2f}' if what == 'ratio' else f'{v:.1f}'
                                          for v in values) + ' |')
    print()


def main():
    """Print all tables of the node."""
    with undisturbed():
        for table in (timers, echoes, recorder):
            table()


if __name__ == '__main__':
    main()
