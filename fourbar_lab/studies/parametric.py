# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
A scene whose parameters are of any arithmetic: columns of many designs, operations of a trace.

The formulas of motion and loads are those of every scene, made for such values.
"""
from __future__ import annotations

from functools import partial
from typing import Any

from fourbar_ros.mechanics.bodies import Applied, Body, unchecked
from fourbar_ros.mechanics.rods import bar_numbers, rod_numbers
from fourbar_ros.mechanisms.evaluation import Constants
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.quantities import Asked, point_acceleration, point_speed
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.numerics.number_types import ARRAY, NumberType, Scalar
from fourbar_ros.scene.linkage import BodiesOfLinks, external_of, SECTIONS
from fourbar_ros.scene.scene import Scene
from fourbar_ros.scene.settings import MACHINE, ParameterValues
import numpy as np

NEARLY = 1e-12      # sums of lengths that agree to this, relative to their sum, are the same


class _UncheckedBodies(BodiesOfLinks):
    """The ``bodies.*`` of a scene whose values are of any arithmetic."""

    body = staticmethod(partial(unchecked, Body))

    def rod(self, length: Scalar, density: Scalar, *section: Scalar) -> Body:
        fields = rod_numbers if self._section == SECTIONS[0] else bar_numbers
        return unchecked(Body, *fields(length, density, *section))


def constants_of(scene: Scene, values: ParameterValues, n: NumberType = ARRAY) -> Constants:
    """
    Return lengths, bodies, gravity and outer loads for the formulas of a scene's mechanism.

    ``values`` are all parameters, floats or of the arithmetic ``n``; ``scene`` has the same kind
    or the same dyads, and the same mode.
    """
    linkage = scene.linkage
    linkage.require_no_friction('an analysis of tolerances')
    external = external_of(values, linkage, partial(unchecked, Applied))
    constants: Constants = linkage.constants._replace(
        gravity=(values['gravity.x'], values['gravity.y']), external=linkage.EXTERNAL(**external))
    if scene.kind != MACHINE:
        lengths = {name: values[f'linkage.{name}'] for name in linkage.length_names}
        bodies = _UncheckedBodies(values, linkage.LINKS, lengths)
        return constants._replace(
            lengths=tuple(lengths.values()),
            bodies=linkage.BODIES(**bodies.made(True)) if bodies.are_given else None)
    from fourbar_ros.machine import Machine
    from fourbar_ros.scene import machines
    assert isinstance(linkage, Machine)
    bodies = _UncheckedBodies(values, linkage.LINKS, {
        link.length: values[f'dyads.{link.length}'] for link in linkage.LINKS if link.length})
    return constants._replace(
        lengths=machines.lengths_of(linkage, values, n),
        bodies=machines.bodies_of(linkage, bodies.made(False) if bodies.are_given else None))


def margin_signs(linkage: Mechanism) -> Array | None:
    """Return the signs of |lengths| in the margins, (margins, lengths); None if no such sums."""
    signs, sizes = np.array(linkage.MARGIN_SIGNS, float), np.abs(linkage.lengths)
    are_sums = signs.size and np.allclose(signs @ sizes, linkage.margins, 0.0,
                                          NEARLY * sizes.sum())
    return signs if are_sums else None


def point_quantities_of(scene: Scene, values: ParameterValues, parametric: Mechanism
                        ) -> dict[str, Asked]:
    """Return {name: speed or acceleration of a point} of a mechanism :func:`.with_any_lengths`."""
    quantities: dict[str, Asked] = {}
    for name, point in scene.points.items():
        coordinates = values[f'points.{name}.along'], values[f'points.{name}.across']
        for make in (point_speed, point_acceleration):
            quantity = make(scene.linkage, *point, name=name)
            of: Any = quantity.of           # partial(length, linkage, link, along, across, first)
            _, link, _, _, first = of.args
            quantities[quantity.name] = quantity._replace(
                of=partial(of.func, parametric, link, *coordinates, first))
    return quantities
