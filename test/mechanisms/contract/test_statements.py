# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""What a mechanism states about itself, and what it refuses."""


from fourbar_ros import OutOfRange
from fourbar_ros.mechanisms.kinds import KINDS
from fourbar_ros.mechanisms.quantities import known_quantities
import numpy as np
from support import contract
from support.cartesian import EPS
from support.contract import CASES, every_case, every_mechanism


def test_every_kind_has_a_case():
    assert {case.name for case in CASES} == set(KINDS)


@every_mechanism
def test_fields_are_named(case):
    mechanism, _ = next(contract.ordinary(case, 200, 1))
    motion, loads = mechanism.MOTION._fields, mechanism.LOADS._fields
    assert len(set(motion + loads)) == len(motion + loads)
    for coordinate in (*contract.coordinates(mechanism), *mechanism.INPUTS.values()):
        assert set(coordinate) <= set(motion), coordinate
    assert {'transmission_angle', 'condition'} <= set(motion)
    assert {'shaking_force_x', 'shaking_force_y', 'shaking_force', 'shaking_moment'} <= set(loads)
    assert set(known_quantities(mechanism, mechanism.input)) <= set(motion + loads)
    assert {link.name for link in mechanism.LINKS} == set(mechanism.BODIES._fields)
    assert {reaction.joint for reaction in mechanism.REACTIONS} == {
        joint.place for joint in mechanism.JOINTS}


@every_mechanism
def test_margins_are_the_sums_of_lengths_that_are_stated(case):
    for mechanism, _ in contract.ordinary(case, 225, 10):
        sizes = np.abs(mechanism.lengths)
        sums = [np.dot(signs, sizes) for signs in mechanism.MARGIN_SIGNS]
        assert len(sums) == len(mechanism.margins) or case == contract.MACHINES
        for found, margin in zip(sums, mechanism.margins):
            assert abs(found - margin) <= 4 * EPS * sizes.sum()


@every_mechanism
def test_what_is_given_comes_back(case):
    for mechanism, given in contract.ordinary(case, 214, 5):
        motion = mechanism.motion(*given)
        assert tuple(getattr(motion, name) for name in mechanism.input_coordinate) == given
        unknown = mechanism.unknown(*given)._asdict()
        assert tuple(unknown.pop(name) for name in mechanism.input_coordinate) == given
        assert all(np.isnan(value) for value in unknown.values())


@every_case
def test_in_mode(case):
    for mechanism, given in contract.ordinary(case, 216, 5):
        assert mechanism.in_mode(case.mode) is mechanism
        for mode in contract.modes_of(case.kind, case.driven):
            other = mechanism.in_mode(mode)
            assert (
                other.mode == mode
                and other.lengths == mechanism.lengths
                and other.bodies == mechanism.bodies
            )
            if mode != case.mode:
                try:
                    assert other.motion(*given) != mechanism.motion(*given)
                except OutOfRange:  # a mode may have a range of its own
                    assert other.input_ranges != mechanism.input_ranges
        assert (mechanism.sign > 0.0) == (case.mode == 2)
