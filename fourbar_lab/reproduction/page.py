# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The page of ``fourbar reproduce --html``: all rows, and the figures from computed values."""
from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from datetime import date
from functools import partial
from html import escape
from math import tau
from pathlib import Path
from typing import Any, TYPE_CHECKING

from fourbar_lab.drawing.figure import make_figure, make_panels, Units, writing
from fourbar_lab.reproduction import published
from fourbar_lab.reproduction.documents import COLUMNS, Section, summary, VERDICTS
from fourbar_ros import __version__, CROSSED, find_extrema, Mechanism, OPEN
from fourbar_ros.mechanisms.picture import Points
from fourbar_ros.numerics.arrays import Array
import numpy as np

if TYPE_CHECKING:      # drawings alone need it
    from fourbar_lab.drawing.paper import PaperFigure as Figure

Captioned = tuple['Figure', str]                # with its caption

PAGE = """\
<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>The two source documents, recomputed</title>
<style>
body {{ font-family: sans-serif; margin: 2em auto; max-width: 64em; }}
th, td {{ padding-right: 1em; text-align: left; vertical-align: top; white-space: pre-wrap; }}
:is(th, td):is(:nth-child(2), :nth-child(3), :nth-child(4)) {{ text-align: right; }}
svg {{ max-width: 100%; height: auto; }}
</style></head>
<body><h1>The two source documents, recomputed</h1>
<p>Lecture slide set 7 (Hayes, Irani, Afagh, Langlois) and the paper of Hayes, Hninn and Irani:
printed value, ours, difference, verdict. {summary}.</p>
<p>fourbar_ros {version}, {when}.</p>
<dl>{legend}</dl>
{body}
</body></html>
"""
FEET = Units(('in', published.INCH), ('ft/s', published.FOOT), ('ft/s$^2$', published.FOOT))


def pose(linkage: Mechanism, inputs: tuple[Any, ...], title: str, caption: str,
         points: Points | None = None, letters: Mapping[str, str] = {}, units: Units = FEET
         ) -> Captioned:
    """Draw a linkage at an input with its rates; ``letters``: of its joints in the slides."""
    return make_figure(linkage, linkage.motion(*inputs), None, title, points, letters,
                       units), caption


def example_7_7() -> Captioned:
    """Draw alpha4, and omega4 eight times as large as in the slides, over two turns."""
    theta1, curves, circles = np.linspace(-tau, tau, 1441), [], []
    for mode in (CROSSED, OPEN):
        linkage = published.EXAMPLE_7_7.in_mode(mode)
        motion = linkage.motion(theta1, 10.0)
        curves += [(rf'$\alpha_4$, mode {mode} [rad/s$^2$]', theta1, motion.alpha4),
                   (rf'$8\,\omega_4$, mode {mode} [rad/s]', theta1, 8.0 * motion.omega4)]
        for extremum in find_extrema(linkage, ('alpha4', 'omega4'), 10.0):
            size = 8.0 if extremum.quantity == 'omega4' else 1.0
            circles += [(extremum.theta1 - turn, size * extremum.value) for turn in (0.0, tau)]
    caption = ('Where ω4 is extreme, α4 is zero; mode 2 is the mirror image of mode 1. Circles: '
               'the extrema found.')
    return _circled({'': curves}, [circles]), caption


def paper_figure_3() -> Captioned:
    theta1, linkage, speed = np.linspace(0.0, tau, 1441), published.PAPER, published.PAPER_SPEED
    motion = linkage.motion(theta1, speed)
    panels = {r'$\omega_4$ [rad/s]': [('', theta1, motion.omega4)],
              r'$\alpha_4$ [rad/s$^2$]': [('', theta1, motion.alpha4)]}
    circles = [[(extremum.theta1, extremum.value)
                for extremum in find_extrema(linkage, (name,), speed)]
               for name in ('omega4', 'alpha4')]
    caption = "The paper's Figure 3: assembly mode 2 at 25 rad/s. Circles: the extrema of Table 2."
    return _circled(panels, circles), caption


def paper_figure_4() -> Captioned:
    """Draw the shaking force and moment, right and as the paper prints them, with m v for m a."""
    printed = published.wrong_curves()
    theta1, loads = printed.theta1, published.THIN.loads(printed.theta1, published.PAPER_SPEED)
    panels = {'shaking force [N]': [('m a', theta1, loads.shaking_force),
                                    ('m v, as printed', theta1, printed.force)],
              '|shaking moment| [N m]': [('m a, arm a4', theta1, np.abs(loads.shaking_moment)),
                                         ('m v, arm 0.01 m, as printed', theta1,
                                          printed.moment)]}
    figure = _circled(panels, [[(x[y.argmax()], y.max()) for _, x, y in curves]
                               for curves in panels.values()])
    for axes in figure.axes:
        axes.set(yscale='log', ylim=(1.0, None))        # the curves pass through zero
    return figure, ("The paper's Figure 4: computed correctly and as printed, on a logarithmic "
                    'scale. Circles: the largest values.')


def _circled(panels: Mapping[str, Sequence[tuple[str, Array, Array]]],
             circles: Sequence[Sequence[tuple[float, float]]]) -> Figure:
    figure = make_panels(panels, r'$\theta_1$ [rad]', '')
    for axes, points in zip(figure.axes, circles):
        axes.plot(*zip(*points), 'o', ms=6, mfc='none', mec='k')
    return figure


FIGURES: dict[str, Callable[[], Captioned]] = {
    'example_7_2': partial(
        pose, published.EXAMPLE_7_2, published.GIVEN_7_2,
        'slider-crank at 30 deg, points and units of the slides',
        'Velocity and acceleration polygons.', letters={'O_1': 'O_2', 'A': 'B', 'B': 'C'}),
    'example_7_3': partial(
        pose, published.EXAMPLE_7_3, published.GIVEN_7_3,
        '4R at 120 deg, points and units of the slides', 'Velocity and acceleration polygons.',
        published.POINTS_7_3, {'O_1': 'A', 'A': 'B', 'B': 'C', 'O_4': 'D'}),
    'example_7_5': partial(
        pose, published.EXAMPLE_7_5, published.GIVEN_7_5,
        'inverted slider-crank at 30 deg, points and units of the slides',
        'Q is the point of the bar under A; the Coriolis term turns V_rel by 90° in the sense of '
        'the bar.', letters={'O_1': 'E', 'O_4': 'D'}),
    'example_7_6': partial(
        pose, published.EXAMPLE_7_6, published.GIVEN_7_6,
        '4R at 60 deg, 10 rad/s, 100 rad/s², assembly mode 2',
        'The slides solve this example with the input-output equations, in any unit of length.',
        units=Units()),
    'example_7_7': example_7_7, 'paper_figure_3': paper_figure_3,
    'paper_figure_4': paper_figure_4}


def page(sections: Sequence[Section], when: str) -> str:
    legend = ''.join(f'<dt>{name}</dt><dd>{meaning}</dd>' for name, meaning in VERDICTS.items())
    return PAGE.format(summary=summary(sections), version=__version__, when=when, legend=legend,
                       body='\n'.join(map(_section, sections)))


def _section(section: Section) -> str:
    """Return a section as HTML: its table, its reasons, its figure."""
    def row(tag: str, cells: Sequence[str]) -> str:
        return '<tr>' + ''.join(f'<{tag}>{escape(cell)}</{tag}>' for cell in cells) + '</tr>'

    text = [f'<h2>{escape(section.title)}</h2>', '<table>',
            row('th', [head.rstrip('>') for head in COLUMNS]),
            *(row('td', cells) for cells in section.cells),
            '</table>', '<ol>', *(f'<li>{escape(reason)}</li>' for reason in section.footnotes),
            '</ol>']
    if section.figure:
        figure, caption = FIGURES[section.figure]()
        figure.style |= {'svg.hashsalt': section.figure}    # no two figures of a page share names
        text.append(f'<figure>{figure._repr_svg_()}<figcaption>{escape(caption)}</figcaption>'
                    '</figure>')
    return '\n'.join(text)


def write_report(sections: Sequence[Section], path: str | Path) -> None:
    text = page(sections, date.today().isoformat())
    with writing(Path(path)):
        Path(path).write_text(text, encoding='utf-8')
