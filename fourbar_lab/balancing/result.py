# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""What balancing did: loads before and after, the scene with its counterweights, figures."""
from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from types import ModuleType
from typing import NamedTuple, TYPE_CHECKING

from fourbar_lab.balancing.loads import body_of, Loads, NUMBERS
from fourbar_lab.balancing.peak import peak
from fourbar_lab.balancing.rms import Balance
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.scene.files import as_text
from fourbar_ros.scene.parameters import find
from fourbar_ros.scene.scene import Scene
import numpy as np

if TYPE_CHECKING:      # drawings alone need it
    from matplotlib.figure import Figure

SAMPLES = 720
DRAWN = ('force', 'moment', 'torque')


class Change(NamedTuple):
    """A load of inertia before and after: root mean square and peak."""

    name: str
    unit: str
    rms: tuple[float, float]
    peak: tuple[float, float]


def changes(loads: Loads, numbers: Array) -> list[Change]:
    """Return the :class:`Change` of everything that can be balanced."""
    return [Change(name, unit_of(loads, name),
                   (loads.rms(name, loads.given), loads.rms(name, numbers)),
                   (peak(loads, name, loads.given)[0], peak(loads, name, numbers)[0]))
            for name in loads.groups]


def unit_of(loads: Loads, name: str) -> str:
    """Return the unit of what can be balanced."""
    return 'N m' if loads.group(name)[0].endswith(('moment', 'torque')) else 'N'


def scene_values(scene: Scene, numbers: Array) -> dict[str, float]:
    """Return the parameters of a scene with these numbers of its links, without defaults."""
    values = dict(scene.values)
    for name in values:
        if name.startswith('bodies.'):
            values[name] = getattr(find(name), 'default', None)
    links = scene.linkage.BODIES._fields
    for link, part in zip(links, numbers.reshape(-1, NUMBERS)):
        body = body_of(part)
        values |= {f'bodies.{link}.mass': body.mass, f'bodies.{link}.cg_along': body.cg_along,
                   f'bodies.{link}.cg_across': body.cg_across}
        if scene.linkage.link(link).turns:
            values[f'bodies.{link}.inertia'] = body.inertia
    return {name: value for name, value in values.items() if value == value
            and value != getattr(find(name), 'default', None)}


def scene_text(scene: Scene, balance: Balance, what: str) -> str:
    """Return a scene file of the balanced mechanism; its head lists the counterweights."""
    head = [f'# {what}; the bodies below include these counterweights, from the first joint:']
    head += [f'#   {one.link}: {one.mass:.9g} kg at along {one.along:.9g} m, '
             f'across {one.across:.9g} m'
             + ''.join([f', {name} {value:.9g}' for name, value in
                        [*one._asdict().items()][4:]]) for one in balance.counterweights]
    return '\n'.join(head) + '\n' + as_text(scene_values(scene, balance.numbers))


def draw_changes(loads: Loads, numbers: Array, path: str | Path) -> None:
    """Draw force, moment and torque of inertia over the input, before and after."""
    pyplot, unit = _pyplot(), loads.mechanism.input_coordinate.unit
    x, _ = loads.nodes(SAMPLES)
    x = np.sort(x)
    figure, axes = pyplot.subplots(1, len(DRAWN), figsize=(12, 3.6), layout='constrained')
    for axis, name in zip(axes, DRAWN):
        matrices = np.stack(list(loads.matrices(x, loads.group(name)).values()))
        shown = np.degrees(x) if unit == 'rad' else x
        for values, style, text in ((loads.given, '--', 'before'), (numbers, '-', 'after')):
            parts = matrices @ values
            size = parts[0] if len(parts) == 1 else np.linalg.norm(parts, axis=0)
            axis.plot(shown, size, style, color='0.5' if text == 'before' else 'C0', label=text)
        axis.set(title=_title(loads, name), xlabel='input [deg]' if unit == 'rad'
                 else 'input [m]', ylabel=f'[{unit_of(loads, name)}]')
        axis.grid(alpha=0.3)
    axes[0].legend()
    _save(figure, path)


def _title(loads: Loads, name: str) -> str:
    field = loads.group(name)[0].removesuffix('_x').replace('_', ' ')
    return field + (' about O1' if name == 'moment' else '')


def draw_front(loads: Loads, names: Sequence[str], found: Sequence[Balance],
               path: str | Path) -> None:
    """Draw what remains over the added mass."""
    pyplot = _pyplot()
    figure, axis = pyplot.subplots(figsize=(6, 4), layout='constrained')
    start = found[0].value or 1.0
    axis.plot([one.added for one in found], [100.0 * one.value / start for one in found], '-')
    axis.set(xlabel='added mass [kg]', ylabel=f'RMS of {" and ".join(names)}, unbalanced = 100 %',
             ylim=(0.0, 105.0))
    axis.grid(alpha=0.3)
    _save(figure, path)


def _pyplot() -> ModuleType:
    import matplotlib
    matplotlib.use('Agg')
    from matplotlib import pyplot
    matplotlib.rcParams['svg.hashsalt'] = 'fourbar'
    found: ModuleType = pyplot
    return found


def _save(figure: Figure, path: str | Path) -> None:
    metadata = {'Date': None} if str(path).endswith('.svg') else None
    figure.savefig(path, dpi=120, metadata=metadata)
    _pyplot().close(figure)
