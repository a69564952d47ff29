# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Static equilibria, their stability and the frequency of small swings.

An equilibrium is where Q + T = 0.

A small motion x about an equilibrium obeys J x.. + D x. + K x = 0 with K = -dQ/dq (dots are
derivatives with respect to time): stable where K > 0, with the natural frequency

    f = sqrt(K / J) / (2 pi)   and the damping ratio   D / (2 sqrt(J K)).                   (S1)
"""
from __future__ import annotations

from math import inf, nan, pi, sqrt, tau
from typing import NamedTuple

from fourbar_ros.dynamics.equation import Equation
from fourbar_ros.errors import InvalidParameter
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.numerics.given import number
from fourbar_ros.numerics.number_types import Function
from fourbar_ros.optional import MissingPackage
import numpy as np

SAMPLES = 2048      # in each range of the input
HALVINGS = 60


class Equilibrium(NamedTuple):
    """A static equilibrium."""

    position: float          # [rad] or [m]
    is_stable: bool
    stiffness: float         # K [N m/rad] or [N/m]
    frequency: float         # [Hz] of small undamped motion; NaN where it is not stable
    damping_ratio: float     # NaN where it is not stable


def equilibria(equation: Equation, drive: float = 0.0) -> tuple[Equilibrium, ...]:
    """
    Return all static equilibria in this assembly mode, in order of the input.

    ``drive``: constant torque (force) T of the drive. Equilibria are sign changes of Q + T on 2048
    samples of each range of the input and at the places of force tables, and pairs of them between
    samples where |Q + T| dips. None
    is found where Q + T is zero over an interval. A jump of Q over zero, as at the wrap of a
    torsion spring, is no equilibrium.
    """
    if not isinstance(equation, Equation):
        raise InvalidParameter('equation', equation, 'must be an Equation')
    drive, places = number('drive', drive), []
    for samples in _samples(equation.mechanism, equation.turns):
        samples = np.union1d(samples, _inputs_of_tables(equation, samples))
        places += roots_of(lambda q: equation.terms(q).force + drive, samples)
    if equation.mechanism.turns_fully:      # samples go a little beyond the turns from -pi on
        cycle, end = equation.turns * tau, (2 * equation.turns - 1) * pi
        places = [place - cycle if place > end else place if abs(place) > 1e-60 else 0.0
                  for place in places]
    return tuple(_equilibrium(equation, place) for place in sorted(places)
                 if not _jumps(equation, place, drive))


def _jumps(equation: Equation, place: float, drive: float) -> bool:
    """
    Return whether Q + T only jumps over zero at a place, as where the angle of a spring wraps.

    At a root the values 1e-9 on either side are as small as the slope says; at a jump they are
    not.
    """
    aside = 1e-9 * equation.mechanism.input_unit
    below, here, above = equation.terms(place + aside * np.arange(-1.0, 2.0)).force + drive
    bend = abs(float(equation.stiffness(place))) * aside
    return bool(min(abs(below), abs(above)) > 1e3 * bend + 1e-6 * abs(above - below))


def _samples(mechanism: Mechanism, turns: int) -> list[Array]:
    """Return inputs in each range: of a full crank equal steps, else denser towards both ends."""
    if mechanism.turns_fully:
        # a sample beyond the turn: its ends, where equilibria are often, are then inside
        return [(np.arange(turns * SAMPLES + 1) + 0.5) * (tau / SAMPLES) - pi]
    u = (np.arange(SAMPLES) + 0.5) * (pi / SAMPLES)
    return [0.5 * (low + high) - 0.5 * (high - low) * np.cos(u)
            for low, high in mechanism.input_ranges]


def _inputs_of_tables(equation: Equation, samples: Array) -> Array:
    """Return the inputs between samples at which a force table has a place, by bisection."""
    found: list[Array] = [np.empty(0)]
    for i, (_, table) in enumerate(equation.tables):
        def beyond(inputs: Array, places: Array, i: int = i,
                   period: float = table.period) -> Array:
            way = equation.places.of_many(inputs)[i] - places
            return way if period == inf else way - period * np.round(way / period)
        places = np.array(table.table.places)[:, None]
        ways = beyond(samples, places)
        passes = ((ways[:, 1:] >= 0.0) != (ways[:, :-1] >= 0.0)) & (
            np.abs(np.diff(ways)) < 0.5 * table.period)
        row, column = np.nonzero(passes)
        low, high, place = samples[column], samples[column + 1], places[row, 0]
        side = ways[row, column] >= 0.0
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            is_before = (beyond(middle, place) >= 0.0) == side
            low, high = np.where(is_before, middle, low), np.where(is_before, high, middle)
        found.append(high)
    return np.concatenate(found)


def roots_of(function: Function, samples: Array) -> list[float]:
    """
    Return the places where a function of floats and arrays changes its sign, to the last bits.

    Brackets are the sign changes between samples. Where |f| dips at a sample without one, the dip
    is searched for its lowest point: beyond zero it gives two more.
    """
    try:
        from scipy.optimize import brentq, minimize_scalar
    except ModuleNotFoundError as error:
        raise MissingPackage('the search for equilibria', error) from error

    values = function(samples)
    sides = values >= 0.0
    brackets = [(samples[i], samples[i + 1]) for i in np.flatnonzero(sides[1:] != sides[:-1])]
    sizes = np.abs(values)
    dips = 1 + np.flatnonzero((sizes[1:-1] < sizes[:-2]) & (sizes[1:-1] <= sizes[2:])
                              & (sides[:-2] == sides[1:-1]) & (sides[1:-1] == sides[2:]))
    for i in dips:
        side = 1.0 if sides[i] else -1.0
        found = minimize_scalar(lambda x, side=side: side * function(float(x)), method='bounded',
                                bounds=sorted((samples[i - 1], samples[i + 1])),
                                options={'xatol': 1e-12})
        if found.fun < 0.0:
            brackets += [(samples[i - 1], found.x), (found.x, samples[i + 1])]
    return [float(brentq(function, float(a), float(b), xtol=1e-300,
                         rtol=4.0 * np.finfo(float).eps))
            for a, b in brackets]


def _equilibrium(equation: Equation, position: float) -> Equilibrium:
    """Return an equilibrium with its stiffness, frequency and damping ratio by (S1)."""
    terms, stiffness = equation.terms(position), float(equation.stiffness(position))
    if stiffness <= 0.0:
        return Equilibrium(position, False, stiffness, nan, nan)
    return Equilibrium(position, True, stiffness, sqrt(stiffness / terms.inertia) / tau,
                       terms.damping / (2.0 * sqrt(terms.inertia * stiffness)))
