# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Motion of the five dyads, two links and three joints, closed by hand.

Notation. P and Q are the points of the first and the second link to which the dyad is attached, D
= Q - P. Primes are derivatives with respect to the input of the machine. e1, e2 are the directions
of the two links of the dyad, t and n the direction of a slide and its normal (t turned by +90
deg); a x b is the z component of a cross product, a . b a dot product.

Dyads between links that are joined to each other are in :mod:`.pairs`. Everything is solved for
*coefficients*: position, first and second derivative with respect to the
input. Rates and accelerations, the inertia of the whole machine and virtual power follow from one
evaluation. A curve is the LinkMotion of a link at unit
rate of the input, and a MovingPoint (x, y, x', y', x'', y'') that of a point, by
point_of() of mechanisms/curves.py.

RRR: B = P + r1 e1 = Q + r2 e2, a triangle P Q B with q = D . D:

    (D1)  root = +-sqrt((r1 + r2)^2 - q) sqrt(q - (r1 - r2)^2),   sine = e1 x e2 = root/(2 r1 r2)
    (D2)  angle1' = D' . e2 / (r1 sine),   angle2' = D' . e1 / (r2 sine)
    (D3)  angle1'' = G . e2 / (r1 sine),   angle2'' = G . e1 / (r2 sine),
          G = D'' + angle1'^2 r1 e1 - angle2'^2 r2 e2

RRP: B = P + r1 e1 = Q + s t, where t and n turn with the second link, at the rate k':

    (D4)  h = D . n,   g = r1 e1 . t = +-sqrt((r1 - h)(r1 + h)),   s = g - D . t
    (D5)  angle1' = V . n / g,   s' = -angle1' h - V . t,   V = D' + k' s n
    (D6)  angle1'' = G . n / g,   s'' = -angle1'' h - G . t,
          G = D'' + (k'' s + 2 k' s') n - k'^2 s t + angle1'^2 r1 e1

RPR: P = Q + s t + h n, a block pinned at P on a bar pinned at Q; d = P - Q:

    (D7)  s = +-sqrt((|d| - h)(|d| + h)),   t = (s d - h n_d) / |d|^2,   n_d = d turned by +90 deg
    (D8)  angle' = d' . n / s,   s' = d' . t + angle' h
    (D9)  angle'' = (d'' . n + angle'^2 h - 2 s' angle') / s,
          s'' = d'' . t + angle'' h + angle'^2 s

RPP: P = Q + s t + d c, a block pinned at P in the slot c of a yoke that slides along t; c = t cos
g + n sin g; both turn with the second link; R = P - Q:

    (D10) d = R . n / sin g,   s = R . t - d cos g, and the same for the derivatives
          R' - k' n_R  and  R'' - k'' n_R + k'^2 R - 2 k' (s' n + d' n_c)

PRP: B = P + s1 t1 = Q + s2 t2, two blocks pinned to each other on two lines:

    (D11) s1 = D x t2 / (t1 x t2),   s2 = D x t1 / (t1 x t2), and the same for the derivatives
          D' + k2' s2 n2 - k1' s1 n1  and
          D'' + (k2'' s2 + 2 k2' s2') n2 - k2'^2 s2 t2 - (k1'' s1 + 2 k1' s1') n1 + k1'^2 s1 t1

A dyad is at a toggle where the sine of its transmission angle vanishes: the angle between the two
rods (RRR), the rod and the normal of the slide (RRP), the bar and the line P Q (RPR), the slot and
the slide (RPP), the two lines (PRP).
"""
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

from fourbar_ros.mechanisms.curves import Direction, LinkMotion, MovingPoint
from fourbar_ros.numerics.number_types import NumberType, Scalar


class DyadMotion(NamedTuple):
    """How both links of a dyad move, by the input of the machine."""

    first: LinkMotion
    second: LinkMotion
    slides: tuple[Scalar, ...]          # s, s', s'' of each slide, one after the other
    sine: Scalar                        # of the transmission angle
    cosine: Scalar
    # {(a link, one it is pinned to): direction of the first seen from the second}
    relations: dict[tuple[int, int], Direction]


class Ends(NamedTuple):
    """The ends P and Q of a dyad and the links that carry them, as its frame sees them."""

    p: MovingPoint
    q: MovingPoint
    apart: Any                  # D = Q - P, a MovingPoint; None of a pair and of a cylinder
    relative: Any               # of a pair angle or slide of its carriers; of a cylinder its drive
    half: Any                   # cosine, sine of half that angle where the driven link has it
    first: LinkMotion           # carrier of P
    second: LinkMotion          # carrier of Q


class Driven(NamedTuple):
    """The driven link of a machine."""

    curve: LinkMotion
    errors: tuple[Scalar, Scalar]       # of place and angle, for relative errors of the lengths
    # cosine and sine of half the angle of a crank, which tell its odd turns from the even ones
    half: tuple[Scalar, Scalar] | None = None
    slide: tuple[Scalar, Scalar, Scalar] | None = None      # of a slider, and its derivatives
    # length of a cylinder, direction of its rod, sine and cosine of its transmission angle
    of_cylinder: tuple[Any, ...] | None = None


ORIGIN = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


def rrr(n: NumberType, sign: Scalar, sizes: Sequence[Scalar], ends: Ends) -> DyadMotion:
    """Return how RRR moves, rods r1 from P and r2 from Q, pinned at B, by (D1) to (D3)."""
    sqrt, (r1, r2) = n.sqrt, sizes
    difference, outer = (r1 - r2) * (r1 + r2), (r1 + r2) * (r1 + r2)
    inner = (r1 - r2) * (r1 - r2)
    per_r1, per_r2, half_sine = 1.0 / r1, 1.0 / r2, 0.5 / r1 / r2
    x, y, dx, dy, ddx, ddy = ends.apart
    q = x * x + y * y
    root = sign * sqrt(outer - q) * sqrt(q - inner)                                     # (D1)
    half = 0.5 / q
    f1, f2, h = (q + difference) * half, (difference - q) * half, root * half
    c1, s1 = (f1 * x - h * y) * per_r1, (f1 * y + h * x) * per_r1
    c2, s2 = (f2 * x - h * y) * per_r2, (f2 * y + h * x) * per_r2
    sine = root * half_sine
    per_1, per_2 = per_r1 / sine, per_r2 / sine
    turn1, turn2 = (dx * c2 + dy * s2) * per_1, (dx * c1 + dy * s1) * per_2             # (D2)
    pull1, pull2 = turn1 * turn1 * r1, turn2 * turn2 * r2
    gx = ddx + pull1 * c1 - pull2 * c2
    gy = ddy + pull1 * s1 - pull2 * s2
    bend1, bend2 = (gx * c2 + gy * s2) * per_1, (gx * c1 + gy * s1) * per_2             # (D3)
    return DyadMotion(LinkMotion(*ends.p, c1, s1, turn1, bend1),
                      LinkMotion(*ends.q, c2, s2, turn2, bend2), (), sine, c1 * c2 + s1 * s2, {})


def turned(curve: LinkMotion, cosine: Scalar, sine: Scalar) -> Direction:
    """Return cosine, sine and both derivatives of a direction that is given on a link."""
    c, s = curve.cosine, curve.sine
    return c * cosine - s * sine, s * cosine + c * sine, curve.omega, curve.alpha


def rrp(n: NumberType, sign: Scalar, sizes: Sequence[Scalar], ends: Ends) -> DyadMotion:
    """Return how RRP moves, a rod r1 from P, its end on a line through Q, by (D4) to (D6)."""
    r1, cos_t, sin_t = sizes
    sqrt, per_r1 = n.sqrt, 1.0 / r1
    qx, qy, qdx, qdy, qddx, qddy = ends.q
    x, y, dx, dy, ddx, ddy = ends.apart
    tx, ty, turn, bend = turned(ends.second, cos_t, sin_t)
    h = y * tx - x * ty
    g = sign * sqrt((r1 - h) * (r1 + h))                                                # (D4)
    s = g - (x * tx + y * ty)
    c1, s1 = (g * tx - h * ty) * per_r1, (g * ty + h * tx) * per_r1
    per_g, swing = 1.0 / g, turn * s
    vx, vy = dx - swing * ty, dy + swing * tx
    turn1 = (vy * tx - vx * ty) * per_g                                                 # (D5)
    ds = -turn1 * h - (vx * tx + vy * ty)
    along, across = -turn * swing, bend * s + 2.0 * turn * ds
    pull = turn1 * turn1
    bend1 = (ddy * tx - ddx * ty + across + pull * h) * per_g                           # (D6)
    dds = -bend1 * h - (ddx * tx + ddy * ty + along + pull * g)
    block = LinkMotion(qx + s * tx, qy + s * ty,
                       qdx - swing * ty + ds * tx, qdy + swing * tx + ds * ty,
                       qddx + (along + dds) * tx - across * ty,
                       qddy + (along + dds) * ty + across * tx, tx, ty, turn, bend)
    return DyadMotion(LinkMotion(*ends.p, c1, s1, turn1, bend1), block, (s, ds, dds), g * per_r1,
                      h * per_r1, {})


def rpr(n: NumberType, sign: Scalar, sizes: Sequence[Scalar], ends: Ends) -> DyadMotion:
    """Return how RPR moves, a block pinned at P on a bar pinned at Q, by (D7) to (D9)."""
    sqrt, (h,) = n.sqrt, sizes
    x, y, dx, dy, ddx, ddy = [-value for value in ends.apart]
    distance = sqrt(x * x + y * y)
    s = sign * sqrt((distance - h) * (distance + h))                                    # (D7)
    per = 1.0 / distance
    per_q = per * per
    tx, ty = (s * x + h * y) * per_q, (s * y - h * x) * per_q
    per_s = 1.0 / s
    turn = (dy * tx - dx * ty) * per_s                                                  # (D8)
    ds = dx * tx + dy * ty + turn * h
    bend = (ddy * tx - ddx * ty + (turn * h - 2.0 * ds) * turn) * per_s                 # (D9)
    dds = ddx * tx + ddy * ty + bend * h + turn * turn * s
    bar: Direction = tx, ty, turn, bend
    return DyadMotion(LinkMotion(*ends.p, *bar), LinkMotion(*ends.q, *bar), (s, ds, dds), s * per,
                      h * per, {})


def rpp(_n: NumberType, _sign: Scalar, sizes: Sequence[Scalar], ends: Ends) -> DyadMotion:
    """Return how RPP moves, a block pinned at P in the slot of a yoke through Q, by (D10)."""
    cos_t, sin_t, cos_g, sin_g = sizes
    per_sine = 1.0 / sin_g

    def split(x: Scalar, y: Scalar, tx: Scalar, ty: Scalar) -> tuple[Scalar, Scalar]:
        across = (y * tx - x * ty) * per_sine                                          # (D10)
        return x * tx + y * ty - across * cos_g, across

    qx, qy, qdx, qdy, qddx, qddy = ends.q
    tx, ty, turn, bend = turned(ends.second, cos_t, sin_t)
    cx, cy = cos_g * tx - sin_g * ty, cos_g * ty + sin_g * tx
    x, y, dx, dy, ddx, ddy = [-value for value in ends.apart]
    s, d = split(x, y, tx, ty)
    ds, dd = split(dx + turn * y, dy - turn * x, tx, ty)
    square, twice = turn * turn, 2.0 * turn
    dds, ddd = split(ddx + bend * y + square * x + twice * (ds * ty + dd * cy),
                     ddy - bend * x + square * y - twice * (ds * tx + dd * cx), tx, ty)
    swing = turn * s
    along, across = dds - turn * swing, bend * s + twice * ds
    yoke = LinkMotion(qx + s * tx, qy + s * ty,
                      qdx - swing * ty + ds * tx, qdy + swing * tx + ds * ty,
                      qddx + along * tx - across * ty, qddy + along * ty + across * tx,
                      tx, ty, turn, bend)
    return DyadMotion(LinkMotion(*ends.p, cx, cy, turn, bend), yoke, (d, dd, ddd, s, ds, dds),
                      sin_g + (s - s), cos_g + (s - s), {})


def prp(_n: NumberType, _sign: Scalar, sizes: Sequence[Scalar], ends: Ends) -> DyadMotion:
    """Return how PRP moves, two blocks, pinned, on lines through P and Q, by (D11)."""
    cos_1, sin_1, cos_2, sin_2 = sizes
    px, py, pdx, pdy, pddx, pddy = ends.p
    x_0, y_0, dx, dy, ddx, ddy = ends.apart
    x1, y1, turn1, bend1 = turned(ends.first, cos_1, sin_1)
    x2, y2, turn2, bend2 = turned(ends.second, cos_2, sin_2)
    cross = x1 * y2 - y1 * x2
    per = 1.0 / cross
    x, y = x_0 * per, y_0 * per
    s1, s2 = x * y2 - y * x2, x * y1 - y * x1                                          # (D11)
    swing1, swing2 = turn1 * s1, turn2 * s2
    v_x = (dx - swing2 * y2 + swing1 * y1) * per
    v_y = (dy + swing2 * x2 - swing1 * x1) * per
    ds1, ds2 = v_x * y2 - v_y * x2, v_x * y1 - v_y * x1
    # along and across each line, the acceleration of B but for s''
    a1, b1 = -turn1 * swing1, bend1 * s1 + 2.0 * turn1 * ds1
    a2, b2 = -turn2 * swing2, bend2 * s2 + 2.0 * turn2 * ds2
    a_x = (ddx + a2 * x2 - b2 * y2 - a1 * x1 + b1 * y1) * per
    a_y = (ddy + a2 * y2 + b2 * x2 - a1 * y1 - b1 * x1) * per
    dds1, dds2 = a_x * y2 - a_y * x2, a_x * y1 - a_y * x1
    at_b = (px + s1 * x1, py + s1 * y1,
            pdx - swing1 * y1 + ds1 * x1, pdy + swing1 * x1 + ds1 * y1,
            pddx + (a1 + dds1) * x1 - b1 * y1, pddy + (a1 + dds1) * y1 + b1 * x1)
    sine = cross + (s1 - s1)         # NaN where B has no place
    return DyadMotion(LinkMotion(*at_b, x1, y1, turn1, bend1),
                      LinkMotion(*at_b, x2, y2, turn2, bend2),
                      (s1, ds1, dds1, s2, ds2, dds2), sine, x1 * x2 + y1 * y2, {})


# (number type, sign, sizes, ends) -> motion
DYADS: dict[str, Callable[..., DyadMotion]] = {
    'RRR': rrr, 'RRP': rrp, 'RPR': rpr, 'RPP': rpp, 'PRP': prp}
