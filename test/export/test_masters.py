# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""FMUs in two masters, FMPy and fmusim of the Modelica association: the bits that Python has."""
import csv
import math
import shutil
import subprocess

from fourbar_lab.export import generate
from fourbar_ros import load_scene
from fourbar_ros.pipeline.stepper import evaluate, LOADS_UNKNOWN, OK, Stepper, Wanted
from fourbar_ros.scene.scene import from_values
import numpy as np
import pytest
from support.acting import CASES, given, RUBBING, values_of
from support.exported import COMPILERS
from support.samples import some
from support.scenes import PAPER, RODS

ROWS = 200


def by_fmpy(path, step, table, **options):
    """Return the rows that FMPy samples; ``table``: {input: values at all steps}."""
    from fmpy import simulate_fmu
    from fmpy.validation import validate_fmu
    assert validate_fmu(str(path)) == []
    times = step * np.arange(ROWS + 1)
    given = np.array(list(zip(times, *table.values())),
                     dtype=[(name, float) for name in ('time', *table)]) if table else None
    found = simulate_fmu(str(path), start_time=0.0, stop_time=times[-1], output_interval=step,
                         input=given, **options)
    return [dict(zip(found.dtype.names, row)) for row in found.tolist()]


def by_fmusim(path, step, table):
    """Return the rows that fmusim writes, in 16 digits."""
    given, found = path.with_name('given.csv'), path.with_name('found.csv')
    with given.open('w', newline='') as file:
        writer = csv.writer(file)
        writer.writerow(['time', *table])
        writer.writerows((repr(i * step), *map(repr, values))
                         for i, values in enumerate(zip(*table.values())))
    done = subprocess.run(
        ['fmusim', '--interface-type', 'cs', '--stop-time', repr(ROWS * step), '--output-interval',
         repr(step), '--output-file', found, *(['--input-file', given] if table else []), path],
        capture_output=True, text=True, check=True)
    assert not done.stdout + done.stderr
    with found.open(newline='') as file:
        return [{name: float(text) for name, text in row.items()} for row in csv.DictReader(file)]


@pytest.fixture(params=['FMPy', 'fmusim'])
def master(request):
    """Return a function to simulate by, and one that rounds as its rows are rounded."""
    if request.param == 'FMPy':
        pytest.importorskip('fmpy')
        return by_fmpy, float
    if shutil.which('fmusim') is None:
        pytest.skip('no fmusim on the path: it is in '
                    'https://github.com/modelica/Reference-FMUs/releases/tag/v0.0.39')
    return by_fmusim, lambda value: float(f'{value:.16g}')


pytestmark = pytest.mark.skipif(not COMPILERS, reason='no C compiler')


def check(row, expected, rounded):
    """Check the columns of a row that are expected: motion at least."""
    known = [name for name in row if name in expected]
    wanted = [rounded(expected[name]) for name in known]
    assert np.array_equal([row[name] for name in known], wanted, equal_nan=True), row['time']
    assert len(known) > 10


MEETING = {**PAPER, **RODS, **given('springs', 's', first__along=0.4, second__link='crank',
                                    second__along=0.4, stiffness=700.0, free_length=0.1)}
SCENES = {**{name: load_scene(name).values for name in (
    'paper', 'jansen', 'parallelogram', 'slides_7_6')},
    **{case: values_of(case) for case in (*CASES, *RUBBING)},
    'press': load_scene('press').values, 'meeting': MEETING}


@some('name', SCENES, ['paper', 'press', 'meeting', 'cylinder, all', 'four_bar, friction'])
def test_motion_and_loads(name, master, tmp_path):
    simulated, rounded = master
    scene, step = from_values(SCENES[name]), 1e-3
    linkage = scene.linkage
    low, high = linkage.input_ranges[0]
    middle, size = 0.5 * (low + high), 0.4 * (high - low)
    samples = [(middle + size * math.sin(x), 9.0 * size * math.cos(x), -81.0 * size * math.sin(x))
               for x in (9.0 * step * i + 0.1 for i in range(ROWS + 1))]
    if name == 'meeting':           # every fourth row
        samples = [(x if i % 4 else 0.0, *rates) for i, (x, *rates) in enumerate(samples)]
    rows = simulated(generate(scene, tmp_path, 'fmu2', name='unit').files[0], step,
                     dict(zip(linkage.input_coordinate, zip(*samples))))
    assert len(rows) == ROWS + 1
    for row, sample in zip(rows[1:], samples):      # a step sees the inputs of its beginning
        status, motion, loads = evaluate(linkage, *sample, linkage.bodies is not None)
        check(row, {**motion._asdict(), **loads._asdict(), 'status': status}, rounded)
    statuses = {row['status'] for row in rows[1:]}
    assert statuses == {OK, LOADS_UNKNOWN} if name == 'meeting' else OK in statuses


@some('solver', ['Euler', 'CVode'], 1)
def test_model_exchange_has_no_delay(solver, tmp_path):
    pytest.importorskip('fmpy')
    linkage, step = load_scene('paper').linkage, 2.0**-10
    given = [(6.0 * x, 6.0, 0.0) for x in (step * i for i in range(ROWS + 1))]
    rows = by_fmpy(generate('paper', tmp_path, 'fmu2').files[0], step,
                   dict(zip(linkage.input_coordinate, zip(*given))), fmi_type='ModelExchange',
                   solver=solver, step_size=step)
    assert len(rows) == ROWS + 1
    for row, sample in zip(rows, given):
        motion, loads = linkage.step(*sample)
        check(row, {**motion._asdict(), **loads._asdict(), 'status': 0.0}, float)


@some('name,changes', [
    ('sundials', {}), ('motor', {}), ('motor', {'shaft.stiffness': 1e9, 'shaft.damping': 1e3})], 1,
    ids=['sundials', 'motor', 'stiff shaft'])
def test_motion_by_torque(name, changes, master, tmp_path):
    simulated, rounded = master
    scene = from_values({**load_scene(name).values, **changes})
    step = 1.0 / scene.drive.rate
    torques = [0.1 * math.sin(0.01 * i) for i in range(ROWS + 1)]
    is_commanded = scene.drive.source == 'torque'
    rows = simulated(generate(scene, tmp_path, 'fmu2', name='unit').files[0], step,
                     {'torque': torques} if is_commanded else {})
    assert len(rows) == ROWS + 1
    mover, stepper = scene.mover, Stepper(scene)
    fields = [*scene.linkage.MOTION._fields, *scene.linkage.LOADS._fields]
    values, status, time = mover.start(), 0, 0.0
    for i, row in enumerate(rows):
        _, numbers = stepper.step(values.position, values.velocity, values.acceleration,
                                  Wanted(with_loads=True), mover.mode)
        check(row, {**dict(zip(fields, numbers)), 'drive.status': status,
                    **{f'drive.{name}': value for name, value in values._asdict().items()}},
              rounded)
        after = (i + 1) * step                    # steps of both are differences of times
        status, values = mover.next(values, after - time, torques[i] * is_commanded)
        time = after
