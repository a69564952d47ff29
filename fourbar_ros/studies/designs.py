# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Many designs of one scene as one mechanism whose numbers are columns of shape (n, 1).

The formulas of motion and loads are those of every other computation, with
:func:`~fourbar_ros.numerics.number_types.columns_of` numbers.
"""
from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from dataclasses import replace
from functools import partial
from typing import Any

from fourbar_ros.extrema.sampling import NoLoads
from fourbar_ros.mechanics.bodies import Applied, Body, rod_numbers, unchecked
from fourbar_ros.mechanisms.contract import Constants, OPEN
from fourbar_ros.mechanisms.quantities import point_acceleration, point_speed
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.numerics.exact_sums import exact_sum_of_four
from fourbar_ros.numerics.number_types import (
    ARRAY,
    columns_of,
    COMPLEX,
    COMPLEX_WITH_ANGLES,
    Function,
    NumberType,
)
from fourbar_ros.scene.linkage import Bodies, external_of
from fourbar_ros.scene.parameters import find, MACHINE
from fourbar_ros.scene.scene import Scene
import numpy as np

NEARLY = 1e-12      # beside the sum of lengths


def _sum_of_columns(columns: Sequence[Array]) -> Array:
    """Return the sum of up to four columns, as good as exact."""
    one, other, *rest = columns
    return exact_sum_of_four((one, other, *rest, *[0.0 * one] * (2 - len(rest))))


class _Columns(Bodies):
    """Bodies of which numbers may be columns."""

    body = staticmethod(partial(unchecked, Body))

    @staticmethod
    def rod(length: Any, density: Any, radius: Any) -> Body:
        return unchecked(Body, *rod_numbers(length, density, radius))


def is_machine(scene: Scene) -> bool:
    """Return whether the mechanism of a scene is a machine of dyads, put together at run time."""
    return bool(scene.values['linkage.kind'] == MACHINE)


def constants_of(scene: Scene, values: dict[str, Any], numbers: NumberType = ARRAY) -> Constants:
    """
    Return what the formulas of a scene's mechanism are made for.

    Parameters
    ----------
    scene : Scene
        One like it: of the same kind or the same dyads, in the same mode.
    values : dict
        All parameters: floats, or numbers of any type.
    numbers : NumberType
        That type, for the directions of a machine.

    """
    linkage = scene.linkage
    external = external_of(values, linkage, partial(unchecked, Applied))
    constants: Constants = linkage.constants._replace(
        gravity=(values['gravity.x'], values['gravity.y']), external=linkage.EXTERNAL(**external))
    if is_machine(scene):
        from fourbar_ros.scene import machines  # only these scenes need its formulas

        bodies = _Columns(values, linkage.LINKS, {link.length: values[f'dyads.{link.length}']
                                                  for link in linkage.LINKS if link.length})
        given = bodies.those_given() if bodies.are_given else None
        return constants._replace(lengths=machines.numbers_of(linkage, values, numbers),
                                  bodies=machines.bodies_of(linkage, given))
    lengths = {name: values[f'linkage.{name}'] for name in linkage.length_names}
    bodies = _Columns(values, linkage.LINKS, lengths)
    return constants._replace(
        lengths=tuple(lengths.values()),
        bodies=linkage.BODIES(**bodies.every()) if bodies.are_given else None)


def dimensions_of(scene: Scene) -> tuple[str, ...]:
    """Return the beginnings of the names of the parameters that are dimensions of its links."""
    if is_machine(scene):
        return 'dyads.', *['cylinder.'] * (scene.linkage.input == 'cylinder')
    return tuple([f'linkage.{name}' for name in scene.linkage.length_names])


def with_lengths(linkage: Any, lengths: Sequence[Any]) -> Any:
    """
    Return a linkage whose lengths are any numbers: quantities of points take them from it.

    Those of a machine take all they need from its motion.
    """
    own = [(name, length) for name, length in zip(linkage.length_names, lengths)
           if hasattr(linkage, name)]
    many = copy(linkage) if own else linkage
    for name, length in own:
        object.__setattr__(many, name, length)
    return many


def point_quantities_of(scene: Scene, values: dict[str, Any], many: Any) -> dict[str, Any]:
    """Return {name: quantity} of the points of a scene, whose parameters are any numbers."""
    found = {}
    for name, point in scene.points.items():
        place = values[f'points.{name}.along'], values[f'points.{name}.across']
        for make in (point_speed, point_acceleration):
            one = make(scene.linkage, *point, name=name)
            known: Any = one.of              # a partial
            _, link, _, _, first = known.args
            found[one.name] = one._replace(of=partial(known.func, many, link, *place, first))
    return found


class Designs:
    """
    Designs of a scene, evaluated together.

    Parameters
    ----------
    scene : Scene
        Any of them.
    values : dict
        All parameters of the scene.
    drawn : dict
        {parameter that varies: its values, shape (n,)}.
    with_angles : bool
        Angles, and their derivatives by a complex step too, are computed; they are zero if not.

    """

    def __init__(self, scene: Scene, values: dict[str, Any], drawn: dict[str, Array],
                 with_angles: bool = True):
        self.scene = scene
        self._with_angles = with_angles
        self._complex = COMPLEX_WITH_ANGLES if with_angles else COMPLEX
        self.size = len(next(iter(drawn.values())))
        columns = {name: np.asarray(column, float)[:, None] for name, column in drawn.items()}
        self.values = values | columns
        constants = constants_of(scene, self.values)
        lengths = tuple([np.broadcast_to(length, (self.size, 1)) for length in constants.lengths])
        self._constants = constants._replace(
            lengths=lengths, sign=np.where(np.equal(self.values['linkage.mode'], OPEN), 1.0, -1.0))
        self.lengths = self._constants.lengths
        self.many = with_lengths(scene.linkage, lengths)
        self.rate = self.values['drive.speed']
        self._made: dict[NumberType, tuple[Function, Function | None]] = {}

    def are_allowed(self) -> Array:
        """Return which designs have values that the table of parameters allows, shape (n,)."""
        good = np.ones(self.size, bool)
        for name, column in self.values.items():
            parameter = find(name)
            if isinstance(column, np.ndarray) and parameter is not None:
                value = column[:, 0]
                good &= (np.isfinite(value) & (value >= parameter.low) & (value <= parameter.high)
                         & ((value > 0.0) | (not parameter.positive)))
        return good

    def state(self, x: Array, acceleration: float, with_loads: bool) -> tuple[Any, Any]:
        """Return (motion, loads) at inputs of shape (n, any), real or complex."""
        motion_of, loads_of = self._formulas(x.dtype.kind == 'c')
        if x.strides[0] == 0:       # the same inputs for all: functions of them alone once
            x = x[:1]
        with np.errstate(all='ignore'):
            motion = self.scene.linkage.MOTION(*motion_of(x, self.rate, acceleration))
            loads = (self.scene.linkage.LOADS(*loads_of(motion)) if with_loads and loads_of
                     else NoLoads())
        return motion, loads

    def _formulas(self, is_complex: bool) -> tuple[Function, Function | None]:
        """Return the formulas of motion and loads; without angles the same for all inputs."""
        numbers = self._complex if is_complex or not self._with_angles else ARRAY
        if numbers not in self._made:
            columns = replace(columns_of(numbers), exact_sum=_sum_of_columns)
            linkage = self.scene.linkage
            with np.errstate(all='ignore'):
                self._made[numbers] = (
                    linkage.motion_formula(columns, self._constants),
                    linkage.loads_formula(columns, self._constants)
                    if linkage.bodies is not None else None)
        return self._made[numbers]

    def point_quantities(self) -> dict[str, Any]:
        """Return {name: quantity} of the points of the scene, with columns."""
        return point_quantities_of(self.scene, self.values, self.many)

    def point(self, name: str) -> tuple[Any, Any]:
        """Return along and across of a point."""
        return self.values[f'points.{name}.along'], self.values[f'points.{name}.across']

    def margins(self) -> Array | None:
        """
        Return :attr:`.Mechanism.margins` over the sum of lengths, shape (margins, n).

        None if they are no sums of lengths.
        """
        linkage, sizes = self.scene.linkage, np.abs(np.concatenate(self.lengths, axis=1))
        signs = np.array(linkage.MARGIN_SIGNS, float).reshape(-1, sizes.shape[1])
        own = np.abs(np.array(linkage.lengths))
        if not np.allclose(signs @ own, linkage.margins, 0.0, NEARLY * own.sum()):
            return None
        return np.asarray((signs @ sizes.T) / sizes.sum(axis=1))
