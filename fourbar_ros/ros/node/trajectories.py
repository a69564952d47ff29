# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
JointTrajectory messages of the output joint converted to the driven joint, and back.

Bytes: ROS makes an object of each point, which for 20 000 points takes half a second in which no
other thread of the process runs, so the stream would stop. Points whose arrays have equal lengths
lie in the message as one numpy array; it is read and written so. Others are left to ROS.

Turns: a sender may have wrapped an angle, from pi to -pi, say. A position means what it says, as
for the controllers of ros2_control, with one exception. If all positions of a message lie in one
turn, [-pi, pi] or [0, 2 pi], and a step runs against the speeds at both of its ends, whole turns
are added to it if it then agrees with the way by these speeds, h (v + v')/2, to within a half of
it and a quarter of a turn.
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
from fourbar_ros.ros.node import qos
from fourbar_ros.ros.node.base import Base
from fourbar_ros.ros.node.sequence import Info, SequenceNumbers, WithInfo
from fourbar_ros.ros.node.worker import Abandoned, Worker
from fourbar_ros.scene.scene import Scene
from fourbar_ros.scene.topics import ANSWERS, INPUT_DEPTH, TRAJECTORIES
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
    """A joint of the scene; ``is_angle``: whether its whole turns are turns of the mechanism."""

    name: str
    scale: Scale
    is_angle: bool


class _Conversion(NamedTuple):
    """The parts of the scene in force that convert a trajectory."""

    transmission: Transmission
    joints: dict[str, _Joint]          # of 'input' and 'output'
    fields: tuple[str, ...]            # to convert beside positions


class Trajectories:
    """Converts trajectories by the scene in force, in a thread of its own."""

    def __init__(self, node: Base, scene: Scene) -> None:
        self._node = node
        # numbers of trajectories since the start:
        self._queued = 0            # put into the worker's queue
        self._overflowed = 0        # never queued, for INPUT_DEPTH others waited
        self._refused = 0           # invalid
        self._worker = Worker('trajectories', node.get_logger().error, INPUT_DEPTH)
        # the last valid one for the joint 'input' and for 'output': the next goes on from its turn
        self._last: dict[str, Counted] = {}
        self.apply(scene)
        # {name of a topic: function that publishes bytes there}: answers and refusals
        self._senders = {name: node.circles.sender(qos.publisher(node, topic), topic)
                         for name, topic in TRAJECTORIES.items() if name not in ANSWERS}
        # counters of the messages that the middleware lost, one for each topic that is converted
        self._sequences = [self._listen(name) for name in ANSWERS]

    def _listen(self, name: str) -> SequenceNumbers:
        """Subscribe to a topic of trajectories; return the counter of its lost messages."""
        topic = TRAJECTORIES[name]
        full = self._node.resolve_topic_name(topic.topic)
        sequence = SequenceNumbers(lambda: subscription.get_publisher_count())

        def take(data: bytes, info: Info) -> None:
            sequence.take(info['publication_sequence_number'])
            if not self._node.circles.is_own(full, data):
                self._take(name, data)
        subscription = qos.subscription(
            self._node, topic, WithInfo(take), is_reliable=True,
            event_callbacks=SubscriptionEventCallbacks(matched=lambda _: sequence.forget()))
        return sequence

    @property
    def counts(self) -> dict[str, int]:
        """Return counters for the diagnostics: trajectories that came, were refused, were lost."""
        lost = sum(sequence.lost for sequence in self._sequences) + self._overflowed
        return {'trajectories': self._queued + self._overflowed,
                'trajectories_refused': self._refused, 'trajectories_lost': lost}

    def apply(self, scene: Scene) -> None:
        """Take over a scene: its transmission, and names and scales of the two joints."""
        mechanism, shown = scene.linkage, scene.joint_states
        coordinates = [joint.coordinate for joint in mechanism.JOINTS]
        joints = {}
        for side, coordinate in (('input', mechanism.input_coordinate),
                                 ('output', mechanism.outputs[0].coordinate)):
            place = coordinates.index(coordinate)
            scale = Scale(shown.ratios[place], shown.offsets[place])
            joints[side] = _Joint(scene.joint_names[place], scale,
                                  coordinate.unit == 'rad' and abs(scale.ratio) == 1.0)
        self._conversion = _Conversion(scene.transmission, joints,
                                       tuple(scene.values['trajectory_fields']))

    def stop(self, patience: float) -> None:
        """Answer no more; wait up to ``patience`` [s] for the answer in work."""
        self._worker.stop(patience)

    def _take(self, name: str, data: bytes) -> None:
        """Queue a message for the worker; refuse it if INPUT_DEPTH others wait there."""
        now = self._node.get_clock().now().nanoseconds
        if self._worker.do(lambda: self._answer(name, data, now)):
            self._queued += 1
        else:
            self._overflowed += 1
            self._refuse(name, f'{INPUT_DEPTH} others wait for an answer')

    def _answer(self, name: str, data: bytes, arrival: int) -> None:
        """
        Convert a trajectory from the topic ``name`` and send the answer, or refuse it.

        An output joint's trajectory becomes a driven joint's trajectory, or the reverse, as
        ANSWERS says for the topic. ``arrival``: when it came [ns].
        """
        answer_topic, method = ANSWERS[name]
        conversion, (given, asked) = self._conversion, SIDES[method]
        try:
            message = _read(data)
            counted, its_trajectory = self._trajectory(message, given, conversion, arrival)
            converted = getattr(conversion.transmission, method)(its_trajectory)
        except FourBarError as error:
            self._refused += 1
            self._refuse(name, str(error))
            return
        if counted:
            self._last[given] = counted
        joint = conversion.joints[asked]
        data = write(message.header, joint.name, message.times,
                     _columns(converted, joint.scale, conversion.fields))
        with suppress(Abandoned):
            self._worker.check()             # else the node, and its publishers, may be gone
            self._senders[answer_topic](data)

    def _trajectory(self, message: Points, side: str, conversion: _Conversion, arrival: int
                    ) -> tuple[Counted | None, Trajectory]:
        """
        Return (positions with turns, trajectory in the mechanism's coordinate) of a joint.

        The first is None unless the joint is an angle whose turns count. ``side``: 'input' or
        'output'; ``arrival`` [ns] is for messages without a stamp.
        """
        joint = conversion.joints[side]
        if joint.name not in message.joint_names:
            raise InvalidParameter('joint_names', list(message.joint_names),
                                   f'must hold {joint.name}')
        if not len(message.times):
            raise InvalidParameter('points', [], 'must not be empty')
        back = np.flatnonzero(np.diff(message.times) < 0)
        if len(back):
            point = int(back[0]) + 1
            before, time = (message.times[point - 1:point + 1] * 1e-9).tolist()
            raise InvalidParameter(f'points[{point}].time_from_start', time,
                                   f'must not decrease: the point before has {before:g} s')
        position, velocity = (_needed(message, name, joint.name) for name in FIELDS[:2])
        acceleration, effort = (_column(message, name, joint.name) for name in FIELDS[2:])
        if 'effort' not in conversion.fields:
            effort = None
            acceleration = acceleration if 'accelerations' in conversion.fields else None
        elif effort is None:
            effort = np.zeros(len(position))
        checked = trajectory(position, velocity, acceleration, effort)
        counted = None
        if joint.is_angle:
            stamp = message.header.stamp
            start = stamp.sec * 10**9 + stamp.nanosec or arrival
            counted = count(Samples(1e-9 * (message.times + start), *checked[:2]),
                            self._last.get(side))
            position = counted.positions
        ratio = joint.scale.ratio
        return counted, Trajectory((position - joint.scale.offset) / ratio, velocity / ratio,
                                   None if acceleration is None else acceleration / ratio,
                                   None if effort is None else effort * ratio)

    def _refuse(self, name: str, why: str) -> None:
        """Log and publish why a trajectory on a topic gets no answer."""
        self._node.log.warning('trajectory', f'{TRAJECTORIES[name].topic}: {why}')
        self._senders['trajectory_refused'](serialize_message(String(data=why)))


def _read(data: bytes) -> Points:
    """Read a message; raise InvalidParameter for bytes that are no JointTrajectory."""
    try:
        return read(data)
    except Exception:
        raise InvalidParameter('message', None, 'is no trajectory_msgs/msg/JointTrajectory'
                               ) from None


def _needed(message: Points, name: str, joint: str) -> Array:
    """Return a field of a joint as :func:`_column` does; raise InvalidParameter if it is None."""
    column = _column(message, name, joint)
    if column is None:
        raise InvalidParameter(name, [], f'must be given for {joint} in point 0')
    return column


def _column(message: Points, name: str, joint: str) -> Array | None:
    """
    Return a field of a joint over the points, shape (n,); None if no point has the field.

    Raises
    ------
    InvalidParameter
        Some points have it and others do not.

    """
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


def _columns(converted: Trajectory, scale: Scale, fields: Collection[str]) -> dict[str, Array]:
    """Return {field: (n,)} of an answer in the joint's scale: positions, others as asked for."""
    ratio = scale.ratio
    columns = {'positions': ratio * converted.position + scale.offset}
    if 'velocities' in fields:
        columns['velocities'] = ratio * converted.rate
    if 'accelerations' in fields and converted.acceleration is not None:
        columns['accelerations'] = ratio * converted.acceleration
    if converted.effort is not None:
        columns['effort'] = converted.effort / ratio
    return columns


FIELDS = ('positions', 'velocities', 'accelerations', 'effort')
LITTLE_ENDIAN = b'\x00\x01'        # first bytes of plain CDR; other encodings are left to ROS
HEADER = 4                         # [bytes] of the encoding; alignment counts from behind it


class Points(NamedTuple):
    """
    A JointTrajectory of n points, by columns.

    ``columns``: {each of FIELDS: array of shape (n, joints)}, or a list of n sequences where
    points have unlike lengths; ``times`` [ns] from the start, shape (n,).
    """

    header: Header
    joint_names: Sequence[str]
    columns: dict[str, Union[Array, list[Any]]]
    times: Array


def read(data: bytes) -> Points:
    """Return the Points of a serialised JointTrajectory; raise what ROS raises for other bytes."""
    at, count = _begin(data)
    if count:
        try:
            blocks = _blocks(data, at, count)
        except (ValueError, StructError):                # fewer bytes than points: let ROS judge
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
    """
    Return a serialised JointTrajectory of one joint; ``columns``: {field: (n,)}.

    ROS serialises one without points; the number of points and the points follow here, in two
    blocks as in :func:`_blocks`.
    """
    empty = serialize_message(JointTrajectory(header=header, joint_names=[joint]))
    begin, _ = _begin(empty)
    lengths = [int(name in columns) for name in FIELDS]
    parts = [empty[:begin - 4], pack('<I', len(times))]
    for rows in (slice(0, 1), slice(1, None)):
        block = np.zeros(len(times[rows]), _point(lengths, (begin - HEADER) % 8))
        block['sec'], block['nanosec'] = np.divmod(times[rows], 10**9)
        for name, length in zip(FIELDS, lengths):
            block[f'{name} length'] = length
            if length:
                block[name][:, 0] = columns[name][rows]
        parts.append(block.tobytes())
        begin += len(parts[-1])
    return b''.join(parts)


def _begin(data: bytes) -> tuple[int, int]:
    """
    Return (offset of the first point, number of points) in a serialised JointTrajectory.

    In front of the points stand the header, with its stamp and frame_id, and the joint names.
    (0, 0) for another encoding than plain CDR, and for bytes that end too early.
    """
    if data[:2] != LITTLE_ENDIAN:
        return 0, 0
    try:
        at = _after_text(data, HEADER + 8)               # frame_id, behind the stamp
        at += -at % 4
        joints, = unpack_from('<I', data, at)
        at += 4
        for _ in range(joints):
            at = _after_text(data, at)
        at += -at % 4
        return at + 4, *unpack_from('<I', data, at)
    except StructError:
        return 0, 0


def _after_text(data: bytes, at: int) -> int:
    """Return the offset behind a CDR string: padding to 4, its length in 4 bytes, its bytes."""
    at += -at % 4
    return int(at + 4 + unpack_from('<I', data, at)[0])


def _blocks(data: bytes, at: int, count: int) -> list[Array]:
    """
    Return the ``count`` points from offset ``at`` as two structured arrays: the first, all others.

    The first may begin at another offset modulo 8 than the others, so its padding differs. The
    lengths of its arrays are taken for all; an empty list if another point has other lengths.
    """
    lengths: list[int] = []         # of the arrays of the first point, in the order of FIELDS
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
    """
    Return the dtype of a point in CDR that begins ``begin`` bytes behind a multiple of 8.

    ``lengths``: numbers of values of its FIELDS. Each array is a count of 4 bytes, padding to 8,
    and doubles; behind them stands the time from start.
    """
    names, formats, offsets, end = [], [], [], begin
    for name, length in zip(FIELDS, lengths):
        names += [f'{name} length', name]
        formats += ['<u4', ('<f8', (length,))]
        values = end + 4
        values += -values % 8 if length else 0
        offsets += [end - begin, values - begin]
        end = values + 8 * length
    return np.dtype({'names': [*names, 'sec', 'nanosec'], 'formats': [*formats, '<i4', '<u4'],
                     'offsets': [*offsets, end - begin, end + 4 - begin],
                     'itemsize': end + 8 - begin})


ROUNDED = 1e-6         # [rad] by which a sender's pi in single precision may be larger
QUARTER = 0.25 * tau   # [rad] by which a step may differ from the way by its speeds
DELAY = 0.1            # [s] by which the arrival of messages without a stamp may vary


class Samples(NamedTuple):
    """Samples of a message, arrays of shape (n,): times [s], positions [rad], rates [rad/s]."""

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
        return np.asarray(self.samples.positions + tau * self.turns)


def count(samples: Samples, last: Counted | None = None) -> Counted:
    """
    Return the samples of a message with the whole turns that its sender took off.

    Positions 3.0, -3.1 at speed +2 become turns 0, 1: the step was a wrap. ``last``, the message
    before, tells in which turn this one begins; times of both count from one date.

    Raises
    ------
    CannotFollow
        A step fits its speeds neither as it is nor with any turns.

    """
    turns = np.zeros(len(samples.times))
    if _may_be_wrapped(samples.positions):
        lacking, is_wrap, way = _steps(samples)
        wrong = np.flatnonzero(~is_wrap & (lacking != 0.0) & (np.abs(way) > QUARTER))
        if len(wrong):
            raise CannotFollow(_why_not(samples, wrong[0], way[wrong[0]]))
        turns[1:] = np.cumsum(np.where(is_wrap, lacking, 0.0))
        if last is not None:
            turns += _turns_before(samples, last)
    return Counted(samples, turns)


def _turns_before(samples: Samples, last: Counted) -> float:
    """Return the turns with which a message begins, by the sample of ``last`` before it."""
    place = np.searchsorted(last.samples.times, samples.times[0], 'right') - 1
    if place < 0:                            # it begins before ``last``
        return float(last.turns[0])
    lacking, is_wrap, _ = _steps(Samples(*(np.array([before[place], after[0]])
                                           for before, after in zip(last.samples, samples))),
                                 DELAY)
    # if the step is no wrap, a new motion begins, at any position
    return float(last.turns[place] + (lacking[0] if is_wrap[0] else 0.0))


def _may_be_wrapped(positions: Array) -> bool:
    """Return whether all positions lie in one turn, as senders wrap angles."""
    low, high = positions.min(), positions.max()
    return bool(low >= -pi - ROUNDED and high <= pi + ROUNDED
                or low >= -ROUNDED and high <= tau + ROUNDED)


@np.errstate(over='ignore', invalid='ignore')
def _steps(samples: Samples, delay: float = 0.0) -> tuple[Array, Array, Array]:
    """
    Return arrays (n - 1,) of the steps between samples: turns lacking, is a wrap, way [rad].

    The way follows from the time h and the speeds at both ends, h (v + v')/2; it is zero where
    their signs differ. A step of -6.1 rad on a way of 0.2 lacks one turn. ``delay`` [s]: the
    times of the samples may differ so much from the true ones.
    """
    rates = samples.rates
    speed = 0.5 * rates[1:] + 0.5 * rates[:-1]
    way = np.diff(samples.times) * speed
    sense = np.where(np.sign(rates[1:]) == np.sign(rates[:-1]), np.sign(speed), 0.0)
    sense[~np.isfinite(way)] = 0.0
    way[sense == 0.0] = 0.0
    step = np.diff(samples.positions)
    turns = np.round((way - step) / tau)
    turns[turns * sense <= 0.0] = 0.0            # a wrap takes turns off in the sense of motion
    whole = step + tau * turns
    error = np.abs(whole - way)
    is_wrap = ((turns != 0.0) & (step * sense < 0.0) & (error <= QUARTER)
               & (error <= 0.5 * np.maximum(np.abs(way), np.abs(whole)) + delay * np.abs(speed)))
    return turns, is_wrap, way


def _why_not(samples: Samples, i: int, way: float) -> str:
    """Return the message that the step from sample i to i + 1 contradicts its speeds."""
    (start, end), (speed, next_speed) = (values[i:i + 2] for values in samples[1:])
    return (f'sample {i + 1}: from {start:.8g} to {end:.8g} rad in '
            f'{samples.times[i + 1] - samples.times[i]:.8g} s, at {speed:.8g} and '
            f'{next_speed:.8g} rad/s, which is about {way:.3g} rad: count turns in the positions, '
            'or send points closer together')
