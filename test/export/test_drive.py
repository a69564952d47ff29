# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Torque-driven steps as C have the bits of the node's, whatever drives."""
import ctypes
import math
import subprocess

from fourbar_lab.export import generate
from fourbar_lab.export.fmu import build
from fourbar_lab.export.model import NotGenerated
from fourbar_ros import load_scene
from fourbar_ros.dynamics.node_step import limited, NOT_FINITE, OK, OUT_OF_BUDGET
from fourbar_ros.dynamics.rosenbrock import StateVector
from fourbar_ros.pipeline.stepper import Stepper, Wanted
from fourbar_ros.scene.scene import from_values
import numpy as np
import pytest
from support.exported import Code, COMPILERS, library_of, MoverOfC, STRICT
from support.scenes import PAPER, RODS

pytestmark = pytest.mark.skipif(not COMPILERS, reason='no C compiler')
CRANK = {**PAPER, **RODS, 'drive.source': 'motor', 'drive.start': -0.5, 'drive.rate': 200.0,
         'motor.rotor_inertia': 0.1, 'outputs': ['state']}
ROCKER = {**CRANK, 'linkage.a1': 1.2, 'linkage.a2': 0.4}
LENGTHS = [f'linkage.a{i}' for i in range(1, 5)]
SHAFT = {'shaft.stiffness': 400.0, 'shaft.damping': 2.0}
LINE = {'motor.stall_torque': 20.0, 'motor.free_speed': 30.0}
DC = {'motor.kind': 'dc', 'motor.voltage': 24.0, 'motor.resistance': 0.5, 'motor.gear': 10.0,
      'motor.torque_constant': 0.3, 'motor.inductance': 0.005}
INDUCTION = {'motor.kind': 'induction', 'motor.breakdown_torque': 10.0, 'motor.gear': 20.0,
             'motor.breakdown_slip': 0.2}
CONTROLLER = {'motor.kind': 'controller', 'motor.speed': 4.0, 'motor.proportional': 20.0,
              'motor.integral': 60.0, 'motor.torque_limit': 25.0}
PUSHED = {name: value for name, value in ROCKER.items() if not name.startswith('motor.')} | {
    'drive.source': 'torque'}
CASES = {'controlled rocker': {**ROCKER, **CONTROLLER}, 'DC motor and shaft': {
    **CRANK, **DC, **SHAFT}, 'engine': None, 'range': {
        **CRANK, **LINE, 'linkage.range': [-1.0, 3.0]}}
MORE = {
    'line': {**CRANK, **LINE}, 'line and shaft': {**CRANK, **LINE, **SHAFT},
    'stiff shaft': {**CRANK, **LINE, 'shaft.stiffness': 1e9, 'shaft.damping': 10.0},
    'no inductance': {**CRANK, **DC, 'motor.inductance': 0.0},
    'induction motor': {**CRANK, **INDUCTION}, 'induction, shaft': {
        **CRANK, **INDUCTION, **SHAFT},
    'controller, P': {**CRANK, **CONTROLLER, 'motor.integral': 0.0},
    'controller, I': {**CRANK, **CONTROLLER, 'motor.proportional': 0.0},
    'controller without limit': {**CRANK, **CONTROLLER, 'motor.torque_limit': math.nan},
    'kite': {**CRANK, **LINE, **dict(zip(LENGTHS, (0.5, 1.0, 1.0, 0.5)))},
    'rocker': {**ROCKER, **LINE}, 'rocker, shaft': {**ROCKER, **LINE, **SHAFT},
    'rocker, DC': {**ROCKER, **DC}, 'rocker, induction': {**ROCKER, **INDUCTION},
    'rocker, controller, shaft': {**ROCKER, **CONTROLLER, **SHAFT}, 'pushed rocker': PUSHED,
    'little budget': {**ROCKER, **LINE, **SHAFT, 'drive.budget': 16, 'drive.tolerance': 1e-9},
    'huge torque': {**CRANK, 'motor.stall_torque': 1e300, 'motor.free_speed': 1.0},
    'cylinder': {**load_scene('cylinder').values, 'drive.source': 'torque', 'drive.start': 1.3},
    'bucket': {**load_scene('bucket').values, 'drive.source': 'torque', 'drive.start': 1.85},
    'friction': {**CRANK, **LINE, 'friction.A.coefficient': 0.1, 'friction.A.radius': 0.02,
                 'friction.B.coefficient': 0.1, 'friction.B.radius': 0.02,
                 'friction.drive.torque': 3.0},
    'narrow tables': {**ROCKER, **LINE, 'outputs': ['state', 'loads'],
                      'points.end.link': 'coupler', 'points.end.along': 1.0,
                      **{f'forces.{name}.{key}': value
                         for name, places, over in (('cut', [0.5, 0.501, 0.502], 'end.x'),
                                                    ('stop', [1.2, 1.201, 1.202], 'theta4'))
                         for key, value in (('link', 'output'), ('acts', 'couple'),
                                            ('over', over), ('places', places),
                                            ('values', [0.0, 30.0, 0.0]))}},
    'steps': {**ROCKER, **LINE, 'outputs': ['state', 'loads'],
              'points.end.link': 'coupler', 'points.end.along': 1.0,
              **{f'forces.{name}.{key}': value
                 for name, places, over in (('cut', [0.3, 0.5, 0.5, 0.6, 0.6], 'end.x'),
                                            ('stop', [1.2, 1.2, 1.4, 1.4, 1.5], 'theta4'))
                 for key, value in (('link', 'output'), ('acts', 'couple'),
                                    ('over', over), ('places', places),
                                    ('values', [0.0, 30.0, 25.0, 5.0, 0.0]))}},
    **dict.fromkeys(('motor', 'controlled', 'released', 'sundials', 'door_closer'))}


def scene_of(name):
    """Return the scene of a case: its values, or a shipped one."""
    values = {**CASES, **MORE}[name]
    return from_values(values) if values else load_scene(name)


def bits(values):
    """Return numbers as bytes; NaN is NaN."""
    return np.where(np.isnan(values), math.nan, values).tobytes()


def differing(mine, theirs, lengths, seed=1):
    """Return (steps that differ in anything, statuses, modes) over steps of both movers."""
    rng, wrong = np.random.default_rng(seed), []
    statuses, modes = set(), set()
    one, other = mine.start(), theirs.start()
    for length in lengths:
        torque = float(rng.normal(0.0, 30.0))
        (status, one), (expected, other) = (mover.next(values, length, torque)
                                            for mover, values in ((mine, one), (theirs, other)))
        statuses.add(expected)
        modes.add(theirs.mode)
        if (status, mine.mode, bits(one)) != (expected, theirs.mode, bits(other)):
            wrong.append((len(wrong), length, status, expected, one, other))
    return wrong, statuses, modes


def generated(scene, folder):
    generate(scene, folder, name='code')
    return library_of(folder, 'code')


@pytest.mark.parametrize('name', CASES)
def test_steps_have_the_bits_of_the_node(name, tmp_path):
    scene = scene_of(name)
    code = generated(scene, tmp_path)
    assert code.code_self_check() == 0
    statuses = set()
    for step, count in ((1.0 / scene.drive.rate, 300), (0.03, 60)):
        wrong, found, _ = differing(MoverOfC(scene, code), scene.mover, [step] * count)
        assert not wrong, wrong[0]
        statuses |= found
    assert {OK, OUT_OF_BUDGET} <= statuses


def test_a_torque_beyond_the_limit_of_the_scene_counts_as_the_limit(tmp_path):
    """As in the node; without a limit of the scene any torque is taken."""
    scene = from_values({**PUSHED, 'drive.torque_limit': 5.0})
    mine, theirs = MoverOfC(scene, generated(scene, tmp_path)), scene.mover
    for torque in (3.0, 40.0, -40.0, math.inf, math.nan):
        status, values = mine.next(mine.start(), 0.005, torque)
        wanted, expected = theirs.next(theirs.start(), 0.005, limited(torque, 5.0))
        assert (status, bits(values)) == (wanted, bits(expected)), torque


def test_a_change_point_that_passes_toggles_is_not_generated(tmp_path):
    """Which mode of the other coordinate goes on is told by poses, not by a table."""
    values = {**ROCKER, **LINE, **dict(zip(LENGTHS, (2.0, 0.4, 0.8, 1.6)))}
    with pytest.raises(NotGenerated, match='motion by torque of a change point with toggles'):
        generate(from_values(values), tmp_path, name='code')


@pytest.mark.slow
@pytest.mark.parametrize('name', [*CASES, *MORE])
def test_every_drive_with_every_compiler(name, tmp_path):
    scene = scene_of(name)
    generate(scene, tmp_path, name='code')
    rng = np.random.default_rng(2)
    lengths = [*[1.0 / scene.drive.rate] * 300, *(10.0**rng.uniform(-7.0, 0.6, 200)).tolist()]
    level = f'-O{[*CASES, *MORE].index(name) % 4}'
    for compiler in COMPILERS:
        library = tmp_path / f'{compiler}{level}.so'
        build(tmp_path / 'code.c', library, compiler, ('-std=c99', level, *STRICT))
        mover = MoverOfC(scene, ctypes.CDLL(str(library)))
        wrong, statuses, _ = differing(mover, scene.mover, lengths)
        assert not wrong, (compiler, level, len(wrong), wrong[0])
        assert statuses & {OK, NOT_FINITE}


@pytest.mark.slow
@pytest.mark.parametrize('name', ['controlled rocker', 'engine', 'DC motor and shaft'])
def test_sanitizers_find_nothing_in_steps(name, tmp_path):
    scene = scene_of(name)
    generate(scene, tmp_path, name='code')
    (tmp_path / 'main.c').write_text("""
#include "code.h"
int main(void)
{
  code_drive drive;
  int i, good = 0;
  code_start(&drive);
  for (i = 0; i < 3000; ++i)
    good += code_advance(&drive, i % 100 == 99 ? 2.0 : 0.0001 * (1 + i % 37)) == code_drive_ok;
  CHANGED;
  drive.velocity = 1e200;
  code_complete(&drive);
  (void)code_advance(&drive, 0.01);
  return good > 0 ? code_self_check() : 2;
}
""".replace('CHANGED', {'controlled rocker': 'drive.motor_speed = -3.0', 'DC motor and shaft':
                        'drive.motor_voltage = -24.0'}.get(name, '(void)drive')))
    for compiler in COMPILERS:
        subprocess.run([compiler, '-std=c99', '-O1', '-fsanitize=address,undefined', *STRICT,
                        '-fno-sanitize-recover=all', 'code.c', 'main.c', '-o', 'checked', '-lm'],
                       check=True, cwd=tmp_path)
        subprocess.run([tmp_path / 'checked'], check=True, cwd=tmp_path)


@pytest.fixture(scope='module')
def rocker(tmp_path_factory):
    """Return scene and code of a rocker with a motor, which passes toggles."""
    scene = from_values({**ROCKER, **LINE, 'outputs': ['state', 'loads']})
    return scene, generated(scene, tmp_path_factory.mktemp('rocker'))


def test_motion_and_loads_are_those_of_both_modes(rocker, tmp_path):
    scene, _ = rocker
    code = Code(scene, tmp_path, 'code')
    run, stepper = code.compiled(COMPILERS[0], '-O2'), Stepper(scene)
    rng, (low, high) = np.random.default_rng(6), scene.linkage.input_ranges[0]
    inputs = np.transpose([rng.uniform(low, high, 100), *rng.normal(0.0, 3.0, (2, 100))])
    for mode in (1, 2):
        signs = {place: numbers[mode] for place, numbers in code.model.signs.items()}
        status, rows = run(np.ascontiguousarray(inputs), [
            signs.get(one.slot, one.value) for one in code.model.tunable])
        for said, found, given in zip(status, rows, inputs.tolist()):
            wanted, expected = stepper.step(*given, Wanted(True, scene.topics), mode)
            assert said == wanted == OK and bits(found) == bits(expected)


def test_a_mode_that_the_drive_never_has_gives_no_number(rocker):
    _, code = rocker
    parameters, constants, motion, loads = ((ctypes.c_double * 1000)() for _ in range(4))
    statuses = []
    for mode in (1.0, 2.0, 3.0, 0.0, math.nan):
        code.code_defaults(parameters)
        code.code_set_mode(parameters, ctypes.c_double(mode))
        code.code_prepare(parameters, constants)
        statuses.append(code.code_step(constants, (ctypes.c_double * 3)(-0.5, 1.0, 0.0), motion,
                                       loads))
    assert statuses[:2] == [OK, OK] and OK not in statuses[2:]


def test_a_state_can_be_set_and_a_wrong_step_holds_it(rocker):
    scene, code = rocker
    mine, theirs = MoverOfC(scene, code), scene.mover
    state = theirs.state_at(StateVector(0.3, -2.0, 0.0, 0.0, 0.0), 1)
    assert bits(mine.values(state, 0.0, 0.0, 0.0)) == bits(theirs.values(state, 0.0, math.nan, 0))
    for step in (0.0, -1.0, math.nan, math.inf, -math.inf):
        for mover in (mine, theirs):
            status, values = mover.next(mover.start(), step)
            assert (status, values.position, values.velocity) == (NOT_FINITE, -0.5, 0.0)
        assert bits(values) == bits(mine.next(mine.start(), step)[1])


@pytest.mark.parametrize('field', ['position', 'velocity'])
@pytest.mark.parametrize('value', [math.nan, math.inf, -math.inf])
def test_a_state_without_a_number_is_held_as_such(rocker, field, value):
    scene, code = rocker
    for mover in (MoverOfC(scene, code), scene.mover):
        status, values = mover.next(mover.start()._replace(**{field: value}), 0.002)
        assert status == NOT_FINITE and values.velocity == 0.0
