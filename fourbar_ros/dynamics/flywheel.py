# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Flywheel for a given coefficient of speed fluctuation.

A crank driven by the constant torque T that balances a cycle, the turns after which all repeats,
has the rate w(q), with a flywheel I,

    (J + I) w^2 / 2 = E0 + integral of (T + Q - D w - R) dq,   T = mean of D w + R - Q      (W1)

R of friction and forces one way is the drive that the loads of this motion need, less that of
(E1). The coefficient of fluctuation is f = (max w - min w) / r with r = (max w + min w) / 2 as the
mean. So w stays between r (1 - f/2) and r (1 + f/2), which bounds E0 from both sides at every q:

    r^2 (1 - f/2)^2 (J + I) / 2 - G  <=  E0  <=  r^2 (1 + f/2)^2 (J + I) / 2 - G           (W2)

with G the integral in (W1). The smallest I at which the largest lower bound meets the smallest
upper one is exact; the textbook's I = (largest change of energy) / (f r^2) leaves out that J
varies.
"""
from math import inf, tau
from typing import NamedTuple

from fourbar_ros.dynamics.equation import Equation, require_input
from fourbar_ros.errors import InvalidParameter
from fourbar_ros.mechanisms.quadrature import gauss
from fourbar_ros.notebook import short_repr
from fourbar_ros.numerics.arguments import FASTEST, finite, rate_of_input
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.numerics.roots import halve
import numpy as np

SAMPLES, MOST_SAMPLES = 1024, 2**18     # of a turn
NARROWEST = 16.0       # samples times the distance of a singularity from the real inputs
CHANGES = 1e-6         # of the inertia by twice the samples, at which it counts as converged
MOST_CHANGE = 1e-4     # the same, at most samples
# Rounds of motion and torque at most; error of the rates, over their mean, that may be left.
ROUNDS, RESOLVED = 300, 1e-6


class Flywheel(NamedTuple):
    """A flywheel and the steady cycle that it gives."""

    inertia: float          # [kg m^2]; zero where none is needed
    torque: float           # [N m] constant torque of the drive
    fluctuation: float      # coefficient of speed fluctuation
    position: Array         # [rad] over the cycle, from zero
    rate: Array             # [rad/s] there

    def __repr__(self) -> str:
        return short_repr('Flywheel', self._asdict())


def flywheel_for(equation: Equation, rate: float, fluctuation: float) -> Flywheel:
    """
    Return the smallest flywheel with which the speed of a crank that turns fully fluctuates less.

    ``rate``: mean of the largest and the smallest rate [rad/s], 1e-100 to 1e100 in size;
    ``fluctuation``: the largest coefficient of speed fluctuation allowed. Raises InvalidParameter.
    """
    require_input(equation)
    rate = rate_of_input('rate', rate)
    fluctuation = finite('fluctuation', fluctuation, 'must be a positive number', above=0.0)
    if abs(rate) < 1.0 / FASTEST:
        raise InvalidParameter('rate', rate, 'must not be zero, at least '
                               f'{1.0 / FASTEST:g} in size')
    if not equation.mechanism.turns_fully:
        raise InvalidParameter('equation', None, 'must be that of a crank that turns fully')
    equation.mechanism.require_cycle()

    # samples resolve the sharpest peak of J and Q, next to a complex singularity
    width = min((abs(z.imag) for z in equation.mechanism.singular_inputs if z.imag), default=1.0)
    count = SAMPLES
    while count * width < NARROWEST and 2 * count < MOST_SAMPLES:
        count *= 2
    wheel, change = _with_samples(equation, count, rate, fluctuation), inf
    while change > CHANGES * wheel.inertia and count < MOST_SAMPLES:
        count, before = 2 * count, wheel
        wheel = _with_samples(equation, count, rate, fluctuation)
        change = abs(wheel.inertia - before.inertia)
    if change > MOST_CHANGE * wheel.inertia:
        raise InvalidParameter('equation', None, f'changes too fast over the input: {count} '
                               'samples of a turn do not resolve it')
    return wheel


@np.errstate(all='ignore')      # without inertia there is no speed
def _with_samples(equation: Equation, count: int, rate: float, most: float) -> Flywheel:
    """Return the flywheel by ``count`` samples of a turn, of a fluctuation of ``most`` at most."""
    # Damping and friction depend on the rate: motion and torque are found in turn, until the rates
    # stay.
    mechanism = equation.mechanism
    cycle, ends = tau * mechanism.turns, mechanism.pieces.ends if mechanism.pieces else ()
    position: Array = np.arange(mechanism.turns * count) * (tau / count)
    terms, rates = equation.terms(position), np.full(position.size, rate)
    # The work of the force at rest up to each sample, and up to ends of pieces between: its mean
    # left out, exact however narrow the pieces are. The speed may have an extreme there too.
    inputs = np.union1d(position, np.mod(ends, cycle))
    spans = np.diff(inputs, append=cycle)
    roots, weights = gauss(3)
    nodes = inputs + np.multiply.outer(0.5 * (1.0 + roots), spans)
    work = spans * (0.5 * weights @ equation.terms(nodes).force)
    torque_at_rest = -float(np.sum(work)) / cycle
    work_before = np.cumsum([0.0, *(work + torque_at_rest * spans)])[:-1]
    is_sample = np.isin(inputs, position)
    work_at_rest = work_before[is_sample]
    inertias = equation.terms(inputs).inertia
    resisting, change = np.zeros((2, position.size))        # R of (E9), dw/dt
    derivative = 1j * np.arange(position.size // 2 + 1) / mechanism.turns       # of harmonics
    total, series = terms.inertia, np.zeros(derivative.size, complex)
    most = min(most, 2.0)                # at which it comes to rest
    for _ in range(ROUNDS):
        if equation.has_resistance:         # from the drive that the loads of the motion need
            drive = getattr(mechanism.loads(position, rates, change), mechanism.drive_load)
            resisting = drive - (equation.torque(position, rates, change)
                                 - equation.extra_inertia * change)
            if not np.isfinite(resisting).all():
                raise InvalidParameter('equation', None, 'must be that of a mechanism that does '
                                       'not lock itself by friction')
        lost, before = terms.damping * rates + resisting, rates
        torque = torque_at_rest + float(np.mean(lost))                                   # (W1)
        # The integral G of a function of zero mean, by its Fourier series. More energy fades, as
        # more speed is damped more: by this part of it per angle, in the middle of all positions.
        # With that the rounds converge however strong damping is; once G stays it cancels out.
        momenta = total * rates
        fading = np.divide(terms.damping, momenta, out=np.zeros_like(rates), where=momenta != 0.0)
        stiff = 0.5 * (fading.max() + fading.min())
        series = np.divide(
            derivative * np.fft.rfft(work_at_rest) - np.fft.rfft(lost) + stiff * series,
            derivative + stiff, out=np.zeros_like(series), where=derivative != 0.0)
        at_samples, inertia = np.fft.irfft(series, position.size), 0.0
        gained = work_before + np.interp(inputs, position, at_samples - work_at_rest, period=cycle)

        def lack(fluctuation: float, gained: Array = gained) -> float:
            """Return how far the bounds (W2) of E0 are from meeting, without a flywheel."""
            low, high = ((rate * (1.0 + 0.5 * side * fluctuation))**2 for side in (-1.0, 1.0))
            return float(np.max(0.5 * low * inertias - gained)
                         - np.min(0.5 * high * inertias - gained))
        fluctuation = most
        if lack(most) > 0.0:
            inertia = lack(most) / (rate * rate * most)
        else:
            fluctuation = halve(lambda fluctuation: lack(fluctuation) > 0.0, 0.0, most)[1]
        # E0, at its largest lower bound (W2); the motion follows by (W1)
        energy = np.max(0.5 * (rate * (1.0 - 0.5 * fluctuation))**2 * (inertias + inertia)
                        - gained)
        all_rates = np.copysign(np.sqrt(2.0 * (energy + gained) / (inertias + inertia)), rate)
        rates, total = all_rates[is_sample], terms.inertia + inertia
        change = (terms.force - lost + torque - terms.half_slope * rates * rates) / total
        left = np.max(np.abs(rates - before)) / abs(rate)
        if not left > 1e-14:
            break
    if not left * (1.0 + abs(stiff)) <= RESOLVED:
        raise InvalidParameter('equation', None, 'must be that of a mechanism with less damping '
                               'or friction, or more inertia: no steady speed is found')
    return Flywheel(inertia, torque, float(np.ptp(all_rates)) / abs(rate), position, rates)
