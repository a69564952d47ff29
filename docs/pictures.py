# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Draw conventions, sliders and the axis in docs, .svg and .png: ``python docs/pictures.py``.

Poses come from the core; black and white; the same bytes on every run with the same matplotlib.
"""
from pathlib import Path
import sys

import matplotlib

matplotlib.use('agg')

import matplotlib.pyplot as plt  # noqa: E402

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT), str(ROOT / 'docs')]

import axis  # noqa: E402, I100
import conventions  # noqa: E402
import sliders  # noqa: E402

STYLE = {'font.family': 'STIXGeneral', 'mathtext.fontset': 'stix', 'font.size': 12,
         'svg.hashsalt': 'fourbar_ros', 'svg.fonttype': 'path'}


def main():
    """Draw and save."""
    with plt.rc_context({**plt.rcParamsDefault, **STYLE, 'backend': 'agg'}):
        for picture in (axis, conventions, sliders):
            figure = plt.figure(figsize=picture.SIZE)
            picture.draw(figure)
            save(figure, picture.__name__)


def save(figure, name):
    """Save a picture."""
    figure.savefig(ROOT / 'docs' / f'{name}.svg', metadata={'Date': None, 'Creator': None})
    if name != 'axis':      # no page has it
        figure.savefig(ROOT / 'docs' / f'{name}.png', dpi=160, metadata={'Software': None})
    plt.close(figure)


if __name__ == '__main__':
    main()
