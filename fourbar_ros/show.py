"""What ``fourbar show`` prints."""
from __future__ import annotations

from math import degrees, radians, tau

from . import scene as scenes
from .core import FourBar
from .core.errors import UNITS, OutOfRange
from .core.extrema import find_extrema
from .core.inverted_slider import InvertedSlider
from .core.quantities import select
from .core.status import INVALID_INPUT, OUT_OF_RANGE, STATUS_NAMES, evaluate
from .tables import make_console, plain_table

SIDES = {0: '', 1: 'from above', -1: 'from below'}      # how an end of the range is approached
MODE_NAMES = {1: '1 (crossed)', 2: '2 (open)'}


def show(path, mode=None, speed=None, at=None, console=None):
    """Print the tables of a scene; ``at``: an input to evaluate [degrees], or [m] of a driven slide."""
    scene = scenes.load(path)
    linkage = scene.linkage.in_mode(mode or scene.linkage.mode)
    speed = scene.drive.speed if speed is None else speed
    console = console or make_console()
    quantities = select((), linkage, scene.point_quantities)
    # first, as it may raise
    state = None if at is None else state_table(linkage, at if linkage.is_driven_by_slide else radians(at), speed,
                                                quantities)
    console.print(what_it_is(linkage, path))
    console.print()
    console.print(extremes_table(find_extrema(linkage, quantities, speed),
                                 f'extremes at {speed:g} {rate_unit(linkage)}, mode {mode_name(linkage)}'))
    if linkage.bodies is None:
        console.print('no masses given, so no loads: see bodies.* in docs/node.md')
    if state:
        console.print()
        console.print(state)


def class_name(linkage):
    """Return the class of a linkage as text; of sliders also the kind and what is driven."""
    if isinstance(linkage, FourBar):
        return linkage.classification
    kind = 'inverted slider-crank' if isinstance(linkage, InvertedSlider) else 'slider-crank'
    return f'{kind}, {linkage.classification}, driven at its {linkage.input}'


def mode_name(linkage):
    """Return the assembly mode as text."""
    return MODE_NAMES[linkage.mode] if isinstance(linkage, FourBar) else str(linkage.mode)


def rate_unit(linkage):
    """Return the unit of the input's rate."""
    return f'{UNITS[linkage.input_coordinate.position]}/s'


def shown(name, value):
    """Return a position as text: angles in degrees."""
    return f'{value:.6g} m' if name == 'slide' else f'{degrees(value):.4f} deg'


def _ranges(name, ranges):
    return ', '.join('full turns' if name != 'slide' and high - low >= tau else f'{shown(name, low)} to {shown(name, high)}'
                     for low, high in ranges)


def what_it_is(linkage, title):
    """Return the table of a linkage's own properties."""
    table = plain_table(str(title), ('', ''))
    table.show_header = False
    driven = linkage.input_coordinate.position
    rows = [('lengths', '  '.join(f'{name} {length:g}' for name, length in zip(linkage.LENGTHS, linkage.lengths)) + '  m'),
            ('class', class_name(linkage)),
            ('assembly mode', mode_name(linkage)),
            ('input', f'{driven}: {_ranges(driven, linkage.input_ranges)}')]
    if hasattr(linkage, 'output_ranges'):
        rows.append(('output', f'theta4: {_ranges("theta4", linkage.output_ranges)}'))
    rows += [('dead point' + (f', {"stretched" if point.stretched else "folded"}' if hasattr(point, 'stretched') else ''),
              ', '.join(f'{name} {shown(name, value)}' for name, value in zip(point._fields, point[:2])))
             for point in linkage.dead_points]
    rows.append(('change-point margin', f'{linkage.change_point_margin:.6g} of the perimeter'))
    if linkage.bodies:
        rows += [(f'{name}', f'{body.mass:.6g} kg, {body.inertia:.6g} kg m^2, CG at '
                             f'({body.cg_along:g}, {body.cg_across:g}) m')
                 for name, body in linkage.bodies._asdict().items()]
    for row in rows:
        table.add_row(*row)
    return table


def extremes_table(extrema, title):
    """Return the table of a list of Extremum."""
    slides = any(extremum.slide == extremum.slide for extremum in extrema)
    table = plain_table(title, ('quantity', 'kind', '', 'value>', 'unit', *(('slide [m]>',) if slides else ()),
                                'theta1 [rad]>', '[deg]>', ''))
    last = None
    for extremum in extrema:
        if last not in (None, extremum.quantity):
            table.add_section()
        table.add_row('' if extremum.quantity == last else extremum.quantity, str(extremum.kind),
                      'global' if extremum.is_global else '', f'{extremum.value:.10g}', extremum.unit,
                      *((f'{extremum.slide:.8f}',) if slides else ()),
                      f'{extremum.theta1:.8f}', f'{degrees(extremum.theta1):.4f}', SIDES[extremum.side])
        last = extremum.quantity
    return table


def state_table(linkage, position, rate, quantities):
    """Return the table of the pose and of some quantities at one input; raises OutOfRange."""
    status, motion, loads = evaluate(linkage, position, rate, 0.0, linkage.bodies is not None)
    driven = linkage.input_coordinate.position
    if status == OUT_OF_RANGE:
        raise OutOfRange(driven, position, linkage.input_ranges)
    if status == INVALID_INPUT:
        linkage.motion(position, rate)       # raises where the input is not finite
    table = plain_table(f'at {driven} = {shown(driven, position)}: {STATUS_NAMES[status]}',
                        ('quantity', 'value>', 'unit', ''))
    bar = isinstance(linkage, InvertedSlider)
    for name, text in (('theta1', 'crank'), ('theta4', 'bar' if bar else 'output link'), ('beta', 'coupler'),
                       ('slide', 'block on the bar' if bar else 'slider'), ('transmission_angle', '')):
        if name in motion._fields:
            value, unit = shown(name, getattr(motion, name)).split()
            table.add_row(name, value, unit, text)
    for quantity in quantities:
        table.add_row(quantity.name, f'{quantity.of(motion, loads):.10g}', quantity.unit, quantity.text)
    return table
