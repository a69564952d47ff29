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
half-angle is that of the driven link, which counts its turns, or else

    (P1)  cos(x/2), sin(x/2):  the larger one |(1 + |cos x|, sin x)|/2, the other sin x / 2 over it

and primes, derivatives with respect to the input of the machine, follow by

    (P2)  y' = y'(x) x',   y'' = y''(x) x'^2 + y'(x) x''

With a slide, sigma + i e is the place of P seen from Q, along and across the slide:

    (P3)  RPR: l^2 = sigma^2 + (e - h)(e + h),   direction (l - i h)(sigma + i e)/q,   q = sigma^2
          + e^2
    (P4)  l' = sigma/l,   l'' = k/l^3,   k = (e - h)(e + h),   y'' = (h l'' - 2 sigma y')/q,
          y' = (h sigma - e l)/(l q) = -k/(l (h sigma + e l)), whichever does not cancel

and where k = 0 the block passes the foot: l = +-sigma, sigma is left out of the quotients.

Lengths that are not given, as |a|, are rounded once, as floats, and are data from there on: for
every type of numbers a change point is one, or none.
"""
from collections.abc import Sequence
from typing import Any

from fourbar_ros.mechanisms import slides
from fourbar_ros.mechanisms.curves import Direction, LinkMotion
from fourbar_ros.mechanisms.loop import HalfAngle, loop
from fourbar_ros.mechanisms.machine.solve.dyads import DyadMotion, Ends
from fourbar_ros.mechanisms.machine.structure import CYLINDER, DyadLengths, Layout, Pair, Stage
from fourbar_ros.numerics.number_types import is_zero, NumberType, Scalar

OnLink = tuple[Scalar, Scalar]       # along and across [m], a point of a link
OnBoth = tuple[OnLink, OnLink]
Joined = tuple[int, int]
# Of a link that slides: (its carrier, start and direction of the slide there).
Slide = tuple[int, OnLink, OnLink]
FIRST_JOINT = (0.0, 0.0)             # a point of a link
SQRT_HALF = 0.5**0.5                 # sine and cosine of pi/4


def slides_of(stage: Stage, lengths: DyadLengths) -> list[tuple[int, Slide]]:
    """Return [(index of a link that slides, its :data:`Slide`)] in the order of the joints."""
    # sizes: as Dyad.lengths has them, an angle by cosine and sine
    first, second, sizes = stage.link, stage.link + 1, lengths.sizes
    if stage.kind == 'RRP':
        return [(second, (stage.second, lengths.q, (sizes[1], sizes[2])))]
    if stage.kind == 'RPR':
        return [(first, (second, (0.0, sizes[0]), (1.0, 0.0)))]
    if stage.kind == 'RPP':
        return [(first, (second, FIRST_JOINT, (sizes[2], sizes[3]))),
                (second, (stage.second, lengths.q, (sizes[0], sizes[1])))]
    if stage.kind == 'PRP':
        return [(first, (stage.first, lengths.p, (sizes[0], sizes[1]))),
                (second, (stage.second, lengths.q, (sizes[2], sizes[3])))]
    return []


class Joints:
    """All joints of a machine, by the indices of their links."""

    # pins: {(a link, a link it is pinned to): (point of the first, of the second)}, each pin both
    # ways; slides: {(a link, its carrier): (start of the slide, its direction), on the carrier}.

    def __init__(self, driver: str, stages: Sequence[Stage], dyad_lengths: Sequence[DyadLengths]
                 ) -> None:
        pins, self.slides = dict[Joined, OnBoth](), dict[Joined, OnBoth]()
        if driver == 'slide':
            self.slides[1, 0] = FIRST_JOINT, (1.0, 0.0)
        else:
            pins[1, 0] = FIRST_JOINT, FIRST_JOINT
        for stage, lengths in zip(stages, dyad_lengths):
            first, second = stage.link, stage.link + 1
            if stage.kind == 'PRP':
                pins[second, first] = FIRST_JOINT, FIRST_JOINT
            else:
                pins[first, stage.first] = FIRST_JOINT, lengths.p
            if stage.kind in ('RRR', 'RPR'):
                pins[second, stage.second] = FIRST_JOINT, lengths.q
            elif stage.kind == 'RRP':
                pins[second, first] = FIRST_JOINT, (lengths.sizes[0], 0.0)
            if stage.kind == 'RRR':         # the far ends of both rods
                pins[second, first] = (lengths.sizes[1], 0.0), (lengths.sizes[0], 0.0)
            for link, (carrier, start, direction) in slides_of(stage, lengths):
                self.slides[link, carrier] = start, direction
        self.pins = {both: points for (a, b), (of_a, of_b) in pins.items()
                     for both, points in (((a, b), (of_a, of_b)), ((b, a), (of_b, of_a)))}

    def pair_of(self, stage: Stage) -> Pair | None:
        """Return the :class:`Pair` of a dyad, None where its links are not joined."""
        if (stage.first, stage.second) in self.pins and stage.kind in ('RRR', 'RRP', 'RPR'):
            # of a pin the link that was there before, of RRP that with the line
            frame, moving = ((stage.second, stage.first) if stage.kind == 'RRP'
                             else sorted((stage.first, stage.second)))
            return Pair(frame, moving, False)
        for link, carrier in ((stage.first, stage.second), (stage.second, stage.first)):
            if (link, carrier) in self.slides and stage.kind in ('RRR', 'RPR'):
                return Pair(carrier, link, True)
        return None


def half_angle(n: NumberType, cos_x: Scalar, sin_x: Scalar, is_sine_positive: bool) -> HalfAngle:
    """Return half of an angle that does not turn fully, without cancellation, (P1)."""
    # The cosine is positive, for x from -pi to pi, or the sine, for x from 0 to 2 pi.
    where, is_ahead, is_left = n.where, cos_x.real > 0.0, sin_x.real > 0.0
    size = 1.0 + n.fabs(cos_x)
    large = 0.5 * size
    small = 0.25 * sin_x * sin_x / large
    ss, cc = where(is_ahead, (small, large), (large, small))
    large = 0.5 * n.hypot(size, sin_x)
    small = 0.5 * sin_x / large
    c, s = where(is_ahead, (large, small), (small, large))      # one of both is positive
    sign_of_small = where(is_left, 1.0, -1.0)
    sign = where(is_ahead, where(is_sine_positive, sign_of_small, 1.0),
                 where(is_sine_positive, 1.0, sign_of_small))
    return HalfAngle(sign * s, sign * c, ss, cc, 0.5 * sin_x)


def turned_by(first: Sequence[Scalar], second: Sequence[Scalar]) -> tuple[Scalar, Scalar]:
    """Return (cosine, sine) of the sum of two angles, each given so."""
    (c, s), (cosine, sine) = first, second
    return c * cosine - s * sine, s * cosine + c * sine


def _shape(n: NumberType, stage: Stage, pair: Pair, lengths: DyadLengths, joints: Joints
           ) -> tuple[Any, ...]:
    """Return the loop of a pair besides sizes of the dyad: ``shape``, as shaped() says."""
    # The frame has the point Q, or the line of RRP; on the link that moves in it is P.
    (p_x, p_y), (q_x, q_y) = ((lengths.p, lengths.q) if pair.moving == stage.first
                              else (lengths.q, lengths.p))
    if pair.slides:
        (x, y), (c, s) = joints.slides[pair.moving, pair.frame]
        return (p_x + (x - q_x) * c + (y - q_y) * s, p_y + (y - q_y) * c - (x - q_x) * s, c, s)
    (o_x, o_y), (x, y) = joints.pins[pair.moving, pair.frame]
    a_x, a_y, g_x, g_y = p_x - o_x, p_y - o_y, q_x - x, q_y - y
    if stage.kind == 'RRP':
        t_x, t_y = lengths.sizes[1:]
        a1 = n.hypot(a_x, a_y)
        size = not_zero(n, a1)
        scalar, cross = a_x * t_x + a_y * t_y, a_y * t_x - a_x * t_y
        half = half_angle(n, scalar / size, cross / size, False)
        # a crank across the line stays there to the bit: it may be a change point at input 0
        half_0 = n.where(is_zero(n, scalar), (SQRT_HALF, n.where(cross.real > 0.0, SQRT_HALF,
                                                                 -SQRT_HALF)),
                         (half.cosine, half.sine))
        return a1, g_y * t_x - g_x * t_y, half_0, g_x * t_x + g_y * t_y, x, y
    a1, a4 = n.hypot(a_x, a_y), n.hypot(g_x, g_y)
    scalar, cross = a_x * g_x + a_y * g_y, a_y * g_x - a_x * g_y
    size, of_g = not_zero(n, n.hypot(scalar, cross)), not_zero(n, a4)
    half = half_angle(n, scalar / size, cross / size, False)
    return a1, a4, (half.cosine, half.sine), g_x / of_g, g_y / of_g


def not_zero(n: NumberType, length: Scalar) -> Scalar:
    """Return a length, 1.0 of a point in the pin itself, whose direction then does not matter."""
    divisor: Scalar = n.where(is_zero(n, length), 1.0, length)
    return divisor


def shaped(n: NumberType, layout: Layout, dyad_lengths: Sequence[DyadLengths]
           ) -> list[DyadLengths]:
    """Return the lengths of all dyads with what follows from them once and for all."""
    # That is reach, |p| and |q|, and of a pair its shape, a tuple:
    #   RRR, RPR with a pin    |a|, |g|, (cosine, sine) of half the angle from g to a, cosine and
    #                          sine of g
    #   RRP                    |a|, e of the line from O, (cosine, sine) of half the angle from the
    #                          line to a, how far Q is along it from O, x and y of O
    #   with a slide           sigma where the slide is zero, e, cosine and sine of the slide
    # The shape of a cylinder is its reach: the distances of pin and base from O1.
    joints, with_shapes = Joints(layout.driver, layout.stages, dyad_lengths), []
    for stage, lengths in zip(layout.stages, dyad_lengths):
        reach = n.hypot(*lengths.p), n.hypot(*lengths.q)
        shape = (_shape(n, stage, stage.pair, lengths, joints) if stage.pair
                 else reach if stage.name == CYLINDER else ())
        with_shapes.append(lengths._replace(reach=reach, shape=shape))
    return with_shapes


def by_input(relative: Sequence[Scalar], first: Scalar, second: Scalar) -> tuple[Scalar, Scalar]:
    """Return derivatives by the input from those by an angle or slide, ``relative``, by (P2)."""
    rate, change = relative[-2:]
    return first * rate, second * rate * rate + first * change


def in_frame(direction: Direction, axis: Sequence[Scalar], relative: Sequence[Scalar]
             ) -> Direction:
    """Return a direction that counts from an axis of the frame, with derivatives by the input."""
    cosine, sine, first, second = direction
    return *turned_by((cosine, sine), axis), *by_input(relative, first, second)


def rrr_pair(n: NumberType, sign: Scalar, stage: Stage, pair: Pair, lengths: DyadLengths,
             ends: Ends) -> DyadMotion:
    """Return how RRR moves as coupler and output link of a 4R linkage."""
    # The angle is from g to a, the arms of the pin that joins the links the dyad hangs on.
    angle = ends.relative
    a1, a4, half_0, *of_g = lengths.shape
    first, of_0 = pair.moving == stage.first, turned_by(half_0, half_0)     # of_0: g to a at 0
    # where the dyad's second link hangs on the one that moves, all is mirrored
    side, (a2, a3) = (1.0, lengths.sizes) if first else (-1.0, lengths.sizes[::-1])
    of_a = turned_by(of_0, of_g)
    rod_1, rod_2 = stage.link, stage.link + 1
    # of a flat position at x = pi, sin(x/2) keeps its sign there
    half = HalfAngle.of(*turned_by(ends.half, half_0)) if ends.half else half_angle(
        n, *turned_by(angle[:2], of_0), is_zero(n, n.exact_sum((a1, -a2, -a3, a4))))
    bars = loop(n, (a1, a2, a3, a4), side * sign, half, pair.can_lie_flat)
    coupler, output = in_frame(bars.b, of_g, angle), in_frame(bars.y, of_g, angle)
    on_moving = in_frame(bars.theta2, of_a, angle)
    cos_mu, sin_mu, d_mu, dd_mu = bars.mu
    sine = side * sin_mu
    between: Direction = (cos_mu, sine, *by_input(angle, side * d_mu, side * dd_mu))
    directions = (coupler, output) if first else (output, coupler)
    return DyadMotion(LinkMotion(*ends.p, *directions[0]), LinkMotion(*ends.q, *directions[1]), (),
                      sine, cos_mu, {(rod_1 if first else rod_2, pair.moving): on_moving,
                                     (rod_2, rod_1): between})


def rrp_pair(n: NumberType, sign: Scalar, stage: Stage, pair: Pair, lengths: DyadLengths,
             ends: Ends) -> DyadMotion:
    """Return how RRP moves as rod and block of a slider-crank."""
    # The frame has the line of the block; the crank is a, from the pin O to P on the moving link.
    angle = ends.relative
    (a1, e, half_0, start, o_x, o_y), (a2, *line) = lengths.shape, lengths.sizes
    unit, of_0 = n.power_of_two(a1, a2, e), turned_by(half_0, half_0)
    of_a, (t_x, t_y) = turned_by(of_0, line), line
    rod_link, moving = stage.link, pair.moving
    foot_x, foot_y = o_x - e * t_y, o_y + e * t_x       # of O on the line
    cos_x, sin_x = turned_by(angle[:2], of_0)
    if ends.half:       # v = x/2 + pi/4, with 2 v from -pi to pi or from 0 to 2 pi
        cos_v, sin_v = turned_by(ends.half, turned_by(half_0, (SQRT_HALF, SQRT_HALF)))
    else:
        of_2v = half_angle(n, -sin_x, cos_x, is_zero(n, n.exact_sum((a2, e, -a1))))
        sin_v, cos_v = of_2v.sine, of_2v.cosine
    b, theta2, slide = slides.rod_on_line(n, a1 / unit, a2 / unit, e / unit, sign, cos_x, sin_x,
                                          sin_v, cos_v, pair.can_lie_flat)
    s, first, second = [unit * value for value in slide]
    d_s, dd_s = by_input(angle, first, second)
    rod = LinkMotion(*ends.p, *in_frame(b, line, angle))
    block = LinkMotion(foot_x + s * t_x, foot_y + s * t_y, d_s * t_x, d_s * t_y, dd_s * t_x,
                       dd_s * t_y, t_x, t_y, 0.0, 0.0)
    # the transmission angle is that of the rod and the normal of the line: its sine is cos b
    cos_b, sin_b, *_ = b
    return DyadMotion(rod, block, (s - start, d_s, dd_s), cos_b, sin_b,
                      {(rod_link, moving): in_frame(theta2, of_a, angle)})


def _bar(is_first: bool, ends: Ends, direction: Direction, slide: tuple[Scalar, ...],
         sine: Scalar, cosine: Scalar, relations: dict[Joined, Direction]) -> DyadMotion:
    """Return the motion of RPR by the direction of its bar, seen from the end on the frame."""
    c, s, turn, bend = direction
    if not is_first:
        c, s = -c, -s
    return DyadMotion(LinkMotion(*ends.p, c, s, turn, bend), LinkMotion(*ends.q, c, s, turn, bend),
                      slide, sine, cosine, relations)


def rpr_pair(n: NumberType, sign: Scalar, stage: Stage, pair: Pair, lengths: DyadLengths,
             ends: Ends) -> DyadMotion:
    """Return how RPR moves as block and bar of an inverted slider-crank."""
    angle = ends.relative
    (a1, a4, half_0, *of_g), (h,) = lengths.shape, lengths.sizes
    unit, of_0 = n.power_of_two(a1, a4, h), turned_by(half_0, half_0)
    h, of_a = h / unit, turned_by(of_0, of_g)
    # theta2 is of the bar as the crank sees it; where the bar hangs on the crank it points back
    is_first = pair.moving == stage.first
    side, link = (1.0, stage.link) if is_first else (-1.0, stage.link + 1)
    half = HalfAngle.of(*turned_by(ends.half, half_0)) if ends.half else half_angle(
        n, *turned_by(angle[:2], of_0), False)
    block = slides.block_on_bar(n, a1 / unit, a4 / unit, h, sign, half, pair.can_lie_flat)
    bar, (cos_2, sin_2, *changes) = in_frame(block.y, of_g, angle), block.theta2
    on_moving: Direction = (*turned_by((side * cos_2, side * sin_2), of_a),
                            *by_input(angle, *changes))
    slide, first, second = [unit * value for value in block.slide]
    return _bar(is_first, ends, bar, (slide, *by_input(angle, first, second)), block.sine,
                block.cosine, {(link, pair.moving): on_moving})


def rrr_slide(n: NumberType, sign: Scalar, stage: Stage, pair: Pair, lengths: DyadLengths,
              ends: Ends) -> DyadMotion:
    """Return how RRR moves as crank and coupler of a slider-crank."""
    # Its slider drives: that link on which the dyad hangs that slides in the second one.
    slide = ends.relative
    (shift, e, *line), first = lengths.shape, pair.moving == stage.first
    on_moving, on_frame = lengths.sizes if first else lengths.sizes[::-1]
    unit, side = n.power_of_two(on_moving, on_frame, e), 1.0 if first else -1.0
    per, (rod_1, rod_2) = 1.0 / unit, (stage.link, stage.link + 1)
    x, (cos_b, sin_b, *changes), (cos_2, sin_2, d_2, dd_2) = slides.triangle(
        n, on_frame * per, on_moving * per, e * per, side * sign, (slide[0] + shift) * per,
        pair.can_lie_flat)
    scaled = slide[1] * per, slide[2] * per
    of_frame = in_frame(x, line, scaled)
    of_moving: Direction = (*turned_by((-cos_b, -sin_b), line), *by_input(scaled, *changes))
    between: Direction = -cos_2, side * sin_2, *by_input(scaled, -side * d_2, -side * dd_2)
    directions = (of_moving, of_frame) if first else (of_frame, of_moving)
    cosine, sine, *_ = between
    return DyadMotion(LinkMotion(*ends.p, *directions[0]), LinkMotion(*ends.q, *directions[1]), (),
                      sine, cosine, {(rod_2, rod_1): between})


def rpr_slide(n: NumberType, sign: Scalar, stage: Stage, pair: Pair, lengths: DyadLengths,
              ends: Ends) -> DyadMotion:
    """Return how RPR moves whose block, or bar, hangs on a slider, (P3), (P4)."""
    slide = ends.relative
    (shift, e, *line), (h,) = lengths.shape, lengths.sizes
    unit = n.power_of_two(e, h, shift)
    per, where = 1.0 / unit, n.where
    shift, e, h = shift * per, e * per, h * per
    k = n.difference_of_squares(e, 0.0, h, 0.0)
    passes_foot = pair.can_lie_flat and is_zero(n, k)
    meets = pair.can_lie_flat and is_zero(n, n.fabs(e) + n.fabs(h))     # P, Q at sigma = 0
    x = slide[0] * per + shift      # sigma
    # where the block passes the foot, x is left out of l and x: what is left of both, times it
    factor, x_left = where(passes_foot, (x, 1.0), (1.0, x))
    q = where(meets, 1.0, x * x + e * e)
    l_left = sign * n.sqrt(where(passes_foot, 1.0, x * x + k))                          # (P3)
    l = l_left * factor     # noqa: E741
    per_l, per_q, h_x, e_l = 1.0 / l_left, 1.0 / q, h * x_left, e * l_left
    d_l, dd_l = x_left * per_l, k * per_l * per_l * per_l                               # (P4)
    over, under = where((h_x * e_l).real > 0.0, (-k, h_x + e_l), (h_x - e_l, q))
    d_y = over / (l_left * under)
    dd_y = (h * dd_l - 2.0 * x * d_y) * per_q
    scaled, root = (slide[1] * per, slide[2] * per), n.sqrt(per_q)
    toward = where(meets, (l_left, 0.0), ((l * x + h * e) * per_q, (l * e - h * x) * per_q))
    bar: Direction = (*turned_by(toward, line), *by_input(scaled, d_y, dd_y))
    d_l, dd_l = by_input(scaled, unit * d_l, unit * dd_l)
    return _bar(pair.moving == stage.first, ends, bar, (unit * l, d_l, dd_l),
                where(meets, l_left, l * root), h * root, {})


# {(kind, whether a slide, not a pin, joins the links it hangs on): how it moves}
PAIRS = {('RRR', False): rrr_pair, ('RRP', False): rrp_pair, ('RPR', False): rpr_pair,
         ('RRR', True): rrr_slide, ('RPR', True): rpr_slide}


def rod_of_cylinder(ends: Ends) -> DyadMotion:
    """Return the motion of rod and tube of a cylinder, whose triangle the driver has solved."""
    length, rod, sine, cosine = ends.relative
    return DyadMotion(LinkMotion(*ends.p, *rod), LinkMotion(*ends.q, *rod), (length, 1.0, 0.0),
                      sine, cosine, {})
