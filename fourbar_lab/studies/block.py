# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The measures of many designs at once: one mechanism whose lengths are columns of shape (n, 1).

:mod:`fourbar_ros.extrema.full_turns` searches those whose cranks turn fully, and says which
results are in doubt; these and all others are left to :mod:`fourbar_lab.studies.design`.
"""
from __future__ import annotations

from collections.abc import Callable, Sequence
from math import pi, tau

from fourbar_lab.studies import measures as kinds
from fourbar_lab.studies import parametric
from fourbar_lab.studies.measures import Extent, Measure, Measures, Searched
from fourbar_lab.studies.study import Study
from fourbar_ros.errors import InvalidParameter
from fourbar_ros.extrema.full_turns import search_turns, Turns
from fourbar_ros.extrema.sampling import State
from fourbar_ros.mechanisms.batches import step_of_arrays
from fourbar_ros.mechanisms.parts import NoLoads, OPEN
from fourbar_ros.mechanisms.points import with_any_lengths
from fourbar_ros.mechanisms.quantities import is_position, is_published
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.scene.parameters import find_parameter
from fourbar_ros.scene.scene import from_values, Scene
from fourbar_ros.scene.settings import ParameterValues
import numpy as np

# Designs that are computed together: their samples stay in the cache of the processor.
TOGETHER = 128
# Samples of a turn: more of them for designs that few do not resolve.
SAMPLES = (96, 192, 512)
# Nearer to a change point, relative to the sum of lengths, a type is left to exact sums.
NEAR = 1e-9
# The mean squares of all samples and of every second differ by less: the error of the former is
# the square of that.
AGREE = 1e-6


class DesignBlock:
    """
    Measures of n designs of one study, computed together.

    Results are written into ``columns``, {measure: values, shape (n,)}, and are right where
    ``is_done``, shape (n,). ``scene`` is one design that can be built; ``drawn`` is {parameter:
    values, shape (n,)}.
    """

    def __init__(self, study: Study, scene: Scene, drawn: dict[str, Array],
                 columns: dict[str, Array]):
        self.study, self.scene, self.drawn, self.columns = study, scene, drawn, columns
        self._measures = Measures(scene)
        self._designs = Designs(scene, study.values, drawn)
        self.is_done = self._designs.are_allowed()

    def compute_cheap(self) -> None:
        """Compute type and distance from a change point: they follow from the lengths alone."""
        margins = self._designs.margins()
        if margins is None:
            self.is_done &= self.columns.keys().isdisjoint((kinds.CLASS, kinds.CHANGE_POINT))
            return
        self.is_done &= (np.abs(margins) > NEAR).all(axis=0)
        if kinds.CHANGE_POINT in self.columns:
            self.columns[kinds.CHANGE_POINT][:] = np.abs(margins).min(axis=0)
        if kinds.CLASS not in self.columns:
            return
        # designs whose margins have equal signs are of one type: a design of each group is asked
        keys = (1 << np.arange(len(margins))) @ (margins > 0.0)     # the signs as bits
        for key in np.unique(keys[self.is_done]).tolist():
            alike = np.nonzero((keys == key) & self.is_done)[0]
            values = {name: column[alike[0]].item() for name, column in self.drawn.items()}
            try:
                scene = from_values({**self.study.values, **values})
                self.columns[kinds.CLASS][alike] = scene.linkage.classification
            except InvalidParameter:
                self.is_done[alike] = False

    def compute(self, rows: Array) -> None:
        """Compute all other measures of some designs, by index; ``is_done`` marks the finished."""
        sources = {measure: self._measures.source(measure) for measure in self.study.measures}
        # without any, the transmission angle alone tells which designs turn fully
        needed = list(dict.fromkeys(filter(None, sources.values()))) or ['transmission_angle']

        def work(rows: Array, samples: int) -> Array:
            drawn = {name: column[rows] for name, column in self.drawn.items()}
            designs = Designs(self.scene, self.study.values, drawn)
            known = self._measures.quantities | parametric.point_quantities_of(
                self.scene, designs.values, designs.many)
            turns = search(designs, [known[name] for name in needed], self.study.acceleration,
                           samples)
            is_done = ~turns.is_doubtful
            for measure in self.study.measures:
                if measure.part not in (kinds.CLASS, kinds.CHANGE_POINT):
                    values, is_right = self._measure(measure, turns, needed)
                    is_done &= is_right
                    self.columns[measure.name][rows[is_done]] = values[is_done]
            return is_done

        self.is_done[in_groups(rows, work)] = False

    def _measure(self, measure: Measure, turns: Turns, needed: list[str]) -> tuple[Array, Array]:
        """Return a measure, and which are right, (n,), from the turns of ``needed``."""
        all_right = np.ones(turns.is_doubtful.size, bool)
        if measure.part == kinds.INPUT_RANGE:
            return np.full(all_right.size, tau), all_right
        row = needed.index(self._measures.source(measure))
        if measure.part == 'rms':
            squares = turns.samples[row] * turns.samples[row]
            mean, of_half = squares.mean(axis=1), squares[:, ::2].mean(axis=1)
            return np.sqrt(mean), np.abs(mean - of_half) <= AGREE * mean
        inputs, values = turns.places[row], turns.values[row]       # NaN beyond the last extremum
        if not values.shape[-1]:
            inputs = values = np.full((len(values), 1), np.nan)
        designs, is_none = np.arange(len(values)), np.isnan(values)
        most = np.argmax(np.where(is_none, -np.inf, values), axis=1)
        least = np.argmin(np.where(is_none, np.inf, values), axis=1)
        extent = Extent(values[designs, most], inputs[designs, most], values[designs, least],
                        inputs[designs, least], turns.counts[row])
        if measure.part in (kinds.SWING, kinds.STROKE):
            samples = turns.samples[row]        # of angles continuous
            is_turn = ((measure.part == kinds.SWING)
                       & (np.abs(samples[:, -1] - samples[:, 0]) > pi))     # less a step
            return np.where(is_turn, tau, extent.max - extent.min), is_turn | (extent.extrema > 0)
        return np.asarray(extent.of(measure.part)), all_right


def in_groups(rows: Array, work: Callable[[Array, int], Array], together: int = TOGETHER
              ) -> Array:
    """
    Do work for designs, by index, ``together`` at a time; return those that are not done.

    ``work``: (some rows, samples of a turn) -> which of them are done, a mask. It is asked again,
    with more samples, for those where samples or search leave a doubt.
    """
    for samples in SAMPLES:
        left = [rows[:0]]
        for start in range(0, rows.size, together):
            group = rows[start:start + together]
            left.append(group[~work(group, samples)])
        rows = np.concatenate(left)
    return rows


def search(designs: Designs, quantities: Sequence[Searched], acceleration: float,
           count: int) -> Turns:
    """Return the extrema of quantities of all designs, from ``count`` samples of a turn."""
    with_loads = any(quantity.is_load for quantity in quantities)
    names = (tuple([quantity.name for quantity in quantities])
             if all(map(is_published, quantities)) else None)
    is_angle = np.array([is_position(quantity) and quantity.unit == 'rad'
                         for quantity in quantities], bool)
    state = designs.step(acceleration, with_loads, names)

    def evaluate(x: Array, which: Array) -> Array:
        """
        Return all quantities, shape (q, m, any), at inputs of shape (m, any) of m designs.

        The mechanism has columns of all designs: those not asked for get the input 1.
        """
        of_all = x
        if which.size < designs.size:
            of_all = np.ones((designs.size, x.shape[1]), x.dtype)
            of_all[which] = x
        values = np.empty((len(quantities), *of_all.shape), x.dtype)
        motion_and_loads = state(of_all)
        for row, quantity in zip(values, quantities):
            row[:] = quantity.of(*motion_and_loads)
        return values[:, which]

    return search_turns(evaluate, designs.size, count, is_angle)


class Designs:
    """
    n designs of a scene, evaluated together: a mechanism whose lengths are columns, shape (n, 1).

    ``scene`` is any of them, ``values`` all of its parameters, ``drawn`` {parameter that varies:
    values, shape (n,)}.
    """

    def __init__(self, scene: Scene, values: ParameterValues, drawn: dict[str, Array]):
        self.scene = scene
        self.size = len(next(iter(drawn.values())))
        columns = {name: np.asarray(column, float)[:, None] for name, column in drawn.items()}
        self.values = {**values, **columns}
        constants = parametric.constants_of(scene, self.values)
        self.lengths = tuple([np.broadcast_to(length, (self.size, 1))
                              for length in constants.lengths])
        self._constants = constants._replace(
            lengths=self.lengths,
            sign=np.where(np.equal(self.values['linkage.mode'], OPEN), 1.0, -1.0))
        self.many = with_any_lengths(scene.linkage, self.lengths)

    def are_allowed(self) -> Array:
        """Return which designs have values that the table of parameters allows, shape (n,)."""
        is_allowed = np.ones(self.size, bool)
        for name, column in self.values.items():
            parameter = find_parameter(name)
            if isinstance(column, np.ndarray) and parameter is not None:
                value = column[:, 0]
                is_allowed &= (np.isfinite(value) & (value >= parameter.low)
                               & (value <= parameter.high)
                               & ((value > 0.0) | (not parameter.positive)))
        return is_allowed

    def step(self, acceleration: float, with_loads: bool, names: tuple[str, ...] | None = None
             ) -> Callable[[Array], State]:
        """
        Return the function of inputs, shape (n, any), real or complex, to (motion, loads).

        ``names``: of the fields, by default all; others are NaN.
        """
        linkage, speed = self.scene.linkage, self.values['drive.speed']
        with_loads, count = with_loads and linkage.bodies is not None, len(linkage.MOTION._fields)
        known = linkage.MOTION._fields + linkage.LOADS._fields
        step = step_of_arrays(linkage, with_loads, data=self._constants,
                              wanted=None if names is None else [*map(known.index, names)])

        def state(x: Array) -> State:
            # of inputs that are the same for all designs, functions of them alone once
            with np.errstate(all='ignore'):
                fields = step(x if x.strides[0] else x[:1], speed, acceleration)
            return (linkage.MOTION(*fields[:count]),
                    linkage.LOADS(*fields[count:]) if with_loads else NoLoads())
        return state

    def margins(self) -> Array | None:
        """
        Return :attr:`.Mechanism.margins` over the sum of lengths, shape (margins, n).

        None if this kind's margins are no sums of its lengths with signs.
        """
        signs = parametric.margin_signs(self.scene.linkage)
        sizes = np.abs(np.concatenate(self.lengths, axis=1))
        return None if signs is None else np.asarray((signs @ sizes.T) / sizes.sum(axis=1))
