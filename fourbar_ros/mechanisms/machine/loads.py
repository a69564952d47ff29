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
dyads are solved from the last to the first (:mod:`.dyad_loads`); what one needs of the links on
which it hangs is added to their needs. The force D of a cylinder's drive acts along its rod, on
the rod and back on the tube.
"""
from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from fourbar_ros.mechanics.bodies import applied_to
from fourbar_ros.mechanics.newton_euler import about_first_joint
from fourbar_ros.mechanisms.machine.description import CYLINDER
from fourbar_ros.mechanisms.machine.dyad_loads import Needs, SOLVERS
from fourbar_ros.mechanisms.machine.frames import slides_of
from fourbar_ros.mechanisms.machine.layout import (
    COEFFICIENTS,
    Layout,
    motion_fields,
    PLACES,
    SLIDES,
    Stage,
    travel,
)
from fourbar_ros.numerics.number_types import Function, NumberType


def make_needs(body: Any, gravity: tuple[Any, Any], applied: Any) -> Function:
    """Return the function (curve, rate^2, rate, acceleration) -> needs of a link, (L1)."""
    (along, across, inertia, hold_x, hold_y, couple, by_cosine,
     by_sine) = about_first_joint(body, 1.0, gravity, applied)
    mass = body.mass

    def needs(curve: Sequence[Any], square: Any, rate: Any, acceleration: Any) -> Needs:
        _, _, dx, dy, ddx, ddy, cosine, sine, turn, bend = curve
        a_x, a_y = dx * acceleration + ddx * square, dy * acceleration + ddy * square
        alpha, omega = turn * acceleration + bend * square, turn * rate
        x, y = along * cosine - across * sine, along * sine + across * cosine
        squared = omega * omega
        return (mass * a_x + hold_x - alpha * y - squared * x,                          # (L1)
                mass * a_y + hold_y + alpha * x - squared * y,
                inertia * alpha + x * a_y - y * a_x
                + by_cosine * cosine + by_sine * sine + couple)
    return needs


def make_loads(n: NumberType, layout: Layout, numbers: Sequence[Any], bodies: Any,
               gravity: tuple[Any, Any], external: Any) -> Function:
    """Return the function (fields of motion) -> fields of :func:`.layout.load_fields`."""
    needs_of = [make_needs(body, gravity, applied_to(external, name))
                for name, body in zip(layout.moving, bodies)]
    read, drive_and_shaking = make_reader(layout), make_drive_and_shaking(n)
    solve, base = make_backward(n, layout, numbers), make_base(n, layout)
    is_crank = layout.driver == 'crank'

    def loads(motion: tuple[Any, ...]) -> tuple[Any, ...]:
        curves, slides, sines, rate, acceleration = read(motion)
        square = rate * rate
        needs = [needs_of_link(curve, square, rate, acceleration)
                 for needs_of_link, curve in zip(needs_of, curves)]
        drive, shaking = drive_and_shaking(curves, needs)
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

    def read(motion: Sequence[Any]) -> Any:
        return ([motion[i:i + width] for i in starts],
                [[motion[i] for i in places] for places in slides], motion[last:],
                motion[place], motion[place + 1])
    return read


def make_drive_and_shaking(n: NumberType) -> Function:
    """Return (curves, needs) -> drive and (shaking force x, y, magnitude, moment about O1)."""
    hypot = n.hypot

    def balance(curves: Sequence[Any], needs: Sequence[Needs]) -> tuple[Any, tuple[Any, ...]]:
        drive = shake_x = shake_y = moment = 0.0
        for (f_x, f_y, m), (x, y, dx, dy, _, _, _, _, turn, _) in zip(needs, curves):
            drive = drive + (f_x * dx + f_y * dy + m * turn)                            # (L2)
            shake_x, shake_y = shake_x - f_x, shake_y - f_y
            moment = moment - (m + x * f_y - y * f_x)
        return drive, (shake_x, shake_y, hypot(shake_x, shake_y), moment)
    return balance


def make_base(n: NumberType, layout: Layout) -> Function:
    """Return (needs of the driven link, drive) -> fields of its joint with the ground."""
    hypot = n.hypot
    if layout.driver == 'slide':
        return lambda needs, drive: (drive, needs[1], hypot(drive, needs[1]), needs[1], needs[2])
    return lambda needs, drive: (needs[0], needs[1], hypot(needs[0], needs[1]))


def make_backward(n: NumberType, layout: Layout, numbers: Sequence[Any]) -> Function:
    """Return (curves, slides, sines, needs, drive) -> fields of all joints of the dyads."""
    work = [(i, stage.first - 1, stage.second - 1, stage.number - 1,
             SOLVERS[stage.kind](*given[4:]), make_fields(n, stage), make_arms(stage, given))
            for i, (stage, given) in enumerate(zip(layout.stages, numbers))][::-1]
    with_cylinder = layout.driver == CYLINDER

    def backward(curves: Sequence[Any], slides: Sequence[Any], sines: Sequence[Any],
                 needs: list[Needs], drive: Any) -> list[Any]:
        found: list[tuple[Any, ...]] = [()] * len(work)
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


def make_arms(stage: Stage, numbers: Sequence[Any]) -> Function:
    """
    Return slides -> where on the links on which a dyad hangs the first joints of its links are.

    From their first joints, along and across: not as differences of places, which may be far.
    """
    sliding = {link: (k, *slide) for k, (link, slide) in enumerate(slides_of(stage, numbers))}

    def arm_of(link: int, parent: int, at: Sequence[Any]) -> Function:
        k, carrier, start, (c, s) = sliding.get(link, (0, -1, at, (0.0, 0.0)))
        if carrier != parent:
            return lambda _slides: at
        return lambda slides: (start[0] + slides[k] * c, start[1] + slides[k] * s)

    first = arm_of(stage.number, stage.first, numbers[:2])
    second = arm_of(stage.number + 1, stage.second, numbers[2:4])
    return lambda slides: (first(slides), second(slides))


def driven_along(forces: tuple[Any, ...], drive: Any, x: Any, y: Any) -> tuple[Any, ...]:
    """Return the forces in a cylinder: with that of its drive along (x, y) on the rod."""
    p_x, p_y, _, q_x, q_y, _, f_x, f_y, *others = forces
    d_x, d_y = drive * x, drive * y
    return (p_x - d_x, p_y - d_y, 0.0, q_x + d_x, q_y + d_y, 0.0, f_x + d_x, f_y + d_y, *others)


def make_fields(n: NumberType, stage: Stage) -> Callable[[tuple[Any, ...]], tuple[Any, ...]]:
    """Return the function forces in a dyad -> fields of its joints."""
    hypot = n.hypot
    slides = list(SLIDES[stage.kind])
    starts = {'first': 0, 'second': 3, 'inner': 6}
    places = [(starts[place], slides.index(place) if place in slides else -1)
              for place in PLACES]

    def fields(forces: tuple[Any, ...]) -> tuple[Any, ...]:
        found: list[Any] = []
        for at, normal in places:
            x, y, couple = forces[at:at + 3]
            found += (x, y, hypot(x, y))
            if normal >= 0:
                found += (forces[9][normal], couple)
        return tuple(found)
    return fields
