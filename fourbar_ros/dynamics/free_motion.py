# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Free conservative motion without integration over time: energy gives the rate, quadrature the time.

    t = integral of sqrt(J / (2 (E - V))) dq                                               (F1)

A crank that goes round has u = +-q; an input that swings between turning points q = c +- h has

    q = c + h sin u,   dt/du = h cos u sqrt(J / (2 (E - V)))                                (F2)

Either way dt/du is a smooth periodic function of u. Its Fourier series from equal samples
converges exponentially and is integrated term by term; u(t) follows by Newton's method.
"""
from __future__ import annotations

from functools import cached_property
from math import pi, tau
from typing import Any

from fourbar_ros.dynamics.model.smooth import flat_positions
from fourbar_ros.dynamics.model.system import System
from fourbar_ros.dynamics.solve.integrators import Part
from fourbar_ros.dynamics.solve.phase import COMPLETE
from fourbar_ros.dynamics.statics import roots_of
from fourbar_ros.errors import FourBarError, InvalidParameter
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.numerics.arrays import Array, Value
import numpy as np
from numpy.typing import ArrayLike, NDArray

ComplexArray = NDArray[np.complexfloating[Any, Any]]
MOST_SAMPLES, MOST_TO_FOLLOW = 2**17, 2**13      # with more, other methods are as fast
A_PERIOD, MOST_TIMES = 32, 1024      # times of a run, if none are asked for
TOGETHER = 2**20       # numbers of a series at several times
ROUNDING = 64.0 * 2.0**-52        # of the energy over the sizes of its parts
SMALL = 1e-15          # of the last Fourier coefficients to the first
RESOLVED = 1e-6        # the same, at least
NARROWEST = 14.0       # samples times the distance of a singularity from the real inputs: e^-14
NOT_RESOLVED = 'dt/du of the free motion needs more samples than allowed'


class NotResolved(FourBarError, ArithmeticError):
    """The motion has features too narrow for the largest Fourier series."""


class FreeMotion:
    """
    Motion of a system without drive and dampers, from its energy.

    Parameters
    ----------
    system : System
        Conservative, not at rest in an equilibrium.
    most : int
        Largest number of samples.
    start : tuple, optional
        Input and rate at the start, in place of those of the system.

    Raises
    ------
    InvalidParameter
        For a system that is not conservative or does not move, or that reaches a limit of its
        input.
    NotResolved
        Where dt/du needs more samples.

    """

    def __init__(self, system: System, most: int = MOST_SAMPLES,
                 start: tuple[float, float] | None = None) -> None:
        """Find the energy and, if the motion swings, its turning points."""
        if not system.is_conservative:
            raise InvalidParameter('system', None, 'must be without drive, dampers and couples')
        self._equation, mechanism = system.equation, system.mechanism
        self._most = most
        self._start, rate = start or system.start
        self._system, self._rate = system, rate
        self.energy = float(self._equation.energy(self._start, rate))
        ends = self._turning_points(mechanism, rate)
        self.swings = ends is not None
        low, high = ends or (0.0, 0.0)
        self._middle, self._half = 0.5 * (low + high), 0.5 * (high - low)
        self._direction = 1.0 if rate > 0.0 else -1.0
        # of u: a crank that alternates its mode is where it was after two turns
        self._cycle = tau if ends else tau * (1 + len(flat_positions(mechanism)) % 2)

    def _turning_points(self, mechanism: Mechanism, rate: float) -> tuple[float, float] | None:
        """
        Return the inputs between which the motion swings, or None for a crank that goes round.

        Raises InvalidParameter for an equilibrium, and for a motion that reaches a limit.
        """
        if rate == 0.0:      # the start is a turning point: the force says which
            pushes = self._equation.terms(self._start).force
            if pushes == 0.0:
                raise InvalidParameter('system', None, 'must not rest in an equilibrium')
            one: float | None = float(self._start)
            other = self._turning_point(mechanism, 1.0 if pushes > 0.0 else -1.0, at_rest=True)
        else:
            one, other = (self._turning_point(mechanism, side) for side in (-1.0, 1.0))
            if one is None and other is None and mechanism.turns_fully:
                return None
        if one is None or other is None:
            raise InvalidParameter('system', None, 'must not reach a limit of its input')
        return min(one, other), max(one, other)

    def _turning_point(self, mechanism: Mechanism, side: float,
                       at_rest: bool = False) -> float | None:
        """
        Return the nearest input on one side (+-1) of the start where all energy is potential.

        Searched on samples, dense next to the start: from rest (``at_rest``) the start itself, the
        other turning point, is left out. None if there is none within a turn, or the range.
        """
        reach = tau
        if not mechanism.turns_fully:
            start = self._system.course.continuous(float(self._start))
            inside = [(low, high) for low, high in mechanism.input_ranges if low <= start <= high]
            if not inside:
                raise InvalidParameter('system', None, 'must start in the range of its input')
            reach = inside[0][1] - start if side > 0.0 else start - inside[0][0]
        near = np.geomspace(1e-9, 1e-3, 25)[:-1]
        far = 1e-3 + (1.0 - 1e-3) * np.sin(np.linspace(0.0, 0.5 * pi, 2048))
        # not quite to the end, where a toggle may be
        parts = np.concatenate([near, far * (1.0 - 1e-9)]) if at_rest else np.concatenate(
            [[0.0], near, far * (1.0 - 1e-9)])
        places = roots_of(lambda q: self.energy - self._equation.potential(q),
                          self._start + side * reach * parts)
        return min(places, key=lambda place: abs(place - self._start), default=None)

    @cached_property
    def _phase(self) -> float:
        """Return u at the start; near a turning point from the rate, which tells it better."""
        if not self.swings:
            return float(self._direction * self._start)
        sine = min(max((self._start - self._middle) / self._half, -1.0), 1.0)
        phase = float(np.arcsin(sine))
        if abs(sine) > 0.5:      # near a turning point the rate tells it better, (F2)
            beside = float(np.arcsin(min(abs(self._rate) * self._time(np.array(phase))[1]
                                         / self._half, 1.0)))
            phase = 0.5 * pi - beside if sine > 0.0 else beside - 0.5 * pi
        return phase if self._rate >= 0.0 else pi - phase

    def _input(self, u: Value) -> Value:
        return self._middle + self._half * np.sin(u) if self.swings else self._direction * u

    def _slope(self, u: Array) -> Array:
        """Return dt/du [s] at the phases u, by (F1) or (F2): the samples of the Fourier series."""
        q = self._input(u)
        inertia, spare = self._equation.terms(q).inertia, self.energy - self._equation.potential(q)
        scale = (self._half * np.cos(u))**2 if self.swings else 1.0
        # rounding may make it negative
        with np.errstate(divide='ignore'):
            slope: Array = np.sqrt(scale * inertia / (2.0 * np.abs(spare)))
        return slope

    @cached_property
    def _resolved(self) -> tuple[float, ComplexArray]:
        """
        Return the relative size of the last Fourier coefficients of dt/du, and those above it.

        Samples are doubled until the last eighth of the coefficients is nothing but rounding.
        """
        # a peak between all samples would leave no trace in the series
        width = min((abs(z.imag) for z in self._equation.mechanism.singular_inputs if z.imag),
                    default=np.inf) / (self._half if self.swings else 1.0)
        if width * self._most < NARROWEST:
            raise NotResolved(NOT_RESOLVED)
        best: tuple[float, ComplexArray] = (np.inf, np.empty(0, complex))
        count = 32
        while best[0] > SMALL and count < self._most:
            count *= 2
            u = (np.arange(count) + 0.5) * (self._cycle / count)
            slope = self._slope(u)
            if not np.all(np.isfinite(slope)):
                break
            series = np.fft.rfft(slope) / count
            # samples at half steps
            series *= np.exp(-1j * np.arange(series.size) * (pi / count))
            tail = float(np.max(np.abs(series[-count // 8:])) / abs(series[0]))
            if tail < best[0]:
                best = tail, series
            elif best[0] < 1e-8 and tail > 4.0 * best[0]:
                # rounding of E - V, which grows towards the turning points, governs
                break
        if best[0] > RESOLVED:
            raise NotResolved(NOT_RESOLVED)
        last = np.flatnonzero(np.abs(best[1]) > best[0] * abs(best[1][0]))[-1]
        return max(best[0], SMALL), best[1][:last + 1]

    @property
    def accuracy(self) -> float:
        """Return the expected relative error of times, from terms that the series leaves out."""
        return self._resolved[0]

    @property
    def _series(self) -> ComplexArray:
        return self._resolved[1]

    @property
    def period(self) -> float:
        """Return the time of a turn (two, if the mode alternates) or of a full swing [s]."""
        return float(self._cycle * self._series[0].real)

    def _time(self, u: Array) -> tuple[Array, Array]:
        """Return the time since u = 0 and dt/du [s], from the Fourier series and its integral."""
        k = np.arange(1, self._series.size) * (tau / self._cycle)
        mean, parts = self._series[0].real, []
        for part in np.array_split(np.atleast_1d(u), 1 + np.size(u) * k.size // TOGETHER):
            waves = 2.0 * self._series[1:] * np.exp(1j * np.multiply.outer(part, k))
            parts.append((mean * part + np.sum((waves / (1j * k)).real, -1),
                          mean + np.sum(waves.real, -1)))
        time, slope = (np.concatenate(rows) for rows in zip(*parts))
        return time.reshape(np.shape(u)), slope.reshape(np.shape(u))

    def states(self, times: ArrayLike) -> Array:
        """
        Return input [rad] or [m] and rate [rad/s] or [m/s] at these times [s], shape (2, ...).

        Whole periods are taken off first; then u(t) is found by Newton's method, in steps of at
        most 0.3, as dt/du has peaks.
        """
        times = np.asarray(times, float)
        start = self._time(np.array(self._phase))[0]
        turns, rest = np.divmod(times, self.period)
        u = self._phase + rest / self._series[0].real
        for _ in range(60):
            now, slope = self._time(u)
            step = (now - start - rest) / slope
            u = u - np.clip(step, -0.3, 0.3)
            if np.max(np.abs(step), initial=0.0) < 1e-14 * tau:
                break
        slope = self._time(u)[1]
        if self.swings:
            return np.array([self._input(u), self._half * np.cos(u) / slope])
        return np.array([self._input(u) + self._direction * self._cycle * turns,
                         self._direction / slope])

    def position(self, times: ArrayLike) -> Array:
        """Return the input at these times [rad] or [m]."""
        return np.asarray(self.states(times)[0])

    def rate(self, times: ArrayLike) -> Array:
        """Return the rate of the input at these times [rad/s] or [m/s]."""
        return np.asarray(self.states(times)[1])

    @property
    def samples(self) -> int:
        """Return how many poses the series is made of, all doublings together."""
        return 4 * self._series.size

    def stays_within(self, system: System) -> bool:
        """Return whether the motion stays clear of all limits at which a run would end."""
        if not self.swings:
            return not system.events(system.course.first)
        ends = (self._middle - self._half, self._middle + self._half)
        is_within = system.distance_to_end if system.has_no_limits else system.distance_to_limit
        return min(map(is_within, ends)) > 0.0 and not (
            system.stops_at_change_points and flat_positions(system.mechanism))

    def error(self, times: Array) -> float:
        """
        Return the largest expected error of the position at times [rad] or [m].

        The energy is known only to its rounding: the motion is computed again with that much more
        energy, and compared. The error of the series, which grows with the time, is added.
        """
        states, (position, rate) = self.states(times), (self._start, self._rate)
        _, size = self._equation.potential_and_size(position)
        terms = self._equation.terms(position)
        rounding = ROUNDING * float(size + 0.5 * terms.inertia * rate * rate)
        near = ((position + rounding / terms.force, 0.0) if rate == 0.0
                else (position, rate + rounding / (terms.inertia * rate)))
        apart = np.max(np.abs(FreeMotion(self._system, self._most, near).states(times)[0]
                              - states[0]))
        return float(apart + self.accuracy * np.max(np.abs(states[1]) * (times + self.period)))


def follow(system: System, until: float, tolerance: float,
           wanted: Array | None) -> tuple[Part, float, int] | None:
    """
    Return a free motion up to a time [s], the error of its position, and its evaluations of poses.

    None where that error is above the tolerance, for a motion that is not free or not periodic.
    ``wanted``: times of the result; None: 32 in each period.
    """
    if not system.is_conservative:
        return None
    try:
        motion = FreeMotion(system, MOST_TO_FOLLOW)
        if not motion.stays_within(system):
            return None
        count = min(A_PERIOD * (1.0 + until / motion.period), MOST_TIMES)
        times = np.linspace(0.0, until, int(count) + 1) if wanted is None else wanted
        # the error grows with time: at its end, at all places of a period
        late = until - min(until, motion.period) * np.linspace(0.0, 1.0, A_PERIOD)
        error = motion.error(late)
    except (InvalidParameter, NotResolved):
        return None
    if not error <= tolerance:
        return None
    states = motion.states(times)
    states[:, times == 0.0] = np.array(system.start)[:, None]
    return Part(system.course.first, times, states, COMPLETE), error, motion.samples
