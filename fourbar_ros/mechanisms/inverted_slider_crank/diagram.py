# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Picture and velocity and acceleration polygons of an inverted slider-crank."""
from __future__ import annotations

from typing import Any

from fourbar_ros.mechanics.moving_frames import acceleration_terms, turned
from fourbar_ros.mechanisms.parts import around, Arrow, Bar, Block, chain, Diagram, ORIGIN, total
from fourbar_ros.mechanisms.points import link_motion, point_motion
import numpy as np

BEYOND = 0.14      # length of the bar beyond its block, over the size of the mechanism


def diagram(mechanism: Any, motion: Any) -> Diagram:
    """
    Return the :class:`Diagram` of one pose.

    A bar with its block, or a cylinder with its rod.
    """
    a = point_motion(mechanism, motion, 'crank', mechanism.a1).place
    o4 = point_motion(mechanism, motion, 'output', 0.0).place
    bar = link_motion(mechanism, motion, 'output').direction
    foot, sense = a - motion.slide * bar, np.sign(motion.slide) * bar
    bars, blocks = [Bar(ORIGIN, a), Bar(o4, foot)], []
    if mechanism.is_driven_by_slide:        # a cylinder: the tube from O4, the rod out of it to A
        tube = foot + min(_tube(mechanism), 0.98 * abs(motion.slide)) * sense
        bars += [Bar(foot, a, 0.7), Bar(foot, tube, 2.4)]
    else:
        size = max(np.ptp(np.array([ORIGIN, a, o4]), axis=0))
        bars.append(Bar(foot, a + BEYOND * size * sense))
        blocks.append(Block(a, bar))
    return Diagram({'O_1': ORIGIN, 'A': a, 'O_4': o4}, ('O_1', 'O_4'), tuple(bars), tuple(blocks),
                   {'f41': 'O_1', 'f21': 'A', 'f32': 'A', 'f43': 'O_4'},
                   {'theta1': 'O_1', 'theta4': 'O_4'}, drawn_whole=('output',))


def _tube(mechanism: Any) -> float:
    """
    Return the length of the tube of a cylinder.

    Its rod is in at the shortest, or half the longest.
    """
    low, high = sorted(map(abs, mechanism.input_ranges[-1]))
    return max(0.9 * low, 0.45 * high)


def velocity_polygon(mechanism: Any, motion: Any) -> list[Arrow]:
    """Return the arrows of V_A = V_Q + V_rel, Q of the bar at A [m/s]."""
    output = link_motion(mechanism, motion, 'output')
    v_a = point_motion(mechanism, motion, 'crank', mechanism.a1).velocity
    v_q = point_motion(mechanism, motion, 'output', motion.slide, mechanism.offset).velocity
    return [total(v_a, 'V_A'), total(v_q, 'V_Q'),
            Arrow(v_q, motion.slide_velocity * output.direction, 'V_{rel}', False)]


def acceleration_polygon(mechanism: Any, motion: Any) -> list[Arrow]:
    """Return the arrows of A_A = A_Q + A_Cor + A_rel, Eq. (9), Q of the bar at A [m/s^2]."""
    crank, output = (link_motion(mechanism, motion, link) for link in ('crank', 'output'))
    a_a = point_motion(mechanism, motion, 'crank', mechanism.a1).acceleration
    arm = motion.slide * output.direction + mechanism.offset * turned(1.0, output.direction)
    relative = motion.slide_acceleration * output.direction
    terms = acceleration_terms(ORIGIN, output.omega, output.alpha, arm,
                               motion.slide_velocity * output.direction, relative)
    a_q = terms.normal + terms.tangential
    return [total(a_a, 'A_A'), *around(ORIGIN, crank, mechanism.a1 * crank.direction, 'A'),
            *around(ORIGIN, output, arm, 'Q'), total(a_q, 'A_Q'),
            *chain(a_q, (terms.coriolis, 'A_{Cor}'), (relative, 'A_{rel}'))]
