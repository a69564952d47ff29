# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
A mechanism and its drive as one system of first-order equations, which :mod:`.simulation` solves.

State, in order: q, w = dq/dt of the input; p, dp/dt of the motor if there is an elastic shaft; the
state of the torque source (current, integral of a controller); what friction dissipates, if there
is any; last the work W of all that is not conservative, so that energy less W is constant whatever
acts (not if nothing of the kind acts):

    dW/dt = (T + C - D w - R) w,   C the part of Q without a potential: of applied couples, of
                                   forces over a position; R of (E9)                       (E6)
"""
from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from functools import partial
from math import inf

from fourbar_ros.dynamics.coordinate import Coordinates, MotionCoordinate
from fourbar_ros.dynamics.equation import compiled, Equation
from fourbar_ros.dynamics.sources import Answer, Drive, has_law, Law
from fourbar_ros.errors import InvalidParameter, Locked
from fourbar_ros.mechanisms.mechanism import DrivenLinks, Mechanism
from fourbar_ros.notebook import short_repr
from fourbar_ros.numerics.arguments import finite
from fourbar_ros.numerics.number_types import Function, NumberType, Scalar

State = Sequence[float]
SLIP_SPEED = 1e-4         # [rad/s], [m/s] of the input, within which friction is smooth
NEAR_TOGGLE = 1e-6        # part of half its range at whose distance an input is at its limit


class System:
    """
    A mechanism with all that acts on it, and a drive.

    The mechanism has bodies; its assembly mode is that at the start. There its input is at
    ``position`` with ``rate``: [rad] or [m], [rad/s] or [m/s], and so is the motor of the drive.
    Without a drive it moves freely. ``slip_speed`` of the input [rad/s], [m/s], of a mechanism
    that has none: where friction would hold it, it creeps at less.
    """

    def __init__(self, mechanism: Mechanism, position: float, rate: float = 0.0,
                 drive: Drive | None = None, slip_speed: float = SLIP_SPEED) -> None:
        if not isinstance(drive, (Drive, type(None))):
            raise InvalidParameter('drive', drive,
                                   'must be a Drive, as Drive(ConstantTorque(5.0))')
        if not isinstance(mechanism, Mechanism):
            raise InvalidParameter('mechanism', mechanism, 'must be one, as FourBar, or the '
                                                           'linkage of a scene')
        mechanism = mechanism.with_slip_speed(
            finite('slip_speed', slip_speed, 'must be a positive number', above=0.0))
        self.drive, self._with_stroke = drive, mechanism
        # an integrator's trial steps go beyond the end at which the run stops
        mechanism = mechanism.without_stroke()
        self.mechanism = mechanism
        motion = (mechanism.checked_input('position', position), finite('rate', rate))
        self.stroke = self._with_stroke.stroke_around(motion[0])    # in the turn of the start
        self.coordinates = Coordinates(self, mechanism, motion[0])
        self.equation = self.coordinates.first.equation
        has_resistance = self.equation.has_resistance
        self.is_conservative = not (drive or self.equation.has_couples
                                    or self.equation.has_dampers or has_resistance)
        shaft, source = (drive.shaft, drive.source.start) if drive else (None, ())
        self.names = ('position', 'rate', *(('motor_position', 'motor_rate') if shaft else ()),
                      *(f'source_{i}' for i in range(len(source))),
                      *(('dissipated',) if has_resistance else ()),
                      *(() if self.is_conservative else ('work',)))
        self.start = (*motion * (2 if shaft else 1), *source, *((0.0,) if has_resistance else ()),
                      *(() if self.is_conservative else (0.0,)))
        # index of the source's speed in a state: of the input's rate, or of dp/dt behind a shaft
        self._speed = 3 if shaft else 1
        self.of_source = slice(self._speed + 1, self._speed + 1 + len(source))

    def __repr__(self) -> str:
        position, rate = self.start[:2]
        return short_repr('System', {'mechanism': self.mechanism.description, 'drive': self.drive,
                                     'position': position, 'rate': rate})

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle the arguments only: functions cannot be pickled, and are made again."""
        return System, (self._with_stroke, *self.start[:2], self.drive)

    @property
    def derivative(self) -> Function:
        """Return (time, state) -> d state / dt; ZeroDivisionError where there is no inertia."""
        return self.coordinates.first.derivative

    @property
    def has_stroke(self) -> bool:
        """Return whether the input has a stroke that ends a run."""
        return self._with_stroke.stroke is not None

    @property
    def has_limits(self) -> bool:
        """Return whether the input has an end: of its stroke, or a toggle."""
        return self.has_stroke or not self.mechanism.turns_fully

    def distance_to_limit(self, position: float) -> float:
        """Return how far an input is inside its limits, zero where a run stops, as a share."""
        # of half the range to NEAR_TOGGLE before a toggle, where the equation is singular; of the
        # stroke to its ends
        coordinates = self.coordinates
        from_toggle = 1.0 - NEAR_TOGGLE - abs(position - coordinates.middle) / coordinates.half
        return min(from_toggle, self.distance_to_end(position))

    def distance_to_end(self, position: float) -> float:
        """Return how far an input is from the nearer end of the stroke, as a part of it."""
        if not self.has_stroke:
            return inf
        low, high = self.stroke
        return min((position - low) / (high - low), (high - position) / (high - low))

    def torque(self, time: float, state: State) -> float:
        """Return the torque (force) of the drive on the input."""
        return self._drive(time, state)[0] if self.drive else 0.0

    def motor_torque(self, time: float, state: State) -> float:
        """Return the torque (force) of the source, which an elastic shaft passes on."""
        if self.drive is None:
            return 0.0
        speed, source_state = state[self._speed], state[self.of_source]
        return float(self.drive.source.torque(time, speed, source_state)[0])

    def _drive(self, time: float, state: State) -> Answer:
        """Return the torque on the input and the derivatives of the states after q and w, (A1)."""
        drive = self.drive
        assert drive is not None
        speed, source_state = state[self._speed], state[self.of_source]
        torque, change = drive.source.torque(time, speed, source_state)
        if drive.shaft is None:
            return torque, change
        position, rate, motor = state[:3]
        on_input = (drive.shaft.stiffness * (motor - position)
                    + drive.shaft.damping * (speed - rate))
        return on_input, (speed, (torque - on_input) / drive.rotor, *change)

    def make_derivative(self, coordinate: MotionCoordinate) -> Function:
        """Return (time, state in a coordinate) -> d state / dt, by (E1); of the work by (E6)."""
        equation, drive = coordinate.equation, self.drive
        if self.equation.has_resistance:
            resisting = self.make_resisting(coordinate)
            return lambda time, state: resisting(time, state)[0]
        if drive is None or drive.shaft is None and has_law(drive.source):
            with suppress(TypeError):       # of a user's law of floats alone: no formula
                change_of = compiled(partial(self._make_change, equation), equation.coordinate,
                                     len(self.names))
                return lambda time, state: change_of(*state)
        terms_of, is_input = equation.fields_of_terms, coordinate.is_input

        def driven(time: float, state: State) -> tuple[float, ...]:
            position, rate, ratio = state[0], state[1], 1.0
            if not is_input:
                value, ratio, _ = coordinate.input_of(position)
                state = (value, ratio * rate, *state[2:])
            torque, change = self._drive(time, state)
            inertia, half_slope, force, damping, couples, *_ = terms_of(position)
            torque = torque * ratio - damping * rate                                        # (Q2)
            return (rate, (force + torque - half_slope * rate * rate) / inertia, *change,
                    (torque + couples) * rate)                                              # (E6)
        return driven

    def _make_change(self, equation: Equation, links: DrivenLinks, n: NumberType) -> Function:
        """Return the formula of a state -> its derivative, driven by a law or not at all."""
        terms_of, law = equation.make_terms(links, n), self.drive and self.drive.source

        def change(position: Scalar, rate: Scalar, *others: Scalar) -> tuple[Scalar, ...]:
            terms, torque, of_source = terms_of(position), 0.0, others[:-1]
            changes = list[Scalar]()
            if isinstance(law, Law):
                speed, state = terms.ratio * rate, of_source[0] if of_source else 0.0
                piece = law.piece(speed, state, n)
                torque = piece.torque_at(speed, state) * terms.ratio                        # (Q2)
                changes += [piece.change_at(speed, state)] * len(of_source)
            torque = torque - terms.damping * rate
            power = [] if self.is_conservative else [(torque + terms.couples) * rate]       # (E6)
            return (rate, (terms.force + torque - terms.half_slope * rate * rate) / terms.inertia,
                    *changes, *power)
        return change

    def make_resisting(self, coordinate: MotionCoordinate) -> Callable[
            [float, State], tuple[tuple[float, ...], Sequence[float]]]:
        """Return (time, state) -> d state / dt with friction, edges of it; it raises Locked."""
        # edges: numbers, of Resistance; where one of them is zero it is not smooth
        from fourbar_ros.mechanisms.friction import dry_joints  # few mechanisms have any
        terms_of, resistance = coordinate.equation.fields_of_terms, coordinate.equation.resistance

        def resisting(time: float, state: State) -> tuple[tuple[float, ...], Sequence[float]]:
            position, rate = state[:2]
            torque, change = self._drive(time, state) if self.drive else (0.0, ())
            inertia, half_slope, force, damping, couples, *_ = terms_of(position)
            torque = torque - damping * rate
            push = force + torque - half_slope * rate * rate
            resisted = resistance(position, rate, push, inertia)
            if resisted.friction != resisted.friction:
                driven = self.mechanism.input_coordinate
                raise Locked(driven.position, position, driven.unit, dry_joints(self.mechanism))
            effort, friction = resisted.effort, resisted.friction
            return (rate, (push - effort) / inertia, *change, friction * rate,              # (E9)
                    (torque + couples - effort) * rate), resisted.edges                     # (E6)
        return resisting
