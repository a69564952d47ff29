# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Loads of a machine: Newton-Euler backward through its dyads.

For a link of mass m, first moment of mass r about its first joint X, inertia I about X, held at
rest by the force W and the moment C of weight and applied loads, a = acceleration of X:

    (L1)  f = m a + alpha k x r - omega^2 r - W,   m_X = I alpha + r x a - C

The drive follows from virtual power with the velocities at unit rate of the input,

    (L2)  T = sum of f . X' + m_X angle'

the shaking force and moment about O1 from the links, -sum of f and -sum of m_X + X x f. Then the
dyads are solved from the last to the first, each a statically determinate system solved by hand.
Where the ground is a link of a dyad and the frame moves, the ground needs what holds all others,

    (L3)  f, m of the ground = shaking force and moment

A dyad adds its forces to the *needs* of the links on which it hangs: the force f = (f_x, f_y)
and the moment m about its first joint that the joints of a link must add up to. The force D of a
cylinder's drive acts along its rod, on the rod and back on the tube. Slides are free of friction:
a normal force along n and a couple. Notation as in
:mod:`fourbar_ros.mechanisms.machine.solve.dyads`.

RRR, with F = a e1 + b e2 of the second rod on the first at B, r1 e1 x F = m1, -r2 e2 x F = m2:

    (F1)  b = m1 / (r1 sine),   a = m2 / (r2 sine);   at P f1 - F, at Q f2 + F

RRP, with F = -a t - b n of the block on the rod, N n and the couple C of the guide on the block:

    (F2)  a = f2 . t,   b = (h a - m1) / g,   N = f2 . n - b,   C = m2;   at P f1 - F

RPR, with F = N n and the couple C of the bar on the block:

    (F3)  C = m1,   N = -(m1 + m2) / s;   at P f1 - F, at Q f2 + F

RPP, with F = N2 n_c and C2 of the slot on the block, N1 n and C1 of the guide on the yoke:

    (F4)  N2 = f2 . t / sin g,  C2 = m1,  N1 = f2 . n + N2 cos g,  C1 = m2 + C2 + d N2;
          at P f1 - F, F = N2 n_c

PRP, with N1 n1, C1 and N2 n2, C2 of the lines on the blocks, f = f1 + f2:

    (F5)  N1 = f . t2 / (t1 x t2),   N2 = -f . t1 / (t1 x t2),   C1 = m1,   C2 = m2,
          F = f1 - N1 n1
"""
from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any, NamedTuple

from fourbar_ros.mechanics.bodies import Applied, applied_to, Body
from fourbar_ros.mechanics.newton_euler import about_first_joint
from fourbar_ros.mechanisms.machine.describe.description import (
    CYLINDER,
    Numbers,
    PRP,
    RPP,
    RPR,
    RRP,
    RRR,
)
from fourbar_ros.mechanisms.machine.describe.layout import (
    COEFFICIENTS,
    Layout,
    motion_fields,
    PLACES,
    SLIDES,
    Stage,
    travel,
)
from fourbar_ros.mechanisms.machine.solve.pairs import Place, slides_of
from fourbar_ros.mechanisms.points import Curve, FIXED
from fourbar_ros.numerics.number_types import Function, NumberType, Scalar
from fourbar_ros.numerics.vectors import Vector


def make_needs(body: Body, gravity: tuple[Scalar, Scalar], applied: Applied) -> Function:
    """Return the function (curve, rate^2, rate, acceleration) -> needs of a link, (L1)."""
    link = about_first_joint(body, 1.0, gravity, applied)

    def needs(curve: Sequence[Scalar], square: Scalar, rate: Scalar,
              acceleration: Scalar) -> Needs:
        _, _, dx, dy, ddx, ddy, cosine, sine, turn, bend = curve
        a = Vector(dx * acceleration + ddx * square, dy * acceleration + ddy * square)
        alpha, omega = turn * acceleration + bend * square, turn * rate
        direction = Vector(cosine, sine)
        r = link.first_moment.along(direction)
        force = a * link.mass + link.held + r.normal * alpha - r * (omega * omega)      # (L1)
        moment = link.moment(direction, link.inertia * alpha + r.x * a.y - r.y * a.x)
        return force.x, force.y, moment
    return needs


def make_loads(n: NumberType, layout: Layout, numbers: Sequence[Numbers], bodies: Iterable[Body],
               gravity: tuple[Scalar, Scalar], external: NamedTuple) -> Function:
    """Return the function (fields of motion) -> fields of :func:`.layout.load_fields`."""
    needs_of = [make_needs(body, gravity, applied_to(external, name))
                for name, body in zip(layout.moving, bodies)]
    read, drive_and_shaking = make_reader(layout), make_drive_and_shaking(n)
    solve, base = make_backward(n, layout, numbers), make_base(n, layout)
    is_crank, ground = layout.driver == 'crank', layout.ground

    def loads(motion: tuple[Scalar, ...]) -> tuple[Scalar, ...]:
        curves, slides, sines, rate, acceleration = read(motion)
        square = rate * rate
        needs = [needs_of_link(curve, square, rate, acceleration)
                 for needs_of_link, curve in zip(needs_of, curves)]
        drive, shaking = drive_and_shaking(curves, needs)
        if ground:
            curves[ground - 1] = FIXED
            needs[ground - 1] = shaking[0], shaking[1], shaking[3]                      # (L3)
        forces = solve(curves, slides, sines, needs, drive)
        return (*base(needs[0], drive), *forces,
                *((drive, 0.0) if is_crank else (0.0, drive)), *shaking)
    return loads


def make_reader(layout: Layout) -> Function:
    """Return motion -> (curves of the moving links, slides, sines of dyads, rate, its change)."""
    fields = motion_fields(layout)
    place = fields.index('rate')
    first, width = place + 2, len(COEFFICIENTS)
    last = first + width * len(layout.moving)
    starts = range(first, last, width)
    slides = [[fields.index(travel(link).position) for link in stage.slides()]
              for stage in layout.stages]

    def read(motion: Sequence[Scalar]) -> Any:
        return ([motion[i:i + width] for i in starts],
                [[motion[i] for i in places] for places in slides], motion[last:],
                motion[place], motion[place + 1])
    return read


def make_drive_and_shaking(n: NumberType) -> Function:
    """Return (curves, needs) -> drive and (shaking force x, y, magnitude, moment about O1)."""
    hypot = n.hypot

    def balance(curves: Sequence[Curve],
                needs: Sequence[Needs]) -> tuple[Scalar, tuple[Scalar, ...]]:
        drive = shake_x = shake_y = moment = 0.0
        for (f_x, f_y, m), (x, y, dx, dy, _, _, _, _, turn, _) in zip(needs, curves):
            drive = drive + (f_x * dx + f_y * dy + m * turn)                            # (L2)
            shake_x, shake_y = shake_x - f_x, shake_y - f_y
            moment = moment - (m + x * f_y - y * f_x)
        return drive, (shake_x, shake_y, hypot(shake_x, shake_y), moment)
    return balance


def make_base(n: NumberType, layout: Layout) -> Function:
    """Return (needs of the driven link, drive) -> fields of its joint with the frame."""
    hypot = n.hypot
    if layout.driver == 'slide':
        return lambda needs, drive: (drive, needs[1], hypot(drive, needs[1]), needs[1], needs[2])
    return lambda needs, drive: (needs[0], needs[1], hypot(needs[0], needs[1]))


def make_backward(n: NumberType, layout: Layout, numbers: Sequence[Numbers]) -> Function:
    """Return (curves, slides, sines, needs, drive) -> fields of all joints of the dyads."""
    work = [(i, stage.first - 1, stage.second - 1, stage.number - 1,
             SOLVERS[stage.kind](*given.sizes), make_fields(n, stage), make_arms(stage, given))
            for i, (stage, given) in enumerate(zip(layout.stages, numbers))][::-1]
    with_cylinder = layout.driver == CYLINDER

    def backward(curves: Sequence[Curve], slides: Sequence[Sequence[Scalar]],
                 sines: Sequence[Scalar], needs: list[Needs], drive: Scalar) -> list[Scalar]:
        found: list[tuple[Scalar, ...]] = [()] * len(work)
        for number, i, j, k, solve, fields, arms in work:
            one, two = curves[k], curves[k + 1]
            forces = solve(one[6:8], two[6:8], slides[number], sines[number], needs[k],
                           needs[k + 1])
            if with_cylinder and number == 0:
                forces = driven_along(forces, drive, one[6], one[7])
            found[number] = fields(forces)
            for parent, at, arm in zip((i, j), (0, 3), arms(slides[number])):
                if parent >= 0:
                    f_x, f_y, couple = forces[at:at + 3]
                    (along, across), (c, s) = arm, curves[parent][6:8]
                    x, y = along * c - across * s, along * s + across * c
                    old = needs[parent]
                    needs[parent] = (old[0] + f_x, old[1] + f_y,
                                     old[2] + couple + x * f_y - y * f_x)
        return [field for fields in found for field in fields]
    return backward


def make_arms(stage: Stage, own: Numbers) -> Function:
    """
    Return slides -> where on the links on which a dyad hangs the first joints of its links are.

    From their first joints, along and across: not as differences of places, which may be far.
    """
    sliding = {link: (k, *slide) for k, (link, slide) in enumerate(slides_of(stage, own))}

    def arm_of(link: int, parent: int, at: Sequence[Scalar]) -> Function:
        k, carrier, start, (c, s) = sliding.get(link, (0, -1, at, (0.0, 0.0)))
        if carrier != parent:
            return lambda _slides: at
        return lambda slides: (start[0] + slides[k] * c, start[1] + slides[k] * s)

    first = arm_of(stage.number, stage.first, own.p)
    second = arm_of(stage.number + 1, stage.second, own.q)
    return lambda slides: (first(slides), second(slides))


# The nine forces and couples of a dyad, and what its slides transmit.
Forces = tuple[Any, ...]


def driven_along(forces: Forces, drive: Scalar, x: Scalar, y: Scalar) -> Forces:
    """Return the forces in a cylinder: with that of its drive along (x, y) on the rod."""
    p_x, p_y, _, q_x, q_y, _, f_x, f_y, *others = forces
    d_x, d_y = drive * x, drive * y
    return (p_x - d_x, p_y - d_y, 0.0, q_x + d_x, q_y + d_y, 0.0, f_x + d_x, f_y + d_y, *others)


def make_fields(n: NumberType, stage: Stage) -> Callable[[Forces], tuple[Scalar, ...]]:
    """Return the function forces in a dyad -> fields of its joints."""
    hypot = n.hypot
    slides = list(SLIDES[stage.kind])
    starts = {'first': 0, 'second': 3, 'inner': 6}
    places = [(starts[place], slides.index(place) if place in slides else -1)
              for place in PLACES]

    def fields(forces: Forces) -> tuple[Scalar, ...]:
        found: list[Scalar] = []
        for at, normal in places:
            x, y, couple = forces[at:at + 3]
            found += (x, y, hypot(x, y))
            if normal >= 0:
                found += (forces[9][normal], couple)
        return tuple(found)
    return fields


Needs = tuple[Scalar, Scalar, Scalar]


# Forces (x, y) and couple at the first joint and at the second, of what the dyad hangs on, on its
# links; at the inner joint, of the second link on the first; normal forces of the joints that
# slide, in their order. Couples are about the first joints of the links.
# (directions (cosine, sine) of both links, slides, sine, needs of both) -> forces.
SolvesDyad = Callable[[Place, Place, Sequence[Scalar], Scalar, Needs, Needs], Forces]


def make_rrr_loads(r1: Scalar, r2: Scalar) -> SolvesDyad:
    """Return the forces in the dyad RRR."""
    def loads(first: Place, second: Place, _slides: Sequence[Scalar], sine: Scalar, needs1: Needs,
              needs2: Needs) -> Forces:
        (f1x, f1y, m1), (f2x, f2y, m2) = needs1, needs2
        b, a = m1 / (r1 * sine), m2 / (r2 * sine)                                       # (F1)
        fx, fy = a * first[0] + b * second[0], a * first[1] + b * second[1]
        return f1x - fx, f1y - fy, 0.0, f2x + fx, f2y + fy, 0.0, fx, fy, 0.0, ()
    return loads


def make_rrp_loads(r1: Scalar, *_: Scalar) -> SolvesDyad:
    """Return the forces in the dyad RRP."""
    def loads(first: Place, second: Place, _slides: Sequence[Scalar], sine: Scalar, needs1: Needs,
              needs2: Needs) -> Forces:
        (f1x, f1y, m1), (f2x, f2y, m2) = needs1, needs2
        tx, ty = second
        h, g = r1 * (first[1] * tx - first[0] * ty), r1 * sine
        a = f2x * tx + f2y * ty                                                         # (F2)
        b = (h * a - m1) / g
        normal = f2y * tx - f2x * ty - b
        fx, fy = b * ty - a * tx, -a * ty - b * tx
        return (f1x - fx, f1y - fy, 0.0, -normal * ty, normal * tx, m2, fx, fy, 0.0, (normal,))
    return loads


def make_rpr_loads(*_: Scalar) -> SolvesDyad:
    """Return the forces in the dyad RPR."""
    def loads(first: Place, _second: Place, slides: Sequence[Scalar], _sine: Scalar, needs1: Needs,
              needs2: Needs) -> Forces:
        (f1x, f1y, m1), (f2x, f2y, m2) = needs1, needs2
        normal = -(m1 + m2) / slides[0]                                                 # (F3)
        fx, fy = -normal * first[1], normal * first[0]
        return f1x - fx, f1y - fy, 0.0, f2x + fx, f2y + fy, 0.0, fx, fy, m1, (normal,)
    return loads


def make_rpp_loads(_cos_t: Scalar, _sin_t: Scalar, cos_g: Scalar, sin_g: Scalar) -> SolvesDyad:
    """Return the forces in the dyad RPP."""
    def loads(first: Place, second: Place, slides: Sequence[Scalar], _sine: Scalar, needs1: Needs,
              needs2: Needs) -> Forces:
        (f1x, f1y, m1), (f2x, f2y, m2) = needs1, needs2
        tx, ty = second
        slot = (f2x * tx + f2y * ty) / sin_g                                            # (F4)
        guide = f2y * tx - f2x * ty + slot * cos_g
        fx, fy = -slot * first[1], slot * first[0]
        return (f1x - fx, f1y - fy, 0.0, -guide * ty, guide * tx, m2 + m1 + slides[0] * slot,
                fx, fy, m1, (slot, guide))
    return loads


def make_prp_loads(*_: Scalar) -> SolvesDyad:
    """Return the forces in the dyad PRP."""
    def loads(first: Place, second: Place, _slides: Sequence[Scalar], sine: Scalar, needs1: Needs,
              needs2: Needs) -> Forces:
        (f1x, f1y, m1), (f2x, f2y, m2) = needs1, needs2
        (x1, y1), (x2, y2) = first, second
        fx, fy = (f1x + f2x) / sine, (f1y + f2y) / sine
        normal1, normal2 = fx * x2 + fy * y2, -(fx * x1 + fy * y1)                      # (F5)
        g1x, g1y = -normal1 * y1, normal1 * x1
        return (g1x, g1y, m1, -normal2 * y2, normal2 * x2, m2, f1x - g1x, f1y - g1y, 0.0,
                (normal1, normal2))
    return loads


SOLVERS: dict[str, Callable[..., SolvesDyad]] = {
    RRR: make_rrr_loads, RRP: make_rrp_loads, RPR: make_rpr_loads, RPP: make_rpp_loads,
    PRP: make_prp_loads}
