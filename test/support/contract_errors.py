# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Errors of motion and loads of a kind in eps times condition, beside Cartesian coordinates."""
from flint import acb, arb, ctx
import numpy as np
from support.cartesian import BITS, Cartesian, EPS, J, ONE, value_and_condition
from support.contract import ANGLES

ANGLE_BOUND, RATE_BOUND, LOADS_BOUND = 2.0, 5.0, 5.0  # in eps cond


def errors_of(case, mechanism, given):
    """
    Return {field: error in eps cond} of motion and of loads, of a value and of an array.

    Angles count modulo a turn, and a condition of an angle below 1 counts as 1. A pair of fields
    NAME_x, NAME_y has one error, of its vector.
    """
    with ctx.workprec(BITS):
        found = case.exact(mechanism, given)
        exact = found.machine.fields(Cartesian(found.machine, given, found))
        many = [np.full(100, v) for v in given]
        results = [(mechanism.motion(*given), mechanism.motion(*many)), ()]
        if mechanism.bodies:
            results[1] = mechanism.loads(*given), mechanism.loads(*many)
        return [{name: max(_error(name, ours, *value_and_condition(column)) for ours in both)
                 for name, column in fields.items()} for fields, both in zip(exact, results)]


def _error(name, ours, truth, condition):
    def first(field):
        return float(np.ravel(getattr(ours, field))[0])
    if isinstance(truth, acb):
        error = acb(first(f'{name}_x'), first(f'{name}_y')) - truth
    else:
        error = arb(first(name)) - truth
    if name.startswith(ANGLES):
        error, condition = (J * error).exp() - ONE, max(condition, 1.0)
    size = float(abs(error))
    return size / (EPS * condition) if condition else 0.0 if size <= 1e-30 else np.inf


def motion_errors(case, lengths, given):
    """Return {field: error in eps cond} of a motion."""
    return errors_of(case, case.make(lengths), given)[0]


def load_errors(case, lengths, given, masses):
    """Return {field or stem of a pair: error in eps cond} of loads."""
    return errors_of(case, case.make(lengths, masses), given)[1]
