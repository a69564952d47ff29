# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The six input-output equations.

And every erratum of the two publications that states an equation or number.

An erratum test shows both: the printed form fails, the corrected one holds.
"""
import doctest
from math import atan, degrees, pi, radians, tan

from fourbar_lab.reproduction import io_equations
from fourbar_lab.reproduction.io_equations import (
    from_half_angle,
    io_equation,
    PAIRS,
    to_half_angle,
)
from fourbar_ros import Bodies, Body, CROSSED, FourBar, InvalidParameter, OPEN, round_rod
from fourbar_ros.mechanisms.half_angle import bilinear_factors
from mechanisms.four_bar.test_motion import angle_difference
import mpmath as mp
import numpy as np
import pytest
from support.reference import EPS, FreeBody, nine_by_nine, random_lengths

ALL_PAIRS = PAIRS + tuple((j, i) for i, j in PAIRS)
OPPOSITE = {1: 3, 2: 4, 3: 1, 4: 2}
PAPER = (0.4, 1.2, 0.8, 1.0)
SLIDES_7_6 = (8.0, 14.0, 9.0, 17.0)
SLIDES_7_7 = (2.0, 6.0, 7.0, 5.0)


class State:
    """Angles 1..4 of a pose with rates and accelerations, also as v; the slides' factors."""

    def __init__(self, lengths, mode, theta1, omega1=3.0, alpha1=-2.0):
        self.lengths, m = lengths, FourBar(*lengths, mode=mode).motion(theta1, omega1, alpha1)
        self.theta = dict(zip((1, 2, 3, 4), (m.theta1, m.theta2, m.theta3, m.theta4)))
        self.omega = dict(zip((1, 2, 3, 4), (m.omega1, m.omega2, m.omega3, m.omega4)))
        self.alpha = dict(zip((1, 2, 3, 4), (m.alpha1, m.alpha2, m.alpha3, m.alpha4)))
        self.v, self.dv, self.ddv = ({n: float(values[k])
                                      for n, values in self._half_angles().items()}
                                     for k in range(3))
        self.factors = bilinear_factors(*lengths)

    def _half_angles(self):
        return {n: to_half_angle(self.theta[n], self.omega[n], self.alpha[n])
                for n in (1, 2, 3, 4)}


@pytest.fixture(scope='module')
def states():
    """Poses of random linkages of all classes, away from toggles and v = infinity."""
    rng, result = np.random.default_rng(21), []
    for k, lengths in enumerate(random_lengths(rng, 400).tolist()):
        linkage = FourBar(*lengths, mode=(CROSSED, OPEN)[k % 2])
        low, high = linkage.input_ranges[-1]
        theta1 = float(angle_difference(rng.uniform(low + 0.1 * (high - low),
                                                    high - 0.1 * (high - low)), 0.0))
        state = State(tuple(lengths), linkage.mode, theta1)
        if linkage.motion(theta1).condition < 10.0 and max(map(abs, state.v.values())) < 10.0:
            result.append(state)
    assert len(result) > 100
    return result


def size(equation, s):
    """Return the sum of the magnitudes of the terms of an equation at a state, for tolerances."""
    vi, vj = abs(s.v[equation.i]), abs(s.v[equation.j])
    both, first, second, mixed, constant = map(abs, equation[2:7])
    return both * vi**2 * vj**2 + first * vi**2 + second * vj**2 + mixed * vi * vj + constant


# --- the equations -------------------------------------------------------------------------------

@pytest.mark.parametrize('pair', ALL_PAIRS)
def test_equations_hold_at_all_three_levels(states, pair):
    i, j = pair
    for s in states:
        e, v, dv, ddv = io_equation(s.lengths, i, j), s.v, s.dv, s.ddv
        scale = size(e, s) * (1.0 + v[i]**2) * (1.0 + v[j]**2)
        speed = max(map(abs, dv.values())) + max(map(abs, ddv.values())) ** 0.5
        assert abs(e.position(v[i], v[j])) <= 256 * EPS * scale
        assert abs(e.velocity(v[i], v[j], dv[i], dv[j])) <= 1024 * EPS * scale * speed
        assert abs(e.acceleration(v[i], v[j], dv[i], dv[j], ddv[i],
                                  ddv[j])) <= 4096 * EPS * scale * speed**2
        cosines = 1.0 / ((1.0 + v[i]**2) * (1.0 + v[j]**2))
        assert e.residual(s.theta[i], s.theta[j]) == pytest.approx(
            e.position(v[i], v[j]) * cosines, abs=64 * EPS * max(map(abs, e[2:7])))


@pytest.mark.parametrize('pair', ALL_PAIRS)
def test_rates_and_accelerations_are_those_of_the_linkage(states, pair):
    i, j = pair
    for s in states:
        e, ti, tj = io_equation(s.lengths, i, j), s.theta[i], s.theta[j]
        ratio, second = e.ratio(ti, tj), e.second_ratio(ti, tj)
        if abs(ratio) > 50.0 or abs(s.omega[i]) < 0.05:
            continue    # close to a dead point of theta_i
        assert ratio * s.omega[i] == pytest.approx(s.omega[j], rel=1e-8, abs=1e-9)
        assert (ratio * s.alpha[i] + second * s.omega[i]**2 == pytest.approx(s.alpha[j], rel=1e-6,
                                                                             abs=1e-6))


@pytest.mark.parametrize('pair', ALL_PAIRS)
def test_either_angle_follows_from_the_other(states, pair):
    i, j = pair
    for s in states:
        positive, negative = io_equation(s.lengths, i, j).solve(s.theta[i])
        mine, other = ((positive, negative) if np.sin(s.theta[OPPOSITE[i]]) > 0.0
                       else (negative, positive))
        assert angle_difference(mine, s.theta[j]) == pytest.approx(0.0, abs=1e-11)
        assert abs(io_equation(s.lengths, i,
                               j).residual(s.theta[i], other)) <= 64 * EPS * sum(s.lengths)**2


def test_solve_gives_crossed_then_open_and_broadcasts():
    x = np.linspace(-3.0, 3.0, 12).reshape(3, 4)
    crossed, open_ = io_equation(PAPER, 1, 4).solve(x)
    assert crossed.shape == (3, 4)
    np.testing.assert_allclose(open_, FourBar(*PAPER).motion(x).theta4, atol=8 * EPS)
    np.testing.assert_allclose(crossed, FourBar(*PAPER, mode=CROSSED).motion(x).theta4,
                               atol=8 * EPS)


@pytest.mark.parametrize('pair', ALL_PAIRS)
def test_infinite_v_is_an_ordinary_point(pair):
    """
    At theta_i = pi the known variable is infinite.

    Where the result is pi the leading term vanishes.
    """
    i, j = pair
    equation = io_equation(SLIDES_7_7, i, j)
    for solution in equation.solve(np.array([pi, -pi])):
        if np.isnan(solution[0]):
            continue
        assert np.abs(equation.residual(pi, solution)).max() <= 16 * EPS * sum(SLIDES_7_7)**2
        assert angle_difference(*solution) == pytest.approx(0.0, abs=1e-14)
        if equation.mixed == 0.0:
            # theta_j has its extreme here, so that back from it is a matter of rounding
            continue
        for tj in solution:     # theta_i = pi as a result
            assert np.abs(angle_difference(io_equation(SLIDES_7_7, j, i).solve(tj),
                                           pi)).min() <= 64 * EPS


def test_leading_coefficient_zero_is_an_ordinary_point():
    """
    theta4 = pi at theta1 = 60 deg.

    A v1^2 + C = 0, where the textbook's quadratic divides by zero.
    """
    equation = io_equation((1.0, 1.0, 1.0, 2.0), 1, 4)
    assert equation.both * tan(pi / 6.0)**2 + equation.second == pytest.approx(0.0, abs=8 * EPS)
    assert np.abs(angle_difference(equation.solve(pi / 3.0), pi)).min() <= 4 * EPS


def test_poses_that_do_not_exist_are_nan():
    assert all(np.isnan(t) for t in io_equation((4.0, 3.0, 2.0, 8.0), 1, 4).solve(1.0))


@pytest.mark.parametrize('pair', [(1, 1), (0, 4), (1, 5)])
def test_other_pairs_are_refused(pair):
    with pytest.raises(InvalidParameter, match='pair'):
        io_equation(PAPER, *pair)


def test_examples_in_the_module_run():
    assert doctest.testmod(io_equations).failed == 0


@pytest.mark.parametrize('pair', PAIRS)
def test_equations_are_identities_in_the_lengths_and_angles(pair):
    """Exact: with B from the loop as a rational point, in 40 digits, for irrational lengths."""
    i, j = pair
    with mp.workdps(40):
        a1, a2, a3 = mp.sqrt(2), mp.sqrt(7), mp.sqrt(5)
        t1, t2, t3 = mp.mpf('0.3'), mp.mpf('-0.8'), mp.mpf('0.9')
        end = a1 * mp.expj(t1) + a2 * mp.expj(t1 + t2) + a3 * mp.expj(t1 + t2 + t3)
        turn = mp.arg(end)      # turn the chain so that it ends on the x axis, at a4
        angles = {1: t1 - turn, 2: t2, 3: t3, 4: t1 - turn + t2 + t3 - mp.pi}
        equation = io_equation([float(a) for a in (a1, a2, a3, abs(end))], i, j)
        value = equation.position(mp.tan(angles[i] / 2), mp.tan(angles[j] / 2))
        assert abs(value) <= 64 * EPS * 60.0


# --- the map to the paper's chain ----------------------------------------------------------------

def paper_factors(a1, a2, a3, a4):
    """Return the factors in the paper's letters, as printed below its Eq. (1)."""
    return {'A1': a1 - a2 + a3 - a4,
            'A2': a1 + a2 + a3 - a4,
            'B1': a1 + a2 - a3 - a4,
            'B2': a1 - a2 - a3 - a4,
            'C1': a1 - a2 - a3 + a4,
            'C2': a1 + a2 - a3 + a4,
            'D1': a1 + a2 + a3 + a4,
            'D2': a1 - a2 + a3 + a4}


def paper_equation(lengths, i, j):
    """
    Return the coefficients of v_i^2 v_j^2, v_i^2, v_j^2, v_i v_j, 1 as printed in Eqs.

    (1)-(6).
    """
    f, (a1, a2, a3, a4) = paper_factors(*lengths), lengths
    products, mixed = {
        (1, 4): (('A1 A2', 'B1 B2', 'C1 C2', 'D1 D2'), -8 * a1 * a3),
        (1, 2): (('A1 B2', 'A2 B1', 'C1 D2', 'C2 D1'), -8 * a2 * a4),
        (1, 3): (('A1 B1', 'A2 B2', 'C2 D2', 'C1 D1'), 0.0),
        (2, 3): (('A1 D2', 'B2 C1', 'B1 C2', 'A2 D1'), -8 * a1 * a3),
        (2, 4): (('A1 C1', 'B2 D2', 'A2 C2', 'B1 D1'), 0.0),
        (3, 4): (('A1 C2', 'B1 D2', 'A2 C1', 'B2 D1'), 8 * a2 * a4)}[i, j]
    both, first, second, constant = (f[p.split()[0]] * f[p.split()[1]] for p in products)
    return both, first, second, mixed, constant


@pytest.mark.parametrize('pair', PAIRS)
def test_map_to_denavit_hartenberg_gives_the_printed_equations_of_the_paper(pair):
    for lengths in (PAPER, SLIDES_7_6, SLIDES_7_7):
        mapped = io_equation(lengths, *pair).denavit_hartenberg()
        assert mapped[2:7] == pytest.approx(paper_equation(lengths, *pair), rel=1e-13,
                                            abs=64 * EPS * max(lengths)**2)
        swapped = io_equation(lengths, *pair[::-1]).denavit_hartenberg()
        assert swapped[2:7] == (mapped.both, mapped.second, mapped.first, mapped.mixed,
                                mapped.constant)


def test_erratum_paper_tables_use_absolute_angles_not_those_of_its_equation_1():
    s = State(PAPER, OPEN, 1.66716501134)
    printed = io_equation(PAPER, 1, 4)._replace(**dict(zip(
        ('both', 'first', 'second', 'mixed', 'constant'), paper_equation(PAPER, 1, 4))))
    assert abs(printed.position(s.v[1], s.v[4])) > 0.1
    # relative angles: theta1 + pi, -theta4
    assert abs(printed.position(-1.0 / s.v[1], -s.v[4])) <= 1e-13
    assert abs(io_equation(PAPER, 1, 4).position(s.v[1], s.v[4])) <= 1e-13


# --- errata of the slides ------------------------------------------------------------------------

def far_from_zero(values, scale):
    """Return whether most of the residuals of a wrong equation are far above rounding."""
    return np.median(np.abs(values)) > 1e-3 * np.median(scale)


def test_erratum_25_has_4_a1_a3(states):
    def ratio(s, product):
        f, v = s.factors, s.v
        return -(((f.B1 * f.C1 * v[3]**2 + f.A1 * f.D2) * v[2] - 4 * product * v[3])
                 * (1 + v[2]**2)
                 / (((f.B1 * f.C1 * v[2]**2 + f.A2 * f.D1) * v[3] - 4 * product * v[2])
                    * (1 + v[3]**2)))

    right = [s.omega[3] / s.omega[2] for s in states]
    printed = [ratio(s, s.lengths[1] * s.lengths[3]) for s in states]
    corrected = [ratio(s, s.lengths[0] * s.lengths[2]) for s in states]
    np.testing.assert_allclose(corrected, right, rtol=1e-7)
    assert far_from_zero(np.subtract(printed, right), np.abs(right))


def test_erratum_31_has_A1_D2(states):
    def left(s, coefficient):
        f, v, dv, ddv, p = s.factors, s.v, s.dv, s.ddv, s.lengths[0] * s.lengths[2]
        terms = (((f.B1 * f.C1 * v[3]**2 + f.A1 * f.D2) * v[2] - 4 * p * v[3]) * ddv[2],
                 ((f.B1 * f.C1 * v[2]**2 + f.A2 * f.D1) * v[3] - 4 * p * v[2]) * ddv[3],
                 (f.B1 * f.C1 * v[3]**2 + coefficient(f)) * dv[2]**2,
                 (f.B1 * f.C1 * v[2]**2 + f.A2 * f.D1) * dv[3]**2,
                 (4 * f.B1 * f.C1 * v[2] * v[3] - 8 * p) * dv[2] * dv[3])
        return sum(terms), sum(map(abs, terms))

    printed, scale = np.transpose([left(s, lambda f: f.A2 * f.D1) for s in states])
    corrected, _ = np.transpose([left(s, lambda f: f.A1 * f.D2) for s in states])
    assert far_from_zero(printed, scale)
    assert (np.abs(corrected) <= 1e-10 * scale).all()      # and "= 0", which (28)-(33) leave out


def test_erratum_33_has_minus_signs(states):
    def left(s, sign):
        f, v, dv, ddv, p = s.factors, s.v, s.dv, s.ddv, sign * s.lengths[1] * s.lengths[3]
        terms = (((f.A2 * f.C1 * v[4]**2 + f.B1 * f.D1) * v[3] + 4 * p * v[4]) * ddv[3],
                 ((f.A2 * f.C1 * v[3]**2 + f.A1 * f.C2) * v[4] + 4 * p * v[3]) * ddv[4],
                 (f.A2 * f.C1 * v[4]**2 + f.B1 * f.D1) * dv[3]**2,
                 (f.A2 * f.C1 * v[3]**2 + f.A1 * f.C2) * dv[4]**2,
                 (4 * f.A2 * f.C1 * v[3] * v[4] + 8 * p) * dv[3] * dv[4])
        return sum(terms), sum(map(abs, terms))

    printed, scale = np.transpose([left(s, 1.0) for s in states])
    corrected, _ = np.transpose([left(s, -1.0) for s in states])
    assert far_from_zero(printed, scale)
    assert (np.abs(corrected) <= 1e-10 * scale).all()


def test_erratum_example_7_6_the_last_number_is_a_second_derivative():
    s = State(SLIDES_7_6, OPEN, radians(60.0), 10.0, 100.0)
    assert s.ddv[2] == pytest.approx(-110.2051, abs=0.5e-4)
    assert s.dv[2] == pytest.approx(-7.6811, abs=0.5e-4)
    assert (s.dv[4] == pytest.approx(6.5574, abs=0.5e-4) and s.ddv[4]
            == pytest.approx(157.4654, abs=0.5e-4))


def slope(lengths, mode, theta1, field, omega1=10.0):
    """Return the derivative of a field of Motion by theta1 at constant rate: complex step."""
    motion = FourBar(*lengths, mode=mode).motion(np.array([theta1]) + 1e-40j, omega1)
    return getattr(motion, field).imag[0] / 1e-40


def vanishes_between(lengths, mode, low, high, field, omega1=10.0):
    return slope(lengths, mode, low, field, omega1) * slope(lengths, mode, high, field,
                                                            omega1) < 0.0


def test_erratum_example_7_7_the_extreme_of_mode_2_is_at_33_8618_deg():
    assert vanishes_between(SLIDES_7_7, OPEN, radians(33.86175786548), radians(33.86175786550),
                            'alpha4')
    # nowhere in what rounds to the printed 33.8616
    assert not vanishes_between(SLIDES_7_7, OPEN, radians(33.86155), radians(33.86165), 'alpha4')


def test_erratum_example_7_7_four_listed_values_are_two_angles():
    printed = np.array([24.6475, 326.1382, -33.8618, -335.3525])
    assert sorted(np.round(printed % 360.0, 4)) == [24.6475, 24.6475, 326.1382, 326.1382]
    # mode 1; the two others of the polynomial belong to mode 2
    for value in (24.6475, 326.1382):
        for mode, at in ((CROSSED, value), (OPEN, -value)):
            assert vanishes_between(SLIDES_7_7, mode, radians(at - 1e-4), radians(at + 1e-4),
                                    'alpha4')
            assert not vanishes_between(SLIDES_7_7, mode, radians(-at - 1e-4), radians(-at + 1e-4),
                                        'alpha4')


def test_erratum_there_can_be_four_extrema_of_the_acceleration_in_one_mode():
    x = np.linspace(-pi, pi, 20001) + 1e-6
    for lengths, count in ((SLIDES_7_7, 2), ((2.0, 4.0, 5.0, 3.2), 4)):
        assert FourBar(*lengths).classification == 'Grashof crank-rocker'
        slopes = FourBar(*lengths).motion(x + 1e-40j, 1.0).alpha4.imag
        assert np.count_nonzero(slopes[1:] * slopes[:-1] < 0.0) == count


def test_item_16_the_modes_are_mirror_images():
    """
    Slides, item 16 "not clear why".

    theta4 of mode 2 at theta1 is minus that of mode 1 at -theta1.
    """
    x = np.linspace(-3.0, 3.0, 60)
    one, two = FourBar(*SLIDES_7_7,
                       mode=CROSSED).motion(-x, 10.0), FourBar(*SLIDES_7_7).motion(x, 10.0)
    np.testing.assert_array_equal(two.theta4, -one.theta4)
    np.testing.assert_array_equal(two.omega4, one.omega4)
    np.testing.assert_array_equal(two.alpha4, -one.alpha4)


def test_erratum_units_of_the_centripetal_acceleration():
    """(94.2 rad/s)^2 (4/12 ft) = 2958 ft/s^2; omega x (omega x R) = -omega^2 R as vectors."""
    assert 94.2**2 * 4.0 / 12.0 == pytest.approx(2958.0, abs=0.5)
    omega, arm = np.array([0.0, 0.0, 94.2]), np.array([0.2, -0.3, 0.0])
    twice = np.cross(omega, np.cross(omega, arm))
    np.testing.assert_allclose(twice, -94.2**2 * arm, rtol=4 * EPS)
    assert np.linalg.norm(twice) > 0.0 > -94.2**2 * np.linalg.norm(arm)


# --- errata of the paper -------------------------------------------------------------------------

def test_erratum_second_derivative_of_v_has_a_factor_v():
    theta, omega, alpha = 0.7, 3.0, -2.0
    v, dv, ddv = to_half_angle(theta, omega, alpha)

    def v_at(t):
        return mp.tan((mp.mpf(theta) + omega * t + mp.mpf(alpha) * t**2 / 2) / 2)

    exact = mp.diff(v_at, 0, 2)
    assert float(exact) == pytest.approx(float(ddv), rel=8 * EPS)
    assert abs(0.5 * (alpha + omega**2) * (1.0 + v**2) - float(exact)) > 1.0      # as printed
    assert from_half_angle(v, dv, ddv) == pytest.approx((theta, omega, alpha), rel=16 * EPS)
    assert float(v) == tan(0.35) and from_half_angle(v)[0] == 2.0 * atan(v)


def test_erratum_step_5_of_the_acceleration_algorithm():
    """What vanishes at an extremum of theta4'' is its own derivative, not that of theta4."""
    at = 0.1482557001
    assert vanishes_between(PAPER, OPEN, at - 1e-8, at + 1e-8, 'alpha4', 25.0)
    assert abs(FourBar(*PAPER).motion(at).velocity_ratio) > 0.1


def test_erratum_table_2_extreme_rate():
    linkage = FourBar(*PAPER)
    exact = linkage.motion(5.91384994221, 25.0).omega4
    assert exact == pytest.approx(-23.95938171814, abs=1e-11)
    for printed in (-23.93938170, 22.05028176, 23.05038176):
        assert abs(exact - printed) > 0.01


@pytest.mark.parametrize('mode, printed, corrected, field, step', [
    (CROSSED, 0.36933536508, 0.36933536497, 'omega4', 1e-11),
    (OPEN, 1.667165012, 1.66716501134, 'omega4', 1e-11),
    (OPEN, 5.913849943, 5.91384994221, 'omega4', 1e-11)])
def test_erratum_table_2_angles_are_good_to_nine_digits(mode, printed, corrected, field, step):
    assert vanishes_between(PAPER, mode, corrected - step, corrected + step, field, 25.0)
    assert not vanishes_between(PAPER, mode, printed - step, printed + step, field, 25.0)


def test_erratum_table_2_extreme_acceleration():
    assert FourBar(*PAPER).motion(5.444944024, 25.0).alpha4 == pytest.approx(-462.6986573,
                                                                             abs=0.6e-7)
    assert FourBar(*PAPER, mode=CROSSED).motion(0.8382412814,
                                                25.0).alpha4 != pytest.approx(462.6986574,
                                                                              abs=0.4e-7)


def paper_linkage(thin):
    """Return the linkage of Table 1 with thin-rod or solid-cylinder inertia."""
    rods = [round_rod(length, 7750.0, 0.01) for length in PAPER[:3]]
    if thin:
        rods = [Body(rod.mass, rod.cg_along, 0.0, rod.mass * length**2 / 12.0)
                for rod, length in zip(rods, PAPER)]
    return FourBar(*PAPER, bodies=Bodies(*rods))


@pytest.mark.parametrize('thin, moment', [(True, 2048.52), (False, 2048.61)])
def test_erratum_table_3_with_accelerations_in_the_force_rows(thin, moment):
    x = np.linspace(0.0, 2.0 * pi, 3601)
    loads = paper_linkage(thin).loads(x, 25.0)
    force = loads.shaking_force
    assert (force.max() == pytest.approx(2512.318, abs=2e-3) and x[force.argmax()]
            == pytest.approx(0.10964, abs=2e-3))
    assert np.abs(loads.shaking_moment).max() == pytest.approx(moment, abs=0.01)
    assert x[np.abs(loads.shaking_moment).argmax()] == pytest.approx(0.2199, abs=2e-3)
    assert force.max() > 40.0 * 56.9764


def test_erratum_table_3_is_reproduced_by_velocities_in_the_force_rows():
    """
    Momentum m v for m a, thin rods, and 0.01 m (the rod radius) for the arm a4.

    All four printed numbers.
    """
    linkage, forces, moments = paper_linkage(True), [], []
    degrees_around = np.arange(3275, 3295) / 10.0
    for theta1 in np.radians(degrees_around).tolist():
        m = linkage.motion(theta1, 25.0)
        crank, coupler, output = (complex(m.cos_x, m.sin_x), complex(m.cos_b, m.sin_b),
                                  complex(m.cos_y, m.sin_y))
        velocities = (12.5j * 0.4 * crank, 25j * 0.4 * crank + 0.5j * m.omega_beta * 1.2 * coupler,
                      0.5j * m.omega4 * 0.8 * output)
        links = [FreeBody(mp.mpc(body.mass * velocity), mp.mpf(body.inertia * alpha),
                          mp.mpc(0.5 * length * turn),
                          mp.mpc(length * turn), None)
                 for body, velocity, alpha, length, turn in zip(
                     linkage.bodies, velocities, (0.0, m.alpha_beta, m.alpha4), PAPER,
                     (crank, coupler, output))]
        f41, _, _, f43, torque = nine_by_nine(links)
        forces.append(float(abs(f41 + f43)))
        moments.append(float(abs(-torque - mp.mpf('0.01') * f43.imag)))
    assert max(forces) == pytest.approx(56.9764, abs=0.5e-4)
    assert radians(degrees_around[int(np.argmax(forces))]) == pytest.approx(5.7299, abs=0.5e-4)
    assert max(moments) == pytest.approx(154.9566, abs=0.5e-4)
    assert radians(degrees_around[int(np.argmax(moments))]) == pytest.approx(5.7352, abs=0.5e-4)


def test_erratum_the_arm_of_f34_is_from_o1_to_o4():
    """T14 + arm x F34 is minus the rate of the angular momentum about O1 for the arm a4 only."""
    linkage, theta1 = paper_linkage(False), 0.7
    m, loads = linkage.step(theta1, 25.0)
    crank, coupler, output = (complex(m.cos_x, m.sin_x), complex(m.cos_b, m.sin_b),
                              complex(m.cos_y, m.sin_y))
    places = (0.2 * crank, 0.4 * crank + 0.6 * coupler, 1.0 + 0.4 * output)
    of_a = -625.0 * 0.4 * crank
    accelerations = (0.5 * of_a, of_a + (1j * m.alpha_beta - m.omega_beta**2) * 0.6 * coupler,
                     (1j * m.alpha4 - m.omega4**2) * 0.4 * output)
    rate = sum(body.mass * (place.conjugate() * acceleration).imag + body.inertia * alpha
               for body, place, acceleration, alpha in zip(linkage.bodies, places, accelerations,
                                                           (0.0, m.alpha_beta, m.alpha4)))
    f34 = complex(-loads.f43_x, -loads.f43_y)
    # r34, from CG3 to O4
    printed = -loads.driving_torque + ((-0.4 * output).conjugate() * f34).imag
    assert loads.shaking_moment == pytest.approx(-rate, rel=1e-13)
    assert abs(printed + rate) > 0.1 * abs(rate)


def test_erratum_a_percentage_of_an_angle():
    """
    5.9138 and 5.7299 rad are 10.5 deg apart.

    3.2 % would be 50 % had theta1 been counted from 5.55 rad.
    """
    assert degrees(5.9138 - 5.7299) == pytest.approx(10.5, abs=0.05)
    assert (5.9138 - 5.7299) / 5.7299 == pytest.approx(0.032, abs=5e-4)
    assert (5.9138 - 5.7299) / (5.7299 - 5.55) > 1.0


def test_erratum_links_with_inertia_are_no_two_force_members():
    loads = paper_linkage(False).loads(0.7, 25.0)
    m = paper_linkage(False).motion(0.7)
    assert abs(loads.f32_x * m.sin_b - loads.f32_y * m.cos_b) > 0.02 * loads.f32
    light = FourBar(*PAPER, bodies=Bodies(Body(1.0), Body(0.0), Body(1.0, 0.4))).loads(0.7, 25.0)
    assert light.f32 > 0.0 and abs(light.f32_x * m.sin_b
                                   - light.f32_y * m.cos_b) <= 8 * EPS * light.f32
