# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Quadrature over the input of a mechanism: inputs and weights of sum one."""
from __future__ import annotations

from functools import lru_cache
from math import pi

from fourbar_ros.numerics.arrays import Array
import numpy as np


def full_turn(points: int) -> tuple[Array, Array]:
    """Return inputs and weights of the trapezoidal rule, which is spectral over a full turn."""
    return 2.0 * pi * np.arange(points) / points, np.full(points, 1.0 / points)


@lru_cache(maxsize=8)
def _gauss(points: int) -> tuple[Array, Array]:
    return np.polynomial.legendre.leggauss(points)


def between(low: float, high: float, points: int) -> tuple[Array, Array]:
    """
    Return inputs and weights of Gauss's rule in the angle whose sine is the input.

    Roots of the distance to a toggle at an end, as angles have, are smooth in that angle.
    """
    nodes, weights = _gauss(points)
    phi = 0.5 * pi * nodes
    return (0.5 * (low + high) + 0.5 * (high - low) * np.sin(phi),
            0.25 * pi * weights * np.cos(phi))
