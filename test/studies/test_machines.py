# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Studies of machines: each row is held against the scene that its values make, searched by itself.

Lengths vary so widely that some cannot close, close in a part of the turn or are change points.
"""
from dataclasses import replace
from math import isnan, pi

from fourbar_lab.studies.block import compute_together
from fourbar_lab.studies.chunks import compute
from fourbar_lab.studies.measures import Design, Measures
from fourbar_lab.studies.study import from_document
from fourbar_ros import load_scene
from fourbar_ros.errors import InvalidParameter
from fourbar_ros.scene.scene import from_values
import numpy as np
import pytest
from support.samples import more, some
from support.scenes import file_of

pytest.importorskip('scipy')
CLOSE = 1e-10           # of the largest value
DRIVE = {'drive.source': 'timer', 'drive.speed': 5.0, 'outputs': ['loads']}
# Means of magnitudes, which change suddenly, seldom settle together.
PARTS = 'max', 'max_at', 'min', 'min_at', 'extrema', 'peak', 'span', 'rms'


def shipped(name, **more_values):
    """Return the parameters of a scene that comes with the package, and others."""
    return {key: value for key, value in load_scene(name).values.items()
            if value == value} | more_values


def v_eight():
    """Return a V8: four throws of a crank, two rods on each."""
    values = {'linkage.kind': 'machine', 'linkage.dyads': [f'c{i}' for i in range(8)], **DRIVE,
              'bodies.crank.mass': 20.0, 'bodies.crank.inertia': 0.1}
    for i in range(8):
        x, y = ((1.0, 0.0), (0.0, 1.0), (0.0, -1.0), (-1.0, 0.0))[i // 2]
        dyad = {'kind': 'RRP', 'links': [f'rod{i}', f'piston{i}'], 'length_1': 0.15,
                'first.link': 'crank', 'first.along': 0.04 * x, 'first.across': 0.04 * y,
                'second.link': 'ground', 'direction_2': (0.25 + 0.5 * (i % 2)) * np.pi}
        values |= {f'dyads.c{i}.{key}': value for key, value in dyad.items()}
        values |= {f'bodies.rod{i}.mass': 0.5, f'bodies.rod{i}.inertia': 0.001,
                   f'bodies.rod{i}.cg_along': 0.04, f'bodies.piston{i}.mass': 0.5}
    return values


SHAPER = {      # a quick return: block on the crank, bar, rod, ram; and a slot across the ram
    'linkage.kind': 'machine', 'linkage.dyads': ['bar', 'ram', 'slot'], **DRIVE,
    'dyads.bar.kind': 'RPR', 'dyads.bar.first.link': 'crank', 'dyads.bar.first.along': 0.1,
    'dyads.bar.second.link': 'ground', 'dyads.bar.second.across': -0.25,
    'dyads.bar.links': ['block', 'lever'], 'dyads.ram.kind': 'RRP', 'dyads.ram.length_1': 0.2,
    'dyads.ram.first.link': 'lever', 'dyads.ram.first.along': 0.5,
    'dyads.ram.second.link': 'ground', 'dyads.ram.second.across': 0.3,
    'dyads.ram.direction_2': 0.0, 'dyads.ram.links': ['rod', 'slider'],
    'dyads.slot.kind': 'RPP', 'dyads.slot.first.link': 'slider',
    'dyads.slot.second.link': 'ground', 'dyads.slot.direction_2': 1.5, 'dyads.slot.slot': 1.0,
    'dyads.slot.links': ['die', 'yoke'], 'bodies.lever.mass': 2.0, 'bodies.lever.inertia': 0.05,
    'bodies.lever.cg_along': 0.3, 'bodies.slider.mass': 3.0, 'bodies.yoke.mass': 1.0}
ACTING = {'springs.s.first.along': 1.5, 'springs.s.first.across': 0.6,
          'springs.s.second.link': 'output', 'springs.s.second.along': 0.4,
          'springs.s.stiffness': 900.0, 'springs.s.free_length': 0.3,
          'forces.push.link': 'rocker', 'forces.push.acts': 'couple',
          'forces.push.over': 'theta_output', 'forces.push.places': [0.3, 0.8, 1.2, 2.0],
          'forces.push.values': [0.0, 60.0, -20.0, 0.0]}
PINS = {f'friction.{joint}.{name}': value for joint in ('base', 'one_inner', 'two_second')
        for name, value in (('coefficient', 0.1), ('radius', 0.01))}
WATT = {'dyads.one.first.along': {'range': [0.3, 0.55]},
        'dyads.one.length_1': {'range': [0.8, 1.6]},
        'dyads.two.length_2': {'uniform': 0.25}, 'bodies.rods.radius': {'range': [0.005, 0.02]}}
CASES = {       # {name: (parameters, variations, quantities)}
    'watt': (shipped('watt'), {**WATT, 'bodies.rocker.mass': {'uniform': 1.0},
                               'drive.speed': {'range': [-20.0, 20.0]}},
             ('theta_output', 'omega_output', 'alpha_rocker', 'two_first', 'shaking_moment')),
    'stephenson': (shipped('stephenson'), {
        'dyads.hoeken.first.along': {'range': [0.08, 0.25]},
        'dyads.second.length_1': {'range': [0.4, 0.7]}, 'points.tracer.along': {'uniform': 0.1}},
        ('omega_output', 'tracer.speed', 'shaking_force', 'second_inner')),
    'jansen': (shipped('jansen'), {
        'linkage.points.pin.along': {'range': [0.1, 0.25]},
        'linkage.points.pivot.x': {'uniform': 0.05}, 'dyads.leg.length_2': {'uniform': 0.06}},
        ('theta_foot', 'alpha_foot', 'foot.acceleration', 'leg_second')),
    'v_engine': (shipped('v_engine'), {
        'dyads.right.length_1': {'range': [0.03, 0.15]},
        'dyads.left.direction_2': {'uniform': 0.4}, 'bodies.crank.cg_along': {'uniform': 0.01}},
        ('slide_left_piston', 'right_second_normal', 'shaking_force')),
    'v_eight': (v_eight(), {'dyads.c0.length_1': {'range': [0.03, 0.16]},
                            'dyads.c5.direction_2': {'uniform': 0.3}},
                ('slide_piston0', 'c0_first', 'shaking_force')),
    'shaper': (SHAPER, {
        'dyads.bar.first.along': {'range': [0.08, 0.3]},
        'dyads.bar.offset': {'range': [-0.05, 0.05]},
        'dyads.slot.slot': {'range': [0.5, 2.0]}, 'dyads.ram.length_1': {'range': [0.1, 0.4]}},
        ('slide_yoke', 'slide_slider_velocity', 'bar_first')),
    'acting': (shipped('watt', **ACTING), {**WATT, 'forces.push.factor': {'range': [0.5, 2.0]},
                                           'springs.s.stiffness': {'range': [100.0, 2000.0]}},
               ('omega_output', 'two_first', 'shaking_force')),
    'friction': (shipped('watt', **PINS), {
        **WATT, 'friction.base.coefficient': {'range': [0.05, 0.2]}},
        ('alpha_output', 'two_first'))}
OF_MACHINE = 'input_range', 'time_ratio', 'work', 'least_transmission_angle'


def study_of(case, folder, rows=60, **document):
    values, vary, quantities = CASES[case]
    measures = Measures(load_scene(file_of(values, folder)))
    way = 'swing' if measures.named('', f'{measures.output}.max')[0].unit == 'rad' else 'stroke'
    return from_document({
        'scene': file_of(values, folder).name, 'rows': rows, 'vary': vary, 'keep': 'all',
        'quantities': [*(f'{name}.{part}' for name in ('driving_torque', *quantities)
                         for part in PARTS), 'driving_torque.mean', *OF_MACHINE, way],
        **document}, folder)


@some('case', CASES, CASES)
def test_rows_are_those_of_the_machines_that_their_values_make(case, tmp_path):
    study = study_of(case, tmp_path, more(24, 60))
    drawn = study.drawn(0, study.rows)
    columns = {measure.name: np.full(study.rows, np.nan) for measure in study.measures}
    together, turning = compute_together(study, drawn, columns), 0
    for i in range(study.rows):
        try:
            scene = from_values(study.values | {
                name: column[i].item() for name, column in drawn.items()})
        except InvalidParameter:
            assert not together[i]
            continue
        turning += scene.linkage.turns_fully
        if together[i]:
            assert scene.linkage.turns_fully and not scene.linkage.flat_inputs
            require_equal(Design(scene), study, {name: column[i]
                                                 for name, column in columns.items()})
    assert 0 < turning < study.rows and together.sum() >= 0.8 * turning, (together.sum(), turning)


def require_equal(design, study, measured):
    design.search([*study.measures, *(replace(measure, part='max') for measure in study.measures
                                      if measure.quantity)])
    for measure in study.measures:
        value, expected = measured[measure.name], design.of(measure)
        extrema = design.extrema.get(design.measures.source(measure), ())
        size = max([abs(extremum.value) for extremum in extrema], default=1.0)
        if measure.part in ('max_at', 'min_at'):        # exactly that one, of equal ones too
            assert value == pytest.approx(expected, abs=1e-7, nan_ok=True), measure.name
            continue
        size = {'extrema': 0.0, 'work': 2.0 * pi * size, 'input_range': 2.0 * pi,
                'time_ratio': 100.0}.get(measure.part, size)
        assert abs(value - expected) <= CLOSE * size or isnan(value) and isnan(expected), (
            measure.name, value, expected)


# A loop on coupler and rocker that never lies flat; with rods of 7/16 and 3/8 m a change point.
BETWEEN = {'dyads.two.first.link': 'coupler', 'dyads.two.first.along': 0.9375,
           'dyads.two.first.across': 0.0, 'dyads.two.second.link': 'rocker',
           'dyads.two.second.along': 0.375, 'dyads.two.second.across': 0.0}


@pytest.mark.parametrize('values, vary', [
    ({'dyads.one.length_2': 0.75}, {'dyads.one.first.along': [
        0.4, 0.499, 0.5 - 1e-6, 0.5 - 1e-9, 0.5 - 2.0**-50, 0.5, 0.5 + 2.0**-50, 0.501],
        'dyads.one.length_1': [1.2, 1.25]}),
    ({**BETWEEN, 'dyads.one.length_1': 1.25, 'dyads.one.length_2': 0.75,
      'dyads.one.first.along': 0.25}, {
        'dyads.two.length_1': [0.45, 0.4376, 0.4375], 'dyads.two.length_2': [0.37, 0.375]})])
def test_change_points_and_those_beside_are_those_of_their_machines(values, vary, tmp_path):
    study = from_document({
        'scene': file_of(shipped('watt', **values), tmp_path).name, 'method': 'grid',
        'keep': 'all', 'vary': {name: {'list': sizes} for name, sizes in vary.items()},
        'quantities': ['omega_output', 'two_first.peak', 'least_transmission_angle', 'swing',
                       'input_range']}, tmp_path)
    chunk = compute(study, 0)
    kept, drawn = len(chunk.columns['row']), study.drawn(0, study.rows)
    assert chunk.counts['feasible'] == kept > 0.6 * study.rows and not chunk.failures
    for i in range(kept):
        design = Design(from_values(study.values | {
            name: chunk.columns[name][i].item() for name in drawn}))
        design.search(study.measures)
        for measure in study.measures:
            value, expected = chunk.columns[measure.name][i], design.of(measure)
            assert value == pytest.approx(expected, rel=1e-9), (i, measure.name)
