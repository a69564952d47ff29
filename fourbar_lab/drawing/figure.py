# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
A mechanism in a pose with its forces, and its velocity and acceleration polygons, to scale.

Only the functions that draw import matplotlib.
"""
from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from math import hypot
from pathlib import Path
from typing import Any, NamedTuple, TYPE_CHECKING

from fourbar_lab.drawing.labels import labels_of, significant
from fourbar_lab.drawing.mechanism_panel import draw_pose, Letters
from fourbar_lab.drawing.polygons import acceleration_polygon, Arrow, sides_of, velocity_polygon
from fourbar_lab.drawing.sheet import Sheet
from fourbar_ros import FourBarError, Mechanism
from fourbar_ros.mechanisms.parts import NamedFields
from fourbar_ros.mechanisms.picture import diagram_of, ORIGIN, Points
from fourbar_ros.numerics.arrays import Array

if TYPE_CHECKING:      # drawings alone need it
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

PICTURES = '.png', '.svg', '.pdf'
STYLE = {'font.family': 'STIXGeneral', 'mathtext.fontset': 'stix', 'font.size': 11,
         'svg.hashsalt': 'fourbar_ros', 'svg.fonttype': 'path'}
LEAST = 0.004          # arrows shorter than this share of the longest are left out
PART, SUM = '#a02c2c', '#1f4e8c'      # dark enough for print in grey


class Units(NamedTuple):
    """Units of a drawing, each as (text, size in SI)."""

    length: tuple[str, float] = ('m', 1.0)
    speed: tuple[str, float] = ('m/s', 1.0)
    acceleration: tuple[str, float] = ('m/s$^2$', 1.0)


class CannotDraw(FourBarError, ValueError):
    """A picture or a table cannot be made or written; the message says why."""


@contextmanager
def new_figure(**options: Any) -> Iterator[Figure]:
    import matplotlib
    from matplotlib.figure import Figure
    with matplotlib.rc_context(STYLE):
        yield Figure(**options)


@contextmanager
def writing(path: Path) -> Iterator[None]:
    """Raise CannotDraw for what keeps a file from being written."""
    try:
        yield
    except (OSError, ValueError) as error:
        raise CannotDraw(f'{path}: {getattr(error, "strerror", None) or error}') from None


def draw_polygon(axes: Axes, arrows: Sequence[Arrow], title: str, unit: tuple[str, float],
                 names: Letters) -> None:
    """
    Draw a velocity or acceleration polygon to scale, and every magnitude as text below it.

    Absolute vectors (sums) start at the pole o, relative ones form chains between their ends.
    ``unit``: (text, size in SI); ``names``: other letters for joints.
    """
    text, size = unit
    arrows = [arrow._replace(start=arrow.start / size, vector=arrow.vector / size)
              for arrow in arrows]
    shown = sides_of(arrows, names, LEAST * max(hypot(*arrow.vector) for arrow in arrows))
    sheet = Sheet(axes, [ORIGIN] + [point for arrow in shown
                                    for point in (arrow.start, arrow.start + arrow.vector)],
                  f'{title} [{text}]')
    axes.plot(0.0, 0.0, 'o', ms=5, mfc='w', mec='k', zorder=7)
    if not shown:
        axes.annotate('all zero', ORIGIN, (8, 0), textcoords='offset points', va='center')
        return
    sheet.label('o', sheet.around(ORIGIN), 'k')
    for arrow in shown:
        color = SUM if arrow.is_sum else PART
        sheet.arrow(arrow.start, arrow.vector, color, 2.0 if arrow.is_sum else 1.4)
        sheet.label(arrow.label, sheet.beside(arrow.start, arrow.vector), color)
    sheet.scale(text)
    sheet.write([f'${arrow.label}$ = {significant(hypot(*arrow.vector))}' for arrow in shown],
                columns=2)
    sheet.finish()


def make_figure(mechanism: Mechanism, motion: NamedFields, loads: NamedFields | None = None,
                title: str = '', points: Points | None = None, names: Letters | None = None,
                units: Units = Units()) -> Figure:
    """
    Return a matplotlib Figure of three panels: mechanism, velocity and acceleration polygon.

    ``points``: {name: (link, along, across)}; ``names``: other letters for joints; ``units`` of
    lengths and polygons. Title and text are beside the figure: save it with a tight box.
    """
    with new_figure(figsize=(12.6, 4.4)) as figure:
        axes = figure.subplots(1, 3)
        figure.subplots_adjust(left=0.0, right=1.0, bottom=0.0, top=0.85, wspace=0.06)
        figure.suptitle(title, x=0.003, y=0.95, ha='left', va='bottom', fontsize=13,
                        fontweight='bold')
        letters = labels_of(diagram_of(mechanism, motion)).letters
        names = {**(names or {}), **letters}
        heading = 'mechanism'
        if loads:
            heading += ('   $F$: force on the link that hangs at the joint' if letters
                        else '   $F_{ij}$: force of link $i$ on link $j$')
        draw_pose(axes[0], mechanism, motion, loads, points or {}, names, units.length, heading)
        draw_polygon(axes[1], velocity_polygon(mechanism, motion), 'velocities', units.speed,
                     names)
        draw_polygon(axes[2], acceleration_polygon(mechanism, motion), 'accelerations',
                     units.acceleration, names)
    return figure


def make_panels(panels: Mapping[str, Sequence[tuple[str, Array, Array]]], xlabel: str,
                title: str) -> Figure:
    """Return a figure of axes below each other: {text of an axis: (label, x, y) of its curves}."""
    with new_figure(figsize=(9.0, 0.6 + 2.4 * len(panels)), layout='constrained') as figure:
        axes = figure.subplots(len(panels), 1, sharex=True, squeeze=False)[:, 0]
        for axis, (text, curves) in zip(axes, panels.items()):
            for label, x, y in curves:
                axis.plot(x, y, label=label)
            axis.set_ylabel(text)
            axis.grid(alpha=0.3)
            if curves[0][0]:
                axis.legend(loc='center left', bbox_to_anchor=(1.0, 0.5), frameon=False)
        axes[0].set_title(title)
        axes[-1].set_xlabel(xlabel)
    return figure


def save(figure: Figure, path: str | Path) -> Path:
    """Write a figure as .svg, .pdf or .png (also without a suffix) and return the path."""
    import matplotlib
    path = Path(path)
    if not path.suffix:
        path = path.with_name(path.name + '.png')
    if path.suffix not in PICTURES:
        raise CannotDraw(f'{path}: must end in {", ".join(PICTURES)}')
    options = {'metadata': {'Date': None}} if path.suffix == '.svg' else {}
    with matplotlib.rc_context(STYLE), writing(path):
        figure.savefig(path, dpi=200, bbox_inches='tight', **options)
    return path
