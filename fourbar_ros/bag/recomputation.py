# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Compute every recorded output again, from the driven motion and the scene, and compare.

Both are in the bag: the motion as messages, the scene as its first message and again after every
change. A motion and its outputs have one stamp. In a bag of the node an output follows its motion;
in a bag of ``ros2 bag record`` it may also come first, so messages wait until both are there.
"""
from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Sequence
from math import inf
from pathlib import Path
from typing import Any, NamedTuple

from fourbar_ros import __version__
from fourbar_ros.bag.drive_states import DriveStates, mover_of, MoverOf
from fourbar_ros.bag.origin import Origin, origin_of, scene_of
from fourbar_ros.bag.reader import Bag, Progress, Raw, software_of, stamps_of
from fourbar_ros.errors import BagError
from fourbar_ros.mechanics.bodies import Base
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.pipeline.stepper import Evaluate, evaluate, InModes, INPUT_TIMEOUT, OK
from fourbar_ros.pipeline.wrenches import ActingInput, Wrench
from fourbar_ros.scene.scene import Scene
from fourbar_ros.scene.topics import (
    applied_topic,
    BASE,
    DRIVE_STATE,
    DRIVEN,
    ON_LINK,
    SCENE,
    TORQUE,
)
import numpy as np

BLOCK = 5000                # motions that are compared together
UNSETTLED = 200_000_000     # [ns] around a change, in which a bag of rosbag2 has no sure order
DUST = 1e-90, 1e-60     # of this size are what version 1.0.0 recorded for 0, omega3 = 2.6e-74
# fields of standard messages that a planar linkage leaves 0
PLANAR = ('wrench.force.z', 'wrench.torque.x', 'wrench.torque.y')
STOPPED, NEAR_A_CHANGE, BEFORE_THE_FILE, UNTOLD = (
    'say that the input had stopped', 'near a change of the scene or of what acts',
    'depend on what came before this file',
    'depend on a wrench or a base that is not in the bag (~/applied, ~/base)')


class Difference(NamedTuple):
    """Largest difference of one field of one topic over all its messages; of texts infinite."""

    topic: str
    field: str
    messages: int
    largest: float


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
    skipped : dict
        {reason: outputs that could not be compared}.
    stepped : int
        States of a drive that were computed again by a step from the one before; those at a start
        or from another version of the integrator have their accelerations and torques compared.
    is_cut : bool
        The recording broke off: the bag has no end.
    made_by : str
        The version of fourbar_ros that recorded it, empty if that is not known.

    """

    differences: list[Difference]
    inputs: int
    compared: int
    unmatched: int
    missing: int
    doubled: int
    skipped: dict[str, int]
    stepped: int
    is_cut: bool
    made_by: str = ''

    @property
    def largest(self) -> float:
        """Return the largest of all differences."""
        return max((difference.largest for difference in self.differences), default=0.0)

    def problems(self, tolerance: float = 0.0) -> list[str]:
        """Return the faults of a bag, one text each; differences up to ``tolerance`` are none."""
        counts = ((self.unmatched, 'outputs without their motion'),
                  (self.missing, 'outputs missing'), (self.doubled, 'outputs more than once'))
        texts = [f'{count} {text}' for count, text in counts if count]
        if self.largest > tolerance:
            texts.insert(0, f'differences up to {self.largest:g}' + (
                f' (recorded by fourbar_ros {self.made_by}; if that is rounding, --tolerance '
                'accepts it)' if self.made_by not in ('', __version__) else ''))
        return texts if self.compared else ['nothing could be compared', *texts]


def recompute(path: str | Path, node: str | None = None, progress: Progress | None = None,
              by: Evaluate = evaluate, moved_by: MoverOf = mover_of) -> Recomputed:
    """
    Compute all outputs of a bag again from their driven motions and compare field by field.

    Differences are absolute; NaN against NaN is none, NaN against a number infinite. Memory does
    not grow with the bag. ``node``: its name, if a bag of ``ros2 bag`` has several. In place of
    Python ``by`` computes motion and loads, as ``evaluate`` of generated code, and ``moved_by``
    makes the integrator of a drive. Raises BagError.
    """
    bag = Bag(path)
    origin = origin_of(bag, node)
    recomputation = Recomputation(bag, origin, by, moved_by)
    for place, raw in enumerate(bag.raw(set(origin.topics.values()), progress=progress)):
        recomputation.take(place, raw)
    if bag.damage:
        raise BagError(f'{bag.path}: {bag.damage[0]}; fourbar bag recover keeps the rest')
    return recomputation.finished()


class _Motion(NamedTuple):
    """A driven motion: place in the bag, stamp and log time [ns], position and its rates."""

    place: int
    stamp: int
    time: int
    motion: tuple[float, float, float]


class _Act(NamedTuple):
    """A wrench on a link, or another motion of the base, from here on."""

    place: int
    name: str
    what: ActingInput


class _Output(NamedTuple):
    """A recorded output that waits for its motion: place, log time [ns], bytes."""

    place: int
    time: int
    data: bytes


class Recomputation:
    """Takes the messages of a bag in order; compares outputs when their motions are known."""

    def __init__(self, bag: Bag, origin: Origin, by: Evaluate, moved_by: MoverOf) -> None:
        """Begin before the first message, with the scene at the start of the bag."""
        self._bag, self._origin, self._by = bag, origin, by
        self._names = {topic: name for name, topic in origin.topics.items()}
        self._largest: dict[tuple[str, str], float] = {}        # {(name, field): difference}
        self._counts: Counter[str] = Counter()      # messages of each output that were compared
        self._skipped: Counter[str] = Counter()
        self._inputs = self._unmatched = self._doubled = 0
        self._missing: dict[str, Missing] = {}
        self._events: list[_Motion | _Act] = []    # not yet evaluated
        self._outputs: defaultdict[str, list[_Output]] = defaultdict(list)
        self._modes: dict[int, int] = {}            # {stamp: mode}, where a drive passes toggles
        self._acting: dict[str, ActingInput] = {}    # the newest wrench on each link, and base
        self._changes = [-inf]                  # log times [ns] of new scenes and what acts
        self._holds_unknown = origin.is_later
        self._drive_states = None
        if origin.scene.dynamics and origin.in_order:
            self._drive_states = DriveStates(origin.scene, bag.about, moved_by)
        self._steppers: InModes | None = None
        self._begin(origin.scene)

    def _begin(self, scene: Scene) -> None:
        self._scene, self._topics = scene, scene.topics       # it makes them anew each time
        acting = self._steppers.acting if self._steppers else None
        self._steppers = InModes(scene, acting, self._by)
        # what acts, but the bag does not tell yet
        self._untold = {name for name in scene.acting
                        if applied_topic(name).name not in self._origin.topics
                        or self._origin.is_later and name not in self._acting}
        self._constant = {'change_point_margin': scene.linkage.change_point_margin,
                          **dict.fromkeys(PLANAR, 0.0)}
        self._texts = {'header.frame_id': scene.frame_id,
                       **{f'name[{i}]': name for i, name in enumerate(scene.names_shown)}}
        if self._drive_states:
            self._drive_states.change(scene)

    def take(self, place: int, raw: Raw) -> None:
        """Take the next message of the bag; ``place``: how many came before it."""
        name = self._names[raw.topic]
        if name in self._topics:
            self._outputs[name].append(_Output(place, raw.time, raw.data))
        elif name == DRIVEN.name:
            message = self._bag.decode(raw)
            self._check_frame(name, message)
            self._events.append(_Motion(place, _stamp_of(message), raw.time, (
                message.position, message.velocity, message.acceleration)))
            if len(self._events) >= 2 * BLOCK:
                self._compare(BLOCK)
        elif name == SCENE.name:
            scene = scene_of(self._bag, self._bag.decode(raw).data)
            # ros2 bag may hold the latched scene several times
            if self._origin.in_order or scene.as_json != self._scene.as_json:
                self._changes.append(raw.time)
                self._compare(len(self._events))
                self._begin(scene)
        elif name == BASE.name or name.startswith(ON_LINK):
            self._take_acting(place, raw, name.removeprefix(ON_LINK))
        elif self._drive_states and name == TORQUE.name:
            self._drive_states.command(self._bag.decode(raw))
        elif name == DRIVE_STATE.name:
            message = self._bag.decode(raw)
            self._modes[_stamp_of(message)] = message.mode
            if self._drive_states:
                self._check_frame(name, message)
                self._drive_states.take(_stamp_of(message), message)

    def _take_acting(self, place: int, raw: Raw, name: str) -> None:
        """Take the wrench in effect on a link, or the motion of the base."""
        message = self._bag.decode(raw)
        what: ActingInput
        if name == BASE.name:
            what = Base(message.force_x, message.force_y, message.rate, message.acceleration)
        else:
            force, torque = message.wrench.force, message.wrench.torque
            what = Wrench(force.x, force.y, torque.z)
        if what != self._acting.get(name):
            self._changes.append(raw.time)
        self._acting[name] = what
        if self._drive_states:
            self._drive_states.act(name, what)
        self._events.append(_Act(place, name, what))

    # --- motions --------------------------------------------------------------------------------

    def _compare(self, count: int) -> None:
        """Evaluate the first ``count`` events, compare the outputs of their motions."""
        events, self._events = self._events[:count], self._events[count:]
        window = self._evaluated(events) if events else None
        later = [event.stamp for event in self._events if isinstance(event, _Motion)]
        until = self._events[0].place if self._events else inf
        for name in self._topics:
            self._compare_output(name, window, later, until)
        newest = window.times[-1] if window else 0
        self._changes = [-inf, *(time for time in self._changes if time > newest - UNSETTLED)]

    def _evaluated(self, events: Sequence[_Motion | _Act]) -> Window | None:
        """
        Return the motions among events with the values that their outputs should have.

        They are evaluated one by one, as in the node: arrays may differ in the last bit.
        """
        assert self._steppers
        scene, steppers, rows = self._scene, self._steppers, []
        own, known = steppers.own_mode, scene.linkage.modes_passed
        needs_loads = scene.needs_loads     # it looks through all outputs each time
        for event in events:
            if isinstance(event, _Act):
                steppers.act(event.name, event.what)
                self._untold.discard(event.name)
                continue
            mode = self._modes.pop(event.stamp, own)
            mode = mode if mode in known else own
            status, values = steppers.step(mode, *event.motion, needs_loads, True)
            self._holds_unknown &= status != OK
            rows.append((event.place, event.stamp, event.time, mode, status,
                         self._why_skipped(event.time), values))
        self._inputs += len(rows)
        if not rows:
            return None
        window = Window(*map(np.array, zip(*rows)))
        return window._replace(values=window.values.T)

    def _why_skipped(self, time: int) -> str:
        """Return why the outputs of a motion cannot be compared; empty if they can."""
        scene = self._scene
        holds = 'hold' in (scene.drive.out_of_range, scene.joint_states.when_unknown)
        if self._untold:
            return BEFORE_THE_FILE if self._origin.is_later else UNTOLD
        if self._holds_unknown and holds:
            return BEFORE_THE_FILE
        if not self._origin.in_order and any(abs(time - change) < UNSETTLED
                                             for change in self._changes):
            return NEAR_A_CHANGE
        return ''

    # --- outputs --------------------------------------------------------------------------------

    def _compare_output(self, name: str, window: Window | None, later: Sequence[int],
                        until: float) -> None:
        """
        Compare the messages of an output with the motions of a window.

        ``later``: stamps of motions that come after them, ``until``: place of the first one.
        """
        outputs, self._outputs[name] = self._outputs[name], []
        counts = np.zeros(len(window.places) if window else 0, np.int64)
        coming = set(later)
        topic = self._origin.topics.get(name, '')
        for rows, records in self._bag.arrays(topic, [o.data for o in outputs]) if outputs else ():
            stamps = stamps_of(records)
            if stamps is None:
                raise BagError(f'{self._bag.path}: {topic} has no header')
            places = np.array([outputs[row].place for row in rows])
            motions = window.motions_of(places, stamps) if window else np.full(len(rows), -1)
            for row in np.flatnonzero(motions < 0).tolist():
                output = outputs[rows[row]]
                if output.place > until or not self._origin.in_order and int(
                        stamps[row]) in coming:
                    self._outputs[name].append(output)
                else:
                    self._without_motion(name, records[row:row + 1], output.time)
            has_motion = motions >= 0
            if window and has_motion.any():
                np.add.at(counts, motions[has_motion], 1)
                self._compare_records(name, records[has_motion], window, motions[has_motion])
        self._outputs[name].sort()
        if window and (self._origin.in_order or topic):
            needed = window.values[self._scene.needed_for(name)]
            # joint_states may be left out where a position is unknown
            due = ~np.isnan(needed).any(axis=0) & (window.why_skipped == '')
            self._doubled += int(np.maximum(counts - 1, 0).sum())
            missing = self._missing.setdefault(name, Missing(self._origin.in_order))
            missing.add(counts, due)

    def _compare_records(self, name: str, records: Array, window: Window, motions: Array) -> None:
        """Note the differences of messages from the values of their motions; skip some."""
        why = window.why_skipped[motions]
        for reason in set(why.tolist()) - {''}:
            self._skipped[reason] += int(np.count_nonzero(why == reason))
        records, motions = records[why == ''], motions[why == '']
        self._counts[name] += len(motions)
        fields = set(records.dtype.names or ())     # a bag of an older version may have fewer
        expectations = {**self._scene.layout.expected(name, window.values[:, motions]),
                        'status': window.status[motions], 'mode': window.modes[motions],
                        **self._constant, **self._texts}
        for field, value in expectations.items():
            if field in fields:
                expected, recorded = _rows(value, len(motions)), records[field]
                if recorded.dtype.kind == 'f':
                    size = abs(recorded)
                    is_dust = (expected == 0.0) & (DUST[0] < size) & (size < DUST[1])
                    recorded = np.where(is_dust, 0.0, recorded)
                self._note(name, field, largest_difference(expected, recorded))

    def _without_motion(self, name: str, record: Array, time: int) -> None:
        """Count an output whose motion is not in the bag, by the likely reason."""
        if _tells_timeout(record, name, self._scene):
            self._skipped[STOPPED] += 1
        elif not self._origin.in_order and any(abs(time - change) < UNSETTLED
                                               for change in self._changes):
            self._skipped[NEAR_A_CHANGE] += 1
        else:
            self._unmatched += 1

    def _check_frame(self, name: str, message: Any) -> None:
        is_same = message.header.frame_id == self._scene.frame_id
        self._note(name, 'header.frame_id', 0.0 if is_same else inf)

    def _note(self, name: str, field: str, difference: float) -> None:
        """Keep a difference if it is the largest so far."""
        self._largest[name, field] = max(self._largest.get((name, field), 0.0), difference)

    def finished(self) -> Recomputed:
        """Return the result after the last message."""
        self._compare(len(self._events))
        compared = sum(self._counts.values())
        self._counts[DRIVEN.name] = self._inputs
        if self._drive_states:
            self._counts[DRIVE_STATE.name] = self._drive_states.compared
            for field, value in self._drive_states.largest.items():
                self._note(DRIVE_STATE.name, field, value)
        is_whole = self._origin.in_order and self._bag.is_finished
        topics = self._origin.topics
        return Recomputed(
            [Difference(topics[name], field, self._counts[name], value)
             for (name, field), value in self._largest.items()],
            self._inputs, compared, self._unmatched,
            sum(missing.inside + missing.at_the_end * is_whole
                for missing in self._missing.values()),
            self._doubled, dict(self._skipped),
            self._drive_states.stepped if self._drive_states else 0, not self._bag.is_finished,
            software_of(self._bag.about).get('fourbar_ros', ''))


class Window(NamedTuple):
    """
    Driven motions that were evaluated; all arrays have shape (n,).

    Places in the bag, stamps and log times [ns], assembly modes, statuses, why their outputs
    cannot be compared (empty: they can); ``values`` of shape (values, n) are those of the scene's
    FieldMap.
    """

    places: Array
    stamps: Array
    times: Array
    modes: Array
    status: Array
    why_skipped: Array
    values: Array

    def motions_of(self, places: Array, stamps: Array) -> Array:
        """
        Return the index of each output's motion, -1 for none.

        That is the last motion before the output. If it has another stamp, as in a bag of
        ``ros2 bag``, which mixes topics, it is the last motion of the output's stamp.
        """
        before = np.searchsorted(self.places, places, side='right') - 1
        good = (before >= 0) & (self.stamps[before] == stamps)
        if good.all():
            return before
        order = np.argsort(self.stamps, kind='stable')
        last = np.searchsorted(self.stamps, stamps, side='right', sorter=order) - 1
        same_stamp = np.where((last >= 0) & (self.stamps[order[last]] == stamps), order[last], -1)
        return np.where(good, before, same_stamp)


class Missing:
    """
    Counts motions without a message of one output.

    A gap counts when a message follows it (``inside``); those behind the newest message are
    ``at_the_end``. A recording of our node is complete ``from_the_start``; any other may begin
    anywhere.
    """

    def __init__(self, from_the_start: bool) -> None:
        self.inside = self.at_the_end = 0
        self._has_begun = from_the_start

    def add(self, counts: Array, due: Array) -> None:
        """Take the messages found for each of the next motions, and whether one was due."""
        found, gaps = np.flatnonzero(counts), due & (counts == 0)
        if len(found):
            first, last = 0 if self._has_begun else found[0], found[-1]
            self.inside += self.at_the_end + int(np.count_nonzero(gaps[first:last]))
            self.at_the_end, self._has_begun = int(np.count_nonzero(gaps[last:])), True
        elif self._has_begun:
            self.at_the_end += int(np.count_nonzero(gaps))


def largest_difference(a: Array, b: Array) -> float:
    """
    Return the largest |a - b| of two arrays of numbers, or of texts, which differ by infinity.

    NaN equals NaN, since both then say "unknown"; NaN against a number is infinite.
    """
    if a.shape != b.shape:
        return inf
    if a.dtype.kind in 'SU' or b.dtype.kind in 'SU':
        return 0.0 if (a == b).all() else inf
    a, b = a.astype(float), b.astype(float)
    with np.errstate(invalid='ignore'):
        apart = np.abs(a - b)
    same = (a == b) | np.isnan(a) & np.isnan(b)
    return float(np.where(same, 0.0, np.where(np.isnan(apart), inf, apart)).max(initial=0.0))


def _rows(value: Any, count: int) -> Array:
    """Return what ``count`` messages should have: a number or text for all, an array, a tuple."""
    if isinstance(value, tuple):
        return np.stack([np.broadcast_to(part, count) for part in value], axis=1)
    return np.broadcast_to(value.encode() if isinstance(value, str) else value, count)


def _tells_timeout(record: Array, name: str, scene: Scene) -> bool:
    """
    Return whether the node sent an output because its input had stopped.

    Its status says so; a message without a status is all NaN then. joint_states may hold
    positions meanwhile, so its velocities alone are asked.
    """
    if 'status' in (record.dtype.names or ()):
        return bool(record['status'][0] == INPUT_TIMEOUT)
    fields = ('velocity',) if name == 'joint_states' else scene.layout.fields[name]
    return all(np.isnan(record[field]).all() for field in fields)


def _stamp_of(message: Any) -> int:
    stamp = message.header.stamp
    return int(stamp.sec * 10**9 + stamp.nanosec)
