# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Quality of service that a user overrides at start.

Qos_overrides.TOPIC.publisher.reliability and so on.
"""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from fourbar_ros.errors import InvalidParameter
from fourbar_ros.scene.scene import Scene
from fourbar_ros.scene.topics import (
    ANSWERS,
    applied_topic,
    DRIVEN,
    INPUTS,
    OUTPUTS,
    PICTURES,
    SCENE,
    topics_of,
    TRAJECTORIES,
    wrench_topic,
)
from rclpy.node import Node
from rclpy.qos import (
    DurabilityPolicy,
    HistoryPolicy,
    LivelinessPolicy,
    QoSPolicyKind,
    ReliabilityPolicy,
)
from rclpy.qos_overriding_options import QoSOverridingOptions

PREFIX = 'qos_overrides.'
_WORDS = {'reliability': ReliabilityPolicy, 'durability': DurabilityPolicy,
          'history': HistoryPolicy,
          'liveliness': LivelinessPolicy}
_NUMBERS = {'depth': 'messages', 'deadline': 'ns', 'lifespan': 'ns',
            'liveliness_lease_duration': 'ns'}
POLICIES = (*_WORDS, *_NUMBERS)


def create(node: Node, entity: str, message_type: type[Any], topic: str, *given: Any,
           **options: Any) -> Any:
    """
    Return a new 'publisher' or 'subscription' of a node with the overrides it was given.

    Arguments as of rclpy.
    """
    name = f'{PREFIX}{node.resolve_topic_name(topic)}.{entity}.'
    kinds = [QoSPolicyKind[policy.upper()] for policy in POLICIES
             if node.has_parameter(name + policy)]
    make = getattr(node, f'create_{entity}')
    return make(message_type, topic, *given, **options,
                qos_overriding_options=QoSOverridingOptions(kinds))


def has_override(node: Node, entity: str, topic: str, policy: str) -> bool:
    """Return whether a policy of a topic is overridden."""
    return bool(node.has_parameter(f'{PREFIX}{node.resolve_topic_name(topic)}.{entity}.{policy}'))


def check(node: Node, scene: Scene) -> None:
    """Raise InvalidParameter for an override of an unknown topic or with a bad value."""
    topics = _topics(node, scene)
    for name, parameter in node.get_parameters_by_prefix('').items():
        if name.startswith(PREFIX):
            why = _why_not(name[len(PREFIX):].rsplit('.', 2), parameter.value, topics)
            if why:
                raise InvalidParameter(name, parameter.value, why)


def _why_not(parts: Sequence[str], value: Any, topics: Mapping[str, str]) -> str:
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
        return ('' if type(value) is int and value >= 0 else 'must be a number of '
                                                             f'{_NUMBERS[policy]}, not negative')
    return f'must be one of {", ".join(POLICIES)}'


def _topics(node: Node, scene: Scene) -> dict[str, str]:
    """Return {resolved topic: publisher or subscription} of all that a scene may ever use."""
    loaded = scene.linkage.EXTERNAL._fields
    outputs = topics_of(OUTPUTS, scene.members).values()
    received = [TRAJECTORIES[name] for name in ANSWERS]
    sent = [topic for topic in TRAJECTORIES.values() if topic not in received]
    published = (DRIVEN, SCENE, *map(applied_topic, loaded), *outputs, *PICTURES.values(), *sent)
    taken = *INPUTS.values(), *map(wrench_topic, loaded), *received
    return {node.resolve_topic_name(topic.topic): entity
            for entity, topics in (('publisher', published), ('subscription', taken))
            for topic in topics}
