# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Keys pressed in the terminal while something runs, without a return."""
from __future__ import annotations

import os
import select
import sys
from typing import Any

KEYS = {b'\x1b[A': 'up', b'\x1b[B': 'down', b'\x1b[C': 'right', b'\x1b[D': 'left', b' ': 'space'}


class Keyboard:
    """
    Reads keys as they are pressed, in a ``with`` block; from what is no terminal, nothing.

    Attributes
    ----------
    is_there : bool
        Whether keys can be read: standard input is a terminal and this program is in its
        foreground.

    """

    _old: list[Any]         # settings of the terminal, to be restored

    def __init__(self) -> None:
        self.is_there = False
        self._rest = b''

    def __enter__(self) -> Keyboard:
        try:
            import termios
            import tty
            self._number = sys.stdin.fileno()
            # the terminal would stop a program in the background that changes its settings
            if os.isatty(self._number) and os.tcgetpgrp(self._number) == os.getpgrp():
                self._old = termios.tcgetattr(self._number)
                tty.setcbreak(self._number)
                self.is_there = True
        # no terminals here, or stdin is closed or replaced
        except (ImportError, OSError, ValueError):
            pass
        return self

    def __exit__(self, *_: object) -> None:
        if self.is_there:
            import termios
            termios.tcsetattr(self._number, termios.TCSADRAIN, self._old)

    def pressed(self) -> list[str]:
        """Return the names of the keys pressed since the last call."""
        while self.is_there and select.select([self._number], [], [], 0.0)[0]:
            data = os.read(self._number, 1024)
            if not data:
                self.is_there = False                   # it was closed
                break
            self._rest += data
        return self._named()

    def _named(self) -> list[str]:
        found = []
        while self._rest:
            key = next((key for key in KEYS if self._rest.startswith(key)), None)
            if key is None and any(other.startswith(self._rest) for other in KEYS):
                break                                   # the rest of it is still to come
            found += [KEYS[key]] if key else []
            self._rest = self._rest[len(key or b'x'):]
        return found
