# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Where loads over the input are not smooth: the ends of pieces that springs and forces bring.

A force table is one polynomial between two of its points, and a torsion spring jumps where its
deflection has made half a turn. So the input is cut where the position s of a table comes to one
of its points, or an angle comes round. Springs besides have branch points where their length is
zero: those at complex inputs near the real ones are given too, as quantities change fast there.
"""
from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from math import inf, pi, tau
from typing import Any, NamedTuple

from fourbar_ros.mechanisms.curves import FIXED, LinkMotion
from fourbar_ros.mechanisms.elements import (
    BOTH,
    Distance,
    Element,
    INPUT,
    LinkAngle,
    LinkMotions,
    PositionForce,
    Spring,
    TableForce,
    TorsionSpring,
)
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.parts import GROUND
from fourbar_ros.numerics.arrays import Array, as_grid, rank_of
from fourbar_ros.numerics.newton import newton_roots
from fourbar_ros.numerics.number_types import ARRAY, Function
import numpy as np

SAMPLES = 361           # of a turn, or of a range of the input
CLOSER = 2.0**-np.arange(16.0, 46.0)    # of a range: distances of more samples from its ends
STEP = 2.0**-200        # of derivatives by a complex step
TOUCHING = 1e-9         # of a turn or range: nearer ends of pieces are one
BESIDE = 1e-10          # ... distance of samples beside them
FARTHEST = 1.0          # [rad] distance from the real inputs at which branch points still matter


class Coordinate(NamedTuple):
    """A number over the input, at some values of which something is not smooth."""

    of: Callable[[Mapping[str, LinkMotion], Any], Any]      # motions of links, input -> it
    points: Array           # those values
    period: float           # after which it comes round, inf: never
    is_square: bool = False     # of a spring's length: only where it is least matters
    turns_back: bool = False    # where it does, a force begins or ends


EDGE = Coordinate(lambda moving, x: x, np.zeros(1), inf)       # what is found otherwise, at zero


class Pieces(NamedTuple):
    """Inputs within a cycle from -half of it on, or in the ranges, [rad] or [m]."""

    ends: tuple[float, ...]             # between which all loads are smooth, in order
    branch_points: tuple[complex, ...]  # of springs, beside the real inputs


def pieces_of(mechanism: Mechanism) -> Pieces:
    coordinates = [each for element in mechanism.elements for each in _coordinates(element)]
    ends, branch_points, low, high = list[float](), list[complex](), 0.0, 0.0
    for low, high in _ranges(mechanism) if coordinates else ():
        x = _samples(mechanism, low, high)
        for coordinate in coordinates:
            values, rows = partial(_values, mechanism, coordinate.of), np.zeros(x.size, int)
            if coordinate.is_square:
                turning, bend, _ = _turning_points(values, x, rows, values(x, rows)[1])
                least, bend = turning[bend > 0.0], bend[bend > 0.0]
                away = np.sqrt(2.0 * values(least, rows)[0] / bend)
                branch_points += [complex(*z) for z in zip(least.tolist(), away.tolist())
                                  if z[1] < FARTHEST * mechanism.input_unit]
            else:
                ends += _ends(values, x, rows, coordinate)[0].tolist()
    return Pieces(_apart(mechanism, ends, low, high), tuple(branch_points))


def span_of(mechanism: Mechanism, of: Callable[[Mapping[str, LinkMotion], Any], Any]
            ) -> tuple[float, float]:
    """Return the least and the largest value over the input; ``of`` as of a Coordinate."""
    values, found = partial(_values, mechanism, of), list[Array]()
    for low, high in _ranges(mechanism):
        x: Array = np.union1d(_samples(mechanism, low, high), (low, high))
        rows: Array = np.zeros(x.size, int)
        s, slope = values(x, rows)
        turning, _, rows = _turning_points(values, x, rows, slope)
        found += s, values(turning, rows)[0]
    every = np.concatenate(found)
    return float(np.nanmin(every)), float(np.nanmax(every))


def _values(mechanism: Mechanism, of: Callable[[Mapping[str, LinkMotion], Any], Any], x: Array,
            _: Array) -> tuple[Array, Array]:
    """Return a coordinate and its slope at inputs, ``of`` the motions of links and the input."""
    with np.errstate(all='ignore'):
        z = x + 1j * STEP
        moving = {**mechanism.link_motions(mechanism.motion(z)), GROUND: FIXED}
        s = np.broadcast_to(of(moving, z), x.shape)
    return s.real, s.imag / STEP


def with_friction(mechanism: Mechanism, rates: tuple[float, float]) -> Pieces:
    """Return the pieces of a mechanism with friction at a rate and acceleration of the input."""
    # Loads jump where the relative rate of a joint changes its sign, and then the slopes of loads
    # where what a guide bears does.
    from fourbar_ros.mechanisms.friction import edges_of  # few mechanisms have any
    ends, branch_points = mechanism.pieces or Pieces((), ())
    edges, found = edges_of(mechanism, mechanism.constants, rates), list(ends)
    for low, high in _ranges(mechanism) if rates[0] else ():
        x = _samples(mechanism, low, high)
        for edge in edges:
            def values(x: Array, _: Array, edge: Function = edge) -> tuple[Array, Array]:
                with np.errstate(all='ignore'):
                    s = np.broadcast_to(edge(x + 1j * STEP), x.shape)
                return s.real, s.imag / STEP
            # on both sides of the ends so far, at which it may jump
            sides = np.array([end + side * BESIDE * (high - low)
                              for end in found for side in (-1.0, 1.0)])
            apart = np.union1d(x, sides[(sides > x[0]) & (sides < x[-1])])
            apart = apart[np.isfinite(values(apart, apart)[0])]
            found += _ends(values, apart, np.zeros(apart.size, int), EDGE)[0].tolist()
        found = list(_apart(mechanism, found, low, high))
    return Pieces(tuple(found), branch_points)


def _samples(mechanism: Mechanism, low: float, high: float) -> Array:
    """Return rising inputs of a cycle, or of a range, denser at its ends."""
    if mechanism.turns_fully:       # once round, from beside zero
        return np.asarray(low + 0.3 + np.linspace(0.0, high - low, SAMPLES * mechanism.turns))
    return samples_of_range(low, high)


def samples_of_range(low: float, high: float) -> Array:
    """Return rising inputs of a range: beside a toggle angles change as the distance's root."""
    shares = np.concatenate((CLOSER, 0.5 - 0.5 * np.cos(np.linspace(0.0, pi, SAMPLES)[1:-1])))
    return np.asarray(np.unique(np.concatenate((low + (high - low) * shares,
                                                high - (high - low) * CLOSER))))


def _apart(mechanism: Mechanism, ends: Sequence[float], low: float, high: float
           ) -> tuple[float, ...]:
    """Return ends of pieces in order, those of a cycle from ``low`` on, each once."""
    apart, width = list[float](), high - low
    for end in sorted(end - width if mechanism.turns_fully and end >= high else end
                      for end in ends):
        if not apart or end - apart[-1] > TOUCHING * width:
            apart.append(end)
    # the last one may be the first, a cycle later
    is_first = mechanism.turns_fully and len(apart) > 1 and (
        apart[-1] - apart[0] > width * (1.0 - TOUCHING))
    return tuple(apart[:-1] if is_first else apart)


def _ranges(mechanism: Mechanism) -> tuple[tuple[float, float], ...]:
    if mechanism.turns_fully:
        return ((-pi * mechanism.turns, pi * mechanism.turns),)
    return mechanism.input_ranges


def _coordinates(element: Element) -> Iterator[Coordinate]:
    if isinstance(element, Spring):
        if element.has_length:
            yield Coordinate(lambda moving, _: element.tension(ARRAY, moving)[2], np.empty(0), inf,
                             True)
    elif isinstance(element, TorsionSpring):
        yield Coordinate(lambda moving, _: element.deflection(ARRAY, moving), np.array([pi]), tau)
    elif isinstance(element, PositionForce):
        second = element.apart_from
        if second is not None:
            yield Coordinate(lambda moving, _: Distance(element.point, second).of(
                ARRAY, moving)**2, np.empty(0), inf, True)
        points: Array = np.empty(0)
        period = inf
        if isinstance(element.value, TableForce):
            points, period = np.array(element.value.table.starts), element.value.period
            if element.value.middle is not None:        # there the table ends and begins again
                points = np.append(points, element.value.middle + pi)
        elif isinstance(element.over, LinkAngle):
            points, period = np.array([pi]), tau
        turns_back = element.when != BOTH and element.over != INPUT
        if points.size or turns_back:
            yield Coordinate(lambda moving, x: element.position(ARRAY, moving, x), points, period,
                             turns_back=turns_back)


# At inputs (m,) of rows, as of mechanisms, their indices (m,), a coordinate and its slope.
Curves = Callable[[Array, Array], tuple[Array, Array]]


def ends_of_turns(elements: Sequence[Element], links_at: Callable[[Array], LinkMotions],
                  count: int, turns: int, edges: Sequence[Function] = ()) -> Array:
    """Return the ends of pieces of many mechanisms whose cranks turn fully, (mechanisms, most)."""
    # They lie in order from 0 to so many turns, NaN beyond the last. elements: on all of them,
    # with columns of numbers, shape (count, 1); links_at: inputs, shape (count, any), complex ->
    # motions of the links; edges: such inputs -> as edges_of().
    cycle, found, of_found = tau * turns, list[Array](), list[Array]()
    rows = np.repeat(np.arange(count), SAMPLES * turns)
    x = np.tile(0.3 + np.linspace(0.0, cycle, SAMPLES * turns), count)
    coordinates = [each for element in elements for each in _coordinates(element)
                   if not each.is_square]
    for coordinate, edge in [*((each, None) for each in coordinates),
                             *((EDGE, edge) for edge in edges)]:
        def values(x: Array, row: Array, coordinate: Coordinate = coordinate,
                   edge: Function | None = edge) -> tuple[Array, Array]:
            row, column, grid = as_grid(x, row, count)
            with np.errstate(all='ignore'):
                z = grid + 1j * STEP
                s = np.broadcast_to(edge(z) if edge else coordinate.of(links_at(z), z),
                                    z.shape)[row, column]
            return s.real, s.imag / STEP

        at, of = [x], [rows]
        if edge:        # on both sides of the ends so far, at which it may jump
            at += [0.3 + np.mod(end + side * BESIDE * cycle - 0.3, cycle)
                   for end in found for side in (-1.0, 1.0)]
            of += [row for row in of_found for _ in range(2)]
        x_there, row_there = np.concatenate(at), np.concatenate(of)
        order = np.lexsort((x_there, row_there))
        ends, of_ends = _ends(values, x_there[order], row_there[order], coordinate)
        found.append(np.mod(ends, cycle))
        of_found.append(of_ends)
    ends, row = (np.concatenate(parts) if parts else rows[:0] for parts in (found, of_found))
    order = np.lexsort((ends, row))
    ends, row = ends[order], row[order]
    # nearer ends are one, the last of a cycle and the first of the next too
    is_first = np.diff(row, prepend=-1) > 0
    before = np.roll(ends, 1)
    before[is_first] = ends[np.roll(is_first, -1)] - cycle
    is_apart = ends - before > TOUCHING * cycle
    ends, row = ends[is_apart], row[is_apart]
    column = rank_of(row)
    table = np.full((count, int(column.max(initial=-1)) + 1), np.nan)
    table[row, column] = ends
    return table


def _turning_points(values: Curves, x: Array, row: Array, slope: Array
                    ) -> tuple[Array, Array, Array]:
    """Return where a coordinate turns back between rising inputs of rows, with a slope at each."""
    # And its second derivative there, and the row.
    before = np.flatnonzero(((slope[1:] >= 0.0) != (slope[:-1] >= 0.0)) & (row[1:] == row[:-1]))
    low, high, row = x[before], x[before + 1], row[before]

    def newton(x: Array, row: Array) -> tuple[Array, Array]:
        turn = 2.0**-24 * (high - low)
        here, there = values(x, row)[1], values(x + turn, row)[1]
        with np.errstate(all='ignore'):
            return here, here * turn / (there - here)
    if not before.size:
        return low, low, row
    turning = newton_roots(newton, row, low, high, slope[before], 0.5 * (low + high))
    turn = 2.0**-12 * (high - low)
    bend = (values(turning + turn, row)[1] - values(turning - turn, row)[1]) / (2.0 * turn)
    return turning, bend, row


def _ends(values: Curves, x: Array, row: Array, coordinate: Coordinate) -> tuple[Array, Array]:
    """Return where pieces end that a coordinate brings, and the rows, from their rising inputs."""
    points, period = np.sort(coordinate.points), coordinate.period
    s, slope = values(x, row)
    turning, _, of_turning = _turning_points(values, x, row, slope)
    ends = (turning, of_turning) if coordinate.turns_back else (x[:0], row[:0])
    x, row = np.concatenate((x, turning)), np.concatenate((row, of_turning))
    s = np.concatenate((s, values(turning, of_turning)[0]))
    order = np.lexsort((x, row))
    order = order[np.isfinite(s[order])]
    if order.size < 2 or not points.size:
        return ends
    x, row, s = x[order], row[order], s[order]      # between these it is monotone
    if period < inf:
        s = np.unwrap(s, period=period)
        first, last = (np.floor((end - points[0]) / period) for end in (s.min(), s.max()))
        points = np.unique(np.add.outer(np.arange(first - 1, last + 2) * period, points))
    low, high = np.minimum(s[:-1], s[1:]), np.maximum(s[:-1], s[1:])
    first, last = np.searchsorted(points, low), np.searchsorted(points, high)
    last = np.where(row[1:] == row[:-1], last, first)
    interval = np.repeat(np.arange(low.size), last - first)
    target, begin, end = points[first[interval] + rank_of(interval)], x[interval], x[interval + 1]

    def newton(x: Array, row: Array) -> tuple[Array, Array]:
        way, slope = values(x, row)
        way = way - target
        if period < inf:
            way = way - period * np.round(way / period)
        with np.errstate(all='ignore'):
            return way, way / slope
    if not interval.size:
        return ends
    part, row = (target - s[interval]) / (s[interval + 1] - s[interval]), row[interval]
    crossings = newton_roots(newton, row, begin, end, s[interval] - target,
                             begin + part * (end - begin))
    return np.concatenate((ends[0], crossings)), np.concatenate((ends[1], row))
