# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Machines of dyads: what they cost beside the four-bar, up to 50 dyads; beside MuJoCo."""
from pathlib import Path
import sys
from time import process_time
from timeit import repeat

from fourbar_ros import Body, FourBar, load_scene
from fourbar_ros.dynamics.model.drives import ConstantTorque, Drive
from fourbar_ros.dynamics.model.system import System
from fourbar_ros.dynamics.solve.simulate import simulate
from fourbar_ros.mechanisms.machine.describe.description import Dyad, Point
from fourbar_ros.mechanisms.machine.machine import Machine
import numpy as np

sys.path.insert(0, str(Path(__file__).parent.parent / 'test'))
from support.andrews import ANDREWS_ANGLE, UNTIL  # noqa: E402
from support.in_mujoco import POSES, worst  # noqa: E402
from support.machines import andrews, ANDREWS_BETA  # noqa: E402

BODY, GRAVITY = Body(1.0, 0.1, 0.05, 0.2), (0.5, -9.81)
SAMPLES, ROUNDS, LIMIT = 10_000, 7, 3.0
SIZES = (1, 2, 5, 10, 20, 50)


def with_masses(dyads):
    """Return a machine all of whose links have the same mass."""
    links = Machine(dyads).layout.moving
    return Machine(dyads, bodies=dict.fromkeys(links, BODY), gravity=GRAVITY)


def six_bar():
    """Return a crank-rocker that moves one more pair of rods."""
    return with_masses([
        Dyad('lower', 'RRR', Point('crank', 0.4), Point('ground', 1.0), ('coupler', 'rocker'),
             length_1=1.2, length_2=0.8),
        Dyad('upper', 'RRR', Point('rocker', 0.9, 0.2), Point('ground', 2.0), ('rod', 'arm'),
             length_1=1.4, length_2=0.9)])


def chain(count):
    """Return a crank and a chain of bars, each moved by a block on the one before."""
    links = ['crank', *(f'bar{i}' for i in range(count))]
    return with_masses([
        Dyad(f'd{i}', 'RPR', Point(links[i], 0.3, 0.02), Point('ground', i + 1.0, 0.1),
             (f'block{i}', f'bar{i}'), offset=0.01) for i in range(count)])


def times(mechanism):
    """Return the times of a sample [us]: with all loads by itself, in a batch, its drive alone."""
    x = np.linspace(0.0, 6.0, SAMPLES)
    mechanism.step(0.7, 2.0, -1.0)
    one = min(repeat(lambda: mechanism.step(0.7, 2.0, -1.0), number=200, repeat=5 * ROUNDS))
    many = min(repeat(lambda: mechanism.step(x, 2.0, -1.0), number=1, repeat=ROUNDS))
    drive = min(repeat(lambda: mechanism.step(x, 2.0, -1.0, fields=('driving_torque',)),
                       number=1, repeat=ROUNDS))
    return 1e6 * one / 200, 1e6 * many / SAMPLES, 1e6 * drive / SAMPLES


def made_in(count):
    """Return the time that a chain takes to be made and to move for the first time [ms]."""
    start = process_time()
    chain(count).step(0.7, 2.0, -1.0)
    return 1e3 * (process_time() - start)


def print_costs():
    """Print times, and operations as they are recorded."""
    four_bar = FourBar(0.4, 1.2, 0.8, 1.0, bodies=(BODY,) * 3, gravity=GRAVITY)
    base = times(four_bar)
    print('| mechanism | operations | one sample [us] | over the four-bar | in a batch [us] | '
          'over the four-bar | drive alone, in a batch [us] | over the four-bar |\n'
          '| --- | --- | --- | --- | --- | --- | --- | --- |')
    machines = {'four-bar': four_bar, 'six-bar': six_bar(),
                **{f'chain of {size} dyads RPR': chain(size) for size in SIZES}}
    for name, mechanism in machines.items():
        one, many, drive = times(mechanism)
        print(f'| {name} | {mechanism.record_with_loads[0].operations} | {one:.1f} | '
              f'{one / base[0]:.1f} | {many:.2f} | {many / base[1]:.1f} | {drive:.2f} | '
              f'{drive / base[2]:.1f} |')
    numbers = len(mechanism.MOTION._fields) + len(mechanism.LOADS._fields)
    print(f'\nMotion and all loads. A six-bar may take {LIMIT:g} times as long as the four-bar, '
          'and 1 us a sample in a\nbatch. Operations are linear in the number of dyads, whatever '
          'the computer does (`test_cost.py`), and so\nis the time of what is computed: of one '
          'sample, and of a load alone in a batch. All results of a chain of\n50 dyads are '
          f'{numbers} numbers a sample, {8 * numbers * SAMPLES // 10**6} MB of a '
          'batch: memory takes the rest of that time.\n')
    print('| dyads | made and moved for the first time [ms] | a dyad [ms] |\n| --- | --- | --- |')
    for size in SIZES:
        spent = made_in(size)
        print(f'| {size} | {spent:.0f} | {spent / size:.0f} |')


def print_mujoco():
    """Print how far accelerations from rest are off in MuJoCo, by its softness."""
    print('\nReleased from rest under gravity and a torque of 1 N m: the largest difference of a '
          "joint's acceleration in MuJoCo\n(`fourbar describe --format mjcf`), over the largest "
          f'in its pose, of {POSES} poses. Its loops are constraints of\nan impedance below 1; '
          'what differs is what is missing to 1.\n')
    print('| machine | impedance 0.99 | 0.999 | 0.9999 |\n| --- | --- | --- | --- |')
    for name in ('watt', 'stephenson', 'quick_return', 'jansen'):
        scene = load_scene(name)
        print(f'| {name} | ' + ' | '.join([f'{worst(scene, 1.0, impedance):.1e}'
                                           for impedance in (0.99, 0.999, 0.9999)]) + ' |')


def print_squeezer():
    """Print error, evaluations and CPU time of Andrews' squeezer moved by its torque."""
    machine, spring, torque = andrews()
    system = System(machine, ANDREWS_BETA, 0.0, [spring], Drive(ConstantTorque(torque)))
    print(f"\nAndrews' squeezer, from rest to {UNTIL:g} s (24 digits by two routes), with all "
          'checks, asked for 1e-9 rad; budget 10 ms:\n\n'
          '| method | error [rad] | stated error | evaluations | CPU [ms] |\n'
          '| --- | --- | --- | --- | --- |')
    for method in ('auto', 'DOP853', 'LSODA'):
        spent = min(repeat(lambda: simulate(system, UNTIL, 1e-9, method), number=1,
                           repeat=ROUNDS, timer=process_time))
        run = simulate(system, UNTIL, 1e-9, method)
        print(f'| {run.method} | {abs(run.position[-1] - float(ANDREWS_ANGLE)):.0e} | '
              f'{run.error:.0e} | {run.evaluations} | {1e3 * spent:.1f} |')


def main():
    """Print costs, a motion that follows from torque, and accelerations beside MuJoCo's."""
    print_costs()
    print_squeezer()
    print_mujoco()
