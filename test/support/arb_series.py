# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Taylor series of balls, a number type: a thin cover of ``flint.arb_series`` (Arb)."""
from __future__ import annotations

from collections.abc import Callable
from typing import Any

from fourbar_ros.numerics.number_types import choose, NumberType


class Series:
    """Enclosure of the Taylor coefficients of a quantity over a piece of the input range."""

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

    def sqrt(self) -> Series:
        """Return its root."""
        return Series(self.series.sqrt())

    def __neg__(self) -> Series:
        return Series(-self.series)

    def __pow__(self, exponent: int) -> Series:
        return Series(self.series ** exponent)


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


def _fabs(v: Any) -> Any:
    """Return |v|; of a series by its middle, for forms that are right whatever the sign."""
    return abs(v) if not isinstance(v, Series) else -v if v.real < 0 else v


# Balls need no scaling. Angles are left out.
ARB_SERIES = NumberType('series of balls', Series.sin, Series.cos, Series.sqrt, lambda y, x: 0.0,
                        lambda x, y: (x * x + y * y).sqrt(), _fabs, choose, sum,
                        lambda *lengths: 1.0)
