# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""FMUs in fmusim, the simulator of the Modelica association: what it writes is what Python has."""
import csv
import math
import shutil
import subprocess

from fourbar_ros import load_scene
from fourbar_ros.generated import generate
from fourbar_ros.pipeline.status import evaluate
from fourbar_ros.pipeline.stepper import InModes
import pytest
from support.generated import COMPILERS

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not COMPILERS, reason='no C compiler'),
    pytest.mark.skipif(shutil.which('fmusim') is None, reason='no fmusim on the path: it is in '
                       'https://github.com/modelica/Reference-FMUs/releases/tag/v0.0.39')]
ROWS = 1000


def simulated(path, step, table):
    """Return the rows that fmusim writes; ``table``: {input: values at all steps}."""
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
        return list(csv.DictReader(file))


def compared(row, expected):
    """Return of how many columns a row has the digits that fmusim prints."""
    known = [name for name in row if name in expected]
    assert {name: float(row[name]) for name in known} == {
        name: float(f'{expected[name]:.16g}') for name in known}
    return len(known)


@pytest.mark.parametrize('as_', ['fmu2', 'fmu3'])
def test_motion_and_loads(as_, tmp_path):
    linkage = load_scene('paper').linkage
    angles = [0.01 * i for i in range(ROWS + 1)]
    given = [(3.0 * math.sin(x), 6.0 * math.cos(x), -12.0 * math.sin(x)) for x in angles]
    rows = simulated(generate('paper', tmp_path, as_).files[0], 1e-3,
                     dict(zip(linkage.input_coordinate, zip(*given))))
    assert len(rows) == ROWS + 1
    for row, sample in zip(rows[1:], given):      # a step sees the inputs of its beginning
        status, motion, loads = evaluate(linkage, *sample, True)
        assert compared(row, {**motion._asdict(), **loads._asdict(), 'status': status}) > 30


@pytest.mark.parametrize('name', ['sundials', 'motor'])
@pytest.mark.parametrize('as_', ['fmu2', 'fmu3'])
def test_motion_by_torque(name, as_, tmp_path):
    scene = load_scene(name)
    step = 1.0 / scene.drive.rate
    torques = [0.1 * math.sin(0.01 * i) for i in range(ROWS + 1)]
    is_commanded = scene.drive.source == 'torque'
    rows = simulated(generate(name, tmp_path, as_).files[0], step,
                     {'torque': torques} if is_commanded else {})
    assert len(rows) == ROWS + 1
    mover, stepper = scene.mover, InModes(scene)
    fields = [*scene.linkage.MOTION._fields, *scene.linkage.LOADS._fields]
    values, status, time = mover.start(), 0, 0.0
    for i, row in enumerate(rows):
        _, numbers = stepper.step(mover.mode, values.position, values.velocity,
                                  values.acceleration, True, True)
        assert compared(row, {
            **dict(zip(fields, numbers)), 'drive.status': status,
            **{f'drive.{name}': value for name, value in values._asdict().items()}}) > 30
        after = (i + 1) * step                    # fmusim's steps are differences of its times
        status, values = mover.next(values, after - time, torques[i] * is_commanded)
        time = after
