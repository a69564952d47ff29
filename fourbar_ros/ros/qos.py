"""Quality of service that a user overrides: qos_overrides.TOPIC.publisher.reliability and so on, at start."""
from __future__ import annotations

from rclpy.event_handler import UnsupportedEventTypeError
from rclpy.qos import QoSPolicyKind
from rclpy.qos_overriding_options import InvalidQosOverridesError, QoSOverridingOptions

from .. import interfaces
from ..core import InvalidParameter

PREFIX = 'qos_overrides.'
POLICIES = {kind.name.lower(): kind for kind in (
    QoSPolicyKind.RELIABILITY, QoSPolicyKind.DURABILITY, QoSPolicyKind.HISTORY, QoSPolicyKind.DEPTH,
    QoSPolicyKind.DEADLINE, QoSPolicyKind.LIFESPAN, QoSPolicyKind.LIVELINESS,
    QoSPolicyKind.LIVELINESS_LEASE_DURATION)}
ENTITIES = ('publisher', 'subscription')


def create(node, entity, message_type, topic, *given, **options):
    """
    Return a new publisher or subscription of a node with the overrides it was given; other arguments as of rclpy.

    Event callbacks are left out where the middleware does not have the event.

    Raises
    ------
    InvalidParameter
        A policy does not have the value given.

    """
    name = f'{PREFIX}{node.resolve_topic_name(topic)}.{entity}.'
    kinds = [kind for policy, kind in POLICIES.items() if node.has_parameter(name + policy)]
    make = getattr(node, f'create_{entity}')
    try:
        return make(message_type, topic, *given, **options, qos_overriding_options=QoSOverridingOptions(kinds))
    except (AssertionError, AttributeError, TypeError, RuntimeError, InvalidQosOverridesError) as error:
        if not kinds:
            raise
        values = {policy: node.get_parameter(name + policy).value for policy in POLICIES
                  if node.has_parameter(name + policy)}
        raise InvalidParameter(name[:-1], values, f'not accepted: {error}') from None


def check(node, scene):
    """Raise InvalidParameter for an override that nothing of the node will ever ask for."""
    topics = _topics(node, scene)
    for name, parameter in node.get_parameters_by_prefix('').items():
        if not name.startswith(PREFIX):
            continue
        *topic, entity, policy = name[len(PREFIX):].rsplit('.', 2)
        if topic[:1] not in ([t] for t in topics):
            raise InvalidParameter(name, parameter.value, f'no such topic of this node; known: {", ".join(topics)}')
        if entity != topics[topic[0]]:
            raise InvalidParameter(name, parameter.value, f'{topic[0]} is a {topics[topic[0]]}')
        if policy not in POLICIES:
            raise InvalidParameter(name, parameter.value, f'must be one of {", ".join(POLICIES)}')


def _topics(node, scene):
    """Return {resolved topic: publisher or subscription} of all that a scene may ever use."""
    outputs = interfaces.topics_of(interfaces.OUTPUTS, scene.points).values()
    return {node.resolve_topic_name(topic.topic): entity
            for entity, topics in (('publisher', (interfaces.DRIVEN, interfaces.SCENE, *outputs)),
                                   ('subscription', interfaces.INPUTS.values()))
            for topic in topics}
