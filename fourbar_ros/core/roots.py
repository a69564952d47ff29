"""
All sign changes of sampled functions: one function in plain floats, or many brackets at once.

Zero counts as positive. Angles are given in order; a smaller one after a larger one is a turn later.
"""
from __future__ import annotations

from math import pi

import numpy as np

EPS = 2.0**-52
# Below this angle [rad] roots are found to an absolute tolerance: 0 has no last bit.
SMALL = 2.0**-40
# Halvings of a dip before it is taken for a touching point without a sign change.
HALVINGS = 26


def turn_after(x, start):
    """Return the angle x as the one that comes after ``start``, less than half a turn away."""
    return x + 2.0 * pi * (x < start - pi)


def brackets(x, f):
    """
    Return (row, xa, xb, fa, fb): where rows of f change sign between neighbours.

    Parameters
    ----------
    x : ndarray, shape (n,)
    f : ndarray, shape (m, n)

    """
    positive = f >= 0.0
    row, i = np.nonzero(positive[:, 1:] != positive[:, :-1])
    return row, x[i], turn_after(x[i + 1], x[i]), f[row, i], f[row, i + 1]


def dips(function, x, f):
    """
    Return brackets, as :func:`brackets`, of pairs of roots that hide between neighbouring samples.

    ``function(x, row)`` evaluates the rows given.
    """
    size = np.abs(f)
    same = (f[:, 1:] >= 0.0) == (f[:, :-1] >= 0.0)
    row, i = np.nonzero((size[:, 1:-1] <= size[:, :-2]) & (size[:, 1:-1] < size[:, 2:])
                        & same[:, 1:] & same[:, :-1])
    return halve_dips(function, row, [turn_after(x[i + j], x[i]) for j in range(3)],
                      [f[row, i + j] for j in range(3)])


def halve_dips(function, row, xs, fs):
    """
    Return brackets of pairs of roots near minima of |f|, each given by three samples of one sign.

    Where the parabola of the samples comes down to less than half of the middle one, the interval is
    halved around the smallest |f| until f changes sign or the parabola says that it does not.
    """
    found = [(row[:0], *(v[:0] for v in (*xs[:2], *fs[:2])))]
    for _ in range(HALVINGS):
        going = may_touch(xs, fs)
        row, xs, fs = row[going], [v[going] for v in xs], [v[going] for v in fs]
        if not row.size:
            break
        mids = 0.5 * (xs[0] + xs[1]), 0.5 * (xs[1] + xs[2])
        f_mids = np.split(function(np.concatenate(mids), np.concatenate((row, row))), 2)
        xs = np.stack((xs[0], mids[0], xs[1], mids[1], xs[2]))
        fs = np.stack((fs[0], f_mids[0], fs[1], f_mids[1], fs[2]))
        positive = fs >= 0.0
        change, column = np.nonzero(positive[1:] != positive[:-1])
        found.append((row[column], xs[change, column], xs[change + 1, column],
                      fs[change, column], fs[change + 1, column]))
        on = np.nonzero((positive == positive[0]).all(axis=0))[0]
        middle = 1 + np.argmin(np.abs(fs[1:4, on]), axis=0)
        row, xs, fs = row[on], [xs[middle + j, on] for j in (-1, 0, 1)], [fs[middle + j, on] for j in (-1, 0, 1)]
    return [np.concatenate(parts) for parts in zip(*found)]


def may_touch(xs, fs):
    """Return whether the parabola through three samples of one sign comes down to half the middle one."""
    left, right = xs[1] - xs[0], xs[2] - xs[1]
    slope_left, slope_right = (fs[1] - fs[0]) / left, (fs[2] - fs[1]) / right
    curvature = (slope_right - slope_left) / (left + right)
    slope = (slope_left * right + slope_right * left) / (left + right)
    return slope * slope > 2.0 * abs(fs[1] * curvature)


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
