# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The type of numpy arrays in annotations, and how finely floats are spaced."""
from __future__ import annotations

from math import pi
from typing import Any, TypeVar, Union

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]
EPS = 2.0**-52      # of 1.0 to the next float
# Type of what is a number or an array of numbers: the result is what the argument is.
Value = TypeVar('Value', float, Array)
Values = Union[float, Array]


def sine_between(low: Value, high: Value, phi: Any) -> Array:
    """Return middle + half sin(phi) of two ends, from the nearer one, which keeps its digits."""
    width = high - low
    return np.where(phi.real < 0.0, low + width * np.sin(0.5 * (phi + 0.5 * pi))**2,
                    high - width * np.sin(0.5 * (0.5 * pi - phi))**2)
