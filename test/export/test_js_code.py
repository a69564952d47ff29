# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Generated JavaScript in Node beside Python: results, refusals, changed parameters, mistakes."""
import json
import re

from fourbar_lab.export import generate
from fourbar_lab.export.js_code import JsModule
from fourbar_lab.export.model import NotGenerated
from fourbar_lab.export.statements import snippet
from fourbar_ros import load_scene
from fourbar_ros.errors import InvalidParameter
from fourbar_ros.numerics.number_types import exact_sum, power_of_two
from fourbar_ros.scene import from_values, read_values
from fourbar_ros.scene.parameters import of_name
import numpy as np
import pytest
from support.exported import EPS, SCENES
from support.javascript import in_node, needs_node, node

pytestmark = needs_node
BOUND = 1e-13           # of the full scale of a unit
QUICK = 'paper', 'jansen', 'door_closer', 'engine', 'cylinder', 'lift_table', 'scotch_yoke'


def inputs_of(scene, count):
    """Return inputs over the ranges and a bit beyond."""
    mechanism = scene.linkage
    low, high = mechanism.input_ranges[0][0], mechanism.input_ranges[-1][1]
    beyond = 0.05 * (high - low)
    rate = float(scene.drive.speed) or 1.0
    return [(x, rate, 0.5) for x in np.linspace(low - beyond, high + 0.97 * beyond, count)]


def compared(module, scene, count, changed):
    """
    Compare a module with Python's scene of the same parameters.

    Full scale is the largest value of a unit; of moments at least the largest force times the
    size of the mechanism, of which they are differences. A sine's last bit is eps, and the
    condition of a pose multiplies it, twice for accelerations.
    """
    inputs = inputs_of(scene, count)
    statuses, rows, check = in_node(module.text, inputs, changed)
    reference = JsModule(scene, 'reference')
    expected = [reference.sample(*values) for values in inputs]
    assert (statuses == [status for status, _ in expected]).all()
    wanted = np.array([row for _, row in expected], float)
    assert np.isnan(rows[np.ix_(statuses == 1, np.arange(rows.shape[1]))]).all()
    units, names = np.array([*module.units.values()]), [*module.units]
    condition = np.nan_to_num(wanted[:, names.index('condition')], nan=1.0)
    size = np.nanmax(np.abs(rows[:, [name.startswith('frame.') and name[-2:] in ('.x', '.y')
                                     for name in names]]))
    scales = {unit: np.nanmax(np.abs(wanted[:, units == unit]), initial=0.0)
              for unit in dict.fromkeys(module.units.values())}
    moment = scales.get('N', 0.0) * max(size, *np.abs(scene.linkage.lengths))
    for unit, least in (('N m', moment), ('W', moment * inputs[0][1])):
        scales[unit] = max(scales.get(unit, 0.0), least)
    differences = np.abs(rows - wanted)
    angles = units == 'rad'
    differences[:, angles] = np.minimum(differences[:, angles],
                                        np.abs(differences[:, angles] - 2.0 * np.pi))
    full = np.array([max(scales[unit], np.finfo(float).tiny) for unit in units])
    bound = np.maximum(BOUND, EPS * condition**2)
    worst = np.nan_to_num(differences / full / bound[:, None])
    i, j = np.unravel_index(worst.argmax(), worst.shape)
    assert worst[i, j] <= 1.0, (names[j], inputs[i], rows[i, j], wanted[i, j], scales[units[j]])
    return check


def close_by(scene, module, seed):
    """Return parameters with all lengths up to 2 % changed so that Python takes them."""
    rng = np.random.default_rng(seed)
    for part in (0.02, 0.01, 0.003, 1e-3, 1e-4):
        changed = {name: value * (1.0 + part * rng.uniform(-1.0, 1.0))
                   for name, value in module.parameters.items()
                   if of_name(name).unit == 'm' and value and name.startswith((
                       'linkage.', 'dyads.', 'cylinder.', 'points.'))}
        try:
            return changed, from_values({**scene.values, **changed})
        except InvalidParameter:
            pass
    return {}, scene


@pytest.mark.parametrize('path', [pytest.param(
    path, id=path.stem, marks=[] if path.stem in QUICK else [pytest.mark.slow])
    for path in SCENES])
def test_every_scene_has_the_numbers_and_refusals_of_python(path):
    scene = load_scene(path)
    module = JsModule(scene, path.stem)
    count = 300 if path.stem in QUICK else 2000
    assert compared(module, scene, count, {}) <= 1e-11
    changed, other = close_by(scene, module, 1)
    compared(module, other, count, changed)


@pytest.mark.parametrize('name', ['paper', 'jansen', 'slider_crank', 'quick_return'])
def test_masses_modes_and_forces_can_be_changed(name):
    scene = load_scene(name)
    module = JsModule(scene, name)
    mode = next(one for one in module.parameters if one.endswith('.mode'))
    link = scene.linkage.LINKS[-1].name
    changed = {mode: 3.0 - module.parameters[mode], 'gravity.y': -9.81,
               f'external.{link}.force_x': 30.0, f'external.{link}.along': 0.1}
    density = 'bodies.rods.density'
    if density in module.parameters:
        changed[density] = 2700.0
    other = from_values({**scene.values, **changed, mode: int(changed[mode])})
    compared(module, other, 200, changed)


ELEMENTS = {
    'springs.back': {'first.along': 0.3, 'first.across': 0.4, 'second.link': 'output',
                     'second.along': 0.4, 'stiffness': 900.0, 'free_length': 0.2,
                     'damping': 3.0},
    'torsion_springs.coil': {'second': 'output', 'stiffness': 40.0, 'free_angle': 0.4},
    'forces.cut': {'link': 'output', 'along': 0.5, 'acts': 'couple', 'over': 'theta4',
                   'places': [0.0, 1.0, 2.0], 'values': [0.0, 50.0, 20.0]},
    'friction.A': {'coefficient': 0.1, 'radius': 0.02},
    'friction.O4': {'viscous': 0.3}}


def test_springs_tables_and_friction_follow_their_parameters():
    values = {f'{group}.{name}': value for group, fields in ELEMENTS.items()
              for name, value in fields.items()}
    scene = from_values({**read_values('paper'), **values})
    module = JsModule(scene, 'paper')
    assert compared(module, scene, 300, {}) <= BOUND
    changed = {'springs.back.stiffness': 1300.0, 'springs.back.second.along': 0.5,
               'springs.back.free_length': 0.3, 'forces.cut.factor': 2.0,
               'friction.A.coefficient': 0.2, 'friction.O4.viscous': 1.0, 'linkage.a1': 0.39}
    compared(module, from_values({**scene.values, **changed}), 300, changed)


@pytest.mark.parametrize('ends', [(-3.0, -2.0), (2.5, 4.0), (-1.0, 7.0)])
def test_a_crank_with_a_range_goes_no_further_in_any_turn(ends):
    scene = from_values({**read_values('paper'), 'linkage.range': list(ends)})
    module = JsModule(scene, 'paper')
    compared(module, scene, 200, {})
    inputs = [(x, 25.0, 0.0) for x in np.linspace(-9.0, 9.0, 200)]
    statuses = in_node(module.text, inputs)[0]
    assert (statuses == [module.sample(*values)[0] for values in inputs]).all()


def test_beside_a_limit_where_a_dyad_lies_flat_it_refuses_as_python_does():
    """Accelerations are noise there: 1e7 rad/s^2 of some 0.03, with status 0."""
    scene = from_values({**read_values('peaucellier'), 'linkage.points.P.along': 0.2,
                         'linkage.points.O.x': -0.2})
    module, flats = JsModule(scene, 'inversor'), sorted(set(scene.linkage.flat_limits))
    inputs = [(flat + turn + side * 10.0**-power, 1.0, 0.5) for flat in flats
              for turn in (0.0, 2.0 * np.pi) for side in (-1.0, 1.0) for power in range(4, 14)]
    statuses = in_node(module.text, inputs)[0].tolist()
    assert statuses == [module.sample(*values)[0] for values in inputs]
    assert len(flats) == 2 and set(statuses) == {0, 1}


def test_a_joint_that_locks_itself_has_a_pose_and_no_loads():
    scene = from_values({**read_values('slider_crank'), 'friction.guide.coefficient': 0.5,
                         'friction.A.coefficient': 0.9, 'friction.A.radius': 0.09,
                         'friction.B.coefficient': 0.9, 'friction.B.radius': 0.2})
    module = JsModule(scene, 'locks')
    compared(module, scene, 300, {})
    assert {module.sample(*values)[0] for values in inputs_of(scene, 60)} == {0, 2}


def test_what_is_no_parameter_is_refused_by_name(tmp_path):
    module = JsModule(load_scene('paper'), 'paper')
    (tmp_path / 'module.mjs').write_text(module.text)
    said = node("""
const { prepare } = await import(process.argv[2]);
for (const changed of [{ 'linkage.a9': 1 }, { 'linkage.a1': 0 }, { 'bodies.rods.radius': NaN },
                       { 'gravity.y': NaN }, { 'linkage.a2': Infinity }, { 'linkage.mode': 3 },
                       { 'linkage.mode': 1.5 }]) {
  try { prepare(changed); console.log('taken'); } catch (error) { console.log(`${error}`); }
}""", str(tmp_path / 'module.mjs')).splitlines()
    assert said[0] == 'RangeError: linkage.a9: no parameter of this structure'
    assert said[1] == 'RangeError: linkage.a1 = 0: must be above 0'
    assert said[5:] == [f'RangeError: linkage.mode = {mode}: must be 1 or 2' for mode in (3, 1.5)]
    assert said[2:5] == [f'RangeError: {name}: must be a finite number' for name in (
        'bodies.rods.radius = NaN', 'gravity.y = NaN', 'linkage.a2 = Infinity')]


def test_one_operation_changed_fails_the_self_check():
    module = JsModule(load_scene('paper'), 'paper')
    lines = [line for line in module.text.splitlines()
             if re.match(r'  const v\d+ = \S+ \+ ', line)]
    inputs = [(0.5, 1.0, 0.5), (2.0, 25.0, 0.5)]
    wanted, failed = in_node(module.text, inputs)[1], 0
    for line in lines[::5]:
        changed = module.text.replace(line, line.replace(' + ', ' - '))
        _, rows, check = in_node(changed, inputs)
        is_other = (np.abs(rows - wanted) > 1e-3 * np.abs(wanted)).any()      # not by adding 0
        assert check > 1e-6 or not is_other, line
        failed += is_other
    assert failed > 5


def test_exact_sums_and_powers_have_the_bits_of_python():
    rng = np.random.default_rng(5)
    rows = [(rng.choice([-1.0, 1.0], 5) * 10.0**rng.uniform(-20.0, 20.0, 5)).tolist()
            for _ in range(2000)]
    rows += [[0.1, 0.2, -0.3], [1.0, 2.0**-53, 2.0**-106], [1.0, 2.0**-53, -2.0**-106], [0.0]]
    functions = ''.join(snippet('functions.js', name) for name in ('exact_sum', 'power_of_two'))
    said = json.loads(node(f"""{functions}
const {{ readFileSync }} = await import('node:fs');
console.log(JSON.stringify(JSON.parse(readFileSync(0)).map(
  row => [exact_sum(...row), power_of_two(...row)])));""", given=json.dumps(rows)))
    for row, (total, power) in zip(rows, said):
        assert float(total) == exact_sum(row)
        assert float(power) == (power_of_two(*row) if any(row) else 0.0)


def test_it_is_written_by_generate_which_refuses_a_choice(tmp_path):
    written = generate('slider_crank', tmp_path, 'js')
    assert [path.name for path in written.files] == ['slider_crank.js'] and written.operations > 50
    with pytest.raises(NotGenerated, match='has all outputs and parameters'):
        generate('paper', tmp_path, 'js', outputs=['theta4'])
