# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
What is drawn of a mechanism, by matplotlib, SVG and RViz.

A :class:`Diagram` states it by points of links, or in a pose. Points are in metres. Blocks and
pivots are signs: their outlines are measured in inches of the paper.
"""
from __future__ import annotations

from collections.abc import Mapping
from functools import singledispatch
from math import copysign, hypot
from typing import Any, cast, NamedTuple, TYPE_CHECKING

from fourbar_ros.mechanisms.curves import Point, point_of, vector
from fourbar_ros.mechanisms.four_bars import FourBarLinks
from fourbar_ros.mechanisms.machine.structure import BASE, CYLINDER, SLIDES, Stage
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.parts import GROUND, NamedFields, SLIDE
from fourbar_ros.mechanisms.points import point_motion
from fourbar_ros.mechanisms.sliders import InvertedSlider, ScotchYoke, SliderCrank
from fourbar_ros.numerics.arrays import Array
import numpy as np

if TYPE_CHECKING:
    from fourbar_ros.mechanisms.machine.description import Dyad
    from fourbar_ros.mechanisms.machine.machine import Machine

ORIGIN = np.zeros(2)      # O1, and the pole of polygons
X, Y = np.array([1.0, 0.0]), np.array([0.0, 1.0])
BEYOND = 0.14      # length of the bar drawn beyond its block, over crank and frame
SAME = 1e-9        # points of a link that are nearer, over their distance, are one
Points = Mapping[str, tuple[str, float, float]]      # {name: (link, along, across)}


class Bar(NamedTuple):
    """A straight part of a link between two points; width 1: usual."""

    start: Any      # a Point of a link; in a pose of shape (2,) [m]
    end: Any
    width: float = 1.0


class SceneLength(float):
    """A length [m] that knows the parameter of a scene which it is: a page follows it."""

    name: str

    def __new__(cls, name: str, value: float) -> SceneLength:
        """Return the value of a parameter."""
        length = super().__new__(cls, value)
        length.name = name
        return length


class Block(NamedTuple):
    """A block at a joint that slides along a direction of a link; ``is_guided``: on the ground."""

    joint: str
    link: str
    direction: Any = (1.0, 0.0)     # from that of the link; in a pose a unit vector, shape (2,)
    is_guided: bool = False


class Diagram(NamedTuple):
    """A mechanism as a textbook draws it, by points of its links or in a pose."""

    # in order along the chain {name: the Point of each link there}; in a pose of shape (2,) [m]
    joints: Mapping[str, Any]
    ground: tuple[str, ...]         # those joints that the ground holds
    bars: tuple[Bar, ...]
    blocks: tuple[Block, ...]
    forces: Mapping[str, str]       # {field of the loads: joint at which the arrow starts}
    angles: Mapping[str, str]       # {field of the motion: joint about which its arc is drawn}
    names: Mapping[str, str] = {}   # in a pose {joint: name of the point there}
    plates: tuple[tuple[Point, ...], ...] = ()      # links of more points; none in a pose


class Arm(NamedTuple):
    """A point of a link: first joint of the link, foot of the point on its line, the point."""

    name: str
    start: Array
    foot: Array
    end: Array


class Force(NamedTuple):
    """A force [N] at a joint; ``name``: its field of the loads."""

    name: str
    joint: str
    point: Array
    vector: Array

    @property
    def size(self) -> float:
        return hypot(*self.vector)


def arms_of(mechanism: Mechanism, motion: NamedFields, points: Points) -> list[Arm]:
    return [Arm(name, *(point_motion(mechanism, motion, link, *position).place
                        for position in ((0.0, 0.0), (along, 0.0), (along, across))))
            for name, (link, along, across) in points.items()]


def forces_of(diagram: Diagram, loads: NamedFields) -> list[Force]:
    return [Force(name, joint, diagram.joints[joint],
                  np.array([getattr(loads, f'{name}_x'), getattr(loads, f'{name}_y')]))
            for name, joint in diagram.forces.items()]


def outlines(point: Array, size: float, block: Block | None = None) -> tuple[Array, Array | None]:
    """Return the outline of a block or a pivot, (n, 2), and the line of its ground, (2, 2) [m]."""
    # The ground is None of a block that slides on a moving link. size: an inch of the paper [m].
    corners, ground, (x, y) = _TRIANGLE, _GROUND, (1.0, 0.0)
    if block:
        corners, ground, (x, y) = _BOX, _GUIDE if block.is_guided else None, block.direction
    axes = size * np.array([(x, y), (-y, x)])
    return point + corners @ axes, None if ground is None else point + ground @ axes


# in inches: (along, across) of the corners, and of the ends of the line of the ground
_TRIANGLE = np.array([(0.0, 0.0), (-0.12, -0.19), (0.12, -0.19)])
_GROUND: Array | None = np.array([(-0.19, -0.19), (0.19, -0.19)])
_BOX = np.array([(0.2, 0.11), (0.2, -0.11), (-0.2, -0.11), (-0.2, 0.11)])
_GUIDE = np.array([(-0.7, -0.11), (0.7, -0.11)])


# --- diagrams ------------------------------------------------------------------------------------

def diagram_of(mechanism: Mechanism, motion: Any) -> Diagram:
    """Return the diagram of a mechanism in one pose; plates are drawn as bars between corners."""
    outline = outline_of(mechanism, motion)

    def locate(point: Point) -> Array:
        link, along, across = point
        if link == GROUND:
            return np.array((along, across))
        x, y, *_ = point_of(mechanism.link_motion(motion, link), along, across)
        return vector(x, y)

    # the points of all links at a joint coincide
    joints = {name: locate(points[0]) for name, points in outline.joints.items()}
    # each corner with the first and with the next: triangles, so that a plate looks rigid
    sides = [Bar(start, end) for first, *rest in outline.plates
             for start, end in (*((first, corner) for corner in rest), *zip(rest, rest[1:]))]
    return outline._replace(
        joints=joints, plates=(),
        bars=tuple([Bar(locate(start), locate(end), width)
                    for start, end, width in dict.fromkeys((*outline.bars, *sides))]),
        blocks=tuple([block._replace(direction=locate(Point(block.link, *block.direction))
                                     - locate(Point(block.link))) for block in outline.blocks]),
        names={joint: mechanism.joint_names[name] for joint in joints
               if (name := {'O_1': 'O1', 'O_4': 'O4'}.get(joint, joint))
               in mechanism.joint_names})


# {kind of dyad: {joint: index of the link that is drawn from there to the inner joint}}, rods and
# the bar of a block
RODS = {'RRR': {'first': 0, 'second': 1}, 'RRP': {'first': 0}, 'RPR': {'second': 1},
        'RPP': {'second': 1}, 'PRP': {}}


def points_of_dyad(stage: Stage, dyad: Dyad) -> dict[str, tuple[Point, ...]]:
    """Return the points of a dyad's links at its joints, by lengths that know their parameters."""
    # At first and second the point of the dyad's link, and that of the link on which it hangs;
    # at inner the point of its first link, and that of its second, or of a block alone.
    group, ends = f'dyads.{dyad.name}', ('first', 'second')
    if stage.name == CYLINDER:
        group, ends = 'cylinder', ('pin', 'base')
    held = [Point(point.link, SceneLength(f'{group}.{end}.along', point.along),
                  SceneLength(f'{group}.{end}.across', point.across))
            for end, point in zip(ends, (dyad.first, dyad.second))]
    length_1, length_2 = (SceneLength(f'{group}.{name}', getattr(dyad, name) or 0.0)
                          for name in ('length_1', 'length_2'))
    first, second = [Point(link) for link in stage.links]
    inner = {'RRR': (first._replace(along=length_1), second._replace(along=length_2)),
             'RRP': (first._replace(along=length_1), second), 'PRP': (first, second)}
    return {'first': (first, held[0]), 'inner': inner.get(stage.kind, (first,)),
            'second': (second, held[1])}


@singledispatch
def outline_of(mechanism: Mechanism, motion: Any) -> Diagram:
    """Return what is drawn of a mechanism; only the side of a bar with a block is of the pose."""
    # Each kind has a function below. This one draws machines: bars from joint to joint of each
    # link, plates of links with three joints and more, blocks on slides.
    machine = cast('Machine', mechanism)
    layout, ground = machine.layout, machine.layout.ground      # its index among the links
    base = Point(layout.driven)
    is_pinned = machine.input != SLIDE and ground == 0
    joints: dict[str, tuple[Point, ...]] = {BASE: (base, Point(GROUND)) if is_pinned else (base,)}
    pivots, bars, blocks = [BASE] * is_pinned, list[Bar](), list[Block]()
    # {link: its corners, each by the point that is drawn, of any link there, and by its own}
    corners: dict[str, list[tuple[Point, Point]]] = {link: [] for link in layout.links}

    def add_corner(drawn: Point, link: str, along: float = 0.0, across: float = 0.0) -> None:
        size = hypot(along, across) + machine.input_unit
        if all(hypot(along - known.along, across - known.across) > SAME * size
               for _, known in corners[link]):
            corners[link].append((drawn, Point(link, along, across)))

    add_corner(base, layout.driven)
    for stage, dyad in zip(layout.stages, machine.stages):
        names, slides = dict(stage.joints()), SLIDES[stage.kind]
        points = points_of_dyad(stage, dyad)
        joints |= {name: points[joint][:1 if joint in slides else 2]
                   for joint, name in names.items()}
        pivots += [names[joint] for joint in ('first', 'second', 'inner')
                   if joint not in slides and ground in stage.ends(joint)]
        for joint, carrier in (('first', dyad.first), ('second', dyad.second)):
            drawn, held = points[joint]
            if joint in slides:
                drawn = held        # where the slide begins on the link that carries it
            else:
                add_corner(drawn, drawn.link)
            add_corner(drawn, carrier.link, carrier.along, carrier.across)
        if 'inner' not in slides:
            for point in points['inner'][:2 if stage.kind == 'RRR' else 1]:
                add_corner(point, point.link, point.along)
        inner = points['inner']
        bars += [Bar(joints[names[joint]][0], inner[i % len(inner)])
                 for joint, i in RODS[stage.kind].items() if stage.links[i] != GROUND]
        blocks += [Block(names[joint], stage.links[i],
                         is_guided=joint != 'first' and ground in stage.ends(joint))
                   for joint, i in slides.items()]
    if machine.input == SLIDE:
        blocks.append(Block(BASE, layout.driven, is_guided=True))
    del corners[GROUND]
    plates = [tuple([drawn for drawn, _ in of_link]) for of_link in corners.values()]
    bars += [Bar(*plate) for plate in plates if len(plate) == 2]
    first_joints = {link.name: BASE if link.first_joint == 'O1' else link.first_joint
                    for link in machine.LINKS}
    angles = {coordinate.position: first_joints.get(
        coordinate.position.removeprefix('theta_'), BASE)
        for coordinate in machine.DRAWN if coordinate.unit == 'rad'}
    return Diagram(joints, ground=tuple(pivots), bars=tuple(dict.fromkeys(bars)),
                   blocks=tuple(blocks), forces={name: name for name in joints}, angles=angles,
                   plates=tuple([plate for plate in plates if len(plate) > 2]))


CRANK, OUTPUT = Point('crank'), Point('output')


def _crank(mechanism: Any) -> dict[str, tuple[Point, ...]]:
    """Return the joints O1 and A."""
    return {'O_1': (Point(GROUND), CRANK),
            'A': (Point('crank', SceneLength('linkage.a1', mechanism.a1)), Point('coupler'))}


@outline_of.register(FourBarLinks)
def _four_bar(mechanism: FourBarLinks, motion: Any) -> Diagram:
    a2, a3, a4 = (SceneLength(f'linkage.{name}', getattr(mechanism, name))
                  for name in ('a2', 'a3', 'a4'))
    joints = _crank(mechanism) | {
        'B': (Point('output', a3), Point('coupler', a2)),
        'O_4': (Point(GROUND, a4), OUTPUT)}
    a, b = joints['A'][0], joints['B'][0]
    return Diagram(joints, ground=('O_1', 'O_4'), bars=(Bar(CRANK, a), Bar(a, b), Bar(OUTPUT, b)),
                   blocks=(), forces={'f41': 'O_1', 'f21': 'A', 'f32': 'B', 'f43': 'O_4'},
                   angles={'theta1': 'O_1', 'theta4': 'O_4'})


@outline_of.register(SliderCrank)
def _slider_crank(mechanism: SliderCrank, motion: Any) -> Diagram:
    joints = _crank(mechanism) | {'B': (OUTPUT,)}
    a = joints['A'][0]
    return Diagram(joints, ground=('O_1',), bars=(Bar(CRANK, a), Bar(a, OUTPUT)),
                   blocks=(Block('B', GROUND, is_guided=True),),
                   forces={'f41': 'O_1', 'f21': 'A', 'f32': 'B', 'f43': 'B'},
                   angles={'theta1': 'O_1'})


@outline_of.register(ScotchYoke)
def _scotch_yoke(mechanism: ScotchYoke, motion: Any) -> Diagram:
    joints = _crank(mechanism) | {'B': (OUTPUT,)}
    # the slot of the yoke reaches over the whole travel of the block, and to the guide
    low, _, high = sorted((0.0, *(end * mechanism.a1 - mechanism.offset for end in (-1.1, 1.1))))
    slot = Bar(Point('output', 0.0, low), Point('output', 0.0, high))
    return Diagram(joints, ground=('O_1',), bars=(slot, Bar(CRANK, joints['A'][0])),
                   blocks=(Block('B', 'output', is_guided=True), Block('A', 'output', (0.0, 1.0))),
                   forces={'f41': 'O_1', 'f21': 'A', 'f32': 'A', 'f43': 'B'},
                   angles={'theta1': 'O_1'})


@outline_of.register(InvertedSlider)
def _inverted_slider(mechanism: InvertedSlider, motion: Any) -> Diagram:
    """Return the outline of a bar with its block at A, or of a cylinder with its rod."""
    joints = _crank(mechanism) | {
        'O_4': (Point(GROUND, SceneLength('linkage.a4', mechanism.a4)), OUTPUT)}
    a, foot = joints['A'][0], Point('output', 0.0, mechanism.offset)
    bars, blocks = [Bar(CRANK, a), Bar(OUTPUT, foot)], []
    # a cylinder: the tube from O4, the thin rod out of it to A, in proportions that look like one
    if mechanism.is_driven_by_slide:
        low, high = sorted(map(abs, mechanism.input_ranges[-1]))
        tube = max(0.9 * low, 0.45 * high)      # as long as it can be with the rod in
        length, width = min(tube, 0.98 * abs(motion.slide)), 2.4
        bars.append(Bar(foot, a, 0.7))
    else:
        length, width = (1.0 + BEYOND) * (mechanism.a1 + mechanism.a4), 1.0
        blocks.append(Block('A', 'output'))
    bars.append(Bar(foot, foot._replace(along=copysign(length, motion.slide)), width))
    return Diagram(joints, ground=('O_1', 'O_4'), bars=tuple(bars), blocks=tuple(blocks),
                   forces={'f41': 'O_1', 'f21': 'A', 'f32': 'A', 'f43': 'O_4'},
                   angles={'theta1': 'O_1', 'theta4': 'O_4'})
