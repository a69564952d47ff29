# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Proof on demand: what is proved, what is not, and that a missing extremum is noticed."""
import sys

from fourbar_ros import Bodies, Body, FourBar, InvertedSlider, round_rod, SliderCrank
from fourbar_ros.extrema.find import find_extrema
from fourbar_ros.extrema.methods import Methods
from fourbar_ros.mechanisms.quantities import known, point_speed
from fourbar_ros.numerics import sturm
import numpy as np
import pytest
from support.extrema_reference import descartes, Polynomial

PAPER = (0.4, 1.2, 0.8, 1.0)
RATES = ('omega4', 'alpha4')
QUANTITIES = known(FourBar)


MASSES = Bodies(Body(1.0, 0.3, 0.1, 0.02), Body(2.0, 0.4, -0.1, 0.03), Body(1.5, 0.2, 0.15, 0.05))


def with_rods(lengths, **others):
    return FourBar(*lengths, bodies=Bodies(*(round_rod(length, 7750.0, 0.01)
                                             for length in lengths[:3])), **others)


def proofs(extrema):
    return {e.proof for e in extrema}


@pytest.mark.parametrize('lengths', [PAPER, (4.0, 2.0, 3.0, 5.5), (1.2, 0.5, 0.8, 1.0),
                                     (2.0, 4.0, 3.0, 5.0),
                                     (0.5, 0.9, 0.7, 0.5)])
@pytest.mark.parametrize('mode', [1, 2])
def test_rates_are_counted_exactly(lengths, mode):
    assert proofs(find_extrema(FourBar(*lengths, mode=mode), RATES, 3.0,
                               certify=True)) == {'exact count'}


@pytest.mark.parametrize('lengths, theta1',
                         [((1.0, 3.0, 5.0, 5.0), 0.0), ((3.0, 4.0, 5.0, 6.0), 0.0),
                          ((1.0, 3.0, 5.0, 3.0), np.pi)])
@pytest.mark.parametrize('mode', [1, 2])
def test_extrema_at_theta1_0_and_180_degrees_are_counted(lengths, theta1, mode):
    """There (a1 -+ a4)^2 = a3^2 - a2^2: the root lies at the end of the range of |A O4|."""
    found = find_extrema(FourBar(*lengths, mode=mode), 'omega4', certify=True)
    assert proofs(found) == {'exact count'}
    assert sum(abs(np.remainder(e.theta1 - theta1 + 1.0, 2 * np.pi) - 1.0) < 1e-15
               for e in found) == 1


@pytest.mark.parametrize('mechanism, quantity',
                         [(SliderCrank(0.1, 0.3, 0.02, bodies=MASSES), 'f43'),
                          (InvertedSlider(0.1, 0.3, 0.02, bodies=MASSES), 'f32')])
def test_magnitudes_of_forces_that_change_their_sense_are_proved(mechanism, quantity):
    """
    A force along one line.

    Its magnitude has kinks, where it is zero, and all of them are global minima.
    """
    pytest.importorskip('flint')
    found = find_extrema(mechanism, quantity, 3.0, 1.0, certify=True)
    assert proofs(found) == {'interval bounds'}
    zeros = [e for e in found if e.value == 0.0]
    assert len(zeros) == 2 and all(e.is_global and e.kind == 'minimum' for e in zeros)
    without = [e for e in find_extrema(mechanism, quantity, 3.0, 1.0, conditions=False)
               if e.value == 0.0]
    assert [e.is_global for e in without] == [True, True]


def test_no_proof_is_claimed_unless_asked():
    assert proofs(find_extrema(FourBar(*PAPER), RATES)) == {''}


def test_input_acceleration_needs_intervals_for_the_acceleration_only():
    pytest.importorskip('flint')
    found = find_extrema(FourBar(*PAPER), RATES, 3.0, 2.0, certify=True)
    assert proofs(e for e in found if e.quantity == 'omega4') == {'exact count'}
    assert proofs(e for e in found if e.quantity == 'alpha4') == {'interval bounds'}


@pytest.mark.parametrize('lengths, end', [(PAPER, ''), ((1.0, 2.0, 2.5, 3.4999), ''),
                                          ((4.0, 2.0, 3.0, 5.5),
                                           ', except 1e-11 rad at the ends')])
def test_loads_are_proved_by_intervals(lengths, end):
    pytest.importorskip('flint')
    found = find_extrema(with_rods(lengths), ('driving_torque', 'shaking_moment'), 25.0,
                         certify=True)
    text, = proofs(found)
    assert text.startswith('interval bounds' + end[:9]) and text.endswith(end[-16:])


def test_functions_are_proved_by_intervals():
    pytest.importorskip('flint')
    linkage = FourBar(*PAPER)
    assert proofs(find_extrema(linkage, point_speed(linkage, 'coupler', 0.5, 0.2),
                               certify=True)) == {'interval bounds'}
    assert proofs(find_extrema(linkage, lambda motion, loads: motion.theta4,
                               certify=True)) == {'interval bounds'}


def test_what_cannot_be_proved_says_why(monkeypatch):
    linkage = with_rods(PAPER)
    constant = find_extrema(with_rods((1.0, 2.0, 1.0, 2.0)), ('omega4', 'f41'), certify=True)
    assert all('not proved: constant in a range' in text for text in proofs(constant))
    monkeypatch.setitem(sys.modules, 'flint', None)
    assert proofs(find_extrema(linkage, ('f41',),
                               certify=True)) == {'not proved: needs the package python-flint'}


def test_a_function_without_enclosures_is_not_proved():
    pytest.importorskip('flint')
    text, = proofs(find_extrema(FourBar(*PAPER), lambda motion, loads: abs(motion.omega4),
                                certify=True))
    assert text.startswith('not proved: the function does not work on enclosures')


@pytest.mark.parametrize('quantity', ['alpha4', 'driving_torque'])
def test_a_missing_extremum_is_noticed(monkeypatch, quantity):
    pytest.importorskip('flint')
    search = Methods.search
    monkeypatch.setattr(Methods, 'search',
                        lambda *arguments: [part[1:] for part in search(*arguments)])
    number = len(find_extrema(with_rods(PAPER), (quantity,), 25.0)) + 1
    text, = proofs(find_extrema(with_rods(PAPER), (quantity,), 25.0, certify=True))
    assert text == f'not proved: {number - 1} found, {number} exist'


def test_a_missing_extremum_is_searched_for_again(monkeypatch):
    search, densities = Methods.search, []

    def forgetful(self, density, conditions):
        densities.append(density)
        found = search(self, density, conditions)
        return [part[1:] for part in found] if density == 1 else found

    monkeypatch.setattr(Methods, 'search', forgetful)
    found = find_extrema(FourBar(*PAPER), ('alpha4',), certify=True)
    assert len(found) == 2 and proofs(found) == {'exact count'} and densities == [1, 8]


def test_sturm_counts_like_descartes():
    """
    On polynomials with roots that are known.

    Random integers, double and complex ones among them.
    """
    rng = np.random.default_rng(3)
    for _ in range(200):
        roots = rng.choice([*range(-30, 0), *range(1, 31)], rng.integers(1, 8),
                           replace=False).tolist()
        P = Polynomial(int(rng.integers(1, 5)), 0, 1)
        for root in roots:
            P = P * Polynomial(-root, 1)
        low, high = -15, 20
        inside = [root for root in roots if low < root < high]
        assert sturm.count_roots(sturm.Polynomial(P.c), low, high) == len(inside)
        assert descartes(P, low, high, 0) >= len(inside)
        if inside:
            assert sturm.count_roots(sturm.Polynomial((P * Polynomial(-inside[0], 1)).c), low,
                                     high) is None


@pytest.mark.slow
@pytest.mark.parametrize('mode', [1, 2])
def test_all_quantities_of_many_linkages_are_proved(mode):
    pytest.importorskip('flint')
    rng = np.random.default_rng(8)
    number = 0
    while number < 10:
        lengths = np.sort(rng.uniform(0.1, 1.0, 4)).tolist()
        if lengths[0] + lengths[3] < 0.99 * (lengths[1] + lengths[2]):
            number += 1
            found = find_extrema(with_rods(lengths, mode=mode), (), 10.0, certify=True)
            assert proofs(found) == {'exact count', 'interval bounds'}
            assert {e.quantity for e in found} == set(QUANTITIES)
