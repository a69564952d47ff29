# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``fourbar balance``: counterweights for a scene."""
import argparse
from math import isnan
import warnings

from fourbar_ros.cli import common
from fourbar_ros.errors import SceneWarning
from fourbar_ros.scene.units import of, ValueInSI

DESCRIPTION = """\
Find counterweights that take shaking force, shaking moment, driving torque or joint reactions of
inertia away, at the constant speed of the scene's drive. With --minimize what springs and forces
over a position add is among these loads; weight is not. Without --minimize: full force balance
with the least added mass. With it: the least root mean square, or the least peak, that an added
mass can give; the printed bound proves how close to the best it is.
"""
EPILOG = """\
examples:
  fourbar balance paper                             no shaking force at all
  fourbar balance paper -o balanced.yaml            the same as a scene for the node
  fourbar balance paper --minimize moment --mass 3
  fourbar balance paper --minimize force moment torque --mass 3 --radius crank=0.2 output=0.3
  fourbar balance paper --minimize force --mass 2 --peak --plot before_after.png
  fourbar balance paper --minimize moment --mass 10 --front front.png
"""


def add(verbs: common.Verbs) -> None:
    verb = common.add_verb(verbs, 'balance', 'find counterweights for a scene, with a proof of '
                                             'how good', DESCRIPTION, EPILOG)
    common.add_scene(verb)
    verb.add_argument('--minimize', nargs='+', metavar='LOAD',
                      help='force, moment, torque or a joint reaction, as f21; if several, each '
                           'counts relative to its value before balancing')
    verb.add_argument('--mass', type=of('kg', least=0.0), metavar='KG',
                      help='with --minimize, which needs it: largest mass to be added [kg]')
    verb.add_argument('--peak', action='store_true',
                      help='with --minimize of one load: its largest magnitude instead of its '
                           'root mean square')
    verb.add_argument('--radius', nargs='+', type=_radius, default=[], metavar='[LINK=]M',
                      help='greatest distance of a counterweight from the first joint of its '
                           'link: M for every link that turns (default: half the longest '
                           'length), or instead LINK=M for each of those that get one')
    common.add_output(verb, '-o', '--out', metavar='SCENE', suffix='.yaml',
                      help='scene file to write')
    common.add_output(verb, '--plot', metavar='PICTURE', suffix='.png',
                      help=f'force, moment and torque before and after: {common.PICTURE_HELP}')
    common.add_output(verb, '--front', metavar='PICTURE', suffix='.png',
                      help='with --minimize: what remains for each mass up to --mass: '
                           f'{common.PICTURE_HELP}')
    verb.add_argument('--points', type=common.positive_integer, default=100, metavar='N',
                      help='points of --front (default 100)')
    verb.set_defaults(run=_run)


def _radius(text: str) -> tuple[str, ValueInSI]:
    """Return (link, radius [m]) of LINK=METRES; the link is '' for METRES, which is for all."""
    link, _, radius = text.rpartition('=')
    return link, of('m', above=0.0)(radius)


def _run(arguments: argparse.Namespace) -> None:
    from fourbar_lab import balancing
    from fourbar_lab.balancing.result import draw_changes, draw_front, scene_text, unit_of
    from fourbar_ros.scene.linkage import in_other_units
    from fourbar_ros.scene.scene import load
    from fourbar_ros.terminal import make_console, make_table
    scene = load(arguments.scene)
    loads = balancing.Loads(scene.linkage, scene.drive.speed)
    radii = dict(arguments.radius)
    if len(radii) < len(arguments.radius) or '' in radii and len(radii) > 1:
        raise balancing.BalanceError('--radius is one M for all links, or LINK=M once for each')
    if '' in radii or not radii:
        for_all = radii.get('', 0.5 * max(map(abs, scene.linkage.lengths)))
        radii = {link.name: for_all for link in scene.linkage.LINKS if link.turns}
    for line in in_other_units([('--radius', radius, 'm') for _, radius in arguments.radius
                                if not radius.unit], scene.linkage):
        warnings.warn(line, SceneWarning, stacklevel=2)
    sites = balancing.Places(loads, radii)
    names, most = arguments.minimize, arguments.mass        # loads, and the mass to be added [kg]
    if not names:
        if arguments.peak or arguments.front or most is not None:
            raise balancing.BalanceError('--mass, --peak and --front go with --minimize')
        balance = balancing.full_force_balance(sites)
        how = f'full force balance, at least {balance.bound:.6g} kg are needed'
    else:
        if most is None:
            raise balancing.BalanceError('--minimize needs --mass: how much may be added')
        if arguments.peak and (len(names) > 1 or arguments.front):
            raise balancing.BalanceError('--peak takes one load, and no --front')
        balance = (balancing.least_peak(sites, names[0], most) if arguments.peak
                   else balancing.least_rms(sites, names, most))
        unit = unit_of(loads, names[0]) if len(names) == 1 else 'relative'
        how = (f'least {"peak" if arguments.peak else "RMS"} of {" and ".join(names)}: '
               f'{balance.value:.9g} {unit}, and none below {balance.bound:.9g} is possible')
    if arguments.front:
        masses = [most * i / (arguments.points - 1 or 1) for i in range(arguments.points)]
        draw_front(names, balancing.front(sites, names, masses), arguments.front)
    # a workshop's digits; those behind them are the solver's, and the scene file's
    weights = [(weight.link, *(f'{value:.7g}' for value in weight[1:]))
               for weight in balance.counterweights]
    of_loads = [(change.name, change.unit,
                 *('not certain' if isnan(value) else f'{value:.6g}'
                   for value in (*change.rms, *change.peak)))
                for change in balancing.changes(loads, balance.moments)]
    console = make_console()
    console.print(f'{how}: {balance.added:.9g} kg added')
    if scene.linkage.elements and not names:
        console.print('of inertia: no masses take away what springs and forces over a position do')
    console.print()
    console.print(make_table('counterweights, from the first joint of their link',
                             ('link', 'mass [kg]>', 'along [m]>', 'across [m]>'), weights))
    console.print()
    console.print(make_table(loads.title, ('', 'unit', 'RMS before>', 'after>', 'peak before>',
                                           'after>'), of_loads))
    if arguments.out:
        arguments.out.write_text(scene_text(scene, balance, how), encoding='utf-8')
    if arguments.plot:
        draw_changes(loads, balance.moments, arguments.plot)
