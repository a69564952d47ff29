# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Springs, dampers and tables act at every door alike, also where the motion is given.

The reference is Lagrange's: the drive of the equation of motion, which knows springs as energies
and forces by virtual work. All doors then give the numbers of ``loads``: bits where they compute
with floats, rounding where they compute with arrays.
"""
import csv
import json
from math import isnan, radians

from fourbar_lab.export.model import GeneratedModel
from fourbar_lab.studies.chunks import compute
from fourbar_lab.studies.study import from_document
from fourbar_ros import load_scene, point_motion
from fourbar_ros.cli.main import main
from fourbar_ros.dynamics.equation import Equation
from fourbar_ros.errors import InvalidParameter
from fourbar_ros.extrema import find_extrema, OverInput
from fourbar_ros.mechanisms.quantities import select
from fourbar_ros.pipeline.stepper import LOADS_UNKNOWN, OK, Stepper, Wanted
from fourbar_ros.scene import scene
import numpy as np
import pytest
from support.acting import ACTING, BACK, CASES, COUNT, given, inputs_of, KINDS, RUBBING, values_of
from support.exported import Code, COMPILERS, differences, of_python, random_inputs
from support.samples import some
from support.scenes import file_of, PAPER, RODS

EPS = 2.0**-52
# each kind and all that acts at least once
QUICK = [*CASES[::len(ACTING) + 1], *CASES[-1:], *(f'{kind}, all' for kind in KINDS),
         *(f'four_bar, {acting}' for acting in list(ACTING)[::2])]
every = some('case', CASES, QUICK)
with_friction = some('case', [*CASES, *RUBBING], [*QUICK, *RUBBING])


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


@with_friction
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


@with_friction
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


@with_friction
def test_a_study_row_is_what_the_search_finds(case, tmp_path):
    """Extrema and root mean square of the drive and of a reaction, 1e-10 of the largest value."""
    file = file_of(values_of(case), tmp_path)
    there = load_scene(file)
    linkage, speed = there.linkage, there.drive.speed
    names = [linkage.drive_load, linkage.REACTIONS[1].magnitude]
    study = from_document({
        'scene': file.name, 'method': 'grid', 'keep': 'all',
        'vary': {'drive.speed': {'list': [speed, 0.5 * speed]}},
        'quantities': [f'{name}.{part}' for name in names
                       for part in ('max', 'min', 'extrema', 'rms')]}, tmp_path)
    columns = compute(study, 0).columns
    assert columns['drive.speed'].tolist() == [speed, 0.5 * speed]
    for name in names:
        extrema = find_extrema(linkage, name, speed)
        over = OverInput(linkage, name, speed, extrema=extrema)
        most, least = over.most.value, over.least.value
        size = max(abs(most), abs(least))
        assert columns[f'{name}.extrema'][0] == len(extrema) > 0
        for part, value in (('max', most), ('min', least), ('rms', over.rms)):
            assert abs(columns[f'{name}.{part}'][0] - value) <= 1e-10 * size, (name, part)


@pytest.mark.skipif(not COMPILERS, reason='no C compiler')
@with_friction
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
def test_where_the_ends_of_a_spring_meet_only_one_without_length_has_a_force(numbers, has_loads,
                                                                             tmp_path):
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
    if COMPILERS:
        code = Code(there, tmp_path, 'meeting')
        inputs = np.array([[0.0, 7.0, 0.0], [0.3, 7.0, 0.0]])
        (at, away), rows = code.compiled(COMPILERS[0], '-std=c99', '-O2')(inputs)
        assert (at, away) == (status, OK)
        assert not differences(((at, away), rows), of_python(linkage, there.points, inputs),
                               len(code.model.motion))


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
