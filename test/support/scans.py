# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Extrema against dense scans, for any mechanism."""

from math import inf

from fourbar_ros import find_extrema
from fourbar_ros.extrema.path_search import PART_OF_NOISE
from fourbar_ros.extrema.sampling import Sampler
from fourbar_ros.mechanisms.quantities import select
import numpy as np
from support.cartesian import EPS


def tops(values, noise):
    """Yield (kind, index) of samples beyond those on both sides by more than noise."""
    for sign, kind in ((1, 'maximum'), (-1, 'minimum')):
        rise = sign * np.diff(values)
        for i in np.flatnonzero((rise[:-1] > noise) & (rise[1:] < -noise)).tolist():
            yield kind, i + 1


def tops_of_a_scan(mechanism, quantities, rate, acceleration, points):
    """Yield (quantity, kind, input, step) of the extrema of a dense scan above rounding."""
    for low, high in mechanism.input_ranges:
        step = (high - low) / points
        x = low + step * (np.arange(-1, points + 1) + 0.5)
        state = mechanism.step(x, rate, acceleration)
        if not mechanism.turns_fully:
            x, state = x[1:-1], [type(part)(*(field[1:-1] for field in part)) for part in state]
        for quantity in quantities:
            values = quantity.of(*state)
            noise = 64 * EPS * np.abs(values[1:-1]) + EPS * np.median(np.abs(values))
            for kind, i in tops(values, noise):
                yield quantity.name, kind, float(x[i]), step


def check_against_scan(mechanism, quantities, rate, acceleration, points, exact=None):
    """
    Each local extremum of a scan must be found, each found one be one.

    A top beside a pole, as joint reactions have at flat positions, is that of the pole.

    ``exact``: (mechanism, name, inputs, rates) -> values to many digits, or None; asked where the
    rounding of the values hides whether one is. Return how many the scan has.
    """
    rates = rate, acceleration
    found, number = find_extrema(mechanism, quantities, *rates), 0
    for name, kind, top, step in tops_of_a_scan(mechanism, quantities, rate, acceleration, points):
        number += 1
        places = [e.input for e in found if e.quantity == name and (
            abs(e.value) == inf or (e.kind, e.place) == (kind, 'interior'))]
        away = min([abs(mechanism.distance(top, at)) for at in places], default=inf)
        assert away <= 1.5 * step or _is_noise(
            mechanism, name, kind, top, step, rates, exact) or _is_below_its_bound(
                mechanism, name, top, rates), (mechanism, name, top)
    by_name = {quantity.name: quantity for quantity in quantities}
    for extremum in found:
        if extremum.place == 'interior' and extremum.kind != 'constant':
            unit = mechanism.input_unit
            # those of exact change points have none
            of_input, of_value = np.nan_to_num([extremum.condition, extremum.value_condition])
            d = min(1e-6 * unit / max(1.0, of_input / unit),
                    1e-3 * _to_singular(mechanism, extremum.input))
            inputs = extremum.input + d * np.array((-1.0, 0.0, 1.0))
            around = by_name[extremum.quantity].of(*mechanism.step(inputs, *rates))
            drop, size = _drop(extremum.kind, around), abs(around[1])
            tolerance = 64 * EPS * size * (1 + of_value) if size else 0.0
            if drop < -tolerance and exact:
                truth = exact(mechanism, extremum.quantity, inputs, rates)
                drop = drop if truth is None else _drop(extremum.kind, truth)
            assert drop >= -tolerance, (mechanism, extremum)
    return number


def _is_below_its_bound(mechanism, name, at, rates):
    """Return whether its value, or its rise above its surroundings, is below rounding errors."""
    sampler = Sampler(mechanism, select((name,), mechanism), rates)
    half = 0.5 * _to_singular(mechanism, at)
    x = np.array([at, at - half, at + half]) / sampler.unit
    here, *beside = sampler.values(x)[0]
    own, *noise = sampler.errors(x, sampler.state(x))[1][0]
    return PART_OF_NOISE * own > abs(here) or any(
        PART_OF_NOISE * bound > abs(value - here) for value, bound in zip(beside, noise))


def _to_singular(mechanism, at):
    """Return the distance to the next singular input, of an angle in any turn."""
    return min((abs(complex(mechanism.distance(z.real, at), z.imag))
                for z in map(complex, mechanism.singular_inputs)), default=inf)


def _is_noise(mechanism, name, kind, top, step, rates, exact):
    """Return whether a top of the scan is none in many digits: rounding made it."""
    truth = exact and exact(mechanism, name, top + step * np.array((-1.0, 0.0, 1.0)), rates)
    return truth is not None and _drop(kind, truth) < 1e-30     # in its unit: less than digits


def _drop(kind, around):
    """Return by how much a value is beyond those on both sides."""
    sense = 1 if kind == 'maximum' else -1
    return min(sense * (around[1] - around[0]), sense * (around[1] - around[2]))
