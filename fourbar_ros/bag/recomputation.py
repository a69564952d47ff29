# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Compute every recorded output again, from the driven motion and the scene, and compare.

The bag has the motion as messages, and the scene as the first message and again after every
change. A motion and the outputs computed from it have the same stamp. In a bag of the node an
output follows the motion; in a bag of ``ros2 bag record`` it may also come before, so messages
wait until both are read. There, joint states may come from a robot or another node too: joint
states of joints that the scene does not name are no outputs.
"""
from __future__ import annotations

from collections import Counter, defaultdict, deque
from collections.abc import Container, Sequence
from math import inf
from pathlib import Path
from typing import Any, NamedTuple

from fourbar_ros import __version__
from fourbar_ros.bag.drive_states import DriveStates
from fourbar_ros.bag.origin import Origin, origin_of, scene_of
from fourbar_ros.bag.reader import Bag, Progress, Raw, software_of, stamps_of
from fourbar_ros.errors import BagError
from fourbar_ros.mechanics.bodies import Base
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.pipeline import joints
from fourbar_ros.pipeline.joints import SceneJoints
from fourbar_ros.pipeline.stepper import INPUT_TIMEOUT, joints_of, OK, Stepper, Wanted
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

BLOCK, MOST_VALUES = 5000, 2_000_000    # motions, and their values, that are compared together
UNSETTLED = 200_000_000     # [ns] around a change, in which a bag of rosbag2 has no sure order
# the topic that a robot and other nodes share, where a bag of rosbag2 has the messages of all
JOINT_STATES = 'joint_states'
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
    """The result of recomputing a bag."""

    differences: list[Difference]
    inputs: int                 # driven motions
    compared: int               # outputs that were computed again from them
    unmatched: int              # outputs whose motion is not in the bag
    missing: int                # outputs that a motion should have and has not
    doubled: int                # outputs beyond the first of a motion
    skipped: dict[str, int]     # {reason: outputs that could not be compared}
    # states of a drive that were computed again by a step from the state before; of states at a
    # start or by another version of the integrator, accelerations and torques are compared
    stepped: int
    is_cut: bool                # a file of the bag has no end: the recording broke off
    made_by: str = ''           # version of fourbar_ros that recorded the bag; '' if not known

    @property
    def largest(self) -> float:
        """Return the largest of all differences."""
        return max((difference.largest for difference in self.differences), default=0.0)

    def problems(self, tolerance: float = 0.0) -> list[str]:
        """Return a text for each fault of a bag; differences up to ``tolerance`` are no fault."""
        counts = ((self.unmatched, 'outputs without their motion'),
                  (self.missing, 'outputs missing'), (self.doubled, 'outputs more than once'))
        texts = [f'{count} {text}' for count, text in counts if count]
        if self.largest > tolerance:
            texts.insert(0, f'differences up to {self.largest:g}' + (
                f' (recorded by fourbar_ros {self.made_by}; if that is rounding, --tolerance '
                'accepts it)' if self.made_by not in ('', __version__) else ''))
        return texts if self.compared else ['nothing could be compared', *texts]


def recompute(path: str | Path, node: str | None = None, progress: Progress | None = None
              ) -> Recomputed:
    """
    Compute all outputs of a bag again from their driven motions and compare field by field.

    Differences are absolute; of NaN and NaN 0, of NaN and a number infinite. Memory hardly grows
    with the bag. ``node``: the name, if a bag of ``ros2 bag`` has several nodes. Raises BagError.
    """
    bag = Bag(path, progress)
    origin = origin_of(bag, node)
    recomputation = Recomputation(bag, origin)
    try:
        for raw in bag.raw(set(origin.topics.values())):
            recomputation.take(raw)
        bag.refuse_damage()
        return recomputation.finished()
    except AttributeError as error:     # a bag may define our types differently
        raise BagError(f'{bag.path}: a definition of a message is not ours: {error}') from None


class Recomputation:
    """Takes the messages of a bag in order; compares outputs with their motions in blocks."""

    def __init__(self, bag: Bag, origin: Origin) -> None:
        """Begin before the first message, with the scene at the start of the bag."""
        self._bag, self._origin = bag, origin
        self._names = {topic: name for name, topic in origin.topics.items()}
        self._largest: dict[tuple[str, str], float] = {}        # {(name, field): difference}
        self._counts: Counter[str] = Counter()      # messages of each output that were compared
        self._skipped: Counter[str] = Counter()
        self._inputs = self._unmatched = 0
        # of each output, by motion: count of messages in the bag, whether one is due
        self._presence: defaultdict[str, list[tuple[Array, Array]]] = defaultdict(list)
        # not yet computed: motions (log time, message); what acts from a motion on, with its index
        self._motions: list[tuple[int, Any]] = []
        self._acts: deque[tuple[int, str, ActingInput]] = deque()
        # not yet compared: outputs (how many motions before it in the bag, log time, data)
        self._outputs: defaultdict[str, list[tuple[int, int, bytes]]] = defaultdict(list)
        self._modes: dict[int, int] = {}            # {stamp: mode}, where a drive passes toggles
        self._changes: list[int] = []           # log times [ns] of new scenes and acting inputs
        self._holds_unknown = origin.is_later
        self._drive_states = None
        if origin.scene.dynamics and origin.in_order:
            self._drive_states = DriveStates(origin.scene, bag.about)
        self._joints: SceneJoints | None = None
        self._is_wrapped = origin.in_order and joints.KEY not in bag.about
        self._joints_have_begun = False
        self._acting: dict[str, ActingInput] = {}    # the newest wrench on each link, and base
        self._begin(origin.scene)

    def _begin(self, scene: Scene) -> None:
        last = self._joints.angles if self._joints else None
        self._scene, self._topics = scene, scene.topics
        self._block = min(BLOCK, MOST_VALUES // len(scene.layout.index_of))
        self._joints = joints_of(scene, last, self._is_wrapped)
        self._stepper = Stepper(scene, self._acting, self._joints)
        # points and links without a topic in the bag are not computed
        self._wanted = Wanted.of(scene, self._origin.topics)._replace(
            with_loads=scene.needs_loads)
        self._acts.clear()
        # what acts, but the bag does not tell yet
        self._untold = {name for name in scene.acting
                        if applied_topic(name).name not in self._origin.topics
                        or self._origin.is_later and name not in self._acting}
        self._constant = {'change_point_margin': scene.linkage.change_point_margin,
                          **dict.fromkeys(PLANAR, 0.0), 'header.frame_id': scene.frame_id,
                          **{f'name[{i}]': name for i, name in enumerate(scene.names_shown)}}
        if self._drive_states:
            self._drive_states.change(scene)

    def take(self, raw: Raw) -> None:
        """Take the next message of the bag."""
        name = self._names[raw.topic]
        if name in self._topics:
            if name == JOINT_STATES and self._joints and not self._joints_have_begun:
                self._begin_joints(self._joints, self._bag.decode(raw))
            self._outputs[name].append((self._inputs, raw.time, raw.data))
        elif name == DRIVEN.name:
            message = self._bag.decode(raw)
            self._check_frame(name, message)
            self._motions.append((raw.time, message))
            self._inputs += 1
            if len(self._motions) >= 2 * self._block:
                self._compare(self._block)
        elif name == SCENE.name:
            scene = scene_of(self._bag, self._bag.decode(raw).data)
            # ros2 bag may hold the latched scene several times
            if self._origin.in_order or scene.as_json != self._scene.as_json:
                self._changes.append(raw.time)
                self._compare(len(self._motions))
                self._begin(scene)
        elif name == BASE.name or name.startswith(ON_LINK):
            self._act(name.removeprefix(ON_LINK), raw.time, self._bag.decode(raw))
        elif self._drive_states and name == TORQUE.name:
            self._drive_states.command(self._bag.decode(raw))
        elif name == DRIVE_STATE.name:
            message = self._bag.decode(raw)
            self._modes[_stamp_of(message)] = message.mode
            if self._drive_states:
                self._check_frame(name, message)
                self._drive_states.take(_stamp_of(message), message)

    def _act(self, name: str, time: int, message: Any) -> None:
        """Let the wrench in effect on a link, or the motion of the base, act from here on."""
        acting: ActingInput
        if name == BASE.name:
            acting = Base(message.force_x, message.force_y, message.rate, message.acceleration)
        else:
            force, torque = message.wrench.force, message.wrench.torque
            acting = Wrench(force.x, force.y, torque.z)
        if acting != self._acting.get(name):
            self._changes.append(time)
        self._acting[name] = acting
        self._acts.append((self._inputs, name, acting))
        if self._drive_states:
            self._drive_states.act(name, acting)

    def _evaluated(self, first: int, motions: Sequence[tuple[int, Any]]) -> Motions:
        """
        Return the next motions with the values that their outputs should have.

        Each motion is computed alone, as in the node: arrays may differ in the last bit.
        ``first``: index of the first motion in the bag.
        """
        stepper, modes, rows = self._stepper, self._scene.linkage.modes_passed, []
        for index, (time, message) in enumerate(motions, first):
            while self._acts and self._acts[0][0] <= index:
                _, name, acting = self._acts.popleft()
                stepper.act(name, acting)
                self._untold.discard(name)
            stamp = _stamp_of(message)
            mode = self._modes.pop(stamp, stepper.mode)
            mode = mode if mode in modes else stepper.mode
            status, values = stepper.step(message.position, message.velocity,
                                          message.acceleration, self._wanted, mode)
            if status == OK:
                self._holds_unknown = False
            rows.append((stamp, mode, status, self._why_unsure(time), values))
        return Motions(first, *map(np.array, zip(*rows) if rows else [()] * 5))

    def _why_unsure(self, time: int) -> str:
        """Return why the outputs of a motion at a log time cannot be computed; '' if they can."""
        if self._untold:
            return BEFORE_THE_FILE if self._origin.is_later else UNTOLD
        policies = self._scene.drive.out_of_range, self._scene.joint_states.when_unknown
        if self._holds_unknown and 'hold' in policies:
            return BEFORE_THE_FILE
        return self._near_a_change(time)

    # --- outputs --------------------------------------------------------------------------------

    def _compare(self, count: int) -> None:
        """Compare the outputs of the first ``count`` motions; outputs of later motions wait."""
        first = self._inputs - len(self._motions)       # motions before them in the bag
        block, self._motions = self._motions[:count], self._motions[count:]
        motions = self._evaluated(first, block)
        for name in self._topics:
            self._compare_output(name, motions)
        if block:
            newest = block[-1][0]
            self._changes = [time for time in self._changes if time > newest - UNSETTLED]

    def _begin_joints(self, scene_joints: SceneJoints, message: Any) -> None:
        """Begin in the turns of the first joint states, which go on from before the bag."""
        if message.name == self._scene.names_shown and np.isfinite(message.position).all():
            scene_joints.follow(dict(zip(self._scene.joints_shown, message.position)))
            self._joints_have_begun = True

    def _near_a_change(self, time: int) -> str:
        """Return NEAR_A_CHANGE if it is not sure what was in force at a log time, else ''."""
        is_near = not self._origin.in_order and any(abs(time - change) < UNSETTLED
                                                    for change in self._changes)
        return NEAR_A_CHANGE if is_near else ''

    def _compare_output(self, name: str, motions: Motions) -> None:
        """Compare the messages of an output with their motions; keep outputs of later motions."""
        topic, waiting = self._origin.topics.get(name, ''), self._outputs.pop(name, [])
        later = set() if self._origin.in_order else {
            _stamp_of(message) for _, message in self._motions}
        counts = np.zeros(len(motions.stamps), np.int32)        # messages of each motion
        arrays = self._bag.arrays(topic, [data for *_, data in waiting]) if waiting else ()
        for rows, records in arrays:
            if name == JOINT_STATES and not self._origin.in_order:
                are_ours = _are_of(records, self._scene.names_shown)
                rows, records = rows[are_ours], records[are_ours]
                if not len(rows):
                    continue
            outputs, stamps = [waiting[row] for row in rows], stamps_of(records)
            if stamps is None:
                raise BagError(f'{self._bag.path}: {topic} has no header')
            before = np.array([before for before, *_ in outputs])
            indices = motions.of_outputs(before, stamps, later)
            self._outputs[name] += [outputs[row] for row in np.flatnonzero(indices == LATER)]
            for row in np.flatnonzero(indices == NOWHERE):
                self._without_motion(name, records[row:row + 1], outputs[row][1])
            is_known = indices >= 0
            if is_known.any():
                np.add.at(counts, indices[is_known], 1)
                self._compare_records(name, records[is_known], motions, indices[is_known])
        if len(counts) and (self._origin.in_order or topic):
            needed = motions.values[:, self._scene.needed_for(name)]
            # joint_states may be left out where a position is unknown
            is_due = ~np.isnan(needed).any(axis=1) & (motions.why == '')
            self._presence[name].append((counts, is_due))

    def _compare_records(self, name: str, records: Array, motions: Motions, indices: Array
                         ) -> None:
        """Note differences of messages from the values of their motions; skip unsure motions."""
        why = motions.why[indices]
        for reason in set(why.tolist()) - {''}:
            self._skipped[reason] += int(np.count_nonzero(why == reason))
        records, indices = records[why == ''], indices[why == '']
        self._counts[name] += len(indices)
        fields = set(records.dtype.names or ())     # a bag of an older version may have fewer
        expectations = {**self._scene.layout.expected(name, motions.values[indices].T),
                        'status': motions.status[indices], 'mode': motions.modes[indices],
                        **self._constant}
        for field, value in expectations.items():
            if field in fields:
                self._note(name, field, largest_difference(_rows(value, len(indices)),
                                                           records[field]))

    def _without_motion(self, name: str, record: Array, time: int) -> None:
        """Count an output whose motion is not in the bag, by the likely reason."""
        if _tells_timeout(record, name, self._scene):
            self._skipped[STOPPED] += 1
        elif why := self._near_a_change(time):
            self._skipped[why] += 1
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
        self._compare(len(self._motions))
        compared = sum(self._counts.values())
        self._counts[DRIVEN.name] = self._inputs
        if self._drive_states:
            self._counts[DRIVE_STATE.name] = self._drive_states.compared
            for field, value in self._drive_states.largest.items():
                self._note(DRIVE_STATE.name, field, value)
        topics = self._origin.topics
        return Recomputed(
            [Difference(topics[name], field, self._counts[name], value)
             for (name, field), value in self._largest.items()],
            self._inputs, compared, self._unmatched, *self._missing_and_doubled(),
            dict(self._skipped),
            self._drive_states.stepped if self._drive_states else 0, not self._bag.is_finished,
            software_of(self._bag.about).get('fourbar_ros', ''))

    def _missing_and_doubled(self) -> tuple[int, int]:
        """Return how many outputs their motions lack, and how many outputs are doubled."""
        missing = doubled = 0
        for blocks in self._presence.values():
            counts, is_due = map(np.concatenate, zip(*blocks))
            doubled += int(np.maximum(counts - 1, 0).sum())
            begin, end = 0, len(counts)
            present = np.flatnonzero(counts)
            if not self._origin.in_order and len(present):   # rosbag2 may begin within a run
                begin = present[0]
            if not (self._origin.in_order and self._bag.is_finished):
                end = present[-1] if len(present) else 0    # the end of a cut bag may lack outputs
            missing += int(np.count_nonzero((is_due & (counts == 0))[begin:end]))
        return missing, doubled


NOWHERE, LATER = -1, -2     # instead of the index of a motion: not in the bag, in a later block


class Motions(NamedTuple):
    """
    Driven motions that were evaluated; all arrays have shape (n,).

    ``first``: index of the first motion in the bag; stamps [ns], assembly modes, statuses;
    ``why``: reason why the outputs cannot be compared (empty: they can); ``values``, of shape
    (n, values): in the order of the FieldMap of the scene.
    """

    first: int
    stamps: Array
    modes: Array
    status: Array
    why: Array
    values: Array

    def of_outputs(self, before: Array, stamps: Array, later: Container[int]) -> Array:
        """
        Return the index of each output's motion, or LATER, or NOWHERE.

        It is the last motion before the output; ``before``: how many motions are before each
        output in the bag. If the stamps differ, as in a bag of ``ros2 bag``, which mixes topics,
        it is the last motion of the stamp of the output; ``later``: stamps of motions that follow
        these.
        """
        indices, count = before - 1 - self.first, len(self.stamps)
        is_same = (indices >= 0) & (indices < count)
        is_same[is_same] = self.stamps[indices[is_same]] == stamps[is_same]
        of_stamp = {} if is_same.all() else dict(zip(self.stamps.tolist(), range(count)))
        for row in np.flatnonzero(~is_same):
            stamp = int(stamps[row])
            is_behind = indices[row] >= count or stamp in later
            indices[row] = of_stamp.get(stamp, LATER if is_behind else NOWHERE)
        return indices


def largest_difference(a: Array, b: Array) -> float:
    """
    Return the largest |a - b| of two arrays of numbers, or of texts, which differ by infinity.

    NaN equals NaN, since both say "unknown"; NaN and a number differ by infinity.
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
        return np.stack([np.broadcast_to(item, count) for item in value], axis=1)
    return np.broadcast_to(value.encode() if isinstance(value, str) else value, count)


def names_in(records: Array) -> list[str]:
    """Return the fields of JointStates that hold the names of the joints; [] for other types."""
    return [field for field in records.dtype.names or () if field.startswith('name[')]


def _are_of(records: Array, names: Sequence[str]) -> Array:
    """Return which JointStates are of joints with these names, in this order."""
    fields, are_ours = names_in(records), np.ones(len(records), bool)
    if len(fields) != len(names):
        return ~are_ours
    for field, name in zip(fields, names):
        are_ours &= records[field] == name.encode()
    return are_ours


def _tells_timeout(record: Array, name: str, scene: Scene) -> bool:
    """
    Return whether the node sent an output because its input had stopped.

    The status of the output says so; an output without a status is all NaN then. joint_states may
    hold positions meanwhile, so velocities alone are checked.
    """
    if 'status' in (record.dtype.names or ()):
        return bool(record['status'][0] == INPUT_TIMEOUT)
    fields = ('velocity',) if name == JOINT_STATES else scene.layout.fields[name]
    return all(np.isnan(record[field]).all() for field in fields)


def _stamp_of(message: Any) -> int:
    stamp = message.header.stamp
    return int(stamp.sec * 10**9 + stamp.nanosec)
