"""Extremes of the output's rate and acceleration of many linkages at once: :mod:`.rates` on arrays."""
from __future__ import annotations

from math import pi
from types import FunctionType
from typing import NamedTuple

import numpy as np

from . import factors
from .elliptic import half_turn
from .extrema import INTERIOR, MINIMUM, RATES, find_extrema
from .linkage import CROSSED, OPEN, FourBar
from .errors import FourBarError, InvalidParameter
from .rates import POINTS_PER_FEATURE, sine_constants, sines
from .roots import EPS, bracketed_roots, brackets, dips
from .search import fold

SAMPLES = 32
# Linkages taken at a time: their samples stay in the cache.
CHUNK = 2048


class Extrema(NamedTuple):
    """
    Extremes of one quantity of many linkages, by linkage, then theta1; arrays of shape (extremes,).

    Parameters
    ----------
    index : ndarray of int
        Which linkage.
    theta1, value : ndarray
        Input angle [rad], in [0, 2 pi), and the quantity there; +-inf at toggles.
    is_maximum, is_global : ndarray of bool
    side : ndarray of int
        0 inside the input range; at an end of it +1 (-1): approached from above (below).

    """

    index: np.ndarray
    theta1: np.ndarray
    value: np.ndarray
    is_maximum: np.ndarray
    is_global: np.ndarray
    side: np.ndarray


def _exact_sum(terms):
    """Return the sum of four arrays as math.fsum would: two exact pairs, their exact sum, the errors."""
    a, b, c, d = terms
    (one, e1), (other, e2) = _two_sum(a, b), _two_sum(c, d)
    total, e3 = _two_sum(one, other)
    return total + (e3 + (e1 + e2))


def _two_sum(a, b):
    total = a + b
    part = total - a
    return total, (a - (total - part)) + (b - part)


_FACTORS = {**vars(factors), 'fsum': _exact_sum}
_FACTORS.update({name: FunctionType(function.__code__, _FACTORS)
                 for name, function in vars(factors).items() if isinstance(function, FunctionType)})
_constants = FunctionType(sine_constants.__code__, {**sine_constants.__globals__, **{
    name: _FACTORS[name] for name in ('half_angle_coefficients', 'difference_of_squares')}})


def find_extrema_many(a1, a2, a3, a4, mode=OPEN, omega1=1.0, progress=None):
    """
    Return all extremes of omega4 and alpha4 of many linkages at constant input rate.

    Parameters
    ----------
    a1, a2, a3, a4 : array_like
        Lengths [m]; broadcast to one dimension. Linkages that cannot be assembled have no extremes.
    mode, omega1 : array_like
        Assembly mode (1 or 2) and input rate [rad/s], not zero.
    progress : callable, optional
        Called with the part done so far, from 0 to 1, some ten times a second.

    Returns
    -------
    dict of str to Extrema
        For 'omega4' and 'alpha4'.

    """
    a1, a2, a3, a4, mode, omega1 = np.broadcast_arrays(*np.atleast_1d(a1, a2, a3, a4, mode, omega1))
    if not (np.isfinite(omega1) & (omega1 != 0.0)).all():
        raise InvalidParameter('omega1', omega1, 'must be finite, not zero')
    if not np.isin(mode, (CROSSED, OPEN)).all():
        raise InvalidParameter('mode', mode, 'must be 1 (crossed) or 2 (open)')
    lengths = np.array((a1, a2, a3, a4), dtype=float)
    sign = np.where(mode == OPEN, 1.0, -1.0)
    parts = ([], [])
    for start in range(0, sign.size, CHUNK):
        chunk = slice(start, start + CHUNK)
        for quantity, rows in zip(parts, _search(lengths[:, chunk], sign[chunk], omega1[chunk])):
            quantity += [(index + start, *others) for index, *others in rows]
        if progress is not None:
            progress(min(start + CHUNK, sign.size) / sign.size)
    return {name: _collect(rows) for name, rows in zip(RATES, parts)}


def _search(lengths, sign, omega1):
    """Return for each quantity a list of tuples (index, theta1, value, is_maximum, side) of arrays."""
    with np.errstate(all='ignore'):
        scaled = np.ldexp(lengths, -np.frexp(lengths.max(axis=0))[1])
        signs = (-1.0, 1.0, 1.0, 1.0), (1.0, -1.0, 1.0, 1.0), (1.0, 1.0, -1.0, 1.0), (1.0, 1.0, 1.0, -1.0)
        closes = np.all([_exact_sum([s * a for s, a in zip(row, scaled)]) > 0.0 for row in signs], axis=0)
        closes &= np.isfinite(scaled).all(axis=0) & (lengths > 0.0).all(axis=0)
        constants = np.array(_constants(*scaled, sign))
    found = ([], [])
    is_flat = closes & ((constants[0] == 0.0) | (constants[1] == 0.0))
    for index in np.nonzero(is_flat)[0].tolist():
        for quantity, rows in zip(found, _at_change_point(index, lengths[:, index], sign[index], omega1[index])):
            quantity += rows
    for out in (False, True):
        for inside in (False, True):
            index = np.nonzero(closes & ~is_flat & ((constants[0] > 0.0) == out) & ((constants[1] > 0.0) == inside))[0]
            if index.size:
                _search_class(found, index, constants[:, index], omega1[index], out, inside)
    return found


def _search_class(found, index, constants, omega1, crosses_out, crosses_in):
    """Add the extremes of linkages of one kind of input range, in groups of one number of samples."""
    period, _ = half_turn(*constants[:3], crosses_out, crosses_in)
    count = np.maximum(SAMPLES // 2, 2**np.ceil(np.log2(POINTS_PER_FEATURE * period)).astype(int))
    for number in np.unique(count).tolist():
        group = np.nonzero(count == number)[0]
        c = np.ascontiguousarray(constants[:, group])
        _, half = half_turn(*c[:3], crosses_out, crosses_in)
        t = np.concatenate(([] if crosses_in else [0.0], (np.arange(number) + 0.5) / number,
                            [] if crosses_out else [1.0]))[:, None]
        # a right angle less a right angle would not be zero
        up, down = half(np.sin(0.5 * pi * t), np.sin(0.5 * pi * (1.0 - t)))
        scale = 1.0 / np.sqrt(up * up + down * down)
        sh, ch = up * scale, down * scale
        mirrored = -sh[::-1], ch[::-1]
        if not crosses_in and not crosses_out:
            paths = [mirrored, (sh, ch)]
        else:
            both = (mirrored, (sh, ch)) if crosses_in else ((sh, ch), mirrored)
            paths = [tuple(np.concatenate(pair) for pair in zip(*both))]
        for path in paths:
            _search_path(found, index[group], c, omega1[group], *path, crosses_in and crosses_out)


def _search_path(found, index, constants, omega1, sh, ch, is_closed):
    """Add the extremes along one path of each linkage; sh, ch: shape (samples, linkages)."""
    def function(order):
        return lambda x, row: sines.array(np.sin(0.5 * x), np.cos(0.5 * x), constants[:, row])[order]

    def angle(i, row):
        return 2.0 * np.arctan2(sh[i, row], ch[i, row])

    if is_closed:
        sh, ch = np.concatenate((sh, sh[:2])), np.concatenate((ch, ch[:2]))
    g, k, X, Y = sines.array(sh, ch, constants)
    upward = constants[15] > 0.0
    if not is_closed:
        for i, side in ((0, 1), (-1, -1)):
            theta1 = fold(angle(i, np.arange(index.size)))
            for quantity, up in zip(found, ((Y[i] > 0.0) == (upward == (omega1 > 0.0)), (g[i] > 0.0) == upward)):
                quantity.append((index, theta1, np.where(up, np.inf, -np.inf), up, np.full(index.size, side)))
    last = sh.shape[0] - 1 - is_closed

    # roots of k, hidden pairs included
    i, row = np.nonzero((k[1:last + 1] >= 0.0) != (k[:last] >= 0.0))
    xa = angle(i, row)
    cells = [i]
    plain = row, xa, turn_after(angle(i + 1, row), xa), k[i, row], k[i + 1, row]
    size = np.abs(k)
    i, row = np.nonzero((size[1:-1] <= size[:-2]) & (size[1:-1] < size[2:]))
    j = (k[i, row] >= 0.0) == (k[i + 1, row] >= 0.0)
    j &= (k[i + 2, row] >= 0.0) == (k[i + 1, row] >= 0.0)
    i, row = i[j], row[j]
    xs = [angle(i, row)]
    xs += [turn_after(angle(i + j, row), xs[0]) for j in (1, 2)]
