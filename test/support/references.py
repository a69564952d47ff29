# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The reference of every kind of mechanism, in many digits.

A new kind adds one entry to :data:`REFERENCES`.

The tests in ``mechanisms/contract`` compare each kind with its reference, and fail for a kind
without one.
"""

from collections.abc import Callable, Mapping
from typing import NamedTuple

import mpmath as mp
from support import reference, slider_reference, yoke_reference


class Reference(NamedTuple):
    """
    Exact values of one kind, by a formulation that shares nothing with the package.

    All take (driven, lengths, sign, given): name of the input, lengths [m], +1 or -1 for the
    assembly mode, input with its rate and acceleration, all as numbers for mpmath.

    Parameters
    ----------
    motion : callable
        Returns {field of the motion: mpf} of angles, travel, rates and accelerations; None where
        the mechanism cannot close or is at a toggle.
    links : callable
        Returns {link: (place of its first joint [m], its direction)}, both complex.
    loads : callable
        Takes (bodies, applied, gravity) too: four numbers a link, five for each link that can be
        loaded, two. Returns {field of the loads: mpf, or mpc for a pair of fields NAME_x, NAME_y}.
    families : mapping
        {name: function (rng) -> lengths} of hard cases beside those that all kinds share.

    """

    motion: Callable
    links: Callable
    loads: Callable
    families: Mapping = {}


# --- the four-bar --------------------------------------------------------------------------------


def _four_bar_motion(driven, lengths, sign, given):
    if reference.pose(lengths, sign, given[0]) is None:
        return None
    values = reference.motion_of(lengths, sign, *given)
    found = {
        **dict(zip(('theta1', 'omega1', 'alpha1'), given)),
        **dict(zip(reference.MOTION_FIELDS, values)),
    }
    return {
        **found,
        'theta2': found['beta'] - given[0],
        'theta3': found['theta4'] - found['beta'] + mp.pi,
    }


def _four_bar_links(driven, lengths, sign, given):
    at, crank = reference.pose(lengths, sign, given[0]), mp.expj(given[0])
    return {
        'crank': (mp.mpc(0), crank),
        'coupler': (lengths[0] * crank, mp.expj(at.b)),
        'output': (mp.mpc(lengths[3]), mp.expj(at.y)),
    }


def _four_bar_loads(driven, lengths, sign, given, bodies, applied, gravity):
    return dict(
        zip(
            reference.LOAD_NAMES,
            reference.loads_of(lengths, sign, *given, bodies, applied, gravity),
        )
    )


def _with_drive_named(loads, driven):
    """Return loads with 'drive' as the torque or the force that it is."""
    drive, is_crank = loads.pop('drive'), driven == 'crank'
    return {**loads, 'driving_torque': drive * is_crank, 'driving_force': drive * (not is_crank)}


# --- the sliders ---------------------------------------------------------------------------------


def _slider(kind, families):
    """Return the Reference of a kind that :mod:`support.slider_reference` knows."""

    def motion(driven, lengths, sign, given):
        if slider_reference.exact((kind, driven), lengths, sign, given) is None:
            return None
        found = dict(
            zip(
                slider_reference.FIELDS[kind],
                slider_reference.fields_of((kind, driven), lengths, sign, given),
            )
        )
        if kind is slider_reference.SliderCrank:  # the slider does not turn
            found.update(
                theta3=-found['beta'], omega3=-found['omega_beta'], alpha3=-found['alpha_beta']
            )
        return found

    def links(driven, lengths, sign, given):
        at = slider_reference.exact((kind, driven), lengths, sign, given)
        crank, other = mp.expj(at.angle[0]), mp.expj(at.angle[1])
        last = (
            (mp.mpc(at.angle[2], lengths[2]), mp.mpc(1))
            if kind is slider_reference.SliderCrank
            else (mp.mpc(lengths[1]), other)
        )
        return {
            'crank': (mp.mpc(0), crank),
            'coupler': (lengths[0] * crank, other),
            'output': last,
        }

    def loads(driven, lengths, sign, given, bodies, applied, gravity):
        found = dict(
            zip(
                slider_reference.LOADS,
                slider_reference.loads_of(
                    (kind, driven), lengths, sign, given, bodies, applied, gravity
                ),
            )
        )
        return _with_drive_named(found, driven)

    return Reference(motion, links, loads, families)


def _without_offset(rng):
    return *rng.uniform(0.1, 1.0, 2), 0.0


def _near_the_limit_of_the_offset(rng):
    one, other = rng.uniform(0.1, 1.0, 2)
    return (
        one,
        other,
        (one + other) * (1.0 - 10.0 ** rng.uniform(-14, -1)) * rng.choice((-1.0, 1.0)),
    )


def _equal_lengths(rng):
    one = rng.uniform(0.1, 1.0)
    return (
        one,
        one * (1.0 + slider_reference.small(rng, -16, -2)),
        rng.choice((0.0, slider_reference.small(rng, -16, -2))),
    )


_OF_SLIDERS = {
    'without offset': _without_offset,
    'near the limit of the offset': _near_the_limit_of_the_offset,
    'equal lengths': _equal_lengths,
}


# --- the Scotch yoke -----------------------------------------------------------------------------


def _yoke_motion(driven, lengths, sign, given):
    if driven == 'slide' and abs(given[0]) >= lengths[0]:
        return None
    fields = yoke_reference.fields_of(driven, lengths, sign, given)
    return dict(zip(yoke_reference.FIELDS, fields))


def _yoke_links(driven, lengths, sign, given):
    pin, _ = yoke_reference.exact(driven, lengths, sign, given)
    return {
        'crank': (mp.mpc(0), pin),
        'coupler': (pin, mp.mpc(0, 1)),
        'output': (mp.mpc(pin.real, lengths[1]), mp.mpc(1)),
    }


def _yoke_loads(driven, lengths, sign, given, bodies, applied, gravity):
    values = yoke_reference.loads_of(driven, lengths, sign, given, bodies, applied, gravity)
    return _with_drive_named(dict(zip(yoke_reference.LOADS, values)), driven)


REFERENCES = {
    'four_bar': Reference(_four_bar_motion, _four_bar_links, _four_bar_loads),
    'slider_crank': _slider(slider_reference.SliderCrank, _OF_SLIDERS),
    'inverted_slider': _slider(slider_reference.InvertedSlider, _OF_SLIDERS),
    'scotch_yoke': Reference(_yoke_motion, _yoke_links, _yoke_loads),
}
