# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Extrema over a part of the input range, as that in which a robot moves a joint.

Those found over the whole range, as far as they lie in the part, and the values at its ends.
Between neighbouring extrema a quantity rises or falls, so that the nearest one tells whether an
end is a minimum or a maximum.
"""
from __future__ import annotations

from collections.abc import Callable, Sequence
from math import isfinite, pi
from typing import Any, NamedTuple

from fourbar_ros.errors import in_words, InvalidParameter
from fourbar_ros.extrema.path_search import PathExtremum
from fourbar_ros.extrema.search import Search
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.numerics.arrays import EPS
from fourbar_ros.numerics.given import number
from fourbar_ros.numerics.roots import fold


class InputPart(NamedTuple):
    """A part of the input, from ``low`` to ``high`` [rad or m], in which the links close."""

    low: float
    high: float
    ends: tuple[bool, bool]     # whether it ends where the user said, not in a limit


def parts_of(linkage: Mechanism, within: Any) -> list[InputPart]:
    """Return the parts of the input between two inputs [rad or m], by rising input."""
    try:
        low, high = (number('within', value) for value in within)
    except (TypeError, ValueError):
        raise InvalidParameter('within', within, 'must be two finite inputs') from None
    if not low < high:
        raise InvalidParameter('within', within, 'must be two inputs, the lower one first')
    if linkage.is_driven_by_slide:
        ranges = list(linkage.input_ranges)
    elif high - low > 2.0 * pi:
        raise InvalidParameter('within', within, 'must span a turn at most')
    elif linkage.turns_fully:
        ranges = [(-2.0 * pi + low, 2.0 * pi + high)]
    else:
        turns = round(low / (2.0 * pi))
        ranges = [(one + 2.0 * pi * turn, other + 2.0 * pi * turn)
                  for turn in range(turns - 2, turns + 3) for one, other in linkage.input_ranges]
    found = [InputPart(max(low, one), min(high, other), (low > one, high < other))
             for one, other in ranges if max(low, one) < min(high, other)]
    if not found:
        unit = linkage.input_coordinate.unit
        raise InvalidParameter('within', within, 'the links close at none of these inputs, but in '
                               + in_words(linkage.input_ranges, unit))
    return found


def in_part(search: Search, linkage: Mechanism, part: InputPart,
            found: Sequence[Sequence[PathExtremum]]) -> list[list[PathExtremum]]:
    """Return those of the extrema of each quantity that lie in a part, and the part's ends."""
    unit, width = linkage.input_unit, part.high - part.low
    slack = 4.0 * EPS * max(1.0, abs(part.low), abs(part.high)) * unit
    at_ends = [search.values_at(x / unit) if is_end else None
               for x, is_end in zip(part[:2], part.ends)]

    def place(x: float) -> float:
        """Return an input as the search gives it: an angle in [0, 2 pi), a slide in its unit."""
        return x / unit if linkage.is_driven_by_slide else float(fold(x))

    def from_low(one: PathExtremum) -> float:
        """Return how far beyond ``low`` an extremum is, of angles less than a turn."""
        beyond = unit * one.place - part.low + slack
        return (beyond if linkage.is_driven_by_slide else beyond % (2.0 * pi)) - slack

    def of_one(row: int, every: Sequence[PathExtremum]) -> list[PathExtremum]:
        inside = sorted((one for one in every if -slack <= from_low(one) <= width + slack
                         and not (from_low(one) <= slack and one.side < 0)
                         and not (from_low(one) >= width - slack and one.side > 0)),
                        key=lambda one: (from_low(one), one.side))
        return _with_ends(row, part, place, inside, [
            values[row] if values else None for values in at_ends],
            [one.value for one in every if not one.sense])
    return [of_one(row, every) for row, every in enumerate(found)]


def _with_ends(row: int, part: InputPart, place: Callable[[float], float],
               inside: list[PathExtremum], values: Sequence[float | None],
               constant: Sequence[float]) -> list[PathExtremum]:
    """Return the extrema inside and the ends that the user gave, of one quantity."""
    known = [value if value is not None and isfinite(value) else None for value in values]
    if not inside and any(value is not None and any(
            abs(value - other) <= 64.0 * EPS * abs(other) for other in constant)
            for value in known):
        return [PathExtremum(row, place(part.low), constant[0], 0, 1)]
    every = list(inside)
    for side, x, value, far in ((1, part.low, known[0], known[1]),
                                (-1, part.high, known[1], known[0])):
        near = inside[0 if side > 0 else -1] if inside else None
        if value is not None and (near is None or near.sense):
            other = near.value if near else far if far is not None else value
            every.append(PathExtremum(row, place(x), value,
                                      1 if value > other or value == other and side > 0 else -1,
                                      side))
    return every
