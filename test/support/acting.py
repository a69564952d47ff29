# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Scenes on which springs, dampers and tables act: 47 without friction, 4 of all with it."""
from itertools import product
from math import pi

import numpy as np
from support.scenes import PAPER, RODS, TIP

COUNT = 60              # inputs of a scene
BODIES = {'bodies.crank.mass': 1.2, 'bodies.crank.inertia': 2e-2, 'bodies.crank.cg_along': 0.1,
          'bodies.coupler.mass': 0.7, 'bodies.coupler.inertia': 1e-2,
          'bodies.coupler.cg_along': 0.3, 'bodies.output.mass': 0.9,
          'bodies.output.inertia': 3e-2, 'gravity.y': -9.81}
KINDS = {
    'four_bar': {**PAPER, **RODS, **TIP, 'gravity.x': 1.0, 'gravity.y': -9.81},
    'slider_crank': {'linkage.kind': 'slider_crank', 'linkage.a1': 0.4, 'linkage.a2': 1.2,
                     'linkage.offset': 0.1, **TIP, **BODIES},
    'cylinder': {'linkage.kind': 'inverted_slider', 'linkage.a1': 1.2, 'linkage.a4': 1.6,
                 'linkage.input': 'slide', 'linkage.range': [1.0, 1.8], **TIP, **BODIES},
    'scotch_yoke': {'linkage.kind': 'scotch_yoke', 'linkage.a1': 0.3, **TIP, **BODIES}}


def given(family, name, **numbers):
    """Return the parameters of a spring or a force by its name; __ is a dot."""
    return {f'{family}.{name}.{field.replace("__", ".")}': value
            for field, value in numbers.items()}


BACK = {'first__along': 1.5, 'first__across': 0.7, 'second__link': 'output',
        'second__across': 0.1}
ACTING = {
    'linear': given('springs', 's', stiffness=800.0, free_length=0.4, **BACK),
    'preload': given('springs', 's', stiffness=500.0, free_length=0.4, preload=120.0, **BACK),
    'constant': given('springs', 's', preload=90.0, **BACK),
    'zero free length': given('springs', 's', stiffness=700.0, **BACK),
    'damper': given('springs', 's', damping=60.0, **BACK),
    'between links': given('springs', 's', first__link='crank', first__across=0.2,
                           second__link='output', second__along=-0.3, stiffness=900.0,
                           free_length=0.3, damping=9.0, preload=-20.0),
    'torsion': given('torsion_springs', 't', first='crank', second='coupler', stiffness=25.0,
                     free_angle=0.4, damping=1.5),
    'table over the input': given(
        'forces', 'f', link='output', along=0.3, acts='x', direction=0.3, factor=-2.0,
        values=[5.0, 80.0, -30.0, 5.0]),
    'table over an angle': given(
        'forces', 'f', link='coupler', along=0.4, across=-0.1, acts='across', over='beta',
        places=[-180.0, -60.0, 20.0, 90.0, 180.0], values=[3.0, 40.0, -60.0, 8.0, 3.0],
        place_unit='deg', periodic=True),
    'lines over a way': given(
        'forces', 'f', link='coupler', along=0.5, acts='y', over='tip.x', interpolation='linear',
        places=[-0.5, 0.2, 0.4, 1.1], values=[0.0, -900.0, 500.0, 20.0]),
    'couple over a way': given(
        'forces', 'f', link='crank', acts='couple', over='tip.y',
        places=[-0.3, 0.1, 0.25, 0.9], values=[80.0, -300.0, 500.0, -200.0])}
ACTING['all'] = {**ACTING['preload'], **ACTING['torsion'], **ACTING['lines over a way'],
                 **given('springs', 'd', first__across=-0.6, second__link='coupler',
                         second__along=0.2, damping=35.0),
                 **{name.replace('.f.', '.g.'): value
                    for name, value in ACTING['table over the input'].items()}}
CASES = [f'{kind}, {acting}' for kind, acting in product(KINDS, ACTING)
         if not (kind == 'scotch_yoke' and acting == 'table over an angle')]   # no angle turns

PIN = {'coefficient': 0.02, 'radius': 0.012, 'viscous': 0.001}
GUIDE = {'coefficient': 0.02, 'viscous': 0.5}
JOINTS = {'four_bar': {'O1': PIN, 'A': PIN, 'B': PIN, 'O4': PIN},
          'slider_crank': {'O1': PIN, 'A': PIN, 'B': PIN, 'guide': GUIDE},
          'cylinder': {'A': PIN, 'O4': PIN, 'O1': PIN},
          'scotch_yoke': {'O1': PIN, 'A': PIN, 'guide': GUIDE}}
RUBBING = [f'{kind}, friction' for kind in KINDS]          # on which all else acts too


def values_of(case):
    """Return the parameters of a scene at constant speed on which something acts."""
    kind, acting = case.split(', ')
    friction = JOINTS[kind] if acting == 'friction' else {}
    values = {**KINDS[kind], **ACTING['all' if friction else acting], **{
        f'friction.{joint}.{name}': value for joint, numbers in friction.items()
        for name, value in numbers.items()}, 'drive.source': 'timer',
              'drive.speed': 0.3 if kind == 'cylinder' else 7.0, 'outputs': ['loads']}
    if kind == 'cylinder' and 'forces.f.over' in values:
        values['forces.f.over'] = values['forces.f.over'].replace('beta', 'theta4')
    for name in [name for name in values if name.endswith('.acts')]:
        if name.replace('.acts', '.places') not in values:      # a table over the input
            values |= ({name.replace('.acts', '.places'): [0.9, 1.2, 1.5, 1.9]}
                       if kind == 'cylinder' else
                       {name.replace('.acts', '.places'): [0.0, 2.0, 4.0, 2.0 * pi],
                        name.replace('.acts', '.periodic'): True})
    return values


def inputs_of(linkage, speed):
    """Return (input, rate, acceleration) all over the first range, shape (n, 3)."""
    low, high = linkage.input_ranges[0]
    rng = np.random.default_rng(57)
    inputs = rng.uniform((low + 0.02 * (high - low), -9.0 * speed, -50.0),
                         (high - 0.02 * (high - low), 9.0 * speed, 50.0), (COUNT, 3))
    inputs[::4, 1:] = speed, 0.0
    return inputs
