# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""How far the cranks of a planar 4R linkage turn, and where its output turns back."""
from __future__ import annotations

from math import atan2, fsum, pi, sqrt
from typing import NamedTuple

from fourbar_ros.mechanisms.contract import Ranges
from fourbar_ros.numerics.exact_sums import difference_of_squares, scaled


class DeadPoint(NamedTuple):
    """Crank and coupler in line, one behind the other (stretched) or folded; angles in [rad]."""

    theta1: float
    theta4: float
    stretched: bool


def squares_of_half(one: float, other: float, a3: float, a4: float) -> tuple[float, float]:
    """Return 4 r a4 (sin^2, cos^2) of half the angle at O1 of r = one + other, a3, a4."""
    return (fsum((a3, -one, -other, a4)) * fsum((a3, one, other, -a4)),
            fsum((one, other, a4, -a3)) * fsum((one, other, a4, a3)))


def ranges_of(a1: float, a2: float, a3: float, a4: float) -> Ranges:
    """
    Return the ranges of the angle at which a1 leaves the ground link.

    See FourBar.closing_ranges.
    """
    a1, a2, a3, a4 = scaled((a1, a2, a3, a4))
    s1 = difference_of_squares(a2, a3, a1, a4)
    s2 = difference_of_squares(a1, -a4, a2, -a3)
    far = 2.0 * atan2(sqrt(difference_of_squares(a2, a3, a1, -a4)), sqrt(-s1)) if s1 < 0.0 else pi
    near = (2.0 * atan2(sqrt(-s2), sqrt(difference_of_squares(a1, a4, a2, -a3))) if s2 < 0.0
            else 0.0)
    if s1 >= 0.0:
        return ((-pi, pi),) if s2 >= 0.0 else ((near, 2.0 * pi - near),)
    return ((-far, far),) if s2 >= 0.0 else ((-far, -near), (near, far))
