# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Arguments of callers, as doubles.

Every public function converts or refuses here, with the name and what is allowed.
"""
from collections.abc import Iterable, Iterator
from dataclasses import field, fields, MISSING
from math import inf, isfinite
from numbers import Real
from typing import Any, NamedTuple

from fourbar_ros.errors import InvalidParameter
from fourbar_ros.numerics.arrays import Array
import numpy as np

FASTEST = 1e100     # rates of an input are at most so large, in its unit over s
FARTHEST = 2.0**54  # [rad] angles of an input are smaller: floats there are 4 rad apart
NOT_SO_FAR = f'must be less than {FARTHEST:.3g} rad in size: floats there are 4 rad apart'


def finite(name: str, value: Any, allowed: str = 'must be a finite number', least: float = -inf,
           above: float = -inf) -> float:
    """Return a finite number as a float, if it is at least ``least`` and more than ``above``."""
    # Integers, fractions, numpy's numbers and arrays without dimensions are numbers; truth values,
    # texts, times, complex numbers and None are not. Otherwise raises InvalidParameter with the
    # name and allowed, the rule in words.
    if type(value) is float and isfinite(value) and value >= least and value > above:
        return value                       # as most are; asking what else it may be takes longer
    is_masked: Any = np.ma.is_masked       # numpy gives it no types
    if isinstance(value, np.ndarray) and value.shape == () and not is_masked(value):
        value = value.item()
    if not _is_number(value):
        raise InvalidParameter(name, value, f'{allowed}, not {_kind_of(value)}')
    try:
        result = float(value)
    except OverflowError:
        result = inf
    if not (isfinite(result) and result >= least and result > above):
        raise InvalidParameter(name, value, allowed)
    return result


def rate_of_input(name: str, value: Any) -> float:
    """Return a rate as a float, so small that its square, times masses, does not overflow."""
    rate = finite(name, value)
    if abs(rate) > FASTEST:
        raise InvalidParameter(name, value, f'must be at most {FASTEST:g} in size, or its square '
                                            'may overflow')
    return rate


def array(name: str, value: Any, with_complex: bool = False) -> Array:
    """Return real numbers as an array of doubles, masked ones as NaN, or InvalidParameter."""
    # with_complex: complex ones, of a complex step, as complex doubles.
    if isinstance(value, np.ma.MaskedArray):
        masked: Any = value
        if value.dtype.kind in 'iuf':       # whole numbers have no NaN
            masked = masked.astype(float)
        value = masked.filled(np.nan) if value.dtype.kind in 'iufcO' else masked.data
    try:
        values = np.asarray(value)
    except ValueError:     # rows of unlike length
        raise InvalidParameter(name, value, 'must be numbers in rows of equal length') from None
    if values.dtype.kind == 'c' and with_complex:
        return values.astype(np.complex128, copy=False)
    if values.dtype.kind not in 'iuf' and values.size:
        wrong = ([_kind_of(values.flat[0])] if values.dtype.kind != 'O' else
                 [_kind_of(item) for item in values.flat if not _is_number(item)])
        if wrong:
            raise InvalidParameter(name, value, f'must be real numbers, not {wrong[0]}')
    try:
        return values.astype(np.float64, copy=False)
    except OverflowError:
        raise InvalidParameter(name, value, 'must be numbers that a float can hold') from None


def _is_number(value: Any) -> bool:
    return isinstance(value, Real) and not isinstance(value, bool)


def _kind_of(value: Any) -> str:
    if isinstance(value, str):
        return f'a text; fourbar_ros.scene.quantity({value[:20]!r}, unit) reads numbers with units'
    return 'None' if value is None else f'of type {type(value).__name__}'


def records(name: str, value: Any, kind: type, whole: Any) -> Any:
    """Return records of one kind, as bodies, as a ``whole``: a NamedTuple of as many fields."""
    # Raises InvalidParameter if their number or kind is another one.
    items = tuple(value) if isinstance(value, Iterable) else ()
    if len(items) != len(whole._fields) or not all(isinstance(item, kind) for item in items):
        raise InvalidParameter(name, value,
                               f'must be {whole.__name__}({", ".join(whole._fields)}), each of '
                               f'type {kind.__name__}')
    return whole(*items)


class NumberField(NamedTuple):
    """A number in a frozen dataclass: its meaning and allowed values."""

    # least and above: it must be at least, and more than that. instead: a value that counts as no
    # number, as None. parameter: its name in scenes, if another one.
    unit: str = ''
    text: str = ''
    least: float = -inf
    above: float = -inf
    is_not_zero: bool = False
    is_whole: bool = False
    instead: Any = MISSING
    parameter: str = ''

    def check(self, name: str, value: Any) -> Any:
        """Return a value as a float, a whole number as an int; raises InvalidParameter."""
        if self.instead is not MISSING and (value is None or isinstance(value, Real)) and (
                value == self.instead):
            return value
        allowed = 'must be a finite number'
        if self.above == 0.0:
            allowed = 'must be a positive number'
        elif self.least > -inf:
            allowed += f', {"zero" if self.least == 0.0 else f"{self.least:g}"} or more'
        result = finite(name, value, allowed, self.least, self.above)
        if self.is_not_zero and result == 0.0:
            raise InvalidParameter(name, result, 'must not be zero')
        if self.is_whole and result != int(result):
            raise InvalidParameter(name, value, 'must be a whole number')
        return int(result) if self.is_whole else result


def quantity(default: Any = MISSING, **properties: Any) -> Any:
    return field(default=default, metadata={NumberField: NumberField(**properties)})


def quantities_of(record: Any) -> Iterator[tuple[str, Any, NumberField]]:
    """Yield (name, default, Quantity) of each quantity of a dataclass or one of its records."""
    for item in fields(record):
        if NumberField in item.metadata:
            yield item.name, item.default, item.metadata[NumberField]


def check_quantities(record: Any) -> None:
    for name, _, quantity_field in quantities_of(record):
        object.__setattr__(record, name, quantity_field.check(name, getattr(record, name)))
