# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
All sign changes of sampled functions, many at once, and roots in brackets to the last bits.

Zero counts as positive. Angles are given in order; a smaller one after a larger one is a turn
later.
"""
from collections.abc import Callable, Sequence
from math import nan, pi

from fourbar_ros.numerics.arrays import Array, EPS, Value, Values
from fourbar_ros.numerics.number_types import Function
import numpy as np

PARTS = 8          # of an interval at a closer look
CAUTION = 0.25     # part of the sample by which the cubic through samples may be wrong
# A dip is looked into as long as its lowest sample is less than this part of how much the parabola
# bends in a step.
DEEP = 0.25
HALVINGS = 26      # of a dip before it is taken for a touching point without a sign change
# Below this angle [rad] roots are found to an absolute tolerance: 0 has no last bit.
SMALL = 2.0**-12
# By how much the error of a step of Newton's method may exceed its square over the width of the
# bracket.
SAFETY = 64.0
NO_GAPS: Array = np.zeros(0, int)


def turn_after(x: Array, start: Array, period: float = 2.0 * pi) -> Array:
    """Return the angle x as the one that comes after ``start``, less than half a period away."""
    return np.asarray(np.where(x < start - 0.5 * period, x + period, x))


def fold(x: Value, period: float = 2.0 * pi) -> Value:
    """Return angles, an array or a float of at most a period less or more, in [0, period)."""
    if isinstance(x, float):
        x = x + period if x < 0.0 else x - period if x >= period else x + 0.0
        return x if x < period else 0.0      # a tiny negative angle rounds to the full period
    x = np.where(x < 0.0, x + period, np.where(x >= period, x - period, x + 0.0))
    return np.where(x < period, x, 0.0)


def turns_back(f: Array, rise: Array) -> Array:
    """Return where the Bernstein coefficient next to a sample has the other sign, or nearly so."""
    return np.asarray(((1.0 - CAUTION) * f + rise >= 0.0) != (f >= 0.0))


def changes_and_doubts(f: Array, rise: Array, is_closed: bool,
                       gaps: Array = NO_GAPS) -> tuple[Array, Array]:
    """Return in which intervals the sign changes, and which may have more roots."""
    # Hermite's cubic through two samples has as many roots as its Bernstein coefficients change
    # sign, or less by two. One root is plain; where there could be more, also if the inner
    # coefficients were a little smaller, the interval needs a closer look. Where one sample is so
    # small for its slope that the sign changes in an interval without a root, so do both beside
    # it. f, rise, shape (n, m): at equal steps, and a third of what f rises in one at its slope;
    # is_closed: after the last sample comes the first; gaps: indices of intervals left out.
    if is_closed:
        f, rise = (np.concatenate((v, v[:1])) for v in (f, rise))
    positive = f >= 0.0
    changes = positive[1:] != positive[:-1]
    at_first, at_second = turns_back(f[:-1], rise[:-1]), turns_back(f[1:], -rise[1:])
    doubtful = changes & at_first & at_second
    if (at_first | at_second).any():
        small = np.zeros_like(positive)
        small[:-1] = at_first & ~changes
        small[1:] |= at_second & ~changes
        if is_closed:
            small[[0, -1]] = small[0] | small[-1]
        doubtful |= small[:-1] | small[1:]
    if gaps.size:
        inner = gaps[gaps < len(changes)]
        changes[inner] = doubtful[inner] = False
    return changes, doubtful


def rises(f: Array, is_closed: bool, gaps: Array = NO_GAPS) -> Array:
    """Return a third of what sampled functions, shape (n, m), rise in a step at each sample."""
    # A third, as the inner Bernstein coefficients of a cubic are so far from its ends. By the
    # difference of five samples, which has no error for polynomials of degree four. For f = 0, 3,
    # 6, 9, ... all are 1. gaps: indices of samples after which functions are not smooth; of a
    # closed path the last is one of them.
    if gaps.size:
        return np.concatenate([rises(rows, False) for rows in np.split(f, gaps + 1) if len(rows)])
    if is_closed:
        f = np.concatenate((f[-2:], f, f[:2]))
    else:
        f = np.concatenate((_beyond(f)[::-1], f, _beyond(f[::-1])))
    return np.asarray((8.0 * (f[3:-1] - f[1:-3]) - (f[4:] - f[:-4])) / 36.0)


def _beyond(f: Array) -> Array:
    """Return the two samples before the first, extrapolated by cubics: the nearer one first."""
    near = 4.0 * (f[0] + f[2]) - 6.0 * f[1] - f[3]
    return np.stack((near, 4.0 * (near + f[1]) - 6.0 * f[0] - f[2]))


def look_closer(function: Function, row: Array, xa: Array, xb: Array) -> list[Array]:
    """Return brackets (which, xa, xb, fa, fb) of the roots in intervals that may have several."""
    # Each interval is cut in PARTS, and where |f| then has a minimum between equal signs, halved
    # on. function(x, row) evaluates the rows given; which: the index of the interval.
    # Example: f = (x - 0.52)^2 - 1e-4 on (0, 1) is positive at every eighth, and least at 0.5,
    # 3e-4. It is evaluated halfway to both neighbours, at 0.4375 and 0.5625, then around 0.5 at
    # 0.46875 and 0.53125, 3e-5 and the least so far, then around 0.53125 at 0.515625: -8e-5. So
    # the roots 0.51 and 0.53 lie in (0.5, 0.515625) and (0.515625, 0.53125).
    # one part more on either side: a minimum may be at an end
    x = xa + (xb - xa) * (np.arange(-1, PARTS + 2)[:, None] / PARTS)
    x[-2] = xb
    f = function(x.ravel(), np.tile(row, len(x))).reshape(x.shape)
    changes, size = (f[1:] >= 0.0) != (f[:-1] >= 0.0), np.abs(f)
    section, which = np.nonzero(changes[1:-1])
    brackets = [(which, *_ends(x, section + 1, which), *_ends(f, section + 1, which))]
    lowest, which = np.nonzero((size[1:-1] <= size[:-2]) & (size[1:-1] < size[2:]) & ~changes[1:]
                               & ~changes[:-1])
    three = np.arange(3)[:, None]
    x, f = x[lowest + three, which], f[lowest + three, which]
    for _ in range(HALVINGS):
        is_doubtful = _may_touch(x, f)
        which, x, f = which[is_doubtful], x[:, is_doubtful], f[:, is_doubtful]
        if not which.size:
            break
        halfway = 0.5 * (x[:-1] + x[1:])
        f_halfway = function(halfway.ravel(), np.tile(row[which], 2)).reshape(halfway.shape)
        x, f = (np.stack((old[0], new[0], old[1], new[1], old[2]))
                for old, new in ((x, halfway), (f, f_halfway)))
        changes = (f[1:] >= 0.0) != (f[:-1] >= 0.0)
        section, dip = np.nonzero(changes & (x[:-1] >= xa[which]) & (x[1:] <= xb[which]))
        brackets.append((which[dip], *_ends(x, section, dip), *_ends(f, section, dip)))
        dip = np.nonzero(~changes.any(axis=0))[0]
        lowest = np.argmin(np.abs(f[1:4, dip]), axis=0)
        which, x, f = which[dip], x[lowest + three, dip], f[lowest + three, dip]
    return [np.concatenate(rows) for rows in zip(*brackets)]


def _ends(samples: Array, section: Array, column: Array) -> tuple[Array, Array]:
    return samples[section, column], samples[section + 1, column]


def _may_touch(xs: Array, fs: Array) -> Array:
    """Return whether the function may have roots between three samples of one sign."""
    # The parabola through them comes down to half the middle one, or the middle one is so low
    # between the others that the error of the parabola's slope, unknown, may have hidden that.
    left, right = xs[1] - xs[0], xs[2] - xs[1]
    with np.errstate(invalid='ignore', over='ignore'):      # next to infinities
        slope_left, slope_right = (fs[1] - fs[0]) / left, (fs[2] - fs[1]) / right
        curvature = (slope_right - slope_left) / (left + right)
        slope = (slope_left * right + slope_right * left) / (left + right)
        return np.asarray((slope * slope > 2.0 * abs(fs[1] * curvature))
                          | (np.abs(fs[1])
                             < DEEP * np.abs(curvature) * np.minimum(left, right)**2))


def first_guesses(xa: Array, xb: Array, fa: Array, fb: Array, step_a: Values,
                  step_b: Values) -> Array:
    """Return a first guess of the root in each bracket from xa to xb, with values fa and fb."""
    # The inverse of f is interpolated with values and slopes (Hermite): a mean of the points of
    # Newton's method from both ends, x - step, and of the secant. Without steps (NaN), or where
    # that is outside, the secant's point.
    share = fa / (fa - fb)
    rest = 1.0 - share
    secant = xa + share * (xb - xa)
    x = rest * rest * (xa - step_a) + share * share * (xb - step_b) + 2.0 * share * rest * secant
    return np.where((x > xa) & (x < xb), x, secant)


def find_brackets(function: Function, x: Function, f: Array, rise: Array, is_closed: bool,
                  period: float = 2.0 * pi, gaps: Array = NO_GAPS) -> Sequence[Array]:
    """Return brackets (i, row, xa, xb, fa, guess) of all roots of sampled functions."""
    # function: (x, row) -> f of the rows given, or a positive multiple; x: (i, row) -> where
    # sample i of the row is [rad], which begins again after period, and a third of what x rises in
    # a step there. f, rise, is_closed, gaps: as in changes_and_doubts(); the interval after the
    # last sample counts as the last.
    changes, doubtful = changes_and_doubts(f, rise, is_closed, gaps)
    i, row = np.nonzero(changes | doubtful)
    is_plain = ~doubtful[i, row]
    j = (i + 1) % len(f)
    (xa, turn_a), (xb, turn_b) = x(i, row), x(j, row)
    xb = turn_after(xb, xa, period)
    here, there = i * f.shape[1] + row, j * f.shape[1] + row
    fa, fb, rise_a, rise_b = f.take(here), f.take(there), rise.take(here), rise.take(there)
    with np.errstate(all='ignore'):
        guess = first_guesses(xa, xb, fa, fb, fa * turn_a / rise_a, fb * turn_b / rise_b)
    brackets = i, row, xa, xb, fa, guess
    if is_plain.all():
        return brackets
    which, xa, xb, fa, fb = look_closer(function, *(v[~is_plain] for v in (row, xa, xb)))
    closer = (i[~is_plain][which], row[~is_plain][which], xa, xb, fa,
              first_guesses(xa, xb, fa, fb, nan, nan))
    return [np.concatenate((v[is_plain], w)) for v, w in zip(brackets, closer)]


def newton_roots(function: Function, which: Array, xa: Array, xb: Array, fa: Array,
                 x: Array) -> Array:
    """Return the root of a function in each bracket, to the last bits of x, all together."""
    # Newton's method, with bisection wherever that leaves the bracket or does not halve its step.
    # The last step is not looked at again: its error is about its square over the width of the
    # bracket. function: (x, some of ``which``) -> f, and the step f/f' (NaN: not known, so halve);
    # xa, xb, fa, x: where f changes its sign, its value at the first of them, and a first guess.
    # A zero at an end may not be where the sign changes: it counts as positive.
    x = np.where((fa != 0.0) & (x > xa) & (x < xb), x, 0.5 * (xa + xb))
    positive: Array = fa >= 0.0
    width = last = xb - xa
    roots, left = x.copy(), np.arange(x.size)       # left: brackets whose root is still sought
    while left.size:
        f, step = function(x, which)
        before = (f >= 0.0) == positive
        xa, xb = np.where(before, x, xa), np.where(before, xb, x)
        better = x - step
        is_newton = (better >= xa) & (better <= xb) & (2.0 * np.abs(step) <= last)
        better = np.where(is_newton, better, 0.5 * (xa + xb))
        tolerance = EPS * np.maximum(np.abs(better), SMALL)
        done = np.where(is_newton, SAFETY * step * step <= tolerance * width,
                        xb - xa <= 2.0 * tolerance)
        done |= ~np.isfinite(f)              # overflow: no root to be found
        roots[left] = better
        last, x = np.abs(x - better), better
        left, which, x, xa, xb, positive, width, last = (
            v[~done] for v in (left, which, x, xa, xb, positive, width, last))
    return roots


def halve(is_before: Callable[[float], bool], low: float, high: float) -> tuple[float, float]:
    """Return the neighbouring floats between which ``is_before`` turns from true to false."""
    # It is true at low and false at high; low may be the larger number of both.
    while True:
        middle = 0.5 * (low + high)
        if not min(low, high) < middle < max(low, high):
            return low, high
        if is_before(middle):
            low = middle
        else:
            high = middle
