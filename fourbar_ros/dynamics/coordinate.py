# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The coordinates of a motion, one after the other: through the toggle positions of the input.

At a toggle the input q turns back, its rate is zero and the equation in it is singular, J = 0/0.
Another coordinate p (:meth:`~fourbar_ros.mechanisms.mechanism.Mechanism.driven_otherwise`: the
slide of a driven crank, the crank of a driven slide, the output link) goes on there and is
regular; not with friction, whose direction is that of the input. Next to a toggle p takes over
from q, later q from p: each where the successor o of the coordinate in use changes so fast with it
that |do/dp| > 2, in units of about the size of the mechanism, long before a toggle, so that both
are accurate there:

    o. = p. do/dp                                                                          (Q1)
    torque on p = T dq/dp                                                                  (Q2)
    d2q/dt2 = p.. dq/dp + p.^2 d2q/dp2                                                     (Q3)

Along p the input turns back, dq/dp = 0, exactly where the assembly mode changes: so the sign of
dq/dp tells the mode.
"""
from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from math import inf, remainder, tau
from operator import attrgetter
from typing import Any, TYPE_CHECKING

from fourbar_ros.dynamics.equation import compiled, Equation
from fourbar_ros.errors import FourBarError
from fourbar_ros.mechanisms.mechanism import DrivenLinks, Mechanism
from fourbar_ros.numerics.arrays import Array, Value
from fourbar_ros.numerics.number_types import Function, NumberType, REAL
import numpy as np
from numpy.typing import ArrayLike, NDArray

if TYPE_CHECKING:
    from fourbar_ros.dynamics.system import System

State = Sequence[float] | Array
LONGEST, FARTHEST = 2.0, 1e3      # |do/dp| at which o takes over from p; its bound in an event
NEXT_TO_TOGGLE = 1e-6             # distance from an end of the range over half its length


class MotionCoordinate:
    """Motion of a system in one coordinate p: the input, or that which goes on at its toggles."""

    # equation: in this coordinate. mode: the assembly mode of the mechanism, of another coordinate
    # than the input where the input grows with it.

    def __init__(self, coordinates: Coordinates, equation: Equation, mode: int) -> None:
        self.all, self.equation, self.is_input = coordinates, equation, equation.is_input
        self.mode, self.mode_beyond = mode, coordinates.partner(mode)
        self.can_end = bool(coordinates.driven_otherwise)     # a successor may have to take over
        # the links as the successor drives them, in one of its modes
        self._links_of_successor: DrivenLinks = equation.mechanism
        if self.is_input and coordinates.driven_otherwise:
            self._links_of_successor = next(iter(coordinates.driven_otherwise.values()))
        # unit of this coordinate over that of the successor
        self.unit_of_ratio = equation.coordinate.input_unit / self._links_of_successor.input_unit

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle the coordinates of the system, and which of them this is."""
        return Coordinates.of, (self.all, self.is_input, self.equation.coordinate.mode, self.mode)

    @cached_property
    def derivative(self) -> Function:
        """Return (time, state) -> d state / dt."""
        return self.all.system.make_derivative(self)

    def make_successor(self, links: DrivenLinks, n: NumberType) -> Function:
        """Return the formula p -> the coordinate that takes over, its two derivatives by p."""
        coefficients, read = links.make_coefficients(n), self._links_of_successor.read_coordinate
        return lambda position: read(n, coefficients(position))

    @cached_property
    def successor(self) -> Function:
        """Return that formula as a function of one p or an array of them."""
        return compiled(self.make_successor, self.equation.coordinate)

    def excess(self, time: float, state: State) -> float:
        """Return |do/dp| - 2, positive where the successor o has to take over: an event."""
        try:
            _, ratio, _ = self.successor(float(state[0]))
        except (FourBarError, ArithmeticError):     # out of reach of this coordinate
            return FARTHEST - LONGEST
        return float(min(abs(ratio) * self.unit_of_ratio, FARTHEST) - LONGEST)

    def next(self, state: State) -> tuple[MotionCoordinate, list[float]]:
        """Return the coordinate that takes over at a state, and the state in it, (Q1)."""
        position, rate, *rest = state
        value, ratio, _ = map(float, self.successor(float(position)))
        taking_over = self.all.taking_over(self, float(position), value, ratio)
        if taking_over.is_input:
            value = self.all.continuous(value)
        return taking_over, [value, ratio * float(rate), *rest]

    def input_of(self, position: float) -> tuple[float, float, float]:
        """Return the input and its first two derivatives by p, at one p."""
        if self.is_input:
            return position, 1.0, 0.0
        value, ratio, bend = self.successor(position)
        return self.all.continuous(value), ratio, bend

    def states_of_input(self, states: Array) -> Array:
        """Return states in this coordinate, (fields, ...), as states in the input."""
        if self.is_input:
            return states
        position, rate, *rest = states
        value, ratio, _ = self.successor(position)
        return np.array([self.all.continuous(value), ratio * rate, *rest])

    def acceleration(self, time: float, state: State) -> float:
        """Return the acceleration of the input at a state in this coordinate, (Q3)."""
        rate, change = state[1], self.derivative(time, state)[1]
        _, ratio, bend = self.input_of(float(state[0]))
        return float(change * ratio + rate * rate * bend)

    def modes(self, positions: ArrayLike) -> NDArray[Any]:
        """Return the assembly mode at values of p, integers of their shape."""
        # Each dyad is a bit of a mode: of more than 63 dyads they are Python's integers.
        positions = np.asarray(positions, float)
        grows = (np.ones(positions.shape, bool) if self.is_input
                 else np.asarray(self.successor(positions)[1]) > 0.0)
        dtype = np.int64 if max(self.mode, self.mode_beyond) < 2**63 else object
        return np.where(grows, np.array(self.mode, dtype), np.array(self.mode_beyond, dtype))


class Coordinates:
    """All coordinates of the motions of a system, in each mode; made when first needed."""

    # mechanism: in its mode at the input start

    def __init__(self, system: System, mechanism: Mechanism, start: float) -> None:
        self.system, self._mechanism = system, mechanism
        # the links as the coordinate that goes on at toggles drives them, by their mode then
        self.driven_otherwise: dict[int, DrivenLinks] = (
            {} if mechanism.turns_fully or mechanism.has_direction else
            {links.mode: links for links in mechanism.driven_otherwise()})
        # of the range between toggles, shifted to the start by whole turns
        self.middle, self.half = 0.0, inf
        if not mechanism.turns_fully:
            low, high = mechanism.range_around(start)
            self.middle, self.half = 0.5 * (low + high), 0.5 * (high - low)
        self._known: dict[tuple[bool, int, int], MotionCoordinate] = {}
        self.first = self.of(True, mechanism.mode, mechanism.mode)

    def __reduce__(self) -> tuple[object, ...]:
        return attrgetter('coordinates'), (self.system,)

    def of(self, is_input: bool, driven_mode: int, mode: int) -> MotionCoordinate:
        """Return a coordinate in a mode of the mechanism; ``driven_mode``: of links it drives."""
        key, drive = (is_input, driven_mode, mode), self.system.drive
        if key not in self._known:
            equation = Equation(self._mechanism.in_mode(mode), drive.rigid_inertia if drive
                                else 0.0, None if is_input else self.driven_otherwise[driven_mode])
            self._known[key] = MotionCoordinate(self, equation, mode)
        return self._known[key]

    def begin(self, state: State) -> tuple[MotionCoordinate, list[float]]:
        """Return the coordinate in which a run begins at a state of the input, its state there."""
        has_ended = self.first.can_end and self.first.excess(0.0, state) > 0.0
        return self.first.next(state) if has_ended else (self.first, list(state))

    def continuous(self, value: Value) -> Value:
        """Return an input in the range of this motion: of angles the nearest to its middle."""
        # From another coordinate the angle of the crank is known but for whole turns; a crank
        # between toggles never turns fully.
        if self._mechanism.is_driven_by_slide:
            return value
        if isinstance(value, float):                # the same, many times faster than numpy
            return self.middle + remainder(value - self.middle, tau)
        return value - tau * np.round((value - self.middle) / tau)

    def partner(self, mode: int) -> int:
        """Return the mode beyond a toggle."""
        passed = self._mechanism.in_mode(mode).modes_passed
        return next((beyond for beyond in passed if beyond != mode), mode)

    def taking_over(self, last: MotionCoordinate, value: float, successor: float, ratio: float
                    ) -> MotionCoordinate:
        """Return the coordinate that goes on near a toggle, with the value ``successor``."""
        # value: of the last coordinate; ratio: d successor / d value. Where it is negative, the
        # links pass into the other assembly mode.
        mode = int(last.modes(value))
        if not last.is_input:
            return self.of(True, mode, mode)
        # the mode in which the successor has the links where they are now
        pose, distances = _pose(last.equation.coordinate, value, 1.0), {}
        for driven_mode, driven in self.driven_otherwise.items():
            try:
                driven_pose = _pose(driven, successor, ratio)
            except (ValueError, ZeroDivisionError):
                continue
            distances[driven_mode] = sum((a - b)**2 for a, b in zip(pose, driven_pose))
        nearest = min(distances, key=lambda driven_mode: distances[driven_mode])
        return self.of(False, nearest, mode if ratio > 0.0 else self.partner(mode))

    def prepare(self) -> dict[MotionCoordinate, tuple[MotionCoordinate, ...]]:
        """Return {coordinate: (first, second)}, of a mechanism with two modes and toggles."""
        # The first takes over where it falls with the coordinate, the second where it grows; () of
        # the input of a change point: taking_over tells.
        inside = (1.0 - NEXT_TO_TOGGLE) * self.half
        successors = dict[MotionCoordinate, tuple[MotionCoordinate, ...]]()
        inputs = {mode: self.of(True, mode, mode) for mode in self._mechanism.modes_passed}
        for mode, coordinate in inputs.items():
            if self._mechanism.change_point_margin == 0.0:
                # an odd turn of p is in the other mode of its links than an even one
                successors[coordinate] = ()
                for driven_mode in self.driven_otherwise:
                    self.of(False, driven_mode, mode)
                continue
            by_sign = {}
            for position in (self.middle - inside, self.middle + inside):
                value, ratio, _ = coordinate.successor(position)
                by_sign[ratio > 0.0] = self.taking_over(coordinate, position, value, ratio)
            # it may come to both of its toggles with one sign
            either = next(iter(by_sign.values()))
            successors[coordinate] = by_sign.get(False, either), by_sign.get(True, either)
        for coordinate in self._known.values():
            if not coordinate.is_input:
                successors[coordinate] = inputs[coordinate.mode_beyond], inputs[coordinate.mode]
        return {coordinate: successors[coordinate] for coordinate in self._known.values()}


def _pose(links: DrivenLinks, value: float, rate: float) -> list[float]:
    """Return first joints and directions of all links, driven at a value, and how they move."""
    # At the flat position of a change point the modes differ in how they move alone.
    return [entry for curve in links.make_coefficients(REAL)(value)
            for entry in (curve.x, curve.y, curve.cosine, curve.sine, rate * curve.v_x,
                          rate * curve.v_y, rate * curve.omega)]
