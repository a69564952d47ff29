# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""A drawing to scale on matplotlib's axes: arrows, labels that find room, scale bars."""
from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from math import floor, hypot, log10
from typing import Any, NamedTuple, TYPE_CHECKING

from fourbar_ros.numerics.arrays import Array
import numpy as np

if TYPE_CHECKING:      # drawings alone need it
    from matplotlib.axes import Axes

FONT, USUAL = 12, 11     # [points] size of labels, where text of a figure has its usual size
PAD = (0.06, 0.1)   # [inches] around the letters of a label
SCALE = 0.2         # [inches] at the lower edge that scale bars take
HEAD = 6.5          # arrows shorter than 1 / 6.5 inch, 11 points, have a smaller head
# The rules of the page for labels (live/js/picture.js), in its pixels: how far from its point the
# box of a label may stand, half of the box that a pin takes, from where on a line leads there.
INCH, FARTHER, PIN, LEADER = 76.0, np.array([8.0, 16.0, 28.0, 44.0, 66.0, 90.0]), 7.0, 34.0
TURNS = np.linspace(-np.pi, np.pi, 25)


@cache
def _size_of(text: str) -> Array:
    """Return (width, height) of a label in mathtext [inches], in the usual size of text."""
    from matplotlib.textpath import TextPath
    extents = TextPath((0.0, 0.0), f'${text}$', size=FONT).get_extents()
    return np.asarray(extents.size / 72.0 + PAD)         # 72 points an inch


def nice(value: float) -> float:
    """Return the largest 1, 2 or 5 times a power of ten up to a positive value: 0.37 gives 0.2."""
    power = 10.0**floor(log10(value))
    return max(step * power for step in (1.0, 2.0, 5.0) if step * power <= value * (1.0 + 1e-12))


def crossed(start: Array, end: Array, low: Array, high: Array) -> Array:
    """Return whether boxes, by their corners (m, 2), meet segments (n, 2): booleans (m, n)."""
    is_beside = ((np.maximum(start, end) < low[:, None])
                 | (np.minimum(start, end) > high[:, None])).any(axis=2)
    # the corners lie on both sides of the segment
    along = end - start
    sides = np.stack([along[:, 0] * (y - start[:, 1]) - along[:, 1] * (x - start[:, 0])
                      for x in (low[:, :1], high[:, :1]) for y in (low[:, 1:], high[:, 1:])])
    return np.asarray(~is_beside & (sides.min(axis=0) <= 0.0) & (sides.max(axis=0) >= 0.0))


class Label(NamedTuple):
    """A text in mathtext and the points (n, 2) beside which it may stand, in a direction each."""

    text: str
    points: Array
    towards: Array          # unit vectors (n, 2)
    reluctance: Array       # (n,), 0: there it looks best
    color: str
    tip: Array | None


class Sheet:
    """
    Axes with equal scales that show all ``points``; labels keep off lines and other labels.

    ``inch`` is an inch of paper in units of the drawing, smaller by ``zoom`` where all text is;
    ``high`` the upper right corner. Labels are written when all lines are there: :meth:`finish`.
    """

    def __init__(self, axes: Axes, points: Sequence[Array] | Array, title: str) -> None:
        from matplotlib import rcParams
        self.zoom = rcParams['font.size'] / USUAL
        every = np.asarray(points)
        low, high = every.min(axis=0), every.max(axis=0)
        box = axes.get_position()
        width, height = (box.width * axes.figure.get_figwidth() / self.zoom,
                         box.height * axes.figure.get_figheight() / self.zoom)       # [inches]
        # 0.9 by 1.15 inches of paper are left around the drawing for labels, and below for scales
        inch = max((high - low) / (width - 0.9, height - 1.15))
        self.inch = inch if inch != 0.0 else 1.0
        self.spare = max(height - 1.15 - (high - low)[1] / self.inch, 0.0)      # [inches]
        middle = 0.5 * (low + high) - (0.0, 0.12 * self.inch)
        half = 0.5 * self.inch * np.array([width, height])
        self.axes, self.low, self.high = axes, middle - half, middle + half
        axes.set(xlim=(self.low[0], self.high[0]), ylim=(self.low[1], self.high[1]),
                 aspect='equal')
        axes.axis('off')
        axes.set_title(title, loc='left', fontsize=FONT * self.zoom,
                       fontweight='bold')
        # lines that no label may cross: points (n, 2), half of their width
        self._lines: list[tuple[Array, float]] = []
        self._signs: list[tuple[Array, Array]] = []     # corners of pins and centres of gravity
        self._labels: list[Label] = []
        self._rows = 0                                      # of text below

    def crop(self) -> None:
        """Make the figure of these axes alone no higher than the drawing needs."""
        figure, share = self.axes.figure, self.axes.get_position().height
        figure.set_figheight(figure.get_figheight() - self.spare * self.zoom / share)
        margin = np.array([0.0, 0.5 * self.spare * self.inch])
        self.low, self.high = self.low + margin, self.high - margin
        self.axes.set_ylim(self.low[1], self.high[1])

    def line(self, start: Array, end: Array, **style: Any) -> None:
        self.curve(np.array([start, end]), **style)

    def curve(self, points: Array, **style: Any) -> None:
        """Draw a line through points (n, 2)."""
        self.axes.plot(*points.T, **style)
        self.occupy(points, style.get('lw', 1.0))

    def occupy(self, points: Array, width: float = 1.0) -> None:
        """Keep labels off a line of a width [points of paper]."""
        self._lines.append((points, 0.5 * width / 72.0 * self.inch / self.zoom))

    def pin(self, point: Array) -> None:
        """Keep labels off a sign at a point."""
        half = PIN / INCH * self.inch
        self._signs.append((point - half, point + half))

    def arrow(self, start: Array, vector: Array, color: str, width: float) -> None:
        """Draw an arrow; its head takes at most half of its length."""
        head = min(0.5, 0.5 * HEAD * hypot(*vector) / self.inch)
        self.axes.annotate('', start + vector, start, zorder=9, arrowprops={
            'arrowstyle': f'-|>,head_width={0.44 * head:.3f},head_length={head:.3f}',
            'shrinkA': 0, 'shrinkB': 0, 'lw': width, 'color': color})
        self.occupy(np.array([start, start + vector]), width)

    def label(self, text: str, point: Array, towards: Sequence[float] | Array, color: str,
              tip: Array | None = None) -> None:
        """
        Have a label around a point, first in this direction.

        ``tip``: what it names: no point that is nearer to the tip of another label is free.
        """
        turns = np.arctan2(towards[1], towards[0]) + TURNS
        directions = np.stack([np.cos(turns), np.sin(turns)], axis=1)
        self._labels.append(Label(text, np.tile(point, (len(turns), 1)), directions,
                                  0.3 * np.abs(TURNS), color, tip))

    def label_arrow(self, text: str, start: Array, vector: Array, color: str) -> None:
        """Have a label beside an arrow, first at its middle."""
        normal = np.array([-vector[1], vector[0]]) / hypot(*vector)
        shares = np.array([0.5, 0.5, 0.4, 0.4, 0.6, 0.6, 0.3, 0.3, 0.7, 0.7, 0.2, 0.2, 0.8, 0.8])
        self._labels.append(Label(
            text, start + np.outer(shares, vector), np.outer((-1.0)**np.arange(14), normal),
            8.0 * np.abs(shares - 0.5), color, None))

    def finish(self) -> None:
        """Write each label where the fewest lines, signs, labels and edges are in its way."""
        pixel = self.inch / INCH
        written: Array = np.empty((0, 2, 2))        # corners of labels
        tips = np.array([label.tip for label in self._labels if label.tip is not None])
        least, most = self.low + (0.0, SCALE * self.inch), self.high
        for label in self._labels:
            half = 0.5 * self.inch * _size_of(label.text)
            # the box is so far from its point, in its direction: shape (distances x points, 2)
            points = np.tile(label.points, (len(FARTHER), 1))
            far = np.repeat(FARTHER, len(label.points))
            wanted = points + np.tile(label.towards, (len(FARTHER), 1)) * (
                far[:, None] * pixel + half)
            middle = np.clip(wanted, least + half, most - half)
            low, high = middle - half, middle + half
            cost = (0.05 * far + np.tile(label.reluctance, len(FARTHER))
                    + 20.0 * (middle != wanted).any(axis=1))
            for box_low, box_high in (*self._signs, *written):
                common = (np.minimum(high, box_high) - np.maximum(low, box_low)) / pixel
                cost += np.where((common > 0.0).all(axis=1), 60.0 + common.prod(axis=1), 0.0)
            for line, width in self._lines:
                cost += 40.0 * crossed(line[:-1], line[1:], low - width, high + width).any(axis=1)
            ends = np.clip(points, low, high)       # of a line from the point to its label
            is_led = np.hypot(*(ends - points).T) > LEADER * pixel
            cost += 60.0 * is_led * crossed(points, ends, *written.swapaxes(0, 1)).sum(axis=0)
            if label.tip is not None:
                nearest = np.hypot(*(middle[:, None] - tips).T).min(axis=0)
                cost += 50.0 * (np.hypot(*(middle - label.tip).T) > nearest)
            best = int(np.argmin(cost))
            written = np.append(written, [[low[best], high[best]]], axis=0)
            if is_led[best]:
                end = ends[best] + 0.1 * (points[best] - ends[best])
                self.line(points[best], end, color=label.color, lw=0.6, zorder=1.1)
            self.axes.text(*middle[best], f'${label.text}$', ha='center', va='center', zorder=8,
                           color=label.color, fontsize=FONT * self.zoom)

    def scale(self, unit: str, factor: float = 1.0, share: float = 0.0) -> None:
        """Draw a bar of some round units, each ``factor`` long, at a ``share`` of the width."""
        length = nice(1.3 * self.inch / factor)
        x, y = self.low + (share * (self.high[0] - self.low[0]) + 0.1 * self.inch,
                           0.09 * self.inch)
        self.axes.plot([x, x + length * factor], [y, y], color='k', lw=1.2, marker='|', ms=7,
                       clip_on=False)
        self.axes.annotate(f'{length:g} {unit}', (x + length * factor, y), (6, 0),
                           textcoords='offset points', va='center',
                           fontsize=10 * self.zoom)

    def write(self, lines: Sequence[str], columns: int = 1) -> None:
        """Write lines of text below the drawing and what is written there, in columns."""
        height = -(-len(lines) // columns)
        for i, text in enumerate(lines):
            column, row = divmod(i, height)
            self.axes.annotate(text, (0.02 + 0.49 * column, 0.0),
                               (0, -self.zoom * (14 + 16 * (self._rows + row))), va='center',
                               fontsize=USUAL * self.zoom,
                               xycoords='axes fraction', textcoords='offset points')
        self._rows += height
