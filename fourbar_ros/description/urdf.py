# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
URDF of a scene, for robot_state_publisher, RViz, MoveIt, Foxglove.

URDF cannot close a loop (a mimic joint follows one line), so the tree is cut at one joint of each
loop. Two frames there, ``closing_NAME_1`` and ``closing_NAME_2``, coincide if the joint states
belong together, as the node's do. Joints have the names in ``joint_states``.

Elements that programs ignore if they do not know them say the rest: ``constraint`` a cut joint, as
proposed for urdfdom, ``transmission`` the drive, and ``group_state``, as in SRDF, the pose at the
start of the scene, in which the loops are closed. Zeros of joints are those of ``joint_states``,
where the loops are mostly open. ``fourbar import`` reads all three.
"""
from collections.abc import Sequence

from fourbar_ros.description.model import inertia_of, RobotModel
from fourbar_ros.description.shapes import Shape
from fourbar_ros.description.xml import add, as_text, colour, comment, Element

UNLIMITED = 1e9        # URDF wants an effort and a rate that a limited joint does not exceed


def urdf(model: RobotModel) -> str:
    robot = Element('robot', name=model.root)
    comment(robot, model.title)
    if model.frame.parent:
        add(robot, 'link', name=model.frame.parent)
    root = add(robot, 'link', name=model.root)
    _visuals(root, model.ground, -1)
    if model.frame.parent:
        _fix(robot, model.root, model.frame.parent, tuple(model.frame.xyz), tuple(model.frame.rpy))
    for index, link in enumerate(model.links):
        joint, frame = link.joint, link.joint.child
        element = add(robot, 'link', name=frame)
        if link.body:
            mass, centre, (about_x, about_y, about_z) = inertia_of(link.body, model.size)
            inertial = add(element, 'inertial')
            add(inertial, 'origin', xyz=centre)
            add(inertial, 'mass', value=mass)
            add(inertial, 'inertia', ixx=about_x, iyy=about_y, izz=about_z, ixy=0.0, ixz=0.0,
                iyz=0.0)
        _visuals(element, link.shapes, index)
        (x, y, angle), child = joint.at_zero, frame
        on_child = joint.connection.on_child
        if not joint.slides and any(on_child):      # URDF has a link's frame in its joint
            (x, y), child = joint.connection.on_parent, f'{frame}_hinge'
            add(robot, 'link', name=child)
            _fix(robot, frame, child, (-on_child[0], -on_child[1], 0.0))
        kind = 'prismatic' if joint.slides else 'revolute' if joint.limits else 'continuous'
        element = add(robot, 'joint', name=joint.name, type=kind)
        add(element, 'parent', link=joint.parent)
        add(element, 'child', link=child)
        add(element, 'origin', xyz=(x, y, 0.0), rpy=(0.0, 0.0, angle))
        add(element, 'axis', xyz=joint.axis)
        if joint.limits:
            low, high = joint.limits
            add(element, 'limit', lower=low, upper=high, effort=UNLIMITED, velocity=UNLIMITED)
    for closure in model.closures:
        connection = closure.connection
        comment(robot, f'joint {closure.name} closes the loop here, which URDF cannot say: these '
                       'two frames coincide' + (' along its axis' if connection.axis else ''))
        ends = [*zip(closure.closing_frames, ('parent', 'child'), (closure.parent, closure.child),
                     (connection.on_parent, connection.on_child))]
        for frame, _, carrier, point in ends:
            add(robot, 'link', name=frame)
            _fix(robot, frame, carrier, (*point, 0.0))
        if connection.axis is None:
            constraint = add(robot, 'constraint', name=closure.name, type='revolute')
            for _, side, carrier, point in ends:
                add(constraint, side, link=carrier)
                add(constraint, f'{side}_origin', xyz=(*point, 0.0))
                add(constraint, f'{side}_axis', xyz=(0.0, 0.0, 1.0))
    for name, (frame, x, y) in model.points.items():
        add(robot, 'link', name=name)
        _fix(robot, name, frame, (x, y, 0.0))
    driven = next((joint.name for joint in model.joints if joint.is_driven), '')
    if driven:                  # at B of a four-bar it is cut
        transmission = add(robot, 'transmission', name=f'{driven}_drive')
        add(transmission, 'type', 'transmission_interface/SimpleTransmission')
        add(transmission, 'joint', name=driven)
        add(transmission, 'actuator', name=f'{driven}_drive')
    start = add(robot, 'group_state', name='start', group='all')
    for joint in model.joints:
        add(start, 'joint', name=joint.name, value=joint.start)
    return as_text(robot)


def _fix(robot: Element, name: str, frame: str, origin: tuple[float, ...],
         rpy: tuple[float, ...] = (0.0, 0.0, 0.0)) -> None:
    """Add the fixed joint of a link in a frame, at ``origin`` [m], turned by ``rpy`` [rad]."""
    joint = add(robot, 'joint', name=f'{name}_fixed', type='fixed')
    add(joint, 'parent', link=frame)
    add(joint, 'child', link=name)
    add(joint, 'origin', xyz=origin, **({'rpy': rpy} if any(rpy) else {}))


def _visuals(link: Element, shapes: Sequence[Shape], index: int) -> None:
    for shape in shapes:
        visual = add(link, 'visual')
        add(visual, 'origin', xyz=shape.pose[:3], rpy=shape.pose[3:])
        add(add(visual, 'geometry'), shape.form, **shape.sizes)
        add(add(visual, 'material', name=f'{link.get("name")}_colour'), 'color',
            rgba=colour(index))
