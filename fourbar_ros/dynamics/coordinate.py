# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Motion in one coordinate after the other: through the toggle positions of the input.

At a toggle the input turns back, its rate is zero and the equation in it is singular, J = 0/0.
Another coordinate (:meth:`~fourbar_ros.mechanisms.mechanism.Mechanism.driven_otherwise`: the slide
of a driven crank, the crank of a driven slide, the output link) goes on there and is regular. A
phase is a part of a motion in one coordinate p and one assembly mode. It lasts until the other
coordinate o changes so fast with p that |do/dp| > 2, in units of about the size of the linkage:
long before a toggle, so that both are accurate where one takes over from the other:

    o. = p. do/dp                                                                          (T1)
    torque on p = T dq/dp,   dq/dp of the input q                                          (T2)
    d2q/dt2 = p.. dq/dp + p.^2 d2q/dp2                                                     (T3)
"""
from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cached_property, partial
from math import inf, remainder, sin, tau
from typing import NamedTuple, TYPE_CHECKING, Union

from fourbar_ros.dynamics.equation import Equation, InBothModes, make_reading
from fourbar_ros.dynamics.smooth import flat_positions, make_interval_of
from fourbar_ros.errors import FourBarError
from fourbar_ros.mechanisms.mechanism import DrivenLinks, Mechanism
from fourbar_ros.numerics.arrays import Array, Value
from fourbar_ros.numerics.number_types import ARRAY, Function, NumberType, Scalar
from fourbar_ros.numerics.straight_line import straight_line
import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from fourbar_ros.dynamics.system import System

State = Union[Sequence[float], Array]
# how a leg of a run ends
COMPLETE, GAVE_UP, AT_LIMIT, AT_CHANGE_POINT, HANDED_OVER, AT_EVENT, AT_KINK = (
    'complete', 'gave up', 'at a limit', 'at a change point', 'handed over', 'at an event',
    'at a kink')
LONGEST, FARTHEST = 2.0, 1e3      # |do/dp| at which o takes over from p; at most, in an event
MakeEquation = Callable[[Mechanism, float, Union[DrivenLinks, None]], Equation]


class Event(NamedTuple):
    """Something that ends a leg of a run."""

    function: Callable[..., float]       # (time, state in the phase) -> number: at its zeros
    end: str                             # how the leg then ends, as AT_LIMIT
    direction: float = 0.0               # 1: where it rises, -1: where it falls, 0: both
    before: float | None = None          # its value at the start, if not that of the function


class Phase:
    """
    Motion of a system in one coordinate, from one assembly mode on.

    ``start``: a value of the coordinate at which the mechanism is in the mode of the equation;
    ``other``: the coordinate that takes over near a toggle, None where none does.
    """

    def __init__(self, course: Course, equation: Equation, start: float,
                 other: DrivenLinks | None = None) -> None:
        """Make the derivative of the state in this coordinate."""
        self.course, self.equation, self._other = course, equation, other
        self.is_input = equation.coordinate is equation.mechanism
        self._key = self.is_input, equation.coordinate.mode, start
        self.derivative = course.system.make_derivative(self)

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle the system and which of its phases this is."""
        return _of_system, (self.course.system, self._key)

    @property
    def _next_coordinate(self) -> DrivenLinks:
        assert self._other is not None, 'no coordinate takes over'
        return self._other

    def make_other(self, coordinate: DrivenLinks, n: NumberType) -> Function:
        """Return the formula of the coordinate that takes over, with its two derivatives."""
        return make_reading(self._next_coordinate)(coordinate, n)

    @cached_property
    def _reading(self) -> InBothModes:
        return self.equation.in_both_modes(self.make_other)

    @property
    def unit_of_ratio(self) -> float:
        """Return the unit of this coordinate in units of the one that takes over."""
        return self.equation.coordinate.input_unit / self._next_coordinate.input_unit

    @cached_property
    def pose(self) -> InBothModes:
        """Return the function p -> places and directions of all links, by which modes are told."""
        return self.equation.in_both_modes(make_pose)

    def prepare(self) -> None:
        """Make the functions of this phase now: the first use takes as long as 100 steps."""
        for function in (self._reading, self.pose, self.equation.input):
            assert function is not None

    def excess(self, time: float, state: State) -> float:
        """
        Return |do/dp| - 2, positive where the other coordinate o has to take over.

        An event of an integrator; both coordinates count in units of the linkage's size.
        """
        ratio = abs(self._reading(float(state[0]))[1])
        return float(min(ratio * self.unit_of_ratio, FARTHEST) - LONGEST)

    def excess_or_most(self, time: float, state: State) -> float:
        """Return the same; out of reach of the coordinate the largest excess."""
        try:
            return self.excess(time, state)
        except (FourBarError, ArithmeticError):
            return FARTHEST

    def to_flat(self, time: float, state: State) -> float:
        """Return a product that changes its sign at each flat position, to stop a run there."""
        coordinate, product = self.equation.coordinate, 1.0
        for place in flat_positions(coordinate):
            way = float(state[0]) - place
            product *= way if coordinate.is_driven_by_slide else sin(0.5 * way)
        return product

    @property
    def can_end(self) -> bool:
        """Return whether another coordinate may have to take over."""
        return self._other is not None

    def next(self, state: State) -> tuple[Phase, list[float]]:
        """
        Return the phase that takes over at a state, and the state in its coordinate, (T1).

        Its assembly mode is the one in which the links stand as they do here.
        """
        position, ratio, _ = self._reading(float(state[0]))
        other = self.course.like(self, float(state[0]), float(position))
        if other.is_input:
            position = self.course.continuous(position)
        return other, [float(position), float(ratio * state[1]), *state[2:]]

    def energy(self, state: State) -> float:
        """Return kinetic plus potential energy at a state [J]."""
        return float(self.equation.energy(float(state[0]), float(state[1])))

    def input_of(self, position: float) -> tuple[float, float, float]:
        """Return the input and its first two derivatives by the coordinate, at one value of it."""
        if self.is_input:
            return position, 1.0, 0.0
        value, ratio, bend = self.equation.input.of_one(position)
        return self.course.continuous(value), ratio, bend

    def states_of_input(self, states: Array) -> Array:
        """Return states in this coordinate as states in the input, of one shape (states, ...)."""
        if self.is_input:
            return states
        value, ratio, _ = self.equation.input(states[0])
        return np.array([self.course.continuous(value), ratio * states[1], *states[2:]])

    def acceleration(self, time: float, state: State) -> float:
        """Return the acceleration of the input at a state in this coordinate, (T3)."""
        rate, change = state[1], self.derivative(time, state)[1]
        _, ratio, bend = self.input_of(float(state[0]))
        return float(change * ratio + rate * rate * bend)

    def modes(self, states: Array) -> NDArray[np.int64]:
        """
        Return the assembly mode at states (states, n) in this coordinate: n integers.

        It is the mode whose pose at the input of the state is nearest to the pose of the state.
        """
        mechanism = self.equation.mechanism
        inputs = self.states_of_input(states)[0]
        own = self.pose(states[0])
        distances = []
        for mode in mechanism.modes_passed:
            with np.errstate(all='ignore'):
                pose = make_pose(mechanism.in_mode(mode), ARRAY)(inputs)
            distances.append(np.nan_to_num(sum((a - b)**2 for a, b in zip(own, pose)), nan=np.inf))
        modes: NDArray[np.int64] = np.array(mechanism.modes_passed)[np.argmin(distances, axis=0)]
        return modes


def _of_system(system: System, key: tuple[bool, int, float]) -> Phase:
    """Return a phase of a system that was pickled."""
    return system.course.of(*key)


def make_pose(coordinate: DrivenLinks, n: NumberType
              ) -> Callable[[Scalar], list[Scalar]]:
    """Return the formula p -> (x, y, cosine, sine) of all links one after the other: the pose."""
    coefficients = coordinate.make_coefficients(n)
    return lambda position: [value for curve in coefficients(position)
                             for value in (curve[0], curve[1], curve[6], curve[7])]


class Course:
    """
    All phases of the motions of a system: each coordinate in each mode, made when first needed.

    ``make_equation``: (mechanism in a mode, start, coordinate or None for the input) -> Equation;
    ``mechanism``: in its mode at the input ``start``.
    """

    def __init__(self, make_equation: MakeEquation, mechanism: Mechanism, start: float,
                 system: System) -> None:
        """Make the phase of the start; middle: of the range of a crank between toggles [rad]."""
        self._make_equation, self._mechanism = make_equation, mechanism
        self.system, self._start = system, start
        others = () if mechanism.turns_fully else mechanism.driven_otherwise()
        self._others = {other.mode: other for other in others}
        self.middle = 0.0
        if others and not mechanism.is_driven_by_slide:
            middles = [0.5 * (low + high) for low, high in mechanism.input_ranges]
            middle = min(middles, key=lambda value: abs(remainder(start - value, tau)))
            self.middle = start - remainder(start - middle, tau)
        # (whether the coordinate is the input, mode, parity of the interval) -> phase
        self._phases: dict[tuple[bool, int, int], Phase] = {}
        self._poses: dict[tuple[bool, int], Function] = {}
        self.first = self.of(True, mechanism.mode, start)

    def at(self, state: State) -> tuple[Phase, list[float]]:
        """Return the phase in which a run begins at a state of the input, and its state there."""
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

    def _in_modes(self, is_input: bool) -> Mapping[int, DrivenLinks]:
        """Return {mode: mechanism driven by the input, or by the other coordinate}."""
        mechanism = self._mechanism
        return ({mode: mechanism.in_mode(mode) for mode in mechanism.modes_passed} if is_input
                else self._others)

    def of(self, is_input: bool, mode: int, start: float) -> Phase:
        """
        Return the phase of the input or of the other coordinate, in the mode at ``start``.

        Where flat positions make the mode alternate, every second interval shares a phase.
        """
        coordinate = self._in_modes(is_input)[mode]
        parity = make_interval_of(coordinate)(start) % 2 if flat_positions(coordinate) else 0
        key = is_input, mode, parity
        if key not in self._phases:
            other = self._in_modes(not is_input) if self._others else {}
            if is_input:
                equation = self._make_equation(self._mechanism.in_mode(mode), start, None)
            else:
                equation = self._make_equation(self._mechanism, start, coordinate)
            self._phases[key] = Phase(self, equation, start, next(iter(other.values()), None))
        return self._phases[key]

    def like(self, last: Phase, value: float, position: float) -> Phase:
        """
        Return the phase of the other coordinate that continues another phase.

        ``value`` is the coordinate of that phase, ``position`` the other coordinate in the same
        pose. Its assembly mode is the one with the nearest pose there.
        """
        pose, is_input = last.pose(value), not last.is_input
        distances = {mode: self._distance(pose, is_input, mode, position)
                     for mode in self._in_modes(is_input)}
        return self.of(is_input, min(distances, key=distances.__getitem__), position)

    def input_in(self, mode: int) -> Phase:
        """Return the phase of the input in a mode, of a mechanism without flat positions."""
        return self.of(True, mode, self._start)

    def prepare(self) -> list[Phase]:
        """Return all phases of a mechanism without flat positions, ready for use."""
        phases = [self.of(is_input, mode, self._start) for is_input in (True, False)
                  for mode in self._in_modes(is_input)]
        for phase in phases:
            phase.prepare()
            self._pose_line(phase.is_input, phase.equation.coordinate.mode)
        return phases

    def _pose_line(self, is_input: bool, mode: int) -> Function:
        """Return the function of a float -> pose, of a coordinate in a mode; made once."""
        if (is_input, mode) not in self._poses:
            coordinate = self._in_modes(is_input)[mode]
            self._poses[is_input, mode] = straight_line(partial(make_pose, coordinate))
        return self._poses[is_input, mode]

    def _distance(self, pose: Sequence[float], is_input: bool, mode: int,
                  position: float) -> float:
        """Return the squared distance of a pose from that of a mode; inf if it cannot close."""
        try:
            own = self._pose_line(is_input, mode)(position)
        except (ValueError, ZeroDivisionError):
            return inf
        return float(sum((a - b)**2 for a, b in zip(pose, own)))
