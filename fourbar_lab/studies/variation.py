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

BITS = 32               # of a point of Sobol: scipy cannot begin at a row of a longer sequence
MOST_ROWS = {'grid': 2**44, 'sobol': 2**BITS, 'random': 2**44}      # of each method
METHODS = tuple(MOST_ROWS)
RANGES, TOLERANCES = ('range', 'log_range'), ('uniform', 'normal')
KINDS = (*RANGES, 'list', *TOLERANCES)
# {kind: distribution of its two values}
DISTRIBUTIONS: dict[str, Callable[[float, float], Any]] = {
    'range': lambda low, high: stats.uniform(low, high - low), 'log_range': stats.loguniform,
    'uniform': lambda centre, size: stats.uniform(centre - size, 2.0 * size),
    'normal': stats.norm}
LEVELS = 10             # of a range in a grid by default
# Beginnings of the names of parameters that change motion or loads.
ACTING = ('linkage.', 'dyads.', 'cylinder.', 'bodies.', 'gravity.', 'external.', 'springs.',
          'torsion_springs.', 'forces.', 'friction.', 'points.', 'drive.speed')
MODE = 'linkage.mode'   # varies by a list only: it is no number on a scale
# The p next to 0 and 1 that designs give: a normal distribution reaches 8.2 deviations there.
EDGE = 2.0**-53

Yaml = Any              # a value as YAML reads it


@dataclass(frozen=True)
class Variation:
    """How a parameter of a scene varies: its values as a function of p in [0, 1]."""

    name: str
    unit: str
    kind: str                       # one of KINDS
    values: tuple[float, ...]       # low and high, centre and size, or all of a list
    levels: int                     # how many values a grid takes

    def quantiles(self, p: Array) -> Array:
        if self.kind == 'list':
            index = np.minimum((p * len(self.values)).astype(int), len(self.values) - 1)
            return np.asarray(np.array(self.values)[index])
        return np.asarray(DISTRIBUTIONS[self.kind](*self.values).ppf(
            np.clip(p, EDGE, 1.0 - EDGE) if self.kind == 'normal' else p))

    @property
    def bounds(self) -> list[float]:
        """Return the least and the greatest value, or all of a list."""
        return list(self.values if self.kind == 'list' else
                    self.quantiles(np.arange(2.0)).tolist())

    @property
    def of_grid(self) -> Array:
        """Return the p of the levels of a grid, shape (levels,)."""
        if self.kind == 'list':
            return (np.arange(self.levels) + 0.5) / self.levels
        return np.linspace(0.0, 1.0, self.levels)


def variation(name: str, entries: Yaml, values: ParameterValues) -> Variation:
    """Return the :class:`Variation` of {KIND: VALUES} in a study, for ``values`` of the scene."""
    entry, parameter = f'vary.{name}', find_parameter(name)
    if parameter is None:
        raise InvalidParameter(entry, None,
                               f'no parameter of a scene{nearest(name, list(PARAMETERS))}')
    if (not name.startswith(ACTING) or not (parameter.type == 'double' or name == MODE)
            or name.startswith('cylinder.') and values['linkage.input'] != 'cylinder'):
        raise InvalidParameter(entry, None, 'cannot vary in this study: numbers of '
                               f'{", ".join(f"{start}*" for start in ACTING)} and {MODE} can')
    keys = [key for key in entries if key != 'levels'] if isinstance(entries, dict) else []
    kind = keys[0] if len(keys) == 1 else ''
    if kind not in KINDS or name == MODE and kind != 'list':
        raise InvalidParameter(entry, entries, 'must be {KIND: VALUES}, a list for '
                               f'{MODE}, else one of {", ".join(KINDS)}')
    sizes, unit = entries[kind], unit_in(parameter, values)
    if isinstance(sizes, list) and parameter.type == 'double':
        sizes = [as_number(f'{entry}.{kind}', size, unit) for size in sizes]
    elif isinstance(sizes, str):
        sizes = as_number(f'{entry}.{kind}', sizes, unit)
    sizes = _checked(f'{entry}.{kind}', kind, sizes, values.get(name))
    levels = entries.get('levels', len(sizes) if kind == 'list' else LEVELS)
    if not isinstance(levels, int) or levels < 1 or kind == 'list' and 'levels' in entries:
        raise InvalidParameter(f'{entry}.levels', levels, 'must be an integer, 1 or more; not '
                                                          'with list, which has its own')
    result = Variation(name, unit, kind, sizes, levels)
    for value in result.bounds:
        try:
            check_value(parameter, value, values)
        except InvalidParameter as error:
            raise InvalidParameter(f'{entry}.{kind}', entries[kind],
                                   f'reaches {value:.6g}, and it {error.allowed}') from None
    return result


def _checked(entry: str, kind: str, sizes: Yaml, centre: Yaml) -> tuple[float, ...]:
    """Return the values of a variation; a tolerance alone is around the centre of the scene."""
    if kind in TOLERANCES and not isinstance(sizes, list):
        sizes = [centre, sizes]
    values = sizes if isinstance(sizes, list) else []
    are_finite = all(isinstance(value, (int, float)) and isfinite(value) for value in values)
    if kind == 'list':
        if not values or not are_finite or len(set(values)) < len(values):
            raise InvalidParameter(entry, sizes, 'must be a list of different finite numbers')
        return tuple(values)
    is_pair = are_finite and len(values) == 2
    if kind in TOLERANCES and not (is_pair and values[1] > 0.0):
        raise InvalidParameter(entry, sizes, 'must be a size above 0, or [centre, size]; without '
                                             'a centre the scene must give the parameter')
    if kind in RANGES and not (is_pair and values[0] < values[1]
                               and (kind == 'range' or values[0] > 0.0)):
        raise InvalidParameter(entry, sizes, 'must be [low, high], two finite numbers, low less '
                                             'than high; for log_range positive')
    return float(values[0]), float(values[1])


def unit_points(method: str, rows: tuple[int, int], seed: int, levels: tuple[Array, ...]) -> Array:
    """Return some rows of a study as points in [0, 1], shape (rows, parameters)."""
    start, stop = rows
    if method == 'grid':
        # the digits of a row in a mixed base: with 2 and 3 levels, row 4 = 1 * 3 + 1 is (1, 1)
        left: Array = np.arange(start, stop)
        columns = []
        for values in reversed(levels):
            left, digits = np.divmod(left, values.size)
            columns.append(values[digits])
        return np.stack(columns[::-1], axis=1)
    if method == 'random':
        # its counter can begin at any row: a row takes whole blocks, of four values each
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
