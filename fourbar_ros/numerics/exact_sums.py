# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Sums and differences of lengths that keep their digits where they cancel.

Lengths are exact data. A sum of some of them, however small beside them, is here rounded once, and
a difference of squares is taken as the product of two such sums: near change points and toggles
all other digits would be lost.

Lengths in decimals are not exact: 0.1 + 0.5 - 0.2 - 0.4 is 2.8e-17. A sum that is no larger than
the roundings of its terms is therefore zero, so that a change point is one in every unit.
"""
from __future__ import annotations

from collections.abc import Sequence
from math import frexp, ldexp

from fourbar_ros.numerics.arrays import Array
from fourbar_ros.numerics.number_types import exact_sum, Function, Scalar, SNAP
import numpy as np


def difference_of_squares(a: Scalar, b: Scalar, c: Scalar, d: Scalar,
                          exact_sum: Function = exact_sum) -> Scalar:
    """Return (a + b)^2 - (c + d)^2 as the product of two exact sums: it keeps digits near zero."""
    product: Scalar = exact_sum((a, b, c, d)) * exact_sum((a, b, -c, -d))
    return product


def scaled(lengths: Sequence[float]) -> list[float]:
    """Return lengths times the power of two that makes the largest about one, exactly."""
    exponent = frexp(max(map(abs, lengths)))[1]
    return [ldexp(length, -exponent) for length in lengths]


def exact_sum_of_four(terms: Sequence[Array]) -> Array:
    """Return :func:`exact_sum` of up to four arrays: roundings are added last."""
    a, b, c, d = list(terms) + [np.zeros(1)] * (4 - len(terms))
    (first, e1), (second, e2) = _two_sum(a, b), _two_sum(c, d)
    total, e3 = _two_sum(first, second)
    total = np.asarray(total + (e3 + (e1 + e2)))
    is_nothing = abs(total.real) <= SNAP * sum([abs(term.real) for term in terms])
    if not is_nothing.any():
        return total
    # a complex step stays
    return np.where(is_nothing, 1j * total.imag if np.iscomplexobj(total) else 0.0, total)


def _two_sum(a: Array, b: Array) -> tuple[Array, Array]:
    """Return the rounded sum of two arrays and its rounding error, which is exact (Knuth)."""
    total = a + b
    part = total - a
    return total, (a - (total - part)) + (b - part)
