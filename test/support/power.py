# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""What a mechanism takes, from the motion of its bodies alone: no reaction is involved."""
from fourbar_ros import Applied
from fourbar_ros.mechanisms.curves import point_of
import numpy as np


def needed(mechanism, motion):
    """
    Return force, moment about O1 and power that the links need, and the sizes of their parts.

    Of power: the change of kinetic energy less the work of all loads.
    """
    force = moment = power = size_force = size_moment = size_power = 0.0
    for link, body in mechanism.bodies._asdict().items():
        at = mechanism.link_motion(motion, link)
        push = getattr(mechanism.external, link, Applied())
        g_x, g_y = mechanism.gravity
        x, y, v_x, v_y, a_x, a_y = point_of(at, body.cg_along, body.cg_across)
        inertial = x, y, v_x, v_y, body.mass * (a_x - g_x), body.mass * (a_y - g_y)
        x, y, v_x, v_y, _, _ = point_of(at, push.along, push.across)
        applied = x, y, v_x, v_y, -push.force_x, -push.force_y
        for x, y, v_x, v_y, f_x, f_y in (inertial, applied):
            force = force + f_x + 1j * f_y
            moment = moment + x * f_y - y * f_x
            power = power + v_x * f_x + v_y * f_y
            size_force = size_force + np.hypot(f_x, f_y)
            size_moment = size_moment + np.hypot(x, y) * np.hypot(f_x, f_y)
            size_power = size_power + np.hypot(v_x, v_y) * np.hypot(f_x, f_y)
        couple = body.inertia * at.alpha - push.couple
        moment, power = moment + couple, power + couple * at.omega
        size_moment, size_power = size_moment + abs(couple), size_power + abs(couple * at.omega)
    return force, moment, power, (size_force, size_moment, size_power)


def power(mechanism, position, rate, acceleration):
    """Return what the drive must give, and the size of its parts."""
    _, _, total, sizes = needed(mechanism, mechanism.motion(position, rate, acceleration))
    return total, sizes[2]
