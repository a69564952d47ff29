# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Sources of motion on a page: the input over a cycle, recorded runs, or a running node.

A playback drives the slider of the page: ``label``, ``bounds`` and ``at`` are what it shows, in
degrees, metres or seconds; ``go`` and ``advance`` move it. ``state`` is that of the input, in SI
units.
"""
from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import isfinite, radians
from time import monotonic
from typing import NamedTuple

from fourbar_lab.live import charts
from fourbar_lab.live.model import Shown
from fourbar_ros.extrema.find import Extremum
from fourbar_ros.numerics.arrays import Array
import numpy as np

SILENCE = 2.0               # [s] after which a node's pose is said to be old
FASTEST = 1e6               # [rad/s, m/s] what is faster sets no scale of arrows and curves
MOST_POINTS = 1500          # of a curve over a long run


class State(NamedTuple):
    """State of the input: position [rad] or [m], rate and acceleration of it by seconds."""

    position: float
    rate: float
    acceleration: float


@dataclass
class Pace:
    """How fast a playback goes: a slider, and its value."""

    label: str
    least: float
    most: float
    value: float


class Playback(ABC):
    """What moves the input of a mechanism."""

    shown: Shown
    can_drag = True
    has_extrema = True          # its curves are over the input, with the extrema marked
    pace: Pace | None = None    # what its user may set; None: nothing
    # largest rate of the input if it is not the scene's: arrows and curves are scaled for it
    speed: float | None = None
    is_difference = False       # curves are differences from the run beside it
    beside: tuple[str, ...] = ()        # titles of other runs to compare with

    @property
    @abstractmethod
    def label(self) -> str:
        """Return the name of the slider's quantity, with unit."""

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

    def follow(self, shown: Shown) -> None:
        """Go on with another mechanism, as when a parameter has changed."""
        self.shown = shown

    def others(self) -> list[tuple[Shown, State | None]]:
        """Return the mechanism and the state of each run to compare with; None after its end."""
        return []

    def warning(self) -> str:
        """Return a warning for the user about the state, or ''."""
        return ''

    @abstractmethod
    def curves(self, names: Sequence[str], extrema: Sequence[Extremum],
               is_dark: bool) -> charts.Options:
        """Return the options of the chart of these quantities."""


class CyclePlayback(Playback):
    """The input goes round, or back and forth between its limits, at the pace of the page."""

    def __init__(self, shown: Shown, position: float):
        self.shown, self.direction = shown, 1.0
        self.pace = Pace('seconds a cycle', 1.0, 30.0, 6.0)
        self.position = shown.nearest_input(position)

    @property
    def label(self) -> str:
        return f'{self.shown.linkage.input_coordinate.position} [{self.shown.input_unit}]'

    @property
    def bounds(self) -> tuple[float, float]:
        return (self.shown.shown_input(self.shown.ranges[0][0]),
                self.shown.shown_input(self.shown.ranges[-1][1]))

    @property
    def at(self) -> float:
        return self.shown.shown_input(self.position)

    def go(self, at: float) -> None:
        """Go to the nearest input that is possible."""
        self.position = self.shown.nearest_input(
            at if self.shown.linkage.is_driven_by_slide else radians(at))

    def advance(self, seconds: float) -> None:
        """Move on by a time: round, in the sense of the rate, or back and forth between limits."""
        assert self.pace is not None            # a node has none, and moves by itself
        low, high = self.shown.range_of(self.position)
        way = seconds / self.pace.value * (high - low)      # of a cycle: a turn, or there and back
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
        return State(self.position, self.shown.rate, self.shown.acceleration)

    def follow(self, shown: Shown) -> None:
        """Go on with another mechanism, at the nearest input that is possible."""
        self.shown, self.position = shown, shown.nearest_input(self.position)

    def curves(self, names: Sequence[str], extrema: Sequence[Extremum],
               is_dark: bool) -> charts.Options:
        """Return the options of the chart over the input, extrema marked."""
        return charts.over_input(self.shown, names, extrema, is_dark)


class Run(NamedTuple):
    """The recorded motion of an input."""

    times: Array        # (n,), since the first sample [s], growing
    states: Array       # (3, n): position, rate and acceleration of the input


class RunPlayback(Playback):
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
        return 'time [s]'

    @property
    def bounds(self) -> tuple[float, float]:
        return 0.0, float(self.run.times[-1])

    @property
    def at(self) -> float:
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

    def others(self) -> list[tuple[Shown, State | None]]:
        """Return the mechanism and the state of each run beside; None after its end."""
        return [(shown, state_at(run, self.time) if self.time <= run.times[-1] else None)
                for _, shown, run in self.runs_beside]

    def curves(self, names: Sequence[str], extrema: Sequence[Extremum],
               is_dark: bool) -> charts.Options:
        """Return the options of the chart over time, of all runs or of their difference."""
        if self.is_difference:
            runs = [('', *_differences(self.shown, self.run, *self.runs_beside[0][1:], names))]
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
    """Return times [s] and {quantity: values} of a run, at :data:`MOST_POINTS` samples at most."""
    picked = np.linspace(0, len(run.times) - 1, min(len(run.times), MOST_POINTS)).astype(int)
    return run.times[picked], _values(shown, run, names, picked)


def _differences(shown: Shown, run: Run, other_shown: Shown, other: Run,
                 names: Sequence[str]) -> tuple[Array, dict[str, Array]]:
    """
    Return times [s] of a run, and by how much the quantities of another run are larger at them.

    Up to the end of the shorter one; between its samples the other run holds the last.
    """
    times, values = _thinned(shown, run, names)
    is_in_both = times <= other.times[-1]
    last = np.maximum(np.searchsorted(other.times, times[is_in_both], 'right') - 1, 0)
    return times[is_in_both], {
        name: of_other - values[name][is_in_both]
        for name, of_other in _values(other_shown, other, names, last).items() if name in values}


def _values(shown: Shown, run: Run, names: Sequence[str],
            picked: Array) -> dict[str, Array]:
    """Return {quantity: values} at samples ``picked`` of a run, of those that its scene has."""
    motion, loads = shown.motion_and_loads(*[row[picked] for row in run.states])
    return {name: np.broadcast_to(shown.quantities[name].of(motion, loads), picked.shape)
            for name in names if name in shown.quantities}


class NodePlayback(CyclePlayback):
    """The input of a running node, as its topic has it."""

    can_drag = False

    def __init__(self, shown: Shown, latest: Callable[[], tuple[float, float, float] | None]):
        """Stand at the scene's start; ``latest`` returns the newest state heard, or None."""
        super().__init__(shown, shown.scene.drive.start)
        self.pace = None
        self.latest = latest
        self._last: tuple[float, float, float] | None = None
        self._heard = monotonic()            # when the last motion came [s]
        self._state = super().state()        # until the first motion comes

    def go(self, at: float) -> None:
        """Do nothing: the node decides."""

    def advance(self, seconds: float) -> None:
        """Take the latest motion of the node; its largest rate so far scales the pictures."""
        motion = self.latest()
        if motion is not None and motion is not self._last:
            self._last, self._heard = motion, monotonic()
            self._state = State(*motion)
            if abs(self._state.rate) <= FASTEST:
                self.speed = max(self.speed or 0.0, self._state.rate, key=abs)
            if isfinite(self._state.position):
                self.position = self.shown.nearest_input(self._state.position)

    def state(self) -> State:
        """Return the latest :class:`State` of the input."""
        return self._state

    def warning(self) -> str:
        """Return since when the node is silent: the page then shows its last pose."""
        silent = monotonic() - self._heard
        if silent < SILENCE:
            return ''
        return (f'no motion of the node for {silent:.0f} s: this is its last pose'
                if self._last else 'no motion of the node yet: this is where it would start')
