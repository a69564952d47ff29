# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Quantities of a mechanism and their derivatives with respect to its input, at many points at once.

The derivative is exact: a complex step through the same formulas that compute the quantity. Users'
functions that know no complex numbers (abs, max, a table) have differences, in the second class.
"""
from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from copy import copy
from decimal import Decimal, localcontext
from functools import cache
from itertools import repeat
from math import pi, sqrt
from numbers import Real
from typing import Any, ClassVar, NamedTuple, NoReturn

from fourbar_ros.errors import InvalidParameter
from fourbar_ros.extrema.input_paths import InputPath, PIECE
from fourbar_ros.mechanisms.batches import step_of_arrays
from fourbar_ros.mechanisms.evaluation import formula_of
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.parts import NamedFields, NoLoads
from fourbar_ros.mechanisms.quantities import Asked, is_position, is_published
from fourbar_ros.numerics.arrays import Array, EPS, Value, Values
from fourbar_ros.numerics.digits import in_decimals, MANY_DIGITS
from fourbar_ros.numerics.number_types import Function, numbers_of
from fourbar_ros.numerics.roots import fold
from fourbar_ros.numerics.trace import flat, Trace
import numpy as np

# Distances from a flat position, in the unit of the input, and 64 times nearer ones: a quantity
# that grows from one to the nearer one as one over both has a pole there. The first distance sees
# poles well above rounding, the second weak ones. No size of a float is below SMALLEST.
FAR, NEAR, SMALLEST = (2.0**-20, 2.0**-30), (2.0**-26, 2.0**-36), 2.0**-1022
# So near to a limit that is a change point errors of accelerations are eps over the third power of
# the distance [in the unit of the input].
BESIDE_DOUBLE_ROOTS = 2.0**-6
# Complex step: its square vanishes next to one, and it is far below the distance of any sample
# from a toggle or a pole. Of lengths below the least [m] it is no number beside the real part.
STEP, LEAST_LENGTH = 2.0**-200, 2.0**-768
# Relative steps of a length, for conditions by differences: at most the first; a part of the
# distance to the next change point, where everything changes; but never lost in rounding.
MOST_CHANGE, PART, LEAST_CHANGE = 2.0**-26, 2.0**-10, 2.0**-46
SAME_TURN = 2.0**-30        # middles of angles that differ by less, as part of a turn, are alike
# Step of real differences, in samples: their error is about as large as rounding.
DIFFERENCE = 2.0**-11
# Of values of a function: it has a pole where it is less beside, at a fraction of a sample.
POLE = 2.0**-20
OFF_CUT = 2.0**-12      # how far off the end of a piece they are taken at least, in samples

State = tuple[NamedFields, NamedFields | NoLoads]     # motion and loads of floats or arrays


class Samples(NamedTuple):
    """Some quantities at the n samples of one path, arrays of shape (quantities, n)."""

    path: InputPath
    values: Array       # each in its unit
    slopes: Array       # their derivatives with respect to the input in its unit
    state: State        # motion and loads from which they come: fields of shape (n,), or floats
    rounding: Array     # the least rounding errors of the values
    noise: Array        # bounds of them, large next to toggles and poles
    sine: Array         # of the transmission angle, but for the factors of flat positions passed


def not_real(quantity: Asked, result: str) -> InvalidParameter:
    """Return the error of a function whose ``result`` at an input is no finite real number."""
    return InvalidParameter('quantities', quantity.name, 'a function must give a finite real '
                            f'number for each input inside the range, not {result}')


def whole_turns(low: Values, high: Values) -> Values:
    """Return by how many turns [rad] angles from low to high are off from about zero."""
    # Without these their middle is from -pi to pi; one that is at half a turn is at pi, be it by
    # rounding below -pi or not.
    return 2.0 * pi * np.ceil((low + high) / (4.0 * pi) - 0.5 - SAME_TURN)


def exactly_scaled(values: Array, size: Array) -> Array:
    """Return values over a power of two next to a size: no product with one overflows."""
    return np.asarray(np.ldexp(values, -np.frexp(size)[1]))


class Sampler:
    """Values and derivatives of some quantities of a mechanism in its mode."""

    # The input x is in units of Mechanism.input_unit. rates: rate and acceleration of the input.
    # poles: those flat positions of a change point at which the quantities have poles, as joint
    # reactions may [rad or m]. Raises MissingBodies or UnknownBaseMotion if a quantity needs loads
    # and the linkage has none.

    # Step of real differences of derivatives, in samples: little enough for Newton's method.
    TURN: ClassVar[float] = 2.0**-24

    def __init__(self, linkage: Mechanism, quantities: Sequence[Asked],
                 rates: tuple[float, float], poles: Sequence[float] = ()) -> None:
        self.linkage, self.quantities, self.rates = linkage, quantities, rates
        if max(map(abs, linkage.lengths)) < LEAST_LENGTH:
            raise InvalidParameter('lengths', linkage.lengths, 'too small: derivatives underflow')
        self.needs_loads = any(q.is_load for q in quantities)
        if self.needs_loads:
            linkage.require_loads()
        self.period = linkage.cycle if self.needs_loads else linkage.period
        self.unit: float = linkage.input_unit
        self.is_angle = np.array([is_position(q) and q.unit == 'rad' for q in quantities])
        # flat positions of a change point through which all quantities go on
        self._passed_flats = np.array(
            [x for x in linkage.flat_inputs if x not in poles]) / self.unit
        # of published quantities no other field is needed for their values; functions of the
        # user may read loads
        known = linkage.MOTION._fields + linkage.LOADS._fields
        self._wanted = ([known.index(q.name) for q in quantities]
                        if all(map(is_published, quantities)) else None)
        self._has_loads = linkage.has_loads and (self.needs_loads or self._wanted is None)
        self._step = step_of_arrays(linkage, self._has_loads)
        self._values = step_of_arrays(linkage, self._has_loads, wanted=self._wanted)

    def along(self, path: InputPath) -> Samples:
        """Return the samples of a path; refuse functions that are NaN, rates that overflow."""
        with np.errstate(over='ignore', invalid='ignore'):
            values, slopes, state = self.sample(path.x)
        for quantity, row in zip(self.quantities, np.isnan(values)):
            if row.any() and not is_published(quantity):
                x = self.unit * float(path.x[row.argmax()])
                raise not_real(quantity, f'NaN at the input {x}')
        if np.isinf(values).any() or np.isinf(slopes).any():
            raise InvalidParameter('rate, acceleration', self.rates,
                                   'too large: quantities overflow')
        if self.is_angle.any():         # without jumps
            values[self.is_angle] = np.unwrap(values[self.is_angle], axis=1)
        return Samples(path, values, slopes, state, *self.errors(path.x, state))

    def same_turn(self, reference: Array, values: Array, row: Array) -> Array:
        """Return values of quantities ``row``, angles within half a turn of a reference angle."""
        if not self.is_angle.any():
            return values
        with np.errstate(invalid='ignore'):
            turns = np.round((reference - values) / (2.0 * pi))
            return np.where(self.is_angle[row] & (turns != 0.0), values + 2.0 * pi * turns,
                            values)

    def by_lengths(self, x: Array, row: Array) -> Array:
        """Return derivatives of quantity ``row[i]`` at x[i] by log(lengths), (n, lengths)."""
        lengths = np.array(self.linkage.lengths)
        columns = lengths[:, None, None] * (1.0 + 1j * STEP * np.eye(lengths.size)[..., None])
        values = self._with(columns).values(np.tile(x + 0.0j, (lengths.size, 1)))
        return np.asarray(values[row, ..., np.arange(row.size)].imag / STEP)

    def _with(self, lengths: Sequence[Any]) -> Sampler:
        """Return a copy for other lengths, columns (n, 1), and for inputs of shape (n, ...)."""
        sampler = copy(self)
        sampler._values = step_of_arrays(self.linkage, self._has_loads, wanted=self._wanted,
                                         data=self.linkage.constants_of(lengths))
        return sampler

    def fold(self, x: Value) -> Value:
        """Return inputs as they are reported: angles from zero to the period."""
        return x if self.linkage.is_driven_by_slide else fold(x, self.period)

    def state(self, x: Array, step: Function | None = None) -> State:
        """Return motion and loads at real or complex x; all fields, or those of ``step``."""
        position, reaches = self.unit * x, self.linkage.reaches
        if reaches is not None:
            position = np.where(reaches(position), position, np.nan)
        with np.errstate(all='ignore'):
            return self._records((step or self._step)(position, *self.rates))

    def _records(self, fields: Sequence[Any]) -> State:
        count = len(self.linkage.MOTION._fields)
        return (self.linkage.MOTION(*fields[:count]),
                self.linkage.LOADS(*fields[count:]) if self._has_loads else NoLoads())

    def poles(self) -> list[tuple[float, ...]]:
        """Return for each quantity the flat positions of a change point at which it has a pole."""
        flats = np.array(self.linkage.flat_inputs)
        on_both_sides = np.concatenate((FAR, np.negative(FAR), NEAR, np.negative(NEAR)))
        x = np.add.outer(flats / self.unit, on_both_sides).ravel()
        # the noise is that of quantities that do have poles there, the larger one
        with_poles = type(self)(self.linkage, self.quantities, self.rates,
                                self.linkage.flat_inputs)
        _, noise, _ = with_poles.errors(x, self.state(x))
        far, near = np.split(np.abs(self.values(x)).reshape(-1, flats.size, 8), 2, axis=-1)
        noise = noise.reshape(-1, flats.size, 8)[..., 4:]
        grows = (near > 4.0 * far) & (near > 16.0 * noise)
        return [tuple(flats[is_pole].tolist()) for is_pole in np.any(grows, axis=-1)]

    def values(self, x: Array) -> Array:
        """Return the quantities at x, shape (quantities, *x.shape)."""
        state = self.state(x, self._values)
        with np.errstate(all='ignore'):
            return self._rows(state, x)

    def _rows(self, state: State, x: Array) -> Array:
        """Return the quantities of a state at x, (quantities, *x.shape)."""
        rows = np.empty((len(self.quantities), *x.shape), x.dtype)
        for row, quantity in zip(rows, self.quantities):
            value = quantity.of(*state)
            if np.iscomplexobj(value) and x.dtype.kind != 'c':
                raise not_real(quantity, 'complex')
            row[:] = value
        return rows

    def sample(self, x: Array) -> tuple[Array, Array, State]:
        """Return values and derivatives at x by a complex step, (quantities, n), and the state."""
        motion, loads = state = self.state(x + 1j * STEP)
        with np.errstate(all='ignore'):
            values = self._rows(state, x + 1j * STEP)
        if isinstance(loads, tuple):
            loads = self.linkage.LOADS(*map(np.real, loads))
        return values.real, values.imag / STEP, (self.linkage.MOTION(*map(np.real, motion)), loads)

    def value_and_slope(self, x: Array, row: Array) -> tuple[Array, Array]:
        """Return value and derivative of quantity ``row[i]`` at x[i], or x[:, i], both exact."""
        values = self.values(x + 1j * STEP)[row, ..., np.arange(row.size)]
        return values.real, values.imag / STEP

    def slope(self, x: Array, row: Array) -> Array:
        return self.value_and_slope(x, row)[1]

    def newton(self, x: Array, row: Array, spacing: Array,
               is_squared: Array) -> tuple[Array, ...]:
        """Return slopes of quantity ``row[i]`` (or half its square) and Newton's step to zero."""
        turn = self.TURN * spacing
        both = self.value_and_slope(np.concatenate((x, x + turn)), np.concatenate((row, row)))
        value, slope = (part.reshape(2, -1) for part in both)
        here, there = np.where(is_squared, exactly_scaled(value, value[0]) * slope, slope)
        with np.errstate(divide='ignore', invalid='ignore'):
            return here, here * turn / (there - here)

    def exact(self, x: Array, row: Array) -> Array:
        """Return quantity ``row[i]`` at x[i] in many digits, ms for each x; NaN of 0/0."""
        # and of functions that do more than a trace records
        recorded = self.linkage.record(self._has_loads)
        data = numbers_of(formula_of(self.linkage, self._has_loads).data)
        results, traces = flat(recorded.trace.results), dict[int, Trace]()
        for i in set(row.tolist()):
            with suppress(Exception):       # such a function may raise anything of a trace
                traces[i] = Trace(lambda *_, of=self.quantities[i].of: (
                    lambda *fields: (of(*self._records(fields)),)), len(results))

        values_of = {i: in_decimals(trace, (), trace.results) for i, trace in traces.items()}

        @cache
        def make_fields(rows: frozenset[int]) -> Function:
            needed = sorted({k for i in rows for k in traces[i].needed(traces[i].results)
                             if k < len(results)})
            fields_of = in_decimals(recorded.trace, data, [results[k] for k in needed])

            def fields(*inputs: Decimal) -> list[Decimal | None]:
                by_index = dict(zip(needed, fields_of(*inputs)))
                return [*map(by_index.get, range(len(results)))]
            return fields

        values = np.full(x.size, np.nan)
        with localcontext(MANY_DIGITS):
            for position in np.unique(x).tolist():
                which = [k for k in np.flatnonzero(x == position).tolist() if row[k] in traces]
                with suppress(ArithmeticError, ValueError):
                    fields = make_fields(frozenset(row[which].tolist()))(
                        *map(Decimal, (float(self.unit * position), *self.rates)))
                    for k in which:
                        with suppress(ArithmeticError, ValueError):
                            values[k] = values_of[row[k]](*fields)[0]
        return values

    def errors(self, x: Array, state: State) -> tuple[Array, Array, Array]:
        """
        Return the least rounding errors of each quantity, and a bound of them, (quantities, n).

        They are some eps times the sizes of the terms that add up to it. Example: the shaking
        force of a balanced linkage is zero, and its computed value the rounding of joint reactions
        that cancel. And the sine that the bound is over, (n,), without its zeros at the flat
        positions that quantities pass. ``state``: a real one at x, as :meth:`sample` returns it.
        """
        motion, loads = state
        sine = np.broadcast_to(np.abs(self.linkage.transmission_sine(motion).real), x.shape)
        of_reactions = np.clip(sine, SMALLEST, 1.0)     # lose digits in line, with a pole or not
        for flat_x in self._passed_flats:
            away = x.real - flat_x
            size = np.abs(away if self.linkage.is_driven_by_slide else np.sin(0.5 * away))
            sine = np.where(size > 0.0, sine / np.maximum(size, SMALLEST), 1.0)
        off_real = [z / self.unit for z in self.linkage.singular_inputs if z.imag]
        if self._passed_flats.size and off_real:    # so near to these digits are lost all the same
            away = x.real[..., None] - np.array(off_real)
            if not self.linkage.is_driven_by_slide:
                away = away - 2.0 * pi * np.round(away.real / (2.0 * pi))
            near = np.abs(away).min(axis=-1)
            sine = np.minimum(sine, np.maximum(of_reactions, near))
            of_reactions = of_reactions * np.minimum(near, 1.0)
        for limit in set(self.linkage.flat_limits):     # a double root of a margin
            away = x.real - limit / self.unit
            if not self.linkage.is_driven_by_slide:
                away = away - 2.0 * pi * np.round(away / (2.0 * pi))
            sine = np.where(np.abs(away) < BESIDE_DOUBLE_ROOTS,
                            np.minimum(sine, np.abs(away)**3), sine)
        # {unit: size of the terms of quantities in it}
        size, omega, alpha = max(map(abs, self.linkage.lengths)), 0.0, 0.0
        for joint in [joint.coordinate for joint in self.linkage.JOINTS]:
            # a bar that reaches as far as a slide turns by what it moves, over the distance
            reach = (1.0 if joint.unit == 'rad'
                     else np.maximum(abs(getattr(motion, joint.position).real), size))
            omega = omega + abs(getattr(motion, joint.rate).real) / reach
            alpha = alpha + abs(getattr(motion, joint.acceleration).real) / reach
        alpha = alpha + omega * omega
        scales: dict[str, Any] = {'rad': 1.0, 'm': size, 'rad/s': omega, 'rad/s^2': alpha,
                                  'm/s': size * omega, 'm/s^2': size * alpha}
        if self.needs_loads:
            scales['N'] = force = sum(abs(getattr(loads, name).real)
                                      for name in self.linkage.reactions)
            scales['N m'] = size * force
            scales['W'] = abs(self.rates[0]) * (
                force if self.linkage.is_driven_by_slide else scales['N m'])
        least = 64.0 * EPS * np.stack([np.broadcast_to(scales.get(q.unit, 0.0), np.shape(sine))
                                       for q in self.quantities])
        is_reaction = np.array([q.name.startswith(self.linkage.reactions)
                                for q in self.quantities])[:, None]
        return least, least / np.where(is_reaction, np.minimum(of_reactions, sine),
                                       np.minimum(sine, 1.0)), sine


class DifferenceSampler(Sampler):
    """The same for quantities without a complex step: derivatives by differences."""

    TURN = 2.0**-6

    _x: Array                # samples of the path in rising order
    _cuts: Array             # where pieces end on it, -inf and inf: no difference reaches over one

    def along(self, path: InputPath) -> Samples:
        self._x = np.sort(path.x)
        ends = np.array([end.x for _, end in path.ends() if end.kind == PIECE])
        cuts = np.concatenate((path.cuts, path.cuts - path.period if path.is_closed else ends))
        self._cuts = np.concatenate(([-np.inf], np.unique(cuts), [np.inf]))
        return super().along(path)

    def _rows(self, state: State, x: Array) -> Array:
        """Return the quantities of a state at x, (quantities, *x.shape)."""
        try:
            return super()._rows(state, x)
        except (TypeError, ValueError):       # a function of plain numbers: one sample at a time
            motions, loads = (zip(*(np.broadcast_to(f, x.shape).ravel().tolist() for f in part))
                              if isinstance(part, tuple) else repeat(part) for part in state)
            states = [(self.linkage.MOTION(*v), self.linkage.LOADS(*w) if isinstance(w, tuple)
                       else w)
                      for v, w in zip(motions, loads)]
            rows = []
            for quantity in self.quantities:
                values = [quantity.of(*state) for state in states]
                for value in values:
                    if not isinstance(value, Real) and np.ndim(value) + np.iscomplexobj(value):
                        raise not_real(quantity, 'complex' if np.iscomplexobj(value)
                                       else repr(value)) from None
                try:
                    rows.append([float(value) for value in values])
                except (TypeError, ValueError):
                    raise not_real(quantity, repr(values[0])) from None
            return np.reshape(rows, (-1, *x.shape))

    def sample(self, x: Array) -> tuple[Array, Array, State]:
        """Return values and slopes at x; the distances of the samples of a path give the steps."""
        state = self.state(x)
        with np.errstate(all='ignore'):
            values = self._rows(state, x)
        return values, np.stack([self.slope(x, np.full(x.size, row))
                                 for row in range(len(self.quantities))]), state

    def steps(self, x: Array) -> tuple[Array, Array]:
        """Return where to take differences for x, off the ends of pieces, and their step."""
        i = np.clip(np.searchsorted(self._x, x), 1, self._x.size - 1)
        spacing = self._x[i] - self._x[i - 1]
        k = np.searchsorted(self._cuts[1:-1], x, side='right') + 1      # also of NaN, of a kink
        low, high = self._cuts[k - 1], self._cuts[k]
        off = np.minimum(OFF_CUT * spacing, 0.25 * (high - low))
        x = np.clip(x, low + off, high - off)
        return x, np.minimum(DIFFERENCE * spacing, 0.25 * np.minimum(x - low, high - x))

    def value_and_slope(self, x: Array, row: Array) -> tuple[Array, Array]:
        """Return value and derivative: its mean between two points, of the sign it has there."""
        near, h = self.steps(x)
        points = np.concatenate((x, near - h, near + h), axis=-1)
        value, low, high = np.split(
            self.values(points)[np.tile(row, 3), ..., np.arange(3 * row.size)], 3)
        return value, (high - low) / (2.0 * h.T)

    def by_lengths(self, x: Array, row: Array) -> Array:
        # Steps are parts of the distances to a change point and to lengths that cannot close,
        # which a range of the input narrows as the root of; NaN where even so nothing closes.
        linkage, count = self.linkage, len(self.linkage.lengths)
        width = min([1.0, *((high - low) / self.unit for low, high in linkage.closing_ranges)])
        step = max(LEAST_CHANGE, min(MOST_CHANGE, PART * linkage.change_point_margin,
                                     PART * width * width))
        around = np.array(linkage.lengths)[:, None] * (
            1.0 + step * np.eye(count)[:, [*range(count)] * 2] * np.repeat((1.0, -1.0), count))
        values = self._with(around[..., None]).values(np.tile(x, (2 * count, 1)))
        up, down = np.split(values[row, ..., np.arange(row.size)], 2, axis=1)
        return np.asarray(self.same_turn(0.0 * up, up - down, row[:, None]) / (2.0 * step))

    def polish(self, x: Array, row: Array, sense: Array) -> Array:
        """Return extrema x, those of a ``sense`` +-1 at a kink of the quantity more exactly."""
        # by golden section, which needs no slope
        near, h = self.steps(x)
        low, high = near - 4.0 * h, near + 4.0 * h
        part, i = 0.5 * (sqrt(5.0) - 1.0), np.arange(x.size)
        for _ in range(56):     # for all brackets at once, unlike scipy's minimize_scalar
            left, right = high - part * (high - low), low + part * (high - low)
            keeps_low = sense * self.values(left)[row, i] > sense * self.values(right)[row, i]
            low, high = np.where(keeps_low, low, left), np.where(keeps_low, right, high)
        better = 0.5 * (low + high)
        gain = sense * (self.values(better)[row, i] - self.values(x)[row, i])
        better = np.where(gain > 64.0 * EPS * np.abs(self.values(x)[row, i]), better, x)
        beside = np.maximum(*np.abs([self.values(near + side * 4.0 * h)[row, i]
                                     for side in (-1.0, 1.0)]))
        for k in np.flatnonzero(beside < POLE * np.abs(self.values(better)[row, i])).tolist():
            self.refuse_pole(int(row[k]), float(better[k]))
        return better

    def refuse_pole(self, row: int, x: float) -> NoReturn:
        raise not_real(self.quantities[row], 'values without bound beside the input '
                                             f'{self.unit * self.fold(x):.9g}')
