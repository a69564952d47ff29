# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The four-bar, driven at its crank, or at A or B between two moving links.

How it moves and what its joints bear follows from the machine that it is, see :mod:`.kind`.

How ``step`` gets theta4: :meth:`.Mechanism.step` calls Python code that was written from one
symbolic run of the formulas (:mod:`.evaluation`). They begin in :meth:`.Kind.motion_in`, which
takes the pose of crank and dyad from ``pose_of`` (machine/solve/frames.py); its ``Poses.add``
calls :func:`.rrr_pair`, as ``one_dyad`` of kind.py chose, and this :func:`.loop.loop`, whose (M1)
to (M3) are the quadratic of plain.py without its differences. theta4 is the atan2 at the end of
``motion_in``. (D1) to (D3) of machine/solve/dyads.py are for dyads that hang on two links which no
joint connects.

How it gets the loads: :meth:`.Kind.joint_loads` takes what each link needs to move so, (N1) and
(N2), from ``needs_of`` (mechanics/newton_euler.py), and torque and joint forces, (L1) and (F1),
from ``solve_loads`` (machine/solve/loads.py); ``FORWARD`` of kind.py names them f41 to f43.

The condition of theta4 (theta1 or theta2 of a drive at A or B), relative errors of the lengths ->
its error [rad], is exact, with p and q the driven link and the frame, r1 and r2 the rods of the
dyad:

    (C1)  condition = (p |cos c| + r1 + r2 |cos m| + q |cos b|) / (r2 |sin m|),   c from driven
          link to r1, m from r1 to r2, b from frame to r1

>>> linkage = MovingJointFourBar(0.4, 1.2, 0.8, 1.0, input='A')
>>> motion = linkage.motion(-0.5, 2.0)
>>> print(f'{motion.theta1:.6f} {motion.theta4:.6f} rad, {motion.omega1:.6f} rad/s')
0.835757 1.045407 rad, -1.807550 rad/s
"""
from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from math import atan2, pi, remainder, sqrt
from typing import Any, TYPE_CHECKING

from fourbar_ros.errors import InvalidParameter
from fourbar_ros.mechanics.bodies import Bodies, External, Gravity
from fourbar_ros.mechanisms import closed_forms, kind, parts
from fourbar_ros.mechanisms.closed_forms import four_bar_ranges, singular_angles
from fourbar_ros.mechanisms.geometry import cached_by_lengths
from fourbar_ros.mechanisms.kind import Coordinates, DrivenMachine, Kind, Lengths, one_dyad
from fourbar_ros.mechanisms.machine.structure import DyadLengths
from fourbar_ros.mechanisms.parts import BETA, CRANK, GROUND, THETA1, THETA2, THETA3, THETA4
from fourbar_ros.numerics.number_types import exact_sum, Operation, REAL, Scalar, scaled, TINY

if TYPE_CHECKING:
    from fourbar_ros.mechanisms.machine.seen_from_link import SeenFromLink


def two_rods_behind(p: Scalar, q: Scalar, first: Scalar, second: Scalar) -> DyadLengths:
    """Return the lengths of RRR: rods from p along the driven link and q behind its pivot [m]."""
    # half the angle from one to the other is a right one
    return DyadLengths((p, 0.0), (-q, 0.0), (first, second), (), (p, q, (0.0, 1.0), -1.0, 0.0))


class FourBarLinks(Kind):
    """Base of the 4R linkages, whichever joint is driven: four bars, four joints."""

    a1: float
    a2: float
    a3: float
    a4: float

    TITLE = 'four-bar'
    TEXT = 'four revolute joints'
    LENGTHS = (kind.CRANK_LENGTH, kind.COUPLER_LENGTH,
               parts.Length('a3', 'length of the output link O4-B'), kind.GROUND_LENGTH)
    LINKS = (kind.CRANK_LINK, parts.Link('coupler', 'coupler', 'A', 'a2'),
             parts.Link('output', 'output link', 'O4', 'a3'))
    JOINTS = (kind.JOINT_O1, parts.Joint('A', THETA2, 'coupler'),
              parts.Joint('B', THETA3, 'coupler_output'), parts.Joint('O4', THETA4, 'output'))
    MODES = {parts.CROSSED: '1 (crossed)', parts.OPEN: '2 (open)'}
    MARGIN_SIGNS = ((-1, -1, 1, 1), (-1, 1, -1, 1), (-1, 1, 1, -1))
    # McCarthy and Soh, Geometric Design of Linkages, with the first two margins exchanged. The
    # name of a non-Grashof linkage says whether theta1 and theta4 swing through 0 or pi.
    CLASSES = {
        (1, 1, 1): 'Grashof crank-rocker',
        (-1, -1, 1): 'Grashof double-crank',
        (-1, 1, -1): 'Grashof rocker-crank',
        (1, -1, -1): 'Grashof double-rocker',
        (-1, -1, -1): 'non-Grashof 0-0 double-rocker',
        (-1, 1, 1): 'non-Grashof pi-0 double-rocker',
        (1, -1, 1): 'non-Grashof pi-pi double-rocker',
        (1, 1, -1): 'non-Grashof 0-pi double-rocker',
    }
    REACTIONS = (parts.Reaction('O1', 'ground on crank', 'f41'),
                 parts.Reaction('A', 'coupler on crank', 'f21'),
                 parts.Reaction('B', 'output link on coupler', 'f32'),
                 parts.Reaction('O4', 'ground on output link', 'f43'))
    PARTS = {THETA1: 'crank', THETA2: 'coupler to crank', THETA3: 'output link to coupler',
             THETA4: 'output link', BETA: 'coupler'}
    FROM_HALF_A_TURN = THETA3
    DRAWN = (THETA1, BETA, THETA4)
    DIRECTIONS = {'x': THETA1, 'b': BETA, 'y': THETA4}
    DRIVES = {CRANK: DrivenMachine(
        one_dyad(CRANK, GROUND, 'crank', 'RRR', ('coupler', 'output')),
        lambda a1, a2, a3, a4: DyadLengths((a1, 0.0), (a4, 0.0), (a2, a3), (),
                                           (a1, a4, (1.0, 0.0), 1.0, 0.0)),
        four_bar_ranges, singular_angles, kind.FORWARD)}

    def condition(self, fabs: Operation, lengths: Lengths, coordinates: Coordinates) -> Scalar:
        theta1, theta2, theta3, theta4, beta = [coordinates[each] for each in self.PARTS]
        p, r1, r2, q = lengths
        of_c, of_m, cos_b = theta2, theta3, beta[0]
        if self.input == parts.JOINT_A:
            q, p, r1, r2 = lengths
            of_c, of_m, cos_b = theta3, theta4, theta1[0] * theta4[0] + theta1[1] * theta4[1]
        elif self.input == parts.JOINT_B:
            r2, q, p, r1 = lengths
            of_c, of_m = theta4, theta1
        return ((p * fabs(of_c[0]) + r1 + r2 * fabs(of_m[0]) + q * fabs(cos_b))
                / (r2 * fabs(of_m[1]) + TINY))                                            # (C1)

    def in_line(self, side: float) -> Iterator[tuple[float, float, bool]]:
        """
        Yield theta1, theta4 [rad], whether stretched, of crank and coupler in line: up to two.

        ``side`` is the sign of sin(mu), of the angle from coupler to output link. Whichever link
        is driven, the output link stands still there and turns back.

        Crank and coupler are in line there: O1 B along the crank is r = a1 + a2 (stretched) or
        a1 - a2 (folded), negative where B lies behind O1. In the triangle of |r|, a3 and a4 the
        half angles at O1 and O4 follow by the law of cosines,

            (DP1) tan^2(theta1/2) = (a3^2 - (r - a4)^2) / ((r + a4)^2 - a3^2)
            (DP2) tan^2(theta4/2) = ((a3 + a4)^2 - r^2) / (r^2 - (a4 - a3)^2)
        """
        a1, a2, a3, a4 = scaled(self.lengths)
        for stretched, coupler in ((True, a2), (False, -a2)):
            # Numerator and denominator of (DP1) as products of exact sums, in which r = a1 +
            # coupler: they keep their digits where the triangle is nearly flat. Both are negative
            # where r is.
            over = exact_sum((a3, -a1, -coupler, a4)) * exact_sum((a3, a1, coupler, -a4))
            under = exact_sum((a1, coupler, a4, -a3)) * exact_sum((a1, coupler, a4, a3))
            if over * under > 0.0:          # else there is no triangle
                # folded, the coupler points back and B is on the other side of the crank
                sign = side if stretched else -side
                theta1 = sign * 2.0 * atan2(sqrt(abs(over)), sqrt(abs(under)))         # (DP1)
                # behind O1, crank and rocker are on two sides of the ground
                sign = sign if a1 + coupler > 0.0 else -sign
                theta4 = sign * 2.0 * atan2(                                           # (DP2)
                    sqrt(REAL.difference_of_squares(a3, a4, a1, coupler)),
                    sqrt(REAL.difference_of_squares(a1, coupler, a4, -a3)))
                yield theta1, theta4, stretched

    def _require_closing(self) -> None:
        lengths = self.lengths
        longest = max(lengths)
        if exact_sum(lengths + (-longest, -longest)) <= 0.0:
            raise InvalidParameter(f'a{lengths.index(longest) + 1}', longest,
                                   'the links cannot close: it must be shorter than the other '
                                   f'three together ({exact_sum(lengths + (-longest,)):.12g})')


@dataclass(frozen=True, repr=False)
class FourBar(FourBarLinks):
    """
    Planar four-bar linkage O1-A-B-O4 with four revolute joints.

    O1 = (0, 0), O4 = (a4, 0). Angles are counter-clockwise, theta1 and theta4 absolute at the
    ground pivots (theta4 is the direction from O4 to B), beta the absolute direction from A to B.

    Parameters
    ----------
    a1, a2, a3, a4 : float
        Lengths of input link, coupler, output link and ground [m], positive; the longest must be
        shorter than the other three together.
    mode : int
        Assembly mode: 2 (open) has sin(theta4 - beta) > 0, 1 (crossed) < 0. It is part of the
        linkage, never guessed from an earlier pose.
    bodies : Bodies, optional
        Masses; without them there are no loads: use ``motion``, as ``step`` raises MissingBodies.
    gravity : tuple of 2 floats, or Base
        Field of gravity (x, y) [m/s^2], or the motion of the base.
    external : External
        Forces and couples on coupler and output link.
    stroke : tuple of 2 floats, optional
        Lowest and highest theta1 [rad], in any turn; not given: all at which the links close.
    elements : tuple
        Springs, dampers, forces over a position, of :mod:`fourbar_ros.mechanisms.elements`.
    friction : mapping {joint: JointFriction}
        By its name, as 'O1'; 'drive': a DriveFriction.
    joint_names : mapping {joint: name}
        Names which pictures show in place of O1, A, B, O4.

    Raises
    ------
    InvalidParameter
        Naming the parameter, its value and the allowed values.

    """

    a1: float
    a2: float
    a3: float
    a4: float
    mode: int = parts.OPEN
    bodies: Bodies | None = None
    gravity: Gravity = (0.0, 0.0)
    external: External = External()
    stroke: tuple[float, float] | None = None
    elements: tuple[Any, ...] = ()
    friction: Any = ()
    joint_names: Mapping[str, str] = field(default_factory=dict, compare=False)

    input = CRANK
    INPUTS, OUTPUTS = {CRANK: THETA1}, {CRANK: (parts.Output(THETA4, 'velocity_ratio'),)}
    RATIOS = {'velocity_ratio': THETA4, 'coupler_ratio': BETA}

    @property
    def description(self) -> str:
        return self.classification

    @cached_by_lengths
    def output_ranges(self) -> parts.Ranges:
        """Return the ranges of theta4 [rad] over both modes; they end at dead points."""
        a1, a2, a3, a4 = self.lengths
        return closed_forms.turned_ranges([         # seen from O4, of pi - theta4
            (-high, -low) for low, high in four_bar_ranges(a3, a2, a1, a4)])

    def stalls(self, side: float) -> Iterator[tuple[float, float, bool]]:
        return self.in_line(side)

    def driven_otherwise(self) -> tuple[SeenFromLink, ...]:
        """Return the same linkage driven at its output link, once for each assembly mode."""
        from fourbar_ros.mechanisms.machine import seen_from_link  # motion by torque alone
        drive = self.drive
        return tuple([seen_from_link.SeenFromLink(
            drive.layout, [drive.lengths(*self.lengths)], [self.sign], 0, mode)
            for mode in self.MODES])


@dataclass(frozen=True, repr=False)
class MovingJointFourBar(FourBarLinks):
    """
    Planar four-bar linkage O1-A-B-O4 that is driven at A or at B, between two moving links.

    Parameters
    ----------
    a1, a2, a3, a4 : float
        As of :class:`~FourBar`.
    mode : int
        Assembly mode: 2 has sin(theta4) > 0 of a drive at A, sin(theta1) > 0 of one at B; 1 < 0.
    input : str
        'A': theta2, coupler to crank, is given; 'B': theta3, output link to coupler.
    bodies, gravity, external, stroke, friction
        As of :class:`~FourBar`; the stroke is of theta2 or theta3.

    Its ``driving_torque`` acts on the coupler from the crank (A), or on the output link from the
    coupler (B).

    """

    a1: float
    a2: float
    a3: float
    a4: float
    mode: int = parts.OPEN
    input: str = parts.JOINT_A
    bodies: Bodies | None = None
    gravity: Gravity = (0.0, 0.0)
    external: External = External()
    stroke: tuple[float, float] | None = None
    elements: tuple[Any, ...] = ()
    friction: Any = ()
    joint_names: Mapping[str, str] = field(default_factory=dict, compare=False)

    MODES = {1: '1', parts.OPEN: '2'}
    INPUTS = {parts.JOINT_A: THETA2, parts.JOINT_B: THETA3}
    OUTPUTS = {joint: (parts.Output(THETA4, 'velocity_ratio'), parts.Output(THETA1, 'crank_ratio'))
               for joint in INPUTS}
    RATIOS = {'velocity_ratio': THETA4, 'coupler_ratio': BETA, 'crank_ratio': THETA1}
    # the frame begins at the driven joint, and its other end lies behind that
    DRIVES = {
        parts.JOINT_A: DrivenMachine(
            one_dyad(CRANK, 'crank', 'coupler', 'RRR', ('output', GROUND)),
            lambda a1, a2, a3, a4: two_rods_behind(a2, a1, a3, a4),
            lambda a1, a2, a3, a4: closed_forms.turned_ranges(four_bar_ranges(a2, a3, a4, a1)),
            lambda a1, a2, a3, a4: closed_forms.turned_angles(singular_angles(a2, a3, a4, a1)),
            {'f41': '-dyad_second', 'f21': '-base', 'f32': '-dyad_first', 'f43': 'dyad_inner'},
            reversed={'output': 'a3'}),
        parts.JOINT_B: DrivenMachine(
            one_dyad(CRANK, 'coupler', 'output', 'RRR', (GROUND, 'crank')),
            lambda a1, a2, a3, a4: two_rods_behind(a3, a2, a4, a1),
            lambda a1, a2, a3, a4: closed_forms.turned_ranges(four_bar_ranges(a3, a4, a1, a2)),
            lambda a1, a2, a3, a4: closed_forms.turned_angles(singular_angles(a3, a4, a1, a2)),
            {'f41': '-dyad_inner', 'f21': 'dyad_second', 'f32': '-base', 'f43': '-dyad_first'},
            reversed={'output': 'a3', GROUND: 'a4', 'crank': 'a1'})}

    @property
    def description(self) -> str:
        return f'{self.classification}, driven at its joint {self.input}'

    @property
    def TORQUE(self) -> str:        # type: ignore[override]  # of each input  # noqa: N802
        return 'T_{12}' if self.input == parts.JOINT_A else 'T_{23}'

    @property
    def dead_point_fields(self) -> tuple[str, ...]:
        return ('input', *super().dead_point_fields[1:])

    def stalls(self, side: float) -> Iterator[tuple[float, float, float, bool]]:
        for theta1, theta4, stretched in (*self.in_line(1.0), *self.in_line(-1.0)):
            beta = theta1 + pi * (not stretched)
            angle, of_mode = ((pi * (not stretched), theta4) if self.input == parts.JOINT_A else
                              (remainder(theta4 - beta + pi, 2.0 * pi), theta1))
            if of_mode * side > 0.0:        # sin(theta4), or that of theta1
                yield angle, theta4, theta1, stretched

    def driven_otherwise(self) -> tuple[FourBar, ...]:
        """Return the same links driven at the crank, which goes on at toggles of this drive."""
        a1, a2, a3, a4 = self.lengths
        return tuple(FourBar(a1, a2, a3, a4, mode, self.bodies, self.gravity, self.external)
                     for mode in FourBar.MODES)


Motion, Loads = kind.results(FourBar, 'Motion', 'Loads')
kind.results(MovingJointFourBar, 'MovingJointMotion', 'Loads')
