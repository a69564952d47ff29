# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``fourbar new``: write a scene from a few numbers, with comments, in SI."""
from argparse import ArgumentTypeError, Namespace
from collections.abc import Mapping, Sequence
from math import fmod, radians
import re
from typing import Any, NamedTuple

from fourbar_ros.cli.common import add_output, add_verb, assembly_mode, Verbs
from fourbar_ros.errors import InvalidParameter
from fourbar_ros.mechanisms.kinds import KINDS
from fourbar_ros.scene.settings import LENGTHS
from fourbar_ros.scene.units import of, UNITS, without_comma

MATERIALS = {'steel': 7850.0, 'stainless': 8000.0, 'aluminium': 2700.0, 'brass': 8500.0,
             'titanium': 4500.0, 'pla': 1240.0, 'wood': 700.0}      # [kg/m^3]
BAR = re.compile(r'([\d.]+)x([\d.]+)([a-z]*)')
SCENE = """\
# {title}. Lengths in m, angles in rad, masses in kg.
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
{slides}{gravity}"""
GRAVITY = '    # gravity: {x: 0.0, y: -9.81}     # [m/s^2]; without it weight is left out\n'
DESCRIPTION = """\
Write a scene from a few numbers: lengths, speed, and bars or rods of one section. The scene is
in SI, with comments; change it as you like.
"""
EPILOG = """\
examples:
  fourbar new my.yaml --a1 50mm --a2 150mm --a3 100mm --a4 125mm --speed 300rpm --bar 20x5mm
  fourbar new pump.yaml --kind slider_crank --a1 30mm --a2 90mm --rod 8mm --material aluminium

  fourbar new leg.yaml --points "O1 0 0" "A 10mm 20mm" "B 60mm 30mm" "O4 50mm 0" "P 40mm 50mm" \\
      --links O1-A A-B-P B-O4

machines of more links are given by points, or begin with a shipped one:
  fourbar scene print watt -o my.yaml

then:
  fourbar show my.yaml
  fourbar plot my.yaml shaking_force -o shaking.png
"""


def add(verbs: Verbs) -> None:
    new = add_verb(verbs, 'new', 'write a scene from a few numbers', DESCRIPTION, EPILOG)
    add_output(new, 'file', metavar='FILE', suffix='.yaml', help='scene to write, e.g. my.yaml')
    new.add_argument('--kind', choices=KINDS, metavar='KIND',
                     help=f'{", ".join(KINDS)} (default four_bar)')
    for name in LENGTHS:
        texts = dict.fromkeys(length.text for kind in KINDS.values() for length in kind.LENGTHS
                              if length.name == name)
        new.add_argument(f'--{name}', type=of('m'), metavar='LENGTH',
                         help=f'{"; ".join(texts)} [m], or with a unit: 50mm')
    new.add_argument('--points', nargs='+', type=_point, metavar='POINT',
                     help='in place of kind and lengths: joints where they are drawn, "NAME X Y"; '
                          'of the ground "NAME X Y ground" (so are O, O1, O2, ...); of a block '
                          'that slides on the ground "NAME X Y slide 30deg"; of a pin whose links '
                          'lie flat "NAME X Y mode 2"')
    new.add_argument('--links', nargs='+', type=lambda text: text.split('-'), metavar='LINK',
                     help='with --points: points of each link but the ground, the crank first, '
                          'O1-A A-B-P B-O4; default: one after another')
    new.add_argument('--mode', type=assembly_mode, metavar='MODE',
                     help='assembly mode: 1 (crossed) or 2 (open, the default)')
    new.add_argument('--speed', type=of('rad/s'), metavar='SPEED',
                     default='60rpm', help='of the crank [rad/s], or 300rpm (default 60rpm)')
    section = new.add_mutually_exclusive_group()
    section.add_argument('--bar', type=_bar, metavar='WIDTHxTHICKNESS',
                         help='flat bars of this section, e.g. 20x5mm')
    section.add_argument('--rod', type=lambda text: f'radius: {0.5 * of("m")(text)!r}',
                         metavar='DIAMETER', help='round rods, e.g. 8mm')
    new.add_argument('--material', type=_density, metavar='MATERIAL',
                     help=f'{", ".join(MATERIALS)}, or a density [kg/m^3] (default steel)')
    new.set_defaults(run=_new)


def _bar(text: str) -> str:
    """Return the YAML of '20x5mm': a unit is that of both."""
    match = BAR.fullmatch(text)
    if not match:
        raise ArgumentTypeError(f'{text!r}: ' + (
            without_comma(text) if ',' in text else 'must be WIDTHxTHICKNESS, e.g. 20x5mm'))
    width, thickness = (of('m')(size + match[3]) for size in match.groups()[:2])
    return f'width: {width!r}, thickness: {thickness!r}'


def _density(text: str) -> float:
    if text in MATERIALS:
        return MATERIALS[text]
    if text[:1].isalpha():
        raise ArgumentTypeError(f'{text!r} must be {", ".join(MATERIALS)}, or a density')
    return of('kg/m^3', above=0.0)(text)


def _new(arguments: Namespace) -> None:
    from fourbar_ros.scene.files import flatten, parse
    from fourbar_ros.scene.linkage import links_without_mass
    from fourbar_ros.scene.scene import from_values, give_warnings
    path = arguments.file
    if path.suffix not in ('.yaml', '.yml'):
        raise InvalidParameter('FILE', str(path), 'must end in .yaml')
    lengths = {name: value for name in LENGTHS if (value := getattr(arguments, name)) is not None}
    # speed, section and density, of scene_text() and text_of_points() alike
    section = arguments.bar or arguments.rod or ''
    options = arguments.speed, section, arguments.material or MATERIALS['steel']
    if (arguments.points and (lengths or arguments.kind or arguments.mode)
            or arguments.links and not arguments.points):
        raise InvalidParameter('--points', None, 'stand in place of kind, lengths and mode, and '
                               '--links with them')
    if arguments.material and not section:
        raise InvalidParameter('--material', arguments.material, 'is that of --bar or --rod')
    text = (text_of_points(arguments.points, arguments.links, *options) if arguments.points else
            scene_text(arguments.kind or 'four_bar', lengths, arguments.mode or 2, *options))
    scene = from_values(flatten(parse(text)['/**']['ros__parameters'], path))
    path.write_text(text, encoding='utf-8')
    branch = scene.linkage.branch_in_words
    print(f'{path}: {scene.linkage.description}' + (f'; {branch}' if branch else ''))
    if massless := [link.name for link in links_without_mass(scene.linkage)]:
        print(f'without mass: {", ".join(massless)}; give bodies.{massless[-1]}.mass')
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
        title=f'{"An" if kind[0] in "aeiou" else "A"} {kind.replace("_", "-")}', kind=kind,
        mode=mode,
        lengths='\n'.join(f'      {name}: {value!r}  # {texts.get(name, "")} [m]'
                          for name, value in lengths.items()),
        bodies=BODIES.format(density=density, section=section, slides=''.join(slides),
                             gravity=GRAVITY)
        if section else '',
        speed=speed, rpm=speed / float(UNITS['rad/s']['rpm']),
        loads=', loads, shaking_wrench' if section else '')


class DrawnPoint(NamedTuple):
    """A joint or another point of a link, in the frame of a drawing [m]."""

    name: str
    place: tuple[float, float]
    is_ground: bool
    slide: float | None         # direction [rad] in which its block slides
    mode: int | None            # of the links that it joins


def _point(text: str) -> DrawnPoint:
    """Return the point of 'B 60mm 30mm', with 'ground', 'slide ANGLE' or 'mode MODE' behind it."""
    name, *rest = text.split() or ['']
    x, y, *more = rest if len(rest) > 1 else ('', '')
    options = dict([more]) if len(more) == 2 else {}
    if not x or more not in ([], ['ground']) and not {'slide', 'mode'} & options.keys():
        raise ArgumentTypeError(f'{text!r}: must be "NAME X Y", perhaps with "ground", "slide '
                                'ANGLE" or "mode MODE" behind it')
    if not re.fullmatch('[A-Za-z][A-Za-z0-9_]*', name):
        raise ArgumentTypeError(f'{name!r} must be a name: letters, digits and _, a letter first')
    return DrawnPoint(name, (of('m')(x), of('m')(y)),
                      bool(re.fullmatch(r'O\d*', name)) or more == ['ground'],
                      radians(fmod(of('rad')(options['slide']), 360.0))
                      if 'slide' in options else None,
                      assembly_mode(options['mode']) if 'mode' in options else None)


def text_of_points(points: Sequence[DrawnPoint], links: Sequence[Sequence[str]] | None,
                   speed: float, section: str, density: float) -> str:
    """
    Return a scene as YAML text, of joints where they are drawn; more as :func:`scene_text`.

    A four-bar with its ground along x and a slider-crank that slides along x have their kind, in
    the frame of the drawing as well; all else is a machine.
    """
    from fourbar_ros.machine import read_drawing
    from fourbar_ros.mechanics.bodies import flat_bar, round_rod
    from fourbar_ros.scene.files import parse, text_of_tree
    names = [point.name for point in points]
    if twice := [name for name in names if names.count(name) > 1]:
        raise InvalidParameter('--points', twice[0], 'must be given once')
    links = links or [*zip(names, names[1:])]
    drawing = read_drawing(
        {point.name: point.place for point in points}, links,
        [point.name for point in points if point.is_ground],
        {point.name: point.slide for point in points if point.slide is not None},
        {point.name: point.mode for point in points if point.mode is not None})
    joints, dyads = drawing.joints, drawing.machine.dyads
    # the crank's x axis goes to its first point behind the pivot
    a1 = next(joint.along for joint in joints.values() if joint.link == 'crank')
    first, (x, y) = dyads[0], dyads[0].second[1:]
    is_four_bar = first.kind == 'RRR' and y == 0.0 < x
    has_kind = len(dyads) == 1 and first.first[1:] == (a1, 0.0) and (
        is_four_bar or first.direction_2 == 0.0)
    link_in_scene = {'crank': 'crank'}      # {link of the machine: its name in the scene}
    if has_kind:
        lengths = ({'a2': first.length_1, 'a3': first.length_2, 'a4': x} if is_four_bar
                   else {'a2': first.length_1, 'offset': y})
        called = drawing.machine.joint_names
        letters = [called['base'], called[f'{first.name}_first'], first.name,
                   *([called[f'{first.name}_second']] if is_four_bar else [])]
        tree: dict[str, Any] = {'linkage': {
            'kind': 'four_bar' if is_four_bar else 'slider_crank', 'a1': a1, **lengths,
            'mode': first.mode} | ({} if letters == ['O1', 'A', 'B', 'O4'][:len(letters)]
                                   else {'joints': letters})}
        link_in_scene |= dict(zip(first.links, ('coupler', 'output')))
    else:
        # points on which dyads hang; one that is the inner pin of a dyad has distance 0 from it
        named = {name: {'x': joints[name].along, 'y': joints[name].across}
                 if joints[name].link == 'ground' else joints[name]._asdict()
                 for name in dict.fromkeys(drawing.ends.values())}
        for dyad in dyads:
            if dyad.name in named:
                named[dyad.name] = {'link': dyad.links[0], 'distance_2': 0.0}
        pivot = next(name for name in links[0] if joints[name].link == 'ground')
        tree = {'linkage': {'kind': 'machine', 'pivot': pivot,
                            'dyads': [dyad.name for dyad in dyads], 'points': named},
                'dyads': {dyad.name: {
                    'kind': dyad.kind,
                    **{end: drawing.ends.get(f'{dyad.name}.{end}', getattr(dyad, end)._asdict())
                       for end in ('first', 'second')}, 'inner': dyad.name, 'links': [*dyad.links],
                    **{name: value for name, value in vars(dyad).items() if value is not None
                       and name.startswith(('length', 'direction'))}, 'mode': dyad.mode}
                    for dyad in dyads}}
        link_in_scene |= {link: link for dyad in dyads for link in dyad.links}
    shared = {*drawing.ends.values(), *[dyad.name for dyad in dyads]}
    tree['points'] = {name: {**joint._asdict(), 'link': link_in_scene[joint.link]}
                      for name, joint in joints.items()
                      if name not in shared and joint.link != 'ground'}
    if section:
        size = parse(f'{{{section}}}')
        tree['bodies'] = {'rods': {'density': float(density), **size}}
        blocks = {'output' if has_kind else dyad.links[1] for dyad in dyads if dyad.kind == 'RRP'}
        tree['bodies'] |= {link: {'mass': 0.0} for link in sorted(blocks)}      # give their own
        if not has_kind:        # the crank of a machine is no rod with two pins
            rod = (round_rod(a1, density, size['radius']) if 'radius' in size else
                   flat_bar(a1, density, size['width'], size['thickness']))
            tree['bodies']['crank'] = {'mass': rod.mass, 'cg_along': rod.cg_along,
                                       'inertia': rod.inertia}
    tree |= {'drive': {'source': 'timer', 'speed': float(speed), 'start': drawing.start,
                       'rate': 200.0},
             'outputs': ['state', 'output', 'joint_states',
                         *(['loads', 'shaking_wrench'] if section else [])]}
    text = text_of_tree({name: group for name, group in tree.items() if group}, width=100,
                        default_flow_style=None)
    if section:
        text = text.replace('    drive:', GRAVITY + '    drive:', 1)
    return ('# By the coordinates of its joints, with the axes of the drawing from the pivot of '
            f'the crank.\n# Lengths in m, angles in rad, masses in kg. Drawn at '
            f'drive.start.\n{text}')
