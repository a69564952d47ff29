# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The octahedron: its faces, octants and distances, each from lengths in another way."""
from fractions import Fraction
from itertools import product

from fourbar_lab.drawing.record import CHANGE_POINTS, mobility
from fourbar_lab.drawing.tables import facts
from fourbar_ros import FourBar, InvalidParameter, SliderCrank
import pytest


def every(most):
    """Yield the four-bars with small whole lengths."""
    for lengths in product(range(1, most + 1), repeat=4):
        try:
            yield FourBar(*map(float, lengths))
        except InvalidParameter:
            # cannot close: on or beyond a face
            assert 2 * max(lengths) >= sum(lengths)


def test_octants_are_classes_and_the_distance_is_that_of_the_change_point():
    octants = {}
    for linkage in every(6):
        found = mobility(linkage)
        assert sum(map(abs, found['place'].values())) < 1.0
        a1, a2, a3, a4 = map(Fraction, linkage.lengths)
        sums = {'A1': a1 + a4 - a2 - a3, 'C1': a1 + a3 - a2 - a4, 'D1': a1 + a2 - a3 - a4}
        expected = {name: float(value / (a1 + a2 + a3 + a4)) for name, value in sums.items()}
        assert found['place'] == pytest.approx(expected, abs=1e-16)
        nearest, = (abs(value) for name, value in found['place'].items()
                    if CHANGE_POINTS[name] == found['nearest_change_point'])
        assert nearest == pytest.approx(linkage.change_point_margin)
        if 0 not in sums.values():
            octant = tuple(value > 0 for value in sums.values())
            octants.setdefault(octant, set()).add(linkage.classification)
    assert len(octants) == 8 and all(len(classes) == 1 for classes in octants.values())


def test_rows_show_the_point():
    linkage = FourBar(0.4, 1.2, 0.8, 1.0)
    rows = dict(facts(linkage))
    assert rows['factors'].split() == ['A1', '-', 'A2', '+', 'B1', '+', 'B2', '+', 'C1', '-',
                                       'C2', '+', 'D1', '-', 'D2', '-']
    nearest, = (name for name in CHANGE_POINTS if 'nearest' in rows[name])
    # a1 + a2 - a3 - a4 = -0.2 of 3.4
    assert nearest == 'D1' and '-0.058824' in rows['D1'] and 'a1 + a2 = a3 + a4' in rows['D1']


def test_other_mechanisms_have_none():
    slider = SliderCrank(0.3, 0.8)
    assert mobility(slider) is None and 'factors' not in dict(facts(slider))
