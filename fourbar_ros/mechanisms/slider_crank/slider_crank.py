"""
The slider-crank RRRP with offset, driven by its crank or by its slider, stable in the last bits.

O1 = (0, 0); crank O1-A of length a1, coupler A-B of length a2; B slides along y = offset, the guide,
parallel to x. Loop (slides, before Eq. (7)): a1 e^{ix} + a2 e^{ib} = s + i e with x = theta1, b = beta,
s = slide, e = offset; primes are derivatives with respect to the input.

Crank input. B is where a circle meets the guide; with n = e - a1 sin x:

    a2 sin b = n,   (a2 cos b)^2 = (a2 - n)(a2 + n)
    b' = -a1 cos x / (a2 cos b),   b' - 1 = -s / (a2 cos b)
    s' = a1 (e cos x - s sin x) / (a2 cos b),   s'' = a1 cos x (b' - 1) - n b''
    b'' = a1 ((a2^2 - a1^2 - e^2) sin x + a1 e (1 + sin^2 x)) / (a2 cos b)^3

where near sin x = +-1 all is expanded about it, in 1 -+ sin x = cos^2 x / (1 +- sin x), so that limits
and change points keep their digits. s' and s'' are as small as s and e where crank and coupler are
nearly equal. A long crank (a1 > 2 a2) with its pin A near the level of the guide, |n| < a2/2, is treated
by n alone,

    (a2 cos b)^2 = (a2 - n)(a2 + n),   b'' = a1 ((a2^2 - n^2) sin x + a1 n cos^2 x) / (a2 cos b)^3

because n is there rounded by up to eps a1, which is much beside a2, and all must be rounded by the same.

Slider input: :mod:`fourbar_ros.mechanisms.slide_dyad`. Every difference in these is one that the data make.
"""
from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import asin, atan2, cos, fabs, frexp, fsum, ldexp, log1p, pi, sin, sqrt
from typing import NamedTuple

from fourbar_ros.mechanics.bodies import Bodies, External
from fourbar_ros.numerics.dialects import dialects, where
from fourbar_ros.errors import InvalidParameter
from fourbar_ros.mechanisms.four_bar.half_angle import difference_of_squares, scaled
from fourbar_ros.mechanisms.mechanism import CRANK, OPEN, SLIDE, Mechanism
from fourbar_ros.mechanisms.parts import (
    BETA,
    THETA1,
    THETA2,
    THETA3,
    TRAVEL,
    Joint,
    Length,
    Link,
    Output,
)
from fourbar_ros.mechanisms.points import LinkMotion, crank_motion, point_of
from fourbar_ros.mechanisms.slider_crank import diagram
from fourbar_ros.mechanisms.slider_loads import SliderLoads, make_slider_crank_loads
from fourbar_ros.mechanisms.slide_dyad import (
    closes,
    make_triangle,
    margins,
    power_of_two,
    reach,
    singular_slides,
    slide_ranges,
)


class SliderCrankMotion(NamedTuple):
    """
    Pose, rates and accelerations for one input; each field a float, or an array of the input's shape.

    Angles [rad], in [-pi, pi] but for a theta1 that is the input; theta2 is relative (coupler to crank),
    theta3 = -beta (slider to coupler): theta1 + theta2 + theta3 = 0.
    """

    theta1: float
    omega1: float
    alpha1: float
    theta2: float
    omega2: float
    alpha2: float
    theta3: float
    omega3: float
    alpha3: float
    slide: float                   # [m] x of B, along the guide
    slide_velocity: float          # [m/s]
    slide_acceleration: float      # [m/s^2]
    beta: float                    # absolute coupler angle
    omega_beta: float
    alpha_beta: float
    transmission_angle: float      # [rad] in [0, pi]: of coupler and normal of the guide (slider input: crank)
    crank_ratio: float             # d theta1, d beta, d slide over d input
    coupler_ratio: float
    slide_ratio: float
    condition: float               # relative error of the lengths -> error of slide [m] (of theta1 [rad])
    cos_x: float                   # directions of crank and coupler, and of theta2
    sin_x: float
    cos_b: float
    sin_b: float
    cos_2: float
    sin_2: float


class SliderDeadPoint(NamedTuple):
    """Crank and coupler in line, one behind the other (stretched) or folded: the slider turns back."""

    theta1: float     # [rad]
    slide: float      # [m]
    stretched: bool


@dialects
def make_crank_motion(a1, a2, e, sign):
    """Return the function (theta1, omega1, alpha1) -> fields of :class:`SliderCrankMotion`."""
    unit = ldexp(1.0, frexp(max(a1, a2, fabs(e)))[1])     # scaling by a power of two is exact
    a1, a2, e = a1 / unit, a2 / unit, e / unit

    def motion(x, omega, alpha, sign=sign, unit=unit, a1=a1, a2=a2, e=e, per_a2=1.0 / a2, a1_e=a1 * e, two_a1_e=2.0 * a1 * e,
               near_zero=(a2 - e, a2 + e), at_top=(fsum((a2, -e, a1)), fsum((a2, e, -a1))),
               at_bottom=(fsum((a2, -e, -a1)), fsum((a2, e, a1))),
               plain=difference_of_squares(a2, 0.0, a1, 0.0) - e * e,
               top=difference_of_squares(a2, 0.0, e, -a1), bottom=difference_of_squares(a2, 0.0, e, a1),
               level=0.25 * a2 * a2 if a1 > 2.0 * a2 else 0.0):
        cos_x, sin_x = cos(x), sin(x)
        size = fabs(sin_x)
        low = cos_x * cos_x / (1.0 + size)     # 1 - |sin x|
        # u = a2 - n and w = a2 + n from their values at sin x = 0, 1 or -1, whichever is nearest
        is_near_zero, is_up = size.real < 0.5, sin_x.real > 0.0
        u, w = where(is_near_zero, near_zero, where(is_up, at_top, at_bottom))
        step = a1 * where(is_near_zero, sin_x, where(is_up, -low, low))
        n = e - a1 * sin_x
        is_level = (n * n).real < level
        u, w = where(is_level, (a2 - n, a2 + n), (u + step, w - step))
        root = sign * sqrt(u * w)     # a2 cos b
        cos_b, sin_b = root * per_a2, n * per_a2 + 0.0 * root      # NaN too where nothing is real
        cos_2, sin_2 = cos_b * cos_x + sin_b * sin_x, sin_b * cos_x - cos_b * sin_x
        # s = a1 cos x + root; where these cancel, from s (root - a1 cos x) = a2^2 - a1^2 - e^2 + 2 a1 e sin x
        at_x = a1 * cos_x
        gap = where(is_near_zero, plain + two_a1_e * sin_x, where(is_up, top - two_a1_e * low, bottom + two_a1_e * low))
        adds = (root * cos_x).real > 0.0
        slide = where(adds, at_x + root, gap) / where(adds, 1.0, root - at_x)
        scale = 1.0 / root
        db, d2 = -at_x * scale, -slide * scale
        ds = a1 * (e * cos_x - slide * sin_x) * scale
        bend = where(is_level, u * w * sin_x + at_x * n * cos_x,
                     where(is_near_zero, plain * sin_x + a1_e * (1.0 + sin_x * sin_x),
                           where(is_up, top * (1.0 - low) + a1_e * low * low,
                                 a1_e * low * low - bottom * (1.0 - low))))
        ddb = a1 * bend * scale * scale * scale
        dds = at_x * d2 - n * ddb
        condition = (a1 * fabs(cos_2) + a2 + fabs(e * sin_b)) * a2 * fabs(scale)
        beta, square, omega_b = atan2(sin_b, cos_b), omega * omega, db * omega
        alpha_b = db * alpha + ddb * square
        return (x, omega, alpha, atan2(sin_2, cos_2), d2 * omega, d2 * alpha + ddb * square, -beta, -omega_b, -alpha_b,
                unit * slide, unit * (ds * omega), unit * (ds * alpha + dds * square),
                beta, omega_b, alpha_b, atan2(fabs(cos_b), sin_b), 1.0, db, unit * ds, unit * condition,
                cos_x, sin_x, cos_b, sin_b, cos_2, sin_2)
    return motion


@dialects
def make_slider_motion(a1, a2, e, unit, triangle):
    """Return the function (slide, velocity, acceleration) -> fields of :class:`SliderCrankMotion`."""
    def motion(slide, velocity, acceleration, a1=a1, a2=a2, e=e, unit=unit, per_unit=1.0 / unit, triangle=triangle):
        (cos_x, sin_x, cos_b, sin_b, cos_2, sin_2, dx, db, d2, ddx, ddb, dd2, scale) = triangle(slide * per_unit)
        v, a = velocity * per_unit, acceleration * per_unit
        square, beta = v * v, atan2(sin_b, cos_b)
        omega_b, alpha_b = db * v, db * a + ddb * square
        condition = 2.0 * a2 * (a1 * fabs(cos_2) + a2 + fabs(e * sin_b)) * fabs(scale)
        theta2 = atan2(sin_2, cos_2)
        return (atan2(sin_x, cos_x), dx * v, dx * a + ddx * square, theta2, d2 * v, d2 * a + dd2 * square,
                -beta, -omega_b, -alpha_b, slide, velocity, acceleration, beta, omega_b, alpha_b,
                fabs(theta2), dx * per_unit, db * per_unit, 1.0, condition, cos_x, sin_x, cos_b, sin_b, cos_2, sin_2)
    return motion


@dataclass(frozen=True)
class SliderCrank(Mechanism):
    """
    Slider-crank O1-A-B whose pin B slides along y = offset.

    Parameters
    ----------
    a1, a2 : float
        Lengths of crank and coupler [m], positive.
    offset : float
        Of the guide from O1, to the left of x [m], shorter than a1 + a2.
    mode : int
        Assembly mode. Crank input: 2 has cos(beta) > 0 (slider ahead of A), 1 has cos(beta) < 0. Slider
        input: 2 has sin(theta2) > 0 (from O1 over A to B one turns left), 1 < 0.
    input : str
        'crank' or 'slide': what theta1 or slide is given for.
    bodies : Bodies, optional
        Crank from O1, coupler from A, slider (``output``) from B along x.
    gravity : tuple of 2 floats
        Field of gravity (x, y) [m/s^2].
    external : External
        Forces and couples on coupler and slider (``output``), as gas forces.
    stroke : tuple of 2 floats, optional
        Shortest and longest slide [m] of a driven slide, as a cylinder has; not given: all where the links close.

    Guide force: of the ground on the slider, + along y; guide couple: of the ground on the slider about B.

    Raises
    ------
    InvalidParameter
        Naming the parameter, its value and what is allowed.

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
    TEXT = 'a slider on a guide parallel to x'
    LENGTHS = (Length('a1', 'length of the crank O1-A'), Length('a2', 'length of the coupler A-B'),
               Length('offset', 'y of the guide', signed=True))
    LINKS = (Link('crank', 'crank', 'O1', 'a1', is_loadable=False), Link('coupler', 'coupler', 'A', 'a2'),
             Link('output', 'slider', 'B', turns=False))
    MARGIN_SIGNS = ((-1, 1, -1), (1, -1, -1))
    INPUTS = {CRANK: THETA1, SLIDE: TRAVEL}
    OUTPUTS = {CRANK: (Output(TRAVEL, 'slide_ratio'),), SLIDE: (Output(THETA1, 'crank_ratio'),)}
    JOINTS = (Joint('O1', THETA1), Joint('A', THETA2), Joint('B', THETA3), Joint('guide', TRAVEL))
    PARTS = {THETA1: 'crank', THETA2: 'coupler to crank', THETA3: 'slider to coupler', BETA: 'coupler', TRAVEL: 'slider'}
    DRAWN = (THETA1, BETA, TRAVEL)
    MOTION, LOADS = SliderCrankMotion, SliderLoads

    def __post_init__(self):
        self._check()
        if not closes(*self.lengths):
            raise InvalidParameter('offset', self.offset, 'the links cannot close: it must be shorter than '
                                   f'crank and coupler together ({self.a1 + self.a2!r})')
        self._check_stroke()

    @cached_property
    def margins(self):
        """Return a2 - a1 - |e| and a1 - a2 - |e| [m]."""
        return margins(self.a1, self.a2, self.offset)

    @property
    def classification(self):
        """Return the type: whose full turns there are, the crank's, the coupler's or nobody's."""
        if 0.0 in self.margins:
            return 'change point'
        crank, coupler = self.margins
        return ('Grashof crank-slider' if crank > 0.0 else
                'Grashof rocker-slider' if coupler > 0.0 else 'non-Grashof rocker-slider')

    @cached_property
    def closing_ranges(self):
        """
        Return the ranges of the input in which the links close, from low to high: theta1 [rad] or slide [m].

        For a crank that turns fully (-pi, pi). At an end that is no full turn the coupler is square to
        the guide (crank input), or in line with the crank (slider input): a toggle.
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
    def singular_inputs(self):
        """
        Return the complex inputs, as far as real part and size of the other go, where crank and dyad are singular.

        A list of toggles (real), flat positions of change points (real) and others: where sin x = (e +- a2)/a1,
        or, for a driven slide, of :func:`~fourbar_ros.mechanisms.slide_dyad.singular_slides`.
        """
        a1, a2, e = self.lengths
        if self.input == SLIDE:
            return singular_slides(a1, a2, e)
        found = []
        for r in (a2, -a2):
            side = 1.0 if e + r > 0.0 else -1.0
            excess = fsum((side * e, side * r, -a1)) / a1          # |sin x| - 1
            if excess >= 0.0:
                found.append(complex(side * 0.5 * pi, log1p(excess + sqrt(excess * (2.0 + excess)))))
            else:
                angle = side * (0.5 * pi - 2.0 * asin(sqrt(-0.5 * excess)))
                found += [complex(angle), complex(pi - angle)]
        return found

    @property
    def dead_points(self):
        """Return where the slider of a driven crank turns back in this mode: up to two SliderDeadPoint."""
        points, unit = [], power_of_two(*self.lengths)
        a1, a2, e = (length / unit for length in self.lengths)
        for stretched, r, k in zip((True, False), (a1 + a2, a1 - a2), reach(a1, a2, e)[::-1]):
            if k > 0.0 and self.input == CRANK:
                ahead = self.sign * sqrt(k) if stretched else -self.sign * sqrt(k)     # of A, along x
                behind = -1.0 if r < 0.0 else 1.0                                      # B as seen from O1
                points.append(SliderDeadPoint(atan2(behind * e, ahead), unit * behind * ahead, stretched))
        return tuple(sorted(points))

    def _make_motion(self, dialect, change=lambda factory: factory):
        if self.input == CRANK:
            return change(make_crank_motion[dialect])(*self.lengths, self.sign)
        scaled = [length / self.input_unit for length in self.lengths]
        return change(make_slider_motion[dialect])(*scaled, self.input_unit,
                                                   change(make_triangle[dialect])(*scaled, self.sign))

    def _make_loads(self, dialect, change=lambda factory: factory):
        return change(make_slider_crank_loads[dialect])(*self.lengths, self.input == CRANK, self.bodies, self.gravity,
                                                        self.external)

    def link_motion(self, motion, link):
        """Return the LinkMotion of a link by name."""
        if link == 'output':
            return LinkMotion(motion.slide, self.offset, motion.slide_velocity, 0.0, motion.slide_acceleration, 0.0,
                              1.0, 0.0, 0.0, 0.0)
        crank = crank_motion(motion)
        if link == 'crank':
            return crank
        return LinkMotion(*point_of(crank, self.a1), motion.cos_b, motion.sin_b, motion.omega_beta, motion.alpha_beta)

    def transmission_sine(self, motion):
        """Return a number that is zero where the dyad is in line, at most one."""
        return motion.cos_b if self.input == CRANK else motion.sin_2

    def diagram(self, motion):
        """Return what a picture shows in one pose."""
        return diagram.diagram(self, motion)

    def velocity_polygon(self, motion):
        """Return the arrows of the velocities [m/s]; the pole is the origin."""
        return diagram.velocity_polygon(self, motion)

    def acceleration_polygon(self, motion):
        """Return the arrows of the accelerations [m/s^2]; the pole is the origin."""
        return diagram.acceleration_polygon(self, motion)
