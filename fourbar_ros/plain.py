# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The four-bar linkage in two hundred lines: read this file first.

It is the paper of Hayes, Hninn and Irani, "Angular Velocity and Acceleration Extrema", in numpy
and in its letters: angles, rates, accelerations, joint forces, shaking force and moment, extrema.
The rest of the library computes the same for planar linkages built of dyads, by formulas that keep
their digits where these lose them, most beside change points (docs/bench/accuracy.md has figures).

Links: 1 crank O1-A, 2 coupler A-B, 3 output link O4-B, 4 ground O1-O4; a1 to a4 are their lengths
[m]. theta1 and theta4 are the angles of links 1 and 3 to the x axis, which runs from O1 to O4.
theta2 turns from link 1 to link 2, theta3 from link 2 to link 3 taken from B to O4. beta is the
angle of link 2 to the x axis: theta1 + theta2, in any turn. Joints 1 to 4 are O1, A, B and O4. An
angle, rate or acceleration is a number or a numpy array, one entry a sample; so are the results.

>>> from fourbar_ros import round_rod
>>> lengths = 0.4, 1.2, 0.8, 1.0
>>> rods = [round_rod(length, 7750.0, 0.01) for length in lengths[:3]]
>>> m = motion(lengths, theta1=1.0, omega1=25.0)
>>> print(f'{m.theta4:.6f} rad, {m.omega4:.6f} rad/s, {m.alpha4:.4f} rad/s^2')
1.112263 rad, 11.032049 rad/s, 225.9953 rad/s^2
>>> print(f'{loads(lengths, rods, m).shaking_force:.3f} N')
874.370 N
>>> for theta1, omega4 in extrema(lengths, 'omega4', omega1=25.0):
...     print(f'{omega4:.6f} rad/s at {theta1:.6f} rad')
13.513437 rad/s at 1.667165 rad
-23.959382 rad/s at 5.913850 rad
"""
from collections import namedtuple
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

Motion = namedtuple('Motion', 'theta1 omega1 alpha1 theta2 omega2 alpha2 theta3 omega3 alpha3 '
                              'theta4 omega4 alpha4 beta omega_beta alpha_beta')
Loads = namedtuple('Loads', 'f41_x f41_y f21_x f21_y f32_x f32_y f43_x f43_y driving_torque '
                            'shaking_force shaking_moment')
STEP = 1e-30        # of derivatives by a complex step [rad]


class IOEquation(NamedTuple):
    """both vi^2 vj^2 + first vi^2 + second vj^2 + mixed vi vj + constant = 0, v = tan(angle/2)."""

    both: float
    first: float
    second: float
    mixed: float
    constant: float


def io_equation(lengths: Sequence[float], i: int, j: int) -> IOEquation:
    """
    Return the coefficients [m^2] of the equation between vi and vj, ``i`` < ``j`` from 1 to 4.

    In the paper's Eqs. (1)-(6) all four angles turn from one link to the next, so that they add up
    to whole turns: the angle at joint 1 is theta1 + pi, that at joint 4 is -theta4.
    """
    a1, a2, a3, a4 = lengths
    A1, A2 = a1 - a2 + a3 - a4, a1 + a2 + a3 - a4
    B1, B2 = a1 + a2 - a3 - a4, a1 - a2 - a3 - a4
    C1, C2 = a1 - a2 - a3 + a4, a1 + a2 - a3 + a4
    D1, D2 = a1 + a2 + a3 + a4, a1 - a2 + a3 + a4
    return IOEquation(*{
        (1, 4): (A1 * A2, B1 * B2, C1 * C2, -8.0 * a1 * a3, D1 * D2),                   # (1)
        (1, 2): (A1 * B2, A2 * B1, C1 * D2, -8.0 * a2 * a4, C2 * D1),                   # (2)
        (1, 3): (A1 * B1, A2 * B2, C2 * D2, 0.0, C1 * D1),                              # (3)
        (2, 3): (A1 * D2, B2 * C1, B1 * C2, -8.0 * a1 * a3, A2 * D1),                   # (4)
        (2, 4): (A1 * C1, B2 * D2, A2 * C2, 0.0, B1 * D1),                              # (5)
        (3, 4): (A1 * C2, B1 * D2, A2 * C1, 8.0 * a2 * a4, B2 * D1)}[i, j])             # (6)


def solved(equation: IOEquation, sign: float, theta1: Any, omega: Any,
           alpha: Any) -> tuple[Any, ...]:
    """
    Return the angle y at joint j, its rate and acceleration, for the angle x = theta1 + pi.

    These are both algorithms of the paper up to the acceleration. The paper's Eqs. (7) and (8) are
    derivatives of the equation in v; here they are those of the equation in angles,
    F(x, y) = 4 cos^2(x/2) cos^2(y/2) (both v1^2 vj^2 + ...) = 0, so that v may be infinite.
    ``sign``: of the square root, which the assembly mode decides.
    """
    both, first, second, mixed, constant = equation
    s, c = np.cos(0.5 * theta1), -np.sin(0.5 * theta1)      # sin, cos of x/2 = (theta1 + pi)/2
    cos_x, sin_x = -np.cos(theta1), -np.sin(theta1)
    # (1) to (3) times cos^2(x/2): p vj^2 - 2 m vj + r = 0, with the root vj = g/h
    p, m, r = both * s**2 + second * c**2, -0.5 * mixed * s * c, first * s**2 + constant * c**2
    root = sign * np.sqrt(m**2 - p * r)
    adds = m.real * root.real >= 0.0        # g/h = (m + root)/p = r/(m - root): what adds
    g, h = np.where(adds, m + root, r), np.where(adds, p, m - root)
    cos_y, sin_y = (h**2 - g**2) / (g**2 + h**2), 2.0 * g * h / (g**2 + h**2)
    # F = ... + of_x cos x + of_y cos y + of_xy cos x cos y + mixed sin x sin y
    of_x, of_y = constant + second - first - both, constant + first - second - both
    of_xy = constant + both - first - second
    F_x = mixed * cos_x * sin_y - (of_x + of_xy * cos_y) * sin_x
    F_y = mixed * sin_x * cos_y - (of_y + of_xy * cos_x) * sin_y
    F_xx = -mixed * sin_x * sin_y - (of_x + of_xy * cos_y) * cos_x
    F_yy = -mixed * sin_x * sin_y - (of_y + of_xy * cos_x) * cos_y
    F_xy = mixed * cos_x * cos_y + of_xy * sin_x * sin_y
    rate = -F_x * omega / F_y                                                           # (7)
    acceleration = -(F_x * alpha + F_xx * omega**2 + 2.0 * F_xy * omega * rate
                     + F_yy * rate**2) / F_y                                            # (8)
    return np.arctan2(sin_y.real, cos_y.real), rate, acceleration


def motion(lengths: Sequence[float], theta1: Any, omega1: Any = 0.0, alpha1: Any = 0.0,
           mode: int = 2) -> Motion:
    """
    Return angles [rad], rates [rad/s] and accelerations [rad/s^2] at theta1, omega1, alpha1.

    ``mode``: 2 (open) where sin(theta4 - beta) > 0, 1 (crossed) elsewhere. NaN where the links do
    not close, or lie flat at a change point; there the library's branch goes on, (M13) of loop.py.
    """
    sign, crank = {2: 1.0, 1: -1.0}[mode], (theta1, omega1, alpha1)
    with np.errstate(divide='ignore', invalid='ignore'):
        theta2, omega2, alpha2 = solved(io_equation(lengths, 1, 2), sign, *crank)
        third = solved(io_equation(lengths, 1, 3), -sign, *crank)      # it turns the other way
        fourth = solved(io_equation(lengths, 1, 4), sign, *crank)
    return Motion._make((*crank, theta2, omega2, alpha2, *third, *(-each for each in fourth),
                         theta1 + theta2, omega1 + omega2, alpha1 + alpha2))


def loads(lengths: Sequence[float], bodies: Sequence[Any], m: Motion,
          gravity: tuple[float, float] = (0.0, 0.0)) -> Loads:
    """
    Return joint forces [N], torque, size of the shaking force, moment about O1 [N m]; with weight.

    ``bodies``: three of :class:`fourbar_ros.Body`; ``gravity``: x and y [m/s^2]. F_ij is the force
    of link i on link j, T41 the drive's torque on the crank. Vectors are complex, x + i y.
    """
    def turning(angle: Any, omega: Any, alpha: Any) -> tuple[Any, Any]:
        direction = np.exp(1j * angle)          # of a link; and its second derivative by time
        return direction, (1j * alpha - omega**2) * direction

    links = [turning(m.theta1, m.omega1, m.alpha1), turning(m.beta, m.omega_beta, m.alpha_beta),
             turning(m.theta4, m.omega4, m.alpha4)]
    first_joint = 0.0, lengths[0] * links[0][1], 0.0        # acceleration of O1, A and O4
    arms, forces, moments = [], [], []
    for (direction, second), length, body, of_joint, alpha in zip(
            links, lengths, bodies, first_joint, (m.alpha1, m.alpha_beta, m.alpha4)):
        cg = complex(body.cg_along, body.cg_across)
        arms.append((-direction * cg, direction * (length - cg)))
        forces.append(body.mass * (of_joint + second * cg - complex(*gravity)))
        moments.append(body.inertia * alpha)
    x = joint_forces(arms, forces, moments)
    force, moment = -(x[0] + x[6]) - 1j * (x[1] + x[7]), -x[8] - lengths[3] * x[7]
    return Loads._make((*x, np.abs(force), moment))


def joint_forces(arms: Sequence[Any], forces: Sequence[Any], moments: Sequence[Any]) -> Any:
    """
    Return the nine unknowns x of the paper's Eq. (9), A x = b, by Eq. (10), shape (9, ...).

    ``arms``: for each link r from its centre of gravity to its first and its second joint, O1 and
    A, A and B, O4 and B [m]; ``forces``, ``moments``: m (a_CG - g) [N], I_CG alpha [N m] of each.
    """
    A = np.zeros((*np.shape(forces[1]), 9, 9))
    b = np.zeros((*np.shape(forces[1]), 9))
    # of each link the columns of the forces at its two joints, and their signs: F12 = -F21
    columns = ((0, 1.0), (2, 1.0)), ((2, -1.0), (4, 1.0)), ((6, 1.0), (4, -1.0))
    for row, at_joints, of_link, force, moment in zip((0, 3, 6), columns, arms, forces, moments):
        for (column, sign), r in zip(at_joints, of_link):
            A[..., row, column] = A[..., row + 1, column + 1] = sign
            A[..., row + 2, column], A[..., row + 2, column + 1] = -sign * r.imag, sign * r.real
        b[..., row], b[..., row + 1], b[..., row + 2] = np.real(force), np.imag(force), moment
    A[..., 2, 8] = 1.0
    return np.moveaxis(np.linalg.solve(A, b[..., None])[..., 0], -1, 0)


def extrema(lengths: Sequence[float], name: str, omega1: float, mode: int = 2,
            samples: int = 3600) -> list[tuple[float, float]]:
    """
    Return (theta1, value) at the extrema of 'omega4' or 'alpha4', for a crank that turns fully.

    Both algorithms of extreme values of the paper: :func:`motion` gives omega4 and alpha4 as
    functions of theta1 alone, at constant omega1; extrema are where the derivative by theta1, by a
    complex step, is zero (steps 3 and 5). Intervals in which its sign changes are halved; two
    extrema between two samples are missed.
    """
    if name not in ('omega4', 'alpha4'):
        raise ValueError(f"name = {name!r} must be 'omega4' or 'alpha4'")

    def function(theta1: Any) -> Any:
        return getattr(motion(lengths, theta1 + 1j * STEP, omega1, 0.0, mode), name)

    low = 2.0 * np.pi / samples * (np.arange(samples) + 0.5)
    slope = function(low).imag
    if np.isnan(slope).any():
        raise ValueError(f'the crank of {tuple(lengths)} does not turn fully')
    changes = np.flatnonzero(slope * np.roll(slope, -1) < 0.0)
    low, slope = low[changes], slope[changes]
    high = low + 2.0 * np.pi / samples
    for _ in range(60):
        middle = 0.5 * (low + high)
        is_before = function(middle).imag * slope > 0.0
        low, high = np.where(is_before, middle, low), np.where(is_before, high, middle)
    return sorted(zip((low % (2.0 * np.pi)).tolist(), function(low).real.tolist()))
