# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The input-output equations with slides, against closures of RRRP and PRRP in 60 digits."""
from itertools import permutations
from math import pi, radians, sqrt

from fourbar_lab.reproduction.io_equations import io_equation
from fourbar_ros import InvalidParameter, SliderCrank
import mpmath as mp
import numpy as np
import pytest
from support import slider_reference
from support.reference import EPS

RRRP, PRRP = (0.3, 0.8, None, 0.1), (None, 0.8, None, 0.35)
CASES = {
    'RRRP': (RRRP, {4: -0.5 * pi}, (0.3, 1.0, 2.5, -2.0)),
    'RRRP, oblique': ((0.3, 0.8, None, 0.25), {4: 0.7}, (0.3, 1.0, 2.5, -2.0)),
    'PRRP': (PRRP, {1: 1.9, 4: 0.4}, (-0.3, 0.05, 0.2, 0.4)),
    'PRRP, square': (PRRP, {1: 0.5 * pi, 4: 0.0}, (-0.5, 0.1, 0.3, 0.6)),
}
PAIRS = {name: [pair for pair in permutations((1, 2, 3, 4), 2)
                if 1 not in slides or set(pair) != {2, 3}]
         for name, (_, slides, _) in CASES.items()}


def closed(name, sign, q):
    """Return {joint: its variable} of a case: a circle about A meets the line of the slide."""
    (a1, a2, _, a4), slides, _ = CASES[name]
    crank = a1 * mp.expj(q) if 1 not in slides else q * mp.expj(slides[1])
    x, y = q if 1 not in slides else mp.mpf(slides[1]), mp.mpf(slides[4])
    seen = (crank - a4) * mp.expj(-y)           # A from O4, along the slide and square to it
    d = seen.real + sign * mp.sqrt(mp.mpf(a2)**2 - seen.imag**2)
    beta = mp.arg(a4 + d * mp.expj(y) - crank)
    return {1: q, 2: beta - x, 3: y + mp.pi - beta, 4: d}


@pytest.mark.parametrize('sign', [1, -1])
@pytest.mark.parametrize('name', CASES)
def test_every_pair_is_zero_has_its_ratios_and_both_solutions(name, sign):
    lengths, slides, inputs = CASES[name]
    for q in inputs:
        with mp.workdps(60):
            pose = closed(name, sign, mp.mpf(q))
            slopes = {n: [mp.diff(lambda x, n=n: closed(name, sign, x)[n], mp.mpf(q), order)
                          for order in (1, 2)] for n in pose}
        for i, j in PAIRS[name]:
            equation, ti, tj = io_equation(lengths, i, j, slides), float(pose[i]), float(pose[j])
            size = np.abs(equation.matrix).sum()        # all that is multiplied is below 2
            assert abs(equation.residual(ti, tj)) <= 8.0 * EPS * size
            v = [t if n in slides else float(mp.tan(pose[n] / 2)) for n, t in ((i, ti), (j, tj))]
            stretch = np.prod([1.0 + its**2 for n, its in zip((i, j), v) if n not in slides])
            assert abs(equation.position(*v)) <= 32.0 * EPS * size * stretch
            (di, ddi), (dj, ddj) = slopes[i], slopes[j]
            ratio = dj / di
            step = 1e-6
            slope = (equation.residual(ti, tj + step) - equation.residual(ti, tj - step)) / (
                2.0 * step)
            condition = 1.0 + abs(float(ratio)) + size / abs(slope)
            assert equation.ratio(ti, tj) == pytest.approx(
                float(ratio), abs=8.0 * EPS * condition**2)
            assert equation.second_ratio(ti, tj) == pytest.approx(
                float((ddj - ratio * ddi) / di**2), abs=16.0 * EPS * condition**4)
            solutions = [float(solution) for solution in equation.solve(ti)]
            away = [abs(s - tj) if j in slides else abs(2.0 * np.sin(0.5 * (s - tj)))
                    for s in solutions]
            assert min(away) <= 8.0 * EPS * condition**2, (i, j, solutions, tj)
            for solution in solutions:
                assert abs(equation.residual(ti, solution)) <= 16.0 * EPS * size * condition


@pytest.mark.parametrize('mode', [1, 2])
@pytest.mark.parametrize('offset', [0.1, 0.0, -0.2])
def test_a_slider_crank_is_the_rrrp_loop_seen_from_its_ground_line(offset, mode):
    linkage = SliderCrank(0.3, 0.8, offset, mode=mode)
    equation = io_equation((0.3, 0.8, None, offset), 1, 4, {4: -0.5 * pi})
    for theta1 in np.radians([10.0, 95.0, 200.0, 330.0]):
        exact = slider_reference.exact(slider_reference.KINDS[0], linkage.lengths, 2 * mode - 3,
                                       (theta1, 1.0, 0.0))
        seen = theta1 - 0.5 * pi
        slide = equation.solve(seen)[2 - mode]
        assert slide == pytest.approx(float(exact.angle[2]), abs=16.0 * EPS)
        assert equation.ratio(seen, slide) == pytest.approx(float(exact.rate[2]), abs=64.0 * EPS)
        assert equation.second_ratio(seen, slide) == pytest.approx(
            float(exact.acceleration[2]), abs=256.0 * EPS)
        motion = linkage.motion(theta1, 1.0)
        assert slide == pytest.approx(motion.slide, abs=16.0 * EPS)


def test_it_is_eq_16_with_another_unknown():
    """The same polynomial in v1 and v4 with a3, or with a1 and a3, for the variables."""
    rng = np.random.default_rng(3)
    for a1, a2, a4, d, x, y in rng.uniform(-1.0, 1.0, (50, 6)):
        v1, v4 = np.tan(0.5 * x), np.tan(0.5 * y)
        as_16 = io_equation((a1, a2, d, a4), 1, 4).position(v1, v4)
        size = 16.0 * (1.0 + v1**2) * (1.0 + v4**2)
        of_rrrp = io_equation((a1, a2, None, a4), 1, 4, {4: y}).position(v1, d)
        of_prrp = io_equation((None, a2, None, a4), 1, 4, {1: x, 4: y}).position(a1, d)
        assert abs(as_16 - of_rrrp * (1.0 + v4**2)) <= 8.0 * EPS * size
        assert abs(as_16 - of_prrp * (1.0 + v1**2) * (1.0 + v4**2)) <= 8.0 * EPS * size


def test_what_cannot_be_asked_is_refused():
    for slides in ({2: 0.0}, {1: 0.0}, {1: 0.0, 3: 0.0}):
        with pytest.raises(InvalidParameter, match='PRRP'):
            io_equation(RRRP, 1, 4, slides)
    with pytest.raises(InvalidParameter, match='whose sum is constant'):
        io_equation(PRRP, 2, 3, {1: radians(30.0), 4: 0.0})
    with pytest.raises(InvalidParameter, match='a1'):
        io_equation(PRRP, 1, 4, {4: 0.0})
    with pytest.raises(InvalidParameter, match='^lengths = .*four'):
        io_equation((1.0, 2.0), 1, 4, {4: 0.0})
    with pytest.raises(InvalidParameter, match='^pair = .*joints 1 to 4'):
        io_equation(RRRP, 1.5, 4, {4: 0.0})


def test_parallel_slides_move_together_and_turn_nothing():
    slides = {1: 0.5 * pi, 4: -0.5 * pi}
    for pair in ((1, 2), (2, 1), (1, 3), (2, 4), (4, 3)):
        with pytest.raises(InvalidParameter, match='^slides = .*parallel'):
            io_equation((None, 2.0, None, 1.0), *pair, slides)
    rise = sqrt(2.0**2 - 1.0**2)        # of the coupler between guides 1 apart
    both = io_equation((None, 2.0, None, 1.0), 1, 4, slides).solve(0.3)
    assert np.allclose(both, (rise - 0.3, -rise - 0.3), rtol=0.0, atol=16.0 * EPS)
    assert np.isnan(io_equation((0.9, 0.2, None, 0.1), 1, 4, {4: 0.0}).solve(1.5)).all()
