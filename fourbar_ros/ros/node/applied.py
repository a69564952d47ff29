# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""What acts on a link from outside, as a latched topic says it."""
from __future__ import annotations

from builtin_interfaces.msg import Time
from fourbar_ros.pipeline.wrenches import Wrench
from fourbar_ros.ros.node import qos
from fourbar_ros.ros.node.recording import Recording
from fourbar_ros.scene.topics import applied_topic
from geometry_msgs.msg import WrenchStamped
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.serialization import serialize_message


class Applied:
    """The latched topic that says what acts on a link."""

    def __init__(self, node: Node, link: str) -> None:
        topic = applied_topic(link)
        self.name, self.data = topic.name, b''
        latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self._publisher = qos.create(node, 'publisher', WrenchStamped, topic.topic, latched)

    def send(self, stamp: Time, wrench: Wrench, frame_id: str, recording: Recording) -> None:
        """Publish and record a Wrench."""
        message = WrenchStamped()
        message.header.stamp, message.header.frame_id = stamp, frame_id
        message.wrench.force.x, message.wrench.force.y, message.wrench.torque.z = wrench
        self.data = serialize_message(message)
        self._publisher.publish(self.data)
        recording.write(self.name, self.data)
