# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Extrema of the output's rate and acceleration of many four-bars, given as arrays of lengths.

They are designs of a study: :mod:`fourbar_lab.studies.block` searches together those whose cranks
turn fully. Rockers and four-bars in doubt are searched one by one.
"""
from typing import NamedTuple

from fourbar_lab.studies.block import Designs, in_groups, NEAR, search
from fourbar_ros.errors import FourBarError, InvalidParameter
from fourbar_ros.extrema.find import (
    CONSTANT,
    Extremum,
    find_extrema,
    MAXIMUM,
    relative_error,
    TRUSTED,
)
from fourbar_ros.mechanisms.four_bars import FourBar
from fourbar_ros.mechanisms.parts import CROSSED, OPEN
from fourbar_ros.mechanisms.quantities import QUANTITIES
from fourbar_ros.notebook import short_repr
from fourbar_ros.numerics.arguments import array, FASTEST
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.scene.scene import from_values
import numpy as np
from numpy.typing import ArrayLike

RATES = 'omega4', 'alpha4'
# Linkages searched together: of two quantities the samples of so many stay in the cache.
TOGETHER = 512
# Two values nearer to each other than this part of them may be equal, as their conditions tell.
NEARLY = 2.0 * relative_error(TRUSTED)
# A four-bar whose crank turns fully: its lengths are replaced by those of the designs.
SCENE = {'linkage.a1': 0.4, 'linkage.a2': 1.2, 'linkage.a3': 0.8, 'linkage.a4': 1.0,
         'outputs': ['state']}


class Extrema(NamedTuple):
    """
    Extrema of one quantity of many linkages, by linkage, then theta1; arrays of shape (extrema,).

    Where a quantity is constant over a range (a parallelogram), the beginning of the range is
    listed, as a maximum if no value is larger, else as a minimum. A linkage without extrema has
    a row of NaN, and the reason.
    """

    # which linkage, counted as by ndarray.ravel; it hides the method of tuples
    index: Array        # type: ignore[assignment]
    theta1: Array       # input angle [rad], in [0, 2 pi)
    value: Array        # +-inf at toggles
    is_maximum: Array
    is_global: Array
    side: Array         # 0 inside the input range; at its ends approached from above (1), below
    reason: Array       # why a linkage has no extrema, as that it cannot be assembled; else ''

    def __repr__(self) -> str:
        return short_repr('Extrema', self._asdict())


def find_extrema_many(a1: ArrayLike, a2: ArrayLike, a3: ArrayLike, a4: ArrayLike,
                      mode: ArrayLike = OPEN, rate: ArrayLike = 1.0) -> dict[str, Extrema]:
    """
    Return {'omega4': Extrema, 'alpha4': Extrema} of many four-bars at constant input rate.

    ``a1`` to ``a4``: lengths [m]; ``mode``: 1 or 2; ``rate``: of the input [rad/s], not zero; all
    are broadcast. Those whose cranks turn fully take some hundredths of a millisecond, as in a
    study, others milliseconds each. A linkage without extrema ends no others.
    """
    arguments = {'a1': a1, 'a2': a2, 'a3': a3, 'a4': a4, 'mode': mode, 'rate': rate}
    columns = [array(name, value) for name, value in arguments.items()]
    try:
        columns = [column.ravel() for column in np.broadcast_arrays(*columns)]
    except ValueError:
        raise InvalidParameter(', '.join(arguments), [column.shape for column in columns],
                               'must have shapes that broadcast') from None
    *lengths, mode, rate = columns
    if not ((np.abs(rate) <= FASTEST) & (rate != 0.0)).all():
        raise InvalidParameter('rate', rate, f'must be at most {FASTEST:g} in size, not zero')
    if not ((mode == CROSSED) | (mode == OPEN)).all():
        raise InvalidParameter('mode', mode, 'must be 1 (crossed) or 2 (open)')
    names = (*(f'linkage.{name}' for name in ('a1', 'a2', 'a3', 'a4', 'mode')), 'drive.speed')
    scene, blocks = from_values(SCENE), {name: list[Extrema]() for name in RATES}

    def searched(which: Array, samples: int) -> Array:
        designs = Designs(scene, {name: column[which] for name, column in zip(names, columns)})
        turns = search(designs, [QUANTITIES[name] for name in RATES], 0.0, samples)
        compared = [*map(_compared, turns.values, turns.counts)]
        margins = designs.margins()
        assert margins is not None
        done = designs.are_allowed() & ~turns.is_doubtful & (np.abs(margins) > NEAR).all(axis=0)
        for *_, has_ties in compared:
            done &= ~has_ties
        for name, inputs, values, (is_maximum, is_global, _) in zip(
                RATES, turns.inputs, turns.values, compared):
            row, k = np.nonzero(np.isfinite(inputs) & done[:, None])
            blocks[name].append(Extrema(
                which[row], inputs[row, k], values[row, k], is_maximum[row, k], is_global[row, k],
                np.zeros(row.size, int), np.full(row.size, '', object)))
        return done

    for index in in_groups(np.arange(rate.size), searched, TOGETHER).tolist():
        extrema, reason = list[Extremum](), ''
        try:
            linkage = FourBar(*[length[index].item() for length in lengths])
            extrema = find_extrema(linkage.in_mode(int(mode[index])), RATES, rate[index].item())
        except FourBarError as error:
            reason = str(error)
        for name in RATES:
            mine = [extremum for extremum in extrema if extremum.quantity == name]
            largest = max([extremum.value for extremum in mine], default=0.0)
            rows = [(index, extremum.theta1, extremum.value, extremum.kind == MAXIMUM
                     or extremum.kind == CONSTANT and extremum.value == largest,
                     extremum.is_global, extremum.side, '') for extremum in mine]
            rows = rows or [(index, np.nan, np.nan, False, False, 0, reason)]
            types = int, float, float, bool, bool, int, object
            blocks[name].append(Extrema(*map(np.array, zip(*rows), types)))
    results = {}
    for name in RATES:
        whole = Extrema(*map(np.concatenate, zip(*blocks[name])))
        order = np.lexsort((whole.theta1, whole.index))
        results[name] = Extrema(*(column[order] for column in whole))
    return results


def _compared(values: Array, counts: Array) -> tuple[Array, Array, Array]:
    """Return which extrema, in rows, are maxima, which global, and which rows have near ties."""
    # maxima and minima alternate: a maximum is not below the next one
    after = (np.arange(values.shape[1]) + 1) % np.maximum(counts, 1)[:, None]
    is_maximum = values >= np.take_along_axis(values, after, axis=1)
    best = np.where(is_maximum, np.fmax.reduce(values, axis=1, initial=-np.inf)[:, None],
                    np.fmin.reduce(values, axis=1, initial=np.inf)[:, None])
    beyond, size = np.abs(best - values), np.abs(best)
    is_global = beyond <= relative_error() * size
    return is_maximum, is_global, ((beyond <= NEARLY * size) & ~is_global).any(axis=1)
