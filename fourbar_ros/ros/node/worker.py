# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""A thread for slow jobs, as long services, while the executor goes on with inputs."""
from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from queue import Full, Queue
import threading
from traceback import format_exc

from fourbar_ros.errors import FourBarError
from fourbar_ros.ros.messages import Message
from rclpy.service import Service

WAITING = 8       # most jobs that wait for one thread


class Abandoned(FourBarError):
    """The node stops before the work is done."""


class Worker:
    """
    A named thread that does one job after the other; ``waiting`` of them may wait for it.

    ``tell(text)`` is called when a job has raised: a fault of ours, or a client that is gone.
    """

    def __init__(self, name: str, tell: Callable[[str], object], waiting: int = WAITING) -> None:
        self._jobs: Queue[Callable[[], object] | None] = Queue(waiting)
        self._stopping, self._tell = False, tell
        self._thread = threading.Thread(target=self._run, name=name, daemon=True)
        self._thread.start()

    def do(self, job: Callable[[], object]) -> bool:
        """Queue a job; return False if too many wait."""
        try:
            self._jobs.put_nowait(job)
        except Full:
            return False
        return True

    @property
    def is_this_thread(self) -> bool:
        """Return whether it runs the code that asks."""
        return threading.current_thread() is self._thread

    def check(self) -> None:
        """Raise Abandoned if the node stops; long jobs call it between their pieces."""
        if self._stopping:
            raise Abandoned('abandoned: the node stops')

    def abandon(self) -> None:
        """Make the running job give up at its next :meth:`check`; begin no other."""
        self._stopping = True
        with suppress(Full):                 # then it sees that at its next job
            self._jobs.put_nowait(None)

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


Answer = Callable[[Message, Message], Message]     # (request, response) -> response


def both(request: Message, response: Message) -> tuple[Message, Message]:
    """Return both: what :func:`answer_beside` asks of the callback of a service."""
    return request, response


def answer_beside(service: Service, answer: Answer, busy: Answer,
                  worker_for: Callable[[Message], Worker]) -> None:
    """
    Have a service answer by ``answer(request, response)`` in the worker for the request.

    Where too many wait for that, ``busy(request, response)`` answers at once. The executor calls
    the service's callback, which must return its arguments, and passes its result to
    ``send_response``. That is replaced: it queues the answer. rclpy has callback groups for that,
    but its EventsExecutor does not know them (ros2/rclpy#1473).
    """
    send = service.send_response

    def queue(arguments: tuple[Message, Message], header: Message) -> None:
        if not worker_for(arguments[0]).do(lambda: send(answer(*arguments), header)):
            send(busy(*arguments), header)
    service.send_response = queue
