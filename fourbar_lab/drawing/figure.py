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

from fourbar_lab.drawing.labels import as_mathtext, labels_of, significant
from fourbar_lab.drawing.mechanism_panel import draw_pose
from fourbar_lab.drawing.polygons import Arrow, polygons_of, sides_of
from fourbar_lab.drawing.sheet import Sheet, USUAL
from fourbar_ros import Mechanism
from fourbar_ros.errors import FourBarError, InvalidParameter
from fourbar_ros.mechanisms.parts import NamedFields
from fourbar_ros.mechanisms.picture import diagram_of, ORIGIN, Points
from fourbar_ros.numerics.arrays import Array
import numpy as np

if TYPE_CHECKING:      # drawings alone need it
    from fourbar_lab.drawing.paper import PaperFigure
    from matplotlib.axes import Axes

PICTURES = '.png', '.svg', '.pdf'
# eight curves that greyscale tells apart: dark ones and light ones, each with four dashes
COLOURS = ('#1f4e8c', '#a02c2c', '#1e6b37', '#5b2a86', '#4a9fd8', '#e08a1e', '#86b53c', '#999999')
DASHES = '-', '--', '-.', ':'
CURVES = {'color': COLOURS, 'linestyle': DASHES + DASHES}
STYLE = {'font.family': 'STIXGeneral', 'mathtext.fontset': 'stix', 'font.size': USUAL,
         'svg.hashsalt': 'fourbar_ros', 'svg.fonttype': 'path',
         'pdf.fonttype': 42}            # journals refuse fonts of type 3
SMALLEST = 8.0         # [points] text of figures that are narrower than usual
BESIDE, COLUMN = 9.0, 5.0      # [inch] least widths of three panels beside each other, of two
NARROWEST, WIDEST = 0.02, 2.0    # [m] of a picture on paper
LEAST = 0.004          # arrows shorter than this share of the longest are left out
PART, SUM = '#a02c2c', '#1f4e8c'      # dark enough for print in grey


class Units(NamedTuple):
    """Units of a drawing, each as (text, size in SI)."""

    length: tuple[str, float] = ('m', 1.0)
    speed: tuple[str, float] = ('m/s', 1.0)
    acceleration: tuple[str, float] = ('m/s$^2$', 1.0)


class Paper(NamedTuple):
    """What a picture is made for: its width [m], 0: the usual one; its title, None: the usual."""

    width: float = 0.0
    title: str | None = None


def paper_of(width: float | None, title: str | None) -> Paper:
    """Return paper of a width [m], None: the usual one; InvalidParameter."""
    if not isinstance(title, str | None):
        raise InvalidParameter('title', title, 'must be a text')
    if width is not None and not NARROWEST <= width <= WIDEST:
        raise InvalidParameter('width', width, "must be 20 mm to 2 m, as '88mm'; a number is in m")
    return Paper(width or 0.0, title)


class CannotDraw(FourBarError, ValueError):
    """A picture or a table cannot be made or written; the message says why."""


@contextmanager
def new_figure(width: float, height: float, paper: Paper = Paper(), **options: Any
               ) -> Iterator[PaperFigure]:
    """Give a figure of its usual size [inch], or as wide as the paper, in proportion."""
    from fourbar_lab.drawing.paper import MARGIN, PaperFigure
    import matplotlib
    page_width = paper.width / 0.0254
    across = max(page_width - 2.0 * MARGIN, 0.5) if page_width else width
    style = STYLE | {'font.size': min(USUAL, max(SMALLEST, USUAL * across / width))}
    with matplotlib.rc_context(style):
        figure = PaperFigure(figsize=(across, height * across / width), **options)
        figure.style, figure.page_width = style, page_width
        yield figure


@contextmanager
def writing(path: Path) -> Iterator[None]:
    """Raise CannotDraw for what keeps a file from being written."""
    try:
        yield
    except (OSError, ValueError) as error:
        raise CannotDraw(f'{path}: {getattr(error, "strerror", None) or error}') from None


def draw_polygon(axes: Axes, arrows: Sequence[Arrow], title: str, unit: tuple[str, float],
                 letters: Mapping[str, str]) -> None:
    """
    Draw a velocity or acceleration polygon to scale, and every magnitude as text below it.

    Absolute vectors (sums) start at the pole o, relative ones form chains between their ends.
    ``unit``: (text, size in SI); ``letters``: {joint: its letter as mathtext}.
    """
    text, size = unit
    arrows = [arrow._replace(start=arrow.start / size, vector=arrow.vector / size)
              for arrow in arrows]
    shown = sides_of(arrows, letters, LEAST * max(hypot(*arrow.vector) for arrow in arrows))
    sheet = Sheet(axes, [ORIGIN] + [point for arrow in shown
                                    for point in (arrow.start, arrow.start + arrow.vector)],
                  f'{title} [{text}]')
    axes.plot(0.0, 0.0, 'o', ms=5, mfc='w', mec='k', zorder=7)
    if not shown:
        axes.annotate('all zero', ORIGIN, (8, 0), textcoords='offset points', va='center')
        return
    sheet.pin(ORIGIN)
    sheet.label('o', ORIGIN, -np.mean([arrow.vector for arrow in shown], axis=0), 'k')
    for arrow in shown:
        color = SUM if arrow.is_sum else PART
        sheet.arrow(arrow.start, arrow.vector, color, 2.0 if arrow.is_sum else 1.4)
        sheet.label_arrow(arrow.label, arrow.start, arrow.vector, color)
    sheet.scale(text)
    sheet.write([f'${arrow.label}$ = {significant(hypot(*arrow.vector))}' for arrow in shown],
                columns=2)
    sheet.finish()


def make_figure(mechanism: Mechanism, motion: NamedFields, loads: NamedFields | None = None,
                title: str = '', points: Points | None = None, names: Mapping[str, str] = {},
                units: Units = Units(), paper: Paper = Paper()) -> PaperFigure:
    """
    Return a matplotlib Figure of three panels: mechanism, velocity and acceleration polygon.

    ``points``: {name: (link, along, across)}; ``names``: {joint: name in place of its letter};
    ``units`` of lengths and polygons. The panels stand beside each other, below each other in a
    column. Title and text are beside the figure: :func:`save` makes room for them.
    """
    velocities, accelerations = polygons_of(mechanism, motion)
    diagram = diagram_of(mechanism, motion)
    # names in the call win over those of the mechanism, and stand before them: of several joints
    # at a point the first name counts
    labels = labels_of(diagram._replace(names={**names, **diagram.names, **names}))
    with new_figure(12.6, 4.4, paper) as figure:
        across, size, top = figure.get_figwidth(), figure.style['font.size'], 0.95
        if across >= BESIDE:
            axes = list(figure.subplots(1, 3))
            figure.subplots_adjust(left=0.0, right=1.0, bottom=0.0, top=0.85, wspace=0.06)
        else:       # the mechanism above the polygons; below each panel its lines of text
            lines = (len(mechanism.DRAWN) + (len(diagram.forces) + 6 if loads else 0) // 2,
                     *(len(arrows) // 2 + 2 for arrows in (velocities, accelerations)))
            shape = ((0,), (1, 2)) if across >= COLUMN else ((0,), (1,), (2,))
            heights = [(min(0.7 * across / len(row), 0.4 * BESIDE),
                        (max(lines[i] for i in row) + 3) * 16.0 / 72.0 * size / 11.0)
                       for row in shape]
            height = sum(map(sum, heights))
            figure.set_figheight(height)
            axes, top, below = [], 1.0 + 0.032 * size / height, height    # above a heading
            for row, (of_panel, of_text) in zip(shape, heights):
                below -= of_panel
                axes += [figure.add_axes((column / len(row), below / height, 0.98 / len(row),
                                          of_panel / height)) for column in range(len(row))]
                below -= of_text
        figure.suptitle(figure.title_of(title, paper.title), x=0.003, y=top, ha='left',
                        va='bottom', fontsize=size * 13.0 / 11.0, fontweight='bold')
        letters = {joint: as_mathtext(letter) for joint, letter in labels.letters.items()}
        heading = 'mechanism'
        if loads:
            heading += ('   $F$: force on the link that hangs at the joint'
                        if not labels.are_by_links
                        else '   $F_{ij}$: force of link $i$ on link $j$')
        draw_pose(axes[0], mechanism, motion, loads, points or {}, labels, units.length, heading)
        draw_polygon(axes[1], velocities, 'velocities', units.speed, letters)
        draw_polygon(axes[2], accelerations, 'accelerations', units.acceleration, letters)
    return figure


def make_panels(panels: Mapping[str, Sequence[tuple[str, Array, Array]]], xlabel: str,
                title: str, paper: Paper = Paper()) -> PaperFigure:
    """Return a figure of axes below each other: {text of an axis: (label, x, y) of its curves}."""
    with new_figure(9.0, 0.6 + 2.4 * len(panels), paper, layout='constrained') as figure:
        size = figure.style['font.size']
        if figure.get_figwidth() < COLUMN:
            figure.set_figheight(0.5 + 1.8 * len(panels))
        axes = figure.subplots(len(panels), 1, sharex=True, squeeze=False)[:, 0]
        for axis, (text, curves) in zip(axes, panels.items()):
            axis.set_prop_cycle(**CURVES)
            for label, x, y in curves:
                axis.plot(x, y, label=label)
            axis.set_ylabel(text)
            axis.grid(alpha=0.3)
            axis.margins(x=0.0)
            if curves[0][0]:
                height = figure.get_figheight() / len(panels) - 0.4       # [inch], about
                label_curves(axis, 1.3 * size / 72.0 / height)
        axes[0].set_title(figure.title_of(title, paper.title))
        axes[-1].set_xlabel(xlabel)
    return figure


def label_curves(axis: Axes, height: float) -> None:
    """
    Write the labels of curves beside their right ends, with lines of their kind that lead there.

    ``height``: of a label over that of the axes; where too many do not fit: a legend.
    """
    lines = list(axis.lines)
    if height * len(lines) > 1.0:
        axis.legend(loc='center left', bbox_to_anchor=(1.0, 0.5), frameon=False)
        return
    low, high = axis.get_ylim()
    axis.set_ylim(low, high)            # the labels stay where they are
    ends = []
    for line in lines:
        x, y = (np.asarray(values, float) for values in line.get_data())
        known = np.flatnonzero(np.isfinite(x) & np.isfinite(y))
        last = int(known[np.argmax(x[known])]) if known.size else 0
        ends.append((float(y[last]), float(x[last]), line))
    ends.sort(key=lambda end: end[0])
    positions: list[float] = [(y - low) / (high - low) for y, _, _ in ends]
    for i, position in enumerate(positions):        # upwards, then down from the upper edge
        positions[i] = max(position, positions[i - 1] + height if i else 0.5 * height)
    for i in reversed(range(len(positions))):
        above = positions[i + 1] if i + 1 < len(positions) else 1.0 + 0.5 * height
        positions[i] = min(positions[i], above - height)
    for (y_end, x_end, line), position in zip(ends, positions):
        axis.annotate(str(line.get_label()), (x_end, y_end), (1.06, position), va='center',
                      textcoords='axes fraction', color=line.get_color(), arrowprops={
                          'arrowstyle': '-', 'color': line.get_color(), 'shrinkA': 1.0,
                          'shrinkB': 0.0, 'ls': line.get_linestyle(), 'lw': 1.2})


def save(figure: PaperFigure, path: str | Path) -> Path:
    """Write a figure as .svg, .pdf or .png (also without a suffix) and return the path."""
    path = Path(path)
    if not path.suffix:
        path = path.with_name(path.name + '.png')
    if path.suffix not in PICTURES:
        raise CannotDraw(f'{path}: must end in {", ".join(PICTURES)}')
    options = {'metadata': {'Date': None}} if path.suffix == '.svg' else {}
    with writing(path):
        figure.savefig(path, dpi=200, **options)
    return path
