# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Compute every recorded output again from the recorded motion of the driven joint and the scene.

Compare.

Both are in the bag: the motion as messages, the scene as its first message and again after every
change.
Where the input as it came is in the bag, the motion of the driven joint is computed again from it
too.
"""
from __future__ import annotations

import json
from math import inf
from operator import attrgetter

from fourbar_ros.bag.acting import Acting, UNSETTLED
from fourbar_ros.bag.difference import Difference, distance, Recomputed
from fourbar_ros.bag.driven import Driven, inputs_of
from fourbar_ros.bag.matching import in_order, Tally, Window
from fourbar_ros.bag.origin import origin_of, scene_of
from fourbar_ros.bag.reader import Bag, Record
from fourbar_ros.formats import rosbag2
from fourbar_ros.pipeline import rate_estimator
from fourbar_ros.pipeline.message_fields import driven_of
from fourbar_ros.pipeline.status import INPUT_TIMEOUT, OK
from fourbar_ros.pipeline.stepper import Stepper
from fourbar_ros.scene.scene import from_values
from fourbar_ros.scene.topics import DRIVE_STATE, DRIVEN, INPUTS, TORQUE
import numpy as np

__all__ = ['Difference', 'Recomputed', 'compare', 'distance', 'recompute', 'scene_of']

# inputs whose outputs may still come; bags of rosbag2 have them in any order
WINDOW = 1000
# what a planar linkage does not have
PLANAR = ('wrench.force.z', 'wrench.torque.x', 'wrench.torque.y')


def recompute(path):
    """Return the list of :class:`Difference` of a bag, by topic and field; see :func:`compare`."""
    return compare(path).differences


def compare(path, progress=None, node=None):
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

    """
    bag = Bag(path)
    origin = origin_of(bag, node)
    work = _Comparison(origin, bag.about())
    # a change of the scene has a say in what came before it
    waiting = None
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
    return work.finished(bag.cut)


class _Comparison:
    """Goes through a bag block by block."""

    def __init__(self, origin, about):
        self.counts, self.largest = {}, {}
        self.inputs = self.compared = self.unmatched = self.missing = self.doubled = 0
        self.silent = self.uncertain = 0
        self.topics, self._name_of = (origin.topics,
                                      {topic: name for name, topic in origin.topics.items()})
        self._in_order, self._settled = origin.in_order, -inf
        self._is_cold = rosbag2.REPEATS in about         # what it holds may be of the part before
        self._source = next((name for name in (*INPUTS, DRIVE_STATE.name)
                             if name in origin.topics), None)
        self._moved = self._moved_of(origin, about)
        is_same_estimator = about.get(rate_estimator.KEY) == str(rate_estimator.VERSION)
        self._scene, self._driven = None, Driven(origin.scene, is_same_estimator)
        self._tallies, self._acting, self._early = {}, Acting(), []
        self.change(origin.scene, None)

    @staticmethod
    def _moved_of(origin, about):
        """Return what steps the drive again, None where there is none or no order to step in."""
        if origin.scene.dynamics is None or not origin.in_order:
            return None
        from fourbar_ros.bag.moved import Moved  # and the equation of motion
        from fourbar_ros.dynamics.stepper import KEY
        return Moved(origin.scene, about.get(KEY, 'unknown'))

    def is_new(self, scene):
        """Return whether a scene counts as a change: rosbag2 repeats the latched one."""
        return self._in_order or scene.as_json != self._scene.as_json

    def change(self, scene, time):
        """Take another scene; it holds from the next input on."""
        self._retire(0)
        # of the scene before, their motion after
        self.uncertain += sum(len(found.times) for found in self._early)
        if self._scene:
            self._acting.apply(self._stepper)
        self._scene, self._stepper, self._layout = (scene, Stepper(scene, self._acting.wrenches),
                                                    scene.layout)
        self._acting.wrenches = self._stepper.acting
        self._driven.change(scene)
        if self._moved:
            self._moved.change(scene)
        self._wanted = scene.needs_loads, 'points' in scene.outputs
        self._constant = {'mode': scene.linkage.mode,
                          'change_point_margin': scene.linkage.change_point_margin,
                          **dict.fromkeys(PLANAR, 0.0)}
        self._texts = {'header.frame_id': scene.frame_id, 'name': scene.names_shown}
        self._holds = (scene.drive.out_of_range == 'hold' or scene.joint_states.when_unknown
                       == 'hold')
        self._may_skip = scene.joint_states.when_unknown == 'skip'
        self._outputs, self._window, self._early = scene.topics.keys(), None, []
        if time is not None and not self._in_order:
            self._settled = time + UNSETTLED

    # --- one block ------------------------------------------------------------------------------

    def block(self, columns, until=inf):
        """
        Compare all messages of a block.

        Those logged after ``until`` are near a change of the scene.
        """
        by_name = {}
        for found in columns:
            by_name.setdefault(self._name_of.get(found.topic), []).append(found)
        self._acting.take(by_name)
        self._take_inputs(by_name, until)
        late, self._early = self._early, []
        for found in late:
            self._output(found, until, is_late=True)
        for name in self._outputs & by_name.keys():
            for found in by_name[name]:
                self._output(found, until)
        self._retire(WINDOW)

    def _take_inputs(self, by_name, until):
        raw = [inputs_of(found, self._scene) for found in by_name.get(self._source, ())]
        if raw and self._in_order:
            self._driven.take(*in_order(raw))
        if self._moved:
            for found in by_name.get(TORQUE.name, ()):
                self._moved.commands(found)
            for found in by_name.get(DRIVE_STATE.name, ()):
                self._moved.compare(found)
        if DRIVEN.name not in by_name:
            return
        self._check_text(by_name[DRIVEN.name])
        places, stamps, motions, times = in_order([(found.places, found.stamps,
                                                    np.stack(driven_of(found.tree), axis=1),
                                                   found.times) for found in by_name[DRIVEN.name]])
        if self._source and self._in_order:
            self._driven.compare(places, stamps, motions)
        self.inputs += len(places)
        status, values = self._evaluated(places, motions)
        known = (times <= until) & (times >= self._settled) & ~self._held(status)
        if not self._in_order:
            known &= self._acting.is_settled(times)
        new = Window(places, stamps, status, known, values,
                     {name: np.zeros(len(places), np.int64) for name in self._outputs})
        self._window = new if self._window is None else self._window.followed_by(new)

    def _evaluated(self, places, motions):
        """
        Return statuses and values of motions.

        One by one, as the node does: not one bit differs.
        """
        found = []
        for place, motion in zip(places.tolist(), motions.tolist()):
            self._acting.apply(self._stepper, place)
            found.append(self._stepper.step(*motion, *self._wanted))
        return np.array([status for status, _ in found],
                        float), np.array([values for _, values in found]).T

    def _held(self, status):
        """Return the inputs whose outputs may hold values from before this part of a bag."""
        if not (self._is_cold and self._holds):
            return np.zeros(len(status), bool)
        good = np.flatnonzero(status == OK)
        self._is_cold = not len(good)
        return np.arange(len(status)) < (good[0] if len(good) else len(status))

    def _output(self, columns, until, is_late=False):
        """Compare the messages of one topic and layout with the motions they belong to."""
        name, stamps = self._name_of[columns.topic], columns.stamps
        source = (self._window.source_of(columns.places, stamps) if self._window
                  else np.full(len(stamps), -1))
        found = source >= 0
        if not found.all():
            self._without_motion(name, columns._replace(
                times=columns.times[~found], places=columns.places[~found],
                records=columns.records[~found]), until,
                is_late)
        if not found.any():
            return
        np.add.at(self._window.seen[name], source[found], 1)
        known = self._window.known[source[found]]
        self.uncertain += np.count_nonzero(~known)
        if known.any():
            rows = np.flatnonzero(found)[known]
            self._compare(name, columns._replace(
                times=columns.times[rows], places=columns.places[rows],
                records=columns.records[rows]), source[rows])

    def _without_motion(self, name, columns, until, is_late):
        """Count outputs that no motion so far has the stamp of."""
        if not self._in_order and not is_late:
            self._early.append(columns)                  # it may come in the next block
            return
        silent = self._says_silence(name, columns)
        unsettled = ~silent & ((columns.times > until) | (columns.times < self._settled))
        self.silent += np.count_nonzero(silent)
        self.uncertain += np.count_nonzero(unsettled)
        self.unmatched += np.count_nonzero(~silent & ~unsettled)

    def _says_silence(self, name, columns):
        """
        Return which messages say that the input has stopped.

        joint_states may hold positions meanwhile.
        """
        if 'status' in columns.records.dtype.names:
            return columns.records['status'] == INPUT_TIMEOUT
        fields = ('velocity',) if name == 'joint_states' else self._layout.fields[name]
        silent = np.ones(len(columns.times), bool)
        for field in fields:
            values = np.isnan(attrgetter(field)(columns.tree))
            silent &= values.all(axis=0) if values.ndim == 2 else values
        return silent

    def _compare(self, name, columns, source):
        window, count = self._window, len(source)
        self.counts[name] = self.counts.get(name, 0) + count
        self.compared += count
        # a bag of an older version may have less
        there, tree = columns.records.dtype.names, columns.tree
        expected = (self._layout.expected(name, window.values[:, source])
                    | {'status': window.status[source]})
        for field, value in (expected | self._constant).items():
            if field in there:
                want, have = _rows(value, count), attrgetter(field)(tree)
                same = want.shape[:-1] == have.shape[:-1]            # as many joints
                self._note(name, field, distance(want, have) if same else inf)
        self._check_text([columns])

    def _check_text(self, blocks):
        """Compare the texts of messages: frame and names of joints."""
        for columns in blocks:
            for field, want in self._texts.items():
                if field in columns.records.dtype.names:
                    good = (columns.records[field] == want.encode()).all()
                elif field in columns.layout.texts:
                    good = columns.layout.texts[field] == want
                else:
                    continue
                self._note(self._name_of[columns.topic], field, 0.0 if good else inf)

    def _note(self, name, field, value):
        self.largest[name, field] = max(self.largest.get((name, field), 0.0), value)

    # --- what a motion should have --------------------------------------------------------------

    def _retire(self, keep):
        """Count what all but the newest inputs have too much or too little, and forget them."""
        window = self._window if self._scene else None
        if window is None or len(window.places) <= keep:
            return
        old = slice(0, len(window.places) - keep)
        for name, seen in window.seen.items():
            if name in self.counts or self._in_order:
                due = self._is_due(name, window.values[:, old]) & window.known[old]
                tally = self._tallies.setdefault(name, Tally(self._in_order))
                tally.add(seen[old], due)
        self._window = window.from_(len(window.places) - keep) if keep else None

    def _is_due(self, name, values):
        """
        Return of which inputs there must be an output.

        joint_states may be left out if they are not known.
        """
        if name != 'joint_states' or not self._may_skip:
            return np.ones(values.shape[1], bool)
        places = [self._layout.place[position]
                  for position in self._layout.fields[name]['position']]
        return ~np.isnan(values[places]).any(axis=0)

    def finished(self, cut):
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
        differences = [Difference(self.topics[name], field, self.counts[name], value)
                       for (name, field), value in self.largest.items() if name in self.counts]
        return Recomputed(differences, self.inputs, self.compared, self.unmatched, self.missing,
                          self.doubled,
                          self.silent, self.uncertain, self._how_driven(), cut)

    def _how_driven(self):
        driven = self._driven
        if not self._in_order and self._source:
            return 'not computed again: the order of input and motion is not in the bag'
        if self._source is None:
            return (f'not computed again: driven by the {self._scene.drive.source}, no input in '
                    'the bag')
        text = f'{driven.compared} computed again from {self.topics[self._source]}'
        if self._moved:
            text += (f' ({self._moved.integrator}), {self._moved.compared} of these states '
                     'stepped again from the one before')
        if driven.unknown:
            text += (f', {driven.unknown} with rates estimated from samples before it or by '
                     'another version')
        return text + (f'; {driven.without} without an input' if driven.without else '')


def _rows(value, count):
    """Return a value of ``count`` messages, or a tuple of them, as an array (..., count)."""
    parts = [np.broadcast_to(part, count)
             for part in (value if isinstance(value, tuple) else (value,))]
    return np.stack(parts) if isinstance(value, tuple) else parts[0]
