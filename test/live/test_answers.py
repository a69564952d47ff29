# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""What a page is told: its sketch, ranges and extrema are those of Python."""
import json
from math import radians, tau
from pathlib import Path
import re
import sys

from fourbar_lab.drawing.curves import curves_of
from fourbar_lab.drawing.labels import labels_of
from fourbar_lab.export.js_code import JsModule
from fourbar_lab.live import page as pages
from fourbar_lab.live.answers import (
    answered,
    extrema_answer,
    quantities_of,
    run_answer,
    scene_of,
    structure_of,
)
from fourbar_ros import find_extrema, load_scene
from fourbar_ros.mechanisms.curves import point_of
from fourbar_ros.mechanisms.picture import diagram_of
from fourbar_ros.scene import from_values
from fourbar_ros.scene import units as scene_units
from fourbar_ros.scene.files import nested, shipped
import numpy as np
import pytest
from support.javascript import needs_node, node

SCENES = sorted(shipped())
LIVE = Path(pages.__file__).parent


def place(scene, motion, point):
    """Return the place of a point of a sketch in a motion."""
    link, along, across = point
    along, across = (scene.values.get(value, getattr(motion, str(value), None))
                     if isinstance(value, str) else value for value in (along, across))
    if link == 'ground':
        return along, across
    x, y, *_ = point_of(scene.linkage.link_motion(motion, link), along, across)
    return x, y


@pytest.mark.parametrize('name', SCENES)
def test_the_joints_of_the_sketch_are_those_of_the_diagram(name):
    scene = load_scene(name)
    linkage, sketch = scene.linkage, structure_of(scene)['sketch']
    low, high = linkage.input_ranges[0]
    for part in (0.2, 0.5, 0.9):
        motion = linkage.motion(low + part * (high - low), 1.0)
        diagram = diagram_of(linkage, motion)
        size = max(1e-3, *np.ptp([*diagram.joints.values()], axis=0))
        assert list(sketch['joints']) == list(diagram.joints)
        for joint, expected in diagram.joints.items():
            for point in sketch['joints'][joint]:       # on every link that meets there
                away = np.hypot(*(np.array(place(scene, motion, point)) - expected))
                assert away <= 1e-9 * size, (joint, point)
        for point in (*sum(sketch['bars'], ()), *sum(sketch['plates'], [])):
            assert np.isfinite(place(scene, motion, point)).all()
    assert tuple(sketch['ground']) == diagram.ground


def test_every_quantity_of_a_page_is_in_its_module_or_of_the_drive():
    for name in SCENES:
        scene = load_scene(name)
        names = JsModule(scene, name).units
        others = {quantity for quantity in quantities_of(scene) if quantity not in names}
        assert others <= {'inertia', 'bias', 'holding_torque', 'holding_force',
                          'mechanical_advantage'}


IN_NODE = """
import { readFileSync } from 'node:fs';
const { Engine, forcesOf, largestForces } = await import(process.argv[2]);
const { structure, changed, names, asked } = JSON.parse(readFileSync(0));
const url = 'data:text/javascript,' + encodeURIComponent(structure.module);
const engine = new Engine(structure, await import(url), { ...structure.values, ...changed });
const { ranges } = engine;
console.log(JSON.stringify({ ranges, turns: engine.turnsFully ? engine.turns : 0,
  atPi: engine.at(Math.PI) && [engine.status, engine.get('driving_torque')],
  inside: asked.map(x => engine.nearestInside(x)), inputs: engine.sweep.inputs,
  samples: names.map(name => engine.samples(name)),
  rows: names.flatMap(name => engine.extremes(name)),
  largest: largestForces(structure,
    forcesOf(structure).flatMap(name => engine.extremes(name))) }));
"""


def by_engine(scene, changed, names=(), asked=()):
    """
    Return ranges, samples and their extremes that the page has for changed parameters.

    ``asked``: inputs, of which it also gives [how far outside, the nearest inside].
    """
    return json.loads(node(IN_NODE, str(LIVE / 'js/engine.js'), given=json.dumps(
        {'structure': structure_of(scene), 'changed': changed, 'names': names, 'asked': asked})))


@needs_node
@pytest.mark.parametrize(('name', 'changed'), [
    ('paper', {'linkage.a1': 0.7}), ('paper', {'linkage.a2': 1.3}), ('paper', {}),
    ('jansen', {'dyads.upper.length_1': 0.52}), ('slider_crank', {'linkage.offset': 0.01}),
    ('cylinder', {'linkage.a1': 1.25}), ('chebyshev', {}), ('lift_table', {})])
def test_ranges_follow_the_lengths(name, changed):
    scene = load_scene(name)
    other = from_values({**scene.values, **changed}).linkage
    found = by_engine(scene, changed)
    if other.turns_fully:
        assert found['turns'] == other.turns and found['ranges'] == [[0.0, tau * other.turns]]
        return
    for low, high in found['ranges']:       # of this branch, in any turn
        assert min(max(abs(low - a - turn), abs(high - b - turn))
                   for a, b in other.input_ranges for turn in (-tau, 0.0, tau)) <= 1e-9


@needs_node
@pytest.mark.parametrize('name', ['paper', 'jansen', 'slider_crank', 'quick_return', 'engine'])
def test_samples_are_those_of_a_table(name):
    """The rows of ``fourbar table``, angles of the same turn too, and quantities of the drive."""
    scene = from_values({**load_scene(name).values, 'gravity.y': -9.81})
    linkage, names = scene.linkage, [*quantities_of(scene)]
    table = curves_of(scene, linkage, names, float(scene.drive.speed), shown_units={})
    found = by_engine(scene, {}, names)
    assert found['inputs'] == pytest.approx(table.values[0], rel=1e-12)
    for quantity, samples in zip(names, found['samples']):
        column = table.values[table.names.index(quantity)]
        subtracted = 'bias' if quantity == 'inertia' else quantity
        terms = column, table.values[table.names.index(subtracted)]
        assert np.array(samples, float) == pytest.approx(np.where(
            np.isfinite(column), column, np.nan), rel=0.0, nan_ok=True, abs=1e-11 * max(
                np.abs(term[np.isfinite(term)]).max() for term in terms)), quantity


CHANGE_POINT = {'linkage.a1': 0.4, 'linkage.a2': 1.0, 'linkage.a3': 0.4, 'linkage.a4': 1.0}
AT_REST = {'drive.speed': 0.0}
# two ranges, on both sides of 0
BELOW_ZERO = {'linkage.a1': 0.3, 'linkage.a2': 0.1, 'linkage.a3': 0.25, 'linkage.a4': 0.3}
SILICON = {         # bars of some tenths of a millimetre: 1e-19 kg m^2
    'linkage.a1': 1e-4, 'linkage.a2': 3e-4, 'linkage.a3': 2e-4, 'linkage.a4': 2.5e-4,
    'bodies.rods.density': 2330.0, 'bodies.rods.width': 4e-6, 'bodies.rods.thickness': 2e-6}


@needs_node
@pytest.mark.parametrize(('name', 'changed'), [
    ('paper', {}), ('paper', CHANGE_POINT), ('paper', {**CHANGE_POINT, 'linkage.mode': 1}),
    ('parallelogram', AT_REST), ('antiparallelogram', AT_REST), ('coupling_rod', {}),
    ('excavator_bucket', {}), ('chebyshev', {}), ('roberts', {}), ('scott_russell', {}),
    ('gripper', {}), ('paper', BELOW_ZERO), ('paper', SILICON), ('press', {}), ('engine', {})])
def test_extremes_of_samples_are_those_of_python_or_none(name, changed):
    """
    Poles, jumps and what flat positions hide have none; nor is there a largest force beside them.

    Neighbours that differ from the top sample by s and 0, s a fifth of it and of its way from the
    median, lie on a parabola that rises above it by s / 8.
    """
    scene = from_values({**(load_scene(name).values if changed != SILICON else {}), **changed})
    linkage, names = scene.linkage, [*quantities_of(scene)]
    found = by_engine(scene, {}, names)
    samples = dict(zip(names, np.array(found['samples'], float)))
    wanted = find_extrema(linkage, [*quantities_of(scene).values()], float(scene.drive.speed))
    for row in found['rows']:
        values = [one.value for one in wanted if one.quantity == row['quantity']]
        low, high = min(values), max(values)
        if row['kind'] == 'constant':
            rounding = 128 * np.finfo(float).eps * max(1.0, abs(low), abs(high))
            assert high - low <= rounding and abs(row['value'] - low) <= rounding, row
        else:
            true = high if row['kind'] == 'maximum' else low
            away = row['value'], row['value'] - np.nanmedian(samples[row['quantity']])
            assert abs(row['value'] - true) <= 0.2 * min(map(abs, away)) / 8, row
    reactions = [reaction.magnitude for reaction in linkage.REACTIONS]
    peak = max(one.value for one in wanted if one.quantity in reactions)
    for row in found['largest'][:1]:
        assert row['value'] == pytest.approx(peak, rel=0.2 / 8)
    if name == 'press':         # whose force steps
        assert not found['largest']


@needs_node
@pytest.mark.parametrize(('name', 'quantity'), [
    ('peaucellier', 'q.x'), ('xarm_hand', 'theta_left_finger'), ('toddlerbot_knee', 'inertia')])
def test_a_constant_is_one_row_where_its_samples_are_rounded(name, quantity):
    """They had none, or a maximum and a minimum 4e-14 apart."""
    scene = load_scene(name)
    found = by_engine(scene, {}, [quantity])
    row, = found['rows']
    one, = find_extrema(scene.linkage, quantities_of(scene)[quantity], float(scene.drive.speed))
    assert row['kind'] == one.kind == 'constant'
    assert row['value'] == pytest.approx(one.value, rel=1e-11)


@needs_node
def test_the_pose_of_a_flat_position_has_no_loads():
    """They are 0/0, or rounding that stood there under a good status."""
    assert by_engine(load_scene('parallelogram'), {})['atPi'] == [2, None]


def test_motion_of_a_four_stroke_has_its_extrema_in_both_turns():
    """Forces repeat after two turns, motion after one: the page draws the dots of both."""
    scene = load_scene('engine')
    rows = extrema_answer(scene, ['slide_velocity', 'f41', 'inertia'], 0.0)['extrema']
    for name in ('slide_velocity', 'f41', 'inertia'):
        inputs = sorted(x for row in rows if row['quantity'] == name for x in row['inputs'])
        there = sorted(one.input % (2.0 * tau) for one in find_extrema(
            scene.linkage, name, float(scene.drive.speed)))
        if name != 'f41':
            there += [x + tau for x in there]
        assert inputs == pytest.approx(there, abs=1e-12), name


def test_what_was_given_with_a_unit_is_not_doubted_again():
    scene = nested(load_scene('paper').values | {'linkage.a1': 50.0, 'linkage.a2': 50.0,
                                                 'linkage.a3': 50.0, 'linkage.a4': 50.0})
    scene = json.loads(json.dumps(scene, default=str).replace('NaN', 'null'))
    lengths = [f'linkage.a{i}' for i in range(1, 5)]
    for with_unit, is_doubted in (([], True), (lengths[:1], True), (lengths, False)):
        answer = answered('check', {'scene': {'linkage': scene['linkage']},
                                    'withUnit': with_unit})
        assert any('did you mean' in line for line in answer['warnings']) == is_doubted


def test_extrema_and_their_proof_are_those_of_show():
    scene = load_scene('paper')
    answer = extrema_answer(scene, ['omega4'], 0.0)
    wanted = find_extrema(scene.linkage, ['omega4'], 25.0)
    assert [row['value'] for row in answer['extrema']] == [one.value for one in wanted]
    assert 'fourbar show' in answer['proof']


def test_what_cannot_be_is_said_and_named():
    scene = nested(load_scene('paper').values)
    scene['linkage']['a2'] = 9
    answer = answered('structure', {'scene': json.loads(json.dumps(scene, default=str))})
    assert 'cannot close' in answer['problem'] or 'a2' in answer['problem']
    for asked in ({}, {'scene': 3}, {'scene': {'linkage': {'a1': 'x'}}}, {'scene': []},
                  {'scene': {'linkage': {'kind': ['x']}}}):
        assert answered('structure', asked)['problem']
    assert answered('extrema', {'scene': {}})['problem']


def test_masses_beyond_all_numbers_are_said():
    """It was an AssertionError, in fourbar show too."""
    values = {**load_scene('paper').values, 'bodies.rods.density': 1e-308}
    scene = nested({name: value for name, value in values.items() if value == value})
    assert 'too heavy or too light' in answered('structure', {'scene': scene})['problem']


def test_a_run_goes_to_its_last_moment():
    """Of every second sample the last one could be missing: where it locks, or ends."""
    answer = run_answer(load_scene('released'), 2.002)
    assert answer['time'][-1] == 2.002 and len({*map(len, (
        answer[name] for name in ('time', 'input', 'rate', 'acceleration')))}) == 1
    assert all(one < two for one, two in zip(answer['time'], answer['time'][1:]))


def test_a_package_that_an_answer_needs_is_named(monkeypatch):
    """The page said Internal Server Error, and a traceback stood in the terminal."""
    monkeypatch.setitem(sys.modules, 'matplotlib.animation', None)
    scene = {'linkage': {'a1': 0.4, 'a2': 1.2, 'a3': 0.8, 'a4': 1.0}}
    assert answered('gif', {'scene': scene})['problem'] == (
        'gif requires matplotlib: pip install matplotlib')


def test_a_module_that_the_page_has_is_not_sent_again():
    scene = load_scene('jansen')
    first = structure_of(scene)
    other = from_values({**scene.values, 'dyads.upper.length_1': 0.51,
                         'bodies.rods.radius': 0.012})
    again = structure_of(other, first['key'])
    assert 'module' not in again and again['key'] == first['key']
    assert again['values']['dyads.upper.length_1'] == 0.51
    assert structure_of(load_scene('paper'), first['key'])['key'] != first['key']


def test_the_start_is_in_the_turn_of_the_ranges():
    scene = load_scene('slides_7_6')
    beyond = from_values({**scene.values, 'drive.start': radians(-300.0)})
    assert structure_of(beyond)['start'] == pytest.approx(radians(60.0), abs=1e-15)


@needs_node
@pytest.mark.parametrize(('name', 'degrees', 'away', 'inside'), [
    ('slides_7_6', -300.0, 0.0, 60.0), ('slides_7_6', 420.0, 0.0, 60.0),
    ('slides_7_6', 200.0, 29.7, -130.3), ('chebyshev', -310.0, 0.0, 50.0),
    ('chebyshev', 400.0, 0.0, 40.0), ('chebyshev', 1.0, 35.9, 36.9)])
def test_an_angle_counts_in_any_turn(name, degrees, away, inside):
    """At -300 degrees a page showed the pose of the end at -130.3, as if it were meant."""
    scene = load_scene(name)
    (far, there), = by_engine(scene, {}, asked=[radians(degrees)])['inside']
    assert [far, there] == pytest.approx([radians(away), radians(inside)], abs=radians(0.1))
    if not away:
        assert np.cos(there - radians(degrees)) == pytest.approx(1.0, abs=1e-15)


MACHINE_OF = """
import { readFileSync } from 'node:fs';
const { machineOf } = await import(process.argv[2]);
console.log(JSON.stringify(machineOf(JSON.parse(readFileSync(0)))));
"""


@needs_node
@pytest.mark.parametrize(('kind', 'joints'), [('four_bar', 'PQRS'), ('slider_crank', 'PQR')])
def test_a_kind_that_is_drawn_on_keeps_its_range_and_the_letters_of_its_joints(kind, joints):
    """The first click with a tool let the crank turn fully and called P and Q O1 and A."""
    last = {'a3': 0.8, 'a4': 1.0} if kind == 'four_bar' else {'offset': 0.05}
    tree = {'linkage': {'kind': kind, 'a1': 0.4, 'a2': 1.2, **last, 'mode': 1,
                        'range': [0.5, 1.5], 'joints': [*joints]},
            'bodies': {'rods': {'density': 7850.0, 'radius': 0.01},
                       **({'output': {'mass': 3.0}} if kind == 'slider_crank' else {})}}
    one, two = (scene_of(each).linkage for each in (tree, json.loads(node(
        MACHINE_OF, str(LIVE / 'js/draw.js'), given=json.dumps(tree)))))
    assert one.input_ranges == pytest.approx(np.array([[0.5, 1.5]])) == two.input_ranges
    (pose, loads), (_, others) = one.step(1.0, 10.0), two.step(1.0, 10.0)
    letters = set(labels_of(diagram_of(two, two.motion(1.0))).letters.values())
    assert letters == set(joints) == set(labels_of(diagram_of(one, pose)).joints)
    assert loads.shaking_force == pytest.approx(others.shaking_force, rel=1e-13)


IN_SI = """
import { readFileSync } from 'node:fs';
const { numberOf } = await import(process.argv[2]), { units, typed } = JSON.parse(readFileSync(0));
console.log(JSON.stringify(typed.map(([text, unit]) => numberOf(text, unit, units).value)));
"""


@needs_node
def test_numbers_with_units_are_those_of_scenes_to_the_last_bit():
    """12in was 0.30479999999999996 m on the page, and 0.7min more than 42 s."""
    units = json.loads(re.search('id="data">(.*)</script>', pages.page(None, None))[1])['units']
    typed = [(f'{number}{unit}', si) for si, sizes in units.items() for unit in sizes
             for number in ('12', '-0.7', '.1', '+2.3e-3', '7.', '1e5')]
    values = json.loads(node(IN_SI, str(LIVE / 'js/panel.js'), given=json.dumps(
        {'units': units, 'typed': typed})))
    assert values == [scene_units.quantity(*of) for of in typed]


def test_the_page_is_one_file_without_addresses_of_others():
    text = pages.page('paper', load_scene('paper'))
    addresses = set(re.findall(r'(?:https?:)?//[\w.]+', re.sub(r'(?m)^\s*//.*$', '', text)))
    assert {one for one in addresses if 'w3.org' not in one and '.' in one} == set()
    assert "connect-src 'none'" in text and 'import {' not in text
    names = re.findall(r'(?m)^(?:async )?(?:function|class|const|let) (\w+)', text)
    assert len(names) == len(set(names))            # all scripts are one


def test_names_of_a_scene_are_no_markup():
    text = pages.page('</title><script>alert(1)</script>', load_scene('paper'))
    assert '<script>alert(1)' not in text
