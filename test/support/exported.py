# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Generated C beside Python: the same inputs through both, all outputs and statuses compared."""
import ctypes
import math
import shutil
import subprocess

from fourbar_lab.export.files import generate
from fourbar_lab.export.fmu import build
from fourbar_lab.export.model import GeneratedModel, word
from fourbar_ros.dynamics.node_step import DriveValues, Mover
from fourbar_ros.mechanisms.curves import PointMotion
from fourbar_ros.mechanisms.points import point_in
from fourbar_ros.numerics.number_types import REAL
from fourbar_ros.pipeline.stepper import (
    evaluate,
    INVALID_INPUT,
    OK,
    OUT_OF_RANGE,
    RATES_UNKNOWN,
    TOGGLE,
)
import numpy as np
from support import ROOT

EPS = 2.0**-52
SCENES = sorted(path for folder in ('config', 'config/classics')
                for path in (ROOT / folder).glob('*.yaml'))
COMPILERS = tuple(filter(shutil.which, ('gcc', 'clang')))
STRICT = ('-Wall', '-Wextra', '-Wpedantic', '-Wconversion', '-Wshadow', '-Werror')
MANY = """
#include "NAME.h"
void many(const NAME_parameters *given, const NAME_input *inputs, int count, double *to,
          int *status);
void many(const NAME_parameters *given, const NAME_input *inputs, int count, double *to,
          int *status)
{
  NAME_parameters parameters;
  NAME_constants constants;
  int i;
  if (given) parameters = *given; else NAME_defaults(&parameters);
  NAME_prepare(&parameters, &constants);
  for (i = 0; i < count; ++i) {
    NAME_motion motion;
    double *row = to + (size_t)i * WIDTH;
    CALL
  }
}
"""
OF_MOTION = """status[i] = NAME_motion_at(&constants, inputs + i, &motion);
    memcpy(row, &motion, sizeof motion);"""
OF_BOTH = """NAME_loads loads;
    status[i] = NAME_step(&constants, inputs + i, &motion, &loads);
    memcpy(row, &motion, sizeof motion);
    memcpy(row + sizeof motion / 8, &loads, sizeof loads);"""


class Code:
    """The generated code of a scene, and a loop over many inputs."""

    def __init__(self, scene, folder, name, **options):
        self.folder, self.name = folder, word(name)
        self.written = generate(scene, folder, name=name, **options)
        self.model = GeneratedModel(scene, self.name, options.get('outputs'),
                                    options.get('parameters'))
        self.width = len(self.model.motion) + len(self.model.loads)
        text = MANY.replace('CALL', OF_BOTH if self.model.loads else OF_MOTION).replace(
            'NAME', self.name).replace('WIDTH', str(self.width))
        (folder / 'many.c').write_text('#include <string.h>\n' + text)

    def compiled(self, *command):
        """Return the function of many inputs, compiled by a command: compiler and flags."""
        library = self.folder / f'{"".join(command).replace("/", "")}.so'
        subprocess.run([*command, '-shared', '-fPIC', '-o', str(library),
                        str(self.folder / f'{self.name}.c'), str(self.folder / 'many.c'), '-lm'],
                       check=True)
        many = ctypes.CDLL(str(library)).many

        def run(inputs, parameters=None):
            to = np.full((len(inputs), self.width), 77.0)
            status = np.full(len(inputs), -1, np.intc)
            given = parameters and (ctypes.c_double * len(parameters))(*parameters)
            many(given, inputs.ctypes.data_as(ctypes.c_void_p), len(inputs),
                 to.ctypes.data_as(ctypes.c_void_p), status.ctypes.data_as(ctypes.c_void_p))
            return status, to
        return run


def library_of(folder, name):
    """Return the C of a folder that ``generate`` wrote, compiled for this machine."""
    build(folder / f'{name}.c', folder / f'{name}.so')
    return ctypes.CDLL(str(folder / f'{name}.so'))


class MoverOfC(Mover):
    """A mover of a scene whose steps and values are those of generated code, of the name code."""

    def __init__(self, scene, library):
        super().__init__(scene.dynamics.system(scene.linkage), scene.drive.tolerance,
                         scene.drive.budget, scene.drive.source == 'torque')
        self.of = {what: getattr(library, f'code_{what}') for what in ('complete', 'advance')}
        # behind the fields of a state: mode, place, command
        self.drive = (ctypes.c_double * (len(DriveValues._fields) + 1 + 6 + 1))()
        library.code_start(self.drive, *self.torques(0.0))
        self.latest = None

    def next(self, values, step, command=0.0):
        if values is not self.latest:
            self.set(values, self.state_of(values).mode, command)
        status = self.of['advance'](self.drive, ctypes.c_double(step), *self.torques(command))
        return status, self.taken()

    def values(self, state, step, command, evaluations):
        position, rate, twist, speed, source = state.vector
        self.set(DriveValues(step, command, position, rate, math.nan, twist, math.nan, speed,
                             math.nan, math.nan, source, source, evaluations), state.mode, command)
        return self.taken()

    def set(self, values, mode, command):
        size = len(values)
        self.drive[:size] = list(values)
        if self.passes:
            self.drive[size] = mode
        self.of['complete'](self.drive, *self.torques(command))

    def taken(self):
        size = len(DriveValues._fields)
        self.mode = int(self.drive[size]) if self.passes else self.mode
        self.latest = DriveValues(*self.drive[:size])
        return self.latest

    def torques(self, command):
        return [ctypes.c_double(command)] * self._takes_commands


def random_inputs(mechanism, seed, count, share_unknown=0.02):
    """Return positions, rates, accelerations, shape (count, 3), hard ones among them."""
    rng = np.random.default_rng(seed)
    ends = [end for bounds in (*mechanism.closing_ranges, *mechanism.input_ranges)
            for end in bounds] + [0.0, math.pi, -0.5 * math.pi, *(mechanism.stroke or ())]
    low, high = min(ends[:-3]), max(ends[:-3])
    ends += mechanism.flat_inputs
    found = rng.uniform(low - 0.1 * (high - low), high + 0.1 * (high - low), (count, 3))
    found[:, 1:] = rng.normal(0.0, 20.0, (count, 2))

    def some(share):
        return rng.random(count) < share
    at = some(0.1)                                         # limits, toggles, and beside them
    found[at, 0] = rng.choice(ends, at.sum()) * (1.0 + rng.integers(-6, 7, at.sum()) * EPS / 2)
    at = some(0.05)                                        # huge angles, tiny ones
    found[at, 0] = rng.normal(size=at.sum()) * 10.0**rng.uniform(-307.0, 305.0, at.sum())
    for column in (1, 2):
        at = some(0.1)
        found[at, column] = rng.normal(size=at.sum()) * 10.0**rng.uniform(-310.0, 306.0, at.sum())
        found[some(0.1), column] = rng.choice([0.0, -0.0])
    for column, share in ((0, 0.01), (1, share_unknown), (2, share_unknown)):
        at = some(share)
        found[at, column] = rng.choice([math.nan, math.inf, -math.inf], at.sum())
    return found


def of_python(mechanism, points, inputs):
    """
    Return (statuses, values) of the node for inputs, one by one.

    And for those of arrays there, which are compared by rounding and not bits, pi and the size of
    the rate: components of vectors are rounded as the angles are, and as these times the rate.
    """
    with_loads = mechanism.bodies is not None
    statuses, rows = [], []
    for given in inputs.tolist():
        status, motion, loads = evaluate(mechanism, *given, with_loads)
        values = [*motion]
        for point in points.values():
            values += point_in(REAL, mechanism, motion, *point)
        statuses.append(status)
        rows.append(values + [*loads] * with_loads)
    statuses, rows = np.array(statuses), np.array(rows)
    # without a pose C gives NaN of points too; Python what is constant, as y of a yoke
    first = len(mechanism.MOTION._fields)
    lost = (statuses == OUT_OF_RANGE) | (statuses == INVALID_INPUT)
    rows[lost, first:first + len(PointMotion._fields) * len(points)] = math.nan
    of_points = rows[:, first:first + len(PointMotion._fields) * len(points)]
    # with unknown rates the node knows no rate of a point, C the constant ones, as y of a yoke
    of_points[(statuses == RATES_UNKNOWN)[:, None] & np.isnan(of_points)] = math.inf
    by_arrays = (statuses == TOGGLE) | (statuses == RATES_UNKNOWN)
    rates = np.where(np.isfinite(inputs[:, 1]), abs(inputs[:, 1]), 0.0)
    return statuses, rows, np.where(by_arrays, math.pi + rates, 0.0)


def differences(found, expected, motions, is_strict=True, has_signs=True):
    """
    Return what is wrong in results of C, as text; empty: nothing.

    Statuses, and NaN or not, are the same everywhere; bits of all samples that are computed with
    floats in Python. At toggles and with unknown rates the node computes with arrays, whose
    atan2 is another one: there angles agree to 8 eps, the rest to 8 eps of itself and of the rate.
    Lengths that are no normal numbers differ by some of the least between versions of Python.
    Not strict: there, what is NaN in one and a number in the other is passed over: of some
    machines zeros keep a field from a rate in C and not in arrays, or the other way round.
    Without signs: Python leaves out sums of lengths that are zero in pairs at change points. C,
    where they may change, adds them: 0 may be -0 there, and the angle pi of a sine of zero -pi.
    """
    (status, values), (statuses, rows, sizes) = found, expected
    by_arrays = sizes > 0.0
    wrong = np.flatnonzero(status != statuses)
    if len(wrong):
        return f'{len(wrong)} statuses, first of input {wrong[0]}: {status[wrong[0]]} for ' \
               f'{statuses[wrong[0]]}'
    unlike = (np.isnan(values) != np.isnan(rows)) & ~np.isinf(rows)
    if not is_strict:
        unlike &= ~by_arrays[:, None]
    with np.errstate(invalid='ignore'):
        apart = (abs(values - rows) > 8.0 * EPS * (abs(rows) + sizes[:, None])) & ~np.isinf(rows)
    bits = np.ascontiguousarray(values).view(np.uint64) != rows.view(np.uint64)
    bits &= ~(np.isnan(values) & np.isnan(rows))
    with np.errstate(invalid='ignore'):
        bits &= ~((abs(rows) < 2.0**-1022) & (abs(values - rows) <= 2.0**-1070))
    if not has_signs:
        bits &= (abs(values) != abs(rows)) | ~np.isin(abs(rows), (0.0, math.pi))
    wrong = np.argwhere(unlike | np.where(by_arrays[:, None], apart, bits))
    if len(wrong):
        row, column = wrong[0]
        return (f'{len(wrong)} values, first of input {row}, status {status[row]}, column '
                f'{column} ({motions} of motion): {values[row, column]!r} for '
                f'{rows[row, column]!r}')
    return '' if (statuses == OK).any() else 'no input is good'
