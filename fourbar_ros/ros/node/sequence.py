# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Messages that were sent but never taken, by the numbers that publishers give them."""
from __future__ import annotations

from collections.abc import Callable
from inspect import Parameter, Signature
from typing import Any

Info = dict[str, Any]      # of a message, as rclpy gives it


class SequenceNumbers:
    """
    Counts what is missing in the numbers of the messages of one topic.

    Every publisher numbers its messages one by one; a message does not say whose it is. So the
    next number of every publisher is kept, and one that fits none leaves a gap behind the
    nearest. With several publishers single gaps may be taken for another's, their sum is right.

    Parameters
    ----------
    publishers : callable
        Returns how many there are.

    Attributes
    ----------
    lost : int
    is_numbered : bool
        Whether the middleware gives numbers at all; if not, nothing is known.

    """

    def __init__(self, publishers: Callable[[], int]) -> None:
        self._publishers = publishers
        self._next: list[int] = []
        self.lost, self.is_numbered = 0, True

    def forget(self) -> None:
        """Start anew: publishers have come or gone."""
        self._next = []

    def take(self, number: int | None) -> None:
        """Note the number of a message; None if the middleware gives none."""
        if number is None:
            self.is_numbered = False
            return
        expected = self._next
        if number in expected:
            expected[expected.index(number)] += 1
        elif len(expected) < self._publishers():
            expected.append(number + 1)                  # the first of this publisher
        elif before := [other for other in expected if other < number]:
            self.lost += number - max(before)
            expected[expected.index(max(before))] = number + 1
        else:
            self._next = [number + 1]                    # a publisher that has started again


class WithInfo:
    """
    A callback for a message and its info, whoever calls it.

    rclpy looks at the signature to see that a callback wants the info. Its EventsExecutor then
    gives both as one tuple (rclpy 7.1.5), other executors, and later ones, as two arguments.
    """

    __signature__ = Signature([Parameter(name, Parameter.POSITIONAL_ONLY)
                               for name in ('message', 'info')])

    def __init__(self, receive: Callable[[bytes, Info], None]) -> None:
        self._receive = receive

    def __call__(self, *given: Any) -> None:
        """Call ``receive(message, info)``."""
        message, info = given if len(given) == 2 else given[0]
        self._receive(message, info)
