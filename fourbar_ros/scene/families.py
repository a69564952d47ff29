# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Parameters that come in sets: of each link, each point, each dyad of a machine. Imports no ROS.

In the tables NAME is free: points.NAME.link and so on.
"""
from __future__ import annotations

from collections.abc import Iterable
from functools import lru_cache
from math import nan
import re
from typing import Any, NamedTuple

from fourbar_ros.mechanisms.machine.description import DIMENSIONS
from fourbar_ros.scene import of_dynamics
from fourbar_ros.scene.parameter import Parameter, REQUIRED
from fourbar_ros.scene.topics import wrench_topic

NAME = 'NAME'
GROUND_TOO = 'of the ground x and y'


def body(link: str, first_joint: str) -> tuple[Parameter, ...]:
    """Return the parameters of the body of a link."""
    name = f'bodies.{link}.'
    return (
        Parameter(name + 'mass', 'double', nan, 'kg', f'mass of the {link}', low=0.0),
        Parameter(name + 'inertia', 'double', nan, 'kg m^2',
                  f'moment of inertia of the {link} about its centre of gravity; required with a '
                  'mass', low=0.0),
        Parameter(name + 'cg_along', 'double', nan, 'm',
                  f'centre of gravity of the {link}: distance from {first_joint} along the link; '
                  'default: half its length (0 for a link without a length)'),
        Parameter(name + 'cg_across', 'double', 0.0, 'm',
                  f'centre of gravity of the {link}: distance to the left of the line of the '
                  'link'),
    )


def external(link: str, first_joint: str) -> tuple[Parameter, ...]:
    """Return the parameters of what acts on a link from outside."""
    name = f'external.{link}.'
    return (
        Parameter(name + 'force_x', 'double', 0.0, 'N', f'external force on the {link}: x '
                                                        'component, constant'),
        Parameter(name + 'force_y', 'double', 0.0, 'N', f'external force on the {link}: y '
                                                        'component, constant'),
        Parameter(name + 'along', 'double', 0.0, 'm',
                  f'point where the external force acts on the {link}: distance from '
                  f'{first_joint} along the link'),
        Parameter(name + 'across', 'double', 0.0, 'm',
                  f'point where the external force acts on the {link}: distance to the left of '
                  'the line of the link'),
        Parameter(name + 'couple', 'double', 0.0, 'N m', f'external couple on the {link}, '
                                                         'constant, counter-clockwise positive'),
        Parameter(name + 'from_topic', 'bool', False, '',
                  f'take the external force and couple on the {link} from the topic '
                  f'{wrench_topic(link).topic} instead of force_x, force_y and couple',
                  live=False),
    )


def _table(*parameters: Parameter) -> dict[str, Parameter]:
    return {parameter.name: parameter for parameter in parameters}


def _having(dimension: str) -> str:
    """Return the kinds of dyads that have a dimension, as text."""
    return ', '.join(kind for kind, names in DIMENSIONS.items() if dimension in names)


def _place(name: str, which: str) -> tuple[Parameter, ...]:
    return (
        Parameter(f'{name}.link', 'string', REQUIRED, '',
                  f'link on which dyad NAME hangs with its {which} link: ground, the driven link '
                  '(crank or slider), or a link of a dyad before it', live=False),
        Parameter(f'{name}.along', 'double', 0.0, 'm',
                  f'the point of that link: distance from its first joint along it; {GROUND_TOO}'),
        Parameter(f'{name}.across', 'double', 0.0, 'm',
                  'the point of that link: distance to the left of its line'),
    )


POINT = _table(
    Parameter('points.NAME.link', 'string', 'coupler', '',
              'link to which the point NAME is fixed'),
    Parameter('points.NAME.along', 'double', 0.0, 'm', 'position of the point NAME: distance '
              'from the first joint of its link along the link'),
    Parameter('points.NAME.across', 'double', 0.0, 'm',
              'position of the point NAME: distance to the left of the line of its link'),
)
DYAD = _table(
    Parameter('dyads.NAME.kind', 'string', REQUIRED, '',
              'kind of dyad NAME by its joints, R a pin, P a slide: outer, inner, outer; '
              'see docs/machines.md', choices=tuple(DIMENSIONS), live=False),
    *_place('dyads.NAME.first', 'first'), *_place('dyads.NAME.second', 'second'),
    Parameter('dyads.NAME.links', 'strings', REQUIRED, '',
              'names of the two links of dyad NAME, the one at `first` first', live=False),
    Parameter('dyads.NAME.length_1', 'double', nan, 'm',
              f'length of the first link ({_having("length_1")})', positive=True),
    Parameter('dyads.NAME.length_2', 'double', nan, 'm',
              f'length of the second link ({_having("length_2")})', positive=True),
    Parameter('dyads.NAME.offset', 'double', nan, 'm',
              "distance of the path of the block's pin from the pivot of the bar, to its left "
              f'({_having("offset")}); default: 0'),
    Parameter('dyads.NAME.direction_1', 'double', nan, 'rad',
              'direction of the line along which the first link slides, from that of the link at '
              f'`first` ({_having("direction_1")})'),
    Parameter('dyads.NAME.direction_2', 'double', nan, 'rad',
              'direction of the line along which the second link slides, from that of the link at '
              f'`second` ({_having("direction_2")})'),
    Parameter('dyads.NAME.slot', 'double', nan, 'rad',
              'direction of the slot of the yoke, from that in which the yoke slides '
              f'({_having("slot")})'),
    Parameter('dyads.NAME.mode', 'integer', 2, '',
              'assembly mode of dyad NAME, see docs/machines.md', 1, 2),
)
BODY = _table(*body(NAME, 'its first joint'))
EXTERNAL = _table(*external(NAME, 'its first joint'))
# Groups of which a scene may have any number.
NAMED = {'points': POINT, 'springs': of_dynamics.SPRING, 'torsion_springs': of_dynamics.TORSION,
         'dyads': DYAD, 'bodies': BODY, 'external': EXTERNAL}
OF_MACHINES = 'dyads', 'bodies', 'external'      # families whose names only machines choose
_MEMBER = re.compile(rf'({"|".join(NAMED)})\.([A-Za-z]\w*)\.([\w.]+)')


def is_name(value: Any) -> bool:
    """Return whether a value can be the name of a member."""
    return isinstance(value, str) and re.fullmatch(r'[A-Za-z]\w*', value) is not None


class Member(NamedTuple):
    """Which member of which family a parameter belongs to, and what it says of it."""

    family: str
    name: str
    field: str


@lru_cache(maxsize=4096)      # scenes are read again at every move of a slider
def member_of(name: str) -> Member | None:
    """Return the :class:`Member` that a parameter belongs to by its name, or None."""
    match = _MEMBER.fullmatch(name)
    return Member(*match.groups()) if match else None


def find(name: str) -> Parameter | None:
    """Return the Parameter of this name, of a member of a family, or None."""
    member = member_of(name)
    if member is None:
        return None
    general = NAMED[member.family].get(f'{member.family}.{NAME}.{member.field}')
    return general and general._replace(name=name, text=general.text.replace(NAME, member.name))


def names_in(family: str, values: Iterable[str]) -> list[str]:
    """Return the names of the members of a family that have a parameter, in order."""
    members = filter(None, map(member_of, values))
    return list(dict.fromkeys(member.name for member in members if member.family == family))


def parameters_of(family: str, member: str) -> list[Parameter]:
    """Return all parameters of one member of a family."""
    named = (find(name.replace(f'.{NAME}.', f'.{member}.')) for name in NAMED[family])
    return list(filter(None, named))
