# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""pylinkage with numba: its compiled loop over positions, velocities, accelerations. No forces."""
from common import Case, Method, serve
import numpy as np
from pylinkage.solver.simulation import simulate_with_kinematics
from pylinkage.solver.types import JOINT_CRANK, JOINT_REVOLUTE, JOINT_STATIC

case = Case()
a1, a2, a3, a4 = case.lengths
(theta1, _, theta4), _ = case.start()
O1, A, B, O4 = range(4)     # noqa: E741


def ints(*values):
    return np.array(values, dtype=np.int32)


def run(samples):
    before = theta1 - case.step     # the loop advances first, then stores
    start = np.array([[0.0, 0.0], [a1 * np.cos(before), a1 * np.sin(before)],
                      [a4 + a3 * np.cos(theta4), a3 * np.sin(theta4)], [a4, 0.0]])
    return simulate_with_kinematics(
        start, np.zeros((4, 2)), np.zeros((4, 2)), np.array([a1, case.step, a2, a3]),
        ints(JOINT_STATIC, JOINT_CRANK, JOINT_REVOLUTE, JOINT_STATIC),
        ints((-1, -1, -1), (O1, -1, -1), (A, O4, -1), (-1, -1, -1)), ints(0, 0, 2, 4),
        ints(O1, O4, A, B),
        np.array([case.omega]), np.array([0.0]), ints(A), len(samples), 1.0)


def read(found):
    arm, velocity, acceleration = (values[:, B] - values[:, O4] for values in found)

    def turning(vector):
        return (arm[:, 0] * vector[:, 1] - arm[:, 1] * vector[:, 0]) / a3**2

    return {'theta4': np.arctan2(arm[:, 1], arm[:, 0]), 'omega4': turning(velocity),
            'alpha4': turning(acceleration)}


serve(case, [Method('pylinkage + numba (motion only)', run, read)])
