# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The SROS2 policy of a scene's node: what it may publish, subscribe, serve, and no more.

Made of the tables of topics and services, so it cannot fall behind them. No ROS is imported.
"""
from __future__ import annotations

from typing import Any
from xml.etree import ElementTree

from fourbar_ros.scene.scene import Scene
from fourbar_ros.scene.topics import (
    DRIVE_STATE,
    DRIVEN,
    FIND_EXTREMA,
    INPUTS,
    RECEIVED_TRAJECTORIES,
    SCENE,
    SERVICES,
    TRAJECTORIES,
)

# What every rclpy node has: its log, its parameters' changes, its type descriptions.
OF_ALL = ('/rosout', '/parameter_events')
PARAMETER_SERVICES = ('describe_parameters', 'get_parameter_types', 'get_parameters',
                      'list_parameters', 'set_parameters', 'set_parameters_atomically',
                      'get_type_description')
DIAGNOSTICS = '/diagnostics'


def policy(scene: Scene, node: str = '/fourbar', use_sim_time: bool = False) -> str:
    """Return the policy, XML, of a node by its full name."""
    namespace, _, name = node.rpartition('/')
    root = ElementTree.Element('policy', version='0.2.0')
    enclave = ElementTree.SubElement(ElementTree.SubElement(root, 'enclaves'), 'enclave',
                                     path=node)
    profile = ElementTree.SubElement(ElementTree.SubElement(enclave, 'profiles'), 'profile',
                                     ns=namespace or '/', node=name)
    for verb, names in _allowed(scene).items():
        kind = {'publish': 'topic', 'subscribe': 'topic', 'reply': 'service',
                'execute': 'action'}[verb]
        if verb == 'subscribe' and use_sim_time:
            names = [*names, '/clock']
        group = ElementTree.SubElement(profile, f'{kind}s', {verb: 'ALLOW'})
        for each in sorted(set(names)):
            ElementTree.SubElement(group, kind).text = each.replace('~/', f'{name}/')
    ElementTree.indent(root)
    return '<?xml version="1.0"?>\n' + ElementTree.tostring(root, encoding='unicode') + '\n'


def _allowed(scene: Scene) -> dict[str, list[str]]:
    """Return {what the node does: names of topics, services or actions}."""
    given: list[Any] = [*scene.wrench_topics, *scene.drive_topics]
    published = [topic for topic in given if topic.latched or topic == DRIVE_STATE]
    received = [topic for topic in given if topic not in published]
    if scene.drive.source in INPUTS:
        received.append(INPUTS[scene.drive.source])
    if scene.values['trajectories']:
        received += [TRAJECTORIES[name] for name in RECEIVED_TRAJECTORIES]
        published += [topic for name, topic in TRAJECTORIES.items()
                      if name not in RECEIVED_TRAJECTORIES]
    published += [DRIVEN, SCENE, *scene.topics.values(), *scene.pictures.values()]
    return {'publish': [*OF_ALL, DIAGNOSTICS, *(topic.topic for topic in published)],
            'subscribe': [topic.topic for topic in received],
            'reply': [*(f'~/{name}' for name in PARAMETER_SERVICES),
                      *(service.service for service in SERVICES.values())],
            'execute': [FIND_EXTREMA.service]}
