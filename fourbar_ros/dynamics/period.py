# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Period of a free motion without integration over time: energy gives the rate, quadrature the time.

    T = integral over a cycle of sqrt(J / (2 (E - V))) dq                                  (F1)

A crank that goes round has u = +-q; an input that swings between turning points q = c +- h has

    q = c + h sin u,   dt/du = h cos u sqrt(J / (2 (E - V)))                                (F2)

Either way dt/du is a smooth periodic function of u: its mean over equal samples converges
exponentially.
"""
from __future__ import annotations

from math import inf, pi, tau

from fourbar_ros.dynamics.equation import flat_positions
from fourbar_ros.dynamics.statics import roots_of
from fourbar_ros.dynamics.system import System
from fourbar_ros.errors import FourBarError, InvalidParameter
from fourbar_ros.numerics.arrays import Array
import numpy as np

MOST_SAMPLES = 2**17
SAME = 1e-14           # relative difference of the means of so many and half as many samples
RESOLVED = 1e-6        # the same, at least
NARROWEST = 14.0       # samples times the distance of a singularity from the real inputs: e^-14


class NotResolved(FourBarError, ArithmeticError):
    """The motion has features too narrow for the largest number of samples."""


def free_period(system: System) -> float:
    """
    Return the time of a turn (two, if the mode alternates) or of a full swing [s].

    The system has no drive and no dampers, and goes round or swings in one assembly mode.

    Raises
    ------
    InvalidParameter
        For a system that is not conservative, rests in an equilibrium, or reaches a limit of its
        input.
    NotResolved
        Where dt/du needs more samples, as next to a change point.

    """
    if not system.is_conservative:
        raise InvalidParameter('system', None, 'must be without drive, dampers and couples')
    equation, mechanism = system.equation, system.mechanism
    energy = float(equation.energy(*system.start[:2]))
    ends = _turning_points(system, energy)
    if ends is None:         # a crank that alternates its mode is where it was after two turns
        cycle, width = tau * (1 + len(flat_positions(mechanism)) % 2), 1.0
    else:
        cycle, width = tau, 0.5 * (ends[1] - ends[0])

    def slowness(u: Array) -> Array:
        """Return dt/du by (F1) or (F2)."""
        q = u if ends is None else 0.5 * (ends[0] + ends[1]) + width * np.sin(u)
        scale = 1.0 if ends is None else (width * np.cos(u))**2
        with np.errstate(divide='ignore'):
            slope: Array = np.sqrt(scale * equation.terms(q).inertia
                                   / (2.0 * np.abs(energy - equation.potential(q))))
        return slope
    # a peak between all samples would leave no trace in the mean
    narrowest = min((abs(z.imag) for z in mechanism.singular_inputs if z.imag), default=inf)
    change, mean, count = inf, inf, 32
    if narrowest / width * MOST_SAMPLES >= NARROWEST:
        while change > SAME and count < MOST_SAMPLES:
            count *= 2
            samples = (np.arange(count) + 0.5) * (cycle / count)
            before, mean = mean, float(np.mean(slowness(samples)))
            now = abs(mean / before - 1.0)
            if change < 1e-8 and now >= change:
                mean = before            # rounding of E - V, next to the turning points, governs
                break
            change = now
    if not change <= RESOLVED:
        raise NotResolved('dt/du of the free motion needs more samples than allowed')
    return cycle * mean


def _turning_points(system: System, energy: float) -> tuple[float, float] | None:
    """
    Return the inputs between which the motion swings, or None for a crank that goes round.

    Raises InvalidParameter for an equilibrium, and for a motion that reaches a limit.
    """
    start, rate = system.start[:2]
    one: float | None
    if rate == 0.0:          # the start is a turning point: the force says which
        push = system.equation.terms(start).force
        if push == 0.0:
            raise InvalidParameter('system', None, 'must not rest in an equilibrium')
        one, other = start, _turning_point(system, energy, 1.0 if push > 0.0 else -1.0)
    else:
        one, other = (_turning_point(system, energy, side) for side in (-1.0, 1.0))
        if one is None and other is None and system.mechanism.turns_fully:
            return None
    if one is None or other is None:
        raise InvalidParameter('system', None, 'must not reach a limit of its input')
    return min(one, other), max(one, other)


def _turning_point(system: System, energy: float, side: float) -> float | None:
    """
    Return the nearest input on one side (+-1) of the start where all energy is potential.

    Searched on samples, dense next to the start: from rest the start itself, the other turning
    point, is left out. None if there is none within a turn, or the range.
    """
    mechanism, (start, rate), reach = system.mechanism, system.start[:2], tau
    if not mechanism.turns_fully:
        start = float(system.coordinates.continuous(float(start)))
        inside = [(low, high) for low, high in mechanism.input_ranges if low <= start <= high]
        if not inside:
            raise InvalidParameter('system', None, 'must start in the range of its input')
        reach = inside[0][1] - start if side > 0.0 else start - inside[0][0]
    near = np.geomspace(1e-9, 1e-3, 25)[:-1]
    far = 1e-3 + (1.0 - 1e-3) * np.sin(np.linspace(0.0, 0.5 * pi, 2048))
    # not quite to the end, where a toggle may be
    parts = np.concatenate([[0.0] if rate else [], near, far * (1.0 - 1e-9)])
    places = roots_of(lambda q: energy - system.equation.potential(q),
                      start + side * reach * parts)
    return min(places, key=lambda place: abs(place - start), default=None)
