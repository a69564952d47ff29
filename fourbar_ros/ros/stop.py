# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The end of a process by signals.

Imports little, so that they are caught before the long imports.
"""
from __future__ import annotations

from collections.abc import Callable
import signal
import sys
import time
from types import FrameType
from typing import Union

# Windows has no SIGHUP
SIGNALS = tuple(signal.Signals[name] for name in ('SIGINT', 'SIGTERM', 'SIGHUP')
                if hasattr(signal, name))

Handler = Union[Callable[[int, Union[FrameType, None]], object], int, None]


class Stop:
    """
    Whether a signal has ``requested`` the end of the process, and its ``name``, else empty.

    It is a plain flag, no ``threading.Event``: a signal may interrupt the main thread while that
    holds the event's lock, and then waits for itself.
    """

    def __init__(self) -> None:
        self.requested, self.name = False, ''
        self._before: dict[signal.Signals, Handler] = {}

    def catch(self) -> Stop:
        """Catch signals from now on, but for a SIGHUP that ``nohup`` ignores; return self."""
        for number in SIGNALS:
            if number.name != 'SIGHUP' or signal.getsignal(number) is not signal.SIG_IGN:
                self._before[number] = signal.signal(number, self._note)
        return self

    def restore(self) -> None:
        """Restore the former handlers."""
        for number, handler in self._before.items():
            signal.signal(number, handler)

    def _note(self, number: int, _: object) -> None:
        self.requested, self.name = True, self.name or signal.Signals(number).name

    @staticmethod
    def ignore() -> None:
        """
        Ignore signals until the end of the process, so that a second Ctrl-C cannot break it off.

        While Python ends it sets handlers back to their defaults, but leaves ignored signals so.
        """
        before = sys.unraisablehook
        # A signal that arrives while its handler changes would print a traceback (an OSError).
        sys.unraisablehook = lambda unraised: (
            None if isinstance(unraised.exc_value, OSError) else before(unraised))
        try:
            for number in SIGNALS:
                signal.signal(number, signal.SIG_IGN)
                time.sleep(0.0)              # here Python handles what arrived in between
        finally:
            sys.unraisablehook = before
