"""The end of a process by signals; light: they are caught before anything long is imported."""
from __future__ import annotations

import signal

SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


class Stop:
    """
    Whether a signal has asked the process to end.

    A plain flag: a handler interrupts the main thread anywhere, also in a handler, where the lock
    of a ``threading.Event`` would wait for itself.
    """

    def __init__(self):
        self.requested, self._before = False, {}

    def catch(self):
        """Note every signal from now on; return self."""
        for number in SIGNALS:
            self._before[number] = signal.signal(number, self._note)
        return self

    def restore(self):
        """Handle signals as before."""
        for number, handler in self._before.items():
            signal.signal(number, handler)

    def _note(self, *_):
        self.requested = True

    @staticmethod
    def ignore():
        """Ignore signals: Python puts handlers back while it ends, not what is ignored."""
        for number in SIGNALS:
            signal.signal(number, signal.SIG_IGN)
