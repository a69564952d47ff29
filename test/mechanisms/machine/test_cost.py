# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""What a machine costs in operations of arithmetic, whatever the speed of the computer."""
from functools import cache

from fourbar_ros import Body
from fourbar_ros.mechanisms.machine.description import Dyad, Point
from fourbar_ros.mechanisms.machine.machine import Machine
from fourbar_ros.mechanisms.machine.solve.frames import Poses
from fourbar_ros.numerics import write_arrays
import numpy as np
import pytest

BODY = Body(1.0, cg_along=0.1, cg_across=0.05, inertia=0.2)


@cache
def chain(count):
    """Return a crank and a chain of bars, each moved by a block on the one before."""
    dyads, link = [], 'crank'
    for i in range(count):
        dyads.append(Dyad(f'd{i}', 'RPR', Point(link, 0.3, 0.02), Point('ground', i + 1.0, 0.1),
                          (f'block{i}', f'bar{i}'), offset=0.01))
        link = f'bar{i}'
    machine = Machine(dyads)
    return Machine(dyads, bodies=dict.fromkeys(machine.layout.moving, BODY), gravity=(0.5, -9.81))


def operations(machine):
    """Return how many operations of motion and loads depend on the input."""
    trace = machine.record(True).trace
    return len(trace.varies) - trace.count


def test_the_cost_is_linear_in_the_number_of_dyads():
    counts = {size: operations(chain(size)) for size in (1, 2, 10, 50)}
    each = counts[2] - counts[1]
    assert abs(counts[50] - counts[1] - 49 * each) <= 0.05 * counts[50]
    assert abs(counts[10] - counts[1] - 9 * each) <= 0.05 * counts[10]


def test_fifty_dyads_move():
    machine = chain(50)
    motion, loads = machine.step(0.7, 2.0, -1.0)
    assert np.isfinite((motion.theta_bar49, loads.driving_torque, loads.d49_inner)).all()
    many = machine.motion(np.linspace(0.0, 6.0, 200), 2.0)
    assert np.isfinite(many.omega_bar49).all()


def four_bars(count, is_chain):
    """Return the dyads of a chain of four-bars, each driven by the one before, or of a star."""
    return [Dyad(f'd{i}', 'RRR', Point(f'rocker{i - 1}' if i and is_chain else 'crank', 0.4),
                 Point('ground', 1.0 + (0.9 if is_chain else 0.01) * i, 0.01 * i),
                 (f'coupler{i}', f'rocker{i}'), length_1=1.2, length_2=0.8) for i in range(count)]


@pytest.mark.parametrize('is_chain', (True, False))
def test_the_search_for_ranges_and_singular_inputs_is_linear_in_the_dyads(monkeypatch, is_chain):
    solved, add = [], Poses.add
    monkeypatch.setattr(Poses, 'add', lambda *given: solved.append(given[1]) or add(*given))

    def dyads_solved(count):
        solved.clear()
        machine = Machine(four_bars(count, is_chain))
        for_ranges = len(solved)
        assert machine.singular_inputs
        return for_ranges, len(solved) - for_ranges
    # in a chain each end of a range is halved with all dyads before: none of these has one
    counts = {count: dyads_solved(count) for count in (4, 8, 32)}
    for few, more, most in zip(*counts.values()):
        assert most <= few + 7 * (more - few), counts


def test_results_of_arrays_are_looked_up_once_for_all_fields(monkeypatch):
    asked, flat = [], write_arrays.flat
    monkeypatch.setattr(write_arrays, 'flat', lambda indices: asked.append(1) or flat(indices))
    Machine(four_bars(3, True)).motion(np.linspace(0.0, 1.0, 5), 2.0)
    assert len(asked) <= 4
