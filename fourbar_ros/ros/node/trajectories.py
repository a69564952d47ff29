# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Trajectories of the output joint as those of the driven joint, and back, in whole messages."""
from __future__ import annotations

from functools import partial

from fourbar_ros.description.model import start_of
from fourbar_ros.errors import FourBarError, InvalidParameter
from fourbar_ros.pipeline.joints import Scale
from fourbar_ros.ros.messages import resolve
from fourbar_ros.ros.node import qos
from fourbar_ros.ros.node.base import Base
from fourbar_ros.scene.scene import Scene
from fourbar_ros.scene.topics import QUEUE_DEPTH, TRAJECTORIES
from fourbar_ros.transmission.transmission import Trajectory, trajectory, Transmission
import numpy as np
from std_msgs.msg import String
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

# What comes: what answers it, and by which method of the Transmission.
ANSWERS = {'output_trajectory': ('drive_trajectory', 'to_input'),
           'input_trajectory': ('followed_trajectory', 'to_output')}


class Trajectories:
    """
    Answers trajectories with the scene in force.

    Parameters
    ----------
    node : rclpy.node.Node
    scene : Scene

    """

    def __init__(self, node: Base, scene: Scene) -> None:
        self._node = node
        self.apply(scene)
        self._publishers = {
            name: qos.create(node, 'publisher', resolve(topic.type), topic.topic, QUEUE_DEPTH)
            for name, topic in TRAJECTORIES.items() if name not in ANSWERS}
        for name in ANSWERS:
            topic = TRAJECTORIES[name]
            qos.create(node, 'subscription', resolve(topic.type), topic.topic,
                       partial(self._take, name), QUEUE_DEPTH)

    def apply(self, scene: Scene) -> None:
        """Take over a scene."""
        mechanism = scene.linkage
        self._transmission = Transmission(mechanism, start_of(scene))
        coordinates = [joint.coordinate for joint in mechanism.JOINTS]
        self._joints = {}
        for side, its in (('input', mechanism.input_coordinate),
                          ('output', mechanism.outputs[0].coordinate)):
            place = coordinates.index(its)
            self._joints[side] = (scene.joint_names[place],
                                  Scale(scene.joint_states.ratios[place],
                                        scene.joint_states.offsets[place]))

    def _take(self, name: str, message: JointTrajectory) -> None:
        answer, method = ANSWERS[name]
        sides = ('output', 'input') if method == 'to_input' else ('input', 'output')
        try:
            given = _read(message, *self._joints[sides[0]])
            found = getattr(self._transmission, method)(given)
        except FourBarError as error:
            self._node.log.warning('trajectory', f'{TRAJECTORIES[name].topic}: {error}')
            self._publishers['trajectory_refused'].publish(String(data=str(error)))
            return
        self._publishers[answer].publish(_written(message, found, *self._joints[sides[1]]))


def _read(message: JointTrajectory, joint: str, scale: Scale) -> Trajectory:
    """Return the Trajectory of a joint in a JointTrajectory, in coordinates of the mechanism."""
    if joint not in message.joint_names:
        raise InvalidParameter('joint_names', list(message.joint_names), f'must hold {joint}')
    if not message.points:
        raise InvalidParameter('points', [], 'must not be empty')
    place = message.joint_names.index(joint)
    columns = []
    for name, is_needed in (('positions', True), ('velocities', True), ('accelerations', True),
                            ('effort', False)):
        column = [getattr(point, name) for point in message.points]
        missing = next((i for i, values in enumerate(column) if len(values) <= place), None)
        if missing is not None and (is_needed or any(map(len, column))):
            raise InvalidParameter(name, list(column[missing]),
                                   f'must be given for {joint} in point {missing}')
        columns.append(np.zeros(len(column)) if missing is not None
                       else np.array([values[place] for values in column]))
    motion = scale.to_input(*columns[:3])
    return trajectory(*motion, columns[3] * scale.ratio)


def _written(message: JointTrajectory, found: Trajectory, joint: str, scale: Scale
             ) -> JointTrajectory:
    """Return a Trajectory as JointTrajectory, with the times of the message it answers."""
    answer = JointTrajectory(header=message.header, joint_names=[joint])
    rows = zip(scale.ratio * found.position + scale.offset, scale.ratio * found.rate,
               scale.ratio * found.acceleration, found.effort / scale.ratio, message.points)
    answer.points = [JointTrajectoryPoint(
        positions=[position], velocities=[velocity], accelerations=[acceleration],
        effort=[effort], time_from_start=point.time_from_start)
        for position, velocity, acceleration, effort, point in rows]
    return answer
