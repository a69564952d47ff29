"""One evaluation that never raises: a status says what the numbers are worth."""
from __future__ import annotations

from math import isfinite, isinf, isnan, nan

import numpy as np

from .errors import OutOfRange, Toggle
from .kinematics import Motion
from .loads import Loads

# The same numbers as the STATUS_ constants of fourbar_msgs/LinkageState (a test compares them).
OK, OUT_OF_RANGE, INVALID_INPUT, TOGGLE, RATES_UNKNOWN, INPUT_TIMEOUT = range(6)
STATUS_NAMES = ('ok', 'out of range', 'invalid input', 'toggle', 'rates unknown', 'input timeout')

NO_LOADS = Loads(*[nan] * len(Loads._fields))
_UNKNOWN = [nan] * (len(Motion._fields) - 3)


def evaluate(linkage, theta1, omega1, alpha1, with_loads):
    """
    Return (status, Motion, Loads): what does not exist is NaN, loads are all NaN if not asked for.

    INVALID_INPUT stands for an angle that is NaN, for infinity, and for speeds so high that a result
    overflows; RATES_UNKNOWN for omega1 or alpha1 that is NaN: what does not depend on it is valid.
    """
    if not isfinite(theta1) or isinf(omega1) or isinf(alpha1):
        return INVALID_INPUT, Motion(theta1, omega1, alpha1, *_UNKNOWN), NO_LOADS
    if isnan(omega1) or isnan(alpha1):
        return _partly(RATES_UNKNOWN, linkage, theta1, omega1, alpha1)
    try:
        if with_loads:
            motion, loads = linkage.step(theta1, omega1, alpha1)
            finite = isfinite(loads.shaking_moment + loads.f41 + motion.alpha4)
        else:
            motion, loads = linkage.motion(theta1, omega1, alpha1), NO_LOADS
            finite = isfinite(motion.alpha4 + motion.alpha_beta)
    except OutOfRange:
        return OUT_OF_RANGE, Motion(theta1, omega1, alpha1, *_UNKNOWN), NO_LOADS
    except Toggle:
        return _partly(TOGGLE, linkage, theta1, omega1, alpha1)
    if finite:
        return OK, motion, loads
    return INVALID_INPUT, Motion(theta1, omega1, alpha1, *_UNKNOWN), NO_LOADS


def _partly(status, linkage, theta1, omega1, alpha1):
    """Return the answer where not all of the Motion exists: what is infinite or undefined is NaN."""
    motion = linkage.motion(np.array([theta1]), omega1, alpha1)
    values = [float(field[0]) for field in motion]
    if isnan(motion.theta4[0]):
        return OUT_OF_RANGE, Motion(theta1, omega1, alpha1, *_UNKNOWN), NO_LOADS
    return status, Motion(theta1, omega1, alpha1, *[v if isfinite(v) else nan for v in values[3:]]), NO_LOADS
