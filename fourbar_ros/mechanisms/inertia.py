# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
What a larger simulation needs of a linkage: its inertia, and what remains of torque and wrench.

The drive gives T = J alpha + b, with the inertia J and the bias b at the input. Both are loads of
single motions: J is the drive at unit acceleration and at rest, without weight and other forces;
half its slope dJ/dtheta is the drive at unit rate. No digit cancels.
"""
from typing import Any, NamedTuple

from fourbar_ros.mechanics.bodies import Base, Body, field_of, NOT_APPLIED
from fourbar_ros.mechanics.newton_euler import needs_of
from fourbar_ros.mechanisms.curves import FIXED, point_of
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.parts import NamedFields
from fourbar_ros.mechanisms.quadrature import mean_over_input
from fourbar_ros.numerics.arrays import Array, EPS
from fourbar_ros.numerics.number_types import Scalar
import numpy as np


class InputEquation(NamedTuple):
    """The equation of motion of the input at a position and a rate; per m of a driven slide."""

    inertia: Scalar           # J [kg m^2]
    inertia_slope: Scalar     # dJ/dtheta [kg m^2/rad]
    bias: Scalar              # b [N m]: half the slope times the squared rate, and what follows
    static_torque: Scalar     # [N m] against weight, springs and other forces, at rest


class Rigid(NamedTuple):
    """A linkage held rigid: its inertia as simulators take it, along the axes of the linkage."""

    mass: Scalar              # [kg]
    x: Scalar                 # [m] centre of gravity from O1
    y: Scalar
    inertia: Scalar           # [kg m^2] about the centre of gravity


def input_equation(mechanism: Mechanism, position: Any, rate: Any,
                   weightless: Mechanism | None = None) -> InputEquation:
    """Return the terms of T = J alpha + b; arguments, arrays too, and errors as of ``loads``."""
    # weightless: the same without weight, if other forces than its constant ones act on it.
    free, drive = weightless or mechanism.weightless, mechanism.drive_load
    inertia, half_slope, static, bias = [
        getattr(links.loads(position, *rates), drive)
        for links, *rates in ((free, 0.0, 1.0), (free, 1.0, 0.0), (mechanism, 0.0, 0.0),
                              (mechanism, rate, 0.0))]
    return InputEquation(inertia, 2.0 * half_slope, bias, static)


def held_rigid(mechanism: Mechanism, motion: NamedFields) -> Rigid:
    """Return the inertia of a mechanism with masses, held in the pose of a motion or of many."""
    masses = []
    for link, (body, _) in mechanism.loads_of_links().items():
        cg = point_of(mechanism.link_motion(motion, link), body.cg_along, body.cg_across)
        masses.append((body.mass, cg.x, cg.y, body.inertia))
    mass = sum(m for m, _, _, _ in masses)
    if not mass:
        return Rigid(0.0, 0.0, 0.0, sum(inertia for *_, inertia in masses))
    x, y = (sum(m * at_cg[i] for m, *at_cg, _ in masses) / mass for i in (0, 1))
    apart = [(m, cg_x - x, cg_y - y, inertia) for m, cg_x, cg_y, inertia in masses]
    # not by **, which raises where floats overflow
    return Rigid(mass, x, y, sum(inertia + m * (d_x * d_x + d_y * d_y)
                                 for m, d_x, d_y, inertia in apart))


def mean_rigid(mechanism: Mechanism) -> Rigid:
    """Return the mean over the input of a mechanism held rigid, as one rigid body."""
    # Its mass matrix about O1 is linear in mass, first moments and moment of inertia about O1, so
    # these are averaged; the mean about the centre of gravity follows.
    def moments(x: Array) -> Array:
        held = held_rigid(mechanism, mechanism.motion(x))
        about_o1 = held.inertia + held.mass * (held.x * held.x + held.y * held.y)
        return np.array([np.broadcast_to(value, x.shape) for value in (held.x, held.y, about_o1)])

    mass = sum(body.mass for body, _ in mechanism.loads_of_links().values())
    size = max(map(abs, mechanism.lengths))
    with np.errstate(all='ignore'):
        x, y, about_o1 = map(float, mean_over_input(mechanism, moments,
                                                    least_size=(size, size, 0.0)))
    # of a symmetrical mechanism only rounding errors are left
    x, y = (0.0 if abs(part) < EPS * size else part for part in (x, y))
    about_centre = about_o1 - mass * (x * x + y * y)
    return Rigid(mass, x, y, 0.0 if about_centre < 0.0 else about_centre)     # by rounding


def rest_of(loads: NamedFields, carried: Rigid, mechanism: Mechanism) -> NamedFields:
    """Return loads whose shaking wrench is without that of a rigid body on the base."""
    # carried: that body, which a simulator has and moves itself; it is at rest on the base. It
    # needs force and moment, and shakes the base with the opposite ones: these are taken off.
    gravity = mechanism.gravity
    # weight is as on a base that accelerates upwards
    base = gravity if isinstance(gravity, Base) else Base(*(-g for g in field_of(gravity)))
    body = Body(carried.mass, cg_along=carried.x, cg_across=carried.y, inertia=carried.inertia)
    needs = needs_of(body, 1.0, base, NOT_APPLIED, FIXED)       # lengths in units of 1 m
    x, y = loads.shaking_force_x + needs.force.x, loads.shaking_force_y + needs.force.y
    return loads._replace(
        shaking_force_x=x, shaking_force_y=y, shaking_force=float(np.hypot(x, y)),
        shaking_moment=loads.shaking_moment + needs.moment)
