# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Friction and forces one way in the equation of motion.

They depend on the direction of the motion, and friction on its acceleration too, as forces of
joints do. So (E1) has one term more,

    J dw/dt + J'/2 w^2 = Q - D w + T - R                                                   (E9)

R w is what friction dissipates, never negative, less the power of forces one way. The joint
forces are linear in dw/dt and in the sizes of all dry efforts; with dw/dt of (E9) they are so in
the sizes alone, and these are solved together as the loads of a given motion are, (J3) of
:mod:`fourbar_ros.mechanisms.machine.solve.friction`. Here the joints lock where friction grows
with the deceleration that it brings faster than the inertia takes it (Painleve's paradox), or
where they would in a motion that is given with this acceleration: then there is none, and R is not
a number.

Within the slip speed of the input the direction is smooth, (J4): where Coulomb's friction would
hold the mechanism, it creeps at a part of that speed.
"""
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from fourbar_ros.dynamics.equation import Equation, NO_WRENCHES, Resistance, Wrenches
from fourbar_ros.mechanics.bodies import Applied, Base, unchecked
from fourbar_ros.mechanisms.friction import direction_of
from fourbar_ros.mechanisms.machine.solve import friction as joints
from fourbar_ros.numerics.linear_forms import CONSTANT, form_of, LinearForm
from fourbar_ros.numerics.number_types import Function, NumberType, Scalar, TINY

CHANGE = 'change'      # the unknown dw/dt


def make_resistance(equation: Equation, n: NumberType, base: Base | None = None,
                    wrenches: Wrenches = NO_WRENCHES) -> Function:
    """Return the formula (q, w, push, J) -> :class:`.Resistance`."""
    # push: Q - D w - J'/2 w^2 + T; base, wrenches as of Equation.make_terms. A fifth argument,
    # felt of a state near by, saves iterations.
    mechanism, make_pose = equation.mechanism, equation.make_pose(equation.coordinate, n)
    constants = mechanism.constants
    if base or wrenches:
        loads = mechanism.loads_of_links()
        constants = constants._replace(
            gravity=base or constants.gravity,
            external=constants.external._replace(**{
                name: unchecked(Applied, force_x, force_y, loads[name][1].along,
                                loads[name][1].across, couple)
                for name, (force_x, force_y, couple) in wrenches.items()}))
    one_way = [force for force in mechanism.elements if force.is_one_way]
    # forces of joints are linear forms, whose sizes are not asked for
    of_forms = replace(n, hypot=lambda x, y: 0.0 if isinstance(x, LinearForm) or isinstance(
        y, LinearForm) else n.hypot(x, y))

    def resistance(position: Scalar, rate: Scalar, push: Scalar, inertia: Scalar,
                   near: Sequence[joints.Felt] = ()) -> Resistance:
        cut, rubbing = 0.0, joints.OpenForces()       # force cut off one way; joints with friction
        if one_way:
            moving, (value, _, _) = make_pose(position)
            direction = direction_of(n, rate, mechanism.slip_speed_in(constants))
            for force in one_way:
                cut = cut + force.generalised(n, moving, value, direction)
        # Loads at a rate and an unknown acceleration are linear forms; they are computed for what
        # joints with friction tell ``rubbing`` of them.
        acceleration: Any = LinearForm({CHANGE: 1.0})
        mechanism.joint_loads_in(of_forms, constants, mechanism.motion_in(
            n, constants, position, rate, acceleration), rubbing)
        paid, felt, edges = form_of(rubbing.paid), list[joints.Felt](), list[Scalar]()
        friction = paid.coefficient(CONSTANT)
        if rubbing:
            # the acceleration as a linear form of the sizes of friction takes the unknown's place
            change = (push + cut - paid) / inertia
            affine = [[form_of(each).with_known(CHANGE, change) for each in joint.felt]
                      for joint in rubbing]
            at_none, *columns = [[(x.coefficient(name), y.coefficient(name)) for x, y in affine]
                                 for name in (CONSTANT, *[joint.name for joint in rubbing])]
            laws = [joint.law for joint in rubbing]
            shares = joints.NEAR_SHARES if near else joints.SHARES[:None if rubbing.tilts else -1]
            sizes, locks, felt = joints.solved(n, laws, at_none, columns, shares, False, near)
            # at this acceleration the joints must be free as in a motion that is given: else the
            # loads that are published beside it are none, or of another torque
            with_change = [[form_of(each) for each in joint.felt] for joint in rubbing]
            locks = locks + joints.locked(n, laws, felt, [
                [(x.coefficient(joint.name), y.coefficient(joint.name)) for x, y in with_change]
                for joint in rubbing])
            largest = 0.0
            for joint, size, (x, y) in zip(rubbing, sizes, felt):
                friction = friction + paid.coefficient(joint.name) * size
                largest = largest + n.fabs(x) + n.fabs(y)
            edges = [edge for joint, pair in zip(rubbing, felt) for edge in (joint.moving, *[
                force / (largest + TINY) for force in joint.edges(pair)])]
            friction = friction + locks     # NaN where joints lock, else 0
        return Resistance(friction - cut, friction, felt, edges)
    return resistance
