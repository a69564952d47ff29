# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Measured rounding errors are those against many digits."""
from decimal import Decimal
import math
import re

from fourbar_ros import FourBar
from fourbar_ros.cli.main import main
from fourbar_ros.mechanisms.force_table import ForceTable
from fourbar_ros.mechanisms.rounding import rounding_errors
from fourbar_ros.scene.scene import load
import pytest
from support.cartesian import values

PLACES = [0.1 * k for k in range(1, 60, 7)]


@pytest.mark.parametrize('lengths', [(0.4, 1.2, 0.8, 1.0), (0.4, 1.2, 0.8, 0.8 + 1e-9)])
def test_they_are_the_distance_from_many_digits(lengths):
    linkage = FourBar(*lengths)
    found = rounding_errors(linkage, PLACES, 25.0, 3.0, False)
    motions = [linkage.motion(x, 25.0, 3.0) for x in PLACES]
    exact = [values(linkage, x, 25.0, 3.0) for x in PLACES]
    for name in ('omega4', 'alpha4'):
        error = max(abs(getattr(motion, name) - right[name])
                    for motion, right in zip(motions, exact))
        sort = name[:5]
        largest = max(abs(value) for motion in motions for field, value
                      in motion._asdict().items() if re.match('[a-z]*', field)[0] == sort)
        assert float(error / largest) == pytest.approx(found[name], rel=1e-6, abs=1e-25)


def test_a_table_that_comes_round_is_the_same_in_many_digits_before_its_start():
    """Python's % is never negative, that of decimals is."""
    places = (0.3, 1.0, 2.0, 5.0)
    table = ForceTable(places, (-1.0, 4.0, 2.0, -1.0), is_periodic=True)
    for x in (-40.0, -4.5, -3.7, 0.2, 0.3, 0.31, 4.9, 5.0, 30.0):
        by_hand = float(table(Decimal(places[0] + math.fmod(x - places[0] + 47.0, 4.7))))
        rounding = 20.0 * math.ulp(47.0)         # of x and of 4.7, by slopes below 20
        assert table(x) == pytest.approx(by_hand, abs=rounding)
        assert float(table(Decimal(x))) == pytest.approx(by_hand, abs=rounding)
    engine = load('engine').linkage
    found = rounding_errors(engine, [-9.0, -3.0, -1.0, 1.0], 1.0, 0.0, True)
    assert max(found.values()) < 1e-13


def test_scene_check_prints_them_beside_the_time_of_a_step(capsys):
    assert main(['scene', 'check', 'paper', '--error']) == 0
    text = ' '.join(capsys.readouterr().out.split())
    assert re.search(r'of rates and accelerations \de-16 \(\w+\), of loads \de-16 \(\w+\)', text)
    assert re.search(r'[0-9.]+ us on this machine', text)
