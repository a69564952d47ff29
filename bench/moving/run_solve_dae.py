# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
solve-dae: three coordinates and the closing of their loop as a differential-algebraic equation.

Stabilised (Gear, Gupta, Leimkuhler), its multipliers as derivatives, so of index 1. Jacobians by
differences of our own: its own scale those of states that act nowhere until they overflow.
"""
from common import problems, report
import numpy as np
from solve_dae.integrate import solve_dae

DIFFERENCE = 1.5e-8


class Loop:
    """Places of a linkage by its three coordinates, their Jacobians and what is centripetal."""

    def __init__(self, problem):
        self.problem, self.is_slider = problem, problem.kind == 'slider_crank'

    def chain(self, q, v, *parts):
        """Return place, Jacobian and bias of a sum of arms (coordinate, along, across)."""
        place, rows, bias = np.zeros(2), np.zeros((2, 3)), np.zeros(2)
        for i, along, across in parts:
            c, s = np.cos(q[i]), np.sin(q[i])
            arm = np.array([along * c - across * s, along * s + across * c])
            place, bias = place + arm, bias - arm * v[i] * v[i]
            rows[:, i] = -arm[1], arm[0]
        return place, rows, bias

    def on_output(self, q, v, along, across):
        """Return the same of a point of the output link."""
        if self.is_slider:
            rows = np.zeros((2, 3))
            rows[0, 2] = 1.0
            return np.array([q[2] + along, across]), rows, np.zeros(2)
        place, rows, bias = self.chain(q, v, (2, along, across))
        return place + (self.problem.lengths[3], 0.0), rows, bias

    def gap(self, q, v):
        """Return what must vanish, its Jacobian and bias: end of coupler less output."""
        a1, a2, *others = self.problem.lengths
        one = self.chain(q, v, (0, a1, 0.0), (1, a2, 0.0))
        other = self.on_output(q, v, 0.0 if self.is_slider else others[0], 0.0)
        return [a - b for a, b in zip(one, other)]

    def masses_and_forces(self, q, v):
        """Return M and the right-hand side of M dv/dt = f + G' multipliers."""
        problem, (a1, *_) = self.problem, self.problem.lengths
        matrix, right = np.zeros((3, 3)), np.zeros(3)
        for i, (mass, along, across, inertia) in enumerate(problem.bodies):
            if mass:
                parts = ((0, along, across),) if i == 0 else ((0, a1, 0.0), (1, along, across))
                _, rows, bias = (self.chain(q, v, *parts) if i < 2
                                 else self.on_output(q, v, along, across))
                matrix += mass * rows.T @ rows
                right += mass * rows.T @ (np.array(problem.gravity) - bias)
            if not (i == 2 and self.is_slider):
                matrix[i, i] += inertia
        push, pull = problem.forces
        right += self.chain(q, v, (0, a1, 0.0))[1].T @ push
        right += self.on_output(q, v, 0.0, 0.0)[1].T @ pull
        if problem.spring:
            on_crank, on_coupler, k, free, damping = problem.spring
            one, its, _ = self.chain(q, v, (0, on_crank, 0.0))
            two, other, _ = self.chain(q, v, (0, a1, 0.0), (1, on_coupler, 0.0))
            apart, rows = two - one, other - its
            length = np.hypot(*apart)
            along = rows.T @ apart / length
            right -= (k * (length - free) + damping * (along @ v)) * along
        return matrix, right

    def start(self):
        """Return the state at the start and its derivative, which are consistent."""
        q, v = np.array(self.problem.start), np.array(self.problem.rates)
        (_, rows, bias), (matrix, right) = self.gap(q, v), self.masses_and_forces(q, v)
        answer = np.linalg.solve(np.block([[matrix, -rows.T], [rows, np.zeros((2, 2))]]),
                                 np.concatenate([right, -bias]))
        return np.concatenate([q, v, np.zeros(4)]), np.concatenate([v, answer, np.zeros(2)])

    def residual(self, time, state, change):
        """Return what vanishes of (q, v, integrals of both multipliers) and its derivative."""
        q, v = state[:3], state[3:6]
        force, drift = change[6:8], change[8:10]
        place, rows, _ = self.gap(q, v)
        matrix, right = self.masses_and_forces(q, v)
        return np.concatenate([change[:3] - v - rows.T @ drift,
                               matrix @ change[3:6] - right - rows.T @ force, rows @ v, place])

    def jacobians(self, time, state, change):
        """Return d residual / d state, and d change, in which it is linear."""
        base, by_state, unit = self.residual(time, state, change), np.zeros((10, 10)), np.eye(10)
        for i in range(6):
            step = DIFFERENCE * max(1.0, abs(state[i]))
            by_state[:, i] = (self.residual(time, state + step * unit[i], change) - base) / step
        nothing = self.residual(time, state, np.zeros(10))
        return by_state, np.array([self.residual(time, state, unit[i]) - nothing
                                   for i in range(10)]).T


def runs(problem, method, tolerance):
    """Return the function that integrates and reads the watched coordinate."""
    loop = Loop(problem)
    state, change = loop.start()

    def run():
        done = solve_dae(loop.residual, (0.0, problem.until), state, change, method=method,
                         rtol=tolerance, atol=tolerance, jac=loop.jacobians)
        if not done.success:
            raise RuntimeError(done.message)
        return done.y[problem.watched, -1]
    return run


for problem in problems():
    for tolerance in (1e-4, 1e-6, 1e-8, 1e-10):
        for method in ('Radau', 'BDF'):
            report(problem, f'solve-dae, {method}', f'{tolerance:.0e}',
                   runs(problem, method, tolerance))
