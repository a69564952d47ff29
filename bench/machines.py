# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""What machines of dyads cost beside the four-bar: one sample, a batch, up to 50 dyads."""
from timeit import repeat

from fourbar_ros import Body, FourBar
from fourbar_ros.mechanisms.machine.description import Dyad, Point
from fourbar_ros.mechanisms.machine.machine import Machine
import numpy as np

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
    """Return the times of a sample with all loads [us]: by itself, in a batch."""
    x = np.linspace(0.0, 6.0, SAMPLES)
    mechanism.step(0.7, 2.0, -1.0)
    one = min(repeat(lambda: mechanism.step(0.7, 2.0, -1.0), number=200, repeat=5 * ROUNDS))
    many = min(repeat(lambda: mechanism.step(x, 2.0, -1.0), number=1, repeat=ROUNDS))
    return 1e6 * one / 200, 1e6 * many / SAMPLES


def main():
    """Print times, and operations as they are recorded."""
    four_bar = FourBar(0.4, 1.2, 0.8, 1.0, bodies=(BODY,) * 3, gravity=GRAVITY)
    base = times(four_bar)
    print('| mechanism | operations | one sample [us] | over the four-bar | in a batch [us] | '
          'over the four-bar |\n| --- | --- | --- | --- | --- | --- |')
    machines = {'four-bar': four_bar, 'six-bar': six_bar(),
                **{f'chain of {size} dyads RPR': chain(size) for size in SIZES}}
    for name, mechanism in machines.items():
        one, many = times(mechanism)
        print(f'| {name} | {mechanism.record_with_loads[0].operations} | {one:.1f} | '
              f'{one / base[0]:.1f} | {many:.2f} | {many / base[1]:.1f} |')
    print(f'\nMotion and all loads. A six-bar may take {LIMIT:g} times as long as the four-bar. '
          'Operations are\nlinear in the number of dyads, whatever the computer does '
          '(`test_cost.py`).')
