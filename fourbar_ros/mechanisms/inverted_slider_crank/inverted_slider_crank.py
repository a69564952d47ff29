"""
The inverted slider-crank RPR with offset: rocking block, oscillating cylinder; stable in the last bits.

O1 = (0, 0), O4 = (a4, 0); crank O1-A of length a1. The block is pinned to the crank at A and slides on
the bar, which turns about O4. l = slide is how far A is along the bar from the foot of O4 on the line
of A, h = offset how far that line is from O4, to the left of the bar. Loop, with x = theta1, y = theta4
the direction of the bar: a1 e^{ix} = a4 + (l + i h) e^{iy}; primes are derivatives with respect to the
input.

Crank input. With q = |A O4|^2 and the half-angle of x, as in the 4R:

    l^2 = ((a1-a4)^2 - h^2) cos^2(x/2) + ((a1+a4)^2 - h^2) sin^2(x/2),   l' = a1 a4 sin x / l
    l'' = a1 a4 (((a1-a4)^2 - h^2) cos^4(x/2) - ((a1+a4)^2 - h^2) sin^4(x/2)) / l^3
    y' = (a1 (a1 - a4 cos x) + h l') / q,   y' - 1 = (a4 (a1 cos x - a4) + h l') / q
    y'' = (a1 a4 sin x (a4^2 - a1^2 - 2 h l')/q + h l'') / q

Slide input: an observer on the bar sees a slider-crank, with a4 for its crank, a1 for its coupler, h for
its offset and A for its slider. So the angles are those of :mod:`fourbar_ros.mechanisms.slide_dyad`, turned back:
y = pi - x_seen, theta1 = pi + theta2_seen.
"""
from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import atan2, atanh, cos, fabs, frexp, fsum, ldexp, pi, sin, sqrt
from typing import NamedTuple

from fourbar_ros.mechanics.bodies import Bodies, External
from fourbar_ros.numerics.dialects import dialects
from fourbar_ros.errors import InvalidParameter
from fourbar_ros.mechanisms.four_bar.half_angle import difference_of_squares, scaled
from fourbar_ros.mechanisms.four_bar.motion import INFINITESIMAL
from fourbar_ros.mechanisms.inverted_slider_crank import diagram
from fourbar_ros.mechanisms.mechanism import CRANK, EPS, OPEN, SLIDE, Mechanism
from fourbar_ros.mechanisms.parts import (
    THETA1,
    THETA2,
    THETA4,
    TRAVEL,
    Joint,
    Length,
    Link,
    Output,
)
from fourbar_ros.mechanisms.points import LinkMotion, crank_motion, point_of
from fourbar_ros.mechanisms.slider_loads import SliderLoads, make_inverted_loads
from fourbar_ros.mechanisms.slide_dyad import (
    closes,
    make_triangle,
    margins,
    reach,
    singular_slides,
    slide_ranges,
)


class InvertedSliderMotion(NamedTuple):
    """
    Pose, rates and accelerations for one input; each field a float, or an array of the input's shape.

    Angles [rad], in [-pi, pi] but for a theta1 that is the input; theta2 = theta4 - theta1 is relative
    (block to crank). Block and bar turn together.
    """

    theta1: float
    omega1: float
    alpha1: float
    theta2: float
    omega2: float
    alpha2: float
    theta4: float                  # absolute, of the bar
    omega4: float
    alpha4: float
    slide: float                   # [m] of the block along the bar
    slide_velocity: float          # [m/s] V_rel of Eq. (9)
    slide_acceleration: float      # [m/s^2] A_rel
    transmission_angle: float      # [rad] in [0, pi], at A: line to O4 and normal of the bar (slide input: crank)
    crank_ratio: float             # d theta1, d theta4, d slide over d input
    output_ratio: float
    slide_ratio: float
    condition: float               # relative error of the lengths -> error of theta4 (slide input: theta1) [rad]
    cos_x: float                   # directions of crank and bar, and of theta2
    sin_x: float
    cos_y: float
    sin_y: float
    cos_2: float
    sin_2: float


@dialects
def make_crank_motion(a1, a4, h, sign):
    """Return the function (theta1, omega1, alpha1) -> fields of :class:`InvertedSliderMotion`."""
    unit = ldexp(1.0, frexp(max(a1, a4, fabs(h)))[1])     # scaling by a power of two is exact
    a1, a4, h = a1 / unit, a4 / unit, h / unit

    def motion(x, omega, alpha, sign=sign, unit=unit, a1=a1, a4=a4, h=h, two_h=2.0 * h, product=a1 * a4,
               less=a1 - a4, more=a1 + a4, low=(a1 - a4)**2, high=(a1 + a4)**2, difference=(a4 - a1) * (a4 + a1),
               near=difference_of_squares(a1, -a4, h, 0.0), far=difference_of_squares(a1, a4, h, 0.0)):
        half = 0.5 * x
        sh, ch = sin(half) + INFINITESIMAL, cos(half)
        ss, cc, sc = sh * sh, ch * ch, sh * ch
        cos_x, sin_x = cc - ss, sc + sc
        slide = sign * sqrt(near * cc + far * ss)
        q = low * cc + high * ss
        per_q, scale = 1.0 / q, 1.0 / slide
        at_x, at_y, ahead = less * cc - more * ss, a1 * sin_x, less * cc + more * ss     # A - O4; a1 - a4 cos x
        cos_y, sin_y = (at_x * slide + at_y * h) * per_q, (at_y * slide - at_x * h) * per_q
        pull = product * sin_x
        dl = pull * scale
        ddl = product * (near * cc * cc - far * ss * ss) * scale * scale * scale
        dy, d2 = (a1 * ahead + h * dl) * per_q, (a4 * at_x + h * dl) * per_q
        ddy = (pull * (difference - two_h * dl) * per_q + h * ddl) * per_q
        cos_2 = (ahead * slide + a4 * h * sin_x) * per_q
        sin_2 = (a4 * slide * sin_x - ahead * h) * per_q
        condition = (a1 * fabs(sin_2) + a4 * fabs(sin_y) + fabs(h)) * fabs(scale)
        square = omega * omega
        return (x, omega, alpha,
                atan2(sin_2, cos_2), d2 * omega, d2 * alpha + ddy * square,
                atan2(sin_y, cos_y), dy * omega, dy * alpha + ddy * square,
                unit * slide, unit * (dl * omega), unit * (dl * alpha + ddl * square), atan2(fabs(slide), h),
                1.0, dy, unit * dl, condition, cos_x, sin_x, cos_y, sin_y, cos_2, sin_2)
    return motion


@dialects
def make_slide_motion(a1, a4, h, unit, triangle):
    """Return the function (slide, velocity, acceleration) -> fields of :class:`InvertedSliderMotion`."""
    def motion(slide, velocity, acceleration, a1=a1, a4=a4, hh=h * h, unit=unit, per_unit=1.0 / unit,
               triangle=triangle):
        (cos_1, sin_1, cos_2, sin_2, cos_x, sin_x, dy, dxy, dx, ddy, ddxy, ddx, scale) = triangle(slide * per_unit)
        cos_x, sin_x, cos_y, sin_y, dy, ddy = -cos_x, -sin_x, -cos_1, sin_1, -dy, -ddy
        v, a = velocity * per_unit, acceleration * per_unit
        square = v * v
        ahead = a1 - a4 * cos_x
        condition = 2.0 * (a1 * fabs(ahead) + a4 * fabs(a4 - a1 * cos_x) + hh) * fabs(scale)
        # theta2 = y - x is minus the angle of the coupler that the bar sees
        return (atan2(sin_x, cos_x), dx * v, dx * a + ddx * square,
                -atan2(sin_2, cos_2), -dxy * v, -(dxy * a + ddxy * square),
                atan2(sin_y, cos_y), dy * v, dy * a + ddy * square, slide, velocity, acceleration,
                atan2(a4 * fabs(sin_x), ahead), dx * per_unit, dy * per_unit, 1.0, condition,
                cos_x, sin_x, cos_y, sin_y, cos_2, -sin_2)
    return motion


class InvertedDeadPoint(NamedTuple):
    """Crank square to the bar: the bar turns back."""

    theta1: float     # [rad]
    theta4: float     # [rad]


@dataclass(frozen=True)
class InvertedSlider(Mechanism):
    """
    Inverted slider-crank: a block pinned to the crank at A slides on a bar that turns about O4.

    With a driven slide it is the oscillating cylinder (of every excavator): block = piston with its rod,
    bar = tube, crank = boom.

    Parameters
    ----------
    a1, a4 : float
        Lengths of crank and ground [m], positive.
    offset : float
        Of the line of A from O4, to the left of the bar [m], shorter than a1 + a4.
    mode : int
        Assembly mode. Crank input: 2 has slide > 0 (bar points from O4 towards A), 1 has slide < 0.
        Slide input: 2 has sin(theta1) > 0 (A to the left of O1-O4), 1 < 0.
    input : str
        'crank' or 'slide': what theta1 or slide is given for.
    bodies : Bodies, optional
        Crank from O1, block (``coupler``) from A along the bar, bar (``output``) from O4 along itself.
    gravity : tuple of 2 floats
        Field of gravity (x, y) [m/s^2].
    external : External
        Forces and couples on block (``coupler``) and bar (``output``).
    stroke : tuple of 2 floats, optional
        Shortest and longest slide [m] of a driven slide, as a cylinder has; not given: all where the links close.

    Guide force: of the bar on the block, + to the left of the bar; guide couple: of the bar on the block
    about A. The driving force pushes the block along the bar as ``slide`` grows, and the bar back.

    Raises
    ------
    InvalidParameter
        Naming the parameter, its value and what is allowed.

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
    TEXT = 'a block on a bar that turns about O4, e.g. an oscillating cylinder'
    LENGTHS = (Length('a1', 'length of the crank O1-A'), Length('a4', 'length of the ground link O1-O4'),
               Length('offset', 'distance of the path of A on the bar from O4, positive to the left of the bar', signed=True))
    LINKS = (Link('crank', 'crank', 'O1', 'a1', is_loadable=False), Link('coupler', 'block', 'A'),
             Link('output', 'bar', 'O4'))
    MARGIN_SIGNS = ((-1, 1, -1), (1, -1, -1))
    INPUTS = {CRANK: THETA1, SLIDE: TRAVEL}
    OUTPUTS = {CRANK: (Output(THETA4, 'output_ratio'),), SLIDE: (Output(THETA1, 'crank_ratio'),)}
    JOINTS = (Joint('O1', THETA1), Joint('A', THETA2), Joint('slide', TRAVEL), Joint('O4', THETA4))
    PARTS = {THETA1: 'crank', THETA2: 'block to crank', THETA4: 'bar', TRAVEL: 'block on the bar'}
    SLIDE_DIRECTION = ('cos_y', 'sin_y')
    DRAWN = (THETA1, THETA4, TRAVEL)
    MOTION, LOADS = InvertedSliderMotion, SliderLoads

    def __post_init__(self):
        self._check()
        if not closes(*self.lengths):
            raise InvalidParameter('offset', self.offset, 'the links cannot close: it must be shorter than '
                                   f'crank and ground together ({self.a1 + self.a4!r})')
        self._check_stroke()

    @cached_property
    def margins(self):
        """Return a4 - a1 - |h| and a1 - a4 - |h| [m]."""
        return margins(self.a1, self.a4, self.offset)

    @property
    def classification(self):
        """Return the type: crank and bar turn fully, or only the crank, or neither."""
        if 0.0 in self.margins:
            return 'change point'
        rocks, turns = self.margins
        return ('Grashof crank-rocker' if rocks > 0.0 else
                'Grashof double-crank' if turns > 0.0 else 'non-Grashof double-rocker')

    @cached_property
    def closing_ranges(self):
        """
        Return the ranges of the input in which the links close, from low to high: theta1 [rad] or slide [m].

        For a crank that turns fully (-pi, pi), else one range through pi. At an end that is no full turn
        A is at the foot of O4 (crank input), or crank and ground in line (slide input): a toggle.
        """
        if self.input == SLIDE:
            return slide_ranges(self.a4, self.a1, self.offset)
        near, far = reach(*scaled(self.lengths))
        if near >= 0.0:
            return ((-pi, pi),)
        low = 2.0 * atan2(sqrt(-near), sqrt(far))
        return ((low, 2.0 * pi - low),)

    @property
    def singular_inputs(self):
        """
        Return the complex inputs where the dyad is singular, as :attr:`.SliderCrank.singular_inputs`.

        For a driven crank where A is at the foot of O4, l = 0, and where it is as far as that from O4, q = 0.
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
    def dead_points(self):
        """Return where the bar of a driven crank turns back in this mode: up to two InvertedDeadPoint."""
        points, (a1, a4, h) = [], scaled(self.lengths)
        for side in (1.0, -1.0):                       # A = +-i a1 e^{iy}
            rise = h - side * a1        # a4 sin y
            run = difference_of_squares(a4, 0.0, h, -side * a1)
            if run > 0.0 and self.input == CRANK:
                cosine, sine = -self.sign * sqrt(run), rise
                points.append(InvertedDeadPoint(atan2(side * cosine, -side * sine), atan2(sine, cosine)))
        return tuple(sorted(points))

    def _make_motion(self, dialect, change=lambda factory: factory):
        if self.input == CRANK:
            return change(make_crank_motion[dialect])(*self.lengths, self.sign)
        a1, a4, h = (length / self.input_unit for length in self.lengths)
        return change(make_slide_motion[dialect])(a1, a4, h, self.input_unit,
                                                  change(make_triangle[dialect])(a4, a1, h, -self.sign))

    def _make_loads(self, dialect, change=lambda factory: factory):
        return change(make_inverted_loads[dialect])(*self.lengths, self.input == CRANK, self.bodies, self.gravity,
                                                    self.external)

    def link_motion(self, motion, link):
        """Return the LinkMotion of a link by name."""
        if link == 'output':
            return LinkMotion(self.a4, 0.0, 0.0, 0.0, 0.0, 0.0, motion.cos_y, motion.sin_y, motion.omega4, motion.alpha4)
        crank = crank_motion(motion)
        if link == 'crank':
            return crank
        return LinkMotion(*point_of(crank, self.a1), motion.cos_y, motion.sin_y, motion.omega4, motion.alpha4)

    def transmission_sine(self, motion):
        """Return a number that is zero where the dyad is in line, at most one."""
        size = max(map(abs, self.lengths))
        slide, aside = motion.slide / size, self.offset / size
        opposite = slide if self.input == CRANK else self.a4 / size * motion.sin_x
        return opposite / (slide * slide + aside * aside)**0.5

    def diagram(self, motion):
        """Return what a picture shows in one pose."""
        return diagram.diagram(self, motion)

    def velocity_polygon(self, motion):
        """Return the arrows of the velocities [m/s]; the pole is the origin."""
        return diagram.velocity_polygon(self, motion)

    def acceleration_polygon(self, motion):
        """Return the arrows of the accelerations [m/s^2]; the pole is the origin."""
        return diagram.acceleration_polygon(self, motion)
