# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Static equilibria, their stability and the frequency of small swings; the period of a free motion.

An equilibrium is where Q + T = 0. A balanced mechanism is in equilibrium everywhere: Q + T is
nothing but the rounding of its terms, whose bound the equation of motion gives.

A small motion x about an equilibrium obeys J x.. + D x. + K x = 0 with K = -dQ/dq (dots are
derivatives with respect to time): stable where K > 0, with the natural frequency

    f = sqrt(K / J) / (2 pi)   and the damping ratio   D / (2 sqrt(J K)).                   (H1)

The period of a free motion needs no integration over time: energy gives the rate, quadrature

    T = integral over a cycle of sqrt(J / (2 (E - V))) dq                                  (H2)

A crank that goes round has u = +-q; an input that swings between turning points q = c +- h has

    q = c + h sin u,   dt/du = h cos u sqrt(J / (2 (E - V)))                                (H3)

Either way dt/du is a smooth periodic function of u: its mean over equal samples converges
exponentially.
"""
from math import inf, nan, pi, sqrt, tau
from typing import Any, NamedTuple

from fourbar_ros.dynamics.equation import Equation, require_input
from fourbar_ros.dynamics.system import System
from fourbar_ros.errors import FourBarError, InvalidParameter
from fourbar_ros.numerics.arguments import finite
from fourbar_ros.numerics.arrays import Array, EPS
from fourbar_ros.numerics.number_types import Function
from fourbar_ros.optional import MissingPackage
import numpy as np

SAMPLES = 2048      # in each range of the input
SHORTEST = 1e-9     # of a piece in equilibrium everywhere, in units of the input
HALVINGS = 60
MOST_SAMPLES = 2**17
SAME = 1e-14           # relative difference of the means of so many and half as many samples
RESOLVED = 1e-6        # the same, at least
LEAST_DECAY = 14.0     # exponent by which the error of the mean must fall at most samples
ROUNDED = 1e-8         # below it a difference of means that does not fall is of rounding
TOO_MANY = 'dt/du of the free motion needs more samples than allowed'


class Equilibrium(NamedTuple):
    """A static equilibrium, or all positions of a piece of the range."""

    position: float          # [rad] or [m]
    is_stable: bool
    stiffness: float         # K [N m/rad] or [N/m]
    frequency: float         # [Hz] of small undamped motion; NaN where it is not stable
    damping_ratio: float     # NaN where it is not stable
    end: float               # of a piece, everywhere in equilibrium; else the position again


def equilibria(equation: Equation, drive: float = 0.0) -> tuple[Equilibrium, ...]:
    """
    Return all static equilibria in this assembly mode, in order of the input.

    ``drive``: constant torque (force) T of the drive. Equilibria are sign changes of Q + T on 2048
    samples of each range of the input and at the points of force tables, and pairs of them between
    samples where |Q + T| dips. Where |Q + T| is within its rounding error over a piece of the
    range, or all of it, as of a balanced mechanism, the piece is one equilibrium with its ``end``;
    of a crank it may go on beyond a whole turn. A jump of Q over zero, as at the wrap of a torsion
    spring, is no equilibrium. With friction the equilibria are the pieces in which it holds the
    mechanism, :meth:`.Mechanism.holding`: they are stable.
    """
    require_input(equation)
    drive, mechanism = finite('drive', drive), equation.mechanism
    results, is_held = list[Equilibrium](), bool(mechanism.friction)

    def push(q: Any) -> Any:        # Q + T; of friction what it cannot hold
        return (drive - np.clip(drive, *mechanism.holding(q)) if is_held
                else equation.terms(q).force + drive)

    def error(q: Any) -> Array:
        return equation.force_error(q) + EPS * abs(drive)

    cycle = mechanism.turns * tau
    ends_of_pieces = np.array(mechanism.pieces.ends if mechanism.pieces else ())
    for low, high in [(-pi, cycle - pi)] if mechanism.turns_fully else mechanism.input_ranges:
        if mechanism.turns_fully:
            # a sample beyond the turn: its ends, where equilibria are often, are then inside
            samples = (np.arange(mechanism.turns * SAMPLES + 1) + 0.5) * (tau / SAMPLES) - pi
            ends_of_pieces = samples[0] + (ends_of_pieces - samples[0]) % mechanism.cycle
        else:
            u = (np.arange(SAMPLES) + 0.5) * (pi / SAMPLES)
            samples = 0.5 * (low + high) - 0.5 * (high - low) * np.cos(u)
        samples = np.union1d(samples, ends_of_pieces[(ends_of_pieces > samples[0])
                                                     & (ends_of_pieces < samples[-1])])
        pieces, parts = _without_force(push, error, samples, SHORTEST * mechanism.input_unit)
        roots = [root for part in parts for root in roots_of(push, part, error)]
        ends = samples[0], samples[-1]
        if mechanism.turns_fully:      # samples go a little beyond the turns from -pi on
            roots = [root - cycle if root > high else root if abs(root) > 1e-60 else 0.0
                     for root in roots]
            if len(pieces) > 1 and (pieces[0][0], pieces[-1][1]) == ends:        # over the seam
                (start, _), (_, stop) = pieces.pop(), pieces.pop(0)
                pieces.append((start, stop + cycle))
        for root in roots:
            aside = 1e-9 * mechanism.input_unit
            below, above = equation.terms(root + aside * np.array((-1.0, 1.0))).force + drive
            terms, stiffness = equation.terms(root), float(equation.stiffness(root))
            # no equilibrium where Q + T jumps over zero
            if min(abs(below), abs(above)) <= (1e3 * abs(stiffness) * aside
                                               + 1e-6 * abs(above - below)):
                damping = terms.damping + (         # friction that holds nothing is viscous
                    equation.resistance(root, 1.0, 0.0, terms.inertia).friction)
                frequency, ratio = (                                                       # (H1)
                    sqrt(stiffness / terms.inertia) / tau,
                    damping / (2.0 * sqrt(terms.inertia * stiffness))
                ) if stiffness > 0.0 else (nan, nan)
                results.append(Equilibrium(root, stiffness > 0.0, stiffness, frequency, ratio,
                                           root))
        results += [Equilibrium(low if start == ends[0] else start, is_held, 0.0, nan, nan,
                                high if stop == ends[1] else stop) for start, stop in pieces]
    return tuple(sorted(results))


def _without_force(push: Function, error: Function, samples: Array, shortest: float
                   ) -> tuple[list[tuple[float, float]], list[Array]]:
    """Return the pieces (first, last input) with no force but rounding; the samples between."""
    # push, error: input -> force, bound of its error. A piece is longer than shortest.
    def is_zero(q: Any) -> Any:
        return np.abs(push(q)) <= error(q)

    def edge(inside: float, outside: float) -> float:
        for _ in range(HALVINGS):
            middle = 0.5 * (inside + outside)
            inside, outside = (middle, outside) if is_zero(middle) else (inside, middle)
        return inside

    pieces, parts, rest, last = list[tuple[float, float]](), list[Array](), 0, samples.size - 1
    changes = np.flatnonzero(np.diff(is_zero(samples), prepend=False, append=False)).tolist()
    for i, after in zip(changes[::2], changes[1::2]):
        j = after - 1           # samples i to j are without force
        if samples[j] - samples[i] > shortest:
            pieces.append((edge(*samples[[i, max(i - 1, 0)]].tolist()),
                           edge(*samples[[j, min(j + 1, last)]].tolist())))
            parts.append(samples[rest:i])
            rest = after
    return pieces, [*parts, samples[rest:]]


def roots_of(function: Function, samples: Array, error: Function | None = None) -> list[float]:
    """Return the arguments at which a function changes its sign, to the last bits."""
    # The function takes floats and arrays. Brackets are the sign changes between samples. Where
    # |f| dips at a sample without a sign change, the dip is searched for its lowest point: beyond
    # zero it gives two brackets more. error: bounds of the rounding errors of values; a value
    # within its error has no sign.
    try:
        from scipy.optimize import brentq, minimize_scalar
    except ModuleNotFoundError as error:
        raise MissingPackage('the search for equilibria', error) from error

    values = function(samples)
    if error is not None:
        has_sign = np.abs(values) > error(samples)
        samples, values = samples[has_sign], values[has_sign]
    sides = values >= 0.0
    brackets = [(samples[i], samples[i + 1]) for i in np.flatnonzero(sides[1:] != sides[:-1])]
    sizes = np.abs(values)
    dips = 1 + np.flatnonzero((sizes[1:-1] < sizes[:-2]) & (sizes[1:-1] <= sizes[2:])
                              & (sides[:-2] == sides[1:-1]) & (sides[1:-1] == sides[2:]))
    for i in dips:
        side = 1.0 if sides[i] else -1.0
        lowest = minimize_scalar(lambda x, side=side: side * function(float(x)), method='bounded',
                                 bounds=sorted((samples[i - 1], samples[i + 1])),
                                 options={'xatol': 1e-12})
        if lowest.fun < (0.0 if error is None else -error(lowest.x)):
            brackets += [(samples[i - 1], lowest.x), (lowest.x, samples[i + 1])]
    # a jump exactly at zero, as of a torsion spring that comes round, is bisected down to xtol
    return [float(brentq(function, float(a), float(b), xtol=1e-300,
                         rtol=4.0 * np.finfo(float).eps, maxiter=1100))
            for a, b in brackets]


# --- the period of a free motion -----------------------------------------------------------------

class NotResolved(FourBarError, ArithmeticError):
    """The motion has features too narrow for the largest number of samples."""


def free_period(system: System) -> float:
    """
    Return the time of a period of the mechanism or of a full swing [s].

    The system has no drive and no dampers, and goes round or swings in one assembly mode. Raises
    InvalidParameter for a system that is not conservative, rests in an equilibrium, or reaches a
    limit of its input; NotResolved where dt/du needs more samples, as next to a change point.
    """
    if not system.is_conservative:
        raise InvalidParameter('system', None, 'must be without drive, dampers and couples')
    equation, mechanism = system.equation, system.mechanism
    energy = float(equation.energy(*system.start[:2]))
    ends = _turning_points(system, energy)
    cycle, width = (tau, 0.5 * (ends[1] - ends[0])) if ends else (mechanism.period, 1.0)

    def slowness(u: Array) -> Array:
        """Return dt/du by (H2) or (H3)."""
        q = u if ends is None else 0.5 * (ends[0] + ends[1]) + width * np.sin(u)
        scale = 1.0 if ends is None else (width * np.cos(u))**2
        with np.errstate(divide='ignore'):
            slope: Array = np.sqrt(scale * equation.terms(q).inertia
                                   / (2.0 * np.abs(energy - equation.potential(q))))
        return slope

    # A singular input z makes a peak as wide as its imaginary part: the mean of n samples has an
    # error of exp(-n Im u(z) tau/cycle), and a peak between all samples leaves no trace in it.
    nearest = min((abs(z.imag) for z in mechanism.singular_inputs if z.imag), default=inf)
    change, mean, count = inf, inf, 32
    if MOST_SAMPLES * tau / cycle * nearest / width < LEAST_DECAY:
        raise NotResolved(TOO_MANY)
    while change > SAME and count < MOST_SAMPLES:
        count *= 2
        samples = (np.arange(count) + 0.5) * (cycle / count)
        mean_before, mean = mean, float(np.mean(slowness(samples)))
        change_before, change = change, abs(mean / mean_before - 1.0)
        if change_before < ROUNDED and change >= change_before:
            # rounding of E - V, next to the turning points, governs
            change, mean = change_before, mean_before
            break
    if not change <= RESOLVED:
        raise NotResolved(TOO_MANY)
    return cycle * mean


def _turning_points(system: System, energy: float) -> tuple[float, float] | None:
    """Return the inputs between which the motion swings, or None for a crank that goes round."""
    # Raises InvalidParameter for an equilibrium, and for a motion that reaches a limit.
    start, rate = system.start[:2]
    low: float | None
    if rate == 0.0:          # the start is a turning point: the force says which
        push = system.equation.terms(start).force
        if abs(push) <= system.equation.force_error(start):
            raise InvalidParameter('system', None, 'must not rest in an equilibrium')
        low, high = start, _turning_point(system, energy, 1.0 if push > 0.0 else -1.0)
    else:
        low, high = (_turning_point(system, energy, side) for side in (-1.0, 1.0))
        if low is None and high is None and not system.has_limits:
            return None
    if low is None or high is None or min(map(system.distance_to_end, (low, high))) < 0.0:
        raise InvalidParameter('system', None, 'must not reach a limit of its input')
    return min(low, high), max(low, high)


def _turning_point(system: System, energy: float, side: float) -> float | None:
    """Return the nearest input on one side (+-1) of the start where all energy is potential."""
    # Searched on samples, dense next to the start: from rest the start itself, a turning point
    # too, is left out. None if there is none within a period, or the range.
    mechanism, (start, rate) = system.mechanism, system.start[:2]
    reach = mechanism.period
    if not mechanism.turns_fully:
        start = float(system.coordinates.continuous(float(start)))
        low, high = mechanism.range_around(start)
        reach = high - start if side > 0.0 else start - low
    near = np.geomspace(1e-9, 1e-3, 25)[:-1]
    far = 1e-3 + (1.0 - 1e-3) * np.sin(np.linspace(0.0, 0.5 * pi, 2048))
    # not quite to the end, where a toggle may be
    shares = np.concatenate([[] if rate == 0.0 else [0.0], near, far * (1.0 - 1e-9)])
    roots = roots_of(lambda q: energy - system.equation.potential(q),
                     start + side * reach * shares)
    return min(roots, key=lambda root: abs(root - start), default=None)
