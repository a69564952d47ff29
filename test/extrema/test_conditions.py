# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Condition numbers of extrema: how far wrong lengths move them, for every kind of mechanism."""
from fourbar_ros import find_extrema, FourBar, load_scene, SliderCrank
from fourbar_ros.machine import Dyad, Machine, Point
import mpmath as mp
import numpy as np
import pytest

EPS = 2.0**-52


def moved_by_lengths(mechanism, quantities, size):
    """Return [(extremum, by how much it moves, its value changes)] over changes of lengths."""
    def search(lengths):
        found = find_extrema(mechanism.with_lengths(lengths), quantities, 3.0, 0.7)
        return np.array([(e.input, e.value) for e in found if e.place == 'interior'])
    lengths, found = np.array(mechanism.lengths), find_extrema(mechanism, quantities, 3.0, 0.7)
    moves = sum(abs(search((lengths * (1.0 + step)).tolist())
                    - search((lengths * (1.0 - step)).tolist()))
                for step in size * np.eye(lengths.size)) / (2.0 * size)
    return list(zip([e for e in found if e.place == 'interior'], *moves.T, strict=True))


def size_of_rate(motion, _loads):
    """Return a quantity that floats alone can compute, with kinks where the output turns back."""
    return abs(motion.omega4)


@pytest.mark.parametrize('scene, quantities', [
    ('paper', ('f43', size_of_rate)), ('slider_crank', ('f43',)),
    ('scotch_yoke', ('driving_torque', 'f21')), ('bucket', ('driving_force',)),
    ('quick_return', ('ram_second', 'lever_inner'))])
def test_condition_numbers_are_those_of_every_kind_and_of_kinks(scene, quantities):
    """Against searches with other lengths; an extremum of value 0 is where |F| has a kink."""
    moves = moved_by_lengths(load_scene(scene).linkage, quantities, 1e-7)
    assert moves
    for extremum, moved, changed in moves:
        assert extremum.condition == pytest.approx(moved, rel=1e-3, abs=1e-6), extremum
        if abs(extremum.value) > 1e-9:
            assert extremum.value_condition * abs(extremum.value) == pytest.approx(
                changed, rel=1e-3, abs=1e-6 * abs(extremum.value)), extremum


NEARLY_OPEN = {          # {what is longest: mechanism}, the other lengths are 2 together
    'coupler': lambda long: FourBar(0.5, long, 1.0, 0.5),
    'output': lambda long: FourBar(1.0, 0.5, long, 0.5),
    'offset': lambda long: SliderCrank(1.0, 1.0, long),
    'rod of a dyad': lambda long: Machine([Dyad(
        'd', 'RRR', Point('crank', 1.0), Point('ground', 0.5), ('a', 'b'), length_1=0.5,
        length_2=long)])}


@pytest.mark.parametrize('gap', [1e-8, 1e-10, 1e-12])
@pytest.mark.parametrize('name', NEARLY_OPEN)
def test_conditions_of_linkages_that_nearly_cannot_close(name, gap):
    """The transmission angle is as the root of what is left, (sum of the others) - longest."""
    long = 2.0 * (1.0 - gap)
    mechanism = NEARLY_OPEN[name](long)
    alone, = find_extrema(mechanism, 'transmission_angle', conditions=False)[1:-1]
    found, = find_extrema(mechanism, 'transmission_angle')[1:-1]
    assert found[:6] == alone[:6]
    # relative change of the root for relative changes of all lengths together, 2 long in all
    assert found.value_condition == pytest.approx(2.0 * long / (2.0 * (2.0 - long)), rel=1e-3)
    assert all(e.condition < 1.0 for e in find_extrema(mechanism) if e.place == 'interior')


@pytest.mark.parametrize('gap', [1e-6, 1e-9, 1e-12])
def test_conditions_beside_a_change_point(gap):
    """The value of alpha4 beside the flat position against its derivatives in 60 digits."""
    lengths = (1.0, 2.0, 2.5, 3.5 * (1.0 - gap))

    def output(x, *lengths):
        """Return theta4 of the open mode by the angles of two triangles."""
        a1, a2, a3, a4 = lengths
        far = a4 - a1 * mp.expj(x)
        d = abs(far)
        return mp.pi + mp.arg(far) - mp.acos((a3**2 + d**2 - a2**2) / (2 * a3 * d))
    found = [e for e in find_extrema(FourBar(*lengths), 'alpha4') if e.place == 'interior']
    with mp.workdps(60):
        for extremum in found:
            at = (mp.mpf(extremum.theta1), *map(mp.mpf, lengths))
            value = mp.diff(output, at, (2, 0, 0, 0, 0))
            assert abs(value / extremum.value - 1) <= 8 * EPS * (1 + extremum.value_condition)
            size = sum(abs(at[1 + i] * mp.diff(output, at, (2, *(int(i == k) for k in range(4)))))
                       for i in range(4))
            assert extremum.value_condition == pytest.approx(float(size / abs(value)), rel=1e-3)
