# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The kinds with a slide: slider-crank, inverted slider-crank, Scotch yoke.

Each has names and pictures of its own, classes, and ranges and dead points in closed form; how it
moves and what its joints bear follows from the machine that it is, see :mod:`.kind`. The condition
of the output, relative errors of the lengths -> its error [rad or m], is exact:

    (C2)  slider-crank: (a1 |cos theta2| + a2 + |offset sin beta|) over |cos beta| of a driven
          crank, over a1 |sin theta2| of a driven slide
    (C3)  inverted one: (a1 |sin theta2| + a4 |sin theta4| + |offset|) / |slide|; of a driven slide
          (a1 |a1 - a4 cos theta1| + a4 |a4 - a1 cos theta1| + offset^2) / (a1 a4 |sin theta1|)
    (C4)  yoke: a1 |cos theta1|; of a driven slide 1 / |tan theta1|

The guide force of an inverted one whose slide is driven comes from moments: in the sum of forces,
those that grow as one over the sine of the toggle would cancel, next to it to 137 eps times the
condition and more. With the force F of the block on the crank, the slide s and the offset h, the
force f that the block needs, along and across the bar, and the moment m that block and bar need,
each about its own joint,

    (I1)  p = F . (A - O4)
    (I2)  guide force = (h (h f_across + s f_along + p) - s m) / (s^2 + h^2)
"""
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from math import atan2, pi, sqrt
from typing import Any

from fourbar_ros.errors import InvalidParameter
from fourbar_ros.mechanics.bodies import Bodies, External, Gravity
from fourbar_ros.mechanics.newton_euler import Needs, Vector
from fourbar_ros.mechanisms import closed_forms, kind, parts
from fourbar_ros.mechanisms.curves import LinkMotion
from fourbar_ros.mechanisms.evaluation import Constants
from fourbar_ros.mechanisms.kind import Coordinates, DrivenMachine, Kind, Lengths, one_dyad
from fourbar_ros.mechanisms.machine.structure import DyadLengths
from fourbar_ros.mechanisms.parts import BETA, CRANK, SLIDE, THETA1, THETA2, THETA4, TRAVEL
from fourbar_ros.numerics import number_types
from fourbar_ros.numerics.number_types import exact_sum, NumberType, Operation, REAL, Scalar, TINY

AT_O = (0.0, 0.0)      # as a place
GUIDE = parts.Length('offset', 'y of the guide', signed=True)
OF_DRIVEN_SLIDER = {'guide_force': 'base_normal', 'guide_couple': 'base_couple'}
OF_CRANK, OF_SLIDE = parts.Output(THETA1, 'crank_ratio'), parts.Output(TRAVEL, 'slide_ratio')
STRAIGHT = (1.0, 0.0)  # cosine and sine of half an angle of zero


def rods_of_slide(height: Scalar, first: Scalar, second: Scalar) -> DyadLengths:
    """Return the lengths of RRR: rods from a driven slider at this height, from the frame [m]."""
    return DyadLengths(AT_O, AT_O, (first, second), (), (0.0, height, 1.0, 0.0))


# How p, r and e, with p e^{ix} + r e^{ib} = s + i e, enter the margins.
MARGINS_OF_TRIANGLE = ((-1, 1, -1), (1, -1, -1))


def require_reach(linkage: Kind) -> None:
    (p, r, e), (p_name, r_name, _) = linkage.lengths, linkage.length_names
    if exact_sum((p, r, -abs(e))) <= 0.0:
        raise InvalidParameter('offset', e, 'the links cannot close: it must be shorter than '
                               f'{p_name} + {r_name} ({p + r:.12g})')


@dataclass(frozen=True, repr=False)
class SliderCrank(Kind):
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
    external : External
        Forces and couples on coupler and slider (``output``), as gas forces.
    stroke : tuple of 2 floats, optional
        Lowest and highest theta1 [rad], in any turn, or slide [m], as a cylinder has; not given:
        all at which the links close.
    gravity, elements, friction, joint_names
        As of :class:`.FourBar`.

    Guide force: of the ground on the slider, + along y; guide couple: of the ground on the slider
    about B.

    """

    a1: float
    a2: float
    offset: float = 0.0
    mode: int = parts.OPEN
    input: str = CRANK
    bodies: Bodies | None = None
    gravity: Gravity = (0.0, 0.0)
    external: External = External()
    stroke: tuple[float, float] | None = None
    elements: tuple[Any, ...] = ()
    friction: Any = ()
    joint_names: Mapping[str, str] = field(default_factory=dict, compare=False)

    _require_closing, MARGIN_SIGNS = require_reach, MARGINS_OF_TRIANGLE
    TITLE = 'slider-crank'
    TEXT = 'a slider on a guide parallel to x'
    LENGTHS = (kind.CRANK_LENGTH, kind.COUPLER_LENGTH, GUIDE)
    LINKS = (kind.CRANK_LINK, parts.Link('coupler', 'coupler', 'A', 'a2'),
             parts.Link('output', 'slider', 'B', turns=False))
    JOINTS = (kind.JOINT_O1, parts.Joint('A', THETA2, 'rod'),
              parts.Joint('B', parts.THETA3, 'pin'), parts.Joint('guide', TRAVEL, 'slider'))
    OUTPUTS = {CRANK: (OF_SLIDE,), SLIDE: (OF_CRANK,)}
    REACTIONS = (parts.Reaction('O1', 'ground on crank', 'f41'),
                 parts.Reaction('A', 'coupler on crank', 'f21'),
                 parts.Reaction('B', 'slider on coupler', 'f32'),
                 parts.Reaction('guide', 'guide on slider', 'f43', 'guide_couple'))
    PARTS = {THETA1: 'crank', THETA2: 'coupler to crank', parts.THETA3: 'slider to coupler',
             TRAVEL: 'slider', BETA: 'coupler'}
    CLASSES = {(1, -1): 'Grashof crank-slider', (-1, 1): 'Grashof rocker-slider',
               (-1, -1): 'non-Grashof rocker-slider'}
    DRAWN = (THETA1, BETA, TRAVEL)
    RATIOS = {'crank_ratio': THETA1, 'coupler_ratio': BETA, 'slide_ratio': TRAVEL}
    DIRECTIONS = {'x': THETA1, 'b': BETA}
    OUTPUT = ''
    DRIVES = {
        CRANK: DrivenMachine(
            one_dyad(CRANK, parts.GROUND, 'crank', 'RRP', ('coupler', 'output')),
            lambda a1, a2, offset: DyadLengths((a1, 0.0), (0.0, offset), (a2, 1.0, 0.0), (),
                                               (a1, offset, STRAIGHT, 0.0, 0.0, 0.0)),
            closed_forms.rod_ranges, closed_forms.singular_angles_of_rod,
            {**kind.FORWARD, 'guide_force': 'dyad_second_normal',
             'guide_couple': 'dyad_second_couple'}, slides=(TRAVEL,)),
        SLIDE: DrivenMachine(
            one_dyad(SLIDE, parts.GROUND, 'output', 'RRR', ('coupler', 'crank')),
            lambda a1, a2, offset: rods_of_slide(offset, a2, a1),
            closed_forms.slide_ranges, closed_forms.singular_slides,
            {'f41': 'dyad_second', 'f21': '-dyad_inner', 'f32': 'dyad_first', 'f43': 'base',
             **OF_DRIVEN_SLIDER}, reversed={'coupler': 'a2'},
            transmission=lambda _, coordinates: coordinates[THETA2])}

    def condition(self, fabs: Operation, lengths: Lengths, coordinates: Coordinates) -> Scalar:
        a1, a2, offset = lengths
        (cos_2, sin_2, *_), (cos_b, sin_b, *_) = coordinates[THETA2], coordinates[BETA]
        return (a1 * fabs(cos_2) + a2 + fabs(offset * sin_b)) / (                         # (C2)
            (fabs(cos_b) if self.input == CRANK else a1 * fabs(sin_2)) + TINY)

    def stalls(self, side: float) -> Iterator[tuple[Any, ...]]:
        """Yield where coupler and crank are in line, or driven by a slide square to each other."""
        unit = number_types.power_of_two(*self.lengths)
        a1, a2, e = (length / unit for length in self.lengths)
        if self.input == SLIDE:         # the coupler points along y, up or down
            for up in (1.0, -1.0):
                rise, run = e - up * a2, REAL.difference_of_squares(a1, 0.0, e, -up * a2)
                if run > 0.0:
                    x = up * side * sqrt(run)
                    yield unit * x, atan2(rise, x)
            return
        folded, stretched = closed_forms.reach(a1, a2, e)
        for is_stretched, r, square in ((True, a1 + a2, stretched), (False, a1 - a2, folded)):
            if square > 0.0:
                x = side * sqrt(square) if is_stretched else -side * sqrt(square)       # of A
                sign = -1.0 if r < 0.0 else 1.0     # B is on the other side of O1
                yield atan2(sign * e, x), unit * sign * x, is_stretched


def angle_at_pin(lengths: Lengths, coordinates: Coordinates) -> Sequence[Scalar]:
    """Return cosine and sine of the angle at A from O1 to O4, times a length."""
    (a1, a4, _), (cosine, sine, *_) = lengths, coordinates[THETA1]
    return a1 - a4 * cosine, a4 * sine


def guide_force_by_moments(n: NumberType, constants: Constants, m: parts.NamedFields,
                           needs: Mapping[str, Needs], loads: Mapping[str, Scalar]
                           ) -> Mapping[str, Scalar]:
    (f, m_block), (_, m_bar), bar = needs['coupler'], needs['output'], Vector(m.cos_y, m.sin_y)
    per_unit = 1.0 / n.power_of_two(*constants.lengths)
    s, h = m.slide * per_unit, constants.lengths[2] * per_unit
    on_crank = Vector(loads['dyad_first_x'], loads['dyad_first_y'])
    p = on_crank.dot(bar * s + bar.normal * h)                                             # (I1)
    guide = (h * (h * bar.cross(f) + s * f.dot(bar) + p)
             - s * (m_block + m_bar)) / (s * s + h * h)                                    # (I2)
    force = bar * loads['driving_force'] + bar.normal * guide
    return {'base_x': force.x, 'base_y': force.y, 'base': n.hypot(force.x, force.y),
            'base_normal': guide}


@dataclass(frozen=True, repr=False)
class InvertedSlider(Kind):
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
        0. Slide input: 2 has sin(theta1) > 0 (A to the left of O1-O4), 1 < 0.
    input : str
        'crank' or 'slide': the driven coordinate, theta1 or slide.
    bodies : Bodies, optional
        Crank from O1, block (``coupler``) from A along the bar, bar (``output``) from O4 along
        itself.
    external : External
        Forces and couples on block (``coupler``) and bar (``output``).
    gravity, stroke, elements, friction
        As of :class:`SliderCrank`.

    Guide force: of the bar on the block, + to the left of the bar; guide couple: of the bar on the
    block about A. The driving force pushes the block along the bar as ``slide`` grows, and the bar
    back.

    """

    a1: float
    a4: float
    offset: float = 0.0
    mode: int = parts.OPEN
    input: str = CRANK
    bodies: Bodies | None = None
    gravity: Gravity = (0.0, 0.0)
    external: External = External()
    stroke: tuple[float, float] | None = None
    elements: tuple[Any, ...] = ()
    friction: Any = ()
    joint_names: Mapping[str, str] = field(default_factory=dict, compare=False)

    _require_closing, MARGIN_SIGNS = require_reach, MARGINS_OF_TRIANGLE
    TITLE = 'inverted slider-crank'
    TEXT = 'a block on a bar that turns about O4, e.g. an oscillating cylinder'
    LENGTHS = (kind.CRANK_LENGTH, kind.GROUND_LENGTH, parts.Length(
        'offset', 'distance of the path of A on the bar from O4, positive to the left of the bar',
        signed=True))
    LINKS = (kind.CRANK_LINK, parts.Link('coupler', 'block', 'A'),
             parts.Link('output', 'bar', 'O4'))
    JOINTS = (kind.JOINT_O1, parts.Joint('A', THETA2, 'block'),
              parts.Joint('slide', TRAVEL, 'slide'), parts.Joint('O4', THETA4, 'bar'))
    OUTPUTS = {CRANK: (parts.Output(THETA4, 'output_ratio'),), SLIDE: (OF_CRANK,)}
    REACTIONS = (parts.Reaction('O1', 'ground on crank', 'f41'),
                 parts.Reaction('A', 'block on crank', 'f21'),
                 parts.Reaction('slide', 'bar on block', 'f32', 'guide_couple'),
                 parts.Reaction('O4', 'ground on bar', 'f43'))
    PARTS = {THETA1: 'crank', THETA2: 'block to crank', THETA4: 'bar', TRAVEL: 'block on the bar'}
    SLIDE_DIRECTION = ('cos_y', 'sin_y')
    CLASSES = {(1, -1): 'Grashof crank-rocker', (-1, 1): 'Grashof double-crank',
               (-1, -1): 'non-Grashof double-rocker'}
    DRAWN = (THETA1, THETA4, TRAVEL)
    RATIOS = {'crank_ratio': THETA1, 'output_ratio': THETA4, 'slide_ratio': TRAVEL}
    DIRECTIONS = {'x': THETA1, 'y': THETA4}
    COUPLER = 'y'
    DRIVES = {
        CRANK: DrivenMachine(
            one_dyad(CRANK, parts.GROUND, 'crank', 'RPR', ('coupler', 'output')),
            lambda a1, a4, offset: DyadLengths((a1, 0.0), (a4, 0.0), (offset,), (),
                                               (a1, a4, STRAIGHT, 1.0, 0.0)),
            closed_forms.bar_ranges, closed_forms.singular_angles_of_bar,
            {**kind.FORWARD, 'guide_force': 'dyad_inner_normal',
             'guide_couple': 'dyad_inner_couple'}, slides=(TRAVEL,)),
        SLIDE: DrivenMachine(
            one_dyad(SLIDE, 'output', 'coupler', 'RRR', ('crank', parts.GROUND)),
            lambda a1, a4, offset: rods_of_slide(offset, a1, a4),
            closed_forms.slide_ranges, closed_forms.singular_slides,
            {'f41': 'dyad_inner', 'f21': 'dyad_first', 'f32': 'base', 'f43': '-dyad_second',
             **OF_DRIVEN_SLIDER}, reversed={'crank': 'a1', parts.GROUND: 'a4'}, sign=-1.0,
            transmission=angle_at_pin, corrected=guide_force_by_moments)}

    def condition(self, fabs: Operation, lengths: Lengths, coordinates: Coordinates) -> Scalar:
        (a1, a4, offset), (cosine, sine, *_) = lengths, coordinates[THETA1]
        if self.input == CRANK:
            error = (a1 * fabs(coordinates[THETA2][1]) + a4 * fabs(coordinates[THETA4][1])
                     + fabs(offset))
            size = fabs(coordinates[TRAVEL][0])
        else:
            error = a1 * fabs(a1 - a4 * cosine) + a4 * fabs(a4 - a1 * cosine) + offset * offset
            size = a1 * a4 * fabs(sine)
        return error / (size + TINY)                                                      # (C3)

    def stalls(self, side: float) -> Iterator[tuple[float, float]]:
        """Yield where the crank is square to the bar, or driven by the slide A at its foot."""
        a1, a4, h = number_types.scaled(self.lengths)
        if self.input == SLIDE:         # A is as near to O4 as on any crank
            near, far = closed_forms.reach(a1, a4, h)
            if near < 0.0:
                yield (0.0, side * 2.0 * atan2(sqrt(-near), sqrt(far)))
            return
        for sign in (1.0, -1.0):                       # A = +-i a1 e^{iy}
            rise = h - sign * a1        # a4 sin y
            run = REAL.difference_of_squares(a4, 0.0, h, -sign * a1)
            if run > 0.0:
                cosine, sine = -side * sqrt(run), rise
                yield atan2(sign * cosine, -sign * sine), atan2(sine, cosine)

    def read_coordinate(self, n: NumberType,
                        curves: Sequence[LinkMotion]) -> tuple[Scalar, Scalar, Scalar]:
        if not self.is_driven_by_slide:
            return super().read_coordinate(n, curves)
        # The slide is the part of O4-A along the bar, with lengths and curves in [m] as the ground
        # sees them. The block has its joint at A and turns with the bar.
        block = curves[kind.LINKS.index('coupler')]
        x, cosine, sine, turn = block.x - self.a4, block.cosine, block.sine, block.omega
        along, across = x * cosine + block.y * sine, block.y * cosine - x * sine
        v_along = block.v_x * cosine + block.v_y * sine
        v_across = block.v_y * cosine - block.v_x * sine
        velocity = v_along + turn * across
        acceleration = (block.a_x * cosine + block.a_y * sine + 2.0 * turn * v_across
                        + block.alpha * across - turn * turn * along)
        return along, velocity, acceleration


@dataclass(frozen=True, repr=False)
class ScotchYoke(Kind):
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
    external : External
        Forces and couples on block (``coupler``) and yoke (``output``).
    stroke : tuple of 2 floats, optional
        Lowest and highest theta1 [rad], in any turn, or slide [m]; not given: all.
    gravity, elements, friction, joint_names
        As of :class:`.FourBar`.

    """

    a1: float
    offset: float = 0.0
    mode: int = parts.OPEN
    input: str = CRANK
    bodies: Bodies | None = None
    gravity: Gravity = (0.0, 0.0)
    external: External = External()
    stroke: tuple[float, float] | None = None
    elements: tuple[Any, ...] = ()
    friction: Any = ()
    joint_names: Mapping[str, str] = field(default_factory=dict, compare=False)

    TITLE = 'Scotch yoke'
    TEXT = 'a crank pin in the slot of a yoke that slides parallel to x, a Scotch yoke'
    LENGTHS = (kind.CRANK_LENGTH, GUIDE)
    LINKS = (kind.CRANK_LINK, parts.Link('coupler', 'block', 'A', turns=False),
             parts.Link('output', 'yoke', 'B', turns=False))
    JOINTS = (kind.JOINT_O1, parts.Joint('A', THETA2, 'block'),
              parts.Joint('slot', parts.SLOT, 'slot'), parts.Joint('guide', TRAVEL, 'yoke'))
    OUTPUTS = {CRANK: (OF_SLIDE,), SLIDE: (OF_CRANK,)}
    REACTIONS = (parts.Reaction('O1', 'ground on crank', 'f41'),
                 parts.Reaction('A', 'block on crank', 'f21'),
                 parts.Reaction('slot', 'yoke on block', 'f32', 'slot_couple'),
                 parts.Reaction('guide', 'guide on yoke', 'f43', 'guide_couple'))
    PARTS = {THETA1: 'crank', THETA2: 'block to crank', TRAVEL: 'yoke',
             parts.SLOT: 'block in the slot'}
    DRAWN = (THETA1, TRAVEL, parts.SLOT)
    RATIOS = {'crank_ratio': THETA1, 'slide_ratio': TRAVEL}
    DIRECTIONS = {'x': THETA1}
    COUPLER = OUTPUT = ''
    DRIVES = {
        CRANK: DrivenMachine(
            one_dyad(CRANK, parts.GROUND, 'crank', 'RPP', ('coupler', 'output')),
            lambda a1, offset: DyadLengths((a1, 0.0), (0.0, offset), (1.0, 0.0, 0.0, 1.0)),
            lambda *_: ((-pi, pi),), lambda *_: [],
            {**kind.FORWARD, 'guide_force': 'dyad_second_normal',
             'guide_couple': 'dyad_second_couple',
             'slot_couple': 'dyad_inner_couple'}, slides=(parts.SLOT, TRAVEL)),
        SLIDE: DrivenMachine(
            one_dyad(SLIDE, parts.GROUND, 'output', 'RRP', ('crank', 'coupler'), first=0),
            lambda a1, _: DyadLengths(AT_O, AT_O, (a1, 0.0, 1.0)),
            lambda a1, _: ((-a1, a1),), lambda a1, _: [complex(-a1), complex(a1)],
            {'f41': 'dyad_first', 'f21': 'dyad_inner', 'f32': 'dyad_second', 'f43': 'base',
             **OF_DRIVEN_SLIDER, 'slot_couple': 'dyad_second_couple'},
            slides=(parts.SLOT,), transmission=lambda _, coordinates: coordinates[THETA1])}
    MARGIN_SIGNS, CLASSES = ((1, 0),), {(1,): 'harmonic motion'}

    @property
    def modes(self) -> dict[int, str]:
        return {1: '1', 2: '2'} if self.input == SLIDE else {2: '2, the only one'}

    def condition(self, fabs: Operation, lengths: Lengths, coordinates: Coordinates) -> Scalar:
        cosine, sine, *_ = coordinates[THETA1]
        return (lengths[0] * fabs(cosine) if self.input == CRANK                          # (C4)
                else fabs(cosine / sine))

    def stalls(self, side: float) -> tuple[tuple[float, float], ...]:
        return ((0.0, self.a1), (pi, -self.a1)) if self.input == CRANK else ()


kind.results(SliderCrank, 'SliderCrankMotion', 'SliderLoads')
kind.results(InvertedSlider, 'InvertedSliderMotion', 'SliderLoads')
kind.results(ScotchYoke, 'ScotchYokeMotion', 'ScotchYokeLoads')
