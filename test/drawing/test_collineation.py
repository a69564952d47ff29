# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Extrema lie where the collineation axis says, and nowhere else.

The geometry is done here once more, from lengths alone: joints by the law of cosines, poles as
intersections of lines, derivatives by the complex step. It is a third search beside samples and
exact roots.
"""
from math import pi

from fourbar_lab.drawing import collineation_axis
from fourbar_lab.studies import find_extrema_many
from fourbar_ros import find_extrema, FourBar, InvalidParameter, InvertedSlider, SliderCrank
import numpy as np
import pytest
from support.samples import more

RATES = ('omega4', 'alpha4')
STEP = 1e-30
NEAR = 1e-6             # within which [rad] a condition must change its sign about an extremum


def cross(p, q):
    return np.stack([p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2],
                     p[0] * q[1] - p[1] * q[0]])


def geometry(lengths, mode, theta):
    """Return R, and the axis along and square to the coupler; analytic in theta."""
    a1, a2, a3, a4 = lengths
    zero, one = 0.0 * theta, 1.0 + 0.0 * theta
    ax, ay = a1 * np.cos(theta), a1 * np.sin(theta)
    dx, dy = ax - a4, ay                                   # from O4 to A
    square = dx * dx + dy * dy
    t = 0.5 * (square + a3 * a3 - a2 * a2) / square        # B over the foot on the line O4 A
    u = np.sqrt(a3 * a3 / square - t * t) * (3 - 2 * mode)
    b = np.stack([a4 + t * dx - u * dy, t * dy + u * dx, one])
    a, o1, o4 = np.stack([ax, ay, one]), np.stack([zero, zero, one]), np.stack([a4 + zero, zero,
                                                                               one])
    p13, p24 = cross(cross(o1, o4), cross(a, b)), cross(cross(o1, a), cross(o4, b))
    axis, (x, y) = cross(p13, p24), (b - a)[:2]
    return (p13[0] / (p13[0] - a4 * p13[2]), x * axis[1] - y * axis[0], x * axis[0] + y * axis[1])


def conditions(lengths, mode, theta):
    """
    Return what changes its sign where omega4 and where alpha4 is extreme: (K1) without its poles.

    The second vanishes at R = 0 and 1 too, where the axis lies along the coupler: R'' does not.
    """
    ratio, along, across = geometry(lengths, mode, theta + 1j * STEP)
    (d, dd), (c, dc) = ((v.real, v.imag / STEP) for v in (along, -across))
    r = ratio.real
    return d, r * (1.0 - r) * (dd * c - d * dc + (1.0 - 2.0 * r) * d * d)


def drawn(count, seed):
    rng = np.random.default_rng(seed)
    while count:
        try:
            linkage = FourBar(*rng.uniform(0.1, 1.0, 4).tolist(), mode=int(rng.integers(1, 3)))
        except InvalidParameter:
            continue
        if linkage.change_point_margin > 1e-3:
            count -= 1
            yield linkage


@pytest.mark.parametrize('count', [more(400, 20_000)])
def test_every_extremum_lies_where_the_axis_says(count):
    rng = np.random.default_rng(1)
    lengths, mode = rng.uniform(0.1, 1.0, (4, count)), rng.integers(1, 3, count)
    closes = 2.0 * lengths.max(axis=0) < lengths.sum(axis=0)
    lengths, mode = lengths[:, closes], mode[closes]
    found, checked = find_extrema_many(*lengths, mode=mode), 0
    for which, name in enumerate(RATES):
        index, theta, *_, side, _ = found[name]
        of_next = np.diff(index, append=-1) == 0
        apart = np.where(of_next, np.diff(theta, append=theta[:1]), pi)
        is_alone = (np.minimum(apart, np.roll(apart, 1)) > 100.0 * NEAR) & (side == 0)
        index, theta = index[is_alone], theta[is_alone]
        signs = []
        for x in (theta - NEAR, theta + NEAR):
            both = [conditions(lengths[:, index], one, x)[which] for one in (1, 2)]
            signs.append(np.sign(np.where(mode[index] == 1, *both)))
        with_limit = ~np.isfinite(signs[0] + signs[1])     # a limit of the range within NEAR
        assert with_limit.mean() < 1e-3
        assert (signs[0] * signs[1] < 0.0)[~with_limit].all(), name
        checked += theta.size
    assert checked > 3 * count


@pytest.mark.parametrize('count', [more(60, 400)])
def test_there_are_no_others(count):
    """The conditions change their signs as often as extrema are found, in each range."""
    for linkage in drawn(count, 2):
        extrema = [e for e in find_extrema(linkage, RATES) if e.place == 'interior']
        for which, name in enumerate(RATES):
            expected = sum(e.quantity == name for e in extrema)
            for points in (2_000, 20_000, 500_000):        # more where two are near each other
                changes = 0
                for low, high in linkage.input_ranges:
                    phi = np.linspace(-0.5 * pi, 0.5 * pi, points + 1)[1:-1]
                    x = (np.linspace(low, high, points) if linkage.turns_fully
                         else 0.5 * (low + high) + 0.5 * (high - low) * np.sin(phi))
                    with np.errstate(invalid='ignore'):
                        signs = np.sign(conditions(linkage.lengths, linkage.mode, x)[which])
                    signs = signs[np.isfinite(signs) & (signs != 0.0)]
                    changes += np.count_nonzero(np.diff(signs))
                if changes == expected:
                    break
            assert changes == expected, (linkage, name, changes, expected)


@pytest.mark.parametrize('linkage', [
    FourBar(0.4, 1.2, 0.8, 1.0), FourBar(8.0, 14.0, 9.0, 17.0, mode=1),
    FourBar(2.0, 6.0, 7.0, 5.0), SliderCrank(0.3, 0.8, 0.1), SliderCrank(0.3, 0.8, -0.1, mode=1),
    InvertedSlider(0.3, 0.8, 0.1), InvertedSlider(0.8, 0.3, -0.1, mode=1)], ids=str)
def test_slopes_of_ratios(linkage):
    """R' = R (1 - R) cot(l), of a slider-crank R cot(l), at every input."""
    (low, high), x = linkage.input_ranges[0], np.linspace(0.01, 0.99, 200)
    motion = linkage.motion(low + (high - low) * x, 1.0, 0.0)
    axis = collineation_axis(linkage, motion)
    if isinstance(linkage, SliderCrank):
        slope, expected = motion.slide_acceleration, motion.slide_velocity
    else:
        slope, expected = motion.alpha4, motion.omega4 * (1.0 - motion.omega4)
    size = np.abs(slope * axis.across) + np.abs(expected * axis.along)
    assert np.abs(slope * axis.across - expected * axis.along).max() <= 1e-12 * size.max()
    alone = collineation_axis(linkage, linkage.motion(low + 0.3 * (high - low), 1.0, 0.0))
    assert -0.5 * pi < alone.angle <= 0.5 * pi


@pytest.mark.parametrize('quantity', ['slide_velocity', 'slide_acceleration'])
def test_slides_too(quantity):
    linkage = SliderCrank(0.3, 0.8, 0.1)
    for extremum in find_extrema(linkage, (quantity,), 1.0):
        x = extremum.theta1 + 1e-5 * np.array((-1.0, 0.0, 1.0))
        tangent = np.tan(collineation_axis(linkage, linkage.motion(x, 1.0)).angle)
        if quantity == 'slide_velocity':
            assert abs(1.0 / tangent[1]) < 1e-12
        else:
            assert (tangent[2] - tangent[0]) / 2e-5 == pytest.approx(1.0, abs=1e-8)


@pytest.mark.parametrize('unit', [2.0**-660, 2.0**660])
@pytest.mark.parametrize('kind', [FourBar, SliderCrank, InvertedSlider])
def test_the_unit_of_length_does_not_matter(kind, unit):
    lengths = (0.4, 1.2, 0.8, 1.0) if kind is FourBar else (0.3, 0.8, 0.1)
    one, other = (kind(*(length * its for length in lengths)) for its in (1.0, unit))
    angles = [collineation_axis(linkage, linkage.motion(1.0)).angle for linkage in (one, other)]
    assert angles[0] == pytest.approx(angles[1], abs=1e-14)


@pytest.mark.parametrize('theta', [0.0, 1.0])
def test_a_parallelogram_has_none(theta):
    linkage = FourBar(1.0, 2.0, 1.0, 2.0)
    assert np.isnan(collineation_axis(linkage, linkage.motion(theta)).angle)


def test_other_mechanisms_have_none():
    slide = SliderCrank(0.3, 0.8, 0.1, input='slide')
    with pytest.raises(InvalidParameter, match='its crank drives'):
        collineation_axis(slide, slide.motion(0.6))
