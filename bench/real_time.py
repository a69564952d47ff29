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
MOTOR, TORQUE, LOOP, BARE = 'motor', 'torque that changes', 'loop of additions', 'bare timer'
KINDS = (MOTOR, LOOP, TORQUE, LOOP, BARE)       # of blocks, in turns
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

    def step(self):
        """Make the next step; return its status."""
        status, self.state = self.mover.next(self.state, 1.0 / RATE, self.torque)
        return status

    def change_torque(self):
        """Let a torque come that depends on the state, as that of a controller does."""
        self.torque = STALL * (1.0 - self.state.motor_velocity / FREE)


class Bench:
    """The parts of a node that make steps: a thread for ticks, a lock."""

    def __init__(self):
        self.driven = {MOTOR: Driven('motor'), TORQUE: Driven('torque')}
        self.period, self.lock = 1.0 / RATE, threading.Lock()
        self.statuses, self.most = {}, 0.0
        self.found = {kind: Ticks() for kind in KINDS}
        self.additions = ADDITIONS

    def run(self, kind):
        """Measure a block of ticks of one kind."""
        first = time.perf_counter() + 2.0 * self.period
        ticks = self.found[kind]
        for late, wall, cpu in [self._tick(kind, first + i * self.period) for i in range(BLOCK)]:
            ticks.late.append(1e6 * late)
            ticks.wall.append(1e6 * wall)
            ticks.ready.append(1e6 * (late + wall))
            ticks.cpu.append(1e-3 * cpu)
            ticks.overruns += cpu * 1e-9 > self.period
        if kind == LOOP and self.found[MOTOR].cpu:
            step, loop = (np.median(self.found[one].cpu[-BLOCK:]) for one in (MOTOR, LOOP))
            self.additions = round(self.additions * (step / loop)**0.5)

    def _tick(self, kind, due):
        """Return how late it begins [s], how long it takes [s], CPU time of its work [ns]."""
        driven = self.driven.get(kind)
        if kind == TORQUE:
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
        return start - due, end - start, cpu


def main(samples=21_000):
    """Print a table in Markdown."""
    sys.setswitchinterval(SWITCH)
    gc.freeze()
    wake_on_time()
    load = getloadavg()[0]
    bench = Bench()
    for block in range(samples // BLOCK):
        bench.run(KINDS[block % len(KINDS)])
    from fourbar_ros.dynamics.step.mover import STATUS_NAMES
    print('Times in us: how late a tick begins, how long it then takes by the clock until the '
          'state can be sent,\nhow long after the tick is due that is, and how much CPU tick and '
          'step take together; median, 99th percentile,\nlargest. The torque that changes depends '
          'on the state. An overrun is a step that takes more CPU time than a\ntick is long. What '
          'interrupts a loop of additions, which takes as much CPU time as a step, is the '
          'machine.\n')
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
