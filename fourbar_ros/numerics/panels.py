# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Functions on the panel [0, 1] from their values at Chebyshev's points, ends included.

Every second point is a point of the rule of half the degree: what that rule says differently is
the error of the coarser one, for no further values. Source: Trefethen, Approximation Theory and
Approximation Practice (2013), chapters 3, 4 and 19.
"""
from __future__ import annotations

from functools import lru_cache
from math import pi
from typing import NamedTuple

from fourbar_ros.numerics.arrays import Array
import numpy as np
from numpy.polynomial import chebyshev


class Panel(NamedTuple):
    """Points, and matrices that act on values at them, of a polynomial of some degree."""

    points: Array            # (degree + 1,), increasing from 0 to 1
    coefficients: Array      # values -> coefficients of Chebyshev's polynomials
    integral: Array          # values -> integral from 0 to each point

    @property
    def weights(self) -> Array:
        """Return the weights of the integral over the panel (Clenshaw and Curtis)."""
        weights: Array = self.integral[-1]
        return weights


@lru_cache(maxsize=4)
def panel(degree: int) -> Panel:
    """Return points and matrices for polynomials of an even degree."""
    x = -np.cos(np.arange(degree + 1) * (pi / degree))
    x[degree // 2] = 0.0
    coefficients = np.linalg.inv(chebyshev.chebvander(x, degree))
    integrals = chebyshev.chebint(np.eye(degree + 1), lbnd=-1, scl=0.5)
    return Panel(0.5 * (x + 1.0), coefficients,
                 chebyshev.chebvander(x, degree + 1) @ integrals @ coefficients)


def at(places: Array, degree: int) -> Array:
    """Return Chebyshev's polynomials at places of the panel, a row for each place."""
    return chebyshev.chebvander(2.0 * places - 1.0, degree)
