# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Motion of a crank by its energy, without steps in time.

Where every force depends on the input alone (weight, loads, springs, a constant torque T of the
drive), the kinetic energy K is an integral over the input, and so is the time:

    K = K0 + integral of (Q + T) dq,    t = integral of sqrt(J / (2 K)) dq                 (F3)

Both converge geometrically on panels (:mod:`fourbar_ros.dynamics.passage`). J and Q repeat with
every turn: later turns cost no evaluations of them. The potential is not used, so that the
constancy of energy remains a check.
"""
from __future__ import annotations

from collections.abc import Iterator
from math import inf, pi

from fourbar_ros.dynamics.integrators import Part
from fourbar_ros.dynamics.passage import Begin, halves, Panels, pass_over, Passage, states_at
from fourbar_ros.dynamics.phase import COMPLETE
from fourbar_ros.dynamics.smooth import flat_positions
from fourbar_ros.dynamics.system import System
from fourbar_ros.numerics.arrays import Array
import numpy as np

TURN = 2.0 * pi
PANELS = 8             # of a turn, at first
NARROW = 2.0           # longest panel over its distance to a complex singularity, at first
LOCAL = 0.03           # error of a panel over that of the motion
MOST_LEVELS, MOST_PANELS, MOST_CYCLES = 60, 4000, 100_000


def can_follow(system: System) -> bool:
    """Return whether forces depend on the input alone, and nothing stops the crank."""
    phase = system.course.first
    return (system.depends_on_input_alone and system.has_no_limits and phase.is_input
            and not phase.can_end and not system.events(phase))


def follow(system: System, until: float, tolerance: float,
           wanted: Array | None) -> tuple[Part, float] | None:
    """
    Return the motion up to a time, and the error of its position by half the degree [rad].

    None for a crank that rests or turns back, and where that error stays above the tolerance.

    Parameters
    ----------
    system : System
        One that it :func:`can follow <can_follow>`.
    until, tolerance : float
        [s], [rad]
    wanted : ndarray, optional
        Times of the result; not given: the ends of the panels.

    """
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
                COMPLETE, motion.evaluations), error


class _Motion:
    """The motion of a system up to a time [s], turn by turn, to a tolerance [rad]."""

    def __init__(self, system: System, until: float, tolerance: float) -> None:
        self._equation, self._until, self._tolerance = system.equation, until, tolerance
        self._torque = system.torque(0.0, system.start)
        self._start, self._rate = system.start[:2]
        mechanism = self._equation.mechanism
        self._cycle = TURN * (1 + len(flat_positions(mechanism)) % 2)
        self._peaks = [z for z in mechanism.singular_inputs if z.imag]
        self._spacing = float(np.spacing(abs(self._start) + self._cycle))
        self.evaluations = 0

    def cycles(self) -> Iterator[tuple[Panels, Passage]]:
        """Yield one turn after the other, up to the last time or as far as it is known."""
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
        """Return panels over the first turn, narrow next to complex singularities."""
        count = PANELS * round(self._cycle / TURN)
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
        """Return how far each panel is from the next singularity off the real inputs."""
        nearest = np.full(first.size, inf)
        for z in self._peaks:
            away = np.remainder(z.real - first - 0.5 * length + pi, TURN) - pi
            beside = np.maximum(np.abs(away) - 0.5 * np.abs(length), 0.0)
            nearest = np.minimum(nearest, np.hypot(beside, z.imag))
        return nearest

    def _panels(self, first: Array, length: Array, power: Array) -> Panels:
        """Return panels with what acts there."""
        places = Panels.places(first, length, power)
        self.evaluations += places.size
        terms = self._equation.terms(places)
        couples = self._equation.couples(places) if self._equation.has_couples else 0.0
        return Panels(first, length, power, terms.inertia, terms.force + self._torque,
                      self._torque + couples + np.zeros(places.shape))

    def _next_cycle(self, panels: Panels) -> Panels:
        """Return the same panels a turn on, where J and Q are known but on one from rest."""
        moved = panels._replace(first=panels.first + np.sign(panels.length) * self._cycle)
        if moved.power[0] == 1.0:
            return moved
        return self._panels(moved.first[:1], moved.length[:1], np.ones(1)).joined(
            moved.pick(np.arange(1, moved.first.size)))

    def _resolved(self, panels: Panels, begin: Begin) -> tuple[Panels, Passage] | None:
        """Return panels narrow enough up to the last time, and how the crank passes them."""
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
