# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Proof on demand that a set of extrema is complete, and the reason where there is no proof.

The trace of the formulas is evaluated in Taylor series of balls (Arb, by the optional package
python-flint) over pieces of the input. About the middle m of a piece, with t = x - m,

    (Z1)  f'(m + t) in c_1 + 2 c_2 t + ... + n c_n t^(n-1) + (n + 1) C t^n

where C holds f^(n+1)/(n+1)! on the whole piece (Lagrange). Where f' cannot vanish there is no
extremum. Where f'' cannot vanish there is one if f' changes sign from end to end, else none. Other
pieces are cut. Of a root, as the magnitude of a force, the square is enclosed, which is smooth
where the root has a kink.

Loads with tables of forces, torsion springs and friction are smooth between *cuts* alone: nothing
is enclosed next to a cut, but on both sides of it values and slopes are, which tell whether the
load jumps there or its slope turns its sign. The formulas choose there between forms; a piece on
which a choice is not the same all over, or on which a table has several polynomials, is cut.
"""
from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from math import inf, nan, pi
from time import thread_time
from typing import Any, NamedTuple, TYPE_CHECKING

from fourbar_ros.extrema.input_paths import InputPath
from fourbar_ros.extrema.path_search import PathExtremum
from fourbar_ros.mechanisms.evaluation import formula_of
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.parts import NoLoads
from fourbar_ros.mechanisms.quantities import Asked, is_position, is_published
from fourbar_ros.numerics.balls import arb_settings, taylor_pairs
from fourbar_ros.numerics.number_types import Function, numbers_of, NumberType
from fourbar_ros.numerics.tables import run, Table
from fourbar_ros.numerics.trace import flat, Number, Trace

if TYPE_CHECKING:      # an optional package
    from flint import arb

INTERVALS, NOT_PROVED = 'interval bounds', 'not proved'
MISSING = 'needs python-flint (pip install python-flint)'
ORDER, BITS = 8, 96
# How many intervals between samples make a piece at first, and where pieces are cut: not in
# the middle, as extrema like that.
STRIDE, CUT = 4, 0.47
NARROWEST = 2.0**-44            # of a piece, over its input or 1
# Nearer than this to a pole, in the input's unit, enclosures take too many pieces.
LEFT_OUT = 2.0**-13
# Nearer than this to a limit, over the range: the rounding of the distance hides the derivatives.
LEFT_OUT_AT_LIMIT = 2.0**-30
# Nearer than this to a cut, in the input's unit, nothing is enclosed.
LEFT_OUT_AT_CUT = 2.0**-30
# By which the input of a cut may be wrong, over itself or 1.
OFF_CUT = 2.0**-46
# How well a proof confirms inputs at best and at least [in the input's unit], and values: over
# themselves, besides what the rounding of their terms and of the input, over itself, makes of it.
TOLERANCE, WIDEST, VALUE, ROUNDING = 2.0**-32, 2.0**-20, 2.0**-32, 2.0**-50
NARROW = 2.0**-40               # what is tried first, of an input


class ProvenPiece(NamedTuple):
    """A piece of the input, in the mechanism's unit, with exactly one extremum of a quantity."""

    low: float
    high: float
    sense: int           # +1 maximum, -1 minimum


class Proof(NamedTuple):
    """All extrema of a quantity inside the paths, or why they are not known."""

    # Next to the ends of a range nothing is enclosed: extrema found there are taken as they are.

    linkage: Mechanism
    parts: list[ProvenPiece]
    enclose: Callable[[float, float], list[arb] | None] | None      # the quantity, for (Z1)
    is_square: bool                          # the square is enclosed, of a root
    is_angle: bool                           # values may differ by whole turns
    ends: list[tuple[int, float, float]]     # (side, input, width left out), in its unit
    cuts: list[float]                        # inputs in the mechanism's unit
    period: float                            # of the input
    why_not: str = ''

    def verdict(self, extrema: Sequence[PathExtremum]) -> str:
        """Return in words whether these are the extrema: as many, of the same kinds and values."""
        # each is matched with a part; the text says how well inputs are confirmed, or which is not
        if why_not := self.why_not or self._differs_at_cuts(extrema):
            return f'{NOT_PROVED}: {why_not}'
        interior = [extremum for extremum in extrema if extremum.side == 0 and extremum.sense
                    and not any(self._is_at(extremum, cut) for cut in self.cuts)]
        inside, left = [extremum for extremum in interior
                        if not self._is_left_out(extremum)], list(self.parts)
        if len(inside) != len(left):
            exist = len(left) + len(interior) - len(inside)
            return f'{NOT_PROVED}: {len(interior)} found, {exist} exist'
        coordinate, unit, width = self.linkage.input_coordinate, self.linkage.input_unit, TOLERANCE
        # beyond one of which paths may go
        turns = (0.0,) if self.period == inf else (-self.period, 0.0, self.period)
        for extremum in inside:
            part = next((part for part in left for turn in turns
                         if part.sense == extremum.sense and part.low - TOLERANCE <= extremum.x
                         + turn <= part.high + TOLERANCE), None)
            around = self._width(extremum) if part else inf
            if part is None or around == inf:
                kind = 'minimum' if extremum.sense < 0 else 'maximum'
                return (f'{NOT_PROVED}: no {kind} of {extremum.value:.12g} confirmed at '
                        f'{coordinate.position} = {unit * extremum.x:.12g}')
            left.remove(part)
            width = max(width, around)
        text = INTERVALS
        if width > TOLERANCE:
            text += f', places to {unit * width:.0e} {coordinate.unit}'
        if self.ends:
            text += (f', except {max(width for *_, width in self.ends):.0e} {coordinate.unit} '
                     'at the ends')
        if self.cuts:
            text += (f', except {unit * LEFT_OUT_AT_CUT:.0e} {coordinate.unit} where pieces end, '
                     'by both sides')
        return text

    def _differs_at_cuts(self, extrema: Sequence[PathExtremum]) -> str:
        """Return where extrema at a cut are not those that both sides of it tell, in words."""
        for cut in self.cuts:
            where = (f'at {self.linkage.input_coordinate.position} = '
                     f'{self.linkage.input_unit * cut:.12g}')
            sides: list[tuple[arb, arb, arb]] = []      # value at the cut, its error, the slope
            for side in (-1.0, 1.0):
                ends = sorted(cut + side * k * LEFT_OUT_AT_CUT for k in (1.0, 2.0))
                c = self.enclose(*ends) if self.enclose else None
                if c is None:
                    return f'not enclosed {where}'
                t = -0.5 * side * LEFT_OUT_AT_CUT
                slope, bend = polynomial(slopes(c), t), abs(polynomial(slopes(slopes(c)), t))
                sides.append((polynomial(c, t) - side * LEFT_OUT_AT_CUT * slope,
                              LEFT_OUT_AT_CUT**2 * bend
                              + OFF_CUT * max(abs(cut), 1.0) * abs(slope), slope))
            (before, error, fall), (after, more, rise) = sides
            if fall.contains(0) or rise.contains(0):
                return f'level {where}'
            expected = []
            if abs(after - before) > 4.0 * (error + more):
                expected = [(-1, 1 if fall > 0 else -1, before), (1, 1 if rise < 0 else -1, after)]
            elif (fall > 0) != (rise > 0):
                expected = [(0, 1 if fall > 0 else -1, after)]
            at_cut = sorted([extremum for extremum in extrema if self._is_at(extremum, cut)],
                            key=lambda extremum: extremum.side)
            if [(extremum.side, extremum.sense) for extremum in at_cut] != [
                    (side, sense) for side, sense, _ in expected]:
                return f'{len(at_cut)} found {where}, not confirmed'
            for extremum, (_, _, value) in zip(at_cut, expected):
                size = abs(extremum.value)
                off, bound = value - extremum.value, VALUE * size + extremum.noise
                if self.is_square:
                    off, bound = value - size * size, bound * (2.0 * size + bound)
                slack = LEFT_OUT_AT_CUT**2 * abs(rise) + 4.0 * (error + more)
                off -= 2.0 * pi * round(float(off.mid()) / (2.0 * pi)) * self.is_angle
                if not abs(off) <= bound + slack:
                    return f'{extremum.value:.12g} is not its value {where}'
        return ''

    def _is_at(self, extremum: PathExtremum, cut: float) -> bool:
        away = extremum.x - cut
        away -= 0.0 if self.period == inf else self.period * round(away / self.period)
        return abs(away) < LEFT_OUT_AT_CUT

    def _is_left_out(self, extremum: PathExtremum) -> bool:
        position = self.linkage.input_unit * extremum.x
        return any(0.0 < side * self.linkage.distance(position, end) < width
                   for side, end, width in self.ends)

    def _width(self, extremum: PathExtremum) -> float:
        """Return how near to its input an extremum is; inf: it may be far, or of another value."""
        # The interval about it is widened until the derivative is not zero at both ends: if it
        # changes its sign as the kind of extremum says, the extremum lies in it.
        width = NARROW          # beside change points wider intervals tell nothing
        while width < WIDEST and self.enclose:
            c = self.enclose(extremum.x - width, extremum.x + width)
            before, after = [extremum.sense * polynomial(slopes(c), t) if c else nan
                             for t in (-width, width)]
            if c and before > 0 > after:
                return width if self._has_value(c, extremum) else inf
            if width >= TOLERANCE and (before < 0 or after > 0):
                return inf
            width *= 16.0 if width < TOLERANCE else 2.0
        return inf

    def _has_value(self, c: list[arb], extremum: PathExtremum) -> bool:
        """Return whether a quantity with the coefficients ``c`` has the value of the extremum."""
        value, slope, bend, size = *(float(part.mid()) for part in c[:3]), abs(extremum.value)
        near, bound = ROUNDING * max(abs(extremum.x), TOLERANCE), VALUE * size + extremum.noise
        by_input = (abs(slope) + abs(bend) * near) * near
        if self.is_square:
            return (extremum.value >= 0.0 and abs(value - size * size)
                    <= bound * (2.0 * size + bound) + by_input)
        off = value - extremum.value
        return (abs(off - 2.0 * pi * round(off / (2.0 * pi)) * self.is_angle)
                <= bound + by_input)


def slopes(c: list[arb]) -> list[arb]:
    """Return the coefficients of the derivative."""
    return [k * c[k] for k in range(1, len(c))]


def polynomial(c: list[arb], t: arb | float) -> arb:
    """Return the value of a polynomial, by Horner's rule."""
    value = c[-1]
    for coefficient in c[-2::-1]:
        value = value * t + coefficient
    return value


def prove(linkage: Mechanism, quantities: Sequence[Asked], rates: tuple[float, float],
          paths: Sequence[InputPath], extrema: Sequence[Sequence[PathExtremum]],
          check: Callable[[float], None], seconds: float) -> list[Proof]:
    """Return a proof of each quantity, whose ``verdict`` compares extrema with it."""
    # extrema: those of each quantity; one that is constant in a range is not proved. check: called
    # before each piece with the share of the paths that is decided; an exception from it ends the
    # proof. seconds: of a processor, for each quantity; those still open then are not proved.
    unit, ends, pieces = linkage.input_unit, [], list[tuple[float, float]]()
    for path in paths:
        x, limits = path.x, path.ends()         # none of a path that closes
        for _, end in limits:                   # nothing is enclosed next to them
            width = limits[1][1].x - limits[0][1].x
            x = x[abs(x - end.x) > (LEFT_OUT if end.is_pole else LEFT_OUT_AT_LIMIT * width)]
        samples = x.tolist()
        ends += [(side, unit * end.x, unit * abs(end.x - samples[::side][0]))
                 for side, end in limits]
        samples += [samples[0] + path.period] if path.is_closed else []
        edges = samples[:-1:STRIDE] + samples[-1:]
        for low, high in zip(edges, edges[1:]):
            for cut in path.cuts.tolist():
                if low - LEFT_OUT_AT_CUT < cut < high + LEFT_OUT_AT_CUT:
                    pieces.append((low, cut - LEFT_OUT_AT_CUT))
                    low = cut + LEFT_OUT_AT_CUT
            pieces.append((low, high))
    pieces = [(low, high) for low, high in pieces if low < high]
    why_not = {i: 'constant in a range' for i, parts in enumerate(extrema)
               if not all(part.sense for part in parts)}
    try:
        enclose = Enclosing(linkage, quantities, rates)
    except ImportError:
        return [Proof(linkage, [], None, False, False, ends, [], inf, MISSING) for _ in quantities]
    why_not |= enclose.why_not
    parts = _search(enclose, pieces, why_not, check, seconds)
    cuts = [cut for path in paths for cut in path.cuts.tolist()]
    return [Proof(linkage, parts[i], partial(enclose.coefficients, i), i in enclose.squares,
                  is_position(quantity) or not is_published(quantity), ends, cuts,
                  linkage.cycle if quantity.is_load else linkage.period, why_not.get(i, ''))
            for i, quantity in enumerate(quantities)]


def _search(enclose: Enclosing, pieces: Sequence[tuple[float, float]], why_not: dict[int, str],
            check: Callable[[float], None], seconds: float) -> list[list[ProvenPiece]]:
    """Return the extrema of each quantity on pieces, which are cut until all are decided."""
    # Depth first, the lower part first. why_not: {quantity given up: reason}, added to; its parts
    # are not used. seconds: of a processor, for each quantity.
    asked = [i for i in range(len(enclose.quantities)) if i not in why_not]
    parts: list[list[ProvenPiece]] = [[] for _ in enclose.quantities]
    left, share, begin = [(*piece, asked) for piece in pieces], 0.0, thread_time()
    total = sum(high - low for low, high in pieces)
    while left:
        share = max(share, 1.0 - sum(high - low for low, high, _ in left) / total)
        check(share)
        low, high, rows = left.pop()
        where = f'at {enclose.name} = {enclose.unit * low:.6g}'
        if thread_time() - begin > seconds * len(parts):
            why_not.update({i: f'not decided in {seconds:g} s, {where}' for i in rows
                            if i not in why_not})
        middle, of_rows = enclose(low, high, [i for i in rows if i not in why_not])
        is_open = []
        for i, c in of_rows.items():         # c: coefficients of (Z1), None if not enclosed
            sense = _sense(c, low - middle, high - middle) if c else None
            if sense is None:
                is_open.append(i)
            elif sense:                      # 0: no extremum
                parts[i].append(ProvenPiece(low, high, sense))
        if high - low < NARROWEST * max(abs(low), 1.0):
            why_not.update(dict.fromkeys(is_open, 'a kink, or nearly two extrema at one place, '
                                                  + where))
        elif is_open:
            cut = low + CUT * (high - low)
            left += [(cut, high, is_open), (low, cut, is_open)]
    check(1.0)
    return parts


def _sense(c: list[arb], left: arb, right: arb) -> int | None:
    """Return the sense of the only extremum of a quantity between two t, 0 of none, else None."""
    # c: its series, (Z1).
    slope, radius = slopes(c), abs(left).max(abs(right))
    bend = slopes(slope)
    if abs(slope[0]) > polynomial([abs(k) for k in slope[1:]], radius) * radius:
        return 0
    if not abs(bend[0]) > polynomial([abs(k) for k in bend[1:]], radius) * radius:
        return None
    before, after = polynomial(slope, left), polynomial(slope, right)
    if before.contains(0) or after.contains(0) or not (before.is_finite() and after.is_finite()):
        return None
    return 0 if (before > 0) == (after > 0) else 1 if before > 0 else -1


class Enclosing:
    """Encloses some quantities of a mechanism over pieces of the input, given in its unit."""

    # why_not: {index of a quantity: why it cannot be enclosed}. squares: indices of roots, such as
    # magnitudes of forces: their squares are enclosed. ImportError without python-flint.

    def __init__(self, linkage: Mechanism, quantities: Sequence[Asked],
                 rates: tuple[float, float]) -> None:
        """Record the formulas of the quantities, and compute what does not depend on the input."""
        from flint import arb

        self.quantities, self.unit = quantities, linkage.input_unit
        self.name, self.why_not = linkage.input_coordinate.position, dict[int, str]()
        self._linkage, self._half = linkage, arb(0)
        self._table: Table = {**taylor_pairs(), 'call': self._calls}
        with_loads = linkage.has_loads and any(
            quantity.is_load or not is_published(quantity) for quantity in quantities)
        self._formula = formula_of(linkage, with_loads)
        data = self._formula.data
        self._trace = trace = Trace(self._make, 1, (rates, data))
        indices = flat(trace.results)
        operations = [trace.steps[index].operation for index in indices]
        self.squares = {i for i, name in enumerate(operations) if name in ('hypot', 'sqrt')}
        self._is_hypot = [name == 'hypot' for name in operations]
        self._results = [trace.steps[index].arguments if i in self.squares else (index,)
                         for i, index in enumerate(indices)]
        for i, of_quantity in enumerate(self._results):
            if any(step.operation == 'call' and not hasattr(step.value, 'polynomial')
                   for step in map(trace.steps.__getitem__, trace.needed(of_quantity))):
                self.why_not[i] = 'functions over a position are not enclosed'
            elif linkage.friction and quantities[i].is_load:
                self.why_not[i] = 'friction is not enclosed'
        self._values: list[Any] = [
            None if number is None else (arb(number), arb(number))
            for number in trace.numbers([*rates, *numbers_of(data)])]
        self._orders: dict[tuple[int, ...], list[int]] = {}
        # what must hold all over a piece: which of several |sines| is the least, where an angle
        # has a kink, and that a force one way acts or does not
        one_way = any(element.is_one_way for element in linkage.elements)
        self._choices = {
            index for index, (operation, arguments, _) in enumerate(trace.steps)
            if operation in ('gt', 'lt') and (all(
                trace.steps[i].operation == 'fabs' for i in arguments) or one_way and any(
                trace.steps[i].operation == 'constant' for i in arguments))}
        with arb_settings(BITS, ORDER + 2):
            enclosed = tuple([i for i in range(len(quantities)) if i not in self.why_not])
            run(trace, [index for index in self._needed(enclosed)
                        if index not in trace.varies], self._table, self._values)

    def _make(self, number_type: NumberType, constants: Any) -> Function:
        """Return the formula position -> quantities, of :func:`Trace`, for rates and constants."""
        rates, data = constants
        step = self._formula.make(number_type, data)

        def values(position: Any) -> list[Any]:
            """Return the quantities; 0 of a function that does other things than arithmetic."""
            fields = step(position, *rates)
            motion, loads = fields if self._formula.with_loads else (fields, None)
            state = (self._linkage.MOTION(*motion),
                     self._linkage.LOADS(*loads) if loads else NoLoads())
            results: list[Any] = []
            for i, quantity in enumerate(self.quantities):
                try:
                    value = quantity.of(*state)
                    if not isinstance(value, (Number, float, int)):
                        raise TypeError(f'it returns {type(value).__name__}')
                    results.append(value)
                except (TypeError, AttributeError) as error:
                    self.why_not[i] = f'the function does not work on enclosures ({error})'
                    results.append(0.0)
            return results
        return values

    def _needed(self, rows: tuple[int, ...]) -> list[int]:
        if rows not in self._orders:
            self._orders[rows] = [
                index for index in self._trace.needed([
                    index for i in rows for index in self._results[i]])
                if not self._trace.steps[index].is_given]
        return self._orders[rows]

    def __call__(self, low: float, high: float, rows: Sequence[int]
                 ) -> tuple[arb, dict[int, list[arb] | None]]:
        """Return the middle of a piece, and of quantities the coefficients of (Z1), if known."""
        from flint import arb, arb_series

        middle, values = arb(0.5 * (low + high)), list(self._values)
        with arb_settings(BITS, ORDER + 2):
            self._half = 0.5 * (arb(high) - arb(low))
            values[0] = tuple([arb_series([self.unit * x, self.unit], terms) for x, terms in (
                (middle, ORDER + 1), (arb(low).union(arb(high)), ORDER + 2))])
            try:
                run(self._trace, [index for index in self._needed(tuple(rows))
                                  if index in self._trace.varies], self._table, values)
                return middle, {i: self._coefficients(i, values) for i in rows}
            except (ValueError, ZeroDivisionError):     # a divisor may vanish
                return middle, dict.fromkeys(rows)

    def _calls(self, function: Any) -> Function:
        """Return a table of forces as a function of pairs of series; NaN over several pieces."""
        # a pair: the series of s about the middle of the piece of the input, and over all of it
        from flint import arb

        def values(s: Any) -> Any:
            about, over = s
            reach = over[0]
            if abs(over[1]) > 0:        # s rises or falls all over the piece: its ends tell more
                c = [*[about[k] for k in range(ORDER + 1)], over[ORDER + 1]]
                reach = polynomial(c, -self._half).union(polynomial(c, self._half))
            coefficients, offset, low, high = function.polynomial(float(about[0].mid()))
            if not (reach >= low and reach <= high):
                return about * arb.nan(), over * arb.nan()
            return tuple([polynomial([arb(k) for k in coefficients[::-1]], each - arb(offset))
                          for each in s])
        return values

    def coefficients(self, i: int, low: float, high: float) -> list[arb] | None:
        """Return the coefficients of (Z1) of a quantity on a short piece."""
        return self(low, high, [i])[1][i]

    def _coefficients(self, i: int, values: Sequence[Any]) -> list[arb] | None:
        """Return c_0 to c_n and C of (Z1) of a quantity, from the values of the trace."""
        # None where a choice may not be the same all over the piece.
        from flint import arb_series

        if not all(values[index][1] for index in self._needed((i,)) if index in self._choices):
            return None
        zero = arb_series([0], ORDER + 2)       # the sum is a series, also of constants
        about, over = [sum(part, zero) for part in zip(*[
            self._table['mul'](values[index], values[index]) if self._is_hypot[i]
            else values[index] for index in self._results[i]])]
        return [*[about[k] for k in range(ORDER + 1)], over[ORDER + 1]]
