# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Formulas take and give records."""

from fourbar_ros.numerics.number_types import ARRAY, REAL
import numpy as np
import pytest
from support import contract


@pytest.mark.parametrize('case', contract.CASES, ids=contract.name_of)
def test_formulas_give_and_take_records(case):
    """Of any numbers, also where a part is out of range: a motion goes into the loads as it is."""
    for mechanism, given in contract.ordinary(case, 604, 1):
        for numbers, x in ((REAL, given[0]), (ARRAY, given[0] + np.linspace(-3.0, 3.0, 50))):
            with np.errstate(all='ignore'):
                motion = mechanism.make_motion(numbers)(x, *given[1:])
                loads = mechanism.make_loads(numbers)(motion)
            assert type(motion) is mechanism.MOTION and type(loads) is mechanism.LOADS
