# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Quality of service that a user overrides at start: qos_overrides.TOPIC.publisher.depth etc."""
from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from fourbar_ros.errors import InvalidParameter
from fourbar_ros.ros.messages import resolve
from fourbar_ros.scene.scene import Scene
from fourbar_ros.scene.topics import (
    ANSWERS,
    applied_topic,
    DRIVEN,
    INPUT_DEPTH,
    INPUTS,
    OUTPUTS,
    PICTURES,
    QUEUE_DEPTH,
    SCENE,
    Topic,
    topics_of,
    TRAJECTORIES,
    wrench_topic,
)
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import (
    DurabilityPolicy,
    HistoryPolicy,
    LivelinessPolicy,
    QoSPolicyKind,
    QoSProfile,
    ReliabilityPolicy,
)
from rclpy.qos_overriding_options import QoSOverridingOptions
from rclpy.subscription import Subscription

PREFIX = 'qos_overrides.'
_WORDS = {'reliability': ReliabilityPolicy, 'durability': DurabilityPolicy,
          'history': HistoryPolicy, 'liveliness': LivelinessPolicy}
_NUMBERS = {'depth': 'messages', 'deadline': 'ns', 'lifespan': 'ns',
            'liveliness_lease_duration': 'ns'}
POLICIES = (*_WORDS, *_NUMBERS)


def publisher(node: Node, topic: Topic, **options: Any) -> Publisher:
    """Return a publisher on a topic with its QoS, latched or not, and the user's overrides."""
    profile = (QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL) if topic.latched
               else QoSProfile(depth=QUEUE_DEPTH))
    return node.create_publisher(resolve(topic.type), topic.topic, profile, **options,
                                 qos_overriding_options=_overrides(node, 'publisher', topic))


def subscription(node: Node, topic: Topic, take: Callable[..., None], is_reliable: bool = False,
                 **options: Any) -> Subscription:
    """
    Return a subscription on a topic with the user's overrides; ``take`` gets serialised messages.

    By default it is best effort, which matches publishers of any reliability.
    """
    reliability = ReliabilityPolicy.RELIABLE if is_reliable else ReliabilityPolicy.BEST_EFFORT
    return node.create_subscription(
        resolve(topic.type), topic.topic, take,
        QoSProfile(depth=INPUT_DEPTH, reliability=reliability), raw=True, **options,
        qos_overriding_options=_overrides(node, 'subscription', topic))


def _overrides(node: Node, entity: str, topic: Topic) -> QoSOverridingOptions:
    """Return the policies that rclpy is to read from parameters: those that are given."""
    return QoSOverridingOptions([QoSPolicyKind[policy.upper()] for policy in POLICIES
                                 if has_override(node, entity, topic, policy)])


def has_override(node: Node, entity: str, topic: Topic, policy: str) -> bool:
    """Return whether a user overrides a policy of a 'publisher' or 'subscription'."""
    name = node.resolve_topic_name(topic.topic)
    return bool(node.has_parameter(f'{PREFIX}{name}.{entity}.{policy}'))


def check(node: Node, scene: Scene) -> None:
    """Raise InvalidParameter for an override of an unknown topic or with a bad value."""
    topics = _topics(node, scene)
    for name, parameter in node.get_parameters_by_prefix('').items():
        if name.startswith(PREFIX):
            fault = _fault_of(name[len(PREFIX):].rsplit('.', 2), parameter.value, topics)
            if fault:
                raise InvalidParameter(name, parameter.value, fault)


def _fault_of(parts: Sequence[str], value: Any, topics: Mapping[str, str]) -> str:
    """
    Return what is wrong with an override, '' if nothing.

    ``parts``: topic, entity, policy of its name; ``topics``: {topic: its entity}.
    """
    if len(parts) != 3 or parts[0] not in topics:
        return f'no such topic of this node; known: {", ".join(topics)}'
    topic, entity, policy = parts
    if entity != topics[topic]:
        return f'{topic} is a {topics[topic]}'
    if policy in _WORDS:
        words = [word.lower() for word in _WORDS[policy].__members__ if word.isupper()
                 and word != 'UNKNOWN']
        return '' if value in words else f'must be one of {", ".join(words)}'
    if policy in _NUMBERS:
        is_good = type(value) is int and value >= 0
        return '' if is_good else f'must be a number of {_NUMBERS[policy]}, not negative'
    return f'must be one of {", ".join(POLICIES)}'


def _topics(node: Node, scene: Scene) -> dict[str, str]:
    """
    Return {full topic name: 'publisher' or 'subscription'} of all that the node may ever use.

    That is more than the scene uses now: outputs, say, can be added while the node runs.
    """
    links = scene.linkage.EXTERNAL._fields               # on which a wrench can act
    outputs = topics_of(OUTPUTS, scene.members).values()
    received = [TRAJECTORIES[name] for name in ANSWERS]
    sent = [topic for topic in TRAJECTORIES.values() if topic not in received]
    published = (DRIVEN, SCENE, *map(applied_topic, links), *outputs, *PICTURES.values(), *sent)
    subscribed = *INPUTS.values(), *map(wrench_topic, links), *received
    return {node.resolve_topic_name(topic.topic): entity
            for entity, topics in (('publisher', published), ('subscription', subscribed))
            for topic in topics}
