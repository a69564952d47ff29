# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Recorded runs as what moves the mechanism of a page, one of them or several to compare."""
from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

from fourbar_ros.extrema.find import Extremum
from fourbar_ros.live import charts
from fourbar_ros.live.course import Course, Pace, State
from fourbar_ros.live.model import Shown
from fourbar_ros.numerics.arrays import Array
import numpy as np

MOST_POINTS = 1500          # of a curve over a long run


class Run(NamedTuple):
    """
    The recorded motion of an input.

    Parameters
    ----------
    times : array of shape (n,)
        Since the first sample [s], growing.
    states : array of shape (3, n)
        Position, rate and acceleration of the input.

    """

    times: Array
    states: Array


class OverTime(Course):
    """A recorded run, at its own pace or to scrub along; a second one beside it to compare."""

    pace: Pace
    can_drag = has_extrema = False

    def __init__(self, shown: Shown, run: Run, others: Sequence[tuple[str, Shown, Run]] = ()):
        self.shown, self.run, self.time, self.is_difference = shown, run, 0.0, False
        self.runs_beside, self.beside = others, tuple(title for title, *_ in others)
        self.pace = Pace('times real time', 0.1, 10.0, 1.0)
        rates = run.states[1][np.isfinite(run.states[1])]
        self.speed = float(rates[np.argmax(np.abs(rates))]) if len(rates) else None

    @property
    def label(self) -> str:
        """Return what its slider shows, with unit."""
        return 'time [s]'

    @property
    def bounds(self) -> tuple[float, float]:
        """Return the ends of its slider."""
        return 0.0, float(self.run.times[-1])

    @property
    def at(self) -> float:
        """Return where its slider stands."""
        return self.time

    def go(self, at: float) -> None:
        """Go to a time [s]."""
        self.time = min(max(at, 0.0), self.bounds[1])

    def advance(self, seconds: float) -> None:
        """Move on by a time, at the end to the start again."""
        length = self.bounds[1]
        self.time = (self.time + self.pace.value * seconds) % length if length > 0.0 else 0.0

    def state(self) -> State:
        """Return the :class:`State` at the sample that holds now."""
        return state_at(self.run, self.time)

    def follow(self, shown: Shown) -> None:
        """Go on with another mechanism, moved by the same run."""
        self.shown = shown

    def others(self) -> list[tuple[Shown, State | None]]:
        """Return the mechanism and the state of each run beside; None after its end."""
        return [(shown, state_at(run, self.time) if self.time <= run.times[-1] else None)
                for _, shown, run in self.runs_beside]

    def curves(self, names: Sequence[str], extrema: Sequence[Extremum],
               is_dark: bool) -> dict[str, Any]:
        """Return the options of the chart over time, of all runs or of their difference."""
        if self.is_difference:
            runs = [('', *_differences((self.shown, self.run), self.runs_beside[0][1:], names))]
        else:
            runs = [(title, *_thinned(shown, run, names))
                    for title, shown, run in [('', self.shown, self.run), *self.runs_beside]]
        return charts.over_time(self.shown, runs, names, self.bounds[1], is_dark)


def state_at(run: Run, time: float) -> State:
    """Return the :class:`State` of the last sample up to a time [s]."""
    i = max(int(np.searchsorted(run.times, time, 'right')) - 1, 0)
    return State(*map(float, run.states[:, i]))


def _thinned(shown: Shown, run: Run,
             names: Sequence[str]) -> tuple[Array, dict[str, Array]]:
    """Return times and values of quantities over a run, of a long one some of its samples."""
    picked = np.linspace(0, len(run.times) - 1, min(len(run.times), MOST_POINTS)).astype(int)
    return run.times[picked], _values(shown, run, names, picked)


def _differences(one: tuple[Shown, Run], other: tuple[Shown, Run],
                 names: Sequence[str]) -> tuple[Array, dict[str, Array]]:
    """Return times of one run, and by how much the other's quantities are larger at them."""
    (shown, run), (its, second) = one, other
    times, values = _thinned(shown, run, names)
    both = times <= second.times[-1]
    held = np.maximum(np.searchsorted(second.times, times[both], 'right') - 1, 0)
    return times[both], {name: found - values[name][both]
                         for name, found in _values(its, second, names, held).items()
                         if name in values}


def _values(shown: Shown, run: Run, names: Sequence[str],
            picked: Array) -> dict[str, Array]:
    """Return the quantities that a mechanism has, at samples of a run."""
    motion, loads = shown.linkage.motion_and_loads(*[row[picked] for row in run.states])
    return {name: np.broadcast_to(shown.quantities[name].of(motion, loads), picked.shape)
            for name in names if name in shown.quantities}
