# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Quadrature over the input of a mechanism: inputs and weights of sum one."""
from __future__ import annotations

from functools import lru_cache
from math import pi

from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.numerics.arrays import Array
import numpy as np

MOST_OF_RANGE = 1024        # points of a range: they are eigenvalues, more would take seconds


@lru_cache(maxsize=8)
def _gauss(points: int) -> tuple[Array, Array]:
    return np.polynomial.legendre.leggauss(points)


def nodes(mechanism: Mechanism, points: int) -> tuple[Array, Array]:
    """
    Return inputs and weights of a mean over the input, ``points`` in each of its ranges.

    Over a full turn the trapezoidal rule, which is spectral there. Else Gauss's rule in the angle
    whose sine is the input: roots of the distance to a toggle at an end, as angles have, are
    smooth in it.
    """
    if mechanism.turns_fully:
        return 2.0 * pi * np.arange(points) / points, np.full(points, 1.0 / points)
    places, weights = _gauss(min(points, MOST_OF_RANGE))
    phi, ranges = 0.5 * pi * places, mechanism.input_ranges
    whole = sum(high - low for low, high in ranges)
    x = [0.5 * (low + high) + 0.5 * (high - low) * np.sin(phi) for low, high in ranges]
    parts = [0.25 * pi * weights * np.cos(phi) * ((high - low) / whole) for low, high in ranges]
    return np.concatenate(x), np.concatenate(parts)
