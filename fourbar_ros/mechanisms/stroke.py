# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The stroke of a driven slide: the part of its range that a cylinder or actuator reaches."""
from __future__ import annotations

from math import nan
from typing import Any

from fourbar_ros.mechanisms.contract import Ranges
from fourbar_ros.numerics.number_types import Function, NumberType, REAL
import numpy as np


def within_stroke(ranges: Ranges, stroke: tuple[float, float] | None) -> Ranges:
    """Return the parts of ranges of the input that lie in the stroke, if there is one."""
    if stroke is None:
        return ranges
    parts = ((max(low, stroke[0]), min(high, stroke[1])) for low, high in ranges)
    return tuple((low, high) for low, high in parts if low < high)


def motion_within(motion: Function, stroke: tuple[float, float], numbers: NumberType) -> Function:
    """
    Return a function of motion that has no pose outside of the stroke.

    There it gives NaN, or ValueError where numbers are floats.
    """
    low, high = stroke

    def within_one(position: float, rate: float, acceleration: float) -> Any:
        if not low <= position <= high:
            raise ValueError
        return motion(position, rate, acceleration)

    def within(position: Any, rate: Any, acceleration: Any) -> Any:
        fields = motion(position, rate, acceleration)
        outside = (position.real < low) | (position.real > high)
        given = position, rate, acceleration
        return tuple(field if any(field is value for value in given)
                     else np.where(outside, nan, field)
                     for field in fields) if outside.any() else fields
    return within_one if numbers is REAL else within
