# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
P6 to many digits by two routes: the paper's crank-rocker, a motor line and an elastic shaft.

One equation in the crank angle with rates from sines; and crank, coupler and output angle with
Lagrange multipliers for the loop. Both as Taylor series in time with python-flint, for stiff
shafts by Radau IIA of high order (:mod:`support.collocation`).
"""
from flint import arb
import mpmath as mp

STALL, FREE, ROTOR = 400, 26, '0.5'
# stiffness: crank angle and rate, rotor angle and rate at 0.5 s; both routes agree in all digits
ANSWERS = {
    1000: ('11.053036712758026133077', '26.847146032521329859387',
           '11.182640094591427197152', '22.616586794746154384684'),
    100000: ('11.370083234362233117973', '23.18074685696328244752',
             '11.371307489533053719505', '23.199975211721346343545'),
    10**7: ('11.374256246971480389396951', '23.170163961325954539022420',
            '11.374268516280366070581463', '23.170352832577040134510496'),
    10**9: ('11.374296030790494060791513', '23.170068884951790983601438',
            '11.374296153485998498505213', '23.170070773324093107434555')}


def data():
    """Return lengths, masses and inertias of the rods in the current precision."""
    lengths = [arb(text) for text in ('0.4', '1.2', '0.8', '1.0')]
    masses = [7750 * arb.pi() * arb('0.01')**2 * length for length in lengths[:3]]
    inertias = [m * (3 * arb('0.01')**2 + l * l) / 12 for m, l in zip(masses, lengths)]
    return lengths, masses, inertias


def shaft_and_motor(k, q, w, p, v):
    """Return the torque of the shaft on the crank and the acceleration of the rotor."""
    shaft = k * (p - q) + k / 1000 * (v - w)
    return shaft, (STALL * (1 - v / FREE) - shaft) / arb(ROTOR)


def one_equation(k):
    """Return the derivative of (q, w, p, v)."""
    def derivative(state):
        (a1, a2, a3, a4), masses, inertias = data()
        q, w, p, v = state
        sin_x, cos_x = q.sin_cos()
        d_x, d_y = a4 - a1 * cos_x, -a1 * sin_x
        square = d_x * d_x + d_y * d_y
        # a2 e^{ib} = (along + i up) (d_x + i d_y) / square: B to the left of A-O4
        along = (a2 * a2 - a3 * a3 + square) / 2
        up = (a2 * a2 * square - along * along).sqrt()
        cos_b = (along * d_x - up * d_y) / square / a2
        sin_b = (along * d_y + up * d_x) / square / a2
        cos_y = (a1 * cos_x + a2 * cos_b - a4) / a3
        sin_y = (a1 * sin_x + a2 * sin_b) / a3
        sin_mu, cos_mu = sin_y * cos_b - cos_y * sin_b, cos_y * cos_b + sin_y * sin_b
        sin_xb, cos_xb = sin_x * cos_b - cos_x * sin_b, cos_x * cos_b + sin_x * sin_b
        sin_xy, cos_xy = sin_x * cos_y - cos_x * sin_y, cos_x * cos_y + sin_x * sin_y
        y1, b1 = a1 * sin_xb / (a3 * sin_mu), a1 * sin_xy / (a2 * sin_mu)
        y2 = (a1 * cos_xb + a2 * b1 * b1 - a3 * y1 * y1 * cos_mu) / (a3 * sin_mu)
        b2 = (a1 * cos_xy + a2 * b1 * b1 * cos_mu - a3 * y1 * y1) / (a2 * sin_mu)
        crank = inertias[0] + masses[0] * a1 * a1 / 4 + masses[1] * a1 * a1
        rod = inertias[1] + masses[1] * a2 * a2 / 4
        output = inertias[2] + masses[2] * a3 * a3 / 4
        coupled = masses[1] * a1 * a2 / 2
        inertia = crank + rod * b1 * b1 + output * y1 * y1 + 2 * coupled * b1 * cos_xb
        half_slope = (rod * b1 * b2 + output * y1 * y2
                      + coupled * (b2 * cos_xb - b1 * sin_xb * (1 - b1)))
        shaft, rotor = shaft_and_motor(k, q, w, p, v)
        return [w, (shaft - half_slope * w * w) / inertia, v, rotor]
    return derivative, lambda: [0, 0, 0, 0]


def with_multipliers(k):
    """Return the derivative of (x, b, y, p) and their rates."""
    def derivative(state):
        (a1, a2, a3, _), masses, inertias = data()
        x, b, y, p, w, b_rate, y_rate, v = state
        (sin_x, cos_x), (sin_b, cos_b), (sin_y, cos_y) = x.sin_cos(), b.sin_cos(), y.sin_cos()
        coupled = masses[1] * a1 * a2 / 2
        sine, cosine = sin_x * cos_b - cos_x * sin_b, cos_x * cos_b + sin_x * sin_b
        shaft, rotor = shaft_and_motor(k, x, w, p, v)
        zero = 0 * x
        crank = inertias[0] + masses[0] * a1 * a1 / 4 + masses[1] * a1 * a1
        rod = inertias[1] + masses[1] * a2 * a2 / 4
        output = inertias[2] + masses[2] * a3 * a3 / 4
        # a1 e^{ix} + a2 e^{ib} - a3 e^{iy} = a4: rows of its Jacobian, and what is centripetal
        r1 = [-a1 * sin_x, -a2 * sin_b, a3 * sin_y]
        r2 = [a1 * cos_x, a2 * cos_b, -a3 * cos_y]
        g1 = a1 * cos_x * w * w + a2 * cos_b * b_rate * b_rate - a3 * cos_y * y_rate * y_rate
        g2 = a1 * sin_x * w * w + a2 * sin_b * b_rate * b_rate - a3 * sin_y * y_rate * y_rate
        rows = [[crank + zero, coupled * cosine, zero, r1[0], r2[0],
                 shaft - coupled * sine * b_rate * b_rate],
                [coupled * cosine, rod + zero, zero, r1[1], r2[1], coupled * sine * w * w],
                [zero, zero, output + zero, r1[2], r2[2], zero],
                [*r1, zero, zero, g1], [*r2, zero, zero, g2]]
        accelerations = solved(rows)
        return [w, b_rate, y_rate, v, *accelerations[:3], rotor]

    def start():
        (a1, a2, a3, a4), *_ = data()
        r = a4 - a1
        return [0, ((a2 * a2 + r * r - a3 * a3) / (2 * a2 * r)).acos(),
                arb.pi() - ((a3 * a3 + r * r - a2 * a2) / (2 * a3 * r)).acos(), 0, 0, 0, 0, 0]
    return derivative, start


def solved(rows):
    """Return the solution of linear equations by elimination; pivots of masses, then of joints."""
    rows = [list(row) for row in rows]
    count = len(rows)
    for i in range(count):
        for j in range(i + 1, count):
            factor = rows[j][i] / rows[i][i]
            rows[j] = [a - factor * b for a, b in zip(rows[j], rows[i])]
    answer = [None] * count
    for i in reversed(range(count)):
        rest = sum((rows[i][j] * answer[j] for j in range(i + 1, count)), 0 * rows[i][i])
        answer[i] = (rows[i][-1] - rest) / rows[i][i]
    return answer


def graded(first, count, until='0.5'):
    """Return lengths of steps: doubled from the first one up, through the fast transient."""
    longest, step, lengths = mp.mpf(until) / count, mp.mpf(first), []
    while step < longest:
        lengths.append(step)
        step *= 2
    left = mp.mpf(until) - sum(lengths)
    equal = int(mp.ceil(left / longest))
    return [mp.nstr(length, 45) for length in [*lengths, *[left / equal] * equal]]
