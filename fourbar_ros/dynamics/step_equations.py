# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
First-order equations of input, shaft and source, and the linear systems of an implicit step.

The state is x = (p, u, s, v, z): coordinate and its rate, twist of the elastic shaft, speed of the
motor behind the gear, state of the torque source. Twist and motor speed are zero for a rigid
shaft. The terms are those of (E1) in p and (M1) for the source; the shaft has the stiffness k and
the damping c. With r = dq/dp, q the input, and r' = dr/dp (1 and 0 if p is the input),

    dp/dt = u                       du/dt = (Q - D u - J'/2 u^2 + r T_in) / J
    ds/dt = v - r u                 dv/dt = (T - T_in) / J_m                               (N1)
    T_in = k s + c (v - r u), of a rigid shaft T at the speed r u;   dz/dt of the source

The twist is a state of its own, not a difference of angles that grow: a stiff shaft would multiply
their rounding. In (g - d(dx/dt)/dx) y = b all but one or two unknowns are eliminated by hand.
"""
from __future__ import annotations

from collections.abc import Callable

from fourbar_ros.dynamics.sources import Piece, Shaft

State = tuple[float, float, float, float, float]
Terms = tuple[float, float, float, float, float, float, float]  # J, J'/2, Q, D, of couples, r, r'
Solver = Callable[[float], Callable[[State], State]]      # g -> (b -> y)


def plus(x: State, weight: float, u: State) -> State:
    """Return x + weight u for states, which are tuples of five numbers."""
    x0, x1, x2, x3, x4 = x
    u0, u1, u2, u3, u4 = u
    return (x0 + weight * u0, x1 + weight * u1, x2 + weight * u2, x3 + weight * u3,
            x4 + weight * u4)


class Rigid:
    """Without a shaft: T_in is T."""

    @staticmethod
    def on_input(terms: Terms, state: State, piece: Piece) -> float:
        """Return the torque on the input."""
        *_, ratio, _ = terms
        return piece.torque_at(ratio * state[1], state[4])

    @staticmethod
    def derivative(terms: Terms, state: State, piece: Piece) -> State:
        """Return dx/dt by (N1), for the terms of (E1) at p and a piece of the source's law."""
        _, u, _, _, z = state
        inertia, half_slope, force, damping, _, r, _ = terms
        torque, by_speed, by_own, own, own_by_speed, own_by_own = piece
        return (u, (force + r * torque + r * by_own * z
                    + (r * r * by_speed - damping - half_slope * u) * u) / inertia,
                0.0, 0.0, own + r * own_by_speed * u + own_by_own * z)

    @staticmethod
    def linear(terms: Terms, state: State, piece: Piece, by_position: float) -> Solver:
        """
        Return g -> (b -> y), the solution of (g - d(dx/dt)/dx) y = b by hand.

        ``by_position``: derivative of du/dt by p, the one entry that is not known in closed form.
        """
        inertia, half_slope, _, damping, _, r, r_slope = terms
        _, by_speed, by_own, _, own_by_speed, own_by_own = piece
        by_rate = (r * r * by_speed - damping - 2.0 * half_slope * state[1]) / inertia
        by_own = r * by_own / inertia
        own_by_rate, own_by_position = r * own_by_speed, r_slope * state[1] * own_by_speed

        def solver(g: float) -> Callable[[State], State]:
            """Prepare the elimination for g = 1 / (gamma h): p and z by u, one equation for u."""
            own = 1.0 / (g - own_by_own)
            in_all = by_position + by_own * own * own_by_position
            whole = 1.0 / (g - by_rate - in_all / g - by_own * own_by_rate * own)

            def solve(right: State) -> State:
                """Return y = (p, u, s, v, z) for a right side b."""
                p, u, _, _, z = right
                rate = (u + in_all * p / g + by_own * z * own) * whole
                place = (p + rate) / g
                return (place, rate, 0.0, 0.0,
                        (z + own_by_rate * rate + own_by_position * place) * own)
            return solve
        return solver


class Elastic:
    """With an elastic shaft."""

    def __init__(self, shaft: Shaft, rotor: float) -> None:
        self._given = shaft.stiffness, shaft.damping, rotor

    def on_input(self, terms: Terms, state: State, piece: Piece) -> float:
        """Return the torque on the input."""
        k, c, _ = self._given
        *_, ratio, _ = terms
        return k * state[2] + c * (state[3] - ratio * state[1])

    def derivative(self, terms: Terms, state: State, piece: Piece) -> State:
        """Return dx/dt by (N1), for the terms of (E1) at p and a piece of the source's law."""
        _, u, s, v, z = state
        k, c, rotor = self._given
        inertia, half_slope, force, damping, _, r, _ = terms
        torque, by_speed, by_own, own, own_by_speed, own_by_own = piece
        w = r * u
        on_input = k * s + c * (v - w)
        return (u, (force + r * on_input - (damping + half_slope * u) * u) / inertia, v - w,
                (torque + by_speed * v + by_own * z - on_input) / rotor,
                own + own_by_speed * v + own_by_own * z)

    def linear(self, terms: Terms, state: State, piece: Piece, by_position: float) -> Solver:
        """Return g -> (b -> y), as :meth:`Rigid.linear`; a system of two remains for u and v."""
        k, c, rotor = self._given
        inertia, half_slope, _, damping, _, r, r_slope = terms
        _, by_speed, by_own, _, own_by_speed, own_by_own = piece
        rate_by_rate = -(damping + r * r * c + 2.0 * half_slope * state[1]) / inertia
        motor_by_speed, motor_by_own = (by_speed - c) / rotor, by_own / rotor
        w_slope = r_slope * state[1]                     # dw/dp

        def solver(g: float) -> Callable[[State], State]:
            """
            Prepare the elimination for g = 1 / (gamma h), which serves all stages of a step.

            m11 to m22 is the system of two for u and v; p, s and z follow from these.
            """
            own, coupling = 1.0 / (g - own_by_own), c + k / g
            in_all = by_position - r * k / (g * inertia) * w_slope
            motor_by_place = coupling / (g * rotor) * w_slope
            m11 = g - rate_by_rate - in_all / g + r * r * k / (g * inertia)
            m12, m21 = -(r * coupling) / inertia, -(r * coupling) / rotor - motor_by_place
            m22 = (g - motor_by_speed + k / (g * rotor)
                   - motor_by_own * own_by_speed * own)
            whole = 1.0 / (m11 * m22 - m12 * m21)

            def solve(right: State) -> State:
                """Return y = (p, u, s, v, z): u and v by Cramer's rule, then the others."""
                p, u, s, v, z = right
                pull = k * s / g
                r1 = u + in_all * p / g + r * pull / inertia
                r2 = v - pull / rotor + motor_by_own * z * own + motor_by_place * p
                rate, speed = (m22 * r1 - m12 * r2) * whole, (m11 * r2 - m21 * r1) * whole
                place = (p + rate) / g
                return (place, rate, (s + speed - r * rate - w_slope * place) / g, speed,
                        (z + own_by_speed * speed) * own)
            return solve
        return solver
