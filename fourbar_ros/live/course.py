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
from math import isfinite, radians
from time import monotonic
from typing import Any, NamedTuple

from fourbar_ros.extrema.find import Extremum
from fourbar_ros.live import charts
from fourbar_ros.live.dragging import nearest_input, range_of
from fourbar_ros.live.model import Shown
import numpy as np

SILENCE = 2.0               # [s] after which a node's pose is said to be old


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
    has_extrema = True          # its curves are over the input, with the extrema marked
    pace: Pace | None = None    # what its user may set; None: nothing
    speed: float | None = None  # of the input, where it is not the scene's: pictures have its size
    is_difference = False       # of runs beside it, their difference is drawn
    beside: tuple[str, ...] = ()        # titles of other runs to compare with

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

    def others(self) -> list[tuple[Shown, State | None]]:
        """Return the mechanism and the state of each run beside; None after its end."""
        return []

    def warning(self) -> str:
        """Return what its user should know of the state, or ''."""
        return ''

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
        assert self.pace is not None            # a node has none, and moves by itself
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


class OfNode(OverInput):
    """The input of a running node, as its topic has it."""

    can_drag = False

    def __init__(self, shown: Shown, latest: Callable[[], tuple[float, float, float] | None]):
        super().__init__(shown, shown.scene.drive.start)
        self.pace = None
        self.latest = latest
        self._last: tuple[float, float, float] | None = None
        self._heard = monotonic()
        self._state = super().state()        # until the first motion comes

    def go(self, at: float) -> None:
        """Do nothing: the node decides."""

    def advance(self, seconds: float) -> None:
        """Take the latest motion."""
        found = self.latest()
        if found is not None and found is not self._last:
            self._last, self._heard = found, monotonic()
            self._state = State(*found)
            if isfinite(self._state.rate):
                self.speed = max(self.speed or 0.0, self._state.rate, key=abs)
            self.position = nearest_input(self.shown, self._state.position)

    def state(self) -> State:
        """Return the latest :class:`State` of the input."""
        return self._state

    def warning(self) -> str:
        """Return since when the node is silent: what is shown is then its last pose."""
        silent = monotonic() - self._heard
        if silent < SILENCE:
            return ''
        return (f'no motion of the node for {silent:.0f} s: this is its last pose'
                if self._last else 'no motion of the node yet: this is where it would start')

    def follow(self, shown: Shown) -> None:
        """Go on with another mechanism."""
        self.shown = shown
