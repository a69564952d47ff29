"""Services that take long: answered by a thread of their own, the executor goes on with inputs."""
from __future__ import annotations

import threading
from queue import SimpleQueue

from ..core import FourBarError


class Abandoned(FourBarError):
    """The node stops before the work is done."""


class Worker:
    """
    A thread that does one job after the other.

    Parameters
    ----------
    name : str
        Of the thread.

    """

    def __init__(self, name):
        self._jobs, self._stopping = SimpleQueue(), False
        self._thread = threading.Thread(target=self._run, name=name, daemon=True)
        self._thread.start()

    def serve(self, node, kind, name, handler):
        """
        Create a service of ``node`` whose ``handler(request, response)`` runs here.

        The executor calls the callback and sends what it returns. So the callback hands on what
        was asked, and sending means: put it into the queue. An executor that knew callback groups
        would need no such turn; EventsExecutor does not.
        """
        service = node.create_service(kind, name, lambda *asked: asked)
        send = service.send_response

        def answer(asked, header):
            self.do(lambda: send(handler(*asked), header))
        service.send_response = answer

    def do(self, job):
        """Do a job, a callable that does not raise, after those that wait."""
        self._jobs.put(job)

    def check(self):
        """Raise Abandoned if the node stops: called by long work between its pieces."""
        if self._stopping:
            raise Abandoned('abandoned: the node stops')

    def abandon(self):
        """Have the job in hand give up, if it checks, and begin no other."""
        self._stopping = True
        self._jobs.put(None)

    def stop(self, patience=None):
        """Abandon the job in hand and wait for its end, up to ``patience`` [s]."""
        self.abandon()
        self._thread.join(patience)

    def _run(self):
        while (job := self._jobs.get()) and not self._stopping:
            job()
