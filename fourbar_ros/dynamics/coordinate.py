# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The coordinates of a motion, one after the other: through the toggle positions of the input.

At a toggle the input q turns back, its rate is zero and the equation in it is singular, J = 0/0.
Another coordinate p (:meth:`~fourbar_ros.mechanisms.mechanism.Mechanism.driven_otherwise`: the
slide of a driven crank, the crank of a driven slide, the output link) goes on there and is
regular. Either takes over from the other where that changes so fast with it that |do/dp| > 2, in
units of about the size of the linkage, long before a toggle, so that both are accurate there:

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
from typing import Any, TYPE_CHECKING, Union

from fourbar_ros.dynamics.equation import (
    Equation,
    flat_positions,
    InBothModes,
    interval_of,
)
from fourbar_ros.errors import FourBarError
from fourbar_ros.mechanisms.mechanism import DrivenLinks, Mechanism
from fourbar_ros.numerics.arrays import Array, Value
from fourbar_ros.numerics.number_types import Function, NumberType, REAL
import numpy as np
from numpy.typing import ArrayLike, NDArray

if TYPE_CHECKING:
    from fourbar_ros.dynamics.system import System

State = Union[Sequence[float], Array]
LONGEST, FARTHEST = 2.0, 1e3      # |do/dp| at which o takes over from p; at most, in an event
NEXT_TO_TOGGLE = 1e-6             # distance from an end of the range over half its length


class MotionCoordinate:
    """
    Motion of a system in one coordinate p: the input, or the one that goes on at its toggles.

    ``equation`` is in this coordinate; ``mode`` the assembly mode of the mechanism at ``start``, a
    value of p, and of another coordinate than the input where the input grows with it.
    """

    def __init__(self, coordinates: Coordinates, equation: Equation, mode: int, start: float
                 ) -> None:
        self.all, self.equation, self.is_input = coordinates, equation, equation.is_input
        self._key = equation.coordinate.mode, mode, start
        self.mode, self.mode_beyond = mode, coordinates.partner(mode)
        self.can_end = bool(coordinates.others)       # another coordinate may have to take over
        # the links as the coordinate that takes over drives them, in one of its modes
        others: list[DrivenLinks] = [*coordinates.others.values(), equation.mechanism]
        self._links_of_next = others[0] if self.is_input else equation.mechanism
        # of this coordinate in that of the next one
        self.unit_of_ratio = equation.coordinate.input_unit / self._links_of_next.input_unit

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle the system and which of its coordinates this is."""
        return _of_system, (self.all.system, self.is_input, *self._key)

    @cached_property
    def derivative(self) -> Function:
        """Return (time, state) -> d state / dt."""
        return self.all.system.make_derivative(self)

    def make_other(self, links: DrivenLinks, n: NumberType) -> Function:
        """Return the formula p -> the coordinate that takes over, its two derivatives by p."""
        coefficients, read = links.make_coefficients(n), self._links_of_next.read_coordinate
        return lambda position: read(n, coefficients(position))

    @cached_property
    def other(self) -> InBothModes:
        """Return p -> the coordinate that takes over, and its first two derivatives by p."""
        return self.equation.in_both_modes(self.make_other)

    def excess(self, time: float, state: State) -> float:
        """
        Return |do/dp| - 2, positive where the other coordinate o has to take over.

        An event of an integrator; out of reach of this coordinate it is the largest number.
        """
        try:
            ratio = abs(self.other(float(state[0]))[1])
        except (FourBarError, ArithmeticError):
            return FARTHEST - LONGEST
        return float(min(ratio * self.unit_of_ratio, FARTHEST) - LONGEST)

    def next(self, state: State) -> tuple[MotionCoordinate, list[float]]:
        """Return the coordinate that takes over at a state, and the state in it, (Q1)."""
        other, ratio, _ = map(float, self.other(float(state[0])))
        taking_over = self.all.taking_over(self, float(state[0]), other, ratio)
        if taking_over.is_input:
            other = self.all.continuous(other)
        return taking_over, [other, ratio * float(state[1]), *state[2:]]

    def input_of(self, position: float) -> tuple[float, float, float]:
        """Return the input and its first two derivatives by p, at one p."""
        if self.is_input:
            return position, 1.0, 0.0
        value, ratio, bend = self.other.of_one(position)
        return self.all.continuous(value), ratio, bend

    def states_of_input(self, states: Array) -> Array:
        """Return states in this coordinate as states in the input, of one shape (states, ...)."""
        if self.is_input:
            return states
        value, ratio, _ = self.other(states[0])
        return np.array([self.all.continuous(value), ratio * states[1], *states[2:]])

    def acceleration(self, time: float, state: State) -> float:
        """Return the acceleration of the input at a state in this coordinate, (Q3)."""
        rate, change = state[1], self.derivative(time, state)[1]
        _, ratio, bend = self.input_of(float(state[0]))
        return float(change * ratio + rate * rate * bend)

    def modes(self, positions: ArrayLike) -> NDArray[Any]:
        """
        Return the assembly mode at values of p, integers of their shape.

        Each dyad is a bit of a mode: of more than 63 dyads they are Python's integers.
        """
        positions = np.asarray(positions, float)
        is_other = np.broadcast_to(self.equation.is_alternate(positions), positions.shape)
        if not self.is_input:
            is_other = is_other ^ ~(np.asarray(self.other(positions)[1]) > 0.0)
        modes = self.mode, self.mode_beyond
        dtype = np.int64 if max(modes) < 2**63 else object
        return np.asarray(np.array(modes, dtype)[is_other.astype(int)])


def _of_system(system: System, *key: object) -> MotionCoordinate:
    """Return a coordinate of a system that was pickled."""
    return system.coordinates.of(*key)       # type: ignore[arg-type]  # a key of a coordinate


class Coordinates:
    """
    All coordinates of the motions of a system, in each assembly mode; made when first needed.

    ``mechanism``: in its mode at the input ``start``.
    """

    def __init__(self, system: System, mechanism: Mechanism, start: float) -> None:
        self.system, self._mechanism, self._start = system, mechanism, start
        others = () if mechanism.turns_fully else mechanism.driven_otherwise()
        # mode of the links as this other coordinate drives them -> the links so driven
        self.others: dict[int, DrivenLinks] = {other.mode: other for other in others}
        # of the range between toggles, shifted to the start by whole turns
        self.middle, self.half = 0.0, inf
        if others:
            low, high = min(mechanism.input_ranges, key=lambda ends: abs(
                mechanism.distance(start, 0.5 * (ends[0] + ends[1]))))
            self.middle, self.half = 0.5 * (low + high), 0.5 * (high - low)
            if not mechanism.is_driven_by_slide:
                self.middle = start - remainder(start - self.middle, tau)
        self._known: dict[tuple[bool, int, int, int], MotionCoordinate] = {}
        self.first = self.of(True, mechanism.mode, mechanism.mode, start)

    def of(self, is_input: bool, number: int, mode: int, start: float) -> MotionCoordinate:
        """
        Return a coordinate; ``number``: mode of its links as it drives them.

        ``mode`` and ``start`` as of :class:`MotionCoordinate`. Where flat positions make the mode
        alternate, every second interval between them shares a coordinate.
        """
        links = self._mechanism.in_mode(number) if is_input else self.others[number]
        interval = interval_of(flat_positions(links), links.is_driven_by_slide, start)
        key = is_input, number, mode, interval % 2
        if key not in self._known:
            equation = self.system.make_equation(self._mechanism.in_mode(mode), start,
                                                 None if is_input else links)
            self._known[key] = MotionCoordinate(self, equation, mode, start)
        return self._known[key]

    def at(self, state: State) -> tuple[MotionCoordinate, list[float]]:
        """Return the coordinate in which a run begins at a state of the input, its state there."""
        has_ended = self.first.can_end and self.first.excess(0.0, state) > 0.0
        return self.first.next(state) if has_ended else (self.first, list(state))

    def continuous(self, value: Value) -> Value:
        """
        Return an input in the range of this motion: an angle shifted by whole turns.

        Another coordinate tells the crank's angle but for whole turns; a crank between toggles
        stays within half a turn of the middle of its range.
        """
        if self._mechanism.is_driven_by_slide:
            return value
        if isinstance(value, float):
            return self.middle + remainder(value - self.middle, tau)
        return value - tau * np.round((value - self.middle) / tau)

    def partner(self, mode: int) -> int:
        """Return the mode beyond a flat position or a toggle."""
        mechanism = self._mechanism.in_mode(mode)
        for place in flat_positions(mechanism):
            return int(mechanism.mode_beyond(place))
        return next((other for other in mechanism.modes_passed if other != mode), mode)

    def taking_over(self, last: MotionCoordinate, value: float, other: float, ratio: float
                    ) -> MotionCoordinate:
        """
        Return the coordinate that goes on near a toggle: the input's, or the one in its place.

        ``value``: of the last coordinate; ``other``: of the one that takes over; ``ratio``:
        d other / d value. Where it is negative, the links pass into the other assembly mode.
        """
        mode = int(last.modes(value))
        if not last.is_input:
            return self.of(True, mode, mode, other)
        beyond = mode if ratio > 0.0 else self.partner(mode)
        return self.of(False, self._mode_at(last, value, other), beyond, other)

    def _mode_at(self, last: MotionCoordinate, value: float, other: float) -> int:
        """Return the mode in which the other coordinate has the links where they are now."""
        links = last.equation.links_in(bool(last.equation.is_alternate(value)))
        pose, distances = _pose(links, value), {}
        for number, driven in self.others.items():
            try:
                own = _pose(driven, other)
            except (ValueError, ZeroDivisionError):
                continue
            distances[number] = sum((a - b)**2 for a, b in zip(pose, own))
        return min(distances, key=lambda number: distances[number])

    def prepare(self) -> dict[MotionCoordinate, tuple[MotionCoordinate, MotionCoordinate]]:
        """
        Return {coordinate: the ones that take over}, of a mechanism with two modes and toggles.

        Of a pair the first takes over where it falls with the coordinate, the second where it
        grows.
        """
        inside, found = (1.0 - NEXT_TO_TOGGLE) * self.half, {}
        inputs = {mode: self.of(True, mode, mode, self._start)
                  for mode in self._mechanism.modes_passed}
        for coordinate in inputs.values():
            by_sign = {}
            for position in (self.middle - inside, self.middle + inside):
                other, ratio, _ = coordinate.other.of_one(position)
                by_sign[ratio > 0.0] = self.taking_over(coordinate, position, other, ratio)
            # it may come to both of its toggles with one sign
            one = next(iter(by_sign.values()))
            found[coordinate] = by_sign.get(False, one), by_sign.get(True, one)
        for coordinate in self._known.values():
            if not coordinate.is_input:
                found[coordinate] = inputs[coordinate.mode_beyond], inputs[coordinate.mode]
        return {coordinate: found[coordinate] for coordinate in self._known.values()}


def _pose(links: DrivenLinks, value: float) -> list[float]:
    """Return the places and directions of all links, driven at a value, one after the other."""
    return [number for curve in links.make_coefficients(REAL)(value)
            for number in (curve.x, curve.y, curve.cosine, curve.sine)]
