# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Compare the recorded outputs of a bag with the values that were computed again."""
from collections import Counter, defaultdict
from collections.abc import Sequence, Set
from math import inf, isnan
from operator import sub
from typing import Any, NamedTuple

from fourbar_ros.bag.origin import Origin
from fourbar_ros.bag.reader import Bag, Raw, stamps_of
from fourbar_ros.errors import BagError
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.pipeline.stepper import INPUT_TIMEOUT
from fourbar_ros.scene.scene import Scene
import numpy as np

UNSETTLED = 200_000_000     # [ns] around a change, in which a bag of rosbag2 has no sure order
# the topic that a robot and other nodes share, where a bag of rosbag2 has the messages of all
JOINT_STATES = 'joint_states'
# fields of standard messages that a planar linkage leaves 0
PLANAR = ('wrench.force.z', 'wrench.torque.x', 'wrench.torque.y')
STOPPED, NEAR_A_CHANGE, AT_AN_END = (
    'say that the input had stopped', 'near a change of the scene or of what acts',
    'are missing at an end of the bag: a recorder may begin or stop within a step')
NOWHERE, LATER = -1, -2     # instead of the index of a motion: not in the bag, in a later block


class Motions(NamedTuple):
    """A block of n driven motions that were evaluated; arrays have shape (n,)."""

    first: int                  # index of the first motion in the bag
    later: Set[int]             # stamps of motions behind the block, where the order is not sure
    changes: Sequence[int]      # log times [ns] of new scenes and acting inputs, likewise
    stamps: Array               # [ns]
    modes: Array
    status: Array
    why: Array                  # reason why the outputs cannot be compared; empty: they can
    values: Array               # (n, values), in the order of the FieldMap of the scene

    def of_outputs(self, before: Array, stamps: Array) -> Array:
        """
        Return the index of each output's motion, or LATER, or NOWHERE.

        It is the last motion before the output; ``before``: how many motions are before each
        output in the bag. If the stamps differ, as in a bag of ``ros2 bag``, which mixes topics,
        it is the last motion of the stamp of the output.
        """
        indices, count = before - 1 - self.first, len(self.stamps)
        is_same = (indices >= 0) & (indices < count)
        is_same[is_same] = self.stamps[indices[is_same]] == stamps[is_same]
        of_stamp = {} if is_same.all() else dict(zip(self.stamps.tolist(), range(count)))
        for row in np.flatnonzero(~is_same):
            stamp = int(stamps[row])
            is_behind = indices[row] >= count or stamp in self.later
            indices[row] = of_stamp.get(stamp, LATER if is_behind else NOWHERE)
        return indices


class OutputComparison:
    """Keeps outputs until their motions are computed, then compares both."""

    def __init__(self, bag: Bag, origin: Origin) -> None:
        """Make it for a bag before its first message; :meth:`begin` tells the scene."""
        self._bag, self._origin = bag, origin
        self.largest: dict[tuple[str, str], float] = {}     # difference of (name, field)
        self.counts: Counter[str] = Counter()               # messages compared, by name
        self.skipped: Counter[str] = Counter()              # outputs, by reason
        self.unmatched = 0                      # outputs whose motion is not in the bag
        # {output: of each block of motions (count of its messages of each, whether one is due)}
        self._presence: defaultdict[str, list[tuple[Array, Array]]] = defaultdict(list)
        # {output: its messages that are not yet compared: motions before it in the bag, log time,
        # data}; a message may stand before its motion
        self._waiting: defaultdict[str, list[tuple[int, int, bytes]]] = defaultdict(list)

    def begin(self, scene: Scene) -> None:
        """Compare from here on with outputs of this scene."""
        self._scene = scene
        self._constant = {'change_point_margin': scene.linkage.change_point_margin,
                          **dict.fromkeys(PLANAR, 0.0), 'header.frame_id': scene.frame_id,
                          **{f'name[{i}]': name for i, name in enumerate(scene.names_shown)}}

    def add(self, name: str, before: int, raw: Raw) -> None:
        """Take an output, with the count of motions before it in the bag."""
        self._waiting[name].append((before, raw.time, raw.data))

    def compare(self, motions: Motions) -> None:
        """
        Compare the outputs that wait with the values of a block of motions, by their stamps.

        Outputs of later motions wait on. Per motion and output the messages are counted, for
        :meth:`missing_and_doubled`.
        """
        for name in self._scene.topics:
            topic, waiting = self._origin.topics.get(name, ''), self._waiting.pop(name, [])
            counts = np.zeros(len(motions.stamps), np.int32)        # messages of each motion
            arrays = self._bag.arrays(topic, [data for *_, data in waiting]) if waiting else ()
            for rows, records in arrays:
                if name == JOINT_STATES and not self._origin.in_order:
                    fields, names = names_in(records), self._scene.names_shown
                    are_ours = np.full(len(records), len(fields) == len(names))
                    for field, joint in zip(fields, names):
                        are_ours &= records[field] == joint.encode()
                    rows, records = rows[are_ours], records[are_ours]
                    if not len(rows):
                        continue
                outputs, stamps = [waiting[row] for row in rows], stamps_of(records)
                if stamps is None:
                    raise BagError(f'{self._bag.path}: {topic} has no header')
                before = np.array([before for before, *_ in outputs])
                indices = motions.of_outputs(before, stamps)        # of the motion of each output
                self._waiting[name] += [outputs[row] for row in np.flatnonzero(indices == LATER)]
                for row in np.flatnonzero(indices == NOWHERE):       # by the likely reason
                    if _tells_timeout(records[row:row + 1], name, self._scene):
                        self.skipped[STOPPED] += 1
                    elif near := near_a_change(outputs[row][1], motions.changes):
                        self.skipped[near] += 1
                    else:
                        self.unmatched += 1
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
        """Note the largest difference of each field of outputs from those of their motions."""
        why = motions.why[indices]
        for reason in set(why.tolist()) - {''}:
            self.skipped[reason] += int(np.count_nonzero(why == reason))
        records, indices = records[why == ''], indices[why == '']
        self.counts[name] += len(indices)
        fields = set(records.dtype.names or ())     # a bag of an older version may have fewer
        expectations = {**self._scene.layout.expected(name, motions.values[indices].T),
                        'status': motions.status[indices], 'mode': motions.modes[indices],
                        **self._constant}
        for field, value in expectations.items():
            if field in fields:
                self.note(name, field, largest_difference(_rows(value, len(indices)),
                                                          records[field]))

    def note(self, name: str, field: str, difference: float) -> None:
        self.largest[name, field] = max(self.largest.get((name, field), 0.0), difference)

    def missing_and_doubled(self) -> tuple[int, int]:
        """
        Return how many outputs their motions lack, and how many outputs are doubled.

        Outputs that may be missing because the recorder began or stopped are ``skipped``.
        """
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
            is_missing = is_due & (counts == 0)
            missing += (inside := int(np.count_nonzero(is_missing[begin:end])))
            if at_an_end := int(np.count_nonzero(is_missing)) - inside:
                self.skipped[AT_AN_END] += at_an_end
        return missing, doubled


def near_a_change(time: int, changes: Sequence[int]) -> str:
    """Return NEAR_A_CHANGE if it is not sure what was in force at a log time, else ''."""
    is_near = any(abs(time - change) < UNSETTLED for change in changes)
    return NEAR_A_CHANGE if is_near else ''


def largest_difference(a: Array, b: Array) -> float:
    """Return the largest |a - b|; NaN equals NaN; infinite for texts, for NaN and a number."""
    if a.shape != b.shape:
        return inf
    if a.dtype.kind in 'SU' or b.dtype.kind in 'SU':
        return 0.0 if (a == b).all() else inf
    if a.dtype.kind in 'iu' and b.dtype.kind in 'iu' and 8 in (a.itemsize, b.itemsize):
        # whole numbers, as times in ns, of more digits than floats have
        return float(max(map(abs, map(sub, a.ravel().tolist(), b.ravel().tolist())), default=0))
    a, b = a.astype(float), b.astype(float)
    with np.errstate(invalid='ignore'):
        apart = np.abs(a - b)
    same = (a == b) | np.isnan(a) & np.isnan(b)
    return float(np.where(same, 0.0, np.where(np.isnan(apart), inf, apart)).max(initial=0.0))


def distance(a: float, b: float) -> float:
    """Return |a - b|; NaN equals NaN and is infinitely far from a number."""
    if a == b or (isnan(a) and isnan(b)):
        return 0.0
    return inf if isnan(a - b) else abs(a - b)


def _rows(value: Any, count: int) -> Array:
    """Return what ``count`` messages should have: a number or text for all, an array, a tuple."""
    if isinstance(value, tuple):
        return np.stack([np.broadcast_to(item, count) for item in value], axis=1)
    return np.broadcast_to(value.encode() if isinstance(value, str) else value, count)


def names_in(records: Array) -> list[str]:
    """Return the fields of JointStates that hold the names of the joints; [] for other types."""
    return [field for field in records.dtype.names or () if field.startswith('name[')]


def _tells_timeout(record: Array, name: str, scene: Scene) -> bool:
    """Return whether an output, an array (1,), is what a node sends when its input stops."""
    if 'status' in (record.dtype.names or ()):
        return bool(record['status'][0] == INPUT_TIMEOUT)
    # joint_states may hold positions meanwhile
    fields = ('velocity',) if name == JOINT_STATES else scene.layout.fields[name]
    return all(np.isnan(record[field]).all() for field in fields)
