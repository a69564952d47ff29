# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Bounds of a tolerance box hold for every linkage drawn from it, and are not much wider."""
from dataclasses import replace
from math import isinf
from pathlib import Path

from fourbar_lab.studies.chunks import compute
from fourbar_lab.studies.study import from_document
from fourbar_lab.studies.tolerance_analysis import box_of, tolerances
from fourbar_ros.cli.main import main
from fourbar_ros.errors import InvalidParameter
import pytest
from support.samples import some

pytest.importorskip('scipy')
PAPER = {'scene': 'paper', 'method': 'random', 'rows': 10_000, 'seed': 3, 'vary': {
    **{f'linkage.a{i}': {'uniform': 5e-4} for i in (1, 2, 3, 4)},
    'bodies.rods.radius': {'uniform': 5e-5}},
    'quantities': ['shaking_force.max', 'shaking_moment.peak', 'omega4.min', 'f32.max', 'swing',
                   'least_transmission_angle']}
CYLINDER = {'scene': 'cylinder', 'method': 'random', 'rows': 200, 'vary': {
    'linkage.a1': {'uniform': 1e-4}, 'bodies.crank.mass': {'range': [0.9, 1.1]}},
    'quantities': ['omega1.max', 'driving_force.peak']}
SLIDER = {'scene': 'slider_crank', 'method': 'random', 'rows': 2000, 'vary': {
    'linkage.a1': {'uniform': 1e-4}, 'bodies.coupler.mass': {'uniform': 0.01},
    'drive.speed': {'uniform': 0.1}},
    'quantities': ['shaking_force.max', 'slide_acceleration.peak', 'stroke', 'f32.max']}


def enclosed(document, chunks=1):
    """Return what is proven, after comparing it with every design of a study."""
    pytest.importorskip('flint')
    study = from_document(document)
    found = tolerances(study)
    study = replace(study, chunk=study.rows // chunks)
    for number in range(chunks):
        columns = compute(study, number).columns
        assert len(columns['row']) == study.chunk
        for one in found:
            values = columns[one.sensitivity.measure.name]
            assert one.proven.low <= values.min() <= values.max() <= one.proven.high, one
    return found


@some('document', [PAPER, SLIDER], 1, ids=['paper', 'slider_crank'])
def test_the_bounds_enclose_random_linkages(document):
    for one in enclosed(document):
        value = one.sensitivity.value
        assert one.proven.low <= one.corners.low < value < one.corners.high <= one.proven.high
        # the first order is right to the second, and the proof is not much wider than it
        assert abs(one.corners.high - value - one.first_order) < 0.05 * one.first_order
        assert one.proven.high - one.proven.low < 5.0 * one.first_order, one


@pytest.mark.slow
def test_the_bounds_enclose_a_million_random_linkages():
    enclosed(PAPER | {'rows': 1_000_000}, 100)


def test_a_stroke_that_is_reached_is_proved_along_it():
    found = enclosed(CYLINDER)
    assert not any(isinf(one.proven.high) for one in found)


def test_a_box_that_reaches_a_toggle_is_not_said_to_be_bounded():
    pytest.importorskip('flint')
    study = from_document(PAPER | {'vary': {'linkage.a1': {'range': [0.35, 0.65]}},
                                   'quantities': ['omega4.max']})
    one, = tolerances(study)
    assert isinf(one.proven.high)


def test_many_parameters_take_the_corners_that_the_first_order_says():
    fields = [f'bodies.{link}.{field}' for link in ('crank', 'coupler')
              for field in ('mass', 'cg_along', 'cg_across', 'inertia')]
    study = from_document({'scene': 'slider_crank', 'rows': 2, 'vary': {
        **{f'linkage.{name}': {'uniform': 1e-4} for name in ('a1', 'a2', 'offset')},
        **{name: {'uniform': 1e-3} for name in fields}}, 'quantities': ['shaking_force.max']})
    one, = tolerances(study, prove=False)
    assert abs(one.corners.high - one.sensitivity.value - one.first_order) < (
        0.05 * one.first_order)
    assert isinf(one.proven.high)


def test_what_is_no_tolerance_is_refused():
    study = from_document(PAPER | {'vary': {'linkage.mode': {'list': [1, 2]}}})
    with pytest.raises(InvalidParameter, match='is not a tolerance; use uniform'):
        box_of(study)
    normal, = box_of(from_document(PAPER | {'vary': {'linkage.a1': {'normal': 1e-4}}}))
    assert normal.centre == 0.4 and abs(normal.size - 3e-4) < 1e-18


@pytest.mark.slow
def test_the_command_shows_them_side_by_side(tmp_path, capsys):
    pytest.importorskip('pyarrow')
    pytest.importorskip('flint')
    file = Path(tmp_path) / 'tolerances.yaml'
    file.write_text('scene: paper\nmethod: random\nrows: 500\n'
                    'vary: {linkage.a1: {uniform: 0.001}, linkage.a4: {uniform: 0.001}}\n'
                    'constraints: {swing: {most: 1.2877}}\nquantities: [shaking_force.max]\n')
    assert not main(['study', 'tolerances', str(file), '--rows', '64', '--workers', '1'])
    text = capsys.readouterr().out
    for part in ('least first order', 'greatest of corners', 'least proven', 'greatest drawn',
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
    assert found.sensitivity.value == 0.0 and found.sensitivity.by == {'linkage.a1': 0.0}
