# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``fourbar import``: the planar loops of a robot's MJCF or URDF as scenes."""
from argparse import ArgumentTypeError, Namespace
from pathlib import Path
from typing import Any

from fourbar_ros.cli.common import add_output, add_verb, BAD, Verbs
from fourbar_ros.scene.units import of

EPILOG = """\
examples:
  fourbar import hand.xml                                what loops there are, and of what kind
  fourbar import hand.xml -o hand.yaml --check           scenes, compared with MuJoCo
  fourbar import leg.urdf --close rod_end,foot_ball --drive knee --at knee=-40 -o leg.yaml

Each loop becomes a scene in which the node is a relay for the robot's passive joints. What the
file leaves open is asked for, never guessed: which joint drives, which to hold of several degrees
of freedom, a pose from which the assembly mode can be read. docs/robots.md has the rest.

exit code 3: a loop was refused, lacks the mass of meshes, or is not as MuJoCo has it.
"""


def add(verbs: Verbs) -> None:
    verb = add_verb(verbs, 'import', "write a robot's closed loops as scenes",
                    'Read the planar closed loops of a robot, from MJCF or URDF, and write them '
                    'as scenes.', EPILOG)
    verb.add_argument('file', type=Path, metavar='FILE', help='MJCF (.xml) or URDF')
    add_output(verb, '-o', '--out', metavar='SCENES', suffix='.yaml',
               help='scene file to write, with a section for each loop; default: report only')
    verb.add_argument('--loop', default='', metavar='JOINT',
                      help='only the loop that has this joint or link')
    verb.add_argument('--drive', action='append', default=[], metavar='JOINT',
                      help='driven joint of a loop, if the file has no motor there')
    verb.add_argument('--base', default='', metavar='LINK',
                      help="link that carries the loop; default: that towards the robot's root")
    verb.add_argument('--close', action='append', default=[], metavar='FRAME,FRAME[:fixed]',
                      help='frames of a URDF that coincide where its loop is closed, by a pin or '
                           'fixed; a frame may be LINK@x/y/z [m]')
    verb.add_argument('--lock', action='append', default=[], metavar='JOINT',
                      help="hold a joint as in the file's pose")
    verb.add_argument('--cut', action='append', default=[], metavar='JOINT',
                      help='leave out a joint that closes a loop')
    verb.add_argument('--key', default='', metavar='NAME',
                      help='pose of the file: a key of MJCF, a group_state of URDF')
    verb.add_argument('--at', action='append', default=[], type=_pair, metavar='JOINT=VALUE',
                      help='position of a joint in the pose [degrees, of a slide m], or with a '
                           'unit: 0.5rad, 50mm')
    verb.add_argument('--mode', action='append', default=[], type=_mode, metavar='DYAD=1|2',
                      help='assembly mode of a dyad (d1, d2, ... or cylinder)')
    verb.add_argument('--gravity', type=_vector, default=(), metavar='X,Y,Z',
                      help='[m/s^2] in the root; default: that of MJCF, of URDF 0,0,-9.80665')
    verb.add_argument('--check', action='store_true',
                      help='compare joints and drive with MuJoCo over the range; unasked where '
                           'axes are not parallel')
    verb.set_defaults(run=_import)


def _pair(text: str) -> tuple[str, str]:
    name, equals, value = text.rpartition('=')
    if not equals or not name:
        raise ArgumentTypeError(f'{text!r}: must be JOINT=VALUE')
    return name, value


def _mode(text: str) -> tuple[str, int]:
    name, mode = _pair(text)
    if mode not in ('1', '2'):
        raise ArgumentTypeError(f'{text!r}: must be DYAD=1 or DYAD=2')
    return name, int(mode)


def _vector(text: str) -> tuple[float, ...]:
    numbers = tuple([of('m/s^2')(number) for number in text.split(',')])
    if len(numbers) != 3:
        raise ArgumentTypeError(f'{text!r}: must be X,Y,Z')
    return numbers


def wishes_of(arguments: Namespace) -> Any:
    """Return the Wishes for import_file() that stand on a command line."""
    from fourbar_ros.importing.robots import Wishes
    values = {name: getattr(arguments, name) for name in Wishes._fields}
    return Wishes(**values | {'at': dict(arguments.at), 'mode': dict(arguments.mode)})


def _import(arguments: Namespace) -> int:
    from fourbar_ros.importing.files import import_file
    result = import_file(arguments.file, wishes_of(arguments))
    report = result.report
    if arguments.out and result.loops:
        arguments.out.write_text(result.text, encoding='utf-8')
        report = [*report, str(arguments.out)]
    print('\n'.join(report))
    return 0 if result.is_good else BAD
