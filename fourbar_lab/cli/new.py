# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``fourbar new``: write a scene from a few numbers, with comments, in SI."""
from __future__ import annotations

from argparse import ArgumentTypeError, Namespace
from math import pi
from pathlib import Path
import re

from fourbar_ros.cli.common import add_verb, assembly_mode, Verbs, warn
from fourbar_ros.errors import FourBarError, InvalidParameter, nearest
from fourbar_ros.mechanisms.kinds import FACTS
from fourbar_ros.scene.units import measured, of

MATERIALS = {'steel': 7850.0, 'stainless': 8000.0, 'aluminium': 2700.0, 'brass': 8500.0,
             'titanium': 4500.0, 'pla': 1240.0, 'wood': 700.0}      # [kg/m^3]
BAR = re.compile(r'([\d.]+) *([a-z]*) *x *([\d.]+) *([a-z]*)')
NAMES = tuple(dict.fromkeys(length.name for kind in FACTS.values() for length in kind.lengths))
DESCRIPTION = """\
Write a scene from a few numbers: lengths, speed, and bars or rods of one section. The scene is
in SI, with comments; change it as you like. No file is overwritten.
"""
EPILOG = """\
examples:
  fourbar new my.yaml --a1 50mm --a2 150mm --a3 100mm --a4 125mm --speed 300rpm --bar 20x5mm
  fourbar new pump.yaml --kind slider_crank --a1 30mm --a2 90mm --rod 8mm --material aluminium

then:
  fourbar show my.yaml
  fourbar plot my.yaml shaking_force -o shaking.png
"""


def add(verbs: Verbs) -> None:
    """Add ``fourbar new``, with an option for each length of any kind of mechanism."""
    new = add_verb(verbs, 'new', 'write a scene from a few numbers', DESCRIPTION, EPILOG)
    new.add_argument('file', metavar='FILE', help='scene to write, e.g. my.yaml')
    new.add_argument('--kind', choices=FACTS, default='four_bar', metavar='KIND',
                     help=f'{", ".join(FACTS)} (default four_bar)')
    for name in NAMES:
        texts = dict.fromkeys(length.text for kind in FACTS.values() for length in kind.lengths
                              if length.name == name)
        new.add_argument(f'--{name}', type=of('length'), metavar='LENGTH',
                         help=f'{"; ".join(texts)} [m], or with a unit: 50mm')
    new.add_argument('--mode', type=assembly_mode, default=2, metavar='MODE',
                     help='assembly mode: 1 (crossed) or 2 (open, the default)')
    new.add_argument('--speed', type=of('angular speed'), metavar='SPEED',
                     default=measured('60rpm', 'angular speed'),
                     help='of the crank [rad/s], or 300rpm (default 60rpm)')
    section = new.add_mutually_exclusive_group()
    section.add_argument('--bar', type=_bar, metavar='WIDTHxTHICKNESS',
                         help='flat bars of this section, e.g. 20x5mm')
    section.add_argument('--rod', type=_rod, metavar='DIAMETER', help='round rods, e.g. 8mm')
    new.add_argument('--material', type=_density, default='steel', metavar='MATERIAL',
                     help=f'{", ".join(MATERIALS)}, or a density [kg/m^3] (default steel)')
    new.set_defaults(run=_new)


def _bar(text: str) -> tuple[str, str]:
    """Return words and YAML of '20x5mm' or '2cmx5mm': a unit given once is that of both."""
    match = BAR.fullmatch(text)
    if not match:
        raise ArgumentTypeError(f'{text!r}: must be WIDTHxTHICKNESS, e.g. 20x5mm')
    width, unit_of_width, thickness, unit = match.groups()
    width, thickness = (_positive(text, measured(size, 'length')) for size in (
        width + (unit_of_width or unit), thickness + (unit or unit_of_width)))
    return (f'bars {width:g} x {thickness:g} m',
            f'width: {_text(width)}, thickness: {_text(thickness)}')


def _rod(text: str) -> tuple[str, str]:
    """Return words and YAML of rods of a diameter."""
    diameter = _positive(text, measured(text, 'length'))
    return f'rods of {diameter:g} m diameter', f'radius: {_text(0.5 * diameter)}'


def _positive(text: str, size: float) -> float:
    if size <= 0.0:
        raise ArgumentTypeError(f'{text!r}: must be positive')
    return size


def _density(text: str) -> float:
    """Return the density [kg/m^3] for the name of a material or a number with a unit."""
    if text in MATERIALS:
        return MATERIALS[text]
    try:
        return _positive(text, measured(text, 'density'))
    except ArgumentTypeError:
        raise ArgumentTypeError(f'{text!r}: is no density and no material'
                                f'{nearest(text, MATERIALS)}') from None


def _new(arguments: Namespace) -> None:
    """Write the scene file; delete it again if it does not load, as with impossible lengths."""
    from fourbar_ros.scene.linkage import LONGEST
    from fourbar_ros.scene.scene import load
    path = Path(arguments.file)
    if not path.suffix:
        path = path.with_suffix('.yaml')
    if path.suffix not in ('.yaml', '.yml'):
        raise InvalidParameter('FILE', arguments.file, 'must end in .yaml')
    if path.exists():
        raise InvalidParameter('FILE', str(path), 'exists already: give another name')
    lengths = _lengths(arguments)
    text = scene_text(arguments.kind, lengths, arguments.mode, arguments.speed,
                      arguments.bar or arguments.rod, arguments.material)
    with open(path, 'x', encoding='utf-8') as file:
        file.write(text)
    try:
        scene = load(path)
    except InvalidParameter as error:
        path.unlink()
        meant = [f'; did you mean {value:g}mm?' for name, value in lengths.items()
                 if abs(value) > LONGEST and error.name == f'linkage.{name}']
        raise InvalidParameter(error.name, error.value,
                               ''.join((error.allowed, *meant))) from None
    except FourBarError:
        path.unlink()
        raise
    print(f'{path}: {scene.linkage.description}')
    print(f'next:  fourbar show {path}')
    warn(scene)


def _lengths(arguments: Namespace) -> dict[str, float]:
    """
    Return {name: length [m]} of the kind, all as given.

    Signed lengths, as the offset of a guide, are 0 unless given.
    """
    given = {name: value for name in NAMES if (value := getattr(arguments, name)) is not None}
    lengths = {length.name: length for length in FACTS[arguments.kind].lengths}
    for name, value in given.items():
        if name not in lengths:
            raise InvalidParameter(f'--{name}', value, f'is no length of a {arguments.kind}')
    for name, length in lengths.items():
        if length.signed:
            given.setdefault(name, 0.0)
        elif name not in given:
            raise InvalidParameter(f'--{name}', None,
                                   f'must be given: {length.text} [m], or 50mm')
    return given


def scene_text(kind: str, lengths: dict[str, float], mode: int, speed: float,
               section: tuple[str, str] | None, density: float) -> str:
    """
    Return a scene as YAML text with comments; lengths [m], speed [rad/s], density [kg/m^3].

    ``section``: words and YAML of bars or rods; without it there are no masses, and the node sends
    no loads.
    """
    lines = [f'# A {kind.replace("_", "-")}. Lengths in m, angles in rad, masses in kg.', '/**:',
             '  ros__parameters:', '    linkage:', f'      kind: {kind}']
    lines += [_line(f'{length.name}: {_text(lengths[length.name])}', f'{length.text} [m]')
              for length in FACTS[kind].lengths]
    lines += [_line(f'mode: {mode}', '1 crossed, 2 open')]
    if section:
        lines += ['    bodies:', *_bodies(kind, section, density),
                  '    # gravity: {x: 0.0, y: -9.81}     # [m/s^2]; without it weight is left out']
    lines += ['    drive:', '      source: timer',
              _line(f'speed: {_text(speed)}', f'[rad/s], {speed * 30.0 / pi:.6g} rpm'),
              _line('rate: 200.0', '[Hz] of the samples'),
              '    outputs: [state, output, joint_states'
              + (', loads, shaking_wrench]' if section else ']'), '']
    return '\n'.join(lines)


def _line(entry: str, comment: str) -> str:
    return f'{"      " + entry:<27}# {comment}'


def _bodies(kind: str, section: tuple[str, str], density: float) -> list[str]:
    """
    Return the YAML lines that give all bars or rods their masses.

    Links without a length, as slides, get zeros, for which the user puts in their own.
    """
    text, size = section
    lines = [f'      # {text}, {density:g} kg/m^3',
             f'      rods: {{density: {_text(density)}, {size}}}']
    for link in FACTS[kind].links:
        if not link.length:
            zeros = 'mass: 0.0, inertia: 0.0' if link.turns else 'mass: 0.0'
            lines.append(f'      {link.name}: {{{zeros}}}     # {link.text}: give its own')
    return lines


def _text(value: float) -> str:
    """Return a number for YAML, with a point or an exponent: ROS takes 3 for an integer."""
    text = f'{value:.10g}'
    return text if '.' in text or 'e' in text else text + '.0'
