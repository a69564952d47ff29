# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Computed values for everything that the two documents print: one function per example.

Each returns a dict by name for :mod:`fourbar_lab.reproduction.table`, which has the printed
numbers. Examples given in inches, feet and degrees are computed in SI units and converted back at
the end. Links have the numbers of the slides: crank 2, coupler 3, output 4; omega_beta is the
coupler's rate.
"""
from __future__ import annotations

from cmath import phase
from math import degrees, hypot, pi, radians

from fourbar_lab.reproduction.io_equations import io_equation, to_half_angle
from fourbar_ros.extrema.find import find_extrema
from fourbar_ros.mechanics.bodies import Bodies, Body, round_rod
from fourbar_ros.mechanics.moving_frames import acceleration_terms
from fourbar_ros.mechanisms.contract import CROSSED, OPEN
from fourbar_ros.mechanisms.four_bar.four_bar import FourBar
from fourbar_ros.mechanisms.half_angle import bilinear_factors
from fourbar_ros.mechanisms.inverted_slider_crank.inverted_slider_crank import InvertedSlider
from fourbar_ros.mechanisms.parts import NamedFields
from fourbar_ros.mechanisms.points import acceleration_image, link_motion, point_motion
from fourbar_ros.mechanisms.slider_crank.slider_crank import SliderCrank
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.numerics.number_types import Scalar
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
THIN_RODS = Bodies(*(Body(rod.mass, rod.cg_along, 0.0, rod.mass * length**2 / 12.0)
                     for rod, length in zip(RODS, PAPER_LENGTHS)))
THIN = FourBar(*PAPER_LENGTHS, bodies=THIN_RODS)


def example_7_2() -> dict[str, float]:
    """Return speeds and accelerations of B, C and the coupler of a slider-crank [ft, rad, s]."""
    motion, a2 = EXAMPLE_7_2.motion(*GIVEN_7_2), EXAMPLE_7_2.a2
    joint_b = point_motion(EXAMPLE_7_2, motion, 'coupler', 0.0)
    return {'angle': degrees(motion.theta1), 'omega2': -motion.omega1,
            'v_b': float(joint_b.speed) / FOOT,
            'a_b': hypot(*joint_b.acceleration) / FOOT, 'v_c': motion.slide_velocity / FOOT,
            'omega3': motion.omega_beta, 'normal': motion.omega_beta**2 * a2 / FOOT,
            'alpha3': motion.alpha_beta, 'tangential': motion.alpha_beta * a2 / FOOT,
            'a_c': -motion.slide_acceleration / FOOT,
            'delta': degrees(acceleration_image(motion.omega_beta, motion.alpha_beta)[1])}


def example_7_3() -> dict[str, float]:
    """Return places [in] and accelerations of a 4R's points, rates of its links [ft, rad, s]."""
    motion = EXAMPLE_7_3.motion(*GIVEN_7_3)
    points = {f'a_{name.lower()}':
              hypot(*point_motion(EXAMPLE_7_3, motion, *point).acceleration) / FOOT
              for name, point in POINTS_7_3.items()}
    places = {f'{name.lower()}_{field}': sign * value / INCH
              for name, (_, along, across) in POINTS_7_3.items()
              for field, sign, value in (('along', 1.0, along), ('across', -1.0, across))}
    return places | {
            'angle': degrees(motion.theta1), 'ground': EXAMPLE_7_3.a4 / INCH,
            'omega2': motion.omega1, 'omega3': motion.omega_beta, 'omega4': motion.omega4,
            'a_b': motion.omega1**2 * EXAMPLE_7_3.a1 / FOOT,
            'normal_cb': motion.omega_beta**2 * EXAMPLE_7_3.a2 / FOOT,
            'normal_cd': motion.omega4**2 * EXAMPLE_7_3.a3 / FOOT,
            'tangential_cb': abs(motion.alpha_beta) * EXAMPLE_7_3.a2 / FOOT,
            'tangential_cd': abs(motion.alpha4) * EXAMPLE_7_3.a3 / FOOT,
            'alpha3': motion.alpha_beta, 'alpha4': -motion.alpha4, **points}


def example_7_4() -> dict[str, float]:
    """
    Return the acceleration of a slider on a turning rod [m/s^2], its parts and direction [deg].

    The rod is at 45 deg, at 50 rad/s ccw, the slider 0.5 m out and moving outwards at 30 m/s.
    """
    out = np.array([np.cos(pi / 4.0), np.sin(pi / 4.0)])
    terms = acceleration_terms((0.0, 0.0), 50.0, 0.0, 0.5 * out, 30.0 * out)
    total = np.sum(terms, axis=0)
    return {'normal': hypot(*terms.normal), 'coriolis': hypot(*terms.coriolis),
            'total': hypot(*total),
            'direction': degrees(pi - np.arctan2(total[1], total[0]))}


def example_7_5() -> dict[str, float]:
    """Return the motion of an inverted slider-crank; Q is the point of the bar under A [ft]."""
    motion, a1 = EXAMPLE_7_5.motion(*GIVEN_7_5), EXAMPLE_7_5.a1
    return {'angle': degrees(motion.theta1), 'offset': EXAMPLE_7_5.offset / INCH,
            'qd': motion.slide / INCH, 'omega4': motion.omega4, 'alpha4': motion.alpha4,
            'v_a': -motion.omega1 * a1 / FOOT, 'v_q': motion.omega4 * motion.slide / FOOT,
            'v_rel': -motion.slide_velocity / FOOT, 'a_a': motion.omega1**2 * a1 / FOOT,
            'normal': motion.omega4**2 * motion.slide / FOOT,
            'coriolis': -2.0 * motion.omega4 * motion.slide_velocity / FOOT,
            'tangential': motion.alpha4 * motion.slide / FOOT}


def example_7_6() -> dict[str, float]:
    """Return angles, rates and half-angles v = tan(theta / 2) of links 2 and 4 in both modes."""
    values: dict[str, float] = {}
    for name, mode in (('', OPEN), ('other_', CROSSED)):
        motion = EXAMPLE_7_6.in_mode(mode).motion(*GIVEN_7_6)
        for number, theta, omega, alpha in (
                (2, motion.theta2, motion.omega2, motion.alpha2),
                (4, motion.theta4, motion.omega4, motion.alpha4)):
            values |= {f'{name}theta{number}': degrees(theta), f'{name}omega{number}': omega,
                       f'{name}alpha{number}': alpha}
            values |= {f'{name}{order}v{number}': float(part) for order, part in
                       zip(('', 'd', 'dd'), to_half_angle(theta, omega, alpha))}
        values |= {f'{name}theta2_positive': degrees(motion.theta2) % 360.0,
                   f'{name}beta': degrees(motion.beta),
                   f'{name}interior': degrees(motion.theta2) % 360.0 - 180.0,
                   f'{name}omega_beta': motion.omega_beta, f'{name}alpha_beta': motion.alpha_beta}
    return values


def example_7_7() -> dict[str, float]:
    """Return the coefficients of Eq. (38), v1-v4, and the extrema of omega4 and alpha4 [deg]."""
    equation = io_equation(EXAMPLE_7_7.lengths, 1, 4)
    values = {'eq38_v1v4': equation.both, 'eq38_v1': equation.first, 'eq38_mixed': -equation.mixed,
              'eq38_v4': -equation.second, 'eq38': equation.constant}
    return values | _extrema(EXAMPLE_7_7, 10.0, 'deg')


def _extrema(linkage: FourBar, speed: float, unit: str) -> dict[str, float]:
    """
    Return values and places (rad or deg) of the global extrema of omega4 and alpha4 in both modes.

    Places count from 0 to a turn, and (``_negative``) from minus a turn to 0.
    """
    values: dict[str, float] = {}
    turn = 360.0 if unit == 'deg' else 2.0 * pi
    for mode in (CROSSED, OPEN):
        for extremum in find_extrema(linkage.in_mode(mode), ('omega4', 'alpha4'), speed):
            if extremum.is_global:
                name = f'mode{mode}_{extremum.quantity}_{extremum.kind[:3]}'
                place = degrees(extremum.theta1) if unit == 'deg' else extremum.theta1
                values |= {name: extremum.value, f'{name}_at': place,
                           f'{name}_at_negative': place - turn}
    return values


def paper_table_1() -> dict[str, float]:
    """Return the masses of the paper's rods [kg]."""
    return {f'm{i}': rod.mass for i, rod in enumerate(RODS, 1)}


def paper_table_2() -> dict[str, float]:
    """Return extrema of omega4 and alpha4 of the paper's linkage, in rad and (``_deg``) in deg."""
    values = _extrema(PAPER, PAPER_SPEED, 'rad')
    return values | {f'{name}_deg': degrees(value) for name, value in values.items()
                     if '_at' in name}


def paper_table_3() -> dict[str, float]:
    """
    Return the largest shaking forces and moments over a turn, and where they are [rad].

    For thin rods, for solid ones, with the arm of the paper's figure, and as the paper has them.
    """
    values: dict[str, float] = {}
    for name, linkage, quantity in (('force', THIN, 'shaking_force'),
                                    ('moment', THIN, 'shaking_moment'),
                                    ('solid_moment', PAPER, 'shaking_moment'),
                                    ('literal_moment', THIN, literal_moment)):
        largest = max(find_extrema(linkage, (quantity,), PAPER_SPEED),
                      key=lambda extremum: abs(extremum.value))
        values |= {name: abs(largest.value), f'{name}_at': largest.theta1}
    theta1, *curves = wrong_curves()
    for name, curve in zip(('wrong_force', 'wrong_moment', 'literal_wrong_moment'), curves):
        values |= {name: curve.max(), f'{name}_at': theta1[curve.argmax()]}
    table_2 = paper_table_2()
    return values | {'rate': table_2['mode2_omega4_min'],
                     'rate_at': table_2['mode2_omega4_min_at']}


def literal_moment(motion: NamedFields, loads: NamedFields) -> Scalar:
    """
    Return T14 + r34 x F34 [N m] with the arm r34 of the paper's Fig. 2.

    That arm runs from the centre of gravity of link 3 to joint 4.
    """
    along = THIN_RODS.output.cg_along
    moment: Scalar = (along * (motion.cos_y * loads.f43_y - motion.sin_y * loads.f43_x)
                      - loads.driving_torque)
    return moment


def wrong_curves() -> tuple[Array, Array, Array, Array]:
    """
    Return theta1 [rad] and three magnitudes from a wrong form of the paper's Eq. (9).

    It has m v in place of m a, thin rods, every 0.1 deg. The first two are "shaking force" and
    "moment" as the paper prints them, to the last digit: the moment with an arm of 0.01 m along x.
    The third is the moment with r34 of Fig. 2, which the paper does not print.
    """
    theta1 = np.radians(np.arange(3600) / 10.0)
    motion = THIN.motion(theta1, PAPER_SPEED)
    unknowns = solve_eq_9(THIN, motion, with_velocities=True)
    f41, f43, torque = unknowns[:, 0:2], unknowns[:, 6:8], unknowns[:, 8]
    along = THIN_RODS.output.cg_along
    literal = along * (motion.cos_y * f43[:, 1] - motion.sin_y * f43[:, 0]) - torque
    return theta1, np.hypot(*(f41 + f43).T), np.abs(-torque - 0.01 * f43[:, 1]), np.abs(literal)


def solve_eq_9(linkage: FourBar, motion: NamedFields, with_velocities: bool = False) -> Array:
    """
    Return the nine unknowns of the paper's Eq. (9), shape (n, 9).

    They are F41, F21, F32, F43 (x, y each) and T41: three equations, Newton's and Euler's, for
    each of three links. ``with_velocities``: the force rows hold m v in place of m a.
    """
    assert linkage.bodies is not None
    size = np.size(motion.theta1)
    matrix, right = np.zeros((size, 9, 9)), np.zeros((size, 9))
    for i, (link, body, length) in enumerate(zip(('crank', 'coupler', 'output'), linkage.bodies,
                                                 linkage.lengths)):
        first, centre, end = (point_motion(linkage, motion, link, along)
                              for along in (0.0, body.cg_along, length))
        # forces i and i + 1 act on this link, the former one as a reaction, but for the ground's
        arms = [joint.place - centre.place
                for joint in ((end, first) if i == 2 else (first, end))]
        for column, sign, arm in zip((2 * i, 2 * i + 2), (1.0 if i == 0 else -1.0, 1.0), arms):
            matrix[:, 3 * i, column] = matrix[:, 3 * i + 1, column + 1] = sign
            matrix[:, 3 * i + 2, column] = -sign * arm[:, 1]
            matrix[:, 3 * i + 2, column + 1] = sign * arm[:, 0]
        right[:, 3 * i:3 * i + 2] = body.mass * (centre.velocity if with_velocities
                                                 else centre.acceleration)
        right[:, 3 * i + 2] = body.inertia * (motion.alpha1, motion.alpha_beta, motion.alpha4)[i]
    matrix[:, 2, 8] = 1.0
    return np.linalg.solve(matrix, right[..., None])[..., 0]


def eq_9() -> dict[str, float]:
    """
    Return the largest difference between Eq. (9), solved as in the paper's (10), and our loads.

    It is over a turn, relative to the largest force of it.
    """
    motion, loads = PAPER.step(np.linspace(0.0, 2.0 * pi, 361), PAPER_SPEED)
    names = ('f41_x', 'f41_y', 'f21_x', 'f21_y', 'f32_x', 'f32_y', 'f43_x', 'f43_y',
             'driving_torque')
    ours = np.stack([getattr(loads, name) for name in names], axis=1)
    return {'difference': np.abs(solve_eq_9(PAPER, motion) - ours).max() / np.abs(ours).max()}


def vectors() -> dict[str, float]:
    """
    Return the symbols of the slides' vector equations (1)-(3) and (6)-(11), in SI units.

    The two sides of an equation reach their points over different links.
    """
    return _vectors_7_3() | _vectors_7_2() | _vectors_7_5()


def _vectors_7_3() -> dict[str, float]:
    """
    Return the symbols of (1)-(3), C on its circle about D, and (6), B and C, in Example 7.3.

    p, q, r: accelerations of C and B and the vector from B to C; ``v_c``, ``a_c``: of C as a point
    of the coupler.
    """
    motion, linkage = EXAMPLE_7_3.motion(*GIVEN_7_3), EXAMPLE_7_3
    joint_b, joint_c = (point_motion(linkage, motion, 'crank', linkage.a1),
                        point_motion(linkage, motion, 'output', linkage.a3))
    c_by_coupler = point_motion(linkage, motion, 'coupler', linkage.a2)
    return {'omega': motion.omega_beta, 'alpha': motion.alpha_beta, 'omega4': motion.omega4,
            'radius': linkage.a3, 'speed': motion.omega4 * linkage.a3,
            'growth': motion.alpha4 * linkage.a3,
            **_components(p=joint_c.acceleration, q=joint_b.acceleration,
                          r=joint_c.place - joint_b.place, v_c=c_by_coupler.velocity,
                          a_c=c_by_coupler.acceleration,
                          tangent=np.array([-motion.sin_y, motion.cos_y]))}


def _vectors_7_2() -> dict[str, float]:
    """
    Return the symbols of (7), (8) and the acceleration image in Example 7.2; crank 2, coupler 3.

    ``image``: size of the acceleration of C about B over their distance; ``delta``: its turn from
    the coupler [deg].
    """
    motion, linkage = EXAMPLE_7_2.motion(*GIVEN_7_2), EXAMPLE_7_2
    joint_b, joint_c = (point_motion(linkage, motion, 'coupler', along)
                        for along in (0.0, linkage.a2))
    image = (complex(motion.slide_acceleration - joint_b.acceleration[0], -joint_b.acceleration[1])
             / complex(*(joint_c.place - joint_b.place)))
    return {'r2': linkage.a1, 'r3': linkage.a2, 's2': motion.sin_x, 'c2': motion.cos_x,
            's3': motion.sin_b, 'c3': motion.cos_b, 'w2': motion.omega1, 'al2': motion.alpha1,
            'w3': motion.omega_beta, 'al3': motion.alpha_beta, 'v4': motion.slide_velocity,
            'acc4': motion.slide_acceleration,
            'image': abs(image), 'delta': degrees(phase(image)) % 360.0}


def _vectors_7_5() -> dict[str, float]:
    """
    Return the symbols of (9)-(11), A and the point Q of the bar under it, in Example 7.5.

    ``a``, ``bar``: accelerations of A and Q; ``v``, ``rel``: velocity and acceleration of A along
    the bar.
    """
    motion, linkage = EXAMPLE_7_5.motion(*GIVEN_7_5), EXAMPLE_7_5
    joint_a, bar_point = (point_motion(linkage, motion, 'crank', linkage.a1),
                          point_motion(linkage, motion, 'output', motion.slide))
    bar = link_motion(linkage, motion, 'output')
    return {'bar_omega': motion.omega4, 'bar_alpha': motion.alpha4, 'crank_omega': motion.omega1,
            'coriolis': 2.0 * abs(motion.omega4 * motion.slide_velocity),
            **_components(crank=joint_a.place, a=joint_a.acceleration, bar=bar_point.acceleration,
                          arm=joint_a.place - (linkage.a4, 0.0),
                          v=motion.slide_velocity * bar.direction,
                          rel=motion.slide_acceleration * bar.direction)}


def _components(**vectors: Array) -> dict[str, float]:
    """Return {NAME_x: x, NAME_y: y} of named vectors."""
    return {f'{name}_{axis}': float(part) for name, vector in vectors.items()
            for axis, part in zip('xy', vector)}


def symbols() -> dict[str, float]:
    """
    Return the symbols of the slides' Eqs. (16)-(37) by name, at the pose of Example 7.6.

    a1..a4, A..D, A1..D2; v1..v4, dv, ddv are their derivatives; w1..w4 and al1..al4 those of
    theta.
    """
    motion = EXAMPLE_7_6.motion(*GIVEN_7_6)
    a1, a2, a3, a4 = EXAMPLE_7_6.lengths
    values = {'a1': a1, 'a2': a2, 'a3': a3, 'a4': a4} | bilinear_factors(a1, a2, a3, a4)._asdict()
    for number in (1, 2, 3, 4):
        values |= _half_angle(number, *(getattr(motion, f'{symbol}{number}')
                                        for symbol in ('theta', 'omega', 'alpha')))
    return values | {letter: values[f'{letter}1'] * values[f'{letter}2'] for letter in 'ABCD'}


def paper_symbols() -> dict[str, float]:
    """
    Return the symbols of the paper's Eqs. (1)-(8), in its own chain.

    The chain has theta1 + pi, -theta4, and its own factors.
    """
    values = symbols()
    a1, a2, a3, a4 = EXAMPLE_7_6.lengths
    values |= {'A1': a1 - a2 + a3 - a4, 'A2': a1 + a2 + a3 - a4, 'B1': a1 + a2 - a3 - a4,
               'B2': a1 - a2 - a3 - a4,
               'C1': a1 - a2 - a3 + a4, 'C2': a1 + a2 - a3 + a4, 'D1': a1 + a2 + a3 + a4,
               'D2': a1 - a2 + a3 + a4}
    motion = EXAMPLE_7_6.motion(*GIVEN_7_6)
    values |= (_half_angle(1, motion.theta1 + pi, motion.omega1, motion.alpha1)
               | _half_angle(4, -motion.theta4, -motion.omega4, -motion.alpha4))
    return values | {letter: values[f'{letter}1'] * values[f'{letter}2'] for letter in 'ABCD'}


def _half_angle(number: int, theta: float, omega: float, alpha: float) -> dict[str, float]:
    """
    Return the symbols of angle ``number``: v = tan(theta / 2) and its rates, omega and alpha.

    Names are v1, dv1, ddv1, w1 and al1 for angle 1.
    """
    names = f'v{number}', f'dv{number}', f'ddv{number}'
    return {**dict(zip(names, map(float, to_half_angle(theta, omega, alpha)))),
            f'w{number}': omega, f'al{number}': alpha}
