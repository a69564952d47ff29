# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""This package, a textbook script, and 9x9 systems in numpy."""
import math
from pathlib import Path
import sys

from common import Case, Method, serve
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from bench.naive import ARRAY, law_of_cosines, nine_by_nine, SCALAR  # noqa: E402, I100
from bench.textbook import FIELDS, textbook  # noqa: E402
from fourbar_ros import Bodies, Body, FourBar  # noqa: E402

case = Case()
omega = float(case.omega)
sign = 1.0 if math.sin(case.truth['theta4'][0] - case.truth['beta'][0]) > 0.0 else -1.0
linkage = FourBar(*case.lengths, mode=2 if sign > 0.0 else 1,
                  bodies=Bodies(*(Body(*b) for b in case.bodies)))
masses = [(b.mass, b.cg_along, b.cg_across, b.inertia) for b in linkage.bodies]


def scalar(theta1):
    step, rows = linkage.step, []
    for x in theta1.tolist():
        motion, loads = step(x, omega, 0.0)
        rows.append((motion.theta4, motion.omega4, motion.alpha4, (loads.f41_x, loads.f41_y)))
    return rows


def scalar_motion(theta1):
    motion_of, rows = linkage.motion, []
    for x in theta1.tolist():
        motion = motion_of(x, omega, 0.0)
        rows.append((motion.theta4, motion.omega4, motion.alpha4))
    return rows


def read_scalar(rows):
    return dict(zip(('theta4', 'omega4', 'alpha4', 'f41'), zip(*rows)))


def read(found):
    motion, loads = found
    return {**read_motion(motion), 'f41': np.stack((loads.f41_x, loads.f41_y), -1)}


def read_motion(motion):
    return {'theta4': motion.theta4, 'omega4': motion.omega4, 'alpha4': motion.alpha4}


def batch(function, count):
    theta1 = np.tile(case.theta1, count // len(case.theta1))
    return lambda _: function(theta1, omega, 0.0)


def system(m):
    """Return the function theta1 -> motion and solution of the 9x9 system."""
    def run(x):
        motion = law_of_cosines(linkage.lengths, sign, x, m)
        return motion, nine_by_nine(linkage.lengths, motion, x, omega, 0.0, masses, m=m)
    return run


def batch_system(count):
    theta1, run = np.tile(case.theta1, count // len(case.theta1)), system(ARRAY)
    return lambda _: run(theta1)


def read_system(found):
    (y, _, dy, _, ddy, _), forces = found
    return {'theta4': y, 'omega4': dy * omega, 'alpha4': ddy * omega**2, 'f41': forces[..., :2]}


def read_systems(rows):
    motions, forces = zip(*rows)
    return read_system((np.array(motions).T, np.array(forces)))


one_system = system(SCALAR)


def only(theta1, rate, acceleration):
    return linkage.step(theta1, rate, acceleration, fields=FIELDS)


def by_textbook(theta1, rate, acceleration, m=ARRAY):
    return textbook(linkage.lengths, sign, masses, theta1, rate, acceleration, m)


def read_fields(found):
    fields = dict(zip(FIELDS, found))
    return {**{name: fields[name] for name in ('theta4', 'omega4', 'alpha4')},
            'f41': np.stack((fields['f41_x'], fields['f41_y']), -1)}


serve(case, [
    Method('fourbar_ros, scalar', scalar, read_scalar),
    Method('fourbar_ros, scalar, motion only', scalar_motion, read_scalar),
    *(Method(f'fourbar_ros, batch of {count}', batch(linkage.step, count), read)
      for count in (1000, 10000, 100000)),
    Method('fourbar_ros, batch of 10000, motion only', batch(linkage.motion, 10000), read_motion),
    Method('fourbar_ros, batch of 10000, fields of the textbook', batch(only, 10000), read_fields),
    Method('textbook numpy, batch of 10000', batch(by_textbook, 10000), read_fields),
    Method('textbook, one a call', lambda theta1: [by_textbook(x, omega, 0.0, SCALAR)
                                                   for x in theta1.tolist()],
           lambda rows: read_fields(np.array(rows).T)),
    Method('9x9 numpy, one a call', lambda theta1: [one_system(x) for x in theta1.tolist()],
           read_systems),
    Method('9x9 numpy, batch of 1000', batch_system(1000), read_system)])
