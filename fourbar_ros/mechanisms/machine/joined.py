# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
What follows from the lengths of pairs, and where they close.

A dyad is a pair where the links on which it hangs are joined to each other, see
:mod:`.solve.pairs`.
"""
from __future__ import annotations

from collections.abc import Sequence
from math import atan2, pi, remainder
from typing import Any

from fourbar_ros.mechanisms.machine.solve.dyads import Ends
from fourbar_ros.mechanisms.machine.solve.pairs import half_angle, Joints, turned_by
from fourbar_ros.mechanisms.machine.structure import CYLINDER, DyadLengths, Layout, Stage
from fourbar_ros.numerics.number_types import (
    exact_sum,
    is_zero,
    NumberType,
    power_of_two,
    REAL,
    Scalar,
)


def _shape(n: NumberType, stage: Stage, lengths: DyadLengths, joints: Joints
           ) -> tuple[Any, ...]:
    """Return the loop of a pair besides sizes of the dyad: ``shape`` of shaped()."""
    assert stage.pair is not None
    frame, moving = stage.pair.frame, stage.moving
    (p_x, p_y), (q_x, q_y) = ((lengths.p, lengths.q) if stage.turns_first
                              else (lengths.q, lengths.p))
    if stage.pair.slides:
        (x, y), (c, s) = joints.slides[moving, frame]
        return (p_x + (x - q_x) * c + (y - q_y) * s, p_y + (y - q_y) * c - (x - q_x) * s, c, s)
    (o_x, o_y), (x, y) = joints.pin(moving, frame)
    a_x, a_y, g_x, g_y = p_x - o_x, p_y - o_y, q_x - x, q_y - y
    if stage.kind == 'RRP':
        t_x, t_y = lengths.sizes[1:]
        a1 = n.hypot(a_x, a_y)
        size = not_zero(n, a1)
        half = half_angle(n, (a_x * t_x + a_y * t_y) / size, (a_y * t_x - a_x * t_y) / size, True)
        half_0 = half.cosine, half.sine
        return a1, g_y * t_x - g_x * t_y, half_0, g_x * t_x + g_y * t_y, x, y
    a1, a4 = n.hypot(a_x, a_y), n.hypot(g_x, g_y)
    scalar, cross = a_x * g_x + a_y * g_y, a_y * g_x - a_x * g_y
    size, of_g = not_zero(n, n.hypot(scalar, cross)), not_zero(n, a4)
    half = half_angle(n, scalar / size, cross / size, True)
    return a1, a4, (half.cosine, half.sine), g_x / of_g, g_y / of_g


def not_zero(n: NumberType, length: Scalar) -> Scalar:
    """Return a length, 1.0 of a point in the pin itself, whose direction then does not matter."""
    divisor: Scalar = n.where(is_zero(n, length), 1.0, length)
    return divisor


def shaped(n: NumberType, layout: Layout, dyad_lengths: Sequence[DyadLengths]
           ) -> list[DyadLengths]:
    """
    Return the lengths of all dyads with what follows from them once and for all.

    That is ``reach``, and of a pair ``shape``: with a pin (|a|, |g|, cosine and sine of half the
    angle from g to a, of g), of RRP (|a|, distance of the line from O, cosine and sine of half the
    angle from the line to a, distance of Q along it from O, O); with a slide (sigma where the
    slide is zero, e, its cosine and sine).
    """
    joints, with_shapes = Joints(layout.driver, layout.stages, dyad_lengths), []
    for stage, lengths in zip(layout.stages, dyad_lengths):
        reach = n.hypot(*lengths.p), n.hypot(*lengths.q)
        shape = (_shape(n, stage, lengths, joints) if stage.pair
                 else reach if stage.name == CYLINDER else ())
        with_shapes.append(lengths._replace(reach=reach, shape=shape))
    return with_shapes


# (plus, minus) of a factor of the discriminant of a pair, by exact sums of its lengths. Of an
# angle x: plus cos^2(x/2) + minus sin^2(x/2), of RRP with x from the normal of its line; of a
# slide: plus sigma^2 + minus.
Factor = tuple[float, float]


class PairRange:
    """
    Where a pair closes: where the factors of its discriminant are positive.

    Of two factors one at most is negative. One that vanishes in one direction and is positive
    elsewhere makes a change point; their exact signs tell. ``flats`` has its directions: +1.0 for
    x = 0, -1.0 for x = pi, or 0.0 for sigma = 0 of a slide.
    """

    def __init__(self, stage: Stage, lengths: DyadLengths) -> None:
        """
        Compute the factors once, from the dyad's lengths with their ``shape``.

        That is (|a|, |g|, ...) where a pin joins the links it hangs on; with a slide (sigma where
        the slide is zero, e, ...): see :func:`shaped`.
        """
        assert stage.pair is not None
        self.slides, self.is_sine = stage.pair.slides, stage.kind == 'RRP'
        # sigma where the slide is zero, or the direction of the other link where the angle is
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
        """
        Return the distance from a flat position, and the side, at an angle or slide of a pair.

        Of an angle (sin x, cos x), of RRP (cos x, sin x), of a slide (sigma, 0).
        """
        if self.slides:
            return relative[0] + self._start, 0.0
        c, s = turned_by(relative[:2], self._start)
        return (c, s) if self.is_sine else (s, c)

    def assembly_margin(self, n: NumberType, ends: Ends) -> Scalar:
        """
        Return the product of the scaled factors of a pair that have toggles.

        A factor is plus cos^2(x/2) + minus sin^2(x/2) of an angle x, plus s^2 + minus of a slide
        s, both from the flat position. It is positive where the pair closes, zero at its toggles.
        """
        sine, cosine = self.flatness(ends.relative)
        of_plus, of_minus, product = sine * sine, 1.0, 1.0      # a slide: flatness() gives (s, 0)
        if not self.slides:
            _, _, of_minus, of_plus, _ = half_angle(n, cosine, sine, True)
        for plus, minus in self._toggles:
            # of a slide far above the sizes of ``minus``, so that no pole is near its roots
            size = abs(plus) * of_plus + 64.0 if self.slides else abs(plus) + abs(minus)
            product = product * ((plus * of_plus + minus * of_minus) * (1.0 / size))
        return product

    def square(self, n: NumberType, ends: Ends) -> Scalar:
        """
        Return |Q - P|^2 of RRR or RPR; the motion has poles where it is zero.

        With a pin it is divided by (|a| + |g|)^2.
        """
        (arm_1, arm_2), (beside, ahead) = self._arms, self.flatness(ends.relative)
        if self.slides:
            return beside * beside + arm_2 * arm_2
        _, _, ss, cc, _ = half_angle(n, ahead, beside, True)
        # law of cosines: (|a| - |g|)^2 cos^2(x/2) + (|a| + |g|)^2 sin^2(x/2)
        return (arm_1 - arm_2)**2 / (arm_1 + arm_2)**2 * cc + ss

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


def _factors(stage: Stage, lengths: DyadLengths) -> list[Factor]:
    """
    Return the one or two factors of a pair's discriminant, positive where it closes.

    Of RRR they are (r1 + r2)^2 - d^2 and d^2 - (r1 - r2)^2, with d the distance of P and Q. Where
    a pin joins the links, |a| and |g| add up to it at the angle pi and differ by it at 0: the
    ``minus`` and the ``plus`` of a factor are its values there. With a slide d^2 = sigma^2 + e^2.
    Lengths are scaled by a power of two and their sums exact, so that a factor is 0.0 just at a
    change point.
    """
    assert stage.pair is not None
    unit = power_of_two(*lengths.sizes[:1 + (stage.kind == 'RRR')],
                        *lengths.shape[stage.pair.slides:2])
    sizes = [size / unit for size in lengths.sizes]
    squares = REAL.difference_of_squares
    # |a| and |g| (of RRP e); with a slide: sigma where it is zero, not read, and e
    first, second = [arm / unit for arm in lengths.shape[:2]]
    if stage.pair.slides:
        if stage.kind == 'RPR':
            return [(unit**-2, squares(second, 0.0, sizes[0], 0.0))]
        return [(-unit**-2, squares(sizes[0], sizes[1], second, 0.0)),
                (unit**-2, -squares(sizes[0], -sizes[1], second, 0.0))]
    if stage.kind == 'RRP':
        r = sizes[0]
        return [(exact_sum((r, -second, first)), exact_sum((r, -second, -first))),
                (exact_sum((r, second, -first)), exact_sum((r, second, first)))]
    near, far = (first, -second), (first, second)
    if stage.kind == 'RPR':
        return [(squares(*near, sizes[0], 0.0), squares(*far, sizes[0], 0.0))]
    return [(squares(sizes[0], sizes[1], *near), squares(sizes[0], sizes[1], *far)),
            (squares(*near, sizes[0], -sizes[1]), squares(*far, sizes[0], -sizes[1]))]
