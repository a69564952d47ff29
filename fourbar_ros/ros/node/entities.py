# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Publishers, subscriptions, clock and log of a node, as all its parts make them."""
from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from typing import Any

from fourbar_ros.errors import FourBarError
from fourbar_ros.ros.messages import resolve
from fourbar_ros.scene.topics import INPUT_DEPTH, QUEUE_DEPTH, Topic
from rclpy.clock import Clock, ClockType
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import DurabilityPolicy, QoSPolicyKind, QoSProfile, ReliabilityPolicy
from rclpy.qos_overriding_options import QoSOverridingOptions
from rclpy.subscription import Subscription

OVERRIDES = 'qos_overrides.'       # a user's parameters: qos_overrides.TOPIC.publisher.depth
QUIET = 10.0                       # [s] between two lines of one cause in the log

Log = Callable[..., None]          # (cause, text, level='warning')


def publisher(node: Node, topic: Topic, **options: Any) -> Publisher:
    """Return a publisher on a topic with its QoS, latched or not, and the user's overrides."""
    profile = (QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL) if topic.latched
               else QoSProfile(depth=QUEUE_DEPTH))
    with _refused(node, topic):
        return node.create_publisher(resolve(topic.type), topic.topic, profile, **options,
                                     qos_overriding_options=_overrides(node, 'publisher', topic))


def subscription(node: Node, topic: Topic, take: Callable[..., None], is_reliable: bool = False,
                 **options: Any) -> Subscription:
    """
    Return a subscription on a topic with the user's overrides; ``take`` gets serialised messages.

    By default it is best effort, which matches publishers of any reliability.
    """
    reliability = ReliabilityPolicy.RELIABLE if is_reliable else ReliabilityPolicy.BEST_EFFORT
    with _refused(node, topic):
        return node.create_subscription(
            resolve(topic.type), topic.topic, take,
            QoSProfile(depth=INPUT_DEPTH, reliability=reliability), raw=True, **options,
            qos_overriding_options=_overrides(node, 'subscription', topic))


def has_override(node: Node, entity: str, topic: Topic, policy: str) -> bool:
    """Return whether a user overrides a policy of a 'publisher' or 'subscription'."""
    name = node.resolve_topic_name(topic.topic)
    return bool(node.has_parameter(f'{OVERRIDES}{name}.{entity}.{policy}'))


@contextmanager
def _refused(node: Node, topic: Topic) -> Iterator[None]:
    """Name the overrides of a topic in an error that rclpy raises for a bad one."""
    prefix = f'{OVERRIDES}{node.resolve_topic_name(topic.topic)}.'
    try:
        yield
    except (AssertionError, RuntimeError, TypeError, ValueError) as error:
        given = {name: parameter.value for name, parameter
                 in node.get_parameters_by_prefix(prefix.rstrip('.')).items()}
        if not given:
            raise
        raise FourBarError(f'{prefix}*: {given}: {error}') from None


def _overrides(node: Node, entity: str, topic: Topic) -> QoSOverridingOptions:
    """Return the policies that the user gives, so that rclpy declares no others."""
    return QoSOverridingOptions([kind for kind in QoSPolicyKind.__members__.values()
                                 if has_override(node, entity, topic, kind.name.lower())])


def clock_of(node: Node) -> Clock:
    """Return the clock of silences and samples: steady, or the simulation's with use_sim_time."""
    if node.get_parameter('use_sim_time').value:
        return node.get_clock()
    return Clock(clock_type=ClockType.STEADY_TIME)


def log_of(node: Node) -> Log:
    """Return the function (cause, text, level) that logs a line of each cause in ten seconds."""
    child = cache(node.get_logger().get_child)

    def log(cause: str, text: str, level: str = 'warning') -> None:
        getattr(child(cause), level)(text, throttle_duration_sec=QUIET)
    return log
