# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The picture of a mechanism in a pose: links, bodies, points, forces at the joints, angles, torque.

To scale.
"""
from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from math import pi, remainder
import re
from typing import Any, TYPE_CHECKING

from fourbar_ros.mechanics.moving_frames import turned
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.parts import Diagram
from fourbar_ros.mechanisms.points import point_motion
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.report.joint_labels import labels_of
from fourbar_ros.report.sheet import Sheet
from fourbar_ros.report.significant import load_lines, motion_lines, symbol_of
import numpy as np

if TYPE_CHECKING:      # drawings alone need it
    from matplotlib.axes import Axes

Points = Mapping[str, tuple[str, float, float]]      # {name: (link, along, across)}

LEAST_FORCE = 0.1      # forces shorter than this share of the longest have no arrow
ARROW = 0.4            # length of the longest force over the size of the mechanism
# dark enough for print in grey
BODY, FORCE, POINT, ANGLE = '0.35', '#1e6b37', '#7a4b00', '0.45'


def renamed(label: str, names: Mapping[str, str]) -> str:
    """
    Return a label with the letters of points as another document has them.

    ``names`` maps ours to its.
    """
    def replace(match: re.Match[str]) -> str:
        return '_' + '{' + '/'.join(names.get(part, part)
                                    for part in match[1].strip('{}').split('/')) + '}'
    if label in names:
        return names[label]
    return re.sub(r'_(\{[^}]*\}|\w)', replace, label) if names else label


def draw_mechanism(axes: Axes, mechanism: Mechanism, motion: Any, loads: Any = None,
                   points: Points | None = None, names: Mapping[str, str] | None = None,
                   unit: tuple[str, float] = ('m', 1.0), title: str = 'mechanism') -> None:
    """
    Draw links and joints, centres of gravity, points.

    With loads also the force on a link at every joint, and the drive.

    Parameters
    ----------
    axes : matplotlib axes
    points : dict, optional
        {name: (link, along, across)}, drawn with what holds them.
    names : dict, optional
        Other letters for joints.
    unit : (str, float)
        Unit of the scale of lengths, and its size [m].

    """
    names, points = names or {}, points or {}
    diagram = mechanism.diagram(motion)
    places = diagram.joints
    size = max(np.ptp(np.array(list(places.values())), axis=0))
    labels, forces = labels_of(diagram), _forces(diagram, loads, ARROW * size) if loads else {}
    centres = _centres(mechanism, motion)
    arms = _arms(mechanism, motion, points)
    ends = ([end for bar in diagram.bars for end in bar[:2]]
            + [places[at] + force for at, force in forces.values()])
    below = [at - (0.0, 0.08 * size) for at in places.values()]
    sheet = Sheet(axes, [*ends, *below, *centres.values(), *(arm[-1] for arm in arms.values())],
                  title)
    for start, end in _extensions(mechanism, motion, points, centres, diagram.drawn_whole):
        _link(sheet, start, end, 1.0)
    for bar in diagram.bars:
        _link(sheet, *bar)
    for arm in arms.values():
        axes.plot(*np.transpose(arm), color=POINT, lw=0.9, ls=(0, (4, 2)), zorder=4)
    for block in diagram.blocks:
        _draw_block(sheet, *block)
    _draw_joints(sheet, places, diagram.ground)
    for centre in centres.values():
        _draw_centre(sheet, centre)
    _draw_points(sheet, arms)
    torque = getattr(loads, 'driving_torque', 0.0) if loads else 0.0
    angles = _draw_angles(sheet, motion, diagram)
    for at, force in forces.values():
        sheet.arrow(places[at], force, FORCE, 1.8)
        sheet.occupy(places[at], places[at] + force)
    if torque:
        _draw_torque(sheet, torque, getattr(motion, mechanism.input_coordinate.position))
    for text, free in angles:
        sheet.label(text, free, ANGLE)
    for name, at in labels.joints.items():
        sheet.label(renamed(name, names), sheet.around(at), 'k')
    for name, arm in arms.items():
        sheet.label(rf'\mathrm{{{name}}}', sheet.around(arm[-1]), POINT)
    for name, (at, force) in forces.items():
        tip = places[at] + force
        sheet.label(labels.forces[name], sheet.around(tip, force), FORCE)
    sheet.scale(*unit)
    if forces:
        sheet.scale('N', ARROW * size / max(getattr(loads, name) for name in diagram.forces), 0.5)
    sheet.write(load_lines(loads, labels, forces) if loads else [],
                motion_lines(mechanism, motion, unit))


# --- what is drawn -------------------------------------------------------------------------------

def _forces(diagram: Diagram, loads: Any, length: float) -> dict[str, tuple[str, Array]]:
    """Return {name: (joint, arrow)} of the forces that can be seen, the longest of this length."""
    longest = max(getattr(loads, name) for name in diagram.forces)
    return {name: (at, length / longest * np.array([getattr(loads, f'{name}_x'),
                                                    getattr(loads, f'{name}_y')]))
            for name, at in diagram.forces.items() if getattr(loads, name) > LEAST_FORCE * longest}


def _centres(mechanism: Mechanism, motion: Any) -> dict[str, Array]:
    """Return {link: centre of gravity} of the bodies that have a mass."""
    bodies = mechanism.bodies._asdict().items() if mechanism.bodies else ()
    return {link: point_motion(mechanism, motion, link, body.cg_along, body.cg_across).place
            for link, body in bodies if body.mass}


def _arms(mechanism: Mechanism, motion: Any, points: Points) -> dict[str, list[Array]]:
    """Return {name: line from the link to a point}."""
    return {name: [point_motion(mechanism, motion, link, along).place,
                   point_motion(mechanism, motion, link, along, across).place]
            for name, (link, along, across) in points.items()}


def _extensions(mechanism: Mechanism, motion: Any, points: Points, centres: Collection[str],
                drawn_whole: Collection[str]) -> Iterator[tuple[Array, Array]]:
    """Return lines of links that extend beyond their joints, to points and CGs."""
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
            yield ends[0], ends[2]
        if min(alongs) < 0.0:
            yield ends[1], ends[0]


# --- strokes -------------------------------------------------------------------------------------

def _link(sheet: Sheet, start: Array, end: Array, width: float) -> None:
    sheet.axes.plot(*zip(start, end), color=BODY, lw=4.5 * width, solid_capstyle='round', zorder=2)
    sheet.axes.plot(*zip(start, end), color='0.88', lw=4.5 * width - 1.9, solid_capstyle='round',
                    zorder=3)
    sheet.occupy(start, end)


def _draw_block(sheet: Sheet, at: Array, direction: Array, is_guided: bool) -> None:
    half = 0.2 * sheet.inch
    corners = [at + half * (a * direction + 0.55 * b * turned(1.0, direction))
               for a, b in ((1, 1), (1, -1), (-1, -1), (-1, 1))]
    sheet.axes.fill(*zip(*corners), fc='0.95', ec='k', lw=1.2, zorder=4)
    for one, other in zip(corners, corners[1:] + corners[:1]):
        sheet.occupy(one, other)
    if is_guided:
        below = -0.11 * turned(1.0, direction)
        sides = at + sheet.inch * np.array([below - 0.7 * direction, below + 0.7 * direction])
        sheet.axes.plot(*sides.T, color='k', lw=1.4)
        sheet.occupy(*sides)


def _draw_joints(sheet: Sheet, places: Mapping[str, Array], ground: Collection[str]) -> None:
    for name, at in places.items():
        if name in ground:
            half = 0.12 * sheet.inch
            sheet.axes.fill(at[0] + half * np.array([0.0, -1.0, 1.0]),
                            at[1] + half * np.array([0.0, -1.6, -1.6]), fc='w',
                            ec='k', lw=1.1, zorder=1)
            sheet.axes.plot(at[0] + half * np.array([-1.6, 1.6]), [at[1] - 1.6 * half] * 2,
                            color='k', lw=1.4, zorder=1)
            sheet.occupy(at - (0.1 * sheet.inch, 0.19 * sheet.inch),
                         at + sheet.inch * np.array([0.1, -0.19]))
        sheet.axes.plot(*at, 'o', ms=5, mfc='w', mec='k', zorder=7)


def _draw_points(sheet: Sheet, arms: Mapping[str, list[Array]]) -> None:
    """Mark the points at the ends of the lines that hold them."""
    for arm in arms.values():
        sheet.axes.plot(*arm[-1], 's', ms=4.5, color=POINT, zorder=7)
        sheet.occupy(arm[-1], arm[-1])


def _draw_centre(sheet: Sheet, at: Array) -> None:
    """Draw the quartered circle of a centre of gravity."""
    from matplotlib.patches import Wedge
    radius = 0.06 * sheet.inch
    for start in (0.0, 180.0):
        sheet.axes.add_patch(Wedge(at, radius, start, start + 90.0, fc='k', ec='none', zorder=6.5))
        sheet.axes.add_patch(Wedge(at, radius, start + 90.0, start + 180.0, fc='w', ec='none',
                                   zorder=6.5))
    sheet.axes.add_patch(Wedge(at, radius, 0.0, 360.0, fc='none', ec='k', lw=0.8, zorder=6.6))
    sheet.occupy(at, at)


def _draw_angles(sheet: Sheet, motion: Any, diagram: Diagram) -> list[tuple[str, list[Array]]]:
    """Draw the arcs of the absolute angles from x; return [(label, places for it)]."""
    found, radius = [], 0.3 * sheet.inch
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
        places = [at + out * radius * direction for out in (1.5, 1.8, 2.1)
                  for direction in directions]
        found.append((symbol_of(name), places))
    return found


def _draw_torque(sheet: Sheet, torque: float, theta1: float) -> None:
    """Draw the torque on the crank as a turning arrow about O1, opposite of the crank."""
    radius, sense = 0.45 * sheet.inch, 1.0 if torque > 0.0 else -1.0
    middle = theta1 + pi
    arc = radius * _directions(middle + sense * np.linspace(-0.35 * pi, 0.35 * pi, 40))
    sheet.axes.plot(*arc[:-3].T, color=FORCE, lw=1.4, zorder=5)
    sheet.arrow(arc[-6], arc[-1] - arc[-6], FORCE, 1.4)
    for point in arc[::3]:
        sheet.occupy(point, point)
    sheet.label('T_{41}', [1.4 * arc[i] for i in (12, 6, 18, 24, 0, 30)], FORCE)


def _directions(angles: Array) -> Array:
    """Return unit vectors of shape (n, 2)."""
    return np.stack([np.cos(angles), np.sin(angles)], axis=-1)
