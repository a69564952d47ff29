"""
Rates of the input from a stream that does not carry them all: causal, on the stamps as they come.

The newest ``window`` samples are fitted by a parabola (least squares in time, any spacing), and its slope
and curvature at the newest sample are the estimate: exact for constant acceleration. If the stream
carries the velocity, a straight line through the newest velocities gives the acceleration.

For equal steps h, window n, a position noise of standard deviation s and a third derivative j (jerk)

* window 3: velocity wrong by j h^2/3 with noise 2.5 s/h; acceleration late by h (wrong by j h), noise 2.4 s/h^2,
* window 5: velocity wrong by 1.43 j h^2 (noise 1.1 s/h), acceleration late by 2 h, noise 0.53 s/h^2.

In general the acceleration is late by half the window, (n - 1) h/2. A test measures these figures.
"""
from __future__ import annotations

from collections import deque
from math import isfinite, nan, remainder, tau

KEY, VERSION = 'estimator', 2      # bags keep which version their rates were estimated by


class RateEstimator:
    """
    Fills in missing velocity and acceleration of an angle.

    Parameters
    ----------
    window : int
        Number of newest samples that are fitted, 3 or more.
    gap : float
        A longer pause [s], or a longer step back of the clock, starts afresh.
    jump : float
        A larger step between two samples [rad, m], after taking off whole turns, starts afresh.
    period : float
        A turn of the input; infinite for one that slides.

    """

    def __init__(self, window=5, gap=1.0, jump=1.0, period=tau):
        self._gap, self._jump, self._period = gap, jump, period
        self._samples = deque(maxlen=window)     # (time, unwrapped angle, velocity), newest last
        self.restarts = 0                        # after a jump, a gap, a clock set back
        self.late = 0                            # samples older than the newest

    def reset(self):
        """Forget all samples."""
        self._samples.clear()

    def update(self, time, position, velocity=nan):
        """
        Return (velocity, acceleration) at a new sample; NaN for what is not known yet.

        Parameters
        ----------
        time : float
            Stamp [s]. One that stands still or goes back leaves the memory as it is, unless it goes back by
            more than ``gap``: then the clock was set and the estimate starts afresh.
        position, velocity : float
            Angle [rad], wrapped or not, or slide [m], and its rate, NaN if the stream has none.

        """
        samples = self._samples
        if not isfinite(position):
            return velocity, nan                 # nothing to remember
        if samples:
            last_time, last_angle, _ = samples[-1]
            if time == last_time:
                return self._estimate(velocity)
            if last_time - self._gap < time < last_time:
                self.late += 1
                return velocity, nan
            step = position - last_angle
            step = remainder(step, self._period) if isfinite(step) else step      # two of 1e308 can overflow
            if abs(time - last_time) > self._gap or abs(step) > self._jump:
                samples.clear()
                self.restarts += 1
            else:
                position = last_angle + step
        samples.append((time, position, velocity))
        return self._estimate(velocity)

    def _estimate(self, velocity):
        now = self._samples[-1][0]
        if isfinite(velocity):
            known = [(t - now, v) for t, _, v in self._samples if isfinite(v)]
            return velocity, _slope(known) if len(known) > 1 else nan
        newest = self._samples[-1][1]
        return _parabola([(t - now, x - newest) for t, x, _ in self._samples])


def _slope(points):
    """Return the slope of the least-squares line through points (t, y)."""
    mean_t = sum(t for t, _ in points) / len(points)
    return (sum((t - mean_t) * y for t, y in points) / sum((t - mean_t)**2 for t, _ in points))


def _parabola(points):
    """
    Return slope and curvature at t = 0 of the least-squares parabola through points (t, y).

    By polynomials orthogonal on the points: no normal equations, so no loss of digits. Two points give
    a slope only, one nothing.
    """
    n = len(points)
    if n < 2:
        return nan, nan
    mean = sum(t for t, _ in points) / n
    line = [t - mean for t, _ in points]                              # p1(t) = t - mean
    norm1 = sum(p * p for p in line)
    slope = sum(p * y for p, (_, y) in zip(line, points)) / norm1
    if n < 3:
        return slope, nan
    shift = sum(p**3 for p in line) / norm1                           # p2 = p1^2 - shift p1 - norm1/n
    curve = [p * p - shift * p - norm1 / n for p in line]
    bend = sum(p * y for p, (_, y) in zip(curve, points)) / sum(p * p for p in curve)
    return slope + bend * (-2.0 * mean - shift), 2.0 * bend
