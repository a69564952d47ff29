# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
A chassis on springs carries the paper's linkage: MuJoCo moves it, a node gives the wrench.

Start the node first:  fourbar_node --ros-args --params-file examples/nodes/mujoco_chassis.yaml
You see how far the linkage shakes the chassis while its crank runs up to 25 rad/s.
"""
import sys

from fourbar_ros import Base
import numpy as np

try:
    import mujoco
except ModuleNotFoundError:
    sys.exit('needs MuJoCo: pip install mujoco')

CARRIED = 5.8434, 0.5417, 0.2979, 1.6236        # mass, x, y, inertia: base.carried of the node
MODEL = """
<mujoco><option timestep="{step}" gravity="0 -9.81 0"><flag eulerdamp="disable"/></option>
 <worldbody><body>
  <joint type="slide" axis="1 0 0" stiffness="4e5" damping="800"/>
  <joint type="slide" axis="0 1 0" stiffness="4e5" damping="800"/>
  <joint type="hinge" axis="0 0 1" stiffness="2e5" damping="300"/>
  <inertial pos="0 0 0" mass="{mass}" diaginertia="12 12 12"/>
  <body pos="-0.5 0.2 0"><site name="O1"/>
   <inertial pos="{1} {2} 0" mass="{0}" diaginertia="{3} {3} {3}"/></body>
 </body></worldbody><sensor><accelerometer site="O1"/></sensor></mujoco>"""


def crank(time, speed=25.0, ramp=0.5):
    """Return angle, rate and acceleration of a crank that runs up and goes on."""
    s = min(time / ramp, 1.0)
    return (speed * (ramp * (s**3 - s**4 / 2) + max(time - ramp, 0.0)),
            speed * (3 * s**2 - 2 * s**3), speed / ramp * 6 * (s - s**2))


def simulate(ask, mass=60.0, step=1e-3, until=3.0, asks=2):
    """
    Return x, y and angle of the chassis; ``ask(stamp, *crank, base=...)`` gives the wrench.

    ``asks``: how often in a step; twice, and the wrench is as good as one solved for in MuJoCo.
    """
    model = mujoco.MjModel.from_xml_string(MODEL.format(*CARRIED, mass=mass, step=step))
    data, way = mujoco.MjData(model), [np.zeros(3)]
    for number in range(asks * round(until / step)):
        mujoco.mj_forward(model, data)           # specific force and acceleration of this moment
        base = Base(*data.sensordata[:2], data.qvel[2], data.qacc[2])
        time = number // asks * step             # stamps rise, and are not 0
        answer = ask((number + 1) * step / asks, *crank(time), base=base).shaking_wrench.wrench
        turn = data.site('O1').xmat.reshape(3, 3)        # the wrench is along the linkage's axes
        data.qfrc_applied[:] = 0.0
        mujoco.mj_applyFT(model, data, turn @ [answer.force.x, answer.force.y, 0.0],
                          np.array([0.0, 0.0, answer.torque.z]), data.site('O1').xpos, 1,
                          data.qfrc_applied)
        if (number + 1) % asks == 0:
            mujoco.mj_step(model, data)
            way.append(data.qpos.copy())
    return np.array(way)


if __name__ == '__main__':
    from fourbar_ros.clients import LockStep  # needs ROS
    x, y, angle = np.ptp(simulate(LockStep())[2000:], axis=0)
    print(f'in the third second: {1e3 * x:.2f} mm, {1e3 * y:.2f} mm, {np.degrees(angle):.3f} deg')
