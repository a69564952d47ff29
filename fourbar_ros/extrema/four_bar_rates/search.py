# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
All extrema of theta4' and theta4'' of four-bars at constant input rate, many linkages at once.

Between two roots of g (:mod:`.sines`) lies one of k, so only k can hide a pair of roots between
samples. It is looked at closely; then the roots of k and the samples bracket those of g. This does
the work of both documents' algorithms of extreme values, on arrays and without a root taken twice.
"""
from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

from fourbar_ros.extrema.four_bar_rates.paths import Path, paths_of, SAMPLES, stacked
from fourbar_ros.extrema.four_bar_rates.sines import make_sines, sine_constants, Sines
from fourbar_ros.mechanisms.four_bar.four_bar import FourBar
from fourbar_ros.mechanisms.four_bar.motion import make_motion
from fourbar_ros.mechanisms.half_angle import bilinear_factors, Factors
from fourbar_ros.numerics.arrays import Array, Values
from fourbar_ros.numerics.exact_sums import exact_sum_of_four
from fourbar_ros.numerics.newton import newton_roots_and_states
from fourbar_ros.numerics.number_types import ARRAY, Function, power_of_two_of_arrays
import numpy as np

# Above this ratio of the longest link to the shortest, samples do without the loop and values are
# computed again by the more accurate formulas.
UNEQUAL = 10.0
# The more accurate formula may move a root by at most this [rad].
POLISH = 2.0**-12
# Lengths are arrays too: one linkage an element.
_MANY = replace(ARRAY, name='arrays of linkages', exact_sum=exact_sum_of_four,
                power_of_two=power_of_two_of_arrays)


class RateExtrema(NamedTuple):
    """Extrema of theta4' or of theta4'' of some linkages; arrays of shape (extrema,)."""

    row: Array            # number of the linkage
    theta1: Array         # [rad], may be a turn away from [0, 2 pi)
    value: Array          # of theta4' or theta4''; +-inf at toggles
    is_maximum: Array
    side: Array           # at a toggle +1 where a range begins, -1 where it ends; else 0
    spacing: Array        # width of the interval that was searched [rad]; NaN at toggles


NOTHING = RateExtrema(np.zeros(0, int), np.zeros(0), np.zeros(0), np.zeros(0, bool),
                      np.zeros(0, int), np.zeros(0))
Both = tuple[RateExtrema, RateExtrema]      # of theta4' and of theta4''


def at_rate(found: RateExtrema, rate: Values, order: int) -> tuple[Array, Array]:
    """
    Return values of omega4 (order 0) or alpha4 (1) at an input rate, and which are maxima.

    ``found``: at 1 rad/s; ``rate``: a number, or one for each extremum [rad/s]. A negative rate
    turns maxima of omega4 into minima, not those of alpha4. A square that underflows leaves kinds
    and infinities as they are.
    """
    is_upward = (rate > 0.0) | (order == 1)
    with np.errstate(over='ignore', under='ignore', invalid='ignore'):
        value = np.float64(rate)**(order + 1) * found.value
    value = np.where(np.isinf(found.value), np.where(is_upward, 1.0, -1.0) * found.value, value)
    return value, found.is_maximum == is_upward


class Linkages(NamedTuple):
    """The data of n linkages that the search needs."""

    lengths: Array        # (4, n), over a power of two, so that the largest is about one
    sign: Array           # of sin(mu): the assembly mode
    constants: Array      # from :func:`.sine_constants`
    limits: Array         # (2, n): theta1 of the toggles near 0 and near pi [rad], or NaN
    closes: Array         # whether it can be assembled
    is_flat: Array        # whether it is at an exact change point, and left out

    @classmethod
    def of(cls, lengths: Array, sign: Array) -> Linkages:
        """Return the data of linkages from lengths [m], shape (4, n), and signs of sin(mu)."""
        with np.errstate(all='ignore'):
            scaled = np.ldexp(lengths, -np.frexp(lengths.max(axis=0))[1])
            a1, a2, a3, a4 = scaled
            factors = bilinear_factors(a1, a2, a3, a4, exact_sum_of_four)
            constants = np.array(sine_constants(scaled, factors, sign))
            # each link shorter than the other three together
            closes = ((factors.A2 > 0.0) & (factors.B1 > 0.0) & (factors.C2 > 0.0)
                      & (factors.D2 < 0.0) & np.isfinite(scaled).all(axis=0)
                      & (lengths > 0.0).all(axis=0))
            is_flat = closes & ((constants[0] == 0.0) | (constants[1] == 0.0))
            return cls(scaled, sign, constants, _limits(factors, *constants[:2]), closes, is_flat)


def rate_extrema(linkage: FourBar, samples: int = SAMPLES) -> Both:
    """Return the extrema of one linkage, not at a change point; ends and values as its motion."""
    given = Linkages.of(np.array(linkage.lengths)[:, None], np.array([linkage.sign]))
    ends = np.array(linkage.input_ranges[-1])[:, None]
    return search(given._replace(limits=np.where(np.isnan(given.limits), np.nan, ends)), samples,
                  1.0, linkage.motion_formula(ARRAY, linkage.constants))


def _limits(f: Factors, s1: Array, s2: Array) -> Array:
    """Return theta1 of the toggles of each linkage near 0 and near pi, (2, n), NaN for none."""
    inner, outer = f.A2 * f.B1, -f.C2 * f.D2     # s2b, s1b of input_paths, without their sums
    return np.array((2.0 * np.arctan2(np.sqrt(-s2), np.sqrt(inner)),
                     2.0 * np.arctan2(np.sqrt(outer), np.sqrt(-s1))))


def search(given: Linkages, samples: int = SAMPLES, unequal: float = UNEQUAL,
           motion: Function | None = None) -> Both:
    """
    Return the extrema of theta4' and theta4'' of linkages, toggles among them.

    Linkages at change points are left out. ``samples``: at least so many for a full turn;
    ``unequal``: as :data:`UNEQUAL`; ``motion``: the formula of the linkage, if there is one alone.
    """
    is_unequal = given.lengths.max(axis=0) >= unequal * given.lengths.min(axis=0)
    paths = list(paths_of(given.constants, given.closes & ~given.is_flat, is_unequal, samples))
    if not paths:
        return NOTHING, NOTHING
    sines, upward = _Sines(given.constants), given.sign > 0.0

    def extrema(value: Array, x: Array, brackets: list[Array]) -> RateExtrema:
        """Return roots x as extrema: maxima where g or k falls and X > 0, or rises and X < 0."""
        row, xa, xb, fa, _ = brackets
        return RateExtrema(row, x, value, (fa >= 0.0) == upward[row], np.zeros(x.size, int),
                           xb - xa)

    # All roots of k at once; then those of g between them and the samples.
    with np.errstate(all='ignore'):
        cells, *brackets = stacked(path.brackets_of_k(sines.k) for path in paths)
        x, step, g, gu, k, X = newton_roots_and_states(sines.k_and_step, *brackets)
        square = X * X
        # g/X^3 at the root; its slope is k/X^5
        value = (g - 0.5 * step * k / square) / (X * square)
        _improve(given, is_unequal, motion, (brackets[0], x.copy()), value)
        second = extrema(value, x, brackets)
        ends = np.cumsum([path.number for path in paths])
        g -= gu / X * step
        parts = (np.split(v, ends[:-1]) for v in (cells, x, g, g * X / gu))
        brackets = stacked(path.brackets_of_g(*part) for path, *part in zip(paths, *parts))
        x, step, g, k, X, Y = newton_roots_and_states(sines.g_and_step, *brackets)
        square = X * X
        value = (Y - 0.5 * step * g / square) / X
        _improve(given, is_unequal, motion, (brackets[0], x), value, k / (X * square * square))
    return _with_toggles(given, paths, (extrema(value, x, brackets), second))


def _with_toggles(given: Linkages, paths: list[Path], extrema: Both) -> Both:
    """Return extrema and, added to them, the toggles at the ends of paths: infinite values."""
    ends = [path.ends() for path in paths if not path.is_closed]
    if not ends:
        return extrema
    row, side, x, g, Y = stacked(ends)
    # theta1 from the lengths, without the roundings of the sample there
    near, far = given.limits.take(row, axis=1)
    is_near = np.isnan(far) | (np.abs(np.abs(x) - near) < np.abs(np.abs(x) - far))
    x = np.copysign(np.where(is_near, near, far), x)
    upward = (given.sign > 0.0)[row]

    def joined(inside: RateExtrema, is_up: Array) -> RateExtrema:
        """Return extrema with all toggles, where the value is +inf if ``is_up``, else -inf."""
        added = row, x, np.where(is_up, np.inf, -np.inf), is_up, side, np.full(x.size, np.nan)
        return RateExtrema(*map(np.concatenate, zip(inside, added)))
    return joined(extrema[0], (Y > 0.0) == upward), joined(extrema[1], (g > 0.0) == upward)


def _improve(given: Linkages, unequal: Array, of_one: Function | None,
             where: tuple[Array, Array], value: Array, third: Array | None = None) -> None:
    """
    Replace, in place, values of extrema of linkages with very unequal links by accurate ones.

    ``where``: (linkage, theta1) of the extrema of theta4''. With the ``third`` derivative they are
    those of theta4', and theta1 is corrected too, by a Newton step. The usual formulas lose digits
    where a link is ten times as long as another.
    """
    rows, x = where
    i = np.nonzero(unequal[rows])[0]
    if not i.size:
        return
    formula = of_one or make_motion(
        _MANY, *np.vstack((given.lengths[:, rows[i]], given.sign[rows[i]])))
    motion = formula(x[i], 1.0, 0.0)
    if third is not None:
        correction = motion.alpha4 / third[i]
        x[i] -= np.where(np.abs(correction) < POLISH, correction, 0.0)
        motion = formula(x[i], 1.0, 0.0)
    value[i] = motion.alpha4 if third is None else motion.omega4


class _Sines:
    """
    The functions g and k of :func:`.make_sines` at (theta1, linkage), as root finders call them.

    Constants of the last rows are kept: Newton's method asks for the same ones again.
    """

    def __init__(self, constants: Array) -> None:
        """Keep the constants of all linkages, (constants, n)."""
        self._constants = constants
        self._row: Array | None = None
        self._at: Sines

    def _of(self, x: Array, row: Array) -> tuple[Array, ...]:
        """Return g, g_u, k, k_u, X, Y at theta1 = x of the linkages ``row``."""
        if row is not self._row:       # Newton's method asks for the same linkages again
            self._row, self._at = row, make_sines(
                ARRAY, tuple(self._constants.take(row, axis=1)))
        x = 0.5 * x
        s, c = np.sin(x), np.cos(x)
        return self._at(s * s, c * c, s * c)

    def k(self, x: Array, row: Array) -> Array:
        return self._of(x, row)[2]

    def k_and_step(self, x: Array, row: Array) -> tuple[Array, ...]:
        """Return k, the step of Newton's method, g, g_u, k, X."""
        g, gu, k, ku, X, _ = self._of(x, row)
        return k, k * X / ku, g, gu, k, X

    def g_and_step(self, x: Array, row: Array) -> tuple[Array, ...]:
        """Return g, the step of Newton's method, g, k, X, Y."""
        g, gu, k, _, X, Y = self._of(x, row)
        return g, g * X / gu, g, k, X, Y
