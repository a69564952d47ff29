# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Check the driven motions that a node reports against the inputs that it received."""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import inf, isnan, nan
from typing import TYPE_CHECKING

from fourbar_ros.bag.difference import apart
from fourbar_ros.bag.records import Columns
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.pipeline import joints
from fourbar_ros.pipeline.message_fields import driven_of, is_time
from fourbar_ros.pipeline.rate_estimator import estimator_of
from fourbar_ros.scene.scene import DriveSettings, Scene
import numpy as np

if TYPE_CHECKING:      # only where the motion follows from torque
    from fourbar_ros.bag.moved import Moved
    from fourbar_ros.bag.origin import Origin

FIELDS = ('position', 'velocity', 'acceleration')


class Driven:
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
        self._scale = joints.Scale(drive.joint_ratio, drive.joint_offset)
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
            source = None
            while at < len(waiting) and waiting[at][0] < place:
                source, at = waiting[at], at + 1
            if source is None:
                self.without += 1
            else:
                self._one(stamp, motion, *source[1:])
        self._inputs = waiting[at:]

    def summary(self, topic: str | None, in_order: bool, moved: Moved | None = None) -> str:
        """
        Return in one line how the motions were checked.

        ``topic`` is that of the input, None if the bag has none; ``in_order``: the bag keeps the
        order of input and motion; ``moved`` has stepped a drive again, if the scene has one.
        """
        if topic is None:
            source = self._drive.source if self._drive else ''
            return f'not recomputed: driven by the {source}, no input in the bag'
        if not in_order:
            return 'not recomputed: the order of input and motion is not in the bag'
        text = f'{self.compared} recomputed from {topic}'
        if moved:
            text += (f' ({moved.integrator}), {moved.compared} of these states stepped again from '
                     'the one before')
            if moved.unknown:
                text += (f', {moved.unknown} not compared: the bag begins next to a toggle, where '
                         'it does not hold the whole state')
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
                self.largest[field] = max(self.largest[field], apart(there, expected))
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
    scale = joints.Scale(scene.drive.joint_ratio, scene.drive.joint_offset)
    return columns.places, stamps, np.stack(scale.to_input(tree.position[i], velocity, unknown),
                                            axis=1)


def moved_of(origin: Origin, about: Mapping[str, str]) -> Moved | None:
    """Return what steps the drive again, None where there is none or no order to step in."""
    if origin.scene.dynamics is None or not origin.in_order:
        return None
    from fourbar_ros.bag.moved import Moved  # and the equation of motion
    from fourbar_ros.dynamics.steps import KEY
    return Moved(origin.scene, about.get(KEY, 'unknown'))
