"""The figures of the two documents, drawn from our values, and the page of ``fourbar reproduce --html``."""
from __future__ import annotations

import html
from io import StringIO
from math import tau
from pathlib import Path

import numpy as np

from . import published
from .core import CROSSED, OPEN
from .draw import STYLE, CannotDraw, make_figure, need_matplotlib
from .reproduce import COLUMNS, MISPRINT, cells, footnotes, summary

CSS = """\
body { font: 15px/1.45 system-ui, sans-serif; max-width: 62em; margin: 2em auto; padding: 0 1em; color: #222; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
th, td { padding: 0.15em 0.9em 0.15em 0; text-align: left; border-bottom: 1px solid #ddd; vertical-align: top; }
td.number, th.number { text-align: right; white-space: nowrap; }
tr.misprint td { background: #fbeee6; } tr.differs td { background: #f6c6c6; }
figure { margin: 1em 0; } svg { max-width: 100%; height: auto; } figcaption, ol { color: #555; font-size: 0.92em; }
@media print { section { break-inside: avoid; } }
"""


def example_7_2():
    motion = published.EXAMPLE_7_2.motion(*published.GIVEN_7_2)
    return make_figure(published.EXAMPLE_7_2, motion, None, 'slider-crank at 30 deg'), 'The slides call A B and B C.'


def example_7_3():
    motion = published.EXAMPLE_7_3.motion(*published.GIVEN_7_3)
    return make_figure(published.EXAMPLE_7_3, motion, None, '4R at 120 deg'), 'The slides call A B and B C.'


def example_7_5():
    motion = published.EXAMPLE_7_5.motion(*published.GIVEN_7_5)
    return (make_figure(published.EXAMPLE_7_5, motion, None, 'inverted slider-crank at 30 deg'),
            'Q is the point of the bar under A; the Coriolis term turns V_rel by 90 deg in the sense of the bar.')


def example_7_7():
    theta1 = np.linspace(-tau, tau, 1441)
    curves = []
    for mode, style in ((CROSSED, '-'), (OPEN, '--')):
        motion = published.EXAMPLE_7_7.in_mode(mode).motion(theta1, 10.0)
        curves += [(theta1, motion.alpha4, f'alpha4, mode {mode} [rad/s$^2$]', style, 'C3'),
                   (theta1, 8.0 * motion.omega4, f'8 omega4, mode {mode} [rad/s]', style, 'C0')]
    return _curves([curves], ['']), 'At the extremes of omega4 alpha4 is zero; mode 2 is the mirror image of mode 1.'


def paper_figure_3():
    theta1 = np.linspace(0.0, tau, 1441)
    motion = published.PAPER.motion(theta1, published.PAPER_SPEED)
    return (_curves([[(theta1, motion.omega4, '', '-', 'C0')], [(theta1, motion.alpha4, '', '-', 'C3')]],
                    ['omega4 [rad/s]', 'alpha4 [rad/s$^2$]']), 'The paper\'s Figure 3: assembly mode 2 at 25 rad/s.')


def paper_figure_4():
    theta1, force, moment, _ = published.wrong_curves()
    loads = published.THIN.loads(theta1, published.PAPER_SPEED)
    return (_curves([[(theta1, loads.shaking_force, 'm a', '-', 'k'), (theta1, force, 'm v, as printed', '--', 'C3')],
                     [(theta1, np.abs(loads.shaking_moment), 'm a, arm a4', '-', 'k'),
                      (theta1, moment, 'm v, arm 0.01 m, as printed', '--', 'C3')]],
                    ['shaking force [N]', '|shaking moment| [N m]']),
            'The paper\'s Figure 4: as it must be, and as the paper has it (logarithmic).')


def _curves(panels, titles):
    """Return a Figure with one panel for each list of (x, y, label, line style, color) over theta1 [rad]."""
    import matplotlib
    from matplotlib.figure import Figure
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(12.6, 4.2), layout='constrained')
        for axes, curves, title in zip(np.ravel(figure.subplots(1, len(panels))), panels, titles):
            for x, y, label, style, color in curves:
                axes.plot(x, y, style, color=color, lw=1.5, label=label)
            axes.set(title=title, xlabel='theta1 [rad]', xlim=(x[0], x[-1]))
            axes.grid(alpha=0.3)
            if any(label for _, _, label, _, _ in curves):
                axes.legend(loc='best')
            if 'shaking' in title:
                axes.set_yscale('log')
                axes.set_ylim(1.0)
    return figure


def svg(name):
    """Return (SVG text, caption) of a figure by name: the same text every time."""
    import matplotlib
    figure, caption = globals()[name]()
    text = StringIO()
    with matplotlib.rc_context({**STYLE, 'svg.hashsalt': name}):
        figure.savefig(text, format='svg', metadata={'Date': None})
    return text.getvalue().partition('<svg')[1] + text.getvalue().partition('<svg')[2], caption


def page(sections):
    """Return the whole report as one self-contained HTML page."""
    need_matplotlib('reproduce --html')
    body = '\n'.join(_section(section) for section in sections)
    return ('<!doctype html>\n<html lang="en"><head><meta charset="utf-8"><title>The two source documents, recomputed'
            f'</title>\n<style>\n{CSS}</style></head>\n<body>\n<h1>The two source documents, recomputed</h1>\n'
            '<p>Lecture slide set 7 (Hayes, Irani, Afagh, Langlois) and the paper of Hayes, Hninn and Irani: '
            f'printed value, ours, difference, verdict. {summary(sections)}.</p>\n{body}\n</body></html>\n')


def _section(section):
    notes = footnotes(section)
    heads = ''.join(f'<th{_kind(head)}>{html.escape(head.rstrip(">"))}</th>' for head in COLUMNS)
    rows = []
    for row in section.rows:
        style = ' class="misprint"' if row.verdict == MISPRINT else ' class="differs"' if row.verdict.isupper() else ''
        note = f'({notes[row.reason]})' if row.reason else ''
        rows.append(f'<tr{style}>' + ''.join(f'<td{_kind(head)}>{html.escape(text)}</td>'
                                            for head, text in zip(COLUMNS, (*cells(row), note))) + '</tr>')
    text = (f'<section><h2>{html.escape(section.title)}</h2>\n<table><tr>{heads}</tr>\n' + '\n'.join(rows)
            + '\n</table>')
    if notes:
        text += '\n<ol>' + ''.join(f'<li>{html.escape(reason)}</li>' for reason in notes) + '</ol>'
    if section.figure:
        picture, caption = svg(section.figure)
        text += f'\n<figure>{picture}<figcaption>{html.escape(caption)}</figcaption></figure>'
    return text + '</section>'


def _kind(head):
    return ' class="number"' if head.endswith('>') else ''


def write_page(sections, path):
    """Write the page to a file."""
    try:
        Path(path).write_text(page(sections))
    except OSError as error:
        raise CannotDraw(f'{path}: {error.strerror}') from None
