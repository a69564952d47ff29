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
    'dyads.leg.first.along': {'uniform': 1e-4}, 'dyads.lower.second.across': {'uniform': 1e-4},
    'bodies.foot.mass': {'uniform': 1e-2}},
    'quantities': ['driving_torque.peak', 'omega_foot.min', 'least_transmission_angle']}


@some('document', [PAPER, SLIDER, JANSEN], 1, ids=['paper', 'slider_crank', 'jansen'])
def test_linkages_that_are_drawn_lie_between_the_corners(document):
    """All measures here are monotonous in the box; the first order is right to the second."""
    study = from_document(document)
    columns = compute(study, 0).columns
    for one in tolerances(study):
        value, size, (low, high) = one.sensitivity.value, one.first_order, one.corners
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
    one, = tolerances(study)
    assert abs(one.corners[1] - one.sensitivity.value - one.first_order) < (
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
    """Nothing in a scotch yoke's shaking moment depends on the crank's length."""
    study = from_document({'scene': 'scotch_yoke', 'rows': 8, 'quantities': ['shaking_moment.rms'],
                           'vary': {'linkage.a1': {'uniform': 1e-4}}})
    found, = tolerances(study)
    assert found.sensitivity.value < 1e-15 and abs(found.sensitivity.by['linkage.a1']) < 1e-14
