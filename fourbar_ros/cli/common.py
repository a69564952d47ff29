# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""What several verbs share: their parser, exit codes, arguments, progress bars."""
import argparse
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from itertools import groupby
import json
from math import isfinite
from pathlib import Path
import re
import sys
from textwrap import fill
from typing import Any, NoReturn

from fourbar_ros import errors
from fourbar_ros.scene.settings import MODES
from fourbar_ros.scene.units import of, wanted_units
from fourbar_ros.spreadsheet import STDOUT

Verbs = Any     # what add_subparsers() of argparse returns: add_parser() adds a verb to it


INVALID_CHOICE = re.compile(r"invalid choice: '?(.*?)'? \(choose from (.*)\)", re.DOTALL)
NEGATIVE = re.compile(r'-(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?([A-Za-zµ°Ω][\w/^*·°²³]*)?(,\S*)?$')


class Parser(argparse.ArgumentParser):
    """An argument parser that suggests the nearest word in its errors, also within verbs."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        # argparse would take -1e-9, -5mm and -1,0,0 for options
        self._negative_number_matcher = NEGATIVE
        self._typed: list[str] = []              # the words of the command line

    def error(self, message: str) -> NoReturn:
        """Print the error in one line that names the help; exit with code 2."""
        if match := INVALID_CHOICE.search(message):
            known = re.findall(r"[^\s,']+", match[2])
            message = (f'{message[:match.start()]}{match[1]!r} is unknown'
                       f'{errors.nearest(match[1], known)}')
        # a mistyped option is named before an argument that it seems to lack
        unknown = [option for option in self._typed if option.startswith('--')
                   and option.split('=')[0] not in self._option_string_actions]
        if message.startswith('the following arguments are required') and unknown:
            message = self._not_understood(unknown[0])
        message = ' '.join(message.split())
        self.exit(2, f'{self.prog}: {message} ({self.prog} --help)\n')

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> Any:
        """Parse as the base class does, but refuse options that a verb does not know."""
        self._typed = [*(sys.argv[1:] if args is None else args)]
        namespace, rest = super().parse_known_args(args, namespace)
        for action in self._actions:        # table paper -o x.csv f41: words behind options
            if (action.nargs in ('*', '+') and not action.option_strings
                    and not any(word.startswith('-') for word in rest)):
                getattr(namespace, action.dest).extend(rest)
                rest = []
        if rest and ' ' in self.prog:
            self.error(self._not_understood(next(
                (word for word in rest if word.startswith('-')), rest[0])))
        return namespace, rest

    def _not_understood(self, word: str) -> str:
        taken = [str(action.metavar) for action in self._actions if not action.option_strings]
        if not word.startswith('-'):
            more = '; fourbar live draws two, fourbar study compares many'
            return (f'{word!r} is one word too many: this verb takes '
                    f'{" ".join(taken) or "options only"}{more * (taken == ["SCENE"])}')
        known = [option for action in self._actions for option in action.option_strings]
        return f'{word!r} is not understood' + (errors.nearest(word.split('=')[0], known)
                                                if word.startswith('--') else '')


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
    parser: argparse.ArgumentParser = verbs.add_parser(
        name, help=text, description=description, epilog=epilog, formatter_class=HelpFormatter)
    return parser


def add_scene(parser: argparse.ArgumentParser, nargs: str | None = None) -> None:
    """Add the argument SCENE; a shell completes names of scenes and files."""
    def known_scenes(prefix: str, **_: object) -> list[str]:
        from argcomplete.completers import FilesCompleter
        from fourbar_ros.scene.files import shipped
        return [*shipped(), *FilesCompleter(('yaml', 'yml'))(prefix)]

    scene: Any = parser.add_argument('scene', metavar='SCENE', help=SCENE_HELP, nargs=nargs)
    scene.completer = known_scenes      # an attribute that argcomplete looks for


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


def positive_integer(text: str) -> int:
    if not text.isdecimal() or not int(text):
        raise argparse.ArgumentTypeError(f'{text!r}: must be a positive integer')
    return int(text)


def add_json(parser: argparse.ArgumentParser) -> None:
    parser.add_argument('--json', action='store_true',
                        help='print one line of JSON per bag; docs/recording.md lists the keys')


def add_node(parser: argparse.ArgumentParser) -> None:
    parser.add_argument('--node', metavar='NAME',
                        help='node, if a bag of ros2 bag record holds several')


def add_tolerance(parser: argparse.ArgumentParser) -> None:
    parser.add_argument('--tolerance', type=of(least=0.0), default=0.0, metavar='X',
                        help='largest absolute difference that counts as equal (default 0)')


def add_topics(parser: argparse._ActionsContainer, text: str) -> None:
    parser.add_argument('--topics', nargs='+', metavar='TOPIC', help=text)


def add_units(parser: argparse.ArgumentParser, text: str) -> None:
    """Add ``--units``, a {SI unit: unit to show}."""
    parser.add_argument('--units', type=wanted_units, default={}, metavar='UNIT,...', help=text)


def add_csv(parser: argparse.ArgumentParser, units_help: str) -> None:
    """Add ``--units``, and the fields of a CsvStyle: ``--digits`` and ``--excel``."""
    add_units(parser, units_help)
    parser.add_argument('--digits', type=int, choices=range(1, 18), metavar='N',
                        help='significant digits of the numbers in CSV (default: all)')
    parser.add_argument('--excel', action='store_true',
                        help='CSV for Excel and others where the decimal sign is a comma: ; '
                             'between cells, which are empty for NaN')


def json_line(record: dict[str, Any]) -> str:
    """Return a dict as one line of JSON; infinities and NaN become text: "inf", "nan"."""
    def plain(value: Any) -> Any:
        if isinstance(value, dict):
            return {key: plain(item) for key, item in value.items()}
        if isinstance(value, (list, tuple)):
            return [plain(item) for item in value]
        return str(value) if isinstance(value, float) and not isfinite(value) else value

    return json.dumps(plain(record), allow_nan=False)


@contextmanager
def bar(text: str, total: float, is_asked: bool = True) -> Iterator[Callable[[float], None]]:
    """Show a progress bar on a terminal; give the function to call with the amount done."""
    from rich.console import Console
    from rich.progress import Progress
    console = Console(stderr=True)
    with Progress(console=console, transient=True,
                  disable=not (is_asked and console.is_terminal)) as progress:
        task = progress.add_task(text, total=total)
        yield lambda done: progress.update(task, completed=done)


@contextmanager
def reading(path: str | Path, text: str) -> Iterator[Callable[[int], None]]:
    """Show how much of a bag is read; give the function to call with the bytes read."""
    from fourbar_ros.bag.metadata import files_of
    with bar(text, sum(file.stat().st_size for file in files_of(Path(path)))) as step:
        yield step


def add_output(parser: argparse.ArgumentParser, *names: str, suffix: str = '',
               can_print: bool = False, **options: Any) -> None:
    """
    Add an argument that names a file to write, and ``--force``, without which none is overwritten.

    A name without a suffix gets ``suffix``. ``can_print``: - is standard output.
    """
    written = parser.get_default('written')
    if written is None:
        parser.add_argument('--force', action='store_true', help='overwrite files that exist')

    def path_of(text: str) -> Path:
        if text[-1:] in './' or text == str(STDOUT) and not can_print:
            raise argparse.ArgumentTypeError(f'{text!r} names no file')
        return Path(text if Path(text).suffix or text == str(STDOUT) else text + suffix)
    action = parser.add_argument(*names, type=path_of, **options)
    parser.set_defaults(written=(*(written or ()), action.dest))


def add_picture(parser: argparse.ArgumentParser) -> None:
    add_output(parser, '-o', '--out', metavar='FILE', required=True, suffix='.png',
               help=PICTURE_HELP)
    parser.add_argument('--width', type=of('m', above=0.0), metavar='WIDTH',
                        help='width of the picture [m], as 88mm for a column of a journal')
    parser.add_argument('--title', metavar='TEXT',
                        help='instead of the usual title; "": none')


def refuse_overwriting(paths: Iterable[Path], force: bool) -> None:
    """Raise FourBarError for a file that exists, unless ``--force`` is given."""
    for path in paths:
        if path.is_file() and not force:
            raise errors.FourBarError(f'{path}: exists already; --force overwrites it')


def write_or_print(text: str, path: Path | None) -> None:
    """Write a text to a file and print its path; without a path print the text itself."""
    if path is None:
        sys.stdout.write(text)
    else:
        path.write_text(text, encoding='utf-8')
        print(path)
