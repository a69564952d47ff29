# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Flywheel for a given coefficient of speed fluctuation.

A crank driven by the constant torque T that balances a turn has the rate w(q), with a flywheel I,

    (J + I) w^2 / 2 = E0 + integral of (T + Q - D w) dq,   T = mean of D w - Q              (W1)

and its coefficient of fluctuation is (max w - min w) / mean w with (max w + min w) / 2 as the
mean.
E0 follows from the mean wanted, I from the coefficient wanted: exactly, not from the textbook's
I = (largest change of energy) / (coefficient w^2), which leaves out that J varies.
"""
from __future__ import annotations

from math import tau
from typing import NamedTuple

from fourbar_ros.dynamics.equation import Equation, Terms
from fourbar_ros.errors import InvalidParameter
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.numerics.given import FASTEST, number, rate_of_input
from fourbar_ros.numerics.newton import halve
from fourbar_ros.optional import MissingPackage
import numpy as np

SAMPLES, MOST_SAMPLES = 1024, 2**17     # of a turn
NARROWEST = 16.0       # samples times the distance of a singularity from the real inputs
CHANGES = 1e-6         # of the inertia by twice the samples, at which it counts as converged


class Flywheel(NamedTuple):
    """A flywheel and the steady turn that it gives."""

    inertia: float          # [kg m^2]; zero where none is needed
    torque: float           # [N m] constant torque of the drive
    fluctuation: float      # coefficient of speed fluctuation
    position: Array         # [rad] over the turn, from zero
    rate: Array             # [rad/s] there


def flywheel_for(equation: Equation, rate: float, fluctuation: float) -> Flywheel:
    """
    Return the smallest flywheel with which the speed fluctuates no more than wanted.

    Parameters
    ----------
    equation : Equation
        Its crank turns fully.
    rate : float
        Mean of the largest and the smallest rate [rad/s], 1e-100 to 1e100 in size.
    fluctuation : float
        Largest coefficient of speed fluctuation, positive.

    Raises
    ------
    InvalidParameter

    """
    try:
        from scipy.optimize import brentq
    except ModuleNotFoundError as error:
        raise MissingPackage('the search for a flywheel', error) from error
    if not isinstance(equation, Equation):
        raise InvalidParameter('equation', equation, 'must be an Equation')
    rate = rate_of_input('rate', rate)
    fluctuation = number('fluctuation', fluctuation, 'must be a positive number', above=0.0)
    if abs(rate) < 1.0 / FASTEST:
        raise InvalidParameter('rate', rate, 'must not be zero, at least '
                               f'{1.0 / FASTEST:g} in size')
    if not equation.mechanism.turns_fully:
        raise InvalidParameter('equation', None, 'must be that of a crank that turns fully')
    if equation.turns > 1:
        raise InvalidParameter('equation', None, f'repeats after {equation.turns} turns, as its '
                               'forces do: a steady turn is computed of one')

    def with_samples(count: int) -> Flywheel:
        """Return the flywheel from so many samples of a turn, by a search for its inertia."""
        position: Array = np.linspace(0.0, tau, count, endpoint=False)
        terms = equation.terms(position)

        def excess(inertia: float) -> float:
            return steady_turn(position, terms, rate, inertia).fluctuation - fluctuation
        if excess(0.0) <= 0.0:
            return steady_turn(position, terms, rate, 0.0)
        most = float(np.max(terms.inertia))
        while excess(most) > 0.0:
            most *= 4.0
        return steady_turn(position, terms, rate,
                           float(brentq(excess, 0.0, most, xtol=1e-12 * most)))
    # samples resolve the sharpest peak of J and Q, next to a complex singularity
    width = min((abs(z.imag) for z in equation.mechanism.singular_inputs if z.imag), default=1.0)
    count = SAMPLES
    while count * width < NARROWEST and count < MOST_SAMPLES:
        count *= 2
    wheel = with_samples(count)
    while count < MOST_SAMPLES:
        count, before, wheel = 2 * count, wheel, with_samples(2 * count)
        if abs(wheel.inertia - before.inertia) <= CHANGES * wheel.inertia:
            break
    return wheel


def steady_turn(position: Array, terms: Terms, rate: float, inertia: float) -> Flywheel:
    """
    Return the periodic motion (W1) with a flywheel of an inertia [kg m^2].

    ``position``: equal steps over a turn [rad], with the terms there; ``rate``: mean of highest
    and lowest [rad/s]. Damping depends on the rate: motion and torque are found in turn, until the
    rates stay.
    """
    rates: Array = np.full(position.size, rate)
    total = terms.inertia + inertia
    for _ in range(100):
        force = terms.force - terms.damping * rates
        torque, before = -float(np.mean(force)), rates
        rates = _rates(_integral(force + torque), total, rate)
        if np.max(np.abs(rates - before)) <= 1e-14 * abs(rate):
            break
    spread = float(np.max(rates) - np.min(rates)) / abs(rate)
    return Flywheel(inertia, torque, spread, position, rates)


def _integral(values: Array) -> Array:
    """Return the integral of a periodic function with zero mean, by its Fourier series."""
    k = np.arange(values.size // 2 + 1)
    series = np.fft.rfft(values)
    series[1:] /= 1j * k[1:]
    series[0] = series[-1] = 0.0
    return np.fft.irfft(series, values.size)


def _rates(gained: Array, total: Array, rate: float) -> Array:
    """
    Return the rates w = sqrt(2 (E0 + gained) / total), (W1), with E0 found by halving.

    ``gained``: the integral of the forces; ``total``: J + I; ``rate``: mean wanted of the largest
    and the smallest w.
    """
    def rates_at(energy: float) -> Array:
        return np.asarray(np.sqrt(2.0 * np.maximum(energy + gained, 0.0) / total))

    def is_slow(energy: float) -> bool:
        rates = rates_at(energy)
        return bool(np.max(rates) + np.min(rates) < 2.0 * abs(rate))
    low = -float(np.min(gained))
    high = low + float(np.max(total)) * rate**2 + float(np.ptp(gained))
    return np.copysign(rates_at(halve(is_slow, low, high)[1]), rate)
