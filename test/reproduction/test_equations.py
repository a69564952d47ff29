# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The six input-output equations of both documents."""
from math import pi

from fourbar_lab.reproduction import equations as printed
from fourbar_lab.reproduction.equations import half_angle
from fourbar_ros import CROSSED, FourBar, OPEN
import mpmath as mp
import numpy as np
import pytest
from support.cartesian import EPS
from support.contract import random_lengths


def angles_of(linkage, theta1):
    """Return {joint: Angle} at 3 rad/s and -2 rad/s^2, as the slides count and as the paper."""
    m = linkage.motion(theta1, 3.0, -2.0)
    slides = {n: half_angle(*(getattr(m, f'{symbol}{n}') for symbol in ('theta', 'omega',
                                                                        'alpha')))
              for n in (1, 2, 3, 4)}
    return slides, slides | {1: half_angle(m.theta1 + pi, m.omega1, m.alpha1),
                             4: half_angle(-m.theta4, -m.omega4, -m.alpha4)}


@pytest.fixture(scope='module')
def poses():
    """Return (lengths, angles) of random linkages, away from toggles and v = infinity."""
    rng, found = np.random.default_rng(21), []
    for k, lengths in enumerate(random_lengths(rng, 400).tolist()):
        linkage = FourBar(*lengths, mode=(CROSSED, OPEN)[k % 2])
        low, high = linkage.input_ranges[-1]
        theta1 = rng.uniform(low + 0.1 * (high - low), high - 0.1 * (high - low))
        both = angles_of(linkage, theta1)
        if (linkage.motion(theta1).condition < 10.0
                and max(abs(angle.v) for angles in both for angle in angles.values()) < 10.0):
            found.append((lengths, both))
    assert len(found) > 80
    return found


@pytest.mark.parametrize('document', [0, 1])
def test_equations_hold_at_all_three_levels(poses, document):
    for lengths, both in poses:
        angles = both[document]
        equations = (printed.equations_of_slides, printed.equations_of_paper)[document]
        for equation in equations(lengths).values():
            a, b = angles[equation.i], angles[equation.j]
            scale = sum(map(abs, equation.position(a, b))) * (1.0 + a.v**2) * (1.0 + b.v**2)
            speed = (max(abs(angle.dv) for angle in angles.values())
                     + max(abs(angle.ddv) for angle in angles.values())**0.5)
            for terms, tolerance in ((equation.position(a, b), 256.0),
                                     (equation.velocity(a, b), 1024.0 * speed),
                                     (equation.acceleration(a, b), 4096.0 * speed**2)):
                assert abs(sum(terms)) <= tolerance * EPS * scale
            if abs(a.omega) > 0.05 and abs(b.omega / a.omega) < 50.0:
                assert equation.ratio(a, b) == pytest.approx(b.omega / a.omega, rel=1e-7,
                                                             abs=1e-7)


def test_the_tables_of_the_paper_use_absolute_angles_not_those_of_its_equation_1():
    lengths = (0.4, 1.2, 0.8, 1.0)
    slides, paper = angles_of(FourBar(*lengths), 1.66716501134)
    equation = printed.equations_of_paper(lengths)[1]
    assert abs(sum(equation.position(slides[1], slides[4]))) > 0.1
    assert abs(sum(equation.position(paper[1], paper[4]))) <= 1e-13


def test_the_half_angle_has_the_derivatives_of_its_tangent():
    theta, omega, alpha = 0.7, 3.0, -2.0
    found = half_angle(theta, omega, alpha)
    for order, value in enumerate((found.v, found.dv, found.ddv)):
        exact = mp.diff(lambda t: mp.tan((mp.mpf(theta) + omega * t + mp.mpf(alpha) * t**2 / 2)
                                         / 2), 0, order)
        assert float(value) == pytest.approx(float(exact), rel=8 * EPS)
