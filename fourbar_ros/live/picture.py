# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
SVG pictures of a mechanism and of its polygons, from the same diagram as print.

Colours are CSS variables with the ones of print as fallback, so that a page can be light or dark
and a saved file is complete.
"""
from __future__ import annotations

from collections.abc import Iterable, Mapping
from html import escape
from math import hypot, isfinite
import re
from typing import Any, NamedTuple

from fourbar_ros.live.model import Shown
from fourbar_ros.mechanisms.parts import Arrow, Diagram, without_repeats
from fourbar_ros.mechanisms.points import instant_centre, link_motion, point_motion
from fourbar_ros.report.mechanism_panel import significant
import numpy as np

WIDTH, HEIGHT = 600.0, 420.0       # [px] of a picture
MARGIN = 44.0                      # [px]
LONGEST_FORCE = 105.0              # [px]
LINE = 17.0                        # [px] between labels
LEAST = 4.0                        # [px] shorter arrows are left out
STYLE = """
.fb text{font:italic 16px 'STIX Two Text',Georgia,serif;fill:var(--fb-ink,#1c1c1c)}
.fb .bar{stroke:var(--fb-ink,#1c1c1c);stroke-width:9;stroke-linecap:round}
.fb .core{stroke:var(--fb-link,#dfe5ec);stroke-width:6;stroke-linecap:round}
.fb .block{fill:var(--fb-link,#dfe5ec);stroke:var(--fb-ink,#1c1c1c);stroke-width:1.6}
.fb .pin{fill:var(--fb-paper,#fff);stroke:var(--fb-ink,#1c1c1c);stroke-width:1.6}
.fb .ground{fill:none;stroke:var(--fb-ink,#1c1c1c);stroke-width:1.6}
.fb .trace{fill:none;stroke:var(--fb-point,#8a5200);stroke-width:1.6}
.fb .point{fill:var(--fb-point,#8a5200)} .fb text.point{fill:var(--fb-point,#8a5200)}
.fb .arm{stroke:var(--fb-point,#8a5200);stroke-dasharray:5 3;stroke-width:1.2}
.fb .force{stroke:var(--fb-force,#1e6b37);fill:var(--fb-force,#1e6b37);stroke-width:2.4}
.fb text.force{stroke:none}
.fb .part{stroke:var(--fb-part,#a02c2c);fill:var(--fb-part,#a02c2c);stroke-width:2}
.fb text.part{stroke:none}
.fb .sum{stroke:var(--fb-sum,#1f4e8c);fill:var(--fb-sum,#1f4e8c);stroke-width:2.6}
.fb text.sum{stroke:none}
.fb .centre{stroke:var(--fb-part,#a02c2c);stroke-width:1.8}
.fb text.centre{stroke:none;fill:var(--fb-part,#a02c2c)}
"""


class View(NamedTuple):
    """The part of the plane that a picture shows: its upper left corner [m], and [px/m]."""

    left: float
    top: float
    scale: float

    def at(self, place: Iterable[float]) -> tuple[float, float]:
        """Return the pixel of a place [m]."""
        x, y = place
        return (x - self.left) * self.scale, (self.top - y) * self.scale

    def place(self, x: float, y: float) -> tuple[float, float]:
        """Return the place [m] of a pixel."""
        return self.left + x / self.scale, self.top - y / self.scale


class Layers(NamedTuple):
    """What a picture shows besides the links."""

    curves: bool = True
    forces: bool = True
    centres: bool = False


def view_of(places: np.ndarray) -> View:
    """Return the :class:`View` that holds places of shape (n, 2) [m], centred."""
    places = places[np.isfinite(places).all(axis=1)]
    low, high = (places.min(axis=0), places.max(axis=0)) if len(places) else np.zeros((2, 2))
    size = np.maximum(high - low, 1e-300)
    scale = float(min((WIDTH - 2.0 * MARGIN) / size[0], (HEIGHT - 2.0 * MARGIN) / size[1]))
    centre = 0.5 * (low + high)
    return View(float(centre[0] - 0.5 * WIDTH / scale), float(centre[1] + 0.5 * HEIGHT / scale),
                scale)


def mechanism_view(shown: Shown) -> View:
    """Return the view in which all poses and coupler curves of what is shown have room."""
    places = [place for motion, _ in shown.poses
              for place in _places(shown.linkage.diagram(motion))]
    places += [trace.place for traces in shown.traces.values() for trace in traces]
    return view_of(np.concatenate([np.reshape(place, (-1, 2)) for place in places])
                   if places else np.zeros((0, 2)))


def _places(diagram: Diagram) -> list[np.ndarray]:
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
    parts = [_ground(at[name]) for name in diagram.ground]
    arms = {name: [view.at(point_motion(linkage, motion, link, *place).place)
                   for place in ((0.0,), (along,), (along, across))]
            for name, (link, along, across) in shown.points.items()}
    if layers.curves:
        parts += [_line('arm', *ends) for arm in arms.values() for ends in zip(arm, arm[1:])]
    for bar in diagram.bars:
        parts += [_line(kind, view.at(bar.start), view.at(bar.end)) for kind in ('bar', 'core')]
    parts += [_block(view.at(block.place), block.direction, block.is_guided)
              for block in diagram.blocks]
    parts += [_circle('pin', place, 5.0) for place in at.values()]
    parts += [_text('', _outside(place, at.values()), _plain(name)) for name, place in at.items()]
    for name, (*_, tip) in arms.items() if layers.curves else ():
        parts += [_circle('point', tip, 4.5), _text('point', (tip[0] + 9.0, tip[1] - 8.0), name)]
    if layers.forces and loads is not None:
        parts += _forces(diagram, loads, at, per_newton)
    if layers.centres:
        parts += _centres(linkage, motion, view, at.values())
    return f'<g class="fb">{"".join(parts)}</g>'


def traces_svg(shown: Shown, view: View) -> str:
    """Return the SVG content of the coupler curves, which are the same in every pose."""
    return ''.join(['<g class="fb">', *(_polyline('trace', trace.place, view)
                                        for traces in shown.traces.values() for trace in traces),
                    '</g>'])


def _forces(diagram: Diagram, loads: Any, at: Mapping[str, tuple[float, float]],
            per_newton: float) -> list[str]:
    """Return arrows of the forces at the joints."""
    found: list[str] = []
    taken: list[tuple[float, float]] = []
    for name, joint in diagram.forces.items():
        force = getattr(loads, f'{name}_x'), getattr(loads, f'{name}_y')
        label = f'F{name[1:]} = {significant(getattr(loads, name))} N'
        found.append(_arrow('force', at[joint], (per_newton * force[0], -per_newton * force[1]),
                            label, taken))
    return found


def _centres(linkage: Any, motion: Any, view: View,
             joints: Iterable[tuple[float, float]]) -> list[str]:
    """Return crosses at the instant centres that are no joints, as far as they are in view."""
    links = [(i + 2, link_motion(linkage, motion, link.name))
             for i, link in enumerate(linkage.LINKS)]
    pairs = [(1, j, None, link) for j, link in links]
    pairs += [(i, j, one, other) for n, (i, one) in enumerate(links)
              for j, other in links[n + 1:]]
    found = []
    for i, j, one, other in pairs:
        x, y = view.at(instant_centre(other, one))
        if 0.0 <= x <= WIDTH and 0.0 <= y <= HEIGHT and all(
                hypot(x - u, y - v) > 6.0 for u, v in joints):
            found += [_line('centre', (x - 6.0, y - 6.0), (x + 6.0, y + 6.0)),
                      _line('centre', (x - 6.0, y + 6.0), (x + 6.0, y - 6.0)),
                      _text('centre', (x + 9.0, y + 18.0), f'P{i}{j}')]
    return found


# --- polygons ------------------------------------------------------------------------------------

def polygon_view(polygons: Iterable[list[Arrow]]) -> View:
    """Return the view in which all these polygons have room."""
    ends = [end for arrows in polygons for arrow in arrows
            for end in (arrow.start, arrow.start + arrow.vector)]
    return view_of(np.array([(0.0, 0.0), *ends]))


def polygon_svg(arrows: list[Arrow], view: View, unit: str) -> str:
    """Return the SVG content of a velocity or acceleration polygon; the pole is o."""
    pole = view.at((0.0, 0.0))
    taken: list[tuple[float, float]] = []
    parts = [_arrow('sum' if arrow.is_sum else 'part', view.at(arrow.start),
                    (view.scale * arrow.vector[0], -view.scale * arrow.vector[1]),
                    f'{_plain(arrow.label)} = {significant(hypot(*arrow.vector))} {unit}', taken)
             for arrow in without_repeats(arrows, 1.0 / view.scale)]
    parts += [_circle('pin', pole, 4.0), _text('', (pole[0] - 16.0, pole[1] + 18.0), 'o')]
    return f'<g class="fb">{"".join(parts)}</g>'


# --- strokes -------------------------------------------------------------------------------------

def _line(kind: str, start: tuple[float, float], end: tuple[float, float]) -> str:
    return (f'<line class="{kind}" x1="{start[0]:.1f}" y1="{start[1]:.1f}" '
            f'x2="{end[0]:.1f}" y2="{end[1]:.1f}"/>')


def _circle(kind: str, at: tuple[float, float], radius: float) -> str:
    return f'<circle class="{kind}" cx="{at[0]:.1f}" cy="{at[1]:.1f}" r="{radius:g}"/>'


def _text(kind: str, at: tuple[float, float], text: str) -> str:
    return f'<text class="{kind}" x="{at[0]:.1f}" y="{at[1]:.1f}">{escape(text)}</text>'


def _polyline(kind: str, places: np.ndarray, view: View) -> str:
    pixels = ' '.join('{:.1f},{:.1f}'.format(*view.at(place)) for place in places
                      if np.isfinite(place).all())
    return f'<polyline class="{kind}" points="{pixels}"/>'


def _ground(at: tuple[float, float]) -> str:
    x, y = at
    return (f'<path class="ground" d="M{x:.1f},{y:.1f} l-11,20 h22 z m-19,20 h38"/>')


def _block(at: tuple[float, float], direction: np.ndarray, is_guided: bool) -> str:
    (x, y), (u, v) = at, (float(direction[0]), -float(direction[1]))
    corners = [(x + 17.0 * a * u - 10.0 * b * v, y + 17.0 * a * v + 10.0 * b * u)
               for a, b in ((1, 1), (1, -1), (-1, -1), (-1, 1))]
    box = ('<polygon class="block" points="'
           + ' '.join(f'{i:.1f},{j:.1f}' for i, j in corners) + '"/>')
    guide = _line('ground', (x - 48.0 * u - 11.0 * v, y - 48.0 * v + 11.0 * u),
                  (x + 48.0 * u - 11.0 * v, y + 48.0 * v + 11.0 * u)) if is_guided else ''
    return guide + box


def _arrow(kind: str, start: tuple[float, float], vector: tuple[float, float],
           label: str, taken: list[tuple[float, float]]) -> str:
    """
    Return an arrow [px] with its label at the tip; nothing of one too short to be seen.

    ``taken``: places of labels, which this one leaves free and is added to.
    """
    size = hypot(*vector)
    if not LEAST <= size < 50.0 * WIDTH:
        return ''
    u, v = vector[0] / size, vector[1] / size
    tip = start[0] + vector[0], start[1] + vector[1]
    back = min(11.0, size)
    head = ' '.join(f'{i:.1f},{j:.1f}' for i, j in (
        tip, (tip[0] - back * u - 4.5 * v, tip[1] - back * v + 4.5 * u),
        (tip[0] - back * u + 4.5 * v, tip[1] - back * v - 4.5 * u)))
    width = 7.5 * len(label)
    text = (min(max(tip[0] + 8.0 * u + (0.0 if u >= 0.0 else -width), 2.0), WIDTH - width),
            min(max(tip[1] + 14.0 * v + 5.0, 16.0), HEIGHT - 4.0))
    while any(abs(text[0] - x) < width and abs(text[1] - y) < LINE for x, y in taken):
        text = text[0], text[1] + LINE
    taken.append(text)
    return (_line(kind, start, (tip[0] - 0.8 * back * u, tip[1] - 0.8 * back * v))
            + f'<polygon class="{kind}" points="{head}"/>' + _text(kind, text, label))


def _outside(at: tuple[float, float],
             places: Iterable[tuple[float, float]]) -> tuple[float, float]:
    """Return where the letter of a joint stands: away from the middle of the others."""
    x, y = np.mean(list(places), axis=0)
    dx, dy = at[0] - x, at[1] - y
    size = hypot(dx, dy) or 1.0
    return at[0] + 16.0 * dx / size - 5.0, at[1] + 16.0 * dy / size + 5.0


def _plain(label: str) -> str:
    """Return a mathtext label as plain text: V_{B/A} as V B/A."""
    return re.sub(r'[_^]\{?([^}_^]*)\}?', r'\1', label)
