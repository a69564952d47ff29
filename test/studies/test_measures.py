# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Measures of designs of every kind beside a dense scan of the mechanism itself."""
from dataclasses import replace
from math import acos, inf, isnan, pi, remainder, tau

from fourbar_lab.studies import chunks
from fourbar_lab.studies.chunks import compute
from fourbar_lab.studies.measures import Design, Measures
from fourbar_lab.studies.study import from_document
from fourbar_ros.scene.scene import from_values
import numpy as np
import pytest
from support.samples import some
from support.scenes import file_of, PAPER, RODS

pytest.importorskip('scipy')
SCAN = 20_001
one_by_one = chunks._row
SCENES = {
    'watt': ({'dyads.one.length_1': {'range': [1.15, 1.25]}, 'gravity.y': {'list': [0.0, -9.81]}},
             ['shaking_force', 'driving_torque.rms']),
    'paper': ({'linkage.a1': {'range': [0.2, 0.9]}, 'linkage.mode': {'list': [1, 2]}},
              ['shaking_force', 'omega4', 'f32.peak', 'driving_torque.rms', 'swing',
               'time_ratio', 'class', 'change_point_margin', 'input_range']),
    'slider_crank': ({'linkage.a1': {'range': [0.03, 0.08]},
                      'bodies.coupler.mass': {'normal': 0.01}},
                     ['shaking_force', 'slide_acceleration', 'f32.peak', 'driving_torque.rms',
                      'stroke', 'time_ratio']),
    'scotch_yoke': ({'linkage.a1': {'range': [0.03, 0.08]}},
                    ['shaking_force', 'driving_torque.rms', 'stroke', 'time_ratio']),
    'cylinder': ({'linkage.a1': {'uniform': 0.05}},
                 ['omega1', 'f32.peak', 'driving_force.rms', 'swing', 'input_range']),
}


def study_of(scene, rows=6, **more):
    vary, quantities = SCENES[scene]
    return from_document({'scene': scene, 'rows': rows, 'vary': vary, 'quantities': quantities,
                          'keep': 'all', **more})


def scene_of(study, row):
    """Return the scene of one design."""
    drawn = study.drawn(row, row + 1)
    return from_values({**study.values, **{name: drawn[name].item() for name in drawn}})


def scanned(scene):
    """Return inputs inside the range, weights of their mean, and motion and loads there."""
    linkage, rate = scene.linkage, scene.drive.speed
    low, high = linkage.input_ranges[0]
    phi = (np.arange(SCAN) + 0.5) / SCAN * pi - 0.5 * pi
    turns = linkage.turns_fully
    x = phi * 2.0 if turns else 0.5 * (low + high) + 0.5 * (high - low) * np.sin(phi)
    weights = np.ones(SCAN) if turns else np.cos(phi)
    return x, weights / weights.sum(), linkage.step(x, rate)


@some('name', SCENES, 2)
def test_measures_are_those_of_a_dense_scan(name):
    study = study_of(name)
    columns = compute(study, 0).columns
    assert len(columns['row']) == 6
    for i, row in enumerate(columns['row'].tolist()):
        scene = scene_of(study, row)
        x, weights, (motion, loads) = scanned(scene)
        for measure in study.measures:
            value = columns[measure.name][i]
            if not measure.quantity:
                continue
            values = getattr(loads, measure.quantity, None)
            values = getattr(motion, measure.quantity) if values is None else values
            expected = {'max': values.max(), 'min': values.min(), 'peak': np.abs(values).max(),
                        'rms': np.sqrt(np.sum(weights * values**2))}.get(measure.part)
            if expected is None or np.isinf(value):      # a toggle position: beyond any scan
                continue
            size = np.abs(values).max()
            assert abs(value - expected) < 2e-6 * size, (measure.name, value, expected)
            if measure.part in ('max', 'peak'):
                assert value >= expected - 1e-12 * size
        if 'input_range' in columns:
            (low, high), *others = scene.linkage.input_ranges
            assert others or columns['input_range'][i] == high - low


def test_swing_and_time_ratio_of_a_crank_rocker_follow_from_its_dead_points():
    study = study_of('paper', 12, constraints={'class': ['crank-rocker']}, keep='feasible')
    columns = compute(study, 0).columns
    assert len(columns['row'])
    for i, row in enumerate(columns['row'].tolist()):
        one, other = scene_of(study, row).linkage.dead_points
        forward = (one.theta1 - other.theta1) % (2.0 * pi)
        ratio = max(forward, 2.0 * pi - forward) / min(forward, 2.0 * pi - forward)
        assert abs(columns['swing'][i] - abs(one.theta4 - other.theta4)) < 1e-12
        assert abs(columns['time_ratio'][i] - ratio) < 1e-9 * ratio


@pytest.mark.parametrize('start', [-1.2, 1.2, 3.0, -1.2 + 4.0 * pi])
def test_swing_and_input_range_are_those_of_the_range_that_holds_the_start(start):
    """Or else of the widest. Both ranges together gave 4.3186 rad for 0.8342 or 0.8226."""
    study = from_document({'scene': 'paper', 'rows': 64, 'seed': 1, 'keep': 'all',
                           'vary': {f'linkage.a{i}': {'range': [0.2, 1.2]} for i in (1, 2, 3, 4)},
                           'quantities': ['swing', 'input_range']})
    study = replace(study, values={**study.values, 'drive.start': start})
    columns, several = compute(study, 0).columns, 0
    for i, row in enumerate(columns['row'].tolist()):
        linkage = scene_of(study, row).linkage
        swept = {}
        for low, high in linkage.input_ranges:
            phi = (np.arange(SCAN) + 0.5) / SCAN * pi - 0.5 * pi
            x = 0.5 * (low + high) + 0.5 * (high - low) * np.sin(phi)
            angles = np.unwrap(linkage.motion(x).theta4)
            swept[low, high] = tau if linkage.turns_fully and abs(
                angles[-1] - angles[0]) > pi else np.ptp(angles)
        held = [bounds for bounds in swept if bounds[0] <= remainder(start, tau) <= bounds[1]
                or bounds[0] <= remainder(start, tau) + tau <= bounds[1]]
        low, high = max(held or swept, key=lambda bounds: bounds[1] - bounds[0])
        several += len(swept) > 1
        assert columns['input_range'][i] == high - low
        assert columns['swing'][i] == pytest.approx(swept[low, high], abs=2e-3)
    assert several > 5


def test_an_output_that_turns_fully_and_reverses_swings_a_turn():
    """Its extrema are 0.573 rad apart."""
    values = {'linkage.kind': 'machine', 'linkage.dyads': ['one', 'two'], 'linkage.output': 'bar',
              **{f'dyads.one.{name}': value for name, value in {
                  'kind': 'RRR', 'first.link': 'crank', 'first.along': 0.41794208,
                  'second.link': 'ground', 'second.along': 1.0, 'links': ['coupler', 'rocker'],
                  'length_1': 1.02850654, 'length_2': 1.10355668, 'mode': 2}.items()},
              **{f'dyads.two.{name}': value for name, value in {
                  'kind': 'RPR', 'first.link': 'coupler', 'first.along': 0.10309871,
                  'first.across': -1.17079605, 'second.link': 'ground',
                  'second.along': 1.02996685, 'second.across': -0.39033883,
                  'links': ['block', 'bar'], 'offset': 0.0, 'mode': 2}.items()},
              'drive.speed': 10.0, 'outputs': ['state']}
    design = Design(from_values(values))
    swing = Measures(design.scene).single('quantities', 'swing')
    design.search([swing])
    assert design.of(swing) == tau


def test_means_of_an_angle_that_turns_on_are_unknown_together_too(monkeypatch):
    """Each design of such a study was computed alone."""
    study = from_document({'scene': 'paper', 'rows': 24, 'keep': 'all', 'vary': {
        'linkage.a1': {'range': [0.9, 1.1]}, 'linkage.a4': {'list': [0.3]}},
        'quantities': ['theta4.mean', 'theta4.rms', 'omega4.max']})
    together, alone = together_and_alone(study, monkeypatch)
    assert alone == 0 and np.isnan(together.columns['theta4.mean']).all()
    assert np.isnan(together.columns['theta4.rms']).all()


@pytest.mark.parametrize('a4', [0.7, 0.8, 0.9])
def test_the_least_transmission_angle_is_that_of_both_lines_at_crank_and_ground_in_line(a4):
    """By the law of cosines; for a4 = 0.9 the lines are nearest where mu is 135 degrees."""
    lengths = {'linkage.a1': 0.3, 'linkage.a2': 0.6, 'linkage.a3': 0.7, 'linkage.a4': a4}
    study = from_document({'scene': 'paper', 'rows': None, 'method': 'grid',
                           'quantities': ['least_transmission_angle'],
                           'vary': {name: {'list': [value]} for name, value in lengths.items()}})
    found, = compute(study, 0).columns['least_transmission_angle'].tolist()
    angles = [acos((0.6**2 + 0.7**2 - (a4 + side * 0.3)**2) / (2 * 0.6 * 0.7))
              for side in (-1, 1)]
    assert found == pytest.approx(min(min(angle, pi - angle) for angle in angles), abs=1e-12)


def test_what_grows_without_bound_is_infinite_and_what_turns_fully_sweeps_a_turn():
    study = from_document({'scene': 'paper', 'rows': None, 'method': 'grid', 'vary': {
        'linkage.a1': {'list': [0.95, 1.3]}, 'linkage.a4': {'list': [0.3, 1.0]}},
        'quantities': ['class', 'omega4.rms', 'omega4.max', 'swing', 'time_ratio']})
    columns = compute(study, 0).columns
    by = dict(zip(columns['class'], zip(*(columns[name] for name in (
        'omega4.rms', 'omega4.max', 'swing', 'time_ratio')))))
    assert by['Grashof double-crank'][2] == 2.0 * pi
    rocking = next(values for kind, values in by.items() if 'non-Grashof' in kind)
    assert rocking[0] == rocking[1] == inf and isnan(rocking[3])


def test_rows_that_fail_constraints_are_counted_by_the_first_that_fails():
    bounds = {'omega4.max': {'most': 15.0}, 'class': ['crank-rocker'], 'swing': {'most': 1.0}}
    kept = compute(study_of('paper', 60, constraints=bounds, keep='feasible'), 0)
    every = compute(study_of('paper', 60, constraints=bounds), 0)
    assert kept.counts == every.counts and sum(kept.counts.values()) == 60
    assert set(kept.counts) == {'feasible', 'class', 'omega4.max', 'swing'} - (
        {'swing'} - set(kept.counts))
    mask = every.columns['feasible']
    assert mask.sum() == kept.counts['feasible'] == len(kept.columns['row'])
    for name, column in kept.columns.items():
        other = every.columns[name][mask]         # computed beside others: last bits may differ
        if column.dtype.kind == 'U':
            assert (column == other).all()
        else:
            np.testing.assert_allclose(column, other, 1e-9, 1e-9, err_msg=name)


def together_and_alone(study, monkeypatch, atol=1e-9):
    """Return a chunk computed together, then one by one; at first, how many designs were alone."""
    alone = []
    monkeypatch.setattr(chunks, '_row', lambda *given: alone.append(given) or one_by_one(*given))
    together, count = compute(study, 0), len(alone)
    monkeypatch.setattr(chunks, 'compute_together', lambda *_: np.zeros(study.rows, bool))
    expected = compute(study, 0)
    assert together.counts == expected.counts
    for name, true in expected.columns.items():
        if true.dtype.kind in 'UO':
            assert (together.columns[name] == true).all()
        else:       # of an input that of the same extremum: of equal ones the first
            np.testing.assert_allclose(together.columns[name], true, 1e-11,
                                       1e-7 if name.endswith('_at') else atol, err_msg=name)
    return together, count


@some('name', ['paper', 'slider_crank', 'scotch_yoke'], 1)
def test_designs_computed_together_are_those_computed_one_by_one(name, monkeypatch):
    quantities = ['shaking_force', 'shaking_moment', 'driving_torque.rms', 'f21.peak', 'f43',
                  'class', 'change_point_margin', 'least_transmission_angle', 'time_ratio',
                  'swing' if name == 'paper' else 'stroke']
    more = {'linkage.mode': {'list': [1, 2]}} if name != 'scotch_yoke' else {}
    study = from_document({
        'scene': name, 'rows': 96, 'keep': 'all', 'acceleration': 2.0, 'quantities': quantities,
        'vary': {**SCENES[name][0], **more, 'gravity.y': {'range': [-10.0, 0.0]},
                 'external.output.force_x': {'uniform': 5.0},
                 'drive.speed': {'range': [5.0, 20.0]}}})
    assert together_and_alone(study, monkeypatch)[1] < 80       # most are computed together


def test_points_computed_together_are_those_computed_one_by_one(monkeypatch):
    together_and_alone(from_document({
        'scene': 'slider_crank', 'rows': 40,
        'vary': {'points.middle.across': {'range': [0.01, 0.02]},
                 'linkage.a2': {'range': [0.1, 0.3]}},
        'quantities': ['middle.speed', 'middle.acceleration.max']}), monkeypatch, 1e-13)


def test_slip_speeds_and_drives_at_rest_are_those_computed_one_by_one(monkeypatch, tmp_path):
    """The first design has no slip speed, and turns."""
    path = file_of({**PAPER, **RODS, 'friction.A.coefficient': 0.1, 'friction.A.radius': 0.02,
                    'friction.drive.torque': 3.0}, tmp_path)
    study = from_document({
        'scene': str(path), 'method': 'grid', 'keep': 'all', 'acceleration': 3.0,
        'vary': {'friction.drive.slip_speed': {'list': [0.0, 20.0]},
                 'drive.speed': {'list': [10.0, 0.0, -5.0]}},
        'quantities': ['driving_torque', 'f21.rms', 'work']})
    together_and_alone(study, monkeypatch)


def test_a_drive_that_rests_among_others_is_computed_alone(monkeypatch):
    """Its work has no way that a rate would give it."""
    study = from_document({
        'scene': 'paper', 'method': 'grid', 'keep': 'all', 'acceleration': 3.0,
        'vary': {'drive.speed': {'list': [10.0, 0.0, -5.0]}}, 'quantities': ['work']})
    assert together_and_alone(study, monkeypatch)[1] == 1


def test_rates_of_any_four_bars_computed_together_are_those_computed_one_by_one(monkeypatch):
    quantities = ['omega4', 'alpha4', 'omega4.span', 'alpha4.peak', 'change_point_margin']
    study = from_document({
        'scene': 'paper', 'rows': 200, 'keep': 'all', 'quantities': quantities,
        'vary': {**{f'linkage.a{i}': {'range': [0.2, 1.0]} for i in (1, 2, 3, 4)},
                 'linkage.mode': {'list': [1, 2]}, 'drive.speed': {'list': [-7.0, 0.5, 25.0]}}})
    together, alone = together_and_alone(study, monkeypatch)
    # cranks that turn fully are computed together
    assert 0 < alone < 200 - together.counts['cannot be built'] < 200
    assert np.isinf(together.columns['alpha4.peak']).any()      # toggle positions are among them


def test_a_least_angle_is_never_below_0():
    """At its toggles the angle is 0 or pi, within rounding on either side."""
    study = from_document({'scene': 'paper', 'rows': 64, 'seed': 2, 'keep': 'all', 'vary': {
        f'linkage.a{i}': {'list': [i / 100 for i in range(20, 121, 7)]} for i in (1, 2, 3, 4)},
        'quantities': ['least_transmission_angle', 'class']})
    columns = compute(study, 0).columns
    angles = columns['least_transmission_angle']
    assert np.count_nonzero(angles < 1e-12) > 10 and angles.min() == 0.0


def test_a_range_of_the_crank_is_that_of_the_measures(tmp_path):
    """Beside a dense scan of the range; no design goes round, so that none is computed so."""
    path = file_of({**PAPER, **RODS, 'linkage.range': [0.0, 0.85]}, tmp_path)
    study = from_document({
        'scene': str(path), 'rows': 3, 'keep': 'all',
        'vary': {'linkage.a2': {'range': [1.1, 1.3]}},
        'quantities': ['input_range', 'swing', 'omega4', 'driving_torque.rms', 'time_ratio']})
    table = compute(study, 0)
    for row in range(3):
        linkage = scene_of(study, row).linkage
        assert linkage.stroke == (0.0, 0.85) and linkage.closes_fully
        x = 0.85 * (np.arange(SCAN) + 0.5) / SCAN
        motion, loads = linkage.step(x, scene_of(study, row).drive.speed)
        for name, expected in {
                'input_range': 0.85, 'swing': np.ptp(motion.theta4),
                'omega4.max': motion.omega4.max(), 'omega4.min': motion.omega4.min(),
                'driving_torque.rms': np.sqrt(np.mean(loads.driving_torque**2))}.items():
            assert table.columns[name][row] == pytest.approx(expected, rel=1e-3, abs=1e-6)
        assert isnan(table.columns['time_ratio'][row])
