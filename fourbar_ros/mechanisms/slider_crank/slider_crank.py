# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The slider-crank RRRP with offset, driven by its crank or by its slider.

Its parts, range of motion and drawing; the formulas are in :mod:`.motion`, :mod:`.loads`.
"""
from __future__ import annotations

from dataclasses import dataclass
from math import asin, atan2, fsum, log1p, pi, sqrt
from typing import NamedTuple

from fourbar_ros.mechanics.bodies import Bodies, External
from fourbar_ros.mechanisms.contract import Constants, CRANK, of_geometry, OPEN, SLIDE
from fourbar_ros.mechanisms.kinds import FACTS
from fourbar_ros.mechanisms.loads import derives
from fourbar_ros.mechanisms.parts import (
    around,
    Arrow,
    Bar,
    BETA,
    Block,
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
    THETA3,
    total,
    TRAVEL,
)
from fourbar_ros.mechanisms.points import (
    crank_motion,
    link_motion,
    LinkMotion,
    point_motion,
    point_of,
)
from fourbar_ros.mechanisms.slide_dyad import OffsetSlide, reach, singular_slides, slide_ranges
from fourbar_ros.mechanisms.slider_crank.loads import make_loads
from fourbar_ros.mechanisms.slider_crank.motion import (
    make_crank_motion,
    make_slider_motion,
    SliderCrankMotion,
)
from fourbar_ros.numerics.exact_sums import scaled
from fourbar_ros.numerics.number_types import Function, NumberType, power_of_two, Scalar
import numpy as np


class SliderDeadPoint(NamedTuple):
    """Crank and coupler in line, stretched or folded: the slider turns back."""

    theta1: float     # [rad]
    slide: float      # [m]
    stretched: bool


@dataclass(frozen=True)
class SliderCrank(OffsetSlide):
    """
    Slider-crank O1-A-B whose pin B slides along y = offset.

    Parameters
    ----------
    a1, a2 : float
        Lengths of crank and coupler [m], positive.
    offset : float
        y of the guide [m], shorter than a1 + a2.
    mode : int
        Assembly mode. Crank input: 2 has cos(beta) > 0 (slider ahead of A), 1 has cos(beta) < 0.
        Slider input: 2 has sin(theta2) > 0 (from O1 over A to B one turns left), 1 < 0.
    input : str
        'crank' or 'slide': the driven coordinate, theta1 or slide.
    bodies : Bodies, optional
        Crank from O1, coupler from A, slider (``output``) from B along x.
    gravity : tuple of 2 floats
        Field of gravity (x, y) [m/s^2].
    external : External
        Forces and couples on coupler and slider (``output``), as gas forces.
    stroke : tuple of 2 floats, optional
        Shortest and longest slide [m] of a driven slide, as a cylinder has; not given: all where
        the links close.

    Guide force: of the ground on the slider, + along y; guide couple: of the ground on the slider
    about B.

    Raises
    ------
    InvalidParameter
        Naming the parameter, its value and the allowed values.

    """

    a1: float
    a2: float
    offset: float = 0.0
    mode: int = OPEN
    input: str = CRANK
    bodies: Bodies | None = None
    gravity: tuple[float, float] = (0.0, 0.0)
    external: External = External()
    stroke: tuple[float, float] | None = None

    TITLE = 'slider-crank'
    TEXT, LENGTHS, LINKS, JOINTS = FACTS['slider_crank'][:4]
    OUTPUTS = {CRANK: (Output(TRAVEL, 'slide_ratio'),), SLIDE: (Output(THETA1, 'crank_ratio'),)}
    REACTIONS = (reaction('O1', 'ground on crank', 'f41'),
                 reaction('A', 'coupler on crank', 'f21'),
                 reaction('B', 'slider on coupler', 'f32'),
                 reaction('guide', 'guide on slider', 'f43', 'guide_couple'))
    PARTS = {THETA1: 'crank', THETA2: 'coupler to crank', THETA3: 'slider to coupler',
             BETA: 'coupler', TRAVEL: 'slider'}
    DRAWN = (THETA1, BETA, TRAVEL)
    MOTION = SliderCrankMotion
    BODIES, EXTERNAL = Bodies, External

    @property
    def classification(self) -> str:
        """Return the type: whose full turns there are, the crank's, the coupler's or nobody's."""
        if 0.0 in self.margins:
            return 'change point'
        crank, coupler = self.margins
        return ('Grashof crank-slider' if crank > 0.0 else
                'Grashof rocker-slider' if coupler > 0.0 else 'non-Grashof rocker-slider')

    @of_geometry
    def closing_ranges(self) -> Ranges:
        """
        Return the ranges of theta1 [rad] or slide [m] in which the links close, from low to high.

        For a crank that turns fully (-pi, pi). At an end that is no full turn the coupler is
        square to the guide (crank input), or in line with the crank (slider input): a toggle.
        """
        if self.input == SLIDE:
            return slide_ranges(*self.lengths)
        a1, a2, e = scaled(self.lengths)
        below, above = fsum((a2, -e, -a1)), fsum((a2, e, -a1))      # of a2 -+ n at x = -+ pi/2
        low = atan2(e - a2, sqrt(-below * fsum((a2, -e, a1)))) if below < 0.0 else None
        high = atan2(e + a2, sqrt(-above * fsum((a2, e, a1)))) if above < 0.0 else None
        if low is None:
            return ((-pi, pi),) if high is None else ((-pi - high, high),)
        return ((low, pi - low),) if high is None else ((low, high), (pi - high, pi - low))

    @property
    def singular_inputs(self) -> list[complex]:
        """
        Return the complex inputs where the coupler is square to the guide or in line with a1.

        The former of a driven crank: sin theta1 = (e +- a2)/a1, also beyond +-1, where theta1 is
        +-pi/2 + i arcosh; the latter of a driven slide.
        """
        a1, a2, e = self.lengths
        if self.input == SLIDE:
            return singular_slides(a1, a2, e)
        found = []
        for r in (a2, -a2):
            side = 1.0 if e + r > 0.0 else -1.0
            excess = fsum((side * e, side * r, -a1)) / a1          # |sin x| - 1
            if excess >= 0.0:
                found.append(complex(side * 0.5 * pi,
                                     log1p(excess + sqrt(excess * (2.0 + excess)))))
            else:
                angle = side * (0.5 * pi - 2.0 * asin(sqrt(-0.5 * excess)))
                found += [complex(angle), complex(pi - angle)]
        return found

    @property
    def dead_points(self) -> tuple[SliderDeadPoint, ...]:
        """Return up to two poses where the slider of a driven crank turns back in this mode."""
        points, unit = [], power_of_two(*self.lengths)
        a1, a2, e = (length / unit for length in self.lengths)
        folded, stretched = reach(a1, a2, e)
        for is_stretched, r, square in ((True, a1 + a2, stretched), (False, a1 - a2, folded)):
            if square > 0.0 and self.input == CRANK:
                x = self.sign * sqrt(square) if is_stretched else -self.sign * sqrt(square)  # of A
                side = -1.0 if r < 0.0 else 1.0     # B is on the other side of O1
                points.append(SliderDeadPoint(atan2(side * e, x), unit * side * x, is_stretched))
        return tuple(sorted(points))

    def motion_formula(self, numbers: NumberType, constants: Constants) -> Function:
        """Return (position, rate, acceleration) -> fields of MOTION for a number type."""
        a1, a2, e = constants.lengths
        if self.input == CRANK:
            return make_crank_motion(numbers, a1, a2, e, constants.sign, self._has_long_crank)
        return make_slider_motion(numbers, a1, a2, e, constants.sign)

    @property
    def _has_long_crank(self) -> bool:
        return self.a1 > 2.0 * self.a2

    @property
    def structure(self) -> tuple[object, ...]:
        """Return the data that mechanisms with the same formulas have in common."""
        return *super().structure, self._has_long_crank

    @derives
    def loads_formula(self, numbers: NumberType, constants: Constants) -> Function:
        """Return (fields of MOTION) -> fields of LOADS for constants of a number type."""
        a1, a2, e = constants.lengths
        return make_loads(numbers, a1, a2, e, self.input == CRANK, constants.bodies,
                          constants.gravity, constants.external)

    @property
    def connections(self) -> tuple[Connection, ...]:
        """Return which links the four joints connect."""
        return (Connection(GROUND, 'crank'), Connection('crank', 'coupler', (self.a1, 0.0)),
                Connection('coupler', 'output', (self.a2, 0.0)),
                Connection(GROUND, 'output', (0.0, self.offset), axis=(1.0, 0.0)))

    def link_motion(self, motion: NamedFields, link: str) -> LinkMotion:
        """Return the motion of a link by name, its first joint O1, A or B."""
        if link == 'output':
            return LinkMotion(motion.slide, self.offset, motion.slide_velocity, 0.0,
                              motion.slide_acceleration, 0.0,
                              1.0, 0.0, 0.0, 0.0)
        crank = crank_motion(motion)
        if link == 'crank':
            return crank
        return LinkMotion(*point_of(crank, self.a1), motion.cos_b, motion.sin_b,
                          motion.omega_beta, motion.alpha_beta)

    def transmission_sine(self, motion: NamedFields) -> Scalar:
        """Return cos(beta), or of a driven slide sin(theta2): zero at toggles."""
        found: Scalar = motion.cos_b if self.input == CRANK else motion.sin_2
        return found

    def corners(self, motion: NamedFields) -> tuple[tuple[Scalar, Scalar, float], ...]:
        """Return O1, A, B, O4, each as (x w, y w, w); O4 is at infinity, square to the guide."""
        if self.is_driven_by_slide:
            return ()
        return ((0.0, 0.0, 1.0),
                (self.a1 * np.cos(motion.theta1), self.a1 * np.sin(motion.theta1), 1.0),
                (motion.slide, self.offset, 1.0), (0.0, 1.0, 0.0))

    def diagram(self, motion: NamedFields) -> Diagram:
        """Return the picture of one pose: two bars and the slider on its guide."""
        a, b = (point_motion(self, motion, link, along).place
                for link, along in (('crank', self.a1), ('output', 0.0)))
        return Diagram({'O_1': ORIGIN, 'A': a, 'B': b}, ('O_1',), (Bar(ORIGIN, a), Bar(a, b)),
                       (Block(b, np.array([1.0, 0.0]), is_guided=True),),
                       {'f41': 'O_1', 'f21': 'A', 'f32': 'B', 'f43': 'B'}, {'theta1': 'O_1'})

    def velocity_polygon(self, motion: NamedFields) -> list[Arrow]:
        """Return the arrows of V_B = V_A + V_B/A [m/s]."""
        v_a = point_motion(self, motion, 'crank', self.a1).velocity
        v_b = point_motion(self, motion, 'coupler', self.a2).velocity
        return [total(v_a, 'V_A'), total(v_b, 'V_B'), Arrow(v_a, v_b - v_a, 'V_{B/A}', False)]

    def acceleration_polygon(self, motion: NamedFields) -> list[Arrow]:
        """Return the arrows of A_B = A_A + A_B/A, with normal and tangential parts [m/s^2]."""
        crank, coupler = (link_motion(self, motion, link) for link in ('crank', 'coupler'))
        a_a = point_motion(self, motion, 'crank', self.a1).acceleration
        a_b = point_motion(self, motion, 'coupler', self.a2).acceleration
        return [total(a_a, 'A_A'), *around(ORIGIN, crank, self.a1 * crank.direction, 'A'),
                *around(a_a, coupler, self.a2 * coupler.direction, 'B/A'), total(a_b, 'A_B')]
