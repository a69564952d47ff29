# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Find the parameters of a scene in the table, and check their values; imports no ROS."""
from array import array
from collections.abc import Iterable
from functools import lru_cache
from math import isfinite, isnan
import re
from typing import Any

from fourbar_ros.errors import InvalidParameter, nearest, one_of
from fourbar_ros.mechanisms import curves, kinds, parts
from fourbar_ros.scene import settings
from fourbar_ros.scene.settings import Parameter, PARAMETERS, ParameterValues
from fourbar_ros.scene.units import NUMBER, quantity, WrongQuantity

VALUES = {'double': float, 'integer': int, 'string': str, 'bool': bool, 'strings': list,
          'doubles': list}
IN_WORDS = {'integer': 'a whole number', 'string': 'a text', 'bool': 'true or false',
            'strings': 'a list of texts: [a, b]', 'doubles': 'a list of numbers: [1.0, 2.0]'}
LISTED = '; docs/reference_desk.md lists those of a scene, reference_robot.md of its node'
ABSENT = 'gears', 'cams'       # which other programs have
OF_MACHINES = 'dyads.', 'linkage.points.'
JOINTS = 'O1, A, B, O4, guide or drive; of a machine base or DYAD_inner'
TABLE_COLUMN = re.compile(r'((forces\.\w+)\.(place|value))s')
_MEMBER = re.compile(rf'({"|".join(settings.FAMILIES)})\.([A-Za-z]\w*)\.([\w.]+)')


# --- find ----------------------------------------------------------------------------------------

@lru_cache(maxsize=4096)      # the page reads a scene again at every move of a slider
def member_of(name: str) -> tuple[str, str, str] | None:
    """Return (family, member, field) by a name: points, P, along of points.P.along; or None."""
    match = _MEMBER.fullmatch(name)
    return (match[1], match[2], match[3]) if match else None


def find_parameter(name: str) -> Parameter | None:
    """Return the Parameter of this name, one of the table or of a member of a family, or None."""
    return PARAMETERS.get(name) or _of_member(name)


@lru_cache(maxsize=4096)
def _of_member(name: str) -> Parameter | None:
    family, member, field = member_of(name) or ('points', '', '')
    general = settings.FAMILIES[family].get(f'{family}.{settings.NAME}.{field}')
    return general and general._replace(
        name=name, text=general.text.replace(settings.NAME, member))


def of_name(name: str) -> Parameter:
    """Return the Parameter of a name that a checked scene has."""
    parameter = find_parameter(name)
    assert parameter is not None, name
    return parameter


def without_defaults(values: ParameterValues) -> dict[str, Any]:
    """Return the parameters that a scene file must give: neither NaN nor a default."""
    return {name: value for name, value in values.items() if value == value
            and value != getattr(find_parameter(name), 'default', None)}


def names_in(family: str, values: Iterable[str]) -> list[str]:
    """Return the members of a family in a scene: P and Q of points.P.link, points.Q.along."""
    members = filter(None, map(member_of, values))
    return list(dict.fromkeys(member for group, member, _ in members if group == family))


def point_in(name: str, values: ParameterValues) -> curves.Point:
    return curves.Point(*(values[f'{name}.{field}'] for field in curves.Point._fields))


def with_unit(values: ParameterValues) -> frozenset[str]:
    """Return the parameters, not checked yet, whose numbers have units, as 40mm; but for zeros."""
    def are_with_unit(items: list[Any]) -> bool:
        matches = [NUMBER.fullmatch(str(item).strip()) for item in items]
        return any(match and match[2] for match in matches) and all(
            match and (match[2] or float(match[1]) == 0.0) for match in matches)
    return frozenset(name for name, value in values.items()
                     if are_with_unit(value if isinstance(value, list) else [value]))


def require_choice(name: str, value: str, choices: Iterable[str], some: bool = False) -> None:
    """Raise InvalidParameter for a value that is none of the choices; ``some`` as of one_of."""
    if value not in (choices := tuple(choices)):
        raise InvalidParameter(name, value, one_of(choices, value, some))


def _parameters_of(family: str, member: str) -> list[Parameter]:
    return [of_name(name.replace(f'.{settings.NAME}.', f'.{member}.'))
            for name in settings.FAMILIES[family]]


# --- check ---------------------------------------------------------------------------------------

def check(values: ParameterValues) -> dict[str, Any]:
    """Return all parameters in their types, with defaults; InvalidParameter for a bad one."""
    is_machine = values.get('linkage.kind') == settings.MACHINE
    for name in values:
        if name not in PARAMETERS and (_of_member(name) is None or (
                name.startswith(OF_MACHINES) and not is_machine)):
            raise InvalidParameter(name, values[name],
                                   _why_unknown(name, is_machine, values[name]))
    every = PARAMETERS | {parameter.name: parameter
                          for family, name in _members(values, is_machine)
                          for parameter in _parameters_of(family, name)}
    for name in [f'dyads.{dyad}.{end}' for dyad in names_in('dyads', every)
                 for end in ('first', 'second')]:
        by_link = [f'{name}.{field}' for field in curves.Point._fields]
        for field in by_link if values.get(name) else ():
            if field in values:
                raise InvalidParameter(field, values[field], f'stands twice: {name} names the '
                                       f'point {values[name]}')
        for unused in by_link if values.get(name) else [name]:
            del every[unused]
    for parameter in every.values():
        if parameter.default is settings.REQUIRED and parameter.name not in values:
            raise InvalidParameter(parameter.name, None, f'must be given: {parameter.text}')
    return {name: check_value(parameter, values.get(name, parameter.default), values)
            for name, parameter in every.items()}


def unit_in(parameter: Parameter, values: ParameterValues) -> str:
    """Return the unit of a parameter in a scene: of 'rad or m' that of the scene's input."""
    slides = values.get('linkage.input') in ('slide', 'cylinder')
    return parameter.unit.split(' or ')[-1 if slides else 0]


def shown_unit(name: str, values: ParameterValues) -> str:
    """Return the unit of a checked value of a scene; empty where each number has its own."""
    parameter, value, column = of_name(name), values[name], TABLE_COLUMN.fullmatch(name)
    if isinstance(value, list) and any(isinstance(item, str) for item in value):
        return ''
    if name == 'joint_states.offsets':          # of angles and slides
        return parameter.unit
    unit: str = values[f'{column[1]}_unit'] if column else unit_in(parameter, values)
    if unit or not column:
        return unit
    over, kinds = values[f'{column[2]}.over'], parameter.unit.split(' or ')
    if column[3] == 'value':                    # N or N m or Pa
        return kinds[int(values[f'{column[2]}.acts'] == settings.COUPLE)]
    return (unit_in(parameter, values) if over == 'input' else
            kinds[not re.fullmatch(r'theta\w*|beta', over)])


def _why_unknown(name: str, is_machine: bool, value: Any) -> str:
    """Return the reason why a scene, perhaps of a machine, has no parameter of this name."""
    family, *rest = name.replace('linkage.points', 'points', 1).split('.')
    member = member_of(name)
    # springs.2nd.stiffness
    if family in settings.FAMILIES and len(rest) > 1 and not member:
        noun = ('link' if family in settings.OF_LINKS else 'joint' if family == 'friction'
                else family[:-1].replace('_', ' '))
        return (f'{rest[0]!r} is not a valid {noun} name: use letters, digits and _, starting '
                'with a letter' + (f', as {JOINTS}' if family == 'friction' else ''))
    if name.startswith(OF_MACHINES) and not is_machine:
        return f'linkage.kind {settings.MACHINE} alone has dyads, and points on which they hang'
    if family in ABSENT:
        return f'fourbar_ros has no {", ".join(ABSENT[:-1])} or {ABSENT[-1]}'
    known = ([each.name for each in _parameters_of(*member[:2])] if member
             else [*PARAMETERS, *settings.FAMILIES['points']])
    group, _, last = name.rpartition('.')
    below, beside = _below(name, known), _below(group, known)
    # linkage: 'a1:0.4'; linkage: 0.4; springs.s.stifness
    if below and isinstance(value, str) and ':' in value:
        return f'a blank is missing behind the colon: {value.replace(":", ": ", 1)}'
    if below:
        return f'is a group of parameters, not a value{nearest("", below)}'
    if beside:
        return f'unknown parameter of {group}{nearest(last, beside) or LISTED}'
    families = [family for family in settings.FAMILIES if _of_member(f'{family}.{name}')]
    if families:        # ram.mass, indented too little
        meant = ' or '.join(f'{family}.{name}' for family in families)
        return f'unknown parameter; did you mean {meant}?'
    groups = dict.fromkeys(each.partition('.')[0] for each in known)
    return f'unknown parameter{nearest(name, [*known, *groups]) or LISTED}'


def _below(group: str, known: Iterable[str]) -> list[str]:
    rests = [name.removeprefix(f'{group}.') for name in known if name.startswith(f'{group}.')]
    return list(dict.fromkeys(rest.split('.')[0] for rest in rests))


def _members(values: ParameterValues, is_machine: bool) -> list[tuple[str, str]]:
    """
    Return (family, name) of all members of families, in values that are not checked yet.

    Each link has masses and external loads, so it is a member of bodies and external.
    """
    mentioned: dict[str, list[str]] = {family: [] for family in settings.FAMILIES}
    if is_machine:
        mentioned['dyads'] = _names(values.get('linkage.dyads'))
        dyads = *mentioned['dyads'], *names_in('dyads', values)
        links = [link for name in dyads for link in _names(values.get(f'dyads.{name}.links'))]
        driver = values.get('linkage.input')
        links.append('slider' if driver == 'slide' else 'crank')
        if driver == 'cylinder':
            links += _names(values.get('cylinder.links', PARAMETERS['cylinder.links'].default))
            links += _names([values.get('cylinder.base.link')])
        elif driver != 'slide':
            links += _names([values.get('linkage.carrier')])
    else:
        kind = values.get('linkage.kind', PARAMETERS['linkage.kind'].default)
        links = ([link.name for link in kinds.KINDS[kind].LINKS]
                 if isinstance(kind, str) and kind in kinds.KINDS else [])
    links = [link for link in links if link != parts.GROUND]
    mentioned.update(dict.fromkeys(settings.OF_LINKS, links))
    return [(family, name) for family, names in mentioned.items()
            for name in dict.fromkeys([*names, *names_in(family, values)]) if name != 'rods']


def _names(value: Any) -> list[str]:
    """Return the valid names in a list that is not checked yet; [] of anything else."""
    return ([item for item in value
             if isinstance(item, str) and re.fullmatch(r'[A-Za-z]\w*', item)]
            if isinstance(value, (list, tuple)) else [])


def check_value(parameter: Parameter, value: Any, values: ParameterValues) -> Any:
    """
    Return a value in the type of its parameter, a text as '40mm' as the number in SI.

    ``values``: of the scene, whose input decides between angles and lengths. InvalidParameter
    names the allowed values.
    """
    name, choices = parameter.name, parameter.choices
    kind: Any = VALUES[parameter.type]
    if kind is float:
        value = as_number(name, value, unit_in(parameter, values))
    if kind is list and isinstance(value, (tuple, array)):      # rclpy gives array('d', ...)
        value = list(value)
    if isinstance(value, str) and value in parameter.words:
        value = parameter.words[value]
    if not isinstance(value, kind) or (kind is int and isinstance(value, bool)):
        raise InvalidParameter(name, value, f'must be {_wanted(parameter, value)}')
    if parameter.type == 'strings':
        for item in value:
            if choices:
                require_choice(name, item, choices, some=True)
            elif not isinstance(item, str):
                raise InvalidParameter(name, item, 'must be a text'
                                       + f': {settings.IN_QUOTES}' * isinstance(item, bool))
    elif parameter.type == 'doubles':
        # angles or lengths: a text stays until the mechanism tells which, but of the input
        units = ([unit_in(parameter, values)] if name == 'linkage.range'
                 else parameter.unit.split(' or '))
        in_si = [as_number(name, item, *units) for item in value]
        for item in in_si:
            if not isinstance(item, float) or not isfinite(item):
                raise InvalidParameter(name, item, 'must hold finite numbers')
        value = [item if len(units) > 1 and isinstance(item, str) else si
                 for item, si in zip(value, in_si)]
    elif choices:
        require_choice(name, value, choices)
    # NaN may stand for "not given"
    if kind in (float, int) and not (isnan(value) and isinstance(parameter.default, float)
                                     and isnan(parameter.default)):
        if not isfinite(value):
            raise InvalidParameter(name, value, 'must be a finite number')
        if parameter.positive and value <= 0:
            raise InvalidParameter(name, value, 'must be positive')
        if (not parameter.low <= value <= parameter.high
                or 0 < value < parameter.least_but_zero):
            verb = 'lie in' if parameter.allowed.startswith(('[', '(')) else 'be'
            raise InvalidParameter(name, value, f'must {verb} {parameter.allowed}')
    return value


def _wanted(parameter: Parameter, value: Any) -> str:
    """Return in words of which type a value must be, to be said of one that is of another."""
    if parameter.words:
        return 'one of ' + ', '.join(f'{value} or {word}'
                                     for word, value in parameter.words.items())
    if parameter.type == 'double':
        return f'a number in {parameter.unit}' if parameter.unit else 'a number'
    if parameter.type == 'string' and isinstance(value, bool):
        return f'a text: {settings.IN_QUOTES}'
    if parameter.type == 'integer' and isinstance(value, float) and value.is_integer():
        return f'a whole number: {value:.0f}'
    return IN_WORDS[parameter.type]


def as_number(name: str, value: Any, *units: str) -> Any:
    """Return an integer, or a text as '40mm', as a float in SI; anything else as it is."""
    if isinstance(value, str):
        try:
            return float(quantity(value, *filter(None, units)))
        except WrongQuantity as error:
            raise InvalidParameter(name, value, str(error)) from None
    return float(value) if isinstance(value, int) and not isinstance(value, bool) else value
