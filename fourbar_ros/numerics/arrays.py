# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The type of numpy arrays in annotations, and how finely floats are spaced."""
from math import pi
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]
EPS = 2.0**-52      # of 1.0 to the next float
# Type of what is a number or an array of numbers: the result is what the argument is.
Value = TypeVar('Value', float, Array)
Values = float | Array


def sine_between(low: Value, high: Value, phi: Any) -> Array:
    """Return middle + half sin(phi) of two ends, from the nearer one, which keeps its digits."""
    width = high - low
    return np.where(phi.real < 0.0, low + width * np.sin(0.5 * (phi + 0.5 * pi))**2,
                    high - width * np.sin(0.5 * (0.5 * pi - phi))**2)


def rank_of(key: Array) -> Array:
    """Return how many equal keys stand before each of sorted keys: of 3 3 5 5 5, 0 1 0 1 2."""
    counts = np.bincount(key)
    first = np.cumsum(counts) - counts
    return np.asarray(np.arange(key.size) - first[key])


def as_grid(x: Array, row: Array, count: int) -> tuple[Array, Array, Array]:
    """Return numbers in a table of ``count`` rows, where each stands, its row and its column."""
    # (row, column, table): columns that a row does not have are 1. row is sorted.
    column = rank_of(row)
    grid = np.ones((count, int(column.max(initial=0)) + 1))
    grid[row, column] = x
    return row, column, grid
