"""
Extremes of arbitrary quantities along one input path: interior ones, ends, ranges where they are constant.

Quantities are sampled on the points of :mod:`.elliptic` with their exact derivative to theta1, a complex
step through the same formulas that compute them. Sign changes of the derivative, and dips of its
magnitude between samples, are bracketed, and all brackets of all quantities solved at once.
"""
from __future__ import annotations

from math import comb, inf, nan, pi, sqrt
from types import FunctionType
from typing import NamedTuple

import numpy as np

from .errors import MissingBodies
from .kinematics import Motion, make_motion
from .loads import Loads
from .roots import EPS, bracketed_roots, find_brackets
from .sensitivity import sampled_conditions

# Complex step: its square vanishes beside one, and it is nothing beside the distance of any sample
# from a toggle or a flat position.
STEP = 2.0**-200
# Step of real differences of fourth order, in samples: their error is about that of rounding.
DIFFERENCE = 2.0**-6
# Power of sin(mu) by which derivatives grow at toggles (that of the acceleration; forces grow faster by
# one, rates more slowly). With it they are smooth, that of a magnitude |F| only when multiplied by |F|: near a
# zero of the force it changes suddenly, F . dF/dtheta1 does not.
POLE = 5
# Samples on either side of an end from which the value there is interpolated, on one side if need be.
NEIGHBOURS, ONE_SIDE = 12, 12


def _weights(number, terms):
    """Return weights, of sum one, of Lagrange's formula at 0."""
    weights = np.array([(-1)**j * terms(j) / (j + 0.5) for j in range(number)])
    return weights / weights.sum()


# For samples at +-1/2, 3/2, ... together, and for those on one side.
_THROUGH = 0.5 * _weights(NEIGHBOURS, lambda j: comb(2 * NEIGHBOURS - 1, NEIGHBOURS + j))
_UP_TO = _weights(ONE_SIDE, lambda j: comb(ONE_SIDE - 1, j))


class Found(NamedTuple):
    """One extreme of quantity number ``row``; the other fields as in :class:`.extrema.Extremum`."""

    row: int
    theta1: float
    value: float
    sense: int          # +1 maximum, -1 minimum, 0 constant from here on
    side: int = 0
    is_flat: bool = False
    condition: float = nan
    value_condition: float = nan


class NoLoads:
    """Stands for the loads of a linkage without masses."""

    def __getattr__(self, name):
        raise MissingBodies


def _complex_angle(y, x):
    """Return atan2 with its derivative: the dialect of :mod:`.dialects` leaves angles out."""
    return np.arctan2(y.real, x.real) + 1j * (x.real * y.imag - y.real * x.imag) / (x.real**2 + y.real**2)


_MOTION_WITH_ANGLES = FunctionType(make_motion.analytic.__code__,
                                   {**make_motion.analytic.__globals__, 'atan2': _complex_angle})


class Sampler:
    """Values and derivatives of some quantities of a linkage in its mode."""

    def __init__(self, linkage, quantities, omega1, alpha1, with_angles=False):
        self.linkage, self.quantities, self.rates = linkage, quantities, (omega1, alpha1)
        self.with_angles = with_angles
        self.needs_loads = any(q.is_load for q in quantities)
        if self.needs_loads and linkage.bodies is None:
            raise MissingBodies
        self._functions = {1: (linkage._motion[1], self.needs_loads and linkage._loads[1]),
                           2: (linkage._motion[2], self.needs_loads and linkage._loads[2])}
        if with_angles:
            motion = _MOTION_WITH_ANGLES(*linkage.lengths, linkage.sign)
            self._functions[2] = motion, linkage.bodies and linkage._loads[2]
            self._functions[1] = linkage._motion[1], linkage.bodies and linkage._loads[1]

    def of(self, linkage):
        """Return the same for another linkage."""
        return type(self)(linkage, self.quantities, *self.rates, self.with_angles)

    def state(self, x):
        """Return (Motion, Loads) at real or complex x."""
        motion, loads = self._functions[2 if x.dtype.kind == 'c' else 1]
        with np.errstate(all='ignore'):
            fields = motion(x, *self.rates)
            return Motion(*fields), Loads(*loads(fields)) if loads else NoLoads()

    def values(self, x):
        """Return the quantities at x, shape (quantities, x.size)."""
        state = self.state(x)
        with np.errstate(all='ignore'):
            return self._rows(state, x)

    def _rows(self, state, x):
        rows = np.empty((len(self.quantities), x.size), x.dtype)
        for row, quantity in zip(rows, self.quantities):
            row[:] = quantity.of(*state)
        return rows

    def sample(self, x):
        """Return values and derivatives at the samples of a path."""
        values = self.values(x + 1j * STEP)
        return values.real, values.imag / STEP

    def at(self, x, row):
        """Return value and derivative of quantity ``row[i]`` at x[i]."""
        values = self.values(x + 1j * STEP)[row, np.arange(x.size)]
        return values.real, values.imag / STEP

    def slope(self, x, row):
        """Return the derivative of quantity ``row[i]`` at x[i]."""
        return self.at(x, row)[1]

    def noise(self, state):
        """
        Return a bound of the rounding errors of each quantity, shape (quantities, n).

        By the sizes of the terms it is a sum of, as far as they are known: of a balanced linkage the
        shaking force is the noise of the joint reactions.
        """
        motion, loads = state
        omega1, alpha1 = self.rates
        a1, a2, a3, a4 = self.linkage.lengths
        gain = min(1.0, a1 / min(a2, a3))
        scales = {'rad/s': gain * abs(omega1), 'rad/s^2': gain * (abs(alpha1) + omega1**2)}
        if self.needs_loads:
            scales['N'] = force = sum(abs(f.real) for f in (loads.f41, loads.f21, loads.f32, loads.f43))
            scales['N m'] = max(self.linkage.lengths) * force
        rows = np.stack([np.broadcast_to(scales.get(q.unit, 0.0), motion.sin_mu.shape)
                         for q in self.quantities])
        return 64.0 * EPS * rows / np.minimum(np.abs(motion.sin_mu.real), 1.0)


class DifferenceSampler(Sampler):
    """The same for functions without a complex step (abs, max, a table): derivatives by differences."""

    def __init__(self, linkage, quantities, omega1, alpha1, with_angles=True):
        super().__init__(linkage, quantities, omega1, alpha1, with_angles)
        self._x = None      # samples of the path in rising order

    def of(self, linkage):
        other = super().of(linkage)
        other._x = self._x
        return other

    def _rows(self, state, x):
        try:
            return super()._rows(state, x)
        except (TypeError, ValueError):       # a function of plain numbers: one sample at a time
            motion, loads = state
            loads_of = ((Loads(*v) for v in zip(*(f.tolist() for f in loads)))
                        if isinstance(loads, tuple) else (loads for _ in x))
            states = [(Motion(*v), w) for v, w in zip(zip(*(np.broadcast_to(f, x.shape).tolist() for f in motion)),
                                                      loads_of)]
            return np.array([[q.of(*s) for s in states] for q in self.quantities], dtype=float)

    def sample(self, x):
        self._x = x[np.argsort(x)]
        return self.values(x), np.stack([self.slope(x, np.full(x.size, row))
                                         for row in range(len(self.quantities))])

    def step(self, x):
        """Return the step of differences at x: a part of the distance between the samples around it."""
        i = np.clip(np.searchsorted(self._x, x), 1, self._x.size - 1)
        return DIFFERENCE * (self._x[i] - self._x[i - 1])

    def at(self, x, row):
        h = self.step(x)
        points = np.concatenate((x, x + h, x - h, x + 2.0 * h, x - 2.0 * h))
        value, *around = np.split(self.values(points)[np.tile(row, 5), np.arange(points.size)], 5)
        return value, (8.0 * (around[0] - around[1]) - (around[2] - around[3])) / (12.0 * h)

    def polish(self, x, row, sense):
        """Return x, or where it is a kink the place of the extreme by golden section around x."""
        low, high = x - 4.0 * self.step(x), x + 4.0 * self.step(x)
        part, i = 0.5 * (sqrt(5.0) - 1.0), np.arange(x.size)
        for _ in range(56):
            one, other = high - part * (high - low), low + part * (high - low)
            keeps_low = sense * self.values(one)[row, i] > sense * self.values(other)[row, i]
            low, high = np.where(keeps_low, low, one), np.where(keeps_low, other, high)
        better = 0.5 * (low + high)
        gain = sense * (self.values(better)[row, i] - self.values(x)[row, i])
        return np.where(gain > 64.0 * EPS * np.abs(self.values(x)[row, i]), better, x)


def fold(x):
    """Return angles, an array or a float of at most a turn less or more, in [0, 2 pi)."""
    if isinstance(x, float):
        x = x + 2.0 * pi if x < 0.0 else x - 2.0 * pi if x >= 2.0 * pi else x + 0.0
        return x if x < 2.0 * pi else 0.0      # a tiny negative angle rounds to the full turn
    x = np.where(x < 0.0, x + 2.0 * pi, np.where(x >= 2.0 * pi, x - 2.0 * pi, x + 0.0))
    return np.where(x < 2.0 * pi, x, 0.0)


def search_path(sampler, path, with_conditions=True):
    """Return the list of :class:`Found` of all quantities along one :class:`.elliptic.InputPath`."""
    values, slopes = sampler.sample(path.theta1)
    middle = np.median(values, axis=1)
    state = sampler.state(path.theta1)
    noise = np.maximum(sampler.noise(state), 64.0 * EPS * np.abs(middle)[:, None])
    varies = (np.abs(values - middle[:, None]) > noise).any(axis=1)
    middle[np.abs(middle) <= noise.min(axis=1)] = 0.0
    start = 0.0 if path.is_closed else path.low.theta1
    found = [Found(row, fold(start), float(middle[row]), 0, 0 if path.is_closed else 1)
             for row in np.nonzero(~varies)[0].tolist()]
    rows = np.nonzero(varies)[0]
    if rows.size:
        found += _interior(sampler, path, values, slopes, state, rows, with_conditions)
    if not path.is_closed:
        inward = np.arange(path.theta1.size)
        found += _end(sampler, path.theta1, path.low, +1, inward, path.first, values, slopes, noise, rows)
        found += _end(sampler, path.theta1, path.high, -1, inward[::-1], path.last, values, slopes, noise, rows)
    return found


def _interior(sampler, path, values, slopes, state, rows, with_conditions):
    """Return what the quantities ``rows`` do between the ends."""
    sine = np.abs(state[0].sin_mu)
    values = values[rows]
    scale = np.where((values > 0.0).all(axis=1, keepdims=True), values * sine**(2 * POLE - 1), sine**POLE)
    _, row, xa, xb, fa, fb = find_brackets(lambda x, row: sampler.slope(x, rows[row]), lambda i, row: path.theta1[i],
                                           slopes[rows].T, path.is_closed, scale.T)
    row = rows[row]
    if not row.size:
        return []
    root = bracketed_roots(sampler.slope, row, xa, xb, fa, fb)
    sense = np.where(fa >= 0.0, 1, -1)
    if isinstance(sampler, DifferenceSampler):
        root = sampler.polish(root, row, sense)
    theta1 = fold(root)
    value = sampler.values(theta1)[row, np.arange(row.size)]
    conditions = (sampled_conditions(sampler, root, row, np.abs(xb - xa)) if with_conditions
                  else np.full((2, row.size), nan))
    return [Found(*fields, 0, False, *pair) for *fields, pair in zip(
        *(v.tolist() for v in (row, theta1, value, sense)), zip(*(v.tolist() for v in conditions)))]


def _end(sampler, x, end, side, inward, first, values, slopes, noise, rows):
    """
    Return what the quantities ``rows`` do at an end.

    ``inward``: the indices of all samples, the nearest to the end first; ``first``: of the sample half a
    step away. Quantities are meromorphic in u: one that grows twofold each time the distance falls to a
    quarter has a pole. The others go on smoothly into the other assembly mode.
    """
    size = np.abs(values[:, inward[:3]])
    has_pole = (size[:, 0] > 2.0 * size[:, 1]) & (size[:, 1] > 2.0 * size[:, 2])
    limits = np.where(values[:, inward[0]] > 0.0, inf, -inf)
    if not has_pole[rows].all():
        near = first + side * np.arange(NEIGHBOURS)
        other = sampler.of(sampler.linkage.in_mode(3 - sampler.linkage.mode))
        beyond = other.values(2.0 * end.theta1 - x[near] if end.is_flat else x[near])
        bounded = (values[:, near] + beyond) @ _THROUGH
        one_sided = values[:, first + side * np.arange(ONE_SIDE)] @ _UP_TO
        # Angles are folded there: they do not go on, and are extrapolated, at the loss of three digits.
        folded = np.abs(one_sided - bounded) > 1e-6 * np.ptp(values[:, near], axis=1)
        bounded = np.where(folded, one_sided, bounded)
        bounded[np.abs(bounded) <= noise[:, first]] = 0.0
        limits = np.where(has_pole, limits, bounded)
    rises = slopes[:, inward[0]] * side > 0.0        # seen from the end
    sense = np.where(has_pole, np.sign(limits), np.where(rises, -1, 1)).astype(int)
    theta1 = fold(end.theta1)
    return [Found(row, theta1, float(limits[row]), int(sense[row]), side, end.is_flat) for row in rows.tolist()]
