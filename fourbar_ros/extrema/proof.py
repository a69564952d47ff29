# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Proof on demand that a set of extrema is complete, and the reason where there is no proof."""
from __future__ import annotations

from collections.abc import Callable, Sequence

from fourbar_ros.extrema import interval_proof
from fourbar_ros.extrema.four_bar_rates import exact_count
from fourbar_ros.extrema.input_paths import InputPath
from fourbar_ros.extrema.path_search import Found
from fourbar_ros.extrema.sampling import Sampler

EXACT_COUNT, INTERVALS, NOT_PROVED = 'exact count', 'interval bounds', 'not proved'
# Nearer than this to a flat position, in the input's unit, enclosures of 0/0 take too many pieces.
LEFT_OUT = 2.0**-13

# number of extrema inside the input range, if proved; how, or why not
Proof = tuple[int | None, str]


def exact_counts(lengths: Sequence[float]) -> list[Proof]:
    """
    Return the proofs of the output's rate and, at constant input rate, its acceleration.

    For a four-bar.
    """
    return [(count, EXACT_COUNT if count is not None else
             f'{NOT_PROVED}: constant in a range, or a root of its derivative is not simple')
            for count in exact_count.count_extrema(lengths)]


def by_intervals(sampler: Sampler, paths: Sequence[InputPath], found: Sequence[Found],
                 check: Callable[[], None]) -> Proof:
    """
    Return the proof of the only quantity of a sampler by interval bounds, which need python-flint.

    At ends of the range they stop at the last sample; what was found in parts left out counts as
    found there.
    """
    if any(part.sense == 0 for part in found):
        return None, f'{NOT_PROVED}: constant in a range'
    paths = [_away_from_flats(path) for path in paths]
    try:
        counts = [interval_proof.count_extrema(sampler, path, check)[0] for path in paths]
    except ImportError:
        return None, f'{NOT_PROVED}: needs the package python-flint'
    except (TypeError, AttributeError) as error:
        return None, f'{NOT_PROVED}: the function does not work on enclosures ({error})'
    decided = [count for count in counts if count is not None]
    if len(decided) < len(counts):
        return None, f'{NOT_PROVED}: more than {interval_proof.MOST_PIECES} pieces'
    linkage = sampler.linkage
    ends = [(side, sampler.unit * end.x, sampler.unit * abs(end.x - path.x[path.inward(side)[0]]))
            for path in paths for side, end in path.ends()]
    number = sum(part.side == 0 and any(0.0 < side * linkage.distance(sampler.unit * part.place,
                                                                      at) < width
                                        for side, at, width in ends) for part in found)
    unit = linkage.input_coordinate.unit
    return (sum(decided) + number,
            INTERVALS + (f', except {max(width for *_, width in ends):.0e} {unit} at the ends'
                         if ends else ''))


def _away_from_flats(path: InputPath) -> InputPath:
    """Return a path without its samples next to flat positions."""
    flats = [end.x for _, end in path.ends() if end.is_flat]
    return path._replace(x=path.x[[all(abs(x - flat) > LEFT_OUT for flat in flats)
                                   for x in path.x.tolist()]])
