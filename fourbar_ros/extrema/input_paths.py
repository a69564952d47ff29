# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Sample points of the input that resolve any mechanism with known singular inputs.

The input is x = phi for a crank that turns fully, x = middle + half sin(phi) for a range between
two toggles, where phi goes through them into the other assembly mode without a root. The samples
are equal steps of

    t(phi) = phi + sum over singular points of some kernels 2 atan(tan((phi - c)/2) / tanh(w/2)),

where each kernel crowds a constant number of samples within w of c. A quantity is analytic except
at poles and at points z of the complex plane where the dyad is in line. There c = Re z, w = |Im
z|; kernels of the widths 4 w, 16 w, ... thin out the samples with the distance.
"""
from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from math import inf, pi
from typing import NamedTuple, TYPE_CHECKING

from fourbar_ros.errors import FourBarError
from fourbar_ros.mechanisms.geometry import BESIDE_FLAT_LIMITS
from fourbar_ros.mechanisms.kind import Kind
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.parts import clipped
from fourbar_ros.numerics.arrays import Array, sine_between
import numpy as np

if TYPE_CHECKING:
    from fourbar_ros.mechanisms.pieces import Pieces

# Samples of a kernel; widths of the kernels of a singular point; the least that is resolved.
PER_KERNEL, WIDER, NARROWEST = 16, 4.0, 1e-12
# The same of machines of dyads, whose complex singular inputs are known less well.
NARROWEST_OF_MACHINE = 2.0**-28
NODES = 32                          # of each kernel, to solve t(phi) = t
# Points added towards a toggle, each twice as close as the one before, and towards a pole, every
# second one twice as close. The last are 1e-6 in u from a toggle and 1e-12 in x from either, where
# x itself has four digits left. How many others a path has at least.
TOGGLE_POINTS, POLE_POINTS, LEAST = 14, 64, 12
LEAST_OF_PIECE = 8
# An end of a piece so near to another end of a path is this end [in units of phi].
BESIDE_END = 1e-9


# Kinds of ends. A pole is a flat position of a change point; at the end of a stroke or of a search
# nothing is singular; beyond that of a piece the path goes on, but not smoothly.
TOGGLE, POLE, REGULAR, PIECE = 'toggle', 'pole', 'regular', 'piece'


class End(NamedTuple):
    """An end of an input path."""

    x: float        # input, in the mechanism's unit
    kind: str       # TOGGLE, POLE, REGULAR or PIECE

    @property
    def is_pole(self) -> bool:
        return self.kind == POLE


class InputPath(NamedTuple):
    """Samples of a range of the input in which a mechanism moves smoothly in one assembly mode."""

    # Between first and last steps of the path's parameter are equal; beyond, points are added next
    # to low and high.

    x: Array             # (n,), rising inputs; of a full period from half of it below zero on
    low: End | None      # where it begins; None: after the last point is the first
    high: End | None     # where it ends
    first: int           # index of the point half a step from ``low``
    last: int            # index of the point half a step from ``high``
    period: float = inf  # after which the input begins again [rad]
    cuts: Array = np.zeros(0)    # (c,), inputs along it where pieces end: loads jump or have kinks
    before_cuts: Array = np.zeros(0, int)       # index of the last sample before each cut

    @property
    def is_closed(self) -> bool:
        """Return whether the path is a full period."""
        return self.low is None

    def ends(self) -> list[tuple[int, End]]:
        """Return (side, end) of both ends, side +1 of the lower, -1 of the upper; () of a turn."""
        return [(side, end) for side, end in ((1, self.low), (-1, self.high)) if end]

    def inward(self, side: int) -> Array:
        """Return the indices of all points in order, beginning at the end on this side."""
        return np.arange(self.x.size)[::side]

    def with_points(self, points: Array) -> InputPath:
        """Return the path with those of more inputs, in any order, that lie between its ends."""
        start, end = self.x[[0, -1]]
        if self.is_closed:
            points = points - self.period * (points > 0.5 * self.period)
        else:
            points = points[(points > start) & (points < end)]
        x = np.concatenate((self.x, points))
        along = x + (self.period if self.is_closed else 2.0 * pi) * (x < start)
        inorder, order = np.unique(along, return_index=True)
        first, last = (order.tolist().index(i % self.x.size) for i in (self.first, self.last))
        return self._replace(x=inorder if self.cuts.size else x[order], first=first, last=last,
                             before_cuts=np.searchsorted(inorder, self.cuts) - 1)


class TooNarrow(FourBarError, ValueError):
    """The range of the input is too narrow, compared with the input, for floats."""

    def __init__(self) -> None:
        super().__init__('the range of the input is too narrow, beside the input itself, to be '
                         'searched')


class Kernels(NamedTuple):
    """The kernels that crowd samples, arrays (kernels, 1); the first stands for equal steps."""

    centres: Array      # c
    tangents: Array     # tanh(w/2)
    weights: Array      # number of samples over 2 pi

    def samples(self, phi: Array) -> tuple[Array, Array]:
        """Return t(phi), see above, and dt/dphi: t counts the samples up to phi."""
        half = 0.5 * (phi - self.centres)
        turns = np.rint(half / pi)
        half = half - turns * pi                      # in [-pi/2, pi/2]
        sine, cosine = np.sin(half), np.cos(half)
        t = 2.0 * (np.arctan2(sine, self.tangents * cosine) + turns * pi)
        slope = self.weights * self.tangents / (sine * sine + (self.tangents * cosine)**2)
        return (self.weights * t).sum(axis=0), slope.sum(axis=0)


def input_paths(mechanism: Mechanism, points: int, within: tuple[float, float] | None = None,
                poles: Sequence[float] = (), pieces: Pieces | None = None) -> list[InputPath]:
    """Return the paths of the input, sampled, that make up a mechanism's motion in its mode."""
    # points is the least number of points of a full turn, without those added at the ends. within:
    # the inputs [rad or m] between which paths are wanted, of angles at most a period apart.
    # poles: those of the mechanism's flat_inputs at which quantities have poles, so that paths end
    # there. pieces: those of loads with forces over a position. Paths of a slide are in units of
    # input_unit.
    unit, is_slide, stroke = mechanism.input_unit, mechanism.is_driven_by_slide, mechanism.cut
    turned = 2.0 * pi * round(stroke[0] / (2.0 * pi)) if stroke and not is_slide else 0.0
    passed = {*mechanism.flat_inputs, *[-x for x in mechanism.flat_inputs if x == pi]}
    singular = np.array([*[z for z in mechanism.singular_inputs
                           if z.imag or z.real in poles or z.real not in passed],
                         *[z - turned for z in (pieces.branch_points if pieces else ())]],
                        complex) / unit
    inner = np.array(pieces.ends if pieces else ()) / unit
    # the parts of the input [rad or m] in which paths are wanted; None: all of it
    wanted: Sequence[tuple[float, float] | None] = (
        clipped((stroke,), within, mechanism.period) if within and stroke else [within or stroke])
    if mechanism.closes_fully:
        period = mechanism.cycle if pieces else mechanism.period
        return [path for part in wanted
                for path in _of_turns(singular, points, part, period, inner)]
    bounds = list[tuple[float, float]]()        # of angles in each turn in which a range may be
    for low, high in [part or (-inf, inf) for part in wanted]:
        turns = [0] if is_slide or low == -inf else [round(low / (2.0 * pi)) + k
                                                     for k in range(-2, 3)]
        bounds += [(low - 2.0 * pi * turn, high - 2.0 * pi * turn) for turn in turns]
    paths = []
    for low, high in mechanism.closing_ranges:
        # beside these there are no results
        margins = [2.0 * BESIDE_FLAT_LIMITS * (limit in mechanism.flat_limits)
                   for limit in (low, high)]
        low, high = low / unit, high / unit
        # the singular inputs but the two toggles; angles also a turn earlier and later
        beside, of_range = singular[(singular != low) & (singular != high)], inner
        if not is_slide:
            beside = np.add.outer((-2.0 * pi, 0.0, 2.0 * pi), beside).ravel()
            distance = np.minimum(np.abs(beside - low), np.abs(beside - high))
            beside = beside[distance > NARROWEST]
            # pieces may lie in the turn of the stroke
            of_range = inner - 2.0 * pi * np.round((inner - 0.5 * (low + high)) / (2.0 * pi))
        for begin, end in bounds:
            between = (max(begin / unit, low + margins[0] if margins[0] else -inf),
                       min(end / unit, high - margins[1] if margins[1] else inf))
            paths += _between(low, high, beside, points, between, of_range)
    return paths


def unresolved(mechanism: Mechanism) -> str:
    """Return in words where singular inputs are so near that samples cannot follow, else ''."""
    unit, coordinate = mechanism.input_unit, mechanism.input_coordinate
    least = unit * (NARROWEST if isinstance(mechanism, Kind) else NARROWEST_OF_MACHINE)
    singular = [complex(z) for z in mechanism.singular_inputs]
    real = [z.real for z in singular if not z.imag]
    for z in singular:
        if 0.0 < abs(z.imag) < least or not z.imag and any(
                0.0 < abs(mechanism.distance(z.real, x)) < least for x in real):
            return (f'changes within {least:.0e} {coordinate.unit} of {coordinate.position} = '
                    f'{z.real:.9g} are not resolved')
    return ''


def _of_turns(singular: Array, points: int, within: tuple[float, float] | None,
              period: float, inner: Array) -> list[InputPath]:
    """Return the paths of full turns: a period, or between poles and ends of ``within``."""
    poles = np.unique(singular.real[singular.imag == 0.0])
    kernels = _kernels(singular[singular.imag != 0.0], points)
    count = 1 + round(period / (2.0 * pi))
    turns = np.arange(-count, count + 1) * (2.0 * pi)
    ends = {float(x): End(float(x), PIECE)
            for x in np.add.outer(np.arange(-2, 3) * period, inner).ravel()}
    ends |= {float(x): End(float(x), POLE) for x in np.add.outer(turns, poles).ravel()}
    ends = dict(sorted(ends.items()))
    if within:
        turn = period * round(sum(within) / (2.0 * period))
        cut = within[0] - turn, within[1] - turn
        ends = _within(ends, cut, {x: x for x in cut})
    elif ends:
        first = float(poles[0]) if poles.size else float(inner[0])
        ends = {x: end for x, end in ends.items()
                if first <= x <= first + period * (1.0 + 1e-15)}
    else:
        phi = _spread(kernels, (-0.5 * period, 0.5 * period), ())[0]
        return [InputPath(phi, None, None, 0, -1, period)]
    return _paths(kernels, ends, lambda phi: phi, 0.0 if within or poles.size else period)


def _between(low: float, high: float, singular: Array, points: int,
             cut: tuple[float, float], inner: Array) -> list[InputPath]:
    """Return the paths from toggle ``low`` to toggle ``high``: two, if a pole lies between."""
    # There x = middle + half sin(phi), -pi/2 <= phi <= pi/2. cut: the two inputs to which paths
    # are cut; inner: the ends of pieces.
    middle, half = 0.5 * (low + high), 0.5 * (high - low)

    def to_phi(x: float) -> float:
        return float(np.arcsin((x - middle) / half))

    scaled = (singular - middle) / half
    is_pole = (scaled.imag == 0.0) & (np.abs(scaled.real) < 1.0)
    angles = np.arcsin(scaled[~is_pole])
    kernels = _kernels(np.concatenate((angles, pi - angles)), points)
    between = {float(np.arcsin(sine)): End(float(x), POLE)
               for sine, x in zip(scaled.real[is_pole], singular.real[is_pole])}
    between |= {to_phi(x): End(float(x), PIECE) for x in inner if low < x < high}
    ends = {-0.5 * pi: End(low, TOGGLE), **dict(sorted(between.items())),
            0.5 * pi: End(high, TOGGLE)}
    ends = _within(ends, cut, {to_phi(x): x for x in cut if low < x < high})
    return _paths(kernels, ends, partial(sine_between, low, high))


def _within(ends: dict[float, End], cut: tuple[float, float], new_ends: dict[float, float]
            ) -> dict[float, End]:
    """Return {phi: End} of the part of a range between the two inputs ``cut``."""
    # new_ends: {phi: input}, those of both that lie inside the range. They are regular ends, but
    # next to a pole, or the end of a piece, that is the end.
    slack = {phi: 0.0 if end.kind == TOGGLE else NARROWEST for phi, end in ends.items()}
    low, high = cut
    kept = {phi: end for phi, end in ends.items()
            if low - slack[phi] <= end.x <= high + slack[phi]}
    regular = {phi: End(x, REGULAR) for phi, x in new_ends.items()
               if all(abs(x - end.x) > slack[phi_of_end] for phi_of_end, end in kept.items())}
    return dict(sorted((kept | regular).items()))


def _paths(kernels: Kernels, ends: dict[float, End], to_input: Callable[[Array], Array],
           period: float = 0.0) -> list[InputPath]:
    """Return the paths between ends {phi: End}, pieces joined; ``period`` of one that closes."""
    # ends: of ranges and pieces in order; to_input: phi -> x
    outer = np.array([phi for phi, end in ends.items() if end.kind != PIECE])
    ends = {phi: end for phi, end in ends.items() if end.kind != PIECE or not outer.size
            or np.abs(outer - phi).min() > BESIDE_END}
    runs = list[list[InputPath]]()          # of pieces that follow each other
    for first, last in zip(ends, list(ends)[1:]):
        low, high = ends[first], ends[last]
        phi, before, after = _spread(kernels, (first, last), (low, high))
        x = to_input(phi)
        # Nearer to an end than this, x has no digits left for the distance.
        near = [np.abs(x - end.x) < 2.0**-40 * max(abs(end.x), 2.0**-12) for end in (low, high)]
        before, after = before - int(near[0].sum()), after - int(near[1].sum())
        x = x[~(near[0] | near[1])]
        if min(before, after) < 0:
            raise TooNarrow
        if not runs or low.kind != PIECE:
            runs.append([])
        runs[-1].append(InputPath(x, low, high, before, x.size - 1 - after))
    joined = list[InputPath]()
    for pieces in runs:
        sizes = np.array([piece.x.size for piece in pieces])
        counts = np.cumsum(sizes)
        # of a path that closes, its end is the end of a piece too
        ends_of_pieces = [piece.high.x for piece in pieces if piece.high]
        inner = len(pieces) if period else len(pieces) - 1
        joined.append(InputPath(
            np.concatenate([piece.x for piece in pieces]), pieces[0].low, pieces[-1].high,
            pieces[0].first, int(counts[-1] - sizes[-1]) + pieces[-1].last,
            cuts=np.array(ends_of_pieces[:inner]), before_cuts=counts[:inner] - 1))
    if not period:
        return joined
    path, = joined
    return [path._replace(low=None, high=None, first=0, last=-1, period=period)]


def _kernels(singular: Array, points: int) -> Kernels:
    """Return the kernel of ``points`` equal steps of a turn, then those of singular points."""
    # A kernel is a term of t(phi) that crowds samples around the real part of such a point. A
    # point at a distance w from the real inputs gets kernels of the widths w, 4 w, ... below 1.
    centres, widths = [0.0], [40.0]               # as good as infinitely wide: equal steps
    for z in singular:
        width = max(abs(z.imag), NARROWEST)
        while width < 1.0:
            centres.append(z.real)
            widths.append(width)
            width *= WIDER
    weights = np.full(len(centres), float(PER_KERNEL))
    weights[0] = points
    return Kernels(np.array(centres)[:, None], np.tanh(0.5 * np.array(widths))[:, None],
                   weights[:, None] / (2.0 * pi))


def _spread(kernels: Kernels, bounds: tuple[float, float],
            ends: Sequence[End]) -> tuple[Array, int, int]:
    """Return phi at equal steps of t between two bounds, how many points were added at each."""
    # t counts samples, phi [rad] stands for the input, see the top of this file. ends: those of
    # both bounds; () for a full turn. Among equal steps of [0, 1] the first point is half a step
    # from an end: added are points at 1/2, 1/4 ... of that next to a toggle, at 1/sqrt(2), 1/2 ...
    # next to a pole, none at the end of a piece.
    begin, end = kernels.samples(np.array(bounds))[0].tolist()
    least = LEAST_OF_PIECE if any(limit.kind == PIECE for limit in ends) else LEAST
    count = max(int(np.ceil(end - begin)), least)
    octaves = {PIECE: np.zeros(0), POLE: 0.5 * np.arange(1, 1 + POLE_POINTS)}
    before, after = (0.5 / count * 2.0**-octaves.get(kind, np.arange(1.0, 1 + TOGGLE_POINTS))
                     for kind in ([limit.kind for limit in ends] or (PIECE, PIECE)))
    part = np.concatenate((before[::-1], (np.arange(count) + 0.5) / count, 1.0 - after))
    t = begin + (end - begin) * part
    # phi at t(phi) = t: nodes at equal steps of each kernel alone bracket it; a cubic through two
    # of them and their slopes (Hermite) is good to 1e-4 of a step, with one step of Newton's
    # method to 1e-9
    half = 0.5 * (-pi + 2.0 * pi / NODES * np.arange(NODES))
    centres = kernels.centres + 2.0 * np.arctan2(kernels.tangents * np.sin(half), np.cos(half))
    first, last = (round(bound / (2.0 * pi)) for bound in bounds)
    nodes = np.add.outer(np.arange(first - 2, last + 3) * (2.0 * pi), centres).ravel()
    nodes = np.unique(np.concatenate((nodes[(nodes > bounds[0]) & (nodes < bounds[1])], bounds)))
    targets, slope = kernels.samples(nodes)
    i = np.clip(np.searchsorted(targets, t) - 1, 0, nodes.size - 2)
    low, high, rise = nodes[i], nodes[i + 1], targets[i + 1] - targets[i]
    part = (t - targets[i]) / rise
    rest = 1.0 - part
    phi = (low + (high - low) * part * part * (3.0 - 2.0 * part)
           + rise * part * rest * (rest / slope[i] - part / slope[i + 1]))
    phi = np.clip(phi, low, high)
    value, slope = kernels.samples(phi)
    return np.clip(phi - (value - t) / slope, low, high), before.size, after.size
