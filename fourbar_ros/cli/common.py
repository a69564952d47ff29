# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""What several verbs share: exit codes, arguments, progress bars."""
from __future__ import annotations

import argparse
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Protocol

from fourbar_ros.scene.arguments import finite, not_negative


class Verbs(Protocol):
    """What argparse gives to add verbs to, whose class it keeps to itself."""

    def add_parser(self, *args: Any, **kwargs: Any) -> argparse.ArgumentParser:
        """Return the parser of a new verb."""


BAD = 3         # exit code: the verb has done its work, but the result is not good
SCENE_HELP = 'parameter file (YAML) or name of a shipped scene, e.g. paper'
BAG_HELP = 'folder of a bag, or .mcap file'
PICTURE_HELP = 'picture to write: .png, .svg or .pdf'


def add_verb(verbs: Verbs, name: str, text: str, description: str, epilog: str = ''
             ) -> argparse.ArgumentParser:
    """Add a verb whose description and epilog keep their line breaks; return its parser."""
    return verbs.add_parser(name, help=text, description=description, epilog=epilog,
                            formatter_class=argparse.RawDescriptionHelpFormatter)


def add_pose(parser: argparse.ArgumentParser, what_at: str, is_required: bool = False) -> None:
    """Add the arguments for input, speed, acceleration and assembly mode."""
    parser.add_argument('--at', type=finite, required=is_required, metavar='INPUT', help=what_at)
    parser.add_argument('--speed', type=finite, metavar='SPEED',
                        help='input speed [rad/s], for a slide [m/s]; default: drive.speed of the '
                             'scene')
    parser.add_argument('--acceleration', type=finite, default=0.0, metavar='ACCELERATION',
                        help='input acceleration [rad/s^2], for a slide [m/s^2]; default 0')
    parser.add_argument('--mode', type=int, choices=(1, 2),
                        help='assembly mode; default: that of the scene')


def add_json(parser: argparse.ArgumentParser) -> None:
    """Add ``--json``."""
    parser.add_argument('--json', action='store_true',
                        help='print one line of JSON per bag; docs/recording.md lists the keys')


def add_node(parser: argparse.ArgumentParser) -> None:
    """Add ``--node``, for a bag with several."""
    parser.add_argument('--node', metavar='NAME', help='node, if a bag of ros2 bag record holds '
                                                       'several')


def add_tolerance(parser: argparse.ArgumentParser, when: str = '') -> None:
    """Add ``--tolerance``; ``when``: with which option it counts."""
    parser.add_argument('--tolerance', type=not_negative, default=0.0, metavar='X',
                        help=f'{when}largest absolute difference that counts as equal (default 0)')


def add_topics(parser: argparse.ArgumentParser, text: str) -> None:
    """Add ``--topics``."""
    parser.add_argument('--topics', nargs='+', metavar='TOPIC', help=text)


@contextmanager
def bar(text: str, total: int) -> Iterator[Callable[[int], None]]:
    """Show a progress bar on a terminal; gives the function to call with the amount done."""
    from rich.console import Console
    from rich.progress import Progress
    console = Console(stderr=True)
    with Progress(console=console, transient=True, disable=not console.is_terminal) as progress:
        task = progress.add_task(text, total=total)
        yield lambda done: progress.update(task, completed=done)


@contextmanager
def reading(path: str | Path, text: str) -> Iterator[Callable[[int], None]]:
    """Show how much of a bag is read; gives the function to call with the bytes read."""
    from fourbar_ros.formats.rosbag2_folder import files_of
    with bar(text, sum(file.stat().st_size for file in files_of(path))) as step:
        yield step
