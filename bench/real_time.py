# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Torque-driven steps at 1 kHz on the stiffest shaft, beside a bare timer and a bare loop."""
import gc
from os import getloadavg
import sys
import time

from fourbar_ros.scene import files
from fourbar_ros.scene import scene as scenes
import numpy as np

from .pages import best_time

RATE = 1000.0
BLOCK = 500                 # ticks of one kind in a row
SWITCH = 0.001              # as in the node
SHAFT = {'shaft.stiffness': 1e9, 'shaft.damping': 100.0, 'drive.rate': RATE}
AHEAD, AT_ONCE = 'made before its tick', 'made at its tick'
BARE, LOOP = 'bare timer', 'loop of additions'
KINDS = (AHEAD, AT_ONCE, AHEAD, LOOP, AHEAD, AT_ONCE, AHEAD, LOOP, AHEAD, BARE)      # of blocks
OFTEN = ADDITIONS = 2000


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


def add(count):
    """Do so many additions and nothing else."""
    total = 0.0
    for _ in range(count):
        total += 1.0
    return total


def run(samples):
    """Return {kind: Ticks}, counts of statuses."""
    scene = scenes.from_values({**files.read_values('motor'), **SHAFT})
    mover = scene.mover
    state, statuses = mover.start(), {}
    found = {kind: Ticks() for kind in KINDS}
    period = 1.0 / RATE
    per_addition = best_time(lambda: add(ADDITIONS), OFTEN) / ADDITIONS
    additions = round(best_time(lambda: mover.work_ahead(state, period), OFTEN)
                      / per_addition)
    began, tick = time.perf_counter() + 0.1, 0
    while tick < samples:
        kind = KINDS[(tick // BLOCK) % len(KINDS)]
        ticks = found[kind]
        due = began + tick * period
        wait = due - time.perf_counter()
        if wait < -1.0:                      # as the node: a second late is not made up for
            began -= wait
            continue
        if wait > 0.0:
            time.sleep(wait)
        start, cpu = time.perf_counter(), time.thread_time_ns()
        if kind == LOOP:
            add(additions)
        elif kind != BARE:
            status, state = mover.next(state, period)
            statuses[status] = statuses.get(status, 0) + 1
        end = time.perf_counter()                # from here on it could be sent
        if kind == AHEAD:
            mover.work_ahead(state, period)
        cpu = time.thread_time_ns() - cpu
        ticks.late.append(1e6 * (start - due))
        ticks.wall.append(1e6 * (end - start))
        ticks.cpu.append(1e-3 * cpu)
        ticks.overruns += cpu * 1e-9 > period
        tick += 1
    return found, statuses


def main(samples=20_000):
    """Print a table in Markdown."""
    sys.setswitchinterval(SWITCH)
    gc.freeze()
    load = getloadavg()[0]
    found, statuses = run(samples)
    from fourbar_ros.dynamics.mover import STATUS_NAMES
    print('Times in us: how late a tick begins, how long it then takes by the clock until the '
          'state can be sent,\nand how much CPU tick and step take together; median, 99th '
          'percentile, largest. The node makes a step\nbefore its tick while the torque does not '
          'change, with a motor always; otherwise at its tick.\nAn overrun is a step that takes '
          'more CPU than its tick is long. What interrupts a loop of additions,\nwhich takes as '
          'long as a step when both are repeated without a pause, is the machine.\n')
    print('| step, shaft 1e9 N m/rad | ticks | late p50 | p99 | max | clock p50 | p99 | max '
          '| CPU p50 | p99 | max | overruns |\n|' + ' --- |' * 12)
    for kind, ticks in found.items():
        print(ticks.row(kind))
    print(f'\nLoad of the machine at the start: {load:.1f}. Steps: '
          + ', '.join(f'{count} {STATUS_NAMES[status]}' for status, count in statuses.items())
          + '.')


if __name__ == '__main__':
    main()
