# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""What a page is told: its sketch, ranges and extrema are those of Python."""
import json
from math import inf, radians, remainder, tau
from pathlib import Path
import re

from fourbar_lab.export.js_code import JsModule
from fourbar_lab.live import page as pages
from fourbar_lab.live.answers import answered, extrema_answer, quantities_of, structure_of
from fourbar_ros import find_extrema, load_scene
from fourbar_ros.mechanisms.curves import point_of
from fourbar_ros.mechanisms.picture import diagram_of
from fourbar_ros.scene import from_values
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
const { Engine } = await import(process.argv[2]);
const { structure, changed, names } = JSON.parse(readFileSync(0));
const url = 'data:text/javascript,' + encodeURIComponent(structure.module);
const engine = new Engine(structure, await import(url), { ...structure.values, ...changed });
engine.start = structure.start;
const { ranges } = engine;
console.log(JSON.stringify({ ranges, turns: engine.turnsFully ? ranges[0].turns : 0,
  extrema: names.flatMap(name => engine.extrema(name)) },
  (_, value) => (Math.abs(value) === Infinity ? String(value) : value)));
"""


def by_engine(scene, changed, names=()):
    """Return ranges and extrema that the page finds for changed parameters of a scene."""
    return json.loads(node(IN_NODE, str(LIVE / 'js/engine.js'), given=json.dumps(
        {'structure': structure_of(scene), 'changed': changed, 'names': names})))


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
@pytest.mark.parametrize('name', ['paper', 'jansen', 'slider_crank', 'quick_return'])
def test_extrema_of_the_file_are_those_of_python(name):
    """Values within 1e-12 of the largest; a sampled search lost none of these."""
    scene = load_scene(name)
    names = ['driving_torque', 'shaking_force', scene.linkage.outputs[0].coordinate.rate]
    found = by_engine(scene, {}, names)['extrema']
    wanted = list(find_extrema(scene.linkage, names, float(scene.drive.speed)))
    assert len(found) == len(wanted)
    for one in wanted:
        size = max(abs(other.value) for other in wanted if other.quantity == one.quantity)
        nearest = min((row for row in found if row['quantity'] == one.quantity),
                      key=lambda row: abs(row['value'] - one.value))
        assert nearest['kind'] == one.kind
        assert abs(nearest['value'] - one.value) <= 1e-12 * size


CHANGE_POINT = {'linkage.a1': 0.4, 'linkage.a2': 1.0, 'linkage.a3': 0.4, 'linkage.a4': 1.0}
AT_REST = {'drive.speed': 0.0}
# two ranges, on both sides of 0
BELOW_ZERO = {'linkage.a1': 0.3, 'linkage.a2': 0.1, 'linkage.a3': 0.25, 'linkage.a4': 0.3}


@needs_node
@pytest.mark.parametrize(('name', 'changed'), [
    ('paper', CHANGE_POINT), ('paper', {**CHANGE_POINT, 'linkage.mode': 1}),
    ('parallelogram', AT_REST), ('antiparallelogram', AT_REST), ('coupling_rod', {}),
    ('excavator_bucket', {}), ('chebyshev', {}), ('roberts', {}), ('scott_russell', {}),
    ('gripper', {}), ('paper', BELOW_ZERO)])
def test_samples_have_all_extrema_at_flat_positions_at_ends_and_of_constants(name, changed):
    """
    Values within 1e-9 of the largest, poles (one for both sides) and constants as of the search.

    A step of 1e-9 of the range beside a flat position is 1e-9 of a slope that is not zero there.
    """
    # of a Scott-Russell eps over 1e-9 is lost beside flat positions, which it passes at a sample
    share = 1e-9 if name != 'scott_russell' else np.finfo(float).eps / 1e-9
    scene = from_values({**load_scene(name).values, **changed})
    linkage, names = scene.linkage, [*quantities_of(scene)]
    rows = by_engine(scene, {}, names)['extrema']
    wanted = find_extrema(linkage, [*quantities_of(scene).values()], float(scene.drive.speed))
    for quantity in names:
        here, there = (sorted((kind, float(value)) for kind, value in pairs) for pairs in (
            [(row['kind'], row['value']) for row in rows if row['quantity'] == quantity],
            [(one.kind, one.value) for one in wanted if one.quantity == quantity]))
        if {kind for kind, _ in there} == {'constant'}:     # the search has one in each range
            there = sorted(set(there))
        assert {pair for pair in here if np.isinf(pair[1])} == {
            pair for pair in there if np.isinf(pair[1])}, quantity
        here, there = ([pair for pair in pairs if np.isfinite(pair[1])] for pairs in (here, there))
        size = max((abs(value) for _, value in there), default=0.0) or 1.0
        assert [kind for kind, _ in here] == [kind for kind, _ in there], quantity
        assert [value for _, value in here] == pytest.approx(
            [value for _, value in there], rel=0.0, abs=share * size), quantity
        # and where: a value that hardly differs from one beside it says no more of the input
        turn = tau if linkage.input_coordinate.unit == 'rad' else inf
        for row in rows:
            if row['quantity'] == quantity and row['kind'] != 'constant':
                assert min(abs(remainder(row['input'] - one.input, turn)) for one in wanted
                           if one.quantity == quantity and one.kind == row['kind']) <= (
                    1e-5 * linkage.input_unit), (quantity, row)
    if any(map(linkage.is_in_stroke, linkage.flat_inputs)):
        assert not [row for row in rows if 'global' in row['note'] and row['quantity'] in
                    linkage.LOADS._fields]


@needs_node
def test_a_jump_of_a_force_table_is_no_pole():
    scene = load_scene('press')
    rows = by_engine(scene, {}, ['shaking_force', 'f43'])['extrema']
    for name in ('shaking_force', 'f43'):
        largest = max(row['value'] for row in rows if row['quantity'] == name)
        wanted = max(one.value for one in find_extrema(scene.linkage, name, float(
            scene.drive.speed)))
        assert largest == pytest.approx(wanted, rel=1e-6), name     # a jump is between samples


@needs_node
def test_a_small_inertia_is_no_noise():
    """Of silicon bars of some tenths of a millimetre: 1e-19 kg m^2."""
    scene = from_values({
        'linkage.a1': 1e-4, 'linkage.a2': 3e-4, 'linkage.a3': 2e-4, 'linkage.a4': 2.5e-4,
        'bodies.rods.density': 2330.0, 'bodies.rods.width': 4e-6, 'bodies.rods.thickness': 2e-6})
    rows = by_engine(scene, {}, ['inertia'])['extrema']
    for kind, pick in (('minimum', min), ('maximum', max)):
        assert pick(row['value'] for row in rows if row['kind'] == kind) == pytest.approx(pick(
            one.value for one in find_extrema(scene.linkage, 'inertia')), rel=1e-9)


@needs_node
def test_quantities_of_the_drive_are_those_of_python():
    scene = from_values({**load_scene('paper').values, 'gravity.y': -9.81})
    linkage, rate = scene.linkage, float(scene.drive.speed)
    names = ['inertia', 'bias', 'holding_torque']
    found = {name: [row for row in by_engine(scene, {}, [name])['extrema']
                    if row['kind'] == 'maximum' and row['isGlobal']][0] for name in names}
    for name, row in found.items():
        wanted = max((one for one in find_extrema(linkage, [name], rate)
                      if one.kind == 'maximum'), key=lambda one: one.value)
        assert row['value'] == pytest.approx(wanted.value, rel=1e-11), name


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
