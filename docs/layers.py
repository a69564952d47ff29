# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Draw docs/layers.svg, the picture of docs/architecture.md: ``python docs/layers.py``.

The rows are the layers in pyproject.toml, the texts the docstrings of the folders, the
arrows the imports in the code, without those that follow from others.
"""
import ast
from pathlib import Path
import re
from textwrap import fill

import matplotlib

matplotlib.use('svg')

from matplotlib.patches import FancyArrowPatch, FancyBboxPatch  # noqa: E402, I100
import matplotlib.pyplot as plt  # noqa: E402

ROOT = Path(__file__).resolve().parent.parent
PACKAGES = ROOT / 'fourbar_ros', ROOT / 'fourbar_lab'
OUTPUT = ROOT / 'docs' / 'layers.svg'
WIDTH, HEIGHT, ROW = 3.1, 0.72, 1.25            # [inch] of a box; from row to row
COLORS = ('#eef3fa', '#e3ecf7', '#d7e5f4', '#ccdef0', '#c1d7ed', '#b5d0e9', '#aac9e6', '#9ec2e2')


def place(folder):
    """Return the path of a folder of either package, or None."""
    return next((package / folder for package in PACKAGES if (package / folder).is_dir()), None)


def layers():
    """Return the rows of folders from the bottom up, errors and optional left out."""
    text = (ROOT / 'pyproject.toml').read_text(encoding='utf-8')
    listed = ast.literal_eval(re.search(r'^layers = (\[.*?^\])', text, re.M | re.S)[1])
    listed.remove('fourbar_lab.cli')        # beside the other cli there is no room for its own
    rows = [[module.split('.')[1] for module in row.split(' | ')
             if (ROOT / module.replace('.', '/')).is_dir()] for row in reversed(listed)]
    return [row for row in rows if row]


def imports(folder, folders):
    """Return the folders that the modules of a folder import from."""
    found = set()
    for path in place(folder).rglob('*.py'):
        for node in ast.walk(ast.parse(path.read_text(encoding='utf-8'))):
            module = getattr(node, 'module', None) if isinstance(node, ast.ImportFrom) else None
            if module and module.startswith(('fourbar_ros.', 'fourbar_lab.')):
                found.add(module.split('.')[1])
    return (found & set(folders)) - {folder}


def arrows(folders):
    """Return the pairs (importing, imported) that do not follow from other pairs."""
    direct = {folder: imports(folder, folders) for folder in folders}

    def reached(folder, seen=()):
        return set().union(*({one} | reached(one, (*seen, folder))
                             for one in direct[folder] if one not in seen))

    return [(one, other) for one in folders for other in sorted(direct[one])
            if not any(other in reached(via) for via in direct[one] - {other})]


def text_of(folder):
    """Return the first sentence of a folder's docstring, without its full stop."""
    doc = ast.get_docstring(ast.parse((place(folder) / '__init__.py').read_text('utf-8')))
    return (doc or '').split('\n')[0].rstrip('.').replace('``', '')


def draw():
    """Write the picture."""
    rows = layers()
    folders = [folder for row in rows for folder in row]
    width = max(map(len, rows)) * (WIDTH + 0.4) + 0.2
    figure, axes = plt.subplots(figsize=(width, len(rows) * ROW + 0.1))
    axes.set(xlim=(0.0, width), ylim=(-0.2, len(rows) * ROW - 0.3))
    axes.axis('off')
    figure.subplots_adjust(0.0, 0.0, 1.0, 1.0)
    at = {}
    for level, row in enumerate(rows):
        start = 0.5 * (width - len(row) * (WIDTH + 0.4) + 0.4)
        for place, folder in enumerate(row):
            x, y = start + place * (WIDTH + 0.4), level * ROW
            at[folder] = x + 0.5 * WIDTH, y
            axes.add_patch(FancyBboxPatch((x, y), WIDTH, HEIGHT, 'round,pad=0.04',
                                          facecolor=COLORS[level % len(COLORS)],
                                          edgecolor='#335', zorder=2))
            axes.text(x + 0.5 * WIDTH, y + 0.52, f'{folder}/', ha='center', weight='bold',
                      size=12, zorder=3)
            axes.text(x + 0.5 * WIDTH, y + 0.24, fill(text_of(folder), 48), ha='center',
                      va='center', size=8, zorder=3)
    for one, other in arrows(folders):
        (x, y), (u, v) = at[one], at[other]
        if y == v:                                  # neighbours in a row
            side = 0.5 * WIDTH + 0.05
            toward = side if u > x else -side
            ends = (x + toward, y + 0.36), (u - toward, v + 0.36)
        else:
            ends = (x, y - 0.05), (u, v + HEIGHT + 0.05)
        axes.add_patch(FancyArrowPatch(*ends, arrowstyle='-|>', mutation_scale=11, shrinkA=0,
                                       shrinkB=0, color='#667', zorder=1))
    figure.savefig(OUTPUT, metadata={'Date': None})


if __name__ == '__main__':
    plt.rcParams.update({'svg.fonttype': 'none', 'svg.hashsalt': 'fourbar_ros',
                         'font.family': 'sans-serif'})
    draw()
