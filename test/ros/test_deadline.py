# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Deadlines by overrides of the quality of service: kept or missed, offered or not."""
from diagnostic_msgs.msg import DiagnosticArray
from fourbar_msgs.msg import LinkageState, Motion
import pytest
from rclpy.duration import Duration
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.qos import QoSProfile
from support.scenes import PAPER

SECOND = 10**9


def test_a_late_input_is_counted_and_a_publisher_without_the_deadline_is_named(run_node, client):
    node = run_node({**PAPER, 'drive.source': 'motion', 'drive.timeout': 0.0, 'outputs': ['state'],
                     'qos_overrides./fourbar/input.subscription.deadline': SECOND // 5})
    heard = []
    client.node.create_subscription(DiagnosticArray, '/diagnostics', heard.append, 10)
    client.listen(['state'])
    client.publisher()                                   # offers none
    client.until(lambda: 'incompatible' in node.said.lower() or 'DEADLINE' in node.said,
                 'the warning')
    offered = QoSProfile(depth=10, deadline=Duration(nanoseconds=SECOND // 5))
    publisher = client.node.create_publisher(Motion, '/fourbar/input', offered)
    client.handshake(lambda: publisher.publish(Motion(position=0.1)))

    def missed():
        values = {pair.key: pair.value for pair in heard[-1].status[0].values} if heard else {}
        return int(values.get('deadlines missed', 0))
    client.until(lambda: missed() >= 2, 'the count')     # nothing is sent now


@pytest.mark.slow
def test_the_deadline_of_an_output_is_offered(run_node, client):
    run_node({**PAPER, 'drive.rate': 50.0, 'outputs': ['state'],
              'qos_overrides./fourbar/state.publisher.deadline': 2 * SECOND})
    heard, refused = [], []
    events = SubscriptionEventCallbacks(incompatible_qos=refused.append)
    for seconds in (2, 1):
        client.node.create_subscription(LinkageState, '/fourbar/state', heard.append, QoSProfile(
            depth=10, deadline=Duration(seconds=seconds)), event_callbacks=events)
    client.until(lambda: heard and refused, 'messages for one, a refusal for the other')
