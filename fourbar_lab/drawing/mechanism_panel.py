# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""A mechanism in a pose on paper: links, bodies, points, joint forces, angles, torque."""
from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from math import hypot, pi, remainder
import re
from typing import TYPE_CHECKING

from fourbar_lab.drawing.labels import labels_of, load_lines, motion_lines, symbol_of
from fourbar_lab.drawing.polygons import Arrow, without_repeats
from fourbar_lab.drawing.sheet import Sheet
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.parts import NamedFields
from fourbar_ros.mechanisms.picture import (
    Arm,
    Bar,
    Block,
    Diagram,
    diagram_of,
    forces_of,
    NamedJoint,
    of_kind,
    outlines,
    picture,
    Points,
    Primitive,
)
from fourbar_ros.mechanisms.points import point_motion
from fourbar_ros.numerics.arrays import Array
import numpy as np

if TYPE_CHECKING:      # drawings alone need it
    from matplotlib.axes import Axes

LEAST_FORCE = 0.1      # forces smaller than this share of the largest have no arrow
ARROW = 0.4            # length of the longest force over the size of the mechanism
BODY, FORCE, POINT, ANGLE = '0.35', '#1e6b37', '#7a4b00', '0.45'     # dark enough to print in grey


def renamed(label: str, names: Mapping[str, str]) -> str:
    """Return a label with other letters for points: 'v_{B/A}' by {'A': 'P'} is 'v_{B/P}'."""
    def replace(match: re.Match[str]) -> str:
        letters = [names.get(letter, letter) for letter in match[1].strip('{}').split('/')]
        return f'_{{{"/".join(letters)}}}'
    if label in names:
        return names[label]
    return re.sub(r'_(\{[^}]*\}|\w)', replace, label) if names else label


def sides_of(arrows: Iterable[Arrow], names: Mapping[str, str], least: float) -> list[Arrow]:
    """
    Return the sides of a polygon to draw: with other letters, none twice, all above a length.

    Joints at one place have one letter: of equal labels the first is drawn.
    """
    named: dict[tuple[str, bool], Arrow] = {}
    for arrow in arrows:
        label = renamed(arrow.label, names)
        named.setdefault((label, arrow.is_sum), arrow._replace(label=label))
    return [arrow for arrow in without_repeats(list(named.values()), least)
            if hypot(*arrow.vector) > least]


def draw_mechanism(axes: Axes, mechanism: Mechanism, motion: NamedFields,
                   loads: NamedFields | None = None, points: Points | None = None,
                   names: Mapping[str, str] | None = None, unit: tuple[str, float] = ('m', 1.0),
                   title: str = 'mechanism') -> None:
    """
    Draw links, joints, centres of gravity, angles, points; with loads also forces and the drive.

    ``points``: {name: (link, along, across)}; ``names``: other letters for joints; ``unit`` of the
    scale of lengths: (text, size in [m]).
    """
    names, points = names or {}, points or {}
    diagram = diagram_of(mechanism, motion)
    places = diagram.joints
    size = max(np.ptp(np.array(list(places.values())), axis=0))
    labels, forces = labels_of(diagram), forces_of(diagram, loads) if loads else []
    longest = max((force.size for force in forces), default=0.0)
    forces = [force._replace(vector=ARROW * size / longest * force.vector) for force in forces
              if force.size > LEAST_FORCE * longest]
    centres, parts = _centres(mechanism, motion), picture(mechanism, motion, points)
    arms = of_kind(Arm, parts)
    ends = ([end for bar in diagram.bars for end in bar[:2]]
            + [force.place + force.vector for force in forces])
    below = [at - (0.0, 0.08 * size) for at in places.values()]
    sheet = Sheet(axes, [*ends, *below, *centres.values(), *(arm.end for arm in arms)], title)
    for part in (*_extensions(mechanism, motion, points, centres, diagram.drawn_whole), *parts):
        draw_part(sheet, part)
    for centre in centres.values():
        _draw_centre(sheet, centre)
    torque = getattr(loads, 'driving_torque', 0.0) if loads else 0.0
    angles = _draw_angles(sheet, motion, diagram)
    for force in forces:
        sheet.arrow(force.place, force.vector, FORCE, 1.8)
        sheet.occupy(force.place, force.place + force.vector)
    if torque:
        _draw_torque(sheet, torque, mechanism, motion, places)
    for text, free in angles:
        sheet.label(text, free, ANGLE)
    for name, at in labels.joints.items():
        sheet.label(renamed(name, names), sheet.around(at), 'k')
    _label_points(sheet, arms)
    for force in forces:
        sheet.label(labels.forces[force.name],
                    sheet.around(force.place + force.vector, force.vector), FORCE)
    sheet.scale(*unit)
    if forces:
        sheet.scale('N', ARROW * size / longest, 0.5)
    sheet.write(load_lines(loads, labels, [force.name for force in forces], mechanism.TORQUE)
                if loads else [],
                motion_lines(mechanism, motion, unit))


def draw_plainly(axes: Axes, mechanism: Mechanism, motion: NamedFields, points: Points,
                 paths: Sequence[Array], others: Sequence[Array] = ()) -> Sheet:
    """
    Draw links, joints, points and paths of shape (n, 2) [m], without angles and forces.

    Returns the sheet, which also has room for ``others``: places that the caller draws at.
    """
    diagram, parts = diagram_of(mechanism, motion), picture(mechanism, motion, points)
    arms, places = of_kind(Arm, parts), np.array(list(diagram.joints.values()))
    ends = [*places, *(end for bar in diagram.bars for end in bar[:2]), *(arm.end for arm in arms),
            *np.concatenate([np.empty((0, 2)), *paths]), *others]
    ends = [end for end in ends if np.isfinite(end).all()]
    size = max(np.ptp(np.array(ends), axis=0))
    below = [at - (0.0, 0.06 * size) for at in places]
    guides = [block.place + share * size * np.asarray(block.direction)
              for block in diagram.blocks if block.is_guided for share in (-0.17, 0.17)]
    sheet = Sheet(axes, [*ends, *below, *guides], '')
    for path in paths:
        axes.plot(*path.T, color=POINT, lw=0.9, zorder=1.5)
        sheet.taken.extend(path[np.isfinite(path).all(axis=1)])
    for part in (*_extensions(mechanism, motion, points, {}, diagram.drawn_whole), *parts):
        draw_part(sheet, part)
    for name, at in labels_of(diagram).joints.items():
        sheet.label(name, sheet.around(at), 'k')
    _label_points(sheet, arms)
    sheet.scale('m')
    return sheet


# --- what is drawn -------------------------------------------------------------------------------

def _centres(mechanism: Mechanism, motion: NamedFields) -> dict[str, Array]:
    """Return {link: centre of gravity} of the bodies that have a mass."""
    bodies = mechanism.bodies._asdict().items() if mechanism.bodies else ()
    return {link: point_motion(mechanism, motion, link, body.cg_along, body.cg_across).place
            for link, body in bodies if body.mass}


def _extensions(mechanism: Mechanism, motion: NamedFields, points: Points,
                centres: Collection[str], drawn_whole: Collection[str]) -> Iterator[Bar]:
    """Yield the lines of links beyond their joints, as far as their points and CGs lie along."""
    reach = {link.name: [0.0] for link in mechanism.LINKS}
    for link, along, _ in points.values():
        reach[link].append(along)
    for link in centres:
        reach[link].append(getattr(mechanism.bodies, link).cg_along)
    lengths = dict(zip(mechanism.length_names, mechanism.lengths))
    for link, alongs in reach.items():
        name = mechanism.link(link).length
        length = lengths[name] if name else 0.0
        ends = [point_motion(mechanism, motion, link, along).place
                for along in (0.0, min(alongs), max(alongs), length)]
        if max(alongs) > length and link not in drawn_whole:
            yield Bar(ends[0], ends[2])
        if min(alongs) < 0.0:
            yield Bar(ends[1], ends[0])


# --- strokes -------------------------------------------------------------------------------------

def draw_part(sheet: Sheet, part: Primitive) -> None:
    """Draw one part, and keep labels off its lines."""
    axes = sheet.axes
    if isinstance(part, Bar):
        line, width = (part.start, part.end), 4.5 * part.width
        axes.plot(*zip(*line), color=BODY, lw=width, solid_capstyle='round', zorder=2)
        axes.plot(*zip(*line), color='0.88', lw=width - 1.9, solid_capstyle='round', zorder=3)
        sheet.occupy(*line)
    elif isinstance(part, Arm):
        axes.plot(*zip(part.foot, part.end), color=POINT, lw=0.9, ls=(0, (4, 2)), zorder=4)
        axes.plot(*part.end, 's', ms=4.5, color=POINT, zorder=7)
        sheet.occupy(part.foot, part.end)
    elif isinstance(part, NamedJoint):
        axes.plot(*part.place, 'o', ms=5, mfc='w', mec='k', zorder=7)
    else:
        is_block = isinstance(part, Block)
        corners, ground = outlines(part, sheet.inch)
        axes.fill(*corners.T, fc='0.95' if is_block else 'w', ec='k', lw=1.2,
                  zorder=4 if is_block else 1)
        for one, other in zip(corners, np.roll(corners, 1, axis=0)) if is_block else ():
            sheet.occupy(one, other)
        if ground is not None:
            axes.plot(*ground.T, color='k', lw=1.4, zorder=2 if is_block else 1)
            sheet.occupy(*ground)


def _label_points(sheet: Sheet, arms: Iterable[Arm]) -> None:
    """Write the names of points, upright, beside the ends of their arms."""
    for arm in arms:
        name = arm.name.replace('_', r'\_')
        sheet.label(rf'\mathrm{{{name}}}', sheet.around(arm.end), POINT)


def _draw_centre(sheet: Sheet, at: Array) -> None:
    """Draw the quartered circle of a centre of gravity."""
    from matplotlib.patches import Wedge
    radius = 0.06 * sheet.inch
    for start, colour in ((0.0, 'k'), (90.0, 'w'), (180.0, 'k'), (270.0, 'w')):
        sheet.axes.add_patch(Wedge(at, radius, start, start + 90.0, fc=colour, ec='none',
                                   zorder=6.5))
    sheet.axes.add_patch(Wedge(at, radius, 0.0, 360.0, fc='none', ec='k', lw=0.8, zorder=6.6))
    sheet.occupy(at, at)


def _draw_angles(sheet: Sheet, motion: NamedFields, diagram: Diagram
                 ) -> list[tuple[str, list[Array]]]:
    """Draw the arcs of the absolute angles from x; return [(label, places where it may go)]."""
    labels, radius = [], 0.3 * sheet.inch
    for name, joint in diagram.angles.items():
        at, angle = diagram.joints[joint], remainder(getattr(motion, name), 2.0 * pi)
        arc = at + radius * _directions(np.linspace(0.0, angle, 40))
        sheet.axes.plot(*arc.T, color=ANGLE, lw=0.9, zorder=1.5)
        base = at + np.array([[0.0, 0.0], [1.5 * radius, 0.0]])
        sheet.axes.plot(*base.T, color=ANGLE, lw=0.7, zorder=1.2)
        sheet.occupy(*base)
        for point in arc[::4]:
            sheet.occupy(point, point)
        directions = list(_directions(angle * np.array([0.5, 0.35, 0.65, 0.8, 0.2])))
        places = [at + distance * radius * direction for distance in (1.5, 1.8, 2.1)
                  for direction in directions] + sheet.around(at, directions[0])
        labels.append((symbol_of(name), places))
    return labels


def _draw_torque(sheet: Sheet, torque: float, mechanism: Mechanism, motion: NamedFields,
                 places: Mapping[str, Array]) -> None:
    """Draw the torque as a turning arrow about the driven joint, away from the links."""
    radius, sense = 0.45 * sheet.inch, 1.0 if torque > 0.0 else -1.0
    centre = places.get(mechanism.input, np.zeros(2))       # O1, or a joint that moves
    away = centre - np.mean(list(places.values()), axis=0)
    middle = (np.arctan2(away[1], away[0]) if mechanism.input in places
              else getattr(motion, mechanism.input_coordinate.position) + pi)
    arc = centre + radius * _directions(middle + sense * np.linspace(-0.35 * pi, 0.35 * pi, 40))
    sheet.axes.plot(*arc[:-3].T, color=FORCE, lw=1.4, zorder=5)
    sheet.arrow(arc[-6], arc[-1] - arc[-6], FORCE, 1.4)
    for point in arc[::3]:
        sheet.occupy(point, point)
    sheet.label(mechanism.TORQUE, [centre + 1.4 * (arc[i] - centre)
                                   for i in (12, 6, 18, 24, 0, 30)], FORCE)


def _directions(angles: Array) -> Array:
    """Return unit vectors, shape (n, 2), at angles [rad] from x."""
    return np.stack([np.cos(angles), np.sin(angles)], axis=-1)
