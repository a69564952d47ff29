# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Warn of values that are allowed but probably in a wrong unit: millimetres, degrees, g/cm^3."""
from __future__ import annotations

from collections.abc import Iterator
from math import isnan, radians, tau

from fourbar_ros.scene.linkage import RODS
from fourbar_ros.scene.scene import Scene
from fourbar_ros.scene.settings import MACHINE

LONGEST = 10.0                      # [m]
LIGHTEST, DENSEST = 100.0, 25000.0  # [kg/m^3], from cork to beyond osmium
STEEL = 7850.0


def warnings_of(scene: Scene) -> list[str]:
    """Return a line for each value of a scene that is allowed but probably in a wrong unit."""
    return [*_long(scene), *_density(scene), *_thick(scene), *_angle(scene)]


def _long(scene: Scene) -> Iterator[str]:
    """
    Yield one line for all lengths beyond LONGEST: the user probably meant millimetres.

    Without masses, as in problems of textbooks, lengths may be in any unit.
    """
    if not scene.has_loads:
        return
    family = 'dyads' if scene.values['linkage.kind'] == MACHINE else 'linkage'
    long = [(f'{family}.{name}', value)
            for name, value in zip(scene.linkage.length_names, scene.linkage.lengths)
            if abs(value) > LONGEST]
    if long:
        (name, value), *others = long
        name = name if name in scene.values else name.removeprefix('dyads.')    # of a cylinder
        too = f' (and {len(others)} more)' if others else ''
        yield f'{name} = {value:g} m: did you mean {value * 1e-3:g}? Lengths are in metres{too}'


def _density(scene: Scene) -> Iterator[str]:
    """Yield a line for rods lighter than cork or denser than any metal: likely in g/cm^3."""
    density = scene.values[RODS + 'density']
    if density < LIGHTEST:
        meant = f'{density * 1e3:g}' if LIGHTEST <= density * 1e3 <= DENSEST else f'{STEEL:g}'
        yield (f'{RODS}density = {density:g} kg/m^3 is lighter than cork: did you mean {meant}? '
               f'Steel has {STEEL:g}')
    if density > DENSEST:
        yield (f'{RODS}density = {density:g} kg/m^3 is denser than any metal: did you mean '
               f'{density * 1e-3:g}? Steel has {STEEL:g}')


def _thick(scene: Scene) -> Iterator[str]:
    """Yield one line if rods are thicker than the shortest of them is long."""
    values, lengths = scene.values, dict(zip(scene.linkage.length_names, scene.linkage.lengths))
    rods = [abs(lengths[link.length]) for link in scene.linkage.LINKS
            if link.length in lengths and isnan(values[f'bodies.{link.name}.mass'])]
    shortest = min(rods, default=0.0)
    for field, across in (('radius', 2.0), ('width', 1.0), ('thickness', 1.0)):
        value = values[RODS + field]
        if rods and across * value > shortest:
            yield (f'{RODS}{field} = {value:g} m: the rods are thicker than the shortest of them '
                   f'is long, {shortest:g} m: did you mean {value * 1e-3:g}?')


def _angle(scene: Scene) -> Iterator[str]:
    """Yield a line for a start of more than a turn: the user probably meant degrees."""
    start = scene.drive.start
    if not scene.linkage.is_driven_by_slide and abs(start) > tau:
        yield (f'drive.start = {start:g} rad is more than a turn: did you mean '
               f'{radians(start):.5g} ({start:g} degrees)?')
