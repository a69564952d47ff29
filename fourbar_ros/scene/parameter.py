# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""One parameter of a scene: type, unit, default, allowed values, text."""
from __future__ import annotations

from array import array
from math import inf, isfinite, isnan
from typing import Any, NamedTuple

from fourbar_ros.errors import InvalidParameter

REQUIRED = object()        # as a default: the scene must give the value
TYPES = {'double': float, 'integer': int, 'string': str, 'bool': bool, 'strings': list,
         'doubles': list}


class Parameter(NamedTuple):
    """
    One parameter.

    A ``default`` of NaN means "not given". ``low`` and ``high`` are inclusive; ``positive``
    excludes zero.
    """

    name: str
    type: str
    default: Any
    unit: str
    text: str
    low: float = -inf
    high: float = inf
    positive: bool = False
    choices: tuple[str, ...] = ()
    live: bool = True          # can be changed while the node runs

    def check(self, value: Any) -> Any:
        """Return the value in its own type, or raise InvalidParameter saying what is allowed."""
        kind: Any = TYPES[self.type]
        if kind is float:
            value = _as_float(value)
        # an array of doubles comes so from rclpy
        if kind is list and isinstance(value, (tuple, array)):
            value = list(value)
        if not isinstance(value, kind) or (kind is int and isinstance(value, bool)):
            raise InvalidParameter(self.name, value, f'must be {self._article} {self.type}')
        if self.type == 'strings':
            for item in value:
                if not isinstance(item, str) or (self.choices and item not in self.choices):
                    raise InvalidParameter(self.name, item,
                                           f'must be some of {", ".join(self.choices)}'
                                           if self.choices else 'must be a text')
        elif self.type == 'doubles':
            value = [_as_float(item) for item in value]
            for item in value:
                if not isinstance(item, float) or not isfinite(item):
                    raise InvalidParameter(self.name, item, 'must hold finite numbers')
        elif self.choices and value not in self.choices:
            raise InvalidParameter(self.name, value, f'must be one of {", ".join(self.choices)}')
        if kind in (float, int):
            self._check_number(value)
        return value

    @property
    def _article(self) -> str:
        return 'an' if self.type == 'integer' else 'some' if TYPES[self.type] is list else 'a'

    def _check_number(self, value: float) -> None:
        if isnan(value) and isinstance(self.default, float) and isnan(self.default):
            return                                             # not given
        if not isfinite(value):
            raise InvalidParameter(self.name, value, 'must be a finite number')
        if self.positive and value <= 0:
            raise InvalidParameter(self.name, value, 'must be positive')
        if not self.low <= value <= self.high:
            raise InvalidParameter(self.name, value, f'must lie in {self.allowed}')

    @property
    def allowed(self) -> str:
        """Return the allowed values as text."""
        if self.choices:
            return ', '.join(self.choices)
        if self.positive:
            return '> 0' if self.high == inf else f'(0, {self.high:g}]'
        if self.low > -inf:
            return f'>= {self.low:g}' if self.high == inf else f'[{self.low:g}, {self.high:g}]'
        return ''


def _as_float(value: Any) -> Any:
    """Return an integer as a float, anything else as it is."""
    return float(value) if isinstance(value, int) and not isinstance(value, bool) else value
