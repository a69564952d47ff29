# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The picture of a mechanism as a list of primitives, which matplotlib, SVG and RViz draw.

Points are in metres. Blocks and pivots are signs: their outlines are measured in inches of the
paper. The list begins with what lies farthest behind.
"""
from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import singledispatch
from math import hypot
from typing import Any, cast, NamedTuple, TYPE_CHECKING, TypeVar

from fourbar_ros.mechanisms.curves import point_of, vector
from fourbar_ros.mechanisms.four_bars import FourBarLinks
from fourbar_ros.mechanisms.machine.structure import BASE, SLIDES
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.parts import GROUND, NamedFields, SLIDE
from fourbar_ros.mechanisms.points import point_motion
from fourbar_ros.mechanisms.sliders import InvertedSlider, ScotchYoke, SliderCrank
from fourbar_ros.numerics.arrays import Array
import numpy as np

if TYPE_CHECKING:
    from fourbar_ros.mechanisms.machine.machine import Machine

ORIGIN = np.zeros(2)      # O1, and the pole of polygons
X, Y = np.array([1.0, 0.0]), np.array([0.0, 1.0])
BEYOND = 0.14      # length of the bar drawn beyond its block, over the size of the mechanism
Points = Mapping[str, tuple[str, float, float]]      # {name: (link, along, across)}


class Bar(NamedTuple):
    """A straight part of a link between two points, each of shape (2,) [m]; width 1: usual."""

    start: Array
    end: Array
    width: float = 1.0


class Block(NamedTuple):
    """A block at a point [m] that slides along a unit vector; ``is_guided``: on the ground."""

    point: Array
    direction: Array
    is_guided: bool = False


class Diagram(NamedTuple):
    """A mechanism in one pose, as a textbook draws it."""

    joints: Mapping[str, Array]     # {name: point of shape (2,) [m]}, in order along the chain
    ground: tuple[str, ...]         # those joints that the ground holds
    bars: tuple[Bar, ...]
    blocks: tuple[Block, ...]
    forces: Mapping[str, str]       # {field of the loads: joint at which the arrow starts}
    angles: Mapping[str, str]       # {field of the motion: joint about which its arc is drawn}


class Pivot(NamedTuple):
    """A joint on the ground, under its :class:`NamedJoint`."""

    point: Array


class NamedJoint(NamedTuple):
    """A joint by its name in the diagram."""

    name: str
    point: Array


class Arm(NamedTuple):
    """A point of a link: first joint of the link, foot of the point on its line, the point."""

    name: str
    start: Array
    foot: Array
    end: Array


Primitive = Bar | Block | Pivot | NamedJoint | Arm
Drawn = TypeVar('Drawn', Bar, Block, NamedJoint, Arm)


class Force(NamedTuple):
    """A force [N] at a joint; ``name``: its field of the loads."""

    name: str
    joint: str
    point: Array
    vector: Array

    @property
    def size(self) -> float:
        return hypot(*self.vector)


def picture(mechanism: Mechanism, motion: NamedFields, points: Points | None = None
            ) -> list[Primitive]:
    diagram = diagram_of(mechanism, motion)
    arms = [Arm(name, *(point_motion(mechanism, motion, link, *position).place
                        for position in ((0.0, 0.0), (along, 0.0), (along, across))))
            for name, (link, along, across) in (points or {}).items()]
    return [*(Pivot(diagram.joints[name]) for name in diagram.ground), *diagram.bars, *arms,
            *diagram.blocks, *(NamedJoint(*item) for item in diagram.joints.items())]


def forces_of(diagram: Diagram, loads: NamedFields) -> list[Force]:
    return [Force(name, joint, diagram.joints[joint],
                  np.array([getattr(loads, f'{name}_x'), getattr(loads, f'{name}_y')]))
            for name, joint in diagram.forces.items()]


def of_kind(kind: type[Drawn], primitives: Iterable[Primitive]) -> list[Drawn]:
    return [primitive for primitive in primitives if isinstance(primitive, kind)]


def outlines(sign: Block | Pivot, size: float) -> tuple[Array, Array | None]:
    """
    Return the outline of a block or a pivot, shape (n, 2), and the line of its ground, (2, 2) [m].

    The ground is None of a block that slides on a moving link. ``size``: an inch of the paper [m].
    """
    corners, ground, (x, y) = _TRIANGLE, _GROUND, (1.0, 0.0)
    if isinstance(sign, Block):
        corners, ground, (x, y) = _BOX, _GUIDE if sign.is_guided else None, sign.direction
    axes = size * np.array([(x, y), (-y, x)])
    return sign.point + corners @ axes, None if ground is None else sign.point + ground @ axes


# in inches: (along, across) of the corners, and of the ends of the line of the ground
_TRIANGLE = np.array([(0.0, 0.0), (-0.12, -0.19), (0.12, -0.19)])
_GROUND: Array | None = np.array([(-0.19, -0.19), (0.19, -0.19)])
_BOX = np.array([(0.2, 0.11), (0.2, -0.11), (-0.2, -0.11), (-0.2, 0.11)])
_GUIDE = np.array([(-0.7, -0.11), (0.7, -0.11)])


# --- diagrams ------------------------------------------------------------------------------------

@singledispatch
def diagram_of(mechanism: Mechanism, motion: Any) -> Diagram:
    """Return the diagram of a mechanism in one pose."""
    # Each kind has a function below. This one draws machines: bars from joint to joint of each
    # link, blocks on slides.
    machine = cast('Machine', mechanism)
    layout, joints = machine.layout, _joints_of(machine, motion)
    ground = layout.ground              # its index among the links
    pivots = [] if machine.input == SLIDE or ground > 0 else [BASE]
    rods, arms, blocks = [], [], []
    for stage, dyad in zip(layout.stages, machine.stages):
        names, slides = dict(stage.joints()), SLIDES[stage.kind]
        pivots += [names[joint] for joint in ('first', 'second', 'inner')
                   if joint not in slides and ground in stage.ends(joint)]
        rods += [Bar(joints[names[joint]], joints[names['inner']])
                 for joint, i in RODS[stage.kind].items() if stage.links[i] != GROUND]
        # from the first joint of a link to the points of it at which the dyad hangs
        arms += [Bar(_point(machine, motion, end.link), _point(machine, motion, *end))
                 for end in (dyad.first, dyad.second)
                 if end.link != GROUND and (end.along, end.across) != (0.0, 0.0)]
        for joint, i in slides.items():
            link = stage.links[i]
            direction = X if link == GROUND else vector(getattr(motion, f'cos_{link}'),
                                                        getattr(motion, f'sin_{link}'))
            blocks.append(Block(joints[names[joint]], direction,
                                joint != 'first' and ground in stage.ends(joint)))
    if machine.input == SLIDE:
        blocks.append(Block(joints[BASE], X, is_guided=True))
    first_joints = {link.name: BASE if link.first_joint == 'O1' else link.first_joint
                    for link in machine.LINKS}
    angles = {coordinate.position: first_joints.get(
        coordinate.position.removeprefix('theta_'), BASE)
        for coordinate in machine.DRAWN if coordinate.unit == 'rad'}
    return Diagram(joints, tuple(pivots),
                   (*rods, *arms, *_third_sides(machine, motion, joints)), tuple(blocks),
                   {name: name for name in joints}, angles)


# {kind of dyad: {joint: index of the link that is drawn from there to the inner joint}}, rods and
# the bar of a block
RODS = {'RRR': {'first': 0, 'second': 1}, 'RRP': {'first': 0}, 'RPR': {'second': 1},
        'RPP': {'second': 1}, 'PRP': {}}


def _point(mechanism: Mechanism, motion: NamedFields, link: str, along: float = 0.0,
           across: float = 0.0) -> Array:
    """Return a point of a link or of the ground in one pose, shape (2,) [m]."""
    if link == GROUND:
        return np.array((along, across))
    x, y, *_ = point_of(mechanism.link_motion(motion, link), along, across)
    return vector(x, y)


def _joints_of(machine: Machine, motion: NamedFields) -> dict[str, Array]:
    """Return {joint: its point [m]} in one pose; a slide is where its block is."""
    points = {BASE: _point(machine, motion, machine.layout.driven)}
    for stage, dyad in zip(machine.layout.stages, machine.stages):
        ends, slides = {'first': dyad.first, 'second': dyad.second}, SLIDES[stage.kind]
        for joint, name in stage.joints():
            if joint in slides:
                points[name] = _point(machine, motion, stage.links[slides[joint]])
            elif joint in ends:
                points[name] = _point(machine, motion, *ends[joint])
            else:                   # the end of a rod, or where the two carriages of PRP meet
                along = 0.0 if stage.kind == 'PRP' else cast('float', dyad.length_1)
                points[name] = _point(machine, motion, stage.links[0], along)
    return points


def _third_sides(machine: Machine, motion: NamedFields, joints: Mapping[str, Array]) -> list[Bar]:
    """Return the sides of links of three and more joints that do not begin at the first joint."""
    # motion is of a single pose; joints are its points by name, shape (2,) each.
    corners: dict[str, list[Array]] = {link: [] for link in machine.layout.links}
    corners[machine.layout.driven].append(joints[BASE])
    for stage, dyad in zip(machine.layout.stages, machine.stages):
        names, slides = dict(stage.joints()), SLIDES[stage.kind]
        for joint, link, carrier in (('first', stage.links[0], dyad.first),
                                     ('second', stage.links[1], dyad.second)):
            if joint not in slides:
                corners[link].append(joints[names[joint]])
            corners[carrier.link].append(_point(machine, motion, *carrier))
        block = slides.get('inner')             # which of the links, where the inner joint slides
        for i, link in enumerate(stage.links):
            if block is None or i == block:     # the block is no corner of the bar it slides on
                corners[link].append(joints[names['inner']])
    del corners[GROUND]
    sides = []
    for points in corners.values():
        beyond = [point for point in points[1:] if np.hypot(*(point - points[0])) > 0.0]
        sides += [Bar(start, end) for start, end in zip(beyond, beyond[1:])
                  if np.hypot(*(start - end)) > 0.0]
    return sides


@diagram_of.register(FourBarLinks)
def _four_bar(mechanism: FourBarLinks, motion: Any) -> Diagram:
    a = _point(mechanism, motion, 'crank', mechanism.a1)
    b = _point(mechanism, motion, 'output', mechanism.a3)
    o4 = _point(mechanism, motion, 'output')
    return Diagram({'O_1': ORIGIN, 'A': a, 'B': b, 'O_4': o4}, ('O_1', 'O_4'),
                   (Bar(ORIGIN, a), Bar(a, b), Bar(o4, b)), (),
                   {'f41': 'O_1', 'f21': 'A', 'f32': 'B', 'f43': 'O_4'},
                   {'theta1': 'O_1', 'theta4': 'O_4'})


@diagram_of.register(SliderCrank)
def _slider_crank(mechanism: SliderCrank, motion: Any) -> Diagram:
    a = _point(mechanism, motion, 'crank', mechanism.a1)
    b = _point(mechanism, motion, 'output')
    return Diagram({'O_1': ORIGIN, 'A': a, 'B': b}, ('O_1',), (Bar(ORIGIN, a), Bar(a, b)),
                   (Block(b, X, is_guided=True),),
                   {'f41': 'O_1', 'f21': 'A', 'f32': 'B', 'f43': 'B'}, {'theta1': 'O_1'})


@diagram_of.register(ScotchYoke)
def _scotch_yoke(mechanism: ScotchYoke, motion: Any) -> Diagram:
    a = _point(mechanism, motion, 'crank', mechanism.a1)
    b = _point(mechanism, motion, 'output')
    # the slot of the yoke reaches over the whole travel of the block, and to the guide
    slot = [b, *(b + (end - mechanism.offset) * Y
                 for end in (-1.1 * mechanism.a1, 1.1 * mechanism.a1))]
    low, _, high = sorted(slot, key=lambda point: float(point[1]))
    return Diagram({'O_1': ORIGIN, 'A': a, 'B': b}, ('O_1',), (Bar(low, high), Bar(ORIGIN, a)),
                   (Block(b, X, is_guided=True), Block(a, Y)),
                   {'f41': 'O_1', 'f21': 'A', 'f32': 'A', 'f43': 'B'}, {'theta1': 'O_1'})


@diagram_of.register(InvertedSlider)
def _inverted_slider(mechanism: InvertedSlider, motion: Any) -> Diagram:
    """Return the diagram of a bar with its block at A, or of a cylinder with its rod."""
    a = _point(mechanism, motion, 'crank', mechanism.a1)
    o4 = _point(mechanism, motion, 'output')
    bar = mechanism.link_motion(motion, 'output').direction
    foot, sense = a - motion.slide * bar, np.sign(motion.slide) * bar
    bars, blocks = [Bar(ORIGIN, a), Bar(o4, foot)], []
    if mechanism.is_driven_by_slide:        # a cylinder: the tube from O4, the rod out of it to A
        low, high = sorted(map(abs, mechanism.input_ranges[-1]))
        tube = max(0.9 * low, 0.45 * high)      # as long as it can be with the rod in
        end = foot + min(tube, 0.98 * abs(motion.slide)) * sense
        bars += [Bar(foot, a, 0.7), Bar(foot, end, 2.4)]
    else:
        size = max(np.ptp(np.array([ORIGIN, a, o4]), axis=0))
        bars.append(Bar(foot, a + BEYOND * size * sense))
        blocks.append(Block(a, bar))
    return Diagram({'O_1': ORIGIN, 'A': a, 'O_4': o4}, ('O_1', 'O_4'), tuple(bars),
                   tuple(blocks), {'f41': 'O_1', 'f21': 'A', 'f32': 'A', 'f43': 'O_4'},
                   {'theta1': 'O_1', 'theta4': 'O_4'})
