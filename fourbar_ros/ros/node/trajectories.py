# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
JointTrajectory messages of the output joint converted to the driven joint, and back.

Positions are taken as written: from 3.0 to -3.1 rad is a motion backwards.
"""
from contextlib import suppress
from functools import partial

from fourbar_ros.errors import FourBarError, InvalidParameter
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.pipeline.joints import Scale
from fourbar_ros.ros.messages import Message
from fourbar_ros.ros.node import entities
from fourbar_ros.ros.node.stream import Stream
from fourbar_ros.scene.scene import Scene
from fourbar_ros.scene.topics import ANSWERS, INPUT_DEPTH, TRAJECTORIES
from fourbar_ros.transmission import Trajectory, trajectory
import numpy as np
from rclpy.node import Node
from rclpy.serialization import serialize_message
from std_msgs.msg import String
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

SIDES = {'to_input': ('input', 'output'), 'to_output': ('output', 'input')}     # asked for, sent
FIELDS = 'positions', 'velocities', 'accelerations', 'effort'
FIELD_OF = dict(zip(Trajectory._fields, FIELDS))        # of the message


class Conversion:
    """Converts trajectories by the transmission, the joints and the fields of a scene."""

    def __init__(self, scene: Scene) -> None:
        """Look up the two joints: of the driven coordinate and of the mechanism's output."""
        mechanism, shown = scene.linkage, scene.joint_states
        coordinates = [joint.coordinate for joint in mechanism.JOINTS]
        self._joints: dict[str, tuple[str, Scale]] = {}      # name and scale of both
        for side, coordinate in (('input', mechanism.input_coordinate),
                                 ('output', mechanism.outputs[0].coordinate)):
            joint = coordinates.index(coordinate)
            self._joints[side] = (scene.joint_names[joint],
                                  Scale(shown.ratios[joint], shown.offsets[joint]))
        self._transmission = scene.transmission
        self._fields: list[str] = scene.values['trajectory_fields']    # beside positions

    def answer(self, method: str, message: Message) -> Message:
        """Return the trajectory of the other joint by a method of the Transmission."""
        asked, sent = SIDES[method]
        try:
            converted = getattr(self._transmission, method)(self._read(message,
                                                                       *self._joints[sent]))
        except InvalidParameter as error:
            raise InvalidParameter(FIELD_OF.get(error.name, error.name), error.value,
                                   error.allowed) from None
        name, (ratio, offset) = self._joints[asked]
        columns = {'positions': ratio * converted.position + offset,
                   'velocities': ratio * converted.rate}
        if converted.acceleration is not None:
            columns['accelerations'] = ratio * converted.acceleration
        if converted.effort is not None:
            columns['effort'] = converted.effort / ratio
        shown = [field for field in columns if field == 'positions' or field in self._fields]
        rows = [columns[field].tolist() for field in shown]
        points = [JointTrajectoryPoint(time_from_start=point.time_from_start,
                                       **{field: [row[i]] for field, row in zip(shown, rows)})
                  for i, point in enumerate(message.points)]
        return JointTrajectory(header=message.header, joint_names=[name], points=points)

    def _read(self, message: Message, joint: str, scale: Scale) -> Trajectory:
        """Return the trajectory of a joint in a JointTrajectory, in its coordinate's units."""
        if joint not in message.joint_names:
            raise InvalidParameter('joint_names', list(message.joint_names),
                                   f'must hold {joint}')
        if len(set(message.joint_names)) < len(message.joint_names):
            raise InvalidParameter('joint_names', list(message.joint_names),
                                   'must not name a joint twice')
        if not message.points:
            raise InvalidParameter('points', [], 'must not be empty')
        times = [point.time_from_start.sec + 1e-9 * point.time_from_start.nanosec
                 for point in message.points]
        for i, (before, time) in enumerate(zip(times, times[1:]), 1):
            if time < before:
                raise InvalidParameter(f'points[{i}].time_from_start', time,
                                       f'must not decrease: the point before has {before:g} s')
        index = list(message.joint_names).index(joint)
        columns = {name: column for name in FIELDS
                   if (column := _column(message, name, index)) is not None}
        for name in FIELDS[:2]:
            if name not in columns:
                raise InvalidParameter(name, [], f'must be given for {joint} in point 0')
        acceleration, effort = columns.get('accelerations'), columns.get('effort')
        if 'effort' not in self._fields:
            effort = None
            acceleration = acceleration if 'accelerations' in self._fields else None
        elif effort is None:
            effort = np.zeros(len(times))
        position, rate, acceleration, effort = trajectory(
            columns['positions'], columns['velocities'], acceleration, effort)
        ratio, offset = scale
        return Trajectory((position - offset) / ratio, rate / ratio,
                          None if acceleration is None else acceleration / ratio,
                          None if effort is None else effort * ratio)


def _column(message: Message, name: str, joint: int) -> Array | None:
    """Return a field of a joint over the points, shape (n,); None if no point has the field."""
    rows, count = [getattr(point, name) for point in message.points], len(message.joint_names)
    if not any(map(len, rows)):
        return None
    for i, row in enumerate(rows):
        if len(row) != count:
            raise InvalidParameter(f'points[{i}].{name}', list(row),
                                   f'must be {count} numbers, one for each of joint_names')
    return np.array([row[joint] for row in rows])


class Trajectories:
    """Converts trajectories by the scene in force, in a thread of its own."""

    def __init__(self, node: Node, stream: Stream, troubles: entities.Troubles) -> None:
        self._stream, self._troubles = stream, troubles
        troubles.expect('trajectories', 'trajectories_refused', 'trajectories_lost')
        self._worker = entities.Worker('trajectories', node.get_logger().error, INPUT_DEPTH)
        self._publishers = {name: entities.publisher(node, topic)
                            for name, topic in TRAJECTORIES.items() if name not in ANSWERS}
        for name in ANSWERS:
            self._listen(node, name)

    def _listen(self, node: Node, name: str) -> None:
        """Answer trajectories of the topic ``name``, in the thread of the worker."""
        read = entities.reader(TRAJECTORIES[name], partial(self._answer, name),
                               partial(self._refuse, 'trajectories_refused'))

        def take(data: bytes, lost: int) -> None:        # the worker's thread reads and answers
            self._troubles.count('trajectories')
            self._troubles.counts['trajectories_lost'] += lost
            if not self._worker.do(partial(read, data)):
                self._refuse('trajectories_lost', f'{TRAJECTORIES[name].topic}: {INPUT_DEPTH} '
                             'others wait for an answer')
        entities.counted_subscription(node, TRAJECTORIES[name], take, self._troubles,
                                      is_reliable=True)

    def stop(self, patience: float) -> None:
        """Answer no more; wait up to ``patience`` [s] for the answer in work."""
        self._worker.stop(patience)

    def _answer(self, name: str, message: Message) -> None:
        """Publish the converted trajectory, or why there is none."""
        answer_topic, method = ANSWERS[name]
        conversion = self._stream.run.conversion
        assert conversion is not None            # this node's scenes have one
        try:
            answer = serialize_message(conversion.answer(method, message))
        except FourBarError as error:
            self._refuse('trajectories_refused', f'{TRAJECTORIES[name].topic}: {error}')
            return
        with suppress(entities.Abandoned):
            self._worker.check()             # else the node, and its publishers, may be gone
            self._publishers[answer_topic].publish(answer)

    def _refuse(self, cause: str, why: str) -> None:
        self._troubles.count(cause, why)
        self._publishers['trajectory_refused'].publish(serialize_message(String(data=why)))
