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
from fourbar_ros.bag.comparison.difference import Difference, Differences, distance, Recomputed
from fourbar_ros.bag.comparison.inputs import (
    drive_states_of,
    DrivenMotions,
    inputs_of,
    mover_of,
    MoverOf,
    UNSETTLED,
    WrenchHistory,
)
from fourbar_ros.bag.comparison.window import in_order, says_silence, Tally, Window
from fourbar_ros.bag.read.origin import Origin, origin_of, scene_of
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

__all__ = ['Difference', 'Recomputed', 'compare', 'distance', 'recompute', 'scene_of']

WINDOW = 1000       # inputs whose outputs may still come; bags of rosbag2 have them in any order
ByName = Mapping[str, Sequence[Columns]]        # messages of a block by short name of their topic


def recompute(path: str | Path) -> list[Difference]:
    """Return the list of :class:`Difference` of a bag, by topic and field; see :func:`compare`."""
    return compare(path).differences


def compare(path: str | Path, progress: Progress | None = None, node: str | None = None,
            by: Evaluate = evaluate, moved_by: MoverOf = mover_of) -> Recomputed:
    """
    Return the :class:`Recomputed` of a bag.

    Each output is compared, with all its fields, with what the driven joint's motion of the same
    stamp gives: the last one before it in the bag, in bags of rosbag2 also one that comes later.
    Differences are absolute; NaN against NaN is none, NaN against a number infinite. Memory does
    not grow with the bag.

    Parameters
    ----------
    path : str or Path
    progress : callable, optional
        Called with the number of bytes read.
    node : str, optional
        Which node, if a bag of rosbag2 has several.
    by : callable, optional
        What computes motion and loads in place of Python, as ``evaluate`` of generated code.
    moved_by : callable, optional
        What moves a drive, as ``mover`` of generated code.

    """
    bag = Bag(path)
    origin = origin_of(bag, node)
    work = Comparison(origin, bag.about(), by, moved_by)
    waiting: list[Columns] | None = None      # a change of the scene may be near its end
    for block in bag.blocks(topics=list(origin.topics.values()), apart=origin.topics.get('scene'),
                            progress=progress):
        scene = None
        if isinstance(block, Record):
            scene = from_values(json.loads(block.message.data))
            is_new = work.is_new(scene)
        if waiting:
            work.block(waiting, block.time - UNSETTLED if scene and is_new and not origin.in_order
                       else inf)
        waiting = None if scene else block
        if scene and is_new:
            work.change(scene, block.time)
    if waiting:
        work.block(waiting)
    return work.finished(bool(bag.cut))


class Comparison:
    """
    Goes through a bag block by block.

    Parameters
    ----------
    origin : Origin
    about : dict
        custom_data of the bag.
    by, moved_by : callable
        What computes motion and loads; what moves a drive.

    """

    def __init__(self, origin: Origin, about: Mapping[str, str], by: Evaluate,
                 moved_by: MoverOf) -> None:
        self._by = by
        self._topics, self._in_order = origin.topics, origin.in_order
        self._name_of = {topic: name for name, topic in origin.topics.items()}
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
        self._inputs = self._unmatched = self._silent = self._uncertain = 0
        self._settled = -inf         # [ns] from when the bag tells which scene holds
        self._is_cold = rosbag2.REPEATS in about     # held values may be of the part before
        self._start(origin.scene)

    def is_new(self, scene: Scene) -> bool:
        """Return whether a scene counts as a change: rosbag2 repeats the latched one."""
        return self._in_order or scene.as_json != self._scene.as_json

    def change(self, scene: Scene, time: int) -> None:
        """Take another scene, logged at a time [ns]; it holds from the next input on."""
        self._retire(0)
        # of the scene before, their motion after
        self._uncertain += sum(len(found.times) for found in self._early)
        self._window, self._early = None, []
        self._wrenches.apply(self._stepper)
        self._start(scene)
        if not self._in_order:
            self._settled = time + UNSETTLED

    def _start(self, scene: Scene) -> None:
        self._scene, self._stepper = scene, InModes(scene, self._wrenches.in_effect,
                                                    self._by)
        self._wrenches.in_effect = self._stepper.wrenches
        self._differences.change(scene, self._stepper.wrenches)
        self._driven.change(scene)
        if self._drive_states:
            self._drive_states.change(scene)
        self._outputs = scene.topics.keys()
        self._wanted = scene.needs_loads, frozenset(scene.topics)

    def block(self, columns: Iterable[Columns], until: float = inf) -> None:
        """
        Compare all messages of a block.

        Those logged after ``until`` are near a change of the scene.
        """
        by_name: dict[str, list[Columns]] = {}
        for found in columns:
            by_name.setdefault(self._name_of.get(found.topic, ''), []).append(found)
        self._wrenches.take(by_name, self._scene.frame_id)
        self._take_inputs(by_name)
        if DRIVEN.name in by_name:
            self._take_motions(by_name[DRIVEN.name], until)
        late, self._early = self._early, []
        for found in late:
            self._output(found, until, is_late=True)
        for name in self._outputs & by_name.keys():
            for found in by_name[name]:
                self._output(found, until)
        self._retire(WINDOW)

    # --- motions of the driven joint ------------------------------------------------------------

    def _take_inputs(self, by_name: ByName) -> None:
        raw = [inputs_of(found, self._scene) for found in by_name.get(self._source or '', ())]
        if raw and self._in_order:
            self._driven.take(*in_order(raw))
        for found in by_name.get(DRIVE_STATE.name, ()):
            self._modes.take(found, self._stepper.own_mode, self._scene.linkage.modes_passed)
        if self._drive_states:
            self._drive_states.commands(by_name.get(TORQUE.name, ()))
            self._drive_states.compare(by_name.get(DRIVE_STATE.name, ()))

    def _take_motions(self, blocks: Sequence[Columns], until: float) -> None:
        """Check the driven motions of a block, and add what follows from them to the window."""
        self._differences.compare_texts(DRIVEN.name, blocks)
        places, stamps, motions, times = in_order([(found.places, found.headed,
                                                    np.stack(driven_of(found.tree), axis=1),
                                                    found.times) for found in blocks])
        if self._source and self._in_order:
            self._driven.compare(places, stamps, motions)
        self._inputs += len(places)
        modes = self._modes.of(stamps, self._stepper.own_mode)
        status, values = self._evaluated(places, motions, modes)
        known = (times <= until) & (times >= self._settled) & ~self._held(status)
        if not self._in_order:
            known &= self._wrenches.is_settled(times, self._scene.wrenches.timeout)
        new = Window(places, stamps, modes, status, known, values, self._sources(status, motions),
                     {name: np.zeros(len(places), np.int64) for name in self._outputs})
        self._window = new if self._window is None else self._window.followed_by(new)

    def _evaluated(self, places: Array, motions: Array, modes: Array) -> tuple[Array, Array]:
        """Return statuses and values of motions, one by one as in the node: to the last bit."""
        found = []
        for place, motion, mode in zip(places.tolist(), motions.tolist(), modes.tolist()):
            self._wrenches.apply(self._stepper, place)
            position, rate, acceleration = motion
            found.append(self._stepper.step(mode, position, rate, acceleration, *self._wanted))
        return (np.array([status for status, _ in found], float),
                np.array([values for _, values in found]).T)

    def _sources(self, status: Array, motions: Array) -> Array:
        """Return the motions, shape (3, n), that the values are of: a held one is older."""
        at: Array = np.arange(len(status))
        if self._scene.drive.out_of_range == 'hold':
            held = np.maximum.accumulate(np.where((status == OK) | (status == LOADS_UNKNOWN), at,
                                                  -1))
            at = np.where(held < 0, at, held)
        return motions[at].T

    def _held(self, status: Array) -> Array:
        """Return a mask of inputs whose outputs may hold values from before this part of a bag."""
        policies = self._scene.drive.out_of_range, self._scene.joint_states.when_unknown
        if not (self._is_cold and 'hold' in policies):
            return np.zeros(len(status), bool)
        good = np.flatnonzero(status == OK)
        self._is_cold = not len(good)
        return np.arange(len(status)) < (good[0] if len(good) else len(status))

    # --- outputs --------------------------------------------------------------------------------

    def _output(self, columns: Columns, until: float, is_late: bool = False) -> None:
        """Compare the messages of one topic and layout with the motions they belong to."""
        name, stamps, window = self._name_of[columns.topic], columns.headed, self._window
        source = (np.full(len(stamps), -1) if window is None
                  else window.source_of(columns.places, stamps))
        found = source >= 0
        if not found.all():
            self._without_motion(name, columns.at(~found), until, is_late)
        if window is None or not found.any():
            return
        np.add.at(window.seen[name], source[found], 1)
        known = window.known[source[found]]
        self._uncertain += int(np.count_nonzero(~known))
        if known.any():
            rows = np.flatnonzero(found)[known]
            self._differences.compare(name, columns.at(rows), window, source[rows])

    def _without_motion(self, name: str, columns: Columns, until: float, is_late: bool) -> None:
        """Count outputs that no motion so far has the stamp of."""
        if not self._in_order and not is_late:
            self._early.append(columns)                  # it may come in the next block
            return
        silent = says_silence(columns, name, self._scene.layout)
        unsettled = ~silent & ((columns.times > until) | (columns.times < self._settled))
        self._silent += np.count_nonzero(silent)
        self._uncertain += np.count_nonzero(unsettled)
        self._unmatched += np.count_nonzero(~silent & ~unsettled)

    def _retire(self, keep: int) -> None:
        """Count missing and doubled outputs of all but the newest inputs, and forget these."""
        window = self._window
        if window is None or len(window.places) <= keep:
            return
        old = slice(0, len(window.places) - keep)
        for name, seen in window.seen.items():
            if name in self._differences.counts or self._in_order:
                # joint_states may be left out if they are not known
                needed = window.values[self._scene.needed_for(name), old]
                due = ~np.isnan(needed).any(axis=0) & window.known[old]
                tally = self._tallies.setdefault(name, Tally(self._in_order))
                tally.add(seen[old], due)
        self._window = window.from_(len(window.places) - keep) if keep else None

    # --- the result -----------------------------------------------------------------------------

    def finished(self, cut: bool) -> Recomputed:
        """Return the Recomputed."""
        late, self._early = self._early, []
        for found in late:
            self._output(found, inf, is_late=True)
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
        return Recomputed(
            differences.as_list(self._topics), self._inputs, compared, self._unmatched,
            missing=sum(tally.missing + (tally.open if self._in_order and not cut else 0)
                        for tally in tallies),
            doubled=sum(tally.doubled for tally in tallies), silent=self._silent,
            uncertain=self._uncertain,
            driven=self._driven.summary(self._source and self._topics[self._source],
                                        self._in_order, states), cut=cut)


class Modes:
    """Assembly modes that states of a drive tell by their stamps; without one, the scene's."""

    def __init__(self) -> None:
        self._others: dict[int, int] = {}      # by the stamps of motions to come

    def take(self, states: Columns, own: int, known: Collection[int]) -> None:
        """Take states of the drive; ``own``: the mode of the scene, one of the known ones."""
        modes = states.records['mode']
        there = (modes != own) & np.isin(modes, list(known))
        self._others.update(zip(states.headed[there].tolist(), modes[there].tolist()))

    def of(self, stamps: Array, own: int) -> Array:
        """Return the modes of motions with these stamps."""
        if not self._others:
            return np.full(len(stamps), own)
        return np.array([self._others.pop(stamp, own) for stamp in stamps.tolist()])
