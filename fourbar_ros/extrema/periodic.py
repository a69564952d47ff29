# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Periodic functions sampled at equal steps: slopes, what is not resolved, roots between samples.

Arrays of shape (samples, m), a column for each function; after the last sample comes the first.
"""
from __future__ import annotations

from collections.abc import Sequence

from fourbar_ros.numerics.arrays import Array
import numpy as np

# Weights of f(x + k h) - f(x - k h), k from 1, in h times the slope of f: orders twelve and four.
FINE = (6.0 / 7.0, -15.0 / 56.0, 5.0 / 63.0, -1.0 / 56.0, 1.0 / 385.0, -1.0 / 5544.0)
PLAIN = (2.0 / 3.0, -1.0 / 12.0)
# Weights of the neighbours at half a step on either side, of the next ones, ..., in the value
# between them.
BETWEEN = tuple([part / 2.0**19 for part in (320166, -76230, 22869, -5445, 847, -63)])
# Between every other sample and what the others say there, over the span: what is resolved.
RESOLVED = 2.0**-9
# Samples around an interval through which a polynomial is laid; its steps of Newton's method.
AROUND, STEPS = 12, 2


def _wrapped(f: Array, width: int) -> Array:
    return np.concatenate((f[-width:], f, f[:width]))


def slopes_of(f: Array, weights: Sequence[float] = FINE) -> Array:
    """Return the slopes at the samples, times the step."""
    width, count = len(weights), len(f)
    wrapped, found, part = _wrapped(f, width), np.zeros(f.shape), np.empty(f.shape)
    for k, weight in enumerate(weights, 1):
        np.subtract(wrapped[width + k:width + k + count], wrapped[width - k:width - k + count],
                    out=part)
        part *= weight
        found += part
    return found


def is_coarse(f: Array, span: Array) -> Array:
    """Return whether every other sample does not follow from the others beside it, (m,)."""
    width, count = len(BETWEEN), len(f) // 2
    even, error, part = _wrapped(f[::2], width), f[1::2].copy(), np.empty((count, *f.shape[1:]))
    for k, weight in enumerate(BETWEEN):
        np.add(even[width - k:width - k + count], even[width + 1 + k:width + 1 + k + count],
               out=part)
        part *= weight
        error -= part
    far: Array = np.maximum(error.max(axis=0), -error.min(axis=0)) > RESOLVED * span
    return far


def roots_between(f: Array, i: Array, column: Array, guess: Array) -> tuple[Array, Array]:
    """
    Return where functions have roots, in steps after sample ``i``, and their slopes there.

    By Newton's method on the polynomials through the nearest samples.

    Parameters
    ----------
    f : ndarray, shape (samples, m)
    i, column : ndarray of int, shape (roots,)
        The sample before the root, and of which function.
    guess : ndarray, shape (roots,)
        From 0 to 1.

    """
    middle = AROUND // 2 - 1
    near = (np.arange(AROUND)[:, None] - middle + i) % len(f)
    table = f.ravel().take(near * f.shape[1] + column)
    falling = [table[0]]        # Newton's differences, over factorials
    for k in range(1, AROUND):
        table = table[1:] - table[:-1]
        table *= 1.0 / k
        falling.append(table[0])
    t = guess + middle
    slope = np.zeros(t.shape)
    for _ in range(STEPS):
        value, slope = falling[-1], np.zeros(t.shape)
        for k in range(AROUND - 2, -1, -1):
            at = t - k
            slope = slope * at + value
            value = value * at + falling[k]
        with np.errstate(all='ignore'):
            t = t - value / slope
    return t - middle, slope
