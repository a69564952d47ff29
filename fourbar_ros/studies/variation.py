# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
How a parameter of a scene varies: a function of a number p that is uniform in (0, 1).

====================  ==========================================================================
``range``             [low, high], uniform
``log_range``         [low, high], its logarithm uniform
``list``              values, each as likely
``uniform``           tolerance, or [centre, tolerance]: uniform within centre +- tolerance
``normal``            deviation, or [centre, deviation]: normal distribution
====================  ==========================================================================

The centre is the value of the scene if it is not given. Ranges may have ``levels``, how many
values of them a grid takes.
"""
from __future__ import annotations

from math import isfinite
from typing import Any, NamedTuple

from fourbar_ros.errors import InvalidParameter, nearest
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.scene import parameters
import numpy as np

RANGES, TOLERANCES = ('range', 'log_range'), ('uniform', 'normal')
KINDS = (*RANGES, 'list', *TOLERANCES)
LEVELS = 10
# Parameters that change motion or loads, and those of them that are no numbers on a scale.
ACTING, LISTED = ('linkage.', 'dyads.', 'cylinder.', 'bodies.', 'gravity.', 'external.', 'points.',
                  'drive.speed'), ('linkage.mode',)
# The p next to 0 and 1 that designs give: a normal distribution reaches 8.2 deviations there.
EDGE = 2.0**-53


class Variation(NamedTuple):
    """
    How one parameter varies.

    Parameters
    ----------
    name : str
        Name of the parameter, as in a scene.
    unit : str
    kind : str
        One of :data:`KINDS`.
    values : tuple
        Low and high, centre and size, or the list.
    levels : int
        How many values a grid takes.

    """

    name: str
    unit: str
    kind: str
    values: tuple[Any, ...]
    levels: int

    def at(self, p: Array) -> Array:
        """Return the values at p in [0, 1]."""
        if self.kind == 'list':
            place = np.minimum((p * len(self.values)).astype(int), len(self.values) - 1)
            return np.array(self.values)[place]
        one, other = self.values
        if self.kind == 'range':
            return one + (other - one) * p
        if self.kind == 'log_range':
            return np.exp(np.log(one) + (np.log(other) - np.log(one)) * p)
        if self.kind == 'uniform':
            return one + other * (2.0 * p - 1.0)
        from scipy.special import ndtri
        return np.asarray(one + other * ndtri(np.clip(p, EDGE, 1.0 - EDGE)))

    @property
    def bounds(self) -> list[Any]:
        """Return the values that are least and greatest, or all of a list."""
        if self.kind == 'list':
            return list(self.values)
        return self.at(np.array((0.0, 1.0))).tolist()

    @property
    def of_grid(self) -> Array:
        """Return the p of the levels of a grid."""
        if self.kind == 'list':
            return (np.arange(self.levels) + 0.5) / self.levels
        return np.linspace(0.0, 1.0, self.levels)


def variation(name: str, given: Any, scene_value: Any) -> Variation:
    """
    Return the :class:`Variation` of a parameter as a study gives it.

    Raises
    ------
    InvalidParameter
        Naming the entry of the study, what was given and what is allowed.

    """
    entry, parameter = f'vary.{name}', parameters.find(name)
    if parameter is None:
        known = list(parameters.PARAMETERS)
        raise InvalidParameter(entry, None, f'no parameter of a scene{nearest(name, known, 0.75)}')
    if not isinstance(given, dict):
        raise InvalidParameter(entry, given, 'must be {KIND: VALUES}, KIND one of '
                                             f'{", ".join(KINDS)}')
    kinds = [key for key in given if key in KINDS]
    for key in given:
        if key not in (*KINDS, 'levels'):
            raise InvalidParameter(f'{entry}.{key}', None, f'unknown{nearest(key, KINDS)}')
    if len(kinds) != 1:
        raise InvalidParameter(entry, given, f'must have one of {", ".join(KINDS)}')
    kind = kinds[0]
    if not name.startswith(ACTING) or not (parameter.type == 'double' or name in LISTED):
        raise InvalidParameter(entry, None, 'cannot vary in a study: numbers of '
                               f'{", ".join(f"{part}*" for part in ACTING)} and {LISTED[0]} can')
    if name in LISTED and kind != 'list':
        raise InvalidParameter(entry, given, 'only a list of its values can vary')
    values = _values(f'{entry}.{kind}', kind, given[kind], scene_value)
    levels = _levels(entry, kind, given.get('levels'), values)
    found = Variation(name, parameter.unit, kind, values, levels)
    for value in found.bounds:
        try:
            parameter.check(value)
        except InvalidParameter as error:
            reach = '' if kind == 'list' else f'reaches {value:.6g}, and it '
            raise InvalidParameter(f'{entry}.{kind}', given[kind],
                                   reach + error.allowed) from None
    return found


def _values(entry: str, kind: str, given: Any, scene_value: Any) -> tuple[Any, ...]:
    """Return the values of a variation, checked."""
    if kind == 'list':
        if (not isinstance(given, list) or not given or not all(map(_is_number, given))
                or len(set(given)) < len(given)):
            raise InvalidParameter(entry, given, 'must be a list of different finite numbers')
        return tuple(given)
    if kind in TOLERANCES and not isinstance(given, list):
        given = [scene_value, given]
    if not isinstance(given, list) or len(given) != 2 or not all(map(_is_number, given)):
        raise InvalidParameter(entry, given, 'must be [low, high], two finite numbers'
                               if kind in RANGES else
                               'must be a size, or [centre, size], finite numbers; without a '
                               'centre the scene must give the parameter')
    one, other = map(float, given)
    if kind in RANGES and not one < other:
        raise InvalidParameter(entry, given, 'low must be less than high')
    if kind == 'log_range' and one <= 0.0:
        raise InvalidParameter(entry, given, 'must be positive: its logarithm is uniform')
    if kind in TOLERANCES and other <= 0.0:
        raise InvalidParameter(entry, given, 'the size must be positive')
    return one, other


def _levels(entry: str, kind: str, given: Any, values: tuple[Any, ...]) -> int:
    """Return how many values a grid takes."""
    if kind == 'list':
        if given is not None:
            raise InvalidParameter(f'{entry}.levels', given, 'a list has as many as it has values')
        return len(values)
    if given is None:
        return LEVELS
    if isinstance(given, bool) or not isinstance(given, int) or given < 2:
        raise InvalidParameter(f'{entry}.levels', given, 'must be an integer, 2 or more')
    return given


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and isfinite(value)
