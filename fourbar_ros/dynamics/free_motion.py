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
from math import pi
from typing import Any

from fourbar_ros.dynamics.smooth import flat_positions
from fourbar_ros.dynamics.statics import roots_of
from fourbar_ros.dynamics.system import System
from fourbar_ros.errors import FourBarError, InvalidParameter
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.floating[Any]]
ComplexArray = NDArray[np.complexfloating[Any, Any]]
MOST_SAMPLES = 2**17
SMALL = 1e-15          # of the last Fourier coefficients to the first
RESOLVED = 1e-6        # the same, at least
NARROWEST = 14.0       # samples times the distance of a singularity from the real inputs: e^-14
TURN = 2.0 * pi
NOT_RESOLVED = f'dt/du of the free motion needs more than {MOST_SAMPLES} samples'


class NotResolved(FourBarError, ArithmeticError):
    """The motion has features too narrow for the largest Fourier series."""


class FreeMotion:
    """
    Motion of a system without drive and dampers, from its energy.

    Parameters
    ----------
    system : System
        Conservative, not at rest in an equilibrium.

    Raises
    ------
    InvalidParameter
        For a system that is not conservative or does not move, or that reaches a limit of its
        input.
    NotResolved
        Where dt/du needs more than 2^17 samples.

    """

    def __init__(self, system: System) -> None:
        if not system.is_conservative:
            raise InvalidParameter('system', None, 'must be without drive, dampers and couples')
        self._equation, mechanism = system.equation, system.mechanism
        self._start, rate = system.start
        self.energy = float(self._equation.energy(self._start, rate))
        turning = self._turning_points(mechanism, rate)
        self.swings = turning is not None
        if turning is None:
            self._middle, self._half, self._direction = 0.0, 0.0, (1.0 if rate > 0.0 else -1.0)
            self._phase = self._direction * self._start
            self._cycle = TURN * (1 + len(flat_positions(mechanism)) % 2)
        else:
            low, high = turning
            self._middle, self._half = 0.5 * (low + high), 0.5 * (high - low)
            sine = min(max((self._start - self._middle) / self._half, -1.0), 1.0)
            self._phase = float(np.arcsin(sine)) if rate >= 0.0 else pi - float(np.arcsin(sine))
            self._cycle = TURN

    def _turning_points(self, mechanism: Any, rate: float) -> tuple[float, float] | None:
        """Return the ends of the swing, or None for a crank that goes round."""
        if rate == 0.0:      # the start is one of them: which one, the force says
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

    def _turning_point(self, mechanism: Any, side: float,
                       at_rest: bool = False) -> float | None:
        """Return the nearest turning point on one side of the start, or None."""
        reach = TURN
        if not mechanism.turns_fully:
            low, high = next((low, high) for low, high in mechanism.input_ranges
                             if low <= self._start <= high)
            reach = high - self._start if side > 0.0 else self._start - low
        near = np.geomspace(1e-9, 1e-3, 25)[:-1]
        far = 1e-3 + (1.0 - 1e-3) * np.sin(np.linspace(0.0, 0.5 * pi, 2048))
        # not quite to the end, where a toggle may be
        parts = np.concatenate([near, far * (1.0 - 1e-9)]) if at_rest else np.concatenate(
            [[0.0], near, far * (1.0 - 1e-9)])
        places = roots_of(lambda q: self.energy - self._equation.potential(q),
                          self._start + side * reach * parts)
        return min(places, key=lambda place: abs(place - self._start), default=None)

    def _input(self, u: Any) -> Any:
        return self._middle + self._half * np.sin(u) if self.swings else self._direction * u

    def _slope(self, u: Array) -> Array:
        """Return dt/du [s], (F1) or (F2)."""
        q = self._input(u)
        inertia, spare = self._equation.terms(q).inertia, self.energy - self._equation.potential(q)
        scale = (self._half * np.cos(u))**2 if self.swings else 1.0
        # rounding may make it negative
        slope: Array = np.sqrt(scale * inertia / (2.0 * np.abs(spare)))
        return slope

    @cached_property
    def _resolved(self) -> tuple[float, ComplexArray]:
        """Return the size of the last Fourier coefficients of dt/du, and those above it."""
        # a peak between all samples would leave no trace in the series
        width = min((abs(z.imag) for z in self._equation.mechanism.singular_inputs if z.imag),
                    default=np.inf) / (self._half if self.swings else 1.0)
        if width * MOST_SAMPLES < NARROWEST:
            raise NotResolved(NOT_RESOLVED)
        best: tuple[float, ComplexArray] = (np.inf, np.empty(0, complex))
        count = 32
        while best[0] > SMALL and count < MOST_SAMPLES:
            count *= 2
            u = (np.arange(count) + 0.5) * (self._cycle / count)
            series = np.fft.rfft(self._slope(u)) / count
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
        """Return the relative error of times to be expected."""
        return self._resolved[0]

    @property
    def _series(self) -> ComplexArray:
        return self._resolved[1]

    @property
    def period(self) -> float:
        """Return the time of a turn (two, if the mode alternates) or of a full swing [s]."""
        return float(self._cycle * self._series[0].real)

    def _time(self, u: Array) -> tuple[Array, Array]:
        """Return the time since u = 0, and dt/du [s]."""
        k = np.arange(1, self._series.size) * (TURN / self._cycle)
        waves = 2.0 * self._series[1:] * np.exp(1j * np.multiply.outer(u, k))
        mean = self._series[0].real
        return mean * u + np.sum((waves / (1j * k)).real, -1), mean + np.sum(waves.real, -1)

    def position(self, times: Any) -> Array:
        """Return the input at these times [rad] or [m]."""
        times = np.asarray(times, float)
        start = self._time(np.array(self._phase))[0]
        turns, rest = np.divmod(times, self.period)
        u = self._phase + rest / self._series[0].real
        for _ in range(60):
            now, slope = self._time(u)
            step = (now - start - rest) / slope
            u = u - np.clip(step, -0.3, 0.3)
            if np.max(np.abs(step), initial=0.0) < 1e-14 * TURN:
                break
        q = self._input(u)
        found: Array = q if self.swings else q + self._direction * self._cycle * turns
        return found

    def rate(self, times: Any) -> Array:
        """Return the size of the rate of the input at these times [rad/s] or [m/s]."""
        q = self.position(times)
        spare = np.maximum(self.energy - self._equation.potential(q), 0.0)
        rate: Array = np.sqrt(2.0 * spare / self._equation.terms(q).inertia)
        return rate
