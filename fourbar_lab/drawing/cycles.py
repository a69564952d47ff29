# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Paths of points and the forces on the ground over a cycle, as curves of vectors.

Only the functions that draw import matplotlib.
"""
from __future__ import annotations

from collections.abc import Callable
import re
from types import MappingProxyType
from typing import Any, TYPE_CHECKING

from fourbar_lab.drawing.figure import CannotDraw, new_figure
from fourbar_lab.drawing.labels import labels_of
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.parts import NamedFields
from fourbar_ros.mechanisms.picture import diagram_of, Points
from fourbar_ros.mechanisms.points import point_motion
from fourbar_ros.numerics.arrays import Array
import numpy as np

if TYPE_CHECKING:      # drawings alone need it
    from matplotlib.figure import Figure

SAMPLES = 721
WITHIN = 1e-9        # share of a range left out at ends in toggles, where rates are unbounded
OUTLIER = 30.0       # vectors longer than so many times the median one are not drawn


def cycles(mechanism: Mechanism, count: int = SAMPLES, from_zero: bool = False,
           turns: int = 1) -> list[Array]:
    """
    Return inputs over each range of a mechanism, arrays of shape (count,) [rad] or [m].

    ``from_zero``: full turns begin at 0, where extrema are counted from, not at -pi; ``turns`` of
    them follow each other, ``count`` inputs in each.
    """
    if from_zero and mechanism.turns_fully:
        return [np.radians(np.linspace(0.0, 360.0 * turns, turns * (count - 1) + 1))]
    inputs = []
    for low, high in mechanism.input_ranges:
        margin = 0.0 if mechanism.turns_fully else WITHIN * (high - low)
        inputs.append(np.linspace(low + margin, high - margin, count))
    return inputs


def usual_points(mechanism: Mechanism, points: Points) -> Points:
    """Return the points of a scene, or if it has none, the middle of the coupler."""
    if points:
        return points
    for link in mechanism.LINKS:
        if link.length and not link.first_joint.startswith('O'):     # O1, O4 are on the ground
            lengths = dict(zip(mechanism.length_names, mechanism.lengths))
            return {'middle': (link.name, 0.5 * lengths[link.length], 0.0)}
    return {}


def ground_forces(mechanism: Mechanism) -> dict[str, str]:
    """Return {field of the loads: symbol as text} of the forces at the joints of the ground."""
    low, high = mechanism.input_ranges[0]        # any pose will do: the joints are the same
    diagram = diagram_of(mechanism, mechanism.motion(0.5 * (low + high), 1.0))
    symbols = labels_of(diagram).forces
    return {name: re.sub('[_{}]', '', symbols[name]) for name, joint in diagram.forces.items()
            if joint in diagram.ground}


def make_cycle_figure(what: str, mechanism: Mechanism, rate: float, acceleration: float = 0.0,
                      points: Points = MappingProxyType({}),
                      loads: Callable[..., NamedFields] | None = None, turns: int = 1) -> Figure:
    """
    Return a matplotlib Figure of curves over all ranges of the input.

    ``what``: 'paths' of the points [m], or 'forces' on the ground [N] at ``rate`` and
    ``acceleration`` of the input [rad or m, per s and s^2]. ``points``: {name: (link, along,
    across)}; ``loads`` of a scene, by default those of the mechanism alone, which repeat after so
    many ``turns``. CannotDraw without point or masses.
    """
    curves, unit = ((_of_forces(mechanism, (rate, acceleration), loads, turns), 'N')
                    if what == 'forces' else (_paths(mechanism, points), 'm'))
    with new_figure(figsize=(7.0, 7.0), layout='constrained') as figure:
        axes = figure.subplots()
        for name, parts in curves.items():
            colour = axes.plot([], [], label=name)[0].get_color()
            for part in parts:
                axes.plot(*part.T, color=colour, lw=1.6)
        if what == 'forces':
            axes.axhline(0.0, color='0.6', lw=0.7)
            axes.axvline(0.0, color='0.6', lw=0.7)
        axes.set_aspect('equal', adjustable='datalim')
        axes.set(xlabel=f'x [{unit}]', ylabel=f'y [{unit}]',
                 title=f'{what} over a cycle: {mechanism.description}')
        axes.legend()
    return figure


def _of_forces(mechanism: Mechanism, rates: tuple[float, float],
               loads: Callable[..., NamedFields] | None, turns: int) -> dict[str, list[Array]]:
    """Return {name: curves, one for each range of the input, shape (n, 2)} of forces [N]."""
    if loads is None and mechanism.bodies is None:
        raise CannotDraw('forces need masses: see bodies.* in docs/reference.md')
    steps = [(loads or mechanism.loads)(inputs, *rates)
             for inputs in cycles(mechanism, from_zero=turns > 1, turns=turns)]
    names = {'shaking_force': 'shaking force'} | ground_forces(mechanism)
    return {text: [bounded(vectors_of(step, name)) for step in steps]
            for name, text in names.items()}


def _paths(mechanism: Mechanism, points: Points) -> dict[str, list[Array]]:
    """Return {name: curves, one for each range of the input, shape (n, 2)} of points [m]."""
    points = usual_points(mechanism, points)
    if not points:
        raise CannotDraw('no point to draw: give points.NAME.link, .along, .across')
    motions = [mechanism.motion(inputs) for inputs in cycles(mechanism)]
    return {name: [point_motion(mechanism, motion, *point).place for motion in motions]
            for name, point in points.items()}


def vectors_of(loads: Any, name: str) -> Array:
    """Return a force of loads in n poses, shape (n, 2), or in one [N]."""
    return np.stack([getattr(loads, f'{name}_{axis}') for axis in 'xy'], axis=-1)


def bounded(vectors: Array) -> Array:
    """Return vectors (n, 2) with outliers as NaN: near a toggle they would dwarf the rest."""
    size = np.hypot(*vectors.T)
    bound = OUTLIER * float(np.nanmedian(size)) or np.inf
    return np.where((size <= bound)[:, None], vectors, np.nan)
