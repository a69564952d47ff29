# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Torque sources as what they are between their kinks: linear in speed and own state z.

    T = T_0 + T_w w + T_z z,    dz/dt = d_0 + d_w w + d_z z                                (M1)

Constant torque, motor line and DC motor are so everywhere, a controller on either side of its
limit and between the limits.
"""
from __future__ import annotations

from collections.abc import Callable
from functools import singledispatch
from typing import Any, NamedTuple

from fourbar_ros.dynamics.drives import ConstantTorque, DCMotor, MotorLine, SpeedController
from fourbar_ros.errors import InvalidParameter


class Piece(NamedTuple):
    """Coefficients of (M1), w the speed behind the gear."""

    torque: float
    by_speed: float = 0.0
    by_state: float = 0.0
    change: float = 0.0
    change_by_speed: float = 0.0
    change_by_state: float = 0.0

    def torque_at(self, speed: float, state: float) -> float:
        """Return T."""
        return self.torque + self.by_speed * speed + self.by_state * state


PieceAt = Callable[[float, float], Piece]


Begin = Callable[[float, float], PieceAt]


@singledispatch
def make_begin(source: Any) -> Begin:
    """
    Return the function (speed, state) -> PieceAt that holds for one step from there on.

    A controller decides there, once a step, whether it integrates.
    """
    raise InvalidParameter('source', source, 'is not one for steps: its torque depends on time')


def always(piece: Piece) -> Begin:
    """Return what a source gives that is the same everywhere."""
    def piece_at(speed: float, state: float) -> Piece:
        return piece
    return lambda speed, state: piece_at


@make_begin.register
def _(source: ConstantTorque) -> Begin:
    return always(Piece(source.value))


@make_begin.register
def _(source: MotorLine) -> Begin:
    return always(Piece(source.stall_torque, -source.stall_torque / source.free_speed))


@make_begin.register
def _(source: DCMotor) -> Begin:
    constant = source.gear * source.constant
    if source.inductance:
        return always(Piece(0.0, 0.0, constant, source.voltage / source.inductance,
                            -constant / source.inductance,
                            -source.resistance / source.inductance))
    return always(Piece(constant * source.voltage / source.resistance,
                        -constant * constant / source.resistance))


@make_begin.register
def _(source: SpeedController) -> Begin:
    wanted_speed, limit = source.speed, source.limit
    plain = Piece(source.proportional * wanted_speed, -source.proportional, source.integral)

    def begin(speed: float, state: float) -> PieceAt:
        wanted, error = plain.torque_at(speed, state), wanted_speed - speed
        winds_up = abs(wanted) > limit and (wanted > 0.0) is (error > 0.0)
        integral = {} if winds_up or not source.integral else {'change': wanted_speed,
                                                               'change_by_speed': -1.0}
        inner = plain._replace(**integral)
        above, below = Piece(limit, **integral), Piece(-limit, **integral)

        def piece_at(speed: float, state: float) -> Piece:
            wanted = inner.torque_at(speed, state)
            return above if wanted > limit else below if wanted < -limit else inner
        return piece_at
    return begin
