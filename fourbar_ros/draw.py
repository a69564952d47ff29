"""
A mechanism in a pose with its forces, and its velocity and acceleration polygons, to scale.

What a teacher draws on the board. Only the functions that draw import matplotlib.
"""
from __future__ import annotations

from math import floor, hypot, log10
from pathlib import Path

import numpy as np

from .core import FourBarError
from .core.frames import turned
from .core.inverted_slider import InvertedSlider
from .core.points import link_motion, point_motion
from .core.slider_crank import SliderCrank
from .polygons import O1, acceleration_polygon, velocity_polygon

STYLE = {'font.family': 'STIXGeneral', 'mathtext.fontset': 'stix', 'font.size': 11, 'svg.hashsalt': 'fourbar_ros',
         'svg.fonttype': 'path'}
LEAST, LEAST_FORCE = 0.004, 0.1      # arrows shorter than this share of the longest are left out
ARROW = 0.45           # length of the longest force over the size of the mechanism
BODY, PART, SUM, FORCE = '0.35', '#a02c2c', '#1f4e8c', '#1e6b37'      # dark enough for print in grey


class CannotDraw(FourBarError, ValueError):
    """The picture cannot be made or written; the message says why."""


def need_matplotlib(what):
    """Raise CannotDraw if matplotlib is missing."""
    try:
        import matplotlib  # noqa: F401
    except ImportError:
        raise CannotDraw(f'{what} needs matplotlib: pip install matplotlib') from None


def joints(mechanism, motion):
    """Return the places of the joints by name, in order along the chain, each of shape (2,) [m]."""
    def place(link, along):
        return point_motion(mechanism, motion, link, along).place

    places = {'O_1': O1, 'A': place('crank', mechanism.a1)}
    if isinstance(mechanism, SliderCrank):
        return places | {'B': place('output', 0.0)}
    if isinstance(mechanism, InvertedSlider):
        return places | {'O_4': place('output', 0.0)}
    return places | {'B': place('output', mechanism.a3), 'O_4': place('output', 0.0)}


def nice(value):
    """Return the largest of 1, 2, 5 times a power of ten that is not above a positive value."""
    power = 10.0**floor(log10(value))
    return max(step * power for step in (1.0, 2.0, 5.0) if step * power <= value * (1.0 + 1e-12))


# --- strokes ---------------------------------------------------------------------------------------

class Sheet:
    """Axes with equal scales, filled by what is on them, and what is already there: labels keep off it."""

    def __init__(self, axes, points, title):
        points = np.asarray(points)
        low, high = points.min(axis=0), points.max(axis=0)
        box = axes.get_position()
        width, height = box.width * axes.figure.get_figwidth(), box.height * axes.figure.get_figheight()
        # inches of paper around the drawing: labels, and below it the scale
        self.inch = max((high - low) / (width - 0.9, height - 1.15)) or 1.0
        middle = 0.5 * (low + high) - (0.0, 0.12 * self.inch)
        half = 0.5 * self.inch * np.array([width, height])
        self.axes, self.left, self.bottom = axes, middle[0] - half[0], middle[1] - half[1]
        axes.set(xlim=(self.left, middle[0] + half[0]), ylim=(self.bottom, middle[1] + half[1]), aspect='equal')
        axes.axis('off')
        axes.set_title(title, loc='left', fontsize=12, fontweight='bold')
        self.taken = []

    def occupy(self, start, end):
        """Keep labels off a line."""
        self.taken.extend(start + t * (end - start) for t in np.linspace(0.0, 1.0, 25))

    def arrow(self, start, vector, color, width):
        """Draw an arrow."""
        self.axes.annotate('', start + vector, start, zorder=5, arrowprops={
            'arrowstyle': '-|>,head_width=0.22,head_length=0.5', 'shrinkA': 0, 'shrinkB': 0, 'lw': width,
            'color': color})

    def label(self, text, places, color):
        """Write a label at the first of several places that is free, or else the freest."""
        letters = len(text.replace('\\', '').translate(str.maketrans('', '', '_^{}')))
        reach = np.array([[x * 0.045 * letters * self.inch, 0.0] for x in (-1.0, -0.5, 0.0, 0.5, 1.0)])
        taken, enough = np.array(self.taken)[:, None, :], 0.13 * self.inch
        best = max(places, key=lambda at: min(enough, np.hypot(*np.moveaxis(taken - (at + reach), -1, 0)).min()))
        self.axes.text(*best, f'${text}$', ha='center', va='center', color=color, zorder=8, fontsize=12)
        self.taken.extend(best + reach)

    def around(self, at, towards=(0.0, 1.0)):
        """Return places for the label of a point, the first in this direction."""
        first = np.arctan2(towards[1], towards[0])
        turns = [first + side * step * np.pi / 12.0 for step in range(13) for side in (1.0, -1.0)]
        return [at + distance * self.inch * np.array([np.cos(turn), np.sin(turn)])
                for distance in (0.2, 0.27, 0.35) for turn in turns]

    def beside(self, start, vector):
        """Return places for the label of an arrow."""
        normal = np.array([-vector[1], vector[0]]) / hypot(*vector) * self.inch
        return [start + share * vector + distance * normal
                for share in (0.5, 0.4, 0.6, 0.3, 0.7, 0.2, 0.8)
                for distance in (0.18, -0.18, 0.26, -0.26, 0.36, -0.36)]

    def scale(self, unit, factor=1.0):
        """Draw a bar of a round number of units; ``factor`` lengths of paper are one of them."""
        length = nice(1.5 * self.inch / factor)
        start, y = self.left + 0.1 * self.inch, self.bottom + 0.05 * self.inch
        self.axes.plot([start, start + length * factor], [y, y], color='k', lw=1.2, marker='|', ms=7, clip_on=False)
        self.axes.annotate(f'{length:g} {unit}', (start + length * factor, y), (6, 0), textcoords='offset points',
                           va='center', fontsize=10)

    def write(self, lines):
        """Write lines below the drawing, in two columns."""
        half = (len(lines) + 1) // 2
        for column, part in enumerate((lines[:half], lines[half:])):
            for row, text in enumerate(part):
                self.axes.annotate(text, (0.02 + 0.47 * column, 0.0), (0, -14 - 16 * row), xycoords='axes fraction',
                                   textcoords='offset points', va='center', fontsize=11)


# --- panels ----------------------------------------------------------------------------------------

def draw_polygon(axes, arrows, title, unit):
    """Draw a polygon to scale: sums from the pole, parts in a chain, every magnitude below it."""
    longest = max(hypot(*arrow.vector) for arrow in arrows)
    # a part that is all of its sum is not drawn twice
    sums = [arrow for arrow in arrows if arrow.is_sum]
    shown = [arrow for arrow in arrows if hypot(*arrow.vector) > LEAST * longest and (arrow.is_sum or not any(
        np.allclose(arrow.vector, other.vector, 0.0, LEAST * longest) and np.allclose(arrow.start, other.start)
        for other in sums))]
    sheet = Sheet(axes, [O1] + [point for arrow in shown for point in (arrow.start, arrow.start + arrow.vector)],
                  f'{title} [{unit}]')
    for arrow in shown:
        sheet.arrow(arrow.start, arrow.vector, *((SUM, 2.0) if arrow.is_sum else (PART, 1.4)))
        sheet.occupy(arrow.start, arrow.start + arrow.vector)
    axes.plot(0.0, 0.0, 'o', ms=5, mfc='w', mec='k', zorder=7)
    if not shown:
        axes.annotate('all zero', O1, (8, 0), textcoords='offset points', va='center')
        return
    sheet.label('o', sheet.around(O1), 'k')
    for arrow in shown:
        sheet.label(arrow.label, sheet.beside(arrow.start, arrow.vector), SUM if arrow.is_sum else PART)
    sheet.scale(unit)
    sheet.write([f'${arrow.label}$ = {hypot(*arrow.vector):.4g}' for arrow in shown])


def draw_mechanism(axes, mechanism, motion, loads=None, title=''):
    """Draw links and joints and, with loads, the force on a link at every joint and the drive."""
    places = joints(mechanism, motion)
    points = np.array(list(places.values()))
    size = max(np.ptp(points, axis=0))
    forces = _forces(places, loads, ARROW * size) if loads else {}
    lines, block = _lines(mechanism, motion, places, size)
    ends = [end for line in lines for end in line] + [places[at] + force for at, force in forces.values()]
    below = [at - (0.0, 0.08 * size) for at in points]
    sheet = Sheet(axes, [*ends, *below], title)
    for start, end in lines:
        axes.plot(*zip(start, end), color=BODY, lw=4.5, solid_capstyle='round', zorder=2)
        axes.plot(*zip(start, end), color='0.88', lw=2.6, solid_capstyle='round', zorder=3)
        sheet.occupy(start, end)
    if block:
        half = 0.2 * sheet.inch
        _block(axes, *block, half)
        corners = [block[0] + (x, y) for x, y in ((-half, -half), (-half, half), (half, half), (half, -half))]
        for one, other in zip(corners, corners[1:]):
            sheet.occupy(one, other)
        if isinstance(mechanism, SliderCrank):
            sides = places['B'] + sheet.inch * np.array([[-0.7, -0.11], [0.7, -0.11]])
            axes.plot(*sides.T, color='k', lw=1.4)
            sheet.occupy(*sides)
    for name, at in places.items():
        if name in ('O_1', 'O_4'):
            _ground(axes, at, 0.12 * sheet.inch)
            sheet.occupy(at - (0.1 * sheet.inch, 0.19 * sheet.inch), at + sheet.inch * np.array([0.1, -0.19]))
        axes.plot(*at, 'o', ms=6, mfc='w', mec='k', zorder=7)
    for at, force in forces.values():
        sheet.arrow(places[at], force, FORCE, 1.8)
        sheet.occupy(places[at], places[at] + force)
    for name, at in places.items():
        sheet.label(name, sheet.around(at), 'k')
    for name, (at, force) in forces.items():
        tip = places[at] + force
        sheet.label(f'F_{{{name[1:]}}}', sheet.around(tip, force), FORCE)
    if loads is None:
        sheet.scale('m')
        return
    if forces:
        sheet.scale('N', ARROW * size / max(getattr(loads, name) for name in FORCES))
    sheet.write(_about(loads, forces))


FORCES = ('f41', 'f21', 'f32', 'f43')


def _forces(places, loads, length):
    """Return {name: (joint, arrow)} of the forces that can be seen, the longest of this length."""
    at = {'f41': 'O_1', 'f21': 'A', 'f32': 'B' if 'B' in places else 'A', 'f43': 'O_4' if 'O_4' in places else 'B'}
    longest = max(getattr(loads, name) for name in FORCES)
    return {name: (at[name], length / longest * np.array([getattr(loads, f'{name}_x'), getattr(loads, f'{name}_y')]))
            for name in FORCES if getattr(loads, name) > LEAST_FORCE * longest}


def _about(loads, drawn):
    """Return the lines of text about loads; ``drawn``: the forces that have an arrow."""
    force = getattr(loads, 'driving_force', 0.0)
    return ['$F_{ij}$: of link $i$ on link $j$',
            *(f'$F_{{{name[1:]}}}$ = {getattr(loads, name):.4g} N' + ('' if name in drawn else ', too short to draw')
              for name in FORCES),
            f'drive: $P$ = {force:.4g} N' if force else f'drive: $T_{{41}}$ = {loads.driving_torque:.4g} N m',
            f'on the ground: {loads.shaking_force:.4g} N', f'about $O_1$: {loads.shaking_moment + 0.0:.4g} N m']


def _lines(mechanism, motion, places, size):
    """Return the links as lines, and (place, direction) of the block or slider or None."""
    lines = [(places['O_1'], places['A'])]
    if isinstance(mechanism, InvertedSlider):
        bar = link_motion(mechanism, motion, 'output').direction
        foot = places['A'] - motion.slide * bar
        end = places['A'] + 0.14 * size * np.sign(motion.slide) * bar
        return lines + [(places['O_4'], foot), (foot, end)], (places['A'], bar)
    lines.append((places['A'], places['B']))
    if isinstance(mechanism, SliderCrank):
        return lines, (places['B'], np.array([1.0, 0.0]))
    return lines + [(places['O_4'], places['B'])], None


def _block(axes, at, direction, half):
    corners = [at + half * (a * direction + 0.55 * b * turned(1.0, direction))
               for a, b in ((1, 1), (1, -1), (-1, -1), (-1, 1))]
    axes.fill(*zip(*corners), fc='0.95', ec='k', lw=1.2, zorder=4)


def _ground(axes, at, half):
    axes.fill(at[0] + half * np.array([0.0, -1.0, 1.0]), at[1] + half * np.array([0.0, -1.6, -1.6]), fc='w', ec='k',
              lw=1.1, zorder=1)
    axes.plot(at[0] + half * np.array([-1.6, 1.6]), [at[1] - 1.6 * half] * 2, color='k', lw=1.4, zorder=1)


def make_figure(mechanism, motion, loads=None, title=''):
    """Return a matplotlib Figure of three panels: mechanism, velocity and acceleration polygon."""
    need_matplotlib('draw')
    import matplotlib
    from matplotlib.figure import Figure
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(12.6, 5.0))
        axes = figure.subplots(1, 3)
        figure.subplots_adjust(left=0.01, right=0.99, bottom=0.24, top=0.93 - 0.04 * title.count('\n'), wspace=0.06)
        draw_mechanism(axes[0], mechanism, motion, loads, title)
        draw_polygon(axes[1], velocity_polygon(mechanism, motion), 'velocities', 'm/s')
        draw_polygon(axes[2], acceleration_polygon(mechanism, motion), 'accelerations', 'm/s$^2$')
    return figure


def save(figure, path):
    """Write a figure as .svg, .pdf, .png, ... and return the path; the same bytes for the same figure."""
    import matplotlib
    path = Path(path)
    if not path.suffix:
        path = path.with_name(path.name + '.png')
    try:
        with matplotlib.rc_context(STYLE):
            figure.savefig(path, dpi=200, **({'metadata': {'Date': None}} if path.suffix == '.svg' else {}))
    except OSError as error:
        raise CannotDraw(f'{path}: {error.strerror}') from None
    except ValueError as error:
        raise CannotDraw(f'{path}: {error}') from None
    return path
