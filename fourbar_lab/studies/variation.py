# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The designs of a study: points of the unit cube, and the value of a parameter at each.

Row i is the same in any process and any order: a study is cut into chunks.

====================  ==========================================================================
``grid``              all combinations of the levels, the last parameter the fastest
``sobol``             Sobol's sequence, scrambled (Owen) with the seed: the best cover of a box
``latin_hypercube``   each parameter's values spread evenly; drawn whole, so at most
                      :data:`WHOLE` rows
``random``            independent points: for tolerances, where percentiles are wanted
====================  ==========================================================================

A parameter is a function of its coordinate p, which is uniform in (0, 1):

====================  ==========================================================================
``range``             [low, high], uniform
``log_range``         [low, high], its logarithm uniform
``list``              values, each as likely
``uniform``           tolerance, or [centre, tolerance]: uniform within centre +- tolerance
``normal``            deviation, or [centre, deviation]: normal distribution
====================  ==========================================================================

The centre is the value of the scene if it is not given. Ranges may have ``levels``: how many
values of them a grid takes.
"""
from __future__ import annotations

from functools import lru_cache
from math import isfinite
from typing import NamedTuple, Union
import warnings

from fourbar_ros.errors import InvalidParameter, nearest
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.scene.parameters import check_value, find
from fourbar_ros.scene.settings import PARAMETERS
import numpy as np

METHODS = ('grid', 'sobol', 'latin_hypercube', 'random')
WHOLE = 2**20           # rows of a Latin hypercube at most
BITS = 32               # of Sobol's numbers
LONGEST = 2**BITS       # rows of his sequence: scipy cannot begin at a row of a longer one
RANGES, TOLERANCES = ('range', 'log_range'), ('uniform', 'normal')
KINDS = (*RANGES, 'list', *TOLERANCES)
LEVELS = 10             # of a range in a grid, if not given
# Beginnings of the names of parameters that change motion or loads.
ACTING = ('linkage.', 'dyads.', 'cylinder.', 'bodies.', 'gravity.', 'external.', 'points.',
          'drive.speed')
LISTED = ('linkage.mode',)      # those of them that are no numbers on a scale
# The p next to 0 and 1 that designs give: a normal distribution reaches 8.2 deviations there.
EDGE = 2.0**-53

# What YAML gives.
Yaml = Union[None, bool, int, float, str, list['Yaml'], dict[str, 'Yaml']]


class Variation(NamedTuple):
    """
    How one parameter of a scene varies: its values as a function of p in [0, 1].

    ``values`` are low and high, centre and size, or all of a list, by kind.
    """

    name: str
    unit: str
    kind: str                       # one of KINDS
    values: tuple[float, ...]
    levels: int                     # how many values a grid takes

    def at(self, p: Array) -> Array:
        """Return the values at p, of any shape: by the inverse of the distribution function."""
        if self.kind == 'list':
            place = np.minimum((p * len(self.values)).astype(int), len(self.values) - 1)
            return np.asarray(np.array(self.values)[place])
        if self.kind in RANGES:
            low, high = self.values
            if self.kind == 'range':
                return low + (high - low) * p
            return np.asarray(np.exp(np.log(low) + (np.log(high) - np.log(low)) * p))
        centre, size = self.values
        if self.kind == 'uniform':
            return centre + size * (2.0 * p - 1.0)
        from scipy.special import ndtri
        return np.asarray(centre + size * ndtri(np.clip(p, EDGE, 1.0 - EDGE)))

    @property
    def bounds(self) -> list[float]:
        """Return the least and the greatest value, or all of a list."""
        return list(self.values if self.kind == 'list' else map(float, self.at(np.arange(2.0))))

    @property
    def of_grid(self) -> Array:
        """Return the p of the levels of a grid, shape (levels,)."""
        if self.kind == 'list':
            return (np.arange(self.levels) + 0.5) / self.levels
        return np.linspace(0.0, 1.0, self.levels)


def variation(name: str, given: Yaml, scene_value: Yaml) -> Variation:
    """
    Return the :class:`Variation` of a parameter from {KIND: VALUES} in a study.

    InvalidParameter names the entry of the study, what was given and what is allowed.
    """
    entry, parameter = f'vary.{name}', find(name)
    if parameter is None:
        known = list(PARAMETERS)
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
    result = Variation(name, parameter.unit, kind, values, levels)
    for value in result.bounds:
        try:
            check_value(parameter, value)
        except InvalidParameter as error:
            reach = '' if kind == 'list' else f'reaches {value:.6g}, and it '
            raise InvalidParameter(f'{entry}.{kind}', given[kind],
                                   reach + error.allowed) from None
    return result


def _values(entry: str, kind: str, given: Yaml, scene_value: Yaml) -> tuple[float, ...]:
    """Return the values of a variation, checked; a tolerance alone is around the scene's value."""
    if kind == 'list':
        numbers = _numbers(given)
        if not numbers or len(set(numbers)) < len(numbers):
            raise InvalidParameter(entry, given, 'must be a list of different finite numbers')
        return numbers
    if kind in TOLERANCES and not isinstance(given, list):
        given = [scene_value, given]
    if len(_numbers(given)) != 2:
        raise InvalidParameter(entry, given, 'must be [low, high], two finite numbers'
                               if kind in RANGES else
                               'must be a size, or [centre, size], finite numbers; without a '
                               'centre the scene must give the parameter')
    first, second = map(float, _numbers(given))         # low and high, or centre and size
    if kind in RANGES and not first < second:
        raise InvalidParameter(entry, given, 'low must be less than high')
    if kind == 'log_range' and first <= 0.0:
        raise InvalidParameter(entry, given, 'must be positive: its logarithm is uniform')
    if kind in TOLERANCES and second <= 0.0:
        raise InvalidParameter(entry, given, 'the size must be positive')
    return first, second


def _levels(entry: str, kind: str, given: Yaml, values: tuple[float, ...]) -> int:
    """Return how many values a grid takes: those of a list, else ``given`` or :data:`LEVELS`."""
    if kind == 'list':
        if given is not None:
            raise InvalidParameter(f'{entry}.levels', given, 'not allowed with list: its length '
                                                             'is the number of levels')
        return len(values)
    if given is None:
        return LEVELS
    if isinstance(given, bool) or not isinstance(given, int) or given < 2:
        raise InvalidParameter(f'{entry}.levels', given, 'must be an integer, 2 or more')
    return given


def _numbers(given: Yaml) -> tuple[float, ...]:
    """Return the numbers of a list; none if it holds anything but finite numbers."""
    values = given if isinstance(given, list) else []
    numbers = tuple([value for value in values if isinstance(value, (int, float))
                     and not isinstance(value, bool) and isfinite(value)])
    return numbers if len(numbers) == len(values) else ()


def unit_points(method: str, rows: tuple[int, int], seed: int, levels: tuple[Array, ...],
                count: int) -> Array:
    """
    Return rows (first, after last) of a design as points in [0, 1], shape (rows, parameters).

    ``levels``: of each parameter, its values of p on a grid; ``count``: rows of the whole design.
    """
    start, stop = rows
    if method == 'grid':
        return _grid(levels, np.arange(start, stop))
    if method == 'random':
        # its counter can begin at any row: a row takes whole blocks, of four numbers each
        generator = np.random.Philox(key=seed)
        blocks = -(-len(levels) // 4)
        generator.advance(start * blocks)
        points = np.random.Generator(generator).random((stop - start, 4 * blocks))
        return points[:, :len(levels)]
    if method == 'latin_hypercube':
        return _latin_hypercube(len(levels), count, seed)[start:stop]
    from scipy.stats.qmc import Sobol
    sequence = Sobol(len(levels), scramble=True, bits=BITS, seed=np.random.default_rng(seed))
    if start:
        sequence.fast_forward(start)
    with warnings.catch_warnings():         # that only powers of two are balanced: a user's choice
        warnings.simplefilter('ignore', UserWarning)
        return np.asarray(sequence.random(stop - start))


def _grid(levels: tuple[Array, ...], rows: Array) -> Array:
    """
    Return the combinations of levels with these numbers, shape (rows, parameters).

    The digits of a number in a mixed base: with 2 and 3 levels, row 4 = 1 * 3 + 1 is (1, 1).
    """
    columns = []
    for values in reversed(levels):
        rows, place = np.divmod(rows, values.size)
        columns.append(values[place])
    return np.stack(columns[::-1], axis=1)


@lru_cache(maxsize=1)
def _latin_hypercube(parameters: int, count: int, seed: int) -> Array:
    """Return the whole design: it cannot be drawn in parts; kept for the next chunk."""
    from scipy.stats.qmc import LatinHypercube
    return np.asarray(LatinHypercube(parameters, seed=np.random.default_rng(seed)).random(count))
