# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Which curves belong into one plot, from the outputs that a scene names.

A curve is a field of a topic that the node of the scene publishes; nothing else is known here.
"""
from __future__ import annotations

from typing import Any, NamedTuple

from fourbar_ros.scene.scene import Scene

NODE = '/fourbar'


class Curve(NamedTuple):
    """A field of a message: full name of the topic, the field with dots, what a legend says."""

    topic: str
    field: str
    label: str


class Plot(NamedTuple):
    """Curves with one axis: its title with the unit."""

    title: str
    curves: tuple[Curve, ...]


def full_name(topic: str, node: str = NODE) -> str:
    """Return the full name of a topic of a node."""
    if topic.startswith('~'):
        return node + topic[1:]
    return topic if topic.startswith('/') else f'{node.rpartition("/")[0]}/{topic}'


def plots_of(scene: Scene, node: str = NODE) -> list[Plot]:
    """Return the plots of a scene whose node has this full name."""
    found = [*_states(scene), *_links(scene), *_loads(scene), *_reactions(scene),
             *_points(scene), *_output(scene)]
    return [Plot(title, tuple(Curve(full_name(topic, node), field, _label(topic, field))
                              for topic, field in curves))
            for title, curves in found if curves]


def _label(topic: str, field: str) -> str:
    """Return the field; before it the member of a family of topics that has it."""
    _, is_member, name = topic.removeprefix('~/').partition('/')
    return f'{name} {field.removeprefix("wrench.")}' if is_member else field


def _states(scene: Scene) -> list[Any]:
    """Return positions, rates and accelerations of joints, angles and slides apart."""
    if 'state' not in scene.topics:
        return []
    topic, known = scene.topics['state'].topic, scene.layout.fields['state']
    coordinates = [*dict.fromkeys(joint.coordinate for joint in scene.linkage.JOINTS)]
    found = []
    for unit in ('rad', 'm'):
        for place, what in enumerate(('position', 'rate', 'acceleration')):
            names = [coordinate[place] for coordinate in coordinates if coordinate.unit == unit]
            suffix = ('', '/s', '/s^2')[place]
            found.append((f'{what} [{unit}{suffix}]',
                          [(topic, name) for name in names if name in known]))
    return [*found, ('transmission angle [rad]', [(topic, 'transmission_angle')])]


def _loads(scene: Scene) -> list[Any]:
    if 'loads' not in scene.topics:
        return []
    topic, known = scene.topics['loads'].topic, scene.layout.fields['loads']
    forces = [name for name in known if name in (*scene.linkage.reactions, 'shaking_force')]
    drive = 'driving_force' if scene.linkage.is_driven_by_slide else 'driving_torque'
    others = [(f'{drive.replace("_", " ")} [{"N" if drive.endswith("force") else "N m"}]', drive),
              ('shaking moment [N m]', 'shaking_moment')]
    return [('forces [N]', [(topic, name) for name in forces]),
            *((title, [(topic, name)] if name in known else []) for title, name in others)]


def _links(scene: Scene) -> list[Any]:
    return [(f'{what.replace("_", " ")} of links [{unit}]', _members(scene, 'links', what))
            for what, unit in (('angular_velocity', 'rad/s'), ('angular_acceleration', 'rad/s^2'))]


def _reactions(scene: Scene) -> list[Any]:
    return [(f'reactions, {axis} [N]', _members(scene, 'reactions', f'wrench.force.{axis}'))
            for axis in 'xy']


def _points(scene: Scene) -> list[Any]:
    return [('speed of points [m/s]', _members(scene, 'points', 'speed'))]


def _members(scene: Scene, family: str, field: str) -> list[Any]:
    """Return a field of all topics of a family of outputs."""
    return [(topic.topic, field) for name, topic in scene.topics.items()
            if name.startswith(f'{family}/')]


def _output(scene: Scene) -> list[Any]:
    """Return the output's motion where the scene sends it without the state."""
    if 'output' not in scene.topics or 'state' in scene.topics:
        return []
    topic = scene.topics['output'].topic
    return [(f'output: {field}', [(topic, field)])
            for field in ('position', 'velocity', 'acceleration')]
