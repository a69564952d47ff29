# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Motion of a machine: its driven link, then dyad by dyad.

O1 = (0, 0) of the frame: the ground, or the link at the base of a cylinder between two moving
links, and then all is turned at the end to where the ground sees it. The driven link is a crank
O1, a slider on the x axis, or a crank that is turned by a cylinder of length s between a point Q
of the frame and a point of the crank, rho from O1. With b = |Q| and psi the angle of that point as
seen from O1, from Q on:

    (C1)  psi = pi + theta2,   psi' = theta2',   psi'' = theta2''   of the cylinder's triangle,
          (T1) to (T8) of :mod:`fourbar_ros.mechanisms.slides`, with b and rho for its sides

which gives its rod as well. Rates are ratios times the rate of the input, accelerations the ratio
times its acceleration plus the second derivative times its rate squared. The condition is a bound
of the true one, by the triangle inequality along the chain of dyads: with E the sum of the errors
of P and Q,

    (C3)  RRR: r1 d angle1 = (E + r1 |e1 . e2| + r2) / |sine|, the other likewise
    (C4)  RRP: r1 d angle1 = (E + r1 + |s| d angle_t) / |sine|
    (C5)  RPR: |s| d angle = E + |h|
    (C6)  RPP, PRP: d B = (E + |s1| d angle_1 + |s2| d angle_2) / |sine|
    (C7)  crank turned by a cylinder: d psi = ((rho^2 + b^2)/(rho b) + 2 |cos psi|) / |sin psi|

The transmission angle of a cylinder is that of its rod and the arm from O1 to its pin.
"""
from __future__ import annotations

from collections.abc import Callable, Sequence

from fourbar_ros.mechanisms.machine.describe.description import (
    CYLINDER,
    Numbers,
    PRP,
    RPR,
    RRP,
    RRR,
)
from fourbar_ros.mechanisms.machine.describe.layout import Layout, Stage
from fourbar_ros.mechanisms.machine.solve.dyads import Direction, Driven, ORIGIN
from fourbar_ros.mechanisms.machine.solve.frames import hangings, Poses, seen_from
from fourbar_ros.mechanisms.machine.solve.pairs import make_moves, turned_by
from fourbar_ros.mechanisms.points import Curve, FIXED
from fourbar_ros.mechanisms.slides import triangle
from fourbar_ros.numerics.number_types import Function, NumberType, Scalar

# Errors of a link for relative errors of the lengths: of the place of its first joint, its angle.
Errors = tuple[Scalar, Scalar]
EXACT: Errors = (0.0, 0.0)
Driver = Callable[[Scalar], Driven]
# Of all links or dyads, in the order that :func:`make_walk` states.
Walked = tuple[list[Curve], list[tuple[Scalar, ...]], list[tuple[Scalar, Scalar]], list[Errors],
               list[Direction]]
Walk = Callable[[Scalar], Walked]


def make_crank(n: NumberType) -> Driver:
    """Return the function theta1 -> a crank."""
    sin, cos = n.sin, n.cos
    return lambda x: Driven((0.0, 0.0, 0.0, 0.0, 0.0, 0.0, cos(x), sin(x), 1.0, 0.0), EXACT)


def make_slider() -> Driver:
    """Return the function slide -> a slider on the x axis."""
    return lambda s: Driven((s, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0), EXACT,
                            (s, 1.0, 0.0))


def make_cylinder(n: NumberType, sign: Scalar, own: Numbers) -> Driver:
    """
    Return a function of a cylinder's length [m]: the crank that it turns, and the cylinder.

    ``sign``: of the sine of the angle from O1-base to O1-pin; ``own``: pin on the crank, base on
    the frame, their distances from O1 for ``shape``.
    """
    (along, across), (base_x, base_y), (rho, b) = own.p, own.q, own.shape
    unit, fabs, sqrt = n.power_of_two(rho, b), n.fabs, n.sqrt
    per, per_rho, per_b = 1.0 / unit, 1.0 / rho, 1.0 / b
    squares = rho / b + b / rho
    of_pin = along * per_rho, -across * per_rho         # turned back from the crank
    of_base = -base_x * per_b, -base_y * per_b          # from the base to O1

    def crank(s: Scalar) -> Driven:
        """Return the crank, and the rod, at a length of the cylinder, by (C1)."""
        at = triangle(n, b * per, rho * per, 0.0, -sign,                                # (C1)
                      (s + (sqrt(s) - sqrt(s))) * per)          # no length is below zero
        directions = (turned_by(turned_by((at.cos_2, at.sin_2), of_base), of_pin),
                      turned_by((at.cos_x, -at.sin_x), of_base))
        error = (squares + 2.0 * fabs(at.cos_2)) / fabs(at.sin_2)                       # (C7)
        square = per * per
        return Driven((*ORIGIN, *directions[0], at.d_theta2 * per, at.dd_theta2 * square),
                      (0.0, error), None,
                      (s, (*directions[1], -at.d_x * per, -at.dd_x * square), -at.sin_b, at.cos_b))
    return crank


def make_driver(n: NumberType, layout: Layout, numbers: Sequence[Numbers],
                signs: Sequence[Scalar]) -> Driver:
    """Return the function input -> the driven link."""
    if layout.driver == CYLINDER:
        return make_cylinder(n, signs[0], numbers[0])
    return make_slider() if layout.driver == 'slide' else make_crank(n)


def make_errors(n: NumberType, stage: Stage, own: Numbers) -> Function:
    """
    Return (errors of the links it hangs on, slides, sine, cosine) -> errors of a dyad's own links.

    A bound, by (C3) to (C6), of how far relative errors of the lengths move and turn them.
    """
    fabs, kind = n.fabs, stage.kind
    (reach_p, reach_q), sizes = own.reach, own.sizes

    def errors(first: Errors, second: Errors, slides: Sequence[Scalar], sine: Scalar,
               cosine: Scalar) -> tuple[Errors, Errors]:
        """Return (error of the first joint [m], of the angle [rad]) of both links of the dyad."""
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


def make_errors_on_ground(n: NumberType, ground: int) -> Function:
    """Return (errors in the frame, curves on the ground, a link) -> its errors there, a bound."""
    fabs = n.fabs

    def on_ground(errors: Sequence[Errors], curves: Sequence[Curve], link: int) -> Errors:
        """Return the errors of a link plus those of the ground, whose angle moves the link."""
        (place, turn), (x, y) = errors[ground], curves[link][:2]
        at, turned = (0.0, 0.0) if link == ground else errors[link]
        return place + at + (fabs(x) + fabs(y)) * turn, turn + turned
    return on_ground


def make_walk(n: NumberType, layout: Layout, numbers: Sequence[Numbers],
              signs: Sequence[Scalar]) -> Walk:
    """
    Return input -> all that the fields of a motion are made of, dyad by dyad.

    Curves of all links in the frame, its own first; slides of each dyad; (sine, cosine) of its
    transmission angle; errors of all links; of each pin between moving links the direction of the
    second seen from the first.
    """
    driver, hanging = make_driver(n, layout, numbers, signs), hangings(layout, numbers)
    work = [(stage, moves, make_errors(n, stage, given)) for stage, given, moves in zip(
        layout.stages, numbers, make_moves(n, layout, numbers, signs))]
    pins = [(i, j) for _, i, j in layout.pins()]

    def walk(position: Scalar) -> Walked:
        """Solve the driven link, then each dyad from the links it hangs on."""
        driven = driver(position)
        curves, slides, transmissions = [FIXED, driven.curve], [], []
        errors: list[Errors] = [EXACT, driven.errors]
        poses = Poses(hanging, driven)
        for number, (stage, moves, errors_of) in enumerate(work):
            moved = moves(*poses.hang(number))
            curves += poses.add(number, moved)
            slides.append(moved.slides)
            transmissions.append((moved.sine, moved.cosine))
            errors += errors_of(errors[stage.first], errors[stage.second], moved.slides,
                                moved.sine, moved.cosine)
        return (curves, slides, transmissions, errors,
                [poses.relation(j, i) for i, j in pins])
    return walk


def make_motion(n: NumberType, layout: Layout, numbers: Sequence[Numbers],
                signs: Sequence[Scalar]) -> Function:
    """
    Return the function (position, rate, acceleration) -> fields of :func:`.layout.motion_fields`.

    ``numbers``, ``signs``: of each stage (:func:`.pairs.shaped`), and its assembly mode as +-1.
    """
    walk = make_walk(n, layout, numbers, signs)
    atan2, transmission_angles = n.atan2, make_transmission_angles(n)
    is_crank = layout.driver == 'crank'
    output, ground = layout.moving.index(layout.output) + 1, layout.ground
    error_of_output = int(layout.output in layout.turning())
    errors_on_ground = make_errors_on_ground(n, ground)
    still = [number for number, link in enumerate(layout.moving, 1)
             if link not in layout.turning()]
    starts_at_slide = layout.driver == 'slide'
    with_cylinder = layout.driver == CYLINDER

    def motion(position: Scalar, rate: Scalar, acceleration: Scalar) -> tuple[Scalar, ...]:
        """Return the fields in the order of motion_fields: links, slides, pins, angles, curves."""
        curves, slides, transmissions, errors, pins = walk(position)
        condition = errors[output][error_of_output]
        if ground:
            curves = seen_from(curves, ground, still)
            condition = errors_on_ground(errors, curves, output)[error_of_output]
        square = rate * rate
        fields: list[Scalar] = []
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
        for cosine, sine, turn, bend in pins:
            fields += (atan2(sine, cosine), turn * rate, turn * acceleration + bend * square)
        fields += transmission_angles(transmissions)
        fields += (condition, rate, acceleration)
        for curve in curves[1:]:
            fields += curve
        fields += [sine for sine, _ in transmissions]
        return tuple(fields)
    return motion


def make_transmission_angles(n: NumberType) -> Function:
    """Return (sine, cosine) of all dyads -> angles [rad] in [0, pi], and again the worst one."""
    atan2, fabs, least = n.atan2, n.fabs, n.least

    def angles(transmissions: Sequence[tuple[Scalar, Scalar]]) -> list[Scalar]:
        """Return the angles; the worst is that of the least |sine|, nearest to its toggle."""
        sizes = [(fabs(sine), cosine) for sine, cosine in transmissions]
        found = [atan2(sine, cosine) for sine, cosine in sizes]
        return [*found, least([(size, angle) for (size, _), angle in zip(sizes, found)])[1]]
    return angles
