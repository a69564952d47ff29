# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The 4R linkage with its output link as the one that is driven.

Mirrored at the middle of its ground, x -> a4 - x, the linkage a1, a2, a3, a4 is the linkage a3,
a2, a1, a4 whose crank stands at p = pi - theta4 and whose output link at pi - theta1; its coupler,
from B to A, is at -beta.
"""
from __future__ import annotations

from math import pi
from typing import Any

from fourbar_ros.mechanisms.points import LinkMotion, point_of
from fourbar_ros.numerics.number_types import Function, NumberType


class SeenFromOutput:
    """
    A 4R linkage whose coordinate is p = pi - theta4.

    What is asked of it and not defined here is that of the mirrored linkage.

    Parameters
    ----------
    mirrored : FourBar
        The linkage a3, a2, a1, a4 in one of its assembly modes.
    crank : float
        a1 [m].

    """

    def __init__(self, mirrored: Any, crank: float) -> None:
        self.mirrored, self._crank = mirrored, crank

    def __getattr__(self, name: str) -> Any:
        if name == 'mirrored':
            raise AttributeError(name)      # while it is being copied
        return getattr(self.mirrored, name)

    def in_mode(self, mode: int) -> SeenFromOutput:
        """Return the same in another assembly mode."""
        return SeenFromOutput(self.mirrored.in_mode(mode), self._crank)

    def make_coefficients(self, numbers: NumberType) -> Function:
        """Return p -> coefficients of crank, coupler and output, as those of a mechanism."""
        mirrored, crank, ground = self.mirrored.make_coefficients(numbers), self._crank, self.a4

        def coefficients(position: Any) -> list[tuple[Any, ...]]:
            (*_, cos_p, sin_p, _, _), (*_, cos_b, sin_b, d_b, dd_b), (
                *_, cos_x, sin_x, d_x, dd_x) = mirrored(position)
            first = LinkMotion(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -cos_x, sin_x, -d_x, -dd_x)
            return [first, (*point_of(first, crank), cos_b, -sin_b, -d_b, -dd_b),
                    (ground, 0.0, 0.0, 0.0, 0.0, 0.0, -cos_p, sin_p, -1.0, 0.0)]
        return coefficients

    def read_coordinate(self, numbers: NumberType, curves: Any) -> tuple[Any, Any, Any]:
        """Return p in (-pi, pi] and its two derivatives from coefficients of the links."""
        *_, cosine, sine, turn, bend = curves[2]
        return pi - numbers.atan2(sine, cosine), -turn, -bend
