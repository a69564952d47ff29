# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""fourbarhinge: kinematics, then its 9x9 system, one sample a call."""
from common import Case, Method, serve
from fourbarhinge import (
    Actuator,
    Bar,
    BarId,
    FourBarDynamics,
    FourBarGeometry,
    FourBarKinematics,
    FourBarReactions,
    Point,
)
import numpy as np

case = Case()
MOVING = BarId.INPUT, BarId.COUPLER, BarId.OUTPUT
bars = {BarId.GROUND: Bar(length=case.lengths[3])}
for bar, length, (mass, along, across, inertia) in zip(MOVING, case.lengths, case.bodies):
    bars[bar] = Bar(length=length, mass=mass, inertia=inertia,
                    center_of_mass=Point(x=along, y=across))
kinematics = FourBarKinematics(FourBarGeometry(position_ground=Point(x=0.0, y=0.0), bar=bars), 0.0)
reactions = FourBarReactions(FourBarDynamics(kinematics, gravity=(0.0, 0.0)))
drive = Actuator(bar=BarId.INPUT)
branch = min((1, -1), key=lambda sign: abs(np.sin(0.5 * (
    kinematics.solve_configuration(float(case.theta1[0]), sign).theta[BarId.OUTPUT]
    - case.truth['theta4'][0]))))


def run(theta1):
    rows = []
    for x in theta1.tolist():
        kinematics.solve_configuration(x, branch)
        _, _, rate = kinematics.solve_theta_dot(case.omega)
        _, _, second = kinematics.solve_theta_ddot(0.0)
        rows.append((kinematics.configuration.theta[BarId.OUTPUT], rate, second,
                     reactions.solve(drive)))
    return rows


def read(rows):
    theta4, omega4, alpha4, forces = zip(*rows)
    return {'theta4': theta4, 'omega4': omega4, 'alpha4': alpha4,
            'f41': [f.reactions['A'] for f in forces]}


serve(case, [Method('fourbarhinge', run, read)])
