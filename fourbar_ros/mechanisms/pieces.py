# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Where loads over the input are not smooth: the ends of pieces that springs and forces bring.

A force table is one polynomial between two of its points, and a torsion spring jumps where its
deflection has made half a turn. So the input is cut where the position s of a table comes to one
of its points, or an angle comes round. Springs besides have branch points where their length is
zero: at real inputs both ends meet, and the force jumps to the opposite direction; those at
complex inputs near the real ones are given too, as quantities change fast there.
"""
from collections.abc import Callable, Iterator, Sequence
from functools import lru_cache
from math import inf, pi, tau
from typing import Any, NamedTuple

from fourbar_ros.mechanisms import elements
from fourbar_ros.mechanisms.batches import order_of, range_of
from fourbar_ros.mechanisms.curves import FIXED
from fourbar_ros.mechanisms.evaluation import Constants, Formula, formula_of, MOST_STRUCTURES
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.parts import GROUND, Ranges
from fourbar_ros.numerics.arrays import Array, as_grid, rank_of
from fourbar_ros.numerics.number_types import Function, numbers_of, NumberType, Scalar
from fourbar_ros.numerics.roots import first_guesses, newton_roots
from fourbar_ros.numerics.tables import ARRAYS, run
from fourbar_ros.numerics.trace import Trace
import numpy as np

SAMPLES = 361           # of a turn, or of a range of the input
START = 0.3             # [rad] samples of turns begin there: no angle that symmetry makes special
CLOSER = 2.0**-np.arange(16.0, 46.0)    # of a range: distances of more samples from its ends
STEP = 2.0**-200        # of derivatives by a complex step
TOUCHING = 1e-9         # of a turn or range: nearer ends of pieces are one
BESIDE = 1e-10          # ... distance of samples beside them
MEETING = 2.0**-40      # of the largest distance of two points: nearer to each other they meet
TOGETHER = 2**13        # inputs that are evaluated at once: they stay in the cache of a processor
FARTHEST = 1.0          # [rad] distance from the real inputs at which branch points still matter


class CutValue(NamedTuple):
    """A number over the input, at some values of which something is not smooth."""

    # number type, motions of links, input -> it
    of: Callable[[NumberType, elements.LinkMotions, Any], Any]
    points: Array           # those values
    period: float           # after which it comes round, inf: never
    is_square: bool = False     # of a spring's length: only where it is least matters
    turns_back: bool = False    # where it does, a force begins or ends
    jumps: bool = True      # loads may jump there, not their slopes alone


EDGE = CutValue(lambda n, moving, x: x, np.zeros(1), inf)    # of friction: at its zeros


class Pieces(NamedTuple):
    """Inputs within a cycle from -half of it on, or in the ranges, [rad] or [m]."""

    ends: tuple[float, ...] = ()        # between which all loads are smooth, in order
    branch_points: tuple[complex, ...] = ()     # of springs, beside the real inputs
    meetings: tuple[float, ...] = ()    # those ends at which both ends of a spring meet


class CutCurves:
    """The coordinates of a mechanism, or of many like it, as functions of the input."""

    # data: its constants, or columns of them, shape (count, 1); rates: rate and acceleration of
    # the input, or columns, of the edges of friction (FrictionReport.edges); None: without these

    def __init__(self, mechanism: Mechanism, data: Constants, count: int = 1,
                 rates: tuple[Any, Any] | None = None) -> None:
        formula = formula_of(mechanism, True)
        self._trace, self._count = _trace_of_curves(formula, rates is not None), count
        self._known = self._trace.numbers(numbers_of(data))
        wanted = range_of(self._trace)
        with np.errstate(all='ignore'):
            run(self._trace, order_of(self._trace, wanted).of_data, ARRAYS, self._known)
        self._rates = [np.asarray(rate, complex) for rate in rates or (1.0, 0.0)]
        coordinates = [each for element in mechanism.elements for each in _coordinates(element)]
        self.coordinates = coordinates + [EDGE] * (len(wanted) - len(coordinates))
        # Edges that are made of loads, so need masses, may jump at the ends of pieces that other
        # curves bring: they ``follow`` these in ``order``. In the data, lengths and signs stand
        # before what makes loads.
        first = self._trace.count + len(numbers_of((data.lengths, data.sign)))
        of_loads = set(range(first, self._trace.count + self._trace.size))
        needed = [order_of(self._trace, (k,)).of_inputs for k in wanted]
        self.follows = [each is EDGE and not of_loads.isdisjoint(self._trace.needed(steps))
                        for each, steps in zip(self.coordinates, needed)]
        self.order = tuple(sorted(wanted, key=lambda k: (self.follows[k], len(needed[k]))))

    def sample(self, which: tuple[int, ...], x: Array) -> tuple[Array, Array]:
        """Return coordinates and slopes, (which, count, any), at inputs (1 or count, any)."""
        # Slopes by a complex step: the imaginary part of f(x + i h) is h f'(x). Inputs of shape
        # (1, any) are those of all mechanisms.
        order = order_of(self._trace, which)
        samples = np.empty((len(which), self._count, x.shape[1]), complex)
        width = max(1, TOGETHER // self._count)
        with np.errstate(all='ignore'):
            for begin in range(0, x.shape[1], width):
                columns = slice(begin, begin + width)
                values = run(self._trace, order.of_inputs, ARRAYS, [
                    x[:, columns] + 1j * STEP, *self._rates, *self._known[self._trace.count:]],
                    order.freed)
                for row, index in zip(samples, order.results):
                    row[:, columns] = values[index]
        return samples.real, samples.imag / STEP

    def at(self, k: int, x: Array, row: Array) -> tuple[Array, Array]:
        """Return a coordinate and its slope at inputs of rows, as of mechanisms, in order."""
        row, column, grid = as_grid(x, row, self._count)
        values, slopes = self.sample((k,), grid)
        return values[0, row, column], slopes[0, row, column]


@lru_cache(maxsize=MOST_STRUCTURES)
def _trace_of_curves(formula: Formula, with_edges: bool) -> Trace:
    mechanism = formula.mechanism

    def make(n: NumberType, constants: Constants) -> Function:
        def values(*inputs: Scalar) -> list[Scalar]:
            motion, reports = mechanism.motion_in(n, constants, *inputs), list[Any]()
            moving = {**mechanism.link_motions(motion, constants.lengths), GROUND: FIXED}
            if with_edges:      # for the reports of friction alone
                mechanism.loads_in(n, constants, motion, reports)
            return [*(each.of(n, moving, inputs[0]) for element in constants.elements
                      for each in _coordinates(element)),
                    *(edge for report in reports for edge in report.edges)]
        return values
    return Trace(make, 3, mechanism.constants)


def pieces_of(mechanism: Mechanism) -> Pieces:
    ends, meetings, branch_points = list[float](), list[float](), list[complex]()
    low, high = 0.0, 0.0
    curves = CutCurves(mechanism, mechanism.constants)
    for low, high in ranges_of(mechanism) if curves.order else ():
        x = _samples(mechanism, low, high)
        rows = np.zeros(x.size, int)
        for k, s, slope in zip(curves.order, *curves.sample(curves.order, x[None])):
            coordinate = curves.coordinates[k]
            if coordinate.is_square:
                def values(x: Array, _: Array, k: int = k) -> tuple[Array, Array]:
                    return curves.at(k, x, np.zeros(x.size, int))
                before = _turns_back(slope[0], rows)
                least, turn = (_turning_points(values, x, slope[0], before),
                               2.0**-12 * (x[before + 1] - x[before]))
                rise = values(least + turn, least)[1] - values(least - turn, least)[1]
                square = values(least, least)[0]
                meets = square <= MEETING**2 * np.nanmax(s)
                meetings += least[meets].tolist()
                with np.errstate(invalid='ignore'):     # where it is largest there is no root
                    away = np.sqrt(4.0 * turn * square / rise)
                branch_points += [complex(*z) for z in zip(least[~meets].tolist(),
                                                           away[~meets].tolist())
                                  if z[1] < FARTHEST * mechanism.input_unit]
            else:
                ends += _ends(curves, k, x, rows, s[0], slope[0])[0].tolist()
    return Pieces(_apart(mechanism, [*ends, *meetings], low, high), tuple(branch_points),
                  tuple(meetings))


def span_of(mechanism: Mechanism, of: Callable[[elements.LinkMotions, Any], Any]
            ) -> tuple[float, float]:
    """Return the least and the largest value over the input; ``of``: links, input -> value."""
    def values(x: Array, _: Array) -> tuple[Array, Array]:
        with np.errstate(all='ignore'):
            z = x + 1j * STEP
            moving = {**mechanism.link_motions(mechanism.motion(z)), GROUND: FIXED}
            s = np.broadcast_to(of(moving, z), x.shape)
        return s.real, s.imag / STEP

    every = list[Array]()
    for low, high in ranges_of(mechanism):
        x: Array = np.union1d(_samples(mechanism, low, high), (low, high))
        s, slope = values(x, x)
        before = _turns_back(slope, np.zeros(x.size, int))
        every += s, values(_turning_points(values, x, slope, before), x)[0]
    inorder = np.concatenate(every)
    return float(np.nanmin(inorder)), float(np.nanmax(inorder))


def inside_pieces(mechanism: Mechanism) -> Array:
    """Return inputs over the whole input, one in each piece at least, none at their ends."""
    ends, inputs = (mechanism.pieces or Pieces()).ends, list[Array]()
    for low, high in ranges_of(mechanism):
        x = np.union1d(_samples(mechanism, low, high), (low, high, *ends))
        x = x[(x >= low) & (x <= high)]
        inputs.append(0.5 * (x[:-1] + x[1:]))
    return np.concatenate(inputs)


def with_friction(mechanism: Mechanism, rates: tuple[float, float]) -> Pieces:
    """Return the pieces of a mechanism with friction at a rate and acceleration of the input."""
    # Loads jump where the relative rate of a joint changes its sign, and then the slopes of loads
    # where what a guide bears does.
    pieces = mechanism.pieces or Pieces()
    if not rates[0]:
        return pieces
    curves, every = CutCurves(mechanism, mechanism.constants, 1, rates), list(pieces.ends)
    for low, high in ranges_of(mechanism):
        for k in curves.order:
            if curves.coordinates[k] is not EDGE:
                continue
            x = _samples(mechanism, low, high)
            if curves.follows[k]:       # on both sides of the ends so far
                sides = np.array([end + side * BESIDE * (high - low)
                                  for end in every for side in (-1.0, 1.0)])
                x = np.union1d(x, sides[(sides > x[0]) & (sides < x[-1])])
            s, slope = (values[0, 0] for values in curves.sample((k,), x[None]))
            x, s, slope = (values[np.isfinite(s)] for values in (x, s, slope))
            every += _ends(curves, k, x, np.zeros(x.size, int), s, slope)[0].tolist()
        every = list(_apart(mechanism, every, low, high))
    return pieces._replace(ends=tuple(every))


def _samples(mechanism: Mechanism, low: float, high: float) -> Array:
    """Return rising inputs of a cycle, or of a range, denser at its ends."""
    if mechanism.turns_fully:       # once round, from beside zero
        return np.asarray(low + START + np.linspace(0.0, high - low, SAMPLES * mechanism.turns))
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


def ranges_of(mechanism: Mechanism) -> Ranges:
    """Return the ranges of the input after which all repeats, forces too: of a crank its cycle."""
    if mechanism.turns_fully:
        return ((-pi * mechanism.turns, pi * mechanism.turns),)
    return mechanism.input_ranges


def _coordinates(element: elements.Element) -> Iterator[CutValue]:
    if isinstance(element, elements.Spring):
        if element.has_length:
            yield CutValue(lambda n, moving, _: element.tension(n, moving)[2], np.empty(0), inf,
                           True)
    elif isinstance(element, elements.TorsionSpring):
        yield CutValue(lambda n, moving, _: element.deflection(n, moving), np.array([pi]), tau)
    elif isinstance(element, elements.PositionForce):
        second = element.apart_from
        if second is not None:
            yield CutValue(lambda n, moving, _: elements.Distance(element.point, second).of(
                n, moving)**2, np.empty(0), inf, True)
        points: Array = np.empty(0)
        period, turns_back = inf, element.when != elements.BOTH and element.over != elements.INPUT
        jumps = turns_back
        if isinstance(element.value, elements.TableForce):
            table = element.value.table
            jumps |= len(table.starts) < len(table.places) or element.value.middle is not None
            points, period = np.array(table.starts), element.value.period
            if element.value.middle is not None:        # there the table ends and begins again
                points = np.append(points, element.value.middle + pi)
        elif isinstance(element.over, elements.LinkAngle):
            points, period, jumps = np.array([pi]), tau, True
        if points.size or turns_back:
            yield CutValue(element.position, points, period, False, turns_back, jumps)


class PieceEnds(NamedTuple):
    """Ends of pieces of many mechanisms, (mechanisms, most), in order from 0 to their cycle."""

    inputs: Array       # NaN beyond the last
    are_jumps: Array    # at which loads may jump, not their slopes alone


def ends_of_turns(curves: CutCurves, count: int, turns: int) -> PieceEnds:
    """Return the ends of pieces of ``count`` mechanisms whose cranks make so many turns."""
    # One curve after the other adds its ends: the input, the row of the mechanism, may it jump.
    cycle, by_curve = tau * turns, list[tuple[Array, Array, Array]]()
    x = START + np.linspace(0.0, cycle, SAMPLES * turns)
    rows = np.repeat(np.arange(count), x.size)
    order = [k for k in curves.order if not curves.coordinates[k].is_square]
    together = tuple([k for k in order if not curves.follows[k]])
    sampled = dict(zip(together, zip(*curves.sample(together, x[None]))))
    for k in order:
        x_there, row_there = np.tile(x, count), rows
        if k in sampled:
            s, slope = (values.ravel() for values in sampled[k])
        else:       # it jumps itself at the ends so far: samples on both sides of each
            sides = [START + np.mod(ends + side * BESIDE * cycle - START, cycle)
                     for ends, *_ in by_curve for side in (-1.0, 1.0)]
            x_there = np.concatenate([x_there, *sides])
            row_there = np.concatenate([rows, *[row for _, row, _ in by_curve for _ in range(2)]])
            inorder = np.lexsort((x_there, row_there))
            x_there, row_there = x_there[inorder], row_there[inorder]
            s, slope = curves.at(k, x_there, row_there)
        ends, row = _ends(curves, k, x_there, row_there, s, slope)
        by_curve.append((np.mod(ends, cycle), row, np.full(row.size, curves.coordinates[k].jumps)))
    if not by_curve:
        return PieceEnds(np.empty((count, 0)), np.empty((count, 0), bool))
    ends, row, are_jumps = map(np.concatenate, zip(*by_curve))
    inorder = np.lexsort((ends, row))
    ends, row, are_jumps = ends[inorder], row[inorder], are_jumps[inorder]
    # Ends that touch are one. Before the first end of a row comes its last one, a cycle earlier.
    is_first = np.diff(row, prepend=-1) > 0
    before = np.roll(ends, 1)
    before[is_first] = ends[np.roll(is_first, -1)] - cycle
    is_apart = ends - before > TOUCHING * cycle
    # where a jump is left out for an end that it touches, all ends of its row may be jumps
    are_jumps |= np.isin(row, row[are_jumps & ~is_apart])
    ends, row, are_jumps = ends[is_apart], row[is_apart], are_jumps[is_apart]
    column = rank_of(row)
    inputs = np.full((count, int(column.max(initial=-1)) + 1), np.nan)
    flags = np.zeros(inputs.shape, bool)
    inputs[row, column], flags[row, column] = ends, are_jumps
    return PieceEnds(inputs, flags)


def _turning_points(values: Function, x: Array, slope: Array, before: Array) -> Array:
    """Return where a coordinate turns back in intervals after some inputs, by its slopes."""
    # values: inputs and which of the intervals they are in -> coordinate and slope; before: the
    # indices of the inputs x after which the slope changes its sign
    low, high = x[before], x[before + 1]
    if not before.size:
        return low

    def newton(position: Array, which: Array) -> tuple[Array, Array]:
        """Return the slope and the step of Newton's method to its zero, by a difference."""
        apart = 2.0**-24 * (high - low)[which]
        here, there = values(position, which)[1], values(position + apart, which)[1]
        with np.errstate(all='ignore'):
            return here, here * apart / (there - here)
    first, last = slope[before], slope[before + 1]
    secant = low + first / (first - last) * (high - low)
    return newton_roots(newton, np.arange(low.size), low, high, first, secant)


def _turns_back(slope: Array, row: Array) -> Array:
    """Return the indices of inputs after which a coordinate turns back."""
    return np.flatnonzero(((slope[1:] >= 0.0) != (slope[:-1] >= 0.0)) & (row[1:] == row[:-1]))


def _ends(curves: CutCurves, k: int, x: Array, row: Array, s: Array, slope: Array
          ) -> tuple[Array, Array]:
    """Return where pieces end that a coordinate brings, and the row of the mechanism of each."""
    # x, row, s, slope: samples of the coordinate, by row and in each by rising inputs. First the
    # inputs at which it turns back, where a force that acts one way begins or ends; between these
    # and the samples it is monotone, and then those at which it comes to one of its points.
    coordinate = curves.coordinates[k]
    points, period = np.sort(coordinate.points), coordinate.period
    before = _turns_back(slope, row)
    if not coordinate.turns_back and points.size:
        # where it turns beyond all points between two inputs does not matter: it comes no farther
        # from the nearer one than its larger slope leads
        reach = 2.0 * np.maximum(np.abs(slope[before]), np.abs(slope[before + 1])) * (
            x[before + 1] - x[before])
        low, high = (pick(s[before], s[before + 1]) + side * reach
                     for pick, side in ((np.minimum, -1.0), (np.maximum, 1.0)))
        if period < inf:
            low, high = (np.floor((end[:, None] - points) / period) for end in (low, high))
            matters = (low != high).any(axis=1)
        else:
            matters = np.searchsorted(points, low) < np.searchsorted(points, high, side='right')
        before = before[matters | ~np.isfinite(reach)]
    of_turning = row[before]
    turning = _turning_points(lambda x, which: curves.at(k, x, of_turning[which]), x, slope,
                              before)
    ends = (turning, of_turning) if coordinate.turns_back else (x[:0], row[:0])
    if not points.size:
        return ends
    if turning.size:        # between all inputs it is monotone then
        at_turning = curves.at(k, turning, of_turning)
        x, row, s, slope = (np.insert(values, before + 1, more) for values, more in (
            (x, turning), (row, of_turning), (s, at_turning[0]), (slope, at_turning[1])))
    is_known = np.isfinite(s)
    if not is_known.all():
        x, row, s, slope = (values[is_known] for values in (x, row, s, slope))
    if s.size < 2:
        return ends
    if period < inf:
        s = np.unwrap(s, period=period)
        first, last = (np.floor((end - points[0]) / period) for end in (s.min(), s.max()))
        points = np.unique(np.add.outer(np.arange(first - 1, last + 2) * period, points))
    # a sample at a point itself counts as above it, as in newton_roots(): of rising ones the
    # interval before it is the one that crosses, of falling ones the interval behind it
    low, high = np.minimum(s[:-1], s[1:]), np.maximum(s[:-1], s[1:])
    first, last = (np.searchsorted(points, size, side='right') for size in (low, high))
    last = np.where(row[1:] == row[:-1], last, first)       # none between two rows
    interval = np.repeat(np.arange(low.size), last - first)
    if not interval.size:
        return ends
    target = points[first[interval] + rank_of(interval)]
    begin, end, row = x[interval], x[interval + 1], row[interval]
    way_a, way_b = s[interval] - target, s[interval + 1] - target

    def newton(x: Array, which: Array) -> tuple[Array, Array]:
        way, slope = curves.at(k, x, row[which])
        way = way - target[which]
        if period < inf:
            way = way - period * np.round(way / period)
        with np.errstate(all='ignore'):
            return way, way / slope
    with np.errstate(all='ignore'):
        guess = first_guesses(begin, end, way_a, way_b, way_a / slope[interval],
                              way_b / slope[interval + 1])
    crossings = newton_roots(newton, np.arange(row.size), begin, end, way_a, guess)
    return np.concatenate((ends[0], crossings)), np.concatenate((ends[1], row))
