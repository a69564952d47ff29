# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Messages that were sent but never taken, by the numbers that publishers give them."""
from __future__ import annotations

from collections.abc import Callable
from inspect import Parameter, Signature
from typing import Any

MessageInfo = dict[str, Any]      # of a message, as rclpy gives it


class SequenceNumbers:
    """
    Counts the messages ``lost`` on one topic, by gaps in their sequence numbers.

    Every publisher numbers its messages one by one, but a message does not name its publisher. So
    the next number of each publisher is kept; a number that fits none leaves a gap behind the
    nearest below. With several publishers a gap may be counted for the wrong one; the sum is
    right. ``publishers()`` returns how many there are. ``is_numbered`` is False with a middleware
    that gives no numbers: then nothing is known.
    """

    def __init__(self, publishers: Callable[[], int]) -> None:
        self._publishers = publishers
        self._next: list[int] = []       # the number that each publisher will give next
        self.lost, self.is_numbered = 0, True

    def forget(self) -> None:
        """Start anew: publishers have come or gone."""
        self._next = []

    def take(self, number: int | None) -> None:
        """
        Note the number of a message; None if the middleware gives none.

        One publisher's numbers 5, 6, 9 count two lost messages.
        """
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
    A subscription callback that gets a message and its info from any executor.

    rclpy sees by the signature that a callback wants the info. Its EventsExecutor then passes both
    as one tuple (rclpy 7.1.5), other executors, and later ones, as two arguments.
    """

    __signature__ = Signature([Parameter(name, Parameter.POSITIONAL_ONLY)
                               for name in ('message', 'info')])

    def __init__(self, receive: Callable[[bytes, MessageInfo], None]) -> None:
        self._receive = receive

    def __call__(self, *given: Any) -> None:
        """Call ``receive(message, info)``."""
        message, info = given if len(given) == 2 else given[0]
        self._receive(message, info)
