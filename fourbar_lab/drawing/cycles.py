# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Paths of points and the forces on the ground over a cycle, as curves of vectors.

Only the functions that draw import matplotlib.
"""
from __future__ import annotations

from collections.abc import Sequence
from math import lcm, tau
from typing import TYPE_CHECKING

from fourbar_lab.drawing.figure import CannotDraw, CURVES, new_figure, Paper
from fourbar_lab.drawing.labels import labels_of
from fourbar_lab.drawing.mechanism_panel import draw_mechanism
from fourbar_ros import Mechanism, point_motion
from fourbar_ros.mechanisms.parts import NamedFields
from fourbar_ros.mechanisms.picture import diagram_of, Points
from fourbar_ros.numerics.arrays import Array
import numpy as np

if TYPE_CHECKING:      # drawings alone need it
    from fourbar_lab.drawing.paper import PaperFigure as Figure

SAMPLES = 721
WITHIN = 1e-9        # share of a range left out at ends in toggles, where rates are unbounded
SHARE = 0.2          # of the range of the input: where the mechanism is drawn beside its paths
OUTLIER = 30.0       # vectors longer than so many times the median one are not drawn


def cycles(mechanism: Mechanism, count: int = SAMPLES, from_zero: bool = False,
           turns: int = 1) -> list[Array]:
    """
    Return inputs over each range of a mechanism, arrays of shape (count,) [rad] or [m].

    Full turns follow each other, ``count`` inputs in each, until all repeats, with forces after
    ``turns``; ``from_zero``: they begin at 0, where extrema are counted from.
    """
    if mechanism.turns_fully:
        turns = lcm(turns, round(mechanism.period / tau))
        first = 0.0 if from_zero else -180.0 * turns
        return [np.radians(np.linspace(first, first + 360.0 * turns, turns * (count - 1) + 1))]
    inputs = []
    for low, high in mechanism.input_ranges:
        margin = WITHIN * (high - low) if mechanism.toggles else 0.0
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


def usual_input(mechanism: Mechanism) -> float:
    """Return the input [rad or m] at which a mechanism is drawn where none is asked for."""
    low, high = mechanism.input_ranges[0]
    return low + SHARE * (high - low)


def paths_of(mechanism: Mechanism, points: Points, count: int = SAMPLES) -> list[Array]:
    """Return the path (n, 2) [m] of each point in each range; CannotDraw without a point."""
    if not points:
        raise CannotDraw('no point to draw: give points.NAME.link, .along, .across')
    return [point_motion(mechanism, mechanism.motion(inputs), *point).place
            for point in points.values() for inputs in cycles(mechanism, count)]


def make_linkage_figure(mechanism: Mechanism, motion: NamedFields, points: Points,
                        paths: Sequence[Array] = (), title: str = '', paper: Paper = Paper(),
                        size: tuple[float, float] = (7.0, 7.0)) -> Figure:
    """Return a figure of a mechanism in a pose, without forces; ``size``: usual one [inch]."""
    with new_figure(*size, paper) as figure:
        title = figure.title_of(title, paper.title)
        axes = figure.add_axes((0.0, 0.0, 1.0, 0.94 if title else 1.0))
        sheet = draw_mechanism(axes, mechanism, motion, points, paths, title=title)
        sheet.crop()
        sheet.scale('m')
        sheet.finish()
    return figure


def make_forces_figure(linkage: Mechanism, speed: float, acceleration: float = 0.0,
                       paper: Paper = Paper()) -> Figure:
    """Return a figure of the forces on the ground over a cycle; CannotDraw without masses."""
    if not linkage.has_loads:
        raise CannotDraw('forces need masses: see bodies.* in docs/reference_desk.md')
    steps = [linkage.loads(inputs, speed, acceleration)
             for inputs in cycles(linkage, from_zero=linkage.turns > 1, turns=linkage.turns)]
    diagram = diagram_of(linkage, linkage.motion(usual_input(linkage)))     # for its joints
    symbols = labels_of(diagram).forces
    names = {'shaking_force': 'shaking force',
             **{name: f'${symbols[name]}$' for name, joint in diagram.forces.items()
                if joint in diagram.ground}}
    with new_figure(7.0, 7.0, paper, layout='constrained') as figure:
        axes = figure.subplots()
        axes.set_prop_cycle(**CURVES)
        for name, text in names.items():
            curves = [_bounded(np.stack([getattr(step, f'{name}_{axis}') for axis in 'xy'],
                                        axis=-1)) for step in steps]      # one for each range
            line, = axes.plot(*curves[0].T, label=text)
            for curve in curves[1:]:
                axes.plot(*curve.T, color=line.get_color(), ls=line.get_linestyle())
        axes.axhline(0.0, color='0.6', lw=0.7)
        axes.axvline(0.0, color='0.6', lw=0.7)
        axes.set_aspect('equal', adjustable='datalim')
        axes.set(xlabel='x [N]', ylabel='y [N]',
                 title=figure.title_of(f'forces over a cycle: {linkage.description}',
                                       paper.title))
        axes.legend()
    return figure


def _bounded(vectors: Array) -> Array:
    """Return vectors (n, 2) with outliers as NaN: near a toggle they would dwarf the rest."""
    size = np.hypot(*vectors.T)
    median = float(np.nanmedian(size))
    bound = OUTLIER * median if median != 0.0 else np.inf
    return np.where((size <= bound)[:, None], vectors, np.nan)
