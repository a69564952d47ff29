# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The type of numpy arrays in annotations, and how finely floats are spaced."""
from __future__ import annotations

from typing import Any, TypeVar, Union

from numpy.typing import NDArray

Array = NDArray[Any]
EPS = 2.0**-52      # of 1.0 to the next float
# Type of what is a number or an array of numbers: the result is what the argument is.
Value = TypeVar('Value', float, Array)
Values = Union[float, Array]
