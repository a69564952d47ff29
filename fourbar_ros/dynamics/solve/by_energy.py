# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Motion of a crank by its energy, without steps in time.

Where every force depends on the input alone (weight, loads, springs, a constant torque T of the
drive), the kinetic energy K is an integral over the input, and so is the time:

    K = K0 + integral of (Q + T) dq,    t = integral of sqrt(J / (2 K)) dq                 (F3)

Both converge geometrically on panels (:mod:`fourbar_ros.dynamics.solve.by_energy`). J and Q repeat
with every turn: later turns need no new evaluations. The potential is not used, so that the
constancy of energy remains a check.

On a panel, x from 0 to 1, the input is

    q = q0 + L x,    from rest  q = q0 + L x^2                                             (F4)

because from rest the time has a root in its denominator, in q but not in x. Polynomials through
values at Chebyshev's points are integrated. Every second point gives polynomials of half the
degree, and the difference estimates the error.

The points include the ends (Clenshaw and Curtis). Source: Trefethen, Approximation Theory and
Approximation Practice (2013), chapters 3, 4 and 19.
"""
from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache
from math import inf, pi, tau
from typing import NamedTuple

from fourbar_ros.dynamics.model.smooth import flat_positions
from fourbar_ros.dynamics.model.system import System
from fourbar_ros.dynamics.solve.integrators import Part
from fourbar_ros.dynamics.solve.phase import COMPLETE
from fourbar_ros.numerics.arrays import Array
import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

PANELS = 8             # of a turn, at first
NARROW = 2.0           # longest panel over its distance to a complex singularity, at first
LOCAL = 0.03           # error of a panel over that allowed for the motion: errors add up
MOST_LEVELS, MOST_PANELS, MOST_CYCLES = 60, 4000, 300     # beyond, integrators are faster


def can_follow(system: System) -> bool:
    """Return whether forces depend on the input alone, and nothing stops the crank."""
    phase = system.course.first
    return (system.depends_on_input_alone and system.has_no_limits and phase.is_input
            and not phase.can_end and not system.events(phase))


def follow(system: System, until: float, tolerance: float,
           wanted: Array | None) -> tuple[Part, float, int] | None:
    """
    Return the motion up to a time [s], the error of its position [rad], evaluations of poses.

    The error is estimated by polynomials of half the degree. None if it stays above the tolerance
    [rad], if the crank rests, turns back or may be stopped, or if forces depend on more than its
    angle. ``wanted``: times of the result; None: the ends of panels.
    """
    if not can_follow(system):
        return None
    times, states = [np.zeros(1)], [np.array(system.start)[:, None]]
    if wanted is not None and wanted[0] > 0.0:
        times, states = [], []
    motion, error, before = _Motion(system, until, tolerance), 0.0, 0.0
    for panels, passage in motion.cycles():
        error = max(error, passage.error)
        if error > tolerance:
            return None
        ends = passage.time[:, -1]
        asked = np.append(ends[ends < until], until) if wanted is None else wanted
        asked = asked[(asked > before) & (asked <= ends[-1])]
        times.append(asked)
        states.append(states_at(panels, passage, asked)[:len(system.start)])
        before = float(ends[-1])
    if before < until:
        return None
    return Part(system.course.first, np.concatenate(times), np.concatenate(states, axis=1),
                COMPLETE), error, motion.evaluations


class _Motion:
    """The motion of a system up to a time [s], turn by turn, to a tolerance [rad]."""

    def __init__(self, system: System, until: float, tolerance: float) -> None:
        """Take its constant torque and, as ``_peaks``, the complex inputs where J or Q peak."""
        self._equation, self._until, self._tolerance = system.equation, until, tolerance
        self._torque = system.torque(0.0, system.start)
        self._start, self._rate = system.start[:2]
        mechanism = self._equation.mechanism
        self._cycle = tau * (1 + len(flat_positions(mechanism)) % 2)
        self._peaks = [z for z in mechanism.singular_inputs if z.imag]
        self._spacing = float(np.spacing(abs(self._start) + self._cycle))
        self.evaluations = 0

    def cycles(self) -> Iterator[tuple[Panels, Passage]]:
        """Yield panels and passage of each turn; stop at the last time, or where it gives up."""
        terms = self._equation.terms(self._start)
        direction = self._rate if self._rate else terms.force + self._torque
        if direction == 0.0:
            return
        panels = self._first_cycle(1.0 if direction > 0.0 else -1.0)
        kinetic = 0.5 * terms.inertia * self._rate**2
        begin = Begin(kinetic, rough_kinetic=kinetic)
        for _ in range(MOST_CYCLES):
            resolved = self._resolved(panels, begin)
            if resolved is None:
                return
            yield resolved
            begin = resolved[1].end
            if begin.time >= self._until:
                return
            panels = self._next_cycle(resolved[0])

    def _first_cycle(self, direction: float) -> Panels:
        """Return panels over the first turn in a direction (+-1), narrow next to sharp peaks."""
        count = PANELS * round(self._cycle / tau)
        first: Array = self._start + np.arange(count) * (direction * self._cycle / count)
        length: Array = np.full(count, direction * self._cycle / count)
        power: Array = np.ones(count)
        power[0] = 1.0 if self._rate else 2.0
        for _ in range(MOST_LEVELS):
            is_long = np.abs(length) > NARROW * self._distance(first, length)
            if not is_long.any():
                break
            first, length, power = halves(first, length, power, is_long)
        return self._panels(first, length, power)

    def _distance(self, first: Array, length: Array) -> Array:
        """
        Return the distance [rad] of each panel from the nearest complex singularity.

        The nearer it is, in lengths of the panel, the slower polynomials converge.
        """
        nearest = np.full(first.size, inf)
        for z in self._peaks:
            away = np.remainder(z.real - first - 0.5 * length + pi, tau) - pi
            beside = np.maximum(np.abs(away) - 0.5 * np.abs(length), 0.0)
            nearest = np.minimum(nearest, np.hypot(beside, z.imag))
        return nearest

    def _panels(self, first: Array, length: Array, power: Array) -> Panels:
        """Return panels with inertia and forces, evaluated at their points."""
        places = Panels.places(first, length, power)
        self.evaluations += places.size
        terms = self._equation.terms(places)
        couples = self._equation.couples(places) if self._equation.has_couples else 0.0
        return Panels(first, length, power, terms.inertia, terms.force + self._torque,
                      self._torque + couples + np.zeros(places.shape))

    def _next_cycle(self, panels: Panels) -> Panels:
        """Return the panels a turn on; J and Q repeat, only one from rest is evaluated again."""
        moved = panels._replace(first=panels.first + np.sign(panels.length) * self._cycle)
        if moved.power[0] == 1.0:
            return moved
        return self._panels(moved.first[:1], moved.length[:1], np.ones(1)).joined(
            moved.pick(np.arange(1, moved.first.size)))

    def _resolved(self, panels: Panels, begin: Begin) -> tuple[Panels, Passage] | None:
        """
        Return panels narrow enough up to the last time, and how the crank passes them.

        Panels whose own error is too large are halved. None: the crank turns back, or takes more
        panels than allowed.
        """
        for _ in range(MOST_LEVELS):
            passage = pass_over(panels, begin, self._spacing)
            starts = np.append(begin.time, passage.time[:-1, -1])
            used = np.arange(int(np.sum(starts < self._until)))
            if passage.turns_back[used].any() or panels.first.size > MOST_PANELS:
                return None
            is_rough = np.zeros(panels.first.size, bool)
            is_rough[used] = ~(passage.errors[used] <= LOCAL * self._tolerance)
            if not is_rough.any():
                panels = panels.pick(used)
                return panels, pass_over(panels, begin, self._spacing)
            rough = panels.pick(is_rough)
            new = halves(*rough[:3], np.ones(rough.first.size, bool))
            panels = panels.pick(~is_rough).joined(self._panels(*new))
        return None


class Panel(NamedTuple):
    """Points, and matrices that act on values at them, of a polynomial of some degree."""

    points: Array            # (degree + 1,), increasing from 0 to 1
    coefficients: Array      # values -> coefficients of Chebyshev's polynomials
    integral: Array          # values -> integral from 0 to each point

    @property
    def weights(self) -> Array:
        """Return the weights of the integral over the panel (Clenshaw and Curtis)."""
        return np.asarray(self.integral[-1])


@lru_cache(maxsize=4)
def panel(degree: int) -> Panel:
    """Return Chebyshev's points and the matrices of a :class:`Panel`, for an even degree."""
    x = -np.cos(np.arange(degree + 1) * (pi / degree))
    x[degree // 2] = 0.0
    coefficients = np.linalg.inv(chebyshev.chebvander(x, degree))
    integrals = chebyshev.chebint(np.eye(degree + 1), lbnd=-1, scl=0.5)
    return Panel(0.5 * (x + 1.0), coefficients,
                 chebyshev.chebvander(x, degree + 1) @ integrals @ coefficients)


def at(places: Array, degree: int) -> Array:
    """Return Chebyshev's polynomials at places of the panel, a row for each place."""
    return chebyshev.chebvander(2.0 * places - 1.0, degree)


DEGREE = 32
FINE, ROUGH = panel(DEGREE), panel(DEGREE // 2)
SEEN = 0.01            # error of the rough work over the work, below which its sign is believed
NEWTON = 20


class Panels(NamedTuple):
    """Consecutive panels, with the inertia and the forces there."""

    first: Array         # q0, (n,)
    length: Array        # L, (n,); negative for a crank that turns backwards
    power: Array         # of x, (n,): 2 from rest, else 1
    inertia: Array       # J at the points, (n, DEGREE + 1)
    force: Array         # Q + T
    supplied: Array      # the part of it that has no potential: T and couples

    @staticmethod
    def places(first: Array, length: Array, power: Array) -> Array:
        """Return the inputs at the points."""
        return np.asarray(first[:, None] + length[:, None] * FINE.points**power[:, None])

    def pick(self, places: NDArray[np.generic]) -> Panels:
        """Return some of these panels, by index or mask."""
        return Panels(*[row[places] for row in self])

    def joined(self, others: Panels) -> Panels:
        """Return these panels and others, sorted in the order in which the crank passes them."""
        rows = [np.concatenate(pair) for pair in zip(self, others)]
        order = np.argsort(rows[0] * np.sign(rows[1][0]), kind='stable')
        return Panels(*[row[order] for row in rows])


class Begin(NamedTuple):
    """Sums over all panels before."""

    kinetic: float
    time: float = 0.0
    work: float = 0.0              # of loads without a potential
    rough_kinetic: float = 0.0     # by polynomials of half the degree alone
    doubt: float = 0.0             # errors of the time by these and by rounding of inputs [s]


class Passage(NamedTuple):
    """Sums over panels, at their points, (n, DEGREE + 1), and their errors."""

    kinetic: Array
    time: Array
    work: Array
    slowness: Array      # dt/dx
    end: Begin
    error: float         # largest error of the position, from the doubt [rad]
    errors: Array        # of the rough polynomials of each panel by itself [rad], (n,)
    turns_back: NDArray[np.bool_]      # whether the kinetic energy falls below zero, (n,)


def halves(first: Array, length: Array, power: Array,
           which: NDArray[np.bool_]) -> tuple[Array, Array, Array]:
    """Return panels in the order of the motion, halved in x where the mask ``which`` is true."""
    part = 0.5**power[which]
    first, length, power = (
        np.concatenate([first[~which], first[which], first[which] + part * length[which]]),
        np.concatenate([length[~which], part * length[which], (1.0 - part) * length[which]]),
        np.concatenate([power[~which], power[which], np.ones(part.size)]))
    order = np.argsort(first * np.sign(length[0]), kind='stable')
    return first[order], length[order], power[order]


def pass_over(panels: Panels, begin: Begin, spacing: float) -> Passage:
    """
    Return how a crank passes panels, from the sums before, (F3) and (F4).

    Energy is integrated first, then time. Polynomials of half the degree do the same and give the
    errors: of each panel alone, and of all panels since the start. ``spacing``: rounding of an
    input.
    """
    power = panels.power[:, None]
    growth = power * panels.length[:, None] * FINE.points**(power - 1.0)        # dq/dx
    pushes = panels.force * growth
    with np.errstate(all='ignore'):
        kinetic = _along(pushes, begin.kinetic)
        slowness = _slowness(panels, growth, kinetic, 1)
        time = _along(slowness, begin.time)
        own, gone = kinetic - kinetic[:, :1], time[:, -1] - time[:, 0]
        rates = np.sqrt(2.0 * kinetic[:, -1] / panels.inertia[:, -1])
        gains = pushes[:, ::2] @ ROUGH.integral.T
        missed = np.max(np.abs(gains - own[:, ::2]), axis=1)
        turns_back = (np.any(kinetic[:, 1:] <= 0.0, axis=1)
                      & (missed <= SEEN * np.max(np.abs(own), axis=1)))
        alone = _slowness(panels, growth, kinetic[:, :1] + gains, 2) @ ROUGH.weights
        fastest = np.max(np.nan_to_num(rates, posinf=0.0))
        errors = fastest * np.maximum(np.abs(alone - gone), gone * missed / kinetic[:, -1])
        ends = begin.rough_kinetic + np.cumsum(gains[:, -1])
        starts = np.append(begin.rough_kinetic, ends[:-1])[:, None]
        rough = _slowness(panels, growth, starts + gains, 2) @ ROUGH.weights
        doubt = begin.doubt + np.cumsum(np.abs(rough - gone)
                                        + gone * spacing / np.abs(panels.length))
        error = float(np.max(doubt * rates))
    work = _along(panels.supplied * growth, begin.work)
    end = Begin(*[float(row.flat[-1]) for row in (kinetic, time, work, ends, doubt)])
    return Passage(kinetic, time, work, slowness, end, error if error >= 0.0 else np.inf, errors,
                   turns_back)


def _along(values: Array, begin: float) -> Array:
    """Return the integral over x up to every point, going on from panel to panel."""
    with np.errstate(over='ignore'):      # then nothing is known of the motion
        own = values @ FINE.integral.T
        ends = begin + np.cumsum(own[:, -1])
        along: Array = np.append(begin, ends[:-1])[:, None] + own
    return along


def _slowness(panels: Panels, growth: Array, kinetic: Array, every: int) -> Array:
    """Return dt/dx of (F3) and (F4) at each point; ``every`` = 2: at every second one."""
    inertia = panels.inertia[:, ::every]
    slowness: Array = np.abs(growth[:, ::every]) * np.sqrt(inertia / (2.0 * kinetic))
    if panels.power[0] > 1.0:      # from rest K = |F L| x^2 at first
        slowness[0, 0] = np.sqrt(2.0 * inertia[0, 0] * abs(panels.length[0] / panels.force[0, 0]))
    return slowness


def states_at(panels: Panels, passage: Passage, times: Array) -> Array:
    """
    Return input, rate and work at n times on these panels, shape (3, n).

    The place x of a time on its panel is found by Newton's method on the polynomial of the time.
    """
    on = np.searchsorted(passage.time[:, -1], times)
    along = passage.time[on]
    after = np.clip(np.sum(along <= times[:, None], axis=1), 1, DEGREE)
    rows = np.arange(times.size)
    low, high = along[rows, after - 1], along[rows, after]
    x = FINE.points[after - 1] + (FINE.points[after] - FINE.points[after - 1]) * (
        (times - low) / (high - low))
    in_time, in_slowness, in_kinetic, in_inertia, in_work = (
        values[on] @ FINE.coefficients.T for values in (
            passage.time, passage.slowness, passage.kinetic, panels.inertia, passage.work))
    for _ in range(NEWTON):
        basis = at(x, DEGREE)
        step = (np.sum(basis * in_time, axis=1) - times) / np.sum(basis * in_slowness, axis=1)
        x = np.clip(x - step, 0.0, 1.0)
        if np.max(np.abs(step), initial=0.0) <= 1e-15:
            break
    basis = at(x, DEGREE)
    kinetic, inertia, work = (np.sum(basis * row, axis=1)
                              for row in (in_kinetic, in_inertia, in_work))
    rate = np.sign(panels.length[on]) * np.sqrt(2.0 * np.maximum(kinetic, 0.0) / inertia)
    return np.array([panels.first[on] + panels.length[on] * x**panels.power[on], rate, work])
