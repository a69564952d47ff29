# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The log, kept readable: at most one line per cause and interval, with how many there were."""
from __future__ import annotations

import threading
import time

INTERVAL = 10.0      # [s]


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

    def __init__(self, logger, interval=INTERVAL):
        self._logger, self._interval, self._lock = logger, interval, threading.Lock()
        self._causes = {}        # {cause: [when logged, how many since, is bad, newest text]}

    def info(self, cause, text):
        """Log what is good."""
        self._note(cause, text, False)

    def warning(self, cause, text):
        """Log what is not."""
        self._note(cause, text, True)

    def flush(self, interval=None):
        """Log what was held back for the interval, or another one: called now and then."""
        interval = self._interval if interval is None else interval
        with self._lock:
            for cause, (logged, waiting, *_) in list(self._causes.items()):
                if waiting and time.monotonic() - logged >= interval:
                    self._log(cause)

    def _note(self, cause, text, is_bad):
        with self._lock:
            logged, waiting, *_ = self._causes.pop(cause, (-self._interval, 0))
            self._causes[cause] = [logged, waiting + 1, is_bad, text]      # the newest last
            if time.monotonic() - logged >= self._interval:
                self._log(cause)

    def _log(self, cause):
        logged, number, is_bad, text = self._causes[cause]
        now = time.monotonic()
        self._causes[cause][:2] = now, 0
        text += f' ({number} times in {now - logged:.0f} s)' if number > 1 else ''
        if is_bad:                       # two lines of code: to rclpy a line has one severity
            self._logger.warning(text)
        else:
            self._logger.info(text)
