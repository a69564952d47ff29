# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
How a crank passes panels of its input under forces that depend on the input alone.

On a panel, x from 0 to 1, the input is

    q = q0 + L x,    from rest  q = q0 + L x^2                                             (F4)

as from rest the time has a root in its denominator, in q but not in x. Integrals are those of the
polynomials through values at Chebyshev's points; every second point gives the polynomials of half
the degree, and with them the error of these.
"""
from __future__ import annotations

from typing import NamedTuple

from fourbar_ros.numerics.arrays import Array
from fourbar_ros.numerics.panels import at, panel
import numpy as np
from numpy.typing import NDArray

DEGREE = 32
FINE, ROUGH = panel(DEGREE), panel(DEGREE // 2)
SEEN = 0.01            # error of the rough work over the work, below which its sign is believed
NEWTON = 20


class Panels(NamedTuple):
    """Panels one after the other, and what acts there."""

    first: Array         # q0, (n,)
    length: Array        # L, (n,); negative for a crank that turns backwards
    power: Array         # of x, (n,): 2 from rest, else 1
    inertia: Array       # J at the points, (n, DEGREE + 1)
    force: Array         # Q + T
    supplied: Array      # the part of it that has no potential: T and couples

    @staticmethod
    def places(first: Array, length: Array, power: Array) -> Array:
        """Return the inputs at the points."""
        places: Array = first[:, None] + length[:, None] * FINE.points**power[:, None]
        return places

    @property
    def growth(self) -> Array:
        """Return dq/dx at the points."""
        power = self.power[:, None]
        growth: Array = power * self.length[:, None] * FINE.points**(power - 1.0)
        return growth

    def pick(self, places: NDArray[np.generic]) -> Panels:
        """Return some of them."""
        return Panels(*[row[places] for row in self])

    def joined(self, others: Panels) -> Panels:
        """Return these and others in the order of the motion."""
        rows = [np.concatenate(pair) for pair in zip(self, others)]
        order = np.argsort(rows[0] * np.sign(rows[1][0]), kind='stable')
        return Panels(*[row[order] for row in rows])


class Begin(NamedTuple):
    """What has added up before panels."""

    kinetic: float
    time: float = 0.0
    work: float = 0.0              # of what has no potential
    rough_kinetic: float = 0.0     # by polynomials of half the degree alone
    doubt: float = 0.0             # errors of the time by these and by rounding of inputs [s]


class Passage(NamedTuple):
    """What adds up over panels, at their points, (n, DEGREE + 1), and how well it is known."""

    kinetic: Array
    time: Array
    work: Array
    slowness: Array      # dt/dx
    end: Begin
    error: float         # largest one of the position, by the doubt [rad]
    errors: Array        # of the rough polynomials of each panel by itself [rad], (n,)
    turns_back: NDArray[np.bool_]      # whether the kinetic energy falls below zero, (n,)


def halves(first: Array, length: Array, power: Array,
           which: NDArray[np.bool_]) -> tuple[Array, Array, Array]:
    """Return panels of which some are halved in x, in the order of the motion."""
    part = 0.5**power[which]
    first, length, power = (
        np.concatenate([first[~which], first[which], first[which] + part * length[which]]),
        np.concatenate([length[~which], part * length[which], (1.0 - part) * length[which]]),
        np.concatenate([power[~which], power[which], np.ones(part.size)]))
    order = np.argsort(first * np.sign(length[0]), kind='stable')
    return first[order], length[order], power[order]


def pass_over(panels: Panels, begin: Begin, spacing: float) -> Passage:
    """Return how a crank passes panels, whose inputs are rounded to a spacing."""
    growth = panels.growth
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
    """Return the integral of values up to every point, over all panels."""
    own = values @ FINE.integral.T
    ends = begin + np.cumsum(own[:, -1])
    along: Array = np.append(begin, ends[:-1])[:, None] + own
    return along


def _slowness(panels: Panels, growth: Array, kinetic: Array, every: int) -> Array:
    """Return dt/dx of (F3) and (F4) at every point, or every second one."""
    inertia = panels.inertia[:, ::every]
    slowness: Array = np.abs(growth[:, ::every]) * np.sqrt(inertia / (2.0 * kinetic))
    if panels.power[0] > 1.0:      # from rest K = |F L| x^2 at first
        slowness[0, 0] = np.sqrt(2.0 * inertia[0, 0] * abs(panels.length[0] / panels.force[0, 0]))
    return slowness


def states_at(panels: Panels, passage: Passage, times: Array) -> Array:
    """Return input, rate and work at times on these panels, (3, times)."""
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
        here = at(x, DEGREE)
        step = (np.sum(here * in_time, axis=1) - times) / np.sum(here * in_slowness, axis=1)
        x = np.clip(x - step, 0.0, 1.0)
        if np.max(np.abs(step), initial=0.0) <= 1e-15:
            break
    here = at(x, DEGREE)
    kinetic, inertia, work = (np.sum(here * row, axis=1)
                              for row in (in_kinetic, in_inertia, in_work))
    rate = np.sign(panels.length[on]) * np.sqrt(2.0 * np.maximum(kinetic, 0.0) / inertia)
    return np.array([panels.first[on] + panels.length[on] * x**panels.power[on], rate, work])
