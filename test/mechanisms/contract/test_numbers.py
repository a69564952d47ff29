# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Single values, arrays, some fields of them, other units of length."""

from dataclasses import replace

from fourbar_ros import Applied, Body, InvalidParameter
from fourbar_ros.mechanisms.quantities import known_quantities
import numpy as np
import pytest
from support import contract
from support.contract import every_mechanism
from support.samples import more, some


@every_mechanism
def test_arrays_equal_single_values(case):
    for mechanism, given in contract.ordinary(case, 211, 10):
        one = mechanism.step(*given)
        for shape in ((2, 1, 3), (100,)):
            many = mechanism.step(*(np.full(shape, v) for v in given))
            for single, array in zip(one, many):
                size = max(1.0, *map(abs, single))
                for name, value, values in zip(single._fields, single, array):
                    assert values.shape == shape and (values == values.flat[0]).all(), name
                    assert abs(values.flat[0] - value) <= 1e-12 * size, name
        assert mechanism.motion(np.float64(given[0]), *given[1:]) == one[0]


@every_mechanism
def test_some_fields_are_those_of_the_whole(case, count=more(1, 3)):
    for mechanism, given in contract.ordinary(case, 212, count):
        names = mechanism.MOTION._fields + mechanism.LOADS._fields
        for values in (given, [np.full(40, v) for v in given]):
            whole = dict(zip(names, sum(mechanism.step(*values), ())))
            for name in names:
                (part,) = mechanism.step(*values, fields=(name,))
                np.testing.assert_array_equal(part, whole[name], err_msg=name)
            assert len(mechanism.motion(*values, fields=mechanism.MOTION._fields)) == len(
                mechanism.MOTION._fields
            )
        for wrong in (('nothing',), 'theta1', (names[-1],)):
            with pytest.raises(InvalidParameter, match='^fields = '):
                mechanism.motion(*given, fields=wrong)


@every_mechanism
@some('power', [-498, 498], 1)
def test_scaling_by_a_power_of_two_changes_no_bit(case, power):
    """Lengths times a power of two, masses that keep forces: each field times a power of it."""
    scale = 2.0**(power if case != contract.MACHINES else power // 5)
    for mechanism, given in contract.ordinary(case, 213, 5):
        bodies = [Body(b.mass / scale, cg_along=b.cg_along * scale, cg_across=b.cg_across * scale,
                       inertia=b.inertia * scale)
                  for b in mechanism.bodies]
        external = [Applied(a.force_x, a.force_y, along=a.along * scale, across=a.across * scale,
                            couple=a.couple * scale) for a in mechanism.external]
        stroke = mechanism.stroke and {'stroke': [end * scale for end in mechanism.stroke]}
        larger = mechanism.with_lengths([v * scale for v in mechanism.lengths])
        scaled = replace(larger, bodies=bodies, external=external, **stroke or {},
                         gravity=[v * scale for v in mechanism.gravity])
        known = known_quantities(mechanism, mechanism.input)
        moved = [v * scale for v in given] if mechanism.is_driven_by_slide else given
        for one, other in zip(mechanism.step(*given), scaled.step(*moved)):
            for name, value, found in zip(one._fields, one, other):
                powers = (-2, -1, 0, 1) if name not in known else (1,) if known[name].unit in (
                    'm', 'm/s', 'm/s^2', 'N m', 'W') else (0,)
                assert found in [value * scale**power for power in powers], name
