"""Proof on demand that a set of extremes is complete, and an honest word where there is none."""
from __future__ import annotations

from fourbar_ros.extrema import interval_proof as intervals
from fourbar_ros.extrema.four_bar_rates import exact_count as sturm
from fourbar_ros.errors import UNITS
from fourbar_ros.mechanisms.four_bar.four_bar import FourBar
from fourbar_ros.extrema.input_paths import input_paths
from fourbar_ros.mechanisms.quantities import is_published
from fourbar_ros.extrema.sampling import Sampler

EXACT_COUNT, INTERVALS, NOT_PROVED = 'exact count', 'interval bounds', 'not proved'
# Nearer than this to a flat position, in the input's unit, enclosures of 0/0 take too many pieces.
LEFT_OUT = 2.0**-13


def prove_counts(linkage, quantities, rate, acceleration, samples, found, check):
    """
    Return how many extremes each quantity has inside the input range, and how that is known.

    The rate of the output, and its acceleration at constant input rate, are counted exactly
    (:mod:`fourbar_ros.extrema.four_bar_rates.exact_count`); the others by interval bounds (:mod:`fourbar_ros.extrema.interval_proof`), which need python-flint and, at
    ends of the range, stop at the last sample. ``found``: what the search found of each quantity. ``check``
    is called between the pieces of the work and may end it by raising.

    Returns
    -------
    list of (int or None, str)
        None: not proved; the text says why.

    """
    proofs = [None] * len(quantities)
    rates = {'omega4': 0} if acceleration else {'omega4': 0, 'alpha4': 1}
    exact = [row for row, quantity in enumerate(quantities)
             if isinstance(linkage, FourBar) and rate and quantity.name in rates and is_published(quantity)]
    if exact:
        counts = sturm.count_extrema(linkage.lengths)
        for row in exact:
            count = counts[rates[quantities[row].name]]
            proofs[row] = count, EXACT_COUNT if count is not None else (
                f'{NOT_PROVED}: constant in a range, or a root of its derivative is not simple')
    for row, quantity in enumerate(quantities):
        if proofs[row] is None and any(part.sense == 0 for part in found[row]):
            proofs[row] = None, f'{NOT_PROVED}: constant in a range'
        elif proofs[row] is None:
            proofs[row] = _by_intervals(linkage, quantity, rate, acceleration, samples, found[row], check)
    return proofs


def _away_from_flats(path):
    """Return a path without its samples next to flat positions."""
    flats = [end.x for end in (path.low, path.high) if end and end.is_flat]
    return path._replace(x=path.x[[all(abs(x - flat) > LEFT_OUT for flat in flats) for x in path.x.tolist()]])


def _by_intervals(linkage, quantity, rate, acceleration, samples, found, check):
    """Return (number, text) of one quantity; what was found in parts left out counts as found there."""
    sampler = Sampler(linkage, (quantity,), rate, acceleration, not is_published(quantity))
    paths = [_away_from_flats(path) for path in input_paths(linkage, samples)]
    try:
        counts = [intervals.count_extrema(sampler, path, check)[0] for path in paths]
    except ImportError:
        return None, f'{NOT_PROVED}: needs the package python-flint'
    except (TypeError, AttributeError) as error:
        return None, f'{NOT_PROVED}: the function does not work on enclosures ({error})'
    if None in counts:
        return None, f'{NOT_PROVED}: more than {intervals.MOST_PIECES} pieces'
    ends = [(side, sampler.unit * end.x, sampler.unit * abs(end.x - x)) for path in paths
            for side, end, x in ((1, path.low, path.x[0]), (-1, path.high, path.x[-1])) if end]
    number = sum(part.side == 0 and any(0.0 < side * linkage.distance(sampler.unit * part.place, at) < width
                                        for side, at, width in ends) for part in found)
    unit = UNITS[linkage.input_coordinate.position]
    return (sum(counts) + number,
            INTERVALS + (f', except {max(width for *_, width in ends):.0e} {unit} at the ends' if ends else ''))
