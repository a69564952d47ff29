# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The mobility of a four-bar: it is a point in an octahedron.

All four-bars that can be closed fill |A1| + |C1| + |D1| <= B2 = a1 + a2 + a3 + a4. A1, C1, D1 are
factors of the input-output equation (sums of lengths with signs). On a face of the octahedron a
link has length zero or the loop is stretched. On the planes A1 = 0, C1 = 0, D1 = 0 lie the change
points; the eight octants between them are the eight Grashof classes.
"""
from __future__ import annotations

from typing import NamedTuple

from fourbar_ros.mechanisms.loop import bilinear_factors, Factors
from fourbar_ros.mechanisms.mechanism import Mechanism

AXES = {'A1': 'a1 + a4 = a2 + a3', 'C1': 'a1 + a3 = a2 + a4', 'D1': 'a1 + a2 = a3 + a4'}


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
    """Return rows (name, text) of a table: signs of the eight factors, and the three places."""
    point = mobility(linkage)
    if not point:
        return []
    signs = [f'{name} {"0" if value == 0.0 else "+" if value > 0.0 else "-"}'
             for name, value in point.factors._asdict().items()]
    return [('factors', '  '.join(signs)),
            *((name, f'{value:+.6f} of the perimeter'
               + (f'; nearest change point: {AXES[name]}' if name == point.nearest else ''))
              for name, value in point.place.items())]
