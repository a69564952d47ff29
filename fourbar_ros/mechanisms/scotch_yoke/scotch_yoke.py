# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The Scotch yoke: its parts, range of motion and drawing."""
from __future__ import annotations

from dataclasses import dataclass
from math import pi
from typing import NamedTuple

from fourbar_ros.mechanics.bodies import Bodies, External
from fourbar_ros.mechanisms.contract import Constants, CRANK, OPEN, SLIDE
from fourbar_ros.mechanisms.kinds import FACTS
from fourbar_ros.mechanisms.loads import derives, with_derived
from fourbar_ros.mechanisms.mechanism import Mechanism
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
    reaction,
    SLOT,
    THETA1,
    THETA2,
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
from fourbar_ros.mechanisms.scotch_yoke.loads import make_loads, ScotchYokeLoads
from fourbar_ros.mechanisms.scotch_yoke.motion import (
    make_crank_motion,
    make_slide_motion,
    ScotchYokeMotion,
)
from fourbar_ros.numerics.number_types import Function, NumberType, Scalar
import numpy as np


class YokeDeadPoint(NamedTuple):
    """Crank along the guide: the yoke turns back."""

    theta1: float     # [rad]
    slide: float      # [m]


X, Y = np.array([1.0, 0.0]), np.array([0.0, 1.0])


@dataclass(frozen=True)
class ScotchYoke(Mechanism):
    """
    Scotch yoke: the crank pin A, on a block, moves a slotted yoke along y = offset.

    The slot is square to it.

    Parameters
    ----------
    a1 : float
        Length of the crank [m], positive.
    offset : float
        y of the guide [m]; it matters for couples alone.
    mode : int
        Assembly mode. A driven slide: 2 has sin(theta1) > 0, 1 < 0. A driven crank has one mode,
        2.
    input : str
        'crank' or 'slide': the driven coordinate, theta1 or slide.
    bodies : Bodies, optional
        Crank from O1, block (``coupler``) from A along the slot (y), yoke (``output``) from B,
        where slot and guide cross, along x. Block and yoke do not turn.
    gravity : tuple of 2 floats
        Field of gravity (x, y) [m/s^2].
    external : External
        Forces and couples on block (``coupler``) and yoke (``output``).
    stroke : tuple of 2 floats, optional
        Shortest and longest slide [m] of a driven slide; not given: [-a1, a1].

    Raises
    ------
    InvalidParameter
        Naming the parameter, its value and the allowed values.

    """

    a1: float
    offset: float = 0.0
    mode: int = OPEN
    input: str = CRANK
    bodies: Bodies | None = None
    gravity: tuple[float, float] = (0.0, 0.0)
    external: External = External()
    stroke: tuple[float, float] | None = None

    TITLE = 'Scotch yoke'
    TEXT, LENGTHS, LINKS, JOINTS = FACTS['scotch_yoke'][:4]
    INPUTS = {CRANK: THETA1, SLIDE: TRAVEL}
    OUTPUTS = {CRANK: (Output(TRAVEL, 'slide_ratio'),), SLIDE: (Output(THETA1, 'crank_ratio'),)}
    REACTIONS = (reaction('O1', 'ground on crank', 'f41'), reaction('A', 'block on crank', 'f21'),
                 reaction('slot', 'yoke on block', 'f32', 'slot_couple'),
                 reaction('guide', 'guide on yoke', 'f43', 'guide_couple'))
    PARTS = {THETA1: 'crank', THETA2: 'block to crank', SLOT: 'block in the slot', TRAVEL: 'yoke'}
    DRAWN = (THETA1, TRAVEL, SLOT)
    MOTION, LOADS = ScotchYokeMotion, with_derived(ScotchYokeLoads)
    BODIES, EXTERNAL = Bodies, External
    MARGIN_SIGNS = ((1, 0),)

    def __post_init__(self) -> None:
        self._check()
        self._check_stroke()

    @property
    def modes(self) -> dict[int, str]:
        """Return the assembly modes: two for a driven slide, one for a driven crank."""
        return {1: '1', 2: '2'} if self.input == SLIDE else {2: '2, the only one'}

    @property
    def margins(self) -> tuple[float, ...]:
        """Return a1: no lengths make a change point."""
        return (self.a1,)

    @property
    def classification(self) -> str:
        """Return the type: the crank of every one can turn fully."""
        return 'harmonic motion'

    @property
    def closing_ranges(self) -> tuple[tuple[float, float], ...]:
        """Return the range of the input: a full turn, or -a1 to a1 [m], the crank along x."""
        return ((-pi, pi),) if self.input == CRANK else ((-self.a1, self.a1),)

    @property
    def singular_inputs(self) -> list[complex]:
        """Return the toggles of a driven slide; of a driven crank there are no singular inputs."""
        return [] if self.input == CRANK else [complex(-self.a1), complex(self.a1)]

    @property
    def dead_points(self) -> tuple[YokeDeadPoint, ...]:
        """Return where the yoke of a driven crank turns back."""
        return ((YokeDeadPoint(0.0, self.a1), YokeDeadPoint(pi, -self.a1)) if self.input == CRANK
                else ())

    def motion_formula(self, numbers: NumberType, constants: Constants) -> Function:
        """Return (position, rate, acceleration) -> fields of MOTION for a number type."""
        make = make_crank_motion if self.input == CRANK else make_slide_motion
        a1, e = constants.lengths
        return make(numbers, a1, e, constants.sign)

    @derives
    def loads_formula(self, numbers: NumberType, constants: Constants) -> Function:
        """Return (fields of MOTION) -> fields of LOADS for constants of a number type."""
        a1, e = constants.lengths
        return make_loads(numbers, a1, e, self.input == CRANK, constants.bodies,
                          constants.gravity, constants.external)

    @property
    def connections(self) -> tuple[Connection, ...]:
        """Return which links the four joints connect; the block points along the slot, y."""
        return (Connection(GROUND, 'crank'), Connection('crank', 'coupler', (self.a1, 0.0)),
                Connection('output', 'coupler', axis=(0.0, 1.0), turn=0.5 * pi),
                Connection(GROUND, 'output', (0.0, self.offset), axis=(1.0, 0.0)))

    def link_motion(self, motion: NamedFields, link: str) -> LinkMotion:
        """Return the motion of a link by name; block and yoke do not turn."""
        if link == 'output':
            return LinkMotion(motion.slide, self.offset, motion.slide_velocity, 0.0,
                              motion.slide_acceleration, 0.0,
                              1.0, 0.0, 0.0, 0.0)
        crank = crank_motion(motion)
        if link == 'crank':
            return crank
        return LinkMotion(*point_of(crank, self.a1), 0.0, 1.0, 0.0, 0.0)

    def transmission_sine(self, motion: NamedFields) -> Scalar:
        """Return 1, or of a driven slide sin(theta1): zero where that cannot turn the crank."""
        found: Scalar = 1.0 + 0.0 * motion.sin_x if self.input == CRANK else motion.sin_x
        return found

    def diagram(self, motion: NamedFields) -> Diagram:
        """Return the picture of one pose; the slot reaches over the whole travel of the block."""
        a, b = (point_motion(self, motion, link, along).place
                for link, along in (('crank', self.a1), ('output', 0.0)))
        travel = [b + (end - self.offset) * Y for end in (-1.1 * self.a1, 1.1 * self.a1)]
        low, _, high = sorted((b, *travel), key=lambda place: float(place[1]))
        return Diagram({'O_1': ORIGIN, 'A': a, 'B': b}, ('O_1',), (Bar(low, high), Bar(ORIGIN, a)),
                       (Block(b, X, is_guided=True), Block(a, Y)),
                       {'f41': 'O_1', 'f21': 'A', 'f32': 'A', 'f43': 'B'}, {'theta1': 'O_1'})

    def velocity_polygon(self, motion: NamedFields) -> list[Arrow]:
        """Return the arrows of V_A = V_B + V_rel, along guide and slot [m/s]."""
        v_a = point_motion(self, motion, 'crank', self.a1).velocity
        v_b = motion.slide_velocity * X
        return [total(v_a, 'V_A'), total(v_b, 'V_B'),
                *chain(v_b, (motion.slot_velocity * Y, 'V_{rel}'))]

    def acceleration_polygon(self, motion: NamedFields) -> list[Arrow]:
        """Return the arrows of A_A = A_B + A_rel [m/s^2]; the slot does not turn: no Coriolis."""
        crank = link_motion(self, motion, 'crank')
        a_a = point_motion(self, motion, 'crank', self.a1).acceleration
        a_b = motion.slide_acceleration * X
        return [total(a_a, 'A_A'), *around(ORIGIN, crank, self.a1 * crank.direction, 'A'),
                total(a_b, 'A_B'), *chain(a_b, (motion.slot_acceleration * Y, 'A_{rel}'))]
