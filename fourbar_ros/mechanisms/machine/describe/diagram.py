# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The picture of a machine and its velocity and acceleration polygons."""
from __future__ import annotations

from collections.abc import Mapping
from typing import Any, TYPE_CHECKING

from fourbar_ros.mechanisms.machine.structure import BASE, SLIDES, Stage
from fourbar_ros.mechanisms.parts import (
    Bar,
    Block,
    Diagram,
    GROUND,
    NamedFields,
)
from fourbar_ros.mechanisms.points import point_of, vector
from fourbar_ros.numerics.arrays import Array
import numpy as np

if TYPE_CHECKING:
    from fourbar_ros.mechanisms.machine.machine import Machine

JointPlaces = Mapping[str, Array]        # of joints, by name


def places_of(mechanism: Machine, motion: NamedFields) -> dict[str, Array]:
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


def diagram(mechanism: Machine, motion: NamedFields) -> Diagram:
    """Return the picture of one pose: bars from joint to joint of each link, blocks on slides."""
    joints = places_of(mechanism, motion)
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
    bars += _bars_of_parents(mechanism, motion, joints) + _third_sides(mechanism, motion, joints)
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


def _bars_of_parents(mechanism: Machine, motion: NamedFields, joints: JointPlaces) -> list[Bar]:
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
