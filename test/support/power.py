# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Power that a mechanism takes, from the motion of its bodies alone: no reaction is involved."""
from fourbar_ros.mechanisms.points import point_motion


def power(mechanism, position, rate, acceleration):
    """Return what the drive must give: change of kinetic energy less the work of all loads."""
    motion, total, size = mechanism.motion(position, rate, acceleration), 0.0, 0.0
    for link, (body, applied) in mechanism.loads_of_links().items():
        its = mechanism.link_motion(motion, link)
        centre = point_motion(mechanism, motion, link, body.cg_along, body.cg_across)
        at = point_motion(mechanism, motion, link, applied.along, applied.across)
        parts = (body.mass * (centre.acceleration_x - mechanism.gravity[0]) * centre.velocity_x,
                 body.mass * (centre.acceleration_y - mechanism.gravity[1]) * centre.velocity_y,
                 body.inertia * its.alpha * its.omega, -applied.couple * its.omega,
                 -applied.force_x * at.velocity_x, -applied.force_y * at.velocity_y)
        total, size = total + sum(parts), size + sum(map(abs, parts))
    return total, size
