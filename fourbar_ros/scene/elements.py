# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Springs, dampers, forces over a position and friction of a scene, made of its parameters.

scene.py imports this file for scenes that have any. A table of forces may stand in a CSV file
beside that of a scene, which is read with it: a scene itself holds the numbers and opens no file.
"""
from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from math import atan2, hypot, inf, pi
from typing import Any, TYPE_CHECKING

from fourbar_ros.errors import InvalidParameter, nearest
from fourbar_ros.mechanics.bodies import field_of
from fourbar_ros.mechanisms import elements as acting
from fourbar_ros.mechanisms import parts, pieces
from fourbar_ros.mechanisms.curves import FIXED
from fourbar_ros.mechanisms.force_table import ForceTable
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.numerics.arguments import quantities_of
from fourbar_ros.numerics.number_types import ARRAY
from fourbar_ros.scene.linkage import require_masses
from fourbar_ros.scene.parameters import names_in, of_name, point_in, require_choice
from fourbar_ros.scene.settings import APART, COUPLE, ParameterValues, POSITION_UNITS
from fourbar_ros.scene.units import quantity, UNITS, ValueInSI
import numpy as np

if TYPE_CHECKING:
    from fourbar_ros.mechanisms.friction import Friction

ROUNDED = 1e-6      # of a stroke: places typed in six digits reach its ends
MM, TINY = 1e-3, 0.01       # places of less than this part of the way are no millimetres
WEAK, WEAKEST = 0.01, 1.0   # a spring with less than this part of the weight, or less [N], is weak
# forces.NAME.acts: (whether the direction turns with the link, angle from its x axis [rad])
ACTS = {'x': (False, 0.0), 'y': (False, 0.5 * pi), 'along': (True, 0.0),
        'across': (True, 0.5 * pi)}
DISTANCE = 'distance'
TABLE_UNITS = 'rad', 'm', 'N', 'N m', 'Pa'      # of both columns of a table
# angles of the kinds of mechanisms: (link, link from which the angle counts)
ANGLES = {'theta1': ('crank', parts.GROUND), 'theta2': ('coupler', 'crank'),
          'theta4': ('output', parts.GROUND), 'beta': ('coupler', parts.GROUND)}


def element_names(values: ParameterValues) -> list[str]:
    """Return the names of springs and forces, as springs.back, in their order in a mechanism."""
    return [f'{family}.{name}' for family in ('springs', 'torsion_springs', 'forces')
            for name in names_in(family, values)]


def group_in(name: str, field: str) -> str:
    """Return the parameters of a point, a field of a spring, force or friction of this name."""
    # forces.ram.along is where it acts
    return name if field == 'point' else f'{name}.{"from" if field == "apart_from" else field}'


def elements_of(values: ParameterValues, mechanism: Mechanism) -> tuple[acting.Element, ...]:
    """Return springs and forces over a position of a scene; InvalidParameter names the wrong."""
    names = element_names(values)
    if names:
        require_masses(mechanism, names[0])
    return tuple([(_force if name.startswith('forces') else _spring)(values, name, mechanism)
                  for name in names])


def beyond_tables(values: ParameterValues, mechanism: Mechanism) -> Iterator[str]:
    """Yield a line for each table whose force never acts, or ends before its position does."""
    for name, element in zip(element_names(values), mechanism.elements):
        force = element.value if isinstance(element, acting.PositionForce) else None
        if (not isinstance(force, acting.TableForce) or element.factor == 0.0
                or not any(force.table.values)):
            continue
        table, over = force.table, values[f'{name}.over']
        low, high = pieces.span_of(mechanism, partial(element.position, ARRAY))
        is_angle = isinstance(element.over, acting.LinkAngle) or (
            element.over == acting.INPUT and not mechanism.is_driven_by_slide)
        unit = values[f'{name}.place_unit'] or ('rad' if is_angle else 'm')
        size = float(POSITION_UNITS[unit])
        span = f'{over} from {low / size:.6g} to {high / size:.6g} {unit}'
        first, last = table.places[0], table.places[-1]
        slack = ROUNDED * (high - low)
        if _acts(values, mechanism, element):
            if force.period == inf and (low < first - slack and table.values[0]
                                        or high > last + slack and table.values[-1]):
                yield (f'{name}: its table goes from {first / size:.6g} to {last / size:.6g}, '
                       f'{span}: beyond its ends the force is that at the end')
        elif _acts(values, mechanism, replace(element, when=acting.BOTH)):
            yield (f'{name} never acts: {over} never goes {element.when} where its table has a '
                   'force')
        else:
            acting_at = [place for i, place in enumerate(table.places)
                         if any(table.values[max(i - 1, 0):i + 2])]     # or beside such a place
            first, last = acting_at[0], acting_at[-1]
            has_unit = values[f'{name}.place_unit'] or isinstance(
                values[f'{name}.places'][0], str)
            is_in_mm = (
                not is_angle and not has_unit and first * MM < high and last * MM > low
                and max(abs(first), abs(last)) * MM > TINY * max(abs(low), abs(high)))
            yield (f'{name} never acts: its table has a force from {first / size:.6g} to '
                   f'{last / size:.6g}, {span}' + ': did you mean mm?' * is_in_mm)


def _acts(values: ParameterValues, mechanism: Mechanism, force: acting.PositionForce) -> bool:
    """Return whether a force is not 0 at some input, in a direction in which the drive moves."""
    speed = values['drive.speed']
    is_one_way = mechanism.turns_fully and values['drive.source'] == 'timer' and speed
    inputs: Any = pieces.inside_pieces(mechanism)
    for rate in [speed] if is_one_way else [1.0, -1.0]:
        moving = {**mechanism.link_motions(mechanism.motion(inputs, rate)), parts.GROUND: FIXED}
        if any(np.any(component) for push in force.forces(ARRAY, moving, inputs, rate, 1.0)
               for component in (push.force_x, push.force_y, push.couple)):
            return True
    return False


def doubtful_springs(values: ParameterValues, mechanism: Mechanism) -> Iterator[str]:
    """Yield a line for each spring that is likely meant in N/mm, or lacks its free length."""
    weight = hypot(*field_of(mechanism.gravity)) * sum(
        body.mass for body in mechanism.bodies)         # NaN on an unknown base
    for name, spring in zip(element_names(values), mechanism.elements):
        if not isinstance(spring, acting.Spring) or not spring.stiffness or (
                spring.preload and spring.free_length):     # which may be most of its force
            continue

        def pull(moving: Any, _: Any, spring: acting.Spring = spring) -> Any:
            per_length, _, square = spring.tension(ARRAY, moving)
            return per_length * np.sqrt(square)
        force = max(map(abs, pieces.span_of(mechanism, pull)))
        if spring.preload:      # and no free length, as if it were not given
            yield (f'{name}.free_length = 0: its force grows with its whole length, up to '
                   f'{force:.4g} N, with a preload of {spring.preload:g} N at length 0: is its '
                   'free length missing?')
        elif force < max(WEAK * weight, min(WEAKEST, weight)):      # weak beside the links
            masses = {link: body.mass for link, body in mechanism.bodies._asdict().items()}
            heaviest = max(masses, key=lambda link: masses[link])
            yield (f'{name}.stiffness = {spring.stiffness:g} N/m: its force is at most '
                   f'{force:.3g} N, the links weigh {weight:.3g} N: did you mean '
                   f'{spring.stiffness:g} N/mm, or a mass of the {heaviest} below '
                   f'{masses[heaviest]:g} kg?')


def _attachment(name: str, values: ParameterValues) -> acting.Attachment:
    """Return the point of the parameters NAME.link, NAME.along and NAME.across."""
    return acting.Attachment(*point_in(name, values))


def _spring(values: ParameterValues, name: str, mechanism: Mechanism) -> acting.Element:
    """Return the spring of the parameters ``name``.*, springs.NAME or torsion_springs.NAME."""
    links, is_torsion = (parts.GROUND, *mechanism.loads_of_links()), name.startswith('torsion')
    first, second = [f'{name}.{end}' if is_torsion else f'{name}.{end}.link'
                     for end in ('first', 'second')]        # the parameters of its two links
    for parameter in (first, second):
        require_choice(parameter, values[parameter], links)
    if not is_torsion and values[first] == values[second] == parts.GROUND:
        raise InvalidParameter(second, None, 'must be given: both ends of '
                               f'{name} are on the ground')
    stiffness, damping = values[f'{name}.stiffness'], values[f'{name}.damping']
    try:
        if is_torsion:
            return acting.TorsionSpring(values[first], values[second], stiffness,
                                        free_angle=values[f'{name}.free_angle'], damping=damping)
        return acting.Spring(
            _attachment(f'{name}.first', values), _attachment(f'{name}.second', values), stiffness,
            free_length=values[f'{name}.free_length'], damping=damping,
            preload=values[f'{name}.preload'])
    except InvalidParameter as error:
        if error.name != 'second':
            raise
        raise InvalidParameter(second, error.value, error.allowed) from None


def _force(values: ParameterValues, name: str, mechanism: Mechanism) -> acting.PositionForce:
    """Return the force of the parameters ``name``.*, checked by computing with it once."""
    link, acts = values[f'{name}.link'], values[f'{name}.acts']
    links = tuple(mechanism.loads_of_links())
    require_choice(f'{name}.link', link, links)
    require_choice(f'{name}.from.link', values[f'{name}.from.link'], (parts.GROUND, *links))
    over = _over(values, name, mechanism)
    turns_with_link, direction = ACTS.get(acts, (False, 0.0))
    try:
        force = acting.PositionForce(
            _attachment(name, values), _table(values, name, over, mechanism), over,
            direction=None if acts == COUPLE else direction + values[f'{name}.direction'],
            axes=link if turns_with_link else parts.GROUND, factor=values[f'{name}.factor'],
            apart_from=_attachment(f'{name}.from', values) if acts == APART else None,
            when=values[f'{name}.when'])
        force.fitted(mechanism)
    except InvalidParameter as error:
        field = {'is_periodic': 'periodic', 'apart_from': 'from.link'}.get(error.name, error.name)
        raise InvalidParameter(f'{name}.{field}', error.value, error.allowed) from None
    return force


def _table(values: ParameterValues, name: str, over: acting.Over, mechanism: Mechanism
           ) -> ForceTable:
    """Return the table of a force in SI units; errors are in the units of the scene."""
    is_couple = values[f'{name}.acts'] == COUPLE
    is_angle = (not mechanism.is_driven_by_slide if over == acting.INPUT
                else isinstance(over, acting.LinkAngle))
    if file := values[f'{name}.table']:
        raise InvalidParameter('table', file, 'only the file of a scene names that of a table, '
                               'which is read with it; here give places and values')
    if not values[f'{name}.places']:
        raise InvalidParameter('table', None, 'must be given, or places and values: what acts '
                               'where')
    places, place_size, _ = _column(
        values, name, 'place', ('rad',) if is_angle else ('m',),
        f'{"an angle" if is_angle else "a length"}: over is {values[f"{name}.over"]}')
    forces, force_size, kind = _column(values, name, 'value', *(
        (('N m',), 'a couple') if is_couple else (('N', 'Pa'), 'a force or pressure')))
    if kind == 'Pa' and values[f'{name}.factor'] == 1.0:
        raise InvalidParameter('factor', 1.0, 'must be the area [m^2] on which the pressure acts, '
                               'negative against the direction')
    table = ForceTable(places, forces, values[f'{name}.periodic'],
                       values[f'{name}.interpolation'] == 'linear')
    return replace(table, places=[place_size * place for place in table.places],
                   values=[force_size * force for force in table.values])


def _column(values: ParameterValues, name: str, column: str, kinds: tuple[str, ...], allowed: str
            ) -> tuple[list[float], float, str]:
    """
    Return the values of a column, the size in SI of the unit they have, and its SI unit.

    ``column``: place or value of the force ``name``, which may hold numbers in NAME.place_unit, or
    texts with units. ``kinds``: the SI units that are allowed, in words ``allowed``.
    """
    items, unit = values[f'{name}.{column}s'], values[f'{name}.{column}_unit']
    converted = [quantity(item, *TABLE_UNITS) if isinstance(item, str) else item for item in items]
    texts = {value.unit: item for item, value in zip(items, converted)
             if isinstance(value, ValueInSI) and value.unit}        # {SI unit: a text that has it}
    unit = unit or next(iter(texts), kinds[0])
    kind = next(si for si in TABLE_UNITS if unit in UNITS[si])
    for si, item in texts.items():
        if si not in kinds:
            raise InvalidParameter(f'{column}s', item, f'must have a unit of {allowed}')
        if si != kind:
            raise InvalidParameter(f'{column}s', item, f'the unit of the rest is {unit}')
    if kind not in kinds:
        raise InvalidParameter(f'{column}_unit', unit, f'must be a unit of {allowed}')
    size = float(UNITS[kind][unit])
    if not texts:
        return converted, size, kind
    return [value if getattr(value, 'unit', '') else size * value
            for value in converted], 1.0, kind


def _over(values: ParameterValues, name: str, mechanism: Mechanism) -> acting.Over:
    """
    Return the coordinate that forces.NAME.over names: the force is a function of it.

    It is the input, an angle or slide of the mechanism, a coordinate of a point, ``P.x``, or the
    distance of two points.
    """
    over, driven = values[f'{name}.over'], mechanism.input_coordinate.position
    inputs: dict[str, acting.Over] = {acting.INPUT: acting.INPUT, driven: acting.INPUT}
    known = {**inputs, **_coordinates(mechanism), **inputs, DISTANCE: acting.Distance(
        _attachment(name, values), _attachment(f'{name}.from', values))}
    for point in names_in('points', values):
        attachment = _attachment(f'points.{point}', values)
        known |= {f'{point}.x': acting.Way(attachment),
                  f'{point}.y': acting.Way(attachment, direction=0.5 * pi)}
    if over not in known:
        raise InvalidParameter(f'{name}.over', over, f'there is no such coordinate'
                                                     f'{nearest(over, known)}')
    return known[over]


def _coordinates(mechanism: Mechanism) -> dict[str, acting.Over]:
    """Return {name: coordinate} of the angles and slides of a mechanism: theta4, theta_LINK."""
    names = [coordinate.position for coordinate in mechanism.PARTS]
    links = {link.name for link in mechanism.LINKS}
    coordinates: dict[str, acting.Over] = {}
    for name in names:
        link = name.removeprefix('theta_')
        if name in ANGLES:
            coordinates[name] = acting.LinkAngle(*ANGLES[name])
        elif link != name and link in links:
            coordinates[name] = acting.LinkAngle(link)
    if hasattr(mechanism, 'stages'):
        from fourbar_ros.scene.machines import slides_in
        for link, origin, (cosine, sine) in slides_in(mechanism):
            coordinates[f'slide_{link}'] = acting.Way(
                acting.Attachment(link), acting.Attachment(*origin), atan2(sine, cosine))
    elif 'slide' in names:
        block, pivot = acting.Attachment('coupler'), acting.Attachment('output')
        # of a bar that turns, along it from its pivot; else along x
        coordinates['slide'] = (acting.Way(block, pivot) if mechanism.SLIDE_DIRECTION
                                else acting.Way(pivot))
    return coordinates


def friction_of(values: ParameterValues, mechanism: Mechanism) -> 'Friction':
    """Return the friction of joints and drive, friction.NAME.*, as pairs (joint, its friction)."""
    from fourbar_ros.mechanisms import friction  # few mechanisms have any
    names = names_in('friction', values)
    require_masses(mechanism, f'friction.{names[0]}')
    if 'equation' in values['outputs']:
        raise InvalidParameter('outputs', 'equation', 'has no friction, which depends on the '
                               f'acceleration: leave it out, or friction.{names[0]}')
    pairs = list[tuple[str, friction.JointFriction | friction.DriveFriction]]()
    for name in names:
        kind: Any = friction.DriveFriction if name == parts.DRIVE else friction.JointFriction
        fields, given = [field for field, *_ in quantities_of(kind)], dict[str, float]()
        for parameter, value in values.items():
            if not parameter.startswith(f'friction.{name}.') or value != value:     # not given
                continue
            field = parameter.rpartition('.')[2]
            if field in fields:
                given[field] = value
            elif value != of_name(parameter).default:
                raise InvalidParameter(parameter, value,
                                       f'friction.{name} has {", ".join(fields)} only')
        pairs.append((name, kind(**given)))
    return tuple(pairs)
