# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Torque-driven steps at 1 kHz on the stiffest shaft, beside a bare timer."""
import gc
from os import getloadavg
import sys
import time

from fourbar_ros.scene import files
from fourbar_ros.scene import scene as scenes
import numpy as np

RATE = 1000.0
BLOCK = 500                 # ticks in a row: nine blocks of steps, then one of a bare timer
EVERY = 10
SWITCH = 0.001              # as in the node
SHAFT = {'shaft.stiffness': 1e9, 'shaft.damping': 100.0, 'drive.rate': RATE}


class Ticks:
    """What was measured of the ticks of one kind [us]."""

    def __init__(self):
        self.late, self.wall, self.cpu = [], [], []
        self.overruns = 0

    def row(self, name):
        """Return a line of a table in Markdown."""
        cells = [f'{np.percentile(values, share):.0f}' for values in (self.late, self.wall,
                                                                      self.cpu)
                 for share in (50, 99, 100)]
        return f'| {name} | {len(self.wall)} | {" | ".join(cells)} | {self.overruns} |'


def run(samples):
    """Return (Ticks of steps, Ticks of a bare timer, counts of statuses)."""
    scene = scenes.from_values({**files.read_values('motor'), **SHAFT})
    mover = scene.mover
    state, statuses = mover.start(), {}
    steps, bare = Ticks(), Ticks()
    period = 1.0 / RATE
    began, tick = time.perf_counter() + 0.1, 0
    while len(steps.wall) < samples:
        is_bare = (tick // BLOCK) % EVERY == EVERY - 1
        due = began + tick * period
        wait = due - time.perf_counter()
        if wait < -1.0:                      # as the node: a second late is not made up for
            began -= wait
            continue
        if wait > 0.0:
            time.sleep(wait)
        start, cpu = time.perf_counter(), time.thread_time_ns()
        if not is_bare:
            status, state = mover.next(state, period)
            statuses[status] = statuses.get(status, 0) + 1
        cpu, end = time.thread_time_ns() - cpu, time.perf_counter()
        kind = bare if is_bare else steps
        kind.late.append(1e6 * (start - due))
        kind.wall.append(1e6 * (end - start))
        kind.cpu.append(1e-3 * cpu)
        kind.overruns += cpu * 1e-9 > period
        tick += 1
    return steps, bare, statuses


def main(samples=20_000):
    """Print a table in Markdown."""
    sys.setswitchinterval(SWITCH)
    gc.freeze()
    load = getloadavg()[0]
    steps, bare, statuses = run(samples)
    from fourbar_ros.dynamics.mover import STATUS_NAMES
    print('Times in us: how late a tick begins, how long the step takes by the clock, and how '
          'much CPU it takes;\nmedian, 99th percentile, largest. An overrun is a step that takes '
          'more CPU than its tick is long.\n')
    print('| | ticks | late p50 | p99 | max | clock p50 | p99 | max | CPU p50 | p99 | max '
          '| overruns |\n|' + ' --- |' * 12)
    print(steps.row('step, shaft 1e9 N m/rad'))
    print(bare.row('bare timer'))
    print(f'\nLoad of the machine at the start: {load:.1f}. Steps: '
          + ', '.join(f'{count} {STATUS_NAMES[status]}' for status, count in statuses.items())
          + '.')


if __name__ == '__main__':
    main()
