# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Loads of a mechanism with springs, dampers and forces over a position.

The loads know external forces only: so the forces of elements are added to the constant external
force of their link.
"""
from __future__ import annotations

from collections.abc import Callable, Sequence
from math import isfinite
from typing import Any, Union

from fourbar_ros.dynamics.elements import Element, ForceOnLink, links_of, PositionForce
from fourbar_ros.errors import FourBarError, InvalidParameter, MissingBodies
from fourbar_ros.mechanics.bodies import Applied, applied_to, unchecked
from fourbar_ros.mechanisms.curves import FIXED, LinkMotion, point_of
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.parts import GROUND, NamedFields
from fourbar_ros.mechanisms.points import with_any_lengths
from fourbar_ros.numerics.number_types import ARRAY, NumberType, REAL
import numpy as np
from numpy.typing import ArrayLike

Loaded = Callable[[float, float], Union[Mechanism, None]]


def make_external(n: NumberType, linkage: Mechanism, elements: Sequence[Element],
                  lengths: Sequence[Any] | None = None) -> Callable[[NamedFields, Any, Any], Any]:
    """
    Return the function (motion, input, constant forces) -> forces on all links, with elements.

    Those of a link with elements act at the point of its constant force; forces on the ground are
    left out. A link without elements keeps its constant force. Not checked to be finite;
    arguments and result are of the number type ``n``, and so are ``lengths``, if they take the
    place of those of the linkage.
    """
    moving = linkage if lengths is None else with_any_lengths(linkage, lengths)
    named = links_of(elements, linkage)
    springs = [element for element in elements if not isinstance(element, PositionForce)]
    pushes = [(element, element.make_value(linkage)) for element in elements
              if isinstance(element, PositionForce)]

    def external(motion: NamedFields, position: Any, constant: Any) -> Any:
        """Return a record {link: :class:`Applied`}."""
        motions = {link: moving.link_motion(motion, link) for link in named}
        motions[GROUND] = FIXED
        acting = [force for spring in springs for force in spring.forces(n, motions)]
        acting += [force for element, value in pushes for force in
                   element.forces(n, value, motions, position)]
        return constant._replace(**{link: _sum_of(
            applied_to(constant, link), motions[link],
            [force for force in acting if force.link == link]) for link in named})
    return external


def make_loaded(linkage: Mechanism, elements: Sequence[Element]) -> Loaded:
    """
    Return the function (position, rate) -> linkage with the elements' forces of this moment.

    They come on top of its constant external forces, and act on any link, a driven crank too: so
    ``loads`` of that linkage include springs, dampers and forces over a position. It returns None
    where a force is not finite.
    """
    external = make_external(REAL, linkage, elements)

    def loaded(position: float, rate: float) -> Mechanism | None:
        """
        Return the linkage with the forces at this input and rate, None where one is not finite.

        They do not depend on the acceleration.
        """
        try:
            motion = linkage.motion(position, rate, 0.0)
        except FourBarError:
            return linkage                               # out of range: its own loads say so
        try:
            forces = external(motion, position, linkage.external)
        except (ArithmeticError, InvalidParameter):      # ends of a spring meet, no finite value
            return None
        is_finite = all(isfinite(component) for force in forces
                        for component in (force.force_x, force.force_y, force.couple))
        return linkage.with_external(forces) if is_finite else None
    return loaded


def loads_with(linkage: Mechanism, elements: Sequence[Element], position: ArrayLike,
               rate: ArrayLike = 0.0, acceleration: ArrayLike = 0.0) -> NamedFields:
    """
    Return the loads of a prescribed motion with springs, dampers and forces over a position.

    ``position``, ``rate`` and ``acceleration`` of the input broadcast. The record is that of
    ``linkage.loads``: fields of the broadcast shape, NaN where there are no loads. Raises
    MissingBodies and InvalidParameter.
    """
    if linkage.bodies is None:
        raise MissingBodies
    motions = np.broadcast_arrays(*(np.asarray(value, float) for value in
                                    (position, rate, acceleration)))
    shape = motions[0].shape
    positions, rates, accelerations = (np.ravel(value) for value in motions)
    with np.errstate(all='ignore'):
        motion = linkage.motion(positions, rates, accelerations)
        external = make_external(ARRAY, linkage, elements)(motion, positions, linkage.external)
        loads = linkage.loads_formula(ARRAY, linkage.with_external(external).constants)(motion)
    rows = [np.broadcast_to(row, positions.shape).reshape(shape) for row in loads]
    record: NamedFields = linkage.LOADS(*(rows if shape else [float(row) for row in rows]))
    return record


def _sum_of(constant: Applied, link: LinkMotion, acting: Sequence[ForceOnLink]) -> Applied:
    """
    Return the external force that does the same as a constant force and more forces on its link.

    It acts at the point of the constant force, which is fixed to the link: the moments of the
    others about that point are added.
    """
    point = point_of(link, constant.along, constant.across)
    couple, force_x, force_y = 0.0, 0.0, 0.0
    for force in acting:                  # in a loop: sum() rounds otherwise from Python 3.12 on
        couple = couple + (force.couple + (force.x - point.x) * force.force_y
                           - (force.y - point.y) * force.force_x)
        force_x, force_y = force_x + force.force_x, force_y + force.force_y
    return unchecked(Applied, constant.force_x + force_x, constant.force_y + force_y,
                     constant.along, constant.across, constant.couple + couple)
