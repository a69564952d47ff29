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

from collections.abc import Callable, Iterator, Sequence
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


class End(NamedTuple):
    """End of an input path: a toggle, a pole, or where a stroke or a search ends."""

    x: float                     # input, in the mechanism's unit
    is_pole: bool                # a flat position of a change point, where quantities have poles
    is_regular: bool = False     # the end of a stroke or a search, where nothing is singular
    is_inner: bool = False       # the end of a piece: the path goes on beyond it, not smoothly


class Gaps(NamedTuple):
    """Ends of pieces along a path, at which slopes or values of quantities jump."""

    x: Array            # (g,), inputs
    before: Array       # index of the last sample before each; the next sample is beyond it


class InputPath(NamedTuple):
    """
    Samples of a range of the input in which a mechanism moves smoothly in one assembly mode.

    Between ``first`` and ``last`` steps of the path's parameter are equal; beyond, points are
    added next to ``low`` and ``high``.
    """

    x: Array             # (n,), rising inputs; of a full period from half of it below zero on
    low: End | None      # where it begins; None: after the last point is the first
    high: End | None     # where it ends
    first: int           # index of the point half a step from ``low``
    last: int            # index of the point half a step from ``high``
    period: float = inf  # after which the input begins again [rad]
    gaps: Gaps | None = None     # the ends of pieces along it

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
        assert not self.gaps
        start, end = self.x[[0, -1]]
        if self.is_closed:
            points = points - self.period * (points > 0.5 * self.period)
        else:
            points = points[(points > start) & (points < end)]
        x = np.concatenate((self.x, points))
        turn = self.period if self.is_closed else 2.0 * pi
        order = np.unique(x + turn * (x < start), return_index=True)[1]
        first, last = (order.tolist().index(i % self.x.size) for i in (self.first, self.last))
        return self._replace(x=x[order], first=first, last=last)

    def half_a_step_from(self, side: int) -> int:
        """Return the index of the point half a step from the end on this side."""
        return self.first if side > 0 else self.last


def closer_points(end: End | None, count: int) -> Array:
    """
    Return the parameters t of points added at an end at t = 0, ever closer to it.

    Among ``count`` equal steps of [0, 1] the first point is half a step away: these are at 1/2,
    1/4 ... of that next to a toggle, at 1/sqrt(2), 1/2 ... next to a pole; none for no end, and
    at that of a piece.
    """
    if end is None or end.is_inner:
        return np.zeros(0)
    octaves = (0.5 * np.arange(1, 1 + POLE_POINTS) if end.is_pole
               else np.arange(1.0, 1 + TOGGLE_POINTS))
    return 0.5 / count * 2.0**-octaves


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


class Range(NamedTuple):
    """The inputs between two toggles, x = middle + half sin(phi), -pi/2 <= phi <= pi/2."""

    low: float
    high: float

    @property
    def middle(self) -> float:
        """Return the input at phi = 0."""
        return 0.5 * (self.low + self.high)

    @property
    def half(self) -> float:
        """Return half the width."""
        return 0.5 * (self.high - self.low)

    def to_input(self, phi: Array) -> Array:
        """Return x from the distance to the nearer end, which matters near a toggle."""
        return sine_between(self.low, self.high, phi)

    def phi(self, x: float) -> float:
        """Return the phi of an input."""
        return float(np.arcsin((x - self.middle) / self.half))


def input_paths(mechanism: Mechanism, points: int, within: tuple[float, float] | None = None,
                poles: Sequence[float] = (), pieces: Pieces | None = None) -> list[InputPath]:
    """
    Return the paths that make up the motion of a mechanism in its mode.

    ``points`` is the least number of points of a full turn, without those added at the ends.
    ``within``: the inputs [rad or m] between which paths are wanted, of angles at most a period
    apart. ``poles``: those of the mechanism's ``flat_inputs`` at which quantities have poles, so
    that paths end there. ``pieces``: those of loads with forces over a position.
    A slide is given in units of :attr:`input_unit`.
    """
    unit = mechanism.input_unit
    turned = (2.0 * pi * round(mechanism.cut[0] / (2.0 * pi))      # the turn of the stroke
              if mechanism.cut and not mechanism.is_driven_by_slide else 0.0)
    passed = {*mechanism.flat_inputs, *[-x for x in mechanism.flat_inputs if x == pi]}
    singular = np.array([*[z for z in mechanism.singular_inputs
                           if z.imag or z.real in poles or z.real not in passed],
                         *[z - turned for z in (pieces.branch_points if pieces else ())]],
                        complex) / unit
    inner = np.array(pieces.ends if pieces else ()) / unit
    cuts = _cuts(mechanism, within)
    if mechanism.closes_fully:
        period = mechanism.cycle if pieces else mechanism.period
        return [path for cut in cuts
                for path in _of_turns(singular, points, cut, period, inner)]
    paths = []
    for low, high in mechanism.closing_ranges:
        bounds, of_range = Range(low / unit, high / unit), inner
        inside = _beside(singular, bounds, not mechanism.is_driven_by_slide)
        if not mechanism.is_driven_by_slide:        # pieces may lie in the turn of the stroke
            of_range = inner - 2.0 * pi * np.round((inner - bounds.middle) / (2.0 * pi))
        # beside these there are no results
        first, last = (2.0 * BESIDE_FLAT_LIMITS * (end in mechanism.flat_limits)
                       for end in (low, high))
        for begin, end in _in_turns(mechanism, cuts):
            cut = (max(begin / unit, bounds.low + first if first else -inf),
                   min(end / unit, bounds.high - last if last else inf))
            paths += _between(bounds, [End(x, False) for x in bounds], inside, points, cut,
                              of_range)
    return paths


def unresolved(mechanism: Mechanism) -> str:
    """
    Return where a quantity may change faster than samples can follow, in words, '' if nowhere.

    That is next to singular inputs that are nearly, but not, one.
    """
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


def _cuts(mechanism: Mechanism, asked: tuple[float, float] | None
          ) -> Sequence[tuple[float, float] | None]:
    """Return the parts of the input [rad or m] in which paths are wanted; None: all of it."""
    if asked and mechanism.cut:
        return clipped((mechanism.cut,), asked, mechanism.period)
    return [asked or mechanism.cut]


def _in_turns(mechanism: Mechanism, cuts: Sequence[tuple[float, float] | None]
              ) -> Iterator[tuple[float, float]]:
    """Yield parts of the input, angles in each turn in which a range may be [rad or m]."""
    for low, high in [cut or (-inf, inf) for cut in cuts]:
        if mechanism.is_driven_by_slide or low == -inf:
            yield low, high
        else:
            turns = round(low / (2.0 * pi))
            yield from ((low - 2.0 * pi * turn, high - 2.0 * pi * turn)
                        for turn in range(turns - 2, turns + 3))


def _of_turns(singular: Array, points: int, within: tuple[float, float] | None,
              period: float, inner: Array) -> list[InputPath]:
    """
    Return the paths of a crank that turns fully.

    They are a whole period, or lead from one pole or end of ``within`` to the next.
    """
    poles = np.unique(singular.real[singular.imag == 0.0])
    kernels = _kernels(singular[singular.imag != 0.0], points)
    turns = np.arange(-2, 3) * (2.0 * pi)
    ends = {float(x): End(float(x), False, True, True)
            for x in np.add.outer(np.arange(-2, 3) * period, inner).ravel()}
    ends |= {float(x): End(float(x), True) for x in np.add.outer(turns, poles).ravel()}
    ends = dict(sorted(ends.items()))
    if within:
        turn = period * round(sum(within) / (2.0 * period))
        ends = _within(ends, [x - turn for x in within], Range(-inf, inf), float)
    elif ends:
        first = float(poles[0]) if poles.size else float(inner[0])
        ends = {x: end for x, end in ends.items()
                if first <= x <= first + period * (1.0 + 1e-15)}
    else:
        phi = _spread(kernels, (-0.5 * period, 0.5 * period), ())[0]
        return [InputPath(phi, None, None, 0, -1, period)]
    return _paths(kernels, ends, lambda phi: phi, 0.0 if within or poles.size else period)


def _beside(singular: Array, bounds: Range, is_periodic: bool) -> Array:
    """Return the singular inputs but the two toggles; angles also a turn earlier and later."""
    singular = singular[(singular != bounds.low) & (singular != bounds.high)]
    if is_periodic:
        singular = np.concatenate([singular + turn for turn in (-2.0 * pi, 0.0, 2.0 * pi)])
        singular = singular[(np.abs(singular - bounds.low) > NARROWEST)
                            & (np.abs(singular - bounds.high) > NARROWEST)]
    return singular


def _between(bounds: Range, limits: Sequence[End], singular: Array, points: int,
             cut: Sequence[float], inner: Array) -> list[InputPath]:
    """
    Return the paths of a range between two toggles: two, if a pole lies between them.

    ``limits``: the ends of the range; ``cut``: the two inputs to which paths are cut; ``inner``:
    the ends of pieces.
    """
    scaled = (singular - bounds.middle) / bounds.half
    is_pole = (scaled.imag == 0.0) & (np.abs(scaled.real) < 1.0)
    angles = np.arcsin(scaled[~is_pole])
    kernels = _kernels(np.concatenate((angles, pi - angles)), points)
    poles = {float(np.arcsin(sine)): End(float(x), True)
             for sine, x in zip(scaled.real[is_pole], singular.real[is_pole])}
    poles |= {bounds.phi(x): End(float(x), False, True, True)
              for x in inner if bounds.low < x < bounds.high}
    ends = {-0.5 * pi: limits[0], **dict(sorted(poles.items())), 0.5 * pi: limits[1]}
    return _paths(kernels, _within(ends, cut, bounds, bounds.phi), bounds.to_input)


def _within(ends: dict[float, End], cut: Sequence[float], bounds: Range,
            to_phi: Callable[[float], float]) -> dict[float, End]:
    """
    Return {phi: End} of the part of a range between two inputs, which are regular ends.

    Next to a pole, that is the end.
    """
    slack = {phi: NARROWEST if end.is_pole else 0.0 for phi, end in ends.items()}
    low, high = cut
    inside = {phi: end for phi, end in ends.items()
              if low - slack[phi] <= end.x <= high + slack[phi]}
    regular = [x for x in cut if bounds.low < x < bounds.high
               and all(abs(x - end.x) > slack[phi] for phi, end in inside.items())]
    inside.update({to_phi(x): End(x, False, True) for x in regular})
    return dict(sorted(inside.items()))


def _paths(kernels: Kernels, ends: dict[float, End], to_input: Callable[[Array], Array],
           period: float = 0.0) -> list[InputPath]:
    """
    Return the paths between neighbouring ends, {phi: End}, those of pieces joined to one.

    ``to_input``: phi -> x; ``period``: of a path that closes where a piece ends, else 0.
    """
    paths, outer = [], np.array([phi for phi, end in ends.items() if not end.is_inner])
    ends = {phi: end for phi, end in ends.items()
            if not (end.is_inner and outer.size) or np.abs(outer - phi).min() > BESIDE_END}
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
        paths.append(InputPath(x, low, high, before, x.size - 1 - after))
    joined = list[InputPath]()
    for path in paths:
        if path.low and path.low.is_inner and joined:
            joined[-1] = _joined(joined[-1], path, path.low.x)
        else:
            joined.append(path)
    if not period:
        return joined
    path, = joined
    assert path.high
    gaps = path.gaps or Gaps(np.empty(0), np.empty(0, int))
    return [InputPath(path.x, None, None, 0, -1, period, Gaps(
        np.append(gaps.x, path.high.x), np.append(gaps.before, path.x.size - 1)))]


def _joined(path: InputPath, following: InputPath, x: float) -> InputPath:
    """Return two paths as one, with a gap between them at the input x."""
    gaps = path.gaps or Gaps(np.empty(0), np.empty(0, int))
    count = path.x.size
    return InputPath(np.concatenate((path.x, following.x)), path.low, following.high, path.first,
                     count + following.last, path.period,
                     Gaps(np.append(gaps.x, x), np.append(gaps.before, count - 1)))


def _kernels(singular: Array, points: int) -> Kernels:
    """
    Return the kernel of ``points`` equal steps of a turn, then those of singular points.

    A kernel is a term of t(phi) that crowds samples around the real part of such a point.
    A point at a distance w from the real inputs gets kernels of the widths w, 4 w, ... below 1.
    """
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
    """
    Return phi at equal steps of t between two bounds, and how many points were added at each end.

    t counts samples, phi [rad] stands for the input, see the top of this file. ``ends``: those of
    both bounds; () for a full turn.
    """
    begin, end = kernels.samples(np.array(bounds))[0].tolist()
    least = LEAST_OF_PIECE if any(limit.is_inner for limit in ends) else LEAST
    count = max(int(np.ceil(end - begin)), least)
    before, after = (closer_points(end, count) for end in ends or (None, None))
    part = np.concatenate((before[::-1], (np.arange(count) + 0.5) / count, 1.0 - after))
    return _inverse(kernels, bounds, begin + (end - begin) * part), before.size, after.size


def _inverse(kernels: Kernels, bounds: tuple[float, float], t: Array) -> Array:
    """
    Return phi at t(phi) = t.

    Nodes at equal steps of each kernel alone bracket it; a cubic through two of them and their
    slopes (Hermite) is good to 1e-4 of a step, with one step of Newton's method to 1e-9.
    """
    half = 0.5 * (-pi + 2.0 * pi / NODES * np.arange(NODES))
    centres = kernels.centres + 2.0 * np.arctan2(kernels.tangents * np.sin(half), np.cos(half))
    nodes = np.add.outer(np.arange(-2, 3) * (2.0 * pi), centres).ravel()
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
    return np.asarray(np.clip(phi - (value - t) / slope, low, high))
