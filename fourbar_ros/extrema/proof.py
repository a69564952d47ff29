# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Proof on demand that a set of extrema is complete, and the reason where there is no proof."""
from __future__ import annotations

from collections.abc import Callable, Sequence
from math import inf, nan, pi
from typing import NamedTuple

from fourbar_ros.extrema.four_bar_rates import exact_count
from fourbar_ros.extrema.input_paths import InputPath
from fourbar_ros.extrema.interval_proof import find_parts, Part, Parts, WIDEST
from fourbar_ros.extrema.path_search import PathExtremum
from fourbar_ros.extrema.sampling import Sampler
from fourbar_ros.mechanisms.quantities import is_published
import numpy as np
from numpy.polynomial.polynomial import polyval

EXACT_COUNT, INTERVALS, NOT_PROVED = 'exact count', 'interval bounds', 'not proved'
# Nearer than this to a flat position, in the input's unit, enclosures of 0/0 take too many pieces.
LEFT_OUT = 2.0**-13
# Nearer than this to a limit, over the range: the rounding of the distance hides the derivatives.
LEFT_OUT_AT_LIMIT = 2.0**-30
# How well a proof confirms places [in the input's unit], if rounding allows it, and values: over
# themselves, and over the largest value (of a root: of the squares).
PLACE, VALUE, OF_LARGEST = 2.0**-32, 2.0**-32, 2.0**-40


class Verdict(NamedTuple):
    """Whether extrema contradict a proof, and a text about them."""

    is_contradicted: bool
    text: str


class Count(NamedTuple):
    """The number of extrema inside the input range, if it is known; how, or why not."""

    exist: int | None
    text: str

    @property
    def ends_of_parts(self) -> list[float]:
        """Return nothing: where extrema are, a number does not say."""
        return []

    def verdict(self, found: Sequence[PathExtremum]) -> Verdict:
        """Return whether as many extrema were found inside the range as exist."""
        number = sum(is_interior(part) for part in found)
        if self.exist in (None, number):
            return Verdict(False, self.text)
        return Verdict(True, f'{NOT_PROVED}: {number} found, {self.exist} exist')


def is_interior(part: PathExtremum) -> bool:
    """Return whether this is an extremum inside the input range."""
    return part.side == 0 and part.sense != 0


def exact_counts(lengths: Sequence[float]) -> list[Count]:
    """Return the proofs of a four-bar's omega4 and, at constant input rate, its alpha4."""
    return [Count(count, EXACT_COUNT if count is not None else
                  f'{NOT_PROVED}: constant in a range, or a root of its derivative is not simple')
            for count in exact_count.count_extrema(lengths)]


class Enclosures:
    """
    All extrema of a quantity, each enclosed in a part of a path.

    Next to the ends of a range nothing is enclosed: extrema found there are taken as they are.
    ``enclosed``: results of :func:`find_parts` for each path. ``is_angle``: values may differ by
    whole turns.
    """

    def __init__(self, sampler: Sampler, paths: Sequence[InputPath], enclosed: Sequence[Parts],
                 is_angle: bool) -> None:
        """Join the parts of all paths; ends are (side, input, width left out), in its unit."""
        self._linkage, self._unit, self._is_angle = sampler.linkage, sampler.unit, is_angle
        self._why_not = next((of_path.why_not for of_path in enclosed if of_path.why_not), '')
        self._parts = [part for of_path in enclosed for part in of_path.parts]
        self._largest = max(of_path.largest for of_path in enclosed)
        self._ends = [(side, self._unit * end.x,
                       self._unit * abs(end.x - path.x[path.inward(side)[0]]))
                      for path in paths for side, end in path.ends()]

    @property
    def ends_of_parts(self) -> list[float]:
        """Return inputs between whose pairs there is one extremum each."""
        return [end for part in self._parts for end in (part.low, part.high)]

    def verdict(self, found: Sequence[PathExtremum]) -> Verdict:
        """
        Return whether these are the extrema: as many, of the same kinds, places and values.

        Each one found is matched with an enclosure; the text says how well places are confirmed,
        or which one is not.
        """
        if self._why_not:
            return Verdict(False, f'{NOT_PROVED}: {self._why_not}')
        inside = [one for one in found if is_interior(one) and not self._is_left_out(one)]
        left_out, left = sum(map(is_interior, found)) - len(inside), list(self._parts)
        if len(inside) != len(left):
            return Verdict(True, f'{NOT_PROVED}: {len(inside) + left_out} found, '
                                 f'{len(left) + left_out} exist')
        coordinate, width = self._linkage.input_coordinate, PLACE
        turns = (0,) if self._linkage.is_driven_by_slide else (-1, 0, 1)    # paths may go beyond
        for one in inside:
            inputs = [one.place + 2.0 * pi * turn for turn in turns]
            part, x = next(((part, x) for part in left for x in inputs
                            if part.sense == one.sense and
                            part.low - PLACE <= x <= part.high + PLACE), (None, nan))
            around = _width(part, x) if part else inf
            if part is None or around == inf or not self._has_value(part, x, one):
                kind = 'minimum' if one.sense < 0 else 'maximum'
                return Verdict(True, f'{NOT_PROVED}: no {kind} of {one.value:.12g} confirmed at '
                                     f'{coordinate.position} = {self._unit * one.place:.12g}')
            left.remove(part)
            width = max(width, around)
        text = INTERVALS
        if width > PLACE:
            text += f', places to {self._unit * width:.0e} {coordinate.unit}'
        if self._ends:
            text += (f', except {max(width for *_, width in self._ends):.0e} {coordinate.unit} '
                     'at the ends')
        return Verdict(False, text)

    def _is_left_out(self, one: PathExtremum) -> bool:
        """Return whether an extremum is so near to an end that nothing is enclosed there."""
        return any(0.0 < side * self._linkage.distance(self._unit * one.place, at) < width
                   for side, at, width in self._ends)

    def _has_value(self, part: Part, x: float, one: PathExtremum) -> bool:
        """Return whether the enclosed quantity has, at x, the value that was found."""
        value, size = _value_and_slope(part, x)[0], abs(one.value)
        bound = VALUE * size + one.noise
        if part.is_square:
            return (one.value >= 0.0 and abs(value - size * size)
                    <= bound * (2.0 * size + bound) + OF_LARGEST * self._largest)
        off = value - one.value
        off -= 2.0 * pi * round(off / (2.0 * pi)) * self._is_angle
        return abs(off) <= bound + OF_LARGEST * self._largest


def _width(part: Part, x: float) -> float:
    """
    Return how near to x the extremum in a part is, inf if it may be far.

    The interval about x is doubled until the derivative at both ends is larger than its error: if
    it changes sign as the kind of extremum says, the extremum lies in it.
    """
    width = PLACE
    while width < WIDEST:
        before, after = (_value_and_slope(part, min(max(at, part.low), part.high))[1] * part.sense
                         for at in (x - width, x + width))
        if min(abs(before), abs(after)) > part.slope_error:
            return width if before > 0.0 > after else inf
        width *= 2.0
    return inf


def _value_and_slope(part: Part, x: float) -> tuple[float, float]:
    """Return the enclosed quantity (of a root its square) at x, and its derivative by t."""
    t, c = (x - part.middle) / part.radius, part.c
    return float(polyval(t, c)), float(polyval(t, c[1:] * np.arange(1, len(c))))


def share_of(check: Callable[[float], None], done: int, parts: int) -> Callable[[float], None]:
    """Return the function that takes the share of one part of the work, others done before it."""
    return lambda share: check((done + share) / parts)


def by_intervals(sampler: Sampler, rows: Sequence[int], paths: Sequence[InputPath],
                 found: Sequence[Sequence[PathExtremum]], check: Callable[[float], None],
                 seconds: float) -> list[Count | Enclosures]:
    """
    Return the proofs of the quantities ``rows`` of a sampler by enclosures over all paths.

    ``found``: the extrema of each quantity; one constant in a range is not proved. ``check`` and
    ``seconds`` as for :func:`.interval_proof.find_parts`.
    """
    varying = {i: row for i, row in enumerate(rows) if all(part.sense for part in found[i])}
    paths = [_away_from_ends(path) for path in paths]
    enclosed = [find_parts(sampler, [*varying.values()], path, share_of(check, done, len(paths)),
                           seconds / len(paths)) for done, path in enumerate(paths)]
    proofs: list[Count | Enclosures] = [
        Count(None, f'{NOT_PROVED}: constant in a range') for _ in found]
    for (i, row), *parts in zip(varying.items(), *enclosed):
        proofs[i] = Enclosures(sampler, paths, parts, bool(sampler.is_angle[row])
                               or not is_published(sampler.quantities[row]))
    return proofs


def _away_from_ends(path: InputPath) -> InputPath:
    """Return a path without its samples next to flat positions and limits."""
    if path.is_closed:
        return path
    ends = [end for _, end in path.ends()]
    limit = LEFT_OUT_AT_LIMIT * (ends[-1].x - ends[0].x)
    return path._replace(x=path.x[[
        all(abs(x - end.x) > (LEFT_OUT if end.is_flat else limit) for end in ends)
        for x in path.x.tolist()]])
