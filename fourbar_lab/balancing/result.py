# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The result of balancing: loads before and after, the scene with counterweights, figures."""
from collections.abc import Sequence
from math import inf, isfinite
from pathlib import Path
from typing import NamedTuple

from fourbar_lab.balancing.cone import Balance, peak
from fourbar_lab.balancing.loads import body_of, Loads, MOMENTS
from fourbar_lab.drawing.figure import make_panels, save
from fourbar_ros.mechanisms.quadrature import nodes
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.scene.files import as_text
from fourbar_ros.scene.parameters import without_defaults
from fourbar_ros.scene.scene import Scene
import numpy as np

SAMPLES = 720                               # inputs of a drawn curve
DRAWN = ('force', 'moment', 'torque')       # loads that are drawn


class Change(NamedTuple):
    """Root mean square and peak of a load of inertia, each (before, after) balancing."""

    name: str
    unit: str
    rms: tuple[float, float]
    peak: tuple[float, float]


def changes(loads: Loads, moments: Array) -> list[Change]:
    """Return the :class:`Change` of each load; ``moments``: of all links after balancing."""
    def both(name: str, of_links: Array) -> tuple[float, float]:
        """Return root mean square and peak; at a flat position both are infinite or none is."""
        largest, _ = peak(loads, name, of_links)
        return (loads.rms(name, of_links), largest) if isfinite(largest) else (inf, inf)

    results = []
    for name in loads.groups:
        (rms, largest), (rms_after, largest_after) = (both(name, of_links)
                                                      for of_links in (loads.unbalanced, moments))
        results.append(Change(name, unit_of(loads, name), (rms, rms_after),
                              (largest, largest_after)))
    return results


def unit_of(loads: Loads, name: str) -> str:
    """Return the unit of a load by its name: N m of moments and torques, else N."""
    return 'N m' if loads.group(name)[0].endswith(('moment', 'torque')) else 'N'


def scene_values(scene: Scene, moments: Array) -> dict[str, float]:
    """Return the parameters of a scene with other bodies, those at their default left out."""
    # moments: m [kg], m x, m y [kg m] and J about the first joint [kg m^2] of each link, all in
    # one row. They replace all that the scene says of bodies, rods too.
    values = {name: value for name, value in scene.values.items()
              if not name.startswith('bodies.')}
    for link, of_link in zip(scene.linkage.BODIES._fields, moments.reshape(-1, MOMENTS)):
        body = body_of(of_link)
        values |= {f'bodies.{link}.mass': body.mass, f'bodies.{link}.cg_along': body.cg_along,
                   f'bodies.{link}.cg_across': body.cg_across}
        if scene.linkage.link(link).turns:
            values[f'bodies.{link}.inertia'] = body.inertia
    return without_defaults(values)


def scene_text(scene: Scene, balance: Balance, how: str) -> str:
    """Return a scene file with the counterweights; its first comment begins with ``how``."""
    head = [f'# {how}; the bodies below include these counterweights, from the first joint:']
    head += [f'#   {weight.link}: {weight.mass:.9g} kg at along {weight.along:.9g} m, '
             f'across {weight.across:.9g} m' for weight in balance.counterweights]
    return '\n'.join(head) + '\n' + as_text(scene_values(scene, balance.moments))


def draw_changes(loads: Loads, moments: Array, path: str | Path) -> None:
    """Draw force, moment and torque of inertia over the input, before and after."""
    is_angle = loads.mechanism.input_coordinate.unit == 'rad'
    x = np.sort(nodes(loads.acting, SAMPLES)[0])
    panels = {}
    for name in DRAWN:
        matrices = loads.matrices(x, name)
        title = loads.group(name)[0].removesuffix('_x').replace('_', ' ')
        panels[f'{title} [{unit_of(loads, name)}]'] = [
            (label, np.degrees(x) if is_angle else x,
             load[0] if len(load) == 1 else np.linalg.norm(load, axis=0))
            for label, load in zip(('before', 'after'), [
                matrices @ loads.column(of_links) for of_links in (loads.unbalanced, moments)])]
    save(make_panels(panels, 'input [deg]' if is_angle else 'input [m]',
                     f'{loads.title}, moment about O1'), path)


def draw_front(names: Sequence[str], balances: Sequence[Balance], path: str | Path) -> None:
    """Draw the remaining loads over the added mass; the first balance has no added mass."""
    added, values = np.array([(balance.added, balance.value) for balance in balances]).T
    percent = 100.0 * values / (values[0] if values[0] != 0.0 else 1.0)
    save(make_panels({f'RMS of {" and ".join(names)} [%]': [('', added, percent)]},
                     'added mass [kg]', ''), path)
