# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Where a machine can be assembled: the ranges of its input, dyad by dyad.

Within the range of the dyads before it, a closing (:mod:`.closings`) is analytic in phi, with x =
middle + half sin(phi) between two toggles. It is sampled with its derivative (a complex step) and
halved until the cubic through both ends of each piece predicts the middle; a piece whose cubic
comes near zero is halved on. Signs that change are then halved to the last bit of the input. This
finds every range that is wider than the last pieces, some 1e-10 of the whole, and proves nothing.
"""
from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from math import pi
from typing import Any, NamedTuple

from fourbar_ros.mechanisms.machine.closings import closes_somewhere, Closing, make_closings
from fourbar_ros.mechanisms.machine.description import CYLINDER, PRP
from fourbar_ros.mechanisms.machine.layout import Layout, Stage
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.numerics.number_types import COMPLEX, REAL
import numpy as np

PIECES, MOST_HALVINGS = 96, 26
STEP = 2.0**-200                 # complex step
MISFIT, ROUNDING = 1e-4, 2.0**-47
NEWTON_STEPS = 12


class Limit(NamedTuple):
    """An end of a range: the input, and the dyad that is at a toggle there, if one is."""

    x: float
    dyad: str

    def turned(self) -> Limit:
        """Return the same one turn later."""
        return Limit(self.x + 2.0 * pi, self.dyad)


Near = Callable[[], list[complex]]


class Closings(NamedTuple):
    """
    The ranges in which dyads close.

    ``limits`` has (low, high) of each, None of a full turn; ``near``: functions that return
    complex inputs next to the ranges at which some dyad is in line; ``stopped``: the first dyad
    that closes nowhere, or ''.
    """

    limits: tuple[tuple[Limit, Limit] | None, ...]
    near: tuple[Near, ...]
    stopped: str = ''


def cylinder_range(numbers: Sequence[float]) -> tuple[float, float]:
    """Return the lengths of a cylinder between which it closes with the crank it turns."""
    rho, b = REAL.hypot(*numbers[:2]), REAL.hypot(*numbers[2:4])
    return abs(rho - b), rho + b


def find_ranges(layout: Layout, numbers: Sequence[Any], signs: Sequence[Any],
                bounds: tuple[float, float]) -> Closings:
    """
    Return where all dyads of a layout close.

    Parameters
    ----------
    layout, numbers, signs
        As for :func:`.motion.make_motion`.
    bounds : tuple of 2 floats
        For a driven slide: where to search [m].

    """
    if layout.driver == 'crank':
        limits: list[Any] = [None]
    else:
        low, high = bounds
        if layout.driver == CYLINDER:
            low, high = cylinder_range(numbers[0])
        name = CYLINDER if layout.driver == CYLINDER else ''
        limits = [(Limit(low, name), Limit(high, name))]
    near: list[Near] = []
    every = make_closings(COMPLEX, layout, numbers, signs, len(layout.stages))
    screens: dict[Any, dict[int, Near]] = {}
    for count, stage in enumerate(layout.stages):
        if not closes_somewhere(stage):
            continue
        found: list[Any] = []
        for bound in limits:
            if bound not in screens:
                screens[bound] = _screen(bound, layout, every)
            parts, minima = [bound], screens[bound].get(count)
            if minima is None:
                parts, minima = _split(bound, stage, *[
                    make_closings(n, layout, numbers, signs, count + 1) for n in (COMPLEX, REAL)])
            found += parts
            near.append(minima)
        limits = found
        if not limits:
            return Closings((), (), stage.name)
    return Closings(tuple(limits), tuple(near))


class _Path(NamedTuple):
    """The inputs between two limits, or of a full turn, by phi."""

    low: float
    high: float
    is_closed: bool

    @classmethod
    def of(cls, bound: tuple[Limit, Limit] | None) -> _Path:
        if bound is None:
            return cls(-pi, pi, True)
        return cls(bound[0].x, bound[1].x, False)

    def to_input(self, phi: Any) -> Any:
        if self.is_closed:
            return phi
        half = 0.5 * (self.high - self.low)
        return np.where(phi.real < 0.0, self.low + 2.0 * half * np.sin(0.5 * (phi + 0.5 * pi))**2,
                        self.high - 2.0 * half * np.sin(0.5 * (0.5 * pi - phi))**2)

    def start(self) -> Array:
        """Return phi in equal steps; without a toggle at either end, where it is singular."""
        if self.is_closed:
            return np.linspace(-pi, pi, PIECES + 1)
        return 0.5 * pi * np.sin(0.5 * pi * np.linspace(-1.0, 1.0, PIECES + 1)) * (1.0 - 1e-7)


def _screen(bound: tuple[Limit, Limit] | None, layout: Layout,
            every: Closing) -> dict[int, Near]:
    """
    Return {number of a dyad: what is near it} of those that need no closer look.

    With one evaluation of all: on a grid and between, cubics hold and stay away from zero.
    """
    path = _Path.of(bound)
    phi = path.start()
    middle = 0.5 * (phi[1:] + phi[:-1])
    with np.errstate(all='ignore'):
        closings = every(path.to_input(np.concatenate((phi, middle)) + 1j * STEP))
    clean: dict[int, Near] = {}
    for number, (stage, closing) in enumerate(zip(layout.stages, closings)):
        if not closes_somewhere(stage):
            continue
        both = closing + np.zeros(phi.size + middle.size, complex)
        value, slope = both.real, both.imag / STEP
        if stage.kind == PRP and value[0] < 0.0:
            value, slope = -value, -slope
        ends, inner = (value[:phi.size], slope[:phi.size]), (value[phi.size:], slope[phi.size:])
        doubtful = _doubtful(ends, inner, np.arange(middle.size), phi[1:] - phi[:-1])
        if not (value > 0.0).all() or doubtful.any():
            break            # what hangs on it is not known either
        clean[number] = partial(_near, every, number, path, phi, *ends)
    return clean


def _near(closings: Closing, number: int, path: _Path, phi: Array, value: Array,
          slope: Array) -> list[complex]:
    """Return the complex toggles of a dyad next to the minima between samples."""
    is_open = value > 0.0
    return [z for i in np.flatnonzero((slope[:-1] <= 0.0) & (slope[1:] > 0.0)
                                      & is_open[:-1] & is_open[1:])
            for z in _complex_toggle(lambda x: closings(x)[number], path, phi[i:i + 2],
                                     value[i:i + 2], slope[i:i + 2])]


def _split(bound: tuple[Limit, Limit] | None, stage: Stage, in_complex: Closing,
           in_floats: Closing) -> tuple[list[Any], Near]:
    """Return the parts of a range in which one more dyad closes, and what is near it."""
    path, is_signed = _Path.of(bound), stage.kind == PRP

    def sample(phi: Array) -> tuple[Array, Array]:
        with np.errstate(all='ignore'):
            value = in_complex(path.to_input(phi + 1j * STEP))[-1] + 0.0 * phi
        return value.real, value.imag / STEP

    phi, value, slope = _resolved(path.start(), sample)
    is_open = value > 0.0
    changes = np.flatnonzero(is_open[1:] != is_open[:-1])
    roots = []
    for i in changes:
        low, high = path.to_input(phi[i:i + 2]).tolist()
        roots.append(_root(lambda x: in_floats(x)[-1], low, high, bool(is_open[i])))
    if is_signed:
        value, slope = np.abs(value), np.where(is_open, slope, -slope)
    near = partial(_near, in_complex, -1, path, phi, value, slope)
    if not roots:
        return ([bound] if is_open.all() or is_signed else []), near
    ends = [Limit(x, stage.name) for x in roots]
    if is_signed:
        return list(_between_all(bound, ends)), near
    if path.is_closed:
        if is_open[0]:       # the first part began before -pi
            ends.append(ends.pop(0).turned())
    else:
        assert bound is not None
        ends = [bound[0]] * bool(is_open[0]) + ends + [bound[1]] * bool(is_open[-1])
    return list(zip(ends[::2], ends[1::2])), near


def _between_all(bound: tuple[Limit, Limit] | None,
                 ends: list[Limit]) -> Iterator[tuple[Limit, Limit]]:
    """Yield the parts between limits of which both sides are open."""
    every = [*ends, ends[0].turned()] if bound is None else [bound[0], *ends, bound[1]]
    return zip(every, every[1:])


def _resolved(phi: Array, sample: Callable[[Array], tuple[Array, Array]]) -> tuple[Array, ...]:
    """Return phi, values and derivatives, so close that cubics between them hold."""
    value, slope = sample(phi)
    pending = np.ones(phi.size - 1, bool)
    for _ in range(MOST_HALVINGS):
        i = np.flatnonzero(pending)
        if not i.size:
            break
        width = phi[i + 1] - phi[i]
        middle = phi[i] + 0.5 * width
        here, its = sample(middle)
        doubtful = _doubtful((value, slope), (here, its), i, width)
        phi, value, slope = (np.insert(old, i + 1, new) for old, new in
                             ((phi, middle), (value, here), (slope, its)))
        pending = np.zeros(phi.size - 1, bool)
        left = i + np.arange(i.size)
        pending[left] = pending[left + 1] = doubtful
    return phi, value, slope


def _doubtful(ends: tuple[Array, Array], inner: tuple[Array, Array], i: Array,
              width: Array) -> Array:
    """Return which pieces ``i`` a cubic does not describe, or that may hide two roots."""
    (value, slope), (here, its) = ends, inner
    cubic = 0.5 * (value[i] + value[i + 1]) + 0.125 * width * (slope[i] - slope[i + 1])
    misfit = np.abs(here - cubic)
    size = np.maximum(np.abs(value[i]), np.abs(value[i + 1]))
    halves = [_least(value[i], slope[i], here, its, 0.5 * width),
              _least(here, its, value[i + 1], slope[i + 1], 0.5 * width)]
    crosses = (value[i] > 0.0) != (value[i + 1] > 0.0)
    doubtful: Array = ((misfit > MISFIT * size) | ~np.isfinite(misfit)
                       | (~crosses & (np.minimum(*halves) < 4.0 * misfit)))
    doubtful &= (width > 1e-11) & (size > ROUNDING)
    return doubtful


def _least(f0: Array, d0: Array, f1: Array, d1: Array, width: Array) -> Array:
    """Return the least of |cubic| over a piece, about: zero if it changes its sign."""
    t = np.linspace(0.0, 1.0, 9)[:, None]
    cubic = ((1.0 + 2.0 * t) * (1.0 - t)**2 * f0 + t * (1.0 - t)**2 * width * d0
             + t * t * (3.0 - 2.0 * t) * f1 - t * t * (1.0 - t) * width * d1)
    least: Array = np.abs(cubic).min(axis=0)
    return np.where((cubic > 0.0).any(axis=0) != (cubic > 0.0).all(axis=0), 0.0, least)


def _root(closing: Closing, low: float, high: float, opens_low: bool) -> float:
    """Return the last input on the open side, halving to neighbouring floats."""
    while True:
        middle = 0.5 * (low + high)
        if not low < middle < high:
            return low if opens_low else high
        try:
            is_open = closing(middle) > 0.0
        except (ValueError, ZeroDivisionError):
            is_open = False
        if is_open is opens_low:
            low = middle
        else:
            high = middle


def _complex_toggle(closing: Closing, path: _Path, phi: Array, value: Array,
                    slope: Array) -> list[complex]:
    """Return the complex input near a minimum at which a closing vanishes; none if far away."""
    width = phi[1] - phi[0]
    at = phi[0] - slope[0] * width / (slope[1] - slope[0])
    z = np.array([at + 1j * np.sqrt(2.0 * value.min() * width / (slope[1] - slope[0]))])
    h = 2.0**-26
    with np.errstate(all='ignore'):
        for _ in range(NEWTON_STEPS):
            here, there = (closing(path.to_input(w)) for w in (z, z + h * (1.0 + 0.0j)))
            z = z - here * h / (there - here)
        x = complex(path.to_input(z)[0])
    is_near = np.isfinite(x) and x.imag != 0.0 and abs(z[0].imag) < 2.0
    return [x] if is_near else []
