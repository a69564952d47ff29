# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""What a machine costs in operations of arithmetic, whatever the speed of the computer."""
from functools import cache

from fourbar_ros import Body
from fourbar_ros.mechanisms.machine.description import Dyad, Point
from fourbar_ros.mechanisms.machine.machine import Machine
import numpy as np

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
    trace = machine.record_with_loads.trace
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
