# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Exact derivatives of outputs and extrema of a scene by its parameters: lengths, masses, any number.

All of them at once, by dual numbers through the formulas of motion and loads. With Q(x, p) a
quantity, x the input, p the parameters, and an extremum inside the input range at x*(p),

    (S1)  d Q(x*, p)/dp = Q_p(x*, p)         as Q_x = 0 there (envelope theorem)
    (S2)  d x*/dp = -Q_xp / Q_xx             (implicit function theorem)

where Q_xp and Q_xx come from a complex step of x through the same duals.
"""
from __future__ import annotations

from collections.abc import Sequence
from math import nan
from typing import Any, NamedTuple

from fourbar_ros.errors import InvalidParameter
from fourbar_ros.extrema.sampling import NoLoads
from fourbar_ros.numerics.arrays import Array
from fourbar_ros.numerics.duals import derivatives_of, Dual, duals_of, value_of
from fourbar_ros.numerics.number_types import ARRAY, COMPLEX_WITH_ANGLES, NumberType
from fourbar_ros.scene.parameters import find
from fourbar_ros.scene.scene import Scene
from fourbar_ros.studies.designs import (
    constants_of,
    dimensions_of,
    point_quantities_of,
    with_lengths,
)
from fourbar_ros.studies.measures import Measures
import numpy as np

INPUT, STEP = 'input', 2.0**-200
# An extremum farther than this [rad] from where the slope vanishes is no smooth one: that of a
# transmission angle where another dyad becomes the one that is nearest to its toggle.
SHARP = 1e-5

By = dict[str, Any]      # {parameter: derivative}


class AtExtremum(NamedTuple):
    """How an extremum moves: derivatives of its value and of its place by each parameter."""

    value: By
    place: By


class Formulas(NamedTuple):
    """Formulas for numbers of one type, made for a scene whose parameters are such numbers."""

    motion: Any
    loads: Any
    rate: Any
    quantities: dict[str, Any]


def formulas_of(scene: Scene, numbers: NumberType, values: dict[str, Any]) -> Formulas:
    """Return the :class:`Formulas` of a scene for values of its parameters of any type."""
    linkage, constants = scene.linkage, constants_of(scene, values, numbers)
    many = with_lengths(linkage, constants.lengths)
    with np.errstate(all='ignore'):
        return Formulas(linkage.motion_formula(numbers, constants),
                        linkage.loads_formula(numbers, constants) if linkage.bodies else None,
                        values['drive.speed'],
                        Measures(scene).quantities | point_quantities_of(scene, values, many))


def usable(scene: Scene) -> tuple[str, ...]:
    """Return the parameters that a scene gives and by which there are derivatives."""
    linkage = scene.linkage
    places = (*dimensions_of(scene), 'bodies.rods.',
              *[f'bodies.{link.name}.' for link in linkage.LINKS], 'gravity.',
              *[f'external.{link}.' for link in linkage.EXTERNAL._fields], 'points.',
              'drive.speed')
    known = [(name, find(name)) for name in scene.values if name.startswith(places)]
    return tuple([name for name, parameter in known
                  if parameter is not None and parameter.type == 'double'
                  and scene.values[name] == scene.values[name]])


class Derivatives:
    """
    Derivatives of the quantities of a scene by some of its parameters.

    Parameters
    ----------
    scene : Scene
        Of any mechanism.
    names : sequence of str, optional
        Parameters of the scene; default: all numbers that it gives.
    acceleration : float
        Of the input; its rate is that of the drive.

    Raises
    ------
    InvalidParameter
        A parameter is no number that the scene gives.

    """

    def __init__(self, scene: Scene, names: Sequence[str] = (), acceleration: float = 0.0) -> None:
        known = usable(scene)
        for name in names:
            if name not in known:
                raise InvalidParameter(name, scene.values.get(name),
                                       'must be a number that the scene gives')
        self.scene, self.names, self.acceleration = scene, tuple(names) or known, acceleration
        values = scene.values | {name: Dual(scene.values[name], {name: 1.0})
                                 for name in self.names}
        self._real = formulas_of(scene, duals_of(ARRAY), values)
        self._sharp = SHARP * scene.linkage.input_unit
        self._complex = formulas_of(scene, duals_of(COMPLEX_WITH_ANGLES), values)
        self.quantities = self._real.quantities

    def state(self, x: Array, with_loads: bool = True) -> tuple[Any, Any]:
        """
        Return (motion, loads) at inputs x, shape (n,): fields are duals, or plain numbers.

        ``value_of`` and ``derivatives_of`` take them apart.
        """
        return self._state(self._real, x, with_loads)

    def _state(self, formulas: Formulas, x: Any, with_loads: bool) -> tuple[Any, Any]:
        linkage = self.scene.linkage
        with np.errstate(all='ignore'):
            fields = formulas.motion(x, formulas.rate, self.acceleration)
            loads = (linkage.LOADS(*formulas.loads(fields)) if with_loads and formulas.loads
                     else NoLoads())
        return linkage.MOTION(*fields), loads

    def of(self, name: str, x: Array) -> tuple[Array, By]:
        """Return values of a quantity at inputs x, shape (n,), and {parameter: derivatives}."""
        quantity = self._real.quantities[name]
        with np.errstate(all='ignore'):
            dual = quantity.of(*self.state(x, quantity.is_load))
        value, by = value_of(dual), derivatives_of(dual)
        zero = np.zeros_like(x)
        return zero + value, {one: zero + by.get(one, 0.0) for one in self.names}

    def at_extremum(self, name: str, x: float) -> AtExtremum:
        """
        Return how an extremum of a quantity inside the input range moves, (S1) and (S2).

        NaN where the quantity has a kink or a jump; the place of what is constant is NaN.
        """
        quantity = self._complex.quantities[name]
        there = Dual(np.array([x + 1j * STEP]), {INPUT: 1.0})
        with np.errstate(all='ignore'):
            by = derivatives_of(quantity.of(*self._state(self._complex, there,
                                                         quantity.is_load)))
            parts = {one: np.ravel(by.get(one, 0.0) + 0j)[0] for one in (*self.names, INPUT)}
            slope = parts.pop(INPUT)
            off = slope.real / slope.imag if slope else 0.0     # what is constant has no place
            unknown = nan if STEP * abs(off) > self._sharp else 0.0
            moves = {one: float(-part.imag / slope.imag) + unknown
                     for one, part in parts.items()}
            # x is the place but for rounding: what slope is left there moves with it
            return AtExtremum({one: float(part.real - off * part.imag) + unknown
                               for one, part in parts.items()}, moves)
