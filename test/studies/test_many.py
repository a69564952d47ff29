# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Extrema of many four-bars at once beside those of each alone."""
from math import remainder

from fourbar_lab.studies import find_extrema_many
from fourbar_lab.studies import many as module
from fourbar_ros import FourBar, InvalidParameter
from fourbar_ros.errors import FourBarError
from fourbar_ros.extrema import find_extrema
import numpy as np
import pytest

EPS = 2.0**-52
PAPER = (0.4, 1.2, 0.8, 1.0)
RATES = ('omega4', 'alpha4')
# with two extrema close together; see test/extrema/test_find.py
PAIRS = ((0.35082668713088083, 0.8833869937245226, 0.830033957902283, 0.9114534728718168),
         (0.9901282012759378, 0.20704846913484642, 0.5637244933385037, 0.5631644614516844),
         (0.4051177427743674, 0.9265869837965962, 0.7664512540213785, 0.4051175759722894),
         (0.3787188125609142, 0.6804980652079842, 0.9270018374007172, 0.13355054582644563))
# change points in decimals, some of which repeat after two turns: cranks that all are in doubt
DOUBTFUL = ((0.1, 0.5, 0.3, 0.7), (0.1, 0.7, 0.5, 0.3), (0.1, 0.6, 0.3, 0.4),
            (0.69, 0.8, 1.23, 1.12))


def test_many_linkages_give_what_each_gives_alone():
    rng = np.random.default_rng(11)
    lengths = rng.uniform(0.1, 1.0, (4, 60))
    lengths[3, :20] = (lengths[1, :20] + lengths[2, :20]
                       - lengths[0, :20]) * (1.0 + 10.0**rng.uniform(-12.0, -2.0, 20))
    lengths[:, 40:] = 0.01**rng.uniform(0.0, 1.0, (4, 20))
    lengths[:, 20:23] = np.transpose([(2.0, 4.0, 3.0, 5.0), (1.0, 2.0, 1.0, 2.0),
                                      (1.0, -2.0, 1.0, 1.0)])
    lengths[:, 23:27], lengths[:, 27:31] = np.transpose(PAIRS), np.transpose(DOUBTFUL)
    modes, rates = rng.integers(1, 3, 60), rng.normal(0.0, 3.0, 60)
    many = find_extrema_many(*lengths, modes, rates)
    for j in range(60):
        try:
            linkage = FourBar(*lengths[:, j].tolist(), mode=int(modes[j]))
            alone = find_extrema(linkage, RATES, float(rates[j]))
        except FourBarError:
            alone = []
        for name in RATES:
            rows = np.nonzero(many[name].index == j)[0]
            expected = [e for e in alone if e.quantity == name]
            if not expected:
                row, = rows
                assert np.isnan(many[name].value[row]) and many[name].reason[row]
                continue
            assert rows.size == len(expected) and not many[name].reason[rows].any()
            for row, e in zip(rows, expected):
                place, size = np.nan_to_num((e.condition, e.value_condition))      # NaN at ends
                apart = remainder(many[name].theta1[row] - e.theta1, linkage.period)
                assert abs(apart) <= 10 * EPS * (6 + place)
                assert many[name].value[row] == pytest.approx(e.value, rel=10 * EPS * (1 + size))
                assert many[name].is_global[row] == e.is_global and many[name].side[row] == e.side
                assert e.kind == 'constant' or many[name].is_maximum[row] == (e.kind == 'maximum')


@pytest.mark.parametrize('lengths', [(0.1, 0.5, 0.2, 0.4), (0.2, 0.5, 0.5, 0.2),
                                     (0.2, 0.5, 0.2, 0.5), (0.2, 0.2, 0.5, 0.5)])
def test_change_points_among_many_have_the_extrema_of_their_whole_period(lengths):
    linkages = [FourBar(*lengths, mode=mode) for mode in (1, 2)]
    many = find_extrema_many(*np.transpose([PAPER, lengths, lengths]), [2, 1, 2], 3.0)
    for name in RATES:
        for j, linkage in enumerate(linkages, 1):
            alone = [(e.theta1, e.value, e.is_global) for e in find_extrema(linkage, name, 3.0)]
            rows = many[name].index == j
            assert alone == [*zip(many[name].theta1[rows], many[name].value[rows],
                                  many[name].is_global[rows])]
    # the least and the largest value of the paths that are sampled over the whole period
    linkage = linkages[1]
    values, = linkage.motion(np.linspace(0.0, linkage.period, 20001), 3.0, fields=['omega4'])
    found = many['omega4'].value[many['omega4'].index == 2]
    assert [found.min(), found.max()] == pytest.approx([values.min(), values.max()], rel=1e-6)


def test_cranks_are_seldom_searched_one_by_one(monkeypatch):
    alone, search = [], module.find_extrema
    monkeypatch.setattr(module, 'find_extrema', lambda *arguments: alone.append(arguments)
                        or search(*arguments))
    rng = np.random.default_rng(3)
    find_extrema_many(rng.uniform(0.2, 0.4, 2000), 1.2, rng.uniform(0.7, 0.9, 2000), 1.0)
    assert len(alone) < 10


def test_many_in_arrays_of_two_dimensions():
    lengths = np.array(PAPER)[:, None, None] * np.ones((4, 2, 3))
    lengths[1, 1, 2] = 1.1
    many, flat = (find_extrema_many(*lengths, rate=[[1.0], [2.0]]),
                  find_extrema_many(*lengths.reshape(4, 6), rate=[1.0] * 3 + [2.0] * 3))
    for name in RATES:
        assert all((one == other).all() for one, other in zip(many[name], flat[name]))
    assert set(many['omega4'].index) == set(range(6))


def test_many_refuses_rates_and_modes_it_cannot_use():
    with pytest.raises(InvalidParameter):
        find_extrema_many(*PAPER, rate=0.0)
    with pytest.raises(InvalidParameter):
        find_extrema_many(*PAPER, mode=3)
    for given, match in (((0.4, ['1.2'], 0.8, 1.0), '^a2'),
                         (([0.4, 0.5], [1.2, 1.1, 1.0], 0.8, 1.0), '^a1, a2')):
        with pytest.raises(InvalidParameter, match=match):
            find_extrema_many(*given)
    with pytest.raises(InvalidParameter, match=r'^rate = .* at most 1e\+100'):
        find_extrema_many(*PAPER, rate=[1.0, 1e160])


@pytest.mark.parametrize('lengths', DOUBTFUL)
def test_one_linkage_never_ends_the_others(lengths):
    """Each of these alone was a ValueError of numpy, and a kite within 1e-12 TooNarrow."""
    kite = (1.0, 1.0 + 1e-13, 2.0, 2.0)
    for rows in ([lengths], [kite], [lengths, kite, PAPER, (-1.0, 1.0, 1.0, np.nan)]):
        many = find_extrema_many(*np.transpose(rows), rate=10.0)
        for name in RATES:
            assert set(many[name].index) == set(range(len(rows)))
            assert (np.isnan(many[name].value) == (many[name].reason != '')).all()
    assert [e.value for e in find_extrema(FourBar(*PAPER), 'omega4', 10.0)] == pytest.approx(
        many['omega4'].value[many['omega4'].index == 2], rel=10 * EPS)
    assert 'must be' in many['omega4'].reason[-1]
