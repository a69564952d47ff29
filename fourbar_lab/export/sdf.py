# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
SDF of a scene, for Gazebo: all links in a pose in which they close, and all joints.

SDF has loops, so no joint is cut. Its joints are zero in the pose of the file, whatever they are
in ``joint_states``: a comment at each joint gives its position there. Where the scene has gravity,
the model stands so that its own gravity is downwards.
"""
from __future__ import annotations

from collections.abc import Sequence
from math import atan2, pi

from fourbar_ros.description.model import (
    Closure,
    inertia_of,
    ModelJoint,
    ModelLink,
    RobotModel,
)
from fourbar_ros.description.shapes import Shape
from fourbar_ros.description.xml import add, as_text, colour, comment, Element, numbers

VERSION = '1.8'        # Fortress to Ionic read it
WORLD = 'world'


def sdf(model: RobotModel) -> str:
    """Return the SDF of a model: links with their pose in the root, joints, frames of points."""
    root = Element('sdf', version=VERSION)
    element = add(root, 'model', name=model.name)
    comment(element, model.title)
    add(element, 'pose', numbers(0.0, 0.0, 0.0, *_upright(model.gravity)))
    _ground(element, model)
    for place, link in enumerate(model.links):
        _link(element, link, place, model)
    for link in model.links:
        _joint(element, link.joint, link.parent, link.frame, link.joint.limits)
    for closure in model.closures:
        comment(element, f'joint {closure.name} closes a loop')
        _joint(element, closure, closure.parent, closure.child, None)
    for name, (frame, x, y) in model.points.items():
        at = add(element, 'frame', name=name, attached_to=frame)
        add(at, 'pose', numbers(x, y, 0.0, 0.0, 0.0, 0.0), relative_to=frame)
    return as_text(root)


def _upright(gravity: tuple[float, float]) -> tuple[float, float, float]:
    """Return (roll, pitch, yaw) that turn gravity (g_x, g_y) of the scene to Gazebo's -z."""
    g_x, g_y = gravity
    if g_x == g_y == 0.0:
        return 0.0, 0.0, 0.0
    return 0.5 * pi, 0.5 * pi + atan2(g_y, g_x), 0.0


def _ground(element: Element, model: RobotModel) -> None:
    """Add the root, fixed to the world."""
    root = add(element, 'link', name=model.root)
    _visuals(root, model.ground, -1)
    fixed = add(element, 'joint', name=f'{model.root}_fixed', type='fixed')
    add(fixed, 'parent', WORLD)
    add(fixed, 'child', model.root)


def _link(parent: Element, link: ModelLink, place: int, model: RobotModel) -> None:
    """Add a moving link: pose, mass, inertia about its centre of gravity, shapes."""
    x, y, angle = link.pose
    element = add(parent, 'link', name=link.frame)
    add(element, 'pose', numbers(x, y, 0.0, 0.0, 0.0, angle))
    if link.body:
        mass, centre, moments = inertia_of(link.body, model.size)
        inertial = add(element, 'inertial')
        add(inertial, 'pose', numbers(*centre, 0.0, 0.0, 0.0))
        add(inertial, 'mass', numbers(mass))
        inertia = add(inertial, 'inertia')
        for name, value in zip(('ixx', 'iyy', 'izz', 'ixy', 'ixz', 'iyz'),
                               (*moments, 0.0, 0.0, 0.0)):
            add(inertia, name, numbers(value))
    _visuals(element, link.shapes, place)


def _joint(element: Element, its: ModelJoint | Closure, parent: str, child: str,
           limits: tuple[float, float] | None) -> None:
    """
    Add a joint at its place on the child; its axis is given in the frame of the parent.

    SDF has zero where it starts, so ``limits`` count from there.
    """
    connection, ratio, start = its.connection, its.ratio, its.start
    joint = add(element, 'joint', name=its.name,
                type='prismatic' if connection.axis else 'revolute')
    comment(joint, f'position in joint_states: {start:.17g}')
    add(joint, 'pose', numbers(*connection.on_child, 0.0, 0.0, 0.0, 0.0), relative_to=child)
    add(joint, 'parent', parent)
    add(joint, 'child', child)
    axis = add(joint, 'axis')
    along = (ratio * connection.axis[0], ratio * connection.axis[1], 0.0) if connection.axis else (
        0.0, 0.0, ratio)
    add(axis, 'xyz', numbers(*along), expressed_in=parent)
    if limits:
        limit = add(axis, 'limit')
        add(limit, 'lower', numbers(limits[0] - start))
        add(limit, 'upper', numbers(limits[1] - start))


def _visuals(link: Element, shapes: Sequence[Shape], place: int) -> None:
    """Add the shapes of a link, in the colour of its place in the order of links."""
    for number, shape in enumerate(shapes):
        visual = add(link, 'visual', name=f'{link.get("name")}_visual_{number}')
        add(visual, 'pose', numbers(*shape.pose))
        geometry = add(add(visual, 'geometry'), shape.form)
        for name, value in shape.sizes.items():
            add(geometry, name, numbers(*(value if isinstance(value, tuple) else (value,))))
        material = add(visual, 'material')
        for name in ('ambient', 'diffuse'):
            add(material, name, numbers(*colour(place)))
