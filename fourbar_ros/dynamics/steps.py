# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Steps of given length through the toggle positions of the input.

A step is made in the input q, near a toggle in the other coordinate p of the phases of
:mod:`fourbar_ros.dynamics.phase`. Where it begins, p takes over if |dp/dq| > 2 there; within it,
where the coordinate in use changes too slowly; q takes over again at the end of the first step
with |dp/dq| <= 2. So q, its rate and the assembly mode tell the state of all samples but those
next to a toggle, where they hardly change with it: there (p, dp/dt) is the state.
"""
from __future__ import annotations

from math import isfinite, pi
from typing import Any, NamedTuple

from fourbar_ros.dynamics.phase import Phase
from fourbar_ros.dynamics.step_equations import State
from fourbar_ros.dynamics.stepper import BUDGET, DONE, FAILED, LIMIT, OneStep, Torques
from fourbar_ros.dynamics.system import System
from fourbar_ros.errors import FourBarError

KEY = 'integrator'         # in a bag: what made its motion
# a bag is stepped again by the same version only; they differ where the input has toggles
NAME, NAME_WITH_TOGGLES = 'steps of the node, version 1', 'steps of the node, version 2'
TURN = 2.0 * pi
LARGEST_MODE = 255         # in a message


class Place(NamedTuple):
    """Where a system is."""

    phase: Phase
    state: State           # in its coordinate
    mode: int              # assembly mode of the mechanism
    rising: int            # mode in which the input grows with the coordinate
    turns: float           # of the input beyond the range of the course [rad]


class Stepped(NamedTuple):
    """The place after a step, how it went, evaluations of the equation of motion."""

    place: Place
    status: str
    evaluations: int


def modes_of(mechanism: Any) -> tuple[int, ...]:
    """
    Return the two assembly modes between which steps through toggles go.

    None where the input has no toggles, where no other coordinate is known to go through them, at
    an exact change point, and where a message cannot tell the modes.
    """
    mechanism = mechanism.without_stroke()
    if mechanism.turns_fully or mechanism.change_point_margin == 0.0:
        return ()
    modes: tuple[int, ...] = mechanism.modes_passed
    passes = (len(modes) == 2 and max(modes) <= LARGEST_MODE
              and bool(mechanism.driven_otherwise()))
    return modes if passes else ()


def in_message(mode: int) -> int:
    """Return the number of a mode in messages."""
    return int(mode) if mode <= LARGEST_MODE else 0


def name_of(mechanism: Any) -> str:
    """Return the name of the integrator of a mechanism, for bags."""
    return NAME_WITH_TOGGLES if modes_of(mechanism) else NAME


class Steps:
    """
    Advances a system, in one coordinate after the other.

    Parameters
    ----------
    system : System
    tolerance, budget : float, int
        Those of a :class:`~fourbar_ros.dynamics.stepper.OneStep`.

    Attributes
    ----------
    passes : bool
        Whether it goes through toggles.

    """

    def __init__(self, system: System, tolerance: float, budget: int) -> None:
        self._system, self._given = system, (system, tolerance, budget)
        self._modes = modes_of(system.mechanism)
        self.passes = bool(self._modes)
        self._ones: dict[Phase, OneStep] = {}
        self._spent = 0

    @property
    def start(self) -> Place:
        """Return the place at the start."""
        return self.place(self._one(self._system.course.first).start)

    def prepare(self) -> None:
        """Make all that steps need, which takes as long as thousands of them."""
        phases = self._system.course.prepare() if self.passes else [self._system.course.first]
        for phase in phases:
            self._one(phase)

    def place(self, state: State, mode: int | None = None) -> Place:
        """Return the place that a state of the input and a mode tell."""
        own, course = int(self._system.mechanism.mode), self._system.course
        if mode is None or mode == own or mode not in self._modes:
            return Place(course.first, state, own, own, 0.0)
        return Place(course.input_in(mode), state, mode, mode, 0.0)

    def tells_all(self, place: Place) -> bool:
        """Return whether input, rate and mode tell a place."""
        if not self.passes:
            return True
        try:
            return place.phase.is_input and place.phase.excess(0.0, place.state) <= 0.0
        except FourBarError:
            return False

    def state_of_input(self, place: Place) -> State:
        """Return the state in the input."""
        if place.phase.is_input:
            return place.state
        p, rate, twist, speed, own = place.state
        value, ratio, _ = place.phase.input_of(p)
        return value + place.turns, ratio * rate, twist, speed, own

    def torques(self, place: Place, command: float | None = None) -> Torques:
        """Return acceleration and torques at a place; ``command``: torque of the source."""
        return self._one(place.phase).torques(place.state, command)

    def advance(self, place: Place, length: float, command: float | None = None) -> Stepped:
        """Return what :meth:`OneStep.advance` does, from a place."""
        if not self.passes:
            phase, before, mode, rising, turns = place
            state, status, spent = self._one(phase).advance(before, length, command)
            return Stepped(Place(phase, state, mode, rising, turns), status, spent)
        held, self._spent = place._replace(state=OneStep.held(place.state)), 0
        try:
            new, is_good = self._passed(place, length, command)
        except FourBarError:
            return Stepped(held, LIMIT, self._spent)
        except ArithmeticError:
            return Stepped(held, FAILED, self._spent)
        if not all(map(isfinite, new.state)):
            return Stepped(held, FAILED, self._spent)
        if self._system.distance_to_end(self.state_of_input(new)[0]) <= 0.0:
            return Stepped(held, LIMIT, self._spent)
        return Stepped(new, DONE if is_good else BUDGET, self._spent)

    def _one(self, phase: Phase) -> OneStep:
        one = self._ones.get(phase)
        if one is None:
            one = self._ones[phase] = OneStep(*self._given, phase if self.passes else None)
        return one

    def _passed(self, place: Place, left: float, command: float | None) -> tuple[Place, bool]:
        """Return the place after a time, and whether it is as good as wanted."""
        if not self.tells_all(place) and place.phase.is_input:
            place = self._next(place)
        piece_at = self._one(place.phase).pieces(place.state, command)
        is_good = True
        while True:
            part, self._spent = self._one(place.phase).part(place.state, left, piece_at,
                                                            self._spent)
            place, left = place._replace(state=part.state), part.left
            if not left:
                return self._settled(place), is_good and part.is_good
            if not (is_good or part.is_good):
                raise FourBarError('no coordinate finishes this step')
            is_good = is_good and part.is_good
            place = self._next(place)

    def _next(self, place: Place) -> Place:
        """Return a place in the coordinate that takes over."""
        if not place.phase.is_input:
            return self._in_input(place)
        course, q = self._system.course, place.state[0]
        turns = TURN * round((q - course.continuous(q)) / TURN)
        phase, state = place.phase.next(place.state)
        grows = phase.input_of(state[0])[1] > 0.0
        rising = place.mode if grows else self._partner(place.mode)
        p, rate, twist, speed, own = state
        return Place(phase, (p, rate, twist, speed, own), place.mode, rising, turns)

    def _in_input(self, place: Place) -> Place:
        """Return a place in another coordinate as one in the input."""
        grows = place.phase.input_of(place.state[0])[1] > 0.0
        mode = place.rising if grows else self._partner(place.rising)
        return self.place(self.state_of_input(place), mode)

    def _settled(self, place: Place) -> Place:
        """Return a place at the end of a step: in the input, if that tells all."""
        if place.phase.is_input:
            return place
        in_input = self._in_input(place)
        return in_input if self.tells_all(in_input) else place._replace(mode=in_input.mode)

    def _partner(self, mode: int) -> int:
        return self._modes[self._modes[0] == mode]
