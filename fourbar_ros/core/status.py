"""One evaluation that never raises: a status says what the numbers are worth."""
from __future__ import annotations

from math import isfinite, nan

import numpy as np

from .errors import OutOfRange, Toggle
from .kinematics import Motion
from .loads import Loads

# The same numbers as the STATUS_ constants of fourbar_msgs/LinkageState (a test compares them).
OK, OUT_OF_RANGE, INVALID_INPUT, TOGGLE = 0, 1, 2, 3
STATUS_NAMES = {OK: 'ok', OUT_OF_RANGE: 'out of range', INVALID_INPUT: 'invalid input', TOGGLE: 'toggle'}

NO_LOADS = Loads(*[nan] * len(Loads._fields))
_UNKNOWN = [nan] * (len(Motion._fields) - 3)


def evaluate(linkage, theta1, omega1, alpha1, with_loads):
    """
    Return (status, Motion, Loads): what does not exist is NaN, loads are all NaN if not asked for.

    INVALID_INPUT stands for NaN and infinity, also for speeds so high that a result overflows.
    """
    if not isfinite(theta1 + omega1 + alpha1):
        return INVALID_INPUT, Motion(theta1, omega1, alpha1, *_UNKNOWN), NO_LOADS
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
        return TOGGLE, _angles_only(linkage, theta1, omega1, alpha1), NO_LOADS
    if finite:
        return OK, motion, loads
    return INVALID_INPUT, Motion(theta1, omega1, alpha1, *_UNKNOWN), NO_LOADS


def _angles_only(linkage, theta1, omega1, alpha1):
    """Return the Motion at a toggle: rates are infinite or undefined, so NaN."""
    motion = linkage.motion(np.array([theta1]), omega1, alpha1)
    values = [float(field[0]) for field in motion]
    return Motion(theta1, omega1, alpha1, *[v if isfinite(v) else nan for v in values[3:]])
