# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Dyads between two links that are joined to each other.

Where a pin or a slide joins the links on which a dyad hangs, the dyad and that joint make a closed
loop of four links: a 4R linkage, a slider-crank or an inverted one, that moves by one relative
angle or slide. The formulas of these (:mod:`fourbar_ros.mechanisms.loop`,
:mod:`fourbar_ros.mechanisms.slides`) keep all digits next to its toggles and go through its
change points. The first dyad of every machine is one of these, and so are many others.

One link of the pair is the frame. On it, O is the pin that joins both, Q the point of the dyad, g
= Q - O; on the other a = P - O. With x the angle of a seen from g, or from the line of RRP, the
half-angle is

    (P1)  sin^2(x/2), cos^2(x/2):  the larger one (1 + |cos x|)/2, the other sin^2 x / 4 over it

and primes, derivatives with respect to the input of the machine, follow by

    (P2)  y' = y'(x) x',   y'' = y''(x) x'^2 + y'(x) x''

With a slide, sigma + i e is the place of P seen from Q, along and across the slide:

    (P3)  RPR: l^2 = sigma^2 + (e - h)(e + h),   direction (l - i h)(sigma + i e)/q,   q = sigma^2
          + e^2
    (P4)  l' = sigma/l,   l'' = k/l^3,   k = (e - h)(e + h),   y'' = (h l'' - 2 sigma y')/q,
          y' = (h sigma - e l)/(l q) = -k/(l (h sigma + e l)), whichever does not cancel

Lengths that are not given, as |a|, are rounded once, as floats, and are data from there on: for
every type of numbers a change point is one, or none.
"""
from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from math import atan2, fsum, hypot, pi, remainder
from typing import Any, NamedTuple

from fourbar_ros.mechanisms.loop import loop
from fourbar_ros.mechanisms.machine.describe.description import (
    CYLINDER,
    Numbers,
    PRP,
    RPP,
    RPR,
    RRP,
    RRR,
)
from fourbar_ros.mechanisms.machine.describe.layout import Layout, Pair, Stage
from fourbar_ros.mechanisms.machine.solve.dyads import (
    Direction,
    DyadMotion,
    DYADS,
    MovesDyad,
    Node,
)
from fourbar_ros.mechanisms.points import LinkMotion
from fourbar_ros.numerics.exact_sums import difference_of_squares
from fourbar_ros.numerics.number_types import Function, nudge, NumberType, power_of_two, Scalar

Place = tuple[Scalar, Scalar]        # along and across, on a link
# Of a link that slides: (its carrier, start and direction of the slide there).
Slide = tuple[int, Place, Place]
FIRST_JOINT = (0.0, 0.0)             # as a place
# Pairs whose evenness is below this are solved in their own form. The others have all digits in
# the general one too (:mod:`.dyads`), with a third fewer operations.
CLOSE = 2.0**-6


def slides_of(stage: Stage, own: Numbers) -> list[tuple[int, Slide]]:
    """Return [(number of a link that slides, its :data:`Slide`)] in the order of the joints."""
    one, two, sizes = stage.number, stage.number + 1, own.sizes
    if stage.kind == RRP:
        return [(two, (stage.second, own.q, (sizes[1], sizes[2])))]
    if stage.kind == RPR:
        return [(one, (two, (0.0, sizes[0]), (1.0, 0.0)))]
    if stage.kind == RPP:
        return [(one, (two, FIRST_JOINT, (sizes[2], sizes[3]))),
                (two, (stage.second, own.q, (sizes[0], sizes[1])))]
    if stage.kind == PRP:
        return [(one, (stage.first, own.p, (sizes[0], sizes[1]))),
                (two, (stage.second, own.q, (sizes[2], sizes[3])))]
    return []


def anchors_of(stage: Stage, own: Numbers) -> dict[int, tuple[int, Place]]:
    """Return {link of a dyad: (link to which its first joint is pinned, where)}."""
    one, two = stage.number, stage.number + 1
    if stage.kind == PRP:
        return {two: (one, FIRST_JOINT)}
    second = {RRR: (stage.second, own.q), RPR: (stage.second, own.q),
              RRP: (one, (own.sizes[0], 0.0))}.get(stage.kind)
    return {one: (stage.first, own.p), **({two: second} if second else {})}


class KnownJoints:
    """
    The joints of a machine between links that come before a dyad.

    ``pins``: {(a link, the one it is pinned to): where on each}, ``slides``: {(a link, the one in
    which it slides): start and direction there}.
    """

    def __init__(self, driver: str) -> None:
        self.pins = {} if driver == 'slide' else {(1, 0): (FIRST_JOINT, FIRST_JOINT)}
        self.slides = {(1, 0): (FIRST_JOINT, (1.0, 0.0))} if driver == 'slide' else {}

    def add(self, stage: Stage, own: Numbers) -> None:
        """
        Add the three joints of a dyad, so that later dyads find them.

        Two are on the links that it hangs on, one joins its own links: of RRR at the far ends of
        both rods, which is no first joint.
        """
        for link, (carrier, place) in anchors_of(stage, own).items():
            self.pins[link, carrier] = FIRST_JOINT, place
        if stage.kind == RRR:
            r1, r2 = own.sizes
            self.pins[stage.number + 1, stage.number] = (r2, 0.0), (r1, 0.0)
        for link, (carrier, start, direction) in slides_of(stage, own):
            self.slides[link, carrier] = start, direction

    def pin(self, link: int, frame: int) -> tuple[Place, Place]:
        """Return where two links are pinned to each other, on the first and on the second."""
        return (self.pins[link, frame] if (link, frame) in self.pins
                else self.pins[frame, link][::-1])

    def pair_of(self, stage: Stage) -> Pair | None:
        """Return the :class:`Pair` of a dyad, None where its links are not joined."""
        for link, carrier in ((stage.first, stage.second), (stage.second, stage.first)):
            if (link, carrier) in self.pins and stage.kind in (RRR, RRP, RPR):
                return Pair(stage.second if stage.kind == RRP else carrier, False)
            if (link, carrier) in self.slides and stage.kind in (RRR, RPR):
                return Pair(carrier, True)
        return None


def other_of(stage: Stage) -> int:
    """Return the number of the link of a pair that is not its frame."""
    return stage.first if stage.turns_first else stage.second


def _shape(stage: Stage, own: Numbers, joints: KnownJoints, length: Function
           ) -> tuple[Scalar, ...]:
    """Return the loop of a pair besides sizes of the dyad: ``shape`` of shaped()."""
    assert stage.pair is not None
    frame, other = stage.pair.frame, other_of(stage)
    (p_x, p_y), (q_x, q_y) = (own.p, own.q) if stage.turns_first else (own.q, own.p)
    if stage.pair.slides:
        (x, y), (c, s) = joints.slides[other, frame]
        return (p_x + (x - q_x) * c + (y - q_y) * s, p_y + (y - q_y) * c - (x - q_x) * s, c, s)
    (o_x, o_y), (x, y) = joints.pin(other, frame)
    a_x, a_y, g_x, g_y = p_x - o_x, p_y - o_y, q_x - x, q_y - y
    if stage.kind == RRP:
        t_x, t_y = own.sizes[1:]
        a1 = length(a_x, a_y)
        return (a1, g_y * t_x - g_x * t_y, (a_x * t_x + a_y * t_y) / a1,
                (a_y * t_x - a_x * t_y) / a1, g_x * t_x + g_y * t_y, x, y)
    a1, a4 = length(a_x, a_y), length(g_x, g_y)
    scalar, cross = a_x * g_x + a_y * g_y, a_y * g_x - a_x * g_y
    size = length(scalar, cross)
    return a1, a4, scalar / size, cross / size, g_x / a4, g_y / a4


def shaped(layout: Layout, numbers: Sequence[Numbers], length: Function = hypot) -> list[Numbers]:
    """
    Return the numbers of all dyads with what follows from them once and for all.

    That is ``reach``, and of a pair ``shape``: with a pin (|a|, |g|, cosine and sine from g to a,
    of g), of RRP (|a|, distance of the line from O, cosine and sine from the line to a, place of Q
    along it from O, O); with a slide (sigma where the slide is zero, e, its cosine and sine).
    """
    joints, found = KnownJoints(layout.driver), []
    for stage, own in zip(layout.stages, numbers):
        shape = _shape(stage, own, joints, length) if stage.pair else ()
        if stage.name == CYLINDER:
            shape = length(*own.p), length(*own.q)
        found.append(own._replace(reach=(length(*own.p), length(*own.q)), shape=shape))
        joints.add(stage, own)
    return found


def with_pairs(layout: Layout, numbers: Sequence[Numbers]) -> Layout:
    """Return a layout whose stages have a ``pair`` where the general formulas lose digits."""
    joints, stages = KnownJoints(layout.driver), []
    for stage, own in zip(layout.stages, numbers):
        pair = None if stage.name == CYLINDER else joints.pair_of(stage)
        stages.append(stage._replace(pair=pair and _if_close(pair, stage, own, joints)))
        joints.add(stage, own)
    return layout._replace(stages=tuple(stages))


def _if_close(pair: Pair, stage: Stage, own: Numbers, joints: KnownJoints) -> Pair | None:
    """Return a pair if it is near a change point or its lengths are unlike, else None."""
    stage = stage._replace(pair=pair)
    try:
        own = own._replace(shape=_shape(stage, own, joints, hypot))
    except ZeroDivisionError:       # hung on the pin that joins the links: it does not move
        return None
    return pair if PairRange(stage, own).evenness < CLOSE else None


# --- how one moves -------------------------------------------------------------------------------

# {(a link, another): :data:`Direction` of the first seen from the second}
Relations = dict[tuple[int, int], Direction]


def half_angle(n: NumberType, cos_x: Scalar,
               sin_x: Scalar) -> tuple[Scalar, Scalar, Scalar]:
    """Return sin^2(x/2), cos^2(x/2), sin(x/2) cos(x/2), without cancellation, (P1)."""
    large = 0.5 * (1.0 + n.fabs(cos_x))
    small = 0.25 * sin_x * sin_x / large
    ss, cc = n.where(cos_x.real > 0.0, (small, large), (large, small))
    return ss, cc, 0.5 * sin_x


def turned_by(one: Sequence[Scalar], other: Sequence[Scalar]) -> tuple[Scalar, Scalar]:
    """Return (cosine, sine) of the sum of two angles, each given so."""
    (c, s), (cosine, sine) = one, other
    return c * cosine - s * sine, s * cosine + c * sine


def by_input(relative: Sequence[Scalar], first: Scalar, second: Scalar) -> tuple[Scalar, Scalar]:
    """Return derivatives by the input from those by an angle or slide, ``relative``, by (P2)."""
    rate, change = relative[-2:]
    return first * rate, second * rate * rate + first * change


def rrr_pair(n: NumberType, sign: Scalar, stage: Stage, own: Numbers, at_p: Node, at_q: Node,
             angle: Sequence[Scalar], _first: LinkMotion, _second: LinkMotion) -> DyadMotion:
    """
    Return how RRR moves as coupler and output link of a 4R linkage.

    ``angle``: the angle from g to a, the arms of the pin that joins the links the dyad hangs on.
    """
    a1, a4, cos_0, sin_0, *of_g = own.shape
    first = stage.turns_first
    side, (a2, a3) = (1.0, own.sizes) if first else (-1.0, own.sizes[::-1])
    beside_0 = nudge(n, *map(n.exact_sum, ((a1, -a4, a2, -a3), (a1, -a4, -a2, a3),
                                           (a1, a4, -a2, -a3))))
    of_a, (cos_x, sin_x) = turned_by((cos_0, sin_0), of_g), turned_by(angle[:2], (cos_0, sin_0))
    one, two, other = stage.number, stage.number + 1, other_of(stage)
    at = loop(n, (a1, a2, a3, a4), side * sign, *half_angle(n, cos_x, sin_x + beside_0))
    coupler: Direction = *turned_by((at.cos_b, at.sin_b), of_g), *by_input(angle, at.d_b, at.dd_b)
    output: Direction = *turned_by((at.cos_y, at.sin_y), of_g), *by_input(angle, at.d_y, at.dd_y)
    on_other: Direction = (*turned_by((at.cos_bx, at.sin_bx), of_a),
                           *by_input(angle, at.d_bx, at.dd_b))
    between: Direction = (at.cos_mu, side * at.sin_mu,
                          *by_input(angle, side * at.d_mu, side * at.dd_mu))
    directions = (coupler, output) if first else (output, coupler)
    return DyadMotion(LinkMotion(*at_p, *directions[0]), LinkMotion(*at_q, *directions[1]), (),
                      side * at.sin_mu, at.cos_mu,
                      {(one if first else two, other): on_other, (two, one): between})


def rrp_pair(n: NumberType, sign: Scalar, stage: Stage, own: Numbers, at_p: Node, _at_q: Node,
             angle: Sequence[Scalar], _first: LinkMotion, _second: LinkMotion) -> DyadMotion:
    """
    Return how RRP moves as rod and block of a slider-crank.

    The frame has the line of the block; the crank is a, from the pin O to P on the other link.
    """
    from fourbar_ros.mechanisms.slides import rod_on_line  # of these alone
    (a1, e, cos_0, sin_0, start, o_x, o_y), (a2, *line) = own.shape, own.sizes
    unit, of_0 = n.power_of_two(a1, a2, e), (cos_0, sin_0)
    of_a, (t_x, t_y) = turned_by(of_0, line), line
    beside_0 = nudge(n, *map(n.exact_sum, ((a2, -e, a1), (a2, -e, -a1), (a2, e, a1),
                                           (a2, e, -a1))))
    one, other = stage.number, stage.first
    foot_x, foot_y = o_x - e * t_y, o_y + e * t_x       # of O on the line
    cos_x, sin_x = turned_by(angle[:2], of_0)
    at = rod_on_line(n, a1 / unit, a2 / unit, e / unit, sign, cos_x + beside_0, sin_x)
    s = unit * at.s
    d_s, dd_s = by_input(angle, unit * at.d_s, unit * at.dd_s)
    rod = LinkMotion(*at_p, *turned_by((at.cos_b, at.sin_b), line),
                     *by_input(angle, at.d_b, at.dd_b))
    block = LinkMotion(foot_x + s * t_x, foot_y + s * t_y, d_s * t_x, d_s * t_y, dd_s * t_x,
                       dd_s * t_y, t_x, t_y, 0.0, 0.0)
    on_other: Direction = (*turned_by((at.cos_2, at.sin_2), of_a),
                           *by_input(angle, at.d_theta2, at.dd_b))
    return DyadMotion(rod, block, (s - start, d_s, dd_s), at.cos_b, at.sin_b,
                      {(one, other): on_other})


def _bar(stage: Stage, at_p: Node, at_q: Node, direction: Direction, slide: tuple[Scalar, ...],
         sine: Scalar, cosine: Scalar, relations: Relations) -> DyadMotion:
    """Return the motion of RPR by the direction of its bar, seen from the end on the frame."""
    c, s, turn, bend = direction
    if not stage.turns_first:
        c, s = -c, -s
    return DyadMotion(LinkMotion(*at_p, c, s, turn, bend), LinkMotion(*at_q, c, s, turn, bend),
                      slide, sine, cosine, relations)


def rpr_pair(n: NumberType, sign: Scalar, stage: Stage, own: Numbers, at_p: Node, at_q: Node,
             angle: Sequence[Scalar], _first: LinkMotion, _second: LinkMotion) -> DyadMotion:
    """Return how RPR moves as block and bar of an inverted slider-crank."""
    from fourbar_ros.mechanisms.slides import block_on_bar  # of these alone
    (a1, a4, cos_0, sin_0, *of_g), (h,) = own.shape, own.sizes
    unit = n.power_of_two(a1, a4, h)
    beside_0 = nudge(n, *map(n.exact_sum, ((a1, -a4, h), (a1, -a4, -h), (a1, a4, h),
                                           (a1, a4, -h))))
    h, of_a = h / unit, turned_by((cos_0, sin_0), of_g)
    side, link = (1.0, stage.number) if stage.turns_first else (-1.0, stage.number + 1)
    pinned = link, other_of(stage)
    cos_x, sin_x = turned_by(angle[:2], (cos_0, sin_0))
    at = block_on_bar(n, a1 / unit, a4 / unit, h, sign, *half_angle(n, cos_x, sin_x + beside_0))
    per = n.sqrt(at.per_q)
    bar: Direction = *turned_by((at.cos_y, at.sin_y), of_g), *by_input(angle, at.d_y, at.dd_y)
    on_other: Direction = (*turned_by((side * at.cos_2, side * at.sin_2), of_a),
                           *by_input(angle, at.d_theta2, at.dd_y))
    return _bar(stage, at_p, at_q, bar,
                (unit * at.l, *by_input(angle, unit * at.d_l, unit * at.dd_l)),
                at.l * per, h * per, {pinned: on_other})


def rrr_slide(n: NumberType, sign: Scalar, stage: Stage, own: Numbers, at_p: Node, at_q: Node,
              slide: Sequence[Scalar], _first: LinkMotion, _second: LinkMotion) -> DyadMotion:
    """
    Return how RRR moves as crank and coupler of a slider-crank.

    Its slider drives: the one of both links the dyad hangs on that slides in the other.
    """
    from fourbar_ros.mechanisms.slides import triangle  # of these alone
    (shift, e, *line), first = own.shape, stage.turns_first
    on_other, on_frame = own.sizes if first else own.sizes[::-1]
    unit, side = n.power_of_two(on_other, on_frame, e), 1.0 if first else -1.0
    per, (one, two) = 1.0 / unit, (stage.number, stage.number + 1)
    at = triangle(n, on_frame * per, on_other * per, e * per, side * sign,
                  (slide[0] + shift) * per)
    scaled = slide[1] * per, slide[2] * per
    frames: Direction = (*turned_by((at.cos_x, at.sin_x), line),
                         *by_input(scaled, at.d_x, at.dd_x))
    others: Direction = (*turned_by((-at.cos_b, -at.sin_b), line),
                         *by_input(scaled, at.d_b, at.dd_b))
    between: Direction = (-at.cos_2, side * at.sin_2,
                          *by_input(scaled, -side * at.d_theta2, -side * at.dd_theta2))
    directions = (others, frames) if first else (frames, others)
    return DyadMotion(LinkMotion(*at_p, *directions[0]), LinkMotion(*at_q, *directions[1]), (),
                      side * at.sin_2, -at.cos_2, {(two, one): between})


def rpr_slide(n: NumberType, sign: Scalar, stage: Stage, own: Numbers, at_p: Node, at_q: Node,
              slide: Sequence[Scalar], _first: LinkMotion, _second: LinkMotion) -> DyadMotion:
    """Return how RPR moves whose block, or bar, hangs on a slider, (P3), (P4)."""
    (shift, e, *line), (h,) = own.shape, own.sizes
    unit = n.power_of_two(e, h, shift)
    per, sqrt, where = 1.0 / unit, n.sqrt, n.where
    shift, e, h = shift * per, e * per, h * per
    k = (e - h) * (e + h)
    beside_0 = nudge(n, k)
    x = slide[0] * per + shift + beside_0
    q = x * x + e * e
    l = sign * sqrt(x * x + k)  # noqa: E741                                            # (P3)
    per_l, per_q, h_x, e_l = 1.0 / l, 1.0 / q, h * x, e * l
    d_l, dd_l = x * per_l, k * per_l * per_l * per_l                                    # (P4)
    over, under = where((h_x * e_l).real > 0.0, (-k, h_x + e_l), (h_x - e_l, q))
    d_y = over / (l * under)
    dd_y = (h * dd_l - 2.0 * x * d_y) * per_q
    scaled, root = (slide[1] * per, slide[2] * per), sqrt(per_q)
    bar: Direction = (*turned_by(((l * x + h * e) * per_q, (l * e - h * x) * per_q), line),
                      *by_input(scaled, d_y, dd_y))
    d_l, dd_l = by_input(scaled, unit * d_l, unit * dd_l)
    return _bar(stage, at_p, at_q, bar, (unit * l, d_l, dd_l), l * root, h * root, {})


# {(kind, whether a slide, not a pin, joins the links it hangs on): how it moves}
PAIRS = {(RRR, False): rrr_pair, (RRP, False): rrp_pair, (RPR, False): rpr_pair,
         (RRR, True): rrr_slide, (RPR, True): rpr_slide}


def rod_of_cylinder(at_p: Node, at_q: Node, driven: Any, _first: LinkMotion,
                    _second: LinkMotion) -> DyadMotion:
    """
    Return the motion of rod and tube of a cylinder, whose triangle the driver has solved.

    ``driven``: length, direction of the rod, sine and cosine of the transmission angle.
    """
    slide, rod, sine, cosine = driven
    return DyadMotion(LinkMotion(*at_p, *rod), LinkMotion(*at_q, *rod), (slide, 1.0, 0.0), sine,
                      cosine, {})


def make_moves(n: NumberType, layout: Layout, numbers: Sequence[Numbers],
               signs: Sequence[Scalar]) -> list[MovesDyad]:
    """
    Return for each dyad the function that solves it for its links, a :data:`MovesDyad`.

    Those of ``PAIRS`` are for dyads between links that are joined to each other and marked so
    (``stage.pair``: the general form would lose digits). ``signs``: the assembly mode of each dyad
    as +-1.
    """
    moves: list[MovesDyad] = []
    for stage, own, sign in zip(layout.stages, numbers, signs):
        if stage.name == CYLINDER:
            moves.append(rod_of_cylinder)
        elif stage.pair:
            moves.append(partial(PAIRS[stage.kind, stage.pair.slides], n, sign, stage, own))
        else:
            moves.append(partial(DYADS[stage.kind], n, sign, own.sizes))
    return moves


# --- where one closes ----------------------------------------------------------------------------

class Factor(NamedTuple):
    """
    A factor of the discriminant of a pair, by exact sums of its lengths.

    Of an angle x: plus cos^2(x/2) + minus sin^2(x/2), of RRP with x from the normal of its line;
    of a slide: plus sigma^2 + minus.
    """

    plus: float
    minus: float

    @property
    def is_limit(self) -> bool:
        """Return whether it changes its sign."""
        return self.plus * self.minus < 0.0

    @property
    def is_impossible(self) -> bool:
        """Return whether it is positive nowhere."""
        return max(self.plus, self.minus) <= 0.0


class PairRange:
    """
    Where a pair closes: where the factors of its discriminant are positive.

    Of two factors one at most is negative. One that vanishes in one direction and is positive
    elsewhere makes a change point; their exact signs tell. ``flats`` has its directions: +1.0 for
    x = 0, -1.0 for x = pi, or 0.0 for sigma = 0 of a slide.
    """

    def __init__(self, stage: Stage, own: Numbers) -> None:
        """
        Compute the factors once, from the dyad's ``own`` numbers with their ``shape``.

        That is (|a|, |g|, ...) where a pin joins the links it hangs on; with a slide (sigma where
        the slide is zero, e, ...): see :func:`shaped`.
        """
        assert stage.pair is not None
        self.slides, self.is_sine = stage.pair.slides, stage.kind == RRP
        # sigma where the slide is zero, or the direction of the other link where the angle is
        self._start: Any = own.shape[0] if self.slides else own.shape[2:4]
        self._factors = _factors(stage, own)
        self._arms: tuple[Scalar, ...] = own.shape[:2]
        # the lengths of its rods [m] and, with a pin, of the arms a and g (RRP has no g)
        rods = [*own.sizes[:{RRR: 2, RRP: 1, RPR: 0}[stage.kind]],
                *(() if self.slides else own.shape[:1 if self.is_sine else 2])]
        self._rods = min(rods, default=1.0), max(rods, default=1.0)
        self.is_impossible = any(factor.is_impossible for factor in self._factors)
        self.has_limits = any(factor.is_limit for factor in self._factors)
        self.flats = [sign for factor in self._factors for sign in self._flats_of(factor)]
        # those that vanish at toggles, real or complex, and not at flat positions
        self._toggles = [factor for factor in self._factors if not self._flats_of(factor)]
        self.has_toggles = bool(self._toggles)

    @property
    def evenness(self) -> float:
        """Return the least ratio, 0 to 1, of coefficients (0: a change point) or of rods."""
        sizes = [sorted(map(abs, (1.0 if self.slides else plus, minus)))
                 for plus, minus in self._factors]
        return min([small / large if large else 0.0 for small, large in [*sizes, self._rods]])

    def _flats_of(self, factor: Factor) -> list[float]:
        """Return the directions in which a factor vanishes, as in ``flats``."""
        if self.slides:
            return [0.0] if factor.minus == 0.0 < factor.plus else []
        return [sign for sign, value in ((1.0, factor.plus), (-1.0, factor.minus)) if value == 0.0]

    def place(self, relative: Sequence[Scalar]) -> tuple[Scalar, Scalar]:
        """
        Return the distance from a flat position, and the side, at an angle or slide of a pair.

        Of an angle (sin x, cos x), of RRP (cos x, sin x), of a slide (sigma, 0).
        """
        if self.slides:
            return relative[0] + self._start, 0.0
        c, s = turned_by(relative[:2], self._start)
        return (c, s) if self.is_sine else (s, c)

    def assembly_margin(self, n: NumberType, relative: Sequence[Scalar],
                        *_curves: LinkMotion) -> Scalar:
        """
        Return the product of the scaled factors that have toggles at an angle or slide of a pair.

        A factor is plus cos^2(x/2) + minus sin^2(x/2) of an angle x, plus s^2 + minus of a slide
        s, both from the flat position. It is positive where the pair closes, zero at its toggles.
        """
        sine, cosine = self.place(relative)
        of_plus, of_minus, product = sine * sine, 1.0, 1.0      # a slide: place() gives (s, 0)
        if not self.slides:
            of_minus, of_plus, _ = half_angle(n, cosine, sine)
        for plus, minus in self._toggles:
            size = abs(plus) * of_plus + 1.0 if self.slides else abs(plus) + abs(minus)
            product = product * ((plus * of_plus + minus * of_minus) * (1.0 / size))
        return product

    def square(self, n: NumberType, relative: Sequence[Scalar], *_curves: LinkMotion) -> Scalar:
        """
        Return |Q - P|^2 of RRR or RPR at an angle or slide; the motion has poles where it is zero.

        With a pin it is divided by (|a| + |g|)^2.
        """
        (one, other), (beside, ahead) = self._arms, self.place(relative)
        if self.slides:
            return beside * beside + other * other
        ss, cc, _ = half_angle(n, ahead, beside)
        # law of cosines: (|a| - |g|)^2 cos^2(x/2) + (|a| + |g|)^2 sin^2(x/2)
        return (one - other)**2 / (one + other)**2 * cc + ss

    def input_at(self, flat: float, is_driven: bool) -> float:
        """
        Return the input where a pair of the driven link and the ground lies flat [rad or m].

        ``flat``: one of ``flats``; ``is_driven``: whether the driven link, not the ground, moves
        in the pair's frame.
        """
        if self.slides:
            return float(0.0 - self._start)
        angle = atan2(*((flat, 0.0) if self.is_sine else (0.0, flat)))
        turn = angle - atan2(*self._start[::-1])
        folded = remainder(turn if is_driven else -turn, 2.0 * pi)
        return pi if folded == -pi else folded + 0.0


def _factors(stage: Stage, own: Numbers) -> list[Factor]:
    """
    Return the one or two factors of a pair's discriminant, positive where it closes.

    Of RRR they are (r1 + r2)^2 - d^2 and d^2 - (r1 - r2)^2, with d the distance of P and Q. Where
    a pin joins the links, |a| and |g| add up to it at the angle pi and differ by it at 0: the
    ``minus`` and the ``plus`` of a factor are its values there. With a slide d^2 = sigma^2 + e^2.
    Lengths are scaled by a power of two and their sums exact, so that a factor is 0.0 just at a
    change point.
    """
    assert stage.pair is not None
    unit = power_of_two(*own.sizes[:1 + (stage.kind == RRR)],
                        *own.shape[stage.pair.slides:2])
    sizes = [size / unit for size in own.sizes]
    # |a| and |g| (of RRP e); with a slide: sigma where it is zero, not read, and e
    first, second = [length / unit for length in own.shape[:2]]
    if stage.pair.slides:
        if stage.kind == RPR:
            return [Factor(unit**-2, difference_of_squares(second, 0.0, sizes[0], 0.0))]
        return [Factor(-unit**-2, difference_of_squares(sizes[0], sizes[1], second, 0.0)),
                Factor(unit**-2, -difference_of_squares(sizes[0], -sizes[1], second, 0.0))]
    if stage.kind == RRP:
        r = sizes[0]
        return [Factor(fsum((r, -second, first)), fsum((r, -second, -first))),
                Factor(fsum((r, second, -first)), fsum((r, second, first)))]
    near, far = (first, -second), (first, second)
    if stage.kind == RPR:
        return [Factor(*[difference_of_squares(*apart, sizes[0], 0.0) for apart in (near, far)])]
    return [Factor(*[difference_of_squares(sizes[0], sizes[1], *apart) for apart in (near, far)]),
            Factor(*[difference_of_squares(*apart, sizes[0], -sizes[1])
                     for apart in (near, far)])]
