# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The four-bar, driven at its crank, at A or at B: names, classes, ranges and dead points.

How it moves and what its joints bear follows from the machine that it is, see :mod:`.kind`. The
condition of theta4 (theta1 or theta2 of a drive at A or B), relative errors of the lengths -> its
error [rad], is exact, with p and q the driven link and the frame, r1 and r2 the rods of the dyad:

    (C1)  condition = (p |cos c| + r1 + r2 |cos m| + q |cos b|) / (r2 |sin m|),   c from driven
          link to r1, m from r1 to r2, b from frame to r1

>>> linkage = MovingJointFourBar(0.4, 1.2, 0.8, 1.0, input='A')
>>> motion = linkage.motion(-0.5, 2.0)
>>> print(f'{motion.theta1:.6f} {motion.theta4:.6f} rad, {motion.omega1:.6f} rad/s')
0.835757 1.045407 rad, -1.807550 rad/s
"""
from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import atan2, fsum, pi, sqrt
from typing import Any, NamedTuple, TYPE_CHECKING

from fourbar_ros.errors import InvalidParameter
from fourbar_ros.mechanics.bodies import Bodies, External, Gravity
from fourbar_ros.mechanisms.closed_forms import (
    four_bar_ranges,
    singular_angles,
    turned_ranges,
)
from fourbar_ros.mechanisms.kind import (
    DrivenMachine,
    FORWARD,
    Kind,
    results,
)
from fourbar_ros.mechanisms.kinds import FACTS
from fourbar_ros.mechanisms.machine.structure import Numbers
from fourbar_ros.mechanisms.mechanism import cached_by_lengths
from fourbar_ros.mechanisms.parts import (
    BETA,
    Connection,
    CRANK,
    CROSSED,
    GROUND,
    JOINT_A,
    JOINT_B,
    OPEN,
    Output,
    Ranges,
    reaction,
    THETA1,
    THETA2,
    THETA3,
    THETA4,
)
from fourbar_ros.numerics.exact_sums import difference_of_squares
from fourbar_ros.numerics.number_types import Function, NumberType, Scalar

if TYPE_CHECKING:
    from fourbar_ros.mechanisms.machine.seen_from_link import SeenFromLink

# Signs of (a4 - a1 + a3 - a2, a4 - a1 - a3 + a2, a2 + a3 - a4 - a1) for the eight basic planar 4R
# linkages: McCarthy and Soh, Geometric Design of Linkages, with the first two exchanged. The name
# of a non-Grashof linkage says whether theta1 and theta4 swing through 0 or pi.
_CLASSES: dict[tuple[int, ...], str] = {
    (1, 1, 1): 'Grashof crank-rocker',
    (-1, -1, 1): 'Grashof double-crank',
    (-1, 1, -1): 'Grashof rocker-crank',
    (1, -1, -1): 'Grashof double-rocker',
    (-1, -1, -1): 'non-Grashof 0-0 double-rocker',
    (-1, 1, 1): 'non-Grashof pi-0 double-rocker',
    (1, -1, 1): 'non-Grashof pi-pi double-rocker',
    (1, 1, -1): 'non-Grashof 0-pi double-rocker',
}


def two_rods(p: Scalar, q: Scalar, first: Scalar, second: Scalar) -> Numbers:
    """Return the numbers of RRR: rods from p and q, along the driven link and the frame [m]."""
    return Numbers((p, 0.0), (q, 0.0), (first, second), (), (p, q, 1.0, 0.0, 1.0, 0.0))


def condition_of_rods(fabs: Function, lengths: Sequence[Scalar], c: Scalar, m: Sequence[Scalar],
                      b: Scalar) -> Scalar:
    """
    Return the condition of a four-bar, (C1).

    ``lengths``: p, q, r1 and r2; ``c``, ``b``: cosines; ``m``: cosine and sine, then any others.
    """
    p, q, r1, r2 = lengths
    found: Scalar = (p * fabs(c) + r1 + r2 * fabs(m[0]) + q * fabs(b)) / (r2 * fabs(m[1]))  # (C1)
    return found


class DeadPoint(NamedTuple):
    """Crank and coupler in line, one behind the other (stretched) or folded; angles in [rad]."""

    theta1: float
    theta4: float
    stretched: bool


class FourBarLinks(Kind):
    """Base of the 4R linkages, whichever joint is driven: four bars, four joints."""

    a1: float
    a2: float
    a3: float
    a4: float

    TITLE = 'four-bar'
    TEXT, LENGTHS, LINKS, JOINTS = FACTS['four_bar'][:4]
    MODES = {CROSSED: '1 (crossed)', OPEN: '2 (open)'}
    MARGIN_SIGNS = ((-1, -1, 1, 1), (-1, 1, -1, 1), (-1, 1, 1, -1))
    REACTIONS = (reaction('O1', 'ground on crank', 'f41'),
                 reaction('A', 'coupler on crank', 'f21'),
                 reaction('B', 'output link on coupler', 'f32'),
                 reaction('O4', 'ground on output link', 'f43'))
    PARTS = {THETA1: 'crank', THETA2: 'coupler to crank', THETA3: 'output link to coupler',
             THETA4: 'output link',
             BETA: 'coupler'}
    FROM_HALF_A_TURN = THETA3
    DRAWN = (THETA1, BETA, THETA4)
    DIRECTIONS = {'x': THETA1, 'b': BETA, 'y': THETA4, 'mu': THETA3}
    DRIVES = {
        CRANK: DrivenMachine(
            (GROUND, 'crank', 'coupler', 'output'), 'RRR',
            lambda lengths: two_rods(lengths[0], lengths[3], lengths[1], lengths[2]), FORWARD,
            ('sin_mu', 1.0), lambda f, a, d, _: condition_of_rods(
                f, (a[0], a[3], a[1], a[2]), d[THETA2][0], d[THETA3], d[BETA][0])),
        JOINT_A: DrivenMachine(
            ('crank', 'coupler', 'output', GROUND), 'RRR',
            lambda lengths: two_rods(lengths[1], lengths[0], lengths[2], lengths[3]),
            {'f41': ('second', -1.0), 'f21': ('base', -1.0), 'f32': ('first', -1.0),
             'f43': ('inner', 1.0)},
            ('sin_y', 1.0), lambda f, a, d, _: condition_of_rods(
                f, (a[1], a[0], a[2], a[3]), d[THETA3][0], d[THETA4],
                d[THETA1][0] * d[THETA4][0] + d[THETA1][1] * d[THETA4][1]),
            reversed=('crank', 'output'), turn=-1.0),
        JOINT_B: DrivenMachine(
            ('coupler', 'output', GROUND, 'crank'), 'RRR',
            lambda lengths: two_rods(lengths[2], lengths[1], lengths[3], lengths[0]),
            {'f41': ('inner', -1.0), 'f21': ('second', 1.0), 'f32': ('base', -1.0),
             'f43': ('first', -1.0)},
            ('sin_x', 1.0), lambda f, a, d, _: condition_of_rods(
                f, (a[2], a[1], a[3], a[0]), d[THETA4][0], d[THETA1], d[BETA][0]),
            reversed=('coupler', 'output', GROUND, 'crank'), turn=-1.0)}

    def __post_init__(self) -> None:
        """Check the parameters, and that no link is as long as the other three together."""
        self._check()
        lengths = self.lengths
        longest = max(lengths)
        if fsum(lengths + (-longest, -longest)) <= 0.0:
            raise InvalidParameter(f'a{lengths.index(longest) + 1}', longest,
                                   'the links cannot close: it must be shorter than the other '
                                   f'three together ({fsum(lengths + (-longest,)):.12g})')

    @cached_by_lengths
    def margins(self) -> tuple[float, ...]:
        """
        Return the signed distances [m] from the three change points of Grashof's classification.

        a4 - a1 + a3 - a2, a4 - a1 - a3 + a2 and a2 + a3 - a4 - a1; a1 is the crank, a4 the ground.
        """
        a1, a2, a3, a4 = self.lengths
        return (fsum((a4, -a1, a3, -a2)), fsum((a4, -a1, -a3, a2)), fsum((a2, a3, -a4, -a1)))

    @cached_by_lengths
    def classification(self) -> str:
        """Return the Grashof type by name; 'change point' if two sums of two links are equal."""
        if 0.0 in self.margins:
            return 'change point'
        return _CLASSES[tuple(1 if margin > 0.0 else -1 for margin in self.margins)]

    @property
    def connections(self) -> tuple[Connection, ...]:
        """Return which links the four joints connect."""
        return (Connection(GROUND, 'crank'), Connection('crank', 'coupler', (self.a1, 0.0)),
                Connection('coupler', 'output', (self.a2, 0.0), (self.a3, 0.0), turn=pi),
                Connection(GROUND, 'output', (self.a4, 0.0)))


@dataclass(frozen=True)
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
        Masses; without them there are no loads.
    gravity : tuple of 2 floats, or Base
        Field of gravity (x, y) [m/s^2], or the motion of the base.
    external : External
        Forces and couples on coupler and output link.

    Raises
    ------
    InvalidParameter
        Naming the parameter, its value and the allowed values.

    """

    a1: float
    a2: float
    a3: float
    a4: float
    mode: int = OPEN
    bodies: Bodies | None = None
    gravity: Gravity = (0.0, 0.0)
    external: External = External()

    input = CRANK
    INPUTS, OUTPUTS = {CRANK: THETA1}, {CRANK: (Output(THETA4, 'velocity_ratio'),)}
    RATIOS = {'velocity_ratio': THETA4, 'coupler_ratio': BETA}

    # --- what it is -----------------------------------------------------------------------------

    @property
    def description(self) -> str:
        """Return its type as text."""
        return self.classification

    @cached_by_lengths
    def closing_ranges(self) -> Ranges:
        """
        Return the ranges (low, high) of theta1 in which the linkage can be assembled [rad].

        One range (-pi, pi) when the crank turns fully, one through 0 or one through pi (high >
        pi), or two. At an end that is no full turn, coupler and output link are in line (toggle).
        """
        return four_bar_ranges(*self.lengths)

    @property
    def singular_inputs(self) -> list[complex]:
        """
        Return the complex theta1 at which coupler and output link are in line, or A meets O4.

        Real ones are the ends of the ranges, to the last bit.
        """
        return singular_angles(*self.lengths)

    @cached_by_lengths
    def output_ranges(self) -> Ranges:
        """Return the ranges of theta4 [rad] over both modes; they end at dead points."""
        # seen from O4, of pi - theta4
        a1, a2, a3, a4 = self.lengths
        return turned_ranges([(-high, -low) for low, high in four_bar_ranges(a3, a2, a1, a4)])

    @property
    def ranges_of_both_modes(self) -> dict[str, Ranges]:
        """Return the ranges of theta4 over both modes by its name."""
        return {'theta4': self.output_ranges}

    @cached_by_lengths
    def dead_points(self) -> tuple[DeadPoint, ...]:
        """
        Return where theta4 turns back in this mode: its rate is zero at any speed of the crank.

        Up to two, in the order of theta1: where crank and coupler are in line, so that |O1 B| is
        |a1 + a2| (stretched) or |a1 - a2| (folded), in the triangle of that side, a3 and a4.
        """
        points, (a1, a2, a3, a4) = [], self.lengths
        for stretched, coupler in ((True, a2), (False, -a2)):
            # 4 (a1 + coupler) a4 times sin^2, cos^2 of half the angle at O1
            sine = fsum((a3, -a1, -coupler, a4)) * fsum((a3, a1, coupler, -a4))
            cosine = fsum((a1, coupler, a4, -a3)) * fsum((a1, coupler, a4, a3))
            if sine * cosine > 0.0:         # both are negative where B lies behind O1
                side = self.sign if stretched else -self.sign
                theta1 = side * 2.0 * atan2(sqrt(abs(sine)), sqrt(abs(cosine)))
                side = side if a1 + coupler > 0.0 else -side
                theta4 = side * 2.0 * atan2(sqrt(difference_of_squares(a3, a4, a1, coupler)),
                                            sqrt(difference_of_squares(a1, coupler, a4, -a3)))
                points.append(DeadPoint(theta1, theta4, stretched))
        return tuple(sorted(points))

    def driven_otherwise(self) -> tuple[SeenFromLink, ...]:
        """
        Return the same linkage driven at its output link, once for each assembly mode.

        Nothing at an exact change point: driven so it would lie flat somewhere too.
        """
        from fourbar_ros.mechanisms.machine.seen_from_link import (
            SeenFromLink,  # motion by torque alone
        )
        if self.change_point_margin == 0.0:
            return ()
        drive = self.drive
        return tuple([SeenFromLink(drive.layout, [drive.numbers(self.lengths)], [self.sign], 0,
                                   mode) for mode in self.MODES])


def seen_lengths(lengths: tuple[Scalar, ...],
                 joint: str) -> tuple[Scalar, Scalar, Scalar, Scalar]:
    """Return the lengths as seen from the link before a driven joint: that one is the ground."""
    a1, a2, a3, a4 = lengths
    return (a2, a3, a4, a1) if joint == JOINT_A else (a3, a4, a1, a2)


@dataclass(frozen=True)
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
    bodies : Bodies, optional
        Masses; without them there are no loads.
    gravity : tuple of 2 floats, or Base
        Field of gravity (x, y) [m/s^2], or the motion of the base.
    external : External
        Forces and couples on the links.

    Its ``driving_torque`` acts on the coupler from the crank (A), or on the output link from the
    coupler (B).

    Raises
    ------
    InvalidParameter
        Naming the parameter, its value and the allowed values.

    """

    a1: float
    a2: float
    a3: float
    a4: float
    mode: int = OPEN
    input: str = JOINT_A
    bodies: Bodies | None = None
    gravity: Gravity = (0.0, 0.0)
    external: External = External()

    MODES = {1: '1', OPEN: '2'}
    INPUTS = {JOINT_A: THETA2, JOINT_B: THETA3}
    OUTPUTS = {joint: (Output(THETA4, 'velocity_ratio'), Output(THETA1, 'crank_ratio'))
               for joint in INPUTS}
    RATIOS = {'velocity_ratio': THETA4, 'coupler_ratio': BETA, 'crank_ratio': THETA1}

    @property
    def description(self) -> str:
        """Return a short text: type, input."""
        return f'{self.classification}, driven at its joint {self.input}'

    @property
    def TORQUE(self) -> str:        # type: ignore[override]  # of each input  # noqa: N802
        """Return the symbol of the torque: of crank on coupler, of coupler on output link."""
        return 'T_{12}' if self.input == JOINT_A else 'T_{23}'

    @cached_by_lengths
    def closing_ranges(self) -> Ranges:
        """Return the ranges of theta2 or theta3 in which the linkage can be assembled [rad]."""
        return turned_ranges(four_bar_ranges(*seen_lengths(self.lengths, self.input)))

    @property
    def singular_inputs(self) -> list[complex]:
        """Return the complex inputs at which output and ground (A), or crank and ground, align."""
        return [complex(x.real + (pi if x.real <= 0.0 else -pi), x.imag)
                for x in singular_angles(*seen_lengths(self.lengths, self.input))]

    @property
    def turns_fully(self) -> bool:
        """Return whether the driven joint makes full turns."""
        return self.input_ranges == ((-pi, pi),)

    def driven_otherwise(self) -> tuple[FourBar, ...]:
        """Return the same links driven at the crank, which goes on at toggles of this drive."""
        a1, a2, a3, a4 = self.lengths
        return tuple(FourBar(a1, a2, a3, a4, mode, self.bodies, self.gravity, self.external)
                     for mode in FourBar.MODES)

    def read_coordinate(self, numbers: NumberType, curves: Any) -> tuple[Any, Any, Any]:
        """Return theta2 or theta3 and two derivatives by the input; ``curves`` of the links."""
        # angle of the second link to the first; theta3 counts from B A, half a turn on
        first, side = (0, 1.0) if self.input == JOINT_A else (1, -1.0)
        one, two = curves[first:first + 2]
        sine, cosine = (two.sine * one.cosine - two.cosine * one.sine,
                        two.cosine * one.cosine + two.sine * one.sine)
        return (numbers.atan2(side * sine, side * cosine),
                two.omega - one.omega, two.alpha - one.alpha)


Motion, Loads = results(FourBar, 'Motion', 'Loads')
results(MovingJointFourBar, 'MovingJointMotion', 'Loads')
