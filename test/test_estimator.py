"""The causal estimator of missing rates: exact where it must be, as noisy and late as it says."""
import math

import numpy as np
import pytest

from fourbar_ros.estimator import RateEstimator

EPS = np.finfo(float).eps


def feed(estimator, times, angles, rates=None):
    rates = [math.nan] * len(times) if rates is None else rates
    return np.array([estimator.update(float(t), float(x), float(v)) for t, x, v in zip(times, angles, rates)])


@pytest.mark.parametrize('window', [3, 5, 9])
def test_constant_acceleration_is_exact_on_any_spacing_and_through_the_wrap(window):
    rng = np.random.default_rng(1)
    times = 1000.0 + np.cumsum(rng.uniform(0.002, 0.01, 300))
    t = times - times[0]
    angles = 0.3 + 20.0 * t - 7.0 * t**2
    wrapped = (angles + np.pi) % (2.0 * np.pi) - np.pi
    found = feed(RateEstimator(window), times, wrapped)[window:]
    # an angle of size 60 and a stamp of size 1000 s, each known to eps, over steps of 2 ms and squares of them
    error = EPS * (60.0 + 40.0 * 1000.0)
    assert np.abs(found[:, 0] - (20.0 - 14.0 * t)[window:]).max() < 8 * error / 0.002
    assert np.abs(found[:, 1] + 14.0).max() < 16 * error / 0.002**2


def test_the_first_samples_say_what_is_not_known_yet():
    first, second, third = feed(RateEstimator(), [0.0, 0.1, 0.2], [1.0, 1.1, 1.2])
    assert np.isnan(first).all()
    assert second[0] == pytest.approx(1.0) and np.isnan(second[1])
    assert third[0] == pytest.approx(1.0) and third[1] == pytest.approx(0.0, abs=16 * EPS * 1.2 / 0.1**2)


def test_a_given_velocity_is_kept_and_only_the_acceleration_estimated():
    times = np.arange(20) * 0.01
    found = feed(RateEstimator(), times, np.sin(times), 5.0 + 3.0 * times)
    assert (found[:, 0] == 5.0 + 3.0 * times).all()
    assert np.isnan(found[0, 1]) and np.abs(found[1:, 1] - 3.0).max() < 64 * EPS * 5.0 / 0.01


def test_jump_gap_and_wrong_order():
    estimator = RateEstimator(window=3, gap=0.5, jump=1.0)
    times = np.arange(10) * 0.1
    feed(estimator, times, times)
    assert estimator.update(0.9, 0.9) == pytest.approx((1.0, 0.0), abs=1e-9)       # the newest again
    assert np.isnan(estimator.update(0.85, 99.0)).all() and estimator.late == 1    # older than the newest: unused
    assert estimator.update(0.95, 0.95) == pytest.approx((1.0, 0.0), abs=1e-9)
    assert np.isnan(estimator.update(1.0, 2.9)).all() and estimator.restarts == 1  # a jump, not a speed
    assert estimator.update(1.1, 3.0)[0] == pytest.approx(1.0)
    assert np.isnan(estimator.update(9.0, 3.1)).all() and estimator.restarts == 2  # after a gap
    assert estimator.update(9.1, 3.2)[0] == pytest.approx(1.0)
    assert np.isnan(estimator.update(0.0, 3.3)).all() and estimator.restarts == 3  # the clock was set back
    assert estimator.update(0.1, 3.4)[0] == pytest.approx(1.0)


@pytest.mark.parametrize('window, velocity_noise, acceleration_noise, jerk_share',
                         [(3, 2.55, 2.45, 1 / 3), (5, 1.115, 0.535, 43 / 30)])
def test_noise_and_lag_are_as_documented(window, velocity_noise, acceleration_noise, jerk_share):
    rng = np.random.default_rng(2)
    h, noise = 0.01, 1e-5
    times = np.arange(20000) * h
    found = feed(RateEstimator(window, jump=3.0), times, rng.normal(0.0, noise, times.size))[window:]
    spread = found.std(axis=0) * np.array([h, h**2]) / noise
    assert spread == pytest.approx([velocity_noise, acceleration_noise], rel=0.03)   # 1/sqrt(20000) = 0.7 %
    jerk, t = 5.0, times[:200]
    found = feed(RateEstimator(window), t, jerk * t**3 / 6.0)[window:]
    assert found[:, 0] - jerk * t[window:]**2 / 2.0 == pytest.approx(-jerk_share * jerk * h**2, rel=1e-3)
    assert found[:, 1] - jerk * t[window:] == pytest.approx(-jerk * h * (window - 1) / 2.0, rel=1e-3)


def test_a_slide_does_not_wrap():
    """Three metres a sample are three metres, not half a turn."""
    times = np.arange(10) * 0.1
    found = feed(RateEstimator(jump=100.0, period=math.inf), times, 40.0 * times)
    assert found[3:, 0] == pytest.approx(40.0, rel=1e-12)
    jump = feed(RateEstimator(jump=1.0, period=math.inf), [0.0, 0.1, 0.2], [0.0, 0.1, 0.1 + 2.0 * np.pi])
    assert np.isnan(jump[2]).all()


@pytest.mark.parametrize('bad', [math.nan, math.inf, -math.inf])
def test_an_input_that_is_no_number_is_not_remembered(bad):
    estimator = RateEstimator()
    feed(estimator, [0.0, 0.1, 0.2], [0.0, 0.1, 0.2])
    assert np.isnan(estimator.update(0.25, bad)).all()
    assert estimator.update(0.3, 0.3) == pytest.approx((1.0, 0.0), abs=1e-12) and estimator.restarts == 0


@pytest.mark.parametrize('period', [math.tau, math.inf])
def test_whatever_comes_it_goes_on(period):
    """Stamps of messages and the edges of floats in every order, and afterwards the estimate is right again."""
    edges = [0.0, -0.0, 1.0, math.nan, math.inf, -math.inf, 5e-324, 1.7e308, -1.7e308, 1e154, 1e16]
    rng = np.random.default_rng(3)
    estimator = RateEstimator(period=period)
    stamps = np.append(rng.integers(-2**31, 2**31, 20), rng.integers(-9, 9, 20) * 1e-9)
    for time, (position, velocity) in zip(rng.choice(stamps, 20000).tolist(), rng.choice(edges, (20000, 2)).tolist()):
        estimator.update(time, position, velocity)
    estimator.reset()
    assert feed(estimator, [0.0, 0.1, 0.2], [0.0, 0.1, 0.2])[-1] == pytest.approx((1.0, 0.0), abs=1e-12)
