# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Drive the input at constant speed, on the wall clock or on simulated time."""
from math import nan
from traceback import format_exc
from typing import Any

from fourbar_ros.ros.messages import sec_nanosec
from fourbar_ros.ros.node.entities import clock_of, Troubles
from fourbar_ros.ros.node.stream import Stream
from rclpy.node import Node

TICK = 0.1             # [s] longest period of the timer: so soon it sees new settings
CATCH_UP = 1.0         # [s] later than this it skips the samples it missed
CLOCK_STEP = 50_000_000        # [ns] the wall clock was set if it is this far from the steady one
CHECK_CLOCK = 1_000_000_000    # [ns] how often that is looked at

Reported = tuple[dict[str, Any], list[str]]     # for the diagnostics: {name: value}, problems


class ClockInput:
    """
    Constant speed: sample k belongs to start + k / rate, however late its timer is.

    Its angle follows from that time, without accumulating errors. Times are those of a steady
    clock, stamps those of the node's clock; with simulated time both are that.
    """

    def __init__(self, node: Node, stream: Stream, troubles: Troubles) -> None:
        """Begin a grid of samples; a timer looks which ones are due."""
        self._node, self._stream, self._troubles = node, stream, troubles
        troubles.expect('missed', 'clock_steps', 'faults')
        self._settings, (self._clock, self._time) = stream.scene.drive, clock_of(node)
        self._is_simulated = self._clock is node.get_clock()
        self._began: int | None = None       # [ns] time of sample 0; None before it
        self._last = 0                       # [ns] time of the last tick
        self._prepare()
        self._timer = node.create_timer(min(1.0 / self._settings.rate, TICK), self._tick,
                                        clock=self._clock)

    def stop(self) -> None:
        self._node.destroy_timer(self._timer)

    def age(self) -> float:
        """Return the time since the newest input [s]: NaN, it has none."""
        return nan

    def report(self) -> Reported:
        """Return (values, problems) for the diagnostics, beside the counts of troubles."""
        return {}, []

    def _tick(self) -> None:
        """
        Make all samples that are due: a late timer neither loses one nor leaves the grid.

        Sample k is due at began + k / rate, for k from ``_next`` on; its stamp is ``_offset`` [ns]
        later. Another rate or speed in the scene begins a new grid.
        """
        now = self._time()
        if now == 0:
            return                                       # no /clock yet
        if now < self._last:
            self._troubles.count('clock_steps', 'simulated time went back: starting again')
            self._began = None
            self._prepare()
        if self._began is None:
            # when this tick was due, so that all later samples are due before their ticks
            self._began = min(now, now + self._timer.time_until_next_call()
                              - self._timer.timer_period_ns)
            self._next, self._offset, self._checked = 0, self._offset_of_stamps(), now
        self._last = now
        if now - self._checked > CHECK_CLOCK:
            self._checked, offset = now, self._offset_of_stamps()
            if abs(offset - self._offset) >= CLOCK_STEP:
                self._troubles.count('clock_steps', 'the clock was set by '
                                     f'{(offset - self._offset) * 1e-9:.3f} s')
                self._offset = offset
        period = 1e9 / self._settings.rate
        behind = int((now - self._began) / period) - self._next
        if behind * period > CATCH_UP * 1e9:             # suspended, or too high a rate
            self._troubles.counts['missed'] += behind
            self._next += behind
        while (due := self._began + round(self._next * period)) <= now:
            try:
                self._sample(due + self._offset, self._next / self._settings.rate)
            except Exception:                            # it is ours and must not end us
                self._troubles.count('faults', f'a fault in a sample: {format_exc()}')
            self._next += 1
        before, self._settings = self._settings, self._stream.scene.drive
        if (self._settings.speed, self._settings.rate) == (before.speed, before.rate):
            return
        # a new grid begins at the last sample [ns], or now if that is long ago
        last = self._began + round((self._next - 1) * period)
        begin = last if (now - last) * 1e-9 < 1.0 / self._settings.rate else now
        self._leave(before.speed, (begin - self._began) * 1e-9)
        self._began, self._next = begin, 1
        if self._settings.rate != before.rate:
            self._timer.timer_period_ns = round(1e9 * min(1.0 / self._settings.rate, TICK))
            self._timer.reset()

    def _offset_of_stamps(self) -> int:
        """Return by how much the node's clock is ahead of the clock of the samples [ns]."""
        if self._is_simulated:
            return 0
        return int(self._node.get_clock().now().nanoseconds - self._time())

    def _prepare(self) -> None:
        self._angle = self._settings.start               # at sample 0

    def _sample(self, stamp: int, passed: float) -> None:
        """Step to the sample of a stamp [ns], ``passed`` seconds after sample 0."""
        self._stream.step(sec_nanosec(stamp), self._angle + self._settings.speed * passed,
                          self._settings.speed, 0.0)

    def _leave(self, speed: float, passed: float) -> None:
        self._angle += speed * passed
