# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Values that a parameter should not have."""
from fourbar_ros.scene.parameters import of_name
from fourbar_ros.scene.topics import OUTPUTS, PICTURES

DOUBLES = [0.0, -0.0, 1.0, -1.0, 1e-9, 1e9, -1e9, 5e-324, 1e-300, -1e-300, 1e154, 1e300, -1e300,
           1.7976931348623157e308, float('inf'), float('-inf'), float('nan')]
EVERY = [*OUTPUTS, *PICTURES]
HOSTILE = {
    'double': [*DOUBLES, 0, 3, 2**63 - 1],
    'integer': [0, 1, 2, 3, -1, 50, 2**31, 2**63 - 1, -2**63],
    'string': ['', 'x' * 100_000, '\n', 'ä\0', '../..', 'ground', 'crank', 'hold', 'dc'],
    'bool': [True, False],
    'strings': [[], [''], ['x'] * 1000, ['state', 'state'], EVERY, ['robot_description'],
                ['markers', 'traces', 'tf'], ['loads', 'links', 'reactions'], ['state']],
    'doubles': [[], [0.0], DOUBLES, [1] * 1000],
}


def hostile(rng, name):
    """Return a value that a parameter should not have, now and then of another type."""
    kind = of_name(name).type if rng.random() < 0.8 else rng.choice([*HOSTILE])
    if kind == 'double' and rng.random() < 0.3:
        return rng.choice([-1.0, 1.0]) * 10.0**rng.uniform(-20.0, 20.0)
    return rng.choice(HOSTILE[kind])
