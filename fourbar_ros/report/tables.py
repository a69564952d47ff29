# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Tables of a linkage's properties and of extrema; words for class, mode and units."""
from __future__ import annotations

from collections.abc import Sequence
from math import degrees, pi, tau
from typing import NamedTuple

from fourbar_ros.extrema.find import CONSTANT, Extremum, find_extrema
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.parts import Coordinate
from fourbar_ros.mechanisms.quantities import positions
from fourbar_ros.report.mobility import mobility_rows
from fourbar_ros.report.poses import in_degrees, number, shown
from fourbar_ros.report.terminal import PlainTable
import numpy as np

SAMPLES, END, FULL_TURN = 721, 1e-14, tau * (1.0 - 1e-9)
ANGLE = 'transmission_angle'
SIDES = {0: '', 1: 'from above', -1: 'from below'}      # how an end of the range is approached


def class_name(linkage: Mechanism) -> str:
    """Return the class of a linkage as text; of sliders also the kind and what is driven."""
    return linkage.description


def mode_name(linkage: Mechanism) -> str:
    """Return the assembly mode as text."""
    return linkage.modes[linkage.mode]


def rate_unit(linkage: Mechanism) -> str:
    """Return the unit of the input's rate."""
    return f'{linkage.input_coordinate.unit}/s'


def _ranges(coordinate: Coordinate, ranges: Sequence[tuple[float, float]]) -> str:
    name, unit = coordinate.position, 'm' if coordinate.unit == 'm' else 'deg'
    if unit == 'deg' and any(high - low >= FULL_TURN for low, high in ranges):
        return f'{name}: full turns'
    ends = [[shown(coordinate, end).split()[0] for end in bounds] for bounds in ranges]
    return f'{name}: {", ".join(map(" to ".join, ends))} {unit}'


def output_ranges(linkage: Mechanism, coordinate: Coordinate | None = None
                  ) -> list[tuple[float, float]]:
    """
    Return the ranges of an output coordinate in the mode of a linkage.

    One for each range of the input.

    The output turns back at dead points only, so these and the ends of the input are where it is
    extreme.
    ``coordinate``: not given, that of the first output.
    """
    coordinate = coordinate or linkage.outputs[0].coordinate
    found = []
    for low, high in linkage.input_ranges:
        turns = [point[0] + turn for point in linkage.dead_points for turn in (-tau, 0.0, tau)]
        given = np.sort([*np.linspace(low, high, SAMPLES), *(x for x in turns if low < x < high)])
        # of a range that ends in a toggle, the end itself may be NaN
        given[0] += END * linkage.input_unit
        given[-1] -= END * linkage.input_unit
        places, = linkage.motion(given, fields=(coordinate.position,))
        if coordinate.unit == 'rad':
            places = np.unwrap(places)
            places = places - tau * round(0.5 * (places.min() + places.max()) / tau)
        found.append((places.min(), places.max()))
    return sorted(found)


def known_output_ranges(linkage: Mechanism
                        ) -> list[tuple[Coordinate, Sequence[tuple[float, float]], bool]]:
    """Return (output, its ranges, whether they are those of both modes, which meet)."""
    if linkage.change_point_margin > 0.0:
        return [(coordinate, output_ranges(linkage, coordinate), False)
                for coordinate, _ in linkage.outputs]
    both = linkage.ranges_of_both_modes
    return [(coordinate, both[coordinate.position], True)
            for coordinate, _ in linkage.outputs if coordinate.position in both]


def what_it_is(linkage: Mechanism, title: object) -> PlainTable:
    """Return the table of a linkage's own properties."""
    table = PlainTable(str(title), ('', ''))
    table.show_header = False
    for row in (*facts(linkage), *mobility_rows(linkage)):
        table.add_row(*row)
    return table


def facts(linkage: Mechanism) -> list[tuple[str, str]]:
    """Return a linkage's own properties as a list of (name, text)."""
    rows = [('lengths', '  '.join(f'{name} {length:g}'
                                  for name, length in zip(linkage.length_names, linkage.lengths))
             + '  m'),
            ('class', class_name(linkage)),
            ('assembly mode', mode_name(linkage)),
            ('input', _ranges(linkage.input_coordinate, linkage.input_ranges))]
    rows += [('output', _ranges(coordinate, ranges)
              + (', in both modes: they meet' if of_both else ', in this mode'))
             for coordinate, ranges, of_both in known_output_ranges(linkage)]
    rows += [('dead point' + (f', {"stretched" if point.stretched else "folded"}'
                              if hasattr(point, 'stretched') else ''),
              ', '.join(f'{coordinate.position} {shown(coordinate, value)}'
                        for coordinate, value in zip(
                            (linkage.input_coordinate,
                             *(output.coordinate for output in linkage.outputs)),
                            (counted(linkage, point[0]), *point[1:]))))
             for point in linkage.dead_points]
    rows += [*_toggles(linkage), *transmission_angles(linkage)]
    rows.append(('change-point margin', f'{linkage.change_point_margin:.6g} of the perimeter'))
    if linkage.bodies:
        rows += [(f'{name}', f'{body.mass:.6g} kg, {body.inertia:.6g} kg m^2, CG at '
                             f'({body.cg_along:g}, {body.cg_across:g}) m')
                 for name, body in linkage.bodies._asdict().items()]
    return rows


def toggles_of(linkage: Mechanism) -> list[float]:
    """Return where the links of a dyad come in line: at ends of the input [rad] or [m]."""
    ends = {end for bounds in linkage.closing_ranges for end in bounds}
    return [] if linkage.turns_fully else [end for bounds in linkage.input_ranges
                                           for end in bounds if end in ends]


def _toggles(linkage: Mechanism) -> list[tuple[str, str]]:
    """Return the row of the toggles."""
    found = [shown(linkage.input_coordinate, end) for end in toggles_of(linkage)]
    return [('toggle', f'{linkage.input_coordinate.position} {", ".join(found)}' if found
             else 'none within the range of the input')]


class Band(NamedTuple):
    """The band of a transmission angle over the input: least, most, and the worst of them."""

    name: str
    least: Extremum
    most: Extremum
    worst: Extremum


def transmission_bands(linkage: Mechanism) -> list[Band]:
    """Return the band of each transmission angle."""
    names = [name for name in positions(linkage, linkage.input) if name.startswith(ANGLE)]
    own = [name for name in names if name != ANGLE] or names     # of a machine, each dyad's own
    found = find_extrema(linkage, own, conditions=False)
    bands = []
    for name in own:
        places = [extremum for extremum in found if extremum.quantity == name]
        least, most = (pick(places, key=lambda extremum: extremum.value) for pick in (min, max))
        worst = max((least, most), key=lambda extremum: abs(extremum.value - 0.5 * pi))
        bands.append(Band(name, least, most, worst))
    return bands


def input_of(linkage: Mechanism, extremum: Extremum) -> float:
    """Return the driven joint at an extremum [rad] or [m]."""
    return counted(linkage, extremum.slide if linkage.is_driven_by_slide else extremum.theta1)


def counted(linkage: Mechanism, theta1: float) -> float:
    """Return an input as it is counted: a crank's angle from 0 to 2 pi, or within its range."""
    if linkage.is_driven_by_slide:
        return theta1
    if linkage.turns_fully:
        return theta1 % tau
    return min((theta1 + turns * tau for turns in (-1, 0, 1)), key=lambda angle: min(
        max(low - angle, angle - high) for low, high in linkage.input_ranges))


def transmission_angles(linkage: Mechanism) -> list[tuple[str, str]]:
    """Return rows of the band of each transmission angle over the input: ends, and worst."""
    rows = []
    for name, least, most, worst in transmission_bands(linkage):
        band = (in_degrees(least.value) if least.kind == CONSTANT else
                f'{degrees(least.value):.4f} to {in_degrees(most.value)}')
        at = input_of(linkage, worst)
        where = '' if least.kind == CONSTANT else (
            f'; {degrees(abs(worst.value - 0.5 * pi)):.1f} deg off square at '
            f'{linkage.input_coordinate.position} {shown(linkage.input_coordinate, at)}')
        rows.append((f'transmission angle{name.removeprefix(ANGLE).replace("_", " ")}',
                     band + where))
    return rows


def extrema_table(linkage: Mechanism, extrema: Sequence[Extremum], title: str) -> PlainTable:
    """Return the table of a list of Extremum."""
    slides = any(extremum.slide == extremum.slide for extremum in extrema)
    driven = linkage.input_coordinate.position
    driven = driven if driven.startswith('theta') else 'theta1'
    table = PlainTable(title, ('quantity', 'kind', '', 'value>', 'unit',
                               *(('slide [m]>',) if slides else ()),
                               f'{driven} [rad]>', '[deg]>', ''))
    last = None
    for extremum in extrema:
        if last not in (None, extremum.quantity):
            table.add_section()
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
