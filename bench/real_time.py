# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Torque-driven steps at 1 kHz on the stiffest shaft, beside a bare timer and a bare loop."""
from array import array
import gc
from os import getloadavg
import sys
import threading
import time

from fourbar_ros.ros.node.drives import wake_on_time
from fourbar_ros.scene import files
from fourbar_ros.scene import scene as scenes
import numpy as np

RATE = 1000.0
BLOCK = 500                 # ticks of one kind in a row
SWITCH = 0.001              # as in the node
SHAFT = {'shaft.stiffness': 1e9, 'shaft.damping': 100.0, 'drive.rate': RATE}
STALL, FREE = 400.0, 26.0   # of the law of the torques that come [N m, rad/s]
AHEAD, COMES, AT_ONCE, LOOP, BARE = (
    'motor: made after the one before', 'torque: made when it comes', 'torque: made at its tick',
    'loop of additions', 'bare timer')
KINDS = (AHEAD, LOOP, COMES, LOOP, AT_ONCE, LOOP, BARE)              # of blocks, in turns
MOMENTS = 0.5 * (5.0**0.5 - 1.0)     # its multiples, less whole numbers, are uniform in [0, 1)
ADDITIONS = 2000            # of a loop at first; it becomes as long as a step at its tick


class Ticks:
    """What was measured of the ticks of one kind [us]."""

    def __init__(self):
        self.late, self.wall, self.ready, self.cpu = (array('d') for _ in range(4))
        self.overruns = 0

    def row(self, name):
        """Return a line of a table in Markdown."""
        columns = self.late, self.wall, self.ready, self.cpu
        cells = [f'{np.percentile(values, share):.0f}'
                 for values in columns for share in (50, 99, 100)]
        return f'| {name} | {len(self.wall)} | {" | ".join(cells)} | {self.overruns} |'


def add(count):
    """Do so many additions and nothing else."""
    total = 0.0
    for _ in range(count):
        total += 1.0
    return total


def sleep_until(moment):
    """Sleep until a moment of perf_counter()."""
    wait = moment - time.perf_counter()
    if wait > 0.0:
        time.sleep(wait)


def used(work, *given):
    """Return the CPU time [ns] that work takes in this thread, and what it returns."""
    begin = time.thread_time_ns()
    found = work(*given)
    return time.thread_time_ns() - begin, found


class Driven:
    """A mover and its state."""

    def __init__(self, source):
        values = {**files.read_values('motor'), **SHAFT, 'drive.source': source}
        self.mover = scenes.from_values(values).mover
        self.state, self.torque = self.mover.start(), 0.0

    def work_ahead(self):
        """Make the next step."""
        self.mover.work_ahead(self.state, 1.0 / RATE, self.torque)

    def step(self):
        """Give the next step; return its status."""
        status, self.state = self.mover.next(self.state, 1.0 / RATE, self.torque)
        return status

    def change_torque(self):
        """Let a torque come that depends on the state, as that of a controller does."""
        self.torque = STALL * (1.0 - self.state.motor_velocity / FREE)


class Bench:
    """The parts of a node that make steps: one thread for ticks, one for torques, a lock."""

    def __init__(self):
        self.driven, by_torque = {AHEAD: Driven('motor')}, Driven('torque')
        self.driven[COMES] = self.driven[AT_ONCE] = by_torque
        self.period, self.lock = 1.0 / RATE, threading.Lock()
        self.statuses, self.most = {}, 0.0
        self.found = {kind: Ticks() for kind in KINDS}
        self.additions = ADDITIONS

    def run(self, kind):
        """Measure a block of ticks of one kind."""
        first = time.perf_counter() + 2.0 * self.period
        dues, spent = [first + i * self.period for i in range(BLOCK)], {}
        other = threading.Thread(target=self._torques_come, args=(dues, spent))
        if kind == COMES:
            other.start()
        rows = [self._tick(kind, due) for due in dues]
        if kind == COMES:
            other.join()
            assert len(spent) == BLOCK
        ticks = self.found[kind]
        for due, (late, wall, *steps) in zip(dues, rows):
            steps.append(spent.get(due, 0))
            ticks.late.append(1e6 * late)
            ticks.wall.append(1e6 * wall)
            ticks.ready.append(1e6 * (late + wall))
            ticks.cpu.append(1e-3 * sum(steps))
            ticks.overruns += max(steps) * 1e-9 > self.period
        if kind == LOOP and self.found[AT_ONCE].cpu:
            step, loop = (np.median(self.found[one].cpu[-BLOCK:]) for one in (AT_ONCE, LOOP))
            self.additions = round(self.additions * (step / loop)**0.5)

    def _tick(self, kind, due):
        """Return how late it begins [s], how long it takes [s], CPU times of work [ns]."""
        driven = self.driven.get(kind)
        if kind == AT_ONCE:
            driven.change_torque()
        sleep_until(due)
        start = time.perf_counter()
        if driven:
            with self.lock:
                cpu, status = used(driven.step)
            self.statuses[status] = self.statuses.get(status, 0) + 1
            self.most = max(self.most, driven.state.evaluations)
        else:
            cpu, _ = used(add, self.additions if kind == LOOP else 0)
        end = time.perf_counter()                # from here on it could be sent
        ahead, _ = used(driven.work_ahead) if kind == AHEAD else (0, None)
        return start - due, end - start, cpu, ahead

    def _torques_come(self, dues, spent):
        """Let a torque come between any two ticks; note the CPU time of the step made then."""
        wake_on_time()
        driven = self.driven[COMES]
        for i, due in enumerate(dues):
            sleep_until(due - MOMENTS * i % 1.0 * self.period)
            with self.lock:
                driven.change_torque()
                spent[due], _ = used(driven.work_ahead)


def main(samples=21_000):
    """Print a table in Markdown."""
    sys.setswitchinterval(SWITCH)
    gc.freeze()
    wake_on_time()
    load = getloadavg()[0]
    bench = Bench()
    for block in range(samples // BLOCK):
        bench.run(KINDS[block % len(KINDS)])
    from fourbar_ros.dynamics.mover import STATUS_NAMES
    print('Times in us: how late a tick begins, how long it then takes by the clock until the '
          'state can be sent,\nhow long after the tick is due that is, and how much CPU tick and '
          'step take together; median, 99th percentile,\nlargest. Torques come from another '
          'thread, one between two ticks, at any moment; each depends on the state.\nAn overrun '
          'is a step that takes more CPU time than a tick is long. What interrupts a loop of '
          'additions, which takes\nas much CPU time as a step at its tick, is the machine. A '
          'torque that comes too late for its tick jumps at\nthe next one, by which the stiff '
          'shaft may ring: such a step is divided as far as the budget allows.\n')
    print('| step, shaft 1e9 N m/rad | ticks | late p50 | p99 | max | clock p50 | p99 | max '
          '| ready p50 | p99 | max | CPU p50 | p99 | max | overruns |\n|' + ' --- |' * 15)
    for kind, ticks in bench.found.items():
        print(ticks.row(kind))
    ended = ', '.join(f'{count} {STATUS_NAMES[status]}'
                      for status, count in bench.statuses.items())
    print(f'\nLoad of the machine at the start: {load:.1f}. Steps: {ended}.'
          f' Most evaluations of the equation of motion in one of them: {bench.most:.0f}.')


if __name__ == '__main__':
    main()
