# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``fourbar generate``: a scene as C code, JavaScript or an FMU."""
from argparse import Namespace
from pathlib import Path
import sys

from fourbar_ros.cli.common import add_scene, add_verb, refuse_overwriting, Verbs

EPILOG = """\
examples:
  fourbar generate paper -o code                     C99, for C++ too
  fourbar generate paper -o code --outputs theta4 omega4 driving_torque --parameters a1 a2
  fourbar generate jansen -o code --parameters       all numbers folded in
  fourbar generate paper -o fmu --as fmu2            for Simulink, OpenModelica, fmi_adapter
  fourbar generate paper -o web --as js              a module for a web page or Node

The results of C have the bits of the node, with the same libm. docs/generated.md has the rest.
"""


def add(verbs: Verbs) -> None:
    verb = add_verb(verbs, 'generate', 'write a scene as C code, JavaScript or an FMU',
                    'Write the formulas of a scene, for its input, as C99, as a module of '
                    'JavaScript, or as an FMU for co-simulation.', EPILOG)
    add_scene(verb)
    verb.add_argument('-o', '--out', metavar='DIR', type=Path, required=True,
                      help='folder to write to; made if it is not there')
    verb.add_argument('--as', dest='format', choices=('c', 'fmu2', 'js'), default='c',
                      help='C, an FMU of FMI 2.0, or JavaScript; default: c')
    verb.add_argument('--outputs', metavar='FIELD', nargs='+',
                      help='fields of motion and loads, POINT.FIELD of points; default: all, of '
                           'an FMU all with a unit')
    verb.add_argument('--parameters', metavar='NAME', nargs='*',
                      help='numbers that can be changed at run time, e.g. a1 bodies.crank.mass; '
                           'default: all but those that are left out, as zero; none: without NAME')
    verb.add_argument('--force', action='store_true', help='overwrite files that exist')
    verb.set_defaults(run=_generate)


def _generate(arguments: Namespace) -> None:
    from fourbar_lab.export.files import generate, paths_of
    from fourbar_ros.scene.files import name_of
    refuse_overwriting(paths_of(name_of(arguments.scene), arguments.out, arguments.format),
                       arguments.force)
    written = generate(arguments.scene, arguments.out, arguments.format, arguments.outputs,
                       arguments.parameters)
    for path in written.files:
        print(path)
    print(f'{written.operations} operations a sample')
    for note in written.notes:
        print(f'fourbar: note: {note}', file=sys.stderr)
