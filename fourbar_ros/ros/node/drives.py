# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Drive the input at constant speed: a thread on a time grid, or a timer of simulated time."""
from __future__ import annotations

from abc import ABC, abstractmethod
from contextlib import suppress
from math import ceil, nan
from pathlib import Path
import threading
import time
from typing import Any

from fourbar_ros.ros.messages import sec_nanosec, Stamp
from fourbar_ros.ros.node.base import Base
from fourbar_ros.ros.node.recording import Recording
from fourbar_ros.ros.node.stream import Stream
from fourbar_ros.scene.scene import DriveSettings, Scene

SLEEP = 0.1            # [s] longest sleep: how soon a thread sees that it must stop
CATCH_UP = 1.0         # [s] a thread later than this skips the samples it missed
CLOCK_STEP = 0.05      # [s] the wall clock was set if it is this far from the monotonic one
CHECK_CLOCK = 1.0      # [s] how often that is looked at


def wake_on_time() -> None:
    """Ask Linux to end sleeps of this thread when due; by default it delays them up to 50 us."""
    with suppress(OSError):                              # on another system
        Path(f'/proc/{threading.get_native_id()}/timerslack_ns').write_text('1')


Reported = tuple[dict[str, Any], list[str]]     # for the diagnostics: {name: value}, problems


class Drive(ABC):
    """A drive moves the input of the linkage: it calls the stream with one pose after another."""

    COUNTED: tuple[str, ...] = ()

    def __init__(self, node: Base, stream: Stream, recording: Recording) -> None:
        self._node, self._stream, self._recording = node, stream, recording
        self.settings = stream.scene.drive
        self.counts = dict.fromkeys(self.COUNTED, 0)

    @abstractmethod
    def start(self) -> None:
        """Begin to make steps."""

    @abstractmethod
    def stop(self) -> None:
        """Make no more steps, when the one in hand is done."""

    def prepare(self, scene: Scene) -> None:        # noqa: B027 # most have nothing to prepare
        """Do what takes long for a scene that is about to hold, while steps go on."""

    def apply(self, settings: DriveSettings) -> None:
        """Take over changed DriveSettings of the scene."""
        self.settings = settings

    def age(self) -> float:
        """Return the time since the newest input [s]; NaN if the drive has no input."""
        return nan

    def state(self) -> Reported:
        """Return (values, problems) for the diagnostics, beside the counters."""
        return {}, []


class TimerDrive(Drive):
    """
    Constant speed on the wall clock.

    Sample k belongs to the time start + k / rate, however late the scheduler is, and its angle
    follows from that time, without accumulating errors. So no samples need be made while nobody
    listens. It is a thread, not a ROS timer: rclpy's timers drop missed ticks and leave their
    grid.
    """

    COUNTED: tuple[str, ...] = ('late', 'missed', 'clock_steps')
    _may_sleep = True      # while nobody listens: a sample does not depend on those before it

    def start(self) -> None:
        """Start the thread."""
        self._stopping = self._is_asleep = False
        self._thread = threading.Thread(target=self._guarded, name='drive', daemon=True)
        self._thread.start()

    def stop(self) -> None:
        """Stop it and wait for the current sample."""
        self._stopping = True
        self._thread.join()

    def state(self) -> Reported:
        """Return (values, problems): whether it sleeps."""
        return ({'asleep': 'nobody listens'} if self._is_asleep else {}), []

    def _guarded(self) -> None:
        """Run the thread; a fault ends the whole node, never silently the stream alone."""
        try:
            wake_on_time()
            self._run()
        except Exception as error:
            self._node.failure = error

    def _run(self) -> None:
        """
        Make samples on the grid began + sample / rate [s, monotonic] until it is stopped.

        ``offset`` [ns] leads from monotonic time to stamps. New settings begin a new grid at the
        sample or sleep in which they are seen.
        """
        settings, began = self.settings, time.monotonic()
        self._begin(settings)
        offset, checked = self._offset(), began
        sample, period = 0, 1.0 / settings.rate
        while not self._stopping:
            elapsed = sample * period
            wait = began + elapsed - time.monotonic()
            self._is_asleep = self._may_sleep and not self._stream.is_heard
            if self._is_asleep or wait > SLEEP:
                time.sleep(SLEEP)
                elapsed = time.monotonic() - began
                if self.settings is not settings:
                    self._go_on(settings, elapsed)
                    settings, began, sample = self.settings, began + elapsed, 1
                    period = 1.0 / settings.rate
                elif self._is_asleep:
                    sample = max(sample, ceil(elapsed / period))
                continue
            if wait > 0.0:
                time.sleep(wait)
            elif wait < -CATCH_UP:           # suspended, or a rate this machine cannot do
                skipped = int(-wait / period)
                self.counts['missed'] += skipped
                sample += skipped
                continue
            elif -wait > period:
                self.counts['late'] += 1
            moment = began + elapsed
            if moment - checked > CHECK_CLOCK:
                offset, checked = self._follow_clock(offset), moment
            self._sample(sec_nanosec(round(moment * 1e9) + offset), settings, elapsed)
            sample += 1
            if self.settings is not settings:
                self._go_on(settings, elapsed)
                settings, began, sample = self.settings, moment, 1
                period = 1.0 / settings.rate

    def _begin(self, settings: DriveSettings) -> None:
        self._angle = settings.start         # at the beginning of the grid

    def _sample(self, stamp: Stamp, settings: DriveSettings, elapsed: float) -> None:
        """Step to the sample ``elapsed`` seconds after the beginning of the grid."""
        self._stream.step(stamp, self._angle + settings.speed * elapsed, settings.speed, 0.0)

    def _go_on(self, settings: DriveSettings, elapsed: float) -> None:
        """Prepare the next grid: it begins at the angle that the old settings have reached."""
        self._angle += settings.speed * elapsed

    def _offset(self) -> int:
        return int(self._node.get_clock().now().nanoseconds - time.monotonic_ns())

    def _follow_clock(self, offset: int) -> int:
        """Return the offset from monotonic to wall clock; a new one if the wall clock was set."""
        new = self._offset()
        if abs(new - offset) < CLOCK_STEP * 1e9:
            return offset
        self.counts['clock_steps'] += 1
        self._node.get_logger().warning(f'the clock was set by {(new - offset) * 1e-9:.3f} s')
        return new


class SimulatedDrive(Drive):
    """Base of drives on simulated time: a ROS timer at ``drive.rate``, which follows /clock."""

    _last = 0                  # [ns] simulated time of the last tick; 0 before the first

    def start(self) -> None:
        """Start the timer."""
        self._timer = self._node.create_timer(1.0 / self.settings.rate, self._tick)

    def stop(self) -> None:
        """Stop it."""
        self._node.destroy_timer(self._timer)

    def apply(self, settings: DriveSettings) -> None:
        """Take over settings, and their rate."""
        rate_changed = settings.rate != self.settings.rate
        super().apply(settings)
        if rate_changed:
            self._node.destroy_timer(self._timer)
            self._timer = self._node.create_timer(1.0 / settings.rate, self._tick)

    def _tick(self) -> None:
        """Make the step of now; begin anew if simulated time went back."""
        now = self._node.get_clock().now().nanoseconds
        if now == 0:
            return                                       # no /clock yet
        before, self._last = self._last, now
        if now < before:
            self.counts['clock_steps'] += 1
            self._node.get_logger().warning('simulated time went back: starting again')
            self._begin_again()
        self._sample_at(now, (now - before) * 1e-9 if before else 0.0)

    @abstractmethod
    def _begin_again(self) -> None:
        """Set the motion back to the start of the scene."""

    @abstractmethod
    def _sample_at(self, now: int, passed: float) -> None:
        """Step to a simulated time [ns], so many seconds after the last step."""


class SimulatedTimerDrive(SimulatedDrive):
    """Constant speed on simulated time: the angle follows from the clock."""

    COUNTED = ('clock_steps',)
    _began: int | None = None           # [ns] when ``_angle`` was reached

    def start(self) -> None:
        """Start the timer."""
        self._begin_again()
        super().start()

    def apply(self, settings: DriveSettings) -> None:
        """Take over speed and rate, continuing from the current angle."""
        if self._began is not None:
            self._angle += self.settings.speed * (self._last - self._began) * 1e-9
            self._began = self._last
        super().apply(settings)

    def _begin_again(self) -> None:
        self._angle, self._began = self.settings.start, None

    def _sample_at(self, now: int, passed: float) -> None:
        if self._began is None:
            self._began = now
        angle = self._angle + self.settings.speed * (now - self._began) * 1e-9
        self._stream.step(sec_nanosec(now), angle, self.settings.speed, 0.0)
