# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Assembly margins: scalars whose signs tell whether dyads can be assembled.

A dyad closes where its *assembly margin* is positive, a number without unit that vanishes at its
toggles. That of a pair (:mod:`.solve.pairs`) is a product of factors, see :class:`PairRange`; of
others

    (X1)  RRR: ((r1 + r2)^2 - q)(q - (r1 - r2)^2) / (r1 + r2)^4
    (X2)  RRP: (r1 - h)(r1 + h) / r1^2        RPR: (|d|^2 - h^2) / (|d|^2 + (a length)^2)
    (X3)  PRP: t1 x t2, which may have either sign: a range ends where the lines are parallel
"""
from collections.abc import Callable, Sequence
from functools import partial
from math import atan2, pi, remainder
from typing import Any

from fourbar_ros.mechanisms.curves import MovingPoint
from fourbar_ros.mechanisms.machine.solve.dyads import Ends, turned
from fourbar_ros.mechanisms.machine.solve.frames import driven_link, hangings, Poses
from fourbar_ros.mechanisms.machine.solve.pairs import half_angle, turned_by
from fourbar_ros.mechanisms.machine.structure import DyadLengths, Layout, Stage
from fourbar_ros.numerics import number_types
from fourbar_ros.numerics.number_types import exact_sum, Function, NumberType, REAL, Scalar

CLOSING = ('RRR', 'RRP', 'RPR', 'PRP')     # kinds that do not close at any input
# (plus, minus) of a factor of the discriminant of a pair, by exact sums of its lengths. Of an
# angle x: plus cos^2(x/2) + minus sin^2(x/2), of RRP with x from the normal of its line; of a
# slide: plus sigma^2 + minus.
Factor = tuple[float, float]
Measure = Callable[[Ends], Any]      # of the ends of a dyad, wherever they are


class PairRange:
    """Where a pair closes: where the factors of its discriminant are positive."""

    # Of two factors one at most is negative. One that vanishes in one direction and is positive
    # elsewhere makes a change point; their exact signs tell. flats has its directions: +1.0 for x
    # = 0, -1.0 for x = pi, or 0.0 for sigma = 0 of a slide.

    def __init__(self, stage: Stage, lengths: DyadLengths) -> None:
        """Compute the factors once, from the dyad's lengths with their ``shape``."""
        # shape: where a pin joins the links it hangs on, (|a|, |g|, half the angle from g to a,
        # ...), |g| of RRP the distance of its line; with a slide (sigma where it is zero, e, ...).
        assert stage.pair is not None
        # the angle of RRP counts from the normal of its line, so that its sine is a cosine
        self.slides, self.is_sine = stage.pair.slides, stage.kind == 'RRP'
        self._moving = stage.pair.moving
        # what the relative slide or angle of both links, as Ends give it, is counted from: sigma
        # where the slide is zero, or twice the half angle as (cosine, sine)
        self._start: Any = (lengths.shape[0] if self.slides
                            else turned_by(lengths.shape[2], lengths.shape[2]))
        self._factors = _factors(stage, lengths)
        self._arms: tuple[Scalar, ...] = lengths.shape[:2]
        self.is_impossible = any(max(factor) <= 0.0 for factor in self._factors)
        self.has_limits = any(plus * minus < 0.0 for plus, minus in self._factors)
        self.flats = [sign for factor in self._factors for sign in self._flats_of(factor)]
        # those that vanish at toggles, real or complex, and not at flat positions
        self._toggles = [factor for factor in self._factors if not self._flats_of(factor)]
        self.has_toggles = bool(self._toggles)

    def _flats_of(self, factor: Factor) -> list[float]:
        """Return the directions in which a factor vanishes, as in ``flats``."""
        plus, minus = factor
        if self.slides:
            return [0.0] if minus == 0.0 < plus else []
        return [sign for sign, value in ((1.0, plus), (-1.0, minus)) if value == 0.0]

    def flatness(self, relative: Sequence[Scalar]) -> tuple[Scalar, Scalar]:
        """Return the distance from a flat position, and the side: (sin x, cos x), (sigma, 0)."""
        # Of RRP with x from the normal: (cos x, sin x).
        if self.slides:
            return relative[0] + self._start, 0.0
        c, s = turned_by(relative[:2], self._start)
        return (c, s) if self.is_sine else (s, c)

    def assembly_margin(self, n: NumberType, ends: Ends) -> Scalar:
        """Return the product of the scaled factors of a pair that have toggles."""
        # A factor is plus cos^2(x/2) + minus sin^2(x/2) of an angle x, plus s^2 + minus of a slide
        # s, both from the flat position. It is positive where the pair closes, zero at its
        # toggles.
        sine, cosine = self.flatness(ends.relative)
        of_plus, of_minus, product = sine * sine, 1.0, 1.0      # a slide: flatness() gives (s, 0)
        if not self.slides:
            _, _, of_minus, of_plus, _ = half_angle(n, cosine, sine, False)
        for plus, minus in self._toggles:
            # of a slide far above the sizes of ``minus``, so that no pole is near its roots
            size = abs(plus) * of_plus + 64.0 if self.slides else abs(plus) + abs(minus)
            product = product * ((plus * of_plus + minus * of_minus) * (1.0 / size))
        return product

    def square(self, n: NumberType, ends: Ends) -> Scalar:
        """Return |Q - P|^2 of RRR or RPR; the motion has poles where it is zero."""
        # With a pin it is divided by (|a| + |g|)^2.
        first, second = self.flatness(ends.relative)
        if self.slides:
            sigma, (_, e) = first, self._arms
            return sigma * sigma + e * e
        (a, g), sin_x, cos_x = self._arms, first, second
        _, _, ss, cc, _ = half_angle(n, cos_x, sin_x, False)
        # law of cosines: (|a| - |g|)^2 cos^2(x/2) + (|a| + |g|)^2 sin^2(x/2)
        return (a - g)**2 / (a + g)**2 * cc + ss

    def inputs(self, limits: Sequence[Any]) -> list[float]:
        """Return the inputs within limits where a pair of frame and driven link lies flat."""
        # limits: the two ends of each range, None of a full turn
        if self.slides:
            flats, turns = [float(0.0 - self._start)] * len(self.flats), [0.0]
        else:
            turned = [atan2(*((flat, 0.0) if self.is_sine else (0.0, flat)))
                      - atan2(*self._start[::-1]) for flat in self.flats]
            # the angle of the driven link, as the frame of the pair or the other one sees it
            folded = [remainder(turn if self._moving == 1 else -turn, 2.0 * pi) for turn in turned]
            flats = [pi if x == -pi else x + 0.0 for x in folded]
            turns = [-2.0 * pi, 0.0, 2.0 * pi]
        return [x for x in flats if any(bound is None or bound[0].x < x + turn < bound[1].x
                                        for bound in limits for turn in turns)]


def _factors(stage: Stage, lengths: DyadLengths) -> list[Factor]:
    """Return the one or two factors of a pair's discriminant, positive where it closes."""
    # Of RRR they are (r1 + r2)^2 - d^2 and d^2 - (r1 - r2)^2, with d the distance of P and Q.
    # Where a pin joins the links, |a| and |g| add up to it at the angle pi and differ by it at 0:
    # the minus and the plus of a factor are its values there. With a slide d^2 = sigma^2 + e^2.
    # Lengths are scaled by a power of two and their sums exact, so that a factor is 0.0 just at a
    # change point.
    assert stage.pair is not None
    # |a| and |g| (of RRP e); with a slide: sigma where it is zero, not read, and e
    first, second = lengths.shape[:2]
    rods = lengths.sizes[:2] if stage.kind == 'RRR' else lengths.sizes[:1]      # of RPR its offset
    unit = number_types.power_of_two(*rods, second, *([] if stage.pair.slides else [first]))
    first, second, *sizes = [length / unit for length in (first, second, *rods)]
    squares = REAL.difference_of_squares        # (a + b)^2 - (c + d)^2 of (a, b, c, d)
    if stage.pair.slides:
        if stage.kind == 'RPR':
            return [(unit**-2, squares(second, 0.0, sizes[0], 0.0))]
        return [(-unit**-2, squares(sizes[0], sizes[1], second, 0.0)),
                (unit**-2, -squares(sizes[0], -sizes[1], second, 0.0))]
    if stage.kind == 'RRP':
        r = sizes[0]
        return [(exact_sum((r, -second, first)), exact_sum((r, -second, -first))),
                (exact_sum((r, second, -first)), exact_sum((r, second, first)))]
    near, far = (first, -second), (first, second)       # add up to d at x = 0, at x = pi
    if stage.kind == 'RPR':
        return [(squares(*near, sizes[0], 0.0), squares(*far, sizes[0], 0.0))]
    return [(squares(sizes[0], sizes[1], *near), squares(sizes[0], sizes[1], *far)),
            (squares(*near, sizes[0], -sizes[1]), squares(*far, sizes[0], -sizes[1]))]


def assembly_margin(n: NumberType, kind: str, lengths: DyadLengths, ends: Ends) -> Scalar:
    """Return the margin of a dyad whose carriers are not joined to each other, (X1) to (X3)."""
    sizes = lengths.sizes
    if kind == 'PRP':
        (x1, y1), (x2, y2) = (turned(ends.first, *sizes[:2])[:2],
                              turned(ends.second, *sizes[2:])[:2])
        return x1 * y2 - y1 * x2
    apart: MovingPoint = ends.apart
    x, y = apart[:2]
    q = x * x + y * y
    if kind == 'RRR':
        r1, r2 = sizes
        outer, inner = (r1 + r2) * (r1 + r2), (r1 - r2) * (r1 - r2)
        return (outer - q) / outer * ((q - inner) / outer)
    if kind == 'RRP':
        t_x, t_y = turned(ends.second, *sizes[1:])[:2]
        h = (y * t_x - x * t_y) / sizes[0]
        return (1.0 - h) * (1.0 + h)
    size = sum(map(n.fabs, (*lengths.p, *lengths.q, *sizes)), start=0.0)
    return (q - sizes[0] * sizes[0]) / (q + size * size)


def margin_of_dyad(n: NumberType, stage: Stage, lengths: DyadLengths,
                   converted: DyadLengths | None = None) -> Measure:
    """Return ends -> assembly margin of a dyad."""
    # converted: its lengths as the number type has them, if it is not one of floats.
    if stage.pair:
        return partial(PairRange(stage, lengths).assembly_margin, n)
    return partial(assembly_margin, n, stage.kind, converted or lengths)


def square_of_dyad(n: NumberType, stage: Stage, lengths: DyadLengths) -> Measure:
    """Return ends -> |D|^2, scaled, of RRR or RPR; where it is zero, links have a pole."""
    if stage.pair:
        return partial(PairRange(stage, lengths).square, n)
    size = sum(map(abs, (*lengths.p, *lengths.q, *lengths.sizes)), start=0.0)

    def square(ends: Ends) -> Scalar:
        apart: MovingPoint = ends.apart
        x, y = apart[:2]
        return (x * x + y * y) / (size * size)
    return square


def make_along(n: NumberType, layout: Layout, dyad_lengths: Sequence[DyadLengths],
               signs: Sequence[Scalar], dyad: int, measure: Measure) -> Function:
    """Return input -> the measure of the ends of a dyad, which may be unable to close."""
    hanging = hangings(n, layout, dyad_lengths, signs)
    return lambda x: measure(
        Poses(hanging, driven_link(n, layout, dyad_lengths, signs, x)).carry(dyad))
