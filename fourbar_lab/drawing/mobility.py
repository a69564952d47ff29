# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The mobility of a four-bar in one picture: it is a point in an octahedron.

All four-bars that can be closed fill |A1| + |C1| + |D1| <= B2 = a1 + a2 + a3 + a4. A1, C1, D1 are
factors of the input-output equation (sums of lengths with signs). On a face of the octahedron a
link has length zero or the loop is stretched. On the planes A1 = 0, C1 = 0, D1 = 0 lie the change
points; the eight octants between them are the eight Grashof classes.
"""
from __future__ import annotations

from itertools import combinations
from typing import NamedTuple

from fourbar_ros.mechanisms.half_angle import bilinear_factors, Factors
from fourbar_ros.mechanisms.mechanism import Mechanism

AXES = {'A1': 'a1 + a4 = a2 + a3', 'C1': 'a1 + a3 = a2 + a4', 'D1': 'a1 + a2 = a3 + a4'}
SIZE, HALF, MIDDLE = (340.0, 290.0), 100.0, (160.0, 122.0)      # [px] picture, half axis, centre
# direction of each axis on the screen, seen from A1, C1, D1 < 0, where the crank-rockers are
SEEN = {'A1': (-0.92, -0.22), 'C1': (0.52, -0.36), 'D1': (0.0, 1.0)}
STYLE = """
.fb-octahedron text{font:italic 13px 'STIX Two Text',Georgia,serif;fill:currentColor}
.fb-octahedron line{stroke:currentColor;stroke-width:1;opacity:.55}
.fb-octahedron .hidden{stroke-dasharray:3 4;opacity:.3}
.fb-octahedron .own{fill:#2463a8;opacity:.22} .fb-octahedron .at{fill:#a02c2c}
.fb-octahedron .way{stroke:#a02c2c;stroke-width:2;opacity:1}
"""
WIDTH = 31      # letters of a bar of text


class Mobility(NamedTuple):
    """
    A linkage in the octahedron.

    Its nearest change point is ``AXES[nearest]``, at the distance ``abs(place[nearest])``.
    """

    factors: Factors                # the eight sums [m]
    place: dict[str, float]         # {'A1', 'C1', 'D1': the factor over the sum of the lengths}
    nearest: str                    # which of them is smallest


def mobility(linkage: Mechanism) -> Mobility | None:
    """Return the :class:`Mobility` of a four-bar, None of any other mechanism."""
    signs = linkage.MARGIN_SIGNS
    if len(signs) != len(AXES) or not all(map(all, signs)):      # a four-bar has three full rows
        return None
    a1, a2, a3, a4 = linkage.lengths
    factors = bilinear_factors(a1, a2, a3, a4)
    place = {name: getattr(factors, name) / factors.B2 for name in AXES}
    return Mobility(factors, place, min(place, key=lambda name: abs(place[name])))


def mobility_rows(linkage: Mechanism) -> list[tuple[str, str]]:
    """
    Return rows (name, text) of a table: the signs of the eight factors, and a bar for each axis.

    A bar as '---o---|-------  -0.5' shows where the linkage (o) is from the change point (|).
    """
    point = mobility(linkage)
    if not point:
        return []
    signs = [f'{name} {"0" if value == 0.0 else "+" if value > 0.0 else "-"}'
             for name, value in point.factors._asdict().items()]
    rows = [('factors', '  '.join(signs))]
    for name, value in point.place.items():
        bar = ['-'] * WIDTH
        bar[WIDTH // 2] = '|'
        bar[round((0.5 + 0.5 * value) * (WIDTH - 1))] = 'o'
        rows.append((name, f'{"".join(bar)}  {value:+.6f}'
                     + (f'  nearest change point: {AXES[name]}' if name == point.nearest else '')))
    return rows


def octahedron_svg(linkage: Mechanism) -> str:
    """
    Return the octahedron as SVG: the linkage, its octant, its way to the nearest change point.

    Empty for a mechanism that is no four-bar.
    """
    point = mobility(linkage)
    if not point:
        return ''
    corners = {(name, side): _pixel({name: side}) for name in AXES for side in (1.0, -1.0)}
    parts = []
    for (name, side), (other_name, other_side) in combinations(corners, 2):
        if name != other_name:           # opposite corners share no edge
            kind = 'hidden' if side + other_side > 0.0 else ''
            parts.append(_line(kind, corners[name, side], corners[other_name, other_side]))
    octant = [corners[name, 1.0 if value >= 0.0 else -1.0] for name, value in point.place.items()]
    points = ' '.join(f'{x:.1f},{y:.1f}' for x, y in octant)
    parts.append(f'<polygon class="own" points="{points}"/>')
    at = _pixel(point.place)
    parts.append(_line('way', at, _pixel({**point.place, point.nearest: 0.0})))
    parts.append(f'<circle class="at" cx="{at[0]:.1f}" cy="{at[1]:.1f}" r="4.5"/>')
    for name in AXES:
        for side, sign in ((-1.14, '-'), (1.14, '+')):
            x, y = _pixel({name: side})
            parts.append(f'<text x="{x:.1f}" y="{y + 4.0:.1f}" text-anchor="middle">{sign}{name}'
                         '</text>')
    for row, text in enumerate((linkage.classification, f'{abs(point.place[point.nearest]):.4f} '
                                f'of the perimeter from {AXES[point.nearest]}')):
        parts.append(f'<text x="6" y="{SIZE[1] - 24.0 + 18.0 * row:.0f}">{text}</text>')
    return (f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {SIZE[0]:g} {SIZE[1]:g}" '
            f'width="{SIZE[0]:g}" height="{SIZE[1]:g}" class="fb-octahedron">'
            f'<style>{STYLE}</style>{"".join(parts)}</svg>')


def _pixel(place: dict[str, float]) -> tuple[float, float]:
    """Return the pixel (x, y) of a place {axis: coordinate, -1 to 1} in the octahedron."""
    x, y = (sum(value * SEEN[name][i] for name, value in place.items()) for i in (0, 1))
    return MIDDLE[0] + HALF * x, MIDDLE[1] + HALF * y


def _line(kind: str, start: tuple[float, float], end: tuple[float, float]) -> str:
    return (f'<line class="{kind}" x1="{start[0]:.1f}" y1="{start[1]:.1f}" x2="{end[0]:.1f}" '
            f'y2="{end[1]:.1f}"/>')
