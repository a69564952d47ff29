# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Who sends which joints on the topic of the driven joint."""
from collections.abc import Iterable, Sequence

from fourbar_ros.errors import nearest
from fourbar_ros.ros.messages import Message

UNHEARD = 20           # messages without the driven joint after which a relay warns


class JointSenders:
    """
    What messages of joint states tell of those who send them.

    Two publishers may send different joints, but not both the driven one, nor the passive joints
    that this node computes.
    """

    def __init__(self, driven: str, computed: Sequence[str]) -> None:
        """Begin without messages; ``driven`` and ``computed`` are names of joints."""
        self._driven, self._computed = driven, computed
        self._without_driven: list[Message] = []    # the first ones, while it never came
        self.forget()

    def forget(self) -> None:
        """Forget the senders, as after each report."""
        self._last_names: Sequence[str] = ()        # of joints, with the driven one
        self._lists = set[tuple[str, ...]]()        # of names, with the driven joint
        self._taken = set[str]()                    # computed joints that others sent
        self.others_are_heard = False               # messages of others without the driven joint

    def note(self, names: Sequence[str]) -> None:
        """Note the names of a message with the driven joint."""
        if names != self._last_names:
            self._last_names = names
            self._lists.add(tuple(names))
            self._taken.update(set(self._computed).intersection(names))

    def note_other(self, message: Message, is_input_heard: bool) -> str:
        """Note a message without the driven joint; return what to log of it, once, or ''."""
        if message.name != self._computed:      # not our own answer
            self.others_are_heard = True
            self._taken.update(set(self._computed).intersection(message.name))
        if is_input_heard or len(self._without_driven) >= UNHEARD:
            return ''
        self._without_driven.append(message)
        if len(self._without_driven) < UNHEARD:
            return ''
        return (f'drive.joint = {self._driven!r} had a position in none of the first {UNHEARD} '
                f'messages{self.hint(self._without_driven)}')

    def hint(self, messages: Iterable[Message]) -> str:
        """Return the name that may be meant of those in messages, as a question, or ''."""
        names = dict.fromkeys(name for message in messages for name in message.name)
        return nearest(self._driven, names) if names and self._driven not in names else ''

    def problems(self, topic: str, publishers: int, heard: int, is_ours: bool) -> list[str]:
        """Return the problems since the last time; ``is_ours``: this node publishes there too."""
        problems = []
        if publishers - is_ours > 1 and (
                len(self._lists) > 1 or heard - is_ours > 1 and not self.others_are_heard):
            joint = f' joint {self._driven!r}' if self._lists else ''
            problems.append(f'more than one publisher sends{joint} on {topic}')
        if is_ours and self._taken:
            problems.append(f'another publisher sends {", ".join(sorted(self._taken))} on {topic},'
                            ' which this node computes')
        return problems
