# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Values that are zero, or equal, but for little: no poles, and none more extreme than another."""
import math

from fourbar_ros import find_extrema, FourBar
from fourbar_ros.extrema.find import _bounds
from fourbar_ros.extrema.path_search import PathExtremum
from fourbar_ros.mechanisms.quantities import Function
import numpy as np


def test_a_bounded_quantity_that_is_zero_beside_a_toggle_is_bounded_at_it():
    """It falls to less than half from one sample to the next, as a pole does, but not again."""
    linkage = FourBar(0.8, 1.2, 0.4, 1.0)
    low, high = linkage.input_ranges[0]
    at_toggle = linkage.motion(high - 1e-13 * (high - low)).theta4
    for apart in np.geomspace(1e-5, 1e-3, 24):
        crossing = Function('crossing', 'rad', 'zero beside the toggle',
                            lambda motion, _, apart=apart: motion.theta4 - at_toggle - apart)
        assert all(math.isfinite(one.value) for one in find_extrema(linkage, [crossing]))


def test_a_quantity_with_a_kink_at_a_toggle_is_not_continued_beyond_it():
    """|sin mu| goes on as a sine with its sign, which a polynomial through both sides is not."""
    kink = Function('kink', '1', 'kink at the toggle',
                    lambda motion, _: np.abs(np.sin(motion.transmission_angle)))
    limits = [one.value for one in find_extrema(FourBar(0.8, 1.2, 0.4, 1.0), [kink]) if one.side]
    assert len(limits) == 4 and np.abs(limits).max() < 1e-10


def test_values_count_as_equal_within_their_rounding_errors():
    assert _bounds(PathExtremum(0, 0.3, 1.0, 1, noise=1e-6)) == (1.0 - 1e-6, 1.0 + 1e-6)
    low, high = _bounds(PathExtremum(0, 0.3, 1.0, 1, value_condition=10.0))
    assert 1.0 - low == high - 1.0 == 104 * 2.0**-52
