# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The six input-output equations of the 4R linkage, each between two of its four joint angles.

Slides, Eqs. (16)-(33), with theta1 and theta4 absolute at the ground pivots, theta2 and theta3
relative; paper, Eqs. (1)-(8), with all angles relative: theta1 + pi and -theta4. In v =
tan(theta/2) each is

    both vi^2 vj^2 + first vi^2 + second vj^2 + mixed vi vj + constant = 0

with products of two bilinear factors for coefficients. Angles and v are
floats or arrays of one shape.
"""
from collections.abc import Mapping, Sequence
from math import prod
from typing import Any, NamedTuple

from fourbar_ros.mechanisms.loop import bilinear_factors
from fourbar_ros.numerics.number_types import Scalar
from fourbar_ros.plain import io_equation
import numpy as np

# Eq.: joints i and j; factors of vi^2 vj^2, vi^2, vj^2, 1; the coefficient of vi vj and the
# lengths that it is multiplied with
SLIDES: Mapping[int, tuple[int, int, str, int, tuple[int, ...]]] = {
    16: (1, 4, 'A1 A2, B1 B2, C1 C2, D1 D2', -8, (1, 3)),
    17: (1, 2, 'A1 B1, A2 B2, C1 D2, C2 D1', 8, (2, 4)),
    18: (1, 3, 'A2 B1, A1 B2, C1 D1, C2 D2', 0, ()),
    19: (2, 3, 'B1 C1, A1 D2, A2 D1, B2 C2', -8, (1, 3)),
    20: (2, 4, 'A1 C1, B1 D2, A2 C2, B2 D1', 0, ()),
    21: (3, 4, 'A2 C1, B1 D1, A1 C2, B2 D2', -8, (2, 4)),
}
# Eq. of the paper: joints i and j; their coefficients are in fourbar_ros/plain.py
PAPER = {1: (1, 4), 2: (1, 2), 3: (1, 3), 4: (2, 3), 5: (2, 4), 6: (3, 4)}


class Angle(NamedTuple):
    """Rate and acceleration of a joint angle, and v = tan(theta/2) with its two derivatives."""

    omega: Scalar
    alpha: Scalar
    v: Scalar
    dv: Scalar
    ddv: Scalar


def half_angle(theta: Any, omega: Any = 0.0, alpha: Any = 0.0) -> Angle:
    """Return an :class:`Angle`, with the derivatives of v by Eqs. (34) and (36) of the slides."""
    # Eqs. (35) and (37) of the slides are the way back.
    v = np.tan(0.5 * theta)
    stretch = 0.5 * (1.0 + v * v)
    return Angle(omega, alpha, v, stretch * omega, stretch * (alpha + omega**2 * v))


class AngleEquation(NamedTuple):
    """One equation between the angles of joints i and j; coefficients in [m^2]."""

    i: int
    j: int
    both: float
    first: float
    second: float
    mixed: float
    constant: float

    def position(self, a: Angle, b: Angle) -> tuple[Scalar, ...]:
        """Return the terms of Eqs. (16)-(21) of the slides, (1)-(6) of the paper [m^2]."""
        return (self.both * a.v**2 * b.v**2, self.first * a.v**2, self.second * b.v**2,
                self.mixed * a.v * b.v, self.constant)

    def velocity(self, a: Angle, b: Angle) -> tuple[Scalar, ...]:
        """Return the terms of half the derivative of :meth:`position`: Eq. (7) of the paper."""
        by_a, by_b = self._slopes(a, b)
        return by_a * a.dv, by_b * b.dv

    def ratio(self, a: Angle, b: Angle) -> Scalar:
        """Return d theta_j / d theta_i: Eqs. (22)-(27)."""
        by_a, by_b = self._slopes(a, b)
        return -by_a * (1.0 + a.v**2) / (by_b * (1.0 + b.v**2))

    def acceleration(self, a: Angle, b: Angle) -> tuple[Scalar, ...]:
        """Return the terms of the derivative of :meth:`velocity`: Eqs. (28)-(33)."""
        by_a, by_b = self._slopes(a, b)
        return (by_a * a.ddv, by_b * b.ddv, (self.both * b.v**2 + self.first) * a.dv**2,
                (self.both * a.v**2 + self.second) * b.dv**2,
                (4.0 * self.both * a.v * b.v + self.mixed) * a.dv * b.dv)

    def _slopes(self, a: Angle, b: Angle) -> tuple[Scalar, Scalar]:
        """Return half the derivatives of :meth:`position` with respect to vi and vj."""
        return ((self.both * b.v**2 + self.first) * a.v + 0.5 * self.mixed * b.v,
                (self.both * a.v**2 + self.second) * b.v + 0.5 * self.mixed * a.v)


def equations_of_slides(lengths: Sequence[float]) -> dict[int, AngleEquation]:
    """Return {number of the equation: :class:`AngleEquation`} for a1 to a4 [m]."""
    a1, a2, a3, a4 = lengths
    factors, equations = bilinear_factors(a1, a2, a3, a4), {}
    for name, (i, j, products, factor, sides) in SLIDES.items():
        both, first, second, constant = (prod(factors[letter] for letter in product.split())
                                         for product in products.split(', '))
        equations[name] = AngleEquation(i, j, both, first, second,
                                        factor * prod(lengths[n - 1] for n in sides), constant)
    return equations


def equations_of_paper(lengths: Sequence[float]) -> dict[int, AngleEquation]:
    """Return {number of the equation: :class:`AngleEquation`} for a1 to a4 [m]."""
    return {name: AngleEquation(i, j, *io_equation(lengths, i, j))
            for name, (i, j) in PAPER.items()}
