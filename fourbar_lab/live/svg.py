# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Strokes of SVG pictures, in pixels, and the view that leads from metres to them.

Colours are CSS variables with the ones of print as fallback, so that a page can be light or dark.
A saved file has the ones of print alone: programs other than browsers know no variables.
"""
from __future__ import annotations

from collections.abc import Iterable
from html import escape
from math import atan2, hypot
from pathlib import Path
import re
from typing import NamedTuple

from fourbar_ros.mechanisms.picture import Arm, Bar, Block, NamedJoint, outlines, Primitive
from fourbar_ros.numerics.arrays import Array
import numpy as np

WIDTH, HEIGHT = 720.0, 420.0       # [px] of a picture
MARGIN = 44.0                      # [px]
LINE = 19.0                        # [px] between labels
INCH = 85.0                        # [px] for the signs of blocks and pivots
LETTER = 8.6                       # [px] width of a letter, in wide fonts
LESS = 0.75                        # size of a subscript
# A label looks for room in these directions from its own [rad], so far from its pixel [px].
AROUND, FARTHER = (0.0, 0.6, -0.6, 1.2, -1.2, 2.0, -2.0, 3.1), (5.0, 22.0, 44.0, 70.0)
FIRST, LAST = np.array([2.0, 1.0]), np.array([WIDTH - 2.0, HEIGHT - 4.0])     # [px] for labels
FAR, TURN = np.repeat(FARTHER, len(AROUND)), np.tile(AROUND, len(FARTHER))
ALONG, FREE = (0.35, 0.6, 0.8, 1.0), 5.0        # parts of an arrow that stay free, [px] around
LEAST = 4.0                        # [px] shorter arrows are left out
# Without the lines of its licence, which every saved picture would repeat.
STYLE = Path(__file__).with_name('picture.css').read_text(encoding='utf-8').partition('*/')[2]
PRINTED_STYLE = re.sub(r'var\([\w-]+,([^)]*)\)', r'\1', STYLE)

Pixel = tuple[float, float]           # [px], y downwards
INDEX = re.compile(r'([_^])(?:\{([^}]*)\}|(\w))')


class View(NamedTuple):
    """The part of the plane that a picture shows: its upper left corner [m], and its scales."""

    left: float
    top: float
    scale: float                # [px/m]
    per_newton: float = 0.0     # of force arrows [m/N]; 0: no forces

    def pixel(self, point: Iterable[float]) -> Pixel:
        """Return the pixel of a point [m]."""
        x, y = point
        return (x - self.left) * self.scale, (self.top - y) * self.scale

    def length(self, vector: Iterable[float]) -> Pixel:
        """Return an arrow [m] in pixels."""
        x, y = vector
        return x * self.scale, -y * self.scale

    def point(self, x: float, y: float) -> tuple[float, float]:
        """Return the point [m] of a pixel."""
        return self.left + x / self.scale, self.top - y / self.scale


def view_of(points: Array) -> View:
    """Return the :class:`View` in which points [m], shape (n, 2), fill the picture, centred."""
    points = points[np.isfinite(points).all(axis=1)]
    low, high = (points.min(axis=0), points.max(axis=0)) if len(points) else np.zeros((2, 2))
    size = np.maximum(high - low, 1e-300)
    scale = float(np.min((np.array([WIDTH, HEIGHT]) - 2.0 * MARGIN) / size))
    x, y = (0.5 * (low + high)).tolist()
    return View(x - 0.5 * WIDTH / scale, y + 0.5 * HEIGHT / scale, scale)


def line(kind: str, start: Pixel, end: Pixel) -> str:
    """Return a line."""
    return (f'<line class="{kind}" x1="{start[0]:.1f}" y1="{start[1]:.1f}" '
            f'x2="{end[0]:.1f}" y2="{end[1]:.1f}"/>')


def circle(kind: str, pixel: Pixel, radius: float) -> str:
    """Return a circle."""
    return f'<circle class="{kind}" cx="{pixel[0]:.1f}" cy="{pixel[1]:.1f}" r="{radius:g}"/>'


def text(kind: str, pixel: Pixel, words: str, anchor: str = 'start') -> str:
    """Return a text; ``words`` may have indices as mathtext has them: V_{B/A}, F_2."""
    end = '' if anchor == 'start' else f' text-anchor="{anchor}"'
    return (f'<text class="{kind}" x="{pixel[0]:.1f}" y="{pixel[1]:.1f}"{end}>'
            f'{INDEX.sub(_index, escape(words))}</text>')


def _index(match: re.Match[str]) -> str:
    """
    Return an index of :func:`text`, lowered or raised.

    In SVG a shift holds for all that follows, so an invisible character shifts back.
    """
    shift = 4 if match[1] == '_' else -5
    return (f'<tspan dy="{shift}" font-size="{LESS:.0%}">{match[2] or match[3]}</tspan>'
            f'<tspan dy="{-shift}">&#8203;</tspan>')


def polyline(kind: str, points: Array, view: View) -> str:
    """Return a line through the finite ones of points [m]."""
    finite = points[np.isfinite(points).all(axis=1)]
    across, down = (np.asarray(part).tolist() for part in view.pixel(finite.T))
    pixels = ' '.join(f'{x:.1f},{y:.1f}' for x, y in zip(across, down))
    return f'<polyline class="{kind}" points="{pixels}"/>'


def primitive(part: Primitive, view: View) -> str:
    """Return a bar, an arm to a point, a joint, or the outlines of a block or a pivot."""
    if isinstance(part, Bar):
        ends = view.pixel(part.start), view.pixel(part.end)
        return line('bar', *ends) + line('core', *ends)
    if isinstance(part, Arm):
        start, foot, end = view.pixel(part.start), view.pixel(part.foot), view.pixel(part.end)
        return line('arm', start, foot) + line('arm', foot, end)
    if isinstance(part, NamedJoint):
        return circle('pin', view.pixel(part.point), 5.0)
    corners, ground = outlines(part, INCH / view.scale)
    points = ' '.join(f'{x:.1f},{y:.1f}' for x, y in map(view.pixel, corners))
    fixed = '' if ground is None else line('ground', *map(view.pixel, ground))
    kind = 'block' if isinstance(part, Block) else 'ground'
    return f'{fixed}<polygon class="{kind}" points="{points}"/>'


def arrow(kind: str, start: Pixel, vector: Pixel, label: str, room: Room) -> str:
    """Return an arrow [px] with its label at the tip; nothing of one too short to be seen."""
    size = hypot(*vector)
    if not LEAST <= size < 50.0 * WIDTH:
        return ''
    u, v = vector[0] / size, vector[1] / size
    tip = start[0] + vector[0], start[1] + vector[1]
    back = min(11.0, size)
    head = ' '.join(f'{i:.1f},{j:.1f}' for i, j in (
        tip, (tip[0] - back * u - 4.5 * v, tip[1] - back * v + 4.5 * u),
        (tip[0] - back * u + 4.5 * v, tip[1] - back * v - 4.5 * u)))
    return (line(kind, start, (tip[0] - 0.8 * back * u, tip[1] - 0.8 * back * v))
            + f'<polygon class="{kind}" points="{head}"/>'
            + room.label(kind, tip, (u, v), label))


class Room:
    """
    Where labels have room: inside the picture, and not above each other.

    Pins and arrows (start, vector) stay free too [px].
    """

    def __init__(self, pins: Iterable[Pixel],
                 arrows: Iterable[tuple[Pixel, Pixel]] = ()):
        points = np.array([*pins, *((start[0] + part * vector[0], start[1] + part * vector[1])
                                    for start, vector in arrows for part in ALONG)])
        # boxes: left, above, right, below [px]
        self._taken = np.concatenate((points - FREE, points + FREE), axis=1)

    def label(self, kind: str, pixel: Pixel, away: Pixel, words: str) -> str:
        """
        Return a text near a pixel, if there is room in the direction ``away``.

        The first free box is taken, or the one that covers least of what is there.
        """
        size = np.array([LETTER * len(plain(words)), LINE])
        angle = atan2(away[1], away[0]) + TURN
        ways = np.stack((np.cos(angle), np.sin(angle)), axis=1)
        corners = pixel + ways * (FAR[:, None] + 0.5 * size) - 0.5 * size      # left, above
        corners = np.clip(corners, FIRST, np.maximum(FIRST, LAST - size))   # into the picture
        boxes = np.concatenate((corners, corners + size), axis=1)
        shared = (np.minimum(boxes[:, None, 2:], self._taken[:, 2:])
                  - np.maximum(boxes[:, None, :2], self._taken[:, :2])).clip(0.0)
        best = boxes[int(np.argmin(shared.prod(axis=-1).sum(axis=1)))]
        self._taken = np.concatenate((self._taken, best[None]))
        left, _, right, below = best.tolist()
        # on the side of the edge: a wider font then grows inwards
        if right > WIDTH - 3.0 * LETTER:
            return text(kind, (right, below - 4.0), words, 'end')
        return text(kind, (left, below - 4.0), words)


def plain(label: str) -> str:
    """Return a mathtext label as plain text: V_{B/A} as VB/A."""
    return INDEX.sub(lambda match: match[2] or match[3], label)
