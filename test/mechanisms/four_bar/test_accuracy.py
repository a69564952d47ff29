# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The error of every output in units of eps times its condition.

Over families of ordinary and extreme cases.

The condition is exact to first order: what the result moves by when each given number is rounded.
About one eps cond is what no algorithm can avoid; see :func:`reference.condition`. The counts of
the default run are a sample, ``-m slow`` runs the full ones.
"""
from math import acos, fsum, nextafter, pi, remainder, sin
from typing import NamedTuple

from fourbar_ros import Applied, Bodies, Body, CROSSED, External, FourBar, OPEN
import mpmath as mp
import numpy as np
import pytest
from support.reference import (
    condition,
    EPS,
    LOAD_NAMES,
    loads_of,
    MOTION_FIELDS,
    motion_of,
    pose,
    random_lengths,
)

# Bounds in eps cond. For angles a condition below one radian counts as one: they are parts of a
# turn.
ANGLE_BOUND, RATE_BOUND, LOADS_BOUND = 2.0, 5.0, 5.0
# Loads at an exact change point: the condition is that of the linkages that remain one, see
# motion_errors; what the accelerations lose against it the loads lose too.
EXACT_LOADS_BOUND = 50.0
# theta4 itself [rad], where its condition is not above 6 (not in line within some degrees).
THETA4_BOUND, ORDINARY = 3e-15, 6.0


class Case(NamedTuple):
    """Free parameters of the four lengths (for doubles and mpmath), theta1, the speed."""

    parameters: tuple
    lengths: object     # parameters -> a1, a2, a3, a4
    theta1: float
    speed: float = 1.0
    # change point: outputs that are constant have no condition, see motion_errors
    exact: bool = False


def free(lengths, theta1, speed=1.0):
    """Return the Case in which all four lengths are free."""
    return Case(tuple(map(float, lengths)), lambda *a: a, float(theta1), speed)


def closes(lengths):
    return min(lengths) > 0.0 and fsum(list(lengths) + [-2.0 * max(lengths)]) > 0.0


def any_lengths(rng):
    return random_lengths(rng, 1)[0]


def crank_lengths(rng):
    """Return lengths of a crank that turns fully: Grashof, crank shortest."""
    while True:
        lengths = np.sort(any_lengths(rng))
        if lengths[0] + lengths[3] < lengths[1] + lengths[2]:
            return np.concatenate((lengths[:1], rng.permutation(lengths[1:])))


def somewhere(rng, lengths):
    """Return a theta1 in the input range."""
    ranges = FourBar(*map(float, lengths)).input_ranges
    return rng.uniform(*ranges[rng.integers(len(ranges))])


def small(rng, low, high):
    """Return a number of either sign, uniform in its logarithm."""
    return rng.choice((-1.0, 1.0)) * 10.0**rng.uniform(low, high)


# --- families ------------------------------------------------------------------------------------

def random_linkage(rng):
    lengths = any_lengths(rng)
    return free(lengths, somewhere(rng, lengths))


def input_near_zero(rng):
    return free(crank_lengths(rng), small(rng, -50, -1))


def input_near_pi(rng):
    return free(crank_lengths(rng), pi + small(rng, -16, -1))


def output_near_pi(rng):
    while True:
        a1, a2, a3, a4 = lengths = any_lengths(rng)
        cosine = (a1**2 + (a4 - a3)**2 - a2**2) / (2.0 * a1 * (a4 - a3))
        if abs(cosine) < 1.0:
            return free(lengths, acos(cosine) + small(rng, -16, -2))


def rocker_near_limit(rng):
    while True:
        lengths = any_lengths(rng)
        linkage = FourBar(*map(float, lengths))
        if not linkage.turns_fully:
            low, high = linkage.input_ranges[-1]
            step = 10.0**rng.uniform(-14, -1) * (high - low)
            return free(lengths, low + step if rng.random() < 0.5 else high - step)


def crank_near_toggle(rng):
    """Draw a crank that clears the toggle position by 1e-2 to 1e-14."""
    while True:
        a1, a2, a3, a4 = crank_lengths(rng)
        margin = 10.0**rng.uniform(-14, -2)
        a2 = a4 - a1 + a3 - margin if rng.random() < 0.5 else a3 - a4 + a1 + margin
        if closes((a1, a2, a3, a4)):
            return free((a1, a2, a3, a4), small(rng, -9, 0))


def near_change_point(rng):
    """Margins from one last bit to 1e-3, close to the flat position or anywhere."""
    while True:
        a1, a2, a3, a4 = crank_lengths(rng)
        flat, a4 = ((pi, a2 + a3 - a1), (0.0, a2 - a3 + a1), (0.0, a3 - a2 + a1))[rng.integers(3)]
        lengths = (a1, a2, a3, a4 * (1.0 + small(rng, -16, -3)))
        if closes(lengths):
            return free(lengths, flat + small(rng, -14, 0) if rng.random() < 0.7
                        else somewhere(rng, lengths))


def near_parallelogram(rng):
    one, other = rng.uniform(0.1, 1.0, 2)
    near = 1.0 + small(rng, -16, -2)
    return free((one, other, one * near, other / near), pi * rng.integers(2) + small(rng, -14, 0))


def near_kite(rng):
    one, other = rng.uniform(0.1, 1.0, 2)
    near = 1.0 + small(rng, -16, -2)
    lengths = ((one, other, other * near, one / near) if rng.random() < 0.5
               else (one, one * near, other, other / near))
    return free(lengths, small(rng, -14, 0))


def link_ratios(power):
    """Return a family: lengths over 10^+-power, the two longest nearly equal if needed."""
    def family(rng):
        while True:
            lengths = 10.0**rng.uniform(-power, power, 4)
            order = np.argsort(lengths)
            if rng.random() < 0.7:
                lengths[order[2]] = (lengths[order[3]]
                                     + rng.uniform(-1.0, 1.0) * lengths[order[:2]].sum())
            if closes(lengths):
                break
        return free(lengths, somewhere(rng, lengths) if rng.random() < 0.7
                    else small(rng, -power, 0))
    return family


def units(rng):
    lengths = any_lengths(rng)
    return free(lengths * 10.0**rng.uniform(-150, 150), somewhere(rng, lengths))


def speeds(rng):
    lengths = any_lengths(rng)
    return free(lengths, somewhere(rng, lengths), small(rng, -8, 8))


def many_turns(rng):
    return free(crank_lengths(rng), rng.uniform(-1e9, 1e9))


def dyadic(rng, count):
    """Return lengths whose sums are exact."""
    return tuple(rng.integers(2**10, 2**20, count) / 2.0**20)


def exactly(lengths, count, flats):
    """
    Return a family of exact change points.

    The condition is that of the parameters that keep it so.
    """
    def family(rng):
        while True:
            parameters = dyadic(rng, count)
            made = lengths(*parameters)
            if closes(made):
                break
        if rng.random() < 0.6:
            theta1 = flats[rng.integers(len(flats))] + small(rng, -14, 0)
        else:
            theta1 = somewhere(rng, made)
        return Case(parameters, lengths, float(theta1), exact=True)
    return family


FAMILIES = {
    'random': random_linkage, 'theta1 near 0': input_near_zero, 'theta1 near pi': input_near_pi,
    'theta4 near pi': output_near_pi, 'rocker near its limit': rocker_near_limit,
    'crank near a toggle': crank_near_toggle, 'near a change point': near_change_point,
    'near a parallelogram': near_parallelogram, 'near a kite': near_kite,
    'link ratios 1e3': link_ratios(1.5), 'link ratios 1e8': link_ratios(4.0),
    'link ratios 1e16': link_ratios(8.0),
    'units': units, 'speeds': speeds, 'many turns': many_turns,
    'flat at pi': exactly(lambda a, b, c: (a, b, c, b + c - a), 3, (pi,)),
    'flat at 0, coupler first': exactly(lambda a, b, c: (a, b + c - a, b, c), 3, (0.0,)),
    'flat at 0, output first': exactly(lambda a, b, c: (a, b, c, a + c - b), 3, (0.0,)),
    'parallelogram': exactly(lambda a, b: (a, b, a, b), 2, (0.0, pi)),
    'kite a1=a4': exactly(lambda a, b: (a, b, b, a), 2, (0.0,)),
    'kite a1=a2': exactly(lambda a, b: (a, a, b, b), 2, (0.0,)),
    'rhombus': exactly(lambda a: (a, a, a, a), 1, (0.0, pi)),
}


# --- errors --------------------------------------------------------------------------------------

def draw(rng, family):
    """Return a case of a family, a mode, and the lengths in doubles; one that can be assembled."""
    while True:
        case, mode = FAMILIES[family](rng), int(rng.integers(1, 3))
        lengths = case.lengths(*case.parameters)
        if pose(lengths, 2 * mode - 3, mp.mpf(case.theta1)) is not None:
            return case, mode, tuple(map(float, lengths))


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
    cond[:2] = [max(c, 1) for c in cond[:2]]
    if case.exact:
        # Compared with linkages that remain a change point the condition can vanish (y' = 1, y'' =
        # 0 of a parallelogram). Left is the last digit of the rates, which enters y'' times a1 a4
        # sin(x)/|A O4|^2.
        a1, _, _, a4 = lengths
        factor = a1 * a4 * abs(sin(case.theta1)) / ((a1 - a4)**2
                                                    + 4.0 * a1 * a4 * sin(0.5 * case.theta1)**2)
        least = [1.0] * 2 + [abs(omega)] * 4 + [omega**2 * (1.0 + factor * (a1 != a4))] * 4
        cond = [max(c, mp.mpf(limit)) for c, limit in zip(cond, least)]
    radians = float(errors[0]) if cond[0] <= ORDINARY else 0.0
    return [float(e / (EPS * c)) for e, c in zip(errors, cond)] + [radians]


def random_masses(rng, reach, speed):
    """Return bodies, applied loads and gravity as tuples of floats, all of a size that matters."""
    bodies = [(rng.uniform(0.1, 10.0), *rng.uniform(-1.0, 1.0, 2) * reach,
               rng.uniform(0.0, 1.0) * reach**2)
              for _ in range(3)]
    force = reach * speed**2
    applied = [(*rng.uniform(-5.0, 5.0, 2) * force, *rng.uniform(-1.0, 1.0, 2) * reach,
                rng.uniform(-5.0, 5.0) * force * reach) for _ in range(2)]
    return bodies, applied, tuple(rng.uniform(-1.0, 1.0, 2) * force)


def load_errors(rng, family):
    """Return the error of each of LOAD_NAMES in eps cond for one case with everything acting."""
    case, mode, lengths = draw(rng, family)
    bodies, applied, gravity = random_masses(rng, float(np.median(lengths)), case.speed)
    omega, alpha = case.speed * rng.normal(), case.speed**2 * rng.normal()
    n = len(case.parameters)

    def exact(v):
        split = v[3 + n:]
        return loads_of(case.lengths(*v[3:3 + n]), 2 * mode - 3, *v[:3],
                        [split[4 * i:4 * i + 4] for i in range(3)],
                        [split[12 + 5 * i:17 + 5 * i] for i in range(2)], split[22:])

    truth, cond = condition(exact, [mp.mpf(float(v)) for v in (
        case.theta1, omega, alpha, *case.parameters, *sum(bodies, ()), *sum(applied, ()),
        *gravity)])
    linkage = FourBar(*lengths, mode=mode, gravity=tuple(map(float, gravity)),
                      bodies=Bodies(*(Body(*map(float, b)) for b in bodies)),
                      external=External(*(Applied(*map(float, a)) for a in applied)))
    loads = linkage.loads(case.theta1, omega, alpha)
    given = [mp.mpc(getattr(loads, f'{name}_x'), getattr(loads, f'{name}_y'))
             if isinstance(t, mp.mpc) else getattr(loads, name)
             for name, t in zip(LOAD_NAMES, truth)]
    return [float(abs(g - t) / (EPS * c)) for g, t, c in zip(given, truth, cond)]


def worst(function, family, seed, count):
    """Return the largest value of each error over some cases of a family."""
    rng = np.random.default_rng(seed)
    return np.max([function(rng, family) for _ in range(count)], axis=0)


def check_motion(family, seed, count):
    *errors, radians = worst(motion_errors, family, seed, count)
    bounds = [ANGLE_BOUND] * 2 + [RATE_BOUND] * 8
    assert {name: error for name, error, bound in zip(MOTION_FIELDS, errors, bounds)
            if not error <= bound} == {}
    assert radians <= THETA4_BOUND


def check_loads(family, seed, count):
    errors = worst(load_errors, family, seed, count)
    bound = (EXACT_LOADS_BOUND if FAMILIES[family](np.random.default_rng(seed)).exact
             else LOADS_BOUND)
    assert {name: error for name, error in zip(LOAD_NAMES, errors) if not error <= bound} == {}


@pytest.mark.parametrize('family', FAMILIES)
def test_motion_of_a_sample(family):
    check_motion(family, 31, 80)


@pytest.mark.parametrize('family', FAMILIES)
def test_loads_of_a_sample(family):
    check_loads(family, 32, 10)


@pytest.mark.slow
@pytest.mark.parametrize('family', FAMILIES)
def test_motion_in_full(family):
    check_motion(family, 33, 20000 if family == 'random' else 3000)


@pytest.mark.slow
@pytest.mark.parametrize('family', FAMILIES)
def test_loads_in_full(family):
    check_loads(family, 34, 20000 if family == 'random' else 300)


# --- near a toggle, relative to the peak ---------------------------------------------------------

def near_toggle_error(rng, margin):
    """Return the error of theta4'' over its peak for a crank that clears a toggle by a margin."""
    while True:
        a1, _, a3, a4 = crank_lengths(rng).tolist()
        # w = small at theta1 = 0... u at pi
        lengths = (a1, a4 - a1 + a3 - margin * (a4 - a1), a3, a4)
        if closes(lengths) and FourBar(*lengths).classification == 'Grashof crank-rocker':
            break
    x = np.concatenate([sign * 10.0**np.linspace(-9, 0.49, 60) for sign in (-1.0, 1.0)])
    second = FourBar(*lengths).motion(x, 1.0).alpha4
    exact = [float(pose(lengths, 1, mp.mpf(v)).ddy) for v in x.tolist()]
    return np.abs(second - exact).max() / np.abs(exact).max()


@pytest.mark.parametrize('margin', [1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 1e-14])
def test_second_derivative_near_a_toggle_relative_to_its_peak(margin):
    rng = np.random.default_rng(35)
    assert max(near_toggle_error(rng, margin) for _ in range(8)) <= 5e-15


# --- exact change points: one-sided values -------------------------------------------------------

FLAT_AT_ZERO = [(2.0, 3.5, 4.0, 1.5), (2.0, 3.0, 4.0, 3.0), (2.0, 3.0, 2.0, 3.0),
                (2.0, 3.0, 3.0, 2.0),
                (2.0, 2.0, 3.0, 3.0), (1.0, 1.0, 1.0, 1.0)]


@pytest.mark.parametrize('mode', [CROSSED, OPEN])
@pytest.mark.parametrize('lengths', FLAT_AT_ZERO)
def test_flat_position_at_zero_has_the_limit_from_above(lengths, mode):
    linkage = FourBar(*lengths, mode=mode)
    assert linkage.classification == 'change point'
    limit = pose(lengths, 2 * mode - 3, mp.mpf(10)**-50)
    for motion in (linkage.motion(0.0, 1.0), linkage.motion(np.zeros(1), 1.0)):
        assert abs(remainder(float(np.ravel(motion.theta4)[0] - limit.y), 2 * pi)) <= 2 * EPS
        assert abs(motion.omega4 - float(limit.dy)) <= 4 * EPS * max(1.0, abs(float(limit.dy)))
        assert abs(motion.omega_beta - float(limit.db)) <= 4 * EPS * max(1.0, abs(float(limit.db)))
        assert abs(motion.alpha4) <= 1e-40 and abs(motion.alpha_beta) <= 1e-40


def test_rate_jumps_at_the_flat_position_at_pi():
    linkage = FourBar(2.0, 4.0, 3.0, 5.0)     # a1 + a4 = a2 + a3
    # pi is below pi
    before, after = linkage.motion(pi, 1.0), linkage.motion(nextafter(pi, 4.0), 1.0)
    assert sorted((before.omega4, after.omega4)) == pytest.approx([-0.2359, 0.8074], abs=5e-5)
    for motion, at in ((before, pi), (after, nextafter(pi, 4.0))):
        exact = pose(linkage.lengths, 1, mp.mpf(at))
        assert motion.omega4 == pytest.approx(float(exact.dy), rel=8 * EPS)
        assert motion.alpha4 == pytest.approx(float(exact.ddy), rel=1e-12, abs=1e-30)


@pytest.mark.parametrize('ulps', [-3, -1, 1, 3])
@pytest.mark.parametrize('lengths', FLAT_AT_ZERO + [(2.0, 4.0, 3.0, 5.0)])
def test_one_last_bit_from_a_change_point(lengths, ulps):
    """Nothing special: the sums of the lengths are exact, and so is the clearance."""
    lengths = (*lengths[:3], lengths[3] * (1.0 + ulps * EPS))
    linkage = FourBar(*lengths)
    assert linkage.classification != 'change point' and 0.0 < linkage.change_point_margin < 4 * EPS
    for x in (1e-12, 1e-8, 3e-8, 1e-4, 1.0, pi - 1e-8, pi, -1e-8):
        exact = pose(lengths, 1, mp.mpf(x))
        if exact is None:
            continue
        motion = linkage.motion(x, 1.0)
        assert abs(remainder(float(motion.theta4 - exact.y), 2.0 * pi)) <= 4 * EPS
        assert motion.omega4 == pytest.approx(float(exact.dy), rel=1e-13, abs=1e-14)
        assert abs(motion.alpha4 - exact.ddy) <= 32 * EPS * max(1.0, abs(float(exact.ddy)),
                                                                abs(float(exact.ddy * x)))
