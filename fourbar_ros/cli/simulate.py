# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``fourbar simulate``: run a scene whose motion follows from torque, faster than real time."""
from argparse import Namespace
from math import inf, nan
from pathlib import Path

from fourbar_ros.cli.common import add_scene, add_verb, BAD, bar, Verbs
from fourbar_ros.scene.units import of, require
from fourbar_ros.terminal import make_console, make_table

METHODS = ('auto', 'DOP853', 'LSODA', 'Radau', 'RK45', 'BDF')
MOST = 3_000_000        # evaluations of the equation of motion, by default
EPILOG = """\
examples:
  fourbar simulate motor --until 2                 a motor starts the paper's crank-rocker
  fourbar simulate motor --until 2 -o bags/start   and the bag that its node would record
  fourbar simulate released --until 10             a linkage is let go and swings
  fourbar simulate released --until 1 --torque 20  the same with a constant torque
  fourbar simulate motor --until 2 --method Radau --tolerance 1e-10

The scene has drive.source: torque or motor; docs/dynamics.md lists what a drive can be. Every run
is compared with one at a tighter tolerance, and its energy must be constant but for the work of
drive and dampers. Exit code 3: it ends early at a limit of the input, does not converge, or gives
up as it needs more evaluations or time than allowed; the summary says which.
"""


def add(verbs: Verbs) -> None:
    simulate = add_verb(verbs, 'simulate', 'run a scene whose motion follows from torque; extrema '
                                           'of speed and loads at its samples',
                        'Integrate the motion that follows from the torque of a motor, weight and '
                        'springs, faster than\nreal time, and show the extrema of speed, torque '
                        'and loads at its samples.', EPILOG)
    add_scene(simulate)
    simulate.add_argument('--until', type=of('s', above=0.0), required=True, metavar='T',
                          help='end of the run [s]; samples are taken at drive.rate')
    simulate.add_argument('--tolerance', type=of(above=0.0), default=1e-8, metavar='X',
                          help='largest error of the position [rad], for a slide relative to its '
                               'size, and of the energy, relative (default 1e-8)')
    simulate.add_argument('--method', choices=METHODS, default='auto',
                          help='integrator of scipy; auto: DOP853, or LSODA where a shaft or '
                               'a drive makes the system stiff')
    simulate.add_argument('--evaluations', type=of(above=0.0), default=MOST, metavar='N',
                          help='most evaluations of the equation of motion in all runs '
                               f'(default {MOST:g}); a run that needs more gives up')
    simulate.add_argument('--seconds', type=of('s', above=0.0), default=inf, metavar='T',
                          help='most time of this machine that the runs may take [s] '
                               '(default: any)')
    simulate.add_argument('--torque', type=of('N m', 'N'), default=nan, metavar='T',
                          help='constant torque [N m], for a slide force [N], for a scene with '
                               'drive.source: torque; default: none')
    simulate.add_argument('-o', '--output', type=Path, metavar='BAG',
                          help='bag to write, as the node would record it; requires ROS 2')
    simulate.set_defaults(run=_simulate)


def _simulate(arguments: Namespace) -> int:
    from fourbar_ros.dynamics.run import REACHED
    from fourbar_ros.errors import BagError
    from fourbar_ros.scene.scene import load
    from fourbar_ros.scene.simulated import simulate_scene
    scene, out = load(arguments.scene), arguments.output
    if out is not None and out.exists():         # refused before the work is done, not after
        raise BagError(f'{out}: exists already')
    require('--torque', arguments.torque, 'N' if scene.linkage.is_driven_by_slide else 'N m')
    with bar('integrating', 1.0) as show:       # goes back when another run begins
        simulated = simulate_scene(scene, arguments.until, arguments.tolerance, arguments.method,
                                   arguments.torque, evaluations=arguments.evaluations,
                                   seconds=arguments.seconds, progress=show)
    if out is not None:
        from fourbar_ros.ros.offline import write_bag
        with bar('writing the bag', simulated.run.time.size) as step:
            out = write_bag(simulated, out.absolute(), step)
    run, console, unit = simulated.run, make_console(), scene.linkage.input_coordinate.unit
    console.print(f'{arguments.scene}: {run.time[-1]:g} s, {run.time.size} samples.')
    checked = (f'error of the position up to {run.error:.2g} {unit}, energy constant within '
               f'{run.drift:.2g}; asked for {arguments.tolerance:g}')
    reason = f'{run.reason}; ' if run.reason else ''
    console.print(f'{run.status}: {reason}{run.method}, {checked}.')
    console.print(f'At the end the input is at {run.position[-1]:.10g} {unit} with '
                  f'{run.rate[-1]:.10g} {unit}/s.')
    if speeds := simulated.speeds_of_last_turn():
        low, high = speeds
        console.print(f'Speed at the samples of the last turn: {low:.6g} to {high:.6g} {unit}/s, '
                      f'coefficient of fluctuation {2.0 * (high - low) / abs(low + high):.4g}.')
    if run.system.mechanism.friction:
        console.print(f'Friction took {run.states.dissipated[-1]:.6g} J, smooth within '
                      f'{run.system.mechanism.slip_speed:g} {unit}/s.')
    for stuck in run.stuck(1.0 / scene.drive.rate):
        console.print(f'Stuck from {stuck.begin:.6g} to {stuck.end:.6g} s: it crept '
                      f'{stuck.crept:.2g} {unit}.')
    modes = sorted(set(run.modes.tolist()))
    if len(modes) > 1:
        console.print(f'The motion goes through both assembly modes, {modes[0]} and {modes[1]}.')
    console.print()
    console.print(make_table(
        'extrema at the samples',
        ('quantity', 'unit', 'lowest>', 'at [s]>', 'highest>', 'at [s]>'),
        [(peak.name, peak.unit, f'{peak.low:.6g}', f'{peak.low_at:g}', f'{peak.high:.6g}',
          f'{peak.high_at:g}') for peak in simulated.peaks()]))
    if out is not None:
        print(f'wrote {out}')
    return 0 if run.status == REACHED else BAD
