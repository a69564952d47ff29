# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Differences between recorded and recomputed messages, and which of them rounding explains.

Values of each version of the software are within ACCURACY eps times condition of the exact ones
(docs/accuracy.md). So two versions differ by at most twice that. The condition of a value is the
sum of |p dv/dp| over all numbers p that it depends on, plus |v|.
"""
from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
import contextlib
from math import inf, isnan
from operator import attrgetter
from typing import NamedTuple

from fourbar_ros.bag.comparison.window import Window
from fourbar_ros.bag.read.records import Columns
from fourbar_ros.errors import FourBarError
from fourbar_ros.numerics.arrays import Array, EPS
from fourbar_ros.pipeline.stepper import Stepper
from fourbar_ros.pipeline.wrenches import Wrench
from fourbar_ros.scene.scene import from_values, Scene
import numpy as np
from numpy.typing import NDArray

ACCURACY = 5.0          # eps times condition
LIMIT = 2.0 * ACCURACY
PLAIN = 2.0             # eps of the value itself: always rounding, since |v| <= condition
STEP = 2.0**-26         # relative step of a difference quotient: half of the 53 bits stay good
# Version 1.0.0 recorded residues of this size for values that are 0: omega3 = 2.6e-74 at input 0.
DUST = 1e-90, 1e-60
# fields of standard messages that a planar linkage leaves 0
PLANAR = ('wrench.force.z', 'wrench.torque.x', 'wrench.torque.y')
# parameters on which values of the mechanism depend
GROUPS = ('linkage.', 'dyads.', 'cylinder.', 'bodies.', 'gravity.', 'external.', 'points.')


class Difference(NamedTuple):
    """
    Largest difference of one field of one topic over all its messages; of texts infinite.

    ``units`` is the largest one in eps times the condition of the value, infinite if not known.
    """

    topic: str
    field: str
    messages: int
    largest: float
    units: float = inf

    @property
    def is_rounding(self) -> bool:
        """Return whether rounding explains the difference, as between two versions."""
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
    silent : int
        Outputs that only say that the input had stopped: nothing to recompute.
    uncertain : int
        Outputs that depend on facts missing from the bag: values held from before a part of a
        split bag, or the order around a change of the scene in a bag of ``ros2 bag``.
    driven : str
        How the motion of the driven joint itself was checked, in one line.
    cut : bool
        The recording broke off: the bag has no end.

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
        """Say in one line whether rounding explains the differences; empty if there are none."""
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
        Return the faults of a bag, one text each; empty for a good one.

        Differences up to ``tolerance`` count as none. With ``accept_rounding``, differences that
        rounding explains count as none too.
        """
        counts = ((self.unmatched, 'outputs without their motion'),
                  (self.missing, 'outputs missing'),
                  (self.doubled, 'outputs more than once'))
        texts = [f'{count} {text}' for count, text in counts if count]
        if self.largest > tolerance and not (accept_rounding and self.is_rounding):
            texts.insert(0, f'differences up to {self.largest:g}')
        return texts if self.compared else ['nothing could be compared', *texts]


def distance(a: Array, b: Array) -> float:
    """
    Return the largest |a - b| of two arrays of numbers.

    NaN equals NaN, since both then say "unknown"; NaN against a number is infinite.
    """
    with np.errstate(invalid='ignore'):
        apart = np.abs(a - b)
    unknown = np.isnan(apart)
    if unknown.any():           # inf - inf, or NaN on one side or both
        is_same = (a == b) | (np.isnan(a) & np.isnan(b))
        apart = np.where(unknown, np.where(is_same, 0.0, inf), apart)
    return float(apart.max())


def distance_of_two(a: float, b: float) -> float:
    """Return |a - b| by the rules of :func:`distance`, for two plain floats."""
    if a == b or (isnan(a) and isnan(b)):
        return 0.0
    return inf if isnan(a - b) else abs(a - b)


class Condition:
    """
    The conditions of all output values of a scene, by difference quotients.

    Each number p that a value v depends on (lengths, masses, gravity, input, ...) is changed by
    2^-26 of itself. The changes of v over 2^-26 add up to the sum of |p dv/dp|. ``wrenches`` are
    by link, as a :class:`~fourbar_ros.pipeline.stepper.Stepper` keeps them.
    """

    def __init__(self, scene: Scene, wrenches: dict[str, Wrench]) -> None:
        self._linkage = scene.linkage
        self._wanted = scene.needs_loads, 'points' in scene.outputs
        self._stepper = Stepper(scene, wrenches)
        self._perturbed = [Stepper(other, wrenches) for other in _perturbed(scene)]

    def of(self, motions: Array) -> Array:
        """Return the conditions, shape (values, n), for motions (position, ...), shape (3, n)."""
        return np.array([self._of_one(motion) for motion in motions.T.tolist()]).T

    def _of_one(self, motion: list[float]) -> Array:
        """
        Return sum |p dv/dp| + |v| of each value v, shape (values,), for one driven motion.

        The motion, (position, velocity, acceleration), is changed like the numbers of the scene.
        """
        values = self._values(self._stepper, motion)
        changed = [self._values(stepper, motion) for stepper in self._perturbed]
        # an angle is known up to rounding of its part of one turn, not of all turns
        sizes = (self._linkage.distance(motion[0], 0.0), *motion[1:])
        for i, size in enumerate(sizes):
            other = [*motion[:i], motion[i] + size * STEP, *motion[i + 1:]]
            changed.append(self._values(self._stepper, other))
        with np.errstate(invalid='ignore'):
            apart = abs(np.array(changed) - values) / STEP
        # NaN: there is no such value, or no pose beside this one; that only lowers the sum
        return np.asarray(np.nan_to_num(apart, posinf=0.0).sum(axis=0)
                          + np.nan_to_num(abs(values)))

    def _values(self, stepper: Stepper, motion: list[float]) -> Array:
        """Return all values that a scene publishes for one driven motion."""
        position, rate, acceleration = motion
        return np.array(stepper.step(position, rate, acceleration, *self._wanted)[1], np.float64)


def _perturbed(scene: Scene) -> Iterator[Scene]:
    """Yield scenes with one parameter changed by 2^-26 of itself, one for each that matters."""
    for name, value in scene.values.items():
        is_number = isinstance(value, float) and value and not isnan(value)
        if is_number and name.startswith(GROUPS) and not name.endswith('timeout'):
            # such a scene may not be allowed: a body with less inertia than its mass has
            with contextlib.suppress(FourBarError):
                yield from_values({**scene.values, name: value * (1.0 + STEP)})


def rounding_units(expected: Array, recorded: Array, condition: Array) -> float:
    """
    Return the largest difference in eps times condition; infinite if a value is not finite.

    A condition of 0 means unknown: then the value itself replaces it. With values 1, 1 + 4 eps and
    condition 2 the result is 2.
    """
    with np.errstate(invalid='ignore', divide='ignore'):
        apart = abs(expected - recorded)
        apart[(expected == recorded) | (np.isnan(expected) & np.isnan(recorded))] = 0.0
        scale = np.maximum(np.nan_to_num(condition), np.nan_to_num(abs(expected)))
        units = apart / (EPS * scale)
    units = np.where(apart == 0.0, 0.0, np.where(np.isnan(units), np.inf, units))
    return float(units.max(initial=0.0))


def needs_condition(expected: Array, recorded: Array) -> NDArray[np.bool_]:
    """
    Return a mask of the messages (last axis) with a value off by more than PLAIN eps of itself.

    A condition costs an evaluation for each parameter, so only these messages get one.
    """
    with np.errstate(invalid='ignore'):
        is_wide = abs(expected - recorded) > PLAIN * EPS * abs(expected)
    return np.asarray(is_wide.any(axis=tuple(range(is_wide.ndim - 1))))


class Differences:
    """
    The largest difference of each field of each output, over all its messages.

    ``counts``: {output: messages}; ``largest``, ``units``: {(output, field): difference}, absolute
    and in eps times the condition of the value.
    """

    def __init__(self) -> None:
        self.counts: dict[str, int] = {}
        self.largest: dict[tuple[str, str], float] = {}
        self.units: dict[tuple[str, str], float] = {}

    def change(self, scene: Scene, wrenches: dict[str, Wrench]) -> None:
        """Compare with another scene from now on, and the wrenches by link that act in it."""
        self._scene, self._wrenches, self._layout = scene, wrenches, scene.layout
        self._condition: Condition | None = None     # of the scene, when it is needed
        self._constant = {'change_point_margin': scene.linkage.change_point_margin,
                          **dict.fromkeys(PLANAR, 0.0)}
        self._texts = {'header.frame_id': scene.frame_id, 'name': scene.names_shown}

    def compare(self, output: str, columns: Columns, window: Window, motions: Array) -> None:
        """
        Compare messages of an output with the values expected from their driven motions.

        ``motions`` has the index in the window of the motion of each message.
        """
        count = len(motions)
        self.counts[output] = self.counts.get(output, 0) + count
        tree = columns.tree
        expectations = (self._layout.expected(output, window.values[:, motions])
                        | {'status': window.status[motions], 'mode': window.modes[motions]}
                        | self._constant)
        differing = {}
        # a bag of an older version may have fewer fields
        for field in expectations.keys() & set(columns.fields):
            expected, recorded = _rows_of(expectations[field], count), attrgetter(field)(tree)
            if expected.shape[:-1] != recorded.shape[:-1]:         # another number of joints
                self.note(output, field, inf)
                continue
            is_dust = (expected == 0.0) & (DUST[0] < abs(recorded)) & (abs(recorded) < DUST[1])
            recorded = np.where(is_dust, expected, recorded)
            largest = distance(expected, recorded)
            self.note(output, field, largest)
            if largest:
                differing[field] = expected, recorded
        if differing:
            self._note_units(output, differing, window, motions)
        self.compare_texts(output, [columns])

    def _note_units(self, output: str, differing: Mapping[str, tuple[Array, Array]],
                    window: Window, motions: Array) -> None:
        """
        Note differences, {field: (expected, recorded)}, in eps times condition.

        ``motions``: the column of the window for each message. Conditions are dear: only messages
        that :func:`needs_condition` picks get one.
        """
        rows = np.zeros(len(motions), bool)
        for pair in differing.values():
            rows |= needs_condition(*pair)
        conditions = np.zeros((len(window.values), len(motions)))
        if rows.any():
            if self._condition is None:
                self._condition = Condition(self._scene, self._wrenches)
            conditions[:, rows] = self._condition.of(window.sources[:, motions[rows]])
        of_fields = self._layout.expected(output, conditions)
        for field, (expected, recorded) in differing.items():
            condition = np.broadcast_to(_rows_of(of_fields.get(field, 0.0), len(motions)),
                                        expected.shape)
            units = rounding_units(expected, recorded, condition)
            self.units[output, field] = max(self.units.get((output, field), 0.0), units)

    def compare_texts(self, output: str, blocks: Iterable[Columns]) -> None:
        """Compare the texts of messages with the scene's: frame and names of joints."""
        for columns in blocks:
            for field, expected in self._texts.items():
                if field in columns.fields:
                    is_same = bool((columns.records[field] == str(expected).encode()).all())
                elif field in columns.layout.texts:
                    is_same = columns.layout.texts[field] == expected
                else:
                    continue
                self.note(output, field, 0.0 if is_same else inf)

    def note(self, output: str, field: str, difference: float) -> None:
        """Keep a difference of a field if it is the largest so far."""
        self.largest[output, field] = max(self.largest.get((output, field), 0.0), difference)

    def as_list(self, topics: Mapping[str, str]) -> list[Difference]:
        """Return a :class:`Difference` for each field; ``topics``: {output: topic}."""
        return [Difference(topics[output], field, self.counts[output], value,
                           self.units.get((output, field), inf if value else 0.0))
                for (output, field), value in self.largest.items() if output in self.counts]


def _rows_of(value: float | Array | tuple[float | Array, ...], count: int) -> Array:
    """
    Return a value of n messages (``count``) as an array, of shape (n,) or (length, n).

    It is one number for all, an array of shape (n,), or a tuple of such for an array field.
    """
    if isinstance(value, tuple):
        return np.stack([np.broadcast_to(part, count) for part in value])
    return np.broadcast_to(value, count)
