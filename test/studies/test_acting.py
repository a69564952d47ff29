# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Studies of scenes with springs and forces over a position.

Each row is held against :func:`.find_extrema` and :class:`.OverInput` of the scene that its values
make, derivatives against differences of whole scenes.
"""
from math import degrees, isnan, pi, tau

from fourbar_lab.studies.block import compute_together
from fourbar_lab.studies.chunks import compute
from fourbar_lab.studies.derivatives import Derivatives, sensitivities
from fourbar_lab.studies.measures import Design
from fourbar_lab.studies.study import from_document
from fourbar_lab.studies.tolerance_analysis import tolerances
from fourbar_ros import load_scene
from fourbar_ros.errors import InvalidParameter
from fourbar_ros.extrema import find_extrema, OverInput
from fourbar_ros.scene.scene import from_values
import numpy as np
import pytest
from support.samples import more, some
from support.scenes import file_of, PAPER, PUSH, RODS, TIP

pytest.importorskip('scipy')
CLOSE = 1e-10           # of the largest value
BASE = {**PAPER, **RODS, **TIP, 'linkage.a1': 0.3, 'gravity.y': -9.81, 'drive.source': 'timer',
        'drive.speed': 6.0, 'outputs': ['loads']}
SPRINGS = {'springs.back.first.along': 1.5, 'springs.back.first.across': 0.7,
           'springs.back.second.link': 'output', 'springs.back.second.along': 0.5,
           'springs.back.stiffness': 900.0, 'springs.back.free_length': 0.3,
           'springs.low.first.across': -0.8, 'springs.low.second.link': 'coupler',
           'springs.low.second.along': 0.3, 'springs.low.stiffness': 400.0,
           'springs.low.free_length': 0.2, 'springs.low.damping': 3.0}
TORSION = {'torsion_springs.t.first': 'ground', 'torsion_springs.t.second': 'crank',
           'torsion_springs.t.stiffness': 5.0, 'torsion_springs.t.free_angle': 0.4}
WAY = {'forces.cut.link': 'coupler', 'forces.cut.along': 0.5, 'forces.cut.across': 0.2,
       'forces.cut.acts': 'x', 'forces.cut.over': 'tip.x', 'forces.cut.places':
       [0.1, 0.3, 0.35, 0.5, 0.8], 'forces.cut.values': [0.0, -700.0, -900.0, 100.0, 0.0]}
ANGLE = {'forces.brake.link': 'output', 'forces.brake.acts': 'couple',
         'forces.brake.over': 'theta4', 'forces.brake.interpolation': 'linear',
         'forces.brake.places': [0.5, 1.2, 1.5, 2.5],
         'forces.brake.values': [0.0, 60.0, -20.0, 0.0]}
SLIDER = {'linkage.kind': 'slider_crank', 'linkage.a1': 0.1, 'linkage.a2': 0.35,
          'bodies.crank.mass': 2.0, 'bodies.crank.inertia': 0.01,
          'bodies.coupler.mass': 0.8, 'bodies.coupler.inertia': 0.01,
          'bodies.coupler.cg_along': 0.1, 'bodies.output.mass': 1.5,
          'drive.source': 'timer', 'drive.speed': 20.0, 'outputs': ['loads'],
          'forces.press.link': 'output', 'forces.press.acts': 'along',
          'forces.press.over': 'slide', 'forces.press.places': [0.3, 0.42, 0.44, 0.46],
          'forces.press.values': [0.0, 0.0, -3000.0, -3500.0]}


STRUT = {'forces.gas.link': 'output', 'forces.gas.along': 0.4, 'forces.gas.acts': 'apart',
         'forces.gas.from.along': 0.4, 'forces.gas.from.across': -0.6,
         'forces.gas.over': 'distance', 'forces.gas.places': [0.7, 1.05, 1.1, 1.3],
         'forces.gas.values': [300.0, 250.0, 240.0, 200.0]}


PINS = {f'friction.{joint}.{name}': value for joint in ('O1', 'A', 'B', 'O4')
        for name, value in (('coefficient', 0.1), ('radius', 0.01))}
PLACES = np.linspace(0.1, 0.8, 100)
LONG = {**WAY, 'forces.cut.places': PLACES.tolist(),
        'forces.cut.values': (200.0 * np.sin(12.0 * PLACES) * np.cos(5.0 * PLACES)).tolist()}


def engine():
    """Return the four-stroke engine of the scenes at a given speed."""
    values = {name: value for name, value in load_scene('engine').values.items()
              if value == value and not name.startswith(('motor.', 'flywheel.', 'drive.'))}
    return values | {'drive.source': 'timer', 'drive.speed': 150.0}


LENGTHS = {'linkage.a1': {'range': [0.2, 0.33]}, 'linkage.a2': {'range': [1.0, 1.3]},
           'linkage.mode': {'list': [1, 2]}}
CASES = {       # {name: (parameters, variations, quantities)}
    'springs': ({**BASE, **SPRINGS}, {
        **LENGTHS, 'springs.back.stiffness': {'range': [0.0, 2000.0]},
        'springs.back.free_length': {'list': [0.0, 0.1, 0.4]},
        'springs.low.damping': {'list': [0.0, 5.0]}, 'springs.low.preload': {'normal': 30.0},
        'springs.low.second.across': {'uniform': 0.1}}, ('f32', 'shaking_moment')),
    'torsion': ({**BASE, **TORSION}, {
        **LENGTHS, 'torsion_springs.t.free_angle': {'range': [-3.0, 3.0]},
        'torsion_springs.t.stiffness': {'range': [1.0, 9.0]}}, ('f21', 'shaking_moment')),
    'way': ({**BASE, **WAY, **SPRINGS}, {
        **LENGTHS, 'forces.cut.factor': {'range': [0.5, 2.0]},
        'forces.cut.direction': {'uniform': 0.5}, 'points.tip.along': {'range': [0.3, 0.7]},
        'springs.back.stiffness': {'range': [0.0, 2000.0]}}, ('f32', 'f21')),
    'angle': ({**BASE, **ANGLE}, {
        **LENGTHS, 'forces.brake.factor': {'range': [-1.0, 2.0]}}, ('f43', 'shaking_force')),
    'input': ({**BASE, **PUSH}, {
        **LENGTHS, 'forces.push.along': {'range': [0.1, 0.5]}}, ('f41', 'shaking_moment')),
    'strut': ({**BASE, **STRUT}, {
        **LENGTHS, 'forces.gas.from.along': {'range': [0.3, 0.5]},
        'forces.gas.across': {'uniform': 0.1}}, ('f41', 'f32')),
    'pins': ({**BASE, **WAY, **SPRINGS, **PINS}, {
        **LENGTHS, 'forces.cut.factor': {'range': [0.5, 2.0]},
        'friction.A.coefficient': {'range': [0.05, 0.2]}}, ('f32', 'shaking_force')),
    'long': ({**BASE, **LONG, **SPRINGS}, {
        **LENGTHS, 'forces.cut.factor': {'range': [0.5, 2.0]}}, ('f32', 'shaking_moment')),
    'cut': ({**BASE, **WAY, 'forces.cut.when': 'forward'}, {
        **LENGTHS, 'forces.cut.factor': {'range': [0.5, 2.0]}}, ('f21', 'shaking_moment')),
    'press': (SLIDER, {
        'linkage.a1': {'range': [0.06, 0.12]}, 'linkage.offset': {'uniform': 0.03},
        'forces.press.factor': {'range': [0.2, 1.5]}}, ('f32', 'f21')),
    'engine': (engine(), {
        'linkage.a1': {'range': [0.03, 0.06]}, 'forces.gas.factor': {'range': [-0.007, -0.004]},
        'drive.speed': {'range': [50.0, 400.0]}}, ('f32', 'f21'))}
PARTS = 'max', 'max_at', 'min', 'min_at', 'extrema', 'peak', 'span', 'rms', 'mean'


def study_of(case, folder, rows=60, **document):
    values, vary, quantities = CASES[case]
    return from_document({
        'scene': file_of(values, folder).name, 'rows': rows, 'vary': vary, 'keep': 'all',
        'quantities': [*(f'{name}.{part}' for name in ('driving_torque', *quantities)
                         for part in PARTS), 'work', 'swing' if 'output.mass' not in str(values)
                       else 'stroke'], **document}, folder)


@some('case', CASES, CASES)
def test_rows_are_those_of_the_scenes_that_their_values_make(case, tmp_path):
    study = study_of(case, tmp_path, more(12, 60))
    chunk = compute(study, 0)
    columns, drawn = chunk.columns, study.drawn(0, study.rows)
    assert not chunk.failures and len(columns['row']) > 0.5 * study.rows
    for i, row in enumerate(columns['row'].tolist()):
        scene = from_values(study.values | {name: drawn[name][row].item() for name in drawn})
        linkage, speed = scene.linkage, scene.drive.speed
        for name in ('driving_torque', *CASES[case][2]):
            extrema = find_extrema(linkage, name, speed, conditions=False)
            over = OverInput(linkage, name, speed, extrema=extrema)
            most, least = over.most.value, over.least.value
            mine = {part: columns[f'{name}.{part}'][i] for part in PARTS}
            if not np.isfinite([most, least]).all():
                assert (mine['max'], mine['min']) == (most, least)
                continue
            size = max(abs(most), abs(least))
            expected = {'max': most, 'min': least, 'span': most - least, 'peak': over.peak,
                        'rms': over.rms, 'mean': over.mean}
            for part, value in expected.items():
                assert abs(mine[part] - value) <= CLOSE * size, (row, name, part)
            assert mine['extrema'] == len(extrema), (row, name)
            for part, at in (('max_at', over.most.input), ('min_at', over.least.input)):
                assert mine[part] == pytest.approx(at, abs=1e-7), (row, name, part)
        work = OverInput(linkage, 'driving_torque', speed).of_cycle
        assert abs(columns['work'][i] - work) <= 10.0 * CLOSE * size or isnan(work)


@pytest.mark.parametrize('case', ['springs', 'torsion', 'way', 'input', 'pins', 'long', 'cut',
                                  'press', 'engine'])
def test_nearly_all_designs_are_computed_together(case, tmp_path):
    study = study_of(case, tmp_path, 64, quantities=['driving_torque.peak', 'driving_torque.rms'])
    columns = {measure.name: np.empty(study.rows) for measure in study.measures}
    assert compute_together(study, study.drawn(0, study.rows), columns).sum() > 0.8 * study.rows


def test_a_table_that_does_not_fit_a_crank_that_turns_is_no_design(tmp_path):
    """It closes over a rocker alone: of cranks that turn fully the last value is the first."""
    values = {**BASE, 'linkage.a1': 0.9, **PUSH, 'forces.push.periodic': False,
              'forces.push.places': [0.0, 2.0, 4.0, 6.0],
              'forces.push.values': [5.0, 80.0, -30.0, 0.0]}
    study = from_document({'scene': file_of(values, tmp_path).name, 'rows': None, 'vary': {
        'linkage.a1': {'list': [0.9, 0.3, 0.25, 0.95]}}, 'method': 'grid', 'keep': 'all',
        'quantities': ['driving_torque.peak']}, tmp_path)
    chunk = compute(study, 0)
    assert chunk.counts == {'feasible': 2, 'cannot be built': 2}
    assert chunk.columns['linkage.a1'].tolist() == [0.9, 0.95]


def sensitivity_of(values, measure, names):
    """Return the :class:`.Sensitivity` of a measure by name."""
    scene = from_values(values)
    return sensitivities(Derivatives(scene, names), [
        Design(scene).measures.single('quantities', measure)])[0]


@pytest.mark.parametrize('case, measures', [
    ('springs', ['driving_torque.peak', 'f32.rms', 'work']),
    ('way', ['driving_torque.max', 'f32.rms', 'f21.mean']),
    ('strut', ['driving_torque.max', 'f32.rms']),
    ('press', ['driving_torque.max', 'f32.rms', 'f21.peak']),
    ('engine', ['driving_torque.max', 'f32.rms', 'f21.peak', 'work'])])
def test_measures_change_as_whole_scenes_do(case, measures):
    values, vary, _ = CASES[case]
    values = from_values(values).values
    names = [name for name in vary if name != 'linkage.mode']
    for measure in measures:
        found, known = sensitivity_of(values, measure, names), 0
        for name in names:
            step = 1e-5 * (abs(values[name]) or 0.1)
            ends = []
            for moved in (-step, step) if values[name] else (0.0, 0.0):
                design = Design(from_values(values | {name: values[name] + moved}))
                asked = design.measures.single('quantities', measure)
                design.search([asked])
                ends.append(design.of(asked))
            if isnan(found.by[name]):
                assert found.why_unknown
                continue
            true = (ends[1] - ends[0]) / (2.0 * step)
            size = abs(true) + abs(found.value) / (abs(values[name]) or 0.1)
            known += 1
            if values[name]:
                assert abs(found.by[name] - true) <= 1e-6 * size, (measure, name)
        assert known


def test_a_spring_without_free_length_has_a_derivative_by_it():
    values = {**BASE, **SPRINGS, 'springs.back.free_length': 0.0}
    found = sensitivity_of(values, 'driving_torque.mean', ['springs.back.free_length',
                                                           'springs.back.damping'])
    torque = [[OverInput(from_values(values | {name: value}).linkage, 'driving_torque', 6.0).mean
               for value in (0.0, 1e-4, 2e-4)] for name in found.by]
    for by, (here, near, far) in zip(found.by.values(), torque):
        assert by == pytest.approx((4.0 * near - far - 3.0 * here) / 2e-4, rel=1e-5, abs=1e-7)


def test_a_load_that_jumps_has_no_derivative_and_says_where(tmp_path):
    """The torsion spring of a crank comes round half a turn from its free angle."""
    values = {**BASE, **TORSION}
    for measure in ('driving_torque.rms', 'driving_torque.max'):
        values['torsion_springs.t.stiffness'] = 500.0       # so that the jump is the largest
        found = sensitivity_of(values, measure, ['torsion_springs.t.free_angle'])
        assert isnan(found.by['torsion_springs.t.free_angle'])
        assert 'it jumps at the input' in found.why_unknown
        assert any(f'input {degrees(0.4 + half):.6g} deg' in found.why_unknown
                   for half in (-pi, pi))
    assert not isnan(sensitivity_of(values, 'f32.rms', ['linkage.a2']).by['linkage.a2'])


def test_a_kink_has_no_derivative():
    """A couple of straight lines on a crank without mass: the torque is least at its tip."""
    values = {**BASE, 'bodies.rods.density': 1e-6, 'gravity.y': 0.0,
              'forces.c.link': 'crank', 'forces.c.acts': 'couple', 'forces.c.periodic': True,
              'forces.c.places': [0.0, 2.0, tau], 'forces.c.values': [0.0, 50.0, 0.0],
              'forces.c.interpolation': 'linear'}
    found = sensitivity_of(values, 'driving_torque.min', ['linkage.a2'])
    assert isnan(found.by['linkage.a2'])
    assert 'it has a kink or a jump at the input 114.592 deg' in found.why_unknown


def test_tolerances_of_springs_and_forces(tmp_path):
    """A mean is linear in stiffness and factor: first order and corners are the same."""
    study = from_document({
        'scene': file_of({**BASE, **SPRINGS, **WAY}, tmp_path).name, 'rows': 8,
        'vary': {'springs.back.stiffness': {'uniform': 0.5},
                 'forces.cut.factor': {'uniform': 0.001}},
        'quantities': ['f21.max', 'work', 'driving_torque.mean', 'driving_torque.rms']},
        tmp_path)
    results, reasons = tolerances(study)
    assert reasons == {'feasible': 4}
    for result in results:
        value, first = result.sensitivity.value, result.first_order
        low, high = result.corners.least, result.corners.greatest
        assert first == pytest.approx(0.5 * (high - low), rel=1e-3, abs=1e-9 * abs(value) + 1e-9)
        if result.sensitivity.measure.name == 'driving_torque.mean':
            assert abs(first - 0.5 * (high - low)) <= 1e-10 * abs(value) + 1e-10


@pytest.mark.parametrize('name, text', [
    ('springs.back.first.link', 'cannot vary'), ('forces.cut.values', 'cannot vary'),
    ('springs.other.stiffness', 'none of the first'), ('springs.back.stifness', 'no parameter')])
def test_what_cannot_vary_is_refused(name, text, tmp_path):
    with pytest.raises(InvalidParameter, match=text):
        from_document({'scene': file_of({**BASE, **SPRINGS, **WAY}, tmp_path).name, 'rows': 2,
                       'vary': {name: {'range': [0.1, 0.2]}}, 'quantities': ['work']}, tmp_path)
