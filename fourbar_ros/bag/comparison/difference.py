# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Differences between recorded and recomputed messages, and which of them rounding explains.

Two versions of the software whose values are each within ACCURACY eps times condition of the exact
ones (docs/accuracy.md) differ by at most twice that. The condition of a value is the sum of
|p dv/dp| over all numbers p that it depends on, plus |v|.
"""
from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from math import inf, isnan
from operator import attrgetter
from typing import NamedTuple

from fourbar_ros.bag.comparison.window import Window
from fourbar_ros.bag.read.records import Columns
from fourbar_ros.errors import FourBarError
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.pipeline.stepper import Stepper
from fourbar_ros.pipeline.wrenches import Wrench
from fourbar_ros.scene.scene import from_values, Scene
import numpy as np
from numpy.typing import NDArray

ACCURACY = 5.0          # eps times condition
LIMIT = 2.0 * ACCURACY
PLAIN = 2.0             # eps of the value itself; less is not looked at closer: |v| <= condition
EPS = float(np.finfo(float).eps)
DUST = 1e-90, 1e-60      # of a number that must not be zero, and its products
STEP = 2.0**-26         # relative; half of the digits of a difference quotient are good
# what a planar linkage does not have
PLANAR = ('wrench.force.z', 'wrench.torque.x', 'wrench.torque.y')
# parameters on which values of the mechanism depend
GROUPS = ('linkage.', 'dyads.', 'cylinder.', 'bodies.', 'gravity.', 'external.', 'points.')


class Difference(NamedTuple):
    """
    Largest difference of one field of one topic over all its messages; of texts infinite.

    ``units``: the largest one in eps times the condition of the value, infinite if not known.
    """

    topic: str
    field: str
    messages: int
    largest: float
    units: float = inf

    @property
    def is_rounding(self) -> bool:
        """Return whether two versions of the software may differ so by rounding."""
        return self.largest == 0.0 or self.units <= LIMIT


class Recomputed(NamedTuple):
    """
    The result of recomputing a bag.

    Attributes
    ----------
    differences : list of Difference
    inputs, compared : int
        Driven motions, and outputs that were recomputed from them.
    unmatched : int
        Outputs whose motion is not in the bag.
    missing, doubled : int
        Outputs that a motion should have and has not, or has once more.
    silent, uncertain : int
        Outputs that say that the input had stopped; outputs that depend on what the bag cannot
        tell: values held from before a part of a split bag, the order around a change of the scene
        in a bag of rosbag2.
    driven : str
        How the motion of the driven joint itself was checked.
    cut : bool
        The bag ends without an end.

    """

    differences: list[Difference]
    inputs: int
    compared: int
    unmatched: int
    missing: int
    doubled: int
    silent: int
    uncertain: int
    driven: str
    cut: bool

    @property
    def largest(self) -> float:
        """Return the largest of all differences."""
        return max((difference.largest for difference in self.differences), default=0.0)

    @property
    def units(self) -> float:
        """Return the largest of all differences in eps times condition."""
        return max((difference.units for difference in self.differences if difference.largest),
                   default=0.0)

    @property
    def is_rounding(self) -> bool:
        """Return whether there are differences, and rounding explains all of them."""
        return self.largest > 0.0 and all(d.is_rounding for d in self.differences)

    def verdict(self) -> str:
        """Return one line about the differences; empty if there are none."""
        if not self.largest:
            return ''
        real = [difference for difference in self.differences if not difference.is_rounding]
        if not real:
            return (f'differences by rounding only: at most {self.units:.2g} eps times the '
                    f'condition of the value; two versions may differ by {LIMIT:g}')
        worst = max(real, key=lambda difference: difference.units)
        size = (f'{worst.units:.2g} eps times the condition of the value; rounding explains '
                f'{LIMIT:g}' if worst.units < inf else 'which rounding does not explain')
        return f'real differences: {worst.topic} {worst.field} by {worst.largest:g}, {size}'

    def problems(self, tolerance: float = 0.0, accept_rounding: bool = False) -> list[str]:
        """
        Return the problems as a list of texts; empty for a good bag.

        ``tolerance``: differences up to this count as none; ``accept_rounding``: so do those that
        rounding explains.
        """
        counts = ((self.unmatched, 'outputs without their motion'),
                  (self.missing, 'outputs missing'),
                  (self.doubled, 'outputs more than once'))
        found = [f'{count} {text}' for count, text in counts if count]
        if self.largest > tolerance and not (accept_rounding and self.is_rounding):
            found.insert(0, f'differences up to {self.largest:g}')
        return found if self.compared else ['nothing could be compared', *found]


def distance(a: Array, b: Array) -> float:
    """
    Return the largest difference of two arrays.

    NaN equals NaN; NaN against a number is infinite.
    """
    with np.errstate(invalid='ignore'):
        distance = np.abs(a - b)
    unknown = np.isnan(distance)
    if unknown.any():           # inf - inf, or NaN on one side or both
        distance = np.where(unknown, np.where((a == b) | (np.isnan(a) & np.isnan(b)), 0.0, inf),
                            distance)
    return float(distance.max())


def distance_of_two(a: float, b: float) -> float:
    """Return the difference of two numbers, by the rules of :func:`distance`."""
    if a == b or (isnan(a) and isnan(b)):
        return 0.0
    return inf if isnan(a - b) else abs(a - b)


class Condition:
    """
    The conditions of all values of a scene.

    Parameters
    ----------
    scene : Scene
    wrenches : dict
        Wrenches by link, as a :class:`~fourbar_ros.pipeline.stepper.Stepper` keeps them.

    """

    def __init__(self, scene: Scene, wrenches: dict[str, Wrench]) -> None:
        self._linkage = scene.linkage
        self._wanted = scene.needs_loads, 'points' in scene.outputs
        self._steppers = [Stepper(other, wrenches) for other in (scene, *_perturbed(scene))]

    def of(self, motions: Array) -> Array:
        """Return the conditions, shape (values, n), for motions (position, ...), shape (3, n)."""
        return np.array([self._of_one(motion) for motion in motions.T.tolist()]).T

    def _of_one(self, motion: list[float]) -> Array:
        first, *others = self._steppers
        values = self._values(first, motion)
        changed = [self._values(other, motion) for other in others]
        changed += [self._values(first, other) for other in self._neighbours(motion)]
        with np.errstate(invalid='ignore'):
            apart = abs(np.array(changed) - values) / STEP
        # NaN: there is no such value, or no pose beside this one; that only lowers the sum
        found: Array = np.nan_to_num(apart, posinf=0.0).sum(axis=0) + np.nan_to_num(abs(values))
        return found

    def _neighbours(self, motion: list[float]) -> Iterator[list[float]]:
        """Yield the motion with one of its numbers changed, an angle by its part of one turn."""
        steps = (self._linkage.distance(motion[0], 0.0), *motion[1:])
        for i, step in enumerate(steps):
            yield [*motion[:i], motion[i] + step * STEP, *motion[i + 1:]]

    def _values(self, stepper: Stepper, motion: list[float]) -> Array:
        position, rate, acceleration = motion
        return np.array(stepper.step(position, rate, acceleration, *self._wanted)[1], np.float64)


def _perturbed(scene: Scene) -> Iterator[Scene]:
    """Yield the scene with one of its numbers changed, for each that the mechanism depends on."""
    for name, value in scene.values.items():
        is_number = isinstance(value, float) and value and not isnan(value)
        if is_number and name.startswith(GROUPS) and not name.endswith('timeout'):
            try:
                yield from_values({**scene.values, name: value * (1.0 + STEP)})
            except FourBarError:        # not allowed: a body with less inertia than its mass has
                continue


def units(want: Array, have: Array, condition: Array) -> float:
    """
    Return the largest difference in eps times condition; infinite if a value is not finite.

    The arrays have one shape; where a condition is not known, 0 stands for it.
    """
    with np.errstate(invalid='ignore', divide='ignore'):
        apart = abs(want - have)
        apart[(want == have) | (np.isnan(want) & np.isnan(have))] = 0.0
        found = apart / (EPS * np.maximum(np.nan_to_num(condition), np.nan_to_num(abs(want))))
    found = np.where(apart == 0.0, 0.0, np.where(np.isnan(found), np.inf, found))
    return float(found.max(initial=0.0))


def without_dust(want: Array, have: Array) -> Array:
    """Return recorded values with zeros for the 1e-74 that version 1.0.0 gave at input 0."""
    return np.where((want == 0.0) & (DUST[0] < abs(have)) & (abs(have) < DUST[1]), want, have)


def needs_condition(want: Array, have: Array) -> NDArray[np.bool_]:
    """Return a mask of the messages (last axis) with a value off by more than PLAIN eps of it."""
    with np.errstate(invalid='ignore'):
        wide = abs(want - have) > PLAIN * EPS * abs(want)
    return np.asarray(wide if wide.ndim == 1 else wide.any(axis=tuple(range(wide.ndim - 1))))


class Differences:
    """
    The largest difference of each field of each output, over all its messages.

    Attributes
    ----------
    counts : dict
        {output: messages}.
    largest, units : dict
        {(output, field): difference}, absolute and in eps times the condition of the value.

    """

    def __init__(self) -> None:
        self.counts: dict[str, int] = {}
        self.largest: dict[tuple[str, str], float] = {}
        self.units: dict[tuple[str, str], float] = {}

    def change(self, scene: Scene, wrenches: dict[str, Wrench]) -> None:
        """Take another scene, and the wrenches by link that act in it."""
        self._scene, self._wrenches, self._layout = scene, wrenches, scene.layout
        self._condition: Condition | None = None     # of the scene, when it is needed
        self._constant = {'change_point_margin': scene.linkage.change_point_margin,
                          **dict.fromkeys(PLANAR, 0.0)}
        self._texts = {'header.frame_id': scene.frame_id, 'name': scene.names_shown}

    def compare(self, name: str, columns: Columns, window: Window, source: Array) -> None:
        """Compare messages of an output with the motions of a window that they belong to."""
        count = len(source)
        self.counts[name] = self.counts.get(name, 0) + count
        tree = columns.tree
        expected = (self._layout.expected(name, window.values[:, source])
                    | {'status': window.status[source], 'mode': window.modes[source]}
                    | self._constant)
        differing = {}
        # a bag of an older version may have fewer fields
        for field in expected.keys() & set(columns.fields):
            want, have = _rows_of(expected[field], count), attrgetter(field)(tree)
            same = want.shape[:-1] == have.shape[:-1]            # as many joints
            if same:
                have = without_dust(want, have)
            largest = distance(want, have) if same else inf
            self.note(name, field, largest)
            if same and largest:
                differing[field] = want, have
        if differing:
            self._note_units(name, differing, window, source)
        self.compare_texts(name, [columns])

    def _note_units(self, name: str, differing: Mapping[str, tuple[Array, Array]], window: Window,
                    source: Array) -> None:
        """Note the differences {field: (want, have)} of messages in eps times condition."""
        rows = np.zeros(len(source), bool)
        for pair in differing.values():
            rows |= needs_condition(*pair)
        conditions = np.zeros((len(window.values), len(source)))
        if rows.any():
            if self._condition is None:
                self._condition = Condition(self._scene, self._wrenches)
            conditions[:, rows] = self._condition.of(window.motions[:, source[rows]])
        of_fields = self._layout.expected(name, conditions)
        for field, (want, have) in differing.items():
            known = _rows_of(of_fields.get(field, 0.0), len(source))
            self.units[name, field] = max(self.units.get((name, field), 0.0),
                                          units(want, have, np.broadcast_to(known, want.shape)))

    def compare_texts(self, name: str, blocks: Iterable[Columns]) -> None:
        """Compare the texts of messages: frame and names of joints."""
        for columns in blocks:
            for field, want in self._texts.items():
                if field in columns.fields:
                    good = bool((columns.records[field] == str(want).encode()).all())
                elif field in columns.layout.texts:
                    good = columns.layout.texts[field] == want
                else:
                    continue
                self.note(name, field, 0.0 if good else inf)

    def note(self, name: str, field: str, value: float) -> None:
        """Note a difference."""
        self.largest[name, field] = max(self.largest.get((name, field), 0.0), value)

    def as_list(self, topics: Mapping[str, str]) -> list[Difference]:
        """Return a :class:`Difference` for each field; ``topics``: {output: topic}."""
        return [Difference(topics[name], field, self.counts[name], value,
                           self.units.get((name, field), inf if value else 0.0))
                for (name, field), value in self.largest.items() if name in self.counts]


def _rows_of(value: float | Array | tuple[float | Array, ...], count: int) -> Array:
    """Return a value of ``count`` messages, or a tuple of them, as an array (..., count)."""
    if isinstance(value, tuple):
        return np.stack([np.broadcast_to(part, count) for part in value])
    return np.broadcast_to(value, count)
