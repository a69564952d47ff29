"""
All extreme values of motion and loads over the input angle: none missed, for any linkage and mode.

The rate and acceleration of the output at constant input rate have a fast path of their own
(:mod:`fourbar_ros.extrema.four_bar_rates.search`); everything else is searched for by :mod:`fourbar_ros.extrema.path_search`. To the extremes inside the input
range come its ends: toggles, where quantities are unbounded, and the flat positions of change points,
where they have one-sided values.
"""
from __future__ import annotations

from math import inf, isfinite, nan
from typing import NamedTuple

import numpy as np

from fourbar_ros.errors import InvalidParameter
from fourbar_ros.numerics.given import number
from fourbar_ros.mechanisms.four_bar.four_bar import FourBar
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.extrema.input_paths import input_paths
from fourbar_ros.mechanisms.quantities import Function, is_published, select
from fourbar_ros.extrema.four_bar_rates.search import SAMPLES as RATE_SAMPLES
from fourbar_ros.extrema.four_bar_rates.search import rate_extrema
from fourbar_ros.numerics.roots import EPS, fold
from fourbar_ros.extrema.sampling import DifferenceSampler, Sampler
from fourbar_ros.extrema.path_search import Found, search_path

MINIMUM, MAXIMUM, CONSTANT = 'minimum', 'maximum', 'constant'
INTERIOR, LIMIT, ONE_SIDED = 'interior', 'limit', 'one-sided'
_KINDS = {-1: MINIMUM, 1: MAXIMUM, 0: CONSTANT}

SAMPLES = 128
# A condition larger than this is that of a change point, where values of either side are not those of the other.
TRUSTED = 1e6
RATES = ('omega4', 'alpha4')


class Extremum(NamedTuple):
    """
    One extreme value of one quantity in one assembly mode.

    Parameters
    ----------
    quantity, unit : str
    mode : int
    kind : str
        'minimum', 'maximum', or 'constant': the same value over a whole range, from ``theta1`` on.
    theta1 : float
        Crank angle [rad], in [0, 2 pi).
    value : float
        In the quantity's unit; +-inf at an end where the quantity is unbounded.
    is_global : bool
        No other minimum (maximum) of the quantity in this mode is lower (higher), as far as rounding lets tell.
    place : str
        'interior'; 'limit': where the range of the input ends, at a toggle or an end of the stroke; 'one-sided': the value
        towards the flat position of a change point, where the quantity jumps.
    side : int
        +1 (-1): the input is approached from above (below); 0 in the interior.
    condition, value_condition : float
        Link lengths each wrong by a relative eps move the place by up to eps * condition [rad or m] and
        ``value`` by up to the relative eps * value_condition. NaN at ends.
    proof : str
        How it is known that no extreme inside the range is missing: '' if not asked, 'exact count',
        'interval bounds ...', or 'not proved: ...'.
    slide : float
        Of a driven slide [m], where ``theta1`` is the crank's angle; NaN if the crank is driven.

    """

    quantity: str
    unit: str
    mode: int
    kind: str
    theta1: float
    value: float
    is_global: bool
    place: str = INTERIOR
    side: int = 0
    condition: float = nan
    value_condition: float = nan
    proof: str = ''
    slide: float = nan


def find_extrema(linkage, quantities=(), rate=1.0, acceleration=0.0, certify=False, conditions=True,
                 check=lambda: None):
    """
    Return all extreme values over the input angle, in the mode of the linkage.

    Parameters
    ----------
    linkage : FourBar, SliderCrank or InvertedSlider
    quantities : sequence of str, Quantity or callable
        Names (see :data:`~fourbar_ros.mechanisms.quantities.QUANTITIES`), or functions (Motion, Loads) -> value of plain
        arithmetic and numpy functions; with abs, comparisons or ``math`` they are slower and located
        to about 1e-10 rad. Attributes ``unit`` and ``__name__`` are used. Empty: all names for which the
        linkage has data.
    rate, acceleration : float
        Rate and acceleration of the input, the same everywhere: [rad/s] and [rad/s^2], or [m/s] and [m/s^2] of
        a driven slide.
    certify : bool
        Also prove that none is missing, see :mod:`fourbar_ros.extrema.proof`: milliseconds for omega4 and alpha4, a
        second or more for each other quantity.
    conditions : bool
        Also compute condition numbers, which takes a quarter of the time; else they are NaN.
    check : callable
        Called without arguments between the pieces of the work, of a proof every few milliseconds; what it
        raises ends the search.

    Returns
    -------
    list of Extremum
        By quantity, in the order asked, then by theta1 (by the slide if that is driven).

    """
    if not isinstance(linkage, Mechanism):
        raise InvalidParameter('linkage', linkage, 'must be a mechanism: FourBar, SliderCrank or InvertedSlider')
    rate, acceleration = number('rate', rate), number('acceleration', acceleration)
    quantities = _resolve(quantities, linkage)
    check()
    found = _search(linkage, quantities, rate, acceleration, 1, conditions)
    proofs = [''] * len(quantities)
    if certify:
        from fourbar_ros.extrema.proof import NOT_PROVED, prove_counts

        counts, proofs = zip(*prove_counts(linkage, quantities, rate, acceleration, SAMPLES, found, check))
        if any(count not in (None, _interior_count(part)) for count, part in zip(counts, found)):
            found = _search(linkage, quantities, rate, acceleration, 8, conditions)
        proofs = [proof if count in (None, _interior_count(part))
                  else f'{NOT_PROVED}: {_interior_count(part)} found, {count} exist'
                  for proof, count, part in zip(proofs, counts, found)]
    return [extremum for quantity, part, proof in zip(quantities, found, proofs)
            for extremum in _extrema(quantity, linkage, part, proof)]


def _interior_count(found):
    return sum(part.side == 0 and part.sense != 0 for part in found)


def _search(linkage, quantities, rate, acceleration, density, conditions):
    """Return a list of :class:`Found` for each quantity, each searched for in the way that fits it."""
    is_fast = isinstance(linkage, FourBar) and acceleration == 0.0 != rate and linkage.change_point_margin > 0.0
    fast, smooth, rough = [], [], []
    for row, quantity in enumerate(quantities):
        if not is_published(quantity):
            (smooth if _has_complex_step(linkage, quantity, rate, acceleration) else rough).append(row)
        else:
            (fast if is_fast and quantity.name in RATES else smooth).append(row)
    found = [[] for _ in quantities]
    if fast:
        for part in _at_constant_rate(linkage, [quantities[row].name for row in fast], rate, density,
                                      conditions):
            found[fast[part.row]].append(part)
    for kind, rows in ((Sampler, smooth), (DifferenceSampler, rough)):
        if rows:
            chosen = [quantities[row] for row in rows]
            sampler = kind(linkage, chosen, rate, acceleration, not all(map(is_published, chosen)))
            for path in input_paths(linkage, density * SAMPLES):
                for part in search_path(sampler, path, conditions):
                    found[rows[part.row]].append(part)
    return found


def _resolve(quantities, linkage):
    """Return the quantities meant."""
    if isinstance(quantities, str) or hasattr(quantities, 'of') or callable(quantities):
        quantities = (quantities,)
    if not len(quantities):
        return select((), linkage)
    names = [quantity for quantity in quantities if not (hasattr(quantity, 'of') or callable(quantity))]
    named = iter(select(names, linkage) if names else ())
    return [quantity if hasattr(quantity, 'of') else next(named) if not callable(quantity)
            else Function(getattr(quantity, '__name__', 'quantity'), getattr(quantity, 'unit', ''), '', quantity)
            for quantity in quantities]


def _has_complex_step(linkage, quantity, rate, acceleration):
    """Return whether the complex step gives the derivative of a function: tried at some points."""
    path = input_paths(linkage, 32)[0]
    x = path.x[path.first:path.last:3]
    step = 2.0**-12 * np.gradient(path.x)[path.first:path.last:3]
    sampler = Sampler(linkage, (quantity,), rate, acceleration, with_angles=True)
    try:
        values, slopes = sampler.sample(x)
        differences = (sampler.values(x + step) - sampler.values(x - step)) / (2.0 * step)
    except (TypeError, ValueError):
        return False
    agrees = np.abs(slopes - differences) <= 1e-3 * np.max(np.abs(differences))
    agrees &= np.abs(values - sampler.values(x)) <= 1e-6 * np.max(np.abs(values))
    return agrees.mean() > 0.8      # an angle may jump by 2 pi at one of the points


def _at_constant_rate(linkage, names, rate, density, with_conditions):
    """Yield the :class:`Found` of omega4 and alpha4; ``row`` is the index in names."""
    extrema, toggles = rate_extrema(linkage, density * RATE_SAMPLES, with_conditions)
    for row, name in enumerate(names):
        i, factor, sign = (0, rate, 1 if rate > 0.0 else -1) if name == 'omega4' else (1, rate * rate, 1)
        for theta1, value, is_maximum, *conditions in extrema[i]:
            yield Found(row, theta1, factor * value, sign if is_maximum else -sign, 0, False, *conditions)
        for x, side, *is_up in toggles:
            sense = sign if is_up[i] else -sign
            yield Found(row, fold(x), sense * inf, sense, side)


def _extrema(quantity, linkage, found, proof):
    """Return the extrema of one quantity by place, the global ones marked."""
    if not found:
        return []
    low = max(_bounds(part)[1] for part in found if part.value == min(part.value for part in found))
    high = min(_bounds(part)[0] for part in found if part.value == max(part.value for part in found))
    found = sorted(found, key=lambda part: (part.place, part.side))
    unit, is_slide = linkage.input_unit, linkage.is_driven_by_slide
    angles = _crank_angles(linkage, found) if is_slide else [part.place for part in found]
    return [Extremum(quantity.name, quantity.unit, linkage.mode, _KINDS[part.sense], theta1, part.value,
                     part.sense <= 0 and _bounds(part)[0] <= low or part.sense >= 0 and _bounds(part)[1] >= high,
                     INTERIOR if not part.side or not part.sense else ONE_SIDED if part.is_flat else LIMIT,
                     part.side, unit * part.condition, part.value_condition, proof,
                     unit * part.place if is_slide else nan)
            for part, theta1 in zip(found, angles)]


def _bounds(part):
    """Return between which values the value of a :class:`Found` may be: two that overlap are equal."""
    if not isfinite(part.value):
        return part.value, part.value
    condition = part.value_condition if part.value_condition < TRUSTED else 0.0
    error = max(part.noise, 4 * EPS * (16 + condition) * abs(part.value))
    return part.value - error, part.value + error


def _crank_angles(linkage, found):
    """Return the crank's angles where the slide is driven; next to a limit that rounding has put outside."""
    places = linkage.input_unit * np.array([part.place for part in found])
    inward = np.array([part.side for part in found]) * 4.0 * EPS * np.abs(places)
    angles = linkage.motion(places).theta1
    return fold(np.where(np.isnan(angles), linkage.motion(places + inward).theta1, angles)).tolist()
