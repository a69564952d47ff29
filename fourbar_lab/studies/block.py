# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The measures of many designs at once: one mechanism whose lengths are columns of shape (n, 1).

:mod:`fourbar_ros.extrema.full_turns` says whose cranks certainly turn fully, searches these, and
says which results are in doubt; these and all others are left to :class:`.Design`.
"""
from __future__ import annotations

from collections.abc import Callable, Sequence
from math import tau
import re

from fourbar_lab.studies import measures as kinds
from fourbar_lab.studies.measures import Extent, Measure, Measures
from fourbar_lab.studies.study import first_scene, Study
from fourbar_ros.errors import InvalidParameter
from fourbar_ros.extrema import full_turns
from fourbar_ros.extrema.over_input import are_equal, settled, time_ratio
from fourbar_ros.extrema.turns_by_pieces import search_pieces
from fourbar_ros.mechanisms.batches import are_switched, step_of_arrays
from fourbar_ros.mechanisms.elements import refuses_turns, turns_of
from fourbar_ros.mechanisms.parts import NoLoads, OPEN, Quantity
from fourbar_ros.mechanisms.pieces import CutCurves, ends_of_turns, PieceEnds
from fourbar_ros.mechanisms.points import with_any_lengths
from fourbar_ros.mechanisms.quantities import Asked, is_position, is_published, OfDrive
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.scene import parametric
from fourbar_ros.scene.parameters import find_parameter
from fourbar_ros.scene.scene import from_values, Scene
import numpy as np

FRICTION = re.compile(r'friction\.\w+\.(coefficient|radius|slip_speed)')
TRIED = 100         # designs, for one that can be built
# Designs that are computed together, and samples of them: they stay in the processor's cache.
TOGETHER = 256
SAMPLES_TOGETHER = 12288
CUT_TOGETHER = 1024     # ... whose pieces of loads are looked for together
# Samples of a turn: more of them for designs that few do not resolve.
SAMPLES = (96, 192, 512, 1536)
# Nearer to a change point, relative to the sum of lengths, a type is left to exact sums.
NEAR = 1e-9


def compute_together(study: Study, drawn: dict[str, Array], columns: dict[str, Array]) -> Array:
    """
    Fill columns with the measures of designs computed together; return which are right, (n,).

    ``drawn``: {parameter that varies: values, shape (n,)}; ``columns``: {measure: values, (n,)}.
    Not computed so: drives at rest, quantities of the drive at rates of their own, ranges, driven
    slides, and designs where lengths, samples or search leave a doubt, or which lock.
    """
    none = np.zeros(len(next(iter(drawn.values()))), bool)
    try:
        scene = first_scene(study, {name: column[:TRIED] for name, column in drawn.items()})
    except InvalidParameter:
        return none
    if scene.linkage.is_driven_by_slide or scene.linkage.stroke:
        return none
    # formulas without dry friction or slip speed are others, and pins have a radius
    if any(FRICTION.fullmatch(name) and not (column > 0.0).all()
           for name, column in drawn.items()):
        return none
    if not scene.linkage.turns_fully and any(map(refuses_turns, scene.linkage.elements)):
        return none
    measures, designs = Measures(scene), Designs(scene, drawn)
    is_done, margins = designs.are_allowed(), designs.margins()
    is_done &= np.ravel(designs.values['drive.speed']) != 0.0
    # type and distance from a change point follow from the lengths alone
    if margins is None:
        is_done &= columns.keys().isdisjoint((kinds.CLASS, kinds.CHANGE_POINT))
    else:
        is_done &= (np.abs(margins) > NEAR).all(axis=0)
    if kinds.CHANGE_POINT in columns and margins is not None:
        columns[kinds.CHANGE_POINT][:] = np.abs(margins).min(axis=0)
    if kinds.CLASS in columns and margins is not None:
        # designs whose margins have equal signs are of one type: a design of each group is asked
        keys = (1 << np.arange(len(margins))) @ (margins > 0.0)     # the signs as bits
        for key in np.unique(keys[is_done]).tolist():
            alike = np.nonzero((keys == key) & is_done)[0]
            values = {name: column[alike[0]].item() for name, column in drawn.items()}
            try:
                columns[kinds.CLASS][alike] = from_values(
                    {**study.values, **values}).linkage.classification
            except InvalidParameter:
                is_done[alike] = False
    wanted = is_done.copy()
    for bound in study.bounds:
        if bound.measure.part in (kinds.CLASS, kinds.CHANGE_POINT) and not study.keeps_all:
            wanted &= bound.allows_each(columns)
    needed = list(dict.fromkeys(name for measure in study.measures
                                for name in measures.smooth_sources(measure)))
    if any(isinstance(measures.quantities[name], OfDrive) for name in needed):
        return none

    def some(rows: Array) -> Designs:
        return Designs(designs.scene, {name: column[rows] for name, column in drawn.items()})
    unsure = in_groups(np.nonzero(wanted)[0],
                       lambda rows, samples: some(rows).are_known_to_turn(samples))
    is_done[unsure] = wanted[unsure] = False
    # where the pieces of loads end
    cuts = PieceEnds(np.empty((is_done.size, 0)), np.empty((is_done.size, 0), bool))
    if any(measures.quantities[name].is_load for name in needed):
        indices = np.nonzero(wanted)[0]
        for start in range(0, indices.size, CUT_TOGETHER):
            rows = indices[start:start + CUT_TOGETHER]
            ends = some(rows).ends(study.acceleration)
            wider = max(0, ends.inputs.shape[1] - cuts.inputs.shape[1])
            cuts = PieceEnds(*[np.pad(table, ((0, 0), (0, wider)), constant_values=filler)
                               for table, filler in zip(cuts, (np.nan, False))])
            for table, of_rows in zip(cuts, ends):
                table[rows, :of_rows.shape[1]] = of_rows

    def work(rows: Array, samples: int) -> Array:
        group = some(rows)
        known = measures.quantities | parametric.point_quantities_of(scene, group.values,
                                                                     group.many)
        most = np.isfinite(cuts.inputs[rows]).sum(axis=1).max()
        cut = PieceEnds(*[table[rows, :most] for table in cuts]) if most else None
        is_right, searched = np.ones(rows.size, bool), dict[str, tuple[full_turns.Turns, int]]()
        for ends in (None,) if cut is None else (None, cut):
            names = [name for name in needed
                     if cut is None or known[name].is_load == (ends is not None)]
            if names:
                turns = search(group, [quantity for name in names if not isinstance(
                    quantity := known[name], OfDrive)], study.acceleration, samples, ends)
                is_right &= ~turns.is_doubtful
                searched |= {name: (turns, row) for row, name in enumerate(names)}
        for measure in study.measures:
            if measure.part == kinds.INPUT_RANGE:
                columns[measure.name][rows[is_right]] = tau
            elif measure.part not in (kinds.CLASS, kinds.CHANGE_POINT):
                signed = group.cycle * np.sign(np.ravel(group.values['drive.speed']))
                values, are_right = zip(*[_measured(measure, *searched[name], signed)
                                          for name in measures.smooth_sources(measure)])
                is_right &= np.logical_and.reduce(are_right)
                columns[measure.name][rows[is_right]] = np.minimum.reduce(values)[is_right]
        return is_right

    # those with as many ends beside each other
    order = np.argsort(np.isfinite(cuts.inputs).sum(axis=1), kind='stable')
    is_done[in_groups(order[wanted[order]], work)] = False
    return is_done


def _measured(measure: Measure, turns: full_turns.Turns, row: int, cycle: Array
              ) -> tuple[Array, Array]:
    """Return a measure of the quantity in a row of turns, and for which designs it is right."""
    # cycle: after how much of the input all repeats [rad], negative where it goes backward.
    inputs, values = turns.inputs[row], turns.values[row]
    if measure.part in kinds.MEANS:
        mean, rms = turns.means[row], np.sqrt(turns.mean_squares[row])
        of_part = {'rms': rms, 'mean': mean, kinds.WORK: np.asarray(cycle * settled(mean, rms))}
        are_right = turns.are_squares if measure.part == 'rms' else turns.are_means
        return of_part[measure.part], are_right[row]
    if not values.shape[-1]:
        inputs = values = np.full((len(values), 1), np.nan)
    designs, every = np.arange(len(values)), np.ones(len(values), bool)
    most, least = (pick.reduce(values, axis=1) for pick in (np.fmax, np.fmin))
    largest = np.maximum(np.abs(most), np.abs(least))[:, None]
    are_most, are_least = (are_equal(values, best[:, None], largest) for best in (most, least))
    # of equal ones the first
    most_at, least_at = (inputs[designs, np.argmax(are_best, axis=1)]
                         for are_best in (are_most, are_least))
    if measure.part == kinds.TIME_RATIO:
        has_ratio = (are_most.sum(axis=1) == 1) & (are_least.sum(axis=1) == 1)
        return np.where(has_ratio & ~turns.are_turning[row], time_ratio(least_at, most_at, tau),
                        np.nan), every
    if measure.part in (kinds.SWING, kinds.STROKE):
        is_turn = (measure.part == kinds.SWING) & turns.are_turning[row]
        return np.where(is_turn, tau, most - least), is_turn | (turns.counts[row] > 0)
    extent = Extent(most, most_at, least, least_at, turns.counts[row])
    return np.asarray(extent.of(measure.part)), every


def in_groups(rows: Array, work: Callable[[Array, int], Array], together: int = TOGETHER
              ) -> Array:
    """Do work for designs, by index, ``together`` at a time; return those that are not done."""
    # work: (some rows, samples of a turn) -> which of them are done, a mask. It is asked again,
    # with more samples, for those where samples or search leave a doubt.
    for samples in SAMPLES:
        left = [rows[:0]]
        for start in range(0, rows.size, together):
            group = rows[start:start + together]
            left.append(group[~work(group, samples)])
        rows = np.concatenate(left)
    return rows


def search(designs: Designs, quantities: Sequence[Asked], acceleration: float, count: int,
           ends: PieceEnds | None = None) -> full_turns.Turns:
    """Return the extrema of quantities of all designs; ``ends``: as of :meth:`Designs.ends`."""
    is_angle = np.array([is_position(quantity) and quantity.unit == 'rad'
                         for quantity in quantities], bool)
    evaluate = designs.function_of(quantities, acceleration)
    if ends is not None:
        return search_pieces(evaluate, ends, count, designs.cycle)
    return full_turns.search_turns(evaluate, designs.size, count, is_angle)


class Designs:
    """n designs of a scene, evaluated together: its lengths are columns, shape (n, 1)."""

    def __init__(self, scene: Scene, drawn: dict[str, Array]):
        self.size = len(next(iter(drawn.values())))
        columns = {name: np.asarray(column, float)[:, None] for name, column in drawn.items()}
        self.values = {**scene.values, **columns}
        constants = parametric.constants_of(scene, self.values)
        self.scene = parametric.alike(scene, constants)
        if 'linkage.mode' in drawn:
            constants = constants._replace(
                sign=np.where(self.values['linkage.mode'] == OPEN, 1.0, -1.0))
        self._constants = constants
        self.many = with_any_lengths(scene.linkage, constants.lengths)

    @property
    def cycle(self) -> float:
        """Return after how much of the input all repeats, forces over the input too [rad]."""
        return tau * turns_of(self.scene.linkage.elements)

    def ends(self, acceleration: float) -> PieceEnds:
        """Return where the pieces of loads end, as :func:`.ends_of_turns`."""
        linkage, rates = self.scene.linkage, (self.values['drive.speed'], acceleration)
        if not (linkage.elements or linkage.friction):
            return PieceEnds(np.empty((self.size, 0)), np.empty((self.size, 0), bool))
        curves = CutCurves(linkage, self._constants, self.size,
                           rates if linkage.friction else None)
        return ends_of_turns(curves, self.size, turns_of(linkage.elements))

    def are_allowed(self) -> Array:
        """Return which designs have values that the table of parameters allows, shape (n,)."""
        is_allowed = np.ones(self.size, bool)
        for name, column in self.values.items():
            parameter = find_parameter(name)
            if isinstance(column, np.ndarray) and parameter is not None:
                value, may_be_negative = column[:, 0], not parameter.positive
                is_allowed &= np.isfinite(value) & (value >= parameter.low)
                is_allowed &= (value <= parameter.high) & ((value > 0.0) | may_be_negative)
                if name.endswith('.factor'):        # 1 is no area, of a table of pressures
                    is_allowed &= value != 1.0
        return is_allowed

    def are_known_to_turn(self, count: int) -> Array:
        """Return whose dyads are certainly nowhere in line, by ``count`` samples, shape (n,)."""
        linkage = self.scene.linkage
        sines = [Quantity(name, '', '', False) for name in linkage.MOTION._fields
                 if name.startswith('sine')]
        samples = self.function_of(sines, 0.0)(
            np.broadcast_to(full_turns.inputs(count), (self.size, count)), np.arange(self.size))
        # the branch of a change point depends on where it lies flat
        is_known = ~np.broadcast_to(are_switched(linkage, self._constants), (self.size, 1))[:, 0]
        return is_known & full_turns.turn_fully(samples)

    def function_of(self, quantities: Sequence[Asked], acceleration: float
                    ) -> full_turns.ColumnFunction:
        """Return inputs of some designs -> their quantities; of no other field than is needed."""
        linkage, speed = self.scene.linkage, self.values['drive.speed']
        with_loads = linkage.has_loads and any(quantity.is_load for quantity in quantities)
        count, known = len(linkage.MOTION._fields), linkage.MOTION._fields + linkage.LOADS._fields
        step = step_of_arrays(
            linkage, with_loads, data=self._constants,
            wanted=([known.index(quantity.name) for quantity in quantities]
                    if all(map(is_published, quantities)) else None))

        def evaluate(x: Array, which: Array) -> Array:
            """Return all quantities, shape (q, m, any), at inputs of shape (m, any) of m rows."""
            of_all = x
            if which.size < self.size:      # columns of designs that are not asked for get 1
                of_all = np.ones((self.size, x.shape[1]), x.dtype)
                of_all[which] = x
            values = np.empty((len(quantities), *of_all.shape), x.dtype)
            width = max(1, SAMPLES_TOGETHER // self.size)
            for begin in range(0, x.shape[1], width):
                columns = slice(begin, begin + width)
                x_there = of_all[:, columns]
                # of inputs that are the same for all designs, functions of them alone once
                with np.errstate(all='ignore'):
                    fields = step(x_there if x_there.strides[0] else x_there[:1], speed,
                                  acceleration)
                motion = linkage.MOTION(*fields[:count])
                loads = linkage.LOADS(*fields[count:]) if with_loads else NoLoads()
                for row, quantity in zip(values, quantities):
                    row[:, columns] = quantity.of(motion, loads)
            return values[:, which]
        return evaluate

    def margins(self) -> Array | None:
        """Return the margins over the sum of lengths, (margins, n); None if no such sums."""
        signs = parametric.margin_signs(self.scene.linkage)
        if signs is None:
            return None
        sizes = np.abs([np.broadcast_to(length, (self.size, 1))[:, 0]
                        for length in self._constants.lengths])
        return np.asarray((signs @ sizes) / sizes.sum(axis=0))
