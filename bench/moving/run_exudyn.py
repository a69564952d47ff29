# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Exudyn: bodies in absolute coordinates, Lagrange multipliers, its implicit solvers."""
from common import problems, report
import exudyn as exu
from exudyn.itemInterface import (
    Force,
    Gravity,
    MarkerBodyMass,
    MarkerBodyPosition,
    MarkerNodeCoordinate,
    NodePointGround,
    NodeRigidBody2D,
    ObjectConnectorCoordinate,
    ObjectConnectorSpringDamper,
    ObjectGround,
    ObjectJointRevolute2D,
    ObjectRigidBody2D,
)
import numpy as np

exu.config.suppressWarnings = True


def starts(problem):
    """Return (place, angle, velocity, rate) of the first joint of each link."""
    (x, b, y), (dx, db, dy) = problem.start, problem.rates
    elbow = problem.lengths[0] * np.array([np.cos(x), np.sin(x)])
    turning = dx * np.array([-elbow[1], elbow[0]])
    last = (((y, 0.0), 0.0, (dy, 0.0), 0.0) if problem.kind == 'slider_crank'
            else ((problem.lengths[3], 0.0), y, (0.0, 0.0), dy))
    return ((0.0, 0.0), x, (0.0, 0.0), dx), (elbow, b, turning, db), last


def build(mbs, problem):
    """Add the linkage; return its nodes."""
    nodes, bodies = [], []
    for (mass, along, across, inertia), (at, angle, velocity, rate) in zip(problem.bodies,
                                                                           starts(problem)):
        nodes.append(mbs.AddNode(NodeRigidBody2D(referenceCoordinates=[*at, angle],
                                                 initialVelocities=[*velocity, rate])))
        bodies.append(mbs.AddObject(ObjectRigidBody2D(
            nodeNumber=nodes[-1], mass=mass, centerOfMass=[along, across],
            inertia=inertia + mass * (along**2 + across**2))))

    def at(body, along=0.0):
        return mbs.AddMarker(MarkerBodyPosition(bodyNumber=body,
                                                localPosition=[along, 0.0, 0.0]))

    def pin(one, other):
        mbs.AddObject(ObjectJointRevolute2D(markerNumbers=[one, other]))

    a1, a2, *others = problem.lengths
    ground = mbs.AddObject(ObjectGround())
    fixed = mbs.AddMarker(MarkerNodeCoordinate(nodeNumber=mbs.AddNode(NodePointGround()),
                                               coordinate=0))
    pin(at(ground), at(bodies[0]))
    pin(at(bodies[0], a1), at(bodies[1]))
    if problem.kind == 'slider_crank':
        pin(at(bodies[1], a2), at(bodies[2]))
        for coordinate in (1, 2):
            mbs.AddObject(ObjectConnectorCoordinate(markerNumbers=[fixed, mbs.AddMarker(
                MarkerNodeCoordinate(nodeNumber=nodes[2], coordinate=coordinate))]))
    else:
        pin(at(bodies[1], a2), at(bodies[2], others[0]))
        pin(at(ground, others[1]), at(bodies[2]))
    if problem.spring:
        on_crank, on_coupler, k, free, damping = problem.spring
        mbs.AddObject(ObjectConnectorSpringDamper(
            markerNumbers=[at(bodies[0], on_crank), at(bodies[1], on_coupler)],
            stiffness=k, referenceLength=free, damping=damping))
    for body, force in zip(bodies[1:], problem.forces):
        mbs.AddLoad(Force(markerNumber=at(body), loadVector=[*force, 0.0]))
    if any(problem.gravity):
        for body in bodies:
            mbs.AddLoad(Gravity(markerNumber=mbs.AddMarker(MarkerBodyMass(bodyNumber=body)),
                                loadVector=[*problem.gravity, 0.0]))
    mbs.Assemble()
    return nodes


def runs(problem, steps, index2):
    """Return the function that takes so many steps and reads the watched coordinate."""
    mbs = exu.SystemContainer().AddSystem()
    nodes = build(mbs, problem)
    settings = exu.SimulationSettings()
    time = settings.timeIntegration
    time.numberOfSteps, time.endTime = steps, problem.until
    time.generalizedAlpha.spectralRadius = 1.0 if index2 else 0.9
    time.generalizedAlpha.useNewmark = time.generalizedAlpha.useIndex2Constraints = index2
    time.newton.useModifiedNewton = True
    time.verboseMode = 0
    settings.solutionSettings.writeSolutionToFile = False
    settings.linearSolverType = exu.LinearSolverType.EXUdense
    is_angle = problem.watched < 2 or problem.kind == 'four_bar'

    def run():
        mbs.Assemble()
        if mbs.SolveDynamic(settings, showHints=False) is False:
            raise RuntimeError('the solver gave up')
        moved = mbs.GetNodeOutput(nodes[problem.watched], exu.OutputVariableType.Coordinates)
        return problem.start[problem.watched] + moved[2 if is_angle else 0]
    return run


for problem in problems():
    for steps in (500, 2000, 8000, 32000, 128000):
        for name, index2 in (('Exudyn, generalized alpha, index 3', False),
                             ('Exudyn, trapezoidal, index 2', True)):
            report(problem, name, f'{steps} steps', runs(problem, steps, index2))
