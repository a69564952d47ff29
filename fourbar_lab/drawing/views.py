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
from typing import TYPE_CHECKING

from fourbar_lab.drawing import axis, curves, cycles, figure, mechanism_panel, poses, tables
from fourbar_ros import Mechanism
from fourbar_ros.errors import InvalidParameter
from fourbar_ros.mechanisms import quantities
from fourbar_ros.notebook import html_table
from fourbar_ros.scene.scene import Scene
from fourbar_ros.scene.units import of, require, wanted_units
import numpy as np

if TYPE_CHECKING:      # figures and frames alone need them
    from fourbar_lab.drawing.paper import PaperFigure
    from fourbar_ros.dynamics.simulation import Run
    from pandas import DataFrame

Option = float | str | None      # a number, or a text with a unit
Units = str | Sequence[str] | dict[str, str]      # 'mm,kN', a list, or what --units gives
PICTURE = 4.0, 3.0              # [inch] of a mechanism in a notebook
POINTS = 721                    # of a run's curve, besides its steps


def value_of(name: str, option: Option, *si_units: str) -> float | None:
    """Return an option in SI, an angle in degrees; InvalidParameter."""
    if not isinstance(option, str):
        return option
    try:
        return of(*si_units)(option)
    except ArgumentTypeError as error:
        raise InvalidParameter(name, option, str(error)) from None


def driven_linkage(scene: Scene, speed: Option, acceleration: Option, mode: int | None,
                   at: Option = None) -> tuple[Mechanism, float, float]:
    """Return the linkage in a mode, rate and acceleration of its input; units are checked."""
    linkage, units = scene.in_mode(mode), scene.linkage.input_coordinate.units
    _, rate, change = values = [
        value_of(name, option, *si_units) for name, option, si_units in (
            ('at', at, ('rad', 'm')), ('speed', speed, ('rad/s', 'm/s')),
            ('acceleration', acceleration, ('rad/s^2', 'm/s^2')))]
    for name, value, unit in zip(('--at', '--speed', '--acceleration'), values, units):
        if value is not None:
            require(name, value, unit)
    return linkage, scene.drive.speed if rate is None else rate, change or 0.0


def paper_of(width: Option, title: str | None) -> figure.Paper:
    return figure.paper_of(value_of('width', width, 'm'), title)


def draw(scene: Scene, at: Option = None, over: str = '', speed: Option = None,
         acceleration: Option = 0.0, mode: int | None = None, title: str | None = None,
         width: Option = None) -> PaperFigure:
    """
    Return the figure of a pose with forces and polygons, or of curves over a cycle.

    ``at``: the input, in degrees or [m], or with a unit; ``over``: 'paths' of the points, 'forces'
    on the ground, the collineation 'axis'; ``speed`` [rad/s or m/s]: default drive.speed of the
    scene; ``width`` [m]: of the picture, as '88mm'.
    """
    linkage, rate, change = driven_linkage(scene, speed, acceleration, mode, at)
    user_input, paper = value_of('at', at, 'rad', 'm'), paper_of(width, title)
    if over == 'axis':
        return axis.make_axis_figure(linkage, rate, None if user_input is None else
                                     poses.position_of(linkage, user_input), paper)
    if over == 'paths':
        return cycles.make_paths_figure(linkage, scene.points, paper)
    if over == 'forces':
        return cycles.make_forces_figure(scene, linkage, rate, change, paper)
    if over:
        raise InvalidParameter('over', over, "must be 'paths', 'forces' or 'axis'")
    if user_input is None:
        raise InvalidParameter('at', None, 'must be given, or over')
    _, motion, loads = poses.step_at(linkage, user_input, rate, change)
    unit = 'm' if linkage.is_driven_by_slide else 'deg'
    usual = (f'{linkage.description}\n'
             f'{linkage.input_coordinate.position} {user_input:.8g} {unit}, '
             f'{tables.rates_in_words(linkage, rate, change, ", ")}, '
             f'assembly mode {tables.mode_name(linkage)}')
    return figure.make_figure(linkage, motion, loads, usual, scene.points, paper=paper)


def plot(scene: Scene, *names: str, speed: Option = None, acceleration: Option = 0.0,
         mode: int | None = None, samples: int = 361, units: Units = '',
         title: str | None = None, width: Option = None, name: str = '') -> PaperFigure:
    """
    Return the figure of quantities over the input, with their extrema, as :func:`draw`.

    No names: all but components, which would crowd a picture. ``units``: to show, as 'mm,kN';
    ``name``: of the scene, in the title.
    """
    linkage, rate, change = driven_linkage(scene, speed, acceleration, mode)
    shown, paper = shown_units(units), paper_of(width, title)
    wanted = names or [quantity.name for quantity in quantities.select(
        (), linkage, scene.point_quantities)]
    lines = curves.curves_of(scene, linkage, wanted, rate, change, samples, shown, True)
    if name:
        lines = lines._replace(title=f'{name}: {lines.title}')
    extrema = curves.extrema_of(scene, linkage, wanted, rate, change)
    marks = curves.marks_of(linkage, extrema, shown)
    return curves.make_figure(lines, marks, paper)


def table(scene: Scene, *names: str, speed: Option = None, acceleration: Option = 0.0,
          mode: int | None = None, samples: int = 361, units: Units = '',
          speeds: Sequence[Option] = ()) -> DataFrame:
    """Return :func:`columns` as a frame of pandas: a column for each quantity, with its unit."""
    import pandas
    heads, rows = curves.rows_of(columns(
        scene, names, driven_linkage(scene, speed, acceleration, mode), samples, units, speeds))
    return pandas.DataFrame(rows, columns=heads)


def columns(scene: Scene, names: Sequence[str], driven: tuple[Mechanism, float, float],
            samples: int, units: Units, speeds: Sequence[Option]) -> curves.Curves:
    """Return quantities over the input, or of the drive over ``speeds`` (low, high)."""
    linkage, rate, change = driven
    shown = shown_units(units)
    if not speeds:
        return curves.curves_of(scene, linkage, names, rate, change, samples, shown)
    if names:
        raise InvalidParameter('--speeds', None, 'cannot be combined with QUANTITY '
                               f'({", ".join(names)}): it tabulates the drive')
    if len(speeds) != 2:
        raise InvalidParameter('--speeds', [*speeds], 'must be the lowest and the highest')
    low, high = [value_of('speeds', speed, 'rad/s', 'm/s') or 0.0 for speed in speeds]
    for end in (low, high):
        require('--speeds', end, f'{linkage.input_coordinate.unit}/s')
    return curves.envelope_of(scene, linkage, (low, high), change, shown)


def shown_units(wanted: Units) -> dict[str, str]:
    """Return {SI unit: unit shown} of 'mm,kN' or a list, angles in degrees if it has no other."""
    words = wanted.values() if isinstance(wanted, dict) else wanted
    text = words if isinstance(words, str) else ','.join(words)
    try:
        return curves.UNITS | (wanted_units(text) if text else {})
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
                              'time [s]', '')


def html(shown: Scene | Mechanism) -> str:
    """Return a mechanism, or that of a scene, as HTML: a picture of it and a table of facts."""
    linkage, points = (shown.linkage, shown.points) if isinstance(shown, Scene) else (shown, {})
    rows = tables.facts(linkage)
    if isinstance(shown, Scene):
        rows += [('speed', tables.rates_in_words(linkage, shown.drive.speed)),
                 ('outputs', ', '.join(shown.outputs))]
    low, high = linkage.input_ranges[0]
    with figure.new_figure(*PICTURE) as drawing:
        axes = drawing.add_axes((0.0, 0.0, 1.0, 1.0))
        sheet = mechanism_panel.draw_mechanism(
            axes, linkage, linkage.motion(low + cycles.SHARE * (high - low)), points)
        sheet.scale('m')
        sheet.finish()
    return drawing._repr_svg_() + html_table(('', ''), rows)
