# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
No door to the loads of a scene with a gas force leaves it out.

The reference knows no table: the same compressor with the gas force of one pose, pressure times
area, as a constant force on the piston; its torque is the one of inertia less the power of the
gas by the rate of the crank.
"""
import csv
import json
from math import radians

from fourbar_lab.drawing.curves import curves_of, extrema_of
from fourbar_lab.drawing.cycles import make_forces_figure
from fourbar_lab.live.answers import extrema_answer, scene_of, structure_of
from fourbar_lab.studies.measures import Design, Measures
from fourbar_ros import find_extrema, load_scene
from fourbar_ros.cli.main import main
from fourbar_ros.errors import SceneWarning, UnknownBaseMotion
from fourbar_ros.mechanics.bodies import Base
from fourbar_ros.pipeline.stepper import Stepper, Wanted
from fourbar_ros.scene import scene
import numpy as np
import pytest
from scipy.optimize import minimize_scalar
from support.exported import Code, COMPILERS
from support.javascript import needs_node, on_the_page

AT, SPEED = 10.0, 157.0                         # [deg], [rad/s]
AREA, PRESSURE = 5e-3, 6.4e5                    # [m^2], [Pa] at 10 degrees
COMPRESSOR = {
    'linkage.kind': 'slider_crank', 'linkage.a1': 0.04, 'linkage.a2': 0.15,
    'bodies.crank.mass': 1.2, 'bodies.crank.inertia': 2e-3, 'bodies.crank.cg_along': 0.01,
    'bodies.coupler.mass': 0.4, 'bodies.coupler.inertia': 1e-3, 'bodies.coupler.cg_along': 0.05,
    'bodies.output.mass': 0.5, 'drive.speed': SPEED, 'outputs': ['loads']}
GAS = {'link': 'output', 'acts': 'along', 'over': 'input', 'place_unit': 'deg',
       'places': [0.0, AT, 180.0, 360.0], 'values': [8.0, 6.4, 1.0, 8.0], 'value_unit': 'bar',
       'periodic': True, 'factor': -AREA}
VALUES = {**COMPRESSOR, **{f'forces.gas.{name}': value for name, value in GAS.items()}}
GIVEN = radians(AT), SPEED, 0.0
PLAIN = scene.from_values(COMPRESSOR).linkage
PUSHED = scene.from_values({**COMPRESSOR, 'external.output.force_x': -PRESSURE * AREA}).linkage
TRUE = PUSHED.loads(*GIVEN)
THERE = scene.from_values(VALUES)
CLOSE = 2.0**-40                                # rounding of some hundred operations


def are_true(f41, torque):
    """Return whether a reaction and a torque are those of the reference."""
    return (abs(f41 - TRUE.f41) <= CLOSE * TRUE.f41
            and abs(torque - TRUE.driving_torque) <= CLOSE * TRUE.f41 * 0.04)


def scanned(name):
    """Return the least and the largest value of a load over a turn: a scan, each end refined."""
    linkage = THERE.linkage
    table = linkage.elements[0].value.table
    inputs = np.unique(np.concatenate([np.linspace(0.0, 2.0 * np.pi, 7201), table.places]))
    values = getattr(linkage.loads(inputs, SPEED), name)
    ends = []
    for sign in (1.0, -1.0):
        k = int(np.argmin(sign * values))
        ends += [sign * min([sign * values[k], *(minimize_scalar(
            lambda x, sign=sign: sign * getattr(linkage.loads(x, SPEED), name), method='bounded',
            bounds=bounds, options={'xatol': 1e-10}).fun
            for bounds in ((inputs[k] - 1e-3, inputs[k]), (inputs[k], inputs[k] + 1e-3)))])]
    return tuple(ends)


@pytest.fixture
def file(tmp_path):
    """Return the file of the compressor."""
    path = tmp_path / 'compressor.yaml'
    path.write_text(THERE.as_text)
    return str(path)


def test_the_reference_is_far_from_the_loads_without_gas():
    motion, plain = PLAIN.step(*GIVEN)
    by_work = plain.driving_torque + PRESSURE * AREA * motion.slide_velocity / SPEED
    assert abs(by_work - TRUE.driving_torque) <= CLOSE * PRESSURE * AREA * 0.04
    assert TRUE.f41 > 1.4 * plain.f41


def test_the_scene_in_python_for_one_input_and_for_arrays():
    linkage = THERE.linkage
    one, many = linkage.loads(*GIVEN), linkage.loads([0.0, GIVEN[0]], SPEED)
    assert are_true(one.f41, one.driving_torque)
    assert are_true(many.f41[1], many.driving_torque[1])
    assert linkage.step(*GIVEN)[1] == one
    assert linkage.bias(*GIVEN[:2]) == one.driving_torque


def test_the_node():
    _, values = Stepper(THERE).step(*GIVEN, Wanted(with_loads=True))
    assert are_true(*(values[THERE.layout.index_of[name]] for name in ('f41', 'driving_torque')))


def test_show(file, capsys):
    main(['show', file, '--at', str(AT), '--json'])
    record = json.loads(capsys.readouterr().out)
    loads = record['pose']['loads']
    assert are_true(loads['f41'], loads['driving_torque'])
    assert record['why_no_loads'] == ''
    most = max(one['value'] for one in record['extrema'] if one['quantity'] == 'f41')
    assert abs(most - scanned('f41')[1]) <= CLOSE * most


def test_table(file, tmp_path):
    main(['table', file, 'f41', 'driving_torque', '-o', str(tmp_path / 'it.csv')])
    head, *rows = csv.reader((tmp_path / 'it.csv').open())
    assert head == ['theta1 [deg]', 'f41 [N]', 'driving_torque [N m]']
    assert are_true(*next(map(float, row[1:]) for row in rows if row[0] == '10.0'))


def test_curves_of_plot_have_marks_of_loads():
    names = ['slide_velocity', 'f41', 'driving_torque']
    curves = curves_of(THERE, THERE.linkage, names, SPEED)
    assert are_true(*curves.values[2:, 10])
    found = extrema_of(THERE, THERE.linkage, names, SPEED)
    assert {one.quantity for one in found} == set(names)


def test_vectors_that_draw_shows():
    figure = make_forces_figure(THERE.linkage, SPEED)
    found = [np.hypot(*line.get_data()) for line in figure.axes[0].lines
             if len(line.get_xdata()) == 721]
    assert min(abs(forces[2 * 190] - TRUE.f41) for forces in found) <= CLOSE * TRUE.f41


@pytest.mark.parametrize('name', ['f41', 'driving_torque', 'guide_force'])
def test_searches_find_loads(name, file):
    found = [one.value for one in find_extrema(load_scene(file).linkage, [name], SPEED)]
    low, high = scanned(name)
    size = max(abs(low), abs(high))
    assert abs(min(found) - low) <= CLOSE * size and abs(max(found) - high) <= CLOSE * size


def test_the_service():
    pytest.importorskip('rclpy')
    from fourbar_ros.ros.messages import resolve
    from fourbar_ros.ros.node.services import search
    service = resolve('fourbar_msgs/srv/FindExtrema')
    for names in (['f41'], ['omega_beta'], []):
        answer = search(THERE, service.Request(quantities=names, velocity=SPEED),
                        lambda: None, service.Response())
        assert answer.result == answer.RESULT_OK, answer.message
        found = {one.quantity for one in answer.extrema}
        assert found == set(names) if names else {'f41', 'omega_beta'} <= found


@needs_node
def test_the_page():
    loads = on_the_page(THERE, *GIVEN)
    assert are_true(loads['f41'], loads['driving_torque'])
    found = extrema_answer(THERE, ['omega_beta', 'f41'], 0.0)['extrema']
    assert {one['quantity'] for one in found} == {'omega_beta', 'f41'}


def test_studies():
    most = scanned('f41')[1]
    measure = Measures(THERE).single('measures', 'f41.max')
    design = Design(THERE)
    design.search([measure])
    assert abs(design.of(measure) - most) <= CLOSE * most


@pytest.mark.skipif(not COMPILERS, reason='no C compiler')
def test_generated_code(tmp_path):
    code = Code(THERE, tmp_path, 'compressor')
    _, rows = code.compiled(COMPILERS[0], '-std=c99', '-O1')(np.array([GIVEN]))
    row = dict(zip([one.name for one in (*code.model.motion, *code.model.loads)], rows[0]))
    assert are_true(row['f41'], row['driving_torque'])


def test_a_four_stroke_has_two_turns_and_the_page_shows_both():
    engine = load_scene('engine')
    curves = curves_of(engine, engine.linkage, ['f41'], 100.0)
    assert engine.linkage.turns == 2 and curves.values[0, -1] == 720.0
    assert curves.values.shape[1] == 721
    for degrees in (370.0, 10.0):
        one = engine.linkage.loads(radians(degrees), 100.0).f41
        assert abs(curves.values[1, int(degrees)] - one) <= CLOSE * one
    assert structure_of(engine)['ranges'] == [(0.0, 4.0 * np.pi)]
    firing, idle = (engine.linkage.loads(turn + radians(10.0), 100.0).f41
                    for turn in (2.0 * np.pi, 0.0))
    assert firing != idle


def test_no_door_gives_loads_of_a_base_that_a_topic_moves(tmp_path, capsys):
    """Loads by name are refused, and left out where none are named."""
    there = scene.from_values({**COMPRESSOR, 'base.topic': 'imu'})
    path = tmp_path / 'carried.yaml'
    path.write_text(there.as_text)
    main(['show', str(path), '--at', '10', '--json'])
    record = json.loads(capsys.readouterr().out)
    assert 'motion of the base' in record['why_no_loads'] and not record['pose'].get('loads')
    for verb, out in (('table', 'it.csv'), ('plot', 'it.svg')):
        assert main([verb, str(path), 'f41', '-o', str(tmp_path / out)]) == 1
        assert 'motion of the base comes from a topic' in capsys.readouterr().err
        assert main([verb, str(path), '-o', str(tmp_path / out)]) == 0
    assert 'f41' not in (tmp_path / 'it.csv').read_text()
    assert main(['draw', str(path), '--at', '10', '-o', str(tmp_path / 'it.png')]) == 0
    page = structure_of(there)
    assert not page['hasLoads'] and 'motion of the base' in page['lacks']
    assert 'driving_torque' not in page['usual']
    for asked in (lambda: there.linkage.loads(0.3), lambda: there.linkage.loads([0.3, 0.4]),
                  lambda: there.linkage.step(0.3, fields=('f41',)),
                  lambda: find_extrema(there.linkage, ['f41'], SPEED)):
        with pytest.raises(UnknownBaseMotion, match='motion of the base'):
            asked()
    assert there.linkage.loads(0.3, base=Base()).f41 == PLAIN.loads(0.3).f41


# --- units, and what is hardly meant -------------------------------------------------------------

@pytest.fixture
def typed(tmp_path, monkeypatch):
    """Return the file of a linkage of 50 mm that was typed in metres, a1 without a unit."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / 'typed.yaml').write_text(
        '/**:\n  ros__parameters:\n    linkage: {a1: 50, a2: 150m, a3: 100 m, a4: 12500cm}\n'
        '    drive: {speed: 300rpm}\n')
    return 'typed.yaml'


@pytest.mark.parametrize('line', [
    'show FILE', 'scene check FILE', 'table FILE theta4 -o x.csv', 'draw FILE --at 60 -o x.svg',
    'plot FILE theta4 -o x.svg', 'describe FILE', 'generate FILE -o code', 'balance FILE',
    'simulate FILE --until 1', 'live FILE --port 70000', 'study run STUDY -o out',
    'new y.yaml --a1 50 --a2 150 --a3 100 --a4 125'])
def test_every_verb_warns_of_metres_in_one_line(line, typed, capsys, tmp_path):
    (tmp_path / 'study.yaml').write_text(
        f'{{scene: {typed}, rows: 4, vary: {{linkage.a1: {{uniform: 1m}}}}, quantities: [swing]}}')
    main(line.replace('FILE', typed).replace('STUDY', 'study.yaml').split())
    said = [line for line in capsys.readouterr().err.splitlines() if 'warning' in line]
    assert len(said) == 1 and 'yaml: linkage.a1 = 50 m: did you mean 0.05?' in said[0]


def test_python_and_the_page_warn_too_and_all_read_the_same_numbers(typed):
    with pytest.warns(SceneWarning, match='linkage.a1 = 50 m: did you mean 0.05?'):
        there = load_scene(typed)
    assert there.linkage.lengths == (50.0, 150.0, 100.0, 125.0)
    assert there.drive.speed == 10.0 * np.pi
    page = scene_of({**there.values, 'linkage.a1': 50, 'linkage.a2': '150 m',
                     'linkage.a3': '1e5 mm', 'linkage.a4': '12500 cm'})
    assert page.values == there.values
    assert structure_of(page)['warnings'] == there.warnings
