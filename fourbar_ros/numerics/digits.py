# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Numbers of many digits: a trace with decimals, where floats lose all theirs.

At the flat position of an exact change point all that moves is a quotient of numbers that vanish
there. A little beside it such numbers are small, and with :data:`DIGITS` digits their quotients
keep enough. A sum of which nothing is left but its rounding is exactly zero: so the data of a
mechanism, taken to the last bit, decide what vanishes.
"""
from collections.abc import Callable, Sequence
from decimal import Context, Decimal, localcontext
from functools import cache, lru_cache
import math
import operator

from fourbar_ros.numerics.number_types import choose, power_of_two, SNAP
from fourbar_ros.numerics.tables import run, Table
from fourbar_ros.numerics.trace import Trace

DIGITS = 160
NOTHING = 100          # a sum so many digits smaller than its terms is zero
MANY_DIGITS = Context(prec=DIGITS, Emax=10**9, Emin=-10**9)


@cache
def quarter_turn() -> Decimal:
    """Return pi/2, three digits short, so that its small multiples are exact (Machin)."""
    with localcontext(MANY_DIGITS) as context:
        context.prec += 10
        return (8 * _arctangent(5) - 2 * _arctangent(239)).quantize(Decimal(10)**(4 - DIGITS))


def _arctangent(n: int) -> Decimal:
    terms = range(1, int(DIGITS / math.log10(n)) + 20, 2)
    return sum([(2 - k % 4) / (Decimal(k) * n**k) for k in terms], Decimal(0))


def is_nothing(total: Decimal, *terms: Decimal) -> bool:
    """Return whether nothing but rounding is left in a sum of some terms."""
    return not total or total.adjusted() < max(v.adjusted() for v in terms if v) - NOTHING


def _sum(*terms: Decimal) -> Decimal:
    total = sum(terms, Decimal(0))
    return Decimal(0) if is_nothing(total, *terms) else total


@lru_cache(maxsize=2)
def sine_and_cosine(angle: Decimal) -> tuple[Decimal, Decimal]:
    """Return both, exact at multiples of a quarter turn, by Taylor's series."""
    quarters = int((angle / quarter_turn()).to_integral_value())
    angle -= quarter_turn() * quarters
    sums, term, k = [Decimal(0), Decimal(1)], Decimal(1), 0
    least = Decimal(10)**-(DIGITS + 5) * abs(angle)
    while abs(term) > least:
        k += 1
        term = term * angle / k
        sums[k % 2 == 0] += -term if k % 4 > 1 else term
    sine, cosine = sums
    for _ in range(quarters % 4):
        sine, cosine = cosine, -sine
    return sine, cosine


def _root(value: Decimal) -> Decimal:
    if value < 0:
        raise ValueError('math domain error')
    return value.sqrt()


def _exact_sum(*terms: Decimal) -> Decimal:
    total = sum(terms, Decimal(0))
    return Decimal(0) if abs(total) <= Decimal(SNAP) * sum(map(abs, terms)) else total


# Angles are results alone, so floats of exact components are enough.
DECIMALS: Table = {
    'add': _sum, 'sub': lambda a, b: _sum(a, -b), 'mul': operator.mul,
    'truediv': operator.truediv, 'neg': operator.neg, 'pow': lambda a, b: a**int(b),
    'gt': operator.gt, 'lt': operator.lt, 'where': choose, 'fabs': abs, 'exact_sum': _exact_sum,
    'sin': lambda a: sine_and_cosine(a)[0], 'cos': lambda a: sine_and_cosine(a)[1],
    'sqrt': _root, 'hypot': lambda x, y: (x * x + y * y).sqrt(),
    'atan2': lambda y, x: Decimal(math.atan2(y + 0, x)),        # 0, not -0
    'power_of_two': lambda *lengths: Decimal(power_of_two(*map(float, lengths)))}


def in_decimals(trace: Trace, data: Sequence[float], indices: Sequence[int]
                ) -> Callable[..., list[Decimal]]:
    """Return the function inputs -> numbers at some indices of a trace, all of them decimals."""
    # To be made and called within the context MANY_DIGITS.
    order = [i for i in trace.needed(indices) if not trace.steps[i].is_given]
    known = [None if value is None else Decimal(value) for value in trace.numbers(data)]
    run(trace, [i for i in order if i not in trace.varies], DECIMALS, known)
    order = [i for i in order if i in trace.varies]

    def numbers(*inputs: Decimal) -> list[Decimal]:
        values = run(trace, order, DECIMALS, [*inputs, *known[trace.count:]])
        return [values[i] for i in indices]
    return numbers
