# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``fourbar new``: write a scene from a few numbers, with comments, in SI."""
from __future__ import annotations

from argparse import ArgumentTypeError, Namespace
from math import pi
from pathlib import Path
import re
import sys
from typing import NamedTuple, TYPE_CHECKING

from fourbar_ros.cli.common import add_verb, assembly_mode, Verbs, warn
from fourbar_ros.errors import FourBarError, InvalidParameter, nearest
from fourbar_ros.mechanisms.kinds import KINDS
from fourbar_ros.scene.units import measured, of

if TYPE_CHECKING:      # verbs import when they run
    from fourbar_ros.mechanisms.parts import Length

MATERIALS = {'steel': 7850.0, 'stainless': 8000.0, 'aluminium': 2700.0, 'brass': 8500.0,
             'titanium': 4500.0, 'pla': 1240.0, 'wood': 700.0}      # [kg/m^3]
BAR = re.compile(r'([\d.]+) *([a-z]*) *x *([\d.]+) *([a-z]*)')
NAMES = tuple(dict.fromkeys(length.name for kind in KINDS.values() for length in kind.LENGTHS))
DESCRIPTION = """\
Write a scene from a few numbers: lengths, speed, and bars or rods of one section. Lengths that
are not given are asked for on a terminal. The scene is in SI, with comments; change it as you
like. No file is overwritten.
"""
EPILOG = """\
examples:
  fourbar new my.yaml --a1 50mm --a2 150mm --a3 100mm --a4 125mm --speed 300rpm --bar 20x5mm
  fourbar new my.yaml                                       asks for the lengths
  fourbar new pump.yaml --kind slider_crank --a1 30mm --a2 90mm --rod 8mm --material aluminium

then:
  fourbar show my.yaml
  fourbar plot my.yaml shaking_force -o shaking.png
"""


class Section(NamedTuple):
    """The section of bars: width and thickness, or of rods: diameter and 0 [m]."""

    width: float
    thickness: float


def add(verbs: Verbs) -> None:
    """Add the verb."""
    new = add_verb(verbs, 'new', 'write a scene from a few numbers', DESCRIPTION, EPILOG)
    new.add_argument('file', metavar='FILE', help='scene to write, e.g. my.yaml')
    new.add_argument('--kind', choices=KINDS, default='four_bar', metavar='KIND',
                     help=f'{", ".join(KINDS)} (default four_bar)')
    for name in NAMES:
        texts = dict.fromkeys(length.text for kind in KINDS.values() for length in kind.LENGTHS
                              if length.name == name)
        new.add_argument(f'--{name}', type=of('length'), metavar='LENGTH',
                         help=f'{"; ".join(texts)} [m], or with a unit: 50mm')
    new.add_argument('--mode', type=assembly_mode, default=2, metavar='MODE',
                     help='assembly mode: 1 (crossed) or 2 (open, the default)')
    new.add_argument('--speed', type=of('angular speed'), default=measured('60rpm',
                                                                           'angular speed'),
                     metavar='SPEED', help='of the crank [rad/s], or 300rpm (default 60rpm)')
    section = new.add_mutually_exclusive_group()
    section.add_argument('--bar', type=_bar, metavar='WIDTHxTHICKNESS',
                         help='flat bars of this section, e.g. 20x5mm')
    section.add_argument('--rod', type=_rod, metavar='DIAMETER', help='round rods, e.g. 8mm')
    new.add_argument('--material', type=_density, default='steel', metavar='MATERIAL',
                     help=f'{", ".join(MATERIALS)}, or a density [kg/m^3] (default steel)')
    new.set_defaults(run=_new)


def _bar(text: str) -> Section:
    """Return the section of a text as 20x5mm or 20mmx5mm: a unit given once is that of both."""
    match = BAR.fullmatch(text)
    if not match:
        raise ArgumentTypeError(f'{text!r}: must be WIDTHxTHICKNESS, e.g. 20x5mm')
    width, its_unit, thickness, unit = match.groups()
    return Section(*(_positive(text, measured(size, 'length')) for size in (
        width + (its_unit or unit), thickness + (unit or its_unit))))


def _rod(text: str) -> Section:
    return Section(_positive(text, measured(text, 'length')), 0.0)


def _positive(text: str, size: float) -> float:
    if size <= 0.0:
        raise ArgumentTypeError(f'{text!r}: must be positive')
    return size


def _density(text: str) -> float:
    if text in MATERIALS:
        return MATERIALS[text]
    try:
        return _positive(text, measured(text, 'density'))
    except ArgumentTypeError:
        raise ArgumentTypeError(f'{text!r}: is no density and no material'
                                f'{nearest(text, MATERIALS)}') from None


def _new(arguments: Namespace) -> None:
    from fourbar_ros.scene.scene import load
    path = Path(arguments.file)
    if not path.suffix:
        path = path.with_suffix('.yaml')
    if path.suffix not in ('.yaml', '.yml'):
        raise InvalidParameter('FILE', arguments.file, 'must end in .yaml')
    if path.exists():
        raise InvalidParameter('FILE', str(path), 'exists already: give another name')
    text = scene_text(arguments.kind, _lengths(arguments), arguments.mode, arguments.speed,
                      arguments.bar or arguments.rod, arguments.material)
    with open(path, 'x', encoding='utf-8') as file:
        file.write(text)
    try:
        scene = load(path)
    except FourBarError:
        path.unlink()
        raise
    print(f'{path}: {scene.linkage.description}')
    print(f'next:  fourbar show {path}')
    warn(scene)


def _lengths(arguments: Namespace) -> dict[str, float]:
    """Return the lengths given, or asked for; a signed one may be left out."""
    given = {name: value for name in NAMES if (value := getattr(arguments, name)) is not None}
    wanted = {length.name: length for length in KINDS[arguments.kind].LENGTHS}
    for name, value in given.items():
        if name not in wanted:
            raise InvalidParameter(f'--{name}', value, f'is no length of a {arguments.kind}')
    return {name: given[name] if name in given else 0.0 if length.signed else _asked(length)
            for name, length in wanted.items()}


def _asked(length: Length) -> float:
    """Return a length from the terminal."""
    while sys.stdin.isatty():
        try:
            return measured(input(f'{length.name}, {length.text} [m, or 50mm]: '), 'length')
        except ArgumentTypeError as error:
            print(error)
        except EOFError:
            break
    raise InvalidParameter(f'--{length.name}', None,
                           f'must be given: {length.text} [m], or 50mm')


def scene_text(kind: str, lengths: dict[str, float], mode: int, speed: float,
               section: Section | None, density: float) -> str:
    """Return a scene as text, with comments; lengths [m], speed [rad/s], density [kg/m^3]."""
    lines = [f'# A {kind.replace("_", "-")}. Lengths in m, angles in rad, masses in kg.', '/**:',
             '  ros__parameters:', '    linkage:', f'      kind: {kind}']
    lines += [f'{f"      {length.name}: {_text(lengths[length.name])}":<27}# {length.text} [m]'
              for length in KINDS[kind].LENGTHS]
    lines += [f'{f"      mode: {mode}":<27}# 1 crossed, 2 open']
    if section:
        lines += ['    bodies:', *_bodies(kind, section, density)]
    lines += ['    drive:', '      source: timer',
              f'{f"      speed: {_text(speed)}":<27}# [rad/s], {speed * 30.0 / pi:.6g} rpm',
              f'{"      rate: 200.0":<27}# [Hz] of the samples',
              '    outputs: [state, output, joint_states'
              + (', loads, shaking_wrench]' if section else ']'), '']
    return '\n'.join(lines)


def _bodies(kind: str, section: Section, density: float) -> list[str]:
    """Return the lines of the bodies; links without two joints have to be given by hand."""
    what, size = ((f'bars {section.width:g} x {section.thickness:g} m',
                   f'width: {_text(section.width)}, thickness: {_text(section.thickness)}')
                  if section.thickness else (f'rods of {section.width:g} m diameter',
                                             f'radius: {_text(0.5 * section.width)}'))
    lines = [f'      # {what}, {density:g} kg/m^3',
             f'      rods: {{density: {_text(density)}, {size}}}']
    for link in KINDS[kind].LINKS:
        if not link.length:
            its = 'mass: 0.0, inertia: 0.0' if link.turns else 'mass: 0.0'
            lines.append(f'      {link.name}: {{{its}}}     # {link.text}: give its own')
    return lines


def _text(value: float) -> str:
    """Return a number as YAML has it: always with a point."""
    text = f'{value:.10g}'
    return text if '.' in text or 'e' in text else text + '.0'
