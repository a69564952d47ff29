# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
What the two documents print, item by item: what, the unit, printed, ours, and the verdict.

Ours come from :mod:`fourbar_lab.reproduction.published` and ``statements``; equations are written
in the symbols of these. Our copy of the slides lacks some pages, and garbles cells of the paper.
"""
from __future__ import annotations

from math import atan, degrees, nan, sqrt

from fourbar_lab.reproduction import published, statements
from fourbar_lab.reproduction.documents import equal, number, Section, zero
from fourbar_lab.reproduction.verdicts import (
    ANSWERED,
    ASSUMED,
    DEFINED,
    DRAWN,
    GARBLED,
    MISPRINT,
    MISSING,
    ROUNDED,
    WRONG,
)


def reproduce() -> list[Section]:
    """Return every :class:`Section`, computed now."""
    return [
        example_7_2(),
        example_7_3(),
        example_7_4(),
        example_7_5(),
        vectors(**published.vectors()),
        contact(**statements.contact()),
        symbols(**published.symbols()),
        example_7_6(),
        example_7_7(),
        method(**statements.method()),
        axis(**statements.axis()),
        paper_symbols(**published.paper_symbols()),
        algorithms(**statements.algorithms()),
        paper_table_1(),
        paper_table_2(),
        eq_9(**published.eq_9()),
        paper_table_3(),
        last_question(**statements.last_question()),
        definitions(),
    ]


def example_7_2() -> Section:
    ours = published.example_7_2()
    title = ('Slides, Example 7.2 - slider-crank, crank 2.5 in at 30 deg, coupler 6 '
             'in, 1800 rpm clockwise')
    return Section(title, [
        number('crank angle', 'deg', '', ours['angle'], ASSUMED,
               'it is in the drawing only; the readings fit it to 2 %'),
        number('crank speed', 'rad/s', '188.5', ours['omega2']),
        number('speed of B', 'ft/s', '39.3', ours['v_b']),
        number('acceleration of B', 'ft/s^2', '7403', ours['a_b'], ROUNDED, 'from 188.5 rad/s',
               within=1e-3, own=188.5**2 * 2.5 / 12),
        number('angular velocity of the coupler', 'rad/s', '68.8', ours['omega3'], DRAWN,
               within=0.02),
        number('normal part of A_C/B', 'ft/s^2', '2367', ours['normal'], DRAWN,
               'from 68.8 rad/s, which is squared', within=0.04, own=68.8**2 * 0.5),
        number('angular acceleration of the coupler', 'rad/s^2', '6640', ours['alpha3'], DRAWN,
               within=0.02, own=1.66 * 2000 / 0.5),
        number('acceleration of C', 'ft/s^2', '8000', ours['a_c'], DRAWN, within=0.02,
               own=4 * 2000),
        number('acceleration of D', 'ft/s^2', '8260', nan, MISSING,
               'where D is on the coupler is in the drawing only'),
    ], figure='example_7_2')


def example_7_3() -> Section:
    ours = published.example_7_3()
    title = ('Slides, Example 7.3 - 4R of Uicker, 4, 18, 11, 10 in, crank at 120 '
             'deg, 900 rpm')
    return Section(title, [
        number('crank angle', 'deg', '', ours['angle'], ASSUMED,
               'it is in the drawing only; the readings fit it to 1 % of the longest arrow'),
        number('ground AD', 'in', '', ours['ground'], ASSUMED, "in the drawing only: Uicker's"),
        number('E, from B along BC', 'in', '', ours['e_along'], ASSUMED, 'in the drawing only'),
        number('E, to the right of BC', 'in', '', ours['e_across'], ASSUMED,
               'in the drawing only'),
        number('F, from D along DC', 'in', '', ours['f_along'], ASSUMED, 'in the drawing only'),
        number('F, to the right of DC', 'in', '', ours['f_across'], ASSUMED,
               'in the drawing only'),
        number('crank speed (900 rpm, in the drawing only)', 'rad/s', '94.2', ours['omega2']),
        number('acceleration of B', 'ft/s^2', '2958', ours['a_b'], ROUNDED,
               'from 94.2 rad/s; "(94.2 rad/s^2)" stands for (94.2 rad/s)^2, in the slides or in '
               'our copy only', within=0.002, own=94.2**2 * 4 / 12),
        number('angular velocity of the coupler', 'rad/s', '25.6', ours['omega3'], DRAWN,
               within=0.01),
        number('angular velocity of the output link', 'rad/s', '49.6', ours['omega4'], DRAWN,
               within=0.01),
        number('normal part of A_C/B', 'ft/s^2', '983', ours['normal_cb'], DRAWN,
               'from 25.6 rad/s', within=0.02, own=25.6**2 * 18 / 12),
        number('normal part of A_C/D', 'ft/s^2', '2255', ours['normal_cd'], DRAWN,
               'from 49.6 rad/s', within=0.01, own=49.6**2 * 11 / 12),
        number('tangential part of A_C/B', 'ft/s^2', '160', ours['tangential_cb'], DRAWN,
               'the smallest arrow of a polygon of 2958 ft/s^2', within=0.01, scale=2958.0),
        number('tangential part of A_C/D', 'ft/s^2', '1670', ours['tangential_cd'], DRAWN,
               within=0.01),
        number('angular acceleration of the coupler', 'rad/s^2', '107', ours['alpha3'], DRAWN,
               'from 160 ft/s^2', within=0.01, scale=1972.0, own=160 / (18 / 12)),
        number('angular acceleration of the output link, cw', 'rad/s^2', '1822', ours['alpha4'],
               DRAWN, within=0.01, own=1670 / (11 / 12)),
        number('acceleration of E', 'ft/s^2', '2580', ours['a_e'], DRAWN, within=0.02),
        number('acceleration of F', 'ft/s^2', '1960', ours['a_f'], DRAWN, within=0.02),
    ], figure='example_7_3')


def example_7_4() -> Section:
    ours = published.example_7_4()
    return Section('Slides, Example 7.4 - slider on a turning rod', [
        number('normal acceleration', 'm/s^2', '1250', ours['normal']),
        number('Coriolis acceleration', 'm/s^2', '3000', ours['coriolis']),
        number('acceleration of A', 'm/s^2', '3250', ours['total']),
        number('its angle with the horizontal', 'deg', '22.4', ours['direction']),
    ])


def example_7_5() -> Section:
    ours = published.example_7_5()
    title = ('Slides, Example 7.5 - inverted slider-crank, crank 3 in at 30 deg, '
             'ground 14 in, no offset, 36 rad/s clockwise')
    return Section(title, [
        number('crank angle', 'deg', '', ours['angle'], ASSUMED,
               'it is in the drawing only; the readings fit it to 3 %'),
        number('distance of D from the line of A', 'in', '', ours['offset'], ASSUMED,
               'in the drawing only: omega4 is 1.3 % off without, 12 or 15 % off with the 2 in '
               'of AB'),
        number('speed of A', 'ft/s', '9', ours['v_a']),
        number('speed of Q', 'ft/s', '7.24', ours['v_q'], DRAWN, within=0.03),
        number('relative velocity', 'ft/s', '5.52', ours['v_rel'], DRAWN, within=0.03),
        number('angular velocity of the bar', 'rad/s', '7.55', ours['omega4'], DRAWN, within=0.03),
        number('distance QD', 'in', '11.5', ours['qd']),
        number('distance QD in the last line', 'in', '11.6', ours['qd'], DRAWN, '11.5 in (E3)',
               within=0.01),
        number('acceleration of A', 'ft/s^2', '324', ours['a_a']),
        number('normal part of A_Q/D', 'ft/s^2', '54.6', ours['normal'], DRAWN, within=0.03,
               own=7.55**2 * 11.5 / 12),
        number('Coriolis acceleration', 'ft/s^2', '83.4', ours['coriolis'], DRAWN, within=0.03,
               own=2 * 7.55 * 5.52),
        number('tangential part of A_Q/D', 'ft/s^2', '274', ours['tangential'], DRAWN,
               within=0.03),
        number('angular acceleration of the bar', 'rad/s^2', '283', ours['alpha4'], DRAWN,
               within=0.03, own=274 / (11.6 / 12)),
    ], figure='example_7_5')


def vectors(a_c_x: float, a_c_y: float, a_x: float, a_y: float, acc4: float, al2: float,
            al3: float, alpha: float, arm_x: float, arm_y: float, bar_alpha: float,
            bar_omega: float, bar_x: float, bar_y: float, c2: float, c3: float, coriolis: float,
            crank_omega: float, crank_x: float, crank_y: float, delta: float, growth: float,
            image: float, omega: float, p_x: float, p_y: float, q_x: float, q_y: float, r2: float,
            r3: float, r_x: float, r_y: float, radius: float, rel_x: float, rel_y: float,
            s2: float, s3: float, speed: float, tangent_x: float, tangent_y: float, v4: float,
            v_c_x: float, v_c_y: float, v_x: float, v_y: float, w2: float, w3: float,
            **_: float) -> Section:
    title = ('Slides, Eqs. (1)-(3), (6), (7), (9)-(11), (E1)-(E4), the acceleration '
             'image and the complex polar formulas, at the poses of Examples 7.3, 7.2, 7.5')
    return Section(title, [
        zero('Eq. (1), x, of C of Example 7.3 on its circle about D', v_c_x, -speed * tangent_x),
        zero('Eq. (1), y', v_c_y, -speed * tangent_y),
        zero('Eqs. (2) and (3), x', a_c_x, -growth * tangent_x,
             speed * tangent_y / radius * speed),
        zero('Eqs. (2) and (3), y', a_c_y, -growth * tangent_y,
             -speed * tangent_x / radius * speed),
        zero('Eq. (6), x, of C and B', p_x, -q_x, alpha * r_y, omega**2 * r_x),
        zero('Eq. (6), y', p_y, -q_y, -alpha * r_x, omega**2 * r_y),
        equal('acceleration image of Example 7.2, its angle delta', 'deg',
              180 - degrees(atan(al3 / w3**2)), delta,
              why='7.2 asks for it and prints no number: the angle from C/B to A_C/B'),
        equal('acceleration image, its factor', '1/s^2', sqrt(w3**4 + al3**2), image,
              why='A_C/B over C/B; the slides send to Example 7.1, which our copy lacks'),
        zero('Eq. (7), real', -r2 * w2 * s2, -r3 * w3 * s3, -v4),
        zero('Eq. (7), imaginary', r2 * w2 * c2, r3 * w3 * c3),
        equal('alpha3 of a slider-crank', '',
              (r2 * w2**2 * s2 - r2 * al2 * c2 + r3 * w3**2 * s3) / (r3 * c3), al3),
        equal('a4 of a slider-crank', '',
              -r2 * w2**2 * c2 - r2 * al2 * s2 - r3 * w3**2 * c3 - r3 * al3 * s3, acc4),
        zero('Eqs. (9), (10), x', a_x, bar_alpha * arm_y, bar_omega**2 * arm_x,
             2 * bar_omega * v_y, -rel_x),
        zero('Eqs. (9), (10), y', a_y, -bar_alpha * arm_x, bar_omega**2 * arm_y,
             -2 * bar_omega * v_x, -rel_y),
        zero('Eq. (11), x', a_x, -bar_x, 2 * bar_omega * v_y, -rel_x),
        zero('Eq. (11), y', a_y, -bar_y, -2 * bar_omega * v_x, -rel_y),
        zero('Eq. (E1), x', a_x, -bar_x, 2 * bar_omega * v_y, -rel_x,
             why='E1 is Eq. (11), although the slides name Eq. (10)'),
        zero('Eq. (E1), y', a_y, -bar_y, -2 * bar_omega * v_x, -rel_y),
        zero('Eq. (E2), x', a_x, crank_omega**2 * crank_x),
        zero('Eq. (E2), y', a_y, crank_omega**2 * crank_y),
        zero('Eq. (E3), x', bar_x, bar_omega**2 * arm_x, bar_alpha * arm_y),
        zero('Eq. (E3), y', bar_y, bar_omega**2 * arm_y, -bar_alpha * arm_x),
        equal('Eq. (E4)', 'm/s^2', 2 * bar_omega * sqrt(v_x**2 + v_y**2), coriolis),
    ])


def contact(al: float, al2: float, al3: float, apparent: float, c_x: float, c_y: float,
            p1_y: float, p2_x: float, p2_y: float, radius: float, rolling_x: float,
            rolling_y: float, w: float, **_: float) -> Section:
    title = ('Slides, Eq. (12), at the pose of Example 7.6; Eqs. (13)-(15), of a '
             'disc of our own, 0.3 m, 4 rad/s, 2 rad/s^2, on flat ground')
    return Section(title, [
        zero('Eq. (12), of crank 2 and coupler 3', al3, -al2, -apparent),
        equal('Eqs. (13) and (14), along the ground', 'm/s^2', rolling_x, p2_x,
              why='ours is the second derivative of the cycloid'),
        equal('Eqs. (13) and (14), square to it: the rolling acceleration', 'm/s^2', rolling_y,
              p2_y),
        zero('Eq. (15), along the ground', c_x, al * radius,
             why='on the ground both points have none'),
        zero('Eq. (15), square to it', p1_y, -c_y, -w**2 * radius, verdict=MISPRINT,
             why="P1 for P2: the disc's point has the right side, P1 of the ground rests",
             correct=[p2_y, -c_y, -w**2 * radius]),
    ])


def symbols(A: float, A1: float, A2: float, B: float, B1: float, B2: float, C: float, C1: float,
            C2: float, D: float, D1: float, D2: float, a1: float, a2: float, a3: float, a4: float,
            al4: float, ddv1: float, ddv2: float, ddv3: float, ddv4: float, dv1: float, dv2: float,
            dv3: float, dv4: float, v1: float, v2: float, v3: float, v4: float, w1: float,
            w2: float, w3: float, w4: float, **_: float) -> Section:
    title = ('Slides, Eqs. (16)-(37), at the pose of Example 7.6 (left sides over '
             'the sum of their terms)')
    return Section(title, [
        zero('Eq. (16)', A * v1**2 * v4**2, B * v1**2, C * v4**2, -8 * a1 * a3 * v1 * v4, D),
        zero('Eq. (17)', A1 * B1 * v1**2 * v2**2, A2 * B2 * v1**2, C1 * D2 * v2**2,
             8 * a2 * a4 * v1 * v2, C2 * D1),
        zero('Eq. (18)', A2 * B1 * v1**2 * v3**2, A1 * B2 * v1**2, C1 * D1 * v3**2, C2 * D2),
        zero('Eq. (19)', B1 * C1 * v2**2 * v3**2, A1 * D2 * v2**2, A2 * D1 * v3**2,
             -8 * a1 * a3 * v2 * v3, B2 * C2),
        zero('Eq. (20)', A1 * C1 * v2**2 * v4**2, B1 * D2 * v2**2, A2 * C2 * v4**2, B2 * D1),
        zero('Eq. (21)', A2 * C1 * v3**2 * v4**2, B1 * D1 * v3**2, A1 * C2 * v4**2,
             -8 * a2 * a4 * v3 * v4, B2 * D2),
        equal('Eq. (22)', '', -((A * v4**2 + B) * v1 - 4 * a1 * a3 * v4) * (1 + v1**2)
              / (((A * v1**2 + C) * v4 - 4 * a1 * a3 * v1) * (1 + v4**2)), w4 / w1),
        equal('Eq. (23)', '', -((A1 * B1 * v2**2 + A2 * B2) * v1 + 4 * a2 * a4 * v2) * (1 + v1**2)
              / (((A1 * B1 * v1**2 + C1 * D2) * v2 + 4 * a2 * a4 * v1) * (1 + v2**2)), w2 / w1),
        equal('Eq. (24)', '', -((A2 * B1 * v3**2 + A1 * B2) * v1) * (1 + v1**2)
              / ((A2 * B1 * v1**2 + C1 * D1) * v3 * (1 + v3**2)), w3 / w1),
        equal('Eq. (25)', '', -((B1 * C1 * v3**2 + A1 * D2) * v2 - 4 * a2 * a4 * v3) * (1 + v2**2)
              / (((B1 * C1 * v2**2 + A2 * D1) * v3 - 4 * a2 * a4 * v2) * (1 + v3**2)), w3 / w2,
              MISPRINT, '4 a2 a4 for 4 a1 a3, twice',
              correct=-((B1 * C1 * v3**2 + A1 * D2) * v2 - 4 * a1 * a3 * v3) * (1 + v2**2)
              / (((B1 * C1 * v2**2 + A2 * D1) * v3 - 4 * a1 * a3 * v2) * (1 + v3**2))),
        equal('Eq. (26)', '', -((A1 * C1 * v4**2 + B1 * D2) * v2) * (1 + v2**2)
              / ((A1 * C1 * v2**2 + A2 * C2) * v4 * (1 + v4**2)), w4 / w2),
        equal('Eq. (27)', '', -((A2 * C1 * v4**2 + B1 * D1) * v3 - 4 * a2 * a4 * v4) * (1 + v3**2)
              / (((A2 * C1 * v3**2 + A1 * C2) * v4 - 4 * a2 * a4 * v3) * (1 + v4**2)), w4 / w3),
        zero('Eq. (28)', ((A * v4**2 + B) * v1 - 4 * a1 * a3 * v4) * ddv1,
             ((A * v1**2 + C) * v4 - 4 * a1 * a3 * v1) * ddv4, (A * v4**2 + B) * dv1**2,
             (A * v1**2 + C) * dv4**2, (4 * A * v1 * v4 - 8 * a1 * a3) * dv1 * dv4,
             why='"= 0" is missing in (28)-(33)'),
        zero('Eq. (29)', ((A1 * B1 * v2**2 + A2 * B2) * v1 + 4 * a2 * a4 * v2) * ddv1,
             ((A1 * B1 * v1**2 + C1 * D2) * v2 + 4 * a2 * a4 * v1) * ddv2,
             (A1 * B1 * v2**2 + A2 * B2) * dv1**2, (A1 * B1 * v1**2 + C1 * D2) * dv2**2,
             (4 * A1 * B1 * v1 * v2 + 8 * a2 * a4) * dv1 * dv2),
        zero('Eq. (30)', (A2 * B1 * v3**2 + A1 * B2) * v1 * ddv1,
             (A2 * B1 * v1**2 + C1 * D1) * v3 * ddv3, (A2 * B1 * v3**2 + A1 * B2) * dv1**2,
             (A2 * B1 * v1**2 + C1 * D1) * dv3**2, 4 * A2 * B1 * v1 * v3 * dv1 * dv3),
        zero('Eq. (31)', ((B1 * C1 * v3**2 + A1 * D2) * v2 - 4 * a1 * a3 * v3) * ddv2,
             ((B1 * C1 * v2**2 + A2 * D1) * v3 - 4 * a1 * a3 * v2) * ddv3,
             (B1 * C1 * v3**2 + A2 * D1) * dv2**2, (B1 * C1 * v2**2 + A2 * D1) * dv3**2,
             (4 * B1 * C1 * v2 * v3 - 8 * a1 * a3) * dv2 * dv3, verdict=MISPRINT,
             why='A2 D1 for A1 D2 in the factor of the square of dv2/dt',
             correct=[((B1 * C1 * v3**2 + A1 * D2) * v2 - 4 * a1 * a3 * v3) * ddv2,
                      ((B1 * C1 * v2**2 + A2 * D1) * v3 - 4 * a1 * a3 * v2) * ddv3,
                      (B1 * C1 * v3**2 + A1 * D2) * dv2**2, (B1 * C1 * v2**2 + A2 * D1) * dv3**2,
                      (4 * B1 * C1 * v2 * v3 - 8 * a1 * a3) * dv2 * dv3]),
        zero('Eq. (32)', (A1 * C1 * v4**2 + B1 * D2) * v2 * ddv2,
             (A1 * C1 * v2**2 + A2 * C2) * v4 * ddv4, (A1 * C1 * v4**2 + B1 * D2) * dv2**2,
             (A1 * C1 * v2**2 + A2 * C2) * dv4**2, 4 * A1 * C1 * v2 * v4 * dv2 * dv4),
        zero('Eq. (33)', ((A2 * C1 * v4**2 + B1 * D1) * v3 + 4 * a2 * a4 * v4) * ddv3,
             ((A2 * C1 * v3**2 + A1 * C2) * v4 + 4 * a2 * a4 * v3) * ddv4,
             (A2 * C1 * v4**2 + B1 * D1) * dv3**2, (A2 * C1 * v3**2 + A1 * C2) * dv4**2,
             (4 * A2 * C1 * v3 * v4 + 8 * a2 * a4) * dv3 * dv4, verdict=MISPRINT,
             why='three times + for - before a2 a4',
             correct=[((A2 * C1 * v4**2 + B1 * D1) * v3 - 4 * a2 * a4 * v4) * ddv3,
                      ((A2 * C1 * v3**2 + A1 * C2) * v4 - 4 * a2 * a4 * v3) * ddv4,
                      (A2 * C1 * v4**2 + B1 * D1) * dv3**2, (A2 * C1 * v3**2 + A1 * C2) * dv4**2,
                      (4 * A2 * C1 * v3 * v4 - 8 * a2 * a4) * dv3 * dv4]),
        equal('Eq. (34)', '', w4 * (1 + v4**2) / 2, dv4),
        equal('Eq. (35)', '', 2 * dv4 / (1 + v4**2), w4),
        equal('Eq. (36)', '', (al4 + w4**2 * v4) * (1 + v4**2) / 2, ddv4),
        equal('Eq. (37)', '', 2 * ddv4 / (1 + v4**2) - w4**2 * v4, al4),
    ])


def example_7_6() -> Section:
    ours = published.example_7_6()
    title = ('Slides, Example 7.6 - 4R 8, 14, 9, 17, crank at 60 deg, 10 rad/s, 100 '
             'rad/s^2')
    return Section(title, [
        number('v2', '', '-0.4840', ours['v2']),
        number('v2, the other mode', '', '-1.8988', ours['other_v2']),
        number('theta2', 'deg', '-51.6569', ours['theta2']),
        number('theta2, the other mode', 'deg', '-124.4528', ours['other_theta2']),
        number('theta2 as a positive angle', 'deg', '308.3430', ours['theta2_positive']),
        number('the same, the other mode', 'deg', '235.5472', ours['other_theta2_positive']),
        number("theta2''", 'deg', '128.3430', ours['interior']),
        number("theta2' (coupler against the ground)", 'deg', '8.3430', ours['beta']),
        number('v4', '', '0.9094', ours['v4']),
        number('v4, the other mode', '', '-2.7989', ours['other_v4']),
        number('theta4', 'deg', '84.5689', ours['theta4']),
        number('theta4, the other mode', 'deg', '-140.6787', ours['other_theta4']),
        number('dv4/dt', '1/s', '6.5574', ours['dv4']),
        number('omega4', 'rad/s', '7.1781', ours['omega4']),
        number('omega2 (of the coupler)', 'rad/s', '-2.4463', ours['omega_beta']),
        number('dv2/dt', '1/s', '-7.6811', ours['dv2']),
        number('dtheta2/dt', 'rad/s', '-12.4463', ours['omega2']),
        number('d2v4/dt2', '1/s^2', '157.4654', ours['ddv4']),
        number('alpha4', 'rad/s^2', '125.5109', ours['alpha4']),
        number('alpha2 (of the coupler)', 'rad/s^2', '-3.5916', ours['alpha_beta']),
        number('dv2/dt on the last page', '1/s', '-110.2051', ours['dv2'], GARBLED,
               'it is d2v2/dt2, as its sentence says; our copy drops dots there'),
        number('d2v2/dt2', '1/s^2', '-110.2051', ours['ddv2']),
        number('d2theta2/dt2', 'rad/s^2', '-103.5916', ours['alpha2']),
    ], figure='example_7_6')


def example_7_7() -> Section:
    ours = published.example_7_7()
    return Section('Slides, Example 7.7 - crank-rocker 2, 6, 7, 5 at 10 rad/s', [
        number('Eq. (38), factor of v1^2 v4^2', '', '-36', ours['eq38_v1v4']),
        number('Eq. (38), of v1^2', '', '160', ours['eq38_v1']),
        number('Eq. (38), of -v1 v4', '', '112', ours['eq38_mixed']),
        number('Eq. (38), of -v4^2', '', '20', ours['eq38_v4']),
        number('Eq. (38), constant', '', '64', ours['eq38']),
        number('least omega4, both modes', 'rad/s', '-6.6959', ours['mode2_omega4_min']),
        number('its theta1, mode 2', 'deg', '2.6810', ours['mode2_omega4_min_at']),
        number('its theta1, mode 1', 'deg', '2.6810', ours['mode1_omega4_min_at_negative'],
               MISPRINT, 'said of both modes; mode 1 is the mirror image of mode 2'),
        number('largest omega4, both modes', 'rad/s', '3.2493', ours['mode2_omega4_max']),
        number('its theta1, mode 2', 'deg', '138.9638', ours['mode2_omega4_max_at']),
        number('its theta1, mode 1', 'deg', '138.9638', ours['mode1_omega4_max_at_negative'],
               MISPRINT, 'said of both modes; mode 1 is the mirror image of mode 2'),
        number('mode 1, largest alpha4', 'rad/s^2', '68.7731', ours['mode1_alpha4_max']),
        number('  its theta1', 'deg', '24.6475', ours['mode1_alpha4_max_at']),
        number('  listed again as', 'deg', '-335.3525', ours['mode1_alpha4_max_at_negative'],
               why="the same angle; the polynomial's other two roots belong to mode 2"),
        number('mode 1, least alpha4', 'rad/s^2', '-87.9671', ours['mode1_alpha4_min']),
        number('  its theta1', 'deg', '326.1382', ours['mode1_alpha4_min_at']),
        number('  listed again as', 'deg', '-33.8618', ours['mode1_alpha4_min_at_negative'],
               why='the same angle'),
        number('mode 2, largest alpha4', 'rad/s^2', '87.9671', ours['mode2_alpha4_max']),
        number('  its theta1', 'deg', '33.8616', ours['mode2_alpha4_max_at'], MISPRINT,
               '33.8618, as two pages earlier'),
        number('mode 2, least alpha4', 'rad/s^2', '-68.7731', ours['mode2_alpha4_min']),
        number('  its theta1', 'deg', '335.3525', ours['mode2_alpha4_min_at']),
    ], figure='example_7_7')


def method(at_rate: float, degree: float, in_a_mode: float, mirror: float, mirror_bend: float,
           most: float, slope: float, step_1: float, step_2: float, step_4: float, turns: float,
           **_: float) -> Section:
    return Section('Slides, steps 1 to 9 of the method and items 1 to 17 of Example 7.7', [
        equal('step 1: theta4 of theta1 alone', '', step_1, 0.0,
              why='largest difference from our motion over a turn'),
        equal('step 2: its rate', '', step_2, 0.0, why='the same over the largest value'),
        equal('steps 3, 4, 5: its acceleration at constant rate', '', step_4, 0.0,
              why='the same over the largest value'),
        equal('steps 6, 7: the derivative at the extrema of alpha4', '', slope, 0.0,
              why='over the largest alpha4, both at 1 rad/s'),
        equal('step 8, item 11: degree of the equation', '', 22, degree),
        equal('step 8, item 11: real values', '', 4, 2 * in_a_mode, why='two in each mode'),
        equal('step 8: complex values', '', 18, degree - 2 * in_a_mode),
        equal('step 9, items 5, 12, 13: two critical values in a mode', '', 2, in_a_mode),
        equal('the same as a general statement: links 1, 2, 2, 2 have', '', most, 4.0, ANSWERED,
              'omega4 of a crank-rocker always has two in a mode in 100,000 random ones; alpha4 '
              'two or four'),
        equal('item 1: a crank that turns fully', '', 1, turns),
        number('item 2: Eq. (38)', '', '', nan, DEFINED, 'compared under Example 7.7'),
        number('items 3, 6: both profiles', '', '', nan, DEFINED,
               'figures; the curves are drawn from steps 2 and 4'),
        equal('item 4: the velocity of mode 2 is that of mode 1 mirrored', '', mirror, 0.0,
              why='over the largest value'),
        number('items 7, 8, 9, 10: the method again', '', '', nan, DEFINED, 'steps 3 to 7'),
        number('item 14: velocity over acceleration', '', '', nan, DEFINED,
               'the figure of Example 7.7'),
        equal('item 15: alpha4 = 0 at the extrema of omega4', '', at_rate, 0.0,
              why='over the largest alpha4'),
        equal('items 13, 16: alpha4 of mode 2 mirrored is that of mode 1 with the other sign', '',
              mirror_bend, 0.0, ANSWERED, 'the linkage of mode 2 is the mirror image: theta4 is '
                                          'odd in theta1 between the modes, its rate even, '
                                          'alpha4 odd'),
    ])


def axis(bend_7_7: float, bend_paper: float, square_7_7: float, square_paper: float,
         **_: float) -> Section:
    return Section('Slides, items 16 and 17 - why the extremes lie where they lie', [
        equal('item 16: axis against coupler at the extrema of omega4, Example 7.7', 'deg',
              square_7_7, 90.0, ANSWERED, 'omega4 is extreme exactly where the collineation '
                                          'axis, through the poles P13 and P24, is square to the '
                                          'coupler (docs/why.md); shown: the angle farthest from '
                                          '90 deg, both modes'),
        equal('item 16: the same, linkage of the paper', 'deg', square_paper, 90.0, ANSWERED,
              'omega4 is extreme exactly where the collineation axis, through the poles P13 and '
              'P24, is square to the coupler (docs/why.md); shown: the angle farthest from 90 '
              'deg, both modes'),
        equal('item 16: d(tan l)/d(theta1) + 2 R - 1 at those of alpha4, Example 7.7', '',
              bend_7_7, 0.0, ANSWERED, 'alpha4 is extreme exactly where d(tan l)/d(theta1) = 1 - '
                                       '2 R, but for R = 0 and 1, l the angle from coupler to '
                                       'axis, R = omega4/omega1; shown: the largest miss over '
                                       'the terms, both modes'),
        equal('item 16: the same sum, linkage of the paper', '', bend_paper, 0.0, ANSWERED,
              'alpha4 is extreme exactly where d(tan l)/d(theta1) = 1 - 2 R, but for R = 0 and '
              '1, l the angle from coupler to axis, R = omega4/omega1; shown: the largest miss '
              'over the terms, both modes'),
        equal('item 17: the research asked for', '', bend_paper, 0.0, ANSWERED,
              'docs/why.md derives both statements; test_collineation.py finds no extremum '
              'without them and none of them, R = 0 and 1 apart, without an extremum'),
    ])


def paper_symbols(A: float, A1: float, A2: float, B: float, B1: float, B2: float, C: float,
                  C1: float, C2: float, D: float, D1: float, D2: float, a1: float, a2: float,
                  a3: float, a4: float, al4: float, ddv1: float, ddv4: float, dv1: float,
                  dv4: float, v1: float, v2: float, v3: float, v4: float, w4: float,
                  **_: float) -> Section:
    title = ('Paper, Eqs. (1)-(8), in its own chain and factors, at the pose of '
             'Example 7.6')
    return Section(title, [
        zero('Eq. (1)', A * v1**2 * v4**2, B * v1**2, C * v4**2, -8 * a1 * a3 * v1 * v4, D,
             why='all angles relative: theta1 + pi, -theta4; the tables are for absolute angles'),
        zero('Eq. (2)', A1 * B2 * v1**2 * v2**2, A2 * B1 * v1**2, C1 * D2 * v2**2,
             -8 * a2 * a4 * v1 * v2, C2 * D1),
        zero('Eq. (3)', A1 * B1 * v1**2 * v3**2, A2 * B2 * v1**2, C2 * D2 * v3**2, C1 * D1),
        zero('Eq. (4)', A1 * D2 * v2**2 * v3**2, B2 * C1 * v2**2, B1 * C2 * v3**2,
             -8 * a1 * a3 * v2 * v3, A2 * D1),
        zero('Eq. (5)', A1 * C1 * v2**2 * v4**2, B2 * D2 * v2**2, A2 * C2 * v4**2, B1 * D1),
        zero('Eq. (6)', A1 * C2 * v3**2 * v4**2, B1 * D2 * v3**2, A2 * C1 * v4**2,
             8 * a2 * a4 * v3 * v4, B2 * D1),
        zero('Eq. (7)', ((A * v4**2 + B) * v1 - 4 * a1 * a3 * v4) * dv1,
             ((A * v1**2 + C) * v4 - 4 * a1 * a3 * v1) * dv4),
        equal('first derivative of v', '', w4 * (1 + v4**2) / 2, dv4),
        equal('second derivative of v', '', (al4 + w4**2) * (1 + v4**2) / 2, ddv4, MISPRINT,
              'the square of the rate needs a factor v',
              correct=(al4 + w4**2 * v4) * (1 + v4**2) / 2),
        zero('Eq. (8)', ((A * v4**2 + B) * v1 - 4 * a1 * a3 * v4) * ddv1,
             ((A * v1**2 + C) * v4 - 4 * a1 * a3 * v1) * ddv4, (A * v4**2 + B) * dv1**2,
             (A * v1**2 + C) * dv4**2, 4 * (A * v1 * v4 - 2 * a1 * a3) * dv1 * dv4),
    ])


def algorithms(position_slope: float, rate_slope: float, slope: float, step_1: float,
               step_2: float, step_4: float, **_: float) -> Section:
    title = ('Paper, algorithms of extreme angular velocity and acceleration, on '
             'its linkage')
    return Section(title, [
        equal('velocity, step 1, and acceleration, step 1', '', step_1, 0.0,
              why='largest difference from our motion over a turn'),
        equal('velocity, step 2, and acceleration, step 2', '', step_2, 0.0,
              why='the same over the largest value'),
        equal('velocity, step 3', '', rate_slope, 0.0,
              why='the derivative at the extrema, at 1 rad/s'),
        equal('acceleration, steps 3, 4', '', step_4, 0.0,
              why='largest difference over the largest value'),
        equal('acceleration, step 5', '', position_slope, 0.0, MISPRINT,
              'd(theta_j)/d(theta_i) for the derivative of its acceleration: theta_j does not '
              'stall there', correct=slope),
    ])


def paper_table_1() -> Section:
    ours = published.paper_table_1()
    return Section('Paper, Table 1 - masses (round steel rods of radius 0.01 m)', [
        number('m1 = 31 pi/100', 'kg', '0.97389372261284', ours['m1']),
        number('m2 = 93 pi/100', 'kg', '2.92168116783851', ours['m2']),
        number('m3 = 31 pi/50', 'kg', '1.94778744522567', ours['m3']),
    ])


def paper_table_2() -> Section:
    ours = published.paper_table_2()
    return Section('Paper, Table 2 and Figure 3 - extrema at 25 rad/s', [
        number('mode 1, omega4', 'rad/s', '-23.95938176', ours['mode1_omega4_min'], GARBLED,
               within=2e-9, copies=(' 22.05028176', '-23.93938170', ' 23 05038176')),
        number('  its theta1', 'rad', '0.36933536508', ours['mode1_omega4_min_at'], ROUNDED,
               'digits lost in the search', within=1e-9),
        number('  its theta1', 'deg', '21.16135764', ours['mode1_omega4_min_at_deg']),
        number('mode 1, omega4', 'rad/s', '13.51343678', ours['mode1_omega4_max'], GARBLED,
               copies=('13 513/3678', '15.51545078')),
        number('  its theta1', 'rad', '-1.667165012', ours['mode1_omega4_max_at_negative'],
               ROUNDED, 'digits lost in the search', within=1e-9),
        number('  its theta1', 'deg', '-95.52151894', ours['mode1_omega4_max_at_negative_deg'],
               ROUNDED, 'digits lost in the search', within=1e-9),
        number('mode 1, alpha4', 'rad/s^2', '462.6986574', ours['mode1_alpha4_max'], ROUNDED,
               'digits lost in the search', within=1e-9),
        number('  its theta1', 'rad', '0.8382412814', ours['mode1_alpha4_max_at']),
        number('  its theta1', 'deg', '48.02768764', ours['mode1_alpha4_max_at_deg']),
        number('mode 1, alpha4', 'rad/s^2', '-1062.775829', ours['mode1_alpha4_min']),
        number('  its theta1', 'rad', '-0.1482557001', ours['mode1_alpha4_min_at_negative']),
        number('  its theta1', 'deg', '-8.494425904', ours['mode1_alpha4_min_at_negative_deg'],
               ROUNDED, 'digits lost in the search', within=1e-9),
        number('mode 2, omega4', 'rad/s', '13.51343678', ours['mode2_omega4_max'], GARBLED,
               copies=('13 51343678', '15.51545070')),
        number('  its theta1', 'rad', '1.667165012', ours['mode2_omega4_max_at'], ROUNDED,
               'digits lost in the search', within=1e-9),
        number('  its theta1', 'deg', '95.52151894', ours['mode2_omega4_max_at_deg'], ROUNDED,
               'digits lost in the search', within=1e-9),
        number('mode 2, omega4', 'rad/s', '-23.95938176', ours['mode2_omega4_min'], GARBLED,
               within=2e-9, copies=(' 22.05028176', '-23.93938170', ' 23 05038176')),
        number('  its theta1', 'rad', '5.913849943', ours['mode2_omega4_min_at'], ROUNDED,
               'digits lost in the search', within=1e-9),
        number('  its theta1', 'deg', '338.8386424', ours['mode2_omega4_min_at_deg']),
        number('mode 2, alpha4', 'rad/s^2', '1062.775829', ours['mode2_alpha4_max'], GARBLED,
               copies=('1062 775829', '1002.775029')),
        number('  its theta1', 'rad', '0.1482557001', ours['mode2_alpha4_max_at']),
        number('  its theta1', 'deg', '8.494425904', ours['mode2_alpha4_max_at_deg'], ROUNDED,
               'digits lost in the search', within=1e-9),
        number('mode 2, alpha4', 'rad/s^2', '-462.6986574', ours['mode2_alpha4_min'], GARBLED,
               within=1e-9, copies=(' 162 6086571', '-402.0980374')),
        number('  its theta1', 'rad', '5.444944024', ours['mode2_alpha4_min_at'], ROUNDED,
               'digits lost in the search', within=1e-9),
        number('  its theta1', 'deg', '311.9723124', ours['mode2_alpha4_min_at_deg']),
    ], figure='paper_figure_3')


def eq_9(difference: float, **_: float) -> Section:
    return Section('Paper, Eqs. (9) and (10), over a turn of its example', [
        equal('Eqs. (9) and (10): the nine unknowns, beside our closed forms', '', difference, 0.0,
              why='largest difference over the largest force'),
    ])


def paper_table_3() -> Section:
    ours = published.paper_table_3()
    return Section('Paper, Table 3 and Figure 4 - shaking force and moment, mode 2', [
        number('largest shaking force', 'N', '56.9764', ours['force'], WRONG,
               'it is the largest momentum: Eq. (9) was given m v in place of m a'),
        number('  its theta1', 'rad', '5.7299', ours['force_at'], WRONG, 'that of the momentum'),
        number('largest shaking moment about O1 (thin rods)', 'N m', '154.9566', ours['moment'],
               WRONG, 'm v again, and an arm of 0.01 m; the moment on the ground about O1 needs '
                      'O4 - O1 = 1 m, the formula as it is printed r34 from CG3'),
        number('  its theta1', 'rad', '5.7352', ours['moment_at'], WRONG,
               'm v again, and an arm of 0.01 m; the moment on the ground about O1 needs O4 - O1 '
               '= 1 m, the formula as it is printed r34 from CG3'),
        number('the same for solid rods', 'N m', '154.9566', ours['solid_moment'], WRONG,
               'm v again, and an arm of 0.01 m; the moment on the ground about O1 needs O4 - O1 '
               '= 1 m, the formula as it is printed r34 from CG3'),
        number('T14 + r34 x F34 with r34 of Fig. 2, from CG3', 'N m', '154.9566',
               ours['literal_moment'], WRONG, 'm v again, and an arm of 0.01 m; the moment on '
                                              'the ground about O1 needs O4 - O1 = 1 m, the '
                                              'formula as it is printed r34 from CG3'),
        number('  its theta1', 'rad', '5.7352', ours['literal_moment_at'], WRONG,
               'm v again, and an arm of 0.01 m; the moment on the ground about O1 needs O4 - O1 '
               '= 1 m, the formula as it is printed r34 from CG3'),
        number('the same with m v', 'kg m^2/s', '154.9566', ours['literal_wrong_moment'], WRONG,
               'm v again, and an arm of 0.01 m; the moment on the ground about O1 needs O4 - O1 '
               '= 1 m, the formula as it is printed r34 from CG3'),
        number('the force with m v', 'kg m/s', '56.9764', ours['wrong_force'],
               why='on a grid of 0.1 deg, to the last digit'),
        number('  its theta1', 'rad', '5.7299', ours['wrong_force_at']),
        number('the moment with m v and 0.01 m (thin rods)', '', '154.9566', ours['wrong_moment'],
               why='on a grid of 0.1 deg, to the last digit; that 0.01 m is the radius of the '
                   'rods is our inference'),
        number('  its theta1', 'rad', '5.7352', ours['wrong_moment_at']),
        number('least omega4 in the text', 'rad/s', '-23.9594', ours['rate']),
        number('  its theta1', 'rad', '5.9138', ours['rate_at']),
        number('from there to the largest force', '%', '3.2', 100 * (5.9138 - 5.7299) / 5.7299,
               why='of the two angles it prints; it depends on where angles are counted from: '
                   'they are 10.5 deg apart. The true force peaks 27.4 deg from the extreme '
                   'rate, 2.2 deg from the largest alpha4'),
    ], figure='paper_figure_4')


def last_question(at_alpha4: float, at_omega4: float, bound: float, peak: float, point_x: float,
                  point_y: float, share: float, share_limit: float, weighted: float,
                  **_: float) -> Section:
    title = ('Paper, its question - do extreme angular velocity and acceleration '
             'imply extreme shaking?')
    return Section(title, [
        equal('force at the largest alpha4 over its peak, rods 1, 2 - 1.5 e, 1 on a ground e, '
              'over sqrt(e)', '', share, share_limit, ANSWERED, "no: a family of the paper's "
                                                                'rods whose share goes to 0 as 5 '
                                                                'sqrt(10)/24 sqrt(e); here e = '
                                                                '1e-6 (docs/why.md)',
              within=1e-06),
        equal("the same share of the paper's linkage, with a counterweight on its crank", '',
              weighted, 0.0, ANSWERED,
              'no: 5 kg on the crank of any linkage can cancel the force in one pose'),
        equal('least peak of the shaking moment, over all points', 'N m', peak, bound, ANSWERED,
              '2048.5 N m about O1 come from the place of O1: about the best point the peak is '
              '5.7 times less; the dual of the linear programme shows that no point is better',
              within=1e-09),
        equal('  that point, x', 'm', point_x, 0.818425, ANSWERED, '2048.5 N m about O1 come '
                                                                   'from the place of O1: about '
                                                                   'the best point the peak is '
                                                                   '5.7 times less; the dual of '
                                                                   'the linear programme shows '
                                                                   'that no point is better',
              within=1e-05),
        equal('  that point, y', 'm', point_y, 0.457235, ANSWERED, '2048.5 N m about O1 come '
                                                                   'from the place of O1: about '
                                                                   'the best point the peak is '
                                                                   '5.7 times less; the dual of '
                                                                   'the linear programme shows '
                                                                   'that no point is better',
              within=1e-05),
        equal('  moment about it at the largest alpha4, over its peak', '', at_alpha4, 0.611174,
              ANSWERED, 'no: the moment peaks elsewhere', within=1e-05),
        equal('  at the extreme omega4', '', at_omega4, 0.999882, ANSWERED,
              'yes, in this linkage: about the best point the moment peaks where omega4 does',
              within=1e-05),
    ])


def definitions() -> Section:
    return Section('Definitions, and what is not compared', [
        number('Slides, Eqs. (4), (5), (8)', '', '', nan, MISSING, 'our copy lacks them'),
        number('Slides, Example 7.1', '', '', nan, MISSING, 'named, not printed'),
        number('Paper, Figures 1, 2', '', '', nan, DEFINED, 'they define symbols'),
    ])
