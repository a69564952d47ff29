# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The state of a page in its address: what a link carries, and nothing that reads files."""
from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple
from urllib.parse import urlencode

from fourbar_ros.errors import FourBarError
from fourbar_ros.scene import files, parameters

AT, ACCELERATION, SCENE = 'at', 'acceleration', 'scene'


class BadLink(FourBarError, ValueError):
    """The address of a page names something that does not exist; the message says what."""


class Link(NamedTuple):
    """
    What an address asks for.

    Name of the scene, its own parameters and those of the link, input in the unit of the page
    (None: not given) and its acceleration.
    """

    title: str
    first: dict[str, Any]
    values: dict[str, Any]
    at: float | None
    acceleration: float


def rounded(at: float) -> float:
    """Return an input as the page and its address have it: with nine digits."""
    return float(f'{at:.9g}')


def address(title: str, first: Mapping[str, Any], values: Mapping[str, Any], at: float,
            acceleration: float) -> str:
    """Return the query of the state: the scene by name, the input, and each changed parameter."""
    changed = {name: repr(value) if isinstance(value, float) else value
               for name, value in values.items()
               if value != first.get(name, value) and value == value}
    return urlencode({SCENE: title, AT: f'{rounded(at):.9g}', **changed,
                      **({ACCELERATION: f'{acceleration:g}'} if acceleration else {})})


def read(query: Mapping[str, str], title: str, values: Mapping[str, Any]) -> Link:
    """
    Return the :class:`Link` of a query to a page that serves a scene.

    Raises
    ------
    BadLink
        It is a link to another scene that does not come with this software, or names an unknown
        parameter, or a value is no number.

    """
    first, scene = dict(values), query.get(SCENE, title)
    if scene != title:
        shipped = {file.stem: file for file in files.folder().glob('*.yaml')}
        if scene not in shipped:
            raise BadLink(f'the link is to the scene {scene}, this page shows {title}: '
                          f'fourbar live {scene}')
        first = parameters.check(files.read_values(shipped[scene]))
    found, at, acceleration = dict(first), None, 0.0
    for name, text in query.items():
        if name == SCENE:
            continue
        value = files.parse(text)
        if name in (AT, ACCELERATION):
            if isinstance(value, bool) or not isinstance(value, (int, float)):
                raise BadLink(f'the link has {name}={text}, which is no number')
            at, acceleration = (float(value), acceleration) if name == AT else (at, float(value))
        elif parameters.find(name) is None:
            raise BadLink(f'the link has the unknown parameter {name}')
        else:
            found[name] = value
    return Link(scene, first, found, at, acceleration)
