"""
All extreme values of motion and loads over the input angle: none missed, for any linkage and mode.

Each quantity Q is sampled on the paths of :mod:`.elliptic` with its exact derivative dQ/dtheta1, by a
complex step through the same formulas that compute Q. Sign changes of the derivative, and dips of its
magnitude between samples, are bracketed and all brackets of all quantities solved at once. To these come the ends of the
paths: toggles, where quantities are unbounded, and flat positions, where they have one-sided values.
"""
from __future__ import annotations

from math import comb, inf, isfinite, pi
from typing import NamedTuple

import numpy as np

from .elliptic import input_paths
from .errors import InvalidParameter, MissingBodies
from .kinematics import Motion
from .loads import Loads
from .quantities import Quantity, select
from .roots import EPS, bracketed_roots, brackets, dips

MINIMUM, MAXIMUM, CONSTANT = 'minimum', 'maximum', 'constant'
INTERIOR, LIMIT, ONE_SIDED = 'interior', 'limit', 'one-sided'

SAMPLES = 128
# Complex step: its square vanishes beside one, and it is nothing beside the distance of any sample
# from a toggle or a flat position.
STEP = 2.0**-200


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
        Input angle [rad], in [0, 2 pi).
    value : float
        In the quantity's unit; +-inf at an end where the quantity is unbounded.
    is_global : bool
        No other minimum (maximum) of the quantity in this mode is lower (higher).
    place : str
        'interior'; 'limit': at a toggle, where the range of the input ends; 'one-sided': the value
        towards a flat position, where the quantity jumps.
    side : int
        +1 (-1): theta1 is approached from above (below); 0 in the interior.

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


def find_extrema(linkage, quantities=(), omega1=1.0, alpha1=0.0):
    """
    Return all extreme values over the input angle, in the mode of the linkage.

    Parameters
    ----------
    linkage : FourBar
    quantities : sequence of str, Quantity or callable
        Names (see :data:`.quantities.QUANTITIES`), or functions (Motion, Loads) -> value. Empty: all
        names for which the linkage has data.
    omega1, alpha1 : float
        Input rate [rad/s] and acceleration [rad/s^2], the same at every angle.

    Returns
    -------
    list of Extremum
        By quantity, in the order asked, then by theta1.

    """
    for name, value in (('omega1', omega1), ('alpha1', alpha1)):
        if not isfinite(value):
            raise InvalidParameter(name, value, 'must be a finite number')
    quantities = _resolve(quantities, linkage.bodies is not None)
    found = [[] for _ in quantities]
    for path in input_paths(linkage, SAMPLES):
        sampler = _Sampler(linkage, quantities, omega1, alpha1)
        for row, extremum in _search(sampler, path):
            found[row].append(extremum)
    return [extremum for part in found for extremum in _mark_global(part)]


def _resolve(quantities, has_bodies):
    if isinstance(quantities, str) or callable(quantities):
        quantities = (quantities,)
    if not quantities:
        return select((), has_bodies)
    return [q if hasattr(q, 'of') else select((q,))[0] if isinstance(q, str) else _UserQuantity(q)
            for q in quantities]


class _UserQuantity:
    def __init__(self, function):
        self.name, self.unit = getattr(function, '__name__', repr(function)), getattr(function, 'unit', '')
        self.of = function
        self.is_load = True


class _Sampler:
    """Values and derivatives of some quantities of a linkage."""

    def __init__(self, linkage, quantities, omega1, alpha1):
        self.linkage, self.quantities, self.rates = linkage, quantities, (omega1, alpha1)
        self.needs_loads = any(q.is_load for q in quantities)
        if self.needs_loads and linkage.bodies is None:
            raise MissingBodies

    def __call__(self, x, dialect=2):
        """Return the quantities at x, shape (quantities, x.size)."""
        with np.errstate(all='ignore'):
            motion = self.linkage._motion[dialect](x, *self.rates)
            loads = Loads(*self.linkage._loads[dialect](motion)) if self.needs_loads else None
            motion = Motion(*motion)
            values = np.empty((len(self.quantities), x.size), x.dtype)
            for row, quantity in zip(values, self.quantities):
                row[:] = quantity.of(motion, loads)
        return values

    def with_slopes(self, x):
        """Return values and exact derivatives with respect to x."""
        values = self(x + 1j * STEP)
        return values.real, values.imag / STEP

    def slope(self, x, row):
        """Return the derivative of quantity ``row[i]`` at x[i]."""
        return self(x + 1j * STEP)[row, np.arange(x.size)].imag / STEP


def _search(sampler, path):
    """Yield (row, Extremum) along one path."""
    x = path.theta1
    values, slopes = sampler.with_slopes(x)
    if path.is_closed:
        x = np.concatenate((x, x[:2] + 2.0 * pi))
        slopes = np.concatenate((slopes, slopes[:, :2]), axis=1)
        found = brackets(x[:-1], slopes[:, :-1])
    else:
        found = brackets(x, slopes)
    hidden = dips(sampler.slope, x, slopes)
    row, xa, xb, fa, fb = (np.concatenate(parts) for parts in zip(found, hidden))
    root = bracketed_roots(sampler.slope, row, xa, xb, fa, fb)
    theta1 = fold(root)
    value = sampler(theta1, 1)[row, np.arange(row.size)]
    for q, kind, angle, v in sorted(zip(row.tolist(), fa >= 0.0, theta1.tolist(), value.tolist())):
        quantity = sampler.quantities[q]
        yield q, Extremum(quantity.name, quantity.unit, sampler.linkage.mode, MAXIMUM if kind else MINIMUM,
                          angle, v, False)


def fold(x):
    """Return angles in [0, 2 pi)."""
    folded = np.where(x < 0.0, x + 2.0 * pi, np.where(x >= 2.0 * pi, x - 2.0 * pi, x))
    return np.where(folded >= 2.0 * pi, 0.0, folded)


def _mark_global(extrema):
    """Return the extrema of one quantity by theta1, the global ones marked."""
    if not extrema:
        return []
    low, high = min(e.value for e in extrema), max(e.value for e in extrema)
    return [e._replace(is_global=e.value <= low + 64 * EPS * abs(low) if e.kind == MINIMUM
                       else e.value >= high - 64 * EPS * abs(high))
            for e in sorted(extrema, key=lambda e: (e.theta1, e.side))]
