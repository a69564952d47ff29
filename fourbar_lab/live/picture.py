# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""SVG pictures of a mechanism and of its polygons, from the same diagram as print."""
from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from itertools import combinations
from math import hypot, inf, isfinite
from types import MappingProxyType
from typing import NamedTuple

from fourbar_lab.drawing.axis import axis_angle, axis_parts
from fourbar_lab.drawing.collineation import instant_centre
from fourbar_lab.drawing.cycles import bounded, ground_forces, vectors_of
from fourbar_lab.drawing.labels import significant
from fourbar_lab.drawing.mechanism_panel import sides_of
from fourbar_lab.drawing.polygons import acceleration_polygon, Arrow, velocity_polygon
from fourbar_lab.drawing.sheet import nice
from fourbar_lab.live import svg
from fourbar_lab.live.model import PagePose, Shown
from fourbar_lab.live.svg import HEIGHT, MARGIN, STYLE, View, view_of, WIDTH
from fourbar_ros.mechanisms.curves import LinkMotion
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.parts import NamedFields
from fourbar_ros.mechanisms.picture import (
    Arm,
    Diagram,
    diagram_of,
    forces_of,
    of_kind,
    ORIGIN,
    picture,
)
from fourbar_ros.numerics.arrays import Array
import numpy as np

LONGEST_FORCE = 105.0              # [px]
DOWN = np.array([1.0, -1.0])       # pixels count downwards
NEAR = 24.0                        # [px] a joint is caught from so far
MOST_EDGE = 130.0                  # [px] that arrows may take of a side at most
FITS = 4                           # steps to find how much they need
# {name: (its arrows, their unit)}
POLYGONS = {'velocity': (velocity_polygon, 'm/s'),
            'acceleration': (acceleration_polygon, 'm/s²')}


class Layers(NamedTuple):
    """What a picture shows besides the links."""

    curves: bool = True
    forces: bool = True
    centres: bool = False
    axis: bool = False


def mechanism_view(shown: Shown) -> View:
    """
    Return the view in which poses, forces and coupler curves of a cycle have room.

    Arrows keep their length in pixels, so the view fits the places, and edges grow step by step
    until the tips of the arrows lie in them.
    """
    places = [place for motion, _ in shown.poses
              for place in _places(diagram_of(shown.linkage, motion))]
    places += [trace.place for traces in shown.traces.values() for trace in traces]
    if not places:
        return view_of(np.zeros((0, 2)))
    flat = np.concatenate([np.reshape(place, (-1, 2)) for place in places])
    tails, arrows = _force_arrows(shown)
    edges = np.full(4, MARGIN)
    for _ in range(FITS):
        view = view_of(flat, edges)
        tips = np.stack(view.at(tails.T), axis=-1) + arrows
        beyond = np.concatenate((-tips, tips - (WIDTH, HEIGHT))).reshape(2, -1, 2)
        needed = 4.0 + beyond.max(axis=1, initial=-inf).ravel()
        edges = np.minimum(edges + np.maximum(needed, 0.0), MOST_EDGE)
    return view_of(flat, edges)


def _force_arrows(shown: Shown) -> tuple[Array, Array]:
    """Return tails [m] and arrows [px] of the forces of all poses, shape (n, 2) each."""
    ends: list[tuple[Array, Array]] = []
    per_newton = force_scale(shown)
    for motion, loads in shown.poses if per_newton else ():
        assert loads is not None, 'there is a force scale'
        ends += [(force.place, per_newton * DOWN * force.vector)
                 for force in forces_of(diagram_of(shown.linkage, motion), loads)]
    pairs: Array = np.array(ends).reshape(-1, 2, 2)
    tails, arrows = pairs[:, 0], pairs[:, 1]
    fits = np.hypot(*arrows.T) <= 1.2 * LONGEST_FORCE       # a few near toggles leave the picture
    return tails[fits], arrows[fits]


def _places(diagram: Diagram) -> list[Array]:
    """Return the places of joints, ends of bars and blocks [m]."""
    return [*diagram.joints.values(), *(end for bar in diagram.bars for end in bar[:2]),
            *(block.place for block in diagram.blocks)]


def force_scale(shown: Shown) -> float:
    """
    Return the scale [px/N] at which the longest joint force of a cycle has its full length.

    The longest but for 2 %, which may be near toggles; 0.0 without forces.
    """
    names = diagram_of(shown.linkage, shown.poses[0].motion).forces if shown.poses else ()
    sizes = [getattr(loads, name) for _, loads in shown.poses if loads for name in names]
    largest = float(np.quantile(sizes, 0.98)) if sizes else 0.0
    return LONGEST_FORCE / largest if largest > 0.0 and isfinite(largest) else 0.0


def document(content: str) -> str:
    """Return a complete SVG file."""
    return (f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH:g} {HEIGHT:g}" '
            f'width="{WIDTH:g}" height="{HEIGHT:g}"><style>{STYLE}</style>'
            f'<rect width="100%" height="100%" fill="var(--fb-paper,#fff)"/>{content}</svg>')


# --- the mechanism -------------------------------------------------------------------------------

def mechanism_svg(shown: Shown, pose: PagePose, view: View, per_newton: float,
                  layers: Layers = Layers()) -> str:
    """
    Return the SVG content of the mechanism in one pose; ``per_newton``: [px/N] of forces.

    Links first, then letters of the joints, points and forces with labels where there is room.
    """
    (motion, loads), linkage = pose, shown.linkage
    diagram = diagram_of(linkage, motion)
    joints = {name: view.at(place) for name, place in diagram.joints.items()}
    primitives = picture(linkage, motion, shown.points if layers.curves else {})
    parts = [svg.primitive(part, view) for part in primitives]
    letters = {shown.labels.letters.get(name, name): pixel for name, pixel in joints.items()}
    forces = (_forces(shown, diagram, loads, view, per_newton)
              if layers.forces and loads is not None else [])
    room = svg.Room(joints.values(), [(start, vector) for start, vector, _ in forces
                                      if hypot(*vector) <= 2.0 * LONGEST_FORCE])
    middle = np.mean(list(joints.values()), axis=0)
    parts += [room.label('', pixel, tuple(pixel - middle), letter)
              for letter, pixel in letters.items()]
    for arm in of_kind(Arm, primitives):
        tip, name = view.at(arm.end), arm.name
        parts += [svg.circle('point', tip, 4.5), room.label(
            'point', tip, (0.6, -0.8), f'point {name}' if name in letters else name)]
    parts += [svg.arrow('force', *force, room) for force in forces]
    if layers.centres:
        parts += _centres(linkage, motion, view, joints.values())
    if layers.axis and shown.has_axis:
        parts += _axis(linkage, motion, view)
    return f'<g class="fb">{"".join(parts)}</g>'


def joints_of(shown: Shown, pose: PagePose, view: View) -> list[list[float]]:
    """Return the pixels of the joints that move, which can be dragged."""
    diagram = diagram_of(shown.linkage, pose.motion)
    return [[round(float(part), 1) for part in view.at(place)]
            for name, place in diagram.joints.items() if name not in diagram.ground]


def grips_svg(shown: Shown, pose: PagePose, view: View) -> str:
    """Return the SVG content of the grips: one around each joint that moves."""
    return ''.join(svg.circle('grip', (x, y), NEAR) for x, y in joints_of(shown, pose, view))


def traces_svg(shown: Shown, view: View) -> str:
    """Return the SVG content of the coupler curves, which are the same in every pose."""
    return ''.join(['<g class="fb">', *(svg.polyline('trace', trace.place, view)
                                        for traces in shown.traces.values() for trace in traces),
                    '</g>'])


def _forces(shown: Shown, diagram: Diagram, loads: NamedFields, view: View, per_newton: float
            ) -> list[tuple[tuple[float, float], tuple[float, float], str]]:
    """Return (start, vector, label) of the forces at the joints, in pixels."""
    arrows = []
    for force in forces_of(diagram, loads):
        x, y = (per_newton * DOWN * force.vector).tolist()
        label = f'{shown.labels.forces[force.name]} = {significant(force.size)} N'
        arrows.append((view.at(force.place), (x, y), label))
    return arrows


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
    for (i, one), (j, other) in combinations(links, 2):
        assert other is not None, 'the ground is the first'
        x, y = view.at(instant_centre(other, one))
        if 0.0 <= x <= WIDTH and 0.0 <= y <= HEIGHT and all(
                hypot(x - u, y - v) > 6.0 for u, v in joints):
            strokes += [svg.line('centre', (x - 6.0, y - 6.0), (x + 6.0, y + 6.0)),
                        svg.line('centre', (x - 6.0, y + 6.0), (x + 6.0, y - 6.0)),
                        svg.text('centre', (x + 9.0, y + 18.0), f'P_{{{i}{j}}}')]
    return strokes


def _axis(linkage: Mechanism, motion: NamedFields, view: View) -> list[str]:
    """Return the collineation axis, its poles and the lines through them, as far as in view."""
    lines, poles = axis_parts(linkage, motion, np.array(view.place(0.0, HEIGHT)),
                              np.array(view.place(WIDTH, 0.0)))
    strokes = [svg.line('sum' if name == 'axis' else 'through', *map(view.at, ends))
               for name, ends in lines.items()]
    for letter, place in poles.items():
        x, y = view.at(place)
        strokes += [svg.circle('sum', (x, y), 4.0), svg.text('sum', (x + 9.0, y - 9.0), letter)]
    angle = axis_angle(linkage).of(motion, None)
    return [*strokes, svg.text('sum', (WIDTH - 8.0, 18.0),
                               f'axis at {angle:.2f}\N{DEGREE SIGN} to the coupler', 'end')]


# --- polygons ------------------------------------------------------------------------------------

Drawn = Callable[[float, PagePose], str]        # of an input in the unit of the page, and its pose


def polygon_drawing(shown: Shown, name: str) -> Drawn:
    """Return how the velocity or acceleration polygon is drawn, at one scale for all poses."""
    polygon, unit = POLYGONS[name]
    view = polygon_view([polygon(shown.linkage, pose.motion) for pose in shown.poses])
    return lambda at, pose: polygon_svg(polygon(shown.linkage, pose.motion), view, unit,
                                        shown.labels.letters)


def force_drawing(shown: Shown) -> tuple[str, Drawn]:
    """
    Return the polar diagram of the shaking force and the forces on the ground: paths, and a pose.

    Each force is an arrow from the pole o, whose tip moves on its path; a circle has the scale.
    """
    names = {'shaking_force': 'shaking force'} | ground_forces(shown.linkage)
    paths = [bounded(vectors_of(cycle.loads, name)) for cycle in shown.cycles for name in names]
    view = view_of(np.concatenate([np.zeros((1, 2)), *paths]))
    pole, radius = view.at((0.0, 0.0)), nice(0.4 * min(WIDTH, HEIGHT) / view.scale)
    under = ['<g class="fb">', svg.circle('through', pole, round(radius * view.scale, 1)),
             svg.text('', (pole[0] + 4.0, pole[1] - radius * view.scale - 4.0), f'{radius:g} N'),
             *(svg.polyline('trace', path, view) for path in paths), '</g>']

    def draw(at: float, pose: PagePose) -> str:
        return polygon_svg([Arrow(ORIGIN, vectors_of(pose.loads, name), text,
                                  name == 'shaking_force') for name, text in names.items()],
                           view, 'N')
    return ''.join(under), draw


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
    pole = view.at((0.0, 0.0))
    room = svg.Room([pole])
    parts = [svg.arrow('sum' if arrow.is_sum else 'part', view.at(arrow.start),
                       (view.scale * arrow.vector[0], -view.scale * arrow.vector[1]),
                       f'{arrow.label} = {significant(hypot(*arrow.vector))} {unit}', room)
             for arrow in sides_of(arrows, letters, 1.0 / view.scale)]
    parts += [svg.circle('pin', pole, 4.0),
              room.label('', pole, (-0.7, 0.7), 'o')]
    return f'<g class="fb">{"".join(parts)}</g>'
