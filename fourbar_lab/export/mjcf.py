# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
MJCF of a scene, for MuJoCo: the tree, and the cut joints as ``connect`` constraints.

MuJoCo keeps a constraint with a spring and a damper, so its loops give way. The settings here are
much stiffer than its own (a time constant of two steps instead of 20 ms). The key ``start`` has a
pose in which the loops are closed. The mechanism lies in x-y of its base, which ``frame.parent``
may carry; gravity is the scene's, turned with it.
"""
from collections.abc import Sequence
from typing import Any

from fourbar_ros.description.model import inertia_of, NoDescription, RobotModel
from fourbar_ros.description.shapes import Shape
from fourbar_ros.description.xml import add, as_text, colour, comment, digits_of, Element
from fourbar_ros.scene.base import rotation_of

WORLD = 'world'        # MuJoCo's name of what carries all bodies
TIMESTEP = 0.0005      # [s]
SOLREF = (2.0 * TIMESTEP, 1.0)                 # time constant [s], damping ratio
SOLIMP = (0.9999, 0.9999, 0.001, 0.5, 2.0)     # as hard as it gets


def mjcf(model: RobotModel) -> str:
    """Return the MJCF of a model; raise NoDescription if a loop is cut at a slide or drive."""
    for closure in model.closures:
        if closure.connection.axis is not None:
            raise NoDescription(f'the loop of joint {closure.name} is cut at a slide, for which '
                                'MuJoCo has no constraint')
        if closure.is_driven:       # B of a four-bar
            raise NoDescription(f'the loop is cut at joint {closure.name}, which is driven, and '
                                'MuJoCo has no motor there')
    root = Element('mujoco', model=model.root)
    comment(root, model.title)
    # roll, pitch, yaw about fixed axes, as in URDF
    add(root, 'compiler', angle='radian', autolimits='true', eulerseq='XYZ')
    axes = rotation_of(model.frame.rpy)
    add(root, 'option', gravity=tuple([sum(g * axis[i] for g, axis in zip(model.gravity, axes))
                                       for i in range(3)]), timestep=TIMESTEP)
    base, parent = add(root, 'worldbody'), model.frame.parent
    if parent and parent != WORLD:
        base = add(base, 'body', name=parent)
    base = add(base, 'body', name=model.root)
    if parent:
        base.set('pos', digits_of(*model.frame.xyz))
        base.set('euler', digits_of(*model.frame.rpy))
    for geom in _geoms(base, model.ground, -1):
        geom.set('mass', '0')           # the ground has no mass, on a moving body either
    bodies = {model.root: base}
    for index, link in enumerate(model.links):
        hung, (x, y, angle) = link.joint, link.joint.at_zero
        body = bodies[hung.child] = add(bodies[hung.parent], 'body', name=hung.child,
                                        pos=(x, y, 0.0), euler=(0.0, 0.0, angle))
        joint = add(body, 'joint', name=hung.name, type='slide' if hung.slides else 'hinge',
                    axis=hung.axis)
        if any(hung.connection.on_child):
            joint.set('pos', digits_of(*hung.connection.on_child, 0.0))
        if hung.limits and hung.is_driven:      # the loops limit the others
            joint.set('range', ' '.join(map(repr, hung.limits)))
        if link.body:
            mass, centre, moments = inertia_of(link.body, model.size)
            add(body, 'inertial', pos=centre, mass=mass, diaginertia=moments)
        _geoms(body, link.shapes, index)
    for name, (frame, x, y) in model.points.items():
        add(bodies[frame], 'site', name=name, pos=(x, y, 0.0), size=0.005 * model.size)
    # each cut joint: two sites that coincide where the loop is closed
    equality = add(root, 'equality')
    for closure in model.closures:
        first, second = closure.closing_frames
        for name, frame, (x, y) in ((first, closure.parent, closure.connection.on_parent),
                                    (second, closure.child, closure.connection.on_child)):
            add(bodies[frame], 'site', name=name, pos=(x, y, 0.0), size=0.005 * model.size)
        add(equality, 'connect', name=closure.name, site1=first, site2=second, solref=SOLREF,
            solimp=SOLIMP)
    driven = next(joint for joint in model.joints if joint.is_driven)
    add(add(root, 'actuator'), 'motor', name=f'{driven.name}_drive', joint=driven.name)
    add(add(root, 'keyframe'), 'key', name='start',
        qpos=tuple(_starts(model, model.root)))
    return as_text(root)


def _geoms(body: Element, shapes: Sequence[Shape], index: int) -> list[Element]:
    """Add shapes without contacts; return their elements."""
    # In a scene without masses they give a link its mass, by MuJoCo's density of a geom.
    geoms = []
    for shape in shapes:
        sizes: Any = shape.sizes
        size = sizes['size'] if shape.form == 'box' else (2.0 * sizes['radius'], sizes['length'])
        geoms.append(add(body, 'geom', type=shape.form,
                         size=tuple([0.5 * length for length in size]), pos=shape.pose[:3],
                         euler=shape.pose[3:], rgba=colour(index), contype='0',
                         conaffinity='0'))
    return geoms


def _starts(model: RobotModel, frame: str) -> list[float]:
    """Return the joints' positions in MuJoCo's order: of a body on the frame, of its children."""
    return [start for joint in model.joints if joint.parent == frame
            for start in (joint.start, *_starts(model, joint.child))]
