# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Draw the figures of the documents from computed values, for ``fourbar reproduce --html``."""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from datetime import date
import html
from io import StringIO
from math import tau
from pathlib import Path
import re
from typing import TYPE_CHECKING

from fourbar_lab.drawing.figure import CannotDraw, make_figure, need_matplotlib, STYLE, Units
from fourbar_lab.reproduction import published, verdicts
from fourbar_lab.reproduction.documents import cells, COLUMNS, footnotes, Section, summary
from fourbar_ros import __version__
from fourbar_ros.extrema.find import find_extrema
from fourbar_ros.mechanisms.contract import CROSSED, OPEN
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.parts import NamedFields
from fourbar_ros.mechanisms.picture import Points
from fourbar_ros.numerics.arrays import Array
import numpy as np

if TYPE_CHECKING:      # drawings alone need it
    from matplotlib.figure import Figure

Captioned = tuple['Figure', str]                 # with its caption
Curve = tuple[Array, Array, str, str, str]      # x, y, label, line style, colour

CSS = """\
body { font: 15px/1.45 system-ui, sans-serif; max-width: 64em; margin: 2em auto; padding: 0 1em;
  color: #222; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
div.wide { overflow-x: auto; }
th, td { padding: 0.15em 0.9em 0.15em 0; text-align: left; border-bottom: 1px solid #ddd;
  vertical-align: top; }
td.number, th.number { text-align: right; white-space: nowrap; }
tr.wrong td { background: #fbeee6; } tr.copy td, tr.assumed td { background: #eef3f8; }
  tr.differs td { background: #f6c6c6; }
td.part { padding-left: 1.2em; } nav ul { columns: 2; } dt { font-weight: 600; } dd { margin: 0 0
  0.3em 1.5em; }
figure { margin: 1em 0; } svg { max-width: 100%; height: auto; } figcaption, ol { color: #555;
  font-size: 0.92em; }
@media print { section { break-inside: avoid; } nav { break-after: page; } }
"""
STYLES = {verdicts.MISPRINT: 'wrong', verdicts.WRONG: 'wrong', verdicts.GARBLED: 'copy',
          verdicts.ASSUMED: 'assumed', verdicts.MISSING: 'assumed', verdicts.DIFFERS: 'differs'}
POLYGONS = 'Velocity and acceleration polygons.'
FEET = Units(('in', published.INCH), ('ft/s', published.FOOT), ('ft/s$^2$', published.FOOT))


def _drawing(linkage: Mechanism, motion: NamedFields, title: str, caption: str,
             points: Points | None = None, names: Mapping[str, str] | None = None,
             units: Units = FEET) -> Captioned:
    """Return a mechanism with its polygons; ``names``: {our name of a joint: the slides'}."""
    return make_figure(linkage, motion, None, title, points, names, units), caption


def example_7_2() -> Captioned:
    return _drawing(published.EXAMPLE_7_2, published.EXAMPLE_7_2.motion(*published.GIVEN_7_2),
                    'slider-crank at 30 deg, points and units of the slides', POLYGONS,
                    names={'O_1': 'O_2', 'A': 'B', 'B': 'C'})


def example_7_3() -> Captioned:
    return _drawing(published.EXAMPLE_7_3, published.EXAMPLE_7_3.motion(*published.GIVEN_7_3),
                    '4R at 120 deg, points and units of the slides', POLYGONS,
                    published.POINTS_7_3, {'O_1': 'A', 'A': 'B', 'B': 'C', 'O_4': 'D'})


def example_7_5() -> Captioned:
    return _drawing(published.EXAMPLE_7_5, published.EXAMPLE_7_5.motion(*published.GIVEN_7_5),
                    'inverted slider-crank at 30 deg, points and units of the slides',
                    'Q is the point of the bar under A; the Coriolis term turns V_rel by 90° in '
                    'the sense of the bar.', names={'O_1': 'E', 'O_4': 'D'})


def example_7_6() -> Captioned:
    return _drawing(published.EXAMPLE_7_6, published.EXAMPLE_7_6.motion(*published.GIVEN_7_6),
                    '4R at 60 deg, 10 rad/s, 100 rad/s², assembly mode 2',
                    'The slides solve this example with the input-output equations, in any unit '
                    'of length.', units=Units())


def example_7_7() -> Captioned:
    """Draw alpha4, and omega4 eight times as large as in the slides, over two turns."""
    theta1 = np.linspace(-tau, tau, 1441)
    curves, marks = [], []
    for mode, style in ((CROSSED, '-'), (OPEN, '--')):
        linkage = published.EXAMPLE_7_7.in_mode(mode)
        motion = linkage.motion(theta1, 10.0)
        curves += [(theta1, motion.alpha4, rf'$\alpha_4$, mode {mode} [rad/s$^2$]', style, 'C3'),
                   (theta1, 8.0 * motion.omega4, rf'$8\,\omega_4$, mode {mode} [rad/s]', style,
                    'C0')]
        for extremum in find_extrema(linkage, ('alpha4', 'omega4'), 10.0):
            factor = 8.0 if extremum.quantity == 'omega4' else 1.0
            marks += [(x, factor * extremum.value)
                      for x in (extremum.theta1, extremum.theta1 - tau)]
    return (_curves([curves], [''], [marks]),
            'Where ω4 is extreme, α4 is zero; mode 2 is the mirror image of mode 1. Circles: the '
            'extrema found.')


def paper_figure_3() -> Captioned:
    """Draw omega4 and alpha4 of the paper's linkage over a turn."""
    theta1 = np.linspace(0.0, tau, 1441)
    motion = published.PAPER.motion(theta1, published.PAPER_SPEED)
    marks = [[(e.theta1, e.value) for e in find_extrema(published.PAPER, (name,),
                                                        published.PAPER_SPEED)]
             for name in ('omega4', 'alpha4')]
    return (_curves([[(theta1, motion.omega4, '', '-', 'C0')],
                     [(theta1, motion.alpha4, '', '-', 'C3')]],
                    [r'$\omega_4$ [rad/s]', r'$\alpha_4$ [rad/s$^2$]'], marks),
            "The paper's Figure 3: assembly mode 2 at 25 rad/s. Circles: the extrema of Table 2.")


def paper_figure_4() -> Captioned:
    """Draw the shaking force and moment, right and as the paper prints them."""
    theta1, force, moment, _ = published.wrong_curves()
    loads = published.THIN.loads(theta1, published.PAPER_SPEED)
    curves = [[(theta1, loads.shaking_force, 'm a', '-', 'k'),
               (theta1, force, 'm v, as printed', '--', 'C3')],
              [(theta1, np.abs(loads.shaking_moment), 'm a, arm a4', '-', 'k'),
               (theta1, moment, 'm v, arm 0.01 m, as printed', '--', 'C3')]]
    marks = [[(x[np.argmax(y)], np.max(y)) for x, y, *_ in panel] for panel in curves]
    return (_curves(curves, ['shaking force [N]', '|shaking moment| [N m]'], marks,
                    with_logarithmic=True),
            "The paper's Figure 4: computed correctly (solid) and as printed (dashed); above "
            'linear, below logarithmic scale. '
            'Circles: the largest values.')


def _curves(panels: Sequence[Sequence[Curve]], titles: Sequence[str],
            marks: Sequence[Sequence[tuple[float, float]]] = (), with_logarithmic: bool = False
            ) -> Figure:
    """
    Return a Figure with one panel for each list of curves over theta1 [rad].

    A curve is (x, y, label, line style, color). ``marks``: points (x, y) to circle in each panel;
    ``with_logarithmic``: repeat all panels below on a logarithmic scale.
    """
    import matplotlib
    from matplotlib.figure import Figure
    scales = ('linear', 'log') if with_logarithmic else ('linear',)
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(12.6, 4.2 * len(scales)), layout='constrained')
        grid = figure.subplots(len(scales), len(panels), squeeze=False)
        for row, scale in zip(grid, scales):
            for axes, curves, title, points in zip(row, panels, titles,
                                                   marks or [()] * len(panels)):
                for x, y, label, style, color in curves:
                    axes.plot(x, y, style, color=color, lw=1.5, label=label)
                if points:
                    axes.plot(*zip(*points), 'o', ms=6, mfc='none', mec='k')
                axes.set(title=title, xlabel=r'$\theta_1$ [rad]',
                         xlim=(curves[0][0][0], curves[0][0][-1]))
                axes.grid(alpha=0.3)
                if any(label for _, _, label, _, _ in curves):
                    axes.legend(loc='best')
                if scale == 'log':
                    axes.set_yscale('log')
                    axes.set_ylim(1.0)
    return figure


def svg(name: str) -> tuple[str, str]:
    """Return (SVG text, caption) of a figure by name; the text is the same every time."""
    import matplotlib
    figure, caption = globals()[name]()
    file = StringIO()
    with matplotlib.rc_context({**STYLE, 'svg.hashsalt': name}):
        figure.savefig(file, format='svg', metadata={'Date': None})
    text = file.getvalue()
    return text[text.index('<svg'):], caption           # without the head of an XML file


def page(sections: Sequence[Section], when: str | None = None) -> str:
    """
    Return the whole report as one self-contained HTML page.

    ``when`` is the date on it, by default today.
    """
    need_matplotlib('reproduce --html')
    body = '\n'.join(_section(section, i) for i, section in enumerate(sections))
    contents = ''.join(f'<li><a href="#s{i}">{html.escape(section.title)}</a></li>'
                       for i, section in enumerate(sections))
    legend = ''.join(f'<dt>{name}</dt><dd>{meaning}</dd>'
                     for name, meaning in verdicts.VERDICTS.items())
    return ('<!doctype html>\n<html lang="en"><head><meta charset="utf-8">'
            '<meta name="viewport" content="width=device-width"><title>The two source documents, '
            f'recomputed</title>\n<style>\n{CSS}</style></head>\n<body>\n<h1>The two source '
            'documents, recomputed</h1>\n<p>Lecture slide set 7 (Hayes, Irani, Afagh, Langlois) '
            'and the paper of Hayes, Hninn and Irani: printed value, ours, difference, verdict. '
            f'{summary(sections)}.</p>\n<p>fourbar_ros {__version__}, '
            f'{when or date.today().isoformat()}.</p>\n<h2>Verdicts</h2>\n<dl>{legend}</dl>\n'
            f'<nav><h2>Contents</h2>\n<ul>{contents}</ul></nav>\n{body}\n</body></html>\n')


SYMBOL = re.compile(r'\b(theta|omega|alpha)(\d)')
GREEK = {'theta': 'θ', 'omega': 'ω', 'alpha': 'α'}


def typeset(text: str) -> str:
    """Return a text as HTML: theta1, V_A, A_C/B with their indices, s^2 with its power."""
    text = SYMBOL.sub(lambda match: f'{GREEK[match[1]]}<sub>{match[2]}</sub>', html.escape(text))
    text = re.sub(r'\b([AV])_([A-Z](?:/[A-Z])?)\b', r'\1<sub>\2</sub>', text)
    return re.sub(r'\b(m|s|ft|v\d)\^(\d)', r'\1<sup>\2</sup>', text)


def _section(section: Section, number: int) -> str:
    """Return a section as HTML: its table, numbered reasons below, and its figure."""
    notes = footnotes(section)
    heads = ''.join(f'<th{_kind(head)}>{html.escape(head.rstrip(">"))}</th>' for head in COLUMNS)
    rows = []
    for row in section.rows:
        style = f' class="{STYLES[row.verdict]}"' if row.verdict in STYLES else ''
        note = f'({notes[row.reason]})' if row.reason else ''
        texts = (*cells(row), note)
        kinds = [' class="part"' if i == 0 and text.startswith(' ') else _kind(head)
                 for i, (head, text) in enumerate(zip(COLUMNS, texts))]
        rows.append(f'<tr{style}>' + ''.join(f'<td{kind}>{typeset(text)}</td>'
                                             for kind, text in zip(kinds, texts)) + '</tr>')
    text = (f'<section id="s{number}"><h2>{typeset(section.title)}</h2>\n<div '
            f'class="wide"><table><tr>{heads}</tr>\n'
            + '\n'.join(rows) + '\n</table></div>')
    if notes:
        text += '\n<ol>' + ''.join(f'<li>{typeset(reason)}</li>' for reason in notes) + '</ol>'
    if section.figure:
        picture, caption = svg(section.figure)
        text += f'\n<figure>{picture}<figcaption>{html.escape(caption)}</figcaption></figure>'
    return text + '</section>'


def _kind(head: str) -> str:
    return ' class="number"' if head.endswith('>') else ''


def write_page(sections: Sequence[Section], path: str | Path) -> None:
    """Write the page to a file."""
    try:
        Path(path).write_text(page(sections), encoding='utf-8')
    except OSError as error:
        raise CannotDraw(f'{path}: {error.strerror}') from None
