# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``fourbar simulate``: run a scene whose motion follows from torque, faster than real time."""
from __future__ import annotations

from argparse import Namespace
from collections.abc import Iterator
from contextlib import contextmanager
from math import nan
from pathlib import Path
import time
from typing import Any, TYPE_CHECKING

from fourbar_ros.cli.common import add_verb, BAD, bar, SCENE_HELP
from fourbar_ros.scene.arguments import finite, positive

if TYPE_CHECKING:
    from fourbar_ros.scene.simulated import SimulatedScene

METHODS = ('auto', 'DOP853', 'LSODA', 'Radau', 'RK45', 'BDF')
EPILOG = """\
examples:
  fourbar simulate motor --until 2                 a motor starts the paper's crank-rocker
  fourbar simulate motor --until 2 -o bags/start   and the bag that its node would record
  fourbar simulate released --until 10             a linkage is let go and swings
  fourbar simulate released --until 1 --torque 20  the same with a constant torque
  fourbar simulate motor --until 2 --method Radau --tolerance 1e-10

The scene has drive.source: torque or motor; docs/dynamics.md lists what a drive can be. Every run
is compared with one at a tighter tolerance, and its energy must be constant but for the work of
drive and dampers. Exit code 3: it ends early at a limit of the input, or does not converge; the
summary says which.
"""


def add(verbs: Any) -> None:
    """Add the verb."""
    simulate = add_verb(verbs, 'simulate', 'run a scene whose motion follows from torque; extrema '
                                           'of speed and loads over the run',
                        'Integrate the motion that follows from the torque of a motor, weight and '
                        'springs, faster than\nreal time, and show the extrema of speed, torque '
                        'and loads over the run.', EPILOG)
    simulate.add_argument('scene', metavar='SCENE', help=SCENE_HELP)
    simulate.add_argument('--until', type=positive, required=True, metavar='T',
                          help='end of the run [s]; samples are taken at drive.rate')
    simulate.add_argument('--tolerance', type=positive, default=1e-8, metavar='X',
                          help='largest error of the position [rad], for a slide relative to its '
                               'size, and of the energy, relative (default 1e-8)')
    simulate.add_argument('--method', choices=METHODS, default='auto',
                          help='integrator of scipy; auto: the energy integral where it holds, '
                               'else DOP853, for stiff systems LSODA')
    simulate.add_argument('--torque', type=finite, default=nan, metavar='T',
                          help='constant torque [N m], for a slide force [N], for a scene with '
                               'drive.source: torque; default: none')
    simulate.add_argument('-o', '--output', type=Path, metavar='BAG',
                          help='bag to write, as the node would record it; requires ROS 2')
    simulate.set_defaults(run=_simulate)


def _simulate(arguments: Namespace) -> int:
    from fourbar_ros.dynamics.simulate import REACHED
    from fourbar_ros.report.simulated import print_summary
    from fourbar_ros.scene.scene import load
    from fourbar_ros.scene.simulated import simulate_scene
    scene, began = load(arguments.scene), time.process_time()
    _check_output(arguments.output)
    with _busy('integrating'):
        simulated = simulate_scene(scene, arguments.until, arguments.tolerance, arguments.method,
                                   arguments.torque)
    took = time.process_time() - began
    written = _written(simulated, arguments.output)
    print_summary(simulated, arguments.scene, arguments.tolerance, took)
    if written:
        print(f'wrote {written}')
    return 0 if simulated.run.status == REACHED else BAD


def _written(simulated: SimulatedScene, path: Path | None) -> Path | None:
    """Return the path of the bag of a run, None if none is wanted."""
    if path is None:
        return None
    from fourbar_ros.ros.offline import write_bag
    with bar('writing the bag', simulated.run.time.size) as progress:
        return write_bag(simulated, path.absolute(), progress)


def _check_output(path: Path | None) -> None:
    """Refuse a bag that exists before the work is done, not after."""
    if path is not None and path.exists():
        from fourbar_ros.errors import BagError
        raise BagError(f'{path}: exists already')


@contextmanager
def _busy(text: str) -> Iterator[None]:
    """Show on a terminal that there is work."""
    from rich.console import Console
    console = Console(stderr=True)
    if not console.is_terminal:
        yield
        return
    with console.status(text):
        yield
