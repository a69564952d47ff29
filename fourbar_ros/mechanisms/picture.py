# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The picture of a mechanism as a list of primitives, which matplotlib, SVG and RViz draw.

Places are in metres. Blocks and pivots have no size of their own: their outlines take that of the
sign, about an inch of the paper. Behind comes first.
"""
from __future__ import annotations

from collections.abc import Iterable, Mapping
from math import hypot
from typing import Any, cast, NamedTuple, TYPE_CHECKING, TypeVar

from fourbar_ros.mechanisms.curves import point_of, vector
from fourbar_ros.mechanisms.four_bars import FourBarLinks
from fourbar_ros.mechanisms.machine.structure import BASE, SLIDES, Stage
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.parts import GROUND, NamedFields
from fourbar_ros.mechanisms.points import point_motion
from fourbar_ros.mechanisms.sliders import InvertedSlider, ScotchYoke, SliderCrank
from fourbar_ros.numerics.arrays import Array
import numpy as np

if TYPE_CHECKING:
    from fourbar_ros.mechanisms.machine.machine import Machine

ORIGIN = np.zeros(2)      # O1, and the pole of polygons
X, Y = np.array([1.0, 0.0]), np.array([0.0, 1.0])
BEYOND = 0.14      # length of the bar drawn beyond its block, over the size of the mechanism
JointPlaces = Mapping[str, Array]        # of joints, by name
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

    joints: Mapping[str, Array]     # {name: place of shape (2,) [m]}, in order along the chain
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
        """Return its magnitude [N]."""
        return hypot(*self.vector)


def picture(mechanism: Mechanism, motion: NamedFields, points: Points | None = None
            ) -> list[Primitive]:
    """Return the primitives of a mechanism in a pose, with points that are fixed to its links."""
    diagram = diagram_of(mechanism, motion)
    arms = [Arm(name, *(point_motion(mechanism, motion, link, *place).place
                        for place in ((0.0, 0.0), (along, 0.0), (along, across))))
            for name, (link, along, across) in (points or {}).items()]
    return [*(Pivot(diagram.joints[name]) for name in diagram.ground), *diagram.bars, *arms,
            *diagram.blocks, *(NamedJoint(*item) for item in diagram.joints.items())]


def forces_of(diagram: Diagram, loads: NamedFields) -> list[Force]:
    """Return the forces [N] at the joints whose fields of the loads a diagram names."""
    return [Force(name, joint, diagram.joints[joint],
                  np.array([getattr(loads, f'{name}_x'), getattr(loads, f'{name}_y')]))
            for name, joint in diagram.forces.items()]


def of_kind(kind: type[Drawn], parts: Iterable[Primitive]) -> list[Drawn]:
    """Return the primitives of one kind."""
    return [part for part in parts if isinstance(part, kind)]


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


# --- contents ------------------------------------------------------------------------------------

def diagram_of(mechanism: Mechanism, motion: Any) -> Diagram:
    """Return the contents of the picture of a mechanism in one pose."""
    if not isinstance(mechanism, (FourBarLinks, SliderCrank, InvertedSlider, ScotchYoke)):
        return _of_machine(cast('Machine', mechanism), motion)
    a = point_motion(mechanism, motion, 'crank', mechanism.a1).place
    if isinstance(mechanism, InvertedSlider):
        return _of_bar(mechanism, motion, a)
    angles = {'theta1': 'O_1'}
    if isinstance(mechanism, FourBarLinks):
        b = point_motion(mechanism, motion, 'output', mechanism.a3).place
        o4 = point_motion(mechanism, motion, 'output', 0.0).place
        return Diagram({'O_1': ORIGIN, 'A': a, 'B': b, 'O_4': o4}, ('O_1', 'O_4'),
                       (Bar(ORIGIN, a), Bar(a, b), Bar(o4, b)), (),
                       {'f41': 'O_1', 'f21': 'A', 'f32': 'B', 'f43': 'O_4'},
                       {**angles, 'theta4': 'O_4'})
    b = point_motion(mechanism, motion, 'output', 0.0).place
    joints, slider = {'O_1': ORIGIN, 'A': a, 'B': b}, Block(b, X, is_guided=True)
    if isinstance(mechanism, SliderCrank):
        return Diagram(joints, ('O_1',), (Bar(ORIGIN, a), Bar(a, b)), (slider,),
                       {'f41': 'O_1', 'f21': 'A', 'f32': 'B', 'f43': 'B'}, angles)
    # the slot of the yoke reaches over the whole travel of the block
    travel = [b + (end - mechanism.offset) * Y
              for end in (-1.1 * mechanism.a1, 1.1 * mechanism.a1)]
    low, _, high = sorted((b, *travel), key=lambda place: float(place[1]))
    return Diagram(joints, ('O_1',), (Bar(low, high), Bar(ORIGIN, a)), (slider, Block(a, Y)),
                   {'f41': 'O_1', 'f21': 'A', 'f32': 'A', 'f43': 'B'}, angles)


def _of_bar(mechanism: InvertedSlider, motion: Any, a: Array) -> Diagram:
    """Return the picture of a bar with its block at A, or of a cylinder with its rod."""
    o4 = point_motion(mechanism, motion, 'output', 0.0).place
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


def _places_of(mechanism: Machine, motion: NamedFields) -> dict[str, Array]:
    """Return {joint: place [m]} in one pose; a slide is where its block is."""
    links = mechanism.layout.links
    found = {BASE: _at(mechanism, motion, links[1], 0.0, 0.0)}
    for stage, dyad in zip(mechanism.layout.stages, mechanism.stages):
        for place, name in stage.joints():
            found[name] = _place(mechanism, motion, stage, dyad, place)
    return found


def _place(mechanism: Machine, motion: NamedFields, stage: Stage, dyad: Any, place: str) -> Array:
    """Return where the 'first', 'inner' or 'second' joint of a dyad is [m], shape (2,)."""
    slides = SLIDES[stage.kind]
    if place in slides:
        return _at(mechanism, motion, stage.links[slides[place]], 0.0, 0.0)
    if place == 'inner':
        if stage.kind == 'PRP':
            return _at(mechanism, motion, stage.links[0], 0.0, 0.0)
        return _at(mechanism, motion, stage.links[0], dyad.length_1, 0.0)
    return _at(mechanism, motion, *getattr(dyad, place))


def _at(mechanism: Machine, motion: NamedFields, link: str, along: float, across: float) -> Array:
    """Return the place of a point of a link or the ground."""
    if link == GROUND:
        return np.array((along, across))
    x, y, *_ = point_of(mechanism.link_motion(motion, link), along, across)
    return vector(x, y)


def _of_machine(mechanism: Machine, motion: NamedFields) -> Diagram:
    """Return the picture of one pose: bars from joint to joint of each link, blocks on slides."""
    joints = _places_of(mechanism, motion)
    held = mechanism.layout.ground
    ground = [BASE] if mechanism.input != 'slide' and not held else []
    bars, blocks = [], []
    for stage in mechanism.layout.stages:
        names = dict(stage.joints())
        slides = SLIDES[stage.kind]
        ground += [names[place] for place in ('first', 'second', *['inner'] * (held > 0))
                   if held in stage.ends(place) and place not in slides]
        bars += _bars_of(stage, joints, names)
        blocks += [Block(joints[names[place]], _direction(motion, stage.links[i]),
                         place != 'first' and held in stage.ends(place))
                   for place, i in slides.items()]
    if mechanism.input == 'slide':
        blocks.append(Block(joints[BASE], np.array((1.0, 0.0)), True))
    bars += _bars_of_parents(mechanism, motion) + _third_sides(mechanism, motion, joints)
    return Diagram(joints, tuple(ground), tuple(bars), tuple(blocks),
                   {name: name for name in joints}, _angles(mechanism, joints))


def _direction(motion: NamedFields, link: str) -> Array:
    """Return the direction of a link as a unit vector."""
    if link == GROUND:
        return np.array((1.0, 0.0))
    return vector(getattr(motion, f'cos_{link}'), getattr(motion, f'sin_{link}'))


def _bars_of(stage: Stage, joints: JointPlaces, names: Mapping[str, str]) -> list[Bar]:
    """Return the rods of a dyad, and the bar on which a block slides."""
    ends = {'RRR': (('first', 'inner'), ('second', 'inner')), 'RRP': (('first', 'inner'),),
            'RPR': (('second', 'inner'),), 'RPP': (('second', 'inner'),), 'PRP': ()}[stage.kind]
    return [Bar(joints[names[one]], joints[names[other]]) for one, other in ends
            if stage.links[one == 'second'] != GROUND]


def _bars_of_parents(mechanism: Machine, motion: NamedFields) -> list[Bar]:
    """Return bars from the first joint of a link to the points on it at which dyads hang."""
    found = []
    for dyad in mechanism.stages:
        for place in ('first', 'second'):
            point = getattr(dyad, place)
            if point.link != GROUND and (point.along or point.across):
                start, end = (_at(mechanism, motion, point.link, *at)
                              for at in ((0.0, 0.0), point[1:]))
                found.append(Bar(start, end))
    return found


def _third_sides(mechanism: Machine, motion: NamedFields, joints: JointPlaces) -> list[Bar]:
    """
    Return the sides of links with three joints and more that do not begin at the first joint.

    They close the triangle of such a link, whose other sides are drawn from its first joint.
    """
    layout = mechanism.layout
    on_link: dict[str, list[Array]] = {link: [] for link in layout.links}
    on_link[layout.links[1]].append(joints[BASE])
    for stage, dyad in zip(layout.stages, mechanism.stages):
        names, slides = dict(stage.joints()), SLIDES[stage.kind]
        for i, place in enumerate(('first', 'second')):
            if place not in slides:
                on_link[stage.links[i]].append(joints[names[place]])
            if getattr(dyad, place).link != GROUND:
                on_link[getattr(dyad, place).link].append(_at(mechanism, motion,
                                                              *getattr(dyad, place)))
        for i, link in enumerate(stage.links):
            if 'inner' not in slides or slides['inner'] != 1 - i:
                on_link[link].append(joints[names['inner']])
    found = []
    for ends in [ends for link, ends in on_link.items() if link != GROUND]:
        rest = [end for end in ends[1:] if np.hypot(*(end - ends[0])) > 0.0]
        found += [Bar(one, other) for one, other in zip(rest, rest[1:])
                  if np.hypot(*(one - other)) > 0.0]
    return found


def _angles(mechanism: Machine, joints: JointPlaces) -> dict[str, str]:
    """Return {field of the input's or the output's angle: joint about which its arc is drawn}."""
    places = {link.name: link.first_joint for link in mechanism.LINKS}
    found = {}
    for coordinate in mechanism.DRAWN:
        link = coordinate.position.removeprefix('theta_')
        if coordinate.unit == 'rad':
            found[coordinate.position] = BASE if places[link] == 'O1' else places[link]
    return found
