# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Numbers of many digits, and Laurent series of one variable t > 0, t -> 0: 0/0 is a quotient.

At the flat position of an exact change point all that moves is a quotient of numbers that vanish
there. Put into the formulas of motion and loads, series leave no doubt about the limit: common
powers of t cancel, a root of t^2 is t, and the sign of a number is that of its first term.
Coefficients have :data:`DIGITS` decimal digits; one that is negligible next to the terms of its
sum is exactly zero. So the data of a mechanism, taken to the last bit, decide which coefficients
vanish. A series of one term is a number: with it a formula has its one exact result where floats
lose all digits, in a thousand times the time of floats.
"""
from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from decimal import Context, Decimal, localcontext
import math
from typing import Union

from fourbar_ros.numerics.number_types import choose, NumberType, power_of_two

DIGITS = 80
TERMS = 20                        # kept of a series that does not end
NOTHING = Decimal('1e-50')        # of the terms of a sum: what is left then is zero
_CONTEXT = Context(prec=DIGITS, Emax=10**9, Emin=-10**9)
# pi/2, three digits short: its small multiples are exact
_QUARTER = Decimal('1.5707963267948966192313216916397514420985846996875529104874722961539082031')


@contextmanager
def many_digits() -> Iterator[None]:
    """Calculate with :data:`DIGITS` digits, in this thread."""
    with localcontext(_CONTEXT):
        yield


def _sum(terms: list[Decimal]) -> Decimal:
    """Return a sum, exactly zero if less than 1e-50 of its terms is left: that is rounding."""
    total = sum(terms, Decimal(0))
    return total if abs(total) > NOTHING * sum(map(abs, terms), Decimal(0)) else Decimal(0)


Operand = Union['Laurent', Decimal, float]


class Laurent:
    """
    The series t^order (c[0] + c[1] t + ...), c[0] not zero, known up to, without, t^end.

    ``end`` is infinite if it has no more terms; c is empty if none is known, or there is none:
    zero.
    Comparisons are those of the values for t -> 0. To be used within :func:`many_digits`.
    """

    __slots__ = ('order', 'c', 'end')

    def __init__(self, c: list[Decimal], order: int = 0, end: float = math.inf):
        """Keep 20 terms from the first that is not zero; drop zeros at the end."""
        first = next((i for i, v in enumerate(c) if v), len(c))
        c, self.order = c[first:first + TERMS + 1], order + first
        if len(c) > TERMS:
            c, end = c[:TERMS], min(end, self.order + TERMS)
        while c and not c[-1]:
            c.pop()
        if not c:
            self.order = int(end) if end < math.inf else 0
        self.c, self.end = c, end

    def coefficient(self, i: int) -> Decimal:
        """Return the coefficient of t^i."""
        i -= self.order
        return self.c[i] if 0 <= i < len(self.c) else Decimal(0)

    def _is_nothing(self) -> bool:
        return not self.c and self.end == math.inf

    def _unit(self) -> list[Decimal]:
        """Return the known coefficients from c[0] on, zeros among them, at most 20."""
        if not self.c:
            raise ZeroDivisionError
        number = int(min(TERMS, self.end - self.order))
        return self.c + [Decimal(0)] * (number - len(self.c))

    def _end_of_unit(self) -> float:
        return (math.inf if len(self.c) == 1 and self.end == math.inf
                else min(TERMS, self.end - self.order))

    @property
    def real(self) -> Laurent:
        return self

    def _is_number(self) -> bool:
        """Return whether it is a constant and not zero: most operands are."""
        return self.order == 0 and len(self.c) == 1 and self.end == math.inf

    def __add__(self, other: Operand) -> Laurent:
        """Return the sum, term by term, as far as both series are known."""
        other = series(other)
        if self._is_number() and other._is_number():
            return _number(_sum([self.c[0], other.c[0]]))
        end = min(self.end, other.end)
        low = min(self.order, other.order)
        high = max(self.order + len(self.c), other.order + len(other.c))
        return Laurent([_sum([self.coefficient(i), other.coefficient(i)])
                        for i in range(low, int(min(high, end)))], low, end)

    def __neg__(self) -> Laurent:
        """Return minus the series."""
        if self._is_number():
            return _number(-self.c[0])
        return Laurent([-v for v in self.c], self.order, self.end)

    def __sub__(self, other: Operand) -> Laurent:
        return self + -series(other)

    def __rsub__(self, other: Operand) -> Laurent:
        return series(other) + -self

    def __mul__(self, other: Operand) -> Laurent:
        """
        Return the product (Cauchy), as far as the known terms of both determine it.

        The term of t^k sums all c[i] d[j] with i + j = k; (1 + 2 t) (3 + t) = 3 + 7 t + 2 t^2.
        An unknown term of one meets the first term of the other: there the product ends.
        """
        other = series(other)
        if self._is_number() and other._is_number():
            return _number(self.c[0] * other.c[0])
        if self._is_nothing() or other._is_nothing():
            return Laurent([])
        order, end = self.order + other.order, min(self.end + other.order, other.end + self.order)
        number = (int(min(len(self.c) + len(other.c) - 1, end - order, TERMS + 1)) if self.c
                  and other.c else 0)
        one, two = ([(i, v) for i, v in enumerate(s.c) if v] for s in (self, other))
        terms: list[list[Decimal]] = [[] for _ in range(number)]
        for i, a in one:
            for j, b in two:
                if i + j >= number:
                    break
                terms[i + j].append(a * b)
        return Laurent([_sum(row) if row else Decimal(0) for row in terms], order, end)

    def __truediv__(self, other: Operand) -> Laurent:
        return self * series(other)._inverse()

    def __rtruediv__(self, other: Operand) -> Laurent:
        return series(other) * self._inverse()

    __radd__, __rmul__ = __add__, __mul__

    def __pow__(self, exponent: int) -> Laurent:
        return math.prod([self] * exponent, start=series(1.0))

    def _inverse(self) -> Laurent:
        """Return 1/f, coefficient by coefficient: sum c[i] inverse[k - i] = 0 for each k > 0."""
        if self._is_number():
            return _number(1 / self.c[0])
        c = self._unit()
        first, inverse = 1 / c[0], [1 / c[0]]
        if self._end_of_unit() == math.inf:
            return Laurent(inverse, -self.order)
        for k in range(1, len(c)):
            inverse.append(-first * _sum([c[i] * inverse[k - i] for i in range(1, k + 1)]))
        return Laurent(inverse, -self.order, -self.order + self._end_of_unit())

    def sqrt(self) -> Laurent:
        """Return the root, positive for t > 0; ValueError if not real or of an odd power of t."""
        if self._is_number() and self.c[0] > 0:
            return _number(self.c[0].sqrt())
        if not self.c:
            return Laurent([], 0, self.end if self._is_nothing() else self.end // 2)
        if self.c[0] < 0 or self.order % 2:
            raise ValueError('math domain error')
        c, order = self._unit(), self.order // 2
        root = [c[0].sqrt()]
        if self._end_of_unit() == math.inf:
            return Laurent(root, order)
        for k in range(1, len(c)):
            root.append(_sum([c[k], *(-root[i] * root[k - i] for i in range(1, k))])
                        / (2 * root[0]))
        return Laurent(root, order, order + self._end_of_unit())

    def _sine_and_cosine(self) -> tuple[Laurent, Laurent]:
        """
        Return sine and cosine of an angle, exact where it is a multiple of pi/2 at t = 0.

        Of the rest, coefficient by coefficient from s' = c phi' and c' = -s phi'.
        """
        quarters = int((self.coefficient(0) / _QUARTER).to_integral_value())
        rest = self - Laurent([_QUARTER * quarters])
        if self._is_number():
            one, other = map(_number, sine_and_cosine_of(rest.coefficient(0)))
            return _turned(one, other, quarters)
        slope = [rest.coefficient(i + 1) * (i + 1) for i in range(TERMS)]
        first, zero = rest.coefficient(0), Decimal(0)
        sine, cosine = [[value] for value in sine_and_cosine_of(first)]
        for k in range(TERMS):
            growth = sum([slope[i] * cosine[k - i] for i in range(k + 1)], zero) / (k + 1)
            fall = sum([slope[i] * sine[k - i] for i in range(k + 1)], zero) / (k + 1)
            sine, cosine = [*sine, growth], [*cosine, -fall]
        end = min(TERMS, self.end) if any(slope) or self.end < math.inf else math.inf
        one, other = [Laurent(values[:int(min(TERMS, end))], 0, end)
                      for values in (sine, cosine)]
        return _turned(one, other, quarters)

    def sin(self) -> Laurent:
        return self._sine_and_cosine()[0]

    def cos(self) -> Laurent:
        return self._sine_and_cosine()[1]

    def __abs__(self) -> Laurent:
        return -self if self < 0.0 else self

    def __float__(self) -> float:
        return float(self.coefficient(0))

    def __lt__(self, other: Operand) -> bool:
        difference = self - other
        return bool(difference.c) and difference.c[0] < 0

    def __gt__(self, other: Operand) -> bool:
        return series(other) < self

    def __ge__(self, other: Operand) -> bool:
        return not self < other

    def __le__(self, other: Operand) -> bool:
        return not self > other

    def derivative(self) -> Laurent:
        return Laurent([(self.order + i) * v for i, v in enumerate(self.c)], self.order - 1,
                       self.end - 1)

    def integral(self) -> Laurent:
        """Return the integral without a constant, of a series without a term 1/t (not checked)."""
        return Laurent([v / (self.order + i + 1) if v else v for i, v in enumerate(self.c)],
                       self.order + 1, self.end + 1)


def _number(value: Decimal) -> Laurent:
    """Return a constant, as ``Laurent([value])`` in half of the time."""
    number = Laurent.__new__(Laurent)
    number.c, number.order, number.end = [value] if value else [], 0, math.inf
    return number


T = Laurent([Decimal(1)], 1)
FIRST_TERMS = Laurent([Decimal(1)], 1, 6)      # T where only the first terms are wanted


def sine_and_cosine_of(angle: Decimal) -> tuple[Decimal, Decimal]:
    """Return sine and cosine of an angle below one, to all digits, by Taylor's series."""
    sums, term, k = [Decimal(0), Decimal(1)], Decimal(1), 0
    while term:
        k += 1
        term = term * angle / k
        if abs(term) < Decimal(10)**-(DIGITS + 5):
            break
        sums[k % 2 == 0] += -term if k % 4 > 1 else term
    return sums[0], sums[1]


def _turned(sine: Laurent, cosine: Laurent, quarters: int) -> tuple[Laurent, Laurent]:
    """Return sine and cosine of an angle turned by some quarter turns: swaps and signs."""
    for _ in range(quarters % 4):
        sine, cosine = cosine, -sine
    return sine, cosine


class Length:
    """
    The length of a vector of two series.

    No series itself, as it may be nearly zero next to t = 0.
    """

    def __init__(self, x: Laurent, y: Laurent):
        self.x, self.y = x, y


def limit(value: Laurent | Length | float) -> float:
    """Return the value of a series, or of a length, for t -> 0 from above; it may be infinite."""
    if isinstance(value, Length):
        return math.hypot(limit(value.x), limit(value.y))
    value = series(value)
    if not value.c:
        return 0.0 if value.end > 0 else math.nan
    return math.copysign(math.inf, value.c[0]) if value.order < 0 else float(value)


def series(value: Laurent | Decimal | float) -> Laurent:
    """Return a number as a series."""
    return value if isinstance(value, Laurent) else _number(Decimal(value))


def quarter_turns(number: int) -> Laurent:
    """Return a multiple of pi/2 whose sines and cosines are exact."""
    return Laurent([_QUARTER * number])


def _atan2(y: Operand, x: Operand) -> Laurent:
    """
    Return the angle of the vector (x, y) of two series, as a series.

    Its derivative (x y' - y x') / (x^2 + y^2) is integrated; the constant is that of a float, with
    its error removed by an arcsine.
    """
    y, x = series(y), series(x)
    rate = (x * y.derivative() - y * x.derivative()) / (x * x + y * y)
    low = min(s.order for s in (x, y) if s.c)
    sine, cosine = (s.coefficient(low) for s in (y, x))
    near = math.atan2(float(sine) or (-0.0 if y < 0.0 else 0.0), float(cosine))
    # what the float leaves is some 1e-16: three terms of the arcsine
    one, other = (value.coefficient(0) for value in series(near)._sine_and_cosine())
    left = (sine * other - cosine * one) / (sine * sine + cosine * cosine).sqrt()
    square = left * left
    start = Decimal(near) + left * (1 + square / 6 * (1 + square * 9 / 20))
    angle: Laurent = rate.integral() + start
    return angle


def _power_of_two(*lengths: Laurent) -> Laurent:
    """Return the power of two next above the largest of some constants."""
    return series(power_of_two(*map(float, lengths)))


def _sum_of(terms: Iterable[Laurent]) -> Laurent:
    return sum(terms, Laurent([]))


def _hypot(x: Operand, y: Operand) -> Laurent:
    return (series(x)**2 + series(y)**2).sqrt()


# With sin(x/2) a series nothing needs to be added to it.
LAURENT = NumberType('Laurent series', Laurent.sin, Laurent.cos, Laurent.sqrt, _atan2, Length, abs,
                     choose, _sum_of, _power_of_two, infinitesimal=0.0, number=series)
# For series of one term.
MANY_DIGITS = replace(LAURENT, name='many digits', hypot=_hypot)
