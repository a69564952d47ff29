# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Reactions, torque, shaking wrench: the paper's linkage, its Eq. (9), power and momentum."""

from fourbar_ros import (
    Bodies,
    FourBar,
    OPEN,
    round_rod,
)
import numpy as np
import pytest

PAPER = FourBar(0.4, 1.2, 0.8, 1.0, mode=OPEN,
                bodies=Bodies(*(round_rod(length, 7750.0, 0.01) for length in (0.4, 1.2, 0.8))))


@pytest.mark.parametrize('field, theta1, value', [
    ('shaking_force', 0.10962848, 2512.318373), ('shaking_moment', 0.21995444, 2048.609105),
    ('driving_torque', 6.21476980, 720.4715562), ('f41', 0.11551325, 3862.925021),
    ('f21', 0.11396259, 3747.46146), ('f32', 0.13068520, 2788.891825),
    ('f43', 0.15042420, 2655.173464)])
def test_largest_loads_of_the_paper_linkage(field, theta1, value):
    """Six engines agree on these (the paper's Table 3 has momenta in place of forces)."""
    assert abs(getattr(PAPER.loads(theta1, 25.0), field)) == pytest.approx(value, rel=3e-10)
    around = PAPER.loads(theta1 + np.linspace(-0.5, 0.5, 2001), 25.0)
    assert np.abs(getattr(around, field)).max() <= value * (1.0 + 3e-10)
