# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Rods and bars beside integrals over their volume, by quadrature that is exact for them."""
from math import inf, nan

from fourbar_ros import Applied, Body, flat_bar, InvalidParameter, round_rod
from fourbar_ros.dynamics import Attachment, Spring, TorsionSpring
import numpy as np
import pytest

EPS = 2.0**-52
NODES, WEIGHTS = np.polynomial.legendre.leggauss(4)      # exact up to degree 7


def over(low, high):
    """Return places and weights on an interval."""
    return 0.5 * (low + high) + 0.5 * (high - low) * NODES, 0.5 * (high - low) * WEIGHTS


def assert_is(body, x, y, mass):
    """Compare a body with mass points (x, y, mass), x along it from its first joint."""
    total, centre = mass.sum(), (mass * x).sum() / mass.sum()
    inertia = (mass * ((x - centre)**2 + y**2)).sum()
    assert body.mass == pytest.approx(total, rel=64 * EPS, abs=0.0)
    assert body.cg_along == pytest.approx(centre, rel=64 * EPS, abs=0.0)
    assert body.cg_across == 0.0
    assert body.inertia == pytest.approx(inertia, rel=64 * EPS, abs=0.0)


@pytest.mark.parametrize(('length', 'density', 'radius'), [(0.4, 7750.0, 0.01), (0.1, 900.0, 0.3)])
def test_a_round_rod_is_a_cylinder(length, density, radius):
    x, by_x = over(0.0, length)
    r, by_r = over(0.0, radius)
    angle = 2.0 * np.pi * (np.arange(8) + 0.5) / 8       # exact for squares of sine and cosine
    x, r, angle = np.meshgrid(x, r, angle, indexing='ij')
    volume = by_x[:, None, None] * by_r[None, :, None] * r * 2.0 * np.pi / 8
    assert_is(round_rod(length, density, radius), x, r * np.sin(angle), density * volume)


@pytest.mark.parametrize(('length', 'width', 'thickness'),
                         [(0.4, 0.05, 0.01), (0.1, 0.3, 0.002), (0.2, 0.01, 0.5)])
def test_a_flat_bar_is_a_box_whose_width_lies_in_the_plane(length, width, thickness):
    x, by_x = over(0.0, length)
    y, by_y = over(-0.5 * width, 0.5 * width)
    x, y = np.meshgrid(x, y, indexing='ij')
    mass = 2700.0 * thickness * by_x[:, None] * by_y
    assert_is(flat_bar(length, 2700.0, width, thickness), x, y, mass)


@pytest.mark.parametrize('value, name', [
    (-1.0, 'mass'), (nan, 'mass'), (inf, 'cg_along'), (nan, 'cg_across'), (-1.0, 'inertia')])
def test_bad_bodies_are_refused_by_name(value, name):
    with pytest.raises(InvalidParameter, match=f'^{name} = '):
        Body(**{'mass': 1.0, name: value})


@pytest.mark.parametrize('make', [
    lambda: Body(2.0, 0.1), lambda: Applied(1.0, 2.0, 3.0),
    lambda: Spring(Attachment(), Attachment('crank'), 500.0, 0.1),
    lambda: TorsionSpring('ground', 'crank', 5.0, 0.1)])
def test_a_second_number_that_could_be_another_one_is_given_by_name(make):
    """As Body(m, I) was a mass with its centre I metres along the link."""
    with pytest.raises(TypeError, match='positional arguments'):
        make()


@pytest.mark.parametrize('make, arguments, name', [
    (round_rod, (0.0, 1.0, 1.0), 'length'), (round_rod, (1.0, -1.0, 1.0), 'density'),
    (round_rod, (1.0, 1.0, nan), 'radius')])
def test_bad_rods_are_refused_by_name(make, arguments, name):
    with pytest.raises(InvalidParameter, match=f'^{name} = '):
        make(*arguments)
