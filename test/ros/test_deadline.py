# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Deadlines by overrides of the quality of service: kept or missed, offered or not."""
from fourbar_msgs.msg import Motion
from rclpy.duration import Duration
from rclpy.qos import QoSProfile
from support.scenes import PAPER

SECOND = 10**9


def test_a_late_input_is_counted_and_a_publisher_without_the_deadline_is_named(
        run_node, client, diagnosed):
    node = run_node({**PAPER, 'drive.source': 'motion', 'drive.timeout': 0.0, 'outputs': ['state'],
                     'qos_overrides./fourbar/input.subscription.deadline': SECOND // 5})
    client.listen(['state'])
    client.publisher()                                   # offers none
    client.until(lambda: 'incompatible' in node.said.lower() or 'DEADLINE' in node.said,
                 'the warning')
    offered = QoSProfile(depth=10, deadline=Duration(nanoseconds=SECOND // 5))
    publisher = client.node.create_publisher(Motion, '/fourbar/input', offered)
    client.handshake(lambda: publisher.publish(Motion(position=0.1)))
    # nothing is sent now
    client.until(lambda: int(diagnosed()[1].get('deadlines missed', 0)) >= 2, 'the count')
