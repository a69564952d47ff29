# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Error against run time of a scene of your own: a step, arrays, motion from torque, its C.

Errors are rounding errors beside the same formulas in 160 digits, over the largest value of their
sort; that of `simulate` is the position's, at the tolerance it was asked for.
"""
from pathlib import Path
from tempfile import TemporaryDirectory
from timeit import repeat

from fourbar_ros import load_scene
from fourbar_ros.cli.scene import INPUTS_OF_ARRAYS, INPUTS_OF_ERROR, ROUNDS, step_cost
from fourbar_ros.mechanisms.rounding import rounding_errors
import numpy as np
from support.exported import Code, COMPILERS

from .pages import table

UNTIL, TOLERANCES = 1.0, (1e-6, 1e-8, 1e-10)        # [s], of simulate


def main(scene='paper'):
    """Print the table of a scene."""
    name, scene = Path(scene).stem, load_scene(scene)
    linkage, speed = scene.linkage, scene.drive.speed
    low, high = linkage.input_ranges[0]
    positions = low + (high - low) * (np.arange(INPUTS_OF_ERROR) + 0.5) / INPUTS_OF_ERROR
    errors = rounding_errors(linkage, positions.tolist(), speed, 0.0, linkage.has_loads)
    field = max(errors, key=errors.get)
    evaluated = linkage.step if linkage.has_loads else linkage.motion
    rows = [('a step', f'{errors[field]:.1g} ({field})', f'{1e6 * step_cost(scene):.2f} us')]

    def values(position):
        result = evaluated(position, speed)
        return np.concatenate(result) if linkage.has_loads else np.array(result)
    steps = np.array([values(position) for position in positions.tolist()]).T

    def beyond(others):
        """Return an error: that of a step, and how far others are from the steps."""
        sizes = np.abs(steps).max(axis=1, initial=1e-300)
        away = float(np.nanmax(np.abs(others - steps).max(axis=1) / sizes))
        return f'{errors[field]:.1g}, {f"{away:.1g} off the step" if away else "bits of the step"}'
    inputs = np.resize(positions, INPUTS_OF_ARRAYS)
    seconds = min(repeat(lambda: evaluated(inputs, speed), number=1, repeat=ROUNDS))
    rows.append((f'arrays of {INPUTS_OF_ARRAYS}', beyond(values(positions)),
                 f'{1e6 * seconds / inputs.size:.3f} us a sample'))
    if COMPILERS:
        with TemporaryDirectory() as folder:
            code = Code(scene, Path(folder), name)
            run = code.compiled(COMPILERS[0], '-std=c99', '-O2')
            told = np.zeros((inputs.size, len(code.model.inputs)))
            told[:, 0], told[:, 1] = inputs, speed
            _, result = run(np.ascontiguousarray(told[:INPUTS_OF_ERROR]))
            seconds = min(repeat(lambda: run(told), number=1, repeat=ROUNDS))
        names = (*linkage.MOTION._fields, *linkage.LOADS._fields)
        every = steps.copy()
        for entry, column in zip((*code.model.motion, *code.model.loads), result.T):
            if entry.name in names:         # points are none of the mechanism's fields
                every[names.index(entry.name)] = column
        rows.append((f'C, {COMPILERS[0]} -O2', beyond(every),
                     f'{1e6 * seconds / inputs.size:.3f} us a sample'))
    if scene.dynamics:
        from fourbar_ros.dynamics import simulate
        for tolerance in TOLERANCES:
            system = scene.dynamics.system(linkage)
            run = simulate(system, UNTIL, tolerance)
            seconds = min(repeat(lambda: simulate(system, UNTIL, tolerance), number=1, repeat=2))
            rows.append((f'simulate, tolerance {tolerance:g}',
                         f'{run.error:.1g} {linkage.input_coordinate.unit} ({run.status})',
                         f'{seconds:.2f} s for {UNTIL:g} s'))
    table((name, 'error', 'time'), rows)
