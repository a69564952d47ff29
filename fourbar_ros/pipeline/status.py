# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""One evaluation that never raises: its status qualifies the numbers."""
from __future__ import annotations

from collections.abc import Callable
from functools import cache
from math import isfinite, isinf, isnan, nan
from typing import cast, NamedTuple

from fourbar_ros.errors import InvalidParameter, OutOfRange, Toggle
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.parts import NamedFields
import numpy as np

# The same numbers as the STATUS_ constants of fourbar_msgs/LinkageState (a test compares them).
OK, OUT_OF_RANGE, INVALID_INPUT, TOGGLE, RATES_UNKNOWN, INPUT_TIMEOUT, LOADS_UNKNOWN = range(7)
STATUS_NAMES = ('ok', 'out of range', 'invalid input', 'toggle', 'rates unknown', 'input timeout',
                'loads unknown')


Evaluated = tuple[int, NamedFields, NamedFields]      # status, MOTION and LOADS of the mechanism
Evaluate = Callable[[Mechanism, float, float, float, bool], Evaluated]     # as evaluate()


@cache
def _none_of(fields: type[NamedTuple]) -> NamedFields:
    """Return a record of this type, all NaN."""
    return cast(NamedFields, fields._make([nan] * len(fields._fields)))


def evaluate(mechanism: Mechanism, position: float, rate: float, acceleration: float,
             with_loads: bool) -> Evaluated:
    """
    Return (status, motion, loads) at an input; unknown fields are NaN, as loads not asked for.

    INVALID_INPUT: the input is NaN or infinite, or so fast that a result overflows. RATES_UNKNOWN:
    the rate or acceleration is NaN; fields that do not depend on it are valid.
    """
    inputs = position, rate, acceleration
    if not isfinite(position) or isinf(rate) or isinf(acceleration):
        return INVALID_INPUT, mechanism.unknown(*inputs), _none_of(mechanism.LOADS)
    if isnan(rate) or isnan(acceleration):
        return _partly(RATES_UNKNOWN, mechanism, *inputs)
    try:
        if with_loads:
            motion, loads = mechanism.step(*inputs)
            is_finite = isfinite(sum(motion) + sum(loads))
        else:
            motion, loads = mechanism.motion(*inputs), _none_of(mechanism.LOADS)
            is_finite = isfinite(sum(motion))
    except InvalidParameter:     # numbers overflow
        is_finite = False
    except OutOfRange:
        return OUT_OF_RANGE, mechanism.unknown(*inputs), _none_of(mechanism.LOADS)
    except Toggle:
        return _partly(TOGGLE, mechanism, *inputs)
    if is_finite:
        return OK, motion, loads
    return INVALID_INPUT, mechanism.unknown(*inputs), _none_of(mechanism.LOADS)


def _partly(status: int, mechanism: Mechanism, position: float, rate: float, acceleration: float
            ) -> Evaluated:
    """
    Return (status, motion, loads) where a part of the motion exists, without loads.

    It is evaluated as an array of one input. An array has infinite or undefined fields where a
    single input raises; they become NaN.
    """
    motion = mechanism.motion(np.array([position]), rate, acceleration)
    no_loads = _none_of(mechanism.LOADS)
    if isnan(motion.transmission_angle[0]):
        return OUT_OF_RANGE, mechanism.unknown(position, rate, acceleration), no_loads
    values = [float(field[0]) for field in motion]
    return (status, mechanism.MOTION(*[value if isfinite(value) else nan for value in values]),
            no_loads)
