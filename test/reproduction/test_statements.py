# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The answers to both documents' questions, each against a formulation of its own."""
from fourbar_lab.reproduction import published
import mpmath as mp
import numpy as np
import pytest
from support.cartesian import EPS


def family(e, theta):
    """Return (alpha4, |F|) of the rods 1, 2 - 1.5 e, 1 on e, 1 kg/m, at unit rate; of series."""
    a2 = 2 - mp.mpf(3) / 2 * e

    def b(x):
        crank = mp.expj(x)
        line = e - crank                        # from A to O4
        q = mp.sqrt((line * mp.conj(line)).real)
        along = (q**2 + a2**2 - 1) / (2 * q)
        return crank + line / q * mp.mpc(along, mp.sqrt(a2**2 - along**2))

    def theta4(x):
        return mp.arg((b(x) - e) * mp.expj(-x)) + x

    alpha4 = mp.diff(theta4, theta, 2)
    centres = [lambda x: mp.expj(x) / 2, lambda x: (mp.expj(x) + b(x)) / 2,
               lambda x: (b(x) + e) / 2]
    force = sum(mass * mp.mpc(mp.diff(lambda x, c=c: c(x).real, theta, 2),
                              mp.diff(lambda x, c=c: c(x).imag, theta, 2))
                for mass, c in zip((1, a2, 1), centres))
    return alpha4, abs(force)


@pytest.mark.parametrize('e', ['1e-6', '1e-12'])
def test_the_share_of_the_family_goes_to_zero_as_its_closed_form_says(e):
    """The closure in 80 digits: alpha4 is largest near 0, the force near pi, by parabolas."""
    with mp.workdps(80):
        e = mp.mpf(e)
        root = mp.sqrt(e)

        def largest(which, middle):
            step = root / 1000
            low, here, high = (family(e, middle + s)[which] for s in (-step, 0, step))
            return middle - step * (high - low) / (2 * (high - 2 * here + low))
        at = largest(0, largest(0, -root / (4 * mp.sqrt(2))))
        top = largest(1, largest(1, mp.pi))
        share, alpha4 = family(e, at)[1] / family(e, top)[1], family(e, at)[0]
        assert abs(share / root - 5 * mp.sqrt(10) / 24) < e + mp.mpf('1e-10')
        assert abs(family(e, at)[1] / e - mp.mpf(15) / 4) < 10 * root
        assert abs(abs(alpha4) / root - mp.sqrt(2)) < 10 * root
    ours = published.small_share(float(e))
    # a2 is rounded by up to eps, which counts beside e
    assert published.force_share(ours) == pytest.approx(float(share), abs=EPS / float(e))


def test_the_largest_alpha4_and_the_peak_of_the_family_are_where_they_are_said_to_be():
    """On samples: of (Q1) and (Q2) no other place has more."""
    linkage, x = published.small_share(1e-6), np.linspace(-np.pi, np.pi, 20001)
    (alpha4,), loads = linkage.motion(x, 1.0, fields=('alpha4',)), linkage.loads(x, 1.0)
    assert abs(x[np.argmax(np.abs(alpha4))]) < 1e-3
    assert abs(abs(x[np.argmax(loads.shaking_force)]) - np.pi) < 1e-2
    g, mass = 2.0 * np.sqrt(1.5 - np.cos(x)), linkage.bodies.crank.mass
    slope, bend = 2.0 * np.sin(x) / g, (2.0 * np.cos(x) - (2.0 * np.sin(x) / g)**2) / g
    expected = 1.5 * mass * 1e-3 * np.hypot(2.0 * slope, g - bend)
    np.testing.assert_allclose(loads.shaking_force, expected, atol=20.0 * 1e-3 * expected.max())


def test_a_counterweight_on_the_crank_cancels_the_force_in_one_pose_alone():
    weighted = published.counterweighted(published.THIN)
    at, x = published.place_of_largest(published.THIN, 'alpha4'), np.linspace(-3.0, 3.0, 601)
    forces = weighted.loads(x, 1.0).shaking_force
    assert weighted.loads(at, 1.0).shaking_force <= 64.0 * EPS * forces.max()
    assert weighted.bodies.crank.mass > published.THIN.bodies.crank.mass


def test_about_no_other_point_the_moment_peaks_lower():
    linkage, speed = published.THIN, published.PAPER_SPEED
    point, peak, bound = published.least_moment(linkage, speed)
    assert bound == pytest.approx(peak, rel=1e-9)
    loads = linkage.loads(np.linspace(0.0, 2.0 * np.pi, 7201), speed)

    def peak_about(x, y):
        return np.abs(loads.shaking_moment - (x * loads.shaking_force_y
                                              - y * loads.shaking_force_x)).max()
    assert peak_about(*point) == pytest.approx(peak, rel=1e-4)      # samples
    assert peak_about(0.0, 0.0) == pytest.approx(2048.519, abs=1e-2)
    # the peak is convex in the point, so a circle around it decides
    for angle in np.linspace(0.0, 2.0 * np.pi, 25):
        assert peak_about(point[0] + 0.01 * np.cos(angle), point[1] + 0.01 * np.sin(angle)) > peak
