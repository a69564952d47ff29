# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The log, kept readable: at most one line per cause and interval, with how many there were."""
from __future__ import annotations

from collections.abc import Hashable
import threading
import time
from typing import Any, Protocol

INTERVAL = 10.0      # [s]


class Logger(Protocol):
    """What this needs of a logger."""

    def info(self, text: str, /) -> object:
        """Log what is good."""

    def warning(self, text: str, /) -> object:
        """Log what is not."""


class QuietLog:
    """
    Says the first of a cause at once and counts the others until ``interval`` is over.

    Parameters
    ----------
    logger : object
        With methods ``info`` and ``warning``.
    interval : float
        [s]

    """

    def __init__(self, logger: Logger, interval: float = INTERVAL) -> None:
        self._logger, self._interval, self._lock = logger, interval, threading.Lock()
        # {cause: [when logged, how many since, is bad, newest text]}
        self._causes: dict[Hashable, list[Any]] = {}

    def info(self, cause: Hashable, text: str) -> None:
        """Log what is good."""
        self._note(cause, text, False)

    def warning(self, cause: Hashable, text: str) -> None:
        """Log what is not."""
        self._note(cause, text, True)

    def flush(self, interval: float | None = None) -> None:
        """Log what was held back for the interval, or another one: called now and then."""
        interval = self._interval if interval is None else interval
        with self._lock:
            for cause, (logged, waiting, *_) in list(self._causes.items()):
                if waiting and time.monotonic() - logged >= interval:
                    self._log(cause)

    def _note(self, cause: Hashable, text: str, is_bad: bool) -> None:
        with self._lock:
            logged, waiting, *_ = self._causes.pop(cause, (-self._interval, 0))
            self._causes[cause] = [logged, waiting + 1, is_bad, text]      # the newest last
            if time.monotonic() - logged >= self._interval:
                self._log(cause)

    def _log(self, cause: Hashable) -> None:
        logged, number, is_bad, text = self._causes[cause]
        now = time.monotonic()
        self._causes[cause][:2] = now, 0
        text += f' ({number} times in {now - logged:.0f} s)' if number > 1 else ''
        if is_bad:                       # two lines of code: to rclpy a line has one severity
            self._logger.warning(text)
        else:
            self._logger.info(text)
