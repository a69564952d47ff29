# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""SVG pictures of a mechanism and of its polygons, from the same diagram as print."""
from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Set
from itertools import combinations
from math import hypot, isfinite
from types import MappingProxyType

from fourbar_lab.drawing.axis import axis_angle, axis_parts
from fourbar_lab.drawing.collineation import instant_centre
from fourbar_lab.drawing.labels import significant
from fourbar_lab.drawing.polygons import acceleration_polygon, Arrow, sides_of, velocity_polygon
from fourbar_lab.drawing.poses import DrawnPose
from fourbar_lab.live import svg
from fourbar_lab.live.model import Shown
from fourbar_lab.live.svg import HEIGHT, PRINTED_STYLE, View, view_of, WIDTH
from fourbar_ros.mechanisms.curves import LinkMotion
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.parts import NamedFields
from fourbar_ros.mechanisms.picture import Arm, diagram_of, forces_of, of_kind, picture
import numpy as np

LONGEST = 0.3                      # of the longest force, over the size of the mechanism
NEAR = 24.0                        # [px] a joint is caught from so far
# what a picture may show besides the links, and what it shows at first
LAYERS = {'curves': 'coupler curves', 'forces': 'forces', 'centres': 'instant centres',
          'axis': 'collineation axis'}
USUAL = frozenset({'curves', 'forces'})
# {name: (its arrows, their unit)}
POLYGONS = {'velocity': (velocity_polygon, 'm/s'),
            'acceleration': (acceleration_polygon, 'm/s²')}


def mechanism_view(shown: Shown) -> View:
    """
    Return the view in which poses, forces and coupler curves of a cycle have room.

    The longest force has its full length; a few near toggles are longer and may leave the picture.
    """
    diagrams = [diagram_of(shown.linkage, pose.motion) for pose in shown.poses]
    joints = np.reshape([point for diagram in diagrams for point in diagram.joints.values()],
                        (-1, 2))
    ends = [end for diagram in diagrams for end in (
        *(end for bar in diagram.bars for end in bar[:2]),
        *(block.point for block in diagram.blocks))]
    forces = [force for diagram, pose in zip(diagrams, shown.poses) if pose.loads
              for force in forces_of(diagram, pose.loads)]
    longest = float(np.quantile([force.size for force in forces], 0.98)) if forces else 0.0
    per_newton = 0.0
    if longest > 0.0 and isfinite(longest):
        per_newton = LONGEST * float(max(np.ptp(joints, axis=0))) / longest
        ends += [force.point + per_newton * force.vector for force in forces
                 if force.size <= 1.2 * longest]
    return view_of(np.vstack([joints, *ends, *shown.traces]))._replace(per_newton=per_newton)


def document(content: str) -> str:
    """Return a complete SVG file, in the colours of print."""
    return (f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH:g} {HEIGHT:g}" '
            f'width="{WIDTH:g}" height="{HEIGHT:g}"><style>{PRINTED_STYLE}</style>'
            f'<rect width="100%" height="100%" fill="#fff"/>{content}</svg>')


# --- the mechanism -------------------------------------------------------------------------------

def mechanism_svg(shown: Shown, pose: DrawnPose, view: View, layers: Set[str] = USUAL) -> str:
    """
    Return the SVG content of the mechanism in one pose; ``layers``: names of :data:`LAYERS`.

    Links first, then letters of the joints, points and forces with labels where there is room.
    """
    (_, motion, loads), linkage = pose, shown.linkage
    diagram = diagram_of(linkage, motion)
    joints = {name: view.pixel(point) for name, point in diagram.joints.items()}
    primitives = picture(linkage, motion, shown.points if 'curves' in layers else {})
    parts = [svg.primitive(part, view) for part in primitives]
    letters = {shown.labels.letters.get(name, name): pixel for name, pixel in joints.items()}
    forces = [(view.pixel(force.point), view.length(view.per_newton * force.vector),
               f'{shown.labels.forces[force.name]} = {significant(force.size)} N')
              for force in (forces_of(diagram, loads) if 'forces' in layers and loads else [])]
    room = svg.Room(joints.values(), [(start, vector) for start, vector, _ in forces
                                      if hypot(*vector) <= WIDTH])
    middle = np.mean(list(joints.values()), axis=0)
    parts += [room.label('', pixel, tuple(pixel - middle), letter)
              for letter, pixel in letters.items()]
    for arm in of_kind(Arm, primitives):
        tip, name = view.pixel(arm.end), arm.name
        parts += [svg.circle('point', tip, 4.5), room.label(
            'point', tip, (0.6, -0.8), f'point {name}' if name in letters else name)]
    parts += [svg.arrow('force', *force, room) for force in forces]
    if 'centres' in layers:
        parts += _centres(linkage, motion, view, joints.values())
    if 'axis' in layers and shown.has_axis:
        parts += _axis(linkage, motion, view)
    return f'<g class="fb">{"".join(parts)}</g>'


def joints_of(shown: Shown, pose: DrawnPose, view: View) -> list[list[float]]:
    """Return the pixels of the joints that move, which can be dragged."""
    diagram = diagram_of(shown.linkage, pose.motion)
    return [[round(float(part), 1) for part in view.pixel(point)]
            for name, point in diagram.joints.items() if name not in diagram.ground]


def grips_svg(shown: Shown, pose: DrawnPose, view: View) -> str:
    """Return the SVG content of the grips: one around each joint that moves."""
    return ''.join(svg.circle('grip', (x, y), NEAR) for x, y in joints_of(shown, pose, view))


def traces_svg(shown: Shown, view: View) -> str:
    """Return the SVG content of the coupler curves, which are the same in every pose."""
    traces = ''.join([svg.polyline('trace', trace, view) for trace in shown.traces])
    return f'<g class="fb">{traces}</g>'


def _centres(linkage: Mechanism, motion: NamedFields, view: View,
             joints: Iterable[tuple[float, float]]) -> list[str]:
    """
    Return a cross and P_ij at each instant centre that is in view and no joint.

    Centres are of pairs of links; link 1 is the ground, the others are numbered from 2.
    """
    links: list[tuple[int, LinkMotion | None]] = [(1, None)]
    links += [(i, linkage.link_motion(motion, link.name))
              for i, link in enumerate(linkage.LINKS, 2)]
    strokes = []
    for (i, first), (j, second) in combinations(links, 2):
        assert second is not None, 'the ground is the first'
        x, y = view.pixel(instant_centre(second, first))
        if 0.0 <= x <= WIDTH and 0.0 <= y <= HEIGHT and all(
                hypot(x - u, y - v) > 6.0 for u, v in joints):
            strokes += [svg.line('centre', (x - 6.0, y - 6.0), (x + 6.0, y + 6.0)),
                        svg.line('centre', (x - 6.0, y + 6.0), (x + 6.0, y - 6.0)),
                        svg.text('centre', (x + 9.0, y + 18.0), f'P_{{{i}{j}}}')]
    return strokes


def _axis(linkage: Mechanism, motion: NamedFields, view: View) -> list[str]:
    """Return the collineation axis, its poles and the lines through them, as far as in view."""
    lines, poles = axis_parts(linkage, motion, np.array(view.point(0.0, HEIGHT)),
                              np.array(view.point(WIDTH, 0.0)))
    strokes = [svg.line('sum' if name == 'axis' else 'through', *map(view.pixel, ends))
               for name, ends in lines.items()]
    for letter, point in poles.items():
        x, y = view.pixel(point)
        strokes += [svg.circle('sum', (x, y), 4.0), svg.text('sum', (x + 9.0, y - 9.0), letter)]
    angle = axis_angle(linkage, motion)
    return [*strokes, svg.text('sum', (WIDTH - 8.0, 18.0),
                               f'axis at {angle:.2f}\N{DEGREE SIGN} to the coupler', 'end')]


# --- polygons ------------------------------------------------------------------------------------

Drawn = Callable[[float, DrawnPose], str]       # of an input in the page's unit, and its pose


def polygon_drawing(shown: Shown, name: str) -> Drawn:
    """Return how the velocity or acceleration polygon is drawn, at one scale for all poses."""
    polygon, unit = POLYGONS[name]
    view = polygon_view([polygon(shown.linkage, pose.motion) for pose in shown.poses])
    return lambda _, pose: polygon_svg(polygon(shown.linkage, pose.motion), view, unit,
                                       shown.labels.letters)


def polygon_view(polygons: Iterable[list[Arrow]]) -> View:
    """Return the view in which all these polygons have room."""
    ends = [end for arrows in polygons for arrow in arrows
            for end in (arrow.start, arrow.start + arrow.vector)]
    return view_of(np.array([(0.0, 0.0), *ends]))


def polygon_svg(arrows: list[Arrow], view: View, unit: str,
                letters: Mapping[str, str] = MappingProxyType({})) -> str:
    """
    Return the SVG content of a velocity or acceleration polygon, with magnitudes; the pole is o.

    ``letters``: {name of a joint: its letter} for the labels of arrows.
    """
    pole = view.pixel((0.0, 0.0))
    room = svg.Room([pole])
    parts = [svg.arrow('sum' if arrow.is_sum else 'part', view.pixel(arrow.start),
                       view.length(arrow.vector),
                       f'{arrow.label} = {significant(hypot(*arrow.vector))} {unit}', room)
             for arrow in sides_of(arrows, letters, 1.0 / view.scale)]
    parts += [svg.circle('pin', pole, 4.0),
              room.label('', pole, (-0.7, 0.7), 'o')]
    return f'<g class="fb">{"".join(parts)}</g>'
