# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Four-bar linkages and poses drawn from families of ordinary and extreme cases.

With the exact loads and conditions of what is drawn: tests and measurements of accuracy share
them.
"""
from math import acos, fsum, pi, sin
from typing import NamedTuple

from fourbar_ros import Applied, Bodies, Body, External, FourBar
import mpmath as mp
import numpy as np
from support.reference import condition, loads_of, pose, random_lengths

ORDINARY = 6.0      # condition of theta4 up to which it is not in line within some degrees


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


# --- drawn ---------------------------------------------------------------------------------------

def draw(rng, family):
    """Return a case of a family, a mode, and the lengths in doubles; one that can be assembled."""
    while True:
        case, mode = FAMILIES[family](rng), int(rng.integers(1, 3))
        lengths = case.lengths(*case.parameters)
        if pose(lengths, 2 * mode - 3, mp.mpf(case.theta1)) is not None:
            return case, mode, tuple(map(float, lengths))


def least_conditions(case, lengths, omega):
    """
    Return what conditions of an angle, its rate and its acceleration count at least.

    An angle is a part of a turn. Compared with linkages that remain a change point the condition
    can vanish (y' = 1, y'' = 0 of a parallelogram). Left is the last digit of the rates, which
    enters y'' times a1 a4 sin(x)/|A O4|^2.
    """
    if not case.exact:
        return 1.0, 0.0, 0.0
    a1, _, _, a4 = lengths
    factor = a1 * a4 * abs(sin(case.theta1)) / ((a1 - a4)**2
                                                + 4.0 * a1 * a4 * sin(0.5 * case.theta1)**2)
    return 1.0, abs(omega), omega**2 * (1.0 + factor * (a1 != a4))


def near_toggle(rng, margin):
    """Return lengths of a crank-rocker that clears the toggle at theta1 = 0 by a margin."""
    while True:
        a1, _, a3, a4 = crank_lengths(rng).tolist()
        lengths = (a1, a4 - a1 + a3 - margin * (a4 - a1), a3, a4)
        if closes(lengths) and FourBar(*lengths).classification == 'Grashof crank-rocker':
            return lengths


def random_masses(rng, reach, speed):
    """Return bodies, applied loads and gravity as tuples of floats, all of a size that matters."""
    bodies = [(rng.uniform(0.1, 10.0), *rng.uniform(-1.0, 1.0, 2) * reach,
               rng.uniform(0.0, 1.0) * reach**2)
              for _ in range(3)]
    force = reach * speed**2
    applied = [(*rng.uniform(-5.0, 5.0, 2) * force, *rng.uniform(-1.0, 1.0, 2) * reach,
                rng.uniform(-5.0, 5.0) * force * reach) for _ in range(2)]
    return bodies, applied, tuple(rng.uniform(-1.0, 1.0, 2) * force)


def loaded(rng, family):
    """
    Return a linkage with everything acting, its input, and its exact loads with their conditions.

    Loads in the order of LOAD_NAMES.
    """
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
    return linkage, (case.theta1, omega, alpha), truth, cond
