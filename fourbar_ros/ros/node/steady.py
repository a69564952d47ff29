# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Timers that no setting of the system clock can stop.

The executor and rclpy's timers wait until a time of the system clock, those on a steady clock too:
the wheels are built with a libstdc++ that knows no other wait. Set that clock back by an hour, and
a wait of 0.1 s takes an hour: no timer runs, and no signal is seen.
"""
from __future__ import annotations

from collections.abc import Callable
from threading import Event, Thread
import time

from rclpy.executors import Executor
from rclpy.node import Node

PERIOD = 0.1        # [s] so finely are these timers spaced
WAKE = 0.3          # [s] so often at least is the executor woken, which then sees signals


def clock_of(node: Node) -> Callable[[], float]:
    """Return the clock of silences, in [s]: steady, or the simulation's with use_sim_time."""
    if node.get_parameter('use_sim_time').value:
        return lambda: node.get_clock().now().nanoseconds * 1e-9
    return time.monotonic


class SteadyTimers:
    """
    Functions called periodically in the thread of an executor.

    A thread sleeps by the monotonic clock and gives the executor a task whenever one is due.
    """

    def __init__(self) -> None:
        self._timers: dict[object, tuple[float, Callable[[], None]]] = {}    # (period [s], call)
        self._due: dict[object, float] = {}              # [s] monotonic, by the same keys
        self._ended = Event()
        self._is_asked = False                           # whether a task waits in the executor

    def add(self, period: float, callback: Callable[[], None]) -> object:
        """Call a function every ``period`` [s] from now on; return a key to :meth:`remove` it."""
        timer = object()
        self._due[timer], self._timers[timer] = time.monotonic() + period, (period, callback)
        return timer

    def remove(self, timer: object) -> None:
        """Do not call it any more."""
        del self._timers[timer], self._due[timer]

    def start(self, executor: Executor, failed: Callable[[Exception], None]) -> None:
        """
        Begin to call the functions in an executor; ``failed`` gets an error of any of them.

        A thread sleeps and, when a function is due, gives the executor a task that calls it.
        """
        def run() -> None:
            self._is_asked = False
            try:
                self._run()
            except Exception as error:
                failed(error)

        def wake() -> None:
            """Sleep, and give the executor the task, until :meth:`stop`: the thread's loop."""
            woken = time.monotonic()
            while not self._ended.is_set():
                time.sleep(PERIOD)
                now = time.monotonic()
                if not self._is_asked and (now - woken >= WAKE or self._any_is_due(now)):
                    self._is_asked, woken = True, now    # no second task for a busy executor
                    executor.create_task(run)
        self._thread = Thread(target=wake, name='steady timers', daemon=True)
        self._thread.start()

    def stop(self) -> None:
        """End it: nothing is called afterwards."""
        self._ended.set()
        self._thread.join()

    def _any_is_due(self, now: float) -> bool:           # to the nearest PERIOD
        return any(now >= due - 0.5 * PERIOD for due in list(self._due.values()))

    def _run(self) -> None:
        """Call the functions that are due; after a delay each is called once, not in a burst."""
        now = time.monotonic()
        for timer, (period, callback) in list(self._timers.items()):
            if now >= self._due[timer] - 0.5 * PERIOD:
                self._due[timer] = max(self._due[timer] + period, now)
                callback()
