# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Pinocchio: rnea of a tree with the loop closed here."""
from common import Case, Method, serve
from loop import read, run_tree
import numpy as np
import pinocchio as pin

case = Case()
a1, a2, a3, a4 = case.lengths


def place(x):
    return pin.SE3(np.eye(3), np.array([x, 0.0, 0.0]))


model = pin.Model()
model.gravity.linear[:] = 0.0
crank = model.addJoint(0, pin.JointModelRZ(), place(0.0), 'crank')
coupler = model.addJoint(crank, pin.JointModelRZ(), place(a1), 'coupler')
output = model.addJoint(0, pin.JointModelRZ(), place(a4), 'output')
for joint, (mass, along, across, inertia) in zip((crank, coupler, output), case.bodies):
    model.appendBodyToJoint(joint, pin.Inertia(mass, np.array([along, across, 0.0]),
                                               inertia * np.eye(3)), place(0.0))
ends = [model.addFrame(pin.Frame(name, joint, 0, place(length), pin.FrameType.OP_FRAME))
        for name, joint, length in (('end of coupler', coupler, a2),
                                    ('end of output', output, a3))]
WORLD = pin.LOCAL_WORLD_ALIGNED


class Tree:
    """See loop.run_tree."""

    def __init__(self):
        self.data = model.createData()

    def gap(self, q):
        data = self.data
        self.q = np.array(q)
        pin.computeJointJacobians(model, data, self.q)
        one, other = (pin.updateFramePlacement(model, data, end).translation for end in ends)
        jacobian = (pin.getFrameJacobian(model, data, ends[1], WORLD)
                    - pin.getFrameJacobian(model, data, ends[0], WORLD))
        return (other - one).tolist(), jacobian[:2].tolist()

    def bias(self, q, v):
        data = self.data
        pin.forwardKinematics(model, data, self.q, np.array(v), np.zeros(3))
        one, other = (pin.getFrameClassicalAcceleration(model, data, end, WORLD).linear
                      for end in ends)
        return (other - one).tolist()

    def efforts(self, q, v, a):
        data = self.data
        effort = pin.rnea(model, data, self.q, np.array(v), np.array(a)).tolist()
        return effort, (data.oMi[crank].rotation @ data.f[crank].linear)[:2].tolist()


serve(case, [Method(f'Pinocchio tree, loop closed to {tolerance:.0e} m',
                    run_tree(Tree(), case, tolerance), read) for tolerance in (1e-3, 1e-9)])
