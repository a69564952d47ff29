# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Springs, dampers and tables act at every door alike, also where the motion is given.

The reference is Lagrange's: the drive of the equation of motion, which knows springs as energies
and forces by virtual work. All doors then give the numbers of ``loads``: bits where they compute
with floats, rounding where they compute with arrays.
"""
import csv
from itertools import product
import json
from math import isnan, pi, radians

from fourbar_lab.export.model import GeneratedModel
from fourbar_ros import load_scene, point_motion
from fourbar_ros.cli.main import main
from fourbar_ros.dynamics.equation import Equation
from fourbar_ros.errors import InvalidParameter
from fourbar_ros.mechanisms.quantities import select
from fourbar_ros.pipeline.stepper import LOADS_UNKNOWN, OK, Stepper, Wanted
from fourbar_ros.scene import scene
import numpy as np
import pytest
from support.exported import Code, COMPILERS, differences, of_python, random_inputs
from support.samples import some
from support.scenes import file_of, PAPER, RODS, TIP

EPS = 2.0**-52
COUNT = 60              # inputs of a scene
BODIES = {'bodies.crank.mass': 1.2, 'bodies.crank.inertia': 2e-2, 'bodies.crank.cg_along': 0.1,
          'bodies.coupler.mass': 0.7, 'bodies.coupler.inertia': 1e-2,
          'bodies.coupler.cg_along': 0.3, 'bodies.output.mass': 0.9,
          'bodies.output.inertia': 3e-2, 'gravity.y': -9.81}
KINDS = {
    'four_bar': {**PAPER, **RODS, **TIP, 'gravity.x': 1.0, 'gravity.y': -9.81},
    'slider_crank': {'linkage.kind': 'slider_crank', 'linkage.a1': 0.4, 'linkage.a2': 1.2,
                     'linkage.offset': 0.1, **TIP, **BODIES},
    'cylinder': {'linkage.kind': 'inverted_slider', 'linkage.a1': 1.2, 'linkage.a4': 1.6,
                 'linkage.input': 'slide', 'linkage.range': [1.0, 1.8], **TIP, **BODIES},
    'scotch_yoke': {'linkage.kind': 'scotch_yoke', 'linkage.a1': 0.3, **TIP, **BODIES}}


def given(family, name, **numbers):
    """Return the parameters of a spring or a force by its name; __ is a dot."""
    return {f'{family}.{name}.{field.replace("__", ".")}': value
            for field, value in numbers.items()}


BACK = {'first__along': 1.5, 'first__across': 0.7, 'second__link': 'output',
        'second__across': 0.1}
ACTING = {
    'linear': given('springs', 's', stiffness=800.0, free_length=0.4, **BACK),
    'preload': given('springs', 's', stiffness=500.0, free_length=0.4, preload=120.0, **BACK),
    'constant': given('springs', 's', preload=90.0, **BACK),
    'zero free length': given('springs', 's', stiffness=700.0, **BACK),
    'damper': given('springs', 's', damping=60.0, **BACK),
    'between links': given('springs', 's', first__link='crank', first__across=0.2,
                           second__link='output', second__along=-0.3, stiffness=900.0,
                           free_length=0.3, damping=9.0, preload=-20.0),
    'torsion': given('torsion_springs', 't', first='crank', second='coupler', stiffness=25.0,
                     free_angle=0.4, damping=1.5),
    'table over the input': given(
        'forces', 'f', link='output', along=0.3, acts='x', direction=0.3, factor=-2.0,
        values=[5.0, 80.0, -30.0, 5.0]),
    'table over an angle': given(
        'forces', 'f', link='coupler', along=0.4, across=-0.1, acts='across', over='beta',
        places=[-180.0, -60.0, 20.0, 90.0, 180.0], values=[3.0, 40.0, -60.0, 8.0, 3.0],
        place_unit='deg', periodic=True),
    'lines over a way': given(
        'forces', 'f', link='coupler', along=0.5, acts='y', over='tip.x', interpolation='linear',
        places=[-0.5, 0.2, 0.4, 1.1], values=[0.0, -900.0, 500.0, 20.0]),
    'couple over a way': given(
        'forces', 'f', link='crank', acts='couple', over='tip.y',
        places=[-0.3, 0.1, 0.25, 0.9], values=[80.0, -300.0, 500.0, -200.0])}
ACTING['all'] = {**ACTING['preload'], **ACTING['torsion'], **ACTING['lines over a way'],
                 **given('springs', 'd', first__across=-0.6, second__link='coupler',
                         second__along=0.2, damping=35.0),
                 **{name.replace('.f.', '.g.'): value
                    for name, value in ACTING['table over the input'].items()}}
CASES = [f'{kind}, {acting}' for kind, acting in product(KINDS, ACTING)
         if not (kind == 'scotch_yoke' and acting == 'table over an angle')]   # no angle turns


def values_of(case):
    """Return the parameters of a scene at constant speed on which something acts."""
    kind, acting = case.split(', ')
    values = {**KINDS[kind], **ACTING[acting], 'drive.source': 'timer',
              'drive.speed': 0.3 if kind == 'cylinder' else 7.0, 'outputs': ['loads']}
    if kind == 'cylinder' and 'forces.f.over' in values:
        values['forces.f.over'] = values['forces.f.over'].replace('beta', 'theta4')
    for name in [name for name in values if name.endswith('.acts')]:
        if name.replace('.acts', '.places') not in values:      # a table over the input
            values |= ({name.replace('.acts', '.places'): [0.9, 1.2, 1.5, 1.9]}
                       if kind == 'cylinder' else
                       {name.replace('.acts', '.places'): [0.0, 2.0, 4.0, 2.0 * pi],
                        name.replace('.acts', '.periodic'): True})
    return values


def inputs_of(linkage, speed):
    """Return (input, rate, acceleration) all over the first range, shape (n, 3)."""
    low, high = linkage.input_ranges[0]
    rng = np.random.default_rng(57)
    inputs = rng.uniform((low + 0.02 * (high - low), -9.0 * speed, -50.0),
                         (high - 0.02 * (high - low), 9.0 * speed, 50.0), (COUNT, 3))
    inputs[::4, 1:] = speed, 0.0
    return inputs


# each kind and all that acts at least once
QUICK = [*CASES[::len(ACTING) + 1], *CASES[-1:], *(f'{kind}, all' for kind in KINDS),
         *(f'four_bar, {acting}' for acting in list(ACTING)[::2])]
every = some('case', CASES, QUICK)


@every
def test_the_drive_is_that_of_lagrange(case):
    there = scene.from_values(values_of(case))
    linkage = there.linkage
    equation, without = Equation(linkage), linkage.with_elements()
    apart = 0.0
    for sample in inputs_of(linkage, there.drive.speed).tolist():
        motion, loads = linkage.step(*sample)
        drive = getattr(loads, linkage.drive_load)
        size = max(map(abs, loads)) + 1e3 * EPS
        condition = 1.0 + motion.condition / linkage.input_unit
        assert abs(drive - equation.torque(*sample)) <= 1e-12 * condition * size
        apart = max(apart, max(abs(one - other)
                               for one, other in zip(loads, without.loads(*sample))) / size)
    assert apart > 1e-3                                     # it matters


@every
def test_arrays_and_the_node_give_what_single_inputs_give(case):
    """The node bits, arrays at most 4 eps of the largest term a digit of the condition."""
    there = scene.from_values(values_of(case))
    linkage, stepper = there.linkage, Stepper(there)
    samples = inputs_of(linkage, there.drive.speed)
    motions, many = linkage.step(*samples.T)
    alone = linkage.loads(*samples.T)
    names = linkage.LOADS._fields
    for i, sample in enumerate(samples.tolist()):
        motion, loads = linkage.step(*sample)
        assert linkage.loads(*sample) == loads
        status, values = stepper.step(*sample, Wanted(with_loads=True))
        assert status == OK
        assert [values[there.layout.index_of[name]] for name in names] == [*loads]
        size = max(map(abs, loads)) * (1.0 + motion.condition / linkage.input_unit)
        for one, other, again in zip(loads, many, alone):
            value = np.broadcast_to(other, COUNT)[i]
            assert abs(value - one) <= 4.0 * EPS * size
            assert np.broadcast_to(again, COUNT)[i] == value
    assert np.isfinite(motions[0]).all()


@every
def test_a_table_and_show_give_the_loads(case, tmp_path, capsys):
    """CSV the values of arrays, and the pose of show those of floats, to the bit."""
    file, out = file_of(values_of(case), tmp_path), tmp_path / 'loads.csv'
    there = load_scene(file)
    linkage, speed = there.linkage, there.drive.speed
    loads = {quantity.name: quantity for quantity in select((), linkage) if quantity.is_load}
    assert main(['table', str(file), *loads, '-o', str(out)]) == 0
    head, *rows = csv.reader(out.read_text().splitlines())
    assert [name.partition(' ')[0] for name in head[1:]] == [*loads]
    cells = np.array([[float(cell) for cell in row] for row in rows])
    inputs = cells[:, 0] if linkage.is_driven_by_slide else np.radians(cells[:, 0])
    both = linkage.step(inputs, speed)
    for name, column in zip(loads, cells.T[1:]):
        assert np.array_equal(column, np.broadcast_to(loads[name].of(*both), column.shape)), name
    capsys.readouterr()
    at = '1.3' if linkage.is_driven_by_slide else '47'
    position = float(at) if linkage.is_driven_by_slide else radians(47.0)
    assert main(['show', str(file), '--at', at, '--json']) == 0
    record = json.loads(capsys.readouterr().out)
    assert record['why_no_loads'] == ''
    assert record['pose']['loads'] == linkage.loads(position, speed)._asdict()
    assert {linkage.drive_load} <= {one['quantity'] for one in record['extrema']}


@pytest.mark.skipif(not COMPILERS, reason='no C compiler')
@every
def test_generated_code_has_the_bits_of_python(case, tmp_path):
    there = scene.from_values(values_of(case))
    code = Code(there, tmp_path, 'acting')
    inputs = random_inputs(there.linkage, 57, 300)
    found = code.compiled(COMPILERS[0], '-std=c99', '-O2')(inputs)
    said = differences(found, of_python(there.linkage, there.points, inputs),
                       len(code.model.motion))
    assert not said, said


def test_numbers_of_springs_and_forces_can_be_changed_in_generated_code(tmp_path):
    """Other numbers handed to the code of a scene are another scene, to the bit."""
    values = values_of('four_bar, all')
    changes = {'springs.s.preload': -45.0, 'springs.s.free_length': 0.3,
               'springs.s.first.along': 1.4, 'springs.d.second.across': 0.1,
               'forces.g.factor': 3.0, 'forces.f.along': 0.6}
    model = GeneratedModel(scene.from_values(values), 'acting')
    assert set(changes) <= {one.name for one in model.tunable}
    if not COMPILERS:
        pytest.skip('no C compiler')
    other = scene.from_values({**values, **changes})
    code = Code(scene.from_values(values), tmp_path, 'acting')
    inputs = random_inputs(other.linkage, 58, 300)
    found = code.compiled(COMPILERS[0], '-std=c99', '-O2')(
        inputs, [changes.get(one.name, one.value) for one in code.model.tunable])
    said = differences(found, of_python(other.linkage, other.points, inputs),
                       len(code.model.motion))
    assert not said, said


@pytest.mark.parametrize('numbers, has_loads', [
    ({'stiffness': 700.0}, True), ({'stiffness': 700.0, 'free_length': 0.1}, False),
    ({'preload': 5.0}, False), ({'damping': 5.0}, False)])
def test_where_the_ends_of_a_spring_meet_only_one_without_length_has_a_force(numbers, has_loads):
    """Never a number by chance: refused for one input, not a number in arrays and topics."""
    there = scene.from_values({**PAPER, **RODS, 'outputs': ['loads'],
                               **given('springs', 's', first__along=0.4, second__link='crank',
                                       second__along=0.4, **numbers)})
    linkage = there.linkage
    motions, many = linkage.step([0.0, 0.3], 7.0)
    assert np.isfinite(many.driving_torque).tolist() == [has_loads, True]
    assert np.isfinite(motions.alpha4).all()
    status, values = Stepper(there).step(0.0, 7.0, 0.0, Wanted(with_loads=True))
    assert status == (OK if has_loads else LOADS_UNKNOWN)
    assert values[there.layout.index_of['alpha4']] == linkage.motion(0.0, 7.0).alpha4
    assert isnan(values[there.layout.index_of['driving_torque']]) is not has_loads
    if has_loads:
        assert linkage.loads(0.0, 7.0) == linkage.with_elements().loads(0.0, 7.0)
    else:
        with pytest.raises(InvalidParameter, match='the ends of a spring meet') as refused:
            linkage.loads(0.0, 7.0)
        assert '\n' not in str(refused.value)


@pytest.mark.parametrize('acting', ['linear', 'preload', 'constant', 'zero free length',
                                    'between links'])
@pytest.mark.parametrize('kind', KINDS)
def test_at_rest_the_drive_stretches_the_spring(kind, acting):
    """Virtual work: the tension by its law times the stretch for an input, by differences."""
    there = scene.from_values({**KINDS[kind], 'outputs': ['loads'], **ACTING[acting]})
    linkage = there.linkage
    law = {'stiffness': 0.0, 'free_length': 0.0, 'preload': 0.0,
           **{name.rpartition('.')[2]: value for name, value in ACTING[acting].items()}}
    spring, = linkage.elements

    def end(q, attachment):
        if attachment.link == 'ground':
            return np.array([attachment.along, attachment.across])
        return point_motion(linkage, linkage.motion(q), attachment.link, attachment.along,
                            attachment.across).place

    def length(q):
        return float(np.hypot(*(end(q, spring.second) - end(q, spring.first))))
    h = 1e-3 * linkage.input_unit
    for q in inputs_of(linkage, 1.0)[:12, 0].tolist():
        slope = (8.0 * (length(q + h) - length(q - h)) - length(q + 2.0 * h)
                 + length(q - 2.0 * h)) / (12.0 * h)
        tension = law['stiffness'] * (length(q) - law['free_length']) + law['preload']
        drive, without = (getattr(one.loads(q), linkage.drive_load)
                          for one in (linkage, linkage.with_elements()))
        size = abs(drive) + abs(without) + abs(tension)
        assert abs(drive - without - tension * slope) <= 1e-8 * size


def test_preload_is_a_constant_tension_beside_the_spring():
    """A spring with initial tension is one without it, and one of that tension alone."""
    both, apart = (scene.from_values({**KINDS['four_bar'], 'outputs': ['loads'], **springs})
                   for springs in (ACTING['preload'], {
                       **given('springs', 'a', stiffness=500.0, free_length=0.4, **BACK),
                       **given('springs', 'b', preload=120.0, **BACK)}))
    for sample in inputs_of(both.linkage, 7.0).tolist():
        one, other = both.linkage.loads(*sample), apart.linkage.loads(*sample)
        size = max(map(abs, one))
        assert max(abs(a - b) for a, b in zip(one, other)) <= 16.0 * EPS * size * (
            1.0 + both.linkage.motion(*sample).condition)
