# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Ordinary differential equations to many digits by Taylor series, with python-flint."""
from flint import arb, arb_series, ctx
import mpmath as mp


def taylor(derivative, start, until, steps, order=40, digits=40):
    """
    Return the state at ``until`` to this many digits, as far as steps and order reach.

    ``derivative(states)`` takes and returns lists of power series in time; ``start()`` returns the
    state at the beginning in the precision in which it is called.
    """
    before = ctx.prec, ctx.cap
    ctx.dps = digits
    try:
        states, step = [arb(value) for value in start()], arb(until) / steps
        for _ in range(steps):
            states = [series_at(series, step) for series in solution(derivative, states, order)]
        return [mp.mpf(value.str(digits - 5, radius=False)) for value in states]
    finally:
        ctx.prec, ctx.cap = before


def solution(derivative, states, order):
    """Return the power series of the solution: each round of Picard's iteration adds a term."""
    series = [arb_series([value]) for value in states]
    for cap in range(2, order + 1):
        ctx.cap = cap
        series = [arb_series([value]) + change.integral()
                  for value, change in zip(states, derivative(series))]
    return series


def series_at(series, step):
    total = arb(0)
    for coefficient in reversed(series.coeffs()):
        total = (total * step + coefficient).mid()
    return total
