# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``fourbar replay``: publish a recorded run again, or drive a live node with it."""
from __future__ import annotations

import argparse
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, nullcontext
import os
import select
import sys
import time
from typing import Any, TYPE_CHECKING

from fourbar_ros.cli.common import add_tolerance, add_topics, add_verb, BAD, BAG_HELP, Verbs
from fourbar_ros.errors import BagError
from fourbar_ros.scene.arguments import not_negative, positive

if TYPE_CHECKING:
    from fourbar_ros.bag.read.playback import Pace


REFRESH = 0.1       # [s] between two looks at the clock of the bag
DESCRIPTION = """\
Publish the messages of a bag again, with their original timing, topics and quality of service.
BAG may be finished, cut off, or still being written. Requires ROS 2 and the packages of the
message types; topics whose type is not installed are left out with a warning. In a terminal, space
pauses, the right arrow publishes the next message, up and down change the rate by a tenth.
"""
EPILOG = """\
examples:
  fourbar replay bags/run                              at the original speed
  fourbar replay bags/run --rate 0.1 --start 12        slowly, from second 12 on
  fourbar replay bags/run --clock --loop               for nodes with use_sim_time
  fourbar replay bags/run --topics /joint_states
  fourbar replay bags/run --ros-args -r /joint_states:=/old/joint_states

  fourbar bag scene bags/run > again.yaml              repeat the run with a live node,
  fourbar_node --ros-args --params-file again.yaml &
  fourbar replay bags/run --inputs-only                and compare its outputs

exit codes: 0 good; 1 an error; 2 bad arguments; 3 with --inputs-only: an output differs or
is missing; 130 after Ctrl-C
"""


def add(verbs: Verbs) -> None:
    """Add ``fourbar replay`` with its arguments."""
    replay = add_verb(verbs, 'replay', 'publish a recorded run again, or drive a live node with '
                                       'it', DESCRIPTION, EPILOG)
    replay.add_argument('bag', metavar='BAG', help=BAG_HELP)
    replay.add_argument('--rate', type=positive, default=1.0, metavar='X',
                        help='play X times as fast (default 1)')
    replay.add_argument('--start', type=not_negative, default=0.0, metavar='S',
                        help='skip the first S seconds')
    replay.add_argument('--loop', action='store_true', help='repeat until stopped')
    replay.add_argument('--follow', action='store_true',
                        help='if the bag is still being written: continue until it is finished')
    replay.add_argument('--clock', nargs='?', type=positive, const=100.0, metavar='HZ',
                        help='publish the time of the bag on /clock, HZ times per second (default '
                             '100); of a bag of simulated time, the stamps of its messages')
    replay.add_argument('--delay', type=not_negative, default=1.0, metavar='S',
                        help='give subscribers at least S seconds to find the topics and wait for '
                             'all that are discovered (default 1); 0: start at once')
    replay.add_argument('--readers', type=int, default=0, metavar='N',
                        help='start only when N subscriptions are matched, however long it takes')
    add_topics(replay, 'publish only these topics')
    replay.add_argument('--inputs-only', action='store_true',
                        help='send only the driven motion to a live node and compare its outputs '
                             'with the recorded ones')
    replay.add_argument('--node', metavar='NAME', help='name of that node; default: the name in '
                                                       'the bag')
    add_tolerance(replay, 'with --inputs-only: ')
    replay.add_argument('--ros-args', nargs=argparse.REMAINDER, default=[],
                        help='arguments for ROS, e.g. remappings')
    replay.set_defaults(run=_replay)


def _replay(arguments: argparse.Namespace) -> int:
    """Publish a bag; keys of the terminal pause it or change its rate meanwhile."""
    ros_args = ['--ros-args', *arguments.ros_args] if arguments.ros_args else []
    from fourbar_ros.bag.read.playback import FASTER, Pace, span
    pace = Pace(arguments.rate)
    first, last = span(arguments.bag)
    if first is not None and last is not None and arguments.start * 1e9 > last - first:
        raise BagError(f'--start {arguments.start:g}: the bag ends after '
                       f'{(last - first) * 1e-9:.3f} s')
    if arguments.inputs_only:
        return _inputs_only(arguments, ros_args)
    from fourbar_ros.ros.clients.replay import replay
    actions: dict[str, Callable[[], None]] = {
        'space': lambda: pace.pause(not pace.is_paused), 'right': pace.step,
        'up': lambda: pace.change(FASTER), 'down': lambda: pace.change(1.0 / FASTER)}
    with Keyboard() as keyboard, _status(first, last, pace, keyboard.is_there) as show:
        def on_tick(now: int) -> None:
            for key in keyboard.pressed():
                actions[key]()
            show(now)
        replay(arguments.bag, arguments.topics, arguments.rate, arguments.start,
               arguments.loop, arguments.follow, arguments.clock, arguments.delay,
               ros_args, pace, on_tick, arguments.readers)
    return 0


@contextmanager
def _status(first: int | None, last: int | None, pace: Pace, has_keys: bool
            ) -> Iterator[Callable[[int], None]]:
    """
    Print the extent of the bag; give the function that shows progress on a terminal.

    ``first``, ``last``: times of its messages [ns], None if the bag does not tell. The function
    takes the time of the bag [ns] and updates the terminal ten times per second.
    """
    from datetime import datetime

    from rich.console import Console
    from rich.live import Live

    def date(moment: int) -> str:
        return datetime.fromtimestamp(moment * 1e-9).astimezone().isoformat(' ', 'milliseconds')
    if first is not None and last is not None:
        print(f'{(last - first) * 1e-9:.3f} s, from {date(first)} to {date(last)}', flush=True)
    console = Console(stderr=True, highlight=False)
    updated = 0.0
    if has_keys and console.is_terminal:
        print('space: pause, right: next message, up and down: faster and slower', flush=True)
    with Live(console=console, auto_refresh=False,
              transient=True) if console.is_terminal else nullcontext() as live:
        def show(now: int) -> None:
            nonlocal updated, first
            if live and time.monotonic() - updated > REFRESH:
                updated, first = time.monotonic(), now if first is None else first
                live.update(status_line(now, first, last, pace), refresh=True)
        yield show


def status_line(now: int, first: int, last: int | None, pace: Pace) -> str:
    """Return the progress of a replay, '3.0 s of 10.0 s, 7.0 s left, rate 1'; times in [ns]."""
    text = f'{(now - first) * 1e-9:.1f} s'
    if last is not None:
        left = max(last - now, 0) * 1e-9
        text += f' of {(last - first) * 1e-9:.1f} s, {left / pace.rate:.1f} s left'
    return f'{text}, rate {pace.rate:.3g}' + (', paused' if pace.is_paused else '')


def _inputs_only(arguments: argparse.Namespace, ros_args: Sequence[str]) -> int:
    """Drive a live node with a bag; print how its outputs differ, return BAD if they do."""
    from fourbar_ros.report.terminal import make_console, PlainTable
    from fourbar_ros.ros.clients.rerun import drive_live
    answers, notes = drive_live(arguments.bag, arguments.node, arguments.rate, arguments.start,
                                ros_args)
    table = PlainTable('', ('topic', 'answers>', 'missing>', 'largest difference>', 'field'))
    for answer in answers:
        table.add_row(answer.topic, str(answer.messages), str(answer.missing),
                      f'{answer.largest:g}', answer.field)
    make_console().print(table)
    for note in notes:
        print(note)
    is_good = all(not answer.missing and answer.largest <= arguments.tolerance
                  for answer in answers)
    return 0 if any(answer.messages for answer in answers) and is_good else BAD


KEYS = {b'\x1b[A': 'up', b'\x1b[B': 'down', b'\x1b[C': 'right', b'\x1b[D': 'left', b' ': 'space'}


class Keyboard:
    """
    Reads keys as they are pressed, in a ``with`` block.

    ``is_there`` tells whether it can: standard input is a terminal with us in its foreground.
    """

    _old: list[Any]         # settings of the terminal, to be restored

    def __init__(self) -> None:
        self.is_there = False
        self._rest = b''

    def __enter__(self) -> Keyboard:
        """Have the terminal pass on each key at once instead of whole lines."""
        try:
            import termios
            import tty
            self._number = sys.stdin.fileno()
            # the terminal would stop a program in the background that changes its settings
            if os.isatty(self._number) and os.tcgetpgrp(self._number) == os.getpgrp():
                self._old = termios.tcgetattr(self._number)
                tty.setcbreak(self._number)
                self.is_there = True
        except (ImportError, OSError, ValueError):       # on Windows; stdin closed or replaced
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
        """Take the keys from the bytes read; drop other bytes, keep the beginning of a key."""
        names = []
        while self._rest:
            key = next((key for key in KEYS if self._rest.startswith(key)), None)
            if key is None and any(other.startswith(self._rest) for other in KEYS):
                break                                   # the rest of it is still to come
            names += [KEYS[key]] if key else []
            self._rest = self._rest[len(key or b'x'):]
        return names
