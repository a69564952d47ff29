# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Peak, mean and root mean square of a quantity over the input, and what an output sweeps.

Every table, record, study and warning takes them from here. Peaks and ends of ranges are extrema,
not samples; means are integrals that settle to 1e-12.

>>> from fourbar_ros import load_scene
>>> from fourbar_ros.extrema import OverInput
>>> torque = OverInput(load_scene('paper').linkage, 'driving_torque', rate=25.0)
>>> f'peak {torque.peak:.4f} N m, root mean square {torque.rms:.4f} N m'
'peak 720.4716 N m, root mean square 217.2600 N m'
"""
from collections.abc import Callable, Sequence
from functools import cached_property
from math import copysign, inf, isfinite, isinf, nan, pi, remainder, sqrt, tau
from typing import Any, NamedTuple

from fourbar_ros.errors import InvalidParameter
from fourbar_ros.extrema import find
from fourbar_ros.extrema.find import CONSTANT, Extremum, find_extrema, SAMPLES
from fourbar_ros.extrema.input_paths import input_paths
from fourbar_ros.extrema.sampling import Sampler
from fourbar_ros.mechanisms.kind import Kind
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.parts import Coordinate, Quantity, Ranges
from fourbar_ros.mechanisms.quadrature import AGREE, mean_over_input, nodes, smooth_ranges
from fourbar_ros.mechanisms.quantities import is_position, Named, OfDrive
from fourbar_ros.notebook import short_repr
from fourbar_ros.numerics.arrays import Array, Values
import numpy as np

# Extrema whose values differ by less than this part of the largest are equal: the first of them,
# by input, is the largest or the least. An output at a dead point may come there twice.
EQUAL = find.relative_error(find.MOST_ALIKE)
FEW = 8         # inputs at which a quantity's size is looked up, before its squares are added
NEAR_END = 2.0**-33      # of a range: the distance at which growth towards its end is looked at


class OverInput:
    """
    Peak, mean and root mean square of one quantity over the input, at constant rate.

    Arguments and errors as of :func:`.find_extrema`; ``extrema``: what that found, if it is known.
    Each figure is computed when it is first asked for, in the quantity's unit. Infinite where the
    quantity grows without bound and the figure with it; NaN if it is not certain.
    """

    def __init__(self, linkage: Mechanism, quantity: find.AskedQuantity, rate: float = 1.0,
                 acceleration: float = 0.0, within: tuple[float, float] | None = None,
                 extrema: Sequence[Extremum] | None = None) -> None:
        self._linkage, self._rates, self._within = linkage, (rate, acceleration), within
        self._quantity, *more = find.resolve(quantity, linkage)
        if more:
            raise InvalidParameter('quantity', quantity, 'must be one')
        if self._quantity.is_load and within is None:
            linkage.require_cycle()
        if extrema is not None:
            self.extrema = list(extrema)

    def __repr__(self) -> str:
        rate, acceleration = self._rates
        return short_repr('OverInput', {
            'linkage': self._linkage.description, 'quantity': self._quantity.name, 'rate': rate,
            'acceleration': acceleration, 'within': self._within})

    @cached_property
    def extrema(self) -> list[Extremum]:
        return find_extrema(self._linkage, self._quantity, *self._rates, conditions=False,
                            within=self._within)

    @property
    def least(self) -> Extremum | None:
        """Return the least extremum; None of an angle that only turns on."""
        return most_extreme(self.extrema, -1)

    @property
    def most(self) -> Extremum | None:
        """Return the largest extremum; None of an angle that only turns on."""
        return most_extreme(self.extrema, 1)

    @property
    def largest(self) -> Extremum | None:
        """Return the extremum of the largest magnitude; None of an angle that only turns on."""
        return most_extreme(self.extrema, 1, abs)

    @property
    def peak(self) -> float:
        sizes = [abs(extremum.value) for extremum in self.extrema]
        return float(np.max(sizes)) if sizes else nan       # NaN if one of them is

    @cached_property
    def mean(self) -> float:
        """Return the mean; NaN if its integral diverges both ways, of an angle over a turn."""
        if self._is_constant:
            return self.extrema[0].value
        # beside an end where it is infinite it is a power of the root of the distance d: only one
        # over that root is integrable, it doubles as d falls to a quarter, where the next power,
        # 1/d, grows fourfold
        d = min(high - low for low, high in self._linkage.input_ranges) * NEAR_END
        divergent = set[float]()
        for end in self.extrema:
            if isinf(end.value):
                far, near = np.abs(self._values(end.input + end.side * np.array((d, 0.25 * d))))[0]
                divergent |= {end.value} if near > 3.0 * far else set()
        if divergent:
            return divergent.pop() if len(divergent) == 1 else nan
        mean, = mean_over_input(self._linkage, self._values, self._ranges)
        return float(mean)

    @property
    def of_cycle(self) -> float:
        """
        Return the integral over a cycle, passed as the rate has it; NaN but for full turns.

        Of a torque it is the work [J] that it does: backward the sign turns.
        """
        if not self._linkage.turns_fully or self._within is not None:
            return nan
        cycle = copysign(self._linkage.cycle, self._rates[0])
        return float(cycle * settled(self.mean, self.rms))

    @cached_property
    def rms(self) -> float:
        """Return the root mean square, inf where its integral diverges."""
        # of a full turn the integral tells by itself whether it is finite, without a search
        by_itself = self._linkage.turns_fully and not isinstance(self._quantity, OfDrive)
        if not by_itself and self.peak == inf:
            return inf          # it grows as one over the root of the distance, at least
        # over the size of a few values, so that no square overflows
        few, _ = nodes(self._linkage, FEW, self._ranges)
        largest = float(np.fmax.reduce(np.abs(self._values(few)), axis=None))
        scale = largest if largest > 0.0 else 1.0
        mean, = mean_over_input(self._linkage, lambda x: np.square(self._values(x) / scale),
                                self._ranges)
        if isfinite(mean):
            return scale * sqrt(mean)
        if self._is_constant:
            return abs(self.extrema[0].value)
        return inf if self.peak == inf else nan

    def _values(self, x: Array) -> Array:
        """Return the quantity at inputs, shape (1, n)."""
        with np.errstate(all='ignore'):
            values = (self._quantity.values(self._linkage, x, self._rates[0])
                      if isinstance(self._quantity, OfDrive) else
                      self._quantity.of(*self._linkage.motion_and_loads(x, *self._rates)))
        if is_position(self._quantity) and self._quantity.unit == 'rad':
            values = values - tau * np.round((values - self._middle) / tau)
        return np.broadcast_to(values, x.shape)[None]

    @cached_property
    def _middle(self) -> float:
        """Return the middle of an angle, from which it is less than half a turn; else NaN."""
        least, most = self.least, self.most
        if (not least or not most or most.value - least.value >= tau
                or _turns_on(self._linkage, self._quantity)):
            return nan      # what its mean is depends on the turn in which each range begins
        return 0.5 * (least.value + most.value)

    @cached_property
    def _ranges(self) -> Ranges:
        """Return the parts of the input ``within``, cut at ends of pieces; () for all of it."""
        unit, rubs = self._linkage.input_unit, self._linkage.friction and self._quantity.is_load
        if self._within is None and not rubs:
            return ()
        ranges = () if self._within is None else tuple([
            (unit * path.low.x, unit * path.high.x)
            for path in input_paths(self._linkage, SAMPLES, self._within)
            if path.low and path.high])
        ends: Sequence[float] = ()
        if rubs:
            from fourbar_ros.mechanisms.pieces import with_friction  # few mechanisms have any
            ends = with_friction(self._linkage, self._rates).ends
        return smooth_ranges(self._linkage, ends, ranges)

    @property
    def _is_constant(self) -> bool:
        return ({extremum.kind for extremum in self.extrema} == {CONSTANT}
                and len({extremum.value for extremum in self.extrema}) == 1)


def most_extreme(extrema: Sequence[Extremum], sense: int,
                 size: Callable[[float], float] = float) -> Extremum | None:
    """
    Return the largest (``sense`` 1) or least extremum (-1), of equal ones that at the least input.

    ``size``: what of values is compared, as their magnitude.
    """
    best = max(extrema, key=lambda extremum: sense * size(extremum.value), default=None)
    if best is None:
        return None
    largest = max([abs(extremum.value) for extremum in extrema if isfinite(extremum.value)],
                  default=0.0)
    first = min([extremum for extremum in extrema if extremum is best or are_equal(
        size(extremum.value), size(best.value), largest)], key=lambda extremum: extremum.input)
    # one that is as large only, of the other sign, is not of the same value
    value = next((sign * best.value for sign in (1.0, -1.0)
                  if are_equal(first.value, sign * best.value, largest)), first.value)
    return first._replace(value=value)


def are_equal(values: Values, best: Values, largest: Values) -> Any:
    """Return which values of extrema equal that of the best; ``largest``: the size of them all."""
    with np.errstate(invalid='ignore'):
        return (np.abs(np.subtract(values, best)) <= EQUAL * largest) | np.equal(values, best)


def settled(mean: Values, rms: Values) -> Values:
    """Return means, 0 where they are less than their error, beside the root mean squares."""
    with np.errstate(invalid='ignore'):
        return np.where(np.abs(mean) <= AGREE * rms, 0.0, mean)


def efficiency(linkage: Mechanism, rate: float = 1.0, acceleration: float = 0.0) -> float:
    """Return the share of the work of a cycle that friction leaves, between drive and loads."""
    # From the work of the drive with and without friction, at the same motion: their quotient that
    # is below 1, whichever way the work goes. What dampers take is no loss of it. NaN where the
    # input does not turn fully, where no work is done, and where friction turns its sign.
    work, without = (OverInput(each, linkage.drive_load, rate, acceleration).of_cycle
                     for each in (linkage, linkage.without_friction))
    return efficiency_of(work, without)


def efficiency_of(work: float, without: float) -> float:
    """Return the efficiency of a cycle by the work of its drive with and without friction."""
    if work < 0.0:          # the loads drive: what arrives at the drive, over what they give
        return work / without if without < 0.0 else nan
    return without / work if work > 0.0 and without >= 0.0 else nan


# --- what an output sweeps -----------------------------------------------------------------------

class OutputRange(NamedTuple):
    """What a coordinate sweeps while the input goes over one of its ranges."""

    inputs: tuple[float, float]     # this range of the input [rad or m]
    low: float                      # [rad or m]; of full turns -pi and pi
    high: float
    turns_fully: bool               # a turn of the input turns it on, with reversals or without
    extrema: tuple[Extremum, ...]   # ends of the input among them; () of full turns

    def time_ratio(self, period: float) -> float:
        """
        Return :func:`time_ratio`; ``period``: of the input [rad].

        NaN of full turns, and where the output is least or greatest at several inputs, as of a
        press whose knee passes its straight pose: which of them counts would be rounding.
        """
        if len(self.least_at) != 1 or len(self.most_at) != 1:
            return nan
        return float(time_ratio(self.least_at[0], self.most_at[0], period))

    @property
    def least_at(self) -> list[float]:
        """Return all inputs at which it is least, within rounding; [] of full turns."""
        return self._at(self.low)

    @property
    def most_at(self) -> list[float]:
        """Return all inputs at which it is greatest, within rounding; [] of full turns."""
        return self._at(self.high)

    def _at(self, end: float) -> list[float]:
        largest = max(abs(self.low), abs(self.high))
        return [extremum.input for extremum in self.extrema
                if are_equal(extremum.value, end, largest)]

    @property
    def width(self) -> float:
        """Return by how much it moves [rad or m]; 2 pi of full turns."""
        return self.high - self.low


def time_ratio(least_at: Values, most_at: Values, period: float) -> Values:
    """Return the time of the slower stroke of an output over that of the faster one."""
    # At constant speed of an input that turns fully; NaN where there is none. least_at, most_at:
    # inputs at which the output is least and greatest.
    forward = np.mod(np.subtract(most_at, least_at), period)
    back = period - forward
    with np.errstate(divide='ignore', invalid='ignore'):
        return np.where(forward > 0.0,
                        np.maximum(forward, back) / np.minimum(forward, back), nan)


def output_ranges(linkage: Mechanism, coordinate: Coordinate | None = None,
                  extrema: Sequence[Extremum] | None = None) -> list[OutputRange]:
    """
    Return what a coordinate sweeps in the mode of a linkage, for each range of the input.

    ``coordinate``: by default that of the first output; ``extrema``: of its position, if they are
    known. Angles are continuous; the middle of each range lies within half a turn of zero.
    """
    coordinate = coordinate or linkage.outputs[0].coordinate
    quantity = Quantity(coordinate.position, coordinate.unit, '', False)
    if extrema is None:
        extrema = find_extrema(linkage, quantity, conditions=False)
    ranges = linkage.input_ranges
    if _turns_on(linkage, quantity):
        return [OutputRange(ranges[0], -pi, pi, True, ())]

    def input_in(bounds: tuple[float, float], extremum: Extremum) -> float:
        """Return the input of an extremum, in the turn of a range, on its side of an end."""
        middle, width = 0.5 * (bounds[0] + bounds[1]), bounds[1] - bounds[0]
        away = extremum.input + NEAR_END * width * extremum.side - middle
        return middle + remainder(away, linkage.period)

    def is_outside_by(bounds: tuple[float, float], extremum: Extremum) -> float:
        x = input_in(bounds, extremum)
        return max(bounds[0] - x, x - bounds[1])        # less than zero inside

    by_range: dict[tuple[float, float], list[Extremum]] = {bounds: [] for bounds in ranges}
    for extremum in extrema:
        by_range[min(ranges, key=lambda bounds: is_outside_by(bounds, extremum))].append(extremum)
    swept = []
    for bounds, inside in by_range.items():
        inside.sort(key=lambda extremum: input_in(bounds, extremum))
        values = [extremum.value for extremum in inside]
        swept.append(OutputRange(bounds, min(values), max(values), False, tuple(inside)))
    return swept


def _turns_on(linkage: Mechanism, quantity: Named) -> bool:
    """Return whether a turn of the input turns an angle on, with reversals or without."""
    if (isinstance(quantity, OfDrive) or not is_position(quantity) or quantity.unit != 'rad'
            or not linkage.turns_fully):
        return False
    sampler = Sampler(linkage, [quantity], (0.0, 0.0))
    angles = [sampler.along(path).values[0] for path in input_paths(linkage, SAMPLES)]
    # a path that closes lacks its last step, less than half a turn
    return bool(round(sum(each[-1] - each[0] for each in angles) / tau))


def turning_points(linkage: Mechanism) -> list[Extremum]:
    """Return where the first output turns back in the mode of a linkage; not ends of its input."""
    coordinate = linkage.outputs[0].coordinate
    return [extremum for extremum in find_extrema(
        linkage, Quantity(coordinate.position, coordinate.unit, '', False), conditions=False)
            if not extremum.side and extremum.kind != CONSTANT]


def dead_points(linkage: Mechanism) -> Sequence[tuple[Any, ...]]:
    """
    Return where the first output turns back, inside the stroke, by input.

    Tuples that begin with input, angles from -pi on, and output; of kinds records in closed form.
    """
    if isinstance(linkage, Kind):
        return linkage.dead_points
    return sorted((linkage.from_minus_pi_on(extremum.input), extremum.value)
                  for extremum in turning_points(linkage))
