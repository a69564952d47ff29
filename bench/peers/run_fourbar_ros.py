# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""This package, its plain.py (the paper in numpy), and a textbook script."""
from functools import partial
import math
from pathlib import Path
import sys

from common import Case, Method, serve
from loop import read as read_rows
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from bench.naive import ARRAY, FIELDS, SCALAR, textbook  # noqa: E402, I100
from fourbar_ros import Bodies, Body, FourBar, plain  # noqa: E402

case = Case()
omega = float(case.omega)
sign = 1.0 if math.sin(case.truth['theta4'][0] - case.truth['beta'][0]) > 0.0 else -1.0
linkage = FourBar(*case.lengths, mode=2 if sign > 0.0 else 1,
                  bodies=Bodies(*(Body(mass, cg_along=along, cg_across=across, inertia=inertia)
                                  for mass, along, across, inertia in case.bodies)))
masses = [(b.mass, b.cg_along, b.cg_across, b.inertia) for b in linkage.bodies]


def read(fields):
    """Return what is scored of fields by their names."""
    found = {name: fields[name] for name in ('theta4', 'omega4', 'alpha4')}
    if 'f41_x' in fields:
        found['f41'] = np.stack((fields['f41_x'], fields['f41_y']), -1)
    return found


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


def batch(function, count):
    """Return the function that gives so many samples at once to another."""
    theta1 = np.tile(case.theta1, count // len(case.theta1))
    return lambda _: function(theta1, omega, 0.0)


def each(function):
    """Return the function that gives one sample after the other to another."""
    return lambda theta1: [function(x, omega, 0.0) for x in theta1.tolist()]


def only(theta1, rate, acceleration):
    return linkage.step(theta1, rate, acceleration, fields=FIELDS)


def by_textbook(theta1, rate, acceleration, m=ARRAY):
    return textbook(linkage.lengths, sign, masses, theta1, rate, acceleration, m)


def read_textbook(found):
    return read(dict(zip(FIELDS, found)))


def by_plain(theta1, rate, acceleration):
    motion = plain.motion(linkage.lengths, theta1, rate, acceleration, linkage.mode)
    return motion, plain.loads(linkage.lengths, linkage.bodies, motion)


def read_plain(found):
    return read(found[0]._asdict() | found[1]._asdict())


def read_plain_rows(rows):
    motions, loads = zip(*rows)
    return read_plain((plain.Motion._make(np.array(motions).T),
                       plain.Loads._make(np.array(loads).T)))


serve(case, [
    Method('fourbar_ros, scalar', scalar, read_rows),
    Method('fourbar_ros, scalar, motion only', scalar_motion, read_rows),
    *(Method(f'fourbar_ros, batch of {count}', batch(linkage.step, count),
             lambda found: read(found[0]._asdict() | found[1]._asdict()))
      for count in (1000, 10000, 100000)),
    Method('fourbar_ros, batch of 10000, motion only', batch(linkage.motion, 10000),
           lambda motion: read(motion._asdict())),
    Method('fourbar_ros, batch of 10000, fields of the textbook', batch(only, 10000),
           read_textbook),
    Method('textbook numpy, batch of 10000', batch(by_textbook, 10000), read_textbook),
    Method('textbook, one a call', each(partial(by_textbook, m=SCALAR)),
           lambda rows: read_textbook(np.array(rows).T)),
    Method('plain.py, one a call', each(by_plain), read_plain_rows),
    Method('plain.py, batch of 1000', batch(by_plain, 1000), read_plain)])
