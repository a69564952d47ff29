# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Trajectories of the output joint as those of the driven joint, and back, in whole messages.

The points of a JointTrajectory as columns of numbers, and back, from and to bytes.

ROS makes an object of each point: of 20 000 in one call of half a second, in which no other thread
of the process runs. Points whose arrays have the same lengths are a numpy array as they lie there;
others are left to ROS.

Whole turns of an angle that its sender may have wrapped, from stamps and speeds.

A position means what it says, as for the controllers of ros2_control, with one exception. If all
positions of a message lie in one turn, [-pi, pi] or [0, 2 pi], and a step runs against the speeds
at both of its ends, it is a wrap where turns make it the way that these speeds go: the trapezoid
h (v + v')/2, up to half of it and a quarter of a turn.
"""
from __future__ import annotations

from collections.abc import Collection, Sequence
from contextlib import suppress
from math import pi, tau
from struct import error as StructError  # noqa: N812, it is a class
from struct import pack, unpack_from
from typing import Any, NamedTuple, Union

from fourbar_ros.errors import FourBarError, InvalidParameter
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.pipeline.joints import Scale
from fourbar_ros.ros.messages import resolve
from fourbar_ros.ros.node import qos
from fourbar_ros.ros.node.base import Base
from fourbar_ros.ros.node.sequence import Info, SequenceNumbers, WithInfo
from fourbar_ros.ros.node.worker import Abandoned, Worker
from fourbar_ros.scene.scene import Scene
from fourbar_ros.scene.topics import ANSWERS, INPUT_DEPTH, QUEUE_DEPTH, TRAJECTORIES
from fourbar_ros.transmission import (
    CannotFollow,
    Trajectory,
    trajectory,
    Transmission,
)
import numpy as np
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.serialization import deserialize_message, serialize_message
from std_msgs.msg import Header, String
from trajectory_msgs.msg import JointTrajectory

SIDES = {'to_input': ('output', 'input'), 'to_output': ('input', 'output')}     # given, asked for


class _Joint(NamedTuple):
    """A joint of the scene by name, and whether a turn of it is a turn of its coordinate."""

    name: str
    scale: Scale
    is_angle: bool


class _InForce(NamedTuple):
    """What of a scene answers."""

    transmission: Transmission
    joints: dict[str, _Joint]          # by side
    fields: tuple[str, ...]            # beside positions


class Trajectories:
    """
    Answers trajectories with the scene in force, in a thread of its own.

    Parameters
    ----------
    node : rclpy.node.Node
    scene : Scene

    """

    def __init__(self, node: Base, scene: Scene) -> None:
        self._node, self._came, self._done, self._too_many = node, 0, 0, 0
        self._refused = 0
        self._worker = Worker('trajectories', node.get_logger().error)
        self._last: dict[str, Counted] = {}              # by side
        self.apply(scene)
        self._senders = {
            name: node.circles.sender(
                qos.create(node, 'publisher', resolve(topic.type), topic.topic, QUEUE_DEPTH),
                topic)
            for name, topic in TRAJECTORIES.items() if name not in ANSWERS}
        self._sequences = [self._listen(name) for name in ANSWERS]

    def _listen(self, name: str) -> SequenceNumbers:
        topic = TRAJECTORIES[name]
        full = self._node.resolve_topic_name(topic.topic)
        sequence = SequenceNumbers(lambda: subscription.get_publisher_count())

        def take(data: bytes, info: Info) -> None:
            sequence.take(info['publication_sequence_number'])
            if not self._node.circles.is_own(full, data):
                self._take(name, data)
        subscription = qos.create(
            self._node, 'subscription', resolve(topic.type), topic.topic, WithInfo(take),
            INPUT_DEPTH, raw=True,
            event_callbacks=SubscriptionEventCallbacks(matched=lambda _: sequence.forget()))
        return sequence

    @property
    def counts(self) -> dict[str, int]:
        """Return the counters of the diagnostics: what came, was refused, was not taken."""
        lost = sum(sequence.lost for sequence in self._sequences) + self._too_many
        return {'trajectories': self._came + self._too_many,
                'trajectories_refused': self._refused, 'trajectories_lost': lost}

    def apply(self, scene: Scene) -> None:
        """Take over a scene."""
        mechanism, shown = scene.linkage, scene.joint_states
        coordinates = [joint.coordinate for joint in mechanism.JOINTS]
        joints = {}
        for side, its in (('input', mechanism.input_coordinate),
                          ('output', mechanism.outputs[0].coordinate)):
            place = coordinates.index(its)
            scale = Scale(shown.ratios[place], shown.offsets[place])
            joints[side] = _Joint(scene.joint_names[place], scale,
                                  its.unit == 'rad' and abs(scale.ratio) == 1.0)
        self._now = _InForce(scene.transmission, joints,
                             tuple(scene.values['trajectory_fields']))

    def stop(self, patience: float) -> None:
        """Answer no more; wait so long for the one in hand [s]."""
        self._worker.stop(patience)

    def _take(self, name: str, data: bytes) -> None:
        """Have a message answered, in the executor."""
        if self._came - self._done >= INPUT_DEPTH:
            self._too_many += 1
            self._tell(name, f'{INPUT_DEPTH} others wait for an answer')
            return
        self._came += 1
        now = self._node.get_clock().now().nanoseconds
        self._worker.do(lambda: self._answer(name, data, now))

    def _answer(self, name: str, data: bytes, came: int) -> None:
        """Answer or refuse a message that came at a time [ns], in the worker."""
        self._done += 1
        answer, method = ANSWERS[name]
        now, (given, asked) = self._now, SIDES[method]
        try:
            message = _read(data)
            counted, wanted = self._trajectory(message, given, now, came)
            found = getattr(now.transmission, method)(wanted)
        except FourBarError as error:
            self._refused += 1
            self._tell(name, str(error))
            return
        if counted:
            self._last[given] = counted
        data = write(message.header, now.joints[asked].name, message.times,
                     _columns(found, now.joints[asked].scale, now.fields))
        with suppress(Abandoned):
            self._worker.check()             # the node is there still
            self._senders[answer](data)

    def _trajectory(self, message: Points, side: str, now: _InForce, came: int
                    ) -> tuple[Counted | None, Trajectory]:
        """Return the trajectory of a joint in a message, and its turns if it is an angle."""
        joint = now.joints[side]
        if joint.name not in message.joint_names:
            raise InvalidParameter('joint_names', list(message.joint_names),
                                   f'must hold {joint.name}')
        if not len(message.times):
            raise InvalidParameter('points', [], 'must not be empty')
        position, velocity = (_needed(message, name, joint.name) for name in FIELDS[:2])
        acceleration, effort = (_column(message, name, joint.name) for name in FIELDS[2:])
        if 'effort' not in now.fields:
            effort = None
            acceleration = acceleration if 'accelerations' in now.fields else None
        elif effort is None:
            effort = np.zeros(len(position))
        found = trajectory(position, velocity, acceleration, effort)
        counted = None
        if joint.is_angle:
            stamp = message.header.stamp
            start = stamp.sec * 10**9 + stamp.nanosec or came
            counted = count(Samples(1e-9 * (message.times + start), *found[:2]),
                            self._last.get(side))
            position = counted.positions
        ratio = joint.scale.ratio
        return counted, Trajectory((position - joint.scale.offset) / ratio, velocity / ratio,
                                   None if acceleration is None else acceleration / ratio,
                                   None if effort is None else effort * ratio)

    def _tell(self, name: str, why: str) -> None:
        self._node.log.warning('trajectory', f'{TRAJECTORIES[name].topic}: {why}')
        self._senders['trajectory_refused'](serialize_message(String(data=why)))


def _read(data: bytes) -> Points:
    try:
        return read(data)
    except Exception:                        # whatever a foreign writer sends, the node goes on
        raise InvalidParameter('message', None, 'is no trajectory_msgs/msg/JointTrajectory'
                               ) from None


def _needed(message: Points, name: str, joint: str) -> Array:
    """Return a field of a joint over the points."""
    column = _column(message, name, joint)
    if column is None:
        raise InvalidParameter(name, [], f'must be given for {joint} in point 0')
    return column


def _column(message: Points, name: str, joint: str) -> Array | None:
    """Return a field of a joint over the points, None if no point has it."""
    rows, place = message.columns[name], list(message.joint_names).index(joint)
    if isinstance(rows, np.ndarray) and place < rows.shape[1]:
        return np.array(rows[:, place])
    missing = next((i for i, values in enumerate(rows) if len(values) <= place), None)
    if missing is None:
        return np.array([values[place] for values in rows])
    if any(map(len, rows)):
        raise InvalidParameter(name, list(rows[missing]),
                               f'must be given for {joint} in point {missing}')
    return None


def _columns(found: Trajectory, scale: Scale, fields: Collection[str]) -> dict[str, Array]:
    """Return the fields of an answer: positions, and those asked for as far as they are known."""
    ratio = scale.ratio
    columns = {'positions': ratio * found.position + scale.offset}
    if 'velocities' in fields:
        columns['velocities'] = ratio * found.rate
    if 'accelerations' in fields and found.acceleration is not None:
        columns['accelerations'] = ratio * found.acceleration
    if found.effort is not None:
        columns['effort'] = found.effort / ratio
    return columns


FIELDS = ('positions', 'velocities', 'accelerations', 'effort')
LITTLE_ENDIAN = b'\x00\x01'        # the beginning of what is read here
HEADER = 4                         # [bytes] before that from which alignment counts


class Points(NamedTuple):
    """
    A JointTrajectory.

    ``columns``: of each of FIELDS for each point the numbers of the joints, (n, joints), or a
    list where points differ; ``times``: ns from its start, shape (n,).
    """

    header: Header
    joint_names: Sequence[str]
    columns: dict[str, Union[Array, list[Any]]]
    times: Array


def read(data: bytes) -> Points:
    """Return the Points of a serialised JointTrajectory; raises what ROS raises for others."""
    at, count = _begin(data)
    if count:
        try:
            blocks = _blocks(data, at, count)
        except (ValueError, StructError):                # not as many: let ROS judge
            blocks = []
        if blocks:
            head = deserialize_message(data[:at - 4] + pack('<I', 0), JointTrajectory)
            columns = {name: np.concatenate([block[name] for block in blocks])
                       for name in FIELDS}
            times = np.concatenate([block['sec'].astype(np.int64) * 10**9 + block['nanosec']
                                    for block in blocks])
            return Points(head.header, head.joint_names, columns, times)
    message = deserialize_message(data, JointTrajectory)
    points = message.points
    return Points(message.header, message.joint_names,
                  {name: [getattr(point, name) for point in points] for name in FIELDS},
                  np.array([point.time_from_start.sec * 10**9 + point.time_from_start.nanosec
                            for point in points], np.int64))


def write(header: Header, joint: str, times: Array, columns: dict[str, Array]) -> bytes:
    """Return a serialised JointTrajectory of one joint; ``columns``: {field: (n,)}."""
    head = serialize_message(JointTrajectory(header=header, joint_names=[joint]))
    at, _ = _begin(head)
    lengths, made = [int(name in columns) for name in FIELDS], []
    for part in (slice(0, 1), slice(1, None)):
        block = np.zeros(len(times[part]), _point(lengths, (at - HEADER) % 8))
        block['sec'], block['nanosec'] = np.divmod(times[part], 10**9)
        for name, length in zip(FIELDS, lengths):
            block[f'{name} length'] = length
            if length:
                block[name][:, 0] = columns[name][part]
        made.append(block.tobytes())
        at += len(made[-1])
    return b''.join([head[:_begin(head)[0] - 4], pack('<I', len(times)), *made])


def _begin(data: bytes) -> tuple[int, int]:
    """Return where the points begin, behind their number, and that; (0, 0) if not found."""
    if data[:2] != LITTLE_ENDIAN:
        return 0, 0
    try:
        at = _after_text(data, HEADER + 8)               # of the header
        at += -at % 4
        names, = unpack_from('<I', data, at)
        at += 4
        for _ in range(names):
            at = _after_text(data, at)
        at += -at % 4
        return at + 4, *unpack_from('<I', data, at)
    except StructError:
        return 0, 0


def _after_text(data: bytes, at: int) -> int:
    at += -at % 4
    return int(at + 4 + unpack_from('<I', data, at)[0])


def _blocks(data: bytes, at: int, count: int) -> list[Array]:
    """Return the first point and all others, whose place may be aligned differently, as arrays."""
    lengths: list[int] = []
    place = at
    for _ in FIELDS:
        lengths += unpack_from('<I', data, place)
        place += 4
        if lengths[-1]:
            place += -(place - HEADER) % 8 + 8 * lengths[-1]
    blocks = []
    for number in (1, count - 1):
        kind = _point(lengths, (at - HEADER) % 8)
        blocks.append(np.frombuffer(data, kind, number, at) if number else np.zeros(0, kind))
        at += number * kind.itemsize
    same = all((block[f'{name} length'] == length).all()
               for block in blocks for name, length in zip(FIELDS, lengths))
    return blocks if same else []


def _point(lengths: Sequence[int], begin: int) -> np.dtype[np.void]:
    """Return the dtype of a point that begins so many bytes behind a multiple of 8."""
    names, formats, offsets, at = [], [], [], begin
    for name, length in zip(FIELDS, lengths):
        names += [f'{name} length', name]
        at += 4
        numbers = at + (-at % 8 if length else 0)
        formats += ['<u4', ('<f8', (length,))]
        offsets += [at - 4 - begin, numbers - begin]
        at = numbers + 8 * length
    return np.dtype({'names': [*names, 'sec', 'nanosec'], 'formats': [*formats, '<i4', '<u4'],
                     'offsets': [*offsets, at - begin, at + 4 - begin],
                     'itemsize': at + 8 - begin})


ROUNDED = 1e-6         # [rad] by which pi of a sender with single precision is beyond ours
QUARTER = 0.25 * tau
DELAY = 0.1            # [s] by which the arrival of messages without a stamp may vary


class Samples(NamedTuple):
    """Samples of a message, arrays of shape (n,): times [s], positions [rad], rates."""

    times: Array
    positions: Array
    rates: Array


class Counted(NamedTuple):
    """The samples of a message and the whole turns of each."""

    samples: Samples
    turns: Array

    @property
    def positions(self) -> Array:
        """Return the positions with their turns [rad]."""
        found: Array = self.samples.positions + tau * self.turns
        return found


def count(samples: Samples, last: Counted | None = None) -> Counted:
    """
    Return the samples of a message with their turns; ``last``: those of the message before.

    Times of both count from one date.

    Raises
    ------
    CannotFollow
        A step fits its speeds neither as it is nor with any turns.

    """
    turns = np.zeros(len(samples.times))
    if _may_be_wrapped(samples.positions):
        steps, is_wrap, way = _steps(samples)
        wrong = np.flatnonzero(~is_wrap & (steps != 0.0) & (np.abs(way) > QUARTER))
        if len(wrong):
            raise CannotFollow(_why_not(samples, wrong[0], way[wrong[0]]))
        turns[1:] = np.cumsum(np.where(is_wrap, steps, 0.0))
        if last is not None:
            turns += _turns_before(samples, last)
    return Counted(samples, turns)


def _turns_before(samples: Samples, last: Counted) -> float:
    """Return the turns with which a message begins, by where the last one is then."""
    place = np.searchsorted(last.samples.times, samples.times[0], 'right') - 1
    if place < 0:                            # a message of before it
        return float(last.turns[0])
    step, is_wrap, _ = _steps(Samples(*(np.array([one[place], other[0]])
                                        for one, other in zip(last.samples, samples))), DELAY)
    # else a new motion begins, wherever it likes
    return float(last.turns[place] + (step[0] if is_wrap[0] else 0.0))


def _may_be_wrapped(positions: Array) -> bool:
    """Return whether all positions lie in one turn, as senders wrap angles."""
    low, high = positions.min(), positions.max()
    return bool(low >= -pi - ROUNDED and high <= pi + ROUNDED
                or low >= -ROUNDED and high <= tau + ROUNDED)


@np.errstate(over='ignore', invalid='ignore')
def _steps(given: Samples, delay: float = 0.0) -> tuple[Array, Array, Array]:
    """Return the turns that steps lack by their speeds, whether they are wraps, and that way."""
    rates = given.rates
    speed = 0.5 * rates[1:] + 0.5 * rates[:-1]
    way = np.diff(given.times) * speed
    sense = np.where(np.sign(rates[1:]) == np.sign(rates[:-1]), np.sign(speed), 0.0)
    sense[~np.isfinite(way)] = 0.0
    way[sense == 0.0] = 0.0
    step = np.diff(given.positions)
    turns = np.round((way - step) / tau)
    turns[turns * sense <= 0.0] = 0.0            # a wrap takes turns off in the sense of motion
    whole = step + tau * turns
    error = np.abs(whole - way)
    is_wrap = ((turns != 0.0) & (step * sense < 0.0) & (error <= QUARTER)
               & (error <= 0.5 * np.maximum(np.abs(way), np.abs(whole)) + delay * np.abs(speed)))
    return turns, is_wrap, way


def _why_not(given: Samples, before: int, way: float) -> str:
    (one, other), (speed, next_speed) = (values[before:before + 2] for values in given[1:])
    return (f'sample {before + 1}: from {one:.8g} to {other:.8g} rad in '
            f'{given.times[before + 1] - given.times[before]:.8g} s, at {speed:.8g} and '
            f'{next_speed:.8g} rad/s, which is about {way:.3g} rad: count turns in the positions, '
            'or send points closer together')
