# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Roots in brackets, to the last bits: many at once by Newton's method, one by halving.

:mod:`fourbar_ros.numerics.roots` finds the brackets.
"""
from __future__ import annotations

from collections.abc import Callable

from fourbar_ros.numerics.arrays import Array, EPS
from fourbar_ros.numerics.number_types import Function
import numpy as np

# Below this angle [rad] roots are found to an absolute tolerance: 0 has no last bit.
SMALL = 2.0**-12
# By how much the error of a step of Newton's method may exceed its square over the width of the
# bracket.
SAFETY = 64.0


def newton_roots(function: Function, which: Array, xa: Array, xb: Array, fa: Array,
                 x: Array) -> Array:
    """Return the root of a function in each bracket, to the last bits of x, all together."""
    # Newton's method, with bisection wherever that leaves the bracket or does not halve its step.
    # The last step is not looked at again: its error is about its square over the width of the
    # bracket. function: (x, some of ``which``) -> f, and the step f/f' (NaN: not known, so halve);
    # xa, xb, fa, x: where f changes its sign, its value at the first of them, and a first guess.
    # A zero at an end may not be where the sign changes: it counts as positive.
    x = np.where((fa != 0.0) & (x > xa) & (x < xb), x, 0.5 * (xa + xb))
    positive: Array = fa >= 0.0
    width = last = xb - xa
    roots, left = x.copy(), np.arange(x.size)       # left: brackets whose root is still sought
    while left.size:
        f, step = function(x, which)
        before = (f >= 0.0) == positive
        xa, xb = np.where(before, x, xa), np.where(before, xb, x)
        better = x - step
        is_newton = (better >= xa) & (better <= xb) & (2.0 * np.abs(step) <= last)
        better = np.where(is_newton, better, 0.5 * (xa + xb))
        tolerance = EPS * np.maximum(np.abs(better), SMALL)
        done = np.where(is_newton, SAFETY * step * step <= tolerance * width,
                        xb - xa <= 2.0 * tolerance)
        done |= ~np.isfinite(f)              # overflow: no root to be found
        roots[left] = better
        last, x = np.abs(x - better), better
        left, which, x, xa, xb, positive, width, last = (
            v[~done] for v in (left, which, x, xa, xb, positive, width, last))
    return roots


def halve(is_before: Callable[[float], bool], low: float, high: float) -> tuple[float, float]:
    """Return the neighbouring floats between which ``is_before`` turns from true to false."""
    # It is true at low and false at high, which may be the larger one.
    while True:
        middle = 0.5 * (low + high)
        if not min(low, high) < middle < max(low, high):
            return low, high
        if is_before(middle):
            low = middle
        else:
            high = middle
