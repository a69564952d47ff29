"""What ``fourbar show`` prints."""
from __future__ import annotations

from math import degrees, radians, tau

from rich.console import Console
from rich.table import Table
from rich.text import Text

from . import scene as scenes
from .core import OPEN
from .core.extrema import find_extrema
from .core.quantities import select
from .core.status import STATUS_NAMES, evaluate

PIPE_WIDTH = 120
SIDES = {0: '', 1: 'from above', -1: 'from below'}      # how an end of the range is approached
MODE_NAMES = {1: '1 (crossed)', 2: '2 (open)'}


def show(path, mode=None, speed=None, at_deg=None, console=None):
    """Print the tables of a scene; ``at_deg``: an input angle [degrees] to evaluate."""
    scene = scenes.load(path)
    linkage = scene.linkage.in_mode(mode or scene.linkage.mode)
    speed = scene.drive.speed if speed is None else speed
    console = console or make_console()
    console.print(what_it_is(linkage, path))
    console.print()
    console.print(extremes_table(find_extrema(linkage, (), speed),
                                 f'extremes at {speed:g} rad/s, mode {MODE_NAMES[linkage.mode]}'))
    if linkage.bodies is None:
        console.print('no masses given, so no loads: see bodies.* in docs/node.md')
    if at_deg is not None:
        console.print()
        console.print(state_table(linkage, radians(at_deg), speed))


def make_console():
    """Return the console all verbs print to: as wide as the terminal, or enough for any table in a pipe."""
    console = Console(highlight=False)
    return console if console.is_terminal else Console(highlight=False, width=PIPE_WIDTH)


def plain_table(title, columns):
    """Return an empty table with these column heads; a head ending in ``>`` is right-aligned."""
    table = Table(title=Text(title), title_justify='left', box=None, padding=(0, 2, 0, 0), title_style='bold')
    for column in columns:
        table.add_column(Text(column.rstrip('>')), justify='right' if column.endswith('>') else 'left', no_wrap=True)
    return table


def _ranges(ranges):
    return ', '.join('full turns' if high - low >= tau else f'{degrees(low):.4f} to {degrees(high):.4f} deg'
                     for low, high in ranges)


def what_it_is(linkage, title):
    """Return the table of a linkage's own properties."""
    table = plain_table(str(title), ('', ''))
    table.show_header = False
    rows = [('lengths', '  '.join(f'a{i} {a:g}' for i, a in enumerate(linkage.lengths, 1)) + '  m'),
            ('class', linkage.classification),
            ('assembly mode', f'{MODE_NAMES[linkage.mode]}: sin(theta4 - beta) '
                              f'{">" if linkage.mode == OPEN else "<"} 0'),
            ('input range', _ranges(linkage.input_ranges)),
            ('output range', _ranges(linkage.output_ranges)),
            *((f'dead point, {"stretched" if point.stretched else "folded"}', f'theta1 {degrees(point.theta1):.4f} deg, '
               f'theta4 {degrees(point.theta4):.4f} deg') for point in linkage.dead_points),
            ('change-point margin', f'{linkage.change_point_margin:.6g} of the perimeter')]
    if linkage.bodies:
        rows += [(f'{name}', f'{body.mass:.6g} kg, {body.inertia:.6g} kg m^2, CG at '
                             f'({body.cg_along:g}, {body.cg_across:g}) m')
                 for name, body in linkage.bodies._asdict().items()]
    for row in rows:
        table.add_row(*row)
    return table


def extremes_table(extrema, title):
    """Return the table of a list of Extremum."""
    table = plain_table(title, ('quantity', 'kind', '', 'value>', 'unit', 'theta1 [rad]>', '[deg]>', ''))
    last = None
    for extremum in extrema:
        if last not in (None, extremum.quantity):
            table.add_section()
        table.add_row('' if extremum.quantity == last else extremum.quantity, str(extremum.kind),
                      'global' if extremum.is_global else '', f'{extremum.value:.10g}', extremum.unit,
                      f'{extremum.theta1:.8f}', f'{degrees(extremum.theta1):.4f}', SIDES[extremum.side])
        last = extremum.quantity
    return table


def state_table(linkage, theta1, omega1):
    """Return the table of all quantities at one input."""
    with_loads = linkage.bodies is not None
    status, motion, loads = evaluate(linkage, theta1, omega1, 0.0, with_loads)
    table = plain_table(f'at theta1 = {degrees(theta1):g} deg: {STATUS_NAMES[status]}',
                        ('quantity', 'value>', 'unit', ''))
    table.add_row('theta4', f'{degrees(motion.theta4):.8g}', 'deg', 'output link')
    table.add_row('beta', f'{degrees(motion.beta):.8g}', 'deg', 'coupler')
    table.add_row('transmission angle', f'{degrees(motion.transmission_angle):.8g}', 'deg', '')
    for quantity in select((), with_loads):
        table.add_row(quantity.name, f'{quantity.of(motion, loads):.10g}', quantity.unit, quantity.text)
    return table
