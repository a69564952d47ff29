# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Errors of motion and loads in eps times condition, against the reference of each kind."""

import mpmath as mp
import numpy as np
from support.contract import ANGLES, exact_numbers
from support.reference import condition, EPS

ANGLE_BOUND, RATE_BOUND, LOADS_BOUND = 2.0, 5.0, 5.0  # in eps cond


def values_and_conditions(function, case, given, others):
    """
    Return ({name: exact value}, {name: condition}) of function(given, others) -> {name: value}.

    :func:`reference.condition` counts its first value modulo a turn, so a zero stands before an
    input that is a length.
    """
    skip = 0 if case.turns else 1
    names = []

    def flat(values):
        found = function(values[skip: skip + 3], values[skip + 3:])
        names[:] = found
        return tuple(found.values())

    truth, cond = condition(flat, exact_numbers([0.0] * skip + [*given, *others]))
    return dict(zip(names, truth)), dict(zip(names, cond))


def error_in_conditions(name, value, truth, cond):
    """
    Return |value - truth| in eps cond.

    Angles count modulo a turn, and a condition of an angle below 1 counts as 1.
    """
    error = abs(value - truth)
    if name.startswith(ANGLES):
        error, cond = abs(mp.arg(mp.expj(value - truth))), max(cond, 1)
    return float(error / (EPS * cond)) if cond else np.inf if error else 0.0


def motion_errors(case, lengths, given):
    """Return {field: error in eps cond}, the larger one of a single value and of an array."""
    n = len(lengths)
    truth, cond = values_and_conditions(
        lambda at, v: case.reference.motion(case.driven, v[:n], case.sign, at),
        case,
        given,
        lengths,
    )
    mechanism = case.make(lengths)
    motions = mechanism.motion(*given), _first(mechanism.motion(*(np.full(100, v) for v in given)))
    return {
        name: max(
            error_in_conditions(name, getattr(motion, name), truth[name], cond[name])
            for motion in motions
        )
        for name in truth
    }


def load_errors(case, lengths, given, masses):
    """Return {field or stem of a pair: error in eps cond}, of a value and of an array."""
    n = len(lengths)
    truth, cond = values_and_conditions(
        lambda at, v: case.reference.loads(case.driven, v[:n], case.sign, at, *case.pieces(v[n:])),
        case,
        given,
        [*lengths, *masses],
    )
    mechanism = case.make(lengths, masses)
    loads = mechanism.loads(*given), _first(mechanism.loads(*(np.full(100, v) for v in given)))

    def value(one, name):
        if isinstance(truth[name], mp.mpc):
            return mp.mpc(getattr(one, f'{name}_x'), getattr(one, f'{name}_y'))
        return getattr(one, name)

    return {
        name: max(
            error_in_conditions(name, value(one, name), truth[name], cond[name]) for one in loads
        )
        for name in truth
    }


def _first(arrays):
    """Return the first sample of a motion or of loads, as numbers of Python."""
    return type(arrays)(*(float(field[0]) for field in arrays))
