"""
Extremes of the output's rate and acceleration at constant input rate: one linkage in plain floats.

With x = theta1, y = theta4, b = beta and u the elliptic parameter of :mod:`.elliptic`, the derivatives

    X = dx/du = a2 a3 sin(y-b),    Y = dy/du = a1 a2 sin(x-b),    B = db/du = a1 a3 sin(x-y)

are sines, and by the loop so are their differences, X - B = a3 a4 sin(y), Y - B = a1 a4 sin(x). Then dy/dx =
Y/X, d2y/dx2 = g/X^3, d3y/dx3 = k/X^5 with g = Y_u X - Y X_u and k = g_u X - 3 g X_u, smooth
everywhere, toggles included. The roots of g are the extremes of theta4', those of k the extremes of
theta4''. Two roots of g have one of k between them, so that only k can hide pairs of roots between
samples, and is looked at closely.
"""
from __future__ import annotations

from functools import cache
from math import atan2, cos, fabs, frexp, inf, ldexp, nan, sin, sqrt

import numpy as np

from .dialects import dialects, where
from .elliptic import POINTS_PER_FEATURE, half_turn, phases
from .factors import difference_of_squares, half_angle_coefficients
from .roots import find_brackets, solve_one, turn_after
from .sensitivity import TURN, perturbed_lengths

# Of a full turn, at least. Half as many have missed nothing in 280 000 linkages of all kinds.
SAMPLES = 24


@dialects
def sines(sh, ch, constants):
    """
    Return g, k, X, Y at sh, ch = sin, cos(theta1/2).

    ``constants`` are those of :func:`sine_constants`; the pose is found as in
    :func:`.kinematics.make_motion`. u is in units of 1/(a2 a3): X = sin(y-b).
    """
    s1, s2, k, yA, yB, yC, yD, yM, bA, bB, bC, bD, bM, r13, r42, half, sign = constants
    ss, cc, sc = sh * sh, ch * ch, sh * ch
    u, w = s1 + k * cc, s2 + k * ss
    root = sign * sqrt(fabs(u * w))       # at a toggle u or w may round to less than zero
    m = yM * sc
    n, d = where(m * root > 0.0, (yB * ss + yD * cc, m + root), (m - root, yA * ss + yC * cc))
    scale = r42 / (n * n + d * d)
    cy, XB = (d - n) * (d + n) * scale, 2.0 * n * d * scale        # a3 a4 cos(y), X - B
    m = bM * sc
    n, d = where(m * root < 0.0, (bB * ss + bD * cc, m - root), (m + root, bA * ss + bC * cc))
    scale = r13 / (n * n + d * d)
    cY, Y = (d - n) * (d + n) * scale, -2.0 * n * d * scale        # a1 a2 cos(x-b)
    cX, X = 0.5 * half * (u - w), half * root                      # a2 a3 cos(y-b)
    cx, YB = 0.5 * half * k * (cc - ss), half * k * sc             # a1 a4 cos(x), Y - B
    Xu = cX * YB
    g = cY * XB * X - Y * Xu
    gu = X * Y * (cY * cy - XB * XB - (cX * cx - YB * YB))
    return g, gu * X - 3.0 * g * Xu, X, Y


def sine_constants(a1, a2, a3, a4, sign):
    """Return the constants of :func:`sines`; the largest length should be about one."""
    yA, yB, yC, yD, yM = half_angle_coefficients(a1, a2, a3, a4)
    bA, bB, bC, bD, bM = half_angle_coefficients(-a4, a3, -a2, -a1)       # of b - x
    return (difference_of_squares(a2, a3, a1, a4), difference_of_squares(a1, -a4, a2, -a3),
            4.0 * a1 * a4, yA, yB, yC, yD, yM, bA, bB, bC, bD, -bM, a1 / a3, a4 / a2, 0.5 / (a2 * a3), sign)


def rate_extrema(linkage, samples=SAMPLES, with_conditions=True):
    """
    Return the roots of theta4'' and of theta4''' at constant input rate, and the signs at the toggles.

    For one linkage in its mode; not at change points.

    Returns
    -------
    roots : tuple of 2 lists of (float, bool, float, float)
        For theta4' and for theta4'': theta1 [rad], whether it is a maximum, and the condition numbers
        of place and value as in :mod:`.sensitivity` (NaN if not wanted).
    toggles : list of (float, int, bool, bool)
        theta1 [rad]; +1 where a range begins and -1 where it ends; whether theta4' and whether theta4''
        go to plus infinity.

    """
    constants = _scaled_constants(linkage.lengths, linkage.sign)
    upward = linkage.sign > 0.0       # X > 0: signs of g and k are those of theta4'' and theta4'''

    def g_at(x):
        return sines.scalar(sin(0.5 * x), cos(0.5 * x), constants)[0]

    def k_at(x):
        return sines.scalar(sin(0.5 * x), cos(0.5 * x), constants)[1]

    roots, toggles = ([], []), []
    for x, is_closed in _paths(constants, linkage.input_ranges[-1], samples // 2):
        nodes = [sines.scalar(sin(0.5 * v), cos(0.5 * v), constants) for v in x]
        if not is_closed:
            for i, side in ((0, 1), (-1, -1)):
                g, _, _, Y = nodes[i]
                toggles.append((x[i], side, (Y > 0.0) is upward, (g > 0.0) is upward))

        # Roots of k by the interval they lie in; then those of g between these and the samples.
        inside = [[] for _ in x]
        places = np.array(x)
        brackets = find_brackets(lambda v, _: np.array([k_at(w) for w in v.tolist()]), lambda i, _: places[i],
                                 np.array([k for _, k, _, _ in nodes])[:, None], is_closed)
        for i, _, xa, xb, fa, fb in zip(*(part.tolist() for part in brackets)):
            root = solve_one(k_at, xa, xb, fa, fb)
            inside[i].append(root)
            roots[1].append((root, (fa >= 0.0) is upward, xb - xa))
        ends = [(v, g) for v, (g, *_) in zip(x, nodes)]
        for one, between, other in zip(ends, inside, ends[1:] + ends[:is_closed]):
            if not between and (one[1] >= 0.0) is (other[1] >= 0.0):
                continue
            chain = [one, *((root, g_at(root)) for root in sorted(between)), other]
            for (xa, fa), (xb, fb) in zip(chain, chain[1:]):
                if (fa >= 0.0) is not (fb >= 0.0):
                    xb = turn_after(xb, xa)
                    roots[0].append((solve_one(g_at, xa, xb, fa, fb), (fa >= 0.0) is upward, xb - xa))
    roots = [(_polished(linkage, constants, *root), *root[1:]) for root in roots[0]], roots[1]
    if with_conditions:
        return _with_conditions(linkage, constants, roots), toggles
    return [[(x, is_maximum, nan, nan) for x, is_maximum, _ in part] for part in roots], toggles


def _scaled_constants(lengths, sign):
    exponent = frexp(max(lengths))[1]
    return sine_constants(*(ldexp(length, -exponent) for length in lengths), sign)


def _derivatives(x, constants):
    """Return theta4', theta4'' and theta4''' with respect to theta1."""
    g, k, X, Y = sines.scalar(sin(0.5 * x), cos(0.5 * x), constants)
    square = X * X
    return Y / X, g / (square * X), k / (square * square * X)


def _polished(linkage, constants, x, _, spacing):
    """Return the root of g with theta4'' of motion(), more accurate where lengths are very unequal."""
    curvature = _derivatives(x, constants)[2]
    correction = linkage._motion[0](x, 1.0, 0.0)[11] / curvature if curvature else inf
    return x - correction if abs(correction) < TURN * spacing else x


def _with_conditions(linkage, constants, roots):
    """Return the roots with their condition numbers: derivatives by differences in lengths and theta1."""
    changed = [(step, _scaled_constants(lengths, linkage.sign)) for step, lengths in perturbed_lengths(linkage)[:3]]
    extended = [], []
    for order in (0, 1):
        for x, is_maximum, spacing in roots[order]:
            here = _derivatives(x, constants)
            value = slope = value4 = slope4 = 0.0
            for step, others in changed:
                there = _derivatives(x, others)
                by_value, by_slope = (there[order] - here[order]) / step, (there[order + 1] - here[order + 1]) / step
                value, slope = value + abs(by_value), slope + abs(by_slope)
                value4, slope4 = value4 - by_value, slope4 - by_slope     # all four together change nothing
            turn = TURN * spacing
            curvature = (_derivatives(x + turn, constants)[2] - here[2]) / turn if order else here[2]
            extended[order].append((x, is_maximum, (slope + abs(slope4)) / abs(curvature) if curvature else inf,
                                    (value + abs(value4)) / abs(here[order]) if here[order] else inf))
    return extended


def _paths(constants, last_range, count):
    """Return the samples of each path, toggles included, and whether it is closed."""
    s1, s2, k = constants[:3]
    period, half = half_turn(s1, s2, k, s1 > 0.0, s2 > 0.0)
    count = int(max(count, POINTS_PER_FEATURE * period))
    x = [2.0 * atan2(*half(*pair)) for pair in _phases(count, s2 < 0.0, s1 < 0.0)]
    if s2 < 0.0:
        x[0] = last_range[0]
    if s1 < 0.0:
        x[-1] = last_range[1]
    mirrored = [-v for v in reversed(x)]
    if s2 > 0.0:
        return [(mirrored + x, s1 > 0.0)]
    return [(x + mirrored, False)] if s1 > 0.0 else [(mirrored, False), (x, False)]


@cache
def _phases(*arguments):
    """Return the pairs of :func:`.elliptic.phases` as floats."""
    return list(zip(*(part.tolist() for part in phases(*arguments))))
