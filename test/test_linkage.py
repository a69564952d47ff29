"""The linkage: what is refused, its class, its limits."""
from math import acos, inf, nan, pi

import pytest
from reference import EPS

from fourbar_ros import Body, FourBar, InvalidParameter, round_rod


@pytest.mark.parametrize('lengths, name', [
    ((0.0, 1.0, 1.0, 1.0), 'a1'), ((1.0, -1.0, 1.0, 1.0), 'a2'), ((1.0, 1.0, nan, 1.0), 'a3'),
    ((1.0, 1.0, 1.0, inf), 'a4'), ((1.0, 1.0, 1.0, 3.0), 'a4'), ((5.0, 1.0, 1.0, 1.0), 'a1')])
def test_bad_lengths_are_refused_by_name(lengths, name):
    with pytest.raises(InvalidParameter, match=f'^{name} = ') as caught:
        FourBar(*lengths)
    assert caught.value.name == name


@pytest.mark.parametrize('mode', [0, 3, 'open', None])
def test_bad_modes_are_refused(mode):
    with pytest.raises(InvalidParameter, match='^mode'):
        FourBar(1.0, 2.0, 2.0, 2.0, mode=mode)


@pytest.mark.parametrize('gravity', [(nan, 0.0), (0.0, inf), (0.0,), (0.0, 0.0, -9.81)])
def test_bad_gravity_is_refused(gravity):
    with pytest.raises(InvalidParameter, match='^gravity = '):
        FourBar(1.0, 2.0, 2.0, 2.0, gravity=gravity)


@pytest.mark.parametrize('arguments, name', [
    ((-1.0,), 'mass'), ((nan,), 'mass'), ((1.0, inf), 'cg_along'), ((1.0, 0.0, nan), 'cg_across'),
    ((1.0, 0.0, 0.0, -1.0), 'inertia')])
def test_bad_bodies_are_refused_by_name(arguments, name):
    with pytest.raises(InvalidParameter, match=f'^{name} = '):
        Body(*arguments)


def test_round_rod_is_table_1_of_the_paper():
    assert [round_rod(length, 7750.0, 0.01).mass for length in (0.4, 1.2, 0.8)] == pytest.approx(
        [31.0 * pi / 100.0, 93.0 * pi / 100.0, 31.0 * pi / 50.0], rel=1e-15)
    rod = round_rod(1.2, 7750.0, 0.01)
    assert (rod.cg_along, rod.cg_across) == (0.6, 0.0)
    assert rod.inertia == pytest.approx(rod.mass * (3.0 * 0.01**2 + 1.2**2) / 12.0, rel=1e-15)
    for bad in ((0.0, 1.0, 1.0), (1.0, -1.0, 1.0), (1.0, 1.0, nan)):
        with pytest.raises(InvalidParameter):
            round_rod(*bad)


def test_limits_of_a_rocker_input():
    (low, high), = FourBar(4.0, 3.0, 2.0, 8.0).input_ranges
    assert high == pytest.approx(acos(55.0 / 64.0), rel=2 * EPS) and low == -high
