# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
What a page draws of a scene: the outline of its mechanism with springs, loads and letters.

A point is (link, along, across); a coordinate is a number [m] or the name of the parameter of the
scene that it follows.
"""
from collections.abc import Mapping
from typing import Any

from fourbar_lab.drawing.labels import as_written, labels_of
from fourbar_ros.mechanisms import curves, picture
from fourbar_ros.mechanisms.elements import PositionForce, Spring
from fourbar_ros.scene.elements import element_names
from fourbar_ros.scene.scene import Scene

Point = tuple[str, float | str, float | str]


def sketch_of(scene: Scene, parameters: Mapping[str, float], points: Mapping[str, Any]
              ) -> dict[str, Any]:
    """
    Return all that is drawn of a scene; ``parameters``: those of its module that have names.

    joints {name: points of all links there}, letters and ground of them; bars, plates (links of
    three points and more), blocks with the direction of their slide on a link; forces {load:
    joint} with symbols; points, springs, applied loads, dyads.
    """
    mechanism = scene.linkage
    low, high = mechanism.input_ranges[0]
    motion = mechanism.motion(low + 0.41 * (high - low), 1.0)
    outline = picture.outline_of(mechanism, motion)

    def named(name: str, value: float) -> float | str:
        return name if name in parameters else float(value)

    def follows(coordinate: float) -> float | str:
        """Return the parameter that a coordinate is: of a named point, if the dyad has one."""
        name = getattr(coordinate, 'name', '')
        end, _, field = name.rpartition('.')
        if point := scene.values.get(end):
            name = f'linkage.points.{point}.{field}'
            if name not in parameters:
                name = f'linkage.points.{point}.{"x" if field == "along" else "y"}'
        return named(name, coordinate)

    def stated(point: curves.Point) -> Point:
        return point.link, follows(point.along), follows(point.across)

    labels = labels_of(picture.diagram_of(mechanism, motion))
    loads_at: dict[str, list[str]] = {}
    for load, joint in outline.forces.items():
        loads_at.setdefault(joint, []).append(load)
    springs, applied = [], [
        {'name': f'external.{link}', 'point': (link, f'external.{link}.along',
                                               f'external.{link}.across')}
        for link in mechanism.EXTERNAL._fields if f'external.{link}.force_x' in parameters]
    for name, element in zip(element_names(scene.values), mechanism.elements):
        ends: tuple[Any, ...] = (
            (element.first, element.second) if isinstance(element, Spring) else
            (element.point, element.apart_from) if isinstance(element, PositionForce) else ())
        if ends and None not in ends:
            springs.append({'name': name, **{
                end: (point.link, named(f'{name}.{end}.along', point.along),
                      named(f'{name}.{end}.across', point.across))
                for end, point in zip(('first', 'second'), ends)}})
    return {'joints': {name: [*map(stated, at)] for name, at in outline.joints.items()},
            'bars': [(stated(start), stated(end)) for start, end, _ in outline.bars],
            'plates': [[*map(stated, plate)] for plate in outline.plates],
            'blocks': [{'joint': block.joint, 'link': block.link, 'direction': block.direction,
                        'isGuided': block.is_guided} for block in outline.blocks],
            'dyads': [{'name': stage.name, 'kind': stage.kind, 'links': stage.links}
                      for stage in mechanism.layout.stages],
            'letters': {name: labels.letters.get(name, name) for name in outline.joints},
            'ground': outline.ground, 'forces': outline.forces, 'loadsAt': loads_at,
            'symbols': {load: as_written(symbol) for load, symbol in labels.forces.items()},
            'springs': springs, 'applied': applied,
            'points': {name: (link, named(f'points.{name}.along', along),
                              named(f'points.{name}.across', across))
                       for name, (link, along, across) in points.items()}}
