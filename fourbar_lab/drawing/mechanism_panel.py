# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""A mechanism in a pose on paper: links, bodies, points, joint forces, angles, torque."""
from __future__ import annotations

from collections.abc import Sequence
from math import pi, remainder
from typing import TYPE_CHECKING

from fourbar_lab.drawing.labels import (
    as_mathtext,
    Labels,
    labels_of,
    load_lines,
    motion_lines,
    symbol_of,
)
from fourbar_lab.drawing.sheet import Sheet
from fourbar_ros import Mechanism, point_motion
from fourbar_ros.mechanisms import picture
from fourbar_ros.mechanisms.parts import NamedFields
from fourbar_ros.numerics.arrays import Array
import numpy as np

if TYPE_CHECKING:      # drawings alone need it
    from matplotlib.axes import Axes

LEAST_FORCE = 0.1      # forces smaller than this share of the largest have no arrow
ARROW = 0.4            # length of the longest force over the size of the mechanism
BODY, FORCE, POINT, ANGLE = '0.35', '#1e6b37', '#7a4b00', '0.45'     # dark enough to print in grey


def draw_mechanism(axes: Axes, mechanism: Mechanism, motion: NamedFields, points: picture.Points,
                   paths: Sequence[Array] = (), extra_points: Sequence[Array] = (),
                   labels: Labels | None = None, title: str = '') -> Sheet:
    """Draw a pose with points and paths (n, 2) [m]; the caller adds ``extra_points``, finishes."""
    diagram = picture.diagram_of(mechanism, motion)
    arms = picture.arms_of(mechanism, motion, points)
    joints = np.array(list(diagram.joints.values()))
    every = np.vstack([joints, *paths, *extra_points, *(bar[:2] for bar in diagram.bars),
                       *(arm.end for arm in arms)])
    every = every[np.isfinite(every).all(axis=1)]
    size = max(np.ptp(every, axis=0))
    guides = [diagram.joints[block.joint] + share * size * block.direction
              for block in diagram.blocks if block.is_guided for share in (-0.17, 0.17)]
    sheet = Sheet(axes, np.vstack([every, joints - (0.0, 0.06 * size), *guides]), title)
    for path in paths:
        sheet.curve(path, color=POINT, lw=0.9, zorder=1.5)
    draw_diagram(sheet, diagram, arms)
    middle = joints.mean(axis=0)
    for name, point in (labels or labels_of(diagram)).joints.items():
        sheet.label(name, point, point - middle, 'k', point)
    for arm in arms:
        sheet.label(rf'\mathrm{{{as_mathtext(arm.name)}}}', arm.end, (1.0, 1.0), POINT, arm.end)
    return sheet


def draw_pose(axes: Axes, mechanism: Mechanism, motion: NamedFields, loads: NamedFields | None,
              points: picture.Points, labels: Labels, unit: tuple[str, float], title: str) -> None:
    """
    Draw links, joints, centres of gravity, angles, points; with loads also forces and the drive.

    ``points``: {name: (link, along, across)}; ``unit`` of the scale of lengths: (text, size in
    [m]).
    """
    from matplotlib.patches import Wedge
    diagram = picture.diagram_of(mechanism, motion)
    size = max(np.ptp(np.array(list(diagram.joints.values())), axis=0))
    forces = picture.forces_of(diagram, loads) if loads else []
    longest = max((force.size for force in forces), default=0.0)
    forces = [force._replace(vector=ARROW * size / longest * force.vector) for force in forces
              if force.size > LEAST_FORCE * longest]
    bodies = mechanism.bodies._asdict().items() if mechanism.bodies else ()
    centres = [point_motion(mechanism, motion, link, body.cg_along, body.cg_across).place
               for link, body in bodies if body.mass != 0.0]
    sheet = draw_mechanism(axes, mechanism, motion, points, (), [
        *centres, *(force.point + force.vector for force in forces)], labels, title)
    for centre in centres:      # a quartered circle
        for start, end, colour in ((0.0, 360.0, 'w'), (0.0, 90.0, 'k'), (180.0, 270.0, 'k')):
            axes.add_patch(Wedge(centre, 0.06 * sheet.inch, start, end, fc=colour, ec='k', lw=0.8,
                                 zorder=6.5))
        sheet.pin(centre)
    radius = 0.3 * sheet.inch
    for name, joint in diagram.angles.items():          # arcs of the absolute angles from x
        centre, angle = diagram.joints[joint], remainder(getattr(motion, name), 2.0 * pi)
        arc = centre + radius * _directions(np.linspace(0.0, angle, 40))
        sheet.curve(arc, color=ANGLE, lw=0.9, zorder=1.5)
        sheet.line(centre, centre + (1.5 * radius, 0.0), color=ANGLE, lw=0.7, zorder=1.2)
        sheet.label(symbol_of(name), arc[20], arc[20] - centre, ANGLE)
    torque = getattr(loads, 'driving_torque', 0.0)
    if torque != 0.0:
        _draw_torque(sheet, torque, mechanism, motion, diagram)
    for force in forces:
        tip = force.point + force.vector
        sheet.arrow(force.point, force.vector, FORCE, 1.8)
        sheet.label(labels.forces[force.name], tip, force.vector, FORCE, tip)
    sheet.scale(*unit)
    if forces:
        sheet.scale('N', ARROW * size / longest, 0.5)
    sheet.write(motion_lines(mechanism, motion, unit))
    if loads:
        sheet.write(load_lines(mechanism, loads, labels), columns=2)
    sheet.finish()


# --- strokes -------------------------------------------------------------------------------------

def draw_diagram(sheet: Sheet, diagram: picture.Diagram, arms: Sequence[picture.Arm]) -> None:
    """Draw a mechanism and arms of points, from behind; labels keep off its lines."""
    axes = sheet.axes

    def draw_sign(point: Array, block: picture.Block | None = None) -> None:
        corners, ground = picture.outlines(point, sheet.inch, block)
        axes.fill(*corners.T, fc='0.95' if block else 'w', ec='k', lw=1.2,
                  zorder=4 if block else 1)
        sheet.occupy(np.vstack([corners, corners[:1]]))
        if ground is not None:
            sheet.line(*ground, color='k', lw=1.4, zorder=2 if block else 1)

    for name in diagram.ground:
        draw_sign(diagram.joints[name])
    for start, end, width in diagram.bars:
        sheet.line(start, end, color=BODY, lw=4.5 * width, solid_capstyle='round', zorder=2)
        axes.plot(*zip(start, end), color='0.88', lw=4.5 * width - 1.9, solid_capstyle='round',
                  zorder=3)
    for arm in arms:
        for line in (arm.start, arm.foot), (arm.foot, arm.end):
            sheet.line(*line, color=POINT, lw=0.9, ls=(0, (4, 2)), zorder=4)
        axes.plot(*arm.end, 's', ms=4.5, color=POINT, zorder=7)
    for block in diagram.blocks:
        draw_sign(diagram.joints[block.joint], block)
    for point in diagram.joints.values():
        axes.plot(*point, 'o', ms=5, mfc='w', mec='k', zorder=7)
        sheet.pin(point)


def _draw_torque(sheet: Sheet, torque: float, mechanism: Mechanism, motion: NamedFields,
                 diagram: picture.Diagram) -> None:
    radius, sense, joints = 0.45 * sheet.inch, 1.0 if torque > 0.0 else -1.0, diagram.joints
    centre = joints.get(mechanism.input, np.zeros(2))       # O1, or a joint that moves
    away = centre - np.mean(list(joints.values()), axis=0)
    middle = (np.arctan2(away[1], away[0]) if mechanism.input in joints
              else getattr(motion, mechanism.input_coordinate.position) + pi)
    arc = centre + radius * _directions(middle + sense * np.linspace(-0.35 * pi, 0.35 * pi, 40))
    sheet.curve(arc[:-3], color=FORCE, lw=1.4, zorder=5)
    sheet.arrow(arc[-6], arc[-1] - arc[-6], FORCE, 1.4)
    sheet.label(mechanism.TORQUE, arc[20], arc[20] - centre, FORCE)


def _directions(angles: Array) -> Array:
    """Return unit vectors, shape (n, 2), at angles [rad] from x."""
    return np.stack([np.cos(angles), np.sin(angles)], axis=-1)
