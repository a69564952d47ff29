# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The address of a page: it holds what was changed, so that a link shows the same."""
from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple
from urllib.parse import urlencode

from fourbar_ros.errors import InvalidParameter
from fourbar_ros.numerics.arguments import finite
from fourbar_ros.scene import files, parameters
from fourbar_ros.scene.settings import ParameterValues

AT, ACCELERATION, SCENE = 'at', 'acceleration', 'scene'


class PageAddress(NamedTuple):
    """What an address asks for; it names shipped scenes and parameters, never a file."""

    title: str                      # of the scene
    first: ParameterValues          # the scene's own
    values: ParameterValues         # with those that the link changes
    input: float | None = None      # in the unit of the page; None: not in the address
    acceleration: float = 0.0       # of the input


def rounded(value: float) -> float:
    """Return an input as the page and its address have it: with nine digits."""
    return float(f'{value:.9g}')


def address(link: PageAddress) -> str:
    """Return the query of a state: the scene by name, the input, and each changed parameter."""
    changed = {name: repr(value) if isinstance(value, float) else value
               for name, value in link.values.items()
               if value != link.first.get(name, value) and value == value}
    if link.acceleration != 0.0:
        changed[ACCELERATION] = f'{link.acceleration:g}'
    return urlencode({SCENE: link.title, AT: f'{rounded(link.input or 0.0):.9g}', **changed})


def read(query: Mapping[str, str], title: str, values: ParameterValues) -> PageAddress:
    """
    Return the :class:`PageAddress` of a query to a page that serves a scene.

    InvalidParameter if it is to another scene, unless that comes with this software, or if input
    or acceleration is no number. Parameters are checked with the scene that is made of them.
    """
    scene, shipped = query.get(SCENE, title), files.shipped()
    if scene != title:
        if scene not in shipped:
            raise InvalidParameter(SCENE, scene, f'this page shows {title}: fourbar live {scene}')
        values = parameters.check(files.read_values(shipped[scene]))
    changes = {name: files.parse(text) for name, text in query.items() if name != SCENE}
    drive = {name: finite(name, changes.pop(name)) for name in (AT, ACCELERATION)
             if name in changes}
    return PageAddress(scene, values, {**values, **changes}, drive.get(AT),
                       drive.get(ACCELERATION, 0.0))
