# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
First-order equations of input, shaft and source, and the linear systems of an implicit step.

The state is x = (q, w, s, v, z): input and its rate, twist of the elastic shaft and speed of the
motor behind the gear (both zero of a rigid shaft), state of the torque source. With the terms of
the equation of motion (E1), stiffness k and damping c of the shaft, and (M1) for the source,

    dq/dt = w                       dw/dt = (Q - D w - J'/2 w^2 + T_in) / J
    ds/dt = v - w                   dv/dt = (T - T_in) / J_m                               (N1)
    T_in = k s + c (v - w), of a rigid shaft T;   dz/dt of the source

The twist is a state of its own, not a difference of angles that grow: a stiff shaft would multiply
their rounding. In (g - d(dx/dt)/dx) u = r all but one or two unknowns are eliminated by hand.
"""
from __future__ import annotations

from collections.abc import Callable

from fourbar_ros.dynamics.drives import Shaft
from fourbar_ros.dynamics.pieces import Piece

State = tuple[float, float, float, float, float]
Terms = tuple[float, float, float, float, float]          # J, J'/2, Q, D, of couples
Solver = Callable[[float], Callable[[State], State]]      # g -> (r -> u)


def plus(x: State, weight: float, u: State) -> State:
    """Return x + weight u."""
    x0, x1, x2, x3, x4 = x
    u0, u1, u2, u3, u4 = u
    return (x0 + weight * u0, x1 + weight * u1, x2 + weight * u2, x3 + weight * u3,
            x4 + weight * u4)


class Rigid:
    """Without a shaft: T_in is T."""

    @staticmethod
    def on_input(state: State, piece: Piece) -> float:
        """Return the torque on the input."""
        return piece.torque_at(state[1], state[4])

    @staticmethod
    def derivative(terms: Terms, state: State, piece: Piece) -> State:
        """Return dx/dt."""
        _, w, _, _, z = state
        inertia, half_slope, force, damping, _ = terms
        torque, by_speed, by_own, own, own_by_speed, own_by_own = piece
        return (w, (force + torque + by_own * z + (by_speed - damping - half_slope * w) * w)
                / inertia, 0.0, 0.0, own + own_by_speed * w + own_by_own * z)

    @staticmethod
    def linear(terms: Terms, state: State, piece: Piece, by_position: float) -> Solver:
        """Return the function g -> (r -> u); ``by_position``: of the acceleration."""
        inertia, half_slope, _, damping, _ = terms
        _, by_speed, by_own, _, own_by_speed, own_by_own = piece
        by_rate = (by_speed - damping - 2.0 * half_slope * state[1]) / inertia
        by_own /= inertia

        def solver(g: float) -> Callable[[State], State]:
            own = 1.0 / (g - own_by_own)
            whole = 1.0 / (g - by_rate - by_position / g - by_own * own_by_speed * own)

            def solve(right: State) -> State:
                q, w, _, _, z = right
                rate = (w + by_position * q / g + by_own * z * own) * whole
                return (q + rate) / g, rate, 0.0, 0.0, (z + own_by_speed * rate) * own
            return solve
        return solver


class Elastic:
    """With an elastic shaft."""

    def __init__(self, shaft: Shaft, rotor: float) -> None:
        self._given = shaft.stiffness, shaft.damping, rotor

    def on_input(self, state: State, piece: Piece) -> float:
        """Return the torque on the input."""
        k, c, _ = self._given
        return k * state[2] + c * (state[3] - state[1])

    def derivative(self, terms: Terms, state: State, piece: Piece) -> State:
        """Return dx/dt."""
        _, w, s, v, z = state
        k, c, rotor = self._given
        inertia, half_slope, force, damping, _ = terms
        torque, by_speed, by_own, own, own_by_speed, own_by_own = piece
        on_input = k * s + c * (v - w)
        return (w, (force + on_input - (damping + half_slope * w) * w) / inertia, v - w,
                (torque + by_speed * v + by_own * z - on_input) / rotor,
                own + own_by_speed * v + own_by_own * z)

    def linear(self, terms: Terms, state: State, piece: Piece, by_position: float) -> Solver:
        """Return the function g -> (r -> u); ``by_position``: of the acceleration."""
        k, c, rotor = self._given
        inertia, half_slope, _, damping, _ = terms
        _, by_speed, by_own, _, own_by_speed, own_by_own = piece
        rate_by_rate = -(damping + c + 2.0 * half_slope * state[1]) / inertia
        motor_by_speed, motor_by_own = (by_speed - c) / rotor, by_own / rotor

        def solver(g: float) -> Callable[[State], State]:
            own, coupling = 1.0 / (g - own_by_own), c + k / g
            m11 = g - rate_by_rate - by_position / g + k / (g * inertia)
            m12, m21 = -coupling / inertia, -coupling / rotor
            m22 = (g - motor_by_speed + k / (g * rotor)
                   - motor_by_own * own_by_speed * own)
            whole = 1.0 / (m11 * m22 - m12 * m21)

            def solve(right: State) -> State:
                q, w, s, v, z = right
                pull = k * s / g
                r1 = w + by_position * q / g + pull / inertia
                r2 = v - pull / rotor + motor_by_own * z * own
                rate, speed = (m22 * r1 - m12 * r2) * whole, (m11 * r2 - m21 * r1) * whole
                return ((q + rate) / g, rate, (s + speed - rate) / g, speed,
                        (z + own_by_speed * speed) * own)
            return solve
        return solver
