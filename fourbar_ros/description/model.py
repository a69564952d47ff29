# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
A scene as links, joints and shapes in one plane, with the names that it has in ROS.

URDF and MJCF are written from it. Frames are the same as the node's: the root is the scene's
``frame_id`` in O1. Each link has its frame at its first joint, x along the link. Joints have the
names, senses and zeros of ``joint_states``. URDF knows trees only: every link hangs on one joint,
and each joint beyond that closes a loop.
"""
from cmath import rect
from collections.abc import Sequence
from math import isnan, nan, remainder, tau
from typing import NamedTuple

from fourbar_ros.description.connections import Connection, connections_of
from fourbar_ros.description.shapes import Shape, shapes_of
from fourbar_ros.errors import FourBarError
from fourbar_ros.extrema.over_input import output_ranges
from fourbar_ros.mechanics.bodies import Body, field_of
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.parts import Coordinate, GROUND, NamedFields
from fourbar_ros.numerics.number_types import direction
from fourbar_ros.pipeline.joints import start_of
from fourbar_ros.scene.elements import element_names
from fourbar_ros.scene.scene import Scene

MARGIN = 0.01          # share by which the limits of passive slides are wider than they are
FAR = 1e6              # of the longest length: the limit of a slide without one
SAME = 1e-9            # of the longest length, and [rad]: by which a closed loop may be open
Vector = tuple[float, float, float]
LEAST = 1e-9           # [kg], or times mass and size squared: for a body without mass or inertia


class ModelJoint(NamedTuple):
    """A joint, of the tree or one that closes a loop; position = ratio * coordinate + offset."""

    name: str                                   # in ``joint_states``
    parent: str                                 # frames of the links that it connects
    child: str
    connection: Connection                      # of the mechanism's links
    coordinate: Coordinate
    ratio: float
    offset: float
    limits: tuple[float, float] | None          # [rad or m]; None: it turns without end
    start: float                                # its position at the start of the scene
    is_driven: bool

    @property
    def slides(self) -> bool:
        return self.connection.axis is not None

    @property
    def closing_frames(self) -> tuple[str, str]:
        """Return two frames, on parent and child, that coincide where a loop is cut here."""
        return f'closing_{self.name}_1', f'closing_{self.name}_2'

    @property
    def travel(self) -> tuple[float, float] | None:
        """Return (low, high) of a slide along the axis of its connection [m]; None of a pin."""
        if self.connection.axis is None or self.limits is None:
            return None
        low, high = sorted(self.ratio * (end - self.offset) for end in self.limits)
        return low, high

    @property
    def at_zero(self) -> tuple[float, float, float]:
        """Return (x, y, angle) of the child's frame in the parent's at joint position zero."""
        # the coordinate there: ratio is 1 or -1, its own inverse
        return self.connection.pose(-self.ratio * self.offset + 0.0)

    @property
    def axis(self) -> tuple[float, float, float]:
        """Return the unit vector of the joint in the frame of the child."""
        if self.connection.axis is None:
            return 0.0, 0.0, self.ratio
        (a_x, a_y), turn = self.connection.axis, self.connection.turn
        cosine, sine = direction(turn)
        return (self.ratio * (a_x * cosine + a_y * sine),
                self.ratio * (a_y * cosine - a_x * sine), 0.0)


class ModelLink(NamedTuple):
    """A moving link: the joint at which it is the child, body and shapes."""

    joint: ModelJoint
    body: Body | None
    shapes: Sequence[Shape]


class RobotModel(NamedTuple):
    """
    A scene for other programs.

    ``points``: {name of a frame: (frame of its link, x, y)}; ``position``: the input at the start;
    ``size``: the longest length [m].
    """

    title: str
    root: str                   # frame of the ground, by which programs call it
    frame: NamedFields          # where the root lies, if it has a parent
    links: tuple[ModelLink, ...]
    closures: tuple[ModelJoint, ...]            # joints at which a loop is cut
    points: dict[str, tuple[str, float, float]]
    ground: Sequence[Shape]
    gravity: tuple[float, float]
    size: float
    position: float

    @property
    def joints(self) -> list[ModelJoint]:
        return [link.joint for link in self.links]

    @property
    def open_at_zero(self) -> float:
        """Return by how much the loops are open [m, rad] where all joints of the tree are zero."""
        poses, far = {self.root: (0j, 0.0)}, 0.0
        for joint in self.joints:
            (origin, turn), (x, y, angle) = poses[joint.parent], joint.at_zero
            poses[joint.child] = origin + complex(x, y) * rect(1.0, turn), turn + angle
        for closure in self.closures:
            connection, ends = closure.connection, (poses[closure.parent], poses[closure.child])
            here, there = (origin + complex(*point) * rect(1.0, turn) for (origin, turn), point
                           in zip(ends, (connection.on_parent, connection.on_child)))
            turns = [turn for _, turn in ends]
            if connection.axis is None:
                far = max(far, abs(here - there))
            else:       # along its axis a slide may be anywhere
                along = complex(*connection.axis) * rect(1.0, turns[0])
                off = remainder(turns[1] - turns[0] - connection.turn, tau)
                far = max(far, abs(((here - there) / along).imag), abs(off))
        return far


def note_of(scene: Scene) -> str:
    """Return a line if the loops are open where all joints are zero, and what helps; or ''."""
    model = model_of(scene)
    if model.open_at_zero <= SAME * model.size:
        return ''
    mechanism, shown = scene.linkage, scene.joint_states
    driven = [joint.coordinate for joint in mechanism.JOINTS].index(mechanism.input_coordinate)
    ratio, offset = shown.ratios[driven], shown.offsets[driven]
    said = ('note: the loops are open where all joints are 0, as in joint_state_publisher_gui; '
            'closed is "start", in the file')
    try:            # the zero of the driven joint stays: a motor has it
        motion = mechanism.motion(-offset / ratio, 0.0, 0.0)
    except FourBarError:
        if scene.drive.source == 'joint_state':
            return said
        motion = mechanism.motion(model.position, 0.0, 0.0)
    offsets = [round(-ratio * getattr(motion, joint.coordinate.position), 12) + 0.0
               for ratio, joint in zip(shown.ratios, mechanism.JOINTS)]
    return f'{said}. To be closed at 0, in the node too: joint_states.offsets: {offsets}'


def left_out(scene: Scene) -> list[str]:
    """Return what acts in a scene and stands in no description: forces, springs, friction."""
    applied = scene.linkage.external._asdict()
    return [*(f'external.{link}' for link, each in applied.items()
              if each.force_x or each.force_y or each.couple),
            *element_names(scene.values),
            *(f'friction.{joint}' for joint, _ in scene.linkage.friction)]


def model_of(scene: Scene) -> RobotModel:
    """
    Return the :class:`RobotModel` of a scene.

    Raises NoDescription if the mechanism has no tree, or two frames have one name.
    """
    mechanism = scene.linkage
    (holding, cut), position = tree_of(mechanism), start_of(scene)
    motion = mechanism.motion(position, 0.0, 0.0)
    frames = {GROUND: scene.frame_id, **{  # of links: prefix of the joints, name, ``_link``
        link.name: f'{scene.joint_states.prefix}{link.name}_link' for link in mechanism.LINKS}}
    joints = [_joint(scene, index, frames, motion) for index in range(len(mechanism.JOINTS))]
    size = max(map(abs, mechanism.lengths))
    # of the rods: the scene's, or half the width of a bar
    radii = (scene.values.get('bodies.rods.radius', nan),
             0.5 * scene.values.get('bodies.rods.width', nan))
    radius = next((radius for radius in radii if not isnan(radius)), 0.02 * size)
    shapes = shapes_of(mechanism, [(joint.connection, joint.travel) for joint in joints],
                       scene.points.values(), float(radius))
    bodies = mechanism.bodies._asdict() if mechanism.bodies else {}
    links = tuple(ModelLink(joints[index], bodies.get(name), shapes[name])
                  for name, index in holding.items())
    closures = tuple(joints[index] for index in cut)
    points = {f'{scene.joint_states.prefix}{name}': (frames[point.link], point.along, point.across)
              for name, point in scene.points.items()}
    model = RobotModel(f'{mechanism.description}, mode {mechanism.mode}', scene.frame_id,
                       scene.frame, links, closures, points, shapes[GROUND],
                       field_of(mechanism.gravity), size, position)
    names = [scene.frame.parent, model.root, *(joint.child for joint in model.joints), *points,
             *(frame for closure in closures for frame in closure.closing_frames)]
    for name in names:
        if names.count(name) > 1:
            raise NoDescription(f'two frames would be named {name!r}: change frame_id, '
                                'frame.parent, joint_states.prefix or the name of a point')
    return model


def _joint(scene: Scene, index: int, frames: dict[str, str], motion: NamedFields) -> ModelJoint:
    """Return a joint; ``frames``: {link: its frame}, ``motion``: that at the scene's start."""
    mechanism, shown = scene.linkage, scene.joint_states
    coordinate, name = mechanism.JOINTS[index].coordinate, scene.joint_names[index]
    connection = connections_of(mechanism)[index]
    is_driven = coordinate == mechanism.input_coordinate
    ratio, offset = shown.ratios[index], shown.offsets[index]
    limits = None
    if (mechanism.stroke or not mechanism.turns_fully if is_driven
            else connection.axis is not None):
        # in the turn of the start, so that it lies between them
        low, high = mechanism.range_around(getattr(motion, mechanism.input_coordinate.position))
        if not is_driven:       # what the slide sweeps there, with a margin
            swept = min(output_ranges(mechanism, coordinate),
                        key=lambda swept: abs(mechanism.distance(swept.inputs[0], low)))
            far = FAR * max(map(abs, mechanism.lengths))        # where links run to infinity
            low, high = max(swept.low, -far), min(swept.high, far)
            margin = MARGIN * (high - low)
            low, high = low - margin, high + margin
        low, high = sorted((ratio * low + offset, ratio * high + offset))
        limits = low, high
    return ModelJoint(name, frames[connection.parent], frames[connection.child], connection,
                      coordinate, ratio, offset, limits,
                      ratio * getattr(motion, coordinate.position) + offset, is_driven)


class NoDescription(FourBarError):
    """A mechanism or a scene cannot be written in a format."""


def tree_of(mechanism: Mechanism) -> tuple[dict[str, int], list[int]]:
    """
    Return ({link: the joint that it hangs on}, joints that close loops), joints as in ``JOINTS``.

    Each link stands after its carrier.

    A link hangs on the driven joint if that is at its first joint, else on a joint that slides,
    else on one that turns: so loops are cut at pins wherever they have one. Where machines are
    solved from a moving link, that hangs on a joint beside its first.

    Raises NoDescription if its joints do not reach every link from the ground.
    """
    connections, driven = connections_of(mechanism), mechanism.input_coordinate

    def preference(joint: int) -> tuple[bool, bool, bool, int]:
        is_driven = mechanism.JOINTS[joint].coordinate == driven
        return (connections[joint].on_child != (0.0, 0.0), not is_driven,
                connections[joint].axis is None, joint)

    chosen = {}
    for link in mechanism.LINKS:
        chosen[link.name] = min((joint for joint, connection in enumerate(connections)
                                 if connection.child == link.name), key=preference)
    ordered: dict[str, int] = {}
    while len(ordered) < len(chosen):
        reached = {link: joint for link, joint in chosen.items() if link not in ordered
                   and connections[joint].parent in (GROUND, *ordered)}
        if not reached:
            raise NoDescription('these links hang on each other in a circle: '
                                f'{", ".join(sorted(chosen.keys() - ordered.keys()))}')
        ordered |= reached
    return ordered, sorted(set(range(len(connections))) - set(ordered.values()))


def inertia_of(body: Body, size: float) -> tuple[float, Vector, Vector]:
    """
    Return mass [kg], centre of gravity in the frame of the link [m], moments of inertia [kg m^2].

    A planar mechanism gives the moment about z alone, and nothing in its plane depends on the
    other two. So a flat body's moments are written, I_xx = I_yy = I_zz / 2. No program takes a
    body without mass or inertia. ``size``: the size of the mechanism [m].
    """
    about_z = max(body.inertia, LEAST * (body.mass or 1.0) * size * size)
    return (max(body.mass, LEAST), (body.cg_along, body.cg_across, 0.0),
            (0.5 * about_z, 0.5 * about_z, about_z))
