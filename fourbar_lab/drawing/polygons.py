# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The velocity and acceleration polygon of a mechanism in one pose, as arrows."""
from collections.abc import Iterator, Mapping, Sequence
from math import hypot
import re
from typing import Any, NamedTuple

from fourbar_ros import InvertedSlider, Mechanism, point_motion, ScotchYoke
from fourbar_ros.machine import Machine
from fourbar_ros.mechanisms.curves import LinkMotion, PointMotion
from fourbar_ros.mechanisms.four_bars import FourBarLinks
from fourbar_ros.mechanisms.parts import GROUND, SLIDE
from fourbar_ros.mechanisms.picture import ORIGIN, X, Y
from fourbar_ros.numerics.arrays import Array
import numpy as np


class Arrow(NamedTuple):
    """One side of a velocity or acceleration polygon; a sum starts at the pole, parts chain up."""

    start: Array
    vector: Array
    label: str             # mathtext without dollars
    is_sum: bool


class AccelerationTerms(NamedTuple):
    """The five terms of Eq. (9) of the slides [m/s^2]; their sum is the acceleration of B."""

    of_origin: Array      # A_A
    relative: Array       # A_rel, seen in the moving frame
    tangential: Array     # alpha x r
    normal: Array         # omega x (omega x r)
    coriolis: Array       # 2 omega x V_rel


def acceleration_terms(a_a: Array, omega: float, alpha: float, r: Array, v_rel: Array = ORIGIN,
                       a_rel: Array = ORIGIN) -> AccelerationTerms:
    """
    Return the terms of the acceleration of B, seen from a frame that moves and turns.

    ``a_a`` is the acceleration of the origin A of the frame [m/s^2], omega [rad/s] and alpha
    [rad/s^2] turn it, r [m] leads from A to B, and ``v_rel`` [m/s] and ``a_rel`` [m/s^2] are
    velocity and acceleration of B as seen in it. Vectors along the axes of the ground.
    """
    return AccelerationTerms(a_a, a_rel, turned(alpha, r), -omega**2 * r,
                             turned(2.0 * omega, v_rel))


def turned(rate: float, r: Array) -> Array:
    """Return rate x r of a rate about z, counter-clockwise positive."""
    return rate * np.array([-r[1], r[0]])


def polygons_of(mechanism: Mechanism, motion: Any) -> tuple[list[Arrow], list[Arrow]]:
    """
    Return the arrows of the velocities [m/s] and accelerations [m/s^2]; the pole is the origin.

    Slides, Eq. (9): normal and tangential parts about a joint, and where a block slides on a link
    that turns, the Coriolis and the relative acceleration.
    """
    if isinstance(mechanism, Machine):
        return _of_machine(mechanism, motion)
    kind: Any = mechanism           # whose lengths have names
    a = point_motion(kind, motion, 'crank', kind.a1)
    crank = kind.link_motion(motion, 'crank')
    velocities = [total(a.velocity, 'V_A')]
    accelerations = [total(a.acceleration, 'A_A'),
                     *around(ORIGIN, crank, kind.a1 * crank.direction, 'A')]
    if isinstance(kind, InvertedSlider):
        # V_A = V_Q + V_rel and A_A = A_Q + A_Cor + A_rel, with Q the point of the bar at A
        output = kind.link_motion(motion, 'output')
        v_q = point_motion(kind, motion, 'output', motion.slide, kind.offset).velocity
        v_rel = motion.slide_velocity * output.direction
        a_rel = motion.slide_acceleration * output.direction
        arm = motion.slide * output.direction + kind.offset * turned(1.0, output.direction)
        terms = acceleration_terms(ORIGIN, output.omega, output.alpha, arm, v_rel, a_rel)
        a_q = terms.normal + terms.tangential
        velocities += [total(v_q, 'V_Q'), *chain(v_q, (v_rel, 'V_{rel}'))]
        accelerations += [*around(ORIGIN, output, arm, 'Q'), total(a_q, 'A_Q'),
                          *chain(a_q, (terms.coriolis, 'A_{Cor}'), (a_rel, 'A_{rel}'))]
    elif isinstance(kind, ScotchYoke):
        # V_A = V_B + V_rel and A_A = A_B + A_rel along guide and slot, which do not turn
        v_b, a_b = motion.slide_velocity * X, motion.slide_acceleration * X
        velocities += [total(v_b, 'V_B'), *chain(v_b, (motion.slot_velocity * Y, 'V_{rel}'))]
        accelerations += [total(a_b, 'A_B'),
                          *chain(a_b, (motion.slot_acceleration * Y, 'A_{rel}'))]
    else:
        coupler = kind.link_motion(motion, 'coupler')
        b = point_motion(kind, motion, 'coupler', kind.a2)
        velocities += [total(b.velocity, 'V_B'),
                       *chain(a.velocity, (b.velocity - a.velocity, 'V_{B/A}'))]
        accelerations += [*around(a.acceleration, coupler, kind.a2 * coupler.direction, 'B/A'),
                          total(b.acceleration, 'A_B')]
        if isinstance(kind, FourBarLinks):          # B turns about O4
            output = kind.link_motion(motion, 'output')
            accelerations += around(ORIGIN, output, kind.a3 * output.direction, 'B')
    return velocities, accelerations


def _of_machine(machine: Machine, motion: Any) -> tuple[list[Arrow], list[Arrow]]:
    """Return whole velocities and accelerations, parts of them at joints on the crank alone."""
    velocities, accelerations = list[Arrow](), list[Arrow]()
    has_crank = machine.layout.ground == 0 and machine.input != SLIDE
    for name, link, joint in _moving_joints(machine, motion):
        velocities.append(total(joint.velocity, f'V_{{{name}}}'))
        accelerations.append(total(joint.acceleration, f'A_{{{name}}}'))
        if has_crank and link == machine.layout.driven:
            accelerations += around(ORIGIN, machine.link_motion(motion, link), joint.place, name)
    return velocities, accelerations


def _moving_joints(machine: Machine, motion: Any) -> Iterator[tuple[str, str, PointMotion]]:
    """Yield (name, a link that has it, its motion) of the joints of a machine that move."""
    for stage, dyad in zip(machine.layout.stages, machine.stages):
        pins = {name for name, *_ in stage.pins()}
        for name, point in ((f'{stage.name}_first', dyad.first),
                            (f'{stage.name}_second', dyad.second)):
            if name in pins and point.link != GROUND:
                yield name, point.link, point_motion(machine, motion, *point)
        name, (first, second) = f'{stage.name}_inner', stage.links
        if stage.kind == 'RRR':             # at the end of its first link
            if GROUND not in (first, second):
                assert dyad.length_1 is not None
                yield name, first, point_motion(machine, motion, first, dyad.length_1)
        elif stage.kind == 'RPP':           # the yoke, which slides at both
            yield f'{stage.name}_second', second, point_motion(machine, motion, second, 0.0)
        elif stage.kind != 'RPR' and second != GROUND:      # whose block has the pin first
            yield name, second, point_motion(machine, motion, second, 0.0)


# --- arrows --------------------------------------------------------------------------------------

def sides_of(arrows: Sequence[Arrow], names: Mapping[str, str], least: float) -> list[Arrow]:
    """
    Return the sides of a polygon to draw: above a length, with other letters, none twice.

    Joints at one point have one letter: of equal labels the first is drawn. At zero alpha the
    normal part of an acceleration is all of it: one arrow with two labels, so the sum is drawn.
    """
    named: dict[tuple[str, bool], Arrow] = {}
    for arrow in arrows:
        label = renamed(arrow.label, names)
        if hypot(*arrow.vector) > least:
            named.setdefault((label, arrow.is_sum), arrow._replace(label=label))
    sums = [arrow for arrow in named.values() if arrow.is_sum]
    return [arrow for arrow in named.values() if arrow.is_sum or not any(
        max(abs(arrow.vector - whole.vector)) <= least
        and max(abs(arrow.start - whole.start)) <= least for whole in sums)]


def renamed(label: str, names: Mapping[str, str]) -> str:
    """Return a label with other letters for points: 'v_{B/A}' by {'A': 'P'} is 'v_{B/P}'."""
    def replace(match: re.Match[str]) -> str:
        letters = [names.get(letter, letter) for letter in match[1].strip('{}').split('/')]
        return f'_{{{"/".join(letters)}}}'
    if label in names:
        return names[label]
    return re.sub(r'_(\{[^}]*\}|\w)', replace, label) if names else label


def total(vector: Array, label: str) -> Arrow:
    return Arrow(ORIGIN, vector, label, True)


def chain(start: Array, *steps: tuple[Array, str]) -> list[Arrow]:
    """Return arrows of (vector, label), each starting where the one before ends."""
    arrows = []
    for vector, label in steps:
        arrows.append(Arrow(start, vector, label, False))
        start = start + vector
    return arrows


def around(start: Array, link: LinkMotion, arm: Array, name: str) -> list[Arrow]:
    """
    Return the arrows omega x (omega x arm) and alpha x arm, labelled A_name^n and A_name^t.

    They are the acceleration of a point of a link relative to another one, ``arm`` [m] away;
    ``start`` is the tip of that one's arrow [m/s^2].
    """
    terms = acceleration_terms(ORIGIN, link.omega, link.alpha, arm)
    return chain(start, (terms.normal, f'A_{{{name}}}^n'), (terms.tangential, f'A_{{{name}}}^t'))
