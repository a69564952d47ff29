# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Motion of a machine: its driven link, then dyad by dyad.

O1 = (0, 0). The driven link is a crank O1, a slider on the x axis, or a crank that is turned by a
cylinder of length s between a point Q of the ground and a point of the crank, rho from O1. With b
= |Q| and psi the angle of that point as seen from O1, from Q on:

    (C1)  rho b sin psi = +-sqrt((rho + b - s)(rho + b + s)(s - rho + b)(s + rho - b)) / 2
    (C2)  psi' = s / (rho b sin psi),   psi'' = (1 - rho b cos psi psi'^2) / (rho b sin psi)

Rates are ratios times the rate of the input, accelerations the ratio times its acceleration plus
the second derivative times its rate squared. The condition is a bound of the true one, by the
triangle inequality along the chain of dyads: with E the sum of the errors of P and Q,

    (C3)  RRR: r1 d angle1 = (E + r1 |e1 . e2| + r2) / |sine|, the other likewise
    (C4)  RRP: r1 d angle1 = (E + r1 + |s| d angle_t) / |sine|
    (C5)  RPR: |s| d angle = E + |h|
    (C6)  RPP, PRP: d B = (E + |s1| d angle_1 + |s2| d angle_2) / |sine|
    (C7)  crank turned by a cylinder: d psi = ((rho^2 + b^2)/(rho b) + 2 |cos psi|) / |sin psi|

The transmission angle of a cylinder is that of its rod and the arm from O1 to its pin (C8).
"""
from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from fourbar_ros.mechanisms.machine.description import CYLINDER, PRP, RPR, RRP, RRR
from fourbar_ros.mechanisms.machine.dyads import Curve, FIXED
from fourbar_ros.mechanisms.machine.frames import Frames
from fourbar_ros.mechanisms.machine.layout import Layout, Stage
from fourbar_ros.mechanisms.machine.loops import make_moves
from fourbar_ros.numerics.number_types import Function, NumberType

# Errors of a link for relative errors of the lengths: of the place of its first joint, its angle.
Errors = tuple[Any, Any]
EXACT: Errors = (0.0, 0.0)
Driver = Callable[[Any], tuple[Curve, Errors]]
Walk = Callable[[Any], tuple[list[Curve], list[Any], list[Any], list[Errors], list[Any]]]


def make_crank(n: NumberType) -> Driver:
    """Return the function theta1 -> curve of a crank, errors."""
    sin, cos = n.sin, n.cos
    return lambda x: ((0.0, 0.0, 0.0, 0.0, 0.0, 0.0, cos(x), sin(x), 1.0, 0.0), EXACT)


def make_slider() -> Driver:
    """Return the function slide -> curve of a slider on the x axis, errors."""
    return lambda s: ((s, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0), EXACT)


def make_cylinder(n: NumberType, sign: Any, numbers: Sequence[Any]) -> Driver:
    """Return the function length of the cylinder -> curve of the crank that it turns, errors."""
    along, across, base_x, base_y = numbers[:4]
    rho, b = n.hypot(along, across), n.hypot(base_x, base_y)
    per, total, excess, sqrt = 1.0 / (rho * b), rho + b, rho - b, n.sqrt
    # of the crank where psi = 0: turned from its pin to the base
    cos_0 = (base_x * along + base_y * across) * per
    sin_0 = (base_y * along - base_x * across) * per

    fabs, squares = n.fabs, (rho * rho + b * b) * per

    def crank(s: Any) -> tuple[Curve, Errors]:
        high, low = (total - s) * (total + s), (s - excess) * (s + excess)              # (C1)
        # in factors, of which a length below zero makes both negative
        root = sqrt(s - excess) * sqrt(s + excess)
        sine, cosine = 0.5 * sign * sqrt(high) * root * per, 0.25 * (high - low) * per
        turn = s * per / sine                                                           # (C2)
        bend = (per - cosine * turn * turn) / sine
        error = (squares + 2.0 * fabs(cosine)) / fabs(sine)                             # (C7)
        return ((0.0, 0.0, 0.0, 0.0, 0.0, 0.0, cos_0 * cosine - sin_0 * sine,
                 sin_0 * cosine + cos_0 * sine, turn, bend), (0.0, error))
    return crank


def make_driver(n: NumberType, layout: Layout, numbers: Sequence[Any],
                signs: Sequence[Any]) -> Driver:
    """Return the function input -> (curve, errors) of the driven link."""
    if layout.driver == CYLINDER:
        return make_cylinder(n, signs[0], numbers[0])
    return make_slider() if layout.driver == 'slide' else make_crank(n)


def make_errors(n: NumberType, stage: Stage, numbers: Sequence[Any]) -> Function:
    """Return (errors of both links, |s| of its slides, sine, cosine) -> errors of its links."""
    fabs, kind = n.fabs, stage.kind
    reach_p, reach_q = n.hypot(*numbers[:2]), n.hypot(*numbers[2:4])
    sizes = numbers[4:]

    def errors(first: Errors, second: Errors, slides: Sequence[Any], sine: Any,
               cosine: Any) -> tuple[Errors, Errors]:
        at_p = first[0] + reach_p * (1.0 + first[1])
        at_q = second[0] + reach_q * (1.0 + second[1])
        both, per = at_p + at_q, 1.0 / fabs(sine)
        if kind == RRR:                                                                 # (C3)
            r1, r2 = sizes
            cosine = fabs(cosine)
            return ((at_p, (both + r1 * cosine + r2) * per / r1),
                    (at_q, (both + r2 * cosine + r1) * per / r2))
        if kind == RRP:                                                                 # (C4)
            r1 = sizes[0]
            shift = (both + r1 + fabs(slides[0]) * second[1]) * per
            return (at_p, shift / r1), (at_p + r1 + shift, second[1])
        if kind == RPR:                                                                 # (C5)
            turn = (both + fabs(sizes[0])) / fabs(slides[0])
            return (at_p, turn), (at_q, turn)
        turn_1 = first[1] if kind == PRP else second[1]                                 # (C6)
        shift = (both + fabs(slides[0]) * turn_1 + fabs(slides[3]) * second[1]) * per
        return ((shift, turn_1) if kind == PRP else (at_p, turn_1)), (shift, second[1])
    return errors


def make_walk(n: NumberType, layout: Layout, numbers: Sequence[Any],
              signs: Sequence[Any]) -> Walk:
    """
    Return input -> curves of all links, the ground's first, and for each dyad its slides.

    Also (sine, cosine) of each, the errors of all links, and for each pin between moving links
    the curves of both in their common frame.
    """
    driver, frames = make_driver(n, layout, numbers, signs), Frames(layout, numbers)
    work = [(stage, moves, make_errors(n, stage, given)) for stage, given, moves in zip(
        layout.stages, numbers, make_moves(n, layout, numbers, signs))]
    pins = [(i, j, frames.common(i, j)) for _, i, j in layout.pins()]
    with_cylinder, arm_and_rod = layout.driver == CYLINDER, make_arm_and_rod(n)

    def walk(position: Any) -> Any:
        curve, error = driver(position)
        curves, slides, transmissions = [FIXED, curve], [], []
        errors: list[Errors] = [EXACT, error]
        poses = frames.begin(curve)
        for number, (stage, moves, errors_of) in enumerate(work):
            moved = moves(*frames.hang(number, poses))
            _, _, slid, sine, cosine = moved
            curves += frames.add(number, poses, moved)
            slides.append(slid)
            transmissions.append(arm_and_rod(curves[-2]) if with_cylinder and not number
                                 else (sine, cosine))
            errors += errors_of(errors[stage.first], errors[stage.second], slid, sine, cosine)
        return (curves, slides, transmissions, errors,
                [(poses.of(i, frame), poses.of(j, frame)) for i, j, frame in pins])
    return walk


def make_arm_and_rod(n: NumberType) -> Callable[[Curve], tuple[Any, Any]]:
    """Return curve of a cylinder's rod -> sine and cosine of its angle to the arm, (C8)."""
    hypot = n.hypot

    def arm_and_rod(rod: Curve) -> tuple[Any, Any]:
        x, y, cosine, sine = *rod[:2], *rod[6:8]
        per = 1.0 / hypot(x, y)
        return (x * sine - y * cosine) * per, (x * cosine + y * sine) * per
    return arm_and_rod


def make_motion(n: NumberType, layout: Layout, numbers: Sequence[Any],
                signs: Sequence[Any]) -> Function:
    """
    Return the function (position, rate, acceleration) -> fields of :func:`.layout.motion_fields`.

    Parameters
    ----------
    n, layout
    numbers, signs : sequence
        For each stage what :attr:`.description.Dyad.numbers` has, and its assembly mode as +-1.

    """
    walk = make_walk(n, layout, numbers, signs)
    atan2, transmission_angles = n.atan2, make_transmission_angles(n)
    is_crank = layout.driver == 'crank'
    output = layout.links.index(layout.output)
    error_of_output = int(layout.output in layout.turning())
    starts_at_slide = layout.driver == 'slide'
    with_cylinder = layout.driver == CYLINDER

    def motion(position: Any, rate: Any, acceleration: Any) -> tuple[Any, ...]:
        curves, slides, transmissions, errors, pins = walk(position)
        square = rate * rate
        fields: list[Any] = []
        for curve in curves[1:]:
            turn, bend = curve[8:]
            fields += (atan2(curve[7], curve[6]), turn * rate,
                       turn * acceleration + bend * square)
        if is_crank:
            fields[0] = position
        given = position, rate, acceleration, 1.0
        if starts_at_slide:
            fields += given
        for slid in slides:
            for k in range(0, len(slid), 3):
                fields += (slid[k], slid[k + 1] * rate,
                           slid[k + 1] * acceleration + slid[k + 2] * square, slid[k + 1])
        if with_cylinder:
            fields[3 * len(curves) - 3:3 * len(curves) + 1] = given
        for (*_, c1, s1, turn1, bend1), (*_, c2, s2, turn2, bend2) in pins:
            turn = turn2 - turn1
            fields += (atan2(c1 * s2 - s1 * c2, c1 * c2 + s1 * s2), turn * rate,
                       turn * acceleration + (bend2 - bend1) * square)
        fields += transmission_angles(transmissions)
        fields += (errors[output][error_of_output], rate, acceleration)
        for curve in curves[1:]:
            fields += curve
        fields += [sine for sine, _ in transmissions]
        return tuple(fields)
    return motion


def make_transmission_angles(n: NumberType) -> Function:
    """
    Return (sine, cosine) of all dyads -> their transmission angles [rad], in [0, pi].

    The last is that of the dyad nearest to its toggle once more.
    """
    atan2, fabs, where = n.atan2, n.fabs, n.where

    def angles(transmissions: Sequence[tuple[Any, Any]]) -> list[Any]:
        sizes = [(fabs(sine), cosine) for sine, cosine in transmissions]
        found = [atan2(sine, cosine) for sine, cosine in sizes]
        least, angle = sizes[0][0], found[0]
        for (size, _), other in zip(sizes[1:], found[1:]):
            least, angle = where(size.real < least.real, (size, other), (least, angle))
        return [*found, angle]
    return angles
