# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Recorded outputs of a bag beside those computed from the motions they belong to."""
from __future__ import annotations

from collections.abc import Iterable, Mapping
from math import inf
from operator import attrgetter

from fourbar_ros.bag.acting import Acting, UNSETTLED
from fourbar_ros.bag.difference import Difference, distance, Recomputed
from fourbar_ros.bag.driven import Driven, inputs_of, moved_of
from fourbar_ros.bag.matching import in_order, rows_of, says_silence, Tally, Window
from fourbar_ros.bag.modes import Modes
from fourbar_ros.bag.origin import Origin
from fourbar_ros.bag.records import Columns
from fourbar_ros.bag.rounding import Condition, needs_condition, units
from fourbar_ros.formats import rosbag2
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.pipeline import rate_estimator
from fourbar_ros.pipeline.in_modes import InModes
from fourbar_ros.pipeline.message_fields import driven_of
from fourbar_ros.pipeline.status import LOADS_UNKNOWN, OK
from fourbar_ros.scene.scene import Scene
from fourbar_ros.scene.topics import DRIVE_STATE, DRIVEN, INPUTS, TORQUE
import numpy as np

# inputs whose outputs may still come; bags of rosbag2 have them in any order
WINDOW = 1000
# what a planar linkage does not have
PLANAR = ('wrench.force.z', 'wrench.torque.x', 'wrench.torque.y')


class Comparison:
    """
    Goes through a bag block by block.

    Parameters
    ----------
    origin : Origin
    about : dict
        custom_data of the bag.

    """

    def __init__(self, origin: Origin, about: Mapping[str, str]) -> None:
        self.counts: dict[str, int] = {}
        self.largest: dict[tuple[str, str], float] = {}
        self.units: dict[tuple[str, str], float] = {}
        self._condition: Condition | None = None     # of the scene, when it is needed
        self._window: Window | None = None
        self._stepper: InModes
        self._modes = Modes()
        self.inputs = self.compared = self.unmatched = self.missing = self.doubled = 0
        self.silent = self.uncertain = 0
        self.topics, self._name_of = (origin.topics,
                                      {topic: name for name, topic in origin.topics.items()})
        self._in_order, self._settled = origin.in_order, -inf
        self._is_cold = rosbag2.REPEATS in about         # what it holds may be of the part before
        self._source = next((name for name in (*INPUTS, DRIVE_STATE.name)
                             if name in origin.topics), None)
        self._moved = moved_of(origin, about)
        is_same_estimator = about.get(rate_estimator.KEY) == str(rate_estimator.VERSION)
        self._driven = Driven(origin.scene, is_same_estimator)
        self._tallies: dict[str, Tally] = {}
        self._early: list[Columns] = []
        self._acting = Acting(origin.topics, origin.scene.wrenches.links)
        self.change(origin.scene, None)

    def is_new(self, scene: Scene) -> bool:
        """Return whether a scene counts as a change: rosbag2 repeats the latched one."""
        return self._in_order or scene.as_json != self._scene.as_json

    def change(self, scene: Scene, time: int | None) -> None:
        """Take another scene; it holds from the next input on."""
        self._retire(0)
        # of the scene before, their motion after
        self.uncertain += sum(len(found.times) for found in self._early)
        if time is not None:                 # not the first
            self._acting.apply(self._stepper)
        self._scene, self._stepper, self._layout = (scene, InModes(scene, self._acting.wrenches),
                                                    scene.layout)
        self._acting.wrenches, self._condition = self._stepper.acting, None
        self._driven.change(scene)
        if self._moved:
            self._moved.change(scene)
        self._wanted = scene.needs_loads, frozenset(scene.topics)
        self._constant = {'change_point_margin': scene.linkage.change_point_margin,
                          **dict.fromkeys(PLANAR, 0.0)}
        self._texts = {'header.frame_id': scene.frame_id, 'name': scene.names_shown}
        self._holds = (scene.drive.out_of_range == 'hold' or scene.joint_states.when_unknown
                       == 'hold')
        self._may_skip = scene.joint_states.when_unknown == 'skip'
        self._outputs, self._window, self._early = scene.topics.keys(), None, []
        if time is not None and not self._in_order:
            self._settled = time + UNSETTLED

    # --- one block ------------------------------------------------------------------------------

    def block(self, columns: Iterable[Columns], until: float = inf) -> None:
        """
        Compare all messages of a block.

        Those logged after ``until`` are near a change of the scene.
        """
        by_name: dict[str | None, list[Columns]] = {}
        for found in columns:
            by_name.setdefault(self._name_of.get(found.topic), []).append(found)
        self._acting.take(by_name, self._scene.frame_id)
        self._take_inputs(by_name, until)
        late, self._early = self._early, []
        for found in late:
            self._output(found, until, is_late=True)
        for name in self._outputs & by_name.keys():
            for found in by_name[name]:
                self._output(found, until)
        self._retire(WINDOW)

    def _take_inputs(self, by_name: Mapping[str | None, list[Columns]], until: float) -> None:
        raw = [inputs_of(found, self._scene) for found in by_name.get(self._source, ())]
        if raw and self._in_order:
            self._driven.take(*in_order(raw))
        for found in by_name.get(DRIVE_STATE.name, ()):
            self._modes.take(found, self._stepper.own_mode, self._scene.linkage.modes_passed)
        if self._moved:
            for found in by_name.get(TORQUE.name, ()):
                self._moved.commands(found)
            for found in by_name.get(DRIVE_STATE.name, ()):
                self._moved.compare(found)
        if DRIVEN.name not in by_name:
            return
        self._check_text(by_name[DRIVEN.name])
        places, stamps, motions, times = in_order([(found.places, found.headed,
                                                    np.stack(driven_of(found.tree), axis=1),
                                                   found.times) for found in by_name[DRIVEN.name]])
        if self._source and self._in_order:
            self._driven.compare(places, stamps, motions)
        self.inputs += len(places)
        modes = self._modes.of(stamps, self._stepper.own_mode)
        status, values = self._evaluated(places, motions, modes)
        known = (times <= until) & (times >= self._settled) & ~self._held(status)
        if not self._in_order:
            known &= self._acting.is_settled(times, self._scene.wrenches.timeout)
        new = Window(places, stamps, modes, status, known, values, self._sources(status, motions),
                     {name: np.zeros(len(places), np.int64) for name in self._outputs})
        self._window = new if self._window is None else self._window.followed_by(new)

    def _evaluated(self, places: Array, motions: Array, modes: Array) -> tuple[Array, Array]:
        """
        Return statuses and values of motions.

        One by one, as the node does: not one bit differs.
        """
        found = []
        for place, motion, mode in zip(places.tolist(), motions.tolist(), modes.tolist()):
            self._acting.apply(self._stepper, place)
            found.append(self._stepper.step(mode, *motion, *self._wanted))
        return np.array([status for status, _ in found],
                        float), np.array([values for _, values in found]).T

    def _sources(self, status: Array, motions: Array) -> Array:
        """Return the motions, shape (3, n), that the values are of: a held one is older."""
        at: Array = np.arange(len(status))
        if self._scene.drive.out_of_range == 'hold':
            held = np.maximum.accumulate(np.where((status == OK) | (status == LOADS_UNKNOWN), at,
                                                  -1))
            at = np.where(held < 0, at, held)
        return motions[at].T

    def _held(self, status: Array) -> Array:
        """Return the inputs whose outputs may hold values from before this part of a bag."""
        if not (self._is_cold and self._holds):
            return np.zeros(len(status), bool)
        good = np.flatnonzero(status == OK)
        self._is_cold = not len(good)
        return np.arange(len(status)) < (good[0] if len(good) else len(status))

    def _output(self, columns: Columns, until: float, is_late: bool = False) -> None:
        """Compare the messages of one topic and layout with the motions they belong to."""
        name, stamps, window = self._name_of[columns.topic], columns.headed, self._window
        source = (np.full(len(stamps), -1) if window is None
                  else window.source_of(columns.places, stamps))
        found = source >= 0
        if not found.all():
            self._without_motion(name, columns._replace(
                times=columns.times[~found], places=columns.places[~found],
                records=columns.records[~found]), until,
                is_late)
        if window is None or not found.any():
            return
        np.add.at(window.seen[name], source[found], 1)
        known = window.known[source[found]]
        self.uncertain += int(np.count_nonzero(~known))
        if known.any():
            rows = np.flatnonzero(found)[known]
            self._compare(name, columns._replace(
                times=columns.times[rows], places=columns.places[rows],
                records=columns.records[rows]), window, source[rows])

    def _without_motion(self, name: str, columns: Columns, until: float, is_late: bool) -> None:
        """Count outputs that no motion so far has the stamp of."""
        if not self._in_order and not is_late:
            self._early.append(columns)                  # it may come in the next block
            return
        silent = says_silence(columns, name, self._layout)
        unsettled = ~silent & ((columns.times > until) | (columns.times < self._settled))
        self.silent += np.count_nonzero(silent)
        self.uncertain += np.count_nonzero(unsettled)
        self.unmatched += np.count_nonzero(~silent & ~unsettled)

    def _compare(self, name: str, columns: Columns, window: Window, source: Array) -> None:
        count = len(source)
        self.counts[name] = self.counts.get(name, 0) + count
        self.compared += count
        # a bag of an older version may have less
        there, tree = columns.fields, columns.tree
        expected = (self._layout.expected(name, window.values[:, source])
                    | {'status': window.status[source], 'mode': window.modes[source]}
                    | self._constant)
        differing = {}
        for field in expected.keys() & set(there):
            want, have = rows_of(expected[field], count), attrgetter(field)(tree)
            same = want.shape[:-1] == have.shape[:-1]            # as many joints
            largest = distance(want, have) if same else inf
            self._note(name, field, largest)
            if same and largest:
                differing[field] = want, have
        if differing:
            self._note_units(name, differing, window, source)
        self._check_text([columns])

    def _note_units(self, name: str, differing: Mapping[str, tuple[Array, Array]], window: Window,
                    source: Array) -> None:
        """Note the differences {field: (want, have)} of messages in eps times condition."""
        rows = np.zeros(len(source), bool)
        for pair in differing.values():
            rows |= needs_condition(*pair)
        conditions = np.zeros((len(window.values), len(source)))
        if rows.any():
            if self._condition is None:
                self._condition = Condition(self._scene, self._stepper.acting)
            conditions[:, rows] = self._condition.of(window.motions[:, source[rows]])
        of_fields = self._layout.expected(name, conditions)
        for field, (want, have) in differing.items():
            known = rows_of(of_fields.get(field, 0.0), len(source))
            self.units[name, field] = max(self.units.get((name, field), 0.0),
                                          units(want, have, np.broadcast_to(known, want.shape)))

    def _check_text(self, blocks: Iterable[Columns]) -> None:
        """Compare the texts of messages: frame and names of joints."""
        for columns in blocks:
            for field, want in self._texts.items():
                if field in columns.fields:
                    good = bool((columns.records[field] == str(want).encode()).all())
                elif field in columns.layout.texts:
                    good = columns.layout.texts[field] == want
                else:
                    continue
                self._note(self._name_of[columns.topic], field, 0.0 if good else inf)

    def _note(self, name: str, field: str, value: float) -> None:
        self.largest[name, field] = max(self.largest.get((name, field), 0.0), value)

    # --- what a motion should have --------------------------------------------------------------

    def _retire(self, keep: int) -> None:
        """Count what all but the newest inputs have too much or too little, and forget them."""
        window = self._window
        if window is None or len(window.places) <= keep:
            return
        old = slice(0, len(window.places) - keep)
        for name, seen in window.seen.items():
            if name in self.counts or self._in_order:
                due = self._is_due(name, window.values[:, old]) & window.known[old]
                tally = self._tallies.setdefault(name, Tally(self._in_order))
                tally.add(seen[old], due)
        self._window = window.from_(len(window.places) - keep) if keep else None

    def _is_due(self, name: str, values: Array) -> Array:
        """
        Return of which inputs there must be an output.

        joint_states may be left out if they are not known.
        """
        if name != 'joint_states' or not self._may_skip:
            return np.ones(values.shape[1], bool)
        places = [self._layout.place[position]
                  for position in self._layout.fields[name]['position']]
        return np.asarray(~np.isnan(values[places]).any(axis=0))

    def finished(self, cut: bool) -> Recomputed:
        """Return the Recomputed."""
        late, self._early = self._early, []
        for found in late:
            self._output(found, inf, is_late=True)
        self._retire(0)
        tallies = self._tallies.values()
        self.missing = sum(tally.missing + (tally.open if self._in_order and not cut else 0)
                           for tally in tallies)
        self.doubled = sum(tally.doubled for tally in tallies)
        for field, value in self._driven.largest.items() if self._driven.compared else ():
            self._note(DRIVEN.name, field, value)
        self.counts[DRIVEN.name] = self.inputs
        if self._moved:
            self.counts[DRIVE_STATE.name] = self._moved.compared + self._moved.alone
            for field, value in self._moved.largest.items():
                self._note(DRIVE_STATE.name, field, value)
        differences = [Difference(self.topics[name], field, self.counts[name], value,
                                  self.units.get((name, field), inf if value else 0.0))
                       for (name, field), value in self.largest.items() if name in self.counts]
        return Recomputed(differences, self.inputs, self.compared, self.unmatched, self.missing,
                          self.doubled,
                          self.silent, self.uncertain, self._driven.summary(
                              self._source and self.topics[self._source], self._in_order,
                              self._moved), cut)
