# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Where a machine can be assembled: the ranges of its input, dyad by dyad.

Within the range of the dyads before it, a dyad's assembly margin (:mod:`.margins`) is analytic in
phi, with x = middle + half sin(phi) between two toggles. It is sampled with its derivative (a
complex step) and halved until the cubic through both ends of each piece predicts the middle; a
piece whose cubic comes near zero is halved on. Signs that change are then halved to the last bit
of the input. This finds every range that is wider than the last pieces, some 1e-10 of the whole,
and proves nothing.

Change points. Of a pair (:mod:`.pairs`) exact sums of lengths tell whether it closes through one;
where it then lies flat, motion goes on. Of other dyads a margin has a positive minimum, a double
root, or a pair of roots: a minimum below :data:`DOUBTFUL` is decided in many digits, as the value
of

    (X4)  v = c0 - c1^2 / (4 c2),   c0 + c1 t + c2 t^2 + ... the margin at t beside the minimum

A double root is a limit of the range, on both sides, where the dyad is at a toggle.

A pair with one flat direction (a kite) is after a turn on its other side. Between the frame and
the driven crank it counts turns, and all repeats after two. Elsewhere the turns of its relative
angle are not counted: that must not pass the opposite direction.
"""
from __future__ import annotations

from collections.abc import Callable, Sequence
from decimal import Decimal, localcontext
from functools import partial
from math import inf, nextafter, pi
from typing import Any, NamedTuple

from fourbar_ros.errors import InvalidParameter
from fourbar_ros.mechanisms.machine import margins
from fourbar_ros.mechanisms.machine.margins import make_along
from fourbar_ros.mechanisms.machine.solve.frames import driven_link, hangings, Poses
from fourbar_ros.mechanisms.machine.structure import CYLINDER, DyadLengths, Layout
from fourbar_ros.numerics.arrays import Array, sine_between
from fourbar_ros.numerics.digits import in_decimals, MANY_DIGITS
from fourbar_ros.numerics.number_types import ARRAY, Function, numbers_of, REAL
from fourbar_ros.numerics.roots import halve
from fourbar_ros.numerics.trace import flat, Trace
import numpy as np

PIECES, MOST_HALVINGS, MOST_SAMPLES = 96, 26, 2**15
STEP = 2.0**-200                 # of derivatives by a complex step
# [rad] a full turn is sampled from this beyond -pi, where symmetric machines lie flat
SEAM = 0.01234
MISFIT = 1e-4                    # of a cubic, over the size of a margin: finer pieces are halved
SAFETY = 4.0                     # a cubic may be off by more than in the middle of a piece
ROUNDING = 2.0**-47              # margins below this are noise
NARROWEST = 1e-11                # pieces are not halved on: their samples would differ by rounding
NEWTON_STEPS = 12
# Minima of a margin below this are decided in many digits: its noise is less than 1e-15, that of
# a minimum between samples whose cubics hold less than 1e-6.
DOUBTFUL = 1e-5
# What is left of a double root in many digits. No margin of data that are floats was met between.
NO_MARGIN = Decimal('1e-40')
STEP_OF_DECIMALS = Decimal('1e-40')     # of central differences in many digits
SAME = 1e-12      # [rad], or of the unit of a slide: flat positions of several dyads are one
DOUBLE = 2.0**-20       # the same: so far a double root is found beside where it is


class Limit(NamedTuple):
    """An end of a range: the input [rad or m] and the dyad that is at a toggle there, or ''."""

    # is_flat: it is a change point, the same limit of the ranges on both sides.
    x: float
    dyad: str
    is_flat: bool = False

    def turned(self, turns: float = 1.0) -> Limit:
        return self._replace(x=self.x + 2.0 * pi * turns)


RangeEnds = tuple[Limit, Limit] | None      # the ends of a range; None: a full turn


class DyadRanges(NamedTuple):
    """The ranges in which dyads close."""

    limits: tuple[RangeEnds, ...]       # (low, high) of each range, None of a full turn
    stopped: str = ''               # the first dyad that closes nowhere
    flats: dict[float, str] = {}    # {input: the first pair that lies flat there}
    # searches for complex inputs near a range: a dyad is in line there, the ends of one meet
    toggles: Callable[[], list[complex]] = list
    poles: Callable[[], list[complex]] = list
    turns: int = 1                  # of a crank that turns fully, after which all repeats
    layout: Layout | None = None    # with what is known of pairs, see :func:`find_ranges`


def find_ranges(layout: Layout, dyad_lengths: Sequence[DyadLengths], signs: Sequence[float],
                bounds: tuple[float, float], unit: float) -> DyadRanges:
    """Return where all dyads of a layout close; InvalidParameter if floats cannot tell."""
    # A pair whose lengths make a change point, but that lies flat nowhere in the ranges, has no
    # branch that goes on: it has the side of its mode, as any other dyad.
    # layout, dyad_lengths, signs: as for motion_of(); bounds: where to search the input of a
    # driven slide [m]; unit: in which inputs are about one [rad or m].
    search = _Search(layout, dyad_lengths, signs)
    if layout.driver == 'crank':
        limits: list[RangeEnds] = [None]
    else:
        low, high = bounds
        if layout.driver == CYLINDER:
            rho, b = dyad_lengths[0].shape
            low, high = abs(rho - b), rho + b
        name = CYLINDER if layout.driver == CYLINDER else ''
        limits = [(Limit(low, name), Limit(high, name))]
    near, flats, twice = list[_Sampled](), dict[float, str](), ''
    for i, (stage, lengths) in enumerate(zip(layout.stages, dyad_lengths)):
        pair_range = margins.PairRange(stage, lengths) if stage.pair else None
        is_driven = (pair_range is not None and {stage.first, stage.second} == {0, 1}
                     and layout.driver != CYLINDER)
        if pair_range and pair_range.is_impossible:
            return DyadRanges((), stage.name, layout=search.layout)
        turns = 2 if twice and not is_driven else 1
        if pair_range.has_toggles if pair_range else (
                stage.kind in margins.CLOSING and stage.name != CYLINDER):
            split = [search.split(bound, i, turns) for bound in limits]
            limits = [section for sections, _ in split for section in sections]
            near += [margin for _, margin in split]
            if not limits:
                return DyadRanges((), stage.name, layout=search.layout)
        inputs: list[float] = []
        if pair_range and pair_range.flats:
            inputs = (pair_range.inputs(limits) if is_driven
                      else search.flats(pair_range, limits, i, turns))
            if not inputs:
                search.without_branch(i)
        if turns == 2 and (inputs or limits != [None]):
            raise InvalidParameter(f'dyads.{stage.name}', None, 'ends the range or lies flat in '
                                   f'one turn of the crank, not in the next: dyad {twice} repeats '
                                   'after two')
        for x in inputs:
            if all(abs(x - known) > SAME * unit for known in flats):
                flats[x] = stage.name
        if limits != [None]:
            twice = ''
        elif is_driven and len(inputs) == 1:
            twice = twice or stage.name
    turns, of_turn = 2 if twice else 1, search.layout
    bounds_of_turn = [end.x for bound in limits if bound for end in bound]
    if flats and bounds_of_turn and layout.driver == 'crank':     # between two ranges
        of_turn = of_turn._replace(seam=0.5 * (min(bounds_of_turn) + max(bounds_of_turn)) - pi)
    search.forget()
    return DyadRanges(tuple(limits), '', dict(sorted(flats.items())),
                      partial(search.toggles, near), partial(search.poles, limits, turns),
                      turns, of_turn)


class _Path(NamedTuple):
    """The inputs from ``low`` to ``high`` as a function of phi, in which margins are analytic."""

    # Of a full turn (is_closed) phi is the input; else input = middle + half sin(phi).
    low: float
    high: float
    is_closed: bool

    @classmethod
    def of(cls, bound: RangeEnds, turns: int) -> _Path:
        return (cls(-pi * turns, pi * turns, True) if bound is None
                else cls(bound[0].x, bound[1].x, False))

    def to_input(self, phi: Any) -> Any:
        return phi if self.is_closed else sine_between(self.low, self.high, phi)

    def start(self) -> Array:
        """Return the phi of the first samples, denser at both ends but not in these toggles."""
        if self.is_closed:
            pieces = PIECES * round((self.high - self.low) / (2.0 * pi))
            return np.linspace(self.low, self.high, pieces + 1) + SEAM
        share = np.linspace(-1.0, 1.0, PIECES + 1)
        return np.asarray(0.5 * pi * np.sin(0.5 * pi * share) * (1.0 - 1e-7))


class _Sampled(NamedTuple):
    """A function of the poses, and its values and slopes so close that cubics hold between."""

    function: Callable[[Poses], Array]
    path: _Path
    phi: Array
    value: Array
    slope: Array


class _Search:
    """The search for the ranges of a machine, dyad by dyad; see :func:`find_ranges`."""

    # Dyads that are searched at the same inputs share the poses of those that carry them: in a
    # chain the work grows with its length, not with the square of it.

    def __init__(self, layout: Layout, dyad_lengths: Sequence[DyadLengths],
                 signs: Sequence[float]) -> None:
        self._machine = layout, dyad_lengths, signs
        # {bytes of inputs: poses} at the first samples, which all dyads share
        self._shared: dict[bytes, Poses] = {}

    def forget(self) -> None:
        self._shared.clear()

    def _poses_at(self, x: Any) -> Poses:
        """Return the poses at real or complex inputs, of no dyad yet."""
        return Poses(hangings(ARRAY, *self._machine), driven_link(ARRAY, *self._machine, x))

    def without_branch(self, dyad: int) -> None:
        """Note that a pair lies flat nowhere, for those after it."""
        layout, dyad_lengths, signs = self._machine
        stages = list(layout.stages)
        pair = stages[dyad].pair
        assert pair is not None
        stages[dyad] = stages[dyad]._replace(pair=pair._replace(can_lie_flat=False))
        self._machine = layout._replace(stages=tuple(stages)), dyad_lengths, signs
        self.forget()

    @property
    def layout(self) -> Layout:
        return self._machine[0]

    def split(self, bound: RangeEnds, dyad: int, turns: int) -> tuple[list[RangeEnds], _Sampled]:
        """Return the parts of a range in which a dyad closes, and the samples of its margin."""
        # turns: of a full turn, after which the dyad is again where it was.
        stage, lengths = self._machine[0].stages[dyad], self._machine[1][dyad]
        in_floats = make_along(REAL, *self._machine, dyad,
                               margins.margin_of_dyad(REAL, stage, lengths))
        path = _Path.of(bound, turns)
        margin = self._resolved(margins.margin_of_dyad(ARRAY, stage, lengths), path, dyad)
        _, _, phi, value, slope = margin
        is_open = value > 0.0

        def changes() -> list[Limit]:
            limits = []
            for i in np.flatnonzero(is_open[1:] != is_open[:-1]):
                low, high = path.to_input(phi[i:i + 2]).tolist()
                limits.append(Limit(_root(in_floats, low, high, bool(is_open[i])), stage.name))
            return limits

        if stage.kind == 'PRP':     # it closes with a margin of either sign, on both sides of ends
            ends = changes()
            if ends:
                ends = [*ends, ends[0].turned()] if bound is None else [bound[0], *ends, bound[1]]
            return list(zip(ends, ends[1:])) or [bound], margin._replace(
                value=np.abs(value), slope=np.where(is_open, slope, -slope))
        flats = [] if stage.pair else self._minima(dyad, path, phi, value, slope)
        if stage.pair and not margins.PairRange(stage, self._machine[1][dyad]).has_limits:
            is_open[:] = True
        for inner, roots in flats:
            is_open[inner] = True           # their signs are noise; the roots are known
            if roots:
                value[inner] = -1.0
        ends = changes() + [Limit(x, stage.name, len(set(roots)) == 1)
                            for _, roots in flats for x in roots]
        ends.sort(key=lambda end: end.x)
        return _open_parts(bound, ends, bool(is_open[0]), bool(is_open[-1])), margin

    def _minima(self, dyad: int, path: _Path, phi: Array, value: Array,
                slope: Array) -> list[tuple[Array, tuple[float, ...]]]:
        """Return (samples of doubtful sign, limits) of each minimum of a margin of about zero."""
        # The limits are two inputs, equal at a double root, or none of a positive minimum. Minima
        # whose roots are not in the range are left out: the signs of samples tell.
        minima, decided = list[tuple[float, Array]](), []       # phi, samples of doubtful sign
        for i in np.flatnonzero((slope[:-1] <= 0.0) & (slope[1:] > 0.0)):
            curve = (slope[i + 1] - slope[i]) / (phi[i + 1] - phi[i])
            lowest = phi[i] - slope[i] / curve
            least = value[i] - 0.5 * slope[i] * slope[i] / curve
            inner = np.flatnonzero(np.abs(phi - lowest)
                                   < np.sqrt(4.0 * (DOUBTFUL + abs(least)) / curve))
            if abs(least) < DOUBTFUL and not any(np.isin(inner, known).any()
                                                 for _, known in minima):
                minima.append((lowest, inner))
        for lowest, inner in minima:
            try:
                limits = self._decided(dyad, float(path.to_input(np.array([lowest]))[0]))
            except (ArithmeticError, ValueError):   # it led to where dyads before do not close
                continue
            if path.is_closed or all(path.low <= x <= path.high for x in limits):
                decided.append((inner, limits))
        return decided

    def _decided(self, dyad: int, x: float) -> tuple[float, ...]:
        """Return the limits of the input beside a minimum of a margin near x by (X4)."""
        # No limit if it is positive, twice the same for a double root, else two roots: between
        # them the dyad does not close, and each is rounded outward, to where it does.
        layout, dyad_lengths, signs = self._machine
        data, h = tuple(dyad_lengths), STEP_OF_DECIMALS
        trace = Trace(lambda n, converted: make_along(
            n, layout, converted, signs, dyad, margins.margin_of_dyad(
                n, layout.stages[dyad], dyad_lengths[dyad], converted[dyad])), 1, data)
        with localcontext(MANY_DIGITS):
            value = in_decimals(trace, numbers_of(data), flat(trace.results)[:1])

            def terms(x: Decimal) -> tuple[Decimal, Decimal, Decimal]:
                """Return c0, c1, c2 at x by central differences, whose error is h^2."""
                (before,), (here,), (after,) = [value(x + k * h) for k in (-1, 0, 1)]
                return here, (after - before) / (2 * h), (after - 2 * here + before) / (2 * h * h)

            lowest = Decimal(x)
            for _ in range(NEWTON_STEPS):       # to the minimum
                c0, c1, c2 = terms(lowest)
                lowest -= c1 / (2 * c2)
                if abs(c1) < NO_MARGIN * abs(2 * c2) * max(abs(lowest), Decimal(1)):
                    break
            c0, c1, c2 = terms(lowest)
            least = c0 - c1 * c1 / (4 * c2)
            if least > NO_MARGIN:
                return ()
            if least > -NO_MARGIN:
                return float(lowest), float(lowest)
            limits = []
            apart = (-least / c2).sqrt()
            for way, outward in ((-apart, -inf), (apart, inf)):
                root = lowest + way
                for _ in range(NEWTON_STEPS):
                    c0, c1, _ = terms(root)
                    root -= c0 / c1
                    if abs(c0) < NO_MARGIN * abs(c1):
                        break
                limit = float(root)
                is_beyond = Decimal(limit) >= root if way > 0 else Decimal(limit) <= root
                limits.append(limit if is_beyond else nextafter(limit, outward))
            return tuple(limits)

    def _resolved(self, measure: margins.Measure, path: _Path, dyad: int) -> _Sampled:
        """Return a measure of the ends of a dyad, sampled so close that cubics hold between."""
        # Pieces that _to_halve() names are halved, MOST_HALVINGS times at most; what is doubtful
        # then stays so. InvalidParameter if there are too many samples.
        def function(poses: Poses) -> Any:
            return measure(poses.carry(dyad))

        def sample(phi: Array) -> tuple[Array, Array]:
            with np.errstate(all='ignore'):     # NaN where the function has no value
                x = path.to_input(phi + 1j * STEP)
                poses = self._shared.get(x.tobytes()) or self._poses_at(x)
                if phi.size >= PIECES:
                    self._shared[x.tobytes()] = poses
                value = function(poses) + 0.0 * phi
            return value.real, value.imag / STEP

        phi = path.start()
        value, slope = sample(phi)
        pending = np.ones(phi.size - 1, bool)       # pieces not yet compared with their cubic
        for _ in range(MOST_HALVINGS):
            i = np.flatnonzero(pending)
            if not i.size:
                break
            if phi.size > MOST_SAMPLES:
                raise InvalidParameter(
                    f'dyads.{self.layout.stages[dyad].name}', None, 'its lengths differ so much '
                    'from the others that its ranges cannot be told in floats')
            width = phi[i + 1] - phi[i]
            middle = phi[i] + 0.5 * width
            middle_value, middle_slope = sample(middle)
            doubtful = _to_halve((value, slope), (middle_value, middle_slope), i, width)
            phi, value, slope = (np.insert(old, i + 1, new) for old, new in (
                (phi, middle), (value, middle_value), (slope, middle_slope)))
            pending = np.zeros(phi.size - 1, bool)
            lower_half = i + np.arange(i.size)      # each middle before it moves it by one
            pending[lower_half] = pending[lower_half + 1] = doubtful
        return _Sampled(function, path, phi, value, slope)

    def _near(self, functions: Sequence[_Sampled]) -> list[list[complex]]:
        """Return the complex roots of each function next to its minima between samples."""
        starts, h = list[Array](), 2.0**-26
        for _, _, phi, value, slope in functions:
            is_open = value > 0.0
            i = np.flatnonzero((slope[:-1] <= 0.0) & (slope[1:] > 0.0)
                               & is_open[:-1] & is_open[1:])
            width, change = phi[i + 1] - phi[i], slope[i + 1] - slope[i]
            least = np.minimum(value[i], value[i + 1])
            starts.append(phi[i] - slope[i] * width / change
                          + 1j * np.sqrt(2.0 * least * width / change))
        ends = np.cumsum([start.size for start in starts]).tolist()
        sections = [slice(end - start.size, end) for start, end in zip(starts, ends)]
        z = np.concatenate([np.empty(0), *starts])
        x = np.empty((2, z.size), complex)      # all at once, as their dyads carry each other
        with np.errstate(all='ignore'):
            for _ in range(NEWTON_STEPS if z.size else 0):
                for function, section in zip(functions, sections):
                    x[:, section] = function.path.to_input(np.array([z[section], z[section] + h]))
                poses = self._poses_at(x)
                for function, section in zip(functions, sections):
                    if section.start < section.stop:
                        at_z, ahead = function.function(poses)[:, section]
                        z[section] -= at_z * h / (ahead - at_z)
            near = [(z[section], function.path.to_input(z[section]))
                    for function, section in zip(functions, sections)]
        return [x[np.isfinite(x) & (x.imag != 0.0) & (np.abs(z.imag) < 2.0)].tolist()
                for z, x in near]

    def toggles(self, margins_of_dyads: Sequence[_Sampled]) -> list[complex]:
        """Return the complex inputs near the ranges at which a dyad is in line."""
        return [root for roots in self._near(margins_of_dyads) for root in roots]

    def poles(self, limits: Sequence[RangeEnds], turns: int) -> list[complex]:
        """Return the complex inputs near the ranges at which the ends of a dyad meet."""
        poles, (layout, dyad_lengths, _) = list[complex](), self._machine
        for bound in limits:
            path, known = _Path.of(bound, turns), list[int]()
            squares = [self._resolved(margins.square_of_dyad(ARRAY, stage, dyad_lengths[i]), path,
                                      i)
                       for i, stage in enumerate(layout.stages)
                       if stage.kind in ('RRR', 'RPR') and stage.name != CYLINDER]
            near = self._near(squares)
            every = np.array([root for roots in near for root in roots])
            poses, start = self._poses_at(every), 0
            for square, roots in zip(squares, near):
                # Of a chain of equal loops the poles of one are enough: a dyad whose ends meet at
                # a pole that is known adds none.
                with np.errstate(all='ignore'):
                    sizes = np.abs(square.function(poses)) + 0.0 * np.abs(every)    # one each
                if not (sizes[known] < DOUBLE**2).any():
                    known += range(start, start + len(roots))
                start += len(roots)
            poles += every[known].tolist()
        self.forget()
        return poles

    def flats(self, pair_range: margins.PairRange, limits: Sequence[RangeEnds], dyad: int,
              turns: int) -> list[float]:
        """Return the inputs within ``limits`` where a pair away from the crank lies flat."""
        # Each to one float. InvalidParameter if it is of one direction, and passes the opposite
        # one.
        stage, signs = self._machine[0].stages[dyad], pair_range.flats
        name, is_driven = stage.name, {stage.first, stage.second} == {0, 1}
        in_floats = make_along(REAL, *self._machine, dyad,
                               lambda ends: pair_range.flatness(ends.relative))
        flats = []
        for bound in limits:
            path = _Path.of(bound, turns)
            _, _, phi, value, _ = self._resolved(
                lambda ends: pair_range.flatness(ends.relative)[0], path, dyad)
            moves = np.abs(value).max() > SAME
            changes = np.flatnonzero((value[1:] > 0.0) != (value[:-1] > 0.0)) if moves else [0]
            for i in changes:
                low, high = path.to_input(phi[i:i + 2]).tolist()
                # to the floats beside 0 it is a thousand halvings
                x = (0.0 if low < 0.0 < high and abs(in_floats(0.0)[0]) < SAME else
                     _root(lambda x: in_floats(x)[0], low, high, bool(value[i] > 0.0)))
                is_opposite = all(sign * in_floats(x)[1] < 0.0 for sign in signs)
                if is_opposite and not is_driven:
                    raise InvalidParameter(
                        f'dyads.{name}', None, 'is a kite on links that turn fully against each '
                        f'other, at input {x:.6g}: it may be one on the frame and the crank')
                if moves and not is_opposite:
                    is_angle = self._machine[0].driver == 'crank'
                    flats.append(x - 2.0 * pi if is_angle and x > pi else
                                 x + 2.0 * pi if is_angle and x <= -pi else x)
        return sorted(flats)


def _open_parts(bound: RangeEnds, ends: list[Limit], opens_first: bool,
                opens_last: bool) -> list[RangeEnds]:
    """Return the parts of a range in which a dyad closes, between every other pair of ends."""
    # opens_first, opens_last: whether it closes at the first and at the last sample.
    if not ends:
        return [bound] if opens_first else []
    if bound is None:
        if opens_first:          # the first part began before the first sample
            ends = [*ends[1:], ends[0].turned()]
        return [(low.turned(-1.0), high.turned(-1.0)) if low.x > pi else (low, high)
                for low, high in zip(ends[::2], ends[1::2])]
    if opens_first:
        ends = [bound[0], *ends]
    if opens_last:
        ends = [*ends, bound[1]]
    return list(zip(ends[::2], ends[1::2]))


def _to_halve(ends: tuple[Array, Array], inner: tuple[Array, Array], i: Array,
              width: Array) -> Array:
    """Return which pieces a cubic does not describe, or that may hide two roots."""
    # Of any function that is sampled: margins, flatness, squared distances. ends: values and
    # slopes at all samples; inner: those in the middle of the pieces, which begin at samples i and
    # are width wide. Too narrow pieces and values that are noise, or NaN, are not halved; a piece
    # in which the sign changes has its root already, and two more would spoil its cubic.
    (value, slope), (middle_value, middle_slope) = ends, inner
    cubic = 0.5 * (value[i] + value[i + 1]) + 0.125 * width * (slope[i] - slope[i + 1])
    misfit = np.abs(middle_value - cubic)
    size = np.maximum(np.abs(value[i]), np.abs(value[i + 1]))
    halves = [_least_size(value[i], slope[i], middle_value, middle_slope, 0.5 * width),
              _least_size(middle_value, middle_slope, value[i + 1], slope[i + 1], 0.5 * width)]
    crosses = (value[i] > 0.0) != (value[i + 1] > 0.0)
    doubtful: Array = ((misfit > MISFIT * size) | ~np.isfinite(misfit)
                       | (~crosses & (np.minimum(*halves) < SAFETY * misfit)))
    doubtful &= (width > NARROWEST) & (size > ROUNDING)
    return doubtful


def _least_size(f0: Array, d0: Array, f1: Array, d1: Array, width: Array) -> Array:
    """Return about the least |cubic| over pieces, zero if it changes its sign."""
    # The cubics have values f0, f1 and slopes d0, d1 at the ends of pieces of a width.
    # at equal steps, and where the slopes of both ends would meet at zero
    bend = np.where((d0 < 0.0) != (d1 < 0.0), d0 / np.where(d0 == d1, 1.0, d0 - d1), 0.5)
    t = np.concatenate((np.linspace(0.0, 1.0, 9)[:, None] + 0.0 * bend, bend[None]))
    cubic = ((1.0 + 2.0 * t) * (1.0 - t)**2 * f0 + t * (1.0 - t)**2 * width * d0
             + t * t * (3.0 - 2.0 * t) * f1 - t * t * (1.0 - t) * width * d1)
    least: Array = np.abs(cubic).min(axis=0)
    return np.where((cubic > 0.0).any(axis=0) != (cubic > 0.0).all(axis=0), 0.0, least)


def _root(margin: Function, low: float, high: float, opens_low: bool) -> float:
    """Return the last input between low and high at which a dyad closes, one of two neighbours."""
    # opens_low: whether it closes at low, else at high.
    def closes(position: float) -> bool:
        try:
            return bool(margin(position) > 0.0)
        except (ValueError, ZeroDivisionError):
            return False
    return halve(closes, *((low, high) if opens_low else (high, low)))[0]
