# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Parse command lines with errors that suggest the nearest word; check a node's arguments."""
from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from math import isfinite
import re
import sys
from typing import Any, NoReturn

from fourbar_ros.errors import FourBarError, nearest
from fourbar_ros.scene.files import NODE, NotForNode, read_values

INVALID_CHOICE = re.compile(r"invalid choice: '?(.*?)'? \(choose from (.*)\)", re.DOTALL)
NEGATIVE = re.compile(r'-(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?([A-Za-z][\w/^]*)?$')
NODE_NAME = re.compile(r'([A-Za-z_]\w*/)*[A-Za-z_]\w*')
RENAMES = re.compile(r'__(node|name):=')
NODE_USAGE = 'fourbar_node --ros-args --params-file SCENE'
NODE_HELP = """\
usage: fourbar_node [NODE ...] --ros-args --params-file SCENE
                    [-p NAME:=VALUE ...] [-r FROM:=TO ...]

The node of one linkage. SCENE is a parameter file, e.g. config/paper.yaml; fourbar scene check
SCENE explains it, docs/reference.md lists all parameters. Several linkages of one robot run in one
process: NODE ... are their names, as in the file. Exit codes: 0 stopped by a signal; 2 the scene
is invalid.
"""


class Parser(argparse.ArgumentParser):
    """An argument parser that suggests the nearest word in its errors, also within verbs."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        # argparse would take -1e-9 and -5mm for options
        self._negative_number_matcher = NEGATIVE
        self._typed: list[str] = []              # the words of the command line

    def error(self, message: str) -> NoReturn:
        """Print the error in one line that names the help; exit with code 2."""
        if match := INVALID_CHOICE.search(message):
            known = re.findall(r"[^\s,']+", match[2])
            message = (f'{message[:match.start()]}{match[1]!r} is unknown'
                       f'{nearest(match[1], known)}')
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
        if rest and ' ' in self.prog:
            self.error(self._not_understood(rest[0]))
        return namespace, rest

    def _not_understood(self, word: str) -> str:
        """Return the error for a word, with the nearest option."""
        known = [option for action in self._actions for option in action.option_strings]
        return f'{word!r} is not understood' + (nearest(word.split('=')[0], known)
                                                if word.startswith('--') else '')


def positive(text: str) -> float:
    """Return a positive number; for ``type=`` of an argument."""
    return _number(text, 'must be a positive number', lambda value: value > 0.0)


def not_negative(text: str) -> float:
    """Return a number that is not negative; for ``type=`` of an argument."""
    return _number(text, 'must be a number that is not negative', lambda value: value >= 0.0)


def positive_integer(text: str) -> int:
    """Return a positive integer; for ``type=`` of an argument."""
    if not text.isdecimal() or not int(text):
        raise argparse.ArgumentTypeError(f'{text!r}: must be a positive integer')
    return int(text)


def finite(text: str) -> float:
    """Return a finite number; for ``type=`` of an argument."""
    return _number(text, 'must be a finite number')


def _number(text: str, must: str, is_allowed: Callable[[float], bool] = isfinite) -> float:
    """Return a finite number that is allowed; ``must`` is the error of any other text."""
    try:
        value = float(text)
    except ValueError:
        value = float('nan')
    if not (isfinite(value) and is_allowed(value)):
        raise argparse.ArgumentTypeError(f'{text!r} {must}')
    return value


class UsageError(FourBarError):
    """The node was called with invalid arguments; the message gives the right ones."""


def check_node_arguments(arguments: list[str]) -> None:
    """
    Refuse arguments that ROS would ignore, and scene files that it would read differently.

    ``arguments``: the node's command line, without its own name. Raises UsageError for an argument
    outside of ``--ros-args`` and for two nodes of one name. Raises SceneError for a parameter file
    that cannot be read or gives a key twice, and if no file has anything for a node.
    """
    names = [full_name(arguments, name) for name in node_names(arguments)]
    _, inside = _parts(arguments)
    files = [value for option, value in zip(inside, inside[1:]) if option == '--params-file']
    for name in names:
        if names.count(name) > 1:
            raise UsageError(f'{name}: two nodes of one name')
        errors = []
        for file in files:
            try:
                read_values(file, name)
            except NotForNode as error:         # another file may have everything
                errors.append(error)
        if files and len(errors) == len(files):
            raise errors[0]


def node_names(arguments: list[str]) -> list[str]:
    """
    Return the names of the nodes that a command line asks for, ``fourbar`` if it names none.

    A name may begin with a namespace, ``left/boom``. UsageError for anything else.
    """
    outside, inside = _parts(arguments)
    for word in outside:
        if '--params-file' not in inside or not NODE_NAME.fullmatch(word):
            usage = NODE_USAGE.replace('SCENE', word) if word[:1] != '-' else NODE_USAGE
            raise UsageError(f'{word}: not understood; type  {usage}')
    if outside and any(RENAMES.match(argument) for argument in inside):
        raise UsageError('__node:= would rename every node: name them before --ros-args alone')
    return outside or [NODE[1:]]


def _parts(arguments: Sequence[str]) -> tuple[list[str], list[str]]:
    """Return (arguments outside, inside) of ``--ros-args ... --``, which ROS reads."""
    outside: list[str] = []
    inside: list[str] = []
    is_inside = False
    for argument in arguments:
        if argument in ('--ros-args', '--'):
            is_inside = argument == '--ros-args'
        else:
            (inside if is_inside else outside).append(argument)
    return outside, inside


def full_name(arguments: Sequence[str], name: str) -> str:
    """
    Return the full name of a node after the remappings (-r) of its command line.

    With ``-r __ns:=/robot`` the node ``left/boom`` is ``/robot/left/boom``.
    """
    _, inside = _parts(arguments)
    *own_namespace, name = name.split('/')
    namespace, original = '', name
    for option, value in zip(inside, inside[1:]):
        match = re.fullmatch(r'(?:(\w+):)?__(node|name|ns):=(.*)', value)
        if option in ('-r', '--remap') and match and match[1] in (None, original):
            if match[2] == 'ns':
                namespace = match[3].strip('/')
            else:
                name = match[3]
    return '/' + '/'.join([*filter(None, [namespace]), *own_namespace, name])
