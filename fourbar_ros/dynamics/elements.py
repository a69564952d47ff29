# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Springs and dampers between any two points or any two links of a mechanism."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Union

from fourbar_ros.errors import InvalidParameter
from fourbar_ros.numerics.given import number

GROUND = 'ground'


@dataclass(frozen=True)
class Attachment:
    """A point of a link or of the ground: along it from its first joint, and to its left [m]."""

    link: str = GROUND
    along: float = 0.0
    across: float = 0.0

    def __post_init__(self) -> None:
        _convert(self, 'along', 'across')


@dataclass(frozen=True)
class Spring:
    """
    Linear spring and damper between two points.

    Parameters
    ----------
    first, second : Attachment
        On different links.
    stiffness : float
        [N/m], zero or more.
    free_length : float
        Length at which the spring exerts no force [m].
    damping : float
        [N s/m], zero or more.

    """

    first: Attachment
    second: Attachment
    stiffness: float = 0.0
    free_length: float = 0.0
    damping: float = 0.0

    def __post_init__(self) -> None:
        _convert(self, 'free_length')
        _convert_not_negative(self, 'stiffness', 'damping')
        _require_two_links(self)

    @property
    def links(self) -> tuple[str, str]:
        """Return the names of the two links it joins."""
        return self.first.link, self.second.link


@dataclass(frozen=True)
class TorsionSpring:
    """
    Torsion spring and damper between two links, or a link and the ground.

    Parameters
    ----------
    first, second : str
        Links; the angle is that of the second relative to the first.
    stiffness : float
        [N m/rad], zero or more.
    free_angle : float
        Angle at which the spring exerts no moment [rad]. The deflection counts within half a turn.
    damping : float
        [N m s/rad], zero or more.

    """

    first: str
    second: str
    stiffness: float = 0.0
    free_angle: float = 0.0
    damping: float = 0.0

    def __post_init__(self) -> None:
        _convert(self, 'free_angle')
        _convert_not_negative(self, 'stiffness', 'damping')
        _require_two_links(self)

    @property
    def links(self) -> tuple[str, str]:
        """Return the names of the two links it joins."""
        return self.first, self.second


Element = Union[Spring, TorsionSpring]


def _convert(element: object, *names: str) -> None:
    for name in names:
        object.__setattr__(element, name, number(name, getattr(element, name)))


def _convert_not_negative(element: object, *names: str) -> None:
    for name in names:
        value = number(name, getattr(element, name), 'must be a finite number, zero or more',
                       least=0.0)
        object.__setattr__(element, name, value)


def _require_two_links(element: Element) -> None:
    first, second = element.links
    if first == second:
        raise InvalidParameter('second', second, 'must be on another link than the first')
