# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Which value was asked for last, where rcl keeps another one.

rcl holds a value of every type for a parameter and prefers a bool to an integer, that to a double
and that to a text, whatever came last: ``-p drive.speed:=3.5`` is ignored where a file says
``25``. No ROS is imported here.
"""
from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

from fourbar_ros.scene.files import flatten, is_for, parse, sections


class Asked(NamedTuple):
    """A value and where it was asked for."""

    value: Any
    where: str


def asked(arguments: list[str], node: str) -> dict[str, Asked]:
    """
    Return what a command line asks of the parameters of a node, by name, in ROS's order.

    Parameters
    ----------
    arguments : list of str
        Those of the command line; only what stands behind ``--ros-args`` counts.
    node : str
        Full name of the node.

    Raises
    ------
    SceneError
        A file cannot be read.

    """
    by_key: dict[str, dict[str, Asked]] = {}
    for option, argument in _of_ros(arguments):
        if option == '--params-file':
            for key, tree in sections(argument).items():
                for name, value in flatten(tree, argument).items():
                    by_key.setdefault(key, {})[name] = Asked(value, argument)
        elif option in ('-p', '--param') and ':=' in argument:
            target, text = argument.split(':=', 1)
            key, _, name = target.rpartition(':')
            key = key if key.startswith('/') else f'/{key or "**"}'
            by_key.setdefault(key, {})[name] = Asked(parse(text), f'-p {argument}')
    mine = [key for key in by_key if is_for(key, node)]
    found: dict[str, Asked] = {}
    for key in sorted(mine, key=lambda key: '*' not in key):         # the node's own name last
        found |= by_key[key]
    return found


def is_ignored(wanted: Any, kept: Any) -> bool:
    """Return whether rcl has kept a value of another type than the one that was asked for last."""
    return None not in (wanted, kept) and _kind(wanted) != _kind(kept)


def _kind(value: Any) -> Any:
    if isinstance(value, bool | int | float | str):
        return type(value)
    return 'list', *(type(item) for item in list(value)[:1])


def _of_ros(arguments: list[str]) -> Iterator[tuple[str, str]]:
    """Yield (option, argument) of all that is meant for ROS."""
    is_inside = False
    for option, argument in zip(arguments, [*arguments[1:], '']):
        if option in ('--ros-args', '--'):
            is_inside = option == '--ros-args'
        elif is_inside:
            yield option, argument
