# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Find the parameters of a scene in the table, and check the values that a scene gives them.

No ROS is imported.
"""
from __future__ import annotations

from array import array
from collections.abc import Iterable, Mapping
from fnmatch import fnmatchcase
from functools import lru_cache
from math import isfinite, isnan
import re
from typing import Any, NamedTuple

from fourbar_ros.errors import InvalidParameter, nearest, one_of
from fourbar_ros.mechanisms.parts import GROUND
from fourbar_ros.scene.parameter_table import (
    FAMILIES,
    GOES_WITH,
    LINKS,
    MACHINE,
    NAME,
    OF_MACHINES,
    Parameter,
    PARAMETERS,
    REQUIRED,
)
from fourbar_ros.scene.units import in_unit, UNITS

ParameterValues = Mapping[str, Any]       # {name: value}; their types stand in the table
TYPES = {'double': float, 'integer': int, 'string': str, 'bool': bool, 'strings': list,
         'doubles': list}
IN_WORDS = {'integer': 'a whole number', 'string': 'a text', 'bool': 'true or false',
            'strings': 'a list of texts: [a, b]', 'doubles': 'a list of numbers: [1.0, 2.0]'}
_MEMBER = re.compile(rf'({"|".join(FAMILIES)})\.([A-Za-z]\w*)\.([\w.]+)')


# --- find ----------------------------------------------------------------------------------------

class Member(NamedTuple):
    """A parameter of a family: points.P.along is the field along of the member P of points."""

    family: str
    name: str
    field: str


@lru_cache(maxsize=4096)      # scenes are read again at every move of a slider
def member_of(name: str) -> Member | None:
    """Return the :class:`Member` that a parameter belongs to by its name, or None."""
    match = _MEMBER.fullmatch(name)
    return Member(*match.groups()) if match else None


def find(name: str) -> Parameter | None:
    """Return the Parameter of this name, one of the table or of a member of a family, or None."""
    return PARAMETERS.get(name) or _of_member(name)


def _of_member(name: str) -> Parameter | None:
    member = member_of(name)
    if member is None:
        return None
    general = FAMILIES[member.family].get(f'{member.family}.{NAME}.{member.field}')
    return general and general._replace(name=name, text=general.text.replace(NAME, member.name))


def of_name(name: str) -> Parameter:
    """Return the Parameter of a name that a checked scene has."""
    found = find(name)
    assert found is not None, name
    return found


def names_in(family: str, values: Iterable[str]) -> list[str]:
    """Return the names of the members of a family that have a parameter, in order."""
    members = filter(None, map(member_of, values))
    return list(dict.fromkeys(member.name for member in members if member.family == family))


def _parameters_of(family: str, member: str) -> list[Parameter]:
    """Return all parameters of one member of a family."""
    named = (_of_member(name.replace(f'.{NAME}.', f'.{member}.')) for name in FAMILIES[family])
    return list(filter(None, named))


def meant(values: ParameterValues, given: ParameterValues) -> list[str]:
    """
    Return the names of the parameters that have a meaning in a scene, or are given all the same.

    ``values``: all parameters of the scene, checked; ``given``: those that it gives.
    """
    def holds(other: str, wanted: tuple[Any, ...]) -> bool:
        of_others = [values[name] for name in values if fnmatchcase(name, other)]
        # NaN: not given
        return any(value in wanted if wanted else value == value for value in of_others)

    hold = [(pattern, holds(other, wanted)) for pattern, other, wanted in GOES_WITH]
    if values['linkage.kind'] == MACHINE:        # which has links of its own
        others = LINKS.keys() - set(_links_of_machine(values))
        hold[:0] = [(f'{family}.{link}.*', False) for family in ('bodies', 'external')
                    for link in others]
    return [name for name in values if name in given
            or next((found for pattern, found in hold if fnmatchcase(name, pattern)), True)]


# --- check ---------------------------------------------------------------------------------------

def check(values: ParameterValues) -> dict[str, Any]:
    """
    Return all parameters with defaults filled in, each in its own type.

    Raises
    ------
    InvalidParameter
        For the first unknown, missing or bad one.

    """
    is_machine = values.get('linkage.kind') == MACHINE
    for name in values:
        if not _is_known(name, is_machine):
            raise InvalidParameter(name, values[name],
                                   _why_unknown(name, is_machine, values[name]))
    of_members = [parameter for family, name in _members(values, is_machine)
                  for parameter in _parameters_of(family, name)]
    every = {parameter.name: parameter for parameter in of_members} | PARAMETERS
    for parameter in every.values():
        if parameter.default is REQUIRED and parameter.name not in values:
            raise InvalidParameter(parameter.name, None, f'must be given: {parameter.text}')
    return {name: check_value(every[name], values.get(name, every[name].default))
            for name in (*PARAMETERS, *(name for name in every if name not in PARAMETERS))}


def _is_known(name: str, is_machine: bool) -> bool:
    """Return whether a scene may have this parameter; links of their own only machines have."""
    member = member_of(name)
    return name in PARAMETERS or (member is not None and _of_member(name) is not None
                                  and (is_machine or member.family not in OF_MACHINES))


def _why_unknown(name: str, is_machine: bool, value: Any) -> str:
    parts = name.split('.')
    if with_unit := _named_with_unit(name, value):
        return with_unit
    below = list(dict.fromkeys(known.removeprefix(f'{name}.').split('.')[0]
                               for known in PARAMETERS if known.startswith(f'{name}.')))
    if below and isinstance(value, str) and ':' in value:
        return f'a blank is missing behind the colon: {value.replace(":", ": ", 1)}'
    if below:
        return f'is a group of parameters, not a value{nearest("", below)}'
    if parts[0] in FAMILIES and len(parts) > 2 and not member_of(name):
        of_what = {'bodies': 'link', 'external': 'link'}.get(parts[0], parts[0][:-1])
        return (f'{parts[1]!r} is not a valid {of_what.replace("_", " ")} name: use letters, '
                'digits and _, starting with a letter')
    if parts[0] == 'dyads' and not is_machine:
        return f'linkage.kind {MACHINE} alone has dyads'
    member = member_of(name)
    known = [*PARAMETERS, *FAMILIES['points']]
    if member and (is_machine or member.family not in OF_MACHINES):
        known = [p.name for p in _parameters_of(member.family, member.name)]
    group, _, last = name.rpartition('.')
    beside = [other.rpartition('.')[2] for other in known if other.rpartition('.')[0] == group]
    if group and beside:
        hint = nearest(last, beside)
        return 'unknown parameter' + hint.replace('mean ', f'mean {group}.').replace(
            '; known:', f'; {group} has')
    return f'unknown parameter{nearest(name, known)}'


def _named_with_unit(name: str, value: Any) -> str:
    """Return what to write for a name with a unit, as drive.rpm or linkage.a1_mm; or nothing."""
    group, _, last = name.rpartition('.')
    base, _, unit = last.rpartition('_')
    units = {unit.lower().replace('/', '_'): unit for its in UNITS.values() for unit in its}
    for word in (last, unit):
        parameter = PARAMETERS.get('drive.speed' if name == f'drive.{word}' and word == last
                                   else f'{group}.{base}')
        if parameter and word.lower() in units:
            of_unit = units[word.lower()]
            found = in_unit(f'{value}{of_unit}', parameter.unit)
            its = f' [{parameter.unit.partition(" or ")[0]}]'
            return (f'unknown parameter; did you mean {parameter.name}{its}?'
                    + (f' {value} {of_unit} = {found:.5g}' if found is not None else ''))
    return ''


def _members(values: ParameterValues, is_machine: bool) -> list[tuple[str, str]]:
    """Return (family, name) of all members of a scene; every link of a machine has a body."""
    found = [(group, name) for group in FAMILIES if group not in OF_MACHINES
             for name in names_in(group, values)]
    if is_machine:
        dyads = _dyads(values)
        found += [('dyads', name) for name in dyads]
        links = _links_of_machine(values)
        for family in ('bodies', 'external'):
            names = dict.fromkeys([*links, *names_in(family, values)])
            found += [(family, name) for name in names if name != 'rods']
    return found


def _dyads(values: ParameterValues) -> list[str]:
    return list(dict.fromkeys([*_names(values.get('linkage.dyads')),
                               *names_in('dyads', values)]))


def _links_of_machine(values: ParameterValues) -> list[str]:
    return [link for link in (*(own for name in _dyads(values)
                                for own in _names(values.get(f'dyads.{name}.links'))),
                              *_driven_links(values)) if link != GROUND]


def _driven_links(values: ParameterValues) -> list[str]:
    """Return the links of a machine that need not be named, those of its cylinder included."""
    driver = values.get('linkage.input')
    rods = _names(values.get('cylinder.links', PARAMETERS['cylinder.links'].default))
    base = _names([values.get('cylinder.base.link')])
    return {'slide': ['slider'], 'cylinder': ['crank', *rods, *base]}.get(str(driver), ['crank'])


def _names(value: Any) -> list[str]:
    """Return the texts in a value, whatever it is."""
    return ([item for item in value
             if isinstance(item, str) and re.fullmatch(r'[A-Za-z]\w*', item)]
            if isinstance(value, (list, tuple)) else [])


def check_value(parameter: Parameter, value: Any) -> Any:
    """Return a value in the type of its parameter; InvalidParameter says what is allowed."""
    name, choices = parameter.name, parameter.choices
    kind: Any = TYPES[parameter.type]
    if kind is float:
        value = _as_float(value)
    # an array of doubles comes so from rclpy
    if kind is list and isinstance(value, (tuple, array)):
        value = list(value)
    if isinstance(value, str) and value in parameter.words:
        value = parameter.words[value]
    if not isinstance(value, kind) or (kind is int and isinstance(value, bool)):
        raise InvalidParameter(name, value, f'must be {_wanted(parameter, value)}')
    if parameter.type == 'strings':
        for item in value:
            if not isinstance(item, str) or (choices and item not in choices):
                raise InvalidParameter(name, item, one_of(choices, item, some=True)
                                       if choices else 'must be a text')
    elif parameter.type == 'doubles':
        value = [_as_float(item) for item in value]
        for item in value:
            if not isinstance(item, float) or not isfinite(item):
                raise InvalidParameter(name, item, 'must hold finite numbers')
    elif choices and value not in choices:
        raise InvalidParameter(name, value, one_of(choices, value))
    if kind in (float, int):
        _check_number(parameter, value)
    return value


def _wanted(parameter: Parameter, value: Any) -> str:
    """Return the type of a parameter in words, with what was probably meant."""
    if parameter.words:
        return 'one of ' + ', '.join(f'{number} or {word}' for word, number
                                     in parameter.words.items())
    if parameter.type == 'double':
        return f'a number{f" in {parameter.unit}" * bool(parameter.unit)}' + _meant(parameter,
                                                                                    value)
    if parameter.type == 'integer' and isinstance(value, float) and value.is_integer():
        return f'a whole number: {value:.0f}'
    return IN_WORDS[parameter.type]


def _meant(parameter: Parameter, value: Any) -> str:
    """Return a text, such as 50mm or 0,05, as the number that it means; empty: it means none."""
    if not isinstance(value, str):
        return ''
    with_point = value.replace(',', '.') if value.count(',') == 1 else value
    found = in_unit(with_point, parameter.unit)
    return f': {found:.5g}' if found is not None and isfinite(found) else ''


def _check_number(parameter: Parameter, value: float) -> None:
    if isnan(value) and isinstance(parameter.default, float) and isnan(parameter.default):
        return                                             # not given
    if not isfinite(value):
        raise InvalidParameter(parameter.name, value, 'must be a finite number')
    if parameter.positive and value <= 0:
        raise InvalidParameter(parameter.name, value, 'must be positive')
    if not parameter.low <= value <= parameter.high:
        verb = 'lie in' if parameter.allowed.startswith(('[', '(')) else 'be'
        raise InvalidParameter(parameter.name, value, f'must {verb} {parameter.allowed}')


def _as_float(value: Any) -> Any:
    """Return an integer as a float, anything else as it is."""
    return float(value) if isinstance(value, int) and not isinstance(value, bool) else value
