# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Quantities over the input of a mechanism, as a table with a row for each input, or a figure."""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import nullcontext
from math import inf, isfinite, tau
from pathlib import Path
from typing import NamedTuple, TYPE_CHECKING

from fourbar_lab.drawing.cycles import cycles
from fourbar_lab.drawing.figure import CannotDraw, make_panels, Paper, writing
from fourbar_lab.drawing.labels import symbols_of
from fourbar_lab.drawing.record import inputs_of
from fourbar_lab.drawing.tables import rates_in_words
from fourbar_ros import InvalidParameter, Mechanism
from fourbar_ros.extrema.find import CONSTANT, Extremum, find_extrema
from fourbar_ros.extrema.over_input import OverInput
from fourbar_ros.extrema.sampling import whole_turns
from fourbar_ros.mechanisms import parts, quantities
from fourbar_ros.mechanisms.pieces import BESIDE, with_friction
from fourbar_ros.numerics.arguments import NumberField
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.scene.units import in_unit, require_columns, units_of
from fourbar_ros.spreadsheet import CsvStyle, STDOUT
import numpy as np

if TYPE_CHECKING:
    from fourbar_lab.drawing.paper import PaperFigure as Figure
    from fourbar_ros.scene.scene import Scene

# what a vertical axis of a unit shows
AXES = {unit: name for si, name in (
    ('rad', 'angle'), ('rad/s', 'angular velocity'), ('rad/s^2', 'angular acceleration'),
    ('m', 'position'), ('m/s', 'velocity'), ('m/s^2', 'acceleration'), ('N', 'force'),
    ('N m', 'torque, moment'), ('W', 'power'), ('kg m^2', 'inertia'), ('kg', 'inertia'),
    ('', 'ratio'), ('N/(N m)', 'ratio'), ('N m/N', 'ratio')) for unit in units_of(si)}
SPEEDS = 25         # in a table over the speed
MISSED = 1e-6       # of the largest value: a peak between rows that is higher by less is none
UNITS = {'rad': 'deg'}              # {SI unit: unit shown}
NEAR, FAR = 10.0, 30.0      # a curve beyond FAR times its median size is cut off at NEAR times


class Curves(NamedTuple):
    """Quantities over the input: columns, the first is the input."""

    title: str
    names: tuple[str, ...]
    units: tuple[str, ...]
    values: Array               # (columns, rows); a row of NaN between two ranges of the input
    symbols: tuple[str, ...]    # of the columns, as in pictures: mathtext
    period: float = inf         # of an input that turns fully, in its unit


def curves_of(scene: Scene, linkage: Mechanism, names: Sequence[str], speed: float,
              acceleration: float = 0.0, samples: int = 361,
              shown_units: Mapping[str, str] = UNITS, with_jumps: bool = False) -> Curves:
    """
    Return quantities of a scene over all ranges of its input, at one speed and acceleration.

    ``names``: fields of motion or loads, NAME.x, .y, .speed, .acceleration of the scene's points,
    or those of :func:`.of_drive`; empty: all but these, loads only with masses. ``linkage`` is the
    scene's in the assembly mode wanted; ``samples`` are the inputs in each range;
    ``shown_units``: {SI unit: unit of the columns that measure the same}; ``with_jumps``: besides
    two inputs, just below and above, wherever loads may jump. UnknownQuantity, with the nearest
    name; InvalidParameter for a load without masses, or if a quantity overflows.
    """
    samples = NumberField(above=0.0, is_whole=True).check('samples', samples)
    units, coordinate = _units(linkage, scene), linkage.input_coordinate
    of_loads, of_drive = linkage.LOADS._fields, quantities.of_drive(linkage, linkage.input)
    of_points = {quantity.name: quantity for quantity in scene.point_quantities}
    for name in names:
        if not isinstance(name, str):
            raise InvalidParameter('names', name, "must be texts, one after another: 'f41', 'f32'")
        if name not in units and name != coordinate.position:
            raise quantities.UnknownQuantity(name, units)
    wanted = [name for name in dict.fromkeys(names) if name != coordinate.position]
    if names and not wanted:
        raise InvalidParameter('names', coordinate.position, 'is the input, over which all else '
                               'is given: name a quantity')
    wanted = wanted or [name for name in units if name not in of_drive
                        and (name not in of_loads or linkage.has_loads)]
    loads_wanted = [name for name in wanted
                    if name in of_loads or name in of_drive and of_drive[name].is_load]
    if loads_wanted and not linkage.has_loads:
        raise InvalidParameter(loads_wanted[0], None, linkage.why_no_loads)

    def values_of(name: str, inputs: Array, motion: parts.NamedFields,
                  loads: parts.NamedFields | None) -> Array:
        if name in of_points:
            return np.asarray(of_points[name].of(motion, loads))
        if name in of_drive:
            return of_drive[name].values(linkage, inputs, speed)
        return np.asarray(getattr(loads if name in of_loads else motion, name))

    ends = (() if not (with_jumps and loads_wanted) else
            with_friction(linkage, (speed, acceleration)).ends if linkage.friction else
            linkage.pieces.ends if linkage.pieces else ())
    blocks: list[Array] = []
    for inputs in cycles(linkage, samples, True, linkage.turns if loads_wanted else 1):
        if ends:
            low, width = inputs[0], inputs[-1] - inputs[0]
            turns = np.arange(-1.0, width / linkage.cycle + 1.0) if linkage.turns_fully else [0.0]
            sides = np.add.outer(np.add.outer(ends, np.multiply(turns, tau * linkage.turns)),
                                 [-BESIDE * width, BESIDE * width])
            inputs = np.union1d(inputs, sides[(sides > low) & (sides < inputs[-1])])
        motion = linkage.motion(inputs, speed, acceleration)
        loads = linkage.loads(inputs, speed, acceleration) if loads_wanted else None
        rows = [inputs, *(values_of(name, inputs, motion, loads) for name in wanted)]
        gap = [np.full((len(rows), 1), np.nan)] if blocks else []
        blocks += [*gap, np.array([np.broadcast_to(row, inputs.shape) for row in rows])]
    values = np.concatenate(blocks, axis=1)
    columns = coordinate.position, *wanted
    for name, column in zip(columns, values):
        if not np.isfinite(column).any():
            if name == 'mechanical_advantage':          # at unit rate, whatever the speed
                raise InvalidParameter(name, inf, 'the output stands still at every input')
            raise InvalidParameter('speed', speed, f'too large: {name} overflows')
    rates = rates_in_words(linkage, speed, acceleration, ', ')
    curves = _in_units(Curves(
        f'{linkage.description} at {rates}', columns,
        (coordinate.unit, *(units[name] for name in wanted)), values,
        symbols_of(linkage, columns), linkage.cycle if linkage.turns_fully else inf),
        shown_units)
    if linkage.turns_fully and curves.units[0] == 'deg':
        curves.values[0] = curves.values[0].round(10)       # whole ones, for who looks up 60
    return curves


def _in_units(curves: Curves, shown_units: Mapping[str, str]) -> Curves:
    require_columns({si: unit for si, unit in shown_units.items() if UNITS.get(si) != unit},
                    curves.units)
    units = tuple(shown_units.get(unit, unit) for unit in curves.units)
    return curves._replace(units=units, values=np.array(
        [in_unit(*column) for column in zip(curves.values, curves.units, units)]),
        period=in_unit(curves.period, curves.units[0], units[0])
        if isfinite(curves.period) else inf)


def envelope_of(linkage: Mechanism, speeds: tuple[float, float], acceleration: float,
                shown_units: Mapping[str, str]) -> Curves:
    """Return the effort of the drive over the speed; InvalidParameter if it overflows."""
    unit = linkage.input_coordinate.unit
    force = 'N' if linkage.is_driven_by_slide else 'N m'
    steps = np.linspace(*speeds, SPEEDS).tolist()
    columns = 'speed', 'root_mean_square', 'peak', 'peak_power'
    rows = list[tuple[float, ...]]()
    for speed in steps:
        load = OverInput(linkage, linkage.drive_load, speed, acceleration)
        rows.append((speed, load.rms, load.peak, load.peak * abs(speed) if speed else 0.0))
    return _in_units(Curves(f'drive of {linkage.description}', columns,
                            (f'{unit}/s', force, force, 'W'), np.array(rows).T, columns),
                     shown_units)


def extrema_of(scene: Scene, linkage: Mechanism, names: Sequence[str], speed: float,
               acceleration: float = 0.0) -> list[Extremum]:
    """Return extrema as of :func:`curves_of`, none of components of forces, of loads that lock."""
    searched = quantities.by_name(linkage, scene.point_quantities)
    locks = linkage.locked_ranges(speed, acceleration)
    wanted = [searched[name] for name in names if name in searched
              and not (locks and searched[name].is_load)]
    return (find_extrema(linkage, wanted, speed, acceleration, conditions=False) if wanted
            else [])


def marks_of(linkage: Mechanism, extrema: Sequence[Extremum],
             shown_units: Mapping[str, str] = UNITS) -> list[tuple[Extremum, float, float]]:
    """Return (extremum, input, value) of the finite ones in all turns, in units of the curves."""
    def shown(value: float, unit: str) -> float:
        return float(in_unit(value, unit, shown_units.get(unit, unit)))
    return [(extremum, shown(x, linkage.input_coordinate.unit),
             shown(extremum.value, extremum.unit))
            for extremum in extrema if extremum.kind != CONSTANT and isfinite(extremum.value)
            for x in inputs_of(linkage, extremum)]


def _units(linkage: Mechanism, scene: Scene) -> dict[str, str]:
    """Return {name: unit} of all quantities that a user may name, components of forces too."""
    units = {name: quantity.unit
             for name, quantity in quantities.by_name(linkage, scene.point_quantities).items()}
    for part in linkage.PARTS:
        if part != linkage.input_coordinate:
            units |= {name: unit for name, unit in zip(part, part.units)
                      if name in linkage.MOTION._fields}
    for name in linkage.LOADS._fields:
        if name not in units and name.endswith(('_x', '_y')):
            units[name] = 'N'
    return units


def missed_peaks(curves: Curves, with_jumps: Curves) -> str:
    """Return a line on columns that are larger at a jump than in any row of a table, or ''."""
    missed = list[str]()
    for name, unit, column, closer in zip(*curves[1:4], with_jumps.values):
        peak = closer[at := np.nanargmax(np.abs(closer))]
        if abs(peak) > (1.0 + MISSED) * np.nanmax(np.abs(column)):
            missed.append(f'{name} {peak:.6g} {unit}'.rstrip()
                          + f' at {with_jumps.values[0, at]:.6g} {curves.units[0]}')
    more = f' and {len(missed) - 3} more' if len(missed) > 3 else ''
    return ('larger than in any row, beside a jump of the loads (see fourbar show): '
            f'{", ".join(missed[:3])}{more}' if missed else '')


def write_table(curves: Curves, path: Path, style: CsvStyle) -> None:
    """Write a table as CSV to a file, or ``-`` for standard output; CannotDraw if it cannot be."""
    if path != STDOUT and path.suffix != '.csv':
        raise CannotDraw(f'{path}: must end in .csv, which --excel writes for Excel, or be - for '
                         'standard output')
    with nullcontext() if path == STDOUT else writing(path):
        style.save(path, *rows_of(curves))


def rows_of(curves: Curves) -> tuple[list[str], list[list[float]]]:
    """Return a table as names with units, and a row for each input."""
    heads = [f'{name} [{unit}]' if unit else name
             for name, unit in zip(curves.names, curves.units)]
    # without gaps between ranges
    return heads, curves.values.T[np.isfinite(curves.values[0])].tolist()


def readable(values: Array, marked: Sequence[float]) -> Array:
    """Return the values of a curve, NaN where it grows without bound, far above all others."""
    sizes = np.abs(values)
    typical = float(np.nanmedian(sizes))
    bound = max([NEAR * typical, *(1.2 * abs(value) for value in marked)])
    if typical == 0.0 or np.nanmax(sizes) <= max(FAR * typical, bound):
        return values
    return np.where(sizes <= bound, values, np.nan)


def _going_on(curves: Curves) -> Curves:
    """Return curves whose angles go on where a sample comes round at half a turn, as extrema."""
    values = curves.values.copy()
    gaps = np.flatnonzero(np.isnan(values[0]))      # between ranges of the input
    for unit, column in zip(curves.units[1:], values[1:]):
        if unit not in units_of('rad'):
            continue
        turn = in_unit(tau, 'rad', unit)
        for angles in np.split(column, gaps):       # views
            known = np.isfinite(angles)
            if known.any():
                goes_on = np.unwrap(angles[known], period=turn)
                ends = tau / turn * goes_on.min(), tau / turn * goes_on.max()
                angles[known] = goes_on - turn * np.round(whole_turns(*ends) / tau)
    return curves._replace(values=values)


def make_figure(curves: Curves, marks: Sequence[tuple[Extremum, float, float]] = (),
                paper: Paper = Paper()) -> Figure:
    """
    Return a figure with one pair of axes for each unit, over the same input.

    ``marks``: of :func:`marks_of`; those in the turns that the curves show are drawn. A curve with
    marks is cut off beyond them where it grows without bound.
    """
    curves = _going_on(curves)
    low, high = np.nanmin(curves.values[0]), np.nanmax(curves.values[0])
    turns_fully = isfinite(curves.period)
    dots = [(extremum.quantity, x, value) for extremum, first, value in marks
            # on its side of a jump, so that one where a turn begins is not at both its ends
            for x in (np.arange(low + (first + 1e-9 * extremum.side - low) % curves.period,
                                high + 0.5e-9, curves.period) if turns_fully else [first])]
    marked = {name: [(x, value) for quantity, x, value in dots if quantity == name]
              for name in curves.names}
    inputs, *columns = curves.values
    panels: dict[str, list[tuple[str, Array, Array]]] = {}      # one for each unit
    names: dict[str, list[str]] = {}                            # of the curves in it
    for name, symbol, unit, values in zip(curves.names[1:], curves.symbols[1:], curves.units[1:],
                                          columns):
        text = AXES.get(unit, 'value') + (f' [{unit}]' if unit else '')
        if marked[name]:
            values = readable(values, [value for _, value in marked[name]])
        panels.setdefault(text, []).append((symbol, inputs, values))
        names.setdefault(text, []).append(name)
    figure = make_panels(panels, f'{curves.symbols[0]} [{curves.units[0]}]', curves.title, paper)
    for axis, of_panel in zip(figure.axes, names.values()):
        for line, name in zip(list(axis.lines), of_panel):
            if marked[name]:
                axis.plot(*zip(*marked[name]), 'o', color=line.get_color(),
                          markersize=0.36 * figure.style['font.size'])
    if curves.units[0] == 'deg' and high - low > 180.0:
        from matplotlib.ticker import MultipleLocator
        figure.axes[-1].xaxis.set_major_locator(MultipleLocator(90.0))
    return figure
