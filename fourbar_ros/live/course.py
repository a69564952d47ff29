# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
What moves the mechanism of a page: its input over a cycle, a recorded run, or a running node.

Each course has the same face: ``bounds`` and ``at`` in the unit of the page, ``go``,
``advance``, and ``state``, the position, rate and acceleration of the input.
"""
from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import radians
from typing import Any, NamedTuple

from fourbar_ros.extrema.find import Extremum
from fourbar_ros.live import charts
from fourbar_ros.live.dragging import nearest_input, range_of
from fourbar_ros.live.model import Shown
import numpy as np

MOST_POINTS = 1500          # of a curve over a long run


class State(NamedTuple):
    """Position, rate and acceleration of the input: [rad] or [m], and so on."""

    position: float
    rate: float
    acceleration: float


@dataclass
class Pace:
    """How fast a course goes: what the number means, its bounds, and the number."""

    label: str
    least: float
    most: float
    value: float


class Course(ABC):
    """What moves the input."""

    can_drag = True
    pace: Pace | None = None    # what its user may set; None: nothing

    @property
    @abstractmethod
    def label(self) -> str:
        """Return what its slider shows, with unit."""

    @property
    @abstractmethod
    def bounds(self) -> tuple[float, float]:
        """Return the ends of its slider."""

    @property
    @abstractmethod
    def at(self) -> float:
        """Return where its slider stands."""

    @abstractmethod
    def go(self, at: float) -> None:
        """Go to a place on the slider."""

    @abstractmethod
    def advance(self, seconds: float) -> None:
        """Move on by a time."""

    @abstractmethod
    def state(self) -> State:
        """Return the :class:`State` of the input."""

    @abstractmethod
    def follow(self, shown: Shown) -> None:
        """Go on with another mechanism."""

    @abstractmethod
    def curves(self, names: Sequence[str], extrema: Sequence[Extremum],
               is_dark: bool) -> dict[str, Any]:
        """Return the options of the chart of these quantities."""


class OverInput(Course):
    """The input goes round, or back and forth between its limits, at the pace of the page."""

    def __init__(self, shown: Shown, position: float):
        self.shown, self.direction = shown, 1.0
        self.pace = Pace('seconds a cycle', 1.0, 30.0, 6.0)
        self.position = nearest_input(shown, position)

    @property
    def label(self) -> str:
        """Return what its slider shows, with unit."""
        return f'{self.shown.linkage.input_coordinate.position} [{self.shown.input_unit}]'

    @property
    def bounds(self) -> tuple[float, float]:
        """Return the ends of its slider."""
        return (self.shown.shown_input(self.shown.ranges[0][0]),
                self.shown.shown_input(self.shown.ranges[-1][1]))

    @property
    def at(self) -> float:
        """Return where its slider stands."""
        return self.shown.shown_input(self.position)

    def go(self, at: float) -> None:
        """Go to the nearest input that is possible."""
        self.position = nearest_input(
            self.shown, at if self.shown.linkage.is_driven_by_slide else radians(at))

    def advance(self, seconds: float) -> None:
        """Move on by a time."""
        low, high = range_of(self.shown, self.position)
        way = seconds / self.pace.value * (high - low)
        if self.shown.linkage.turns_fully:
            forward = float(np.copysign(way, self.shown.rate or 1.0))
            self.position = low + (self.position + forward - low) % (high - low)
            return
        self.position += 2.0 * way * self.direction
        if not low <= self.position <= high:
            self.direction = -self.direction
            end = low if self.position < low else high
            self.position = min(max(2.0 * end - self.position, low), high)

    def state(self) -> State:
        """Return the :class:`State` of the input."""
        return State(self.position, self.shown.rate, self.shown.acceleration)

    def follow(self, shown: Shown) -> None:
        """Go on with another mechanism."""
        self.shown, self.position = shown, nearest_input(shown, self.position)

    def curves(self, names: Sequence[str], extrema: Sequence[Extremum],
               is_dark: bool) -> dict[str, Any]:
        """Return the options of the chart over the input, extrema marked."""
        return charts.over_input(self.shown, names, extrema, is_dark)


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

    times: np.ndarray
    states: np.ndarray


class OverTime(Course):
    """A recorded run, at its own pace or to scrub along; a second one beside it to compare."""

    can_drag = False

    def __init__(self, shown: Shown, run: Run, others: Sequence[tuple[str, Shown, Run]] = ()):
        self.shown, self.run, self.others, self.time = shown, run, others, 0.0
        self.pace = Pace('times real time', 0.1, 10.0, 1.0)

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

    def curves(self, names: Sequence[str], extrema: Sequence[Extremum],
               is_dark: bool) -> dict[str, Any]:
        """Return the options of the chart over time, of all runs."""
        runs = [('', self.shown, self.run), *self.others]
        lines = [[(title, *_thinned(shown, run, name)) for title, shown, run in runs
                  if name in shown.quantities] for name in names]
        return charts.over_time(self.shown, names, lines, self.bounds[1], is_dark)


def state_at(run: Run, time: float) -> State:
    """Return the :class:`State` of the last sample up to a time [s]."""
    i = max(int(np.searchsorted(run.times, time, 'right')) - 1, 0)
    return State(*map(float, run.states[:, i]))


def _thinned(shown: Shown, run: Run, name: str) -> tuple[np.ndarray, np.ndarray]:
    """Return times and values of a quantity over a run, of a long one some of its samples."""
    picked = np.linspace(0, len(run.times) - 1, min(len(run.times), MOST_POINTS)).astype(int)
    quantity, given = shown.quantities[name], [row[picked] for row in run.states]
    motion, loads = shown.linkage.motion_and_loads(*given)
    return run.times[picked], np.broadcast_to(quantity.of(motion, loads), picked.shape)


class OfNode(OverInput):
    """The input of a running node, as its topic has it."""

    can_drag = False

    def __init__(self, shown: Shown, latest: Callable[[], tuple[float, float, float] | None]):
        super().__init__(shown, shown.scene.drive.start)
        self.pace = None
        self.latest = latest
        self._state = super().state()        # until the first motion comes

    def go(self, at: float) -> None:
        """Do nothing: the node decides."""

    def advance(self, seconds: float) -> None:
        """Take the latest motion."""
        found = self.latest()
        if found is not None:
            self._state = State(*found)
            self.position = nearest_input(self.shown, self._state.position)

    def state(self) -> State:
        """Return the latest :class:`State` of the input."""
        return self._state

    def follow(self, shown: Shown) -> None:
        """Go on with another mechanism."""
        self.shown = shown
