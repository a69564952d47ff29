# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The picture of a Scotch yoke and its velocity and acceleration polygons."""
from __future__ import annotations

from typing import Any

from fourbar_ros.mechanisms.parts import around, Arrow, Bar, Block, chain, Diagram, ORIGIN, total
from fourbar_ros.mechanisms.points import link_motion, point_motion
import numpy as np

X, Y = np.array([1.0, 0.0]), np.array([0.0, 1.0])


def diagram(mechanism: Any, motion: Any) -> Diagram:
    """
    Return the :class:`Diagram` of one pose.

    The slot reaches over the whole travel of the block.
    """
    a, b = (point_motion(mechanism, motion, link, along).place
            for link, along in (('crank', mechanism.a1), ('output', 0.0)))
    low, high = (b + (end - mechanism.offset) * Y
                 for end in (-1.1 * mechanism.a1, 1.1 * mechanism.a1))
    ends = min((low, b, high), key=lambda at: at[1]), max((low, b, high), key=lambda at: at[1])
    return Diagram({'O_1': ORIGIN, 'A': a, 'B': b}, ('O_1',), (Bar(*ends), Bar(ORIGIN, a)),
                   (Block(b, X, is_guided=True), Block(a, Y)),
                   {'f41': 'O_1', 'f21': 'A', 'f32': 'A', 'f43': 'B'}, {'theta1': 'O_1'})


def velocity_polygon(mechanism: Any, motion: Any) -> list[Arrow]:
    """Return the arrows of V_A = V_B + V_rel, along guide and slot [m/s]."""
    v_a = point_motion(mechanism, motion, 'crank', mechanism.a1).velocity
    v_b = motion.slide_velocity * X
    return [total(v_a, 'V_A'), total(v_b, 'V_B'),
            *chain(v_b, (motion.slot_velocity * Y, 'V_{rel}'))]


def acceleration_polygon(mechanism: Any, motion: Any) -> list[Arrow]:
    """
    Return the arrows of A_A = A_B + A_rel.

    The slot does not turn, so there is no Coriolis term [m/s^2].
    """
    crank = link_motion(mechanism, motion, 'crank')
    a_a = point_motion(mechanism, motion, 'crank', mechanism.a1).acceleration
    a_b = motion.slide_acceleration * X
    return [total(a_a, 'A_A'), *around(ORIGIN, crank, mechanism.a1 * crank.direction, 'A'),
            total(a_b, 'A_B'), *chain(a_b, (motion.slot_acceleration * Y, 'A_{rel}'))]
