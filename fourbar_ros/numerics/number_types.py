# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
One formula, several number types.

Formulas are written once. They take every function they use from ``n``, a :class:`NumberType`,
and contain no ``if``: a choice between two forms of a formula is ``n.where(condition, if_true,
if_false)``. A condition compares real parts, ``x.real > 0.0``, which floats, arrays and complex
numbers all have.

=========================  ==================================================================
``REAL``                   floats: one sample takes microseconds where numpy would take thirty
``ARRAY``                  numpy arrays, real, or complex for exact derivatives by a complex step
``RECORDED``               writes down what is done: :mod:`fourbar_ros.numerics.trace`
=========================  ==================================================================
"""
from collections.abc import Callable, Sequence
from copy import copy
from dataclasses import dataclass, fields, is_dataclass
from functools import cache, reduce
import math
from typing import Any, TypeVar

from fourbar_ros.numerics.arrays import Array, EPS, Values
import numpy as np

Function = Callable[..., Any]
# A number of any type in a formula. Type checkers take it for a float: a formula uses nothing of
# its numbers that floats do not have.
Scalar = float
Operation = Callable[..., Scalar]        # of the functions of a number type

_Choice = TypeVar('_Choice')

# Lengths are exact data: a sum of some of them, however small beside them, is rounded once, and a
# difference of squares is the product of two such sums. Near change points and toggles all other
# digits would be lost. In decimals they are not exact, 0.1 + 0.5 - 0.2 - 0.4 is 2.8e-17: a sum
# below this part of their sizes is zero, so that a change point is one in every unit.
SNAP = 4.0 * EPS
# No other product of sums of lengths of about one is below it.
NOTHING = 2.0**-500
# Added to a size before a division by it: only a size of zero is changed by it, to infinity.
TINY = 2.0**-1074


@dataclass(frozen=True, eq=False)
class NumberType:
    """The functions that formulas may use, for one type of number."""

    sin: Operation      # these as in math
    cos: Operation
    sqrt: Operation
    atan2: Operation
    hypot: Operation
    fabs: Operation
    # where(condition, if_true, if_false); both may be tuples of equal length, and both are
    # computed, whatever the condition: neither may divide by zero
    where: Function
    exact_sum: Operation        # of a tuple of lengths, see exact_sum()
    power_of_two: Operation     # next above the largest of some lengths: scaling rounds nothing
    # call(function, x): a function that is no formula, as a table, of a float or an array
    call: Function = lambda function, x: function(x)

    def difference_of_squares(self, a: Scalar, b: Scalar, c: Scalar, d: Scalar) -> Scalar:
        """Return (a + b)^2 - (c + d)^2, a product of exact sums: it keeps digits near zero."""
        return self.exact_sum((a, b, c, d)) * self.exact_sum((a, b, -c, -d))


def choose(condition: bool, if_true: _Choice, if_false: _Choice) -> _Choice:
    return if_true if condition else if_false


def is_zero(n: NumberType, value: Scalar) -> bool:
    """Return whether a number that data alone make is 0.0, as its complex step may not be."""
    return n.fabs(value).real < NOTHING


def exact_sum(terms: Sequence[float]) -> float:
    """Return the correctly rounded sum of lengths, 0.0 below SNAP of their sizes."""
    total = math.fsum(terms)
    return 0.0 if abs(total) <= SNAP * sum(map(abs, terms)) else total


def exact_sum_of_four(terms: Sequence[Array]) -> Array:
    """Return :func:`exact_sum` of two to four arrays, zero below SNAP: roundings come last."""
    a, b, c, d = list(terms) + [np.zeros(1)] * (4 - len(terms))
    (first, e1), (second, e2) = _two_sum(a, b), _two_sum(c, d)
    total, e3 = _two_sum(first, second)
    total = np.asarray(total + (e3 + (e1 + e2)))
    is_nothing = abs(total.real) <= SNAP * sum([abs(term.real) for term in terms])
    if not is_nothing.any():
        return total
    # the imaginary part is a complex step, which stays
    return np.where(is_nothing, 1j * total.imag if np.iscomplexobj(total) else 0.0, total)


def _two_sum(a: Array, b: Array) -> tuple[Array, Array]:
    """Return the rounded sum of two arrays and its rounding error, which is exact (Knuth)."""
    total = a + b
    added = total - a
    return total, (a - (total - added)) + (b - added)


def power_of_two(*lengths: float) -> float:
    """Return the power of two next above the sizes of all lengths: 4.0 of (2.5, -1.0)."""
    return math.ldexp(1.0, math.frexp(max(map(abs, lengths)))[1])


def scaled(lengths: Sequence[float]) -> list[float]:
    """Return lengths times the power of two that makes the largest about one, exactly."""
    unit = power_of_two(*lengths)
    return [length / unit for length in lengths]


def direction(angle: float) -> tuple[float, float]:
    """Return cosine and sine of an angle, exact at right angles."""
    quarters = angle / (0.5 * math.pi)
    if quarters == round(quarters) and abs(quarters) < 2**20:
        return ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))[round(quarters) % 4]
    return math.cos(angle), math.sin(angle)


def direction_in(n: NumberType, angle: Scalar) -> tuple[Scalar, Scalar]:
    """Return the :func:`direction` of an angle that is a float or of the number type ``n``."""
    return direction(angle) if isinstance(angle, float) else (n.cos(angle), n.sin(angle))


def _choose_in_arrays(condition: bool | Array, if_true: Any, if_false: Any) -> Any:
    if isinstance(condition, (bool, np.bool_)):
        return if_true if condition else if_false
    if isinstance(if_true, tuple):
        return tuple([np.where(condition, a, b) for a, b in zip(if_true, if_false)])
    return np.where(condition, if_true, if_false)


def hypot_of_arrays(x: Values, y: Values, out: Array | None = None) -> Array:
    """Return sqrt(x^2 + y^2) of arrays, written to ``out`` if given."""
    # By the formula, and by the slower np.hypot only where a square may overflow or underflow.
    length = np.asarray(np.sqrt(x * x + y * y, out=out))
    if length.size and length.min() > 1e-140 and length.max() < 1e150:
        return length
    # each sample by itself, so that none depends on those beside it
    np.hypot(x, y, out=length, where=~((length > 1e-140) & (length < 1e150)))
    return length


def size_of_complex(x: Any) -> Any:
    """Return x or -x, whichever has a positive real part: |x|, with its complex step if any."""
    if isinstance(x, float):
        return abs(x)
    return np.where(x.real < 0.0, -x, x) if np.iscomplexobj(x) else np.abs(x)


def angle_of_complex(y: Any, x: Any) -> Any:
    """Return the angle of (x, y), with its complex step if any."""
    if not np.iscomplexobj(x) and not np.iscomplexobj(y):
        return np.arctan2(y, x)
    turn = 1j * (x.real * y.imag - y.real * x.imag) / (x.real**2 + y.real**2)
    return np.arctan2(y.real, x.real) + turn


def hypot_of_complex(x: Any, y: Any) -> Any:
    return (np.sqrt(x * x + y * y) if np.iscomplexobj(x) or np.iscomplexobj(y)
            else hypot_of_arrays(x, y))


REAL = NumberType(math.sin, math.cos, math.sqrt, math.atan2, math.hypot, math.fabs,
                  choose, exact_sum, power_of_two)
ARRAY = NumberType(np.sin, np.cos, np.sqrt, angle_of_complex, hypot_of_complex,
                   size_of_complex, _choose_in_arrays, exact_sum, power_of_two)


def power_of_two_of_arrays(*lengths: Array) -> Array:
    return np.asarray(np.ldexp(1.0, np.frexp(reduce(np.maximum, map(np.abs, lengths)))[1]))


def converted(record: Any, convert: Callable[[Any], Any]) -> Any:
    """Return a nested record with ``convert(value)`` for each number."""
    # Dataclasses are copied without their checks, as other numbers than floats would not pass
    # them. Names, truths and functions, as a table of forces, stay.
    if isinstance(record, (tuple, list)):
        values = [converted(value, convert) for value in record]
        return record._make(values) if hasattr(record, '_make') else tuple(values)
    if record is None or isinstance(record, (str, bool)) or callable(record):
        return record
    if not is_dataclass(record):
        return convert(record)
    copied = copy(record)
    for field in fields(record):
        object.__setattr__(copied, field.name, converted(getattr(record, field.name), convert))
    return copied


def numbers_of(record: Any) -> list[float]:
    """Return the numbers of a nested record in the order in which :func:`converted` meets them."""
    values, left = list[float](), [record]
    while left:
        piece = left.pop()
        kind: Any = type(piece)
        if kind is float:       # most are
            values.append(piece)
        elif isinstance(piece, tuple):
            left += reversed(piece)
        elif names := _names_of(kind):
            left += [getattr(piece, name) for name in reversed(names)]
        elif not (piece is None or isinstance(piece, (str, bool)) or callable(piece)):
            values.append(piece)
    return values


@cache
def _names_of(kind: type[Any]) -> tuple[str, ...]:
    is_record = is_dataclass(kind) and not any('__call__' in vars(base) for base in kind.__mro__)
    return tuple([field.name for field in fields(kind)]) if is_record else ()
