# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Enclosures over a box of parameters: duals of balls whose value is that in the middle of the box.

A number holds its value q(p0) and enclosures of its derivatives over the box; over the box it is

    (C1)  q(p) in q(p0) + sum q_i(P) [-t_i, t_i]

(the mean value form). Taken at every operation it keeps what is common to two operands, which
ball arithmetic on the box itself would count twice (E. R. Hansen, A generalized interval
arithmetic, 1975). Balls are those of Arb, by the optional package python-flint.
"""
from __future__ import annotations

from dataclasses import replace
from typing import Any

from fourbar_ros.numerics.duals import Derivatives, derivatives_of, Dual, duals_of
from fourbar_ros.numerics.number_types import choose, Function, INFINITESIMAL, NumberType


def _ball(value: Any) -> Any:
    """Return a number as a ball: a formula may be asked of a constant of its own."""
    if not isinstance(value, (float, int)):
        return value
    import flint

    return flint.arb(value)


def _atan2(y: Any, x: Any) -> Any:
    y = _ball(y)
    return type(y).atan2(y, _ball(x))


def _sqrt(value: Any) -> Any:
    return _ball(value).sqrt()


# Balls need no scaling. Choices are made in the middle of the box, between forms that are right.
BALLS = NumberType('balls', lambda v: _ball(v).sin(), lambda v: _ball(v).cos(), _sqrt, _atan2,
                   lambda x, y: _sqrt(x * x + y * y), abs, choose, sum, lambda *lengths: 1.0,
                   INFINITESIMAL)


class Centred(Dual):
    """
    A number over a box; see :func:`centred_on`, which gives subclasses their ``radii``.

    Parameters
    ----------
    value : flint.arb
        In the middle of the box.
    by : dict
        {parameter: flint.arb that holds the derivative everywhere in the box}.

    """

    __slots__ = ('_whole',)
    radii: dict[str, Any]

    def __init__(self, value: Any, by: Derivatives) -> None:
        super().__init__(value, by)
        self._whole: Any = None

    @property
    def whole(self) -> Any:
        """Return the ball of the values in the box, (C1)."""
        if self._whole is None:
            self._whole = self.value + sum((part * self.radii[name]
                                            for name, part in self.by.items()))
        return self._whole


def centred_on(radii: dict[str, Any]) -> tuple[type[Centred], NumberType]:
    """
    Return the type of numbers over a box, and their number type.

    Parameters
    ----------
    radii : dict
        {parameter: half the width of the box, as the ball 0 +- that}.

    """
    centred: type[Centred] = type('Centred', (Centred,), {'__slots__': (), 'radii': radii})
    numbers = duals_of(BALLS, centred)
    return centred, replace(numbers, hypot=_lipschitz(numbers.hypot, centred))


def _lipschitz(hypot: Function, centred: type[Centred]) -> Function:
    """
    Return ``hypot`` over a box in which both may vanish: of a force that changes its sense.

    There it has no derivative, and changes by no more than (x, y) does.
    """
    def call(x: Any, y: Any) -> Any:
        found = hypot(x, y)
        if all(part.is_finite() for part in found.by.values()):
            return found
        one, other = derivatives_of(x), derivatives_of(y)
        either = _ball(0.0).union(_ball(1.0)) * 2.0 - 1.0
        return centred(found.value, {name: either * BALLS.hypot(*[
            abs(_ball(by.get(name, 0.0))).upper() for by in (one, other)]) for name in found.by})
    return call
