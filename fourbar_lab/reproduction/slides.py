# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
What the lecture slides print, item by item: its unit, the printed value, ours, the verdict.

Texts have the numbers of the slides: crank 2, coupler 3, output 4. Our copy lacks some pages.
"""
from cmath import phase
from collections.abc import Sequence
from math import atan, degrees, hypot, nan, pi, sqrt

from fourbar_lab.drawing.polygons import acceleration_terms
from fourbar_lab.reproduction import documents, published
from fourbar_lab.reproduction.documents import drawn, equal, printed, remark, Section, zero
from fourbar_lab.reproduction.equations import equations_of_slides, half_angle
from fourbar_lab.reproduction.published import FOOT, INCH, largest, TURN
from fourbar_ros import CROSSED, find_extrema, FourBar, Mechanism, OPEN, point_motion
from fourbar_ros.mechanisms.parts import NamedFields
from fourbar_ros.mechanisms.picture import ORIGIN
import numpy as np

FOUR_EXTREMA = (1.0, 2.0, 2.0, 2.0)    # a crank-rocker whose alpha4 has four in each mode


def sections() -> list[Section]:
    return [example_7_2(), example_7_3(), example_7_4(), example_7_5(), vectors(), contact(),
            io_equations(), example_7_6(), example_7_7(), method(), axis()]


def example_7_2() -> Section:
    # our crank pin A is their B, our B their C; of what turns or points back they print the size
    linkage, m = published.EXAMPLE_7_2, published.EXAMPLE_7_2.motion(*published.GIVEN_7_2)
    crank_pin = point_motion(linkage, m, 'coupler', 0.0)
    title = ('Slides, Example 7.2 - slider-crank, crank 2.5 in at 30 deg, coupler 6 '
             'in, 1800 rpm clockwise')
    return Section(title, [
        printed('crank angle', 'deg', '', degrees(m.theta1), documents.ASSUMED,
                'it is in the drawing only; the readings fit it to 2 %'),
        printed('crank speed', 'rad/s', '188.5', -m.omega1),
        printed('speed of B', 'ft/s', '39.3', crank_pin.speed / FOOT),
        printed('acceleration of B', 'ft/s^2', '7403', hypot(*crank_pin.acceleration) / FOOT,
                documents.ROUNDED, 'from 188.5 rad/s', within=1e-3),
        drawn('angular velocity of the coupler', 'rad/s', '68.8', m.omega_beta, 0.02),
        drawn('normal part of A_C/B', 'ft/s^2', '2367', m.omega_beta**2 * linkage.a2 / FOOT, 0.04,
              'from 68.8 rad/s, which is squared'),
        drawn('angular acceleration of the coupler', 'rad/s^2', '6640', m.alpha_beta, 0.02),
        drawn('acceleration of C', 'ft/s^2', '8000', -m.slide_acceleration / FOOT, 0.02),
        printed('acceleration of D', 'ft/s^2', '8260', nan, documents.MISSING,
                'where D is on the coupler is in the drawing only'),
    ], figure='example_7_2')


def example_7_3() -> Section:
    linkage, m = published.EXAMPLE_7_3, published.EXAMPLE_7_3.motion(*published.GIVEN_7_3)
    a_e, a_f = (hypot(*point_motion(linkage, m, *point).acceleration) / FOOT
                for point in published.POINTS_7_3.values())
    title = 'Slides, Example 7.3 - 4R of Uicker, 4, 18, 11, 10 in, crank at 120 deg, 900 rpm'
    return Section(title, [
        printed('crank angle', 'deg', '', degrees(m.theta1), documents.ASSUMED,
                'it is in the drawing only; the readings fit it to 1 % of the longest arrow'),
        printed('ground AD', 'in', '', linkage.a4 / INCH, documents.ASSUMED,
                "in the drawing only: Uicker's"),
        *(printed(f'{name}, {where}', 'in', '', value / INCH, documents.ASSUMED,
                  'in the drawing only')
          for name, first, link in (('E', 'B', 'BC'), ('F', 'D', 'DC'))
          for where, value in ((f'from {first} along {link}', published.POINTS_7_3[name][1]),
                               (f'to the right of {link}', -published.POINTS_7_3[name][2]))),
        printed('crank speed (900 rpm, in the drawing only)', 'rad/s', '94.2', m.omega1),
        printed('acceleration of B', 'ft/s^2', '2958', m.omega1**2 * linkage.a1 / FOOT,
                documents.ROUNDED, 'from 94.2 rad/s; "(94.2 rad/s^2)" stands for (94.2 rad/s)^2, '
                'in the slides or in our copy only', within=0.002),
        drawn('angular velocity of the coupler', 'rad/s', '25.6', m.omega_beta, 0.01),
        drawn('angular velocity of the output link', 'rad/s', '49.6', m.omega4, 0.01),
        drawn('normal part of A_C/B', 'ft/s^2', '983', m.omega_beta**2 * linkage.a2 / FOOT, 0.02,
              'from 25.6 rad/s'),
        drawn('normal part of A_C/D', 'ft/s^2', '2255', m.omega4**2 * linkage.a3 / FOOT, 0.01,
              'from 49.6 rad/s'),
        drawn('tangential part of A_C/B', 'ft/s^2', '160', abs(m.alpha_beta) * linkage.a2 / FOOT,
              0.2, 'the smallest arrow of a polygon of 2958 ft/s^2'),
        drawn('tangential part of A_C/D', 'ft/s^2', '1670', abs(m.alpha4) * linkage.a3 / FOOT,
              0.01),
        drawn('angular acceleration of the coupler', 'rad/s^2', '107', m.alpha_beta, 0.2,
              'from 160 ft/s^2'),
        drawn('angular acceleration of the output link, cw', 'rad/s^2', '1822', -m.alpha4, 0.01),
        drawn('acceleration of E', 'ft/s^2', '2580', a_e, 0.02),
        drawn('acceleration of F', 'ft/s^2', '1960', a_f, 0.02),
    ], figure='example_7_3')


def example_7_4() -> Section:
    # the rod at 45 deg, at 50 rad/s ccw, the slider 0.5 m out and moving outwards at 30 m/s
    out = np.array([np.cos(pi / 4.0), np.sin(pi / 4.0)])
    terms = acceleration_terms(ORIGIN, 50.0, 0.0, 0.5 * out, 30.0 * out)
    x, y = np.sum(terms, axis=0)
    return Section('Slides, Example 7.4 - slider on a turning rod', [
        printed('normal acceleration', 'm/s^2', '1250', hypot(*terms.normal)),
        printed('Coriolis acceleration', 'm/s^2', '3000', hypot(*terms.coriolis)),
        printed('acceleration of A', 'm/s^2', '3250', hypot(x, y)),
        printed('its angle with the horizontal', 'deg', '22.4', degrees(pi - np.arctan2(y, x))),
    ])


def example_7_5() -> Section:
    linkage, m = published.EXAMPLE_7_5, published.EXAMPLE_7_5.motion(*published.GIVEN_7_5)
    coriolis = -2.0 * m.omega4 * m.slide_velocity
    title = ('Slides, Example 7.5 - inverted slider-crank, crank 3 in at 30 deg, '
             'ground 14 in, no offset, 36 rad/s clockwise')
    return Section(title, [
        printed('crank angle', 'deg', '', degrees(m.theta1), documents.ASSUMED,
                'it is in the drawing only; the readings fit it to 3 %'),
        printed('distance of D from the line of A', 'in', '', linkage.offset / INCH,
                documents.ASSUMED, 'in the drawing only: omega4 is 1.3 % off without, 12 or 15 % '
                'off with the 2 in of AB'),
        printed('speed of A', 'ft/s', '9', -m.omega1 * linkage.a1 / FOOT),
        drawn('speed of Q', 'ft/s', '7.24', m.omega4 * m.slide / FOOT, 0.03),
        drawn('relative velocity', 'ft/s', '5.52', -m.slide_velocity / FOOT, 0.03),
        drawn('angular velocity of the bar', 'rad/s', '7.55', m.omega4, 0.03),
        printed('distance QD', 'in', '11.5', m.slide / INCH),
        drawn('distance QD in the last line', 'in', '11.6', m.slide / INCH, 0.01, '11.5 in (E3)'),
        printed('acceleration of A', 'ft/s^2', '324', m.omega1**2 * linkage.a1 / FOOT),
        drawn('normal part of A_Q/D', 'ft/s^2', '54.6', m.omega4**2 * m.slide / FOOT, 0.03),
        drawn('Coriolis acceleration', 'ft/s^2', '83.4', coriolis / FOOT, 0.03),
        drawn('tangential part of A_Q/D', 'ft/s^2', '274', m.alpha4 * m.slide / FOOT, 0.03),
        drawn('angular acceleration of the bar', 'rad/s^2', '283', m.alpha4, 0.03),
    ], figure='example_7_5')


def vectors() -> Section:
    """Both sides of an equation, as complex numbers, reach their points over different links."""
    title = ('Slides, Eqs. (1)-(3), (6), (7), (9)-(11), (E1)-(E4), the acceleration '
             'image and the complex polar formulas, at the poses of Examples 7.3, 7.2, 7.5')

    def moved(linkage: Mechanism, motion: NamedFields, link: str, along: float
              ) -> tuple[complex, complex, complex]:
        """Return position, velocity and acceleration of a point of a link, x + i y each."""
        point = point_motion(linkage, motion, link, along)
        return complex(*point.place), complex(*point.velocity), complex(*point.acceleration)

    # C on its circle about D, B and C, in Example 7.3
    linkage, m = published.EXAMPLE_7_3, published.EXAMPLE_7_3.motion(*published.GIVEN_7_3)
    b, _, a_b = moved(linkage, m, 'crank', linkage.a1)
    c, _, a_c = moved(linkage, m, 'output', linkage.a3)
    _, v_of_coupler, a_of_coupler = moved(linkage, m, 'coupler', linkage.a2)
    arm, r = c - linkage.a4, c - b
    rows = [
        zero('Eq. (1), of C of Example 7.3 on its circle about D', v_of_coupler,
             -1j * m.omega4 * arm),
        zero('Eqs. (2) and (3)', a_of_coupler, -1j * m.alpha4 * arm, m.omega4**2 * arm),
        zero('Eq. (6), of C and B', a_c, -a_b, -1j * m.alpha_beta * r, m.omega_beta**2 * r),
    ]

    # the acceleration image in Example 7.2
    slider, m = published.EXAMPLE_7_2, published.EXAMPLE_7_2.motion(*published.GIVEN_7_2)
    r2, r3, w2, w3, al2, al3 = slider.a1, slider.a2, m.omega1, m.omega_beta, m.alpha1, m.alpha_beta
    s2, c2, s3, c3 = m.sin_x, m.cos_x, m.sin_b, m.cos_b
    (b, _, a_b), (c, _, _) = (moved(slider, m, 'coupler', along) for along in (0.0, r3))
    image = (m.slide_acceleration - a_b) / (c - b)
    rows += [
        equal('acceleration image of Example 7.2, its angle delta', 'deg',
              180 - degrees(atan(al3 / w3**2)), degrees(phase(image)) % 360.0,
              why='7.2 asks for it and prints no number: the angle from C/B to A_C/B'),
        equal('acceleration image, its factor', '1/s^2', sqrt(w3**4 + al3**2), abs(image),
              why='A_C/B over C/B; the slides send to Example 7.1, which our copy lacks'),
        zero('Eq. (7)', 1j * r2 * w2 * complex(c2, s2), 1j * r3 * w3 * complex(c3, s3),
             -m.slide_velocity),
        equal('alpha3 of a slider-crank', '',
              (r2 * w2**2 * s2 - r2 * al2 * c2 + r3 * w3**2 * s3) / (r3 * c3), al3),
        equal('a4 of a slider-crank', '',
              -r2 * w2**2 * c2 - r2 * al2 * s2 - r3 * w3**2 * c3 - r3 * al3 * s3,
              m.slide_acceleration),
    ]

    # A and the point Q of the bar under it, in Example 7.5
    inverted, m = published.EXAMPLE_7_5, published.EXAMPLE_7_5.motion(*published.GIVEN_7_5)
    a, _, a_a = moved(inverted, m, 'crank', inverted.a1)
    _, _, a_q = moved(inverted, m, 'output', m.slide)
    bar, arm = complex(*inverted.link_motion(m, 'output').direction), a - inverted.a4
    coriolis, rel = -2j * m.omega4 * m.slide_velocity * bar, m.slide_acceleration * bar
    tangential, normal = -1j * m.alpha4 * arm, m.omega4**2 * arm
    return Section(title, [
        *rows,
        zero('Eqs. (9), (10)', a_a, tangential, normal, coriolis, -rel),
        zero('Eq. (11)', a_a, -a_q, coriolis, -rel),
        zero('Eq. (E1)', a_a, -a_q, coriolis, -rel,
             why='E1 is Eq. (11), although the slides name Eq. (10)'),
        zero('Eq. (E2)', a_a, m.omega1**2 * a),
        zero('Eq. (E3)', a_q, normal, tangential),
        equal('Eq. (E4)', 'm/s^2', abs(coriolis), 2.0 * abs(m.omega4 * m.slide_velocity)),
    ])


def contact() -> Section:
    title = ('Slides, Eq. (12), at the pose of Example 7.6; Eqs. (13)-(15), of a '
             'disc of our own, 0.3 m, 4 rad/s, 2 rad/s^2, on flat ground')
    m, radius, w, al = published.EXAMPLE_7_6.motion(*published.GIVEN_7_6), 0.3, 4.0, 2.0
    centre, p2 = -al * radius, -1j * radius             # acceleration of C; P2 seen from C
    # of the cycloid r (phi - sin phi, 1 - cos phi), phi clockwise, at phi = 0
    cycloid = 1j * radius * w**2
    return Section(title, [
        zero('Eq. (12), of crank 2 and coupler 3', m.alpha_beta, -m.alpha1, -m.alpha2),
        zero('Eqs. (13) and (14): the rolling acceleration', centre, 1j * al * p2, -w**2 * p2,
             -cycloid, why='against the second derivative of the cycloid'),
        zero('Eq. (15), along the ground', centre, al * radius,
             why='on the ground both points have none'),
        zero('Eq. (15), square to it', -w**2 * radius, verdict=documents.MISPRINT,
             why="P1 for P2: the disc's point has the right side, P1 of the ground rests",
             correct=[cycloid, w**2 * p2]),
    ])


def io_equations() -> Section:
    title = ('Slides, Eqs. (16)-(37), at the pose of Example 7.6 (left sides over '
             'the sum of their terms)')
    linkage = published.EXAMPLE_7_6
    m, (_, a2, _, a4) = linkage.motion(*published.GIVEN_7_6), linkage.lengths
    angles = {n: half_angle(*(getattr(m, f'{symbol}{n}') for symbol in ('theta', 'omega',
                                                                        'alpha')))
              for n in (1, 2, 3, 4)}
    position, ratio, acceleration = [], [], []
    for name, equation in equations_of_slides(linkage.lengths).items():
        a, b = angles[equation.i], angles[equation.j]
        position.append(zero(f'Eq. ({name})', *equation.position(a, b)))
        ratio.append(equal(f'Eq. ({name + 6})', '', equation.ratio(a, b), b.omega / a.omega))
        acceleration.append(zero(f'Eq. ({name + 12})', *equation.acceleration(a, b),
                                 why='"= 0" is missing in (28)-(33)' if name == 16 else ''))
        if name == 19:
            ratio[-1] = equal(
                'Eq. (25)', '', equation._replace(mixed=-8 * a2 * a4).ratio(a, b),
                b.omega / a.omega, documents.MISPRINT, '4 a2 a4 for 4 a1 a3, twice',
                correct=equation.ratio(a, b))
            right = equation.acceleration(a, b)
            acceleration[-1] = zero(
                'Eq. (31)', *right[:2], (equation.both * b.v**2 + equation.second) * a.dv**2,
                *right[3:], verdict=documents.MISPRINT,
                why='A2 D1 for A1 D2 in the factor of the square of dv2/dt', correct=right)
        if name == 21:
            acceleration[-1] = zero(
                'Eq. (33)', *equation._replace(mixed=8 * a2 * a4).acceleration(a, b),
                verdict=documents.MISPRINT, why='three times + for - before a2 a4',
                correct=equation.acceleration(a, b))
    b = angles[4]
    return Section(title, [
        *position, *ratio, *acceleration,
        equal('Eq. (34)', '', b.omega * (1 + b.v**2) / 2, b.dv),
        equal('Eq. (35)', '', 2 * b.dv / (1 + b.v**2), b.omega),
        equal('Eq. (36)', '', (b.alpha + b.omega**2 * b.v) * (1 + b.v**2) / 2, b.ddv),
        equal('Eq. (37)', '', 2 * b.ddv / (1 + b.v**2) - b.omega**2 * b.v, b.alpha),
    ])


def example_7_6() -> Section:
    m, crossed = (published.EXAMPLE_7_6.in_mode(mode).motion(*published.GIVEN_7_6)
                  for mode in (OPEN, CROSSED))
    v2, v4 = (half_angle(m.theta2, m.omega2, m.alpha2), half_angle(m.theta4, m.omega4, m.alpha4))
    theta2, crossed_theta2 = degrees(m.theta2), degrees(crossed.theta2)
    title = 'Slides, Example 7.6 - 4R 8, 14, 9, 17, crank at 60 deg, 10 rad/s, 100 rad/s^2'
    return Section(title, [
        printed('v2', '', '-0.4840', v2.v),
        printed('v2, the other mode', '', '-1.8988', half_angle(crossed.theta2).v),
        printed('theta2', 'deg', '-51.6569', theta2),
        printed('theta2, the other mode', 'deg', '-124.4528', crossed_theta2),
        printed('theta2 as a positive angle', 'deg', '308.3430', theta2 % 360.0),
        printed('the same, the other mode', 'deg', '235.5472', crossed_theta2 % 360.0),
        printed("theta2''", 'deg', '128.3430', theta2 % 360.0 - 180.0),
        printed("theta2' (coupler against the ground)", 'deg', '8.3430', degrees(m.beta)),
        printed('v4', '', '0.9094', v4.v),
        printed('v4, the other mode', '', '-2.7989', half_angle(crossed.theta4).v),
        printed('theta4', 'deg', '84.5689', degrees(m.theta4)),
        printed('theta4, the other mode', 'deg', '-140.6787', degrees(crossed.theta4)),
        printed('dv4/dt', '1/s', '6.5574', v4.dv),
        printed('omega4', 'rad/s', '7.1781', m.omega4),
        printed('omega2 (of the coupler)', 'rad/s', '-2.4463', m.omega_beta),
        printed('dv2/dt', '1/s', '-7.6811', v2.dv),
        printed('dtheta2/dt', 'rad/s', '-12.4463', m.omega2),
        printed('d2v4/dt2', '1/s^2', '157.4654', v4.ddv),
        printed('alpha4', 'rad/s^2', '125.5109', m.alpha4),
        printed('alpha2 (of the coupler)', 'rad/s^2', '-3.5916', m.alpha_beta),
        printed('dv2/dt on the last page', '1/s', '-110.2051', v2.dv, documents.GARBLED,
                'it is d2v2/dt2, as its sentence says; our copy drops dots there'),
        printed('d2v2/dt2', '1/s^2', '-110.2051', v2.ddv),
        printed('d2theta2/dt2', 'rad/s^2', '-103.5916', m.alpha2),
    ], figure='example_7_6')


def example_7_7() -> Section:
    eq_38 = equations_of_slides(published.EXAMPLE_7_7.lengths)[16]

    def extreme(mode: int, quantity: str, kind: str) -> tuple[float, float]:
        """Return the value of an extremum and its theta1 [deg]."""
        extremum = published.extreme(published.EXAMPLE_7_7.in_mode(mode), quantity, kind, 10.0)
        return extremum.value, degrees(extremum.theta1)

    (low, theta1_low), (high, theta1_high) = (extreme(OPEN, 'omega4', kind)
                                              for kind in ('minimum', 'maximum'))
    (most_1, theta1_most_1), (least_1, theta1_least_1) = (extreme(CROSSED, 'alpha4', kind)
                                                          for kind in ('maximum', 'minimum'))
    (most_2, theta1_most_2), (least_2, theta1_least_2) = (extreme(OPEN, 'alpha4', kind)
                                                          for kind in ('maximum', 'minimum'))
    mirrored = 'said of both modes; mode 1 is the mirror image of mode 2'
    return Section('Slides, Example 7.7 - crank-rocker 2, 6, 7, 5 at 10 rad/s', [
        printed('Eq. (38), factor of v1^2 v4^2', '', '-36', eq_38.both),
        printed('Eq. (38), of v1^2', '', '160', eq_38.first),
        printed('Eq. (38), of -v1 v4', '', '112', -eq_38.mixed),
        printed('Eq. (38), of -v4^2', '', '20', -eq_38.second),
        printed('Eq. (38), constant', '', '64', eq_38.constant),
        printed('least omega4, both modes', 'rad/s', '-6.6959', low),
        printed('its theta1, mode 2', 'deg', '2.6810', theta1_low),
        printed('its theta1, mode 1', 'deg', '2.6810',
                extreme(CROSSED, 'omega4', 'minimum')[1] - 360.0, documents.MISPRINT, mirrored),
        printed('largest omega4, both modes', 'rad/s', '3.2493', high),
        printed('its theta1, mode 2', 'deg', '138.9638', theta1_high),
        printed('its theta1, mode 1', 'deg', '138.9638',
                extreme(CROSSED, 'omega4', 'maximum')[1] - 360.0, documents.MISPRINT, mirrored),
        printed('mode 1, largest alpha4', 'rad/s^2', '68.7731', most_1),
        printed('  its theta1', 'deg', '24.6475', theta1_most_1),
        printed('  listed again as', 'deg', '-335.3525', theta1_most_1 - 360.0,
                why="the same angle; the polynomial's other two roots belong to mode 2"),
        printed('mode 1, least alpha4', 'rad/s^2', '-87.9671', least_1),
        printed('  its theta1', 'deg', '326.1382', theta1_least_1),
        printed('  listed again as', 'deg', '-33.8618', theta1_least_1 - 360.0,
                why='the same angle'),
        printed('mode 2, largest alpha4', 'rad/s^2', '87.9671', most_2),
        printed('  its theta1', 'deg', '33.8616', theta1_most_2, documents.MISPRINT,
                '33.8618, as two pages earlier'),
        printed('mode 2, least alpha4', 'rad/s^2', '-68.7731', least_2),
        printed('  its theta1', 'deg', '335.3525', theta1_least_2),
    ], figure='example_7_7')


def degree_at_extrema(lengths: Sequence[float]) -> int:
    """
    Return the degree in v1 of the equation of the extrema of alpha4, for whole lengths.

    Two for each root but zero of a polynomial in q = |A O4|^2. With e = a1^2 - a4^2, f = a2^2 -
    a3^2, S = ((a1+a4)^2 - q)(q - (a1-a4)^2) and T = ((a2+a3)^2 - q)(q - (a2-a3)^2)

        theta4''' = [e (4 S - q S_q) + s rS M/T^(5/2)]/(4 q^3),   rS^2 = S,   s = 1 or -1
        M = 2 q T R_q - 4 R T - 3 q R T_q,   R = -f S T + q (q+f)(S_q T - S T_q)/2
    """
    a1, a2, a3, a4 = map(int, lengths)
    e, f = a1 * a1 - a4 * a4, a2 * a2 - a3 * a3

    def polynomial(*c: int) -> np.poly1d:
        return np.poly1d(np.array(c, dtype=object))     # whole numbers of any size
    q = polynomial(1, 0)
    S = polynomial(-1, (a1 + a4)**2) * polynomial(1, -(a1 - a4)**2)
    T = polynomial(-1, (a2 + a3)**2) * polynomial(1, -(a2 - a3)**2)
    R2 = -2 * f * (S * T) + q * polynomial(1, f) * (S.deriv() * T - S * T.deriv())     # 2 R
    M2 = 2 * q * T * R2.deriv() - 4 * R2 * T - 3 * q * R2 * T.deriv()
    W = 4 * S - q * S.deriv()
    c = (4 * e * e * W * W * T**5 - S * M2 * M2).c
    return 2 * int(np.ptp(np.flatnonzero(c)))


def method() -> Section:
    linkage, speed = published.EXAMPLE_7_7, 10.0
    motion, mirrored = linkage.motion(TURN, speed), linkage.in_mode(CROSSED).motion(-TURN, speed)
    degree = degree_at_extrema(linkage.lengths)
    in_a_mode, most = (len(find_extrema(mechanism, ('alpha4',), speed))
                       for mechanism in (linkage, FourBar(*FOUR_EXTREMA)))
    by_rate, by_acceleration = (published.at_extrema(linkage, name, speed)
                                for name in ('omega4', 'alpha4'))
    return Section('Slides, steps 1 to 9 of the method and items 1 to 17 of Example 7.7', [
        *published.steps(linkage, speed, ('step 1: theta4 of theta1 alone', 'step 2: its rate',
                         'steps 3, 4, 5: its acceleration at constant rate')),
        equal('steps 6, 7: the derivative at the extrema of alpha4', '',
              published.slope(linkage, 'alpha4', by_acceleration.theta1), 0.0,
              why='over the largest alpha4, both at 1 rad/s'),
        equal('step 8, item 11: degree of the equation', '', 22, degree),
        equal('step 8, item 11: real values', '', 4, 2 * in_a_mode, why='two in each mode'),
        equal('step 8: complex values', '', 18, degree - 2 * in_a_mode),
        equal('step 9, items 5, 12, 13: two critical values in a mode', '', 2, in_a_mode),
        equal('the same as a general statement: links 1, 2, 2, 2 have', '', most, 4.0,
              documents.ANSWERED, 'omega4 of a crank-rocker always has two in a mode in 100,000 '
              'random ones; alpha4 two or four'),
        equal('item 1: a crank that turns fully', '', 1, linkage.turns_fully),
        remark('item 2: Eq. (38)', documents.DEFINED, 'compared under Example 7.7'),
        remark('items 3, 6: both profiles', documents.DEFINED,
               'figures; the curves are drawn from steps 2 and 4'),
        equal('item 4: the velocity of mode 2 is that of mode 1 mirrored', '',
              largest(motion.omega4 - mirrored.omega4) / largest(motion.omega4), 0.0,
              why='over the largest value'),
        remark('items 7, 8, 9, 10: the method again', documents.DEFINED, 'steps 3 to 7'),
        remark('item 14: velocity over acceleration', documents.DEFINED,
               'the figure of Example 7.7'),
        equal('item 15: alpha4 = 0 at the extrema of omega4', '',
              largest(by_rate.alpha4) / largest(motion.alpha4), 0.0,
              why='over the largest alpha4'),
        equal('items 13, 16: alpha4 of mode 2 mirrored is that of mode 1 with the other sign', '',
              largest(motion.alpha4 + mirrored.alpha4) / largest(motion.alpha4), 0.0,
              documents.ANSWERED, 'the linkage of mode 2 is the mirror image: theta4 is odd in '
              'theta1 between the modes, its rate even, alpha4 odd'),
    ])


def axis() -> Section:
    proof = '; docs/extrema.md derives it, test_collineation.py finds no exception'
    return Section('Slides, items 16 and 17 - why the extremes lie where they lie', [
        remark('item 16: at the extrema of omega4', documents.ANSWERED,
               'the collineation axis, through the poles P13 and P24, is square to the coupler'
               + proof),
        remark('item 16: at the extrema of alpha4', documents.ANSWERED,
               'd(tan l)/d(theta1) = 1 - 2 R, but for R = 0 and 1, l the angle from coupler to '
               'axis, R = omega4/omega1' + proof),
        remark('item 17: the research asked for', documents.ANSWERED,
               'both statements of item 16'),
    ])
