# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""What the pages of measurements share: tables and figures."""
from . import ROOT

is_written = False      # whether docs/bench is written: --write


def table(head, rows):
    """Print a Markdown table and an empty line."""
    for line in (head, ['---'] * len(head), *rows):
        print('| ' + ' | '.join(map(str, line)) + ' |')
    print()


def figure(rows=1, columns=1, **arguments):
    """Return matplotlib's figure and axes, made for pictures that are the same on every run."""
    import matplotlib
    matplotlib.use('Agg')
    matplotlib.rcParams['svg.hashsalt'] = 'fourbar'
    from matplotlib import pyplot
    return pyplot.subplots(rows, columns, layout='constrained', **arguments)


def save(drawing, name):
    """Write a picture of docs/bench, with ``--write`` alone."""
    from matplotlib import pyplot
    if is_written:
        drawing.savefig(ROOT / 'docs' / 'bench' / f'{name}.svg', metadata={'Date': None})
    pyplot.close(drawing)
