# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Scenes as figures and frames: of ``fourbar draw``, ``plot`` and ``table``, and of a notebook.

What an argument of a verb may be, a number or a text with its unit, an option of these may be too.
"""
from __future__ import annotations

from argparse import ArgumentTypeError
from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple, TYPE_CHECKING

from fourbar_lab.drawing import axis, curves, cycles, figure, poses, tables
from fourbar_ros import Mechanism
from fourbar_ros.errors import InvalidParameter
from fourbar_ros.mechanisms import quantities
from fourbar_ros.notebook import html_table
from fourbar_ros.numerics.arguments import finite
from fourbar_ros.scene import parameters
from fourbar_ros.scene.scene import Scene
from fourbar_ros.scene.units import quantity, require, wanted_units, WrongQuantity
import numpy as np

if TYPE_CHECKING:      # figures and frames alone need them
    from fourbar_lab.drawing.paper import PaperFigure
    from fourbar_ros.dynamics.run import Run
    from pandas import DataFrame

Option = float | str | None      # a number, or a text with a unit
Units = str | Sequence[str] | dict[str, str]      # 'mm,kN', a list, or what --units gives
PICTURE = 4.0, 3.0              # [inch] of a mechanism in a notebook
POINTS = 721                    # of a run's curve, besides its steps


class DrivenLinkage(NamedTuple):
    """A linkage in the mode asked for, rate and acceleration of its input [SI], and an input."""

    linkage: Mechanism
    rate: float
    acceleration: float
    at: float | None        # [deg or m]


def value_of(name: str, option: Option, unit: str) -> float | None:
    """Return an option in this SI unit, an angle in degrees; InvalidParameter, WrongQuantity."""
    if isinstance(option, str):
        try:
            return quantity(option, unit, plain_angle='deg')
        except WrongQuantity as error:
            raise InvalidParameter(name, option, str(error)) from None
    if option is not None:
        finite(name, option)
        require(name, option, unit)
    return option


def driven_linkage(scene: Scene, speed: Option, acceleration: Option, mode: int | None,
                   at: Option = None) -> DrivenLinkage:
    linkage, units = scene.in_mode(mode), scene.linkage.input_coordinate.units
    at, rate, change = [value_of(*option) for option in zip(
        ('at', 'speed', 'acceleration'), (at, speed, acceleration), units)]
    return DrivenLinkage(linkage, scene.drive.speed if rate is None else rate, change or 0.0, at)


def draw(scene: Scene, at: Option = None, over: str = '', speed: Option = None,
         acceleration: Option = 0.0, mode: int | None = None, title: str | None = None,
         width: Option = None) -> PaperFigure:
    """
    Return the figure of a pose with forces and polygons, or of curves over a cycle.

    ``at``: the input, in degrees or [m], or with a unit; ``over``: 'linkage', which is drawn
    alone, 'paths' of the points, 'forces' on the ground, the collineation 'axis'; ``speed`` [rad/s
    or m/s]: default drive.speed of the scene; ``width`` [m]: of the picture, as '88mm'.
    """
    linkage, rate, change, user_input = driven_linkage(scene, speed, acceleration, mode, at)
    points, paper = scene.points, figure.paper_of(value_of('width', width, 'm'), title)
    if over == 'axis':
        return axis.make_axis_figure(linkage, rate, None if user_input is None else
                                     poses.position_of(linkage, user_input), paper)
    if over == 'forces':
        if at is not None:
            raise InvalidParameter('at', at, 'is one input, and the forces are those of a cycle')
        return cycles.make_forces_figure(linkage, rate, change, paper)
    if over not in ('', 'linkage', 'paths'):
        raise InvalidParameter('over', over, "must be 'linkage', 'paths', 'forces' or 'axis'")
    if user_input is None and not over:
        raise InvalidParameter('at', None, 'must be given, or over')
    usual = linkage.description
    if user_input is not None:
        unit = 'm' if linkage.is_driven_by_slide else 'deg'
        usual += f'\n{linkage.input_coordinate.position} {user_input:.8g} {unit}'
    if over:
        motion = (linkage.motion(cycles.usual_input(linkage)) if user_input is None else
                  poses.evaluate_at(linkage, user_input, 0.0, 0.0).motion)
        if over == 'linkage':
            usual += f', assembly mode {linkage.modes[linkage.mode]}'
            return cycles.make_linkage_figure(linkage, motion, points, (), usual, paper)
        moving = cycles.usual_points(linkage, points)
        return cycles.make_linkage_figure(
            linkage, motion, moving, cycles.paths_of(linkage, moving),
            f'paths over a cycle: {linkage.description}', paper)
    assert user_input is not None
    usual += (f', {tables.rates_in_words(linkage, rate, change, ", ")}, '
              f'assembly mode {linkage.modes[linkage.mode]}')
    pose = poses.evaluate_at(linkage, user_input, rate, change, at_toggles=False)
    return figure.make_figure(linkage, pose.motion, pose.loads, usual, points, paper=paper)


def plot(scene: Scene, *names: str, speed: Option = None, acceleration: Option = 0.0,
         mode: int | None = None, samples: int = 361, units: Units = '',
         title: str | None = None, width: Option = None) -> PaperFigure:
    """
    Return the figure of quantities over the input, with their extrema, as :func:`draw`.

    No names: all but components, which would crowd a picture. ``units``: to show, as 'mm,kN'.
    """
    linkage, rate, change, _ = driven_linkage(scene, speed, acceleration, mode)
    shown, paper = shown_units(units), figure.paper_of(value_of('width', width, 'm'), title)
    wanted = names or [quantity.name for quantity in quantities.select(
        (), linkage, scene.point_quantities)]
    lines = curves.curves_of(scene, linkage, wanted, rate, change, samples, shown, True)
    if scene.name:
        lines = lines._replace(title=f'{scene.name}: {lines.title}')
    extrema = curves.extrema_of(scene, linkage, wanted, rate, change)
    marks = curves.marks_of(linkage, extrema, shown)
    return curves.make_figure(lines, marks, paper)


def table(scene: Scene, *names: str, speed: Option = None, acceleration: Option = 0.0,
          mode: int | None = None, samples: int = 361, units: Units = '',
          speeds: Sequence[Option] = ()) -> DataFrame:
    """Return :func:`columns` as a frame of pandas: a column for each quantity, with its unit."""
    import pandas
    heads, rows = curves.rows_of(columns(
        scene, names, driven_linkage(scene, speed, acceleration, mode)[:3], samples, units,
        speeds))
    return pandas.DataFrame(rows, columns=heads)


def columns(scene: Scene, names: Sequence[str], driven: tuple[Mechanism, float, float],
            samples: int, units: Units, speeds: Sequence[Option]) -> curves.Curves:
    """Return quantities over the input, or of the drive over ``speeds`` (low, high)."""
    linkage, rate, change = driven
    shown = shown_units(units)
    if not speeds:
        return curves.curves_of(scene, linkage, names, rate, change, samples, shown)
    if names:
        raise InvalidParameter('speeds', None, f'cannot be combined with quantities '
                               f'({", ".join(map(str, names))}): it tabulates the drive')
    ends = [value_of('speeds', speed, f'{linkage.input_coordinate.unit}/s') for speed in speeds
            ] if isinstance(speeds, Sequence) and not isinstance(speeds, str) else []
    if len(ends) != 2 or ends[0] is None or ends[1] is None:
        raise InvalidParameter('speeds', speeds, 'must be the lowest and the highest')
    return curves.envelope_of(linkage, (ends[0], ends[1]), change, shown)


def shown_units(wanted: Units) -> dict[str, str]:
    """Return {SI unit: unit shown} of 'mm,kN' or a list, angles in degrees if it has no other."""
    try:
        words = wanted.values() if isinstance(wanted, dict) else wanted
        text = words if isinstance(words, str) else ','.join(words)
        return curves.UNITS | (wanted_units(text) if text else {})
    except TypeError:
        raise InvalidParameter('units', wanted, "must be a text as 'mm,kN', or a list") from None
    except ArgumentTypeError as error:
        raise InvalidParameter('units', wanted, str(error)) from None


def plot_run(run: Run) -> PaperFigure:
    """Return a figure of position, rate, acceleration and drive of a run over time."""
    unit = run.system.mechanism.input_coordinate.unit
    # the steps of the integrator lie too far apart for a smooth line
    run = replace(run, asked=np.union1d(run.time, np.linspace(0.0, run.time[-1], POINTS)))
    rows = {f'position [{unit}]': run.position, f'rate [{unit}/s]': run.rate,
            f'acceleration [{unit}/s²]': run.acceleration}
    if run.system.drive:
        rows[f'drive [{"N" if unit == "m" else "N m"}]'] = run.torque
    return figure.make_panels({text: [('', run.time, values)] for text, values in rows.items()},
                              'time [s]', f'run: {run.system.mechanism.description}')


def html(shown: Scene | Mechanism) -> str:
    """Return a mechanism, or that of a scene, as HTML: a picture of it and a table of facts."""
    linkage, points = (shown.linkage, shown.points) if isinstance(shown, Scene) else (shown, {})
    drawn_at, coordinate = cycles.usual_input(linkage), linkage.input_coordinate
    drawing = cycles.make_linkage_figure(linkage, linkage.motion(drawn_at), points, size=PICTURE)
    drawn = 'drawn at', f'{coordinate.position} {poses.shown(coordinate, drawn_at)}'
    parts = [drawing._repr_svg_(), html_table(('', ''), [drawn, *tables.facts(linkage)])]
    if isinstance(shown, Scene):
        values = {name: shown.values[name] for name in ('gravity.x', 'gravity.y')}
        values |= parameters.without_defaults(shown.values)
        described = [(name, value, parameters.of_name(name)) for name, value in values.items()]
        parts = [html_table(('scene', shown.name), ()), *parts, html_table(
            ('parameter', 'value', 'unit', 'meaning'),
            [(name, f'{value:.10g}' if isinstance(value, float) else value,
              parameters.shown_unit(name, shown.values), parameter.text)
             for name, value, parameter in described])]
    return ''.join(parts)
