# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The planar 4R linkage: its parts, range of motion and drawing.

Its formulas are in :mod:`.motion` and :mod:`.loads`. :class:`SeenFromOutput` is the linkage driven
at its output link.
"""
from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from math import asinh, atan2, fsum, pi, sqrt
from typing import Any, NamedTuple

from fourbar_ros.errors import InvalidParameter
from fourbar_ros.mechanics.bodies import Bodies, External
from fourbar_ros.mechanisms.contract import Constants, CRANK, CROSSED, of_geometry, OPEN
from fourbar_ros.mechanisms.four_bar.motion import Loads, make_motion, Motion
from fourbar_ros.mechanisms.kinds import FACTS
from fourbar_ros.mechanisms.loads import derives, with_derived
from fourbar_ros.mechanisms.mechanism import Mechanism
from fourbar_ros.mechanisms.parts import (
    around,
    Arrow,
    Bar,
    BETA,
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
    THETA4,
    total,
)
from fourbar_ros.mechanisms.points import (
    Coefficients,
    crank_motion,
    Curve,
    link_motion,
    LinkMotion,
    point_motion,
    point_of,
)
from fourbar_ros.numerics.exact_sums import difference_of_squares, scaled
from fourbar_ros.numerics.number_types import Function, NumberType, Scalar
import numpy as np

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


class FourBarLinks(Mechanism):
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
    DRAWN = (THETA1, BETA, THETA4)
    LOADS = with_derived(Loads)
    BODIES, EXTERNAL = Bodies, External

    def __post_init__(self) -> None:
        """Check the parameters, and that no link is as long as the other three together."""
        self._check()
        lengths = self.lengths
        longest = max(lengths)
        if fsum(lengths + (-longest, -longest)) <= 0.0:
            raise InvalidParameter(f'a{lengths.index(longest) + 1}', longest,
                                   'the links cannot close: it must be shorter than the other '
                                   f'three together ({fsum(lengths + (-longest,)):.12g})')

    @of_geometry
    def margins(self) -> tuple[float, ...]:
        """
        Return the signed distances [m] from the three change points of Grashof's classification.

        a4 - a1 + a3 - a2, a4 - a1 - a3 + a2 and a2 + a3 - a4 - a1; a1 is the crank, a4 the ground.
        """
        a1, a2, a3, a4 = self.lengths
        return (fsum((a4, -a1, a3, -a2)), fsum((a4, -a1, -a3, a2)), fsum((a2, a3, -a4, -a1)))

    @of_geometry
    def classification(self) -> str:
        """Return the Grashof type by name; 'change point' if two sums of two links are equal."""
        if 0.0 in self.margins:
            return 'change point'
        return _CLASSES[tuple(1 if margin > 0.0 else -1 for margin in self.margins)]

    @derives
    def loads_formula(self, numbers: NumberType, constants: Constants) -> Function:
        """Return (fields of MOTION) -> fields of LOADS for constants of a number type."""
        from fourbar_ros.mechanisms.four_bar.loads import make_loads  # linkages with masses alone
        a1, a2, a3, a4 = constants.lengths
        return make_loads(numbers, a1, a2, a3, a4, constants.bodies, constants.gravity,
                          constants.external, self.input)

    @property
    def connections(self) -> tuple[Connection, ...]:
        """Return which links the four joints connect."""
        return (Connection(GROUND, 'crank'), Connection('crank', 'coupler', (self.a1, 0.0)),
                Connection('coupler', 'output', (self.a2, 0.0), (self.a3, 0.0), turn=pi),
                Connection(GROUND, 'output', (self.a4, 0.0)))

    def link_motion(self, motion: Any, link: str) -> LinkMotion:
        """Return the motion of a link by name, its first joint O1, A or O4."""
        if link == 'output':
            return LinkMotion(self.a4, 0.0, 0.0, 0.0, 0.0, 0.0, motion.cos_y, motion.sin_y,
                              motion.omega4, motion.alpha4)
        crank = crank_motion(motion)
        if link == 'crank':
            return crank
        return LinkMotion(*point_of(crank, self.a1), motion.cos_b, motion.sin_b,
                          motion.omega_beta, motion.alpha_beta)

    def diagram(self, motion: Any) -> Diagram:
        """Return the picture of one pose: three bars, four joints."""
        joints = {'O_1': ORIGIN, 'A': point_motion(self, motion, 'crank', self.a1).place,
                  'B': point_motion(self, motion, 'output', self.a3).place,
                  'O_4': point_motion(self, motion, 'output', 0.0).place}
        bars = tuple(Bar(joints[one], joints[other])
                     for one, other in (('O_1', 'A'), ('A', 'B'), ('O_4', 'B')))
        return Diagram(joints, ('O_1', 'O_4'), bars, (), {'f41': 'O_1', 'f21': 'A', 'f32': 'B',
                                                          'f43': 'O_4'},
                       {'theta1': 'O_1', 'theta4': 'O_4'})

    def velocity_polygon(self, motion: Any) -> list[Arrow]:
        """Return the arrows of V_B = V_A + V_B/A [m/s]."""
        v_a = point_motion(self, motion, 'crank', self.a1).velocity
        v_b = point_motion(self, motion, 'coupler', self.a2).velocity
        return [total(v_a, 'V_A'), total(v_b, 'V_B'), Arrow(v_a, v_b - v_a, 'V_{B/A}', False)]

    def acceleration_polygon(self, motion: Any) -> list[Arrow]:
        """Return the arrows of A_B = A_A + A_B/A, with normal and tangential parts [m/s^2]."""
        crank, coupler, output = (link_motion(self, motion, link)
                                  for link in ('crank', 'coupler', 'output'))
        a_a = point_motion(self, motion, 'crank', self.a1).acceleration
        a_b = point_motion(self, motion, 'coupler', self.a2).acceleration
        return [total(a_a, 'A_A'), *around(ORIGIN, crank, self.a1 * crank.direction, 'A'),
                *around(a_a, coupler, self.a2 * coupler.direction, 'B/A'), total(a_b, 'A_B'),
                *around(ORIGIN, output, self.a3 * output.direction, 'B')]


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
    gravity : tuple of 2 floats
        Field of gravity (x, y) [m/s^2].
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
    gravity: tuple[float, float] = (0.0, 0.0)
    external: External = External()

    input = CRANK
    INPUTS, OUTPUTS = {CRANK: THETA1}, {CRANK: (Output(THETA4, 'velocity_ratio'),)}
    MOTION = Motion

    # --- what it is -----------------------------------------------------------------------------

    @property
    def description(self) -> str:
        """Return its type as text."""
        return self.classification

    @of_geometry
    def closing_ranges(self) -> Ranges:
        """
        Return the ranges (low, high) of theta1 in which the linkage can be assembled [rad].

        One range (-pi, pi) when the crank turns fully, one through 0 or one through pi (high >
        pi), or two. At an end that is no full turn, coupler and output link are in line (toggle).
        """
        return ranges_of(*self.lengths)

    @property
    def singular_inputs(self) -> list[complex]:
        """
        Return the complex theta1 at which coupler and output link are in line, or A meets O4.

        Real ones are the ends of the ranges, to the last bit.
        """
        return singular_angles(*self.lengths)

    @of_geometry
    def output_ranges(self) -> Ranges:
        """Return the ranges of theta4 [rad] over both modes; they end at dead points."""
        # seen from O4, of pi - theta4
        return turned_ranges([(-high, -low) for low, high in ranges_of(self.a3, self.a2, self.a1,
                                                                       self.a4)])

    @property
    def ranges_of_both_modes(self) -> dict[str, Ranges]:
        """Return the ranges of theta4 over both modes by its name."""
        return {'theta4': self.output_ranges}

    @of_geometry
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

    # --- how it moves ---------------------------------------------------------------------------

    def motion_formula(self, numbers: NumberType, constants: Constants) -> Function:
        """Return (position, rate, acceleration) -> fields of MOTION for a number type."""
        a1, a2, a3, a4 = constants.lengths
        return make_motion(numbers, a1, a2, a3, a4, constants.sign)

    def driven_otherwise(self) -> tuple[SeenFromOutput, ...]:
        """Return the same linkage driven at its output link, once for each assembly mode."""
        mirrored = replace(self, a1=self.a3, a3=self.a1, bodies=None, external=External())
        return tuple(SeenFromOutput(mirrored.in_mode(mode), self.a1) for mode in self.MODES)

    def transmission_sine(self, motion: NamedFields) -> Scalar:
        """Return sin(mu), zero at toggles: errors of rates and loads grow as 1/sin(mu)."""
        found: Scalar = motion.sin_mu
        return found

    def term_sizes(self, motion: NamedFields, rate: Scalar, acceleration: Scalar
                   ) -> dict[str, Scalar]:
        """Return {unit: size of the terms}, see :meth:`.Described.term_sizes`, in closed form."""
        gain = min(1.0, self.a1 / min(self.a2, self.a3))
        return {'rad/s': gain * abs(rate), 'rad/s^2': gain * (abs(acceleration) + rate**2)}

    def corners(self, motion: NamedFields) -> tuple[tuple[Scalar, Scalar, float], ...]:
        """Return O1, A, B, O4, each as (x w, y w, w) with w = 1; see Contract.corners."""
        return ((0.0, 0.0, 1.0),
                (self.a1 * np.cos(motion.theta1), self.a1 * np.sin(motion.theta1), 1.0),
                (self.a4 + self.a3 * np.cos(motion.theta4), self.a3 * np.sin(motion.theta4), 1.0),
                (self.a4, 0.0, 1.0))


class DeadPoint(NamedTuple):
    """Crank and coupler in line, one behind the other (stretched) or folded; angles in [rad]."""

    theta1: float
    theta4: float
    stretched: bool


def singular_angles(a1: float, a2: float, a3: float, a4: float) -> list[complex]:
    """
    Return the complex angles x between a1 and a4 at which a2 and a3 are in line, or A meets O4.

    With s1, s2 of (M3) in :mod:`fourbar_ros.mechanisms.loop`, the first from cos^2(x/2) = -s1 /
    (4 a1 a4), the next from sin^2(x/2) = -s2 / (4 a1 a4), the last from q = 0.
    """
    a1, a2, a3, a4 = scaled((a1, a2, a3, a4))
    root = 2.0 * sqrt(a1 * a4)
    s1, s2 = difference_of_squares(a2, a3, a1, a4), difference_of_squares(a1, -a4, a2, -a3)
    outer, inner = sqrt(abs(s1)) / root, sqrt(abs(s2)) / root
    far = (complex(pi, 2.0 * asinh(outer)) if s1 >= 0.0 else complex(
        2.0 * atan2(sqrt(max(difference_of_squares(a2, a3, a1, -a4), 0.0)), sqrt(-s1))))
    near = (complex(0.0, 2.0 * asinh(inner)) if s2 >= 0.0 else complex(
        2.0 * atan2(sqrt(-s2), sqrt(max(difference_of_squares(a1, a4, a2, -a3), 0.0)))))
    return [far, -far, near, -near, complex(0.0, 2.0 * asinh(abs(a1 - a4) / root))]


def ranges_of(a1: float, a2: float, a3: float, a4: float) -> Ranges:
    """Return the ranges [rad] of the angle between a1 and a4; see FourBar.closing_ranges."""
    a1, a2, a3, a4 = scaled((a1, a2, a3, a4))
    s1 = difference_of_squares(a2, a3, a1, a4)
    s2 = difference_of_squares(a1, -a4, a2, -a3)
    far = 2.0 * atan2(sqrt(difference_of_squares(a2, a3, a1, -a4)), sqrt(-s1)) if s1 < 0.0 else pi
    near = (2.0 * atan2(sqrt(-s2), sqrt(difference_of_squares(a1, a4, a2, -a3))) if s2 < 0.0
            else 0.0)
    if s1 >= 0.0:
        return ((-pi, pi),) if s2 >= 0.0 else ((near, 2.0 * pi - near),)
    return ((-far, far),) if s2 >= 0.0 else ((-far, -near), (near, far))


def turned_ranges(ranges: Iterable[tuple[float, float]]) -> Ranges:
    """Return ranges of an angle moved by half a turn, each so that it begins in [-pi, pi)."""
    turned = [(pi + low - turn, pi + high - turn) for low, high in ranges
              for turn in (2.0 * pi if pi + low >= pi else 0.0,)]
    return ((-pi, pi),) if turned == [(0.0, 2.0 * pi)] else tuple(sorted(turned))


class SeenFromOutput:
    """
    A 4R linkage driven at its output link, by the coordinate p = pi - theta4.

    Mirrored at the middle of its ground, x -> a4 - x, the linkage a1, a2, a3, a4 becomes the
    linkage a3, a2, a1, a4. Its crank is then at p, its output link at pi - theta1, and its
    coupler, from B to A, at -beta. Everything not defined here comes from the mirrored linkage, a
    FourBar in one of its assembly modes; ``crank``: a1 [m].
    """

    def __init__(self, mirrored: Any, crank: float) -> None:
        self.mirrored, self._crank = mirrored, crank

    def __getattr__(self, name: str) -> Any:
        """Return an attribute of the mirrored linkage."""
        if name == 'mirrored':              # not set yet while this is copied
            raise AttributeError(name)
        return getattr(self.mirrored, name)

    def in_mode(self, mode: int) -> SeenFromOutput:
        """Return the same in another assembly mode."""
        return SeenFromOutput(self.mirrored.in_mode(mode), self._crank)

    def make_coefficients(self, numbers: NumberType) -> Coefficients:
        """Return p -> coefficients of crank, coupler and output, as those of a mechanism."""
        mirrored, crank, ground = self.mirrored.make_coefficients(numbers), self._crank, self.a4

        def coefficients(position: Scalar) -> list[Curve]:
            """Return the curves of crank, coupler and output, mirrored back."""
            (*_, cos_p, sin_p, _, _), (*_, cos_b, sin_b, d_b, dd_b), (
                *_, cos_x, sin_x, d_x, dd_x) = mirrored(position)
            first = LinkMotion(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -cos_x, sin_x, -d_x, -dd_x)
            return [first, (*point_of(first, crank), cos_b, -sin_b, -d_b, -dd_b),
                    (ground, 0.0, 0.0, 0.0, 0.0, 0.0, -cos_p, sin_p, -1.0, 0.0)]
        return coefficients

    def read_coordinate(self, numbers: NumberType,
                        curves: Sequence[Curve]) -> tuple[Scalar, Scalar, Scalar]:
        """Return p in (-pi, pi] and its two derivatives from coefficients of the links."""
        *_, cosine, sine, turn, bend = curves[2]
        return pi - numbers.atan2(sine, cosine), -turn, -bend
