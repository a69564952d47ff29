# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Strokes of SVG pictures, in pixels, and the view that leads from metres to them.

Colours are CSS variables with the ones of print as fallback, so that a page can be light or dark
and a saved file is complete.
"""
from __future__ import annotations

from collections.abc import Iterable
from html import escape
from math import hypot
import re
from typing import NamedTuple

from fourbar_ros.numerics.arrays import Array
import numpy as np

WIDTH, HEIGHT = 600.0, 420.0       # [px] of a picture
MARGIN = 44.0                      # [px]
LINE = 17.0                        # [px] between labels
LETTER = 9.0                       # [px] of the letters of a joint
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
.fb .ghost{opacity:.42} .fb .ghost .core{stroke:var(--fb-point,#8a5200)}
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


def view_of(places: Array) -> View:
    """Return the :class:`View` that holds places of shape (n, 2) [m], centred."""
    places = places[np.isfinite(places).all(axis=1)]
    low, high = (places.min(axis=0), places.max(axis=0)) if len(places) else np.zeros((2, 2))
    size = np.maximum(high - low, 1e-300)
    scale = float(min((WIDTH - 2.0 * MARGIN) / size[0], (HEIGHT - 2.0 * MARGIN) / size[1]))
    centre = 0.5 * (low + high)
    return View(float(centre[0] - 0.5 * WIDTH / scale), float(centre[1] + 0.5 * HEIGHT / scale),
                scale)


def line(kind: str, start: tuple[float, float], end: tuple[float, float]) -> str:
    """Return a line."""
    return (f'<line class="{kind}" x1="{start[0]:.1f}" y1="{start[1]:.1f}" '
            f'x2="{end[0]:.1f}" y2="{end[1]:.1f}"/>')


def circle(kind: str, at: tuple[float, float], radius: float) -> str:
    """Return a circle."""
    return f'<circle class="{kind}" cx="{at[0]:.1f}" cy="{at[1]:.1f}" r="{radius:g}"/>'


def text(kind: str, at: tuple[float, float], words: str) -> str:
    """Return a text."""
    return f'<text class="{kind}" x="{at[0]:.1f}" y="{at[1]:.1f}">{escape(words)}</text>'


def polyline(kind: str, places: Array, view: View) -> str:
    """Return a line through places [m], finite ones."""
    finite = places[np.isfinite(places).all(axis=1)]
    across, down = (np.asarray(part).tolist() for part in view.at(finite.T))
    pixels = ' '.join(f'{x:.1f},{y:.1f}' for x, y in zip(across, down))
    return f'<polyline class="{kind}" points="{pixels}"/>'


def ground(at: tuple[float, float]) -> str:
    """Return the sign of a pivot on the ground."""
    x, y = at
    return (f'<path class="ground" d="M{x:.1f},{y:.1f} l-11,20 h22 z m-19,20 h38"/>')


def block(at: tuple[float, float], direction: Array, is_guided: bool) -> str:
    """Return a slider, with its guide if that is fixed."""
    (x, y), (u, v) = at, (float(direction[0]), -float(direction[1]))
    corners = [(x + 17.0 * a * u - 10.0 * b * v, y + 17.0 * a * v + 10.0 * b * u)
               for a, b in ((1, 1), (1, -1), (-1, -1), (-1, 1))]
    box = ('<polygon class="block" points="'
           + ' '.join(f'{i:.1f},{j:.1f}' for i, j in corners) + '"/>')
    guide = line('ground', (x - 48.0 * u - 11.0 * v, y - 48.0 * v + 11.0 * u),
                 (x + 48.0 * u - 11.0 * v, y + 48.0 * v + 11.0 * u)) if is_guided else ''
    return guide + box


def arrow(kind: str, start: tuple[float, float], vector: tuple[float, float],
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
    place = (min(max(tip[0] + 8.0 * u + (0.0 if u >= 0.0 else -width), 2.0), WIDTH - width),
             min(max(tip[1] + 14.0 * v + 5.0, 16.0), HEIGHT - 4.0))
    while any(abs(place[0] - x) < width and abs(place[1] - y) < LINE for x, y in taken):
        place = place[0], place[1] + LINE
    taken.append(place)
    return (line(kind, start, (tip[0] - 0.8 * back * u, tip[1] - 0.8 * back * v))
            + f'<polygon class="{kind}" points="{head}"/>' + text(kind, place, label))


def outside(name: str, at: tuple[float, float],
            places: Iterable[tuple[float, float]]) -> tuple[float, float]:
    """Return where the letter of a joint stands: away from the middle of the others."""
    x, y = np.mean(list(places), axis=0)
    dx, dy = at[0] - x, at[1] - y
    size = hypot(dx, dy) or 1.0
    width = LETTER * len(name)
    return (at[0] + (13.0 + 0.5 * width) * dx / size - 0.5 * width, at[1] + 18.0 * dy / size + 5.0)


def plain(label: str) -> str:
    """Return a mathtext label as plain text: V_{B/A} as V B/A."""
    return re.sub(r'[_^]\{?([^}_^]*)\}?', r'\1', label)
