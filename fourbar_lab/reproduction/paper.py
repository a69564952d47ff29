# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
What the paper prints, item by item: its unit, the printed value, ours, and the verdict.

Our copy garbles some cells of its tables.
"""
from math import degrees, pi, tau
from typing import Any

from fourbar_lab.reproduction import documents, published, slides
from fourbar_lab.reproduction.documents import equal, printed, remark, Row, Section, WRONG, zero
from fourbar_lab.reproduction.equations import equations_of_paper, half_angle
from fourbar_lab.reproduction.published import PAPER_SPEED, THIN
from fourbar_ros import CROSSED, OPEN, plain
from fourbar_ros.extrema.over_input import OverInput
from fourbar_ros.mechanisms.parts import NamedFields
from fourbar_ros.numerics.number_types import Scalar
import numpy as np

UNKNOWNS = ('f41_x', 'f41_y', 'f21_x', 'f21_y', 'f32_x', 'f32_y', 'f43_x', 'f43_y',
            'driving_torque')                   # of Eq. (9)
LOST: dict[str, Any] = {'verdict': documents.ROUNDED, 'why': 'digits lost in the search',
                        'within': 1e-9}
WRONG_MOMENT = ('m v again, and an arm of 0.01 m; the moment on the ground about O1 needs O4 - O1 '
                '= 1 m, the formula as it is printed r34 from CG3')


def reproduce() -> list[Section]:
    """Return the tables of the slides and of the paper: each printed value beside ours."""
    return [*slides.sections(), io_equations(), algorithms(), table_1(), table_2(), eq_9(),
            table_3(), last_question(), definitions()]


def io_equations() -> Section:
    title = 'Paper, Eqs. (1)-(8), in its own chain and factors, at the pose of Example 7.6'
    m = published.EXAMPLE_7_6.motion(*published.GIVEN_7_6)
    angles = {1: half_angle(m.theta1 + pi, m.omega1, m.alpha1),
              2: half_angle(m.theta2), 3: half_angle(m.theta3),
              4: half_angle(-m.theta4, -m.omega4, -m.alpha4)}
    equations = equations_of_paper(published.EXAMPLE_7_6.lengths)
    a, b, first = angles[1], angles[4], equations[1]
    return Section(title, [
        *(zero(f'Eq. ({name})', *equation.position(angles[equation.i], angles[equation.j]),
               why='all angles relative: theta1 + pi, -theta4; the tables are for absolute angles'
               if name == 1 else '') for name, equation in equations.items()),
        zero('Eq. (7)', *first.velocity(a, b)),
        equal('first derivative of v', '', b.omega * (1 + b.v**2) / 2, b.dv),
        equal('second derivative of v', '', (b.alpha + b.omega**2) * (1 + b.v**2) / 2, b.ddv,
              documents.MISPRINT, 'the square of the rate needs a factor v',
              correct=(b.alpha + b.omega**2 * b.v) * (1 + b.v**2) / 2),
        zero('Eq. (8)', *first.acceleration(a, b)),
    ])


def algorithms() -> Section:
    title = 'Paper, algorithms of extreme angular velocity and acceleration, on its linkage'
    linkage, speed = published.PAPER, PAPER_SPEED
    by_rate, by_acceleration = (published.at_extrema(linkage, name, speed)
                                for name in ('omega4', 'alpha4'))
    position, rate, acceleration = published.steps(linkage, speed, (
        'velocity, step 1, and acceleration, step 1',
        'velocity, step 2, and acceleration, step 2', 'acceleration, steps 3, 4'))
    return Section(title, [
        position, rate,
        equal('velocity, step 3', '', published.slope(linkage, 'omega4', by_rate.theta1), 0.0,
              why='the derivative at the extrema, at 1 rad/s'),
        acceleration,
        equal('acceleration, step 5', '', published.largest(by_acceleration.omega4) / speed, 0.0,
              documents.MISPRINT, 'd(theta_j)/d(theta_i) for the derivative of its acceleration: '
              'theta_j does not stall there',
              correct=published.slope(linkage, 'alpha4', by_acceleration.theta1)),
    ])


def table_1() -> Section:
    return Section('Paper, Table 1 - masses (round steel rods of radius 0.01 m)', [
        printed(item, 'kg', text, rod.mass) for rod, item, text in zip(
            published.RODS, ('m1 = 31 pi/100', 'm2 = 93 pi/100', 'm3 = 31 pi/50'),
            ('0.97389372261284', '2.92168116783851', '1.94778744522567'))])


def table_2() -> Section:
    return Section('Paper, Table 2 and Figure 3 - extrema at 25 rad/s', [
        *_extremum(CROSSED, 'omega4', 'minimum', '-23.95938176', '0.36933536508', '21.16135764',
                   ('rad',), '" 22.05028176", "-23.93938170" and " 23 05038176"'),
        *_extremum(CROSSED, 'omega4', 'maximum', '13.51343678', '-1.667165012', '-95.52151894',
                   ('rad', 'deg'), '"13 513/3678" and "15.51545078"'),
        *_extremum(CROSSED, 'alpha4', 'maximum', '462.6986574', '0.8382412814', '48.02768764',
                   ('value',)),
        *_extremum(CROSSED, 'alpha4', 'minimum', '-1062.775829', '-0.1482557001', '-8.494425904',
                   ('deg',)),
        *_extremum(OPEN, 'omega4', 'maximum', '13.51343678', '1.667165012', '95.52151894',
                   ('rad', 'deg'), '"13 51343678" and "15.51545070"'),
        *_extremum(OPEN, 'omega4', 'minimum', '-23.95938176', '5.913849943', '338.8386424',
                   ('rad',), '" 22.05028176", "-23.93938170" and " 23 05038176"'),
        *_extremum(OPEN, 'alpha4', 'maximum', '1062.775829', '0.1482557001', '8.494425904',
                   ('deg',), '"1062 775829" and "1002.775029"'),
        *_extremum(OPEN, 'alpha4', 'minimum', '-462.6986574', '5.444944024', '311.9723124',
                   ('rad',), '" 162 6086571" and "-402.0980374"'),
    ], figure='paper_figure_3')


def _extremum(mode: int, quantity: str, kind: str, value: str, in_radians: str,
              in_degrees: str, lost: tuple[str, ...], copies: str = '') -> list[Row]:
    """Return the Rows of one extremum of Table 2: its value, and its theta1 in rad and deg."""
    # lost names those of 'value', 'rad' and 'deg' that lost digits in the search; copies quotes
    # the garbled copies of the value.
    extremum = published.extreme(published.PAPER.in_mode(mode), quantity, kind, PAPER_SPEED)
    theta1 = extremum.theta1 - tau if in_radians.startswith('-') else extremum.theta1
    how: dict[str, Any] = LOST if 'value' in lost else {}
    if copies:
        how = {'verdict': documents.GARBLED, 'why': f'the copy has {copies}', 'within': 2e-9}
    return [printed(f'mode {mode}, {quantity}', 'rad/s' if quantity == 'omega4' else 'rad/s^2',
                    value, extremum.value, **how),
            printed('  its theta1', 'rad', in_radians, theta1, **(LOST if 'rad' in lost else {})),
            printed('  its theta1', 'deg', in_degrees, degrees(theta1),
                    **(LOST if 'deg' in lost else {}))]


def eq_9() -> Section:
    motion, loads = published.PAPER.step(np.linspace(0.0, tau, 361), PAPER_SPEED)
    ours = np.stack([getattr(loads, name) for name in UNKNOWNS], axis=1)
    by_eq_9 = plain.loads(published.PAPER.lengths, published.RODS, motion)
    miss = published.largest(np.stack(by_eq_9[:len(UNKNOWNS)], axis=1) - ours)
    return Section('Paper, Eqs. (9) and (10), over a turn of its example', [
        equal('Eqs. (9) and (10): the nine unknowns, beside our closed forms', '',
              miss / published.largest(ours), 0.0,
              why='largest difference over the largest force'),
    ])


def literal_moment(motion: NamedFields, loads: NamedFields) -> Scalar:
    """Return T14 + r34 x F34 [N m] with the arm r34 of Fig. 2, from CG3 to joint 4."""
    along = published.THIN_RODS.output.cg_along
    moment: Scalar = (along * (motion.cos_y * loads.f43_y - motion.sin_y * loads.f43_x)
                      - loads.driving_torque)
    return moment


def table_3() -> Section:
    force, moment, literal, solid = (
        published.largest_extremum(linkage, quantity, PAPER_SPEED) for linkage, quantity in (
            (THIN, 'shaking_force'), (THIN, 'shaking_moment'), (THIN, literal_moment),
            (published.PAPER, 'shaking_moment')))
    wrong = published.wrong_curves()
    theta1_force, theta1_moment = (wrong.theta1[curve.argmax()]
                                   for curve in (wrong.force, wrong.moment))
    rate = published.extreme(published.PAPER, 'omega4', 'minimum', PAPER_SPEED)
    grid = 'on a grid of 0.1 deg, to the last digit'
    return Section('Paper, Table 3 and Figure 4 - shaking force and moment, mode 2', [
        printed('largest shaking force', 'N', '56.9764', abs(force.value), WRONG,
                'it is the largest momentum: Eq. (9) was given m v in place of m a'),
        printed('  its theta1', 'rad', '5.7299', force.theta1, WRONG, 'that of the momentum'),
        printed('largest shaking moment about O1 (thin rods)', 'N m', '154.9566',
                abs(moment.value), WRONG, WRONG_MOMENT),
        printed('  its theta1', 'rad', '5.7352', moment.theta1, WRONG, WRONG_MOMENT),
        printed('the same for solid rods', 'N m', '154.9566', abs(solid.value), WRONG,
                WRONG_MOMENT),
        printed('T14 + r34 x F34 with r34 of Fig. 2, from CG3', 'N m', '154.9566',
                abs(literal.value), WRONG, WRONG_MOMENT),
        printed('  its theta1', 'rad', '5.7352', literal.theta1, WRONG, WRONG_MOMENT),
        printed('the same with m v', 'kg m^2/s', '154.9566', wrong.literal_moment.max(), WRONG,
                WRONG_MOMENT),
        printed('the force with m v', 'kg m/s', '56.9764', wrong.force.max(), why=grid),
        printed('  its theta1', 'rad', '5.7299', theta1_force),
        printed('the moment with m v and 0.01 m (thin rods)', '', '154.9566', wrong.moment.max(),
                why=f'{grid}; that 0.01 m is the radius of the rods is our inference'),
        printed('  its theta1', 'rad', '5.7352', theta1_moment),
        printed('least omega4 in the text', 'rad/s', '-23.9594', rate.value),
        printed('  its theta1', 'rad', '5.9138', rate.theta1),
        printed('from there to the largest force', '%', '3.2', 100 * (5.9138 - 5.7299) / 5.7299,
                why='of the two angles it prints; it depends on where angles are counted from: '
                'they are 10.5 deg apart. The true force peaks 27.4 deg from the extreme '
                'rate, 2.2 deg from the largest alpha4'),
    ], figure='paper_figure_4')


def last_question() -> Section:
    """Test the paper's claim that extreme alpha4 implies extreme shaking."""
    title = ('Paper, its question - do extreme angular velocity and acceleration '
             'imply extreme shaking?')
    theta1 = published.largest_extremum(THIN, 'alpha4', 1.0).theta1
    linkage = published.counterweighted(THIN, theta1)
    peak = OverInput(linkage, 'shaking_force').peak
    return Section(title, [
        equal('force at the largest alpha4 over its peak, with a counterweight on the crank', '',
              linkage.loads(theta1, 1.0).shaking_force / peak, 0.0, documents.ANSWERED,
              'no: 5 kg on the crank of any linkage can cancel the force in one pose '
              '(docs/extrema.md)'),
    ])


def definitions() -> Section:
    return Section('Definitions, and what is not compared', [
        remark('Slides, Eqs. (4), (5), (8)', documents.MISSING, 'our copy lacks them'),
        remark('Slides, Example 7.1', documents.MISSING, 'named, not printed'),
        remark('Paper, Figures 1, 2', documents.DEFINED, 'they define symbols'),
    ])
