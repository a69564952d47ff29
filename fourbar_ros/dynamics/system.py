# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
A mechanism and its drive as one system of first-order equations.

State, in order: q, w = dq/dt of the input; p, dp/dt of the motor if there is an elastic shaft; the
state of the torque source (current, integral of a controller); last the work W of all that is not
conservative, so that energy less W is constant whatever acts (not if nothing of the kind acts):

    dW/dt = (T + C - D w) w,   C the part of Q of applied couples                          (E6)
"""
from __future__ import annotations

from collections.abc import Callable, Sequence
from math import inf
from typing import Any

from fourbar_ros.dynamics.drives import ConstantTorque, Drive
from fourbar_ros.dynamics.elements import Element
from fourbar_ros.dynamics.equation import Equation
from fourbar_ros.dynamics.phase import AT_LIMIT, Course, Phase
from fourbar_ros.dynamics.smooth import flat_positions
from fourbar_ros.errors import FourBarError
from fourbar_ros.numerics.given import number
import numpy as np

State = Sequence[float]
NEAR_TOGGLE = 1e-3        # sine of the angle of the dyad at which an input counts as at its limit


class System:
    """
    A mechanism, its springs and its drive.

    Parameters
    ----------
    mechanism : Mechanism
        With bodies; its assembly mode is that at the start.
    position, rate : float
        The input at the start and its rate: angle [rad] or slide [m], [rad/s] or [m/s].
    elements : sequence of Spring or TorsionSpring
    drive : Drive, optional
        Without one the mechanism moves freely. Its motor starts at the position and rate of the
        input.
    stops_at_change_points : bool
        Whether a run ends where the mechanism lies flat in an exact change point, instead of going
        on smoothly.

    """

    def __init__(self, mechanism: Any, position: float, rate: float = 0.0,
                 elements: Sequence[Element] = (), drive: Drive | None = None,
                 stops_at_change_points: bool = False) -> None:
        self.stops_at_change_points = stops_at_change_points
        self.drive, self._stroke = drive, mechanism.stroke
        # an integrator's trial steps go beyond the end at which the run stops
        mechanism = mechanism.without_stroke()
        self.mechanism = mechanism
        motion = (number('position', position), number('rate', rate))
        elements = tuple(elements)

        def make_equation(mechanism: Any, start: float, coordinate: Any) -> Equation:
            return Equation(mechanism, elements, drive.rigid_inertia if drive else 0.0, start,
                            coordinate)
        self.equation = make_equation(mechanism, motion[0], None)
        self.is_conservative = not (drive or self.equation.has_couples
                                    or any(e.damping for e in elements))
        shaft, source = (drive.shaft, drive.source.start) if drive else (None, ())
        self.names = ('position', 'rate', *(('motor_position', 'motor_rate') if shaft else ()),
                      *(f'source_{i}' for i in range(len(source))),
                      *(() if self.is_conservative else ('work',)))
        self.start = (*motion * (2 if shaft else 1), *source,
                      *(() if self.is_conservative else (0.0,)))
        self.course = Course(make_equation, mechanism, motion[0], self._make_derivative)
        self.derivative = self.course.first.derivative

    @property
    def has_no_limits(self) -> bool:
        """Return whether the input can go on for ever: a crank that turns fully."""
        return bool(self.mechanism.turns_fully)

    @property
    def depends_on_input_alone(self) -> bool:
        """Return whether all forces do: no damping, and no drive but a constant torque."""
        drive = self.drive
        return (not any(element.damping for element in self.equation.elements)
                and (drive is None or drive.shaft is None
                     and isinstance(drive.source, ConstantTorque)))

    def distance_to_limit(self, time: float, state: State) -> float:
        """Return a number that is zero at the ends of the stroke, and just before a toggle."""
        position = float(state[0])
        try:
            motion = self.mechanism.motion(position)
        except FourBarError:
            return -NEAR_TOGGLE
        from_toggle = float(abs(self.mechanism.transmission_sine(motion))) - NEAR_TOGGLE
        return min(from_toggle, self.distance_to_end(position))

    def distance_to_end(self, position: float) -> float:
        """Return a number that is zero at the ends of the stroke."""
        if self._stroke is None:
            return inf
        low, high = map(float, self._stroke)
        return min((position - low) / (high - low), (high - position) / (high - low))

    def events(self, phase: Phase) -> tuple[Callable[..., float], ...]:
        """Return functions (time, state in a phase) whose zeros end a run."""
        passes = phase.can_end or self.has_no_limits

        def limit(time: float, state: Any) -> float:
            state = phase.states_of_input(np.asarray(state))
            return (self.distance_to_end(float(state[0])) if passes
                    else self.distance_to_limit(time, state))

        limit.terminal, limit.end = True, AT_LIMIT      # type: ignore[attr-defined]
        ends = not passes or self._stroke is not None
        stops = self.stops_at_change_points and flat_positions(phase.equation.coordinate)
        return (*((limit,) if ends else ()), *((phase.to_flat,) if stops else ()))

    def torque(self, time: float, state: State) -> float:
        """Return the torque (force) of the drive on the input."""
        return self._drive(time, state)[0] if self.drive else 0.0

    def motor_torque(self, time: float, state: State) -> float:
        """Return the torque (force) of the source, which an elastic shaft passes on."""
        if self.drive is None:
            return 0.0
        speed = 3 if self.drive.shaft else 1
        return self.drive.source.torque(time, state[speed], state[speed + 1:-1])[0]

    def _drive(self, time: float, state: State) -> tuple[float, tuple[float, ...]]:
        """Return the torque on the input and the derivatives of the drive's own states."""
        drive = self.drive
        assert drive is not None
        if drive.shaft is None:
            return drive.source.torque(time, state[1], state[2:-1])
        position, rate, motor, speed = state[:4]
        torque, change = drive.source.torque(time, speed, state[4:-1])
        on_input = (drive.shaft.stiffness * (motor - position)
                    + drive.shaft.damping * (speed - rate))
        return on_input, (speed, (torque - on_input) / drive.rotor, *change)

    def _make_derivative(self, phase: Phase) -> Any:
        """Return the function (time, state) -> d state / dt in the coordinate of a phase."""
        terms_of, drive = phase.equation.of_one, self._drive if self.drive else None

        def conservative(time: float, state: State) -> tuple[float, ...]:
            position, rate = state
            inertia, half_slope, force, _, _ = terms_of(position)
            return rate, (force - half_slope * rate * rate) / inertia

        def driven(time: float, state: State) -> tuple[float, ...]:
            rate = state[1]
            torque, change = drive(time, state) if drive else (0.0, ())
            inertia, half_slope, force, damping, couples = terms_of(state[0])
            torque -= damping * rate
            return (rate, (force + torque - half_slope * rate * rate) / inertia, *change,
                    (torque + couples) * rate)

        def driven_elsewhere(time: float, state: State) -> tuple[float, ...]:
            position, rate, *rest = state
            value, ratio, _ = phase.input_of(position)
            torque, change = drive(time, (value, ratio * rate, *rest)) if drive else (0.0, ())
            inertia, half_slope, force, damping, couples = terms_of(position)
            torque = torque * ratio - damping * rate                                        # (T2)
            return (rate, (force + torque - half_slope * rate * rate) / inertia, *change,
                    (torque + couples) * rate)

        if self.is_conservative:
            return conservative
        return driven if phase.is_input else driven_elsewhere
