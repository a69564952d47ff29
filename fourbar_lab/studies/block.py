# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The measures of many designs at once: one mechanism whose numbers are columns of shape (n, 1).

:mod:`fourbar_lab.studies.full_turns` searches those whose cranks turn fully, and says which
results are in doubt; these and all others are left to :mod:`fourbar_lab.studies.design`.
"""
from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import pi

from fourbar_lab.studies.full_turns import rank_of, search_turns, Turns
from fourbar_lab.studies.measures import (
    CHANGE_POINT,
    CHEAP,
    CLASS,
    INPUT_RANGE,
    LEAST_ANGLE,
    Measure,
    Measures,
    Searched,
    SWING,
    TIME_RATIO,
)
from fourbar_lab.studies.parametric import constants_of, point_quantities_of, with_lengths
from fourbar_lab.studies.study import Study
from fourbar_ros.errors import InvalidParameter
from fourbar_ros.extrema.batch import find_extrema_many
from fourbar_ros.extrema.methods import has_fast_rates
from fourbar_ros.extrema.sampling import needs_angles, State
from fourbar_ros.mechanisms.contract import OPEN
from fourbar_ros.mechanisms.parts import NoLoads
from fourbar_ros.mechanisms.points import link_motion, point_of
from fourbar_ros.mechanisms.quantities import is_position
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.numerics.exact_sums import exact_sum_of_four
from fourbar_ros.numerics.number_types import (
    ARRAY,
    columns_of,
    COMPLEX,
    COMPLEX_WITH_ANGLES,
    Function,
    NumberType,
    Scalar,
)
from fourbar_ros.scene.parameters import find, ParameterValues
from fourbar_ros.scene.scene import from_values, Scene
import numpy as np

# Designs that are computed together: their samples stay in the cache.
TOGETHER = 128
# Samples of a turn, and of those that these do not resolve.
SAMPLES = (96, 192, 512)
# Nearer to a change point, relative to the sum of lengths, a type is left to exact sums.
NEAR = 1e-9
# Between the mean squares of all samples and of every other one: it falls with its square.
AGREE = 1e-6
# Sums of lengths that agree to this, relative to their sum, are the same.
NEARLY = 1e-12


class Block:
    """
    Measures of designs of one study.

    Parameters
    ----------
    study : Study
    scene : Scene
        One that can be built.
    drawn : dict
        {parameter: values, shape (n,)}.

    """

    def __init__(self, study: Study, scene: Scene, drawn: dict[str, Array]):
        self.study, self.scene, self.drawn = study, scene, drawn
        self.size = len(next(iter(drawn.values())))
        self.found: dict[str, Array] = {}
        self.is_done = np.ones(self.size, bool)
        self._fields = Measures(scene).quantities
        self._output = scene.linkage.outputs[0].coordinate.position
        self._designs = Designs(scene, study.values, drawn)
        self.is_done &= self._designs.are_allowed()

    def compute_cheap(self) -> None:
        """Compute what follows from the lengths alone."""
        margins = self._designs.margins()
        if margins is None:
            if any(measure.part in (CLASS, CHANGE_POINT) for measure in self.study.measures):
                self.is_done[:] = False
            return
        self.is_done &= (np.abs(margins) > NEAR).all(axis=0)
        self.found[CHANGE_POINT] = np.abs(margins).min(axis=0)
        if any(measure.part == CLASS for measure in self.study.measures):
            self.found[CLASS] = self._classes(margins > 0.0)

    def _classes(self, signs: Array) -> Array:
        """Return the types: they follow from the signs of the margins."""
        keys = (1 << np.arange(len(signs))) @ signs
        names = np.full(self.size, '', dtype=object)
        for key in np.unique(keys[self.is_done]).tolist():
            alike = np.nonzero((keys == key) & self.is_done)[0]
            values = {name: column[alike[0]].item() for name, column in self.drawn.items()}
            try:
                names[alike] = from_values({**self.study.values, **values}).linkage.classification
            except InvalidParameter:
                self.is_done[alike] = False
        return names.astype(str)

    def compute(self, rows: Array) -> None:
        """Compute everything for some designs, which are done after this or not."""
        needed = self._needed()
        parts = [measure.part for measure in self.study.measures if measure.part not in
                 (CLASS, CHANGE_POINT) and not (measure.quantity and measure.part != 'rms')]
        if (has_fast_rates(self.scene.linkage, needed, self.study.acceleration) and not parts
                and not self.study.curves):
            self._compute_rates(rows)
            return
        for count in SAMPLES:
            left = []
            for start in range(0, rows.size, TOGETHER):
                part = rows[start:start + TOGETHER]
                done = self._compute(part, count, needed)
                left.append(part[~done])
            rows = np.concatenate(left) if left else rows[:0]
        self.is_done[rows] = False

    def _compute_rates(self, rows: Array) -> None:
        """Compute extrema of rates alone, of any four-bars: their own search is much faster."""
        values = {name: np.broadcast_to(np.asarray(self.drawn.get(name, self.study.values[name])),
                                        self.size)[rows]
                  for name in ('linkage.a1', 'linkage.a2', 'linkage.a3', 'linkage.a4',
                               'linkage.mode', 'drive.speed')}
        moving = values['drive.speed'] != 0.0
        self.is_done[rows[~moving]] = False
        rows = rows[moving]
        found = find_extrema_many(*(column[moving] for column in values.values()))
        extents = {name: extent_of_list(part.index, part.theta1, part.value, rows.size)
                   for name, part in found.items()}
        for measure in self.study.measures:
            if measure.quantity:
                extent = extents[measure.quantity]
                self._column(measure.name)[rows] = extent.of(measure.part)
                self.is_done[rows[~extent.is_there]] = False     # those that cannot be assembled

    def _needed(self) -> list[str]:
        """Return the quantities whose extrema are needed."""
        names: dict[str, None] = {}
        for measure in self.study.measures:
            if measure.quantity:
                names[measure.quantity] = None
            elif measure.part == LEAST_ANGLE:
                names['transmission_angle'] = None
            elif measure.part not in CHEAP:
                names[self._output] = None
        return list(names) or ['transmission_angle']      # that alone says what turns fully

    def _compute(self, rows: Array, count: int, needed: list[str]) -> Array:
        """Compute some designs with a number of samples; return which are done."""
        drawn = {name: column[rows] for name, column in self.drawn.items()}
        fields = self._fields
        with_angles = any(needs_angles(fields[name]) for name in needed)
        designs = Designs(self.scene, self.study.values, drawn, with_angles)
        known = fields | designs.point_quantities()
        quantities = [known[name] for name in needed]
        turns = self._turns(designs, quantities, count)
        done = ~turns.is_doubtful
        extents: dict[int, Extent] = {}
        for measure in self.study.measures:
            if measure.part in (CLASS, CHANGE_POINT):
                continue
            values, good = self._measure(measure, turns, needed, extents)
            done &= good
            self._column(measure.name)[rows[done]] = values[done]
        for curve in self.study.curves:
            for name, values in zip((f'{curve.point}.x', f'{curve.point}.y'),
                                    self._curve(designs, curve.point, curve.samples)):
                self._column(name, curve.samples)[rows[done]] = values[done]
                done &= np.isfinite(values).all(axis=1)
        return done

    def _column(self, name: str, *samples: int) -> Array:
        """Return the column of a result, NaN where it is not found yet."""
        if name not in self.found:
            self.found[name] = np.full((self.size, *samples), np.nan)
        return self.found[name]

    def _turns(self, designs: Designs, quantities: Sequence[Searched], count: int) -> Turns:
        with_loads = any(quantity.is_load for quantity in quantities)
        is_angle = np.array([is_position(quantity) and quantity.unit == 'rad'
                             for quantity in quantities], bool)

        def rows(x: Array) -> Array:
            state = designs.state(x, self.study.acceleration, with_loads)
            out = np.empty((len(quantities), *x.shape), x.dtype)
            for row, quantity in zip(out, quantities):
                row[:] = quantity.of(*state)
            return out

        return search_turns(rows, designs.size, count, is_angle)

    def _measure(self, measure: Measure, turns: Turns, needed: list[str],
                 extents: dict[int, Extent]) -> tuple[Array, Array]:
        """Return the values of a measure, and which are right; ``extents``: what they share."""
        size = turns.is_doubtful.size
        good = np.ones(size, bool)
        if measure.part == INPUT_RANGE:
            return np.full(size, 2.0 * pi), good
        name = measure.quantity or ('transmission_angle' if measure.part == LEAST_ANGLE
                                    else self._output)
        which = needed.index(name)
        if which not in extents:
            extents[which] = Extent(turns.samples[which], turns.counts[which],
                                    turns.places[which], turns.values[which])
        part = extents[which]
        if measure.part == 'rms':
            return part.rms()
        if measure.quantity:
            return part.of(measure.part), good
        if measure.part == LEAST_ANGLE:
            return np.minimum(part.of('min'), pi - part.of('max')), good
        if measure.part == TIME_RATIO:
            forward = np.mod(part.of('max_at') - part.of('min_at'), 2.0 * pi)
            backward = 2.0 * pi - forward
            with np.errstate(all='ignore'):
                ratio = np.maximum(forward, backward) / np.minimum(forward, backward)
            return np.where(part.is_there, ratio, np.nan), good
        if measure.part == SWING:
            return np.where(part.is_there, part.of('span'), 2.0 * pi), good
        return part.of('span'), part.is_there

    def _curve(self, designs: Designs, point: str, samples: int) -> tuple[Array, Array]:
        """Return x and y of a point, each of shape (n, samples)."""
        x = np.broadcast_to(2.0 * pi * np.arange(samples) / samples, (designs.size, samples))
        motion, _ = designs.state(x, 0.0, False)
        link = link_motion(designs.many, motion, self.scene.points[point].link)
        place = point_of(link, *designs.point(point))[:2]
        one, other = (np.broadcast_to(part, x.shape) for part in place)
        return one, other


class Designs:
    """
    Designs of a scene, evaluated together.

    Parameters
    ----------
    scene : Scene
        Any of them.
    values : dict
        All parameters of the scene.
    drawn : dict
        {parameter that varies: its values, shape (n,)}.
    with_angles : bool
        Angles, and their derivatives by a complex step too, are computed; they are zero if not.

    """

    def __init__(self, scene: Scene, values: ParameterValues, drawn: dict[str, Array],
                 with_angles: bool = True):
        self.scene = scene
        self._with_angles = with_angles
        self._complex = COMPLEX_WITH_ANGLES if with_angles else COMPLEX
        self.size = len(next(iter(drawn.values())))
        columns = {name: np.asarray(column, float)[:, None] for name, column in drawn.items()}
        self.values = {**values, **columns}
        constants = constants_of(scene, self.values)
        lengths = tuple([np.broadcast_to(length, (self.size, 1)) for length in constants.lengths])
        self._constants = constants._replace(
            lengths=lengths, sign=np.where(np.equal(self.values['linkage.mode'], OPEN), 1.0, -1.0))
        self.lengths = self._constants.lengths
        self.many = with_lengths(scene.linkage, lengths)
        self.rate = self.values['drive.speed']
        self._made: dict[NumberType, tuple[Function, Function | None]] = {}

    def are_allowed(self) -> Array:
        """Return which designs have values that the table of parameters allows, shape (n,)."""
        good = np.ones(self.size, bool)
        for name, column in self.values.items():
            parameter = find(name)
            if isinstance(column, np.ndarray) and parameter is not None:
                value = column[:, 0]
                good &= (np.isfinite(value) & (value >= parameter.low) & (value <= parameter.high)
                         & ((value > 0.0) | (not parameter.positive)))
        return good

    def state(self, x: Array, acceleration: float, with_loads: bool) -> State:
        """Return (motion, loads) at inputs of shape (n, any), real or complex."""
        motion_of, loads_of = self._formulas(x.dtype.kind == 'c')
        if x.strides[0] == 0:       # the same inputs for all: functions of them alone once
            x = x[:1]
        with np.errstate(all='ignore'):
            motion = self.scene.linkage.MOTION(*motion_of(x, self.rate, acceleration))
            loads = (self.scene.linkage.LOADS(*loads_of(motion)) if with_loads and loads_of
                     else NoLoads())
        return motion, loads

    def _formulas(self, is_complex: bool) -> tuple[Function, Function | None]:
        """Return the formulas of motion and loads; without angles the same for all inputs."""
        numbers = self._complex if is_complex or not self._with_angles else ARRAY
        if numbers not in self._made:
            columns = replace(columns_of(numbers), exact_sum=_sum_of_columns)
            linkage = self.scene.linkage
            with np.errstate(all='ignore'):
                self._made[numbers] = (
                    linkage.motion_formula(columns, self._constants),
                    linkage.loads_formula(columns, self._constants)
                    if linkage.bodies is not None else None)
        return self._made[numbers]

    def point_quantities(self) -> dict[str, Searched]:
        """Return {name: quantity} of the points of the scene, with columns."""
        return point_quantities_of(self.scene, self.values, self.many)

    def point(self, name: str) -> tuple[Scalar, Scalar]:
        """Return along and across of a point."""
        return self.values[f'points.{name}.along'], self.values[f'points.{name}.across']

    def margins(self) -> Array | None:
        """
        Return :attr:`.Mechanism.margins` over the sum of lengths, shape (margins, n).

        None if they are no sums of lengths.
        """
        linkage, sizes = self.scene.linkage, np.abs(np.concatenate(self.lengths, axis=1))
        signs = np.array(linkage.MARGIN_SIGNS, float).reshape(-1, sizes.shape[1])
        own = np.abs(np.array(linkage.lengths))
        if not np.allclose(signs @ own, linkage.margins, 0.0, NEARLY * own.sum()):
            return None
        return np.asarray((signs @ sizes.T) / sizes.sum(axis=1))


def _sum_of_columns(columns: Sequence[Array]) -> Array:
    """Return the sum of up to four columns, as good as exact."""
    one, other, *rest = columns
    return exact_sum_of_four((one, other, *rest, *[0.0 * one] * (2 - len(rest))))


class Extent:
    """
    The extrema of one quantity of n designs.

    Parameters
    ----------
    samples : ndarray, shape (n, samples)
        Over a turn, at equal steps.
    counts : ndarray of int, shape (n,)
    places, values : ndarray, shape (n, r)
        NaN beyond the last.

    """

    def __init__(self, samples: Array, counts: Array, places: Array, values: Array) -> None:
        self.samples, self.counts = samples, counts
        if not values.shape[-1]:
            places = values = np.full((len(values), 1), np.nan)
        self.is_there = counts > 0
        rows = np.arange(len(values))
        with np.errstate(all='ignore'):
            most = np.argmax(np.where(np.isnan(values), -np.inf, values), axis=1)
            least = np.argmin(np.where(np.isnan(values), np.inf, values), axis=1)
        self._ends = values[rows, most], values[rows, least]
        self._places = places[rows, most], places[rows, least]

    def of(self, part: str) -> Array:
        """Return a part by name."""
        (most, least), (most_at, least_at) = self._ends, self._places
        if part in ('span', 'peak'):
            with np.errstate(invalid='ignore'):         # from one infinity to the other
                found: Array = (most - least if part == 'span'
                                else np.maximum(np.abs(most), np.abs(least)))
            return found
        result: Array = {'max': most, 'min': least, 'max_at': most_at, 'min_at': least_at,
                         'extrema': self.counts}[part]
        return result

    def rms(self) -> tuple[Array, Array]:
        """Return root mean squares, and where they are right to rounding."""
        squares = self.samples * self.samples
        mean, half = squares.mean(axis=1), squares[:, ::2].mean(axis=1)
        return np.sqrt(mean), np.abs(mean - half) <= AGREE * mean


def extent_of_list(index: Array, places: Array, values: Array, size: int) -> Extent:
    """Return the :class:`Extent` of extrema listed by design; ``index``: of which, in order."""
    counts = np.bincount(index, minlength=size)
    shape = size, int(counts.max(initial=0))
    padded = [np.full(shape, np.nan) for _ in range(2)]
    for whole, part in zip(padded, (places, values)):
        whole[index, rank_of(index)] = part
    return Extent(np.empty((size, 0)), counts, *padded)
