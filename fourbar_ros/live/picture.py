# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""SVG pictures of a mechanism and of its polygons, from the same diagram as print."""
from __future__ import annotations

from collections.abc import Iterable, Mapping
from math import hypot, isfinite
from types import MappingProxyType
from typing import Any, NamedTuple

from fourbar_ros.live import strokes
from fourbar_ros.live.model import Shown
from fourbar_ros.live.strokes import HEIGHT, STYLE, View, view_of, WIDTH
from fourbar_ros.mechanisms.parts import Arrow, Diagram, without_repeats
from fourbar_ros.mechanisms.points import instant_centre, link_motion, LinkMotion, point_motion
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.report.mechanism_panel import renamed
from fourbar_ros.report.significant import significant
import numpy as np

LONGEST_FORCE = 105.0              # [px]


class Layers(NamedTuple):
    """What a picture shows besides the links."""

    curves: bool = True
    forces: bool = True
    centres: bool = False


def mechanism_view(*several: Shown) -> View:
    """Return the view in which all poses and coupler curves of what is shown have room."""
    places = [place for shown in several for motion, _ in shown.poses
              for place in _places(shown.linkage.diagram(motion))]
    places += [trace.place for shown in several for traces in shown.traces.values()
               for trace in traces]
    return view_of(np.concatenate([np.reshape(place, (-1, 2)) for place in places])
                   if places else np.zeros((0, 2)))


def _places(diagram: Diagram) -> list[Array]:
    return [*diagram.joints.values(), *(end for bar in diagram.bars for end in bar[:2]),
            *(block.place for block in diagram.blocks)]


def force_scale(shown: Shown) -> float:
    """Return [px/N] at which the longest joint force of a cycle has its full length."""
    names = shown.linkage.diagram(shown.poses[0][0]).forces if shown.poses else ()
    sizes = [getattr(loads, name) for _, loads in shown.poses if loads for name in names]
    largest = float(np.quantile(sizes, 0.98)) if sizes else 0.0
    return LONGEST_FORCE / largest if largest > 0.0 and isfinite(largest) else 0.0


def document(content: str, width: float = WIDTH, height: float = HEIGHT) -> str:
    """Return a complete SVG file."""
    return (f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:g} {height:g}" '
            f'width="{width:g}" height="{height:g}"><style>{STYLE}</style>'
            f'<rect width="100%" height="100%" fill="var(--fb-paper,#fff)"/>{content}</svg>')


# --- the mechanism -------------------------------------------------------------------------------

def mechanism_svg(shown: Shown, motion: Any, loads: Any, view: View, per_newton: float,
                  layers: Layers = Layers()) -> str:
    """Return the SVG content of the mechanism in one pose; ``per_newton``: [px/N] of forces."""
    linkage, diagram = shown.linkage, shown.linkage.diagram(motion)
    at = {name: view.at(place) for name, place in diagram.joints.items()}
    parts = [strokes.ground(at[name]) for name in diagram.ground]
    arms = {name: [view.at(point_motion(linkage, motion, link, *place).place)
                   for place in ((0.0,), (along,), (along, across))]
            for name, (link, along, across) in shown.points.items()}
    if layers.curves:
        parts += [strokes.line('arm', *ends) for arm in arms.values()
                  for ends in zip(arm, arm[1:])]
    parts += _links(diagram, view)
    letters = {strokes.plain(shown.labels.letters.get(name, name)): place
               for name, place in at.items()}
    parts += [strokes.text('', strokes.outside(letter, place, at.values()), letter)
              for letter, place in letters.items()]
    for name, (*_, tip) in arms.items() if layers.curves else ():
        parts += [strokes.circle('point', tip, 4.5),
                  strokes.text('point', (tip[0] + 9.0, tip[1] - 8.0), name)]
    if layers.forces and loads is not None:
        parts += _forces(shown, diagram, loads, (at, per_newton))
    if layers.centres:
        parts += _centres(linkage, motion, view, at.values())
    return f'<g class="fb">{"".join(parts)}</g>'


def _links(diagram: Diagram, view: View) -> list[str]:
    """Return bars, blocks and pins."""
    parts = [strokes.line(kind, view.at(bar.start), view.at(bar.end))
             for bar in diagram.bars for kind in ('bar', 'core')]
    parts += [strokes.block(view.at(block.place), block.direction, block.is_guided)
              for block in diagram.blocks]
    return parts + [strokes.circle('pin', view.at(place), 5.0)
                    for place in diagram.joints.values()]


def ghost_svg(shown: Shown, motion: Any, view: View) -> str:
    """Return the SVG content of a mechanism to compare with, pale and without letters."""
    links = ''.join(_links(shown.linkage.diagram(motion), view))
    return f'<g class="fb"><g class="ghost">{links}</g></g>'


def traces_svg(shown: Shown, view: View) -> str:
    """Return the SVG content of the coupler curves, which are the same in every pose."""
    return ''.join(['<g class="fb">', *(strokes.polyline('trace', trace.place, view)
                                        for traces in shown.traces.values() for trace in traces),
                    '</g>'])


def _forces(shown: Shown, diagram: Diagram, loads: Any,
            view: tuple[Mapping[str, tuple[float, float]], float]) -> list[str]:
    """Return arrows of the forces at the joints; ``view``: their pixels, and [px/N]."""
    at, per_newton = view
    found: list[str] = []
    taken: list[tuple[float, float]] = []
    for name, joint in diagram.forces.items():
        force = getattr(loads, f'{name}_x'), getattr(loads, f'{name}_y')
        label = f'{strokes.plain(shown.labels.forces[name])} = '\
                f'{significant(getattr(loads, name))} N'
        pixels = per_newton * force[0], -per_newton * force[1]
        found.append(strokes.arrow('force', at[joint], pixels, label, taken))
    return found


def _centres(linkage: Any, motion: Any, view: View,
             joints: Iterable[tuple[float, float]]) -> list[str]:
    """Return crosses at the instant centres that are no joints, as far as they are in view."""
    links = [(i + 2, link_motion(linkage, motion, link.name))
             for i, link in enumerate(linkage.LINKS)]
    pairs: list[tuple[int, int, LinkMotion | None, LinkMotion]]
    pairs = [(1, j, None, link) for j, link in links]
    pairs += [(i, j, one, other) for n, (i, one) in enumerate(links)
              for j, other in links[n + 1:]]
    found = []
    for i, j, one, other in pairs:
        x, y = view.at(instant_centre(other, one))
        if 0.0 <= x <= WIDTH and 0.0 <= y <= HEIGHT and all(
                hypot(x - u, y - v) > 6.0 for u, v in joints):
            found += [strokes.line('centre', (x - 6.0, y - 6.0), (x + 6.0, y + 6.0)),
                      strokes.line('centre', (x - 6.0, y + 6.0), (x + 6.0, y - 6.0)),
                      strokes.text('centre', (x + 9.0, y + 18.0), f'P{i}{j}')]
    return found


# --- polygons ------------------------------------------------------------------------------------

def polygon_view(polygons: Iterable[list[Arrow]]) -> View:
    """Return the view in which all these polygons have room."""
    ends = [end for arrows in polygons for arrow in arrows
            for end in (arrow.start, arrow.start + arrow.vector)]
    return view_of(np.array([(0.0, 0.0), *ends]))


def polygon_svg(arrows: list[Arrow], view: View, unit: str,
                letters: Mapping[str, str] = MappingProxyType({})) -> str:
    """Return the SVG content of a velocity or acceleration polygon; the pole is o."""
    pole = view.at((0.0, 0.0))
    taken: list[tuple[float, float]] = []
    parts = [strokes.arrow('sum' if arrow.is_sum else 'part', view.at(arrow.start),
                           (view.scale * arrow.vector[0], -view.scale * arrow.vector[1]),
                           f'{strokes.plain(renamed(arrow.label, letters))} = '
                           f'{significant(hypot(*arrow.vector))} {unit}', taken)
             for arrow in without_repeats(arrows, 1.0 / view.scale)]
    parts += [strokes.circle('pin', pole, 4.0),
              strokes.text('', (pole[0] - 16.0, pole[1] + 18.0), 'o')]
    return f'<g class="fb">{"".join(parts)}</g>'
