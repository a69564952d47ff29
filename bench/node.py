# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The node beside a bare rclpy node that publishes or echoes the same bytes."""
from contextlib import contextmanager, ExitStack
from statistics import median
import tempfile
import time

from bench.pages import table
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
def running(*children, outputs=KINEMATICS, poked=False):
    """Yield the (child, listener) of children that run side by side, all found."""
    with ExitStack() as stack:
        pairs = []
        for child in children:
            stack.callback(child.stop)
            listener = Listener(child.name, outputs)
            stack.callback(listener.close)
            pairs.append((child, listener))
        for _, listener in pairs:
            listener.wait(listener.send if poked else None)
        yield pairs


def side_by_side(theirs, mine, outputs, work, poked=False):
    """
    Return the slices of two children that run at once, during ``work(listeners)``.

    Started anew several times, each first in turn: two processes of one kind may differ by a
    tenth.
    """
    parts = [], []
    for k in range(ROUNDS):
        order = (theirs, mine)[::1 - 2 * (k % 2)]
        with running(*(make() for make in order), outputs=outputs, poked=poked) as pairs:
            pairs = pairs[::1 - 2 * (k % 2)]
            for _ in range(SLICES):
                with Slice(*pairs[0]) as first, Slice(*pairs[1]) as second:
                    work([listener for _, listener in pairs])
                parts[0].append(first)
                parts[1].append(second)
    return parts


def beside(parts, take, names=('bare', 'fourbar'), before=((), (), ())):
    """
    Return rows: the medians of two sides, and of their ratio slice by slice.

    ``take``: slice -> its numbers. ``before``: texts that stand before the numbers of each row.
    """
    sides = [[take(part) for part in side] for side in parts]
    ratios = [[b / a for a, b in zip(*both)] for both in zip(*sides)]
    return [(name, *texts, *(f'{median(column):.{digits}f}' for column in zip(*found)))
            for name, texts, found, digits in zip((*names, 'ratio'), before, (*sides, ratios),
                                                  (1, 1, 2))]


def timers():
    """Print the timer table: both run side by side, each slice gives a ratio."""
    rows = []
    for what, rate, outputs in (('kinematics only, 1000 Hz', 1000.0, KINEMATICS),
                                ('full loads, 5 topics, 500 Hz', 500.0, FULL)):
        parts = side_by_side(lambda: bare('timer', outputs, rate),
                             lambda: ours(outputs, drive__rate=rate), outputs,
                             lambda listeners: time.sleep(SECONDS))
        rows += [(what, *row) for row in beside(parts, lambda part: (
            len(part.late) / part.seconds, percentile(part.late, 0.5),
            percentile(part.late, 0.99), part.per_step))]
    table(('stream', 'node', 'rate got [Hz]', 'late p50 [us]', 'late p99 [us]', 'CPU a step [us]'),
          rows)


def friction(rate=1000.0):
    """Print what friction in all pins costs a node: one without it, one with it, at once."""
    pins = {f'friction__{joint}__{name}': value for joint in ('O1', 'A', 'B', 'O4')
            for name, value in (('coefficient', 0.1), ('radius', 0.01))}
    parts = side_by_side(lambda: ours(FULL, drive__rate=rate),
                         lambda: ours(FULL, 'rubbing', drive__rate=rate, **pins), FULL,
                         lambda listeners: time.sleep(SECONDS))
    table((f'{rate:g} Hz, 5 topics heard', 'late p50 [us]', 'late p99 [us]', 'CPU a step [us]'),
          beside(parts, lambda part: (percentile(part.late, 0.5), percentile(part.late, 0.99),
                                      part.per_step), ('no friction', 'friction in all pins')))


def echoes():
    """Print the latency table: inputs go to both in turns, half a millisecond apart."""
    rows, counts = [], []

    def work(listeners):
        counts.append(sent(2000.0, SECONDS, [listener.send for listener in listeners]) // 2)
        time.sleep(0.3)

    for outputs in (KINEMATICS, FULL):
        counts.clear()
        parts = side_by_side(lambda: bare('echo', outputs),
                             lambda: ours(outputs, drive__source='motion'), outputs,
                             work, poked=True)
        lost = [(f'{100.0 * (1.0 - sum(len(part.late) for part in side) / sum(counts)):.2f}',)
                for side in parts]
        rows += [(f'{len(outputs)} of {len(FULL)} outputs', *row) for row in beside(
            parts, lambda part: (percentile(part.late, 0.5), percentile(part.late, 0.99),
                                 part.per_step), before=(*lost, ('',)))]
    table(('input to output, 1 kHz', 'node', 'lost [%]', 'p50 [us]', 'p99 [us]',
           'CPU a message [us]'), rows)


def recorder(rate=500.0):
    """Print what recording costs: the same process with its recorder off and on in turns."""
    from fourbar_msgs.srv import StartRecording
    from std_srvs.srv import Trigger
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
    table((f'{rate:g} Hz, 5 topics heard', 'CPU a step [us]', 'late p99 [us]'),
          beside(parts, lambda part: (part.per_step, percentile(part.late, 0.99)),
                 ('recorder off', 'recorder on')))


def main():
    """Print all tables of the node."""
    with undisturbed():
        timers()
        friction()
        echoes()
        recorder()


if __name__ == '__main__':
    main()
