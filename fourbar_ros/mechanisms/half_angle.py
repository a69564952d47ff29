# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The bilinear factors of the six input-output equations, exact to the last bit.

Every coefficient of Eqs. (16)-(21) of the slides is a product of two sums +-a1 +-a2 +-a3 +-a4.
Near a change point one of these sums cancels; computed with ``math.fsum`` it keeps all its digits,
and so do products with it.
"""
from __future__ import annotations

from math import fsum
from typing import NamedTuple

from fourbar_ros.numerics.number_types import Function, Scalar


class Factors(NamedTuple):
    """The eight sums by the slides' letters [m]; the paper gives these letters to other sums."""

    A1: Scalar
    A2: Scalar
    B1: Scalar
    B2: Scalar
    C1: Scalar
    C2: Scalar
    D1: Scalar
    D2: Scalar


def bilinear_factors(a1: Scalar, a2: Scalar, a3: Scalar, a4: Scalar,
                     exact_sum: Function = fsum) -> Factors:
    """Return the eight sums of four lengths [m], rounded once: at a change point one is 0.0."""
    return Factors(A1=exact_sum((a1, -a2, -a3, a4)), A2=exact_sum((a1, a2, -a3, a4)),
                   B1=exact_sum((a1, -a2, a3, a4)), B2=exact_sum((a1, a2, a3, a4)),
                   C1=exact_sum((a1, -a2, a3, -a4)), C2=exact_sum((a1, a2, a3, -a4)),
                   D1=exact_sum((a1, a2, -a3, -a4)), D2=exact_sum((a1, -a2, -a3, -a4)))


def half_angle_coefficients(f: Factors) -> tuple[tuple[Scalar, ...], tuple[Scalar, ...]]:
    """
    Return A, B, C, D [m^2] of the half-angle quadratics of y and of b - x in a loop of four rods.

    In |a4 - a1 e^{ix} + a3 e^{iy}| = a2 the half-angle t = tan(y/2) solves p t^2 - 2 m t + r = 0
    with p = A sh^2 + C ch^2, r = B sh^2 + D ch^2, m = 4 a1 a3 sh ch, where sh, ch = sin,
    cos(x/2): Eq. (16) of the slides, homogeneous in tan(x/2). Its discriminant is m^2 - p r =
    (2 a2 a3 sin mu)^2. Negative or exchanged lengths turn the same equation into those of the
    other pairs of angles, and their sums into the same but for signs: the lengths -a4, a3, -a2,
    -a1 give b - x, and -a4, a2, a3, -a1 give y - x, with A and B of y exchanged.
    """
    return ((f.A1 * f.A2, f.B1 * f.B2, f.C1 * f.C2, f.D1 * f.D2),
            (f.A1 * f.B1, f.A2 * f.B2, f.C1 * f.D2, f.C2 * f.D1))
