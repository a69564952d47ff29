# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Extrema of all quantities against dense scans and proofs."""
from itertools import islice

from fourbar_ros import find_extrema
from fourbar_ros.mechanisms.quantities import point_acceleration, point_speed, select
import numpy as np
import pytest
from support import contract
from support.contract import every_case
from support.samples import more
from support.scans import check_against_scan


def everything(mechanism):
    """Return all quantities of a mechanism, and two of a point of its second link."""
    link = mechanism.bodies._fields[1]
    return [*select((), mechanism), point_speed(mechanism, link, 0.3, -0.4),
            point_acceleration(mechanism, link, 0.3, -0.4)]


def mechanisms_for_extrema(case, seed, count, least=1e-3):
    """Yield random loaded mechanisms, not too near a change point."""
    return islice((mechanism for mechanism in contract.drawn(case, seed, 1000)
                   if mechanism.change_point_margin > least), count)


@every_case
def test_extrema_are_proved_complete(case):
    """All but magnitudes of reactions, which may have a kink or be too steep to decide."""
    pytest.importorskip('flint')
    for mechanism in mechanisms_for_extrema(case, 12, 1, 0.02):
        quantities = [q for q in everything(mechanism)
                      if q.name not in ('f41', 'f21', 'f32', 'f43', 'guide_couple', 'slot_couple')]
        proofs = {e.proof for e in find_extrema(mechanism, quantities, 3.0, 4.0, certify=True)}
        if case.name == 'scotch_yoke':
            proofs.discard('not proved: constant in a range')
        assert all(proof.startswith('interval bounds') for proof in proofs), (mechanism, proofs)
        assert all('at the ends' in proof for proof in proofs) != mechanism.turns_fully


@every_case
def test_extrema_against_a_scan(case, count=more(1, 10)):
    rng = np.random.default_rng(220)
    number = sum(check_against_scan(mechanism, everything(mechanism), float(rng.normal(0.0, 10.0)),
                                    float(rng.normal(0.0, 50.0)), 20_000)
                 for mechanism in mechanisms_for_extrema(case, 220, count))
    assert number > 6 * count
