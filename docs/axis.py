# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Draw the collineation axis of the examples of both documents where their output is extreme."""
from math import degrees

from fourbar_lab.drawing.axis import draw_axis
from fourbar_lab.reproduction import published
from fourbar_ros import find_extrema

SIZE = (11.0, 8.6)                  # [inch]
EXAMPLES = (('7.2', published.EXAMPLE_7_2, 'maximum'), ('7.6', published.EXAMPLE_7_6, 'maximum'),
            ('7.7', published.EXAMPLE_7_7, 'minimum'), ('7.7', published.EXAMPLE_7_7, 'maximum'),
            ('paper', published.PAPER, 'minimum'), ('paper', published.PAPER, 'maximum'))


def draw(figure):
    """Draw a panel for each extremum."""
    for i, (name, linkage, kind) in enumerate(EXAMPLES):
        row, column = divmod(i, 3)
        axes = figure.add_axes((0.005 + 0.333 * column, 0.505 - 0.5 * row, 0.325, 0.455))
        quantity = linkage.outputs[0].coordinate.rate
        at, = (extremum.theta1 for extremum in find_extrema(linkage, (quantity,), 1.0)
               if extremum.place == 'interior' and extremum.kind == kind)
        symbol = r'\omega_4' if quantity == 'omega4' else r'\dot s'
        draw_axis(axes, linkage, linkage.motion(at, 1.0),
                  rf'{name}: {kind} of ${symbol}$, $\theta_1$ = {degrees(at):.2f}$\degree$')
