"""Jacobi's elliptic functions against mpmath and scipy."""

from fourbar_ros.extrema.four_bar_rates.input_paths import jacobi, landen_steps
import mpmath as mp
import numpy as np
import pytest
from scipy.special import ellipj, ellipk

NEGLECTED = 0.5 * 1e-3  # half of 1 - k' of the modulus at which landen_steps ends


@pytest.mark.parametrize('m1', [1.0, 0.9, 0.5, 1e-2, 1e-6, 1e-12, 1e-30, 1e-100])
def test_against_mpmath(m1):
    """Relative, times 1 + u in a tail exp(-u); also where 1 - m is below the last bit of m."""
    steps = landen_steps(m1)
    with mp.workdps(250):
        m = 1 - mp.mpf(m1)
        quarter = mp.ellipk(m) if m else mp.pi / 2
        for phase in np.linspace(-3.0, 3.0, 25).tolist():
            found = jacobi(float(mp.sin(phase)), float(mp.cos(phase)), steps)
            u = 2 * quarter * mp.mpf(phase) / mp.pi
            for name, ours in zip(('sn', 'cn', 'dn'), found):
                exact = mp.ellipfun(name, u, m=m)
                size = max(abs(exact) * (1 + abs(u)), mp.mpf(10) ** -30)
                assert abs(ours - exact) <= NEGLECTED * size, (name, phase)


def test_arrays_against_scipy():
    m1, phase = np.meshgrid([0.9, 0.3, 0.05], np.linspace(0.1, 3.0, 40))
    found = jacobi(np.sin(phase), np.cos(phase), landen_steps(m1))
    expected = ellipj(2.0 * ellipk(1.0 - m1) * phase / np.pi, 1.0 - m1)[:3]
    for ours, theirs in zip(found, expected):
        np.testing.assert_allclose(ours, theirs, rtol=0.0, atol=NEGLECTED)


def test_one_number_is_one_of_an_array():
    for m1 in (0.7, 1e-8):
        one = jacobi(np.sin(0.4), np.cos(0.4), landen_steps(m1))
        many = jacobi(
            np.full(3, np.sin(0.4)), np.full(3, np.cos(0.4)), landen_steps(np.full(3, m1))
        )
        for a, b in zip(one, many):
            np.testing.assert_allclose(b, a, rtol=1e-15)


def test_identities_hold():
    """sn^2 + cn^2 = 1 and dn^2 + m sn^2 = 1."""
    for m1 in (0.8, 0.1, 1e-4):
        sn, cn, dn = jacobi(np.sin(1.1), np.cos(1.1), landen_steps(m1))
        assert sn * sn + cn * cn == pytest.approx(1.0, abs=2 * NEGLECTED)
        assert dn * dn + (1.0 - m1) * sn * sn == pytest.approx(1.0, abs=2 * NEGLECTED)
