# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Tables of a linkage's properties and of extrema; words for class, mode and units."""
from __future__ import annotations

from collections.abc import Sequence
from math import degrees, isfinite, pi, tau
from operator import attrgetter
from typing import NamedTuple

from fourbar_lab.drawing.mobility import mobility_rows
from fourbar_lab.drawing.poses import in_degrees, number, shown
from fourbar_ros.extrema.find import CONSTANT, Extremum, find_extrema
from fourbar_ros.mechanics.bodies import Base, field_of
from fourbar_ros.mechanisms.inertia import mean_rigid, middles
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.parts import Coordinate
from fourbar_ros.mechanisms.quantities import positions
from fourbar_ros.terminal import make_table
import numpy as np
from rich.table import Table

SAMPLES = 721
END = 1e-14                         # step inside from an end of the input, in its unit
FULL_TURN = tau * (1.0 - 1e-9)      # [rad] ranges from this width on are called full turns
ANGLE = 'transmission_angle'
NO_WEIGHT = 'weight', 'left out (gravity 0)'         # name and text of a row
SIDES = {0: '', 1: 'from above', -1: 'from below'}      # how an end of the range is approached


def mode_name(linkage: Mechanism) -> str:
    """Return the assembly mode as text."""
    return linkage.modes[linkage.mode]


def rate_unit(linkage: Mechanism) -> str:
    """Return the unit of the input's rate."""
    return f'{linkage.input_coordinate.unit}/s'


def _ranges(coordinate: Coordinate, ranges: Sequence[tuple[float, float]]) -> str:
    """Return ranges [rad or m] as text: 'theta1: 30.0000 to 60.0000 deg'."""
    name, unit = coordinate.position, 'm' if coordinate.unit == 'm' else 'deg'
    if unit == 'deg' and any(high - low >= FULL_TURN for low, high in ranges):
        return f'{name}: full turns'
    ends = [[shown(coordinate, end).split()[0] for end in bounds] for bounds in ranges]
    return f'{name}: {", ".join(map(" to ".join, ends))} {unit}'


def output_ranges(linkage: Mechanism, coordinate: Coordinate | None = None
                  ) -> list[tuple[float, float]]:
    """
    Return the range [rad or m] of an output in the mode of a linkage, for each range of its input.

    It is extreme at dead points, where it turns back, and at ends of the input; samples between
    them tell whole turns. ``coordinate``: by default that of the first output.
    """
    coordinate = coordinate or linkage.outputs[0].coordinate
    ranges = []
    for low, high in linkage.input_ranges:
        dead = [point[0] + turn for point in linkage.dead_points for turn in (-tau, 0.0, tau)]
        inputs = np.sort([*np.linspace(low, high, SAMPLES), *(x for x in dead if low < x < high)])
        # at an end in a toggle the motion itself may be NaN
        inputs[0] += END * linkage.input_unit
        inputs[-1] -= END * linkage.input_unit
        positions, = linkage.motion(inputs, fields=(coordinate.position,))
        if coordinate.unit == 'rad':
            positions = np.unwrap(positions)
            positions = positions - tau * round(0.5 * (positions.min() + positions.max()) / tau)
        ranges.append((positions.min(), positions.max()))
    return sorted(ranges)


def known_output_ranges(linkage: Mechanism
                        ) -> list[tuple[Coordinate, Sequence[tuple[float, float]], bool]]:
    """
    Return (output, its ranges, whether these cover both modes) for each output.

    At a change point the modes meet, and the linkage can go from one into the other.
    """
    if linkage.change_point_margin > 0.0:
        return [(coordinate, output_ranges(linkage, coordinate), False)
                for coordinate, _ in linkage.outputs]
    both = linkage.ranges_of_both_modes
    return [(coordinate, both[coordinate.position], True)
            for coordinate, _ in linkage.outputs if coordinate.position in both]


def what_it_is(linkage: Mechanism, scene: object) -> Table:
    """Return the table of a linkage's own properties; ``scene``: its file."""
    return make_table('', ('', ''), [('scene', str(scene)), *facts(linkage),
                                     *mobility_rows(linkage)])


def facts(linkage: Mechanism) -> list[tuple[str, str]]:
    """Return rows (name, text) of a linkage's own properties: lengths, class, limits, masses."""
    driven = linkage.input_coordinate
    lengths = [f'{name} {length:g}' for name, length in zip(linkage.length_names, linkage.lengths)]
    rows = [('lengths', '  '.join([*lengths, 'm'])),
            ('class', linkage.description), ('assembly mode', mode_name(linkage)),
            ('input', _ranges(driven, linkage.input_ranges))]
    rows += [('output', _ranges(coordinate, ranges)
              + (', in both modes: they meet' if of_both else ', in this mode'))
             for coordinate, ranges, of_both in known_output_ranges(linkage)]
    coordinates = driven, *(output.coordinate for output in linkage.outputs)
    for point in linkage.dead_points:
        values = counted(linkage, point[0]), *point[1:]
        texts = [f'{coordinate.position} {shown(coordinate, value)}'
                 for coordinate, value in zip(coordinates, values)]
        kind = ''
        if hasattr(point, 'stretched'):
            kind = ', stretched' if point.stretched else ', folded'
        rows.append((f'dead point{kind}', ', '.join(texts)))
    margin = 'of the perimeter'
    if hasattr(linkage, 'stages'):
        unit = f'of {linkage.input_unit:g} m' if linkage.is_driven_by_slide else 'rad'
        margin = f'{unit}; the nearer to 0, the faster the links pass their flat pose'
    toggles = [f'{shown(driven, end)}{_dyad_at(linkage, end)}' for end in toggles_of(linkage)]
    rows += [('toggle', f'{driven.position} {", ".join(toggles)}' if toggles
              else 'none within the range of the input'),
             *transmission_angles(linkage),
             ('change-point margin', f'{linkage.change_point_margin:.6g} {margin}')]
    if linkage.bodies:
        rows += [(name, f'{body.mass:.6g} kg, {body.inertia:.6g} kg m^2, CG at '
                        f'({body.cg_along:g}, {body.cg_across:g}) m'
                        if body.mass or body.inertia else 'no mass in the scene')
                 for name, body in linkage.bodies._asdict().items()]
        rows += [NO_WEIGHT] * (not any(field_of(linkage.gravity))
                               and not isinstance(linkage.gravity, Base))
        mean = mean_rigid(linkage)
        rows += [('inertia at the input', _inertia_in_words(linkage)),
                 ('held rigid, mean', f'{mean.mass:.6g} kg at ({mean.x:.6g}, {mean.y:.6g}) m, '
                                      f'{mean.inertia:.6g} kg m^2: base.carried')]
    return rows


class InputInertia(NamedTuple):
    """Least and largest inertia at the input, and its mean [kg m^2], of a driven slide [kg]."""

    least: Extremum
    most: Extremum
    mean: float


def inertia_of(linkage: Mechanism) -> InputInertia | None:
    """Return the inertia at the input; None where it is unbounded all over."""
    found = [one for one in find_extrema(linkage, 'inertia', conditions=False)
             if isfinite(one.value)]
    if not found:
        return None
    mean = np.mean([linkage.inertia(middles(low, high)) for low, high in linkage.input_ranges])
    return InputInertia(min(found, key=attrgetter('value')), max(found, key=attrgetter('value')),
                        float(mean))


def _inertia_in_words(linkage: Mechanism) -> str:
    """Return the least, largest and mean inertia at the input, for a motor, and where they are."""
    found, driven = inertia_of(linkage), linkage.input_coordinate
    if found is None:
        return 'unbounded at the ends of the input'
    return (f'{found.least.value:.6g} at {shown(driven, counted(linkage, found.least.input))} to '
            f'{found.most.value:.6g} {found.most.unit} at '
            f'{shown(driven, counted(linkage, found.most.input))}, mean {found.mean:.6g}')


def toggles_of(linkage: Mechanism) -> list[float]:
    """Return the ends of the input [rad or m] at which the links of a dyad come in line."""
    ends = {end for bounds in linkage.closing_ranges for end in bounds}
    return [] if linkage.turns_fully else [end for bounds in linkage.input_ranges
                                           for end in bounds if end in ends]


def _dyad_at(linkage: Mechanism, end: float) -> str:
    """Return ' (dyad NAME)' of the dyad of a machine that stops it at an end of the input."""
    limits = [limit for bound in getattr(linkage, 'limits', ()) if bound for limit in bound]
    if not limits:
        return ''
    nearest = min(limits, key=lambda limit: abs(linkage.distance(limit.x, end)))
    return f' (dyad {nearest.dyad})'


class Band(NamedTuple):
    """Extrema of a transmission angle over the input; the worst is farther from 90 degrees."""

    name: str
    least: Extremum
    most: Extremum
    worst: Extremum


def transmission_bands(linkage: Mechanism) -> list[Band]:
    """Return the band of the transmission angle; of a machine, one for each of its dyads."""
    names = [name for name in positions(linkage, linkage.input) if name.startswith(ANGLE)]
    own = [name for name in names if name != ANGLE] or names
    every = find_extrema(linkage, own, conditions=False)
    bands = []
    for name in own:
        extrema = [extremum for extremum in every if extremum.quantity == name]
        least, most = (pick(extrema, key=lambda extremum: extremum.value) for pick in (min, max))
        worst = max((least, most), key=lambda extremum: abs(extremum.value - 0.5 * pi))
        bands.append(Band(name, least, most, worst))
    return bands


def input_of(linkage: Mechanism, extremum: Extremum) -> float:
    """Return the driven joint at an extremum [rad] or [m]."""
    return counted(linkage, extremum.input)


def counted(linkage: Mechanism, theta1: float) -> float:
    """Return an input as users count it: in its range, of a full turn from 0 to 2 pi."""
    if linkage.is_driven_by_slide:
        return theta1
    if linkage.turns_fully:
        return theta1 % tau
    return min((theta1 + turns * tau for turns in (-1, 0, 1)), key=lambda angle: min(
        max(low - angle, angle - high) for low, high in linkage.input_ranges))


def transmission_angles(linkage: Mechanism) -> list[tuple[str, str]]:
    """Return a row (name, text) for each transmission angle: least to most, and where worst."""
    rows = []
    for name, least, most, worst in transmission_bands(linkage):
        band = (in_degrees(least.value) if least.kind == CONSTANT else
                f'{degrees(least.value):.4f} to {in_degrees(most.value)}')
        at = input_of(linkage, worst)
        where = '' if least.kind == CONSTANT else (
            f'; worst deviation from 90 deg: {degrees(abs(worst.value - 0.5 * pi)):.1f} deg at '
            f'{linkage.input_coordinate.position} {shown(linkage.input_coordinate, at)}')
        rows.append((f'transmission angle{name.removeprefix(ANGLE).replace("_", " ")}',
                     band + where))
    return rows


def extrema_table(linkage: Mechanism, extrema: Sequence[Extremum], title: str) -> Table:
    """Return the table of extrema: value, place in rad and degrees (and slide), a block each."""
    slides = any(extremum.slide == extremum.slide for extremum in extrema)
    driven = linkage.input_coordinate.position
    driven = driven if driven.startswith('theta') else 'theta1'
    table = make_table(title, ('quantity', 'kind', '', 'value>', 'unit',
                               *(('slide [m]>',) if slides else ()),
                               f'{driven} [rad]>', '[deg]>', ''))
    last = None
    for extremum in extrema:
        if last not in (None, extremum.quantity):
            table.add_row()
        theta1 = counted(linkage, extremum.theta1)
        table.add_row('' if extremum.quantity == last else extremum.quantity, str(extremum.kind),
                      'global' if extremum.is_global else '', number(extremum.value),
                      extremum.unit,
                      *((f'{extremum.slide:.8f}',) if slides else ()),
                      f'{theta1:.8f}', f'{degrees(theta1):.4f}',
                      SIDES[extremum.side])
        last = extremum.quantity
    return table


def proofs_in_words(extrema: Sequence[Extremum]) -> str:
    """Return a line for each way in which extrema are proved, or not, with the quantities."""
    names: dict[str, dict[str, None]] = {}
    for extremum in extrema:
        names.setdefault(extremum.proof, {})[extremum.quantity] = None
    return '\n'.join(f'{proof}: {", ".join(of)}' for proof, of in names.items())
