# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The dyad RPR between points of which one may run to infinity.

With the notation of :mod:`.dyads`, and of :mod:`.far` for weighted numbers: d = w (P - Q) stays
finite as w vanishes. By differentiating d = S t + w h n:

    (W3)  S = w s = +-sign(w) sqrt((|d| - w h)(|d| + w h)),   t = (S d - w h n_d) / |d|^2
    (W4)  angle' = (d' . n - w' h) / S,   S' = d' . t + angle' w h
    (W5)  angle'' = (d'' . n - w'' h + angle'^2 w h - 2 S' angle') / S,
          S'' = d'' . t + angle'' w h + angle'^2 S + 2 angle' w' h
    (W6)  s = S / w,   s' = (S' - s w') / w,   s'' = (S'' - 2 s' w' - s w'') / w
"""
from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from fourbar_ros.numerics.number_types import NumberType


def make_far_rpr(n: NumberType, sign: Any, h: Any) -> Callable[[Sequence[Any]], tuple[Any, ...]]:
    """
    Return w (Q - P) and w -> direction, slide, sine and cosine of the transmission angle of RPR.

    Given as by :func:`.far.far_between`; direction: (cosine, sine, angle', angle'').
    """
    sqrt, hypot, where = n.sqrt, n.hypot, n.where

    def turned(apart: Sequence[Any]) -> tuple[Any, ...]:
        x, y, dx, dy, ddx, ddy = [-part for part in apart[:6]]
        w, dw, ddw = apart[6:]
        distance, wh = hypot(x, y), w * h
        root = sign * sqrt((distance - wh) * (distance + wh))
        slide, size = where(w.real > 0.0, (root, w), (-root, -w))                       # (W3)
        per, per_s, per_w = 1.0 / distance, 1.0 / slide, 1.0 / w
        per_q = per * per
        tx, ty = (slide * x + wh * y) * per_q, (slide * y - wh * x) * per_q
        turn = (dy * tx - dx * ty - dw * h) * per_s                                     # (W4)
        ds = dx * tx + dy * ty + turn * wh
        bend = (ddy * tx - ddx * ty - ddw * h + (turn * wh - 2.0 * ds) * turn) * per_s  # (W5)
        dds = ddx * tx + ddy * ty + bend * wh + (turn * slide + 2.0 * dw * h) * turn
        s = slide * per_w                                                               # (W6)
        rate = (ds - s * dw) * per_w
        return ((tx, ty, turn, bend), (s, rate, (dds - 2.0 * rate * dw - s * ddw) * per_w),
                root * per, size * h * per)
    return turned
