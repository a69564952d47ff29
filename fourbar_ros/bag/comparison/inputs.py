# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
What a node received, and what followed from it: driven motions, states of a drive, wrenches.

Each is recomputed in the order of the bag, with the code of the node, and compared.
"""
from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from math import inf, isfinite, isnan, nan
from typing import Union

from fourbar_ros.bag.comparison.difference import distance_of_two
from fourbar_ros.bag.comparison.window import in_order
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


class DrivenMotions:
    """
    Goes through inputs and the driven motions that follow from them, as the node does.

    Rates that the input does not carry are estimated from the samples before. Those that may come
    from samples before the bag, or from an estimator that computed otherwise, are counted in
    ``unknown``, not compared.

    Parameters
    ----------
    scene : Scene
    has_our_estimator : bool
        The bag was made with the estimator of this version of the software.

    Attributes
    ----------
    largest : dict
        {field: largest difference}.
    compared, unknown, without : int
        Motions that were compared; rates that were not; motions that belong to no input.

    """

    def __init__(self, scene: Scene, has_our_estimator: bool) -> None:
        self._has_our_estimator = has_our_estimator
        self.largest = dict.fromkeys((*FIELDS, 'header.stamp'), 0.0)
        self.compared = self.unknown = self.without = 0
        # (place, stamp [ns], motion) not yet taken
        self._inputs: list[tuple[int, int, list[float]]] = []
        self._drive: DriveSettings | None = None
        self._newest = 0
        self.change(scene)

    def change(self, scene: Scene) -> None:
        """Take over another scene; with other settings of the drive the estimate starts afresh."""
        drive = scene.drive
        if drive == self._drive:
            return
        self._estimator = estimator_of(scene)
        self._scale = Scale(drive.joint_ratio, drive.joint_offset)
        # how many samples there are still to come until all are from the bag
        self._cold = 0 if self._drive else drive.window
        self._drive = drive

    def take(self, places: Array, stamps: Array, motions: Array) -> None:
        """
        Take messages of the input, in order.

        Places in the bag, stamps [ns], (position, velocity, acceleration).
        """
        self._inputs += zip(places.tolist(), stamps.tolist(), motions.tolist())

    def compare(self, places: Array, stamps: Array, motions: Array) -> None:
        """Compare driven motions, in order, with the inputs taken before them."""
        waiting, at = self._inputs, 0
        for place, stamp, motion in zip(places.tolist(), stamps.tolist(), motions.tolist()):
            newest = None           # of the inputs between the output before and this one
            while at < len(waiting) and waiting[at][0] < place:
                newest, at = waiting[at], at + 1
            if newest is None:
                self.without += 1
            else:
                _, input_stamp, input_motion = newest
                self._one(stamp, motion, input_stamp, input_motion)
        self._inputs = waiting[at:]

    def summary(self, topic: str | None, in_order: bool, states: DriveStates | None = None) -> str:
        """
        Return in one line how the motions were checked.

        ``topic`` is that of the input, None if the bag has none; ``in_order``: the bag keeps the
        order of input and motion; ``states``: those of the drive, if the scene has one.
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

    def _one(self, stamp: int, driven: Sequence[float], told: int, given: Sequence[float]) -> None:
        self.compared += 1
        if told and told != stamp:
            self.largest['header.stamp'] = inf
        velocity, acceleration = given[1:]
        is_known = True
        if isnan(velocity) or isnan(acceleration):
            velocity, estimate, is_known = self._estimated(stamp, given, driven)
            acceleration = estimate if isnan(acceleration) else acceleration
        for field, there, expected in zip(FIELDS, driven, (given[0], velocity, acceleration)):
            if is_known or not isnan(given[FIELDS.index(field)]):
                self.largest[field] = max(self.largest[field], distance_of_two(there, expected))
        self.unknown += not is_known

    def _estimated(self, stamp: int, given: Sequence[float], driven: Sequence[float]
                   ) -> tuple[float, float, bool]:
        restarts = self._estimator.restarts
        velocity, acceleration = self._estimator.update(stamp, given[0], given[1])
        is_first = isnan(driven[2]) and (isnan(driven[1]) or not isnan(given[1]))
        if self._estimator.restarts != restarts or is_first:
            self._cold = 0                             # nothing from before the bag is in it
        is_known = self._cold == 0 and self._has_our_estimator
        if stamp > self._newest:
            self._newest, self._cold = stamp, max(self._cold - 1, 0)
        return velocity, acceleration, is_known


def inputs_of(columns: Columns, scene: Scene) -> tuple[Array, Array, Array]:
    """
    Return (places, stamps, motions) of input messages; those without the joint are left out.

    Stamp 0: the message has none.
    """
    stamp = [columns.records[f'header.stamp.{field}'] for field in ('sec', 'nanosec')]
    stamps = np.where(is_time(*stamp), columns.headed, 0)
    if scene.drive.source != 'joint_state':
        return columns.places, stamps, np.stack(driven_of(columns.tree), axis=1)
    names = columns.layout.texts.get('name', [])
    if scene.drive.joint not in names:
        return columns.places[:0], stamps[:0], np.zeros((0, 3))
    i, count = names.index(scene.drive.joint), len(columns.places)
    tree, unknown = columns.tree, np.full(count, nan)
    if i >= len(tree.position):
        return columns.places[:0], stamps[:0], np.zeros((0, 3))
    velocity = tree.velocity[i] if i < len(tree.velocity) else unknown
    scale = Scale(scene.drive.joint_ratio, scene.drive.joint_offset)
    return columns.places, stamps, np.stack(scale.to_input(tree.position[i], velocity, unknown),
                                            axis=1)


def mover_of(scene: Scene, mode: int | None = None) -> Mover:
    """Return what moves a scene by torque, in a mode beyond a toggle if one is given."""
    return scene.mover if mode is None else scene.mover_in(mode)


MoverOf = Callable[[Scene, Union[int, None]], Mover]      # as mover_of()


def drive_states_of(origin: Origin, about: Mapping[str, str],
                    moved_by: MoverOf = mover_of) -> DriveStates | None:
    """Return the DriveStates of a bag; None if it has no drive, or no order to step in."""
    if origin.scene.dynamics is None or not origin.in_order:
        return None
    return DriveStates(origin.scene, about.get(KEY, 'unknown'), moved_by)


class DriveStates:
    """
    Steps a drive again from each of its states to the next, as a mover does.

    The torque in effect is recomputed from the messages on its topic. If another version of the
    integrator made the bag, accelerations and torques alone are recomputed, from the states. Next
    to a toggle, input and rate do not determine the state: a mover that came there by its own
    steps knows it; of a bag that begins there, the states up to the first one past the toggle are
    not compared.

    Parameters
    ----------
    scene : Scene
    integrator : str
        What the bag says of it.
    moved_by : callable, optional
        (scene, mode or None) -> mover.

    Attributes
    ----------
    largest : dict
        {field: largest difference}.
    compared, alone : int
        States that were stepped again from the one before; those of which the accelerations and
        torques alone were: at a start, after a gap, of another integrator.
    unknown : int
        States next to a toggle near which the bag begins: not compared.

    """

    def __init__(self, scene: Scene, integrator: str, moved_by: MoverOf = mover_of) -> None:
        self.integrator, self._moved_by = integrator, moved_by
        drive = scene.dynamics and scene.dynamics.drive
        self._steps = integrator == name_of(scene.linkage, drive.source if drive else None)
        self.largest: dict[str, float] = {}
        self.compared = self.alone = self.unknown = 0
        # values, mode, stamp [ns]; no values where they do not tell the state
        self._before: tuple[DriveValues | None, int, int] = (None, 0, 0)
        self._commands: list[tuple[int, float]] = []
        self._torque: float | None = None
        self.change(scene)

    def change(self, scene: Scene) -> None:
        """Take another scene; the state stays."""
        self._scene, self._mover = scene, self._moved_by(scene, None)
        self._movers: dict[int, Mover] = {}

    def commands(self, blocks: Sequence[Columns]) -> None:
        """Take messages of the torque topic."""
        limit = self._scene.drive.torque_limit
        limit = inf if isnan(limit) else limit
        for columns in blocks:
            wrench = columns.tree.wrench
            torques = (wrench.force.x if self._scene.linkage.is_driven_by_slide
                       else wrench.torque.z)
            self._commands += [(place, min(max(torque, -limit), limit))
                               for place, torque in zip(columns.places.tolist(), torques.tolist())
                               if isfinite(torque)]
        self._commands.sort()        # a block has messages of one layout: of one length of text

    def compare(self, blocks: Sequence[Columns]) -> None:
        """Compare DriveStates."""
        if not blocks:
            return
        for place, stamp, status, mode, row in zip(*(column.tolist() for column in in_order(
                [(found.places, found.headed, found.records['status'], found.records['mode'],
                  np.stack([found.records[name] for name in DriveValues._fields], axis=1))
                 for found in blocks]))):
            self._one(place, stamp, status, mode, DriveValues(*row))

    def _in_mode(self, mode: int) -> Mover:
        """Return what gives accelerations and torques in a mode; of an unknown one the scene's."""
        if mode not in self._movers:
            self._movers[mode] = self._moved_by(self._scene, mode)
        return self._movers[mode]

    def _one(self, place: int, stamp: int, status: int, mode: int, values: DriveValues) -> None:
        while self._commands and self._commands[0][0] < place:
            self._torque = self._commands.pop(0)[1]
        self._note('command', self._command_apart(status, values.command))
        before, mode_before, at = self._before
        follows = before is not None and 0.5 < (stamp - at) * 1e-9 / (values.step or inf) < 1.5
        known: DriveValues | None = values
        if before is not None and follows and self._steps:
            expected, again = self._mover.next(before, values.step, values.command,
                                               status == SILENT, mode_before)
            self._note('status', 0.0 if expected == status else inf)
            self._note('mode', 0.0 if self._mover.mode == mode else inf)
            self.compared += 1
            if self._compared(values, again) == 0.0:
                known = again                            # of which the mover knows more
        elif self._steps and values.step and not self._mover.tells_all(
                self._mover.place(self._mover.state(values), mode)):
            known = None
            self.unknown += 1
        else:
            mover = self._in_mode(mode)
            now = mover.place(mover.state(values))
            self._compared(values, mover.values(now, values.step, values.command,
                                                values.evaluations))
            self.alone += 1
        self._before = known, mode, stamp

    def _compared(self, values: DriveValues, again: DriveValues) -> float:
        """Note the differences of values; return the largest."""
        found = {name: distance_of_two(there, computed)
                 for name, there, computed in zip(values._fields, values, again)}
        for name, value in found.items():
            self._note(name, value)
        return max(found.values())

    def _command_apart(self, status: int, command: float) -> float:
        """Return how far a torque in effect is from what the topic and its policy say."""
        if self._scene.drive.source != TORQUE.name:
            return 0.0 if isnan(command) else inf
        has_zero = self._scene.drive.when_silent == 'zero'
        if status == SILENT and has_zero:
            return distance_of_two(command, 0.0)
        if self._torque is None:                         # what came before the bag is not known
            return 0.0
        # held at a limit, or out of budget, it may be silent too
        is_silent = has_zero and status not in (OK, SILENT)
        return min(distance_of_two(command, self._torque),
                   distance_of_two(command, 0.0) if is_silent else inf)

    def _note(self, field: str, value: float) -> None:
        self.largest[field] = max(self.largest.get(field, 0.0), value)


class WrenchHistory:
    """
    Hands the wrenches from outside to a stepper, in the order of the bag.

    The topic of the wrench in effect says so whenever it changes. A bag of ``ros2 bag`` may hold
    the wrenches alone that the node received: then they act until the next one, or until they
    time out.

    Parameters
    ----------
    topics : dict
        {short name: topic} of the bag.
    links : sequence of str
        Those that a topic loads.

    Attributes
    ----------
    in_effect : dict
        Wrenches by link, as a stepper keeps them.

    """

    def __init__(self, topics: Collection[str], links: Sequence[str]) -> None:
        self.in_effect: dict[str, Wrench] = {}
        self._waiting: list[tuple[int, str, Wrench]] = []        # with their places
        self._times = np.zeros(0)            # when one was logged that differs from before [ns]
        self._newest: dict[str, Wrench] = {}     # the last wrench of each link
        loaded = [name.removeprefix(ON_LINK) for name in topics if name.startswith(ON_LINK)]
        self._source = {link: ON_LINK + link for link in (*loaded, *links)}
        # {link: log times [ns]} where only these are known
        self._received: dict[str, Array] = {}
        for link in links:
            if ON_LINK + link not in topics and WRENCH + link in topics:
                self._source[link] = WRENCH + link
                self._received[link] = np.zeros(0)

    def take(self, by_name: Mapping[str, Iterable[Columns]], frame_id: str) -> None:
        """Take the wrenches of a block; ``by_name``: lists of Columns."""
        changes = self._times[-1:].tolist()
        for link, name in self._source.items():
            messages = sorted(message for columns in by_name.get(name, ())
                              for message in _messages(columns, link in self._received, frame_id))
            for place, time, wrench in messages:
                self._waiting.append((place, link, wrench))
                if wrench != self._newest.get(link):
                    changes.append(time)
                self._newest[link] = wrench
            if link in self._received:
                times = [time for _, time, _ in messages]
                self._received[link] = np.array([*self._received[link][-1:], *times])
        self._times = np.sort(np.array(changes))
        self._waiting.sort(key=lambda event: event[0])

    def apply(self, stepper: InModes, until: float = inf) -> None:
        """Apply to steppers the wrenches before a place in the bag."""
        while self._waiting and self._waiting[0][0] < until:
            _, link, wrench = self._waiting.pop(0)
            stepper.act(link, wrench)

    def is_settled(self, times: Array, timeout: float) -> Array:
        """
        Return a mask of the motions, by their log times, that are not near a change.

        A bag of the received wrenches alone does not show what acts before the first and after
        ``timeout`` [s] without one, 0 for never.
        """
        good = _distance(self._times, times) > UNSETTLED
        longest = timeout * 1e9 - UNSETTLED if timeout else inf
        for received in self._received.values():
            before = np.searchsorted(received, times) - 1
            last = received[np.maximum(before, 0)] if len(received) else np.zeros(len(times))
            good &= (before >= 0) & (times - last < longest)
        return good


def _distance(changes: Array, times: Array) -> Array:
    """Return how far each time is from the nearest change."""
    if not len(changes):
        return np.full(len(times), inf)
    after = np.searchsorted(changes, times)
    before = changes[np.maximum(after - 1, 0)]
    next_one = changes[np.minimum(after, len(changes) - 1)]
    found: Array = np.minimum(abs(times - before), abs(times - next_one))
    return found


def _messages(columns: Columns, is_received: bool, frame_id: str) -> list[tuple[int, int, Wrench]]:
    """Return [(place, log time, Wrench)] of messages; of received ones those that a node takes."""
    wrench = columns.tree.wrench
    is_ours = np.ones(len(columns.times), bool)
    if is_received and 'header.frame_id' in columns.fields:    # else it is empty
        is_ours = columns.records['header.frame_id'] == frame_id.encode()
    # a couple is the same in all frames
    is_ours |= (wrench.force.x == 0.0) & (wrench.force.y == 0.0)
    parts = (columns.places, columns.times, wrench.force.x, wrench.force.y, wrench.torque.z)
    return [(place, time, Wrench(*each))
            for place, time, *each in zip(*(part[is_ours].tolist() for part in parts))]
