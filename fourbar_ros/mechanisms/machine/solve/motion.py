# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Motion of a machine: its driven link, then dyad by dyad.

Rates are ratios times the rate of the input, accelerations the ratio
times its acceleration plus the second derivative times its rate squared. The condition is a bound
of the true one, by the triangle inequality along the chain of dyads: with E the sum of the errors
of P and Q,

    (V1)  RRR: r1 d angle1 = (E + r1 |e1 . e2| + r2) / |sine|, the other likewise
    (V2)  RRP: r1 d angle1 = (E + r1 + |s| d angle_t) / |sine|
    (V3)  RPR: |s| d angle = E + |h|
    (V4)  RPP, PRP: d B = (E + |s1| d angle_1 + |s2| d angle_2) / |sine|

and (K3) of :mod:`.frames` of a crank that a cylinder turns.
"""
from collections.abc import Sequence

from fourbar_ros.mechanisms.machine import structure
from fourbar_ros.mechanisms.machine.solve.dyads import DyadMotion
from fourbar_ros.mechanisms.machine.solve.frames import driven_link, pose_of
from fourbar_ros.mechanisms.machine.solve.pairs import Joints
from fourbar_ros.mechanisms.machine.structure import CYLINDER, DyadLengths, Layout, Stage
from fourbar_ros.mechanisms.parts import Coordinate
from fourbar_ros.numerics.number_types import NumberType, Scalar, TINY

# Errors of a link for relative errors of the lengths: of the place of its first joint, its angle.
Errors = tuple[Scalar, Scalar]
EXACT: Errors = (0.0, 0.0)


def errors_of(n: NumberType, stage: Stage, lengths: DyadLengths, first: Errors, second: Errors,
              moved: DyadMotion) -> tuple[Errors, Errors]:
    """Return (error of the first joint [m], of the angle [rad]) of both links of a dyad."""
    # A bound, by (V1) to (V4), of how far relative errors of the lengths move and turn them.
    # first, second: errors of the links it hangs on. First joints are P and Q of RRR and RPR, P
    # and B of RRP and RPP, B of PRP.
    fabs, (reach_p, reach_q), sizes = n.fabs, lengths.reach, lengths.sizes
    at_p = first[0] + reach_p * (1.0 + first[1])        # place of the first joint, angle
    at_q = second[0] + reach_q * (1.0 + second[1])
    both, per = at_p + at_q, 1.0 / (fabs(moved.sine) + TINY)
    if stage.kind == 'RRR':                                                               # (V1)
        (r1, r2), cosine = sizes, fabs(moved.cosine)
        return ((at_p, (both + r1 * cosine + r2) * per / r1),
                (at_q, (both + r2 * cosine + r1) * per / r2))
    slide, r1 = moved.slides[0], sizes[0]
    if stage.kind == 'RRP':                                                               # (V2)
        shift = (both + r1 + fabs(slide) * second[1]) * per
        return (at_p, shift / r1), (at_p + r1 + shift, second[1])
    if stage.kind == 'RPR':                                                               # (V3)
        offset = sizes[0]
        turn = (both + fabs(offset)) / (fabs(slide) + TINY)
        return (at_p, turn), (at_q, turn)
    # slides are s, s', s'' of one and of the next: of the slot and the yoke (RPP), of two blocks
    next_slide, turn_2 = moved.slides[3], second[1]
    turn_1 = first[1] if stage.kind == 'PRP' else turn_2        # both links of RPP turn alike
    shift = (both + fabs(slide) * turn_1 + fabs(next_slide) * turn_2) * per                # (V4)
    return (shift if stage.kind == 'PRP' else at_p, turn_1), (shift, turn_2)


def motion_of(n: NumberType, layout: Layout, dyad_lengths: Sequence[DyadLengths],
              signs: Sequence[Scalar], position: Scalar, rate: Scalar,
              acceleration: Scalar) -> tuple[Scalar, ...]:
    """Return the fields of :func:`.structure.motion_fields`; arguments as of :func:`.pose_of`."""
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
