# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The address of a page: it holds what was changed, so that a link shows the same."""
from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple
from urllib.parse import urlencode

from fourbar_ros.errors import FourBarError, InvalidParameter
from fourbar_ros.numerics.given import number
from fourbar_ros.scene import files, parameters
from fourbar_ros.scene.settings import ParameterValues

AT, ACCELERATION, SCENE = 'at', 'acceleration', 'scene'


class BadLink(FourBarError, ValueError):
    """The address of a page names something that does not exist; the message says what."""


class PageAddress(NamedTuple):
    """What an address asks for; it names shipped scenes and parameters, never a file."""

    title: str                      # of the scene
    first: ParameterValues          # the scene's own
    values: ParameterValues         # with those that the link changes
    at: float | None = None         # the input in the unit of the page; None: not given
    acceleration: float = 0.0       # of the input


def rounded(at: float) -> float:
    """Return an input as the page and its address have it: with nine digits."""
    return float(f'{at:.9g}')


def address(link: PageAddress) -> str:
    """Return the query of a state: the scene by name, the input, and each changed parameter."""
    changed = {name: repr(value) if isinstance(value, float) else value
               for name, value in link.values.items()
               if value != link.first.get(name, value) and value == value}
    return urlencode({SCENE: link.title, AT: f'{rounded(link.at or 0.0):.9g}', **changed,
                      **({ACCELERATION: f'{link.acceleration:g}'} if link.acceleration else {})})


def read(query: Mapping[str, str], title: str, values: ParameterValues) -> PageAddress:
    """
    Return the :class:`PageAddress` of a query to a page that serves a scene.

    BadLink if it is to another scene, unless that comes with this software; if it names an unknown
    parameter; or if input or acceleration is no number.
    """
    first, scene = dict(values), query.get(SCENE, title)
    if scene != title:
        shipped = {file.stem: file for file in files.folder().glob('*.yaml')}
        if scene not in shipped:
            raise BadLink(f'the link is to the scene {scene}, this page shows {title}: '
                          f'fourbar live {scene}')
        first = parameters.check(files.read_values(shipped[scene]))
    numbers: dict[str, float] = {}
    changed: dict[str, Any] = {}
    for name, text in query.items():
        value = files.parse(text)
        if name in (AT, ACCELERATION):
            try:
                numbers[name] = number(name, value)
            except InvalidParameter as error:
                raise BadLink(f'the link has {error}') from None
        elif name != SCENE:
            if parameters.find_parameter(name) is None:
                raise BadLink(f'the link has the unknown parameter {name}')
            changed[name] = value
    return PageAddress(scene, first, {**first, **changed}, numbers.get(AT),
                       numbers.get(ACCELERATION, 0.0))
