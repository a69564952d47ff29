# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""MuJoCo: inverse dynamics of a tree with the loop closed here; and its own, connect."""
from common import Case, Method, serve
from loop import read, run_tree
import mujoco
from mujoco import rollout as runner
import numpy as np

case = Case()
(x0, b0, y0), (dx0, db0, dy0) = case.start()
FLYWHEEL = 1e8     # [kg m^2] keeps the stepped crank at its speed


def link(name, at, end, body, inside='', armature=0.0):
    mass, along, across, inertia = body
    return f"""
<body name="{name}" pos="{at!r} 0 0">
  <joint name="{name}" axis="0 0 1" armature="{armature!r}"/>
  <inertial pos="{along!r} {across!r} 0" mass="{mass!r}"
            diaginertia="{inertia!r} {inertia!r} {inertia!r}"/>
  <site name="{name}" pos="{end!r} 0 0"/>{'<site name="o1"/>' if name == 'crank' else ''}{inside}
</body>"""


def model(equality='', options='', armature=0.0, sensors=''):
    a1, a2, a3, a4 = case.lengths
    crank, coupler, output = case.bodies
    tree = (link('crank', 0.0, a1, crank, link('coupler', a1, a2, coupler), armature)
            + link('output', a4, a3, output))
    return mujoco.MjModel.from_xml_string(f"""
<mujoco><compiler angle="radian"/><option gravity="0 0 0" {options}/>
<worldbody>{tree}</worldbody><equality>{equality}</equality><sensor>{sensors}</sensor></mujoco>""")


class Tree:
    """See loop.run_tree."""

    def __init__(self):
        self.model = model()
        self.data = mujoco.MjData(self.model)
        self.ends = self.model.site('coupler').id, self.model.site('output').id
        self.bodies = [self.model.body(name).id for name in ('coupler', 'output')]
        self.crank = self.model.body('crank').id
        self.one, self.other = np.zeros((3, 3)), np.zeros((3, 3))

    def gap(self, q):
        model, data, (coupler, output) = self.model, self.data, self.ends
        data.qpos[:] = q
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        mujoco.mj_jacSite(model, data, self.one, None, coupler)
        mujoco.mj_jacSite(model, data, self.other, None, output)
        at = data.site_xpos
        return (at[output] - at[coupler]).tolist(), (self.other - self.one)[:2].tolist()

    def bias(self, q, v):
        model, data = self.model, self.data
        data.qvel[:] = v
        mujoco.mj_comVel(model, data)
        at = data.site_xpos
        mujoco.mj_jacDot(model, data, self.one, None, at[self.ends[0]], self.bodies[0])
        mujoco.mj_jacDot(model, data, self.other, None, at[self.ends[1]], self.bodies[1])
        return ((self.other - self.one) @ data.qvel).tolist()

    def efforts(self, q, v, a):
        model, data = self.model, self.data
        data.qacc[:] = a
        mujoco.mj_inverse(model, data)
        mujoco.mj_rnePostConstraint(model, data)
        return data.qfrc_inverse.tolist(), data.cfrc_int[self.crank, 3:5].tolist()


def connect(steps, hardest):
    """Return the stepper: two turns, RK4, some steps a sample, in one call of mujoco.rollout."""
    dt = case.step / case.omega / steps
    solver = f'solref="{2.0 * dt!r} 1" solimp="0.9999 0.9999 0.001 0.5 2"' if hardest else ''
    sensors = ('<force site="o1"/><frameangvel objtype="body" objname="output"/>'
               '<frameangacc objtype="body" objname="output"/>')
    loop = model(f'<connect site1="coupler" site2="output" {solver}/>',
                 f'timestep="{dt!r}" integrator="RK4" iterations="20" tolerance="0"', FLYWHEEL,
                 sensors)
    data, count = mujoco.MjData(loop), 2 * len(case.theta1) * steps
    data.qpos[:], data.qvel[:] = (x0, b0 - x0, y0), (dx0, db0 - dx0, dy0)
    start = np.zeros(mujoco.mj_stateSize(loop, mujoco.mjtState.mjSTATE_FULLPHYSICS))
    mujoco.mj_getState(loop, data, start, mujoco.mjtState.mjSTATE_FULLPHYSICS)

    def run(theta1):
        state, sensed = runner.rollout(loop, data, start[None, :], nstep=count)
        return state[0], sensed[0]
    return run


def read_connect(found):
    """
    States are those after a step, what the sensors say is from before it.

    The force is in the crank's frame.
    """
    state, sensed = found
    state = np.concatenate((np.array([[0.0, x0, b0 - x0, y0]]), state[:-1, :4]))
    steps = len(state) // (2 * len(case.theta1))
    state, sensed = state[::steps][len(case.theta1):], sensed[::steps][len(case.theta1):]
    cosine, sine = np.cos(state[:, 1]), np.sin(state[:, 1])
    fx, fy = sensed[:, 0], sensed[:, 1]
    return {'theta4': state[:, 3], 'omega4': sensed[:, 5], 'alpha4': sensed[:, 8],
            'f41': np.stack((cosine * fx - sine * fy, sine * fx + cosine * fy), -1)}


serve(case, [
    *(Method(f'MuJoCo tree, loop closed to {tolerance:.0e} m', run_tree(Tree(), case, tolerance),
             read) for tolerance in (1e-3, 1e-9)),
    Method('MuJoCo connect, default softness', connect(1, False), read_connect, 2),
    Method('MuJoCo connect, hardest, 1 step', connect(1, True), read_connect, 2),
    Method('MuJoCo connect, hardest, 4 steps', connect(4, True), read_connect, 2)])
