# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``fourbar new``: write a scene from a few numbers, with comments, in SI."""
from __future__ import annotations

from argparse import ArgumentTypeError, Namespace
from collections.abc import Mapping
import re

from fourbar_ros.cli.common import add_output, add_verb, assembly_mode, Verbs
from fourbar_ros.errors import InvalidParameter
from fourbar_ros.mechanisms.kinds import KINDS
from fourbar_ros.scene.units import of, UNITS

MATERIALS = {'steel': 7850.0, 'stainless': 8000.0, 'aluminium': 2700.0, 'brass': 8500.0,
             'titanium': 4500.0, 'pla': 1240.0, 'wood': 700.0}      # [kg/m^3]
BAR = re.compile(r'([\d.]+)x([\d.]+)([a-z]*)')
NAMES = tuple(dict.fromkeys(length.name for kind in KINDS.values() for length in kind.LENGTHS))
SCENE = """\
# A {title}. Lengths in m, angles in rad, masses in kg.
/**:
  ros__parameters:
    linkage:
      kind: {kind}
{lengths}
      mode: {mode}  # 1 crossed, 2 open
{bodies}    drive:
      source: timer
      speed: {speed!r}  # [rad/s], {rpm:.6g} rpm
      rate: 200.0  # [Hz] of the samples
    outputs: [state, output, joint_states{loads}]
"""
BODIES = """\
    bodies:
      rods: {{density: {density}, {section}}}
{slides}    # gravity: {{x: 0.0, y: -9.81}}     # [m/s^2]; without it weight is left out
"""
DESCRIPTION = """\
Write a scene from a few numbers: lengths, speed, and bars or rods of one section. The scene is
in SI, with comments; change it as you like.
"""
EPILOG = """\
examples:
  fourbar new my.yaml --a1 50mm --a2 150mm --a3 100mm --a4 125mm --speed 300rpm --bar 20x5mm
  fourbar new pump.yaml --kind slider_crank --a1 30mm --a2 90mm --rod 8mm --material aluminium

machines of more links begin with a shipped one:
  fourbar scene print watt > my.yaml

then:
  fourbar show my.yaml
  fourbar plot my.yaml shaking_force -o shaking.png
"""


def add(verbs: Verbs) -> None:
    """Add ``fourbar new``, with an option for each length of any kind of mechanism."""
    new = add_verb(verbs, 'new', 'write a scene from a few numbers', DESCRIPTION, EPILOG)
    add_output(new, 'file', metavar='FILE', suffix='.yaml', help='scene to write, e.g. my.yaml')
    new.add_argument('--kind', choices=KINDS, default='four_bar', metavar='KIND',
                     help=f'{", ".join(KINDS)} (default four_bar)')
    for name in NAMES:
        texts = dict.fromkeys(length.text for kind in KINDS.values() for length in kind.LENGTHS
                              if length.name == name)
        new.add_argument(f'--{name}', type=of('m'), metavar='LENGTH',
                         help=f'{"; ".join(texts)} [m], or with a unit: 50mm')
    new.add_argument('--mode', type=assembly_mode, default=2, metavar='MODE',
                     help='assembly mode: 1 (crossed) or 2 (open, the default)')
    new.add_argument('--speed', type=of('rad/s'), metavar='SPEED',
                     default='60rpm', help='of the crank [rad/s], or 300rpm (default 60rpm)')
    section = new.add_mutually_exclusive_group()
    section.add_argument('--bar', type=_bar, metavar='WIDTHxTHICKNESS',
                         help='flat bars of this section, e.g. 20x5mm')
    section.add_argument('--rod', type=lambda text: f'radius: {0.5 * of("m")(text)!r}',
                         metavar='DIAMETER', help='round rods, e.g. 8mm')
    new.add_argument('--material', type=_density, default='steel', metavar='MATERIAL',
                     help=f'{", ".join(MATERIALS)}, or a density [kg/m^3] (default steel)')
    new.set_defaults(run=_new)


def _bar(text: str) -> str:
    """Return the YAML of '20x5mm': a unit is that of both."""
    match = BAR.fullmatch(text)
    if not match:
        raise ArgumentTypeError(f'{text!r}: must be WIDTHxTHICKNESS, e.g. 20x5mm')
    width, thickness = (of('m')(size + match[3]) for size in match.groups()[:2])
    return f'width: {width!r}, thickness: {thickness!r}'


def _density(text: str) -> float:
    """Return the density [kg/m^3] for the name of a material or a number with a unit."""
    if text in MATERIALS:
        return MATERIALS[text]
    if text[:1].isalpha():
        raise ArgumentTypeError(f'{text!r} must be {", ".join(MATERIALS)}, or a density')
    return of('kg/m^3', above=0.0)(text)


def _new(arguments: Namespace) -> None:
    """Write the scene file, unless it would not load, as with wrong lengths."""
    from fourbar_ros.scene.files import flatten, parse
    from fourbar_ros.scene.scene import from_values, give_warnings
    path = arguments.file
    if path.suffix not in ('.yaml', '.yml'):
        raise InvalidParameter('FILE', str(path), 'must end in .yaml')
    lengths = {name: value for name in NAMES if (value := getattr(arguments, name)) is not None}
    text = scene_text(arguments.kind, lengths, arguments.mode, arguments.speed,
                      arguments.bar or arguments.rod or '', arguments.material)
    scene = from_values(flatten(parse(text)['/**']['ros__parameters'], path))
    path.write_text(text, encoding='utf-8')
    branch = scene.linkage.branch_in_words
    print(f'{path}: {scene.linkage.description}' + (f'; {branch}' if branch else ''))
    print(f'next:  fourbar show {path}')
    give_warnings(scene, path)


def scene_text(kind: str, lengths: Mapping[str, float], mode: int, speed: float, section: str,
               density: float) -> str:
    """
    Return a scene as YAML text with comments; lengths [m], speed [rad/s], density [kg/m^3].

    ``section``: YAML of bars or rods; without it there are no masses, and the node sends no loads.
    Links without a length, as slides, get zeros, for which the user puts in their own.
    """
    texts = {length.name: length.text for length in KINDS[kind].LENGTHS}
    slides = [f'      {link.name}: {{mass: 0.0{", inertia: 0.0" if link.turns else ""}}}     '
              f'# {link.text}: give its own\n' for link in KINDS[kind].LINKS if not link.length]
    return SCENE.format(
        title=kind.replace('_', '-'), kind=kind, mode=mode,
        lengths='\n'.join(f'      {name}: {value!r}  # {texts.get(name, "")} [m]'
                          for name, value in lengths.items()),
        bodies=BODIES.format(density=density, section=section, slides=''.join(slides))
        if section else '',
        speed=speed, rpm=speed / float(UNITS['rad/s']['rpm']),
        loads=', loads, shaking_wrench' if section else '')
