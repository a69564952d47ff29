# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Every door to the loads of a scene with friction gives those of the mechanism, or refuses."""
import csv
import json
from math import isnan, radians

from fourbar_lab.balancing.loads import Loads
from fourbar_lab.drawing.record import drive_of
from fourbar_lab.live.answers import extrema_answer, structure_of
from fourbar_lab.studies.block import compute_together
from fourbar_lab.studies.derivatives import Derivatives
from fourbar_lab.studies.measures import Design
from fourbar_lab.studies.study import from_document
from fourbar_ros import (
    Bodies,
    Body,
    DriveFriction,
    find_extrema,
    FourBar,
    InvalidParameter,
    JointFriction,
)
from fourbar_ros.bag.recomputation import recompute
from fourbar_ros.cli.main import main
from fourbar_ros.errors import Locked
from fourbar_ros.extrema import OverInput
from fourbar_ros.pipeline.stepper import LOCKED, OK, STATUS_NAMES, Stepper, Wanted
from fourbar_ros.scene import scene
import numpy as np
import pytest
from support.bags import run
from support.exported import Code, COMPILERS, differences, of_python

AT, SPEED = 60.0, 12.0
PRESS = {
    'linkage.kind': 'slider_crank', 'linkage.a1': 0.06, 'linkage.a2': 0.25, 'linkage.offset': 0.01,
    'bodies.crank.mass': 1.2, 'bodies.crank.inertia': 0.004, 'bodies.crank.cg_along': 0.02,
    'bodies.coupler.mass': 0.8, 'bodies.coupler.inertia': 0.006, 'bodies.coupler.cg_along': 0.09,
    'bodies.output.mass': 2.0, 'external.output.force_x': -800.0, 'drive.speed': SPEED,
    'springs.back.first.link': 'ground', 'springs.back.first.along': 0.5,
    'springs.back.second.link': 'output', 'springs.back.stiffness': 500.0,
    'springs.back.free_length': 0.1, 'outputs': ['state', 'loads']}
RUBS = {'friction.O1.coefficient': 0.1, 'friction.O1.radius': 0.01,
        'friction.A.coefficient': 0.1, 'friction.A.radius': '10mm',
        'friction.B.coefficient': 0.08, 'friction.B.radius': 0.008, 'friction.B.viscous': 0.01,
        'friction.guide.coefficient': 0.1, 'friction.guide.length': 0.1,
        'friction.drive.torque': 0.3, 'friction.drive.viscous': 0.01}
THERE = scene.from_values({**PRESS, **RUBS})
GIVEN = radians(AT), SPEED, 0.0
TRUE = THERE.linkage.loads(*GIVEN)
# the slider drives, and cannot push the crank out of its dead centre
LOCKS = scene.from_values({
    **PRESS, 'linkage.input': 'slide', 'linkage.offset': 0.0, 'external.output.force_x': 0.0,
    'external.crank.couple': -5.0, 'drive.speed': 0.1,
    **{name: value for name, value in RUBS.items() if not name.startswith('friction.drive')}})
NEAR = 0.309999                     # [m]
JAMS = {'linkage.offset': 0.189, 'friction.guide.coefficient': 1.0}


@pytest.fixture
def file(tmp_path):
    """Return the file of the press."""
    path = tmp_path / 'press.yaml'
    path.write_text(THERE.as_text)
    return str(path)


def test_the_mechanism_has_what_the_scene_says():
    assert THERE.linkage.friction == (
        ('O1', JointFriction(0.1, radius=0.01)), ('A', JointFriction(0.1, radius=0.01)),
        ('B', JointFriction(0.08, radius=0.008, viscous=0.01)),
        ('guide', JointFriction(0.1, length=0.1)), ('drive', DriveFriction(0.3, 0.01)))
    plain = scene.from_values(PRESS).linkage
    assert plain.friction == () and abs(plain.loads(*GIVEN).driving_torque
                                        - TRUE.driving_torque) > 1.0
    faster = THERE.with_values({'friction.O1.coefficient': 0.2}).linkage
    assert faster.loads(*GIVEN).driving_torque > TRUE.driving_torque


def test_node_table_show_and_page(file, tmp_path, capsys):
    status, values = Stepper(THERE).step(*GIVEN, Wanted(with_loads=True))
    assert status == OK
    assert values[THERE.layout.index_of['driving_torque']] == TRUE.driving_torque
    main(['table', file, 'f21', 'driving_torque', '-o', str(tmp_path / 'it.csv')])
    row = next(row for row in csv.reader((tmp_path / 'it.csv').open()) if row[0] == '60.0')
    assert [float(value) for value in row[1:]] == pytest.approx(
        [TRUE.f21, TRUE.driving_torque], rel=1e-12)
    capsys.readouterr()
    main(['show', file, '--at', str(AT), '--hold', str(AT), '--json'])
    record = json.loads(capsys.readouterr().out)
    assert record['pose']['loads']['driving_torque'] == TRUE.driving_torque
    rest = record['drive']['at_rest']
    assert [rest['lower'], rest['upper']] == list(THERE.linkage.holding(GIVEN[0]))
    assert record['drive']['locks'] == []


def test_show_sizes_the_drive_in_words(file, capsys):
    """In degrees and rpm: peak, cycle, worst pin, what holds it; that jumps are jumps once."""
    linkage, free = THERE.linkage, THERE.linkage.without_friction
    main(['show', file, '--hold', str(AT)])
    text = capsys.readouterr().out
    assert text.index('extrema of motion') < text.index('drive  ') < text.index('extrema of loads')
    torque = OverInput(linkage, 'driving_torque', SPEED)
    peak = torque.largest
    assert (f'peak {peak.value:.6g} N m at {np.degrees(peak.input):.4f} deg, rms {torque.rms:.6g} '
            f'N m, peak power {peak.value * SPEED:.6g} W') in text
    assert f'{SPEED:g} rad/s ({SPEED * 30.0 / np.pi:.6g} rpm)' in text
    work, left = (OverInput(each, 'driving_torque', SPEED).of_cycle for each in (linkage, free))
    assert (f'cycle      {work:.6g} J = {left:.6g} J without friction + {work - left:.6g} J '
            'friction, ') in text
    assert f'mean power {work * SPEED / (2.0 * np.pi):.6g} W' in text
    assert 'locks      nowhere' in text and text.count('from below, from above: ') == 1
    lower, upper = linkage.holding(GIVEN[0])
    rate = linkage.motion(GIVEN[0], 1.0).slide_velocity
    there, back = ('grows', 'falls') if rate > 0.0 else ('falls', 'grows')
    assert (f'{AT:.4f} deg, with friction: stays from {lower:.6g} N m (below it theta1 falls, '
            f'slide {back}) to {upper:.6g} N m (above it theta1 grows, slide {there})') in text


@pytest.mark.parametrize(('changes', 'expected'), [
    (JAMS, (264.119, 12.892)), ({**JAMS, 'drive.speed': -SPEED}, (168.493, 264.119)),
    ({'friction.A.radius': 0.06, 'friction.A.coefficient': 4.0}, (0.0, 360.0))])
def test_where_a_turning_crank_locks_is_counted_from_0_to_360(changes, expected, tmp_path, capsys):
    """Also over 0 and over 180 degrees, where ranges of the input begin: one range each."""
    locks = scene.from_values({**THERE.values, **changes})
    path = tmp_path / 'locks.yaml'
    path.write_text(locks.as_text)
    assert main(['show', str(path), '--json']) == 0
    each, = json.loads(capsys.readouterr().out)['drive']['locks']
    assert np.degrees([each['from'], each['to']]) == pytest.approx(expected, abs=1e-3)
    main(['show', str(path)])
    text = capsys.readouterr().out
    line = next(line for line in text.splitlines() if line.startswith('locks'))
    with pytest.raises(Locked) as error:
        locks.linkage.loads(each['from'] + 0.1, locks.drive.speed)
    assert list(error.value.joints) == each['joints']
    assert (f'{np.degrees(each["from"]):.4f} to {np.degrees(each["to"]):.4f} deg '
            f'({", ".join(each["joints"])})') in line
    assert 'extrema of loads' not in text and 'drive   ' not in text


@pytest.mark.parametrize('name', ['driving_torque', 'f21', 'f32', 'guide_force', 'guide_couple'])
def test_extrema_are_those_of_a_scan(name):
    """Loads jump where a joint turns back: both values there count."""
    x = np.linspace(0.0, 2.0 * np.pi, 100_001)
    values = getattr(THERE.linkage.loads(x, SPEED), name)
    found = [extremum.value for extremum in find_extrema(THERE.linkage, [name], SPEED)]
    steep = np.sort(np.abs(np.diff(values)))[-40]       # but for the jumps
    assert abs(max(found) - values.max()) <= steep and max(found) >= values.max() - 1e-9
    assert abs(min(found) - values.min()) <= steep and min(found) <= values.min() + 1e-9


def test_what_it_locks_is_said(tmp_path, capsys):
    linkage = LOCKS.linkage
    ranges = linkage.locked_ranges(0.1)
    low, high = ranges[-1]
    assert low < NEAR < high == pytest.approx(0.31, abs=1e-12)
    status, values = Stepper(LOCKS).step(NEAR, 0.1, 0.0, Wanted(with_loads=True))
    assert status == LOCKED and STATUS_NAMES[status] == 'locked by friction'
    assert isnan(values[LOCKS.layout.index_of['f41']])
    assert values[LOCKS.layout.index_of['theta1']] == linkage.motion(NEAR, 0.1).theta1
    assert np.isnan(linkage.loads([0.25, NEAR], 0.1).f41).tolist() == [False, True]
    path = tmp_path / 'locks.yaml'
    path.write_text(LOCKS.as_text)
    main(['show', str(path), '--hold', str(NEAR), '--json'])
    record = json.loads(capsys.readouterr().out)
    locks = record['drive']['locks'][-1]
    assert [locks['from'], locks['to'], locks['joints']] == [low, high, ['B', 'A', 'O1']]
    assert record['drive']['at_rest']['upper'] == 'inf' and 'effort' not in record['drive']
    assert not any(one['quantity'] == 'f41' for one in record['extrema'])
    with pytest.raises(InvalidParameter, match='B, A, O1.*locks the mechanism in'):
        find_extrema(linkage, ['f41'], 0.1)
    assert find_extrema(linkage, ['f41'], 0.1, within=(0.2, 0.3))
    # pictures have no marks of loads, and the page says why
    main(['plot', str(path), 'f41', 'theta1', '-o', str(tmp_path / 'it.svg')])
    assert 'locks itself by friction' in structure_of(LOCKS)['lacks']
    assert not extrema_answer(LOCKS, ['f41'], 0.0)['extrema']
    assert extrema_answer(LOCKS, ['theta1'], 0.0)['extrema']


def test_beside_the_flat_position_of_a_change_point_rubbing_pins_lock():
    pin = JointFriction(0.1, radius=0.01)
    linkage = FourBar(1.0, 2.0, 1.0, 2.0, gravity=(0.0, -9.81), friction={'O1': pin, 'A': pin},
                      bodies=Bodies(*[Body(1.0, cg_along=0.4, inertia=0.1)] * 3))
    locks, = drive_of(linkage, 10.0)['locks']
    assert [locks['from'], locks['to'], locks['joints']] == [0.0, 0.0, ['O1', 'A']]


@pytest.mark.skipif(not COMPILERS, reason='no C compiler')
@pytest.mark.parametrize('there', [THERE, LOCKS], ids=['press', 'locks'])
def test_generated_code_has_the_bits_and_statuses_of_the_node(there, tmp_path):
    low, high = there.linkage.input_ranges[0]
    x = np.concatenate((np.linspace(low, high, 301), high - 10.0**-np.arange(1.0, 12.0)))
    inputs = np.column_stack((x, np.where(np.arange(x.size) % 2, 0.1, -0.3), 0.0 * x))
    code = Code(there, tmp_path, 'rubs')
    wanted = of_python(there.linkage, there.points, inputs)
    found = code.compiled(COMPILERS[0], '-std=c99', '-O1')(inputs)
    assert differences(found, wanted, len(code.model.motion)) == ''
    assert (LOCKED in wanted[0]) is (there is LOCKS)
    changed = {one.name: one for one in code.model.tunable}
    assert ('friction.guide.coefficient' in changed) and changed[
        'friction.A.radius'].value == 0.01


@pytest.mark.parametrize('there', [THERE, LOCKS], ids=['press', 'locks'])
def test_a_bag_recomputes_exactly(there, tmp_path):
    low, high = there.linkage.input_ranges[0]
    values = {**there.values, 'drive.source': 'motion'}
    motions = [(x, rate, 0.5) for x in np.linspace(low, high, 12)[1:-1].tolist()
               for rate in (0.3, -0.2, 0.0)] + [(high - 1e-6, 0.1, 0.0)]
    path = run(tmp_path, 'run', values, motions, paced=True)
    found = recompute(path)
    assert not found.problems() and found.differences and found.largest == 0.0


def test_what_takes_none_refuses_it():
    with pytest.raises(InvalidParameter, match='friction.O1: .*balancing.* takes no friction'):
        Loads(THERE.linkage, SPEED)


@pytest.mark.parametrize('more, words', [
    ({'friction.C.coefficient': 0.1}, 'friction.C: there is no such joint'),
    ({'friction.A.radius': 0.0}, 'friction.A.radius = 0.0: must be positive'),
    ({'friction.A.coefficient': -0.1}, 'friction.A.coefficient = -0.1'),
    ({'friction.A.torque': 1.0}, 'friction.A.torque = 1.0: friction.A has coefficient'),
    ({'friction.drive.radius': 1.0}, 'friction.drive has torque, viscous, slip_speed only'),
    ({'friction.guide.radius': 0.1}, 'friction.guide.radius = 0.1: only pins'),
    ({'outputs': ['equation']}, "outputs = 'equation': has no friction"),
    ({'bodies.crank.mass': None}, 'bodies')])
def test_wrong_scenes(more, words):
    values = {name: value for name, value in {**PRESS, **RUBS, **more}.items()
              if value is not None}
    with pytest.raises(InvalidParameter) as error:
        scene.from_values(values)
    assert words in str(error.value) and '\n' not in str(error.value)


def test_studies(tmp_path, file):
    """Designs that vary have their friction, together: each row is that of its scene, 1e-10."""
    pytest.importorskip('scipy.stats')
    vary = {'linkage.a1': [0.05, 0.06], 'friction.A.coefficient': [0.1, 0.2],
            'friction.guide.length': [0.1, 0.3], 'friction.drive.torque': [0.0, 0.5],
            'drive.speed': [-SPEED, SPEED]}
    study = from_document({
        'scene': file, 'rows': 8, 'keep': 'all', 'vary': {
            name: {'range': bounds} for name, bounds in vary.items()},
        'quantities': ['f21.max', 'f21.extrema', 'guide_force.min', 'driving_torque.rms', 'work']})
    drawn = study.drawn(0, 8)
    columns = {measure.name: np.full(8, np.nan) for measure in study.measures}
    is_done = compute_together(study, drawn, columns)
    assert is_done.sum() >= 6
    for i in np.flatnonzero(is_done):
        design = Design(scene.from_values({**study.values, **{
            name: column[i].item() for name, column in drawn.items()}}))
        design.search(study.measures)
        for measure in study.measures:
            assert columns[measure.name][i] == pytest.approx(design.of(measure), rel=1e-10)
    # without dry friction, or the radius of a pin, formulas are others
    for name, low in (('friction.A.coefficient', 0.0), ('friction.A.radius', 0.0)):
        columns = {measure.name: np.full(2, np.nan) for measure in study.measures}
        assert not compute_together(study, {name: np.array([0.01, low])}, columns).any()
    with pytest.raises(InvalidParameter, match='an analysis of tolerances takes no friction yet'):
        Derivatives(THERE)
