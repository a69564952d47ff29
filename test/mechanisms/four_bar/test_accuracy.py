# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The error of every output in units of eps times its condition.

Over families of ordinary and extreme cases.

The condition is exact to first order: what the result moves by when each given number is rounded.
About one eps cond is what no algorithm can avoid; see :func:`reference.condition`.
"""

from fourbar_ros import FourBar
import mpmath as mp
import numpy as np
import pytest
from support.four_bar_families import (
    draw,
    FAMILIES,
    least_conditions,
    loaded,
    near_toggle,
    ORDINARY,
)
from support.reference import condition, EPS, LOAD_NAMES, MOTION_FIELDS, motion_of, pose
from support.samples import more, some

# Bounds in eps cond. For angles a condition below one radian counts as one: they are parts of a
# turn.
ANGLE_BOUND, RATE_BOUND, LOADS_BOUND = 2.0, 5.0, 5.0
# Loads at an exact change point: the condition is that of the linkages that remain one, see
# motion_errors; what the accelerations lose against it the loads lose too.
EXACT_LOADS_BOUND = 50.0
# theta4 itself [rad], where its condition is at most ORDINARY.
THETA4_BOUND = 3e-15


def motion_errors(rng, family):
    """
    Return the error of each of MOTION_FIELDS in eps cond, and that of an ordinary theta4 in rad.

    At constant rate, so that the accelerations are the second derivatives; those due to alpha1 are
    the rates over again.
    """
    case, mode, lengths = draw(rng, family)
    omega, alpha = case.speed * rng.normal(), 0.0
    truth, cond = condition(
        lambda v: motion_of(case.lengths(*v[3:]), 2 * mode - 3, *v[:3]),
        [mp.mpf(v) for v in (case.theta1, omega, alpha, *case.parameters)])
    motion = FourBar(*lengths, mode=mode).motion(case.theta1, omega, alpha)
    errors = [abs(getattr(motion, name) - exact) for name, exact in zip(MOTION_FIELDS, truth)]
    errors[:2] = [min(e, abs(e - 2 * mp.pi)) for e in errors[:2]]
    angle, rate, acceleration = least_conditions(case, lengths, omega)
    least = [angle] * 2 + [rate] * 4 + [acceleration] * 4
    cond = [max(c, mp.mpf(limit)) for c, limit in zip(cond, least)]
    radians = float(errors[0]) if cond[0] <= ORDINARY else 0.0
    return [float(e / (EPS * c)) for e, c in zip(errors, cond)] + [radians]


def load_errors(rng, family):
    """Return the error of each of LOAD_NAMES in eps cond for one case with everything acting."""
    linkage, given, truth, cond = loaded(rng, family)
    loads = linkage.loads(*given)
    found = [mp.mpc(getattr(loads, f'{name}_x'), getattr(loads, f'{name}_y'))
             if isinstance(t, mp.mpc) else getattr(loads, name)
             for name, t in zip(LOAD_NAMES, truth)]
    return [float(abs(f - t) / (EPS * c)) for f, t, c in zip(found, truth, cond)]


def worst(function, family, seed, count):
    """Return the largest value of each error over some cases of a family."""
    rng = np.random.default_rng(seed)
    return np.max([function(rng, family) for _ in range(count)], axis=0)


@pytest.mark.parametrize('family', FAMILIES)
def test_motion(family):
    *errors, radians = worst(motion_errors, family, 31, more(20, 60))
    bounds = [ANGLE_BOUND] * 2 + [RATE_BOUND] * 8
    assert {name: error for name, error, bound in zip(MOTION_FIELDS, errors, bounds)
            if not error <= bound} == {}
    assert radians <= THETA4_BOUND


@pytest.mark.parametrize('family', FAMILIES)
def test_loads(family):
    errors = worst(load_errors, family, 32, more(3, 20))
    bound = (EXACT_LOADS_BOUND if FAMILIES[family](np.random.default_rng(32)).exact
             else LOADS_BOUND)
    assert {name: error for name, error in zip(LOAD_NAMES, errors) if not error <= bound} == {}


# --- near a toggle, relative to the peak ---------------------------------------------------------

def near_toggle_error(rng, margin):
    """Return the error of theta4'' over its peak for a crank that clears a toggle by a margin."""
    lengths = near_toggle(rng, margin)
    x = np.concatenate([sign * 10.0**np.linspace(-9, 0.49, 60) for sign in (-1.0, 1.0)])
    second = FourBar(*lengths).motion(x, 1.0).alpha4
    exact = [float(pose(lengths, 1, mp.mpf(v)).ddy) for v in x.tolist()]
    return np.abs(second - exact).max() / np.abs(exact).max()


@some('margin', [1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 1e-14], (1e-2, 1e-8, 1e-14))
def test_second_derivative_near_a_toggle_relative_to_its_peak(margin):
    rng = np.random.default_rng(35)
    assert max(near_toggle_error(rng, margin) for _ in range(8)) <= 5e-15
