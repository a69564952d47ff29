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
from fourbar_ros.numerics.tables import run
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
    """
    All extrema of a quantity inside the paths, or why they are not known.

    Next to the ends of a range nothing is enclosed: extrema found there are taken as they are.
    """

    linkage: Mechanism
    parts: list[ProvenPiece]
    enclose: Callable[[float, float], list[arb] | None] | None      # the quantity, for (Z1)
    is_square: bool                          # the square is enclosed, of a root
    is_angle: bool                           # values may differ by whole turns
    ends: list[tuple[int, float, float]]     # (side, input, width left out), in its unit
    why_not: str = ''

    def verdict(self, extrema: Sequence[PathExtremum]) -> str:
        """
        Return a text on whether these are the extrema: as many, of the same kinds, inputs, values.

        Each extremum is matched with a part; the text says how well inputs are confirmed, or
        which one is not.
        """
        if self.why_not:
            return f'{NOT_PROVED}: {self.why_not}'
        interior = [extremum for extremum in extrema if extremum.side == 0 and extremum.sense]
        inside, left = [extremum for extremum in interior
                        if not self._is_left_out(extremum)], list(self.parts)
        if len(inside) != len(left):
            exist = len(left) + len(interior) - len(inside)
            return f'{NOT_PROVED}: {len(interior)} found, {exist} exist'
        coordinate, unit, width = self.linkage.input_coordinate, self.linkage.input_unit, TOLERANCE
        period = self.linkage.period        # of an angle, beyond which paths may go
        turns = (0.0,) if period == inf else (-period, 0.0, period)
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
        return text

    def _is_left_out(self, extremum: PathExtremum) -> bool:
        """Return whether an extremum is so near to an end that nothing is enclosed there."""
        position = self.linkage.input_unit * extremum.x
        return any(0.0 < side * self.linkage.distance(position, end) < width
                   for side, end, width in self.ends)

    def _width(self, extremum: PathExtremum) -> float:
        """
        Return how near to its input an extremum is, inf if it may be far or has another value.

        The interval about it is widened until the derivative is not zero at both ends: if it
        changes its sign as the kind of extremum says, the extremum lies in it.
        """
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
    """
    Return a proof of each quantity, whose ``verdict`` compares extrema with it.

    ``extrema``: those of each quantity; one that is constant in a range is not proved.
    ``check``: called before each piece with the share of the paths that is decided; an
    exception from it ends the proof. ``seconds``: of a processor, for each quantity; those
    still open then are not proved.
    """
    paths, unit = [_away_from_ends(path) for path in paths], linkage.input_unit
    ends = [(side, unit * end.x, unit * abs(end.x - path.x[path.inward(side)[0]]))
            for path in paths for side, end in path.ends()]
    why_not = {i: 'constant in a range' for i, parts in enumerate(extrema)
               if not all(part.sense for part in parts)}
    try:
        enclose = Enclosing(linkage, quantities, rates)
    except ImportError:
        return [Proof(linkage, [], None, False, False, ends, MISSING) for _ in quantities]
    why_not |= enclose.why_not
    parts = _search(enclose, [piece for path in paths for piece in _pieces(path)], why_not, check,
                    seconds)
    return [Proof(linkage, parts[i], partial(enclose.coefficients, i), i in enclose.squares,
                  is_position(quantity) or not is_published(quantity), ends, why_not.get(i, ''))
            for i, quantity in enumerate(quantities)]


def _away_from_ends(path: InputPath) -> InputPath:
    """Return a path without its samples next to poles and limits."""
    if path.is_closed:
        return path
    ends = [end for _, end in path.ends()]
    limit = LEFT_OUT_AT_LIMIT * (ends[1].x - ends[0].x)
    return path._replace(x=path.x[[
        all(abs(x - end.x) > (LEFT_OUT if end.is_pole else limit) for end in ends)
        for x in path.x.tolist()]])


def _pieces(path: InputPath) -> list[tuple[float, float]]:
    """Return the pieces (low, high) between every fourth sample of a path."""
    x = path.x.tolist()
    x += [x[0] + path.period] if path.is_closed else []
    edges = x[:-1:STRIDE] + x[-1:]
    return list(zip(edges, edges[1:]))


def _search(enclose: Enclosing, pieces: Sequence[tuple[float, float]], why_not: dict[int, str],
            check: Callable[[float], None], seconds: float) -> list[list[ProvenPiece]]:
    """
    Return the extrema of each quantity on some pieces: enclose and cut until all are decided.

    Depth first, the lower part first. ``why_not``: {quantity given up: reason}, added to; its
    parts are not used. ``seconds``: of a processor, for each quantity.
    """
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
    """
    Return the sense of the only extremum of a quantity between two t, 0 of none, else None.

    ``c``: its series, (Z1).
    """
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
    """
    Encloses some quantities of a mechanism over pieces of the input, given in its unit.

    ``why_not``: {index of a quantity: why it cannot be enclosed}. ``squares``: indices of roots,
    such as magnitudes of forces: their squares are enclosed. ImportError without python-flint.
    """

    def __init__(self, linkage: Mechanism, quantities: Sequence[Asked],
                 rates: tuple[float, float]) -> None:
        """Record the formulas of the quantities, and compute what does not depend on the input."""
        from flint import arb

        self.quantities, self.unit = quantities, linkage.input_unit
        self.name, self.why_not = linkage.input_coordinate.position, dict[int, str]()
        self._linkage, self._table = linkage, taylor_pairs()
        with_loads = linkage.has_loads and any(
            quantity.is_load or not is_published(quantity) for quantity in quantities)
        self._formula, data = formula_of(linkage, with_loads)
        self._trace = trace = Trace(self._make, 1, (rates, data))
        indices = flat(trace.results)
        operations = [trace.steps[index].operation for index in indices]
        self.squares = {i for i, name in enumerate(operations) if name in ('hypot', 'sqrt')}
        self._is_hypot = [name == 'hypot' for name in operations]
        self._results = [trace.steps[index].arguments if i in self.squares else (index,)
                         for i, index in enumerate(indices)]
        for i, of_quantity in enumerate(self._results):
            if any(trace.steps[k].operation == 'call' for k in trace.needed(of_quantity)) or (
                    linkage.pieces and linkage.pieces.ends and quantities[i].is_load):
                self.why_not[i] = ('forces over a position and torsion springs that come round '
                                   'are not enclosed')
            elif linkage.friction and quantities[i].is_load:
                self.why_not[i] = 'friction is not enclosed'
        self._values: list[Any] = [
            None if number is None else (arb(number), arb(number))
            for number in trace.numbers([*rates, *numbers_of(data)])]
        self._orders: dict[tuple[int, ...], list[int]] = {}
        self._leasts = {index for index, step in enumerate(trace.steps)
                        if step.operation == 'lt'
                        and all(trace.steps[i].operation == 'fabs' for i in step.arguments)}
        with arb_settings(BITS, ORDER + 2):
            enclosed = tuple([i for i in range(len(quantities)) if i not in self.why_not])
            run(trace, [index for index in self._needed(enclosed)
                        if index not in trace.varies], self._table, self._values)

    def _make(self, number_type: NumberType, constants: Any) -> Function:
        """Return the formula of all quantities, position -> values, from rates and data."""
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
                    results.append(_recorded(quantity.of(*state)))
                except (TypeError, AttributeError) as error:
                    self.why_not[i] = f'the function does not work on enclosures ({error})'
                    results.append(0.0)
            return results
        return values

    def _needed(self, rows: tuple[int, ...]) -> list[int]:
        """Return the indices of the operations that some quantities need, in order."""
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
            values[0] = tuple([arb_series([self.unit * x, self.unit], terms) for x, terms in (
                (middle, ORDER + 1), (arb(low).union(arb(high)), ORDER + 2))])
            try:
                run(self._trace, [index for index in self._needed(tuple(rows))
                                  if index in self._trace.varies], self._table, values)
                return middle, {i: self._coefficients(i, values) for i in rows}
            except (ValueError, ZeroDivisionError):     # a divisor may vanish
                return middle, dict.fromkeys(rows)

    def coefficients(self, i: int, low: float, high: float) -> list[arb] | None:
        """Return the coefficients of (Z1) of a quantity on a short piece."""
        return self(low, high, [i])[1][i]

    def _coefficients(self, i: int, values: Sequence[Any]) -> list[arb] | None:
        """
        Return c_0 to c_n and C of (Z1) of a quantity, from the values of the trace.

        None where one of several |sines| may become the least: there an angle has a kink.
        """
        if not all(values[index][1] for index in self._needed((i,)) if index in self._leasts):
            return None
        from flint import arb_series

        zero = arb_series([0], ORDER + 2)       # the sum is a series, also of constants
        about, over = [sum(part, zero) for part in zip(*[
            self._table['mul'](values[index], values[index]) if self._is_hypot[i]
            else values[index] for index in self._results[i]])]
        return [*[about[k] for k in range(ORDER + 1)], over[ORDER + 1]]


def _recorded(value: Any) -> Any:
    """Return what a function of a user gave, if it is one number."""
    if not isinstance(value, (Number, float, int)):
        raise TypeError(f'it returns {type(value).__name__}')
    return value
