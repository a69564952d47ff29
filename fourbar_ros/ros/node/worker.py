# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""A thread for slow jobs, as long services, while the executor goes on with inputs."""
from __future__ import annotations

from collections.abc import Callable
from queue import SimpleQueue
import threading
from traceback import format_exc
from typing import Any

from fourbar_ros.errors import FourBarError
from fourbar_ros.ros.messages import Message
from rclpy.node import Node


class Abandoned(FourBarError):
    """The node stops before the work is done."""


class Worker:
    """
    A named thread that does one job after the other.

    ``tell(text)`` is called when a job has raised: a fault of ours, or a client that is gone.
    """

    def __init__(self, name: str, tell: Callable[[str], object]) -> None:
        self._jobs: SimpleQueue[Callable[[], object] | None] = SimpleQueue()
        self._stopping, self._tell = False, tell
        self._thread = threading.Thread(target=self._run, name=name, daemon=True)
        self._thread.start()

    def serve(self, node: Node, kind: type[Any], name: str,
              handler: Callable[[Message, Message], Message]) -> None:
        """
        Create a service of ``node`` whose ``handler(request, response)`` runs in this thread.

        The executor calls the service's callback and passes its result to ``send_response``. Here
        the callback returns its arguments, and ``send_response`` is replaced: it queues the
        handler, which sends the response when it is done. rclpy has callback groups for that, but
        its EventsExecutor does not know them.
        """
        service = node.create_service(kind, name, lambda request, response: (request, response))
        send = service.send_response

        def queue(arguments: tuple[Message, Message], header: Message) -> None:
            self.do(lambda: send(handler(*arguments), header))
        service.send_response = queue

    def do(self, job: Callable[[], object]) -> None:
        """Queue a job."""
        self._jobs.put(job)

    def check(self) -> None:
        """Raise Abandoned if the node stops; long jobs call it between their pieces."""
        if self._stopping:
            raise Abandoned('abandoned: the node stops')

    def abandon(self) -> None:
        """Make the running job give up at its next :meth:`check`; begin no other."""
        self._stopping = True
        self._jobs.put(None)

    def stop(self, patience: float | None = None) -> None:
        """Abandon the running job and wait for its end, up to ``patience`` [s]."""
        self.abandon()
        self._thread.join(patience)

    def _run(self) -> None:
        while (job := self._jobs.get()) and not self._stopping:
            try:
                job()
            except Exception:                            # the next one is done all the same
                self._tell(f'a fault in {self._thread.name}: {format_exc()}')
