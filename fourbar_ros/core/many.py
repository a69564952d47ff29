"""Extremes of the output's rate and acceleration of many linkages at once: :mod:`.rates` on arrays."""
from __future__ import annotations

from math import pi
from types import FunctionType
from typing import NamedTuple

import numpy as np

from . import factors
from .elliptic import POINTS_PER_FEATURE, half_turn, phases
from .errors import InvalidParameter
from .extrema import MINIMUM, RATES, find_extrema
from .linkage import CROSSED, OPEN, FourBar
from .rates import sine_constants, sines
from .roots import EPS, bracketed_roots, find_brackets, turn_after
from .search import fold

SAMPLES = 24
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
    count = np.maximum(SAMPLES // 2, 8 * np.ceil(POINTS_PER_FEATURE / 8 * period).astype(int))
    for number in np.unique(count).tolist():
        group = np.nonzero(count == number)[0]
        c = np.ascontiguousarray(constants[:, group])
        _, half = half_turn(*c[:3], crosses_out, crosses_in)
        up, down = half(*(v[:, None] for v in phases(number, not crosses_in, not crosses_out)))
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
    g, k, _, Y = sines.array(sh, ch, constants)
    upward, forward = constants[15] > 0.0, omega1 > 0.0

    def angle(i, row):
        return 2.0 * np.arctan2(sh[i, row], ch[i, row])

    def values(x, row):
        return sines.array(np.sin(0.5 * x), np.cos(0.5 * x), constants[:, row])

    def add(order, row, x, is_maximum):
        g, _, X, Y = values(x, row)
        value = omega1[row]**2 * g / X**3 if order else omega1[row] * Y / X
        found[order].append((index[row], fold(x), value, is_maximum, np.zeros(row.size, int)))

    if not is_closed:
        for i, side in ((0, 1), (-1, -1)):
            row = np.arange(index.size)
            for order, up in ((0, (Y[i] > 0.0) == (upward == forward)), (1, (g[i] > 0.0) == upward)):
                found[order].append((index, fold(angle(i, row)), np.where(up, np.inf, -np.inf), up,
                                     np.full(index.size, side)))

    cell, row, *bracket = find_brackets(lambda x, row: values(x, row)[1], angle, k, is_closed)
    root = bracketed_roots(lambda x, row: values(x, row)[1], row, *bracket)
    add(1, row, root, (bracket[2] >= 0.0) == upward[row])

    if is_closed:
        g, sh, ch = (np.concatenate((v, v[:1])) for v in (g, sh, ch))
    row, *bracket = _brackets_of_g(g, angle, cell, row, root, values(root, row)[0])
    root = bracketed_roots(lambda x, row: values(x, row)[0], row, *bracket)
    add(0, row, root, ((bracket[2] >= 0.0) == upward[row]) == forward[row])


def _brackets_of_g(g, angle, cell, row, root, g_root):
    """Return (row, xa, xb, fa, fb) of the sign changes of g between samples and the roots of k."""
    positive, cells = g >= 0.0, len(g) - 1
    divided = np.zeros((cells, g.shape[1]), bool)
    divided[cell, row] = True
    i, whole = np.nonzero((positive[1:] != positive[:-1]) & ~divided)
    xa = angle(i, whole)
    plain = whole, xa, turn_after(angle(i + 1, whole), xa), g[i, whole], g[i + 1, whole]

    i, col = np.nonzero(divided)
    start = angle(i, col)
    lowest = angle(cell, row)
    root = root + 2.0 * pi * np.round((lowest - root) / (2.0 * pi))      # the turn of its cell
    key = np.concatenate((col * cells + i, row * cells + cell, col * cells + i))
    x = np.concatenate((start, np.maximum(root, lowest), turn_after(angle(i + 1, col), start)))
    f = np.concatenate((g[i, col], g_root, g[i + 1, col]))
    order = np.lexsort((x, key))
    key, x, f = key[order], x[order], f[order]
    j = np.nonzero((key[1:] == key[:-1]) & ((f[1:] >= 0.0) != (f[:-1] >= 0.0)))[0]
    return [np.concatenate(pair) for pair in zip(plain, (key[j] // cells, x[j], x[j + 1], f[j], f[j + 1]))]


def _at_change_point(index, lengths, sign, omega1):
    """Return the same for a linkage at an exact change point, one by one."""
    linkage = FourBar(*lengths.tolist(), mode=OPEN if sign > 0.0 else CROSSED)
    found = {name: [] for name in RATES}
    for extremum in find_extrema(linkage, RATES, float(omega1)):
        found[extremum.quantity].append((extremum.theta1, extremum.value, extremum.kind != MINIMUM, extremum.side))
    for rows in found.values():
        yield [(np.full(len(rows), index), *(np.array(column) for column in zip(*rows)))] if rows else []


def _collect(rows):
    """Return :class:`Extrema` of lists of arrays, sorted, the global ones marked."""
    empty = np.zeros(0)
    index, theta1, value, is_maximum, side = (
        np.concatenate([row[i] for row in rows]) if rows else empty for i in range(5))
    index, is_maximum, side = index.astype(int), is_maximum.astype(bool), side.astype(int)
    order = np.lexsort((theta1, index))
    index, theta1, value, is_maximum, side = (v[order] for v in (index, theta1, value, is_maximum, side))
    is_global = np.zeros(index.size, bool)
    if index.size:
        first = np.nonzero(np.concatenate(([True], index[1:] != index[:-1])))[0]
        number = np.diff(np.append(first, index.size))
        high, low = (np.repeat(extreme.reduceat(value, first), number) for extreme in (np.maximum, np.minimum))
        with np.errstate(invalid='ignore'):
            is_global = np.where(is_maximum, value >= high - np.where(np.isinf(high), 0.0, 64 * EPS * np.abs(high)),
                                 value <= low + np.where(np.isinf(low), 0.0, 64 * EPS * np.abs(low)))
    return Extrema(index, theta1, value, is_maximum, is_global, side)
