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
from collections import deque
from collections.abc import Sequence
from math import inf
from pathlib import Path
from typing import Any, NamedTuple

from fourbar_ros import __version__
from fourbar_ros.bag import drive_states, outputs, reader, sides
from fourbar_ros.bag.origin import Origin, origin_of, scene_of
from fourbar_ros.errors import BagError
from fourbar_ros.pipeline import joints
from fourbar_ros.pipeline.stepper import joints_of, OK, Stepper, TOGGLE, Wanted
from fourbar_ros.pipeline.wrenches import acting_of, ActingInput
from fourbar_ros.scene import topics
from fourbar_ros.scene.scene import Scene
import numpy as np

BLOCK, MOST_VALUES = 5000, 2_000_000    # motions, and their values, that are compared together
BEFORE_THE_FILE, UNTOLD = (
    'depend on what came before this file',
    'depend on a wrench or a base that is not in the bag (~/applied, ~/base)')
NO_ORDER, NOT_TOLD = (
    'are states of a drive, and rosbag2 has no sure order of them and what acts',
    'are states of a drive that input and rate do not tell, as next to a toggle')


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
    doubled: int                # outputs beyond one for a motion; motions and states sent again
    skipped: dict[str, int]     # {reason: outputs that could not be compared}
    # states of a drive that were computed again by a step from the state before; of states at a
    # start or by another version of the integrator, accelerations and torques are compared
    stepped: int
    other_branch: int           # motions that a change point had before a mode was a branch
    is_cut: bool                # a file of the bag has no end: the recording broke off
    made_by: str = ''           # version of fourbar_ros that recorded the bag; '' if not known

    @property
    def largest(self) -> float:
        return max((difference.largest for difference in self.differences), default=0.0)

    def problems(self, tolerance: float = 0.0) -> list[str]:
        """
        Return a text for each fault of a bag; absolute differences to ``tolerance`` are none.

        Outputs that were skipped, a bag that is cut and motions of the other branch are no faults.
        """
        counts = ((self.unmatched, 'outputs without their motion'),
                  (self.missing, 'outputs missing'), (self.doubled, 'messages more than once'))
        texts = [f'{count} {text}' for count, text in counts if count]
        if self.largest > tolerance:
            texts.insert(0, f'differences up to {self.largest:g}' + (
                f' (recorded by fourbar_ros {self.made_by}; if that is rounding, --tolerance '
                'accepts it)' if self.made_by not in ('', __version__) else ''))
        return texts if self.compared else ['nothing could be compared', *texts]


def recompute(path: str | Path, node: str | None = None, progress: reader.Progress | None = None
              ) -> Recomputed:
    """
    Compute all outputs of a bag again from their driven motions and compare field by field.

    Differences are absolute; of NaN and NaN 0, of NaN and a number infinite. Memory hardly grows
    with the bag. ``node``: the name, if a bag of ``ros2 bag`` has several nodes. Raises BagError.
    """
    bag = reader.Bag(path, progress)
    origin = origin_of(bag, node)
    recomputation = Recomputation(bag, origin)
    try:
        for raw in bag.raw(set(origin.topics.values())):
            recomputation.take(raw)
        bag.refuse_damage()
        return recomputation.finished()
    except (AttributeError, TypeError) as error:        # a bag may define our types differently
        raise BagError(f'{bag.path}: a definition of a message is not ours: {error}') from None


class Recomputation:
    """Takes the messages of a bag in order and computes the motions again, in blocks."""

    def __init__(self, bag: reader.Bag, origin: Origin) -> None:
        """Begin with the scene at the start of a bag."""
        self._bag, self._origin = bag, origin
        self._names = {topic: name for name, topic in origin.topics.items()}
        self._comparison = outputs.OutputComparison(bag, origin)
        self._motion_count = 0                      # messages of the motion so far
        # not yet computed: motions (log time, message, recorded mode or 0); what acts from a
        # motion on, with its index
        self._motions: list[tuple[int, Any, int]] = []
        self._acts: deque[tuple[int, str, ActingInput]] = deque()
        self._modes: dict[int, int] = {}            # {stamp: recorded mode}, of motion by torque
        self._last: tuple[str, int, bytes] | None = None    # topic, log time and data of a message
        self._repeated = 0          # motions and states of a drive that are that one once more
        self._other_branch = 0                      # motions that are not on the branch of today
        self._changes: list[int] = []           # log times [ns] of new scenes and acting inputs
        # a later file of a split bag may hold values of the one before, until a motion is valid
        self._holds_unknown = origin.is_later
        self._drive_states = None
        if origin.scene.dynamics and origin.in_order:
            self._drive_states = drive_states.DriveStates(origin.scene, bag.about)
        self._joints: joints.SceneJoints | None = None
        # a joint in a bag without this key jumps by a turn where its angle wraps
        self._is_wrapped = origin.in_order and joints.KEY not in bag.about
        self._joints_have_begun = False             # the turns of the first joint states are taken
        self._acting: dict[str, ActingInput] = {}    # the newest wrench on each link, and base
        self._has_branches = not origin.in_order or bag.about.get(sides.KEY) == sides.BRANCHES
        self._begin(origin.scene)

    def _begin(self, scene: Scene) -> None:
        """Compute from here on with another scene; joints go on from their last positions."""
        last = self._joints.angles if self._joints else None
        self._scene, self._topics = scene, scene.topics
        self._comparison.begin(scene)
        modes = None if self._has_branches else sides.modes_of(scene.linkage)
        self._are_sides, self._modes_known = modes is not None, modes or scene.linkage.modes_passed
        self._block = min(BLOCK, MOST_VALUES // len(scene.layout.index_of))
        self._joints = joints_of(scene, last, self._is_wrapped)
        self._stepper = Stepper(scene, self._acting, self._joints)
        # points and links without a topic in the bag are not computed
        self._wanted = Wanted.of(scene, self._origin.topics)._replace(
            with_loads=scene.needs_loads)
        self._acts.clear()
        # what acts, but the bag does not tell yet
        self._untold = {name for name in scene.acting
                        if topics.applied_topic(name).name not in self._origin.topics
                        or self._origin.is_later and name not in self._acting}
        if self._drive_states:
            self._drive_states.change(scene)

    def take(self, raw: reader.Raw) -> None:
        """
        Take the next message: an output, a motion, a scene, what acts, a torque, a drive state.

        Outputs and motions wait, until a block of motions is computed or the scene changes.
        """
        name = self._names[raw.topic]
        # a node may send a motion again, when its outputs stand between the two
        before, self._last = self._last, (raw.topic, raw.time, raw.data)
        if before == self._last and name in (topics.DRIVEN.name, topics.DRIVE_STATE.name):
            self._repeated += 1
            return
        if name in self._topics:
            if name == outputs.JOINT_STATES and self._joints and not self._joints_have_begun:
                message = self._bag.decode(raw)
                if message.name == self._scene.names_shown and np.isfinite(message.position).all():
                    # its turns go on from before the bag
                    self._joints.follow(dict(zip(self._scene.joints_shown, message.position)))
                    self._joints_have_begun = True
            self._comparison.add(name, self._motion_count, raw)
        elif name == topics.DRIVEN.name:
            message = self._bag.decode(raw)
            self._check_frame(name, message)
            # at once where the state is before the motion: simulated time may come again
            mode = self._modes.get(_stamp_of(message), 0) if self._origin.in_order else 0
            self._motions.append((raw.time, message, mode))
            self._motion_count += 1
            if len(self._motions) >= 2 * self._block:
                self._compare(self._block)
        elif name == topics.SCENE.name:
            scene = scene_of(self._bag, self._bag.decode(raw).data)
            # ros2 bag may hold the latched scene several times
            if self._origin.in_order or scene.as_json != self._scene.as_json:
                self._note_change(raw.time)
                self._compare(len(self._motions))
                self._begin(scene)
        elif name == topics.BASE.name or name.startswith(topics.ON_LINK):
            name, acting = name.removeprefix(topics.ON_LINK), acting_of(self._bag.decode(raw))
            if acting != self._acting.get(name):
                self._note_change(raw.time)
            self._acting[name] = acting
            self._acts.append((self._motion_count, name, acting))
            if self._drive_states:
                self._drive_states.act(name, acting)
        elif self._drive_states and name == topics.TORQUE.name:
            self._drive_states.command(self._bag.decode(raw))
        elif name == topics.DRIVE_STATE.name:
            message = self._bag.decode(raw)
            self._modes[_stamp_of(message)] = message.mode
            if self._drive_states:
                self._check_frame(name, message)
                self._drive_states.take(_stamp_of(message), message,
                                        self._branch(message.mode, message.position)
                                        if self._are_sides else message.mode)
            else:
                self._comparison.skipped[NO_ORDER] += 1

    def _branch(self, mode: int, position: float) -> int:
        """Return the mode of a recorded one at an input, that of the scene for one that is not."""
        if mode not in self._modes_known:
            return self._stepper.mode
        return sides.branch_at(self._scene.linkage, mode, position) if self._are_sides else mode

    def _note_change(self, time: int) -> None:
        if not self._origin.in_order:
            self._changes.append(time)

    def _evaluated(self, first: int, motions: Sequence[tuple[int, Any, int]]) -> outputs.Motions:
        """
        Return motions, each computed alone as in the node: arrays may differ in a last bit.

        ``motions``: (log time [ns], message, recorded mode or 0) of each, ``first`` the index of
        the first in the bag.
        """
        stepper, rows = self._stepper, []       # rows: the last five fields of Motions
        passes = len(self._scene.linkage.modes_passed) > 1      # toggles
        is_holding = 'hold' in (self._scene.drive.out_of_range,
                                self._scene.joint_states.when_unknown)
        for index, (time, message, mode) in enumerate(motions, first):
            while self._acts and self._acts[0][0] <= index:
                _, name, acting = self._acts.popleft()
                stepper.act(name, acting)
                self._untold.discard(name)
            stamp = _stamp_of(message)
            mode = mode or self._modes.get(stamp, stepper.mode)
            branch = self._branch(mode, message.position)
            status, values = stepper.step(message.position, message.velocity,
                                          message.acceleration, self._wanted, branch)
            if status == OK:
                self._holds_unknown = False
            why = outputs.near_a_change(time, self._changes)
            if self._untold:
                why = BEFORE_THE_FILE if self._origin.is_later else UNTOLD
            elif self._holds_unknown and is_holding:
                why = BEFORE_THE_FILE
            if self._are_sides:
                self._other_branch += branch != (mode if passes else stepper.mode)
                why = why or sides.AT_FLAT * (status == TOGGLE)
            mode = mode if mode in self._modes_known else branch
            rows.append((stamp, mode, status, why, values))
        later = {_stamp_of(message) for _, message, _ in self._motions}
        for stamp in {stamp for stamp, *_ in rows} - later:
            self._modes.pop(stamp, None)
        arrays = map(np.array, zip(*rows) if rows else [()] * 5)
        return outputs.Motions(first, set() if self._origin.in_order else later, self._changes,
                               *arrays)

    def _compare(self, count: int) -> None:
        """Compute the first ``count`` motions that wait and compare their outputs."""
        first = self._motion_count - len(self._motions)       # motions before them in the bag
        block, self._motions = self._motions[:count], self._motions[count:]
        self._comparison.compare(self._evaluated(first, block))
        if block:
            newest = block[-1][0]
            self._changes = [time for time in self._changes if time > newest - outputs.UNSETTLED]

    def _check_frame(self, name: str, message: Any) -> None:
        is_same = message.header.frame_id == self._scene.frame_id
        self._comparison.note(name, 'header.frame_id', 0.0 if is_same else inf)

    def finished(self) -> Recomputed:
        """Compute what waits; return the result for the whole bag."""
        self._compare(len(self._motions))
        comparison, counts = self._comparison, self._comparison.counts
        compared = sum(counts.values())
        counts[topics.DRIVEN.name] = self._motion_count
        if self._drive_states:
            counts[topics.DRIVE_STATE.name] = self._drive_states.compared
            if self._drive_states.unknown:
                comparison.skipped[NOT_TOLD] = self._drive_states.unknown
            for field, value in self._drive_states.largest.items():
                comparison.note(topics.DRIVE_STATE.name, field, value)
        missing, doubled = comparison.missing_and_doubled()
        return Recomputed(
            [Difference(self._origin.topics[name], field, counts[name], value)
             for (name, field), value in comparison.largest.items()],
            self._motion_count, compared, comparison.unmatched, missing,
            doubled + self._repeated, dict(comparison.skipped),
            self._drive_states.stepped if self._drive_states else 0, self._other_branch,
            not self._bag.is_finished, reader.software_of(self._bag.about).get('fourbar_ros', ''))


def _stamp_of(message: Any) -> int:
    stamp = message.header.stamp
    return int(stamp.sec * 10**9 + stamp.nanosec)
