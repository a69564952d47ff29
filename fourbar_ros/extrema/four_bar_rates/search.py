# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Extrema of the output's rate and acceleration at constant input rate: one linkage in plain floats.

With x = theta1, y = theta4, b = beta and u the elliptic parameter of
:mod:`fourbar_ros.extrema.four_bar_rates.input_paths`, the derivatives

    X = dx/du = a2 a3 sin(y-b),    Y = dy/du = a1 a2 sin(x-b),    B = db/du = a1 a3 sin(x-y)

are sines, and by the loop so are their differences, X - B = a3 a4 sin(y), Y - B = a1 a4 sin(x).
Then dy/dx = Y/X, d2y/dx2 = g/X^3, d3y/dx3 = k/X^5 with g = Y_u X - Y X_u and k = g_u X - 3 g X_u,
smooth everywhere, toggles included. The roots of g are the extrema of theta4', those of k the
extrema of theta4''. Two roots of g have one of k between them, so that only k can hide pairs of
roots between samples, and is looked at closely.
"""
from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import cache
from math import atan2, cos, inf, nan, sin
from typing import Any, NamedTuple

from fourbar_ros.extrema.four_bar_rates.input_paths import half_turn, phases, POINTS_PER_FEATURE
from fourbar_ros.extrema.four_bar_rates.sensitivity import rate_changes
from fourbar_ros.mechanisms.four_bar.four_bar import FourBar
from fourbar_ros.mechanisms.half_angle import bilinear_factors, Factors, half_angle_coefficients
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.numerics.exact_sums import scaled
from fourbar_ros.numerics.newton import newton_root
from fourbar_ros.numerics.number_types import Function, NumberType, REAL
from fourbar_ros.numerics.roots import (
    first_guess,
    fold,
    intervals_of_one,
    look_closer,
    turn_after,
)
import numpy as np

# At least so many for a full turn. Half as many have missed nothing in 280 000 linkages.
SAMPLES = 24
Sines = Callable[..., tuple[Any, ...]]
State = tuple[Any, ...]     # what the function of make_sines returns
# A root may be moved by at most this [rad] to that of the more accurate formula.
POLISH = 2.0**-12


def make_sines(n: NumberType, constants: Sequence[Any], by_loop: bool = False) -> Sines:
    """
    Return the function (ss, cc, sc) -> g, g_u, k, k_u, X, Y.

    At the squares and the product of s, c = sin, cos(theta1/2).

    ``constants`` are those of :func:`sine_constants`; the pose is found as in
    :func:`~fourbar_ros.mechanisms.four_bar.motion.make_motion`. u is in units of 1/(a2 a3): X =
    sin(y-b). A fourth argument tells whether sc has the sign of X, where that is known beforehand.
    ``by_loop``: Y and the cosine that belongs to it follow from the others by the loop. This is
    faster, but loses digits where lengths are unequal.
    """
    sqrt, fabs, where = n.sqrt, n.fabs, n.where
    s1, s2, k, yA, yB, yC, yD, yM, bA, bB, bC, bD, bM, r13, r42, half, sign = constants
    # as in the motion of a four-bar, (M1) and (M2): what adds for one angle adds for both
    adding, other = (yB, yD, bB, bD, 1.0), (yA, yC, bA, bC, -1.0)
    half_k, half_cX = half * k, 0.5 * half
    half_cx = half_cX * k
    if by_loop:     # (a3^2 + a4^2 - a1^2 - a2^2) / (2 a2 a3)
        excess = 0.25 * half * (yM * (1.0 / r13 - r13) + bM * (1.0 / r42 - r42))

    def sines(ss: Any, cc: Any, sc: Any, adds: Any = None) -> tuple[Any, ...]:
        u, w = s1 + k * cc, s2 + k * ss
        root = sign * sqrt(fabs(u * w))       # at a toggle u or w may round to less than zero
        y_s, y_c, b_s, b_c, side = where(sc * root > 0.0 if adds is None else adds, adding, other)
        signed = side * root
        p, q = y_s * ss + y_c * cc, yM * sc + signed
        scale = side * r42 / (p * p + q * q)
        cy, XB = (q - p) * (q + p) * scale, 2.0 * side * p * q * scale     # a3 a4 cos(y), X - B
        cX, X = half_cX * (u - w), half * root                         # a2 a3 cos(y-b)
        cx, YB = half_cx * (cc - ss), half_k * sc                      # a1 a4 cos(x), Y - B
        if by_loop:
            cY, Y = cy + excess, YB + (X - XB)                         # a1 a2 cos(x-b)
        else:
            p, q = b_s * ss + b_c * cc, bM * sc - signed
            scale = side * r13 / (p * p + q * q)
            cY, Y = (q - p) * (q + p) * scale, -2.0 * side * p * q * scale
        Xu = cX * YB
        Yu = cY * XB
        P, Q = cY * cy - XB * XB, cX * cx - YB * YB                    # Y_uu/Y, X_uu/X
        XY, PQ = X * Y, P - Q
        g, gu = Yu * X - Y * Xu, XY * PQ
        guu = (Xu * Y + X * Yu) * PQ + XY * (X * YB * (3.0 * cx + cX) - Y * XB * (3.0 * cy + cY))
        return g, gu, gu * X - 3.0 * g * Xu, guu * X - 2.0 * gu * Xu - 3.0 * g * X * Q, X, Y
    return sines


def sine_constants(lengths: Sequence[Any], factors: Factors, sign: Any) -> tuple[Any, ...]:
    """
    Return the constants of :func:`make_sines`; the largest length should be about one.

    ``factors`` are the :func:`.bilinear_factors` of the lengths. Their products are s1, s2 of
    :mod:`.input_paths` and the :func:`.half_angle_coefficients`.
    """
    (a1, a2, a3, a4), f = lengths, factors
    of_y, of_bx = half_angle_coefficients(f)
    return (-f.A1 * f.B2, f.C1 * f.D1, 4.0 * a1 * a4,
            *of_y, 4.0 * a1 * a3, *of_bx, -4.0 * a2 * a4,
            a1 / a3, a4 / a2, 0.5 / (a2 * a3), sign)


class RateExtremum(NamedTuple):
    """
    An extremum of theta4' or theta4'': theta1 [rad] and value.

    Conditions as in :mod:`fourbar_ros.extrema.sensitivity`.
    """

    theta1: float
    value: float
    is_maximum: bool
    condition: float
    value_condition: float


class Node(NamedTuple):
    """
    Where g or k is known.

    theta1 [rad], its value, the step of Newton's method (NaN: not known).
    """

    theta1: float
    value: float
    step: float


def rate_extrema(linkage: FourBar, samples: int = SAMPLES, with_conditions: bool = True
                 ) -> tuple[tuple[list[RateExtremum], list[RateExtremum]],
                            list[tuple[float, int, bool, bool]]]:
    """
    Return the extrema of theta4' and of theta4'' at constant input rate.

    And the signs at the toggles.

    For one linkage in its mode; not at change points.

    Returns
    -------
    extrema : tuple of 2 lists of RateExtremum
        Those of theta4' and of theta4''. The conditions are NaN if not wanted.
    toggles : list of (float, int, bool, bool)
        theta1 [rad]; +1 where a range begins and -1 where it ends; whether theta4' and whether
        theta4'' go to plus infinity.

    """
    a1, a2, a3, a4 = lengths = scaled(linkage.lengths)
    constants = sine_constants(lengths, bilinear_factors(a1, a2, a3, a4), linkage.sign)
    sines = make_sines(REAL, constants)
    upward = linkage.sign > 0.0       # X > 0: signs of g and k are those of theta4'' and theta4'''
    motion = linkage.motion_formula(REAL, linkage.constants)
    extrema: tuple[list[RateExtremum], list[RateExtremum]] = [], []
    toggles: list[tuple[float, int, bool, bool]] = []
    for x, step, is_closed in _paths(constants, linkage.input_ranges[-1], samples // 2):
        states = [_at(sines, v) for v in x]
        if not is_closed:
            for i, side in ((0, 1), (-1, -1)):
                g, Y = states[i][0], states[i][-1]
                toggles.append((x[i], side, (Y > 0.0) is upward, (g > 0.0) is upward))
        inside: list[list[Node]] = [[] for _ in x]       # nodes of g at the roots of k after x
        for i, falls, theta1, state in _roots_of_k(sines, x, states, step / 3.0, is_closed):
            extrema[1].append(_extremum(linkage, motion, 1, theta1, falls is upward, state,
                                        with_conditions))
            inside[i].append(_node(theta1, 0, state))
        for falls, theta1, state in _roots_of_g(sines, x, states, inside, is_closed):
            extrema[0].append(_extremum(linkage, motion, 0, theta1, falls is upward, state,
                                        with_conditions))
    return extrema, toggles


def _at(sines: Sines, x: float) -> State:
    s, c = sin(0.5 * x), cos(0.5 * x)
    return sines(s * s, c * c, s * c)


def _node(x: float, which: int, state: State) -> Node:
    """Return the :class:`Node` of g (which = 0) or k (2)."""
    value, slope, X = state[which], state[which + 1], state[4]
    return Node(x, value, value * X / slope if slope else inf)


def _root(sines: Sines, which: int, a: Node, b: Node) -> tuple[float, State]:
    """Return the root of g or k between nodes of different sign, and the sines there."""
    def at(x: float) -> tuple[float, float, State]:
        state = _at(sines, x)
        value, slope = state[which], state[which + 1]
        return value, value * state[4] / slope if slope else inf, state

    guess = first_guess(a.theta1, b.theta1, a.value, b.value, a.step, b.step)
    return newton_root(at, a.theta1, b.theta1, a.value, guess)


def _roots_of_k(sines: Sines, x: list[float], states: list[State], third: float, is_closed: bool
                ) -> Iterator[tuple[int, bool, float, State]]:
    """
    Yield (interval, whether k falls, theta1, sines) of the roots of k.

    ``third``: of a step of u.
    """
    def k_at(x: Array, _: Array) -> Array:
        return np.array([_at(sines, v)[2] for v in x.tolist()])

    k, rise = [state[2] for state in states], [third * state[3] for state in states]
    for i, is_plain in intervals_of_one(k, rise, is_closed):
        j = (i + 1) % len(x)
        xa, xb = x[i], turn_after(x[j], x[i])
        if is_plain:
            pairs = [(_node(xa, 2, states[i]), _node(xb, 2, states[j]))]
        else:
            _, *parts = look_closer(k_at, np.zeros(1, int), np.array([xa]), np.array([xb]))
            pairs = [(Node(xa, fa, nan), Node(xb, fb, nan))
                     for xa, xb, fa, fb in zip(*(v.tolist() for v in parts))]
        for a, b in pairs:
            yield i, a.value >= 0.0, *_root(sines, 2, a, b)


def _roots_of_g(sines: Sines, x: list[float], states: list[State], inside: list[list[Node]],
                is_closed: bool) -> Iterator[tuple[bool, float, State]]:
    """Yield (whether g falls, theta1, sines) of the roots of g: between samples and roots of k."""
    positive = [state[0] >= 0.0 for state in states]
    for i, j in enumerate([*range(1, len(x)), *[0] * is_closed]):
        if not inside[i] and positive[i] is positive[j]:
            continue
        chain = [_node(x[i], 0, states[i]), *sorted(inside[i]),
                 _node(turn_after(x[j], x[i]), 0, states[j])]
        for a, b in zip(chain, chain[1:]):
            if (a.value >= 0.0) is not (b.value >= 0.0):
                yield a.value >= 0.0, *_root(sines, 0, a, b)


def _extremum(linkage: FourBar, motion: Function, order: int, x: float, is_maximum: bool,
              state: State, with_conditions: bool) -> RateExtremum:
    """Return the :class:`RateExtremum` at a root of g (order 0) or k (1)."""
    g, gu, k, ku, X, Y = state
    fields = motion(x, 1.0, 0.0)
    curvature = ku / X**6 if order else k / X**5      # the first derivative that is not zero there
    if order == 0:
        # theta4'' of motion() is more accurate than g where lengths are very unequal
        correction = fields[11] / curvature if curvature else inf
        if abs(correction) < POLISH:
            x = x - correction
            fields = motion(x, 1.0, 0.0)
    theta1, value = fold(x), fields[10 + order]
    if not with_conditions:
        return RateExtremum(theta1, value, is_maximum, nan, nan)
    changes = rate_changes(linkage.lengths, fields, 0.0 if order else curvature)
    place, size = changes[order + 1], changes[order]
    return RateExtremum(theta1, value, is_maximum, place / abs(curvature) if curvature else inf,
                        size / abs(value) if value else inf)


def _paths(constants: Sequence[float], last_range: tuple[float, float],
           count: int) -> list[tuple[list[float], float, bool]]:
    """Return theta1 of each path's samples with toggles, their step in u, if it is closed."""
    s1, s2, k, *_, half, sign = constants
    at = half_turn(s1, s2, k, s1 > 0.0, s2 > 0.0)
    count = int(max(count, POINTS_PER_FEATURE * at.period))
    pairs, step = _phases(count, s2 < 0.0, s1 < 0.0)
    x = [2.0 * atan2(*at(*pair)) for pair in pairs]
    step = sign * step * at.period * at.unit * 0.5 / half
    if s2 < 0.0:
        x[0] = last_range[0]
    if s1 < 0.0:
        x[-1] = last_range[1]
    mirrored = [-v for v in reversed(x)]
    if s2 > 0.0:
        return [(mirrored + x, step, s1 > 0.0)]
    return ([(x + mirrored, step, False)] if s1 > 0.0
            else [(mirrored, step, False), (x, step, False)])


@cache
def _phases(count: int, low_is_toggle: bool,
            high_is_toggle: bool) -> tuple[list[tuple[float, float]], float]:
    """Return the pairs of :func:`.input_paths.phases` as floats, and the step."""
    of_u, cosines, step = phases(count, low_is_toggle, high_is_toggle)
    return list(zip(of_u.tolist(), cosines.tolist())), step
