# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The linkages of both documents, and values of them that several items need.

Examples given in inches, feet and degrees are computed in SI units and converted back in the rows.
"""
from dataclasses import replace
from math import pi, radians
from typing import NamedTuple

from fourbar_lab.reproduction.documents import equal, Row
from fourbar_ros import Bodies, Body, find_extrema, FourBar, plain, point_motion, round_rod
from fourbar_ros.extrema.find import AskedQuantity, Extremum
from fourbar_ros.extrema.over_input import OverInput
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.parts import NamedFields
from fourbar_ros.mechanisms.sliders import InvertedSlider, SliderCrank
from fourbar_ros.numerics.arrays import Array, Values
import numpy as np

INCH, FOOT = 0.0254, 0.3048          # [m]
RPM = pi / 30.0

EXAMPLE_7_2 = SliderCrank(2.5 * INCH, 6.0 * INCH)
GIVEN_7_2 = (radians(30.0), -1800.0 * RPM)              # the angle is in the drawing only
EXAMPLE_7_3 = FourBar(4.0 * INCH, 18.0 * INCH, 11.0 * INCH, 10.0 * INCH)
GIVEN_7_3 = (radians(120.0), 900.0 * RPM)
POINTS_7_3 = {'E': ('coupler', 10.0 * INCH, -4.0 * INCH), 'F': ('output', 7.0 * INCH, -3.0 * INCH)}
# no offset: with 2 in, omega4 would miss by 12 to 15 %
EXAMPLE_7_5 = InvertedSlider(3.0 * INCH, 14.0 * INCH)
GIVEN_7_5 = (radians(30.0), -36.0)
EXAMPLE_7_6 = FourBar(8.0, 14.0, 9.0, 17.0)
GIVEN_7_6 = (radians(60.0), 10.0, 100.0)
EXAMPLE_7_7 = FourBar(2.0, 6.0, 7.0, 5.0)
PAPER_LENGTHS, PAPER_SPEED = (0.4, 1.2, 0.8, 1.0), 25.0
RODS = [round_rod(length, 7750.0, 0.01) for length in PAPER_LENGTHS[:3]]
PAPER = FourBar(*PAPER_LENGTHS, bodies=Bodies(*RODS))
THIN_RODS = Bodies(*(Body(rod.mass, cg_along=rod.cg_along, inertia=rod.mass * length**2 / 12.0)
                     for rod, length in zip(RODS, PAPER_LENGTHS)))
THIN = FourBar(*PAPER_LENGTHS, bodies=THIN_RODS)

STEP = 1e-30                                # of derivatives by a complex step
TURN: Array = np.linspace(-3.0, 3.0, 61)           # theta1 of samples of a turn [rad]


def extreme(linkage: Mechanism, quantity: str, kind: str, speed: float) -> Extremum:
    """Return the global ``maximum`` or ``minimum`` of a quantity, theta1 from 0 to a turn."""
    extrema = find_extrema(linkage, (quantity,), speed)
    extremum, = (each for each in extrema if each.is_global and each.kind == kind)
    return extremum


def at_extrema(linkage: FourBar, quantity: str, speed: float) -> NamedFields:
    return linkage.motion([extremum.theta1 for extremum
                           in find_extrema(linkage, (quantity,), speed)], speed)


def slope(linkage: FourBar, quantity: str, theta1: Values) -> float:
    """Return the largest |dQ/dtheta1| at these inputs over the largest |Q| of a turn."""
    of_turn, = linkage.motion(TURN, 1.0, fields=(quantity,))
    here, = linkage.motion(np.asarray(theta1) + 1j * STEP, 1.0, fields=(quantity,))
    return largest(here.imag / STEP) / largest(of_turn)


def largest(values: Values) -> float:
    return float(np.max(np.abs(values)))


def steps(linkage: FourBar, speed: float, names: tuple[str, str, str]) -> list[Row]:
    """Return three Rows: theta4, omega4, alpha4 by the documents' steps against our motion."""
    by_steps, ours = plain.motion(linkage.lengths, TURN, speed), linkage.motion(TURN, speed)
    return [
        equal(names[0], '', largest(np.sin(0.5 * (by_steps.theta4 - ours.theta4))), 0.0,
              why='largest difference from our motion over a turn'),
        *(equal(name, '', largest(getattr(by_steps, field) - getattr(ours, field))
                / largest(getattr(by_steps, field)), 0.0, why='the same over the largest value')
          for name, field in zip(names[1:], ('omega4', 'alpha4')))]


class WrongCurves(NamedTuple):
    """Magnitudes from a wrong form of the paper's Eq. (9): m v in place of m a, thin rods."""

    theta1: Array             # [rad], every 0.1 deg
    force: Array              # "shaking force [N]" as the paper prints it, to the last digit
    moment: Array             # "shaking moment [N m]" as printed: with an arm of 0.01 m, not a4
    literal_moment: Array     # with r34 of Fig. 2, which the paper does not print


def wrong_curves() -> WrongCurves:
    """Return what the paper printed as shaking force and moment, by its mistake."""
    theta1 = np.radians(np.arange(3600) / 10.0)
    motion = THIN.motion(theta1, PAPER_SPEED)
    arms, momenta = [], []
    for link, length, rod in zip(THIN_RODS._fields, PAPER_LENGTHS, THIN_RODS):
        first, centre, end = (point_motion(THIN, motion, link, along)
                              for along in (0.0, rod.cg_along, length))
        arms.append([(joint.place - centre.place) @ (1.0, 1j) for joint in (first, end)])
        momenta.append(rod.mass * centre.velocity @ (1.0, 1j))
    turning = zip(THIN_RODS, (motion.alpha1, motion.alpha_beta, motion.alpha4))
    f41_x, f41_y, *_, f43_x, f43_y, torque = plain.joint_forces(
        arms, momenta, [rod.inertia * alpha for rod, alpha in turning])
    literal = THIN_RODS.output.cg_along * (motion.cos_y * f43_y - motion.sin_y * f43_x) - torque
    return WrongCurves(theta1, np.hypot(f41_x + f43_x, f41_y + f43_y),
                       np.abs(-torque - 0.01 * f43_y), np.abs(literal))


def largest_extremum(linkage: Mechanism, quantity: AskedQuantity, speed: float) -> Extremum:
    """Return the extremum of a quantity that is largest, of either sign."""
    extremum = OverInput(linkage, quantity, speed).largest
    assert extremum     # it is no angle
    return extremum


def counterweighted(linkage: FourBar, theta1: float) -> FourBar:
    """Return a linkage with 5 kg on its crank: no shaking force at theta1 [rad]."""
    assert linkage.bodies is not None
    crank, mass, loads = linkage.bodies.crank, 5.0, linkage.loads(theta1, 1.0)
    force = complex(loads.shaking_force_x, loads.shaking_force_y)
    # at unit rate a first moment s on the crank adds the force s e^{i theta1}
    moment = crank.mass * complex(crank.cg_along, crank.cg_across) - force * np.exp(-1j * theta1)
    total = crank.mass + mass
    body = Body(total, cg_along=moment.real / total, cg_across=moment.imag / total,
                inertia=crank.inertia)
    return replace(linkage, bodies=linkage.bodies._replace(crank=body))
