# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
What a page draws of a scene: joints, bars, slides, springs and loads as points of links.

A point is (link, along, across); a coordinate is a number [m] or the name of what it follows: a
parameter of the scene, or a field of the motion.
"""
from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import partial
from math import hypot
from typing import Any, cast, TYPE_CHECKING

from fourbar_lab.drawing.labels import labels_of
from fourbar_ros.mechanisms.curves import point_of
from fourbar_ros.mechanisms.elements import PositionForce, Spring
from fourbar_ros.mechanisms.four_bars import FourBarLinks
from fourbar_ros.mechanisms.machine.structure import BASE, SLIDES
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.parts import GROUND, NamedFields, SLIDE
from fourbar_ros.mechanisms.picture import BEYOND, diagram_of, RODS
from fourbar_ros.mechanisms.sliders import InvertedSlider, ScotchYoke, SliderCrank
from fourbar_ros.scene.elements import element_names
from fourbar_ros.scene.scene import Scene

if TYPE_CHECKING:
    from fourbar_ros.machine import Machine

Point = tuple[str, float | str, float | str]
Sketch = dict[str, Any]         # as the page takes it, see :func:`sketch_of`
SAME = 1e-9         # points of a link that are nearer, over its size, are the same


def sketch_of(scene: Scene, parameters: Mapping[str, float], points: Mapping[str, Any]) -> Sketch:
    """
    Return all that is drawn of a scene; ``parameters``: those of its module that have names.

    joints {name: points of all links there}, letters and ground of them; bars, plates (links of
    three points and more), blocks with the direction of their slide on a link; forces {load:
    joint} with symbols; points, springs, applied loads, dyads with their parameters.
    """
    mechanism = scene.linkage
    low, high = mechanism.input_ranges[0]
    motion = mechanism.motion(low + 0.41 * (high - low), 1.0)
    named = partial(_named, parameters)
    sketch = (_of_machine(cast('Machine', mechanism), scene, named, motion)
              if hasattr(mechanism, 'stages') else _of_kind(mechanism, named, motion))
    diagram = diagram_of(mechanism, motion)
    labels = labels_of(diagram, {
        joint: scene.values[parameter] for joint in diagram.joints
        for dyad, _, end in [joint.rpartition('_')]
        if scene.values.get(parameter := f'dyads.{dyad}.{end}')})
    loads_at: dict[str, list[str]] = {}
    for load, joint in diagram.forces.items():
        loads_at.setdefault(joint, []).append(load)
    springs, applied = [], [
        {'name': f'external.{link}', 'point': (link, f'external.{link}.along',
                                               f'external.{link}.across')}
        for link in mechanism.EXTERNAL._fields if f'external.{link}.force_x' in parameters]
    for name, element in zip(element_names(scene.values), mechanism.elements):
        if isinstance(element, Spring):
            springs.append({'name': name, **{
                end: (point.link, named(f'{name}.{end}.along', point.along),
                      named(f'{name}.{end}.across', point.across))
                for end, point in (('first', element.first), ('second', element.second))}})
        elif isinstance(element, PositionForce) and element.apart_from is not None:
            springs.append({'name': name, 'first': _attached(element.point),
                            'second': _attached(element.apart_from)})
    return {**sketch, 'joints': {name: sketch['joints'][name] for name in diagram.joints},
            'letters': {name: labels.letters.get(name, name) for name in diagram.joints},
            'ground': diagram.ground, 'forces': dict(diagram.forces), 'loadsAt': loads_at,
            'symbols': dict(labels.forces), 'springs': springs, 'applied': applied,
            'points': {name: (link, named(f'points.{name}.along', along),
                              named(f'points.{name}.across', across))
                       for name, (link, along, across) in points.items()}}


def _named(parameters: Mapping[str, float], name: str, value: float) -> float | str:
    return name if name in parameters else float(value)


def _attached(point: Any) -> Point:
    return point.link, point.along, point.across


def _place(mechanism: Mechanism, motion: NamedFields, point: tuple[str, float, float]
           ) -> tuple[float, float]:
    link, along, across = point
    if link == GROUND:
        return along, across
    x, y, *_ = point_of(mechanism.link_motion(motion, link), along, across)
    return x, y


def _of_machine(machine: Machine, scene: Scene, named: Any, motion: NamedFields) -> Sketch:
    """Return joints, bars, plates, blocks and dyads of a machine."""
    layout = machine.layout
    joints: dict[str, list[Point]] = {BASE: [(layout.driven, 0.0, 0.0)]}
    if machine.input != SLIDE and layout.ground == 0:
        joints[BASE].append((GROUND, 0.0, 0.0))
    bars, blocks, dyads = list[tuple[Point, Point]](), [], []
    corners: dict[str, list[tuple[Point, tuple[float, float]]]] = {
        link: [] for link in layout.links}

    def corner(link: str, point: Point, *place: float) -> None:
        at = _place(machine, motion, (link, *place))      # type: ignore[arg-type]
        size = hypot(*at) + machine.input_unit
        if all(hypot(at[0] - x, at[1] - y) > SAME * size for _, (x, y) in corners[link]):
            corners[link].append((point, at))

    corner(layout.driven, (layout.driven, 0.0, 0.0), 0.0, 0.0)
    for stage, dyad in zip(layout.stages, machine.stages):
        names, slides = dict(stage.joints()), SLIDES[stage.kind]
        is_cylinder = dyad not in machine.dyads
        prefix = 'cylinder.' if is_cylinder else f'dyads.{dyad.name}.'
        ends = dict(zip(('first', 'second'), ('pin', 'base') if is_cylinder else
                        ('first', 'second')))
        length_1 = named(f'{prefix}length_1', dyad.length_1 or 0.0)
        length_2 = named(f'{prefix}length_2', dyad.length_2 or 0.0)
        for i, joint in enumerate(('first', 'second')):
            end, link = getattr(dyad, joint), stage.links[i]
            # by its name in the scene, if the point has one
            point = scene.values.get(f'{prefix}{ends[joint]}')
            group = f'linkage.points.{point}' if point else f'{prefix}{ends[joint]}'
            fields = ('x', 'y') if point and end.link == GROUND else ('along', 'across')
            held: Point = (end.link, *(named(f'{group}.{field}', value) for field, value in zip(
                fields, (end.along, end.across))))
            if joint in slides:
                joints[names[joint]] = [(link, 0.0, 0.0)]
                corner(end.link, held, end.along, end.across)
                continue
            # first joint of its own link: a place that follows all lengths
            joints[names[joint]] = [(link, 0.0, 0.0), held]
            corner(link, (link, 0.0, 0.0), 0.0, 0.0)
            corner(end.link, (link, 0.0, 0.0), end.along, end.across)
        first, second = stage.links
        inner: list[Point] = [(first, 0.0 if stage.kind == 'PRP' else length_1, 0.0)]
        if 'inner' in slides:
            inner = [(stage.links[slides['inner']], 0.0, 0.0)]
        elif stage.kind == 'RRR':
            inner.append((second, length_2, 0.0))
        else:
            inner.append((second, 0.0, 0.0))
        joints[names['inner']] = inner
        if 'inner' not in slides:
            corner(first, inner[0], 0.0 if stage.kind == 'PRP' else dyad.length_1 or 0.0, 0.0)
            if stage.kind == 'RRR':
                corner(second, inner[1], dyad.length_2 or 0.0, 0.0)
        for joint in RODS[stage.kind]:
            bars.append((joints[names[joint]][0], inner[0]))
        for joint, i in slides.items():
            carrier = stage.links[i]
            blocks.append({'joint': names[joint], 'link': carrier, 'direction': (1.0, 0.0),
                           'isGuided': joint != 'first' and layout.ground in stage.ends(joint)})
        dyads.append({'name': dyad.name, 'kind': stage.kind, 'links': stage.links,
                      **{joint: names[joint] for joint in ('first', 'inner', 'second')},
                      'length_1': length_1, 'length_2': length_2, 'mode': f'{prefix}mode'})
    if machine.input == SLIDE:
        blocks.append({'joint': BASE, 'link': layout.driven, 'direction': (1.0, 0.0),
                       'isGuided': True})
    plates = []
    for link, found in corners.items():
        if link == GROUND or len(found) < 2:
            continue
        if len(found) == 2:
            bars.append((found[0][0], found[1][0]))
        else:
            plates.append([point for point, _ in found])
    return {'joints': joints, 'bars': _without_doubles(bars), 'plates': plates, 'blocks': blocks,
            'dyads': dyads}


def _without_doubles(bars: Iterable[tuple[Point, Point]]) -> list[tuple[Point, Point]]:
    kept: list[tuple[Point, Point]] = []
    for first, second in bars:
        if (first, second) not in kept and (second, first) not in kept:
            kept.append((first, second))
    return kept


def _of_kind(mechanism: Mechanism, named: Any, motion: NamedFields) -> Sketch:
    """Return joints, bars and blocks of a mechanism with names of its own."""
    def length(name: str) -> float | str:
        value: float | str = named(f'linkage.{name}', getattr(mechanism, name))
        return value

    a: list[Point] = [('crank', length('a1'), 0.0)]
    joints: dict[str, list[Point]] = {'O_1': [(GROUND, 0.0, 0.0), ('crank', 0.0, 0.0)], 'A': a}
    bars: list[tuple[Point, Point]] = [(('crank', 0.0, 0.0), a[0])]
    blocks: list[dict[str, Any]] = []
    links = [link.name for link in mechanism.LINKS]
    if 'coupler' in links:
        a.append(('coupler', 0.0, 0.0))
    origin: Point = ('output', 0.0, 0.0)
    if isinstance(mechanism, FourBarLinks):
        b: Point = ('output', length('a3'), 0.0)
        joints |= {'B': [b, ('coupler', length('a2'), 0.0)],
                   'O_4': [(GROUND, length('a4'), 0.0), origin]}
        bars += [(a[0], b), (origin, b)]
    elif isinstance(mechanism, ScotchYoke):
        joints['B'] = [origin]
        ends: list[Point] = [('output', 0.0, side * 1.1 * mechanism.a1 - mechanism.offset)
                             for side in (-1.0, 1.0)]
        bars += [(ends[0], ends[1]), (origin, ends[0]), (origin, ends[1])]
        blocks += [{'joint': 'B', 'link': 'output', 'direction': (1.0, 0.0), 'isGuided': True},
                   {'joint': 'A', 'link': 'output', 'direction': (0.0, 1.0), 'isGuided': False}]
    elif isinstance(mechanism, SliderCrank):
        joints['B'] = [origin]
        bars.append((a[0], origin))
        blocks.append({'joint': 'B', 'link': GROUND, 'direction': (1.0, 0.0), 'isGuided': True})
    else:
        assert isinstance(mechanism, InvertedSlider)
        bar = mechanism.link_motion(motion, 'output')
        (x, y), sense = _place(mechanism, motion, ('crank', mechanism.a1, 0.0)), 1.0
        across = (y - bar.y) * bar.cosine - (x - bar.x) * bar.sine
        sense = 1.0 if motion.slide >= 0.0 else -1.0
        joints['O_4'] = [(GROUND, length('a4'), 0.0), origin]
        foot: Point = ('output', 0.0, across)
        bars.append((origin, foot))
        if mechanism.is_driven_by_slide:
            low, high = sorted(map(abs, mechanism.input_ranges[-1]))
            bars += [(foot, a[0]), (foot, ('output', sense * max(0.9 * low, 0.45 * high), across))]
        else:
            reach = (1.0 + BEYOND) * (mechanism.a1 + mechanism.a4)
            bars.append((foot, ('output', sense * reach, across)))
            blocks.append({'joint': 'A', 'link': 'output', 'direction': (1.0, 0.0),
                           'isGuided': False})
    return {'joints': joints, 'bars': bars, 'plates': [], 'blocks': blocks, 'dyads': []}
