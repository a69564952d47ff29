# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Motion of a machine: its driven link, then dyad by dyad.

O1 = (0, 0) of the frame: the ground, or one of the two moving links between which the drive is,
and then all is seen from the ground at the end. The driven link is a crank about
O1, a slider on the x axis, or a crank that is turned by a cylinder of length s between a point Q
of the frame and a point of the crank, rho from O1. With b = |Q| and psi the angle of that point as
seen from O1, from Q on:

    (V1)  psi = pi + theta2,   psi' = theta2',   psi'' = theta2''   of the cylinder's triangle,
          (T1) to (T8) of :mod:`fourbar_ros.mechanisms.slides`, with b and rho for its sides

which gives its rod as well. Rates are ratios times the rate of the input, accelerations the ratio
times its acceleration plus the second derivative times its rate squared. The condition is a bound
of the true one, by the triangle inequality along the chain of dyads: with E the sum of the errors
of P and Q,

    (V2)  RRR: r1 d angle1 = (E + r1 |e1 . e2| + r2) / |sine|, the other likewise
    (V3)  RRP: r1 d angle1 = (E + r1 + |s| d angle_t) / |sine|
    (V4)  RPR: |s| d angle = E + |h|
    (V5)  RPP, PRP: d B = (E + |s1| d angle_1 + |s2| d angle_2) / |sine|
    (V6)  crank turned by a cylinder: d psi = ((rho^2 + b^2)/(rho b) + 2 |cos psi|) / |sin psi|

The transmission angle of a cylinder is that of its rod and the arm from O1 to its pin.
"""
from __future__ import annotations

from collections.abc import Sequence

from fourbar_ros.mechanisms.curves import LinkMotion
from fourbar_ros.mechanisms.machine import structure
from fourbar_ros.mechanisms.machine.solve import dyads
from fourbar_ros.mechanisms.machine.solve.dyads import Driven, DyadMotion, ORIGIN
from fourbar_ros.mechanisms.machine.solve.frames import pose_of
from fourbar_ros.mechanisms.machine.solve.pairs import half_angle, Joints, turned_by
from fourbar_ros.mechanisms.machine.structure import CYLINDER, DyadLengths, Layout, Stage
from fourbar_ros.mechanisms.parts import Coordinate
from fourbar_ros.mechanisms.slides import triangle
from fourbar_ros.numerics.number_types import NumberType, Scalar, TINY

# Errors of a link for relative errors of the lengths: of the place of its first joint, its angle.
Errors = tuple[Scalar, Scalar]
EXACT: Errors = (0.0, 0.0)


def driven_link(n: NumberType, layout: Layout, dyad_lengths: Sequence[DyadLengths],
                signs: Sequence[Scalar], x: Scalar) -> Driven:
    """Return the driven link at an input: a crank, a slider on the x axis, or with a cylinder."""
    if layout.driver == CYLINDER:
        return crank_with_cylinder(n, signs[0], dyad_lengths[0], x)
    if layout.driver == 'slide':
        return dyads.driven_slider(x)
    return dyads.driven_crank(n, x)


def crank_with_cylinder(n: NumberType, sign: Scalar, lengths: DyadLengths, s: Scalar) -> Driven:
    """
    Return the crank, and the rod, at a length s of the cylinder that turns it [m], by (V1).

    ``sign``: of the sine of the angle from O1-base to O1-pin; ``lengths``: pin on the crank, base
    on the frame, their distances from O1 for ``shape``.
    """
    (along, across), (base_x, base_y), (rho, b) = lengths.p, lengths.q, lengths.shape
    per, per_rho, per_b = 1.0 / n.power_of_two(rho, b), 1.0 / rho, 1.0 / b
    of_pin = along * per_rho, -across * per_rho         # turned back from the crank
    of_base = -base_x * per_b, -base_y * per_b          # from the base to O1
    root = n.sqrt(s)                                    # no length is below zero
    sides = triangle(n, b * per, rho * per, 0.0, -sign, (s + (root - root)) * per)         # (V1)
    directions = (turned_by(turned_by((sides.cos_2, sides.sin_2), of_base), of_pin),
                  turned_by((sides.cos_x, -sides.sin_x), of_base))
    # half the angle of the crank: of where psi is +-pi/2, and of psi from there on
    (x, y), z = turned_by(of_base, of_pin), sign * sides.sin_2
    middle = half_angle(n, sign * y, -sign * x, True)
    beyond = half_angle(n, -z, sign * sides.cos_2, True)
    half = turned_by((middle.cosine, middle.sine), (beyond.cosine, beyond.sine))
    error = (rho / b + b / rho + 2.0 * n.fabs(sides.cos_2)) / (
        n.fabs(sides.sin_2) + TINY)                                                      # (V6)
    square = per * per
    return Driven(LinkMotion(*ORIGIN, *directions[0], sides.d_theta2 * per,
                             sides.dd_theta2 * square),
                  (0.0, error), half, None,
                  (s, (*directions[1], -sides.d_x * per, -sides.dd_x * square), -sides.sin_b,
                   sides.cos_b))


def errors_of(n: NumberType, stage: Stage, lengths: DyadLengths, first: Errors, second: Errors,
              moved: DyadMotion) -> tuple[Errors, Errors]:
    """
    Return (error of the first joint [m], of the angle [rad]) of both links of a dyad.

    A bound, by (V2) to (V5), of how far relative errors of the lengths move and turn them.
    ``first``, ``second``: errors of the links it hangs on. First joints are P and Q of RRR and
    RPR, P and B of RRP and RPP, B of PRP.
    """
    fabs, (reach_p, reach_q), sizes = n.fabs, lengths.reach, lengths.sizes
    at_p = first[0] + reach_p * (1.0 + first[1])
    at_q = second[0] + reach_q * (1.0 + second[1])
    both, per = at_p + at_q, 1.0 / (fabs(moved.sine) + TINY)
    if stage.kind == 'RRR':                                                               # (V2)
        (r1, r2), cosine = sizes, fabs(moved.cosine)
        return ((at_p, (both + r1 * cosine + r2) * per / r1),
                (at_q, (both + r2 * cosine + r1) * per / r2))
    slide, r1 = moved.slides[0], sizes[0]
    if stage.kind == 'RRP':                                                               # (V3)
        shift = (both + r1 + fabs(slide) * second[1]) * per
        return (at_p, shift / r1), (at_p + r1 + shift, second[1])
    if stage.kind == 'RPR':                                                               # (V4)
        offset = sizes[0]
        turn = (both + fabs(offset)) / (fabs(slide) + TINY)
        return (at_p, turn), (at_q, turn)
    other_slide = moved.slides[3]        # of the yoke (RPP), of the second block (PRP)
    turn_1 = first[1] if stage.kind == 'PRP' else second[1]                               # (V5)
    shift = (both + fabs(slide) * turn_1 + fabs(other_slide) * second[1]) * per
    return ((shift, turn_1) if stage.kind == 'PRP' else (at_p, turn_1)), (shift, second[1])


def motion_of(n: NumberType, layout: Layout, dyad_lengths: Sequence[DyadLengths],
              signs: Sequence[Scalar], position: Scalar, rate: Scalar,
              acceleration: Scalar) -> tuple[Scalar, ...]:
    """
    Return the fields of :func:`.structure.motion_fields`: links, slides, pins, angles, curves.

    ``dyad_lengths``, ``signs``: as for :func:`.frames.pose_of`.
    """
    driven = driven_link(n, layout, dyad_lengths, signs, position)
    pose = pose_of(n, layout, dyad_lengths, signs, driven)
    curves, dyad_motions = [*pose.curves.values()], [*pose.dyads.values()]
    errors = [EXACT, driven.errors]
    for stage, lengths, moved in zip(layout.stages, dyad_lengths, dyad_motions):
        errors += errors_of(n, stage, lengths, errors[stage.first], errors[stage.second], moved)
    if layout.ground:
        turning, joints = layout.turning(), Joints(layout.driver, layout.stages, dyad_lengths)
        curves = [curve if not i or layout.moving[i - 1] in turning
                  else curve._replace(omega=0.0, alpha=0.0)
                  for i, curve in enumerate(pose.seen_from(layout.ground, joints))]
    # the error of the output: of its angle [rad], or without turning of its joint [m]
    output = layout.moving.index(layout.output) + 1
    shift, turn = errors[output]
    if layout.ground:       # errors of a link are those in the frame and those of the ground
        (of_shift, of_turn), curve = errors[layout.ground], curves[output]
        shift, turn = (0.0, 0.0) if output == layout.ground else (shift, turn)
        shift = of_shift + shift + (n.fabs(curve.x) + n.fabs(curve.y)) * of_turn
        turn = of_turn + turn
    condition = turn if layout.output in layout.turning() else shift
    fields, square = dict[str, Scalar](), rate * rate

    def add(names: Coordinate, value: Scalar, slope: Scalar, bend: Scalar) -> None:
        """Add a coordinate, its rate and acceleration, from its derivatives by the input."""
        fields.update(zip(names, (value, slope * rate, slope * acceleration + bend * square)))

    for link, curve in zip(layout.moving, curves[1:]):
        add(structure.coordinate(link), n.atan2(curve.sine, curve.cosine), curve.omega,
            curve.alpha)
        fields.update(zip([f'{name}_{link}' for name in structure.COEFFICIENTS], curve))
    for stage, moved in zip(layout.stages, dyad_motions):
        fields[f'sine_{stage.name}'] = moved.sine
        for k, link in enumerate(stage.slides()):
            slide, slope, bend = moved.slides[3 * k:3 * k + 3]
            add(structure.travel(link), slide, slope, bend)
            fields[f'slide_{link}_ratio'] = slope
    if layout.driver != 'crank':
        link = layout.stages[0].links[0] if layout.driver == CYLINDER else layout.driven
        fields.update(zip(structure.travel(link), (position, rate, acceleration)))
        fields[f'slide_{link}_ratio'] = 1.0
    of_pins = [(pin, pose.relation(j, i)) for pin, i, j in layout.pins()]
    for pin, (c, s, slope, bend) in of_pins:
        add(structure.coordinate(pin), n.atan2(s, c), slope, bend)
    if layout.driver == 'crank':        # the input is not computed, it is as it is given
        of_input = structure.BASE if layout.ground else layout.driven
        fields[structure.coordinate(of_input).position] = position
    sines = [n.fabs(moved.sine) for moved in dyad_motions]
    angles = [n.atan2(sine, moved.cosine) for sine, moved in zip(sines, dyad_motions)]
    fields.update(zip([f'transmission_angle_{stage.name}' for stage in layout.stages], angles))
    worst, *rest = zip(sines, angles)           # of the least |sine|
    for pair in rest:
        worst = n.where(pair[0].real < worst[0].real, pair, worst)
    fields.update(transmission_angle=worst[1], condition=condition, rate=rate,
                  acceleration=acceleration)
    return tuple([fields[name] for name in structure.motion_fields(layout)])
