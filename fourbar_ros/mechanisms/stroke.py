# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The stroke of a driven slide: the part of its range that a cylinder or actuator reaches."""
from __future__ import annotations

from collections.abc import Sequence
from math import nan
from typing import Any

from fourbar_ros.mechanisms.parts import Ranges
from fourbar_ros.numerics.arrays import Array, Values
from fourbar_ros.numerics.number_types import Function, NumberType, REAL
import numpy as np


def within_stroke(ranges: Ranges, stroke: tuple[float, float] | None) -> Ranges:
    """Return the parts of ranges of the input that lie in the stroke, if there is one."""
    if stroke is None:
        return ranges
    parts = ((max(low, stroke[0]), min(high, stroke[1])) for low, high in ranges)
    return tuple((low, high) for low, high in parts if low < high)


def motion_within(motion: Function, reaches: Function | None, numbers: NumberType) -> Function:
    """
    Return a function of motion that has no pose where the mechanism does not reach.

    There it gives NaN, or ValueError where numbers are floats. ``reaches``: as
    :attr:`~fourbar_ros.mechanisms.mechanism.Described.reaches`; None: the motion as it is.
    """
    if reaches is None:
        return motion

    def within_one(position: float, rate: float, acceleration: float) -> Sequence[float]:
        if not reaches(position):
            raise ValueError
        fields: Sequence[float] = motion(position, rate, acceleration)
        return fields

    def within(position: Array, rate: Values, acceleration: Values) -> Any:
        fields = motion(position, rate, acceleration)
        outside = ~reaches(position)
        given = position, rate, acceleration
        if not outside.any():
            return fields
        make = getattr(fields, '_make', tuple)
        return make([field if any(field is value for value in given)
                     else np.where(outside, nan, field) for field in fields])
    return within_one if numbers is REAL else within
