# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Enclosures: Taylor series of balls, a number type in which a result is certain.

A thin cover of ``flint.arb_series`` of the optional package python-flint (Arb): each coefficient
is a ball that contains the true one. Constants are balls, ``flint.arb``, made from floats without
rounding.
"""
from __future__ import annotations

from collections.abc import Callable
from typing import Any

from fourbar_ros.numerics.number_types import choose, INFINITESIMAL, NumberType


class Series:
    """
    Enclosure of the Taylor coefficients of a quantity over a piece of the input range.

    numpy functions like ``np.sqrt`` find its methods.
    """

    __slots__ = ('series',)

    def __init__(self, series: Any):
        self.series = series

    @property
    def real(self) -> Any:
        """
        Return the middle of the value.

        To choose between forms of a formula that are both right.
        """
        return self.series[0].mid()

    def sin(self) -> Series:
        """Return its sine."""
        return Series(self.series.sin())

    def cos(self) -> Series:
        """Return its cosine."""
        return Series(self.series.cos())

    def sqrt(self) -> Root:
        """Return its root."""
        return Root(self.series)

    def __neg__(self) -> Series:
        return Series(-self.series)

    def __pow__(self, exponent: int) -> Series:
        return Series(self.series ** exponent)


class Root(Series):
    """
    The root of a series, taken only where it is calculated with.

    It has its extrema where its square has them: also where that is zero and the root has a kink,
    as the magnitude of a force along one line has where the force changes its sense.
    """

    __slots__ = ('square',)

    def __init__(self, square: Any):
        self.square = square

    @property
    def series(self) -> Any:
        """Return the root as a series."""
        return self.square.sqrt()


def _operator(name: str) -> Callable[[Series, Any], Series]:
    def operate(self: Series, other: Any) -> Series:
        return Series(getattr(self.series, name)(getattr(other, 'series', other)))
    return operate


for _name in ('add', 'radd', 'sub', 'rsub', 'mul', 'rmul', 'truediv', 'rtruediv'):
    setattr(Series, f'__{_name}__', _operator(f'__{_name}__'))


def series_of(value: Any) -> Any:
    """Return the ``arb_series`` of a value, which may be a constant."""
    import flint

    return value.series if isinstance(value, Series) else flint.arb_series([value])


def squared_or_plain(value: Any) -> Any:
    """
    Return the series of a value, or of the square of a root.

    With extrema at the same places.
    """
    return value.square if isinstance(value, Root) else series_of(value)


def _atan2(y: Any, x: Any) -> Series:
    """Return the angle of two series: its derivative is (x y' - y x') / (x^2 + y^2)."""
    y, x = series_of(y), series_of(x)
    rate = (x * y.derivative() - y * x.derivative()) / (x * x + y * y)
    return Series(rate.integral() + type(y[0]).atan2(y[0], x[0]))


def _fabs(v: Any) -> Any:
    """Return |v|; of a series by its middle, for forms that are right whatever the sign."""
    return abs(v) if not isinstance(v, Series) else -v if v.real < 0 else v


def _enclosure(name: str, atan2: Callable[[Any, Any], Any]) -> NumberType:
    # Balls need no scaling.
    return NumberType(name, Series.sin, Series.cos, Series.sqrt, atan2,
                      lambda x, y: (x * x + y * y).sqrt(), _fabs, choose, sum,
                      lambda *lengths: 1.0,
                      INFINITESIMAL)


ENCLOSURE = _enclosure('enclosures without angles', lambda y, x: 0.0)
ENCLOSURE_WITH_ANGLES = _enclosure('enclosures', _atan2)
