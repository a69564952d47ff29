# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The causal estimator of missing rates: exact where it must be, as noisy and late as it says."""
import math

from fourbar_ros.pipeline.rate_estimator import estimator_of, MEMORY, RateEstimator
from fourbar_ros.scene import scene
import numpy as np
import pytest
from support.scenes import PAPER

EPS = np.finfo(float).eps


NS = 1_000_000_000
# today, before 1970, the end of a Time message
EPOCHS = [0, 1_795_282_488_233_864_734, -3 * NS, 2**31 * NS]


def stamps(seconds):
    """Return times [s] as stamps [ns]."""
    return np.rint(np.asarray(seconds) * 1e9).astype(np.int64)


def feed(estimator, times, angles, rates=None):
    """Return what an estimator says for times [s] or stamps [ns]."""
    rates = [math.nan] * len(times) if rates is None else rates
    times = np.asarray(times)
    times = times if times.dtype == np.int64 else stamps(times)
    return np.array([estimator.update(int(t), float(x), float(v))
                     for t, x, v in zip(times, angles, rates)])


@pytest.mark.parametrize('epoch', EPOCHS)
@pytest.mark.parametrize('window', [3, 5, 9])
def test_constant_acceleration_is_exact_on_any_spacing_and_through_the_wrap(window, epoch):
    """Only rounding of angles is left, whatever the clock: stamps are whole nanoseconds."""
    rng = np.random.default_rng(1)
    times = epoch + np.cumsum(rng.integers(2_000_000, 10_000_000, 300))
    t = (times - times[0]) * 1e-9
    angles = 0.3 + 20.0 * t - 7.0 * t**2
    wrapped = (angles + np.pi) % (2.0 * np.pi) - np.pi
    found = feed(RateEstimator(window, top_speed=26.0), times, wrapped)[window:]
    # of an angle that has been up to 60 rad, wrapped, over steps of 2 ms
    error = 4.0 * EPS * 60.0
    assert np.abs(found[:, 0] - (20.0 - 14.0 * t)[window:]).max() < 2.5 * error / 0.002
    assert np.abs(found[:, 1] + 14.0).max() < 4.0 * error / 0.002**2


def test_the_first_samples_say_what_is_not_known_yet():
    first, second, third = feed(RateEstimator(), [0.0, 0.1, 0.2], [1.0, 1.1, 1.2])
    assert np.isnan(first).all()
    assert second[0] == pytest.approx(1.0) and np.isnan(second[1])
    assert (third[0] == pytest.approx(1.0) and third[1]
            == pytest.approx(0.0, abs=16 * EPS * 1.2 / 0.1**2))


def test_a_given_velocity_is_kept_and_only_the_acceleration_estimated():
    times = np.arange(20) * 0.01
    found = feed(RateEstimator(), times, np.sin(times), 5.0 + 3.0 * times)
    assert (found[:, 0] == 5.0 + 3.0 * times).all()
    assert np.isnan(found[0, 1]) and np.abs(found[1:, 1] - 3.0).max() < 64 * EPS * 5.0 / 0.01


def test_jump_gap_and_wrong_order():
    estimator = RateEstimator(window=3, gap=0.5, jump=1.0)

    def update(seconds, position):
        return estimator.update(round(seconds * NS), position)
    for k in range(10):
        update(k * 0.1, k * 0.1)
    assert update(0.9, 0.9) == pytest.approx((1.0, 0.0), abs=1e-9)       # the newest again
    # older than the newest: unused
    assert np.isnan(update(0.85, 99.0)).all() and estimator.late == 1
    assert update(0.95, 0.95) == pytest.approx((1.0, 0.0), abs=1e-9)
    assert np.isnan(update(1.0, 2.9)).all() and estimator.restarts == 1  # a jump, not a speed
    assert update(1.1, 3.0)[0] == pytest.approx(1.0)
    assert np.isnan(update(9.0, 3.1)).all() and estimator.restarts == 2  # after a gap
    assert update(9.1, 3.2)[0] == pytest.approx(1.0)
    assert np.isnan(update(0.0, 3.3)).all() and estimator.restarts == 3  # the clock was set back
    assert update(0.1, 3.4)[0] == pytest.approx(1.0)


def test_a_stamp_that_stands_still_while_the_position_moves_is_late():
    """A driver with a stuck clock; the same sample again keeps its rates."""
    estimator = RateEstimator()
    feed(estimator, np.arange(6) * 0.01, 0.05 * np.arange(6))
    assert feed(estimator, [0.05] * 2, [0.25] * 2) == pytest.approx(np.array([[5.0, 0.0]] * 2),
                                                                    abs=1e-9)
    assert estimator.late == 0
    assert np.isnan(feed(estimator, [0.05] * 3, [0.3, 0.35, 0.4])).all() and estimator.late == 3
    assert feed(estimator, [0.05], [0.3], [7.0])[0, 0] == 7.0 and estimator.late == 4
    assert feed(estimator, [0.06], [0.3])[0] == pytest.approx([5.0, 0.0], abs=1e-9)
    assert estimator.restarts == 0


@pytest.mark.parametrize('gap', [1.0, 0.29, 0.57, 1.1, 4.1, 0.001])
def test_a_step_as_long_as_the_gap_is_none(gap):
    """1.0/1e-9 is 999999999.9999999: exact steps of a second never had rates."""
    steps = round(gap * 1e9) * np.arange(20)
    estimator = RateEstimator(gap=gap)
    found = feed(estimator, steps, 0.5 * np.arange(20))[3:]
    assert np.isfinite(found).all() and estimator.restarts == 0
    steps[-1] += 1
    estimator.reset()
    feed(estimator, steps, 0.5 * np.arange(20))
    assert estimator.restarts == 1


@pytest.mark.parametrize('back', [0.02, 0.1, 0.8, 0.999, 1.0, 50.0])
def test_a_clock_set_back_by_any_step_costs_no_more_than_a_start(back):
    """A simulation that starts again: the second sample after it has a velocity, the third all."""
    estimator = RateEstimator(window=5, gap=1.0)
    before = np.arange(200) * 0.01
    feed(estimator, before, 3.0 * before)
    after = before[-1] - back + np.arange(1, 200) * 0.01
    found = feed(estimator, after, 3.0 * after)
    assert np.isnan(found[:, 0]).sum() <= 1 and np.isnan(found[:, 1]).sum() <= 2
    # two samples back is only the newest again
    assert estimator.restarts == (0 if back == 0.02 else 1)
    assert np.abs(found[2:] - [3.0, 0.0]).max() < 64 * EPS * 50.0 / 0.01**2


def test_samples_overtaken_one_by_one_do_not_start_it_afresh():
    """Two publishers on one topic: samples of the one behind have no rates, the others all."""
    estimator = RateEstimator(window=5)
    t = np.arange(200) * 0.01
    times = np.column_stack((t, t - 0.015)).ravel()
    found = feed(estimator, times, 3.0 * times).reshape(-1, 2, 2)
    assert (np.isnan(found[2:, 1]).all() and np.abs(found[2:, 0] - [3.0, 0.0]).max()
            < 64 * EPS * 6.0 / 0.01**2)
    assert estimator.restarts == 0 and estimator.late == 200


@pytest.mark.parametrize('ratio, others', [(0.5, {}), (-3.0, {}), (-60.0, {}),
                                           (1.0, {'drive.top_speed': 4.0}),
                                           (-1.0, {'drive.top_speed': 4.0})])
def test_a_motor_that_counts_its_turns_drives_a_crank_behind_gears_or_one_that_wraps(ratio,
                                                                                     others):
    estimator = estimator_of(scene.from_values({**PAPER, 'drive.source': 'joint_state',
                                                'drive.joint': 'motor',
                                                'drive.joint_ratio': ratio,
                                                'drive.joint_offset': 0.3, **others}))
    t = np.arange(2000) * 0.002
    motor = ratio * 4.0 * t + 0.3
    if others:
        motor = (motor + math.pi) % math.tau - math.pi
    found = feed(estimator, t, (motor - 0.3) / ratio)[3:]
    assert np.abs(found - [4.0, 0.0]).max() < 16 * EPS * 4.0 * t[-1] / 0.002**2
    assert estimator.restarts == 0


def crank(t, is_wrapped):
    """Return the positions of a crank at 25 rad/s."""
    return (25.0 * t + math.pi) % math.tau - math.pi if is_wrapped else 25.0 * t


def right(found, t):
    """Return which answers have both rates; assert that these are right to the digits."""
    is_known = np.isfinite(found).all(axis=1)
    assert (np.abs(found[is_known] - [25.0, 0.0])
            < 16 * EPS * 25.0 * t[-1] / np.array([0.01, 0.01**2])).all()
    return is_known


@pytest.mark.parametrize('is_wrapped, top_speed', [(False, math.nan), (True, math.nan),
                                                   (True, 25.0), (False, 25.0)])
@pytest.mark.parametrize('pause', [0.02, 0.06, 0.1, 0.12, 0.2, 0.25, 0.26, 0.5, 0.8, 1.5])
def test_a_pause_makes_no_wrong_rate(pause, is_wrapped, top_speed):
    """
    25 rad/s at 100 Hz: in 0.25 s the crank makes a turn less 0.03 rad.

    -22, -13, 17 and 28 rad/s were answered with STATUS_OK after it, also of counted positions.
    """
    t = np.cumsum(np.r_[np.full(60, 0.01), pause, np.full(40, 0.01)])
    is_known = right(feed(RateEstimator(top_speed=top_speed), t, crank(t, is_wrapped)), t)
    # a restart costs two samples; turns that wrap and are not declared to do so are restarts
    restarts = 5 if is_wrapped and math.isnan(top_speed) else 1
    assert is_known.sum() >= len(t) - 2 * (restarts + 1)


@pytest.mark.parametrize('rate, is_wrapped, top_speed, jump, known', [
    (4.0, False, math.nan, 1.0, False), (4.0, False, math.nan, 10.0, True),
    (4.0, True, 25.0, 10.0, False), (4.0, True, 25.0, 1.0, False), (15.0, True, 25.0, 2.0, False),
    (16.0, True, 25.0, 2.0, True), (50.0, True, 25.0, 1.0, True), (50.0, True, 100.0, 1.0, False)])
def test_a_slow_stream_is_believed_only_if_its_steps_are_known(rate, is_wrapped, top_speed, jump,
                                                               known):
    """A wrapped step is known if it takes less time than a quarter turn at the top speed."""
    t = np.arange(40) / rate
    found = feed(RateEstimator(jump=jump, top_speed=top_speed), t, crank(t, is_wrapped))
    assert right(found, t).sum() == (38 if known else 0)


def test_a_wrap_that_was_not_declared_costs_two_samples_of_each_turn():
    t = np.arange(400) * 0.01
    estimator = RateEstimator()
    is_known = right(feed(estimator, t, crank(t, True)), t)
    assert estimator.restarts == np.count_nonzero(np.diff(crank(t, True)) < 0.0)
    assert (~is_known).sum() == 2 * (estimator.restarts + 1)


@pytest.mark.parametrize('rate', [4.0, 100.0])
def test_given_velocities_need_no_turns(rate):
    """Wrapped, slow or with a pause: the acceleration follows from the velocities."""
    t = np.cumsum(np.r_[np.full(30, 1.0 / rate), 0.8, np.full(30, 1.0 / rate)])
    angles = 5.0 * t + 2.0 * t**2 + math.pi
    estimator = RateEstimator()
    found = feed(estimator, t, angles % math.tau - math.pi, 5.0 + 4.0 * t)[1:]
    assert np.abs(found[:, 1] - 4.0).max() < 16 * EPS * 100.0 * rate and estimator.restarts == 0
    jump = feed(estimator, [t[-1] + 0.01], [angles[-1] + 2.0], [5.0 + 4.0 * t[-1]])[0]
    assert np.isnan(jump[1]) and estimator.restarts == 1


# --- noise ---------------------------------------------------------------------------------------

def encoder(angle, rng):
    """Round an angle to an encoder of 2000 counts."""
    return np.rint(angle * 1000.0 / np.pi) * np.pi / 1000.0


def gaussian(angle, rng):
    return angle + rng.normal(0.0, 1e-5, angle.size)


@pytest.mark.parametrize('spacing', ['even', 'uneven'])
@pytest.mark.parametrize('disturb', [gaussian, encoder])
@pytest.mark.parametrize('window', [3, 5, 9])
def test_noise_is_the_scatter_of_the_acceleration(window, disturb, spacing):
    rng = np.random.default_rng(3)
    steps = (np.full(6000, 2_000_000) if spacing == 'even'
             else rng.integers(1_000_000, 3_000_000, 6000))
    times = EPOCHS[1] + np.cumsum(steps)
    t = (times - times[0]) * 1e-9
    angles = disturb(7.3 * t + 1.1 * t**2, rng)
    estimator, said, wrong = RateEstimator(window), [], []
    for time, angle in zip(times.tolist(), angles.tolist()):
        _, acceleration = estimator.update(time, angle)
        said.append(estimator.noise)
        wrong.append(acceleration - 2.2)
    said, wrong = np.array(said)[MEMORY:], np.array(wrong)[MEMORY:]
    assert math.sqrt(np.mean(wrong**2)) == pytest.approx(math.sqrt(np.mean(said**2)), rel=0.2)
    assert estimator.is_noise is bool(np.mean(said) > 0.1 * (7.3 + 2.2 * t[-1])**2)


def test_the_noise_of_velocities_and_of_their_acceleration():
    rng = np.random.default_rng(4)
    times = EPOCHS[1] + np.arange(4000) * 2_000_000
    t = np.arange(4000) * 0.002
    for window, gain in ((3, 1 / math.sqrt(2.0)), (5, 1 / math.sqrt(10.0))):
        estimator = RateEstimator(window)
        found = feed(estimator, times, t,
                     1.0 + 3.0 * t + rng.normal(0.0, 1e-3, t.size))[window:, 1]
        assert found.std() == pytest.approx(gain * 1e-3 / 0.002, rel=0.05)
        # of the newest 100
        assert estimator.noise == pytest.approx(gain * 1e-3 / 0.002, rel=0.3)
        assert estimator.lag == pytest.approx((window - 1) * 0.001)


@pytest.mark.parametrize('every', [2, 5, 10, 50])
@pytest.mark.parametrize('has_rates', [False, True])
def test_noise_is_known_between_complete_inputs(every, has_rates):
    """An estimate that is wrong by what is said: of 2,000 inputs of which some have all rates."""
    rng = np.random.default_rng(5)
    t = 0.001 * np.arange(2000)
    angles, rates = 5.0 * t + rng.normal(0.0, 1e-4, t.size), 5.0 + rng.normal(0.0, 1e-2, t.size)
    estimator, said, wrong = RateEstimator(), [], []
    for k, (time, angle, rate) in enumerate(zip(stamps(t).tolist(), angles, rates)):
        is_complete = k % every == 0
        found = estimator.update(time, angle, rate if has_rates or is_complete else math.nan,
                                 0.0 if is_complete else math.nan)
        if k >= MEMORY and not is_complete:
            said.append(estimator.noise)
            wrong.append(found[1])
    assert math.sqrt(np.mean(np.square(wrong))) == pytest.approx(
        math.sqrt(np.mean(np.square(said))), rel=0.2)


def test_noise_is_never_less_than_stamps_and_floats_can_say():
    """A stream without any scatter: whole nanoseconds at 25 rad/s are 7e-9 rad."""
    times = np.arange(50) * 1_000_000
    estimator = RateEstimator(3)
    assert np.isnan(estimator.noise) and not estimator.is_noise
    feed(estimator, times, 25.0 * np.arange(50) * 0.001)
    assert estimator.noise == pytest.approx(math.sqrt(6.0 / 12.0) * 25e-9 / 0.001**2, rel=0.01)
    assert not estimator.is_noise
    at_rest = RateEstimator(3)
    feed(at_rest, times, np.full(50, 1.2217))
    assert at_rest.noise > 0.0 and not at_rest.is_noise
    estimator.reset()
    assert np.isnan(estimator.noise) and np.isnan(estimator.lag)


@pytest.mark.parametrize('window, velocity_noise, acceleration_noise, jerk_share',
                         [(3, 2.55, 2.45, 1 / 3), (5, 1.115, 0.535, 43 / 30)])
def test_noise_and_lag_are_as_documented(window, velocity_noise, acceleration_noise, jerk_share):
    rng = np.random.default_rng(2)
    h, noise = 0.01, 1e-5
    times = np.arange(20000) * h
    found = feed(RateEstimator(window, jump=3.0), times,
                 rng.normal(0.0, noise, times.size))[window:]
    spread = found.std(axis=0) * np.array([h, h**2]) / noise
    # 1/sqrt(20000) = 0.7 %
    assert spread == pytest.approx([velocity_noise, acceleration_noise], rel=0.03)
    jerk, t = 5.0, times[:200]
    found = feed(RateEstimator(window), t, jerk * t**3 / 6.0)[window:]
    assert found[:, 0] - jerk * t[window:]**2 / 2.0 == pytest.approx(-jerk_share * jerk * h**2,
                                                                     rel=1e-3)
    assert found[:, 1] - jerk * t[window:] == pytest.approx(-jerk * h * (window - 1) / 2.0,
                                                            rel=1e-3)


def test_a_slide_does_not_wrap():
    """Three metres a sample are three metres, not half a turn."""
    times = np.arange(10) * 0.1
    found = feed(RateEstimator(jump=100.0, turn=math.inf), times, 40.0 * times)
    assert found[3:, 0] == pytest.approx(40.0, rel=1e-12)
    jump = feed(RateEstimator(jump=1.0, turn=math.inf), [0.0, 0.1, 0.2],
                [0.0, 0.1, 0.1 + 2.0 * np.pi])
    assert np.isnan(jump[2]).all()


@pytest.mark.parametrize('bad', [math.nan, math.inf, -math.inf])
def test_an_input_that_is_no_number_is_not_remembered(bad):
    estimator = RateEstimator()
    feed(estimator, [0.0, 0.1, 0.2], [0.0, 0.1, 0.2])
    assert np.isnan(estimator.update(NS // 4, bad)).all()
    assert (estimator.update(3 * NS // 10, 0.3) == pytest.approx((1.0, 0.0), abs=1e-12)
            and estimator.restarts == 0)


@pytest.mark.parametrize('turn, top_speed', [(math.tau, math.nan), (math.tau, 9.0),
                                             (math.inf, math.nan)])
def test_whatever_comes_it_goes_on(turn, top_speed):
    """Take stamps and floats at their limits in any order; then the estimate recovers."""
    edges = [0.0, -0.0, 1.0, math.nan, math.inf, -math.inf, 5e-324, 1.7e308, -1.7e308, 1e154, 1e16]
    rng = np.random.default_rng(3)
    estimator = RateEstimator(turn=turn, top_speed=top_speed)
    times = np.append(rng.integers(-2**31, 2**31, 20) * NS, rng.integers(-9, 9, 20))
    for time, (position, velocity) in zip(rng.choice(times, 20000).tolist(),
                                          rng.choice(edges, (20000, 2)).tolist()):
        estimator.update(time, position, velocity)
        estimator.is_noise
    estimator.reset()
    assert feed(estimator, [0.0, 0.1, 0.2],
                [0.0, 0.1, 0.2])[-1] == pytest.approx((1.0, 0.0), abs=1e-12)
