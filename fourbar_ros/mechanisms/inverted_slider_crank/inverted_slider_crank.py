# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The inverted slider-crank RPR with offset: rocking block, oscillating cylinder.

Its parts, range of motion and drawing; the formulas are in :mod:`.motion`, :mod:`.loads`.
"""
from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import atan2, atanh, pi, sqrt
from typing import NamedTuple

from fourbar_ros.mechanics.bodies import Bodies, External
from fourbar_ros.mechanics.moving_frames import acceleration_terms, turned
from fourbar_ros.mechanisms.contract import Constants, CRANK, of_geometry, OPEN, SLIDE
from fourbar_ros.mechanisms.inverted_slider_crank.loads import make_loads
from fourbar_ros.mechanisms.inverted_slider_crank.motion import (
    InvertedSliderMotion,
    make_crank_motion,
    make_slide_motion,
)
from fourbar_ros.mechanisms.kinds import FACTS
from fourbar_ros.mechanisms.loads import derives
from fourbar_ros.mechanisms.parts import (
    around,
    Arrow,
    Bar,
    Block,
    chain,
    Connection,
    Diagram,
    GROUND,
    NamedFields,
    ORIGIN,
    Output,
    Ranges,
    reaction,
    THETA1,
    THETA2,
    THETA4,
    total,
    TRAVEL,
)
from fourbar_ros.mechanisms.points import (
    crank_motion,
    Curve,
    link_motion,
    LinkMotion,
    point_motion,
    point_of,
)
from fourbar_ros.mechanisms.slide_dyad import OffsetSlide, reach, singular_slides, slide_ranges
from fourbar_ros.numerics.arrays import EPS
from fourbar_ros.numerics.exact_sums import difference_of_squares, scaled
from fourbar_ros.numerics.number_types import Function, NumberType, Scalar
import numpy as np


class InvertedDeadPoint(NamedTuple):
    """Crank square to the bar: the bar turns back."""

    theta1: float     # [rad]
    theta4: float     # [rad]


BEYOND = 0.14      # length of the bar drawn beyond its block, over the size of the mechanism


@dataclass(frozen=True)
class InvertedSlider(OffsetSlide):
    """
    Inverted slider-crank: a block pinned to the crank at A slides on a bar that turns about O4.

    With a driven slide it is the oscillating cylinder (of every excavator): block = piston with
    its rod, bar = tube, crank = boom.

    Parameters
    ----------
    a1, a4 : float
        Lengths of crank and ground [m], positive.
    offset : float
        Distance of the path of A from O4, to the left of the bar [m], shorter than a1 + a4.
    mode : int
        Assembly mode. Crank input: 2 has slide > 0 (bar points from O4 towards A), 1 has slide <
        0.
        Slide input: 2 has sin(theta1) > 0 (A to the left of O1-O4), 1 < 0.
    input : str
        'crank' or 'slide': the driven coordinate, theta1 or slide.
    bodies : Bodies, optional
        Crank from O1, block (``coupler``) from A along the bar, bar (``output``) from O4 along
        itself.
    gravity : tuple of 2 floats
        Field of gravity (x, y) [m/s^2].
    external : External
        Forces and couples on block (``coupler``) and bar (``output``).
    stroke : tuple of 2 floats, optional
        Shortest and longest slide [m] of a driven slide, as a cylinder has; not given: all where
        the links close.

    Guide force: of the bar on the block, + to the left of the bar; guide couple: of the bar on the
    block about A. The driving force pushes the block along the bar as ``slide`` grows, and the bar
    back.

    Raises
    ------
    InvalidParameter
        Naming the parameter, its value and the allowed values.

    """

    a1: float
    a4: float
    offset: float = 0.0
    mode: int = OPEN
    input: str = CRANK
    bodies: Bodies | None = None
    gravity: tuple[float, float] = (0.0, 0.0)
    external: External = External()
    stroke: tuple[float, float] | None = None

    TITLE = 'inverted slider-crank'
    TEXT, LENGTHS, LINKS, JOINTS = FACTS['inverted_slider'][:4]
    OUTPUTS = {CRANK: (Output(THETA4, 'output_ratio'),), SLIDE: (Output(THETA1, 'crank_ratio'),)}
    REACTIONS = (reaction('O1', 'ground on crank', 'f41'), reaction('A', 'block on crank', 'f21'),
                 reaction('slide', 'bar on block', 'f32', 'guide_couple'),
                 reaction('O4', 'ground on bar', 'f43'))
    PARTS = {THETA1: 'crank', THETA2: 'block to crank', THETA4: 'bar', TRAVEL: 'block on the bar'}
    SLIDE_DIRECTION = ('cos_y', 'sin_y')
    DRAWN = (THETA1, THETA4, TRAVEL)
    MOTION = InvertedSliderMotion
    BODIES, EXTERNAL = Bodies, External

    @property
    def classification(self) -> str:
        """Return the type: crank and bar turn fully, or only the crank, or neither."""
        if 0.0 in self.margins:
            return 'change point'
        rocks, turns = self.margins
        return ('Grashof crank-rocker' if rocks > 0.0 else
                'Grashof double-crank' if turns > 0.0 else 'non-Grashof double-rocker')

    @of_geometry
    def closing_ranges(self) -> Ranges:
        """
        Return the ranges of theta1 [rad] or slide [m] in which the links close, from low to high.

        For a crank that turns fully (-pi, pi), else one range through pi. At an end that is no
        full turn A is at the foot of O4 (crank input), or crank and ground in line (slide input):
        a toggle.
        """
        if self.input == SLIDE:
            return slide_ranges(self.a4, self.a1, self.offset)
        near, far = reach(*scaled(self.lengths))
        if near >= 0.0:
            return ((-pi, pi),)
        low = 2.0 * atan2(sqrt(-near), sqrt(far))
        return ((low, 2.0 * pi - low),)

    @property
    def singular_inputs(self) -> list[complex]:
        """
        Return the complex inputs where the dyad is in line or A meets O4.

        For a driven crank l = 0 and q = 0 of (B1), both linear in tan^2(theta1/2).
        """
        if self.input == SLIDE:
            return singular_slides(self.a4, self.a1, self.offset)
        a1, a4, _ = scaled(self.lengths)
        near, far = reach(*scaled(self.lengths))
        pole = complex(0.0, 2.0 * atanh(min(abs(a1 - a4) / (a1 + a4), 1.0 - EPS)))
        if near > 0.0:
            return [complex(0.0, 2.0 * atanh(min(sqrt(near / far), 1.0 - EPS))), pole]
        angle = 2.0 * atan2(sqrt(-near), sqrt(far))
        return [complex(angle), complex(-angle), pole]

    @property
    def dead_points(self) -> tuple[InvertedDeadPoint, ...]:
        """Return up to two poses where the bar of a driven crank turns back in this mode."""
        points, (a1, a4, h) = [], scaled(self.lengths)
        for side in (1.0, -1.0):                       # A = +-i a1 e^{iy}
            rise = h - side * a1        # a4 sin y
            run = difference_of_squares(a4, 0.0, h, -side * a1)
            if run > 0.0 and self.input == CRANK:
                cosine, sine = -self.sign * sqrt(run), rise
                points.append(InvertedDeadPoint(atan2(side * cosine, -side * sine),
                                                atan2(sine, cosine)))
        return tuple(sorted(points))

    def motion_formula(self, numbers: NumberType, constants: Constants) -> Function:
        """Return (position, rate, acceleration) -> fields of MOTION for a number type."""
        make = make_crank_motion if self.input == CRANK else make_slide_motion
        a1, a4, h = constants.lengths
        return make(numbers, a1, a4, h, constants.sign)

    @derives
    def loads_formula(self, numbers: NumberType, constants: Constants) -> Function:
        """Return (fields of MOTION) -> fields of LOADS for constants of a number type."""
        a1, a4, h = constants.lengths
        return make_loads(numbers, a1, a4, h, self.input == CRANK, constants.bodies,
                          constants.gravity, constants.external)

    @property
    def connections(self) -> tuple[Connection, ...]:
        """Return which links the four joints connect."""
        return (Connection(GROUND, 'crank'), Connection('crank', 'coupler', (self.a1, 0.0)),
                Connection('output', 'coupler', (0.0, self.offset), axis=(1.0, 0.0)),
                Connection(GROUND, 'output', (self.a4, 0.0)))

    def link_motion(self, motion: NamedFields, link: str) -> LinkMotion:
        """Return the motion of a link by name; block and bar turn together."""
        if link == 'output':
            return LinkMotion(self.a4, 0.0, 0.0, 0.0, 0.0, 0.0, motion.cos_y, motion.sin_y,
                              motion.omega4, motion.alpha4)
        crank = crank_motion(motion)
        if link == 'crank':
            return crank
        return LinkMotion(*point_of(crank, self.a1), motion.cos_y, motion.sin_y,
                          motion.omega4, motion.alpha4)

    def read_coordinate(self, numbers: NumberType,
                        curves: Sequence[Curve]) -> tuple[Scalar, Scalar, Scalar]:
        """Return the input and its two derivatives from coefficients of the links."""
        if not self.is_driven_by_slide:
            return super().read_coordinate(numbers, curves)
        # the slide is the part of O4-A along the bar, which turns
        x, y, d_x, d_y, dd_x, dd_y, cosine, sine, turn, bend = curves[1]
        x = x - self.a4
        along, across = x * cosine + y * sine, y * cosine - x * sine
        d_along, d_across = d_x * cosine + d_y * sine, d_y * cosine - d_x * sine
        return (along, d_along + turn * across,
                dd_x * cosine + dd_y * sine + 2.0 * turn * d_across + bend * across
                - turn * turn * along)

    def transmission_sine(self, motion: NamedFields) -> Scalar:
        """Return slide / |A O4|, or of a driven slide a4 sin(theta1) / |A O4|: zero at toggles."""
        size = max(map(abs, self.lengths))
        slide, aside = motion.slide / size, self.offset / size
        opposite = slide if self.input == CRANK else self.a4 / size * motion.sin_x
        found: Scalar = opposite / (slide * slide + aside * aside)**0.5
        return found

    def corners(self, motion: NamedFields) -> tuple[tuple[Scalar, Scalar, float], ...]:
        """Return O1, A, B, O4, each as (x w, y w, w); B is at infinity, square to the bar."""
        if self.is_driven_by_slide:
            return ()
        return ((0.0, 0.0, 1.0),
                (self.a1 * np.cos(motion.theta1), self.a1 * np.sin(motion.theta1), 1.0),
                (-np.sin(motion.theta4), np.cos(motion.theta4), 0.0), (self.a4, 0.0, 1.0))

    def diagram(self, motion: NamedFields) -> Diagram:
        """Return the picture of one pose: a bar with its block, or a cylinder with its rod."""
        a = point_motion(self, motion, 'crank', self.a1).place
        o4 = point_motion(self, motion, 'output', 0.0).place
        bar = link_motion(self, motion, 'output').direction
        foot, sense = a - motion.slide * bar, np.sign(motion.slide) * bar
        bars, blocks = [Bar(ORIGIN, a), Bar(o4, foot)], []
        if self.is_driven_by_slide:        # a cylinder: the tube from O4, the rod out of it to A
            low, high = sorted(map(abs, self.input_ranges[-1]))
            tube = max(0.9 * low, 0.45 * high)      # as long as it can be with the rod in
            end = foot + min(tube, 0.98 * abs(motion.slide)) * sense
            bars += [Bar(foot, a, 0.7), Bar(foot, end, 2.4)]
        else:
            size = max(np.ptp(np.array([ORIGIN, a, o4]), axis=0))
            bars.append(Bar(foot, a + BEYOND * size * sense))
            blocks.append(Block(a, bar))
        return Diagram({'O_1': ORIGIN, 'A': a, 'O_4': o4}, ('O_1', 'O_4'), tuple(bars),
                       tuple(blocks), {'f41': 'O_1', 'f21': 'A', 'f32': 'A', 'f43': 'O_4'},
                       {'theta1': 'O_1', 'theta4': 'O_4'}, drawn_whole=('output',))

    def velocity_polygon(self, motion: NamedFields) -> list[Arrow]:
        """Return the arrows of V_A = V_Q + V_rel, Q of the bar at A [m/s]."""
        output = link_motion(self, motion, 'output')
        v_a = point_motion(self, motion, 'crank', self.a1).velocity
        v_q = point_motion(self, motion, 'output', motion.slide, self.offset).velocity
        return [total(v_a, 'V_A'), total(v_q, 'V_Q'),
                Arrow(v_q, motion.slide_velocity * output.direction, 'V_{rel}', False)]

    def acceleration_polygon(self, motion: NamedFields) -> list[Arrow]:
        """Return the arrows of A_A = A_Q + A_Cor + A_rel, Eq. (9), Q of the bar at A [m/s^2]."""
        crank, output = (link_motion(self, motion, link) for link in ('crank', 'output'))
        a_a = point_motion(self, motion, 'crank', self.a1).acceleration
        arm = motion.slide * output.direction + self.offset * turned(1.0, output.direction)
        relative = motion.slide_acceleration * output.direction
        terms = acceleration_terms(ORIGIN, output.omega, output.alpha, arm,
                                   motion.slide_velocity * output.direction, relative)
        a_q = terms.normal + terms.tangential
        return [total(a_a, 'A_A'), *around(ORIGIN, crank, self.a1 * crank.direction, 'A'),
                *around(ORIGIN, output, arm, 'Q'), total(a_q, 'A_Q'),
                *chain(a_q, (terms.coriolis, 'A_{Cor}'), (relative, 'A_{rel}'))]
