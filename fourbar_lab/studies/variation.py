# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The designs of a study: points of the unit cube, and the value of a parameter at each.

Row i is the same in any process and any order: a study is cut into chunks.

====================  ==========================================================================
``grid``              all combinations of the levels, the last parameter the fastest
``sobol``             Sobol's sequence, scrambled (Owen) with the seed: the best cover of a box
``random``            independent points: for tolerances, where percentiles are wanted
====================  ==========================================================================

A parameter has a distribution of scipy.stats; its value is the quantile of its coordinate:

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

from collections.abc import Callable
from dataclasses import dataclass
from math import isfinite
from typing import Any
import warnings

from fourbar_ros.errors import InvalidParameter, nearest
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.scene.parameters import as_number, check_value, find_parameter, unit_in
from fourbar_ros.scene.settings import PARAMETERS, ParameterValues
import numpy as np
from scipy import stats

BITS = 32               # of Sobol's numbers: scipy cannot begin at a row of a longer sequence
MOST_ROWS = {'grid': 2**44, 'sobol': 2**BITS, 'random': 2**44}      # of each method
METHODS = tuple(MOST_ROWS)
# {kind: distribution of its two values}
RANGES: dict[str, Callable[[float, float], Any]] = {
    'range': lambda low, high: stats.uniform(low, high - low), 'log_range': stats.loguniform}
TOLERANCES: dict[str, Callable[[float, float], Any]] = {
    'uniform': lambda centre, size: stats.uniform(centre - size, 2.0 * size),
    'normal': stats.norm}
KINDS = (*RANGES, 'list', *TOLERANCES)
LEVELS = 10             # of a range in a grid, if not given
# Beginnings of the names of parameters that change motion or loads.
ACTING = ('linkage.', 'dyads.', 'cylinder.', 'bodies.', 'gravity.', 'external.', 'points.',
          'drive.speed')
LISTED = ('linkage.mode',)      # those of them that are no numbers on a scale
# The p next to 0 and 1 that designs give: a normal distribution reaches 8.2 deviations there.
EDGE = 2.0**-53

# What YAML gives.
Yaml = Any


@dataclass(frozen=True)
class Variation:
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
        """Return the values at p, of any shape: quantiles of the distribution."""
        if self.kind == 'list':
            place = np.minimum((p * len(self.values)).astype(int), len(self.values) - 1)
            return np.asarray(np.array(self.values)[place])
        distribution = {**RANGES, **TOLERANCES}[self.kind](*self.values)
        return np.asarray(distribution.ppf(p if self.kind != 'normal'
                                           else np.clip(p, EDGE, 1.0 - EDGE)))

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


def variation(name: str, given: Yaml, values: ParameterValues) -> Variation:
    """
    Return the :class:`Variation` of a parameter from {KIND: VALUES} in a study.

    ``values``: of the scene. InvalidParameter names the entry of the study, what was given and
    what is allowed.
    """
    entry, parameter = f'vary.{name}', find_parameter(name)
    if parameter is None:
        known = list(PARAMETERS)
        raise InvalidParameter(entry, None, f'no parameter of a scene{nearest(name, known)}')
    if (not name.startswith(ACTING) or not (parameter.type == 'double' or name in LISTED)
            or name.startswith('cylinder.') and values['linkage.input'] != 'cylinder'):
        raise InvalidParameter(entry, None, 'cannot vary in this study: numbers of '
                               f'{", ".join(f"{part}*" for part in ACTING)} and {LISTED[0]} can')
    kind, *others = [key for key in given if key != 'levels'] if isinstance(given, dict) else ['']
    if kind not in KINDS or others or name in LISTED and kind != 'list':
        raise InvalidParameter(entry, given, 'must be {KIND: VALUES}, a list for '
                               f'{LISTED[0]}, else one of {", ".join(KINDS)}')
    sizes, unit = given[kind], unit_in(parameter, values)
    if isinstance(sizes, list) and parameter.type == 'double':
        sizes = [as_number(f'{entry}.{kind}', size, unit) for size in sizes]
    elif isinstance(sizes, str):
        sizes = as_number(f'{entry}.{kind}', sizes, unit)
    numbers = _numbers(f'{entry}.{kind}', kind, sizes, values.get(name))
    levels = given.get('levels', len(numbers) if kind == 'list' else LEVELS)
    if not isinstance(levels, int) or levels < 1 or kind == 'list' and 'levels' in given:
        raise InvalidParameter(f'{entry}.levels', levels, 'must be an integer, 1 or more; not '
                                                          'with list, which has its own')
    result = Variation(name, parameter.unit, kind, numbers, levels)
    for value in result.bounds:
        try:
            check_value(parameter, value, values)
        except InvalidParameter as error:
            raise InvalidParameter(f'{entry}.{kind}', given[kind],
                                   f'reaches {value:.6g}, and it {error.allowed}') from None
    return result


def _numbers(entry: str, kind: str, given: Yaml, scene_value: Yaml) -> tuple[float, ...]:
    """Return the values of a variation, checked; a tolerance alone is around the scene's value."""
    if kind in TOLERANCES and not isinstance(given, list):
        given = [scene_value, given]
    numbers = given if isinstance(given, list) else []
    are_finite = all(isinstance(value, (int, float)) and isfinite(value) for value in numbers)
    if kind == 'list':
        if not numbers or not are_finite or len(set(numbers)) < len(numbers):
            raise InvalidParameter(entry, given, 'must be a list of different finite numbers')
        return tuple(numbers)
    is_right = are_finite and len(numbers) == 2 and (
        numbers[1] > 0.0 if kind in TOLERANCES else
        numbers[0] < numbers[1] and (kind == 'range' or numbers[0] > 0.0))
    if not is_right:
        raise InvalidParameter(entry, given, 'must be a size above 0, or [centre, size]; without '
                               'a centre the scene must give the parameter'
                               if kind in TOLERANCES else 'must be [low, high], two finite '
                               'numbers, low less than high; for log_range positive')
    return float(numbers[0]), float(numbers[1])


def unit_points(method: str, rows: tuple[int, int], seed: int, levels: tuple[Array, ...]) -> Array:
    """
    Return rows (first, after last) of a design as points in [0, 1], shape (rows, parameters).

    ``levels``: of each parameter, its values of p on a grid.
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
