"""
All sign changes of sampled functions: one function in plain floats, or many brackets at once.

Zero counts as positive. Angles are given in order; a smaller one after a larger one is a turn later.
"""
from __future__ import annotations

from math import pi

import numpy as np

EPS = 2.0**-52
# Below this angle [rad] roots are found to an absolute tolerance: 0 has no last bit.
SMALL = 2.0**-12
# Parts of an interval at a closer look.
PARTS = 8
# Part of the sample by which the cubic is allowed to be wrong.
CAUTION = 0.25
# Halvings of a dip before it is taken for a touching point without a sign change.
HALVINGS = 26


def turn_after(x, start):
    """Return the angle x as the one that comes after ``start``, less than half a turn away."""
    return x + 2.0 * pi * (x < start - pi)


def intervals_with_roots(f, is_closed):
    """
    Return (i, column, is_plain) of the intervals between samples that have roots, or may have two more.

    Hermite's cubic through two samples, with slopes from five samples each, has as many roots as its
    Bernstein coefficients change sign, or less by two. One root is plain; where there could be more, also
    if the inner coefficients were a little smaller, the interval needs a closer look. Where one sample is
    so small for its slope that the sign changes in an interval without a root, so do both intervals beside it.

    Parameters
    ----------
    f : ndarray, shape (n, m)
        At equal steps.
    is_closed : bool
        After the last sample comes the first.

    """
    if is_closed:
        f = np.concatenate((f[-2:], f, f[:3]))
    else:
        f = np.concatenate((_beyond(f)[::-1], f, _beyond(f[::-1])))
    rise = (8.0 * (f[3:-1] - f[1:-3]) - (f[4:] - f[:-4])) / 36.0     # a third of the slope
    f = f[2:-2]
    positive = f >= 0.0
    one = ((1.0 - CAUTION) * f[:-1] + rise[:-1] >= 0.0) != positive[:-1]
    other = ((1.0 - CAUTION) * f[1:] - rise[1:] >= 0.0) != positive[1:]
    changes = positive[1:] != positive[:-1]
    small = np.zeros(f.shape, bool)
    small[:-1] = one & ~changes
    small[1:] |= other & ~changes
    if is_closed:
        small[[0, -1]] = small[0] | small[-1]
    doubtful = small[:-1] | small[1:] | changes & one & other
    i, column = np.nonzero(changes | doubtful)
    return i, column, ~doubtful[i, column]


def _beyond(f):
    """Return the two samples before the first, by cubics."""
    one = 4.0 * (f[0] + f[2]) - 6.0 * f[1] - f[3]
    return np.stack((one, 4.0 * (one + f[1]) - 6.0 * f[0] - f[2]))


def look_closer(function, row, xa, xb):
    """
    Return brackets (which, xa, xb, fa, fb) of the roots in intervals that may have several.

    Each interval is cut in :data:`PARTS`, and where |f| then has a minimum between equal signs, halved on.
    ``function(x, row)`` evaluates the rows given; ``which``: the index of the interval.
    """
    # one part more on either side: a minimum may be at an end
    x = xa + (xb - xa) * (np.arange(-1, PARTS + 2)[:, None] / PARTS)
    x[-2] = xb
    f = function(x.ravel(), np.tile(row, len(x))).reshape(x.shape)
    positive, size = f >= 0.0, np.abs(f)
    changes = positive[1:] != positive[:-1]
    i, which = np.nonzero(changes[1:-1])
    found = [(which, x[i + 1, which], x[i + 2, which], f[i + 1, which], f[i + 2, which])]
    i, which = np.nonzero((size[1:-1] <= size[:-2]) & (size[1:-1] < size[2:]) & ~changes[1:] & ~changes[:-1])
    xs, fs = ([v[i + j, which] for j in range(3)] for v in (x, f))
    for _ in range(HALVINGS):
        going = _may_touch(xs, fs)
        which, xs, fs = which[going], [v[going] for v in xs], [v[going] for v in fs]
        if not which.size:
            break
        mids = 0.5 * (xs[0] + xs[1]), 0.5 * (xs[1] + xs[2])
        f_mids = np.split(function(np.concatenate(mids), np.tile(row[which], 2)), 2)
        xs = np.stack((xs[0], mids[0], xs[1], mids[1], xs[2]))
        fs = np.stack((fs[0], f_mids[0], fs[1], f_mids[1], fs[2]))
        positive = fs >= 0.0
        changes = positive[1:] != positive[:-1]
        i, j = np.nonzero(changes & (xs[:-1] >= xa[which]) & (xs[1:] <= xb[which]))
        found.append((which[j], xs[i, j], xs[i + 1, j], fs[i, j], fs[i + 1, j]))
        on = np.nonzero(~changes.any(axis=0))[0]
        middle = 1 + np.argmin(np.abs(fs[1:4, on]), axis=0)
        which, xs, fs = which[on], [xs[middle + j, on] for j in (-1, 0, 1)], [fs[middle + j, on] for j in (-1, 0, 1)]
    return [np.concatenate(parts) for parts in zip(*found)]


def _may_touch(xs, fs):
    """Return whether the parabola through three samples of one sign comes down to half the middle one."""
    left, right = xs[1] - xs[0], xs[2] - xs[1]
    slope_left, slope_right = (fs[1] - fs[0]) / left, (fs[2] - fs[1]) / right
    curvature = (slope_right - slope_left) / (left + right)
    slope = (slope_left * right + slope_right * left) / (left + right)
    return slope * slope > 2.0 * abs(fs[1] * curvature)


def find_brackets(function, x, f, is_closed, scale=1.0):
    """
    Return brackets (i, row, xa, xb, fa, fb) of all roots of sampled functions, hidden pairs included.

    Parameters
    ----------
    function : callable
        (x, row) -> f of the rows given.
    x : callable
        (i, row) -> where sample i of the row is [rad].
    f : ndarray, shape (n, m)
        At steps that are equal in some smooth variable.
    is_closed : bool
        After the last sample comes the first; ``i`` counts this interval as the last.
    scale : ndarray, shape (n, m) or (n, 1)
        Positive; f times scale is smooth.

    """
    i, row, is_plain = intervals_with_roots(f * scale, is_closed)
    j = (i + 1) % len(f)
    xa = x(i, row)
    xb = turn_after(x(j, row), xa)
    plain = [v[is_plain] for v in (i, row, xa, xb, f[i, row], f[j, row])]
    if is_plain.all():
        return plain
    i, row, xa, xb = (v[~is_plain] for v in (i, row, xa, xb))
    which, *closer = look_closer(function, row, xa, xb)
    return [np.concatenate(pair) for pair in zip(plain, (i[which], row[which], *closer))]


def bracketed_roots(function, row, xa, xb, fa, fb):
    """
    Return the root of ``function(x, row)`` in each bracket, to the last bits of x.

    Chandrupatla, Adv. Eng. Software 28 (1997) 145-149: inverse quadratic steps where they are safe,
    bisection elsewhere, after a linear one; all brackets advance together.
    """
    root = np.where(np.abs(fa) < np.abs(fb), xa, xb)
    todo = np.arange(root.size)
    xc, fc = xa, fa
    t = np.clip(fa / (fa - fb), 0.05, 0.95)
    while todo.size:
        x = xa + t * (xb - xa)
        f = function(x, row)
        same = (f >= 0.0) == (fa >= 0.0)
        xc, fc = np.where(same, xa, xb), np.where(same, fa, fb)
        xb, fb = np.where(same, xb, xa), np.where(same, fb, fa)
        xa, fa = x, f
        better = np.abs(fa) < np.abs(fb)
        best, best_f = np.where(better, xa, xb), np.where(better, fa, fb)
        root[todo] = best
        width = np.abs(xb - xa)
        tolerance = EPS * np.maximum(np.abs(best), SMALL)
        going = (width > 2.0 * tolerance) & (best_f != 0.0)
        if not going.all():
            row, todo = row[going], todo[going]
            xa, xb, xc, fa, fb, fc, width, tolerance = (
                v[going] for v in (xa, xb, xc, fa, fb, fc, width, tolerance))
        with np.errstate(divide='ignore', invalid='ignore'):
            xi, phi = (xa - xb) / (xc - xb), (fa - fb) / (fc - fb)
            safe = (phi * phi < xi) & ((1.0 - phi)**2 < 1.0 - xi)
            t = np.where(safe, fa / (fb - fa) * fc / (fb - fc)
                         + (xc - xa) / (xb - xa) * fa / (fc - fa) * fb / (fc - fb), 0.5)
            least = tolerance / width
        t = np.clip(t, least, 1.0 - least)
    return root


def solve_one(function, xa, xb, fa, fb):
    """Return the root in one bracket, as :func:`bracketed_roots`, in plain floats."""
    t = min(max(fa / (fa - fb), 0.05), 0.95)
    while True:
        x = xa + t * (xb - xa)
        f = function(x)
        if (f >= 0.0) is (fa >= 0.0):
            xc, fc = xa, fa
        else:
            xc, fc, xb, fb = xb, fb, xa, fa
        xa, fa = x, f
        best, best_f = (xa, fa) if abs(fa) < abs(fb) else (xb, fb)
        width, tolerance = abs(xb - xa), EPS * max(abs(best), SMALL)
        if best_f == 0.0 or width <= 2.0 * tolerance:
            return best
        t = 0.5
        xi, phi = (xa - xb) / (xc - xb), (fa - fb) / (fc - fb)
        if phi * phi < xi and (1.0 - phi)**2 < 1.0 - xi:
            t = fa / (fb - fa) * fc / (fb - fc) + (xc - xa) / (xb - xa) * fa / (fc - fa) * fb / (fc - fb)
        least = tolerance / width
        t = min(max(t, least), 1.0 - least)
