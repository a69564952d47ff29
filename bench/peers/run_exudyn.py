# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Exudyn: bodies in absolute coordinates, Lagrange multipliers, constant speed."""
from common import Case, Method, serve
import exudyn as exu
from exudyn.itemInterface import (
    MarkerBodyPosition,
    MarkerNodeCoordinate,
    NodePointGround,
    NodeRigidBody2D,
    ObjectConnectorCoordinate,
    ObjectJointRevolute2D,
    ObjectRigidBody2D,
    SensorNode,
    SensorObject,
)
import numpy as np

case = Case()
a1, a2, a3, a4 = case.lengths
(x0, b0, y0), (dx0, db0, dy0) = case.start()
exu.config.suppressWarnings = True


def build(mbs):
    """Add the linkage; return the sensors: output link's angle, rate, acceleration, F41 x, y."""
    elbow = np.array([a1 * np.cos(x0), a1 * np.sin(x0)])
    turning = dx0 * np.array([-elbow[1], elbow[0]])
    starts = (((0.0, 0.0), x0, (0.0, 0.0), dx0), (elbow, b0, turning, db0),
              ((a4, 0.0), y0, (0.0, 0.0), dy0))
    nodes, ends, begins = [], [], []
    for length, (mass, along, across, inertia), (at, angle, velocity, rate) in zip(case.lengths,
                                                                                   case.bodies,
                                                                                   starts):
        node = mbs.AddNode(NodeRigidBody2D(referenceCoordinates=[*at, angle],
                                           initialVelocities=[*velocity, rate]))
        body = mbs.AddObject(ObjectRigidBody2D(nodeNumber=node, mass=mass,
                                               centerOfMass=[along, across],
                                               inertia=inertia + mass * (along**2 + across**2)))
        nodes.append(node)
        begins.append(mbs.AddMarker(MarkerBodyPosition(bodyNumber=body)))
        ends.append(mbs.AddMarker(MarkerBodyPosition(bodyNumber=body,
                                                     localPosition=[length, 0.0, 0.0])))
    mbs.AddObject(ObjectJointRevolute2D(markerNumbers=[ends[0], begins[1]]))
    mbs.AddObject(ObjectJointRevolute2D(markerNumbers=[ends[1], ends[2]]))
    ground = mbs.AddMarker(MarkerNodeCoordinate(nodeNumber=mbs.AddNode(NodePointGround()),
                                                coordinate=0))

    def fix(node, coordinate, **more):
        marker = mbs.AddMarker(MarkerNodeCoordinate(nodeNumber=node, coordinate=coordinate))
        return mbs.AddObject(ObjectConnectorCoordinate(markerNumbers=[ground, marker], **more))

    fix(nodes[2], 0)
    fix(nodes[2], 1)
    fix(nodes[0], 2, velocityLevel=True, offset=dx0)
    kinds = exu.OutputVariableType
    sensors = [SensorNode(nodeNumber=nodes[2], storeInternal=True, outputVariableType=kind)
               for kind in (kinds.Rotation, kinds.AngularVelocity, kinds.AngularAcceleration)]
    sensors += [SensorObject(objectNumber=fix(nodes[0], i), storeInternal=True,
                             outputVariableType=kinds.Force)
                for i in (0, 1)]
    return [mbs.AddSensor(sensor) for sensor in sensors]


def stepper(steps, index2):
    """Return the function that steps two turns and returns the sensors' tables of the second."""
    mbs = exu.SystemContainer().AddSystem()
    sensors = build(mbs)
    settings = exu.SimulationSettings()
    turn = len(case.theta1)
    time, dt = settings.timeIntegration, case.step / case.omega
    time.numberOfSteps, time.endTime = 2 * turn * steps, 2 * turn * dt
    time.generalizedAlpha.spectralRadius = 1.0 if index2 else 0.9
    time.generalizedAlpha.useNewmark = time.generalizedAlpha.useIndex2Constraints = index2
    time.newton.useModifiedNewton = True
    time.verboseMode = 0
    settings.solutionSettings.writeSolutionToFile = False
    settings.solutionSettings.sensorsWritePeriod = dt
    settings.linearSolverType = exu.LinearSolverType.EXUdense

    def run(theta1):
        mbs.Assemble()
        mbs.SolveDynamic(settings)
        return [mbs.GetSensorStoredData(sensor)[turn:2 * turn, -1] for sensor in sensors]
    return run


def read(found):
    theta4, omega4, alpha4, *force = found     # that of the crank on the ground
    return {'theta4': theta4, 'omega4': omega4, 'alpha4': alpha4, 'f41': -np.array(force).T}


serve(case, [Method(f'Exudyn {name}, {steps} step{"s" * (steps > 1)}', stepper(steps, index2),
                    read, 2)
             for name, index2 in (('generalized alpha index 3', False),
                                  ('trapezoidal index 2', True))
             for steps in (1, 4)])
