# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The picture of a 4R linkage and its velocity and acceleration polygons."""
from __future__ import annotations

from typing import Any

from fourbar_ros.mechanisms.parts import around, Arrow, Bar, Diagram, ORIGIN, total
from fourbar_ros.mechanisms.points import link_motion, point_motion


def diagram(linkage: Any, motion: Any) -> Diagram:
    """Return the :class:`Diagram` of one pose."""
    joints = {'O_1': ORIGIN, 'A': point_motion(linkage, motion, 'crank', linkage.a1).place,
              'B': point_motion(linkage, motion, 'output', linkage.a3).place,
              'O_4': point_motion(linkage, motion, 'output', 0.0).place}
    bars = tuple(Bar(joints[one], joints[other])
                 for one, other in (('O_1', 'A'), ('A', 'B'), ('O_4', 'B')))
    return Diagram(joints, ('O_1', 'O_4'), bars, (), {'f41': 'O_1', 'f21': 'A', 'f32': 'B',
                                                      'f43': 'O_4'},
                   {'theta1': 'O_1', 'theta4': 'O_4'})


def velocity_polygon(linkage: Any, motion: Any) -> list[Arrow]:
    """Return the arrows of V_B = V_A + V_B/A [m/s]."""
    v_a = point_motion(linkage, motion, 'crank', linkage.a1).velocity
    v_b = point_motion(linkage, motion, 'coupler', linkage.a2).velocity
    return [total(v_a, 'V_A'), total(v_b, 'V_B'), Arrow(v_a, v_b - v_a, 'V_{B/A}', False)]


def acceleration_polygon(linkage: Any, motion: Any) -> list[Arrow]:
    """Return the arrows of A_B = A_A + A_B/A, each in its normal and tangential part [m/s^2]."""
    crank, coupler, output = (link_motion(linkage, motion, link)
                              for link in ('crank', 'coupler', 'output'))
    a_a = point_motion(linkage, motion, 'crank', linkage.a1).acceleration
    a_b = point_motion(linkage, motion, 'coupler', linkage.a2).acceleration
    return [total(a_a, 'A_A'), *around(ORIGIN, crank, linkage.a1 * crank.direction, 'A'),
            *around(a_a, coupler, linkage.a2 * coupler.direction, 'B/A'), total(a_b, 'A_B'),
            *around(ORIGIN, output, linkage.a3 * output.direction, 'B')]
