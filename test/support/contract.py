# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Mechanisms of every kind, input and mode for the tests of the contract.

Drawn at random and from hard families.
"""

from typing import Any, NamedTuple

from fourbar_ros import (
    Applied,
    Bodies,
    Body,
    External,
    InvalidParameter,
    MovingJointFourBar,
)
from fourbar_ros.mechanisms.kinds import KINDS
import numpy as np
import pytest
from support import cartesian, random_machines

FAMILIES = (
    'random',
    'near a toggle',
    'near a change point',
    'link ratios 1e8',
    'near a special input',
)
ANGLES = ('theta', 'beta')  # how fields begin that count modulo a turn
TRIES = 10_000


class Case(NamedTuple):
    """A kind of mechanism with one of its inputs, in one assembly mode."""

    name: str
    kind: Any
    driven: str
    mode: int

    def exact(self, mechanism, given):
        """Return the Cartesian of one of its mechanisms, whose pose is next to the library's."""
        motion, near = mechanism.motion(*given), []
        exact = cartesian.Kind(self.name, mechanism.lengths, self.sign, self.driven,
                               mechanism.bodies, mechanism.external, mechanism.gravity)
        for link in exact.moving:
            at = mechanism.link_motion(motion, link)
            near.append([at.x, at.y, float(np.arctan2(at.sine, at.cosine))])
        if self.driven == 'crank':
            near[0][2] = given[0]
        return cartesian.exact(exact, given, near)

    @property
    def sign(self):
        """Return the assembly mode as the reference takes it."""
        return 2 * self.mode - 3

    @property
    def turns(self):
        """Return whether the input is an angle."""
        return self.kind.INPUTS[self.driven].position.startswith(ANGLES)

    @property
    def bodies(self):
        """Return the type of its bodies: a field for each moving link."""
        return getattr(self.kind, 'BODIES', Bodies)

    @property
    def external(self):
        """Return the type of its external loads: a field for each link that can be loaded."""
        return getattr(self.kind, 'EXTERNAL', External)

    def make(self, lengths, masses=None, **others):
        """Return the mechanism; ``masses``: what :func:`random_masses` returns."""
        if len(self.kind.INPUTS) > 1:
            others['input'] = self.driven
        if masses is not None:
            bodies, applied, gravity = self.pieces(masses)
            others.update(
                bodies=self.bodies(*(Body(*b) for b in bodies)),
                gravity=tuple(gravity),
                external=self.external(*(Applied(*a) for a in applied)),
            )
        return self.kind(*lengths, mode=self.mode, **others)

    def pieces(self, values):
        """Split a flat list into bodies (four numbers), applied loads (five) and gravity."""
        count, first = len(self.bodies._fields), 4 * len(self.bodies._fields)
        return (
            [values[4 * i: 4 * i + 4] for i in range(count)],
            [values[first + 5 * i: first + 5 * i + 5] for i in range(len(self.external._fields))],
            values[-2:],
        )


def modes_of(kind, driven):
    """
    Return the assembly modes of a kind with this input.

    Read from one whose lengths are all one metre.
    """
    others = {'input': driven} if len(kind.INPUTS) > 1 else {}
    return tuple(kind(*[1.0 for _ in kind.LENGTHS], **others).modes)


CASES = [
    Case(name, kind, driven, mode)
    for name, kind in (*KINDS.items(), ('four_bar', MovingJointFourBar))
    for driven in kind.INPUTS
    for mode in modes_of(kind, driven)
]


def name_of(case):
    """Return the name of a case in the list of tests."""
    return f'{case.name}-{case.driven}-{case.mode}' if isinstance(case, Case) else str(case)


MACHINES = 'machines'  # of dyads, drawn with their structure: see :func:`ordinary`
every_case = pytest.mark.parametrize('case', CASES, ids=name_of)
every_mechanism = pytest.mark.parametrize('case', [*CASES, MACHINES], ids=name_of)


def are_signed(kind):
    """Return for each length whether it may be negative."""
    return [getattr(length, 'signed', length == 'offset') for length in kind.LENGTHS]


def small(rng, low, high):
    """Return a number of either sign, uniform in its logarithm."""
    return float(rng.choice((-1.0, 1.0)) * 10.0 ** rng.uniform(low, high))


def _without_offset(rng):
    return *rng.uniform(0.1, 1.0, 2), 0.0


def _near_the_limit_of_the_offset(rng):
    one, other = rng.uniform(0.1, 1.0, 2)
    return (one, other,
            (one + other) * (1.0 - 10.0 ** rng.uniform(-14, -1)) * rng.choice((-1.0, 1.0)))


def _equal_lengths(rng):
    one = rng.uniform(0.1, 1.0)
    return one, one * (1.0 + small(rng, -16, -2)), rng.choice((0.0, small(rng, -16, -2)))


# {kind: {name: function (rng) -> lengths}} of hard cases beside those that all kinds share
OWN_FAMILIES = dict.fromkeys(('slider_crank', 'inverted_slider'), {
    'without offset': _without_offset,
    'near the limit of the offset': _near_the_limit_of_the_offset,
    'equal lengths': _equal_lengths,
})


def families_of(case):
    """Return the names of the families of lengths and inputs: those of all, then its own."""
    return (*FAMILIES, *OWN_FAMILIES.get(case.name, ()))


every_family = pytest.mark.parametrize(
    'case, family',
    [
        (case, family)
        for case in CASES
        for family in families_of(case)
    ],
    ids=name_of,
)


def _lengths(rng, case, family):
    """Return lengths that may or may not close."""
    if family in OWN_FAMILIES.get(case.name, ()):
        return np.array(OWN_FAMILIES[case.name][family](rng), float)
    signed = np.array(are_signed(case.kind))
    if family == 'link ratios 1e8':
        lengths = 10.0 ** rng.uniform(-4.0, 4.0, len(signed))
        order = np.argsort(lengths)
        if not signed.any() and rng.random() < 0.7:  # few close; two nearly equal long ones do
            lengths[order[-2]] = (
                lengths[order[-1]] + rng.uniform(-1.0, 1.0) * lengths[order[:-2]].sum()
            )
        return lengths * np.where(signed, rng.choice((-1.0, 1.0)), 1.0)
    lengths = rng.uniform(np.where(signed, -1.0, 0.1), 1.0)
    margins = [signs for signs in case.kind.MARGIN_SIGNS if min(signs) < 0 < max(signs)]
    if family == 'near a change point' and margins:  # others are sums of lengths, never zero
        signs = np.array(margins[rng.integers(len(margins))])
        i = rng.choice(np.flatnonzero(signs))  # the length that makes this margin nearly zero
        rest = -signs[i] * (signs @ np.abs(lengths) - signs[i] * abs(lengths[i]))
        lengths[i] = (
            rest * (1.0 + small(rng, -16, -3)) * (rng.choice((-1.0, 1.0)) if signed[i] else 1.0)
        )
    return lengths


def _position(rng, case, mechanism, family):
    low, high = mechanism.input_ranges[rng.integers(len(mechanism.input_ranges))]
    special = family in ('near a special input', 'near a change point',
                         *OWN_FAMILIES.get(case.name, ()))
    if special and rng.random() < 0.7:
        at = 0.5 * np.pi * rng.integers(-2, 3) if case.turns else 0.0
        return float(at + small(rng, -30 if family == 'near a special input' else -14, 0))
    share = rng.uniform()
    if family == 'near a toggle':
        share = 10.0 ** rng.uniform(-14, -1)
        share = share if rng.random() < 0.5 else 1.0 - share
    return float(low + (high - low) * share)


def draw(rng, case, family='random'):
    """Return lengths [m] and (input, rate, acceleration) of a mechanism that closes."""
    for _ in range(TRIES):
        lengths = tuple(_lengths(rng, case, family).tolist())
        try:
            mechanism = case.make(lengths)
        except InvalidParameter:
            continue
        if not mechanism.input_ranges:
            continue
        given = (_position(rng, case, mechanism, family), float(rng.normal()), float(rng.normal()))
        if any(low < given[0] < high for low, high in mechanism.input_ranges):
            return lengths, given
    raise AssertionError(f'{case}: no mechanism of the family {family!r} in {TRIES} tries')


def random_masses(rng, case, reach, speed):
    """Return numbers for :meth:`Case.pieces`, all of a size that matters."""
    force, values = reach * speed**2, []
    for _ in case.bodies._fields:
        values += [
            rng.uniform(0.1, 10.0),
            *(rng.uniform(-1.0, 1.0, 2) * reach),
            rng.uniform(0.0, 1.0) * reach**2,
        ]
    for _ in case.external._fields:
        values += [
            *(rng.uniform(-5.0, 5.0, 2) * force),
            *(rng.uniform(-1.0, 1.0, 2) * reach),
            rng.uniform(-5.0, 5.0) * force * reach,
        ]
    return [float(v) for v in (*values, *(rng.uniform(-1.0, 1.0, 2) * force))]


def ordinary(case, seed, count):
    """Yield (mechanism, input) with everything acting, away from toggles and change points."""
    if case == MACHINES:
        yield from random_machines.random_machines(seed, count, dyads=(1, 4), least_sine=0.2)
        return
    rng = np.random.default_rng(seed)
    while count:
        lengths, given = draw(rng, case)
        mechanism = case.make(lengths, random_masses(rng, case, max(map(abs, lengths)), 3.0))
        if (
            abs(np.sin(mechanism.motion(*given).transmission_angle)) > 0.2
            and mechanism.change_point_margin > 1e-2
        ):
            count -= 1
            yield mechanism, given


def ordinary_of(names, seed, count, driven=None):
    """Yield what :func:`ordinary` does of each case of these kinds, or of one of their inputs."""
    for case in CASES:
        if case.name in names and driven in (None, case.driven):
            yield from ordinary(case, seed, count)


def coordinates(kind):
    """Return the coordinates of the joints of a kind or a mechanism."""
    return [joint.coordinate for joint in kind.JOINTS]
