# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Links that run to infinity: their places as ratios.

Where the lines of a dyad PRP become parallel, its pin B runs to infinity, and what is pinned to
its links with it. A bar between such a link and another one (dyad RPR) turns smoothly all the
same. From places, its rates are what is left where terms cancel that grow as the second and third
power of the distance. So a far place x is kept as a *weighted* one, N = w x, that stays finite as
its weight w = t1 x t2 vanishes. With the notation of :mod:`.dyads`, for the dyad PRP:

    (W1)  w = t1 x t2,   w' = k w_n,   w'' = l w_n - k^2 w,   w_n = t1 . t2,   k = k2' - k1',
          l = k2'' - k1''
    (W2)  N = w P + S1 t1,   S1 = w s1 = D x t2,   S1' = D' x t2 + k2' D . t2,
          S1'' = D'' x t2 + 2 k2' D' . t2 + k2'' D . t2 - k2'^2 D x t2;   S2 = D x t1 likewise
"""
from __future__ import annotations

from typing import Any, NamedTuple

from fourbar_ros.mechanisms.machine.dyads import Curve, Node, node_of, ORIGIN

Jet = tuple[Any, Any, Any]      # a number and its two derivatives


class Weighted(NamedTuple):
    """The curve of a link whose place is weighted, and the weight."""

    curve: Curve
    weight: Jet


def weighed(node: Node, weight: Jet) -> Node:
    """Return w x and its derivatives."""
    (x, y, dx, dy, ddx, ddy), (w, dw, ddw) = node, weight
    return (w * x, w * y, w * dx + dw * x, w * dy + dw * y,
            w * ddx + 2.0 * dw * dx + ddw * x, w * ddy + 2.0 * dw * dy + ddw * y)


def product(one: Jet, other: Jet) -> Jet:
    """Return the product of two weights."""
    (a, da, dda), (b, db, ddb) = one, other
    return a * b, a * db + da * b, a * ddb + 2.0 * da * db + dda * b


def moved_by(node: Node, other: Node) -> Node:
    """Return the sum of two nodes."""
    x, y, dx, dy, ddx, ddy = [a + b for a, b in zip(node, other)]
    return x, y, dx, dy, ddx, ddy


def far_node(link: Weighted, along: Any, across: Any) -> Node:
    """Return the weighted place of a point fixed to a far link."""
    arm = node_of((*ORIGIN, *link.curve[6:]), along, across)
    return moved_by(link.curve[:6], weighed(arm, link.weight))


def far_between(at_p: Node, at_q: Node, weight_p: Jet | None,
                weight_q: Jet | None) -> tuple[Any, ...]:
    """Return w (Q - P) and its derivatives, then w, w', w''; a weight of None is 1."""
    if weight_p is not None and weight_q is not None and weight_p is not weight_q:
        at_p, at_q = weighed(at_p, weight_q), weighed(at_q, weight_p)
        weight = product(weight_p, weight_q)
    elif weight_p is None:
        assert weight_q is not None
        at_p, weight = weighed(at_p, weight_q), weight_q
    else:
        at_q, weight = at_q if weight_q is weight_p else weighed(at_q, weight_p), weight_p
    return *[q - p for p, q in zip(at_p, at_q)], *weight


def weight_of(one: Curve, other: Curve) -> Jet:
    """Return t1 x t2 and its derivatives from links that have these directions, (W1)."""
    *_, x1, y1, turn1, bend1 = one
    *_, x2, y2, turn2, bend2 = other
    w, scalar, turn = x1 * y2 - y1 * x2, x1 * x2 + y1 * y2, turn2 - turn1
    return w, turn * scalar, (bend2 - bend1) * scalar - turn * turn * w


def far_slide(apart: Node, other: Curve) -> Jet:
    """Return D x t of the direction of a link and its derivatives, (W2)."""
    x, y, dx, dy, ddx, ddy = apart
    tx, ty, turn, bend = other[6:]
    cross, scalar, d_scalar = x * ty - y * tx, x * tx + y * ty, dx * tx + dy * ty
    return (cross, dx * ty - dy * tx + turn * scalar,
            ddx * ty - ddy * tx + 2.0 * turn * d_scalar + bend * scalar - turn * turn * cross)


def far_pin(at_p: Node, slide: Jet, one: Curve, weight: Jet) -> Node:
    """Return w B = w P + S1 t1 and its derivatives, (W2)."""
    along = weighed(node_of((*ORIGIN, *one[6:]), 1.0, 0.0), slide)
    return moved_by(weighed(at_p, weight), along)
