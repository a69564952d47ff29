# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Recompute the inputs of a node from its bag: driven motions, states of a drive, wrenches.

They are recomputed in the order of the bag, with the code of the node, and compared.
"""
from __future__ import annotations

from collections import deque
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from math import inf, isfinite, isnan, nan
from typing import NamedTuple, Union

from fourbar_ros.bag.comparison.difference import distance_of_two
from fourbar_ros.bag.comparison.window import joined_by_place
from fourbar_ros.bag.read.origin import Origin
from fourbar_ros.bag.read.records import Columns
from fourbar_ros.dynamics.step.mover import DriveValues, KEY, Mover, name_of, OK, SILENT
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.pipeline.joints import Scale
from fourbar_ros.pipeline.rate_estimator import estimator_of
from fourbar_ros.pipeline.stepper import InModes
from fourbar_ros.pipeline.wrenches import Wrench
from fourbar_ros.scene.message_fields import driven_of, is_time
from fourbar_ros.scene.scene import DriveSettings, Scene
from fourbar_ros.scene.topics import ON_LINK, TORQUE, WRENCH
import numpy as np

FIELDS = ('position', 'velocity', 'acceleration')
UNSETTLED = 200_000_000  # [ns] around a change, in which a bag of rosbag2 does not tell the order


class _InputMessage(NamedTuple):
    """A message of the input: place in the bag, stamp [ns], (position, velocity, acceleration)."""

    place: int
    stamp: int
    motion: list[float]


class DrivenMotions:
    """
    Recomputes the driven motions of a node from the messages of its input.

    Rates that the input does not carry are estimated from the samples before, as in the node.
    Rates that may come from samples before the bag, or from another version of the estimator, are
    counted in ``unknown``, not compared. ``has_our_estimator``: the bag was made with this
    version's estimator. ``largest`` is {field: largest difference}; ``compared`` counts motions
    that were compared, ``without`` motions that belong to no input.
    """

    def __init__(self, scene: Scene, has_our_estimator: bool) -> None:
        """Begin before the first message, with no difference."""
        self._has_our_estimator = has_our_estimator
        self.largest = dict.fromkeys((*FIELDS, 'header.stamp'), 0.0)
        self.compared = self.unknown = self.without = 0
        self._inputs: list[_InputMessage] = []       # which no driven motion has followed yet
        self._drive: DriveSettings | None = None
        self._newest_stamp = 0                       # [ns] at which rates were estimated
        self.change(scene)

    def change(self, scene: Scene) -> None:
        """Take over another scene; with other settings of the drive the estimate starts afresh."""
        drive = scene.drive
        if drive == self._drive:
            return
        self._estimator = estimator_of(scene)
        # so many of the estimator's samples may still be of before the bag
        self._samples_before = 0 if self._drive else drive.window
        self._drive = drive

    def take(self, places: Array, stamps: Array, motions: Array) -> None:
        """Take messages of the input: places, ascending, stamps [ns], motions of shape (n, 3)."""
        self._inputs += map(_InputMessage, places.tolist(), stamps.tolist(), motions.tolist())

    def compare(self, places: Array, stamps: Array, motions: Array) -> None:
        """Compare driven motions, given as in :meth:`take`, with the inputs before them."""
        inputs, begin = self._inputs, 0
        for place, stamp, motion in zip(places.tolist(), stamps.tolist(), motions.tolist()):
            first = begin
            while begin < len(inputs) and inputs[begin].place < place:
                begin += 1
            if begin == first:         # no input between the motion before and this one
                self.without += 1
            else:
                self._compare_one(stamp, motion, inputs[begin - 1])
        self._inputs = inputs[begin:]

    def summary(self, topic: str | None, in_order: bool, states: DriveStates | None = None) -> str:
        """
        Return in one line how the motions were checked.

        ``topic``: the topic of the input, None if the bag has none. ``in_order``: the bag keeps
        the order of input and motion. ``states``: the states of the drive, if the scene has one.
        """
        if topic is None:
            source = self._drive.source if self._drive else ''
            return f'not recomputed: driven by the {source}, no input in the bag'
        if not in_order:
            return 'not recomputed: the order of input and motion is not in the bag'
        text = f'{self.compared} recomputed from {topic}'
        if states:
            text += (f' ({states.integrator}), {states.compared} of these states stepped again '
                     'from the one before')
            if states.unknown:
                text += (f', {states.unknown} not compared: the bag begins next to a toggle, '
                         'where it does not hold the whole state')
        if self.unknown:
            text += (f', {self.unknown} with rates estimated from samples before it or by another '
                     'version')
        return text + (f'; {self.without} without an input' if self.without else '')

    def _compare_one(self, stamp: int, driven: Sequence[float], source: _InputMessage) -> None:
        """Compare a driven motion with that in its input; NaN rates there are estimated."""
        self.compared += 1
        if source.stamp and source.stamp != stamp:
            self.largest['header.stamp'] = inf
        position, velocity, acceleration = source.motion
        is_known = True
        if isnan(velocity) or isnan(acceleration):
            velocity, estimate, is_known = self._estimated(stamp, source.motion, driven)
            acceleration = estimate if isnan(acceleration) else acceleration
        expected = position, velocity, acceleration
        for field, recorded, want, sent in zip(FIELDS, driven, expected, source.motion):
            if is_known or not isnan(sent):
                self.largest[field] = max(self.largest[field], distance_of_two(recorded, want))
        self.unknown += not is_known

    def _estimated(self, stamp: int, sent: Sequence[float], driven: Sequence[float]
                   ) -> tuple[float, float, bool]:
        """
        Return (velocity, acceleration, is_known) by the estimator at a stamp [ns].

        ``sent`` is the motion in the input, ``driven`` the recorded motion. A recorded rate of NaN
        shows that the node had no sample before this one either.
        """
        restarts = self._estimator.restarts
        velocity, acceleration = self._estimator.update(stamp, sent[0], sent[1])
        is_first = isnan(driven[2]) and (isnan(driven[1]) or not isnan(sent[1]))
        if self._estimator.restarts != restarts or is_first:
            self._samples_before = 0
        is_known = self._samples_before == 0 and self._has_our_estimator
        if stamp > self._newest_stamp:
            self._newest_stamp, self._samples_before = stamp, max(self._samples_before - 1, 0)
        return velocity, acceleration, is_known


def inputs_of(columns: Columns, scene: Scene) -> tuple[Array, Array, Array]:
    """
    Return (places, stamps [ns], motions) of input messages, motions of shape (n, 3).

    Messages without the driven joint are left out, as the node ignores them. Stamp 0: the message
    has no valid one.
    """
    stamp = [columns.records[f'header.stamp.{field}'] for field in ('sec', 'nanosec')]
    stamps, drive = np.where(is_time(*stamp), columns.headed, 0), scene.drive
    if drive.source != 'joint_state':
        return columns.places, stamps, np.stack(driven_of(columns.tree), axis=1)
    names, tree = columns.layout.texts.get('name', []), columns.tree
    i = names.index(drive.joint) if drive.joint in names else len(tree.position)
    if i >= len(tree.position):
        return columns.places[:0], stamps[:0], np.zeros((0, 3))
    unknown = np.full(len(columns.places), nan)
    velocity = tree.velocity[i] if i < len(tree.velocity) else unknown
    motion = Scale(drive.joint_ratio, drive.joint_offset).to_input(tree.position[i], velocity,
                                                                   unknown)
    return columns.places, stamps, np.stack(motion, axis=1)


def mover_of(scene: Scene, mode: int | None = None) -> Mover:
    """Return the integrator of a scene driven by torque, of a mode beyond a toggle if given."""
    return scene.mover if mode is None else scene.mover_in(mode)


MoverOf = Callable[[Scene, Union[int, None]], Mover]      # as mover_of()


def drive_states_of(origin: Origin, about: Mapping[str, str],
                    moved_by: MoverOf = mover_of) -> DriveStates | None:
    """Return the DriveStates of a bag; None if it has no drive, or no order to step in."""
    if origin.scene.dynamics is None or not origin.in_order:
        return None
    return DriveStates(origin.scene, about.get(KEY, 'unknown'), moved_by)


class _RecordedState(NamedTuple):
    """
    A DriveState message.

    ``values`` are None next to a toggle: there they do not determine the state of the mover.
    """

    values: DriveValues | None
    mode: int
    stamp: int


class DriveStates:
    """
    Steps a drive again from each of its recorded states to the next, as the node's mover does.

    The torque in effect is recomputed from the messages on its topic. If another version of the
    integrator made the bag, accelerations and torques alone are recomputed, from the states. Next
    to a toggle, input and rate do not determine the state; a mover that came there by its own
    steps knows it. If a bag begins there, the states up to the first one past the toggle are not
    compared. ``integrator`` is the name of the integrator that made the bag. ``moved_by`` makes
    the mover that steps again, from a scene and a mode (None: its own).

    Attributes
    ----------
    largest : dict
        {field: largest difference}.
    compared : int
        States that were stepped again from the one before.
    alone : int
        States without such a step, at a start, after a gap, or from another integrator: only their
        accelerations and torques were computed again.
    unknown : int
        States next to a toggle near which the bag begins: not compared.

    """

    def __init__(self, scene: Scene, integrator: str, moved_by: MoverOf = mover_of) -> None:
        """Begin before the first message, with no state to step from."""
        self.integrator, self._moved_by = integrator, moved_by
        dynamics = scene.dynamics
        self._has_our_integrator = integrator == (
            name_of(scene.bare_linkage, dynamics.drive.source, dynamics.elements) if dynamics
            else name_of(scene.bare_linkage))
        self.largest: dict[str, float] = {}
        self.compared = self.alone = self.unknown = 0
        self._before = _RecordedState(None, 0, 0)
        self._commands: deque[tuple[int, float]] = deque()      # (place, torque), ahead of states
        self._torque: float | None = None                       # newest one; None: not known
        self.change(scene)

    def change(self, scene: Scene) -> None:
        """Take another scene; the state stays."""
        self._scene, self._mover = scene, self._moved_by(scene, None)
        self._movers: dict[int, Mover] = {}              # by mode

    def commands(self, blocks: Sequence[Columns]) -> None:
        """Take messages of the torque topic, cut to the torque limit as the node does."""
        limit = self._scene.drive.torque_limit
        limit = inf if isnan(limit) else limit
        new = []
        for columns in blocks:
            wrench = columns.tree.wrench
            torques = (wrench.force.x if self._scene.linkage.is_driven_by_slide
                       else wrench.torque.z)
            new += [(place, min(max(torque, -limit), limit))
                    for place, torque in zip(columns.places.tolist(), torques.tolist())
                    if isfinite(torque)]
        self._commands.extend(sorted(new))

    def compare(self, blocks: Sequence[Columns]) -> None:
        """Compare recorded DriveState messages with the steps and torques that lead to them."""
        if not blocks:
            return
        places, *states = joined_by_place([
            (block.places, block.headed, block.records['status'], block.records['mode'],
             np.stack([block.records[name] for name in DriveValues._fields], axis=1))
            for block in blocks])
        for place, stamp, status, mode, row in zip(places.tolist(),
                                                   *(array.tolist() for array in states)):
            while self._commands and self._commands[0][0] < place:
                self._torque = self._commands.popleft()[1]
            self._compare_one(stamp, status, mode, DriveValues(*row))

    def _compare_one(self, stamp: int, status: int, mode: int, values: DriveValues) -> None:
        """Compare a state with a step from the one before or, where that is unknown, by itself."""
        self._note('command', self._command_difference(status, values.command))
        before = self._before
        # the stamps are a step apart: no message between them is missing
        follows = 0.5 < (stamp - before.stamp) * 1e-9 / (values.step or inf) < 1.5
        known: DriveValues | None = values
        if before.values is not None and follows and self._has_our_integrator:
            expected_status, expected = self._mover.next(
                before.values, values.step, values.command, status == SILENT, before.mode)
            self._note('status', 0.0 if expected_status == status else inf)
            self._note('mode', 0.0 if self._mover.mode == mode else inf)
            self.compared += 1
            if self._note_values(values, expected) == 0.0:
                known = expected     # the mover also keeps what a message next to a toggle lacks
        elif self._has_our_integrator and values.step and not self._mover.tells_all(
                self._mover.place(self._mover.state(values), mode)):
            known = None
            self.unknown += 1
        else:
            if mode not in self._movers:
                self._movers[mode] = self._moved_by(self._scene, mode)
            mover = self._movers[mode]
            self._note_values(values, mover.values(mover.place(mover.state(values)), values.step,
                                                   values.command, values.evaluations))
            self.alone += 1
        self._before = _RecordedState(known, mode, stamp)

    def _note_values(self, values: DriveValues, expected: DriveValues) -> float:
        """Note the differences of all values; return the largest."""
        apart = [distance_of_two(*pair) for pair in zip(values, expected)]
        for field, difference in zip(DriveValues._fields, apart):
            self._note(field, difference)
        return max(apart)

    def _command_difference(self, status: int, command: float) -> float:
        """
        Return |torque in effect - torque by the topic and its policy| [N m]; 0 if not known.

        ``command`` is recorded with each state; NaN for a drive without a torque topic.
        """
        if self._scene.drive.source != TORQUE.name:
            return 0.0 if isnan(command) else inf
        has_zero = self._scene.drive.when_silent == 'zero'
        if status == SILENT and has_zero:
            return distance_of_two(command, 0.0)
        if self._torque is None:                         # sent before the bag began
            return 0.0
        # At a limit or out of budget the status says that, though the topic may be silent too.
        may_be_silent = has_zero and status not in (OK, SILENT)
        return min(distance_of_two(command, self._torque),
                   distance_of_two(command, 0.0) if may_be_silent else inf)

    def _note(self, field: str, difference: float) -> None:
        """Keep a difference of a field if it is the largest so far."""
        self.largest[field] = max(self.largest.get(field, 0.0), difference)


class _WrenchMessage(NamedTuple):
    """A recorded wrench on a link: place in the bag, log time [ns], the Wrench."""

    place: int
    time: int
    wrench: Wrench


class WrenchHistory:
    """
    Hands the wrenches from outside to a stepper, in the order of the bag.

    A topic of our node says which wrench is in effect whenever it changes. A bag of ``ros2 bag``
    may hold only the wrenches that the node received: then they act until the next one, or until
    they time out. ``topics``: short names of the topics in the bag. ``links``: links whose wrench
    comes from a topic. ``in_effect``: wrenches by link, as a stepper keeps them.
    """

    def __init__(self, topics: Collection[str], links: Sequence[str]) -> None:
        """Choose the topic of each link: wrenches in effect, or else received wrenches."""
        self.in_effect: dict[str, Wrench] = {}
        self._waiting: list[tuple[int, str, Wrench]] = []        # (place, link, wrench)
        self._change_times = np.zeros(0)         # log times [ns] of wrenches unlike the one before
        self._newest: dict[str, Wrench] = {}     # the last wrench of each link
        applied = [name.removeprefix(ON_LINK) for name in topics if name.startswith(ON_LINK)]
        self._names = {link: ON_LINK + link for link in (*applied, *links)}    # of their topics
        # {link: log times [ns]} where only the received wrenches are known
        self._received: dict[str, Array] = {}
        for link in links:
            if ON_LINK + link not in topics and WRENCH + link in topics:
                self._names[link] = WRENCH + link
                self._received[link] = np.zeros(0)

    def take(self, by_name: Mapping[str, Iterable[Columns]], frame_id: str) -> None:
        """
        Queue the wrenches of a block, {short name of a topic: its messages}, by place.

        The log times of changes and of received messages are kept for :meth:`is_settled`, with
        the last ones of the block before.
        """
        change_times = self._change_times[-1:].tolist()
        for link, name in self._names.items():
            is_received = link in self._received
            messages = sorted(message for columns in by_name.get(name, ())
                              for message in _wrenches_in(columns, frame_id, is_received))
            for place, time, wrench in messages:
                self._waiting.append((place, link, wrench))
                if wrench != self._newest.get(link):
                    change_times.append(time)
                self._newest[link] = wrench
            if is_received:
                times = [message.time for message in messages]
                self._received[link] = np.array([*self._received[link][-1:], *times])
        self._change_times = np.sort(np.array(change_times))
        self._waiting.sort(key=lambda event: event[0])

    def apply(self, stepper: InModes, until: float = inf) -> None:
        """
        Hand the queued wrenches that the bag has before the place ``until`` to a stepper.

        A place is the number of a message in the bag. Called with the place of each motion, so
        that the stepper computes it under the loads of that moment.
        """
        while self._waiting and self._waiting[0][0] < until:
            _, link, wrench = self._waiting.pop(0)
            stepper.act(link, wrench)

    def is_settled(self, times: Array, timeout: float) -> Array:
        """
        Return a mask of the motions, by their log times [ns], whose wrench is certain.

        Near a change a bag of ``ros2 bag`` does not tell the order. A bag with received wrenches
        alone does not show the wrench before the first message, or after ``timeout`` [s] without
        one (0: never).
        """
        good = _nearest_distance(self._change_times, times) > UNSETTLED
        longest = timeout * 1e9 - UNSETTLED if timeout else inf
        for received in self._received.values():
            before = np.searchsorted(received, times) - 1
            last = received[np.maximum(before, 0)] if len(received) else np.zeros(len(times))
            good &= (before >= 0) & (times - last < longest)
        return good


def _nearest_distance(changes: Array, times: Array) -> Array:
    """Return |time - nearest change| for each time; ``changes`` ascend, infinite without any."""
    padded = np.concatenate(([-inf], changes, [inf]))
    after = np.searchsorted(padded, times, side='left')
    return np.asarray(np.minimum(times - padded[after - 1], padded[after] - times))


def _wrenches_in(columns: Columns, frame_id: str, is_received: bool) -> Iterator[_WrenchMessage]:
    """
    Yield the wrenches in messages.

    Received wrenches are yielded only if the node takes them: those in its frame, and pure
    couples, which are the same in all frames.
    """
    wrench = columns.tree.wrench
    is_taken = np.ones(len(columns.times), bool)
    if is_received and 'header.frame_id' in columns.fields:    # else it is empty
        is_taken = ((columns.records['header.frame_id'] == frame_id.encode())
                    | (wrench.force.x == 0.0) & (wrench.force.y == 0.0))
    arrays = columns.places, columns.times, wrench.force.x, wrench.force.y, wrench.torque.z
    for place, time, *components in zip(*(array[is_taken].tolist() for array in arrays)):
        yield _WrenchMessage(place, time, Wrench(*components))
