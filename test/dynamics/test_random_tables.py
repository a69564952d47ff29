# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Runs over random force tables of the input beside scipy, begun anew at each of their points."""
from math import pi

from fourbar_ros import Bodies, FourBar, InvertedSlider, round_rod, SliderCrank
from fourbar_ros.dynamics.run import REACHED
from fourbar_ros.dynamics.simulation import simulate
from fourbar_ros.dynamics.sources import ConstantTorque, Drive
from fourbar_ros.dynamics.system import System
from fourbar_ros.mechanisms.elements import Attachment, PositionForce
from fourbar_ros.mechanisms.force_table import ForceTable
import numpy as np
import pytest
from scipy.integrate import solve_ivp

TURN = 2.0 * pi
SAMPLES = 101          # at which a run is compared
BODIES = Bodies(*(round_rod(length, 7750.0, 0.02) for length in (0.4, 1.2, 0.8)))
MACHINES = [FourBar(0.4, 1.2, 0.8, 1.0, bodies=BODIES, gravity=(0.0, -9.81)),
            FourBar(0.9, 0.8, 0.9, 0.4, bodies=BODIES), SliderCrank(0.3, 0.9, 0.1, bodies=BODIES),
            InvertedSlider(0.3, 0.9, 0.1, bodies=BODIES)]


def random_force(rng, size):
    """Return a couple on the crank: steps, ramps, constant stretches, over a turn or two."""
    low, span = rng.choice([0.0, -pi, 0.3]), TURN * int(rng.integers(1, 3))
    inner = low + span * np.sort(rng.uniform(0.02, 0.98, int(rng.choice([2, 5, 12]))))
    jumps = inner[rng.random(inner.size) < 0.3]
    places = np.sort(np.concatenate([[low], inner, jumps, [low + span]]))
    values = size * rng.normal(size=places.size)
    first = int(rng.integers(places.size))
    values[first:first + 3] = values[first]
    values[-1] = values[0]
    table = ForceTable(places, values, is_periodic=True, is_linear=bool(rng.random() < 0.5))
    return PositionForce(Attachment('crank'), table, direction=None)


def random_case(seed):
    """Return a system, the end of its run and a tolerance; it may begin at a point of a table."""
    rng = np.random.default_rng([seed, 78])
    size, fast = 10.0**rng.uniform(0.0, 2.0), 10.0**rng.uniform(0.5, 1.5)
    forces = [random_force(rng, size) for _ in range(int(rng.integers(1, 4)))]
    linkage = MACHINES[int(rng.integers(len(MACHINES)))].with_elements(*forces)
    position = rng.choice([rng.uniform(-pi, pi), rng.choice(forces[0].value.places)])
    position += linkage.cycle * int(rng.choice([0, 0, -3, 100]))
    drive = Drive(ConstantTorque(0.3 * size * rng.normal()), flywheel=rng.choice([0.0, 10.0]))
    system = System(linkage, position, fast * rng.choice([-1.0, 1.0]), drive)
    return system, rng.uniform(0.5, 5.0) / fast, 10.0**-rng.uniform(3.0, 9.0)


def by_scipy(system, until, method, times):
    """Return positions by an integration that begins anew at each point of a table."""
    points = [(place, force.value.table.span)       # and after what it comes round
              for force in system.equation.tables for place in force.value.table.places]
    now, state, positions = 0.0, np.array(system.start), np.empty(times.size)
    while now < until:
        change = system.derivative(now, state.tolist())[1]
        ahead = state[0] + 1e-9 * np.sign(state[1] or change)
        low = max(ahead - (ahead - place) % period for place, period in points)
        high = min(ahead + (place - ahead) % period for place, period in points)

        def rates(time, state, low=low, high=high):
            inside = min(max(state[0], low + 1e-12), high - 1e-12)
            return system.derivative(time, [inside, *state[1:].tolist()])
        events = [lambda time, state, low=low: state[0] - low,
                  lambda time, state, high=high: state[0] - high]
        for event, direction in zip(events, (-1.0, 1.0)):
            event.terminal, event.direction = True, direction
        solved = solve_ivp(rates, (now, until), state, method, rtol=1e-11, atol=1e-13,
                           events=events, dense_output=True)
        there = (times >= now) & (times <= solved.t[-1])
        if there.any():
            positions[there] = solved.sol(times[there])[0]
        now, state = solved.t[-1], solved.y[:, -1]
    return positions


def require_error(seed, method):
    """Require that a run is as exact as it says, or as it was asked for."""
    system, until, tolerance = random_case(seed)
    run, times = simulate(system, until, tolerance), np.linspace(0.0, until, SAMPLES)
    assert run.status == REACHED
    exact = by_scipy(system, until, method, times)
    # the reference is known to some of its tolerances, as points of tables at large inputs are
    assert np.max(np.abs(run.at(times).position - exact)) <= (
        max(run.error, tolerance) + 1e-9 + 1e-11 * np.max(np.abs(exact)))


@pytest.mark.parametrize('seed', range(12))
def test_a_run_is_the_motion_of_scipy_from_point_to_point(seed):
    require_error(seed, 'DOP853')


def test_a_run_is_the_motion_of_an_implicit_method_too():
    require_error(3, 'Radau')


@pytest.mark.slow
@pytest.mark.parametrize('seed', range(100, 300))
def test_more_runs_are_the_motion_of_scipy_from_point_to_point(seed):
    require_error(seed, 'DOP853')
