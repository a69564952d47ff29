# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""What several verbs share: exit codes, arguments, progress bars."""
from __future__ import annotations

import argparse
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from itertools import groupby
import json
from math import isfinite
from pathlib import Path
import sys
from textwrap import fill
from typing import Any, Protocol

from fourbar_ros.errors import FourBarError
from fourbar_ros.scene.settings import MODES
from fourbar_ros.scene.units import of, wanted_units
from fourbar_ros.spreadsheet import CsvStyle

Json = dict[str, Any]      # values that --json prints: text, numbers, lists and records


class Verbs(Protocol):
    """The object of argparse that verbs are added to; its class is private there."""

    def add_parser(self, *args: Any, **kwargs: Any) -> argparse.ArgumentParser:
        """Return the parser of a new verb."""


class HelpFormatter(argparse.HelpFormatter):
    """Fills paragraphs of help to the terminal's width, but keeps lines of indented examples."""

    def _fill_text(self, text: str, width: int, indent: str) -> str:
        paragraphs = groupby(text.splitlines(), lambda line: line[:1] in ('', ' '))
        return '\n'.join('\n'.join(lines) if is_example else fill(' '.join(lines), width)
                         for is_example, lines in paragraphs)


BAD = 3         # exit code: the verb has done its work, but the result is not good
SCENE_HELP = 'parameter file (YAML) or name of a shipped scene, e.g. paper'
BAG_HELP = 'folder of a bag, or .mcap file'
PICTURE_HELP = 'picture to write: .png, .svg or .pdf'


def add_verb(verbs: Verbs, name: str, text: str, description: str, epilog: str = ''
             ) -> argparse.ArgumentParser:
    return verbs.add_parser(name, help=text, description=description, epilog=epilog,
                            formatter_class=HelpFormatter)


def add_scene(parser: argparse.ArgumentParser, nargs: str | None = None) -> None:
    """Add the argument SCENE; a shell completes names of scenes and files."""
    scene: Any = parser.add_argument('scene', metavar='SCENE', help=SCENE_HELP, nargs=nargs)
    scene.completer = _scenes           # an attribute that argcomplete looks for


def _scenes(prefix: str, **_: object) -> list[str]:
    from argcomplete.completers import FilesCompleter
    from fourbar_ros.scene.files import shipped
    return [*shipped(), *FilesCompleter(('yaml', 'yml'))(prefix)]


def add_pose(parser: argparse.ArgumentParser, help_of_at: str) -> None:
    parser.add_argument('--at', type=of('rad', 'm'), metavar='INPUT',
                        help=help_of_at + '; or with a unit: 60deg, 1.2rad, 50mm')
    add_rates(parser)


def add_rates(parser: argparse.ArgumentParser) -> None:
    parser.add_argument('--speed', type=of('rad/s', 'm/s'), metavar='SPEED',
                        help='input speed [rad/s], for a slide [m/s], or with a unit: 300rpm; '
                             'default: drive.speed of the scene')
    parser.add_argument('--acceleration', type=of('rad/s^2', 'm/s^2'),
                        default=0.0, metavar='ACCELERATION',
                        help='input acceleration [rad/s^2], for a slide [m/s^2]; default 0')
    parser.add_argument('--mode', type=assembly_mode, metavar='MODE',
                        help='assembly mode: 1 (crossed) or 2 (open); default: that of the '
                             'scene. Modes of a machine are dyads.NAME.mode of its scene')


def assembly_mode(text: str) -> int:
    """Return the assembly mode for a number or a name, '1' or 'crossed': an argument's type."""
    if text in MODES:
        return MODES[text]
    if not text.isdecimal() or not int(text):
        raise argparse.ArgumentTypeError(f'{text!r}: must be 1 or crossed, 2 or open')
    return int(text)                # whether a mechanism has it: a machine has more than two


def add_json(parser: argparse.ArgumentParser) -> None:
    parser.add_argument('--json', action='store_true',
                        help='print one line of JSON per bag; docs/recording.md lists the keys')


def add_node(parser: argparse.ArgumentParser) -> None:
    parser.add_argument('--node', metavar='NAME',
                        help='node, if a bag of ros2 bag record holds several')


def add_tolerance(parser: argparse.ArgumentParser) -> None:
    parser.add_argument('--tolerance', type=of(least=0.0), default=0.0, metavar='X',
                        help='largest absolute difference that counts as equal (default 0)')


def add_topics(parser: argparse.ArgumentParser, text: str) -> None:
    parser.add_argument('--topics', nargs='+', metavar='TOPIC', help=text)


def add_units(parser: argparse.ArgumentParser, text: str) -> None:
    """Add ``--units``, a {SI unit: unit to show}."""
    parser.add_argument('--units', type=wanted_units, default={}, metavar='UNIT,...', help=text)


def add_csv(parser: argparse.ArgumentParser, units_help: str) -> None:
    """Add ``--units``, ``--digits`` and ``--excel``; :func:`csv_style` reads the last two."""
    add_units(parser, units_help)
    parser.add_argument('--digits', type=int, choices=range(1, 18), metavar='N',
                        help='significant digits of the numbers in CSV (default: all)')
    parser.add_argument('--excel', action='store_true',
                        help='CSV for Excel and others where the decimal sign is a comma: ; '
                             'between cells, which are empty for NaN')


def csv_style(arguments: argparse.Namespace) -> CsvStyle:
    return CsvStyle(arguments.digits, arguments.excel)


def json_line(record: Json) -> str:
    """Return a dict as one line of JSON; infinities and NaN become text: "inf", "nan"."""
    return json.dumps(_plain(record), allow_nan=False)


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    return str(value) if isinstance(value, float) and not isfinite(value) else value


@contextmanager
def bar(text: str, total: float) -> Iterator[Callable[[float], None]]:
    """Show a progress bar on a terminal; give the function to call with the amount done."""
    from rich.console import Console
    from rich.progress import Progress
    console = Console(stderr=True)
    with Progress(console=console, transient=True, disable=not console.is_terminal) as progress:
        task = progress.add_task(text, total=total)
        yield lambda done: progress.update(task, completed=done)


@contextmanager
def reading(path: str | Path, text: str) -> Iterator[Callable[[int], None]]:
    """Show how much of a bag is read; give the function to call with the bytes read."""
    from fourbar_ros.bag.metadata import files_of
    with bar(text, sum(file.stat().st_size for file in files_of(Path(path)))) as step:
        yield step


def add_output(parser: argparse.ArgumentParser, *names: str, suffix: str = '', **options: Any
               ) -> None:
    """
    Add an argument that names a file to write, and ``--force``, without which none is overwritten.

    A name without a suffix gets ``suffix``.
    """
    written = parser.get_default('written')
    if written is None:
        parser.add_argument('--force', action='store_true', help='overwrite files that exist')

    def path_of(text: str) -> Path:
        return Path(text if Path(text).suffix or text == '-' else text + suffix)
    action = parser.add_argument(*names, type=path_of, **options)
    parser.set_defaults(written=(*(written or ()), action.dest))


def add_picture(parser: argparse.ArgumentParser) -> None:
    add_output(parser, '-o', '--out', metavar='FILE', required=True, suffix='.png',
               help=PICTURE_HELP)
    parser.add_argument('--width', type=of('m', above=0.0), metavar='WIDTH',
                        help='width of the picture [m], as 88mm for a column of a journal')
    parser.add_argument('--title', metavar='TEXT',
                        help="instead of the usual title; '': none")


def refuse_overwriting(paths: Iterable[Path], force: bool) -> None:
    """Raise FileExists for a file that exists, unless ``--force`` is given."""
    for path in paths:
        if path.is_file() and not force:
            raise FileExists(f'{path}: exists already; --force overwrites it')


class FileExists(FourBarError):
    """A file that a verb is to write exists; the message names it."""


def write_or_print(text: str, path: Path | None) -> None:
    """Write a text to a file and print its path; without a path print the text itself."""
    if path is None:
        sys.stdout.write(text)
    else:
        path.write_text(text, encoding='utf-8')
        print(path)
