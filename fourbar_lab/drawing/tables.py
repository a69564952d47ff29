# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Tables of a linkage's properties and of extrema; words for class, mode and units."""
from collections.abc import Sequence
from dataclasses import replace
from math import degrees, isfinite, pi, tau

from fourbar_lab.drawing.poses import in_degrees, ranges_in_words, shown, ten_digits
from fourbar_lab.drawing.record import ANGLE, counted, Intervals, LinkageRecord, properties_of
from fourbar_ros import Base, Mechanism
from fourbar_ros.extrema.find import Extremum, SIDES
from fourbar_ros.extrema.proof import INTERVALS
from fourbar_ros.mechanics.bodies import field_of
from fourbar_ros.mechanisms.elements import BOTH, PositionForce, TorsionSpring
from fourbar_ros.mechanisms.parts import Coordinate
from fourbar_ros.scene.units import in_unit
from fourbar_ros.terminal import make_table
import numpy as np
from rich.table import Table

# [rad, m] how near a jump two values are taken, and how far they are apart, over the largest load
BESIDE, JUMP = 1e-9, 1e-7
FULL_TURN = tau * (1.0 - 1e-9)      # [rad] ranges from this width on are called full turns
NO_WEIGHT = 'weight', 'left out (gravity 0)'         # name and text of a row


def rates_in_words(linkage: Mechanism, speed: float, acceleration: float = 0.0,
                   between: str = ' and ') -> str:
    """Return speed, and acceleration if there is one: '10 rad/s (95.493 rpm) and 2 rad/s^2'."""
    unit = linkage.input_coordinate.unit
    turns = f' ({in_unit(speed, "rad/s", "rpm"):.6g} rpm)' if unit == 'rad' else ''
    if acceleration == 0.0:
        return f'{speed:g} {unit}/s{turns}'
    return f'{speed:g} {unit}/s{turns}{between}{acceleration:g} {unit}/s^2'


def _ranges(coordinate: Coordinate, ranges: Intervals) -> str:
    """Return ranges [rad or m] as text: 'theta1: 30.0000 to 60.0000 deg'."""
    if coordinate.unit == 'rad' and any(high - low >= FULL_TURN for low, high in ranges):
        return f'{coordinate.position}: full turns'
    return f'{coordinate.position}: {ranges_in_words(coordinate, ranges)}'


def linkage_table(linkage: Mechanism, scene: object) -> Table:
    return make_table('', ('', ''), [('scene', str(scene)), *facts(linkage)])


def facts(linkage: Mechanism) -> list[tuple[str, str]]:
    """Return rows (name, text) of a linkage's own properties: lengths, class, limits, masses."""
    properties = properties_of(linkage)
    driven = linkage.input_coordinate
    coordinates = {coordinate.position: coordinate for coordinate in (
        driven, *(output.coordinate for output in linkage.outputs))}
    lengths = [f'{name} {length:g} m' for name, length in properties['lengths'].items()]
    rows = [('lengths', '  '.join(lengths)),
            *([('in doubt', linkage.doubt)] if linkage.doubt else []),
            ('class', properties['class']), ('assembly mode', properties['mode_name']),
            *([('change point', linkage.branch_in_words)] if linkage.branch_in_words else []),
            ('input', _ranges(driven, linkage.input_ranges))]
    for output in properties['outputs']:
        ratio, least_at, most_at = (output[name] for name in ('time_ratio', 'least_at', 'most_at'))
        words = f', time ratio {ratio:.6g}' if isfinite(ratio) else ''
        if linkage.turns_fully and not words:
            words = ''.join(f', no time ratio: {end} at {len(inputs)} inputs'
                            for end, (inputs,) in (('least', least_at), ('greatest', most_at))
                            if len(inputs) > 1)
        rows.append(('output', f'{_ranges(coordinates[output["name"]], output["ranges"])}, in '
                     f'this mode{words}'))
    output = properties['outputs'][0]
    if output['unit'] == 'm':
        rows += [('stroke', f'{high - low:.6g} m: least at {driven.position} '
                  f'{", ".join(shown(driven, x) for x in least_at)}, greatest at '
                  f'{", ".join(shown(driven, x) for x in most_at)}')
                 for (low, high), least_at, most_at in zip(
                     output['ranges'], output['least_at'], output['most_at'])]
    for point in properties['dead_points']:
        kind = ''
        if 'stretched' in point:
            kind = ', stretched' if point['stretched'] else ', folded'
        rows.append((f'dead point{kind}', ', '.join(
            f'{name} {shown(coordinates[name], value)}' for name, value in point.items()
            if name in coordinates)))
    margin = 'of the perimeter'
    if hasattr(linkage, 'stages'):
        unit = f'of {linkage.input_unit:g} m' if linkage.is_driven_by_slide else 'rad'
        margin = f'{unit}; the nearer to 0, the faster the links pass their flat pose'
    toggles = [f'{shown(driven, end)}{_dyad_at(linkage, end)}' for end in properties['toggles']]
    rows += [('toggle', f'{driven.position} {", ".join(toggles)}' if toggles
              else 'none within the range of the input'),
             *(_transmission_angle(driven, name, angle)
               for name, angle in properties['transmission_angles'].items()),
             ('change-point margin', f'{properties["change_point_margin"]:.6g} {margin}')]
    return [*rows, *(_masses(linkage, properties) if linkage.bodies else [])]


def _masses(linkage: Mechanism, properties: LinkageRecord) -> list[tuple[str, str]]:
    rows = [(name, f'{body["mass"]:.6g} kg, {body["inertia"]:.6g} kg m^2, CG at '
                   f'({body["cg_along"]:g}, {body["cg_across"]:g}) m'
                   + ', a point mass at its first joint' * (
                       body['cg_along'] == body['cg_across'] == body['inertia'] == 0.0
                       and linkage.link(name).turns)
                   if (body['mass'], body['inertia']) != (0.0, 0.0) else 'no mass')
            for name, body in properties['bodies'].items()]
    if not any(field_of(linkage.gravity)) and not isinstance(linkage.gravity, Base):
        rows.append(NO_WEIGHT)
    inertia = properties['inertia_at_input']
    driven, unit = linkage.input_coordinate, 'kg' if linkage.is_driven_by_slide else 'kg m^2'
    least = f'{inertia["least"]:.6g} {unit} at {shown(driven, inertia["least_at"])}'
    ends = ', '.join(shown(driven, end) for end in inertia['unbounded_at'])
    words = (f'{least}, unbounded at {ends}; no finite mean' if ends else
             f'{least} to {inertia["most"]:.6g} {unit} at {shown(driven, inertia["most_at"])}, '
             f'mean {inertia["mean"]:.6g} {unit}')
    mean = properties['held_rigid_mean']
    return [*rows, ('inertia at the input', words),
            ('held rigid, mean', f'{mean["mass"]:.6g} kg at ({mean["x"]:.6g}, {mean["y"]:.6g}) m, '
                                 f'{mean["inertia"]:.6g} kg m^2: base.carried')]


def _dyad_at(linkage: Mechanism, end: float) -> str:
    """Return ' (dyad NAME)' of the dyad of a machine that stops it at an end of the input."""
    limits = [limit for bound in getattr(linkage, 'limits', ()) if bound for limit in bound]
    if not limits:
        return ''
    nearest = min(limits, key=lambda limit: abs(linkage.distance(limit.x, end)))
    return f' (dyad {nearest.dyad})'


def _transmission_angle(driven: Coordinate, name: str, angle: LinkageRecord) -> tuple[str, str]:
    words = in_degrees(angle['most'])
    if angle['least'] < angle['most']:
        words = (f'{degrees(angle["least"]):.4f} to {words}; worst deviation from 90 deg: '
                 f'{degrees(abs(angle["worst"] - 0.5 * pi)):.1f} deg at '
                 f'{driven.position} {shown(driven, angle["worst_at"])}')
    return f'transmission angle{name.removeprefix(ANGLE).replace("_", " ")}', words


def extrema_table(linkage: Mechanism, extrema: Sequence[Extremum], title: str) -> Table:
    """Return the table of extrema: value, place in rad and degrees (and slide), a block each."""
    slides = any(extremum.slide == extremum.slide for extremum in extrema)
    driven = linkage.input_coordinate.position
    driven = driven if driven.startswith('theta') else 'theta1'
    table = make_table(title, ('quantity', 'kind', '', 'value>', 'unit',
                               *(('slide [m]>',) if slides else ()),
                               f'{driven} [rad]>', '[deg]>', ''))
    last = None
    for extremum in extrema:
        if last not in (None, extremum.quantity):
            table.add_row()
        theta1 = counted(linkage, extremum.theta1)
        table.add_row('' if extremum.quantity == last else extremum.quantity, str(extremum.kind),
                      'global' if extremum.is_global else '', ten_digits(extremum.value),
                      extremum.unit,
                      *((f'{extremum.slide:.8f}',) if slides else ()),
                      f'{theta1:.8f}', f'{degrees(theta1):.4f}',
                      SIDES[extremum.side])
        last = extremum.quantity
    return table


def drive_in_words(linkage: Mechanism, drive: LinkageRecord, speed: float,
                   acceleration: float = 0.0) -> list[tuple[str, str]]:
    """Return rows (name, text) that size a drive, from :func:`.record.drive_of` at its rates."""
    driven, force = linkage.input_coordinate, 'N' if linkage.is_driven_by_slide else 'N m'
    lines = list[tuple[str, str]]()
    if effort := drive.get('effort'):
        at = f'at {shown(driven, effort["peak_at"])}'
        lines.append(('drive', f'peak {effort["peak"]:.6g} {force} {at}, rms '
                      f'{effort["root_mean_square"]:.6g} {force}, peak power '
                      f'{effort["peak_power"]:.6g} W {at}, '
                      f'{rates_in_words(linkage, speed, acceleration)}'))
        if isfinite(drive['cycle']['work']):
            lines.append(('cycle', _cycle(linkage, drive['cycle'])))
        pin = drive['worst_pin']
        load = f' ({pin["load"]})' if pin['load'] != pin['joint'] else ''
        lines.append(('worst pin', f'{pin["joint"]}{load} {pin["force"]:.6g} N at '
                      f'{shown(driven, pin["at"])}'))
    if 'locks' in drive:
        lines.append(('locks', '; '.join(
            f'{shown(driven, each["from"]).split()[0]} to {shown(driven, each["to"])} '
            f'({", ".join(each["joints"])})' for each in drive['locks']) + (
                ': without loads there, and without their extrema' if drive['locks'] else
                'nowhere')))
    for name in drive:
        if name.startswith(('holding', 'mechanical')):
            record = drive[name]
            least, most = (f'{record[end]:.6g} {record["unit"]}'.rstrip()
                           for end in ('least', 'most'))
            ends = (f'{least} at {shown(driven, record["least_at"])} to {most} at '
                    f'{shown(driven, record["most_at"])}' if least != most else least)
            free = 'without friction ' if 'locks' in drive else ''
            lines.append(('holding' if record['unit'] == force else 'advantage', free + ends))
    if wheel := drive.get('flywheel'):
        lines.append(('flywheel', f'{wheel["inertia"]:.6g} kg m^2 for a fluctuation of at most '
                      f'{100.0 * wheel["most"]:g} %, with a constant torque of '
                      f'{wheel["torque"]:.6g} N m'))
    if rest := drive.get('at_rest'):
        lines.append(('at rest', _at_rest(linkage, rest)))
    return lines


def _cycle(linkage: Mechanism, cycle: LinkageRecord) -> str:
    words = f'{cycle["work"]:.6g} J'
    if linkage.friction:
        words += f' = {cycle["without_friction"]:.6g} J without friction + ' + (
            f'{cycle["friction"]:.6g} J friction')
        if cycle['without_friction'] and isfinite(cycle['efficiency']):
            words += f', efficiency {cycle["efficiency"]:.6g}'
    if not cycle['without_friction'] and (linkage.friction or linkage.elements):
        words += ', no force takes work out over a cycle'
    if cycle['without_friction'] < 0.0:
        words += ', the loads drive it (is the sign of a force wrong?)'
    return f'{words}, mean power {cycle["mean_power"]:.6g} W'


def _at_rest(linkage: Mechanism, rest: LinkageRecord) -> str:
    driven, unit = linkage.input_coordinate, 'N' if linkage.is_driven_by_slide else 'N m'
    at = shown(driven, rest['at'])
    if not linkage.friction:
        return f'{at}: {rest["lower"]:.6g} {unit} holds it'
    ways = list[str]()
    for drive, beyond, way, free in ((rest['lower'], 'below', -1, 'negative'),
                                     (rest['upper'], 'above', 1, 'positive')):
        moves = [f'{name} {"grows" if sense > 0 else "falls" if sense < 0 else "turns back"}'
                 for name, sense in ((driven.position, way), (rest['output'], way * rest['way']))]
        ways.append(f'{drive:.6g} {unit} ({beyond} it {", ".join(moves)})' if isfinite(drive) else
                    f'any {free} {unit} (it locks)')
    return f'{at}, with friction: stays from {" to ".join(ways)}'


def jumps_in_words(linkage: Mechanism, names: Sequence[str], extrema: Sequence[Extremum],
                   rates: tuple[float, float]) -> str:
    """
    Return a line on what jumps where loads have values from below and from above, if any have.

    ``names``: of the elements; ``rates``: rate and acceleration of the input.
    """
    sided = {(extremum.quantity, extremum.input, extremum.side) for extremum in extrema
             if extremum.side and isfinite(extremum.value)}
    inputs = sorted({x for name, x, side in sided if (name, x, -side) in sided})

    def jumps(mechanism: Mechanism) -> list[bool]:
        """Return at which inputs any load of a mechanism jumps."""
        sides = np.add.outer([-BESIDE, BESIDE], inputs)
        loads = np.array([np.broadcast_to(load, sides.shape)
                          for load in mechanism.loads(sides, *rates)])
        away = np.abs(loads[:, 1] - loads[:, 0]).max(axis=0)
        return list(away > JUMP * np.abs(loads).max(axis=(0, 1)))
    causes = dict[str, list[bool]]()
    free = linkage.without_friction
    for name, element in zip(names, linkage.elements) if inputs else ():
        at = jumps(free.with_elements(element))
        if isinstance(element, TorsionSpring):
            causes[f'{name} comes round'] = at
        elif isinstance(element, PositionForce):
            steps = at
            if element.when != BOTH and any(at):
                steps = jumps(free.with_elements(replace(element, when=BOTH)))
                causes[f'{name} begins or ends (when: {element.when})'] = [
                    is_jump and not is_step for is_jump, is_step in zip(at, steps)]
            causes[f'{name} steps'] = [a and b for a, b in zip(at, steps)]
    if linkage.friction:
        causes['friction changes its direction'] = jumps(linkage.with_elements())
    where = [shown(linkage.input_coordinate, x) for x in inputs]
    words = [f'{cause} at {", ".join(text for text, is_here in zip(where, at) if is_here)}'
             for cause, at in causes.items() if any(at)]
    return (f'from below, from above: loads jump, both values count: {"; ".join(words)}'
            if words else '')


def proofs_in_words(extrema: Sequence[Extremum]) -> str:
    """Return a line for each way in which extrema are proved, or not, with the quantities."""
    names: dict[str, dict[str, None]] = {}
    for extremum in extrema:
        if extremum.proof:
            text = extremum.proof.replace(INTERVALS, 'proved complete')
            names.setdefault(text, {})[extremum.quantity] = None
    return '\n'.join(f'{proof}: {", ".join(of)}' for proof, of in names.items())
