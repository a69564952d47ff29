# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Mechanisms as three free bodies and their joints: the second formulation of their dynamics.

Nine Cartesian coordinates, Lagrange multipliers for the joints, constraints at acceleration level
(index 1): nothing of it is singular at a toggle of the input, and nothing of the package's closed
forms is in it. Constraints drift with the error of the integrator alone.
"""
from fourbar_ros import FourBar, SliderCrank
from fourbar_ros.mechanics.bodies import NOT_APPLIED
import numpy as np
from scipy.integrate import solve_ivp

LINKS = ('crank', 'coupler', 'output')


def unit(angle):
    return np.array([np.cos(angle), np.sin(angle)])


def turned(vector):
    return np.array([-vector[1], vector[0]])


class Multibody:
    """Free motion of a four-bar, slider-crank or inverted slider-crank; gravity and loads."""

    def __init__(self, mechanism):
        self.mechanism, self.bodies = mechanism, mechanism.bodies
        a1 = mechanism.a1
        if isinstance(mechanism, FourBar):
            self.pins = [((None, (0.0, 0.0)), (0, (0.0, 0.0))), ((0, (a1, 0.0)), (1, (0.0, 0.0))),
                         ((1, (mechanism.a2, 0.0)), (2, (mechanism.a3, 0.0))),
                         ((None, (mechanism.a4, 0.0)), (2, (0.0, 0.0)))]
        elif isinstance(mechanism, SliderCrank):
            self.pins = [((None, (0.0, 0.0)), (0, (0.0, 0.0))), ((0, (a1, 0.0)), (1, (0.0, 0.0))),
                         ((1, (mechanism.a2, 0.0)), (2, (0.0, 0.0)))]
        else:
            self.pins = [((None, (0.0, 0.0)), (0, (0.0, 0.0))), ((0, (a1, 0.0)), (1, (0.0, 0.0))),
                         ((None, (mechanism.a4, 0.0)), (2, (0.0, 0.0)))]
        self.masses = np.ravel([(b.mass, b.mass, b.inertia) for b in self.bodies])
        self.forces = [mechanism.external._asdict().get(link, NOT_APPLIED) for link in LINKS]

    def arm(self, link, point):
        """Return a point of a link, given from its first joint, from its centre of gravity."""
        body = self.bodies[link]
        return np.array(point) - (body.cg_along, body.cg_across)

    def start(self, curves, rate):
        """Return the state from coefficients of the links at a rate."""
        places, rates = [], []
        for (x, y, dx, dy, _, _, cosine, sine, turn, _), body in zip(curves, self.bodies):
            cg = np.array([cosine * body.cg_along - sine * body.cg_across,
                           sine * body.cg_along + cosine * body.cg_across])
            places += [x + cg[0], y + cg[1], np.arctan2(sine, cosine)]
            rates += [rate * (dx - turn * cg[1]), rate * (dy + turn * cg[0]), rate * turn]
        return np.array(places + rates)

    def _pin(self, side, q, v):
        """Return the rows of a pin's side and the centripetal part of its acceleration."""
        link, point = side
        rows, bend = np.zeros((2, 9)), np.zeros(2)
        if link is not None:
            c, s = np.cos(q[3 * link + 2]), np.sin(q[3 * link + 2])
            x, y = self.arm(link, point)
            arm = np.array([c * x - s * y, s * x + c * y])
            rows[:, 3 * link:3 * link + 2] = np.eye(2)
            rows[:, 3 * link + 2] = turned(arm)
            bend = -arm * v[3 * link + 2]**2
        return rows, bend

    def _joints(self, q, v):
        rows, right = [], []
        for one, other in self.pins:
            (a, bend_a), (b, bend_b) = self._pin(one, q, v), self._pin(other, q, v)
            rows.append(a - b)
            right.append(bend_b - bend_a)
        if len(self.pins) == 4:
            return np.vstack(rows), np.concatenate(right)
        if isinstance(self.mechanism, SliderCrank):      # it does not turn, nor leave y = e
            guide = np.zeros((2, 9))
            guide[0, 7] = guide[1, 8] = 1.0
            return np.vstack([*rows, guide]), np.concatenate([*right, np.zeros(2)])
        # block and bar turn together, and A stays at the same distance from the bar's line
        (a, bend_a), (b, bend_b) = (self._pin((link, (0.0, 0.0)), q, v) for link in (1, 2))
        angle, spin = q[8], v[8]
        e, n = unit(angle), turned(unit(angle))
        body = self.bodies[1]
        place = q[3:5] - (unit(q[5]) * body.cg_along + turned(unit(q[5])) * body.cg_across)
        apart = place - (self.mechanism.a4, 0.0)
        rate = (a - b) @ v
        row = n @ (a - b)
        row[8] -= e @ apart
        extra = -n @ (bend_a - bend_b) + 2.0 * spin * (e @ rate) + spin**2 * (n @ apart)
        same = np.zeros(9)
        same[5], same[8] = 1.0, -1.0
        return np.vstack([*rows, same, row]), np.concatenate([*right, [0.0, extra]])

    def derivative(self, time, state):
        q, v = state[:9], state[9:]
        rows, right = self._joints(q, v)
        load = np.zeros(9)
        for i, (body, applied) in enumerate(zip(self.bodies, self.forces)):
            force = np.array([applied.force_x, applied.force_y])
            x, y = self.arm(i, (applied.along, applied.across))
            arm = x * unit(q[3 * i + 2]) + y * turned(unit(q[3 * i + 2]))
            load[3 * i:3 * i + 2] = body.mass * np.array(self.mechanism.gravity) + force
            load[3 * i + 2] = applied.couple + arm[0] * force[1] - arm[1] * force[0]
        count = len(right)
        matrix = np.block([[np.diag(self.masses), rows.T], [rows, np.zeros((count, count))]])
        answer = np.linalg.solve(matrix, np.concatenate([load, right]))
        return np.concatenate([v, answer[:9]])

    def run(self, state, times, tolerance=1e-12):
        """Return the states at these times."""
        return solve_ivp(self.derivative, (0.0, times[-1]), state, 'DOP853', times,
                         rtol=tolerance, atol=tolerance).y
