# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Scenes of the seeds, as parameters."""
import json
from math import pi

from fourbar_ros.scene import topics
import numpy as np

RODS = {'bodies.rods.density': 7750.0, 'bodies.rods.radius': 0.01}
PAPER = {'linkage.a1': 0.4, 'linkage.a2': 1.2, 'linkage.a3': 0.8, 'linkage.a4': 1.0}
SLIDES_7_6 = {'linkage.a1': 8.0, 'linkage.a2': 14.0, 'linkage.a3': 9.0, 'linkage.a4': 17.0}
SLIDES_7_7 = {'linkage.a1': 2.0, 'linkage.a2': 6.0, 'linkage.a3': 7.0, 'linkage.a4': 5.0}
ROCKER = {'linkage.a1': 4.0, 'linkage.a2': 3.0, 'linkage.a3': 2.0, 'linkage.a4': 8.0}
TIP = {'points.tip.link': 'coupler', 'points.tip.along': 0.5, 'points.tip.across': 0.2}
PUSH = {'forces.push.link': 'output', 'forces.push.along': 0.4, 'forces.push.acts': 'y',
        'forces.push.places': [0.0, 2.0, 4.0, 2.0 * pi],
        'forces.push.values': [5.0, 80.0, -30.0, 5.0], 'forces.push.periodic': True}
# with one point, a topic for each
OUTPUTS = [name for name in topics.OUTPUTS if name == 'points' or name not in topics.FAMILIES]


def kite_angle(short, long, mode, x):
    """
    Return theta4 of the kite a1 = a4 = short, a2 = a3 = long, on its branch from x = 0 on.

    B lies on the line that halves the angle between crank and ground, at both ends of a rod.
    """
    half = 0.5 * x
    root = np.sqrt(long**2 - (short * np.sin(half))**2)
    at = short * np.cos(half) + (root if mode == 2 else -root)
    return np.arctan2(at * np.sin(half), at * np.cos(half) - short)


def file_of(values, folder, name='scene'):
    """Return the path of a scene file of these values in a folder; JSON is YAML."""
    file = folder / f'{name}.yaml'
    text = json.dumps({'/**': {'ros__parameters': values}})
    file.write_text(text.replace('Infinity', '.inf').replace('NaN', '.nan'))
    return file


def values_of(mechanism, kind, **others):
    """Return the parameters of a scene with this mechanism, its kind by name; and others."""
    values = {f'linkage.{name}': value
              for name, value in zip(mechanism.length_names, mechanism.lengths)}
    values |= {'linkage.kind': kind, 'linkage.mode': mechanism.mode,
               'linkage.input': mechanism.input, 'gravity.x': mechanism.gravity[0],
               'gravity.y': mechanism.gravity[1]}
    if mechanism.bodies:
        values |= {f'bodies.{link}.{field}': getattr(body, field)
                   for link, body in mechanism.bodies._asdict().items()
                   for field in ('mass', 'inertia', 'cg_along', 'cg_across')}
        values |= {f'external.{link}.{field}': getattr(applied, field)
                   for link, applied in mechanism.external._asdict().items()
                   for field in ('force_x', 'force_y', 'along', 'across', 'couple')}
    return values | others
