# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
A motor drives the paper's linkage: MuJoCo moves the rotor, a node gives inertia and bias.

Start the node first:  fourbar_node --ros-args --params-file examples/nodes/mujoco_motor.yaml
You see how the speed rises and by how much it fluctuates, however light the rotor is.
"""
import sys

import numpy as np

try:
    import mujoco
except ModuleNotFoundError:
    sys.exit('needs MuJoCo: pip install mujoco')

# The centre lies beside the origin: MuJoCo would keep the inertia of a simpler body as it was.
MODEL = """
<mujoco><option timestep="{step}" gravity="0 0 0" integrator="Euler"/><worldbody><body>
 <joint type="hinge" axis="0 0 1"/><inertial pos="0 0 0.1" mass="1" diaginertia="{0} {0} {0}"/>
</body></worldbody></mujoco>"""


def motor(rate, stall_torque=400.0, free_speed=26.0):
    """Return the torque of the motor."""
    return stall_torque * (1.0 - rate / free_speed)


def simulate(ask, rotor=0.2, step=1e-3, until=2.0):
    """Return angle and rate of the rotor; ``ask(stamp, angle, rate, 0)`` gives the equation."""
    model = mujoco.MjModel.from_xml_string(MODEL.format(rotor, step=step))
    data, way = mujoco.MjData(model), [np.zeros(2)]
    for number in range(round(until / step)):
        (angle,), (rate,) = data.qpos, data.qvel
        equation = ask((number + 1) * step, float(angle), float(rate), 0.0).equation
        model.dof_armature[0] = equation.inertia          # the linkage, as a part of the rotor
        data.qfrc_applied[0] = motor(rate) - equation.bias
        mujoco.mj_step(model, data)
        way.append([data.qpos[0], data.qvel[0]])
    return np.array(way)


if __name__ == '__main__':
    from fourbar_ros.clients import LockStep  # needs ROS
    rates = simulate(LockStep(outputs=('equation',)))[:, 1]
    print(f'{rates[100]:.2f} rad/s after 0.1 s; at the end {rates[1500:].min():.2f} to '
          f'{rates[1500:].max():.2f} rad/s')
