# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The mechanism of a scene: its kind or its dyads, its bodies, what acts on them."""
from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from math import degrees, inf, isnan, tau
from typing import Any, TYPE_CHECKING

from fourbar_ros.errors import InvalidParameter, nearest
from fourbar_ros.mechanics.bodies import Applied, Body, Gravity, UNKNOWN_BASE
from fourbar_ros.mechanisms.kinds import kind_of, KINDS
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.parts import JOINT_A, Link
from fourbar_ros.numerics.number_types import Scalar
from fourbar_ros.scene.parameters import member_of, of_name, unit_in
from fourbar_ros.scene.settings import LENGTHS, MACHINE, PARAMETERS, ParameterValues

if TYPE_CHECKING:
    from fourbar_ros.machine import Machine  # only scenes of machines need it
    from fourbar_ros.scene.scene import Scene

# an error of a mechanism names parameters of these groups as the scene does
AS_IN_SCENE = 'linkage.', 'dyads.', 'cylinder', 'bodies.', 'external.'
RODS = 'bodies.rods.'
FIELDS_OF_BODY = 'mass', 'inertia', 'cg_along'       # of a link: each of them gives it a body
SECTIONS = ('radius',), ('width', 'thickness')       # of rods: round, rectangular
ROD_PARAMETERS = tuple(RODS + field for field in ('density', *SECTIONS[0], *SECTIONS[1]))
RENAMED = {'stroke': 'linkage.range', 'dyads': 'linkage.dyads',
           'name of a dyad': 'linkage.dyads', 'length, density, radius': 'bodies.rods',
           'length, density, width, thickness': 'bodies.rods'}
GEOMETRY = 'linkage.', 'dyads.', 'cylinder'
MEMORY = 8
# {parameters of GEOMETRY: the newest machine with these}: a live change of masses and loads does
# not search for ranges and toggles again, which takes as long as hundreds of steps
_newest: dict[str, Machine] = {}


def linkage_of(values: ParameterValues) -> Mechanism:
    """Return the mechanism of a scene; InvalidParameter names parameters as the scene does."""
    _check_lengths(values)
    make = _machine if values['linkage.kind'] == MACHINE else _of_kind
    try:
        mechanism = make(values)
        mechanism.prepare()
        return mechanism
    except InvalidParameter as error:
        if error.name in values or error.name.startswith(AS_IN_SCENE):
            raise
        name = RENAMED.get(error.name, f'linkage.{error.name}')
        raise InvalidParameter(name, error.value, error.allowed) from None
    except (ArithmeticError, ValueError):
        raise InvalidParameter('linkage', values['linkage.kind'],
                               'lengths and bodies are too large, too small or too '
                               'far apart to be computed with') from None


def _check_lengths(values: ParameterValues) -> None:
    name = values['linkage.kind']
    lengths = [] if name == MACHINE else [length.name for length in KINDS[name].LENGTHS]
    for length in LENGTHS:
        parameter = PARAMETERS[f'linkage.{length}']
        value = values[parameter.name]
        if length in lengths and isnan(value):
            raise InvalidParameter(parameter.name, None, f'must be given: {parameter.text}')
        if length not in lengths and not isnan(value) and value != parameter.default:
            raise InvalidParameter(parameter.name, value, f'linkage.kind {name} has '
                                   + (f'{", ".join(lengths)} only' if lengths else 'dyads.*'))


def _of_kind(values: ParameterValues) -> Mechanism:
    name = values['linkage.kind']
    kind: Any = kind_of(name, values['linkage.input'])     # a class: arguments are its LENGTHS
    for only in ('linkage.dyads', 'linkage.output', 'linkage.carrier'):
        if values[only] != of_name(only).default:
            raise InvalidParameter(only, values[only], f'linkage.kind {MACHINE} alone has it')
    arguments = {length.name: values[f'linkage.{length.name}'] for length in kind.LENGTHS}
    if len(kind.INPUTS) > 1:
        arguments['input'] = values['linkage.input']
    elif values['linkage.input'] not in kind.INPUTS:
        inputs = dict.fromkeys([*kind.INPUTS, *kind_of(name, JOINT_A).INPUTS])
        raise InvalidParameter('linkage.input', values['linkage.input'],
                               f'linkage.kind {name} is driven at its {" or ".join(inputs)}')
    _check_links(values, kind)
    bodies = BodiesOfLinks(values, kind.LINKS,
                           {length: values[f'linkage.{length}'] for length in LENGTHS})
    stroke = values['linkage.range']
    mechanism: Mechanism = kind(
        **arguments, mode=values['linkage.mode'], stroke=tuple(stroke) if stroke else None,
        bodies=kind.BODIES(**bodies.made(True)) if bodies.are_given else None,
        gravity=_gravity(values), external=kind.EXTERNAL(**external_of(values, kind)))
    return mechanism


def _machine(values: ParameterValues) -> Mechanism:
    from fourbar_ros.scene import machines  # only scenes of machines need these formulas

    key = repr([item for item in values.items() if item[0].startswith(GEOMETRY)])
    machine = _newest.get(key) or machines.machine_of(values)
    _check_links(values, machine)
    bodies = BodiesOfLinks(values, machine.LINKS, dict(zip(machine.length_names, machine.lengths)))
    loaded = machine.with_loads(
        bodies=bodies.made(False) if bodies.are_given else None, gravity=_gravity(values),
        external=external_of(values, machine))
    if len(_newest) >= MEMORY:
        _newest.clear()
    _newest[key] = loaded
    return loaded


def _check_links(values: ParameterValues, mechanism: Mechanism | type[Mechanism]) -> None:
    """Refuse bodies of links that the mechanism lacks, and forces on links that bear none."""
    known = {'bodies': [link.name for link in mechanism.LINKS],
             'external': mechanism.EXTERNAL._fields}
    for name, value in values.items():
        family, link, _ = member_of(name) or ('', '', '')
        if family not in known or name in ROD_PARAMETERS:
            continue
        links, is_given = known[family], value == value and value != of_name(name).default
        if link not in links and is_given:
            raise InvalidParameter(f'{family}.{link}', None,
                                   f'there is no such link here{nearest(link, links)}')


def _gravity(values: ParameterValues) -> Gravity:
    gravity = values['gravity.x'], values['gravity.y']
    if not values['base.topic']:
        return gravity
    if any(gravity):
        raise InvalidParameter('base.topic', values['base.topic'], 'has weight in it: gravity '
                               'must be zero, else weight counts twice')
    return UNKNOWN_BASE


def external_of(values: ParameterValues, mechanism: Mechanism | type[Mechanism],
                applied: Callable[..., Any] = Applied) -> dict[str, Any]:
    """Return {link: external force}, made by ``applied`` of the parameters external.LINK.*."""
    return {link: applied(**{field: values[f'external.{link}.{field}']
                             for field in Applied.__dataclass_fields__})
            for link in mechanism.EXTERNAL._fields}


class BodiesOfLinks:
    """The bodies of the links of a scene: given one by one, or by a model of rods."""

    body = staticmethod(Body)        # a subclass may take arrays

    def __init__(self, values: ParameterValues, links: Sequence[Link],
                 lengths: Mapping[str, Scalar]) -> None:
        self._values, self._links, self._lengths = values, links, lengths
        self._has_rods = any(map(self._has, ROD_PARAMETERS))
        of_round, of_flat = SECTIONS
        self._section = of_flat if any(self._has(RODS + field) for field in of_flat) else of_round
        if self._section == of_flat and self._has(RODS + 'radius'):
            raise InvalidParameter(RODS + 'radius', self._values[RODS + 'radius'],
                                   'give either the radius of round rods or width and thickness')
        for field in ('density', *self._section) if self._has_rods else ():
            if not self._has(RODS + field):
                raise InvalidParameter(RODS + field, None, 'must be given: rods have density and '
                                       'radius, or density, width and thickness')

    def _has(self, name: str) -> bool:
        value = self._values[name]
        return not isinstance(value, float) or not isnan(value)

    def _has_mass(self, link: Link) -> bool:
        return self._has(f'bodies.{link.name}.mass')

    @property
    def are_given(self) -> bool:
        return self._has_rods or any(map(self._has_mass, self._links))

    def made(self, are_all_needed: bool) -> dict[str, Body]:
        """Return {link: Body}, by bodies.LINK.* or rods; refuse a lack if ``are_all_needed``."""
        values, bodies = self._values, {}
        for link in self._links:
            group = f'bodies.{link.name}.'
            fields = [field for field in FIELDS_OF_BODY if self._has(group + field)]
            if self._has_rods and link.length and not self._has_mass(link):
                if fields:
                    raise InvalidParameter(group + fields[0], values[group + fields[0]], 'needs '
                                           'the mass of the link: it is a rod (bodies.rods)')
                bodies[link.name] = self.rod(self._lengths[link.length], *(
                    values[RODS + field] for field in ('density', *self._section)))
            elif fields or are_all_needed:
                for field in ('mass', 'inertia') if link.turns else ('mass',):
                    if field not in fields:
                        raise InvalidParameter(
                            group + field, None, 'must be given: loads need mass'
                            f'{" and inertia" if link.turns else ""} of the {link.name}')
                along = (values[group + 'cg_along'] if 'cg_along' in fields
                         else 0.5 * self._lengths[link.length] if link.length else 0.0)
                bodies[link.name] = self.body(
                    values[group + 'mass'], cg_along=along, cg_across=values[group + 'cg_across'],
                    inertia=values[group + 'inertia'] if 'inertia' in fields else 0.0)
        return bodies

    def rod(self, length: Scalar, density: Scalar, *section: Scalar) -> Body:
        from fourbar_ros.mechanics.bodies import flat_bar, round_rod  # only for scenes with rods
        make: Callable[..., Body] = round_rod if self._section == SECTIONS[0] else flat_bar
        return make(length, density, *section)


# --- values that are allowed but probably in a wrong unit: millimetres, degrees ------------------

LONGEST = 20.0                      # [m]
LIGHTEST, DENSEST = 100.0, 25000.0  # [kg/m^3], from cork to beyond osmium
STEEL = 7850.0
FAR_THICKER = 5.0       # than a rod is long: in millimetres
ROUNDED = 1e-9          # [deg] off a whole number, of one that was given in degrees


def warnings_of(scene: Scene) -> list[str]:
    """Return a line for each value of a scene that is allowed but probably not meant."""
    return list(_warnings(scene))


def _warnings(scene: Scene) -> Iterator[str]:
    values, linkage = scene.values, scene.linkage
    long = [(name, value) for name, value in values.items()
            if isinstance(value, float) and abs(value) > LONGEST and not name.startswith(RODS)
            and unit_in(of_name(name), values) == 'm']
    if long:
        name, value = long[0]
        too = f' (and {len(long) - 1} more)' if len(long) > 1 else ''
        yield f'{name} = {value:g} m: did you mean {value * 1e-3:g}? Lengths are in metres{too}'

    density = values[RODS + 'density']          # in g/cm^3?
    if density < LIGHTEST:
        meant = f'{density * 1e3:g}' if LIGHTEST <= density * 1e3 <= DENSEST else f'{STEEL:g}'
        yield (f'{RODS}density = {density:g} kg/m^3 is lighter than cork: did you mean {meant}? '
               f'Steel has {STEEL:g}')
    if density > DENSEST:
        yield (f'{RODS}density = {density:g} kg/m^3 is denser than any metal: did you mean '
               f'{density * 1e-3:g}? Steel has {STEEL:g}')

    lengths = dict(zip(linkage.length_names, linkage.lengths))
    rods = [abs(lengths[link.length]) for link in linkage.LINKS
            if link.length in lengths and isnan(values[f'bodies.{link.name}.mass'])]
    shortest = min(rods, default=inf)
    for field, across in (('radius', 2.0), ('width', 1.0), ('thickness', 1.0)):
        value = values[RODS + field]
        if across * value > shortest:
            yield (f'{RODS}{field} = {value:g} m: the rods are thicker than the shortest of them '
                   f'is long, {shortest:g} m: ' + (
                       f'did you mean {value * 1e-3:g}?' if value > FAR_THICKER * shortest else
                       'give the mass and inertia of such links (bodies.LINK.mass)'))

    turn = linkage.period if linkage.period < inf else tau      # two turns at some change points
    wide = [(name, angle) for name, value in values.items()
            if name != 'drive.jump' and not name.endswith('.places')    # which have a unit
            for angle in (value if isinstance(value, list) else [value])
            if isinstance(angle, float) and abs(angle) > turn
            and unit_in(of_name(name), values) == 'rad'
            and abs(degrees(angle) - round(degrees(angle))) > ROUNDED]      # else a text, 720deg
    if wide:
        name, angle = wide[0]
        too = f' (and {len(wide) - 1} more)' if len(wide) > 1 else ''
        yield f'{name} = {angle:g} rad is more than a turn: did you mean {angle:g}deg?{too}'

    carried = scene.drive.carried_inertia       # with which the torque of the rest may be unstable
    if carried != 0.0 and linkage.bodies is not None:
        from fourbar_ros.extrema.over_input import OverInput  # few scenes search for extrema
        inertia = OverInput(linkage, 'inertia')
        assert inertia.least and inertia.most       # both are None of angles alone
        least, most = inertia.least.value, inertia.most.value
        beyond = max(abs(most - carried), abs(least - carried)) - carried
        if most == inf:
            yield (f'drive.carried_inertia = {carried:g}: the inertia at the input grows without '
                   'bound at the ends of the input: unstable there with any rotor')
        elif beyond > 0.0:
            yield (f'drive.carried_inertia = {carried:g}: the inertia at the input goes up to '
                   f'{most:.4g}: unstable with a rotor lighter than {beyond:.4g}; '
                   f'{0.5 * (least + most):.4g} would do with any')

    if linkage.elements:
        from fourbar_ros.scene.elements import beyond_tables, weak_springs  # few scenes have any
        yield from beyond_tables(values, linkage)
        yield from weak_springs(values, linkage)
    for joint, friction in linkage.friction:
        coefficient = getattr(friction, 'coefficient', 0.0)
        if coefficient > 1.0:
            yield (f'friction.{joint}.coefficient = {coefficient:g}: dry friction is mostly below '
                   '1')
