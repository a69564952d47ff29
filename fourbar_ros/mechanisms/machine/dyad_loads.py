# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Forces in the five dyads, each a statically determinate system solved by hand.

Notation as in :mod:`fourbar_ros.mechanisms.machine.dyads`. The *needs* f = (f_x, f_y) and m of a
link are what the forces of its joints must add up to, and their moment about its first joint; what
hangs on it is in them already. Slides are free of friction: a normal force along n and a couple.

RRR, with F = a e1 + b e2 of the second rod on the first at B, r1 e1 x F = m1, -r2 e2 x F = m2:

    (F1)  b = m1 / (r1 sine),   a = m2 / (r2 sine);   at P f1 - F, at Q f2 + F

RRP, with F = -a t - b n of the block on the rod, N n and the couple C of the guide on the block:

    (F2)  a = f2 . t,   b = (h a - m1) / g,   N = f2 . n - b,   C = m2;   at P f1 - F

RPR, with F = N n and the couple C of the bar on the block:

    (F3)  C = m1,   N = -(m1 + m2) / s;   at P f1 - F, at Q f2 + F

RPP, with F = N2 n_c and C2 of the slot on the block, N1 n and C1 of the guide on the yoke:

    (F4)  N2 = f2 . t / sin g,  C2 = m1,  N1 = f2 . n + N2 cos g,  C1 = m2 + C2 + d N2;
          at P f1 - F, F = N2 n_c

PRP, with N1 n1, C1 and N2 n2, C2 of the lines on the blocks, f = f1 + f2:

    (F5)  N1 = f . t2 / (t1 x t2),   N2 = -f . t1 / (t1 x t2),   C1 = m1,   C2 = m2,
          F = f1 - N1 n1
"""
from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from fourbar_ros.mechanisms.machine.description import PRP, RPP, RPR, RRP, RRR

Needs = tuple[Any, Any, Any]


# Forces (x, y) and couple at the first joint and at the second, of what the dyad hangs on, on its
# links; at the inner joint, of the second link on the first; normal forces of the joints that
# slide, in their order. Couples are about the first joints of the links.
# (directions (cosine, sine) of both links, slides, sine, needs of both) -> forces.
SolvesDyad = Callable[[Any, Any, Sequence[Any], Any, Needs, Needs], tuple[Any, ...]]


def make_rrr_loads(r1: Any, r2: Any) -> SolvesDyad:
    """Return the forces in the dyad RRR."""
    def loads(first: Any, second: Any, _slides: Any, sine: Any, needs1: Needs,
              needs2: Needs) -> tuple[Any, ...]:
        (f1x, f1y, m1), (f2x, f2y, m2) = needs1, needs2
        b, a = m1 / (r1 * sine), m2 / (r2 * sine)                                       # (F1)
        fx, fy = a * first[0] + b * second[0], a * first[1] + b * second[1]
        return f1x - fx, f1y - fy, 0.0, f2x + fx, f2y + fy, 0.0, fx, fy, 0.0, ()
    return loads


def make_rrp_loads(r1: Any, *_: Any) -> SolvesDyad:
    """Return the forces in the dyad RRP."""
    def loads(first: Any, second: Any, _slides: Any, sine: Any, needs1: Needs,
              needs2: Needs) -> tuple[Any, ...]:
        (f1x, f1y, m1), (f2x, f2y, m2) = needs1, needs2
        tx, ty = second
        h, g = r1 * (first[1] * tx - first[0] * ty), r1 * sine
        a = f2x * tx + f2y * ty                                                         # (F2)
        b = (h * a - m1) / g
        normal = f2y * tx - f2x * ty - b
        fx, fy = b * ty - a * tx, -a * ty - b * tx
        return (f1x - fx, f1y - fy, 0.0, -normal * ty, normal * tx, m2, fx, fy, 0.0, (normal,))
    return loads


def make_rpr_loads(*_: Any) -> SolvesDyad:
    """Return the forces in the dyad RPR."""
    def loads(first: Any, _second: Any, slides: Any, _sine: Any, needs1: Needs,
              needs2: Needs) -> tuple[Any, ...]:
        (f1x, f1y, m1), (f2x, f2y, m2) = needs1, needs2
        normal = -(m1 + m2) / slides[0]                                                 # (F3)
        fx, fy = -normal * first[1], normal * first[0]
        return f1x - fx, f1y - fy, 0.0, f2x + fx, f2y + fy, 0.0, fx, fy, m1, (normal,)
    return loads


def make_rpp_loads(_cos_t: Any, _sin_t: Any, cos_g: Any, sin_g: Any) -> SolvesDyad:
    """Return the forces in the dyad RPP."""
    def loads(first: Any, second: Any, slides: Any, _sine: Any, needs1: Needs,
              needs2: Needs) -> tuple[Any, ...]:
        (f1x, f1y, m1), (f2x, f2y, m2) = needs1, needs2
        tx, ty = second
        slot = (f2x * tx + f2y * ty) / sin_g                                            # (F4)
        guide = f2y * tx - f2x * ty + slot * cos_g
        fx, fy = -slot * first[1], slot * first[0]
        return (f1x - fx, f1y - fy, 0.0, -guide * ty, guide * tx, m2 + m1 + slides[0] * slot,
                fx, fy, m1, (slot, guide))
    return loads


def make_prp_loads(*_: Any) -> SolvesDyad:
    """Return the forces in the dyad PRP."""
    def loads(first: Any, second: Any, _slides: Any, sine: Any, needs1: Needs,
              needs2: Needs) -> tuple[Any, ...]:
        (f1x, f1y, m1), (f2x, f2y, m2) = needs1, needs2
        (x1, y1), (x2, y2) = first, second
        fx, fy = (f1x + f2x) / sine, (f1y + f2y) / sine
        normal1, normal2 = fx * x2 + fy * y2, -(fx * x1 + fy * y1)                      # (F5)
        g1x, g1y = -normal1 * y1, normal1 * x1
        return (g1x, g1y, m1, -normal2 * y2, normal2 * x2, m2, f1x - g1x, f1y - g1y, 0.0,
                (normal1, normal2))
    return loads


SOLVERS: dict[str, Callable[..., SolvesDyad]] = {
    RRR: make_rrr_loads, RRP: make_rrp_loads, RPR: make_rpr_loads, RPP: make_rpp_loads,
    PRP: make_prp_loads}
