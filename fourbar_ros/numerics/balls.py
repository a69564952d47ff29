# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The arithmetic of balls by the optional package python-flint (Arb): series for proofs."""
from collections.abc import Iterator
from contextlib import contextmanager
import operator
from threading import RLock
from typing import Any

from fourbar_ros.numerics.number_types import Function, SNAP

# Precision and the number of terms of series are the same for all threads.
_SETTINGS = RLock()


@contextmanager
def arb_settings(bits: int, terms: int) -> Iterator[None]:
    """Compute with balls of so many bits, and series of so many terms; other threads wait."""
    from flint import ctx

    with _SETTINGS:
        before = ctx.prec, ctx.cap
        ctx.prec, ctx.cap = bits, terms
        try:
            yield
        finally:
            ctx.prec, ctx.cap = before


def taylor_pairs() -> dict[str, Function]:
    """Return the table of pairs of ``flint.arb_series``: a Taylor series, one over a piece."""
    # The first is about the middle of a piece of the input; coefficient k of the second holds
    # f^(k)/k! on all of the piece, so its last one is Lagrange's bound of what the first leaves
    # out. Constants are pairs of balls. A comparison gives whether it holds in the middle, by
    # which formulas choose between forms that are both right, and whether it does on all of the
    # piece.
    from flint import arb, arb_series

    nan = arb.nan()

    def first(v: Any) -> Any:           # the value
        return v[0] if isinstance(v, arb_series) else v

    def of_one(function: Function) -> Function:
        return lambda a: (function(a[0]), function(a[1]))

    def of_two(function: Function) -> Function:
        return lambda a, b: (function(a[0], b[0]), function(a[1], b[1]))

    def power(base: Any, exponent: Any) -> Any:
        whole = exponent.unique_fmpz()
        return base**exponent if whole is None else base**int(whole)

    def angle(y: Any, x: Any) -> Any:
        """Return the angle of (x, y): that in the middle, and the rest by an arc tangent."""
        if not isinstance(x, arb_series) and not isinstance(y, arb_series):
            return arb.atan2(y, x)
        turn = arb.atan2(first(y).mid(), first(x).mid())
        cosine, sine = turn.cos(), turn.sin()
        along, across = x * cosine + y * sine, y * cosine - x * sine
        return turn + (across / along).atan() if first(along) > 0 else nan * x

    def is_greater(a: Any, b: Any) -> tuple[bool, bool]:
        """Return whether a > b in the middle, and whether the same holds on all of the piece."""
        low, high = first(a[1]), first(b[1])
        return first(a[0]).mid() > first(b[0]).mid(), bool(low > high or low <= high)

    def size(v: Any) -> Any:
        return v if first(v[0]).mid() >= 0 else (-v[0], -v[1])

    def exact(terms: Any) -> Any:
        total, size = sum(terms, arb(0)), sum(map(abs, terms), arb(0))
        return arb(0) if abs(total.mid()) <= SNAP * size.mid() else total

    return {'add': of_two(operator.add), 'sub': of_two(operator.sub),
            'mul': of_two(operator.mul), 'truediv': of_two(operator.truediv),
            'neg': of_one(operator.neg), 'pow': of_two(power),
            'sin': of_one(lambda v: v.sin()), 'cos': of_one(lambda v: v.cos()),
            'sqrt': of_one(lambda v: v.sqrt()), 'atan2': of_two(angle), 'fabs': size,
            'hypot': of_two(lambda x, y: (x * x + y * y).sqrt()),
            'exact_sum': lambda *terms: tuple(map(exact, zip(*terms))),
            'where': lambda condition, if_true, if_false: if_true if condition[0] else if_false,
            'gt': is_greater, 'lt': lambda a, b: is_greater(b, a),
            'power_of_two': lambda *lengths: (arb(1), arb(1))}     # balls need no scaling
