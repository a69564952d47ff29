"""
Extremes of the output's rate and acceleration at constant input rate: one linkage in plain floats.

With x = theta1, y = theta4, b = beta and u the elliptic parameter of :mod:`.elliptic`, the derivatives

    X = dx/du = a2 a3 sin(y-b),    Y = dy/du = a1 a2 sin(x-b),    B = db/du = a1 a3 sin(x-y)

are sines, and so dy/dx = Y/X, d2y/dx2 = g/X^3, d3y/dx3 = k/X^5 with g = Y_u X - Y X_u and k = g_u X -
3 g X_u, smooth everywhere, toggles included. The roots of g are the extremes of theta4', those of k the
extremes of theta4''. Two roots of g have one of k between them, so that only k can hide pairs of roots
between samples.
"""
from __future__ import annotations

from functools import cache
from math import atan2, cos, fabs, frexp, inf, ldexp, pi, sin, sqrt

import numpy as np

from .dialects import dialects, where
from .elliptic import half_turn, POINTS_PER_FEATURE
from .factors import difference_of_squares, half_angle_coefficients
from .roots import dips, may_touch, solve_one, turn_after
from .sensitivity import perturbed_lengths

SAMPLES = 48
# Step in theta1 [rad] of differences of theta4''': small beside the narrowest feature at a change point
# one rounding away (1e-8), large beside rounding.
TURN = 2.0**-40


@dialects
def sines(sh, ch, constants):
    """
    Return g, k, X, Y at sh, ch = sin, cos(theta1/2).

    ``constants`` are those of :func:`sine_constants`; the pose is found as in
    :func:`.kinematics.make_motion`.
    """
    s1, s2, k, yA, yB, yC, yD, yM, bA, bB, bC, bD, bM, a12, a13, sign = constants
    ss, cc, sc = sh * sh, ch * ch, sh * ch
    u, w = s1 + k * cc, s2 + k * ss
    root = sign * sqrt(fabs(u * w))       # at a toggle u or w may round to less than zero
    m = yM * sc
    n, d = where(m * root > 0.0, (yB * ss + yD * cc, m + root), (m - root, yA * ss + yC * cc))
    scale = a13 / (n * n + d * d)
    cB, B = (d - n) * (d + n) * scale, -2.0 * n * d * scale
    m = bM * sc
    n, d = where(m * root < 0.0, (bB * ss + bD * cc, m - root), (m + root, bA * ss + bC * cc))
    scale = a12 / (n * n + d * d)
    cY, Y = (d - n) * (d + n) * scale, -2.0 * n * d * scale
    cX, X = 0.25 * (u - w), 0.5 * root
    YB, XB = Y - B, X - B
    Xu, Yu, Bu = cX * YB, cY * XB, cB * (X - Y)
    g = Yu * X - Y * Xu
    Xuu, Yuu = cX * (Yu - Bu) - X * YB * YB, cY * (Xu - Bu) - Y * XB * XB
    return g, (Yuu * X - Y * Xuu) * X - 3.0 * g * Xu, X, Y


def sine_constants(a1, a2, a3, a4, sign):
    """Return the constants of :func:`sines`; the largest length should be about one."""
    yA, yB, yC, yD, yM = half_angle_coefficients(-a4, a2, a3, -a1)
    bA, bB, bC, bD, bM = half_angle_coefficients(-a4, a3, -a2, -a1)
    return (difference_of_squares(a2, a3, a1, a4), difference_of_squares(a1, -a4, a2, -a3),
            4.0 * a1 * a4, yA, yB, yC, yD, -yM, bA, bB, bC, bD, -bM, a1 * a2, a1 * a3, sign)


def rate_extrema(linkage, samples=SAMPLES):
    """
    Return the roots of theta4'' and of theta4''' at constant input rate, and the signs at the toggles.

    For one linkage in its mode; not at change points.

    Returns
    -------
    roots : tuple of 2 lists of (float, bool, float, float)
        For theta4' and for theta4'': theta1 [rad], whether it is a maximum, and the condition numbers
        of place and value as in :mod:`.sensitivity`.
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
        nodes = [(v, *sines.scalar(sin(0.5 * v), cos(0.5 * v), constants)) for v in x]
        if is_closed:
            nodes = [nodes[-1], *nodes, nodes[0]]
        else:
            for (v, g, _, _, Y), side in ((nodes[0], 1), (nodes[-1], -1)):
                toggles.append((v, side, (Y > 0.0) is upward, (g > 0.0) is upward))

        # Roots of k by the interval they lie in; then those of g between these and the samples.
        inside = [[] for _ in range(len(nodes) - 1 - is_closed)]
        for i, bracket in _brackets(k_at, [(v, k) for v, _, k, _, _ in nodes], is_closed):
            root = solve_one(k_at, *bracket)
            inside[i % len(inside)].append(root)
            roots[1].append((root, (bracket[2] >= 0.0) is upward))
        for one, between, other in zip(nodes, inside, nodes[1:]):
            chain = [one[:2], *((root, g_at(root)) for root in sorted(between)), other[:2]]
            for (xa, fa), (xb, fb) in zip(chain, chain[1:]):
                if (fa >= 0.0) is not (fb >= 0.0):
                    roots[0].append((solve_one(g_at, xa, turn_after(xb, xa), fa, fb), (fa >= 0.0) is upward))
    return _with_conditions(linkage, constants, roots), toggles


def _scaled_constants(lengths, sign):
    exponent = frexp(max(lengths))[1]
    return sine_constants(*(ldexp(length, -exponent) for length in lengths), sign)


def _with_conditions(linkage, constants, roots):
    """Return the roots with their condition numbers: derivatives by differences in lengths and theta1."""
    def derivatives(x, constants):
        g, k, X, Y = sines.scalar(sin(0.5 * x), cos(0.5 * x), constants)
        square = X * X
        return Y / X, g / (square * X), k / (square * square * X)

    step, others = perturbed_lengths(linkage)
    others = [_scaled_constants(lengths, linkage.sign) for lengths in others]
    extended = [], []
    for order in (0, 1):
        for x, is_maximum in roots[order]:
            here = derivatives(x, constants)
            turned = derivatives(x + TURN, constants)
            shifts = [derivatives(x, other) for other in others]
            value, slope = (sum(abs(shift[i] - here[i]) for shift in shifts) / step for i in (order, order + 1))
            curvature = (turned[order + 1] - here[order + 1]) / (x + TURN - x)
            extended[order].append((x, is_maximum, slope / abs(curvature) if curvature else inf,
                                    value / abs(here[order]) if here[order] else inf))
    return extended


def _paths(constants, last_range, count):
    """Return the samples of each path, in order, and whether it is closed."""
    s1, s2, k = constants[:3]
    period, half = half_turn(s1, s2, k, s1 > 0.0, s2 > 0.0)
    count = int(max(count, POINTS_PER_FEATURE * period))
    low = [last_range[0]] if s2 < 0.0 else []
    high = [last_range[1]] if s1 < 0.0 else []
    x = low + [2.0 * atan2(*half(sine, cosine)) for sine, cosine in _phases(count)] + high
    mirrored = [-v for v in reversed(x)]
    if low and high:
        return [(mirrored, False), (x, False)]
    return [(x + mirrored, False)] if low else [(mirrored + x, not high)]


@cache
def _phases(count):
    """Return sine and cosine of the middles of equal parts of a right angle."""
    return [(sin(phase), cos(phase)) for phase in ((j + 0.5) / count * 0.5 * pi for j in range(count))]


def _brackets(function, nodes, is_closed):
    """Yield (index of the interval, bracket) for all sign changes, hidden pairs included."""
    for i in range(1, len(nodes)):
        (xa, fa), (xb, fb) = nodes[i - 1:i + 1]
        unwound = turn_after(xb, xa)
        if (fa >= 0.0) is not (fb >= 0.0):
            if i < len(nodes) - is_closed:
                yield i - 1, (xa, unwound, fa, fb)
        elif i + 1 < len(nodes) and abs(fb) <= abs(fa):
            xc, fc = nodes[i + 1]
            xc = turn_after(xc, xa)
            if abs(fb) < abs(fc) and (fb >= 0.0) is (fc >= 0.0) and may_touch((xa, unwound, xc), (fa, fb, fc)):
                for left, right, *fs in _hidden(function, (xa, unwound, xc), (fa, fb, fc)):
                    if right <= unwound:
                        yield i - 1, (left, right, *fs)
                    else:
                        yield i, (left + (xb - unwound), right + (xb - unwound), *fs)


def _hidden(function, xs, fs):
    """Return the brackets of a dip."""
    found = dips(lambda x, _: np.array([function(v) for v in x.tolist()]), np.array(xs), np.array((fs,)))
    return zip(*(part.tolist() for part in found[1:]))
