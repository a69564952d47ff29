# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The designs of a study: points of the unit cube, and what a parameter is at each of them.

Row i of a design is the same whoever computes it, and in whatever order: a study is cut into
chunks.

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
from fourbar_ros.scene.parameter_table import PARAMETERS
from fourbar_ros.scene.parameters import check_value, find
import numpy as np

METHODS = ('grid', 'sobol', 'latin_hypercube', 'random')
WHOLE = 2**20
# Bits of Sobol's numbers, and rows of a sequence: scipy cannot begin at a row of a longer one.
BITS = 32
LONGEST = 2**BITS
RANGES, TOLERANCES = ('range', 'log_range'), ('uniform', 'normal')
KINDS = (*RANGES, 'list', *TOLERANCES)
LEVELS = 10
# Parameters that change motion or loads, and those of them that are no numbers on a scale.
ACTING, LISTED = ('linkage.', 'dyads.', 'cylinder.', 'bodies.', 'gravity.', 'external.', 'points.',
                  'drive.speed'), ('linkage.mode',)
# The p next to 0 and 1 that designs give: a normal distribution reaches 8.2 deviations there.
EDGE = 2.0**-53

# What YAML gives.
Yaml = Union[None, bool, int, float, str, list['Yaml'], dict[str, 'Yaml']]


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
    values: tuple[float, ...]
    levels: int

    def at(self, p: Array) -> Array:
        """Return the values at p in [0, 1]."""
        if self.kind == 'list':
            place = np.minimum((p * len(self.values)).astype(int), len(self.values) - 1)
            listed: Array = np.array(self.values)[place]
            return listed
        one, other = self.values
        if self.kind == 'range':
            return one + (other - one) * p
        if self.kind == 'log_range':
            found: Array = np.exp(np.log(one) + (np.log(other) - np.log(one)) * p)
            return found
        if self.kind == 'uniform':
            return one + other * (2.0 * p - 1.0)
        from scipy.special import ndtri
        return np.asarray(one + other * ndtri(np.clip(p, EDGE, 1.0 - EDGE)))

    @property
    def bounds(self) -> list[float]:
        """Return the values that are least and greatest, or all of a list."""
        if self.kind == 'list':
            return list(self.values)
        found: list[float] = self.at(np.array((0.0, 1.0))).tolist()
        return found

    @property
    def of_grid(self) -> Array:
        """Return the p of the levels of a grid."""
        if self.kind == 'list':
            return (np.arange(self.levels) + 0.5) / self.levels
        return np.linspace(0.0, 1.0, self.levels)


def variation(name: str, given: Yaml, scene_value: Yaml) -> Variation:
    """
    Return the :class:`Variation` of a parameter as a study gives it.

    Raises
    ------
    InvalidParameter
        Naming the entry of the study, what was given and what is allowed.

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
    found = Variation(name, parameter.unit, kind, values, levels)
    for value in found.bounds:
        try:
            check_value(parameter, value)
        except InvalidParameter as error:
            reach = '' if kind == 'list' else f'reaches {value:.6g}, and it '
            raise InvalidParameter(f'{entry}.{kind}', given[kind],
                                   reach + error.allowed) from None
    return found


def _values(entry: str, kind: str, given: Yaml, scene_value: Yaml) -> tuple[float, ...]:
    """Return the values of a variation, checked."""
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
    one, other = map(float, _numbers(given))
    if kind in RANGES and not one < other:
        raise InvalidParameter(entry, given, 'low must be less than high')
    if kind == 'log_range' and one <= 0.0:
        raise InvalidParameter(entry, given, 'must be positive: its logarithm is uniform')
    if kind in TOLERANCES and other <= 0.0:
        raise InvalidParameter(entry, given, 'the size must be positive')
    return one, other


def _levels(entry: str, kind: str, given: Yaml, values: tuple[float, ...]) -> int:
    """Return how many values a grid takes."""
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
    Return some rows of a design, shape (rows, parameters), in [0, 1].

    Parameters
    ----------
    method : str
        One of :data:`METHODS`.
    rows : (first, after last)
    seed : int
    levels : tuple of ndarray
        Levels of each parameter on a grid.
    count : int
        Rows of the whole design.

    """
    start, stop = rows
    if method == 'grid':
        return _grid(levels, np.arange(start, stop))
    if method == 'random':
        generator = np.random.Philox(key=seed)
        # one block of four 64-bit numbers a row and four parameters
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
    """Return the combinations of levels with these numbers."""
    columns = []
    for values in reversed(levels):
        rows, place = np.divmod(rows, values.size)
        columns.append(values[place])
    return np.stack(columns[::-1], axis=1)


@lru_cache(maxsize=1)
def _latin_hypercube(parameters: int, count: int, seed: int) -> Array:
    from scipy.stats.qmc import LatinHypercube
    return np.asarray(LatinHypercube(parameters, seed=np.random.default_rng(seed)).random(count))
