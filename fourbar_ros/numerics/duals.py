# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Dual numbers: a value and its exact derivatives by any number of parameters.

A number type made of another one: of arrays for derivatives at many samples, of complex arrays
for second derivatives too (a complex step of the input). The rules are those of the chain rule,

    (D1)  (u v)' = u' v + u v',   (u/v)' = (u' - (u/v) v') / v,   sqrt(u)' = u' / (2 sqrt(u))
    (D2)  atan2(y, x)' = (x y' - y x') / (x^2 + y^2),   hypot(x, y)' = (x x' + y y') / hypot(x, y)

A derivative that is not listed is zero, and costs nothing: masses do not act on a motion.
"""
from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import reduce
from typing import Any, Union

from fourbar_ros.numerics.arrays import Array
from fourbar_ros.numerics.number_types import Function, NumberType, Scalar
import numpy as np

Derivatives = dict[str, Any]
Operand = Union['Dual', Scalar]


class Dual:
    """A number of another type, and its derivatives ``by`` = {parameter: derivative}."""

    __slots__ = ('by', 'value')

    def __init__(self, value: Any, by: Derivatives) -> None:
        self.value, self.by = value, by

    @property
    def real(self) -> Scalar:
        """Return the real part of the value: formulas choose by it."""
        real: Scalar = getattr(self.value, 'real', self.value)
        return real

    def __add__(self, other: Operand) -> Dual:
        """Return the sum; a number without derivatives adds none."""
        if not isinstance(other, Dual):
            return Dual(self.value + other, self.by)
        return Dual(self.value + other.value, _sum(self.by, other.by))

    __radd__ = __add__

    def __neg__(self) -> Dual:
        return Dual(-self.value, {name: -part for name, part in self.by.items()})

    def __sub__(self, other: Operand) -> Dual:
        """Return the difference."""
        if not isinstance(other, Dual):
            return Dual(self.value - other, self.by)
        by = dict(self.by)
        for name, part in other.by.items():
            by[name] = by[name] - part if name in by else -part
        return Dual(self.value - other.value, by)

    def __rsub__(self, other: Scalar) -> Dual:
        return Dual(other - self.value, {name: -part for name, part in self.by.items()})

    def __mul__(self, other: Operand) -> Dual:
        """Return the product, by (D1); a number without derivatives scales."""
        if not isinstance(other, Dual):
            return Dual(self.value * other, _scaled(self.by, other))
        return Dual(self.value * other.value,                                           # (D1)
                    _sum(_scaled(self.by, other.value), _scaled(other.by, self.value)))

    __rmul__ = __mul__

    def __truediv__(self, other: Operand) -> Dual:
        """Return the quotient, by (D1)."""
        if not isinstance(other, Dual):
            return Dual(self.value / other, {name: part / other
                                             for name, part in self.by.items()})
        per = 1.0 / other.value
        return Dual(self.value / other.value,
                    _sum(_scaled(self.by, per), _scaled(other.by, -(self.value * per * per))))

    def __rtruediv__(self, other: Scalar) -> Dual:
        per = 1.0 / self.value
        return Dual(other / self.value, _scaled(self.by, -(other * per * per)))

    def __pow__(self, exponent: int) -> Dual:
        return Dual(self.value**exponent,
                    _scaled(self.by, exponent * self.value**(exponent - 1)))

    def __gt__(self, other: Operand) -> bool:
        is_greater: bool = self.value > value_of(other)
        return is_greater

    def __lt__(self, other: Operand) -> bool:
        is_less: bool = self.value < value_of(other)
        return is_less

    def sqrt(self) -> Dual:
        """Return the root, as ``numpy.sqrt`` asks for it."""
        return _root(self, np.sqrt)

    def __array_ufunc__(self, function: Any, method: str, *given: Any, **more: Any) -> Any:
        """Return array + dual, np.sqrt(dual) and the like, which numpy asks for by this method."""
        operation = _OF_ARRAYS.get(function)
        if method != '__call__' or more or operation is None:
            return NotImplemented
        return operation(*given)


def value_of(number: Operand) -> Any:
    """Return the value of a dual, and any other number as it is."""
    return number.value if isinstance(number, Dual) else number


def derivatives_of(number: Operand) -> Derivatives:
    """Return {parameter: derivative} of a dual, nothing of any other number."""
    return number.by if isinstance(number, Dual) else {}


def _sum(one: Derivatives, other: Derivatives) -> Derivatives:
    """Return the sums by parameter; {a: 1, b: 2} and {b: 3} give {a: 1, b: 5}."""
    by = dict(one)
    for name, part in other.items():
        by[name] = by[name] + part if name in by else part
    return by


def _scaled(by: Derivatives, factor: Scalar) -> Derivatives:
    return {name: factor * part for name, part in by.items()}


def _root(number: Dual, sqrt: Function) -> Dual:
    return Dual(sqrt(number.value), _scaled(number.by, 0.5 / sqrt(number.value)))


# What arrays ask of a dual on their right, and numpy's functions of one.
_OF_ARRAYS: dict[Any, Callable[..., Any]] = {
    np.add: lambda a, b: b + a if isinstance(b, Dual) else a + b,
    np.subtract: lambda a, b: b.__rsub__(a) if not isinstance(a, Dual) else a - b,
    np.multiply: lambda a, b: b * a if isinstance(b, Dual) else a * b,
    np.true_divide: lambda a, b: b.__rtruediv__(a) if not isinstance(a, Dual) else a / b,
    np.greater: lambda a, b: value_of(a) > value_of(b),
    np.less: lambda a, b: value_of(a) < value_of(b),
    np.sqrt: Dual.sqrt,
}


def _where_of(choose: Function) -> Function:
    """Return ``where`` of duals, from that of their values, ``choose``."""
    def where(condition: bool | Array, one: Any, other: Any) -> Any:
        """Return one of two duals, or of each pair in two tuples, with its derivatives."""
        if isinstance(one, tuple):
            return tuple([where(condition, a, b) for a, b in zip(one, other)])
        if not (isinstance(one, Dual) or isinstance(other, Dual)):
            return choose(condition, one, other)
        by, others = derivatives_of(one), derivatives_of(other)
        return Dual(choose(condition, value_of(one), value_of(other)),
                    {name: choose(condition, by.get(name, 0.0), others.get(name, 0.0))
                     for name in by.keys() | others.keys()})
    return where


def duals_of(numbers: NumberType) -> NumberType:
    """
    Return the type of duals whose values and derivatives are of a type of numbers.

    Its functions (sin, atan2 ...) take duals and plain ``numbers`` alike: of a dual they return
    value and derivatives, by the chain rule.
    """
    def of_one(function: Function, derivative: Callable[[Scalar], Scalar]) -> Function:
        """Return f for duals, of f and f' for numbers, as sin and cos: (f(u))' = f'(u) u'."""
        def call(number: Operand) -> Operand:
            """Return f(u); of a plain number, a plain number."""
            value = function(value_of(number))
            return (Dual(value, _scaled(number.by, derivative(number.value)))
                    if isinstance(number, Dual) else value)
        return call

    def atan2(y: Operand, x: Operand) -> Dual:
        """Return the angle of (x, y), by (D2)."""
        of_y, of_x = value_of(y), value_of(x)
        per = 1.0 / (of_x * of_x + of_y * of_y)
        return Dual(numbers.atan2(of_y, of_x),
                    _sum(_scaled(derivatives_of(y), of_x * per),
                         _scaled(derivatives_of(x), -(of_y * per))))

    def hypot(x: Operand, y: Operand) -> Dual:
        """Return sqrt(x^2 + y^2), by (D2)."""
        per = 1.0 / numbers.hypot(value_of(x), value_of(y))
        return Dual(numbers.hypot(value_of(x), value_of(y)),
                    _sum(_scaled(derivatives_of(x), value_of(x) * per),
                         _scaled(derivatives_of(y), value_of(y) * per)))

    def fabs(number: Operand) -> Operand:
        """Return |x|, its derivatives those of x or -x; of a plain number, a plain number."""
        size: Scalar = numbers.fabs(value_of(number))
        if not isinstance(number, Dual):
            return size
        return Dual(size, _scaled(number.by, numbers.where(number.real < 0.0, -1.0, 1.0)))

    def exact_sum(terms: Sequence[Operand]) -> Dual:
        """Return the sum of duals and numbers, its value rounded once, not after each term."""
        by: Derivatives = reduce(_sum, map(derivatives_of, terms), {})
        return Dual(numbers.exact_sum([value_of(term) for term in terms]), by)

    where = _where_of(numbers.where)
    return NumberType(f'duals of {numbers.name}', of_one(numbers.sin, numbers.cos),
                      of_one(numbers.cos, lambda value: -numbers.sin(value)),
                      lambda x: (_root(x, numbers.sqrt) if isinstance(x, Dual)
                                 else numbers.sqrt(x)),
                      atan2, hypot, fabs, where, exact_sum,
                      lambda *lengths: numbers.power_of_two(*map(value_of, lengths)))    # a unit
