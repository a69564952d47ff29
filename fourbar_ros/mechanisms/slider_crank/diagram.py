# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The picture of a slider-crank and its velocity and acceleration polygons."""
from __future__ import annotations

from typing import Any

from fourbar_ros.mechanisms.parts import around, Arrow, Bar, Block, Diagram, ORIGIN, total
from fourbar_ros.mechanisms.points import link_motion, point_motion
import numpy as np


def diagram(mechanism: Any, motion: Any) -> Diagram:
    """Return the :class:`Diagram` of one pose."""
    a, b = (point_motion(mechanism, motion, link, along).place
            for link, along in (('crank', mechanism.a1), ('output', 0.0)))
    return Diagram({'O_1': ORIGIN, 'A': a, 'B': b}, ('O_1',), (Bar(ORIGIN, a), Bar(a, b)),
                   (Block(b, np.array([1.0, 0.0]), is_guided=True),),
                   {'f41': 'O_1', 'f21': 'A', 'f32': 'B', 'f43': 'B'}, {'theta1': 'O_1'})


def velocity_polygon(mechanism: Any, motion: Any) -> list[Arrow]:
    """Return the arrows of V_B = V_A + V_B/A [m/s]."""
    v_a = point_motion(mechanism, motion, 'crank', mechanism.a1).velocity
    v_b = point_motion(mechanism, motion, 'coupler', mechanism.a2).velocity
    return [total(v_a, 'V_A'), total(v_b, 'V_B'), Arrow(v_a, v_b - v_a, 'V_{B/A}', False)]


def acceleration_polygon(mechanism: Any, motion: Any) -> list[Arrow]:
    """Return the arrows of A_B = A_A + A_B/A, with normal and tangential parts [m/s^2]."""
    crank, coupler = (link_motion(mechanism, motion, link) for link in ('crank', 'coupler'))
    a_a = point_motion(mechanism, motion, 'crank', mechanism.a1).acceleration
    a_b = point_motion(mechanism, motion, 'coupler', mechanism.a2).acceleration
    return [total(a_a, 'A_A'), *around(ORIGIN, crank, mechanism.a1 * crank.direction, 'A'),
            *around(a_a, coupler, mechanism.a2 * coupler.direction, 'B/A'), total(a_b, 'A_B')]
