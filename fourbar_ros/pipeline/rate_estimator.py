# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Rates of the input, estimated from a stream that lacks some: causal, by the stamps as they come.

The newest ``window`` samples are fitted by a parabola (least squares in time, any spacing), and
its slope and curvature at the newest sample are the estimate. It is exact if the samples lie on a
parabola. If the stream carries the velocity, a straight line through the newest velocities gives
the acceleration.

Stamps are whole nanoseconds. Only differences of stamps and of positions are used: no digit is
lost to the age of the clock or to the turns of a crank. The errors left are those of the samples.
A stamp that is good to dt and a position that is good to dx make a position noise s of hypot(dx,
velocity dt). A third derivative j (jerk) is seen late. For equal steps h and window n

* window 3: velocity wrong by j h^2/3 with noise 2.5 s/h; acceleration late by h (wrong by j h)
  with noise 2.4 s/h^2,
* window 5: velocity wrong by 1.43 j h^2 with noise 1.1 s/h; acceleration late by 2 h with noise
  0.53 s/h^2.

In general the acceleration is late by half the window, (n - 1) h/2. A test measures these figures.
Two samples give the velocity in their middle, wrong by the acceleration times h/2.

Positions count their turns: a step is taken as it is. Where they wrap after a turn, a step tells
the motion only if it is known to be short, from the largest speed of the input: below a quarter
turn, so that stamps may be as wrong as the step is long.

The stream itself shows the noise of an acceleration: each new sample is compared with the
prediction of the fit before it. :attr:`RateEstimator.noise` is the standard deviation from that.
"""
from collections import deque
from collections.abc import Sequence
from math import hypot, inf, isfinite, isinf, isnan, nan, remainder, sqrt, tau, ulp
from typing import NamedTuple

from fourbar_ros.scene.message_fields import nanoseconds
from fourbar_ros.scene.scene import Scene

NANOSECOND = 1e-9        # [s]
MEMORY = 100             # samples over which noise and size of the acceleration are averaged
ENOUGH = 10              # of them before anything is reported
ROUNDED = sqrt(1 / 12)   # standard deviation of rounding to whole units
TOO_NOISY = 0.1          # noise over size of the acceleration from which it is worth a warning


class Estimate:
    """
    Least-squares polynomial of degree 1 or 2 through points (t, y).

    The basis polynomials are orthogonal on the points: no normal equations, so no loss of digits.
    Degree 2 needs three points, degree 1 two; t must differ. ``slope`` and ``curvature`` are taken
    at t = 0; the curvature of a line is NaN. ``lag``: how much older than t = 0 the highest
    derivative is, the mean age of the points.
    """

    def __init__(self, points: Sequence[tuple[float, float]], degree: int) -> None:
        """Fit the points; t [s] is 0 for the newest sample and negative before."""
        # y(t) = start + slope p1(t) + bend p2(t), with p1 and p2 orthogonal on the points
        n = len(points)
        mean = sum(t for t, _ in points) / n
        line = [t - mean for t, _ in points]                              # p1(t) = t - mean
        norm = sum(p * p for p in line)
        slope = sum(p * y for p, (_, y) in zip(line, points)) / norm
        self._start, self._slope = sum(y for _, y in points) / n, slope
        self._mean, self._norm = mean, norm
        self.lag, self.degree, self._n = -mean, degree, n
        self.slope, self.curvature = slope, nan
        if degree == 2:
            shift = sum(p**3 for p in line) / norm       # p2 = p1^2 - shift p1 - norm/n
            curve = [p * p - shift * p - norm / n for p in line]
            self._shift, self._curve_norm = shift, sum(p * p for p in curve)
            # less the line: what is left of y keeps its digits
            self._bend = sum(q * (y - self._start - slope * p) for q, p, (_, y)
                             in zip(curve, line, points)) / self._curve_norm
            self.slope += self._bend * (-2.0 * mean - shift)
            self.curvature = 2.0 * self._bend

    @property
    def gain(self) -> float:
        """
        Return the standard deviation of the highest derivative over that of one y.

        The highest derivative is the slope of a line [1/s], the curvature of a parabola [1/s^2].
        """
        return 2.0 / sqrt(self._curve_norm) if self.degree == 2 else 1.0 / sqrt(self._norm)

    def surprise(self, t: float, y: float) -> float:
        """
        Return the distance of a new point from the prediction, scaled to the noise of one y.

        The prediction is noisy too. So the distance is divided by the square root of 1 + its
        variance (for points with variance 1): the mean square is then the variance of one y.
        """
        p = t - self._mean                   # p1(t), below p2(t), as in __init__
        predicted = self._start + self._slope * p
        variance = 1.0 + 1.0 / self._n + p * p / self._norm
        if self.degree == 2:
            q = p * p - self._shift * p - self._norm / self._n
            predicted += self._bend * q
            variance += q * q / self._curve_norm
        return (y - predicted) / sqrt(variance)


class _Sample(NamedTuple):
    """An input: stamp [ns], position, velocity, change of position; NaN if it is not believed."""

    time: int
    position: float
    velocity: float
    step: float = nan


KEY, VERSION = 'estimator', 5      # bags keep the version of the estimator that made their rates


class RateEstimator:
    """
    Fills in missing velocity and acceleration of the input.

    It fits the ``window`` newest samples, 3 or more. A pause, or a step back of the clock, above
    ``gap`` [s] starts afresh, and so does a step between two samples above ``jump`` [rad, m], or
    one that differs by more from the step expected at the velocity before (of samples with
    velocities only the latter, without whole turns). ``turn``: of the input [rad], infinite
    without one. ``length``: unit of the input [rad, m], an acceleration of velocity^2/length
    always matters. ``top_speed`` [rad/s] is given if positions wrap after a turn: whole turns are
    taken off a step; one that takes so long that it could be a quarter turn starts afresh.
    """

    def __init__(self, window: int = 5, gap: float = 1.0, jump: float = 1.0,
                 turn: float = tau, length: float = 1.0, top_speed: float = nan) -> None:
        """Begin without samples."""
        self._gap, self._jump, self._turn, self._length = nanoseconds(gap), jump, turn, length
        self._top_speed = top_speed
        self._samples: deque[_Sample] = deque(maxlen=window)
        # how often it started afresh, and samples that are not newer than the newest
        self.restarts = self.late = 0
        # mean squares of the distances from the predictions, and of the accelerations
        self._scatter, self._size = _MeanSquare(), _MeanSquare()
        self._from_rates = False                 # whether the acceleration comes from velocities
        self.reset()

    def reset(self) -> None:
        self._samples.clear()
        # a sample older than the newest one, if it came last
        self._late_sample: _Sample | None = None
        self._fit: Estimate | None = None
        self._estimate = nan, nan               # velocity and acceleration at the newest sample

    @property
    def noise(self) -> float:
        """Return the standard deviation of the estimated acceleration, NaN if not known yet."""
        if self._fit is None or isnan(self._estimate[1]) or self._scatter.count < ENOUGH:
            return nan
        return self._fit.gain * sqrt(max(self._scatter.value, self._resolution**2))

    @property
    def lag(self) -> float:
        """Return by how much the estimated acceleration is late [s], NaN if there is none."""
        return nan if self._fit is None or isnan(self._estimate[1]) else self._fit.lag

    @property
    def is_noise(self) -> bool:
        """
        Return whether noise is a large part of the acceleration, or of velocity^2/length.

        False if the noise is in the last digit alone, as at rest.
        """
        return (self.noise > TOO_NOISY * sqrt(self._size.value)
                and self._scatter.value > self._resolution**2)

    def update(self, time: int, position: float, velocity: float = nan,
               acceleration: float = nan) -> tuple[float, float]:
        """
        Return (velocity, acceleration) at a new sample; NaN for what is not known yet.

        ``time`` is its stamp [ns]; ``position`` an angle [rad], wrapped or not, or a slide [m];
        ``velocity`` and ``acceleration`` NaN where it has none. A sample that comes again keeps
        its rates. Another one with the same stamp is late, as is one that goes back: it leaves the
        memory as it is. If a stamp goes back by more than ``gap``, or the next one follows it
        there, the clock was set and the estimate starts afresh.
        """
        if not isfinite(position) or isinf(velocity):
            return velocity, nan                 # nothing to remember
        sample = _Sample(time, position, velocity)
        newest = self._samples[-1] if self._samples else None
        if newest and time == newest.time:
            if position == newest.position and (velocity == newest.velocity or isnan(velocity)):
                return self._estimate
            self.late += 1
            return velocity, nan
        if newest and 0 < newest.time - time < self._gap and not self._is_set_back(sample):
            return velocity, nan
        self._late_sample = None
        is_complete = isfinite(velocity) and isfinite(acceleration)
        self._append(sample, is_complete)
        if is_complete:                          # nothing to estimate this time
            self._fit, self._estimate = None, (velocity, acceleration)
        else:
            self._estimate = self._fitted(velocity)
        return self._estimate

    def _is_set_back(self, sample: _Sample) -> bool:
        # It is if this is the second late sample in a row, and later than the first; then the
        # estimate starts afresh from the first. A single late one was overtaken on its way.
        before, self._late_sample = self._late_sample, sample
        if before is None or sample.time <= before.time:
            self.late += 1
            return False
        self._restart()
        self._append(before, False)
        return True

    def _restart(self) -> None:
        self.reset()
        self.restarts += 1

    def _append(self, sample: _Sample, is_complete: bool) -> None:
        """
        Keep a sample with its step [rad, m], NaN if that is not believed: too long or unexpected.

        The estimate starts afresh after a gap or an unexpected step. The distance of the sample
        from the fit before it tells the noise: of positions or of velocities, whichever the latest
        estimate was from.
        """
        if not self._samples:
            self._samples.append(sample)
            return
        last = self._samples[-1]
        t, step = (sample.time - last.time) * NANOSECOND, sample.position - last.position
        if not isnan(self._top_speed):
            step = _without_turns(step, self._turn)
        rates = [v for v in (self._estimate[0], sample.velocity) if isfinite(v)]
        surprise = step - t * sum(rates) / len(rates) if rates else step
        is_believed = (abs(step) <= self._jump and abs(surprise) <= self._jump
                       and not t * self._top_speed >= 0.25 * self._turn)
        is_steady = is_believed
        if isfinite(sample.velocity):                # positions need not tell the rate
            is_steady = abs(_without_turns(surprise, self._turn)) <= self._jump
        from_rates = self._from_rates if is_complete else isfinite(sample.velocity)
        if not (is_steady and 0 < sample.time - last.time <= self._gap):
            self._restart()
        elif from_rates is not self._from_rates:
            self._from_rates, self._scatter = from_rates, _MeanSquare()
        elif self._fit and (from_rates or is_believed and self._fit.degree == 2):
            y = sample.velocity - last.velocity if from_rates else step
            self._scatter.add(self._fit.surprise(t, y))
        self._samples.append(sample._replace(step=step if is_believed else nan))

    def _fitted(self, velocity: float) -> tuple[float, float]:
        """
        Return (velocity, acceleration) at the newest sample by a fit through all that are kept.

        ``velocity``: of the sample, or NaN. A line through velocities, or a parabola through
        positions as far back as their steps are believed; times from the newest sample.
        """
        newest = self._samples[-1]
        from_rates = isfinite(velocity)
        if from_rates:
            points = [((sample.time - newest.time) * NANOSECOND, sample.velocity - velocity)
                      for sample in self._samples if isfinite(sample.velocity)]
        else:
            points, position = [], 0.0       # from that of the newest sample
            for sample in reversed(self._samples):
                points.append(((sample.time - newest.time) * NANOSECOND, position))
                position -= sample.step
                if isnan(position):
                    break
        degree = min(1 if from_rates else 2, len(points) - 1)
        self._fit = fit = Estimate(points, degree) if degree else None
        if not fit:
            return velocity, nan
        last_digit = ulp(velocity if from_rates else newest.position)
        self._resolution = ROUNDED * hypot(last_digit, fit.slope * NANOSECOND)
        acceleration = fit.slope if from_rates else fit.curvature
        velocity = velocity if from_rates else fit.slope
        self._size.add(hypot(acceleration, velocity * velocity / self._length))
        return velocity, acceleration


def gap_of(timeout: float) -> float:
    """Return the pause after which rates start afresh [s]: a timeout, 1 s where there is none."""
    return timeout if timeout != 0.0 else 1.0


def estimator_settings(scene: Scene) -> tuple[float, ...]:
    """Return the settings of an estimator that may change while a node runs; 0: not given."""
    drive = scene.drive
    return (drive.window, gap_of(drive.timeout), drive.jump,
            0.0 if isnan(drive.top_speed) else drive.top_speed)


def estimator_of(scene: Scene) -> RateEstimator:
    """Return the :class:`RateEstimator` of a scene: where turns count, no step is a turn."""
    drive, linkage = scene.drive, scene.linkage
    is_slide = linkage.is_driven_by_slide
    return RateEstimator(drive.window, gap_of(drive.timeout), drive.jump,
                         inf if is_slide or scene.must_count_turns else tau,
                         max(linkage.lengths) if is_slide else 1.0, drive.top_speed)


def _without_turns(step: float, turn: float) -> float:
    """Return a step less whole turns; two positions of 1e308 can be infinitely far apart."""
    return remainder(step, turn) if isfinite(step) else step


class _MeanSquare:
    """Mean square of about the newest MEMORY values; those that are not finite are left out."""

    def __init__(self) -> None:
        self.value, self.count = 0.0, 0

    def add(self, x: float) -> None:
        if isfinite(square := x * x):
            self.count = min(self.count + 1, MEMORY)
            self.value += (square - self.value) / self.count
