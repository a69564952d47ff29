# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Loads on a body that moves, against Cartesian coordinates of all links in many digits.

The reference differentiates exp(j phi) c twice for each centre of gravity, phi the turn of the
base, and knows nothing of frames.
"""
from dataclasses import replace
from math import inf, nan

from flint import ctx
from fourbar_ros import (
    Applied,
    Base,
    Bodies,
    External,
    FourBar,
    InvalidParameter,
    load_scene,
    MissingBodies,
    Toggle,
)
from fourbar_ros.dynamics.equation import Equation
from fourbar_ros.dynamics.node_step import Mover, NOT_FINITE
from fourbar_ros.dynamics.system import System
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from support import contract, ROOT
from support.cartesian import BITS, errors, exact
from support.samples import more

BOUND = 10.0        # eps times condition
RODS = Bodies(*load_scene(ROOT / 'config/paper.yaml').linkage.bodies)
PAPER = FourBar(0.4, 1.2, 0.8, 1.0, bodies=RODS)


def bases(seed):
    """Yield bases with everything in them, or with one thing alone."""
    rng = np.random.default_rng(seed)
    while True:
        values = rng.normal(0.0, (10.0, 10.0, 3.0, 30.0))
        if rng.random() < 0.5:
            values *= np.arange(4) == rng.integers(4)
        yield Base(*values.tolist())


@contract.every_mechanism
def test_loads_to_ten_eps_of_the_condition(case, count=more(3, 20)):
    many = 4 * count if case == contract.MACHINES else count
    for (mechanism, given), base in zip(contract.ordinary(case, 601, many), bases(602)):
        mechanism = mechanism.with_base(base)
        with ctx.workprec(BITS):
            beyond = [(name, error, base) for name, error, is_load in
                      errors(mechanism, given, exact(mechanism, given))
                      if is_load and not error <= BOUND]
        assert beyond == []


def test_arrays_are_what_single_samples_are():
    inputs = np.linspace(-3.0, 3.0, 7)
    columns = [row for row, _ in zip(bases(608), inputs)]
    together = PAPER.loads(inputs, 25.0, -4.0, base=Base(*np.transpose(columns)))
    for i, (x, base) in enumerate(zip(inputs.tolist(), columns)):
        one = PAPER.loads(x, 25.0, -4.0, base=base)
        assert np.allclose([row[i] for row in together], one, rtol=1e-13, atol=1e-10)
    rocker = FourBar(1.0, 0.5, 0.9, 1.1, bodies=RODS)
    low, high = rocker.input_ranges[0]
    loads = rocker.loads([high + 0.1, 0.5 * (low + high)], base=Base(0.0, 9.81, [1.0, 2.0]))
    assert np.isnan(loads.f41[0]) and np.isfinite(loads.f41[1])
    flat = FourBar(1.0, 1.0, 1.0, 1.0, bodies=RODS)
    there, beside = (flat.loads([x], 9.0, base=Base(1.0)) for x in (0.0, 1e-12))
    assert not np.isfinite(there.f41[0])        # rods in line bear anything; the drive is known
    for name in ('driving_torque', 'shaking_force', 'shaking_moment'):
        assert getattr(there, name) == pytest.approx(getattr(beside, name), rel=1e-9, abs=1e-9)
    with pytest.raises(Toggle):
        flat.loads(0.0, 9.0, base=Base(1.0))


@contract.every_mechanism
def test_the_equation_of_motion_gives_the_drive(case):
    for (mechanism, given), base in zip(contract.ordinary(case, 609, 10), bases(610)):
        mechanism = mechanism.with_base(base)
        loads, equation = mechanism.loads(*given), Equation(mechanism.without_stroke())
        drive = sum(getattr(loads, name, 0.0) for name in ('driving_torque', 'driving_force'))
        inertia, half_slope, force, *_ = equation.terms(given[0])
        size = abs(inertia * given[2]) + abs(half_slope * given[1]**2) + abs(force)
        assert abs(equation.torque(*given) - drive) <= 1e-9 * (size + abs(drive))


def test_what_cannot_be_is_refused():
    for value in (nan, inf, 'fast'):
        with pytest.raises(InvalidParameter, match='rate'):
            PAPER.with_base(Base(rate=value))
    with pytest.raises(InvalidParameter, match='gravity'):
        replace(PAPER, gravity=(0.0, 1.0, 2.0))
    with pytest.raises(InvalidParameter, match='broadcast'):
        PAPER.loads([1.0, 2.0], base=Base([0.0, 1.0, 2.0]))
    with pytest.raises(MissingBodies):
        FourBar(0.4, 1.2, 0.8, 1.0).loads([1.0], base=Base())


# --- steps of the node ---------------------------------------------------------------------------

ROCKER = FourBar(0.9, 0.8, 0.7, 1.0, bodies=RODS)      # swings through its toggles
ACTS = {'base': Base(1.0, 9.0, 2.0, -3.0), 'output': (20.0, -30.0, 4.0)}


def moved(mover, count, step=1e-3):
    """Return the states of a mover after some steps."""
    values, found = mover.start(), []
    for _ in range(count):
        status, values = mover.next(values, step, mode=mover.mode)
        assert status == 0
        found.append((values.position, values.velocity, values.acceleration))
    return np.array(found)


@pytest.mark.parametrize('linkage, start', [(PAPER, 0.3), (ROCKER, 0.5)])
def test_a_step_under_what_acts_is_one_of_a_linkage_that_has_it(linkage, start):
    along = replace(linkage, external=External(output=Applied(0.0, 0.0, along=0.5, across=0.1)))
    mover = Mover(System(along, start), 1e-9, 9999, acting=tuple(ACTS))
    for name, what in ACTS.items():
        mover.act(name, what)
    fixed = along.with_base(ACTS['base']).with_external(External(
        output=Applied(20.0, -30.0, along=0.5, across=0.1, couple=4.0)))
    alone = Mover(System(fixed, start), 1e-9, 9999)
    ours, due = moved(mover, 600), moved(alone, 600)
    assert np.abs(ours - due).max() <= 1e-9 * np.abs(due).max()


def test_the_base_of_now_moves_the_next_step():
    """Held over a step: its error is of first order."""
    def base_at(t):
        return Base(3.0 * np.sin(9.0 * t), 9.81, 0.5 * np.cos(4.0 * t), -2.0 * np.sin(4.0 * t))

    def rates(t, state):
        return [state[1], Equation(PAPER.with_base(base_at(t))).acceleration(*state)]
    run = solve_ivp(rates, (0.0, 0.2), [0.3, 0.0], rtol=1e-8, atol=1e-8)
    errors = []
    for step in (2e-3, 1e-3):
        mover = Mover(System(PAPER, 0.3), 1e-9, 200, acting=('base',))
        values = mover.start()
        for number in range(round(0.2 / step)):
            mover.act('base', base_at(number * step))
            _, values = mover.next(values, step)
        errors.append(abs(values.position - run.y[0, -1]))
    assert errors[0] < 1e-3 and errors[1] < 0.6 * errors[0]


def test_nothing_moves_while_what_acts_is_unknown():
    mover = Mover(System(PAPER, 0.3, 1.0), 1e-9, 200, acting=('base',))
    status, values = mover.next(mover.start(), 1e-3)
    assert status == NOT_FINITE and (values.position, values.velocity) == (0.3, 0.0)
    mover.act('base', Base(0.0, 9.81))
    assert mover.next(values, 1e-3)[0] == 0
