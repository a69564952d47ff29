"""Velocity and acceleration polygons of all mechanisms, as lists of arrows from the pole at the origin."""
from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fourbar_ros.mechanics.moving_frames import acceleration_terms, turned
from fourbar_ros.mechanisms.inverted_slider_crank.inverted_slider_crank import InvertedSlider
from fourbar_ros.mechanisms.points import link_motion, point_motion
from fourbar_ros.mechanisms.slider_crank.slider_crank import SliderCrank

O1 = np.zeros(2)      # also the pole


class Arrow(NamedTuple):
    """One side of a polygon: from ``start`` by ``vector``; parts add up to sums, which start at the pole."""

    start: np.ndarray
    vector: np.ndarray
    label: str             # mathtext without dollars
    is_sum: bool


def _chain(start, *steps):
    """Return the arrows of a chain of (vector, label): each starts where the one before ends."""
    arrows = []
    for vector, label in steps:
        arrows.append(Arrow(start, vector, label, False))
        start = start + vector
    return arrows


def velocity_polygon(mechanism, motion):
    """Return the list of :class:`Arrow` of the velocities [m/s]; the pole is the origin."""
    v_a = point_motion(mechanism, motion, 'crank', mechanism.a1).velocity
    if isinstance(mechanism, InvertedSlider):
        output = link_motion(mechanism, motion, 'output')
        v_q = point_motion(mechanism, motion, 'output', motion.slide, mechanism.offset).velocity
        return [Arrow(O1, v_a, 'V_A', True), Arrow(O1, v_q, 'V_Q', True),
                Arrow(v_q, motion.slide_velocity * output.direction, 'V_{rel}', False)]
    v_b = point_motion(mechanism, motion, 'coupler', mechanism.a2).velocity
    return [Arrow(O1, v_a, 'V_A', True), Arrow(O1, v_b, 'V_B', True), Arrow(v_a, v_b - v_a, 'V_{B/A}', False)]


def acceleration_polygon(mechanism, motion):
    """Return the list of :class:`Arrow` of the accelerations [m/s^2]; the pole is the origin."""
    crank, coupler, output = (link_motion(mechanism, motion, link) for link in ('crank', 'coupler', 'output'))
    a_a = point_motion(mechanism, motion, 'crank', mechanism.a1).acceleration
    arrows = [Arrow(O1, a_a, 'A_A', True), *_around(O1, crank, mechanism.a1 * crank.direction, 'A')]
    if isinstance(mechanism, InvertedSlider):
        arm = motion.slide * output.direction + mechanism.offset * turned(1.0, output.direction)
        relative = motion.slide_acceleration * output.direction
        terms = acceleration_terms(O1, output.omega, output.alpha, arm,
                                   motion.slide_velocity * output.direction, relative)
        a_q = terms.normal + terms.tangential
        return arrows + [*_around(O1, output, arm, 'Q'), Arrow(O1, a_q, 'A_Q', True),
                         *_chain(a_q, (terms.coriolis, 'A_{Cor}'), (relative, 'A_{rel}'))]
    a_b = point_motion(mechanism, motion, 'coupler', mechanism.a2).acceleration
    arrows += [*_around(a_a, coupler, mechanism.a2 * coupler.direction, 'B/A'), Arrow(O1, a_b, 'A_B', True)]
    if not isinstance(mechanism, SliderCrank):
        arrows += _around(O1, output, mechanism.a3 * output.direction, 'B')
    return arrows


def _around(start, link, arm, name):
    """Return the normal and the tangential arrow of a point that is ``arm`` from another of its link."""
    terms = acceleration_terms(O1, link.omega, link.alpha, arm)
    return _chain(start, (terms.normal, f'A_{{{name}}}^n'), (terms.tangential, f'A_{{{name}}}^t'))
