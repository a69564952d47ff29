# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""A machine from the coordinates of its joints in one pose, as public linkages are given."""
from cmath import phase, rect
from collections.abc import Mapping, Sequence
from dataclasses import replace
import re
from typing import Any, NamedTuple

from fourbar_ros.errors import FourBarError, InvalidParameter, nearest
from fourbar_ros.mechanisms.checks import two_numbers
from fourbar_ros.mechanisms.curves import Point
from fourbar_ros.mechanisms.machine.description import Dyad
from fourbar_ros.mechanisms.machine.machine import Machine
from fourbar_ros.mechanisms.machine.structure import BASE, CRANK_LINK
from fourbar_ros.mechanisms.parts import CROSSED, GROUND, OPEN
from fourbar_ros.mechanisms.points import point_motion
from fourbar_ros.numerics.arguments import finite

# Below this [rad] a dyad lies so flat in a drawing that its mode cannot be read.
FLAT = 0.02
SAME = 1e-6         # the pose of the machine is the drawing to this part of its size


class Drawing(NamedTuple):
    """A machine and its drawing, whose origin is the pivot of the crank."""

    machine: Machine
    start: float                    # angle of the crank in it [rad]
    joints: dict[str, Point]        # of each joint: the point of a link that has it
    ends: dict[str, str]            # {'d.first': joint on which dyad d hangs there}


def read_drawing(points: Mapping[str, Sequence[float]], links: Sequence[Sequence[str]],
                 ground: Sequence[str], slides: Mapping[str, float] | None = None,
                 modes: Mapping[str, int] | None = None, **options: Any) -> Drawing:
    """Return a :class:`Drawing`; arguments and errors as of :meth:`.Machine.from_points`."""
    # Points in [m], shape (2,) each, directions of slides in [rad].
    links, ground = [_names_of(link, points) for link in links], _names_of(ground, points)
    slides, modes, used = slides or {}, modes or {}, {name for link in links for name in link}
    for name in (*used, *ground, *slides, *modes):
        if name not in points:
            raise InvalidParameter('points', name,
                                   f'there is no such point{nearest(name, points)}')
    if unused := [name for name in points if name not in used]:
        raise InvalidParameter('points', unused[0], 'no link has this point')
    for link in links:
        if len(set(link)) < max(2, len(link)):
            raise InvalidParameter('links', tuple(link), 'must be two points or more, each once')
        if len({*ground} & {*link}) > 1:
            raise InvalidParameter('links', '-'.join(link), 'joins two points of the ground, so '
                                   'it does not move: leave it out, the ground is no link here')
    pivots = [name for name in links[0] if name in ground] if links else []
    if len(pivots) != 1:
        raise InvalidParameter('links', tuple(links[0]) if links else None, 'the first must be '
                               'the crank, with one point of the ground')
    places = {name: complex(*two_numbers(f'points.{name}', position))
              for name, position in points.items()}
    drawn = {name: position - places[pivots[0]] for name, position in places.items()}
    slides = {name: finite(f'slides.{name}', angle) for name, angle in slides.items()}
    joints = {name: Point(GROUND, drawn[name].real, drawn[name].imag) for name in ground}

    def add(link: str, names: Sequence[str], first: str, end: str) -> float:
        """Add the points of a link, whose x axis goes from one to another; return its length."""
        axis = drawn[end] - drawn[first]
        length = abs(axis)
        if not length:
            raise InvalidParameter('points', end, f'must not be where {first} is')
        for name in names:
            arm = (length if name == end
                   else axis.conjugate() * (drawn[name] - drawn[first]) / length)
            joints.setdefault(name, Point(link, arm.real, arm.imag))
        return length

    pin = next(name for name in links[0] if name not in pivots)
    add(CRANK_LINK, links[0], pivots[0], pin)
    start, dyads, ends = phase(drawn[pin]), list[Dyad](), dict[str, str]()
    waiting = [list(link) for link in links[1:]]
    if not waiting:
        raise InvalidParameter('links', '-'.join(links[0]), 'is the crank alone: give the links '
                               'that close the linkage too')
    while waiting:
        first, second, inner = _next_dyad(waiting, joints, slides)
        p = next(name for name in first if name in joints)
        rod, names = drawn[inner] - drawn[p], [''.join(first), ''.join(second or [inner, 'block'])]
        q = next(name for name in second if name in joints) if second else inner
        lengths: dict[str, Any] = {'length_1': add(names[0], first, p, inner)}
        if second:
            lengths['length_2'] = add(names[1], second, q, inner)
            # sine of the turn from the first rod to the second, times the length of the first
            side = (rod.conjugate() * (drawn[inner] - drawn[q])).imag / lengths['length_2']
            hangs = joints[p], joints[q]
        else:
            lengths['direction_2'] = slides[inner]
            # how far the rod points along the slide
            side = (rod.conjugate() * rect(1.0, slides[inner])).real
            hangs = joints[p], Point(GROUND, drawn[inner].real, drawn[inner].imag)
        if abs(side) < FLAT * lengths['length_1'] and inner not in modes:
            raise InvalidParameter(f'modes.{inner}', None, 'must be given, 1 or 2: the links at '
                                   f'{inner} lie too flat in the drawing to read it')
        dyads.append(Dyad(inner, 'RRR' if second else 'RRP', *hangs, (names[0], names[1]),
                          mode=modes.get(inner, OPEN if side > 0.0 else CROSSED), **lengths))
        ends |= {f'{inner}.first': p} | ({f'{inner}.second': q} if second else {})
        waiting = [link for link in waiting if link not in (first, second)]
    blocks = [dyad.name for dyad in dyads if dyad.kind == 'RRP']
    for name in slides.keys() - blocks:
        raise InvalidParameter(f'slides.{name}', slides[name], 'no block can slide there: the '
                               'links before it hold the point')
    for name in modes.keys() - {dyad.name for dyad in dyads}:
        raise InvalidParameter(f'modes.{name}', modes[name], 'is the inner pin of no dyad: '
                               f'{", ".join(dyad.name for dyad in dyads)}')
    # The mode of a change point is that of its branch, which may have the other side where it is
    # drawn: of both modes that which has the drawn pose.
    for i, dyad in enumerate(dyads):
        if dyad.name not in modes:
            modes_of_dyad = dyad, replace(dyad, mode=OPEN + CROSSED - dyad.mode)
            as_drawn = next((each for each in modes_of_dyad if _is_as_drawn(
                Machine((*dyads[:i], each)), start, dyad, drawn)), None)
            if as_drawn is None:
                raise InvalidParameter('points', dyad.name,
                                       'the links do not close where it is drawn')
            dyads[i] = as_drawn
    names_of_joints = {BASE: pivots[0], **{f'{dyad.name}_inner': dyad.name for dyad in dyads},
                       **{end.replace('.', '_'): name for end, name in ends.items()}}
    return Drawing(Machine(tuple(dyads), joint_names=names_of_joints, **options), start, joints,
                   ends)


def _names_of(text: Sequence[str], points: Mapping[str, Any]) -> list[str]:
    """Return the names of points in 'AB', 'O2A' or 'O2-A', or in a sequence of names."""
    if not isinstance(text, str) or all(letter in points for letter in text):
        return [*text]
    names = '|'.join(map(re.escape, sorted(points, key=len, reverse=True)))
    return re.findall(f'{names}|[^-]', text) if points else [*text]


def _next_dyad(waiting: Sequence[list[str]], joints: Mapping[str, Point],
               slides: Mapping[str, float]) -> tuple[list[str], list[str] | None, str]:
    """Return the links of the next dyad and its inner pin; None: a block slides there."""
    hanging = [link for link in waiting if sum(name in joints for name in link) == 1]
    for i, first in enumerate(hanging):
        for inner in [name for name in first if name in slides and name not in joints]:
            return first, None, inner
        for second in hanging[i + 1:]:
            for inner in [name for name in first if name in second and name not in joints]:
                return first, second, inner
    raise InvalidParameter('links', ', '.join('-'.join(link) for link in waiting), 'form no dyads '
                           'on the links before them: two links that share a pin, each with one '
                           'joint on those. Drive another link, or look for a joint left out')


def _is_as_drawn(machine: Machine, start: float, dyad: Dyad, drawn: Mapping[str, complex]) -> bool:
    try:
        position = point_motion(machine, machine.motion(start), dyad.links[0],
                                dyad.length_1 or 0.0).place
    except FourBarError:
        return False
    return abs(complex(*position) - drawn[dyad.name]) < SAME * max(map(abs, drawn.values()))
