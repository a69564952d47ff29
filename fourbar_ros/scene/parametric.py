# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
A scene whose parameters are of any arithmetic: columns of many designs, operations of a trace.

The formulas of motion and loads are those of every scene, made for such values.
"""
from collections.abc import Iterable
from copy import copy
from dataclasses import fields, replace
from functools import partial
from math import inf
from typing import Any, TypeVar

from fourbar_ros.mechanics.bodies import Applied, bar_numbers, Body, rod_numbers, unchecked
from fourbar_ros.mechanisms import curves, mechanism
from fourbar_ros.mechanisms import elements as acting
from fourbar_ros.mechanisms.evaluation import Constants
from fourbar_ros.mechanisms.quantities import Asked, POINT_QUANTITIES
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.numerics.number_types import ARRAY, direction_in, NumberType, Scalar
from fourbar_ros.scene.elements import ACTS, element_names, group_in
from fourbar_ros.scene.linkage import bodies_of_links, external_of, SECTIONS
from fourbar_ros.scene.scene import Scene
from fourbar_ros.scene.settings import MACHINE, ParameterValues
import numpy as np

NEARLY = 1e-12      # sums of lengths that agree to this, relative to their sum, are the same


_Record = TypeVar('_Record')


def constants_of(scene: Scene, values: ParameterValues, n: NumberType = ARRAY) -> Constants:
    """Return lengths, bodies and all that acts, for formulas, of ``values`` in any arithmetic."""
    linkage = scene.linkage
    external = external_of(values, linkage, partial(unchecked, Applied))
    constants: Constants = linkage.constants._replace(
        gravity=(values['gravity.x'], values['gravity.y']), external=linkage.EXTERNAL(**external),
        friction=tuple([_with(friction, **{
            field: values[f'friction.{name}.{field}'] for field in vars(friction)
            if field != 'length' or friction.length < inf})
            for name, friction in linkage.friction]))
    group = 'dyads' if scene.kind == MACHINE else 'linkage'
    bodies = bodies_of_links(
        values, linkage.LINKS,
        {link.length: values[f'{group}.{link.length}'] for link in linkage.LINKS if link.length},
        scene.kind != MACHINE, partial(unchecked, Body), dict(zip(SECTIONS, (
            lambda *sizes: unchecked(Body, *rod_numbers(*sizes)),
            lambda *sizes: unchecked(Body, *bar_numbers(*sizes))))))
    if scene.kind != MACHINE:
        return constants._replace(
            lengths=tuple([values[f'linkage.{name}'] for name in linkage.length_names]),
            elements=elements_of(scene, values, n),
            bodies=None if bodies is None else linkage.BODIES(**bodies))
    from fourbar_ros.machine import Machine
    from fourbar_ros.scene import machines
    assert isinstance(linkage, Machine)
    lengths = machines.lengths_of(linkage, values, n)
    return constants._replace(
        lengths=lengths,
        elements=elements_of(scene, values, n, machines.slides_in(linkage, lengths)),
        bodies=machines.bodies_of(linkage, bodies))


def elements_of(scene: Scene, values: ParameterValues, n: NumberType,
                slides: Iterable[tuple[str, curves.Point, tuple[Scalar, Scalar]]] = ()
                ) -> tuple[acting.Element, ...]:
    """Return springs and forces in any arithmetic; ``slides`` as :func:`.slides_in`."""
    def varies(name: str, *fields: str) -> bool:
        """Return whether one of some parameters is, or may be, another number than 0."""
        return not all(isinstance(value, float) and value == 0.0
                       for value in [values[f'{name}.{field}'] for field in fields])

    ways = {f'slide_{link}': (_with(acting.Attachment(), **origin._asdict()), along)
            for link, origin, along in slides}
    elements = list[acting.Element]()
    for name, element in zip(element_names(scene.values), scene.linkage.elements):
        derived: dict[str, Any] = {}
        if isinstance(element, acting.PositionForce):
            over, coordinate = element.over, values[f'{name}.over']
            if isinstance(over, acting.Distance):
                over = _with(over, point=_of_values(over.point, name, values),
                             origin=_of_values(over.origin, f'{name}.from', values))
            elif coordinate in ways:
                over = _with(over, **dict(zip(('origin', 'unit_vector'), ways[coordinate])))
            elif isinstance(over, acting.Way) and '.' in coordinate:
                over = _with(over, point=_of_values(over.point, f'points.{coordinate[:-2]}',
                                                    values))
            derived['over'] = over
            if element.direction is not None:
                turned = ACTS.get(values[f'{name}.acts'], (False, 0.0))[1] + values[
                    f'{name}.direction']
                derived |= {'direction': turned, 'unit_vector': direction_in(n, turned)}
        else:
            derived['has_damping'] = varies(name, 'damping')
            if isinstance(element, acting.Spring):
                derived['has_length'] = varies(name, 'free_length', 'preload')
            else:
                derived['free_direction'] = direction_in(n, values[f'{name}.free_angle'])
        elements.append(_with(_of_values(element, name, values), **derived))
    return tuple(elements)


def _of_values(record: _Record, name: str, values: ParameterValues) -> _Record:
    """Return a record with the numbers of the parameters NAME.FIELD, also of its points."""
    changed: dict[str, Any] = {}
    for field in fields(record):        # type: ignore[arg-type]  # a dataclass
        value = getattr(record, field.name)
        if isinstance(value, acting.Attachment):
            changed[field.name] = _of_values(value, group_in(name, field.name), values)
        elif isinstance(value, float):
            changed[field.name] = values[f'{name}.{field.name}']
    return _with(record, **changed)


def alike(scene: Scene, constants: Constants) -> Scene:
    """Return a scene whose formulas are those of such constants: springs with what may vary."""
    elements = [_with(element, **{name: value for name, value in vars(made).items()
                                  if name.startswith('has_')})
                for element, made in zip(scene.linkage.elements, constants.elements)]
    if elements == [*scene.linkage.elements]:
        return scene
    return replace(scene, linkage=scene.linkage.with_elements(*elements))


def _with(record: _Record, **changed: Any) -> _Record:
    copied = copy(record)
    for name, value in changed.items():
        object.__setattr__(copied, name, value)
    return copied


def margin_signs(linkage: mechanism.Mechanism) -> Array | None:
    """Return the signs of |lengths| in the margins, (margins, lengths); None if no such sums."""
    signs, sizes = np.array(linkage.MARGIN_SIGNS, float), np.abs(linkage.lengths)
    are_sums = signs.size and np.allclose(signs @ sizes, linkage.margins, 0.0,
                                          NEARLY * sizes.sum())
    return signs if are_sums else None


def point_quantities_of(scene: Scene, values: ParameterValues, parametric: mechanism.Mechanism
                        ) -> dict[str, Asked]:
    """
    Return {NAME.x, .y, .speed, .acceleration: quantity} of a scene's points, for many designs.

    ``parametric`` is the scene's mechanism with arrays as lengths, ``values`` its parameters.
    """
    quantities: dict[str, Asked] = {}
    for name, point in scene.points.items():
        coordinates = values[f'points.{name}.along'], values[f'points.{name}.across']
        for make in POINT_QUANTITIES:
            quantity = make(scene.linkage, *point, name=name)
            of: Any = quantity.of           # partial(length, linkage, link, along, across, first)
            _, link, _, _, first = of.args
            quantities[quantity.name] = quantity._replace(
                of=partial(of.func, parametric, link, *coordinates, first))
    return quantities
