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

Reactions of an inverted one whose slide is driven come from the ground: in the frame of the bar,
joint forces that grow as one over the sine of the toggle would cancel in the guide force. Block
and bar are one rod r2 e2 from O4 to A. It and the crank need the moments m2 about O4 and m1 about
O1, and the force F of the block on the crank follows as of RRR. Along and across the bar, with the
slide s, the offset h, the force f that the block needs, and the moment m of block and bar each
about its own joint, so that m2 = m + s f_across - h f_along,

    (I1)  p = r2 F.e2 = ((m1 + m2/2) r2^2 + m2/2 (a1^2 - a4^2)) / (a1 a4 sin theta1)
          r2^2 F = (s p + h m2, h p - s m2),   r2^2 = s^2 + h^2
    (I2)  guide force = (h (h f_across + s f_along + p) - s m) / r2^2
"""
from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import atan2, pi, sqrt
from typing import NamedTuple, TYPE_CHECKING

from fourbar_ros.errors import InvalidParameter
from fourbar_ros.mechanics.bodies import Bodies, External, Gravity
from fourbar_ros.mechanisms.closed_forms import (
    bar_ranges,
    reach,
    rod_ranges,
    singular_angles_of_bar,
    singular_angles_of_rod,
    singular_slides,
    slide_ranges,
)
from fourbar_ros.mechanisms.curves import LinkMotion
from fourbar_ros.mechanisms.kind import DrivenMachine, FORCES, FORWARD, Kind, LINKS, results
from fourbar_ros.mechanisms.kinds import FACTS
from fourbar_ros.mechanisms.machine.structure import DyadLengths
from fourbar_ros.mechanisms.parts import (
    BETA,
    CRANK,
    GROUND,
    NamedFields,
    OPEN,
    Output,
    reaction,
    SLIDE,
    SLOT,
    THETA1,
    THETA2,
    THETA3,
    THETA4,
    TRAVEL,
)
from fourbar_ros.numerics.exact_sums import difference_of_squares, scaled
from fourbar_ros.numerics.number_types import exact_sum, LEAST, NumberType, power_of_two, Scalar

if TYPE_CHECKING:
    from fourbar_ros.mechanics.newton_euler import Needs

AT_O = (0.0, 0.0)      # as a place
STRAIGHT = (1.0, 0.0)  # cosine and sine of half an angle of zero


def rods_of_slide(height: Scalar, first: Scalar, second: Scalar) -> DyadLengths:
    """Return the numbers of RRR: rods from a driven slider at this height, from the frame [m]."""
    return DyadLengths(AT_O, AT_O, (first, second), (), (0.0, height, 1.0, 0.0))


def rod_on_line(a1: Scalar, a2: Scalar, height: Scalar) -> DyadLengths:
    """Return the numbers of RRP: a rod a2 from a crank a1 to a line at this height [m]."""
    return DyadLengths((a1, 0.0), (0.0, height), (a2, 1.0, 0.0), (),
                       (a1, height, STRAIGHT, 0.0, 0.0, 0.0))


def bar_through_block(a1: Scalar, a4: Scalar, offset: Scalar) -> DyadLengths:
    """Return the numbers of RPR: a block on a crank a1, on a bar from a4 on [m]."""
    return DyadLengths((a1, 0.0), (a4, 0.0), (offset,), (), (a1, a4, STRAIGHT, 1.0, 0.0))


class OffsetSlide(Kind):
    """Base of the kinds whose lengths p, r, e make a triangle p e^{ix} + r e^{ib} = s + i e."""

    INPUTS = {CRANK: THETA1, SLIDE: TRAVEL}
    MARGIN_SIGNS = ((-1, 1, -1), (1, -1, -1))

    def __post_init__(self) -> None:
        """Check what is given, and that both rods together reach over the offset e."""
        self._check()
        (p, r, e), (p_name, r_name, _) = self.lengths, self.length_names
        if exact_sum((p, r, -abs(e))) <= 0.0:
            raise InvalidParameter('offset', e, 'the links cannot close: it must be shorter than '
                                   f'{p_name} + {r_name} ({p + r:.12g})')
        self._check_stroke()


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
    gravity : tuple of 2 floats, or Base
        Field of gravity (x, y) [m/s^2], or the motion of the base.
    external : External
        Forces and couples on coupler and slider (``output``), as gas forces.
    stroke : tuple of 2 floats, optional
        Shortest and longest slide [m] of a driven slide, as a cylinder has; not given: all where
        the links close.

    Guide force: of the ground on the slider, + along y; guide couple: of the ground on the slider
    about B.

    """

    a1: float
    a2: float
    offset: float = 0.0
    mode: int = OPEN
    input: str = CRANK
    bodies: Bodies | None = None
    gravity: Gravity = (0.0, 0.0)
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
             TRAVEL: 'slider', BETA: 'coupler'}
    CLASSES = {(1, -1): 'Grashof crank-slider', (-1, 1): 'Grashof rocker-slider',
               (-1, -1): 'non-Grashof rocker-slider'}
    DRAWN = (THETA1, BETA, TRAVEL)
    RATIOS = {'crank_ratio': THETA1, 'coupler_ratio': BETA, 'slide_ratio': TRAVEL}
    DIRECTIONS = {'x': THETA1, 'b': BETA, '2': THETA2}
    OUTPUT = ''
    DRIVES = {
        CRANK: DrivenMachine(
            (GROUND, 'crank', 'coupler', 'output'), 'RRP',
            lambda lengths: rod_on_line(*lengths), rod_ranges, singular_angles_of_rod,
            {**FORWARD, 'guide_force': ('second_normal', 1.0),
             'guide_couple': ('second_couple', 1.0)},
            ('cos_b', 1.0), lambda f, a, d, _: (                                        # (C2)
                a[0] * f(d[THETA2][0]) + a[1] + f(a[2] * d[BETA][1])) / (f(d[BETA][0]) + LEAST),
            slides=(TRAVEL,)),
        SLIDE: DrivenMachine(
            (GROUND, 'output', 'coupler', 'crank'), 'RRR',
            lambda lengths: rods_of_slide(lengths[2], lengths[1], lengths[0]),
            slide_ranges, singular_slides,
            {'f41': ('second', 1.0), 'f21': ('inner', -1.0), 'f32': ('first', 1.0),
             'f43': ('base', 1.0), 'guide_force': ('base_normal', 1.0),
             'guide_couple': ('base_couple', 1.0)},
            ('sin_2', 1.0), lambda f, a, d, _: (                                        # (C2)
                a[0] * f(d[THETA2][0]) + a[1] + f(a[2] * d[BETA][1])) / (
                a[0] * f(d[THETA2][1]) + LEAST),
            lambda f, a, d: (f(d[THETA2][1]), d[THETA2][0]),
            reversed=('coupler',), start=lambda lengths: (0.0, lengths[2]))}

    def stalls(self, side: float) -> Iterator[SliderDeadPoint]:
        """Yield up to two poses where the slider of a driven crank turns back."""
        unit = power_of_two(*self.lengths)
        a1, a2, e = (length / unit for length in self.lengths)
        folded, stretched = reach(a1, a2, e)
        for is_stretched, r, square in ((True, a1 + a2, stretched), (False, a1 - a2, folded)):
            if square > 0.0 and self.input == CRANK:
                x = side * sqrt(square) if is_stretched else -side * sqrt(square)       # of A
                sign = -1.0 if r < 0.0 else 1.0     # B is on the other side of O1
                yield SliderDeadPoint(atan2(sign * e, x), unit * sign * x, is_stretched)


class InvertedDeadPoint(NamedTuple):
    """Crank square to the bar: the bar turns back."""

    theta1: float     # [rad]
    theta4: float     # [rad]


class DrivenCylinder(DrivenMachine):
    """The inverted slider-crank that is driven at its slide; its reactions by (I1) and (I2)."""

    def forces(self, n: NumberType, numbers: DyadLengths, lengths: Mapping[str, Scalar],
               links: Mapping[str, LinkMotion], needs: Mapping[str, Needs], sine: Scalar,
               slides: Sequence[Scalar], drive: Scalar) -> dict[str, Scalar]:
        """Return {field: reaction} at all joints."""
        # of linkages with masses alone
        from fourbar_ros.numerics.vectors import Vector
        (f1, m1), (f, m_block), (f_bar, m_bar) = [needs[link] for link in LINKS]
        a1, a4, (s,), h = lengths['crank'], lengths[GROUND], slides, numbers.shape[1]
        crank, bar = links['crank'], Vector(links['output'].cosine, links['output'].sine)
        f_along, f_across, m, square = f.dot(bar), bar.cross(f), m_bar + m_block, s * s + h * h
        m2 = m + s * f_across - h * f_along
        half = 0.5 * m2
        p = (m1 + half) * square + half * ((a1 - a4) * (a1 + a4))                          # (I1)
        p = p / (a1 * a4 * crank.sine)
        on_crank = (bar * (s * p + h * m2) + bar.normal * (h * p - s * m2)) / square
        guide = (h * (h * f_across + s * f_along + p) - s * m) / square                    # (I2)
        on_block = bar * drive + bar.normal * guide
        forces = dict(zip(FORCES, (f1 - on_crank, on_crank, on_block, f_bar + on_block)))
        found = {'guide_force': guide, 'guide_couple': m_block}
        for name, force in forces.items():
            found |= {f'{name}_x': force.x, f'{name}_y': force.y, name: n.hypot(force.x, force.y)}
        return {name: found[name] for name in self.fields_of_loads()}


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
    gravity : tuple of 2 floats, or Base
        Field of gravity (x, y) [m/s^2], or the motion of the base.
    external : External
        Forces and couples on block (``coupler``) and bar (``output``).
    stroke : tuple of 2 floats, optional
        Shortest and longest slide [m] of a driven slide, as a cylinder has; not given: all where
        the links close.

    Guide force: of the bar on the block, + to the left of the bar; guide couple: of the bar on the
    block about A. The driving force pushes the block along the bar as ``slide`` grows, and the bar
    back.

    """

    a1: float
    a4: float
    offset: float = 0.0
    mode: int = OPEN
    input: str = CRANK
    bodies: Bodies | None = None
    gravity: Gravity = (0.0, 0.0)
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
    CLASSES = {(1, -1): 'Grashof crank-rocker', (-1, 1): 'Grashof double-crank',
               (-1, -1): 'non-Grashof double-rocker'}
    DRAWN = (THETA1, THETA4, TRAVEL)
    RATIOS = {'crank_ratio': THETA1, 'output_ratio': THETA4, 'slide_ratio': TRAVEL}
    DIRECTIONS = {'x': THETA1, 'y': THETA4, '2': THETA2}
    COUPLER = 'y'
    DRIVES = {
        CRANK: DrivenMachine(
            (GROUND, 'crank', 'coupler', 'output'), 'RPR',
            lambda lengths: bar_through_block(*lengths), bar_ranges, singular_angles_of_bar,
            {**FORWARD, 'guide_force': ('inner_normal', 1.0),
             'guide_couple': ('inner_couple', 1.0)},
            ('', 1.0), lambda f, a, d, s: (                                             # (C3)
                a[0] * f(d[THETA2][1]) + a[1] * f(d[THETA4][1]) + f(a[2])) / (
                f(s[TRAVEL][0]) + LEAST),
            slides=(TRAVEL,)),
        SLIDE: DrivenCylinder(
            ('output', 'coupler', 'crank', GROUND), 'RRR',
            lambda lengths: rods_of_slide(lengths[2], lengths[0], lengths[1]),
            slide_ranges, singular_slides,
            {'f41': ('inner', 1.0), 'f21': ('first', 1.0), 'f32': ('base', 1.0),
             'f43': ('second', -1.0), 'guide_force': ('base_normal', 1.0),
             'guide_couple': ('base_couple', 1.0)},
            ('sin_x', -1.0), lambda f, a, d, _: (                                       # (C3)
                a[0] * f(a[0] - a[1] * d[THETA1][0]) + a[1] * f(a[1] - a[0] * d[THETA1][0])
                + a[2] * a[2]) / (a[0] * a[1] * f(d[THETA1][1]) + LEAST),
            lambda f, a, d: (a[1] * f(d[THETA1][1]), a[0] - a[1] * d[THETA1][0]),
            slides=(TRAVEL,), reversed=('crank', GROUND),
            start=lambda lengths: (0.0, lengths[2]), sign=-1.0)}

    def stalls(self, side: float) -> Iterator[InvertedDeadPoint]:
        """Yield up to two poses where the bar of a driven crank turns back."""
        a1, a4, h = scaled(self.lengths)
        for sign in (1.0, -1.0):                       # A = +-i a1 e^{iy}
            rise = h - sign * a1        # a4 sin y
            run = difference_of_squares(a4, 0.0, h, -sign * a1)
            if run > 0.0 and self.input == CRANK:
                cosine, sine = -side * sqrt(run), rise
                yield InvertedDeadPoint(atan2(sign * cosine, -sign * sine), atan2(sine, cosine))

    def read_coordinate(self, n: NumberType,
                        curves: Sequence[LinkMotion]) -> tuple[Scalar, Scalar, Scalar]:
        """Return the input and its two derivatives; ``curves``: motions of the links by it."""
        if not self.is_driven_by_slide:
            return super().read_coordinate(n, curves)
        # the slide is the part of O4-A along the bar; the block has its joint at A and turns
        # with the bar
        link = curves[1]
        x, cosine, sine, turn = link.x - self.a4, link.cosine, link.sine, link.omega
        along, across = x * cosine + link.y * sine, link.y * cosine - x * sine
        d_along = link.v_x * cosine + link.v_y * sine
        d_across = link.v_y * cosine - link.v_x * sine
        return (along, d_along + turn * across,
                link.a_x * cosine + link.a_y * sine + 2.0 * turn * d_across + link.alpha * across
                - turn * turn * along)

    def transmission_sine(self, motion: NamedFields) -> Scalar:
        """Return slide / |A O4|, or of a driven slide a4 sin(theta1) / |A O4|: zero at toggles."""
        size = max(map(abs, self.lengths))
        slide, aside = motion.slide / size, self.offset / size
        opposite = slide if self.input == CRANK else self.a4 / size * motion.sin_x
        sine: Scalar = opposite / (slide * slide + aside * aside)**0.5
        return sine


class YokeDeadPoint(NamedTuple):
    """Crank along the guide: the yoke turns back."""

    theta1: float     # [rad]
    slide: float      # [m]


@dataclass(frozen=True)
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
    gravity : tuple of 2 floats, or Base
        Field of gravity (x, y) [m/s^2], or the motion of the base.
    external : External
        Forces and couples on block (``coupler``) and yoke (``output``).
    stroke : tuple of 2 floats, optional
        Shortest and longest slide [m] of a driven slide; not given: [-a1, a1].

    """

    a1: float
    offset: float = 0.0
    mode: int = OPEN
    input: str = CRANK
    bodies: Bodies | None = None
    gravity: Gravity = (0.0, 0.0)
    external: External = External()
    stroke: tuple[float, float] | None = None

    TITLE = 'Scotch yoke'
    TEXT, LENGTHS, LINKS, JOINTS = FACTS['scotch_yoke'][:4]
    INPUTS = {CRANK: THETA1, SLIDE: TRAVEL}
    OUTPUTS = {CRANK: (Output(TRAVEL, 'slide_ratio'),), SLIDE: (Output(THETA1, 'crank_ratio'),)}
    REACTIONS = (reaction('O1', 'ground on crank', 'f41'), reaction('A', 'block on crank', 'f21'),
                 reaction('slot', 'yoke on block', 'f32', 'slot_couple'),
                 reaction('guide', 'guide on yoke', 'f43', 'guide_couple'))
    PARTS = {THETA1: 'crank', THETA2: 'block to crank', TRAVEL: 'yoke',
             SLOT: 'block in the slot'}
    DRAWN = (THETA1, TRAVEL, SLOT)
    RATIOS = {'crank_ratio': THETA1, 'slide_ratio': TRAVEL}
    DIRECTIONS = {'x': THETA1}
    COUPLER = OUTPUT = ''
    DRIVES = {
        CRANK: DrivenMachine(
            (GROUND, 'crank', 'coupler', 'output'), 'RPP',
            lambda lengths: DyadLengths((lengths[0], 0.0), (0.0, lengths[1]),
                                        (1.0, 0.0, 0.0, 1.0)),
            lambda *_: ((-pi, pi),), lambda *_: [],
            {**FORWARD, 'guide_force': ('second_normal', 1.0),
             'guide_couple': ('second_couple', 1.0), 'slot_couple': ('inner_couple', 1.0)},
            ('', 1.0), lambda f, a, d, _: a[0] * f(d[THETA1][0]),                      # (C4)
            slides=(SLOT, TRAVEL)),
        SLIDE: DrivenMachine(
            (GROUND, 'output', 'crank', 'coupler'), 'RRP',
            lambda lengths: DyadLengths(AT_O, AT_O, (lengths[0], 0.0, 1.0)),
            lambda a1, _: ((-a1, a1),), lambda a1, _: [complex(-a1), complex(a1)],
            {'f41': ('first', 1.0), 'f21': ('inner', 1.0), 'f32': ('second', 1.0),
             'f43': ('base', 1.0), 'guide_force': ('base_normal', 1.0),
             'guide_couple': ('base_couple', 1.0), 'slot_couple': ('second_couple', 1.0)},
            ('sin_x', 1.0), lambda f, a, d, _: f(d[THETA1][0] / d[THETA1][1]),           # (C4)
            lambda f, a, d: (f(d[THETA1][1]), d[THETA1][0]), slides=(SLOT,), first=0,
            start=lambda lengths: (0.0, lengths[1]))}
    MARGIN_SIGNS, CLASSES = ((1, 0),), {(1,): 'harmonic motion'}

    def __post_init__(self) -> None:
        self._check()
        self._check_stroke()

    @property
    def modes(self) -> dict[int, str]:
        """Return the assembly modes: two for a driven slide, one for a driven crank."""
        return {1: '1', 2: '2'} if self.input == SLIDE else {2: '2, the only one'}

    def stalls(self, side: float) -> tuple[YokeDeadPoint, ...]:
        """Return where the yoke of a driven crank turns back."""
        return ((YokeDeadPoint(0.0, self.a1), YokeDeadPoint(pi, -self.a1)) if self.input == CRANK
                else ())


results(SliderCrank, 'SliderCrankMotion', 'SliderLoads')
results(InvertedSlider, 'InvertedSliderMotion', 'SliderLoads')
results(ScotchYoke, 'ScotchYokeMotion', 'ScotchYokeLoads')
