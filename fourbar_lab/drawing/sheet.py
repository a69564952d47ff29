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
PAD = (0.03, 0.07)  # [inches] around the letters of a label
FREE = 0.05         # [inches] between a label and lines, where there is room
SCALE = 0.2         # [inches] at the lower edge that scale bars take
HEAD = 6.5          # arrows shorter than 1 / 6.5 inch, 11 points, have a smaller head


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


class Label(NamedTuple):
    """A text in mathtext, points where it may stand, and the tip of the arrow that it names."""

    text: str
    points: Sequence[Array]
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
        middle = 0.5 * (low + high) - (0.0, 0.12 * self.inch)
        half = 0.5 * self.inch * np.array([width, height])
        self.axes, self.low, self.high = axes, middle - half, middle + half
        axes.set(xlim=(self.low[0], self.high[0]), ylim=(self.low[1], self.high[1]),
                 aspect='equal')
        axes.axis('off')
        axes.set_title(title, loc='left', fontsize=FONT * self.zoom,
                       fontweight='bold')
        self.taken: list[Array] = []                        # points on lines
        self._labels: list[Label] = []
        self._rows = 0                                      # of text below

    def occupy(self, start: Array, end: Array) -> None:
        self.taken.extend(start + t * (end - start) for t in np.linspace(0.0, 1.0, 49))

    def line(self, start: Array, end: Array, **style: Any) -> None:
        self.axes.plot(*zip(start, end), **style)
        self.occupy(start, end)

    def arrow(self, start: Array, vector: Array, color: str, width: float) -> None:
        """Draw an arrow; its head takes at most half of its length."""
        head = min(0.5, 0.5 * HEAD * hypot(*vector) / self.inch)
        self.axes.annotate('', start + vector, start, zorder=9, arrowprops={
            'arrowstyle': f'-|>,head_width={0.44 * head:.3f},head_length={head:.3f}',
            'shrinkA': 0, 'shrinkB': 0, 'lw': width, 'color': color})
        self.occupy(start, start + vector)

    def label(self, text: str, points: Sequence[Array], color: str, tip: Array | None = None
              ) -> None:
        """
        Have a label at the first of several points that is free, or else the freest.

        ``tip``: what it names: no point that is nearer to the tip of another label is free.
        """
        self._labels.append(Label(text, points, color, tip))

    def finish(self) -> None:
        lines: Array = np.reshape(self.taken, (-1, 2))
        written: list[tuple[Array, Array]] = []
        for label in self._labels:
            half = 0.5 * self.inch * _size_of(label.text)
            best = max(label.points, key=lambda point: self._room(
                point, half, lines, written, self._is_nearest(point, label.tip)))
            written.append((best, half))
            self.axes.text(*best, f'${label.text}$', ha='center', va='center', zorder=8,
                           color=label.color, fontsize=FONT * self.zoom)

    def _is_nearest(self, point: Array, tip: Array | None) -> bool:
        return tip is None or all(
            hypot(*(point - tip)) <= hypot(*(point - other.tip)) for other in self._labels
            if other.tip is not None)

    def _room(self, point: Array, half: Array, lines: Array, written: list[tuple[Array, Array]],
              is_nearest: bool) -> tuple[float, bool, float, int]:
        """Return how free a point is: overlap (0: none), then distance to lines, or crossings."""
        gaps = [(np.abs(point - centre) - half - size).max() for centre, size in written]
        low = self.low + (0.0, SCALE * self.inch)
        edges = np.minimum(point - half - low, self.high - point - half).min()
        beyond = np.maximum(np.abs(lines - point) - half, 0.0)
        nearest = np.hypot(*beyond.T).min(initial=FREE * self.inch)
        crossed = np.count_nonzero(~beyond.any(axis=1))
        return min(0.0, edges, *gaps), is_nearest, nearest, -crossed

    def around(self, point: Array, towards: Sequence[float] | Array = (0.0, 1.0)) -> list[Array]:
        """Return points for the label of a point, on circles about it, first in this direction."""
        first = np.arctan2(towards[1], towards[0])
        turns = [first + side * step * np.pi / 12.0 for step in range(13) for side in (1.0, -1.0)]
        return [point + distance * self.inch * np.array([np.cos(turn), np.sin(turn)])
                for distance in (0.2, 0.27, 0.35, 0.45, 0.6, 0.8) for turn in turns]

    def beside(self, start: Array, vector: Array) -> list[Array]:
        """Return points for the label of an arrow, on both sides along it, the middle first."""
        normal = np.array([-vector[1], vector[0]]) / hypot(*vector) * self.inch
        return [start + share * vector + distance * normal
                for share in (0.5, 0.4, 0.6, 0.3, 0.7, 0.2, 0.8)
                for distance in (0.18, -0.18, 0.26, -0.26, 0.36, -0.36)]

    def scale(self, unit: str, factor: float = 1.0, share: float = 0.0) -> None:
        """Draw a bar of some round units, each ``factor`` long, at a ``share`` of the width."""
        length = nice(1.3 * self.inch / factor)
        x, y = self.low + (share * (self.high[0] - self.low[0]) + 0.1 * self.inch,
                           0.05 * self.inch)
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
