# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Generated C beside Python, numpy, numba and engines, its floor, what compiler flags change."""
from __future__ import annotations

from collections import Counter
import ctypes
import json
from pathlib import Path
import shutil
import subprocess
import sys
from tempfile import TemporaryDirectory

from fourbar_ros import load_scene
from fourbar_ros.generated import generate
from fourbar_ros.generated.c_code import Code
from fourbar_ros.generated.model import Model
from fourbar_ros.numerics.straight_line import straight_line
import numpy as np

from . import ROOT, speed
from .compiled import compiled
from .pages import best_time, table

SAMPLES, ROUNDS, STEPS_MADE = 20_000, 15, 5000
SCENES = ('paper', 'slider_crank', 'cylinder', 'scotch_yoke', 'bucket', 'watt', 'jansen',
          'andrews', 'classics/v8')
C = ['-std=c99', '-O2']
LOOP = """
#include <math.h>
#include <stddef.h>
#include "NAME.h"
void many(const NAME_input *inputs, int count, double *to, int width)
{
  NAME_parameters parameters;
  NAME_constants constants;
  int i;
  NAME_defaults(&parameters);
  NAME_prepare(&parameters, &constants);
  for (i = 0; i < count; ++i) {
    NAME_motion *motion = (NAME_motion *)(to + (size_t)i * (size_t)width);
    NAME_step(&constants, inputs + i, motion, (NAME_loads *)(motion + 1));
  }
}
double alone(const NAME_input *inputs, int count, double unit)
{
  double sum = 0.0;
  int i;
  for (i = 0; i < count; ++i) {
    const double *given = (const double *)(inputs + i);
    const double x = given[0];
FLOOR
  }
  return sum;
}
"""
STEPS = """
#include "NAME.h"
void steps(int count, double step, double *to)
{
  NAME_drive drive;
  int i;
  NAME_start(&drive TORQUE);
  for (i = 0; i < count; ++i) {
    (void)NAME_advance(&drive, step TORQUE);
    to[3 * i] = drive.position;
    to[3 * i + 1] = drive.velocity;
    to[3 * i + 2] = drive.evaluations;
  }
}
"""
ENGINES = 'mujoco', 'pin'
PEER = str(speed.ENVIRONMENT / 'bin' / 'python')
RUNNERS = {speed.OURS: sys.executable, 'mujoco': PEER, 'pinocchio': PEER}
SHOWN = {speed.SCALAR, speed.BATCHES[1], 'MuJoCo rollout, hardest, 1 step',
         'MuJoCo tree, loop closed to 1e-09 m', 'Pinocchio tree, loop closed to 1e-09 m',
         'Pinocchio constraintDynamics, mu 1e-04, 20 it.'}
MOVED = ('motor', 'controlled', 'engine', 'released', 'sundials', 'classics/door_closer')
FLAGS = ([['gcc', '-std=c99', level] for level in ('-O0', '-O1', '-O2', '-O3')]
         + [['gcc', '-std=gnu99', '-O2', '-march=native'],
            ['gcc', '-std=gnu99', '-O2', '-march=native', 'NO_PRAGMA'],
            ['gcc', '-std=c99', '-O2', '-ffast-math', '-U__FAST_MATH__']]
         + [['clang', '-std=c99', level] for level in ('-O0', '-O1', '-O2', '-O3')]
         + [['clang', '-std=c99', '-O2', '-march=native'],
            ['clang', '-std=c99', '-O2', '-ffast-math', '-U__FAST_MATH__']])


class Built:
    """The code of a scene and a loop, compiled."""

    def __init__(self, name, folder, command):
        scene = load_scene(ROOT / 'config' / f'{name}.yaml')
        self.model = Model(scene, Path(name).name)
        self.code, name = Code(self.model), self.model.name
        counts = Counter(self.model.trace.steps[place].operation
                         for place in self.model.needed(True)
                         if place in self.model.trace.varies)
        self.calls = {what: counts[what] for what in ('sin', 'cos', 'sqrt', 'atan2', 'hypot')}
        floor = [f'    sum += {text.format(0.01 * i)};' for what, text in (
            ('sin', 'sin(x + {})'), ('cos', 'cos(x + {})'), ('sqrt', 'sqrt(unit + x * x + {})'),
            ('atan2', 'atan2(x + {}, unit)')) for i in range(self.calls[what])]
        source = self.code.source()
        if 'NO_PRAGMA' in command:
            source = source.replace('#pragma GCC optimize ("fp-contract=off")', '')
        command = [word for word in command if word != 'NO_PRAGMA']
        (folder / f'{name}.h').write_text(self.code.header())
        (folder / f'{name}.c').write_text(source)
        (folder / 'loop.c').write_text(LOOP.replace('FLOOR', '\n'.join(floor)).replace(
            'NAME', name))
        library = folder / f'{len(list(folder.iterdir()))}.so'
        subprocess.run([*command, '-shared', '-fPIC', '-o', library, f'{name}.c', 'loop.c', '-lm'],
                       check=True, cwd=folder)
        self.library = ctypes.CDLL(str(library))
        self.width = len(self.model.motion) + len(self.model.loads)
        low, high = self.model.mechanism.input_ranges[0]
        rng = np.random.default_rng(0)
        self.inputs = np.column_stack([rng.uniform(low, high, SAMPLES),
                                       rng.normal(0.0, 20.0, (SAMPLES, 2))])
        self.values = np.zeros((SAMPLES, self.width))

    def of_step(self):
        """Return the time of a sample [ns]."""
        given = [array.ctypes.data_as(ctypes.c_void_p) for array in (self.inputs, self.values)]
        return 1e9 / SAMPLES * best_time(lambda: self.library.many(
            given[0], SAMPLES, given[1], self.width), ROUNDS)

    def of_floor(self):
        """Return the time of its sines, cosines, roots and arc tangents alone [ns]."""
        alone = self.library.alone
        alone.argtypes = [ctypes.c_void_p, ctypes.c_int, ctypes.c_double]
        alone.restype = ctypes.c_double
        given = self.inputs.ctypes.data
        return 1e9 / SAMPLES * best_time(lambda: alone(given, SAMPLES, 1.0), ROUNDS)

    def in_python(self):
        """Return the time of a sample by floats, and by arrays [ns]."""
        step, rows = self.model.mechanism.step, self.inputs[:2000].tolist()
        one = 1e9 / len(rows) * best_time(lambda: [step(*row) for row in rows])
        columns = self.inputs.T.copy()
        return one, 1e9 / SAMPLES * best_time(lambda: step(*columns))


def main():
    """Print the tables."""
    with TemporaryDirectory() as folder:
        _beside(Path(folder))
        _machines(Path(folder))
        _steps(Path(folder))
        _flags(Path(folder))


def _beside(folder):
    """Print what others take for a revolution of the paper's linkage: speed's case."""
    case = folder / 'case.json'
    speed.write_case(case)
    given = json.loads(case.read_text())
    (folder / 'beside').mkdir()
    built = Built('paper', folder / 'beside', ['gcc', *C])
    turns = SAMPLES // len(given['theta1'])
    built.inputs = np.array([(x, given['omega'], 0.0) for x in given['theta1']] * turns)
    found = {'sines, cosines, roots and arc tangents of C alone': (built.of_floor(), None),
             'C': (built.of_step(), _error(built.values, built, given))}
    left_out = [f'{peer}: {why}' for peer, why in speed.install(ENGINES).items() if why]
    try:
        import numba
        out = np.empty((SAMPLES, built.width)).T        # a sample's results together, as in C
        columns = built.inputs.T.copy()
        loop = compiled(straight_line(_flat_formula(built.model.mechanism), 3), 3, numba)
        loop(columns, out)
        found['numba'] = (1e9 / SAMPLES * best_time(lambda: loop(columns, out), ROUNDS),
                          _error(out.T, built, given))
    except ImportError:
        left_out.append('numba is not installed here: pip install numba')
    for script, python in RUNNERS.items():
        try:
            runner = speed.Runner(script, python, case, folder)
        except (RuntimeError, OSError) as error:
            left_out.append(f'{script}: {error}')
            continue
        rounds = [runner.one_round() for _ in range(speed.ROUNDS)]
        runner.close()
        found.update({name: (1e9 * min(one[name] for one in rounds), errors['f41'])
                      for name, errors in runner.errors.items() if name in SHOWN})
    print('The four-bar with all loads: a revolution at constant speed. Engines are called from '
          'Python, rollouts once for all samples; error of the force at O1, of its peak.\n')
    table(('method', 'ns a sample', 'times C', 'error'),
          [(name, f'{took:.0f}', f'{took / found["C"][0]:.3g}',
           '-' if error is None else f'{error:.1e}')
           for name, (took, error) in sorted(found.items(), key=lambda item: item[1][0])])
    for line in left_out:
        print(f'Left out: {line}\n')


def _flat_formula(mechanism):
    """Return number type -> formula of motion and loads, one after the other."""
    def formula(numbers):
        motion_of = mechanism.motion_formula(numbers, mechanism.constants)
        loads_of = mechanism.loads_formula(numbers, mechanism.constants)

        def state(*given):
            motion = mechanism.MOTION._make(motion_of(*given))
            return (*motion, *loads_of(motion))
        return state
    return formula


def _error(rows, built, case):
    """Return the largest error of F41 of the first samples, of its peak."""
    names = [one.name for one in (*built.model.motion, *built.model.loads)]
    true = np.array(case['truth']['f41'])
    found = rows[:len(true), [names.index('f41_x'), names.index('f41_y')]]
    return float(np.hypot(*(found - true).T).max() / np.hypot(*true.T).max())


def _machines(folder):
    print(f'Motion and all loads, gcc {" ".join(C)}, ns a sample; the least of {ROUNDS} rounds. '
          'A line without loops has one path: its operations are the longest. Floor: its sines, '
          'cosines, roots and arc tangents alone.\n')
    rows = []
    for name in SCENES:
        (folder / Path(name).name).mkdir()
        built = Built(name, folder / Path(name).name, ['gcc', *C])
        step, floor = built.of_step(), built.of_floor()
        one, many = built.in_python()
        rows.append((Path(name).name, built.code.operations[True],
                     ' + '.join(map(str, built.calls.values())), f'{step:.0f}', f'{floor:.0f}',
                     f'{step / floor:.2f}', f'{one:.0f}', f'{many:.0f}', built.code.stack))
    table(('scene', 'operations', 'sin + cos + root + atan2 + hypot', 'C', 'floor', 'C / floor',
           'Python', 'numpy batch', 'stack bound [bytes]'), rows)
    print('Operations of every shipped scene (motion; with loads):\n')
    counts = []
    for path in sorted((ROOT / 'config').glob('*.yaml')) + sorted(
            (ROOT / 'config' / 'classics').glob('*.yaml')):
        found = Code(Model(load_scene(path), path.stem.replace('-', '_'))).operations
        counts.append(f'{path.stem} {found[False]}'
                      + (f'; {found[True]}' if True in found else ''))
    print(', '.join(f'{text.replace(";", " and")}' for text in counts) + '.\n')


def _steps(folder):
    print('Steps of motion by torque, as long as the node makes them, us a step; the values that '
          'differ are of position, velocity and evaluations.\n')
    rows = []
    for path in MOVED:
        name, scene = Path(path).name, load_scene(ROOT / 'config' / f'{path}.yaml')
        place = folder / f'{name}_steps'
        place.mkdir()
        generate(scene, place, name=name)
        torque = ', 0.0' * (scene.drive.source == 'torque')
        (place / 'steps.c').write_text(STEPS.replace(' TORQUE', torque).replace('NAME', name))
        subprocess.run(['gcc', *C, '-shared', '-fPIC', '-o', place / 'steps.so', f'{name}.c',
                        'steps.c', '-lm'], check=True, cwd=place)
        run = ctypes.CDLL(str(place / 'steps.so')).steps
        run.argtypes = [ctypes.c_int, ctypes.c_double, ctypes.c_void_p]
        step, found = 1.0 / scene.drive.rate, np.zeros((STEPS_MADE, 3))
        in_c = best_time(lambda: run(STEPS_MADE, step, found.ctypes.data), ROUNDS)
        mover, expected = scene.mover, []

        def in_python():
            values = mover.start()
            expected.clear()
            for _ in range(STEPS_MADE):
                _, values = mover.next(values, step)
                expected.append((values.position, values.velocity, values.evaluations))
        slow = best_time(in_python, 3)
        rows.append((name, f'{step:g}', f'{found[:, 2].mean():.1f}',
                     f'{1e6 * in_c / STEPS_MADE:.2f}', f'{1e6 * slow / STEPS_MADE:.0f}',
                     f'{np.count_nonzero(found != expected)} of {found.size}'))
    table(('scene', 'step [s]', 'evaluations a step', 'C', 'Python', 'values that differ'), rows)


def _flags(folder):
    print(f'Compiler flags, four-bar, {SAMPLES} inputs: values that differ in any bit from '
          f'gcc {" ".join(C)}, which has those of Python.\n')
    reference, rows = Built('paper', folder, ['gcc', *C]), []
    reference.of_step()
    for command in FLAGS:
        if shutil.which(command[0]) is None:
            continue
        built = Built('paper', folder, command)
        ns = built.of_step()
        one, other = reference.values, built.values
        differ = (one.view(np.uint64) != other.view(np.uint64)) & ~(np.isnan(one)
                                                                    & np.isnan(other))
        with np.errstate(divide='ignore', invalid='ignore'):
            apart = np.nanmax(np.where(differ, abs(one - other) / abs(one), 0.0))
        what = ' '.join('without the pragma of the source' if word == 'NO_PRAGMA' else word
                        for word in command if not word.startswith('-U'))
        rows.append((what, f'{ns:.0f}', f'{differ.sum()} of {differ.size}', f'{apart:.1e}'))
    table(('flags', 'ns', 'values that differ', 'at most, relative'), rows)
