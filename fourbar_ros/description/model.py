# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
A scene as links, joints and shapes in one plane, with the names that it has in ROS.

URDF, SDF and MJCF are written from it. Frames are those of the node: the root is the scene's
``frame_id`` in O1, each link has its frame at its first joint, x along the link; joints have the
names, senses and zeros of ``joint_states``.
"""
from __future__ import annotations

from collections.abc import Sequence
from math import nan, pi
from typing import Any, NamedTuple

from fourbar_ros.description.shapes import Shape, shapes_of
from fourbar_ros.description.tree import NoDescription, tree_of
from fourbar_ros.errors import FourBarError
from fourbar_ros.mechanics.bodies import Body
from fourbar_ros.mechanisms.parts import Connection, Coordinate, GROUND
from fourbar_ros.scene.scene import Scene
import numpy as np

SAMPLES = 721          # over the range of the input, for the limits of passive slides
MARGIN = 0.01          # by which these limits are wider than what the samples show


class ModelJoint(NamedTuple):
    """
    A joint of the tree.

    Parameters
    ----------
    name : str
        As in ``joint_states``.
    connection : Connection
        The links it joins, by the names of the mechanism.
    coordinate : Coordinate
        The coordinate of the motion.
    ratio, offset : float
        joint = ratio * coordinate + offset.
    limits : tuple of 2 floats, optional
        Limits of the joint [rad or m]; None: it turns without end.
    start : float
        Position of the joint at the start of the scene.
    is_driven : bool
        Whether it is the input.

    """

    name: str
    connection: Connection
    coordinate: Coordinate
    ratio: float
    offset: float
    limits: tuple[float, float] | None
    start: float
    is_driven: bool

    @property
    def slides(self) -> bool:
        """Return whether it is a slide, not a pin."""
        return self.connection.axis is not None

    @property
    def at_zero(self) -> tuple[float, float, float]:
        """Return (x, y, angle) of the child's frame in the parent's at joint position zero."""
        (x, y), q = self.connection.on_parent, -self.ratio * self.offset + 0.0
        if self.connection.axis is None:
            return x, y, self.connection.turn + q
        a_x, a_y = self.connection.axis
        return x + q * a_x, y + q * a_y, self.connection.turn

    @property
    def axis(self) -> tuple[float, float, float]:
        """Return the unit vector of the joint in the frame of the child."""
        if self.connection.axis is None:
            return 0.0, 0.0, self.ratio
        (a_x, a_y), turn = self.connection.axis, self.connection.turn
        cosine, sine = _direction(turn)
        return (self.ratio * (a_x * cosine + a_y * sine),
                self.ratio * (a_y * cosine - a_x * sine), 0.0)


class ModelLink(NamedTuple):
    """
    A moving link: its frame, the joint it hangs on, its body and shapes in its own frame.

    ``pose``: (x, y, angle) in the root at the start; ``parent``: the frame that carries it.
    """

    name: str
    frame: str
    parent: str
    joint: ModelJoint
    body: Body | None
    shapes: Sequence[Shape]
    pose: tuple[float, float, float]


class Closure(NamedTuple):
    """
    A joint at which a loop is cut.

    ``name``: the joint's in ``joint_states``; ``frames``: two frames that coincide where the loop
    is closed, ``first`` on the parent and ``second`` on the child.
    """

    name: str
    connection: Connection
    parent: str
    child: str
    ratio: float
    start: float

    @property
    def frames(self) -> tuple[str, str]:
        """Return the names of the two frames."""
        return f'closing_{self.name}_1', f'closing_{self.name}_2'


class Model(NamedTuple):
    """
    A scene for other programs.

    ``points``: {name of a frame: (frame of its link, x, y)}; ``position``: the input at the start.
    """

    name: str
    title: str
    root: str
    links: tuple[ModelLink, ...]
    closures: tuple[Closure, ...]
    points: dict[str, tuple[str, float, float]]
    ground: Sequence[Shape]
    gravity: tuple[float, float]
    size: float
    position: float

    @property
    def joints(self) -> list[ModelJoint]:
        """Return the joints of the tree, in the order of the links."""
        return [link.joint for link in self.links]


def model_of(scene: Scene) -> Model:
    """
    Return the :class:`Model` of a scene.

    Raises
    ------
    NoDescription
        The mechanism has no tree, or two frames have one name.

    """
    mechanism = scene.linkage
    tree, position = tree_of(mechanism), start_of(scene)
    motion = mechanism.motion(position, 0.0, 0.0)
    joints = [_joint(scene, place, motion) for place in range(len(mechanism.JOINTS))]
    shapes = shapes_of(mechanism, joints, scene.points.values(), _radius(scene))
    frames = {link.name: frame_of(scene, link.name) for link in mechanism.LINKS}
    frames[GROUND] = scene.frame_id
    bodies = mechanism.bodies._asdict() if mechanism.bodies else {}
    links = tuple(ModelLink(name, frames[name], frames[joints[place].connection.parent],
                            joints[place], bodies.get(name), shapes[name],
                            _pose(mechanism.link_motion(motion, name)))
                  for name, place in tree.holding.items())
    closures = tuple(Closure(joints[place].name, joints[place].connection,
                             frames[joints[place].connection.parent],
                             frames[joints[place].connection.child], joints[place].ratio,
                             joints[place].start)
                     for place in tree.cut)
    points = {point_frame(scene, name): (frames[point.link], point.along, point.across)
              for name, point in scene.points.items()}
    model = Model(scene.frame_id, f'{mechanism.description}, mode {mechanism.mode}',
                  scene.frame_id, links, closures, points, shapes[GROUND], mechanism.gravity,
                  max(map(abs, mechanism.lengths)), position)
    _check_names(model)
    return model


def frame_of(scene: Scene, link: str) -> str:
    """Return the name of the frame of a link: prefix of the joints, name, ``_link``."""
    return f'{scene.joint_states.prefix}{link}_link'


def point_frame(scene: Scene, point: str) -> str:
    """Return the name of the frame of a point."""
    return f'{scene.joint_states.prefix}{point}'


def start_of(scene: Scene) -> float:
    """Return ``drive.start`` if the linkage closes there, else the middle of its first range."""
    try:
        scene.linkage.motion(scene.drive.start, 0.0, 0.0)
        return scene.drive.start
    except FourBarError:
        low, high = scene.linkage.input_ranges[0]
        return 0.5 * (low + high)


def _joint(scene: Scene, place: int, motion: Any) -> ModelJoint:
    """Return the joint at a place of JOINTS."""
    mechanism, shown = scene.linkage, scene.joint_states
    coordinate, name = mechanism.JOINTS[place].coordinate, scene.joint_names[place]
    connection, is_driven = mechanism.connections[place], coordinate == mechanism.input_coordinate
    ratio, offset = shown.ratios[place], shown.offsets[place]
    limits = _limits(mechanism, coordinate, connection, is_driven)
    if limits:
        low, high = sorted(ratio * end + offset for end in limits)
        limits = low, high
    return ModelJoint(name, connection, coordinate, ratio, offset, limits,
                      ratio * getattr(motion, coordinate.position) + offset, is_driven)


def _limits(mechanism: Any, coordinate: Any, connection: Connection,
            is_driven: bool) -> tuple[float, float] | None:
    """Return the range of a joint's coordinate, None if it may turn without end."""
    if is_driven:
        ranges = mechanism.input_ranges
        if mechanism.turns_fully or connection.axis is None and len(ranges) > 1:
            return None
        return ranges[0][0], ranges[-1][1]
    if connection.axis is None:
        return None
    inputs = np.concatenate([np.linspace(low, high, SAMPLES)[1:-1]
                             for low, high in mechanism.input_ranges])
    positions, = mechanism.motion(inputs, fields=(coordinate.position,))
    low, high = np.nanmin(positions), np.nanmax(positions)
    margin = MARGIN * (high - low)
    return float(low - margin), float(high + margin)


def _radius(scene: Scene) -> float:
    """Return the radius of the scene's rods, or one that looks well [m]."""
    radius = scene.values.get('bodies.rods.radius', nan)
    return radius if radius == radius else 0.02 * max(map(abs, scene.linkage.lengths))


def _pose(link: Any) -> tuple[float, float, float]:
    return link.x, link.y, float(np.arctan2(link.sine, link.cosine))


def _direction(turn: float) -> tuple[float, float]:
    """Return (cos, sin); exact for quarter turns."""
    quarters = turn / (0.5 * pi)
    if quarters == round(quarters):
        return ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))[round(quarters) % 4]
    return float(np.cos(turn)), float(np.sin(turn))


def _check_names(model: Model) -> None:
    """Refuse frames of one name: no format has two."""
    names = [model.root, *(link.frame for link in model.links), *model.points,
             *(frame for closure in model.closures for frame in closure.frames)]
    for name in names:
        if names.count(name) > 1:
            raise NoDescription(f'two frames would be named {name!r}: change frame_id, '
                                'joint_states.prefix or the name of a point')
