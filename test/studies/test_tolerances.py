# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The first order and corners of a tolerance box beside linkages that are drawn from it."""
from pathlib import Path

from fourbar_lab.studies.chunks import compute
from fourbar_lab.studies.study import from_document
from fourbar_lab.studies.tolerance_analysis import box_of, tolerances
from fourbar_ros.cli.main import main
from fourbar_ros.errors import InvalidParameter
import pytest
from support.samples import some
from yaml import safe_load

pytest.importorskip('scipy')
PAPER = {'scene': 'paper', 'method': 'random', 'rows': 2000, 'seed': 3, 'vary': {
    **{f'linkage.a{i}': {'uniform': 5e-4} for i in (1, 2, 3, 4)},
    'bodies.rods.radius': {'uniform': 5e-5}},
    'quantities': ['shaking_force.max', 'shaking_moment.peak', 'omega4.min', 'f32.max', 'swing',
                   'least_transmission_angle']}
SLIDER = {'scene': 'slider_crank', 'method': 'random', 'rows': 2000, 'vary': {
    'linkage.a1': {'uniform': 1e-4}, 'bodies.coupler.mass': {'uniform': 0.01},
    'drive.speed': {'uniform': 0.1}},
    'quantities': ['shaking_force.max', 'slide_acceleration.peak', 'stroke', 'f32.max']}
JANSEN = {'scene': 'jansen', 'method': 'random', 'rows': 100, 'vary': {
    'linkage.points.hip.along': {'uniform': 1e-4}, 'linkage.points.pivot.y': {'uniform': 1e-4},
    'bodies.foot.mass': {'uniform': 1e-2}},
    'quantities': ['driving_torque.peak', 'omega_foot.min', 'least_transmission_angle']}


@some('document', [PAPER, SLIDER, JANSEN], 1, ids=['paper', 'slider_crank', 'jansen'])
def test_linkages_that_are_drawn_lie_between_the_corners(document):
    """All measures here are monotonous in the box; the first order is right to the second."""
    study = from_document(document)
    columns = compute(study, 0).columns
    results, counts = tolerances(study)
    assert counts == {'feasible': 2**len(study.vary)}
    for one in results:
        value, size, low, high = (one.sensitivity.value, one.first_order, one.corners.least,
                                  one.corners.greatest)
        values = columns[one.sensitivity.measure.name]
        assert low < values.min() < value < values.max() < high
        assert max(abs(high - value - size), abs(value - low - size)) < 0.05 * size
        assert values.max() - values.min() > size


def test_many_parameters_take_the_corners_that_the_first_order_says():
    fields = [f'bodies.{link}.{field}' for link in ('crank', 'coupler')
              for field in ('mass', 'cg_along', 'cg_across', 'inertia')]
    study = from_document({'scene': 'slider_crank', 'rows': 2, 'vary': {
        **{f'linkage.{name}': {'uniform': 1e-4} for name in ('a1', 'a2', 'offset')},
        **{name: {'uniform': 1e-3} for name in fields}}, 'quantities': ['shaking_force.max']})
    (one,), _ = tolerances(study)
    assert abs(one.corners.greatest - one.sensitivity.value - one.first_order) < (
        0.05 * one.first_order)


def test_what_is_no_tolerance_is_refused():
    study = from_document(PAPER | {'vary': {'linkage.mode': {'list': [1, 2]}}})
    with pytest.raises(InvalidParameter, match='is not a tolerance; use uniform'):
        box_of(study)
    (centre, size), = box_of(from_document(
        PAPER | {'vary': {'linkage.a1': {'normal': 1e-4}}})).values()
    assert centre == 0.4 and abs(size - 3e-4) < 1e-18


@pytest.mark.slow
def test_the_command_shows_them_side_by_side(tmp_path, capsys):
    pytest.importorskip('pyarrow')
    file = Path(tmp_path) / 'tolerances.yaml'
    file.write_text('scene: paper\nmethod: random\nrows: 500\n'
                    'vary: {linkage.a1: {uniform: 0.001}, linkage.a4: {uniform: 0.001}}\n'
                    'constraints: {swing: {most: 1.2877}}\nquantities: [shaking_force.max]\n')
    assert not main(['study', 'tolerances', str(file), '--rows', '64'])
    text = capsys.readouterr().out
    for part in ('least first order', 'greatest of corners', 'greatest drawn',
                 'percentiles of 64 designs', 'N/m', '% of the designs fulfil'):
        assert part in text, part
    share = float(text.partition(' % of the designs')[0].split()[-1])
    assert 20.0 < share < 80.0
    assert main(['study', 'tolerances', str(tmp_path)]) == 1


def test_a_root_mean_square_of_zero_is_no_error():
    """A scotch yoke's shaking moment is rounding noise, whose derivative is small or not given."""
    study = from_document({'scene': 'scotch_yoke', 'rows': 8, 'quantities': ['shaking_moment.rms'],
                           'vary': {'linkage.a1': {'uniform': 1e-4}}})
    (found,), _ = tolerances(study)
    assert found.sensitivity.value < 1e-15
    assert not abs(found.sensitivity.by['linkage.a1']) >= 1e-14


def shown(capsys, tmp_path, text):
    """Return what the command prints for a study."""
    pytest.importorskip('pyarrow')
    file = tmp_path / 'tolerances.yaml'
    file.write_text(text)
    assert not main(['study', 'tolerances', str(file)])
    return capsys.readouterr().out


def test_what_cannot_be_built_is_counted(capsys, tmp_path):
    """The linkage closes for a2 up to 2.2: the rest of 2.15 +- 0.1 cannot be built."""
    text = ('scene: paper\nmethod: random\nrows: 64\nseed: 1\n'
            'vary: {linkage.a2: {uniform: [2.15, 0.1]}}\nquantities: [swing, time_ratio]\n')
    study = from_document(safe_load(text))
    lost = int((study.drawn(0, 64)['linkage.a2'] > 2.2).sum())
    out = shown(capsys, tmp_path, text)
    assert f'{lost} of 64 draws and 1 of 2 corners cannot be built' in out
    assert f'percentiles of {64 - lost} designs' in out
    # its crank does not turn
    assert f'time_ratio has no value in {64 - lost} of {64 - lost} draws and 1 of 1 corners' in out
    (swing, ratio), counts = tolerances(study)
    assert counts == {'cannot be built': 1, 'feasible': 1}
    assert swing.corners.missing == 0 and ratio.corners.missing == 1


def test_an_infinite_value_is_no_missing_one(capsys, tmp_path):
    """A crank-rocker becomes a double-rocker, whose loads are infinite at its toggles."""
    out = shown(capsys, tmp_path, 'scene: paper\nmethod: random\nrows: 16\nvary: {linkage.a3: '
                                  '{uniform: [0.61, 0.02]}}\nquantities: [shaking_force.max]\n')
    row = next(line for line in out.splitlines() if line.startswith('shaking_force.max  N'))
    assert row.split()[6] == 'inf' and ' - ' not in row


def test_where_two_inputs_tie_there_is_no_first_order_but_corners_and_draws(capsys, tmp_path):
    masses = '{bodies.%s_piston.mass: {uniform: 0.005}, bodies.%s_piston.mass: {uniform: 0.005}}'
    out = shown(capsys, tmp_path, 'scene: v_engine\nmethod: random\nrows: 16\nvary: '
                f'{masses % ("left", "right")}\nquantities: [shaking_force.max]\n')
    assert 'shaking_force.max has no first order: it has a kink: 4 extrema tie, as' in out
    row = next(line for line in out.splitlines() if line.startswith('shaking_force.max'))
    assert row.split()[3:5] == ['-', '-'] and row.split()[5] == '3023.18'


def test_lengths_of_a_change_point_have_no_tolerances_and_masses_have():
    """With any other length a scissor lift is in another pose: its mode is a side there."""
    def study_of(scene, name):
        return from_document({'scene': scene, 'rows': 4, 'quantities': ['shaking_force.max'],
                              'vary': {name: {'uniform': 1e-4}}})

    with pytest.raises(InvalidParameter, match=r'vary\.dyads\.lower\.length_1.* change point'):
        tolerances(study_of('scissor_lift', 'dyads.lower.length_1'))
    results, reasons = tolerances(study_of('parallelogram', 'bodies.rods.density'))
    assert reasons == {'feasible': 2} and all(result.first_order > 0.0 for result in results)
