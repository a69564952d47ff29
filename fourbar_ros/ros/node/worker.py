# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Services that take long: answered by a thread of their own, the executor goes on with inputs."""
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
    A thread that does one job after the other.

    Parameters
    ----------
    name : str
        Name of the thread.
    tell : callable
        Called with a text when a job has raised: a fault of ours, or an answer that nobody takes.

    """

    def __init__(self, name: str, tell: Callable[[str], object]) -> None:
        self._jobs: SimpleQueue[Callable[[], object] | None] = SimpleQueue()
        self._stopping, self._tell = False, tell
        self._thread = threading.Thread(target=self._run, name=name, daemon=True)
        self._thread.start()

    def serve(self, node: Node, kind: type[Any], name: str,
              handler: Callable[[Message, Message], Message]) -> None:
        """
        Create a service of ``node`` whose ``handler(request, response)`` runs here.

        The executor calls the callback and sends what it returns. So the callback hands on what
        was asked, and sending means: put it into the queue. An executor that knew callback groups
        would need no such turn; EventsExecutor does not.
        """
        service = node.create_service(kind, name, lambda *asked: asked)
        send = service.send_response

        def answer(asked: tuple[Message, Message], header: Message) -> None:
            self.do(lambda: send(handler(*asked), header))
        service.send_response = answer

    def do(self, job: Callable[[], object]) -> None:
        """Do a job, a callable, after those that wait."""
        self._jobs.put(job)

    def check(self) -> None:
        """Raise Abandoned if the node stops: called by long work between its pieces."""
        if self._stopping:
            raise Abandoned('abandoned: the node stops')

    def abandon(self) -> None:
        """Have the job in hand give up, if it checks, and begin no other."""
        self._stopping = True
        self._jobs.put(None)

    def stop(self, patience: float | None = None) -> None:
        """Abandon the job in hand and wait for its end, up to ``patience`` [s]."""
        self.abandon()
        self._thread.join(patience)

    def _run(self) -> None:
        while (job := self._jobs.get()) and not self._stopping:
            try:
                job()
            except Exception:                            # the next one is done all the same
                self._tell(f'a fault in {self._thread.name}: {format_exc()}')
