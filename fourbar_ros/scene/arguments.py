# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Parse command lines with errors that suggest the nearest word."""
from __future__ import annotations

import argparse
import re
import sys
from typing import Any, NoReturn

from fourbar_ros.errors import nearest

INVALID_CHOICE = re.compile(r"invalid choice: '?(.*?)'? \(choose from (.*)\)", re.DOTALL)
NEGATIVE = re.compile(r'-(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?([A-Za-z][\w/^]*)?$')


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
        known = [option for action in self._actions for option in action.option_strings]
        return f'{word!r} is not understood' + (nearest(word.split('=')[0], known)
                                                if word.startswith('--') else '')


def positive_integer(text: str) -> int:
    if not text.isdecimal() or not int(text):
        raise argparse.ArgumentTypeError(f'{text!r}: must be a positive integer')
    return int(text)
