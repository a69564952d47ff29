# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""One evaluation that never raises: its status qualifies the numbers."""
from __future__ import annotations

from collections.abc import Callable
from functools import cache
from math import isfinite, isinf, isnan, nan
from typing import Any, NamedTuple

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
    unknown: Any = fields._make([nan] * len(fields._fields))
    found: NamedFields = unknown
    return found


def evaluate(mechanism: Mechanism, position: float, rate: float, acceleration: float,
             with_loads: bool) -> Evaluated:
    """
    Return (status, motion, loads); what does not exist is NaN, and loads that are not wanted too.

    INVALID_INPUT: the input is NaN or infinite, or so fast that a result overflows. RATES_UNKNOWN:
    the rate or acceleration is NaN; what does not depend on it is valid.
    """
    given = position, rate, acceleration
    if not isfinite(position) or isinf(rate) or isinf(acceleration):
        return INVALID_INPUT, mechanism.unknown(*given), _none_of(mechanism.LOADS)
    if isnan(rate) or isnan(acceleration):
        return _partly(RATES_UNKNOWN, mechanism, *given)
    try:
        if with_loads:
            motion, loads = mechanism.step(*given)
            is_finite = isfinite(sum(motion) + sum(loads))
        else:
            motion, loads = mechanism.motion(*given), _none_of(mechanism.LOADS)
            is_finite = isfinite(sum(motion))
    except InvalidParameter:     # numbers overflow
        is_finite = False
    except OutOfRange:
        return OUT_OF_RANGE, mechanism.unknown(*given), _none_of(mechanism.LOADS)
    except Toggle:
        return _partly(TOGGLE, mechanism, *given)
    if is_finite:
        return OK, motion, loads
    return INVALID_INPUT, mechanism.unknown(*given), _none_of(mechanism.LOADS)


def _partly(status: int, mechanism: Mechanism, position: float, rate: float, acceleration: float
            ) -> Evaluated:
    """Return the part of the motion that exists; infinite and undefined fields are NaN."""
    motion = mechanism.motion(np.array([position]), rate, acceleration)
    if isnan(motion.transmission_angle[0]):
        return OUT_OF_RANGE, mechanism.unknown(position, rate,
                                               acceleration), _none_of(mechanism.LOADS)
    values = [float(field[0]) for field in motion]
    return (status, mechanism.MOTION(*[value if isfinite(value) else nan for value in values]),
            _none_of(mechanism.LOADS))
