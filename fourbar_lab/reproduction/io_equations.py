# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The six input-output equations of the 4R linkage, each between two of its four joint angles.

Slides, Eqs. (16)-(37), as corrected (test_io_equations.py has every erratum): theta1 and theta4
absolute at the ground pivots, theta2 and theta3 relative, theta1 + theta2 + theta3 = theta4 + pi,
v = tan(theta/2).
Each equation is

    both vi^2 vj^2 + first vi^2 + second vj^2 + mixed vi vj + constant = 0

with products of two bilinear factors for coefficients. Functions of v are the textbook's;
functions of angles use the same polynomial homogeneous in sin and cos(theta/2), where v infinite
(theta = pi) is an ordinary point. With slides in place of pivots it is the same equation:
:mod:`fourbar_lab.reproduction.slide_equations`.

>>> import math
>>> equation = io_equation((8.0, 14.0, 9.0, 17.0), 1, 4)
>>> crossed, open_ = equation.solve(math.radians(60.0))
>>> rate = 10.0 * float(equation.ratio(math.radians(60.0), open_))
>>> round(math.degrees(open_), 4), round(rate, 4)
(84.5689, 7.1781)
"""
from __future__ import annotations

from collections.abc import Mapping, Sequence
import math
from typing import NamedTuple, overload

from fourbar_lab.reproduction.slide_equations import equation_of_slides, SlideEquation
from fourbar_ros.errors import InvalidParameter
from fourbar_ros.mechanisms.half_angle import bilinear_factors
from fourbar_ros.numerics.arrays import Array, Values
from fourbar_ros.numerics.given import array, number
import numpy as np
from numpy.typing import ArrayLike

# For each pair the factors of v_i^2 v_j^2, v_i^2, v_j^2, 1; the lengths in the coefficient of v_i
# v_j, and that coefficient over their product: Eqs. (17), (18), (16), (19), (20), (21) of the
# slides.
_TERMS = {
    (1, 2): (('A1', 'B1'), ('A2', 'B2'), ('C1', 'D2'), ('C2', 'D1'), (2, 4), 8.0),
    (1, 3): (('A2', 'B1'), ('A1', 'B2'), ('C1', 'D1'), ('C2', 'D2'), (), 0.0),
    (1, 4): (('A1', 'A2'), ('B1', 'B2'), ('C1', 'C2'), ('D1', 'D2'), (1, 3), -8.0),
    (2, 3): (('B1', 'C1'), ('A1', 'D2'), ('A2', 'D1'), ('B2', 'C2'), (1, 3), -8.0),
    (2, 4): (('A1', 'C1'), ('B1', 'D2'), ('A2', 'C2'), ('B2', 'D1'), (), 0.0),
    (3, 4): (('A2', 'C1'), ('B1', 'D1'), ('A1', 'C2'), ('B2', 'D2'), (2, 4), -8.0),
}
PAIRS = tuple(_TERMS)
# The joint across the loop: its angle changes sign from one solution to the other. For a positive
# one the root of the discriminant counts positive, but for these (i, j).
_OPPOSITE = {1: 3, 2: 4, 3: 1, 4: 2}
_NEGATIVE_ROOT = {(1, 2), (4, 1), (4, 2)}


class IOEquation(NamedTuple):
    """One equation between theta_i and theta_j; coefficients in [m^2]."""

    i: int
    j: int
    both: float
    first: float
    second: float
    mixed: float
    constant: float
    lengths: tuple[float, ...]

    # --- in v = tan(theta/2), as printed ---------------------------------------------------------

    def position(self, vi: Values, vj: Values) -> Values:
        """Return the left-hand side of Eqs. (16)-(21) [m^2]; zero for a pose."""
        return (self.both * vi**2 * vj**2 + self.first * vi**2 + self.second * vj**2
                + self.mixed * vi * vj + self.constant)

    def velocity(self, vi: Values, vj: Values, dvi: Values, dvj: Values) -> Values:
        """
        Return half the time derivative of :meth:`position` [m^2/s]: Eqs. (22)-(27) with = 0.

        For joints 1 and 4 it is Eq. (7) in the paper's chain.
        """
        by_i, by_j = self._slopes(vi, vj)
        return by_i * dvi + by_j * dvj

    def acceleration(self, vi: Values, vj: Values, dvi: Values, dvj: Values, ddvi: Values,
                     ddvj: Values) -> Values:
        """
        Return the time derivative of :meth:`velocity` [m^2/s^2]: Eqs. (28)-(33) with = 0.

        For joints 1 and 4 it is Eq. (8) in the paper's chain.
        """
        by_i, by_j = self._slopes(vi, vj)
        return (by_i * ddvi + by_j * ddvj + (self.both * vj**2 + self.first) * dvi**2
                + (self.both * vi**2 + self.second) * dvj**2
                + (4.0 * self.both * vi * vj + self.mixed) * dvi * dvj)

    def _slopes(self, vi: Values, vj: Values) -> tuple[Values, Values]:
        """Return half the derivatives of :meth:`position` with respect to vi and vj."""
        return ((self.both * vj**2 + self.first) * vi + 0.5 * self.mixed * vj,
                (self.both * vi**2 + self.second) * vj + 0.5 * self.mixed * vi)

    def denavit_hartenberg(self) -> IOEquation:
        """
        Return the same equation in the paper's chain, Eqs. (1)-(6): v1 is -1/v1, v4 is -v4 there.

        Its angles are all relative and add up to zero: theta1_DH = theta1 + pi, theta4_DH =
        -theta4.
        """
        both, first, second, mixed, constant = self[2:7]
        if self.i == 1:
            both, first, second, mixed, constant = second, constant, both, -mixed, first
        if self.j == 1:
            both, first, second, mixed, constant = first, both, constant, -mixed, second
        if 4 in (self.i, self.j):
            mixed = -mixed
        return self._replace(both=both, first=first, second=second, mixed=mixed, constant=constant)

    # --- in angles: no angle is special ----------------------------------------------------------

    def residual(self, ti: ArrayLike, tj: ArrayLike) -> Array:
        """Return :meth:`position` times cos^2(ti/2) cos^2(tj/2) [m^2], finite for all angles."""
        return self._form(_powers(ti)[0], _powers(tj)[0])

    def ratio(self, ti: ArrayLike, tj: ArrayLike) -> Array:
        """Return d tj / d ti at a pose, by Eqs. (22)-(27); infinite where ti stalls at a limit."""
        (i0, i1, _), (j0, j1, _) = _powers(ti), _powers(tj)
        with np.errstate(divide='ignore', invalid='ignore'):
            return -self._form(i1, j0) / self._form(i0, j1)

    def second_ratio(self, ti: ArrayLike, tj: ArrayLike) -> Array:
        """Return d^2 tj / d ti^2 at a pose, from Eqs. (28)-(33) and (36)."""
        (i0, i1, i2), (j0, j1, j2) = _powers(ti), _powers(tj)
        with np.errstate(divide='ignore', invalid='ignore'):
            by_j = self._form(i0, j1)
            ratio = -self._form(i1, j0) / by_j
            return -(self._form(i2, j0)
                     + ratio * (2.0 * self._form(i1, j1) + ratio * self._form(i0, j2))) / by_j

    def solve(self, ti: ArrayLike) -> tuple[Array, Array]:
        """
        Return both theta_j in [-pi, pi] that belong to theta_i [rad], NaN where no linkage closes.

        The first is for a positive angle of the joint opposite to i in the loop, the second for a
        negative one: for i = 1 that is theta3, so the first is mode 1 (crossed), the second mode 2
        (open). The equation is a quadratic in tan(theta_j/2); its root is kept as a pair
        (numerator, denominator) in the form without cancellation, and its discriminant is the
        product that the equation with the opposite joint provides.
        """
        (square, rest, product), _, _ = _powers(ti)
        opposite = io_equation(self.lengths, self.i, _OPPOSITE[self.i])
        with np.errstate(invalid='ignore'):
            root = np.sqrt(-(opposite.both * square + opposite.second * rest)
                           * (opposite.first * square + opposite.constant * rest))
        p, r = self.both * square + self.second * rest, self.first * square + self.constant * rest
        m = -0.5 * self.mixed * product
        if (self.i, self.j) in _NEGATIVE_ROOT:
            root = -root
        return _double_angle(p, r, m, root), _double_angle(p, r, m, -root)

    def _form(self, one: Sequence[Array], other: Sequence[Array]) -> Array:
        """Return the equation's bilinear form for (sin^2, cos^2, sin cos) of both half-angles."""
        return ((self.both * one[0] + self.second * one[1]) * other[0]
                + (self.first * one[0] + self.constant * one[1]) * other[1]
                + self.mixed * one[2] * other[2])


@overload
def io_equation(lengths: Sequence[float], i: int, j: int) -> IOEquation: ...


@overload
def io_equation(lengths: Sequence[float], i: int, j: int,
                slides: Mapping[int, float]) -> SlideEquation: ...


def io_equation(lengths: Sequence[float], i: int, j: int,
                slides: Mapping[int, float] | None = None) -> IOEquation | SlideEquation:
    """
    Return the :class:`IOEquation` between theta_i and theta_j.

    Parameters
    ----------
    lengths : sequence of 4 floats
        a1, a2, a3, a4 [m].
    i, j : int
        Two different of 1, 2, 3, 4, in any order: theta_i is the first variable.
    slides : mapping, optional
        {joint: direction of its slide [rad]}: the :class:`SlideEquation` of RRRP or PRRP, see
        :func:`~fourbar_lab.reproduction.slide_equations.equation_of_slides`.

    Raises
    ------
    InvalidParameter
        For any other pair.

    """
    if slides:
        return equation_of_slides(lengths, slides, i, j)
    if (min(i, j), max(i, j)) not in _TERMS:
        raise InvalidParameter('pair', (i, j), 'must be two different of the joints 1 to 4: '
                                               f'{PAIRS}')
    *products, mixed_lengths, factor = _TERMS[min(i, j), max(i, j)]
    a1, a2, a3, a4 = sides = four_lengths(lengths)
    factors = bilinear_factors(a1, a2, a3, a4)
    both, first, second, constant = (getattr(factors, one) * getattr(factors, other)
                                     for one, other in products)
    mixed = factor * math.prod(sides[n - 1] for n in mixed_lengths)
    if i > j:
        first, second = second, first
    return IOEquation(i, j, both, first, second, mixed, constant, sides)


def four_lengths(lengths: Sequence[float]) -> tuple[float, ...]:
    """Return four finite numbers [m] as a tuple of floats, or raise InvalidParameter."""
    try:
        a1, a2, a3, a4 = lengths
    except (TypeError, ValueError):
        raise InvalidParameter('lengths', lengths,
                               'must be four numbers: a1, a2, a3, a4') from None
    return tuple(number(f'a{i}', length) for i, length in enumerate((a1, a2, a3, a4), 1))


def to_half_angle(theta: ArrayLike, omega: Values = 0.0,
                  alpha: Values = 0.0) -> tuple[Array, Array, Array]:
    """Return v = tan(theta/2) and its two time derivatives, Eqs. (34) and (36)."""
    v = np.tan(0.5 * array('theta', theta))
    stretch = 0.5 * (1.0 + v * v)
    return v, stretch * omega, stretch * (alpha + omega**2 * v)


def from_half_angle(v: Values, dv: Values = 0.0,
                    ddv: Values = 0.0) -> tuple[Values, Values, Values]:
    """Return theta = 2 atan(v) [rad] and its two time derivatives, Eqs. (35) and (37)."""
    stretch = 2.0 / (1.0 + v * v)
    omega = stretch * dv
    return 2.0 * np.arctan(v), omega, stretch * ddv - omega**2 * v


def _powers(theta: ArrayLike) -> tuple[tuple[Array, Array, Array], ...]:
    """Return (sin^2, cos^2, sin cos) of theta/2, and their two derivatives by theta."""
    half = 0.5 * array('theta', theta)
    sine, cosine = np.sin(half), np.cos(half)
    square, rest, product = sine * sine, cosine * cosine, sine * cosine
    slope = 0.5 * (cosine - sine) * (cosine + sine)
    return (square, rest, product), (product, -product, slope), (slope, -slope, -product)


def _double_angle(p: Array, r: Array, m: Array, root: Array) -> Array:
    """Return the angle whose half has the tangent (m + root)/p = r/(m - root), by the sum."""
    adds = m * root > 0.0
    numerator, denominator = np.where(adds, m + root, r), np.where(adds, p, m - root)
    angle: Array = np.arctan2(2.0 * numerator * denominator,
                              (denominator - numerator) * (denominator + numerator))
    return angle
