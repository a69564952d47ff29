# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""A readable log: at most one line per cause and interval, with a count."""
from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass
import threading
import time
from typing import Protocol

INTERVAL = 10.0      # [s]


class Logger(Protocol):
    """The methods of a logger that are used here, as rclpy's has them."""

    def info(self, text: str, /) -> object:
        """Log good news."""

    def warning(self, text: str, /) -> object:
        """Log a trouble."""


@dataclass
class _Cause:
    """A cause of log lines: when it was logged [s], how often it came since, its newest line."""

    logged: float
    waiting: int = 0
    is_warning: bool = False
    text: str = ''


class QuietLog:
    """
    Logs the first line of a cause at once, then only the newest line of each ``interval`` [s].

    A stream of 1000 bad inputs a second would flood the log. The line held back says how often it
    came; :meth:`flush` writes it when the interval is over.
    """

    def __init__(self, logger: Logger, interval: float = INTERVAL) -> None:
        self._logger, self._interval, self._lock = logger, interval, threading.Lock()
        self._causes: dict[Hashable, _Cause] = {}        # the newest last

    def info(self, cause: Hashable, text: str) -> None:
        """Log good news."""
        self._note(cause, text, False)

    def warning(self, cause: Hashable, text: str) -> None:
        """Log a trouble."""
        self._note(cause, text, True)

    def flush(self, interval: float | None = None) -> None:
        """Log the lines held back for the interval, or another one [s]; called now and then."""
        interval = self._interval if interval is None else interval
        with self._lock:
            for cause in list(self._causes.values()):
                if cause.waiting and time.monotonic() - cause.logged >= interval:
                    self._log(cause)

    def _note(self, name: Hashable, text: str, is_warning: bool) -> None:
        """Count a line of a cause; log it if the interval since the last one is over."""
        with self._lock:
            cause = self._causes.pop(name, None) or _Cause(-self._interval)
            self._causes[name] = cause
            cause.waiting, cause.is_warning, cause.text = cause.waiting + 1, is_warning, text
            if time.monotonic() - cause.logged >= self._interval:
                self._log(cause)

    def _log(self, cause: _Cause) -> None:
        """Write the line of a cause, with how often it came since the last one."""
        now, text = time.monotonic(), cause.text
        if cause.waiting > 1:
            text += f' ({cause.waiting} times in {now - cause.logged:.0f} s)'
        cause.logged, cause.waiting = now, 0
        if cause.is_warning:             # rclpy remembers one severity for each line of code
            self._logger.warning(text)
        else:
            self._logger.info(text)
