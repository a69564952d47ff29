# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The mechanism of a scene: its kind or its dyads, its bodies, what acts on them."""
from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from math import inf, isnan, sqrt, tau
from typing import Any, TYPE_CHECKING

from fourbar_ros.errors import in_words, InvalidParameter, nearest, OutOfRange
from fourbar_ros.mechanics.bodies import Applied, Body, flat_bar, Gravity, round_rod, UNKNOWN_BASE
from fourbar_ros.mechanisms.kinds import kind_of, KINDS
from fourbar_ros.mechanisms.mechanism import LONGEST, Mechanism
from fourbar_ros.mechanisms.parts import JOINT_A, Link
from fourbar_ros.numerics.number_types import Scalar
from fourbar_ros.scene.parameters import member_of, of_name, unit_in
from fourbar_ros.scene.settings import LENGTHS, MACHINE, PARAMETERS, ParameterValues, TIMER

if TYPE_CHECKING:
    from fourbar_ros.scene.scene import Scene

# an error of a mechanism names parameters of these groups as the scene does
AS_IN_SCENE = 'linkage.', 'dyads.', 'cylinder', 'bodies.', 'external.'
RODS = 'bodies.rods.'
FIELDS_OF_BODY = 'mass', 'inertia', 'cg_along'       # of a link: each of them gives it a body
SECTIONS = ('radius',), ('width', 'thickness')       # of rods: round, rectangular
RODS_BY_SECTION: dict[tuple[str, ...], Callable[..., Body]] = dict(zip(
    SECTIONS, (round_rod, flat_bar)))
ROD_PARAMETERS = tuple(RODS + field for field in ('density', *SECTIONS[0], *SECTIONS[1]))
RENAMED = {'stroke': 'linkage.range', 'dyads': 'linkage.dyads',
           'name of a dyad': 'linkage.dyads',
           'length, density, radius': 'bodies.rods',
           'length, density, width, thickness': 'bodies.rods'}
GEOMETRY = 'linkage.', 'dyads.', 'cylinder'
MEMORY = 8
# {parameters of GEOMETRY: the newest mechanism with these}: a live change of masses and loads does
# not search for ranges and toggles again, which takes as long as hundreds of steps of machines
_newest: dict[str, Mechanism] = {}


def linkage_of(values: ParameterValues) -> Mechanism:
    """Return the mechanism of a scene; InvalidParameter names parameters as the scene does."""
    kind = values['linkage.kind']
    lengths = [] if kind == MACHINE else [length.name for length in KINDS[kind].LENGTHS]
    for length in LENGTHS:
        parameter = PARAMETERS[f'linkage.{length}']
        value = values[parameter.name]
        if length in lengths and isnan(value):
            raise InvalidParameter(parameter.name, None, f'must be given: {parameter.text}')
        if length not in lengths and not isnan(value) and value != parameter.default:
            raise InvalidParameter(parameter.name, value, f'linkage.kind {kind} has '
                                   + (f'{", ".join(lengths)} only' if lengths else 'dyads.*'))
    if kind == MACHINE and values['linkage.joints']:
        raise InvalidParameter('linkage.joints', values['linkage.joints'], 'a machine has '
                               'linkage.pivot, linkage.points and dyads.NAME.inner')
    key = repr([item for item in values.items() if item[0].startswith(GEOMETRY)])
    try:
        mechanism = _newest.get(key) or _unloaded(values)
        _check_links(values, mechanism)
        bodies: Any = bodies_of_links(values, mechanism.LINKS, dict(zip(
            mechanism.length_names, mechanism.lengths)), are_all_needed=kind != MACHINE)
        mechanism = mechanism.with_loads(
            bodies=bodies if kind == MACHINE else bodies and mechanism.BODIES(**bodies),
            gravity=_gravity(values),
            external=mechanism.EXTERNAL(**external_of(values, mechanism)))
        mechanism.prepare()
        if len(_newest) >= MEMORY:
            _newest.clear()
        _newest[key] = mechanism
        return mechanism
    except InvalidParameter as error:
        if error.name in values or error.name.startswith(AS_IN_SCENE):
            raise
        name = RENAMED.get(error.name, f'linkage.{error.name}')
        raise InvalidParameter(name, error.value, error.allowed) from None
    except (ArithmeticError, ValueError):
        raise InvalidParameter('linkage', kind, 'lengths and bodies are too large, too small or '
                               'too far apart to be computed with') from None


def _unloaded(values: ParameterValues) -> Mechanism:
    """Return the mechanism of a scene without bodies and loads."""
    name = values['linkage.kind']
    if name == MACHINE:
        from fourbar_ros.scene import machines  # only scenes of machines need these formulas
        return machines.machine_of(values)
    kind: Any = kind_of(name, values['linkage.input'])     # a class: arguments are its LENGTHS
    for only in ('linkage.dyads', 'linkage.output', 'linkage.carrier', 'linkage.pivot'):
        if values[only] != of_name(only).default:
            raise InvalidParameter(only, values[only], f'linkage.kind {MACHINE} alone has it')
    arguments = {length.name: values[f'linkage.{length.name}'] for length in kind.LENGTHS}
    if len(kind.INPUTS) > 1:
        arguments['input'] = values['linkage.input']
    elif values['linkage.input'] not in kind.INPUTS:
        inputs = dict.fromkeys([*kind.INPUTS, *kind_of(name, JOINT_A).INPUTS])
        raise InvalidParameter('linkage.input', values['linkage.input'],
                               f'linkage.kind {name} is driven at its {" or ".join(inputs)}')
    joints = kind.pins()
    if (names := values['linkage.joints']) and not (
            len({*names} - {''}) == len(names) == len(joints)):
        raise InvalidParameter('linkage.joints', names,
                               f'must be {len(joints)} different names, of {", ".join(joints)}')
    stroke = values['linkage.range']
    mechanism: Mechanism = kind(
        **arguments, mode=values['linkage.mode'], stroke=tuple(stroke) if stroke else None,
        joint_names=dict(zip(joints, names)))
    return mechanism


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


def require_masses(mechanism: Mechanism, what_needs_them: str) -> None:
    if mechanism.bodies is None:
        raise InvalidParameter('bodies.crank.mass', None, 'must be given (or bodies.rods): '
                               f'{what_needs_them} needs masses')


def external_of(values: ParameterValues, mechanism: Mechanism | type[Mechanism],
                applied: Callable[..., Any] = Applied) -> dict[str, Any]:
    """Return {link: external force}, made by ``applied`` of the parameters external.LINK.*."""
    return {link: applied(**{field: values[f'external.{link}.{field}']
                             for field in Applied.__dataclass_fields__})
            for link in mechanism.EXTERNAL._fields}


def bodies_of_links(values: ParameterValues, links: Sequence[Link], lengths: Mapping[str, Scalar],
                    are_all_needed: bool, make_body: Callable[..., Body] = Body,
                    make_rods: Mapping[tuple[str, ...], Callable[..., Body]] = RODS_BY_SECTION
                    ) -> dict[str, Body] | None:
    """
    Return {link: Body} by bodies.LINK.* or, without these, by bodies.rods.*; None without masses.

    ``lengths``: {name of a length: its value [m]}. ``are_all_needed``: a link without a mass is
    refused. Values of any arithmetic have makers of their own; of rods {their section: maker}.
    """
    def has(name: str) -> bool:
        return not isinstance(values[name], float) or not isnan(values[name])

    round_section, bar_section = SECTIONS
    section = bar_section if any(has(RODS + field) for field in bar_section) else round_section
    of_rods = [RODS + field for field in ('density', *section)]     # their parameters
    has_rods = any(map(has, ROD_PARAMETERS))
    if section == bar_section and has(RODS + 'radius'):
        raise InvalidParameter(RODS + 'radius', values[RODS + 'radius'],
                               'give either the radius of round rods or width and thickness')
    for name in of_rods if has_rods else ():
        if not has(name):
            raise InvalidParameter(name, None, 'must be given: rods have density and radius, or '
                                   'density, width and thickness')
    if not has_rods and not any(has(f'bodies.{link.name}.mass') for link in links):
        return None
    bodies: dict[str, Body] = {}
    for link in links:
        group = f'bodies.{link.name}.'
        fields = [field for field in FIELDS_OF_BODY if has(group + field)]
        if has_rods and link.length and 'mass' not in fields:
            if fields:
                raise InvalidParameter(group + fields[0], values[group + fields[0]], 'needs the '
                                       'mass of the link: it is a rod (bodies.rods)')
            bodies[link.name] = make_rods[section](lengths[link.length],
                                                   *(values[name] for name in of_rods))
        elif fields or are_all_needed:
            for field in ('mass', 'inertia') if link.turns else ('mass',):
                if field not in fields:
                    raise InvalidParameter(
                        group + field, None, 'must be given: loads need mass'
                        f'{" and inertia" if link.turns else ""} of the {link.name}')
            along = (values[group + 'cg_along'] if 'cg_along' in fields
                     else 0.5 * lengths[link.length] if link.length else 0.0)
            bodies[link.name] = make_body(
                values[group + 'mass'], cg_along=along, cg_across=values[group + 'cg_across'],
                inertia=values[group + 'inertia'] if 'inertia' in fields else 0.0)
    return bodies


# --- values that are allowed but probably in a wrong unit: millimetres, degrees ------------------

LIGHTEST, DENSEST = 100.0, 25000.0  # [kg/m^3], from cork to beyond osmium
STEEL, HEAVIEST = 7850.0, 100.0     # [kg/m^3], [m/s^2] some times the earth's gravity
FAR_THICKER = 5.0       # than a rod is long: in millimetres
FAR, FAR_OUT = 50.0, 100.0      # as often the longest length: a point, a radius of gyration
TYPED = '.9g'           # as many digits as are typed; an angle that was converted has more


def in_other_units(quantities: Iterable[tuple[str, float, str]], linkage: Mechanism
                   ) -> Iterator[str]:
    """
    Yield a line on lengths that are likely in millimetres, and one on angles in degrees.

    ``quantities``: (parameter, value, its SI unit) of those that were given without a unit.
    """
    turn = linkage.period if linkage.period < inf else tau      # two turns at some change points
    far = min(LONGEST, FAR * longest_of(linkage))
    long, wide = list[tuple[str, float]](), list[tuple[str, float]]()
    for name, value, unit in quantities:
        if unit == 'm' and abs(value) > (LONGEST if name.startswith('frame.') else far):
            long.append((name, value))
        elif unit == 'rad' and abs(value) > turn and float(format(value, TYPED)) == value:
            wide.append((name, value))
    more_long, more_wide = (f' (and {len(lines) - 1} more)' if len(lines) > 1 else ''
                            for lines in (long, wide))
    for name, value in long[:1]:
        yield (f'{name} = {value:g} m: did you mean {value * 1e-3:g}? Lengths are in metres'
               + more_long)
    for name, angle in wide[:1]:
        yield f'{name} = {angle:g} rad is more than a turn: did you mean {angle:g}deg?{more_wide}'


def longest_of(linkage: Mechanism) -> float:
    return max(map(abs, linkage.lengths), default=inf)


def _without_unit(scene: Scene) -> Iterator[tuple[str, float, str]]:
    """Yield (parameter, value, its SI unit) of all numbers that were given without a unit."""
    for name, value in scene.values.items():
        # a step may be more than a turn; places have a unit of their own
        if (name in scene.with_unit or name == 'drive.jump'
                or name.startswith(RODS) or name.endswith('.places')):
            continue
        numbers = value if isinstance(value, list) else [value]
        units = [unit_in(of_name(name), scene.values)] * len(numbers)
        if name == 'joint_states.offsets':
            units = [joint.coordinate.unit for joint in scene.linkage.JOINTS]
        yield from ((name, number, unit) for number, unit in zip(numbers, units)
                    if isinstance(number, float))


def links_without_mass(mechanism: Mechanism) -> list[Link]:
    """Return the links that have neither mass nor inertia; [] without masses."""
    bodies: dict[str, Body] = mechanism.bodies._asdict() if mechanism.bodies else {}
    return [link for link in mechanism.LINKS if link.name in bodies
            and bodies[link.name].mass == bodies[link.name].inertia == 0.0]


def warnings_of(scene: Scene) -> Iterator[str]:
    """Yield a line for each value of a scene that is allowed but probably not meant."""
    values, linkage = scene.values, scene.linkage
    yield from in_other_units(_without_unit(scene), linkage)

    for name in ('gravity.x', 'gravity.y'):
        if abs(values[name]) > HEAVIEST and name not in scene.with_unit:
            yield f'{name} = {values[name]:g} m/s^2: did you mean {values[name]:g} mm/s^2?'

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

    longest = longest_of(linkage)
    for name, body in (linkage.bodies._asdict() if linkage.bodies else {}).items():
        parameter = f'bodies.{name}.inertia'
        if (body.mass and parameter not in scene.with_unit and not isnan(values[parameter])
                and body.inertia > body.mass * (FAR_OUT * longest)**2):
            yield (f'{parameter} = {body.inertia:g} kg m^2 is that of {body.mass:g} kg at a '
                   f'distance of {sqrt(body.inertia / body.mass):.3g} m: did you mean '
                   f'{body.inertia:g} kg mm^2?')

    line = leaves_range(scene)
    if line and not linkage.stroke and scene.drive.speed != of_name('drive.speed').default:
        yield line

    if linkage.bodies is not None and not isnan(density) and any(
            values[f'gravity.{axis}'] for axis in 'xy'):
        massless = [link.name for link in linkage.LINKS if not link.turns
                    and not getattr(linkage.bodies, link.name).mass]
        if massless:
            yield (f'bodies: {", ".join(massless)} without mass, as bodies.rods is of rods alone: '
                   f'give bodies.{massless[-1]}.mass')

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
        from fourbar_ros.scene import elements  # few scenes have any
        yield from elements.beyond_tables(values, linkage)
        yield from elements.doubtful_springs(values, linkage)
    for joint, friction in linkage.friction:
        coefficient = getattr(friction, 'coefficient', 0.0)
        if coefficient > 1.0:
            yield (f'friction.{joint}.coefficient = {coefficient:g}: dry friction is mostly below '
                   '1')
        radius = getattr(friction, 'radius', 0.0)
        if radius > longest:
            yield (f'friction.{joint}.radius = {radius:g} m: the pin is thicker than all is long: '
                   f'did you mean {radius * 1e-3:g}?')


def leaves_range(scene: Scene) -> str:
    """Return how the timer drives the input out of its ranges, in a line; empty if it does not."""
    linkage, drive = scene.linkage, scene.drive
    if drive.source != TIMER or linkage.turns_fully:
        return ''
    unit = linkage.input_coordinate.unit
    allowed = in_words(linkage.input_ranges, unit)
    policy = f'(drive.out_of_range: {drive.out_of_range})'
    try:
        linkage.motion(drive.start)
    except OutOfRange:
        return f'drive.start = {drive.start:g} {unit} is outside {allowed} {policy}'
    return '' if not drive.speed else (
        f'drive.speed = {drive.speed:g} {unit}/s: the input cannot turn fully, the timer drives '
        f'it out of {allowed} {policy}')
