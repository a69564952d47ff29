# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
An induction motor at a constant supply frequency, by Kloss' formula.

A motor with p pole pairs has the synchronous speed w_s = 2 pi f / p; s is the slip. Its breakdown
torque T_b occurs at the slip s_b. At the output shaft of a gear of ratio N it gives

    T = N 2 T_b / (s / s_b + s_b / s),    s = 1 - N w / w_s                                (K1)

    dT/dw = -(N / w_s) N 2 T_b s_b (s_b^2 - s^2) / (s^2 + s_b^2)^2                         (K2)

It neglects the resistance of the stator and electrical transients. Beyond w_s it brakes as a
generator. Source: Kloss, Drehmoment und Schluepfung des Drehstrommotors, Archiv fuer
Elektrotechnik 5 (1916).
"""
from __future__ import annotations

from dataclasses import dataclass
from math import tau
from typing import ClassVar

from fourbar_ros.dynamics.model.drives import Law, MakePiece, Piece
from fourbar_ros.numerics.given import quantity
from fourbar_ros.numerics.number_types import NumberType, REAL, Scalar


@dataclass(frozen=True)
class InductionMotor(Law):
    """
    Induction motor with a gear, by Kloss' formula (K1); fields state units and meanings.

    A negative gear: the shaft behind it turns the other way.
    """

    is_smooth: ClassVar[bool] = True
    breakdown_torque: float = quantity(unit='N m or N', above=0.0,
                                       text='largest torque of the motor')
    breakdown_slip: float = quantity(above=0.0, text='slip at which it gives that torque')
    frequency: float = quantity(50.0, unit='Hz', above=0.0, text='frequency of the supply')
    pole_pairs: int = quantity(2, least=1, is_whole=True, text='pairs of poles')
    gear: float = quantity(1.0, is_not_zero=True)

    @property
    def synchronous_speed(self) -> float:
        """Return the speed behind the gear at which it gives no torque [rad/s]."""
        return tau * self.frequency / self.pole_pairs / self.gear

    def make_piece(self, n: NumberType = REAL, command: Scalar | None = None) -> MakePiece:
        """Return the law (K1) by its tangent at each speed: it is smooth, not linear."""
        synchronous, s_b = self.synchronous_speed, self.breakdown_slip
        factor = 2.0 * self.gear * self.breakdown_torque * s_b

        def tangent(speed: Scalar, own: Scalar) -> Piece:
            """Return the line T + dT/dw (w - speed), as T_0 + T_w w of (M1)."""
            slip = 1.0 - speed / synchronous
            whole = slip * slip + s_b * s_b
            torque = factor * slip / whole                                                  # (K1)
            by_speed = factor * (slip * slip - s_b * s_b) / (synchronous * whole * whole)   # (K2)
            return Piece(torque - by_speed * speed, by_speed)
        return tangent
