# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Recompute every recorded output from the recorded driven motion and the scene, and compare.

Both are in the bag: the motion as messages, the scene as its first message and again after every
change. If the input as it came is in the bag, the driven motion is recomputed from it too.
"""
from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
import json
from math import inf
from pathlib import Path

from fourbar_ros.bag import rosbag2
from fourbar_ros.bag.comparison.difference import Difference, Differences, Recomputed
from fourbar_ros.bag.comparison.inputs import (
    drive_states_of,
    DrivenMotions,
    inputs_of,
    mover_of,
    MoverOf,
    UNSETTLED,
    WrenchHistory,
)
from fourbar_ros.bag.comparison.window import joined_by_place, Tally, tells_timeout, Window
from fourbar_ros.bag.read.origin import Origin, origin_of
from fourbar_ros.bag.read.reader import Bag
from fourbar_ros.bag.read.records import Columns, Progress, Record
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.pipeline import rate_estimator
from fourbar_ros.pipeline.status import Evaluate, evaluate, LOADS_UNKNOWN, OK
from fourbar_ros.pipeline.stepper import InModes
from fourbar_ros.scene.message_fields import driven_of
from fourbar_ros.scene.scene import from_values, Scene
from fourbar_ros.scene.topics import DRIVE_STATE, DRIVEN, INPUTS, TORQUE
import numpy as np

WINDOW = 1000       # inputs whose outputs may still come; bags of rosbag2 have them in any order
ByName = Mapping[str, Sequence[Columns]]        # messages of a block by short name of their topic


def recompute(path: str | Path) -> list[Difference]:
    """Return the list of :class:`Difference` of a bag, by topic and field; see :func:`compare`."""
    return compare(path).differences


def compare(path: str | Path, progress: Progress | None = None, node: str | None = None,
            by: Evaluate = evaluate, moved_by: MoverOf = mover_of) -> Recomputed:
    """
    Recompute all outputs of a bag from their driven motions and compare them, field by field.

    The motion of an output is the last one before it with its stamp; in bags of ``ros2 bag`` it
    may also come later. Differences are absolute; NaN against NaN is none, NaN against a number
    infinite. Memory does not grow with the bag. ``node``: its name, if a bag of ``ros2 bag`` has
    several. In place of Python ``by`` computes motion and loads, as ``evaluate`` of generated
    code, and ``moved_by`` makes the integrator of a drive, as its ``mover``. ``progress`` is
    called with the number of bytes read.
    """
    bag = Bag(path)
    origin = origin_of(bag, node)
    comparison = Comparison(origin, bag.about(), by, moved_by)
    # The newest block waits until the next item tells whether the scene changes near its end.
    waiting: list[Columns] | None = None
    for item in bag.blocks(topics=list(origin.topics.values()), apart=origin.topics.get('scene'),
                           progress=progress):
        new_scene, certain_until = None, inf
        if isinstance(item, Record):
            scene = from_values(json.loads(item.message.data))
            if comparison.is_new(scene):
                new_scene = scene
                certain_until = inf if origin.in_order else item.time - UNSETTLED
        if waiting:
            comparison.block(waiting, certain_until)
        waiting = None if isinstance(item, Record) else item
        if new_scene:
            comparison.change(new_scene, item.time)
    if waiting:
        comparison.block(waiting)
    return comparison.finished(bool(bag.cut))


class Comparison:
    """
    Recomputes the outputs of one node, block by block of its bag.

    ``about``: custom_data of the bag; ``by`` computes motion and loads, as ``evaluate``;
    ``moved_by`` makes the integrator of a drive, as ``mover_of``.
    """

    def __init__(self, origin: Origin, about: Mapping[str, str], by: Evaluate,
                 moved_by: MoverOf) -> None:
        """Begin before the first block, with the scene at the start of the bag."""
        self._by = by
        # {short name: topic}; whether messages stand in the order in which the node had them
        self._topics, self._in_order = origin.topics, origin.in_order
        self._name_of = {topic: name for name, topic in origin.topics.items()}
        # the input behind the driven motions, as far as it is in the bag
        self._source = next((name for name in (*INPUTS, DRIVE_STATE.name)
                             if name in origin.topics), None)
        self._differences = Differences()
        self._driven = DrivenMotions(origin.scene, about.get(rate_estimator.KEY)
                                     == str(rate_estimator.VERSION))
        self._drive_states = drive_states_of(origin, about, moved_by)
        self._wrenches = WrenchHistory(origin.topics, origin.scene.wrenches.links)
        self._modes = Modes()
        self._window: Window | None = None
        self._early: list[Columns] = []          # outputs of motions that may still come
        self._tallies: dict[str, Tally] = {}
        # counts of motions and, of outputs not compared: without a motion, told by a timeout,
        # near a change of scene or wrench
        self._inputs = self._unmatched = self._silent = self._uncertain = 0
        self._certain_from = -inf        # log time [ns] from which the bag tells the scene
        # Values held at the start of a later part of a split bag may be of the part before.
        self._may_hold_unknown = rosbag2.REPEATS in about
        self._start(origin.scene)

    def is_new(self, scene: Scene) -> bool:
        """
        Return whether a recorded scene counts as a change.

        ``ros2 bag`` may hold the latched scene several times; our recorder keeps changes only.
        """
        return self._in_order or scene.as_json != self._scene.as_json

    def change(self, scene: Scene, time: int) -> None:
        """Take another scene, logged at a time [ns]; it holds from the next input on."""
        self._retire(0)
        # these outputs are of the scene before, their motions come after
        self._uncertain += sum(len(columns.times) for columns in self._early)
        self._window, self._early = None, []
        self._wrenches.apply(self._stepper)
        self._start(scene)
        if not self._in_order:
            self._certain_from = time + UNSETTLED

    def _start(self, scene: Scene) -> None:
        """Hand a scene to all that compute by it."""
        self._scene = scene
        self._stepper = InModes(scene, self._wrenches.in_effect, self._by)
        self._wrenches.in_effect = self._stepper.wrenches
        self._differences.change(scene, self._stepper.wrenches)
        self._driven.change(scene)
        if self._drive_states:
            self._drive_states.change(scene)
        self._outputs = tuple(scene.topics)
        self._wanted = scene.needs_loads, frozenset(scene.topics)

    def block(self, columns: Iterable[Columns], certain_until: float = inf) -> None:
        """
        Compare all messages of a block.

        Those logged after ``certain_until`` [ns] are near a change of the scene, in a bag that
        does not tell the order: they count as uncertain.
        """
        by_name: dict[str, list[Columns]] = {}
        for part in columns:
            by_name.setdefault(self._name_of.get(part.topic, ''), []).append(part)
        self._wrenches.take(by_name, self._scene.frame_id)
        self._take_inputs(by_name)
        if DRIVEN.name in by_name:
            self._take_motions(by_name[DRIVEN.name], certain_until)
        early, self._early = self._early, []
        for part in early:
            self._compare_output(part, certain_until, is_second_try=True)
        for name in self._outputs:
            for part in by_name.get(name, ()):
                self._compare_output(part, certain_until)
        self._retire(WINDOW)

    # --- motions of the driven joint ------------------------------------------------------------

    def _take_inputs(self, by_name: ByName) -> None:
        """Take the node's inputs and the states of its drive, ahead of driven motions."""
        inputs = [inputs_of(part, self._scene) for part in by_name.get(self._source or '', ())]
        if inputs and self._in_order:
            self._driven.take(*joined_by_place(inputs))
        for part in by_name.get(DRIVE_STATE.name, ()):
            self._modes.take(part, self._stepper.own_mode, self._scene.linkage.modes_passed)
        if self._drive_states:
            self._drive_states.commands(by_name.get(TORQUE.name, ()))
            self._drive_states.compare(by_name.get(DRIVE_STATE.name, ()))

    def _take_motions(self, blocks: Sequence[Columns], certain_until: float) -> None:
        """Compare driven motions with the input, and add the values expected of their outputs."""
        self._differences.compare_texts(DRIVEN.name, blocks)
        places, stamps, motions, times = joined_by_place(
            [(part.places, part.headed, np.stack(driven_of(part.tree), axis=1), part.times)
             for part in blocks])
        if self._source and self._in_order:
            self._driven.compare(places, stamps, motions)
        self._inputs += len(places)
        modes = self._modes.of(stamps, self._stepper.own_mode)
        status, values = self._evaluated(places, motions, modes)
        is_certain = ((times <= certain_until) & (times >= self._certain_from)
                      & ~self._holds_unknown(status))
        if not self._in_order:
            is_certain &= self._wrenches.is_settled(times, self._scene.wrenches.timeout)
        new = Window(places, stamps, modes, status, is_certain, values,
                     self._sources(status, motions),
                     np.zeros((len(self._outputs), len(places)), np.int64))
        self._window = self._window.followed_by(new) if self._window else new

    def _evaluated(self, places: Array, motions: Array, modes: Array) -> tuple[Array, Array]:
        """
        Return (status, values) of motions, of shape (n,) and (values, n).

        They are evaluated one by one as in the node: arrays may differ in the last bit.
        """
        samples = []
        for place, motion, mode in zip(places.tolist(), motions.tolist(), modes.tolist()):
            self._wrenches.apply(self._stepper, place)
            position, rate, acceleration = motion
            samples.append(self._stepper.step(mode, position, rate, acceleration, *self._wanted))
        return (np.array([status for status, _ in samples], float),
                np.array([values for _, values in samples]).T)

    def _sources(self, status: Array, motions: Array) -> Array:
        """Return the motions, shape (3, n), that the values are of: a held one is older."""
        rows: Array = np.arange(len(status))
        if self._scene.drive.out_of_range == 'hold':
            is_good = (status == OK) | (status == LOADS_UNKNOWN)
            last_good = np.maximum.accumulate(np.where(is_good, rows, -1))
            rows = np.where(last_good < 0, rows, last_good)
        return motions[rows].T

    def _holds_unknown(self, status: Array) -> Array:
        """Return a mask of motions whose outputs may hold values from before this file."""
        policies = self._scene.drive.out_of_range, self._scene.joint_states.when_unknown
        if not (self._may_hold_unknown and 'hold' in policies):
            return np.zeros(len(status), bool)
        good = np.flatnonzero(status == OK)
        self._may_hold_unknown = not len(good)
        return np.arange(len(status)) < (good[0] if len(good) else len(status))

    # --- outputs --------------------------------------------------------------------------------

    def _compare_output(self, columns: Columns, certain_until: float,
                        is_second_try: bool = False) -> None:
        """Compare the messages of one topic and layout with the motions they belong to."""
        name, stamps, window = self._name_of[columns.topic], columns.headed, self._window
        motions = (np.full(len(stamps), -1) if window is None
                   else window.motions_of(columns.places, stamps))
        has_motion = motions >= 0
        if not has_motion.all():
            self._without_motion(name, columns.at(~has_motion), certain_until, is_second_try)
        if window is None or not has_motion.any():
            return
        np.add.at(window.counts[self._outputs.index(name)], motions[has_motion], 1)
        is_certain = has_motion & window.is_certain[motions]
        self._uncertain += int(np.count_nonzero(has_motion & ~is_certain))
        if is_certain.any():
            self._differences.compare(name, columns.at(is_certain), window, motions[is_certain])

    def _without_motion(self, name: str, columns: Columns, certain_until: float,
                        is_second_try: bool) -> None:
        """
        Count outputs whose motion is not in the window, by the likely reason.

        Silent: the node told a timeout, without a motion. Uncertain: the bag does not tell
        the scene at their log time. Unmatched: neither. In a bag without order they are tried
        once more with the next block.
        """
        if not self._in_order and not is_second_try:
            self._early.append(columns)                  # it may come in the next block
            return
        silent = tells_timeout(columns, name, self._scene.layout)
        uncertain = ~silent & ((columns.times > certain_until)
                               | (columns.times < self._certain_from))
        self._silent += np.count_nonzero(silent)
        self._uncertain += np.count_nonzero(uncertain)
        self._unmatched += np.count_nonzero(~silent & ~uncertain)

    def _retire(self, keep: int) -> None:
        """Count missing and doubled outputs of all but the newest motions, and forget these."""
        window = self._window
        if window is None or len(window.places) <= keep:
            return
        old = slice(0, len(window.places) - keep)
        for name, counts in zip(self._outputs, window.counts):
            if name in self._differences.counts or self._in_order:
                # joint_states may be left out where a position is unknown
                needed = window.values[self._scene.needed_for(name), old]
                due = ~np.isnan(needed).any(axis=0) & window.is_certain[old]
                tally = self._tallies.setdefault(name, Tally(self._in_order))
                tally.add(counts[old], due)
        self._window = window.newest(keep) if keep else None

    # --- the result -----------------------------------------------------------------------------

    def finished(self, cut: bool) -> Recomputed:
        """
        Return the result after the last block; ``cut``: the recording broke off.

        Outputs whose motion has not come until now have none. Differences of driven motions and of
        drive states are added to the differences of the outputs.
        """
        early, self._early = self._early, []
        for part in early:
            self._compare_output(part, inf, is_second_try=True)
        self._retire(0)
        differences, tallies = self._differences, self._tallies.values()
        compared = sum(differences.counts.values())
        for field, value in self._driven.largest.items() if self._driven.compared else ():
            differences.note(DRIVEN.name, field, value)
        differences.counts[DRIVEN.name] = self._inputs
        if states := self._drive_states:
            differences.counts[DRIVE_STATE.name] = states.compared + states.alone
            for field, value in states.largest.items():
                differences.note(DRIVE_STATE.name, field, value)
        is_whole = self._in_order and not cut      # then the last outputs must be there too
        return Recomputed(
            differences.as_list(self._topics), self._inputs, compared, self._unmatched,
            missing=sum(tally.missing + tally.open * is_whole for tally in tallies),
            doubled=sum(tally.doubled for tally in tallies), silent=self._silent,
            uncertain=self._uncertain,
            driven=self._driven.summary(self._source and self._topics[self._source],
                                        self._in_order, states), cut=cut)


class Modes:
    """
    The assembly modes of driven motions: a drive that passes a toggle changes the mode.

    DriveState messages tell the mode by the stamp of the motion; without one it is the scene's.
    """

    def __init__(self) -> None:
        self._others: dict[int, int] = {}      # {stamp [ns]: mode} of motions to come

    def take(self, states: Columns, own: int, known: Collection[int]) -> None:
        """Take states of the drive; ``own``: the mode of the scene, one of the known ones."""
        modes = states.records['mode']
        is_other = (modes != own) & np.isin(modes, list(known))
        self._others.update(zip(states.headed[is_other].tolist(), modes[is_other].tolist()))

    def of(self, stamps: Array, own: int) -> Array:
        """Return the modes of motions with these stamps."""
        if not self._others:
            return np.full(len(stamps), own)
        return np.array([self._others.pop(stamp, own) for stamp in stamps.tolist()])
