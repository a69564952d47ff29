# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The joints of a JointState: joint = ratio * coordinate + offset, in and out.

A mechanism has its angles within half a turn of zero. A joint does not jump where they come round:
ratio and offset act on the angle that goes on.

Rates and accelerations scale likewise, joint' = ratio * coordinate'. Power is the same on both
sides, so the effort of the joint is the effort of the coordinate divided by the ratio.
"""
from collections.abc import Mapping, Sequence
from math import inf, isfinite, isnan, nan, pi, tau
from operator import itemgetter
from typing import NamedTuple, TypeVar

from fourbar_ros.errors import FourBarError
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.scene.message_fields import nanoseconds
from fourbar_ros.scene.scene import Scene
import numpy as np

FloatOrArray = TypeVar('FloatOrArray', float, Array)
KEY, CONTINUOUS = 'joints', 'continuous'     # in a bag whose joints are
SAMPLES = 721          # over the range of the input, to follow each joint from the start


class Scale(NamedTuple):
    """joint = ratio * coordinate + offset; ``ratio`` is not zero, ``offset`` in [rad] or [m]."""

    ratio: float
    offset: float

    def to_input(self, position: FloatOrArray, velocity: FloatOrArray,
                 acceleration: FloatOrArray) -> tuple[FloatOrArray, FloatOrArray, FloatOrArray]:
        """Return the coordinate's motion from the joint's motion [rad, s] or [m, s]; NaN stays."""
        return ((position - self.offset) / self.ratio, velocity / self.ratio,
                acceleration / self.ratio)


TURN = tau * (1.0 + 1e-6)      # [rad] positions that wrap lie within it, rounded as floats are
SURE = 0.02            # [rad] so near to a whole turn is a step from rest that wraps


class TurnCounter:
    """
    Counts the turns of an input whose positions wrap, as those of many encoders.

    Behind a gear, where a turn of the joint is none of the coordinate, and at a change point that
    repeats after two turns it must count them. That it wraps shows where a step is a turn away
    from the one expected at the rate so far, to half of that, while all positions lie within a
    turn. From then on a position is in the turn nearest to the one expected. ``wraps`` tells
    whether it does. One position beyond a turn is then a bad one, as is one a turn away in
    positions that do not lie within one; after two in a row the count begins afresh.
    """

    def __init__(self, gap: float) -> None:
        self._gap, self.wraps = nanoseconds(gap), False
        self._low, self._high, self._is_bad = inf, -inf, False
        self._time, self._position, self._rate = 0, nan, nan     # of the newest sample

    def counted(self, time: int, position: float, velocity: float) -> tuple[float, bool]:
        """
        Return (position with its turns [rad], whether they are in doubt) of a sample.

        ``time`` is its stamp [ns]; ``velocity`` [rad/s] may be NaN. In doubt: after a pause, or
        beyond a turn; a step of a turn in positions that do not lie within one.
        """
        if not isfinite(position):
            return position, False
        passed, before = (time - self._time) * 1e-9, self._position
        rate = velocity if isfinite(velocity) else self._rate
        is_paused = abs(time - self._time) > self._gap       # or the clock was set
        is_known = isfinite(before + rate) and not is_paused
        due = before + rate * passed if is_known else before
        steps_a_turn = (is_known and abs(position - before) > pi
                        and abs(abs(position - due) - tau) < SURE + 0.5 * abs(due - before))
        low, high = min(self._low, position), max(self._high, position)
        wraps, is_beyond = self.wraps or steps_a_turn, high - low > TURN
        self._is_bad = wraps and is_beyond and not self._is_bad
        if self._is_bad:
            return continued(due, position), True
        begins_afresh = wraps and is_beyond
        self._low, self._high = (position, position) if begins_afresh else (low, high)
        self.wraps = wraps and not is_beyond
        counted = continued(due, position) if self.wraps else position
        if passed > 0.0 or is_paused or isnan(before):           # it is not late
            step = counted - before          # a step of more than half a turn tells no rate
            self._rate = velocity if isfinite(velocity) else (
                step / passed if abs(step) <= pi and passed > 0.0 and not is_paused else nan)
            self._time, self._position = time, counted
        return counted, begins_afresh or self.wraps and is_paused


class SceneJoints:
    """
    The joints of a scene as a JointState shows them, one sample after the other.

    Pins are continuous: where the mechanism's angle, within half a turn of zero, comes round, they
    go on. ``angles`` are the last known positions of all joints [rad or m]; by default they begin
    as :func:`first_angles` says. The driven joint is as its input came, unless that wraps.
    ``is_wrapped``: none is continuous, as in bags recorded before they were.
    """

    def __init__(self, scene: Scene, angles: Sequence[float] | None = None,
                 is_wrapped: bool = False) -> None:
        """Look up once which values of a sample are those of the joints, and how they scale."""
        layout, shown = scene.layout, scene.joint_states
        index_of, joints = layout.index_of, layout.joints
        self.angles = list(first_angles(scene) if angles is None else angles)
        self._scales = [Scale(*pair) for pair in zip(shown.ratios, shown.offsets)]
        self._is_scaled = set(self._scales) != {Scale(1.0, 0.0)}
        self._positions = itemgetter(*[index_of[joint.position] for joint, _ in joints])
        self._rates = itemgetter(*[index_of[joint.rate] for joint, _ in joints])
        # (index of the joint, index of its effort) of the driven joint; passive ones have none
        self._efforts = [(joint, index_of[effort]) for joint, (_, effort) in enumerate(joints)
                         if effort in index_of]
        self._holds = shown.when_unknown == 'hold'
        self._last = [nan] * len(joints)        # positions [rad, m] of the last known pose
        counts_turns = isnan(scene.drive.top_speed)     # the input's positions
        # indices of the joints whose angles go on where the mechanism's come round
        self._turning = [] if is_wrapped else [
            index for index, (joint, _) in enumerate(joints) if joint.unit == 'rad'
            and not (counts_turns and joint == scene.linkage.input_coordinate)]

    def of(self, values: Sequence[float]) -> tuple[float, ...]:
        """
        Return positions, then rates, then efforts of all joints from the values of one sample.

        Where a position is unknown, the last known positions stand in if they are to be held.
        """
        positions, rates, last = list(self._positions(values)), self._rates(values), self.angles
        efforts = [0.0] * len(positions)
        is_known = True
        for joint in self._turning:
            if not -pi <= positions[joint] - last[joint] <= pi:      # seldom: no call otherwise
                is_known = is_known and not isnan(positions[joint])
                positions[joint] = continued(last[joint], positions[joint])
        self.angles = positions if is_known else [
            before if isnan(angle) else angle for before, angle in zip(last, positions)]
        for joint, index in self._efforts:
            efforts[joint] = values[index] / self._scales[joint].ratio
        if self._is_scaled:
            positions = [ratio * x + offset for (ratio, offset), x in zip(self._scales, positions)]
            rates = [ratio * x for (ratio, _), x in zip(self._scales, rates)]
        if self._holds:
            if any(map(isnan, positions)):
                positions = self._last
            else:
                self._last = positions
        return (*positions, *rates, *efforts)

    def follow(self, positions: Mapping[int, float]) -> None:
        """Go on from positions in a JointState, {index of a joint: position}."""
        for joint, position in positions.items():
            scale = self._scales[joint]
            self.angles[joint] = (position - scale.offset) / scale.ratio


def continued(last: float, angle: float) -> float:
    """Return an angle [rad] in the turn where it is nearest to the last one."""
    away = last - angle
    return angle + tau * round(away / tau) if pi < abs(away) < inf else angle


def start_of(scene: Scene) -> float:
    """Return ``drive.start`` if the linkage closes there, else the middle of its first range."""
    try:
        scene.linkage.motion(scene.drive.start, 0.0, 0.0)
        return float(scene.drive.start)
    except FourBarError:
        low, high = scene.linkage.input_ranges[0]
        return 0.5 * (low + high)


def first_angles(scene: Scene) -> list[float]:
    """
    Return the position near which each joint of a scene begins [rad or m].

    A pin is in the turn in which its angle at the start of the scene is within half a turn of
    zero. If it only swings, it begins near the middle of its swing, so that every input has one
    position of it; else near its angle at the start.
    """
    mechanism, start = scene.linkage, start_of(scene)
    names = [joint.coordinate.position for joint in mechanism.JOINTS]
    at_start = mechanism.motion(start, 0.0, 0.0)
    angles = [float(getattr(at_start, name)) for name in names]
    inputs = np.linspace(*mechanism.range_around(start), SAMPLES)
    for joint, positions in enumerate(mechanism.motion(inputs, fields=tuple(names))):
        path = np.unwrap(positions[np.isfinite(positions)])
        turns_round = mechanism.turns_fully and abs(path[-1] - path[0]) > pi
        if mechanism.JOINTS[joint].coordinate.unit == 'rad' and not turns_round:
            near = path[np.argmin(abs(inputs[np.isfinite(positions)] - start))]
            angles[joint] += 0.5 * float(path.min() + path.max()) - float(near)
    return angles
