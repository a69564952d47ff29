"""
The slider-crank RRRP with offset, driven by its crank or by its slider, stable in the last bits.

O1 = (0, 0); crank O1-A of length a1, coupler A-B of length a2; B slides along y = offset, the guide,
parallel to x. Loop (slides, before Eq. (7)): a1 e^{ix} + a2 e^{ib} = s + i e with x = theta1, b = beta,
s = slide, e = offset; primes are derivatives with respect to the input.

Crank input. B is where a circle meets the guide; with n = e - a1 sin x:

    a2 sin b = n,   (a2 cos b)^2 = (a2 - n)(a2 + n)
    b' = -a1 cos x / (a2 cos b),   s' = -a1 sin x - n b',   s'' = -a1 cos x - a2 cos b b'^2 - n b''
    b'' = a1 ((a2^2 - a1^2 - e^2) sin x + a1 e (1 + sin^2 x)) / (a2 cos b)^3

where near sin x = +-1 all is expanded about it, in 1 -+ sin x = cos^2 x / (1 +- sin x), so that limits
and change points keep their digits.

Slider input: :func:`make_triangle`. Every difference in these is one that the data make.
"""
from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import atan2, cos, fabs, frexp, fsum, hypot, ldexp, pi, sin, sqrt
from typing import NamedTuple

from .dialects import dialects, where
from .errors import InvalidParameter
from .factors import difference_of_squares
from .kinematics import INFINITESIMAL
from .linkage import OPEN, Bodies, External
from .loads import _about_first_joint
from .mechanism import Mechanism, link_needs

CRANK, SLIDER = 'crank', 'slider'


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


class SliderLoads(NamedTuple):
    """
    Loads for one input; each field a float, or an array of the input's shape.

    fij = all that link i does ON link j along the ground axes (1 crank, 2 coupler or block, 3 slider or
    bar, 4 ground), the drive's force included where the drive is between them; fji = -fij. Forces [N],
    moments [N m], counter-clockwise positive.
    """

    f41_x: float
    f41_y: float
    f21_x: float
    f21_y: float
    f32_x: float
    f32_y: float
    f43_x: float
    f43_y: float
    f41: float                # magnitudes
    f21: float
    f32: float
    f43: float
    guide_force: float        # normal, at the pin; see the mechanism for its sense
    guide_couple: float       # about the pin
    driving_torque: float     # of the drive on the crank; zero for a driven slide
    driving_force: float      # of the drive along the slide; zero for a driven crank
    shaking_force_x: float    # of all links on the ground
    shaking_force_y: float
    shaking_force: float      # magnitude
    shaking_moment: float     # about O1


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

    def motion(x, omega, alpha, sign=sign, unit=unit, a1=a1, a2=a2, e=e, per_a2=1.0 / a2, a1_e=a1 * e,
               near_zero=(a2 - e, a2 + e), at_top=(fsum((a2, -e, a1)), fsum((a2, e, -a1))),
               at_bottom=(fsum((a2, -e, -a1)), fsum((a2, e, a1))),
               plain=difference_of_squares(a2, 0.0, a1, 0.0) - e * e,
               top=difference_of_squares(a2, 0.0, e, -a1), bottom=difference_of_squares(a2, 0.0, e, a1)):
        cos_x, sin_x = cos(x), sin(x)
        size = fabs(sin_x)
        low = cos_x * cos_x / (1.0 + size)     # 1 - |sin x|
        # u = a2 - n and w = a2 + n from their values at sin x = 0, 1 or -1, whichever is nearest
        is_near_zero, is_up = size.real < 0.5, sin_x.real > 0.0
        u, w = where(is_near_zero, near_zero, where(is_up, at_top, at_bottom))
        step = a1 * where(is_near_zero, sin_x, where(is_up, -low, low))
        n = e - a1 * sin_x
        root = sign * sqrt((u + step) * (w - step))     # a2 cos b
        cos_b, sin_b = root * per_a2, n * per_a2 + 0.0 * root      # NaN too where nothing is real
        cos_2, sin_2 = cos_b * cos_x + sin_b * sin_x, sin_b * cos_x - cos_b * sin_x
        scale = 1.0 / root
        db = -a1 * cos_x * scale
        ds = -a1 * sin_x - n * db
        bend = where(is_near_zero, plain * sin_x + a1_e * (1.0 + sin_x * sin_x),
                     where(is_up, top * (1.0 - low) + a1_e * low * low, a1_e * low * low - bottom * (1.0 - low)))
        ddb = a1 * bend * scale * scale * scale
        dds = -a1 * cos_x - root * db * db - n * ddb
        condition = (a1 * fabs(cos_2) + a2 + fabs(e * sin_b)) * a2 * fabs(scale)
        beta, square, omega_b = atan2(sin_b, cos_b), omega * omega, db * omega
        alpha_b = db * alpha + ddb * square
        return (x, omega, alpha, atan2(sin_2, cos_2), omega_b - omega, alpha_b - alpha, -beta, -omega_b, -alpha_b,
                unit * (a1 * cos_x + root), unit * (ds * omega), unit * (ds * alpha + dds * square),
                beta, omega_b, alpha_b, atan2(fabs(cos_b), sin_b), 1.0, db, unit * ds, unit * condition,
                cos_x, sin_x, cos_b, sin_b, cos_2, sin_2)
    return motion


@dialects
def make_triangle(a1, a2, e, sign):
    """
    Return the function s -> angles x, b of a1 e^{ix} + a2 e^{ib} = s + i e, and their derivatives.

    Which is a slider-crank driven by its slider, and, seen from its bar, an inverted one driven by its
    cylinder. With q = s^2 + e^2, f = a1^2 - a2^2, theta2 = b - x as the 4R's mu (:mod:`.kinematics`):

        (2 a1 a2 sin theta2)^2 = (K+ - s^2)(s^2 - K-),   K+- = (a1 +- a2)^2 - e^2
        theta2'' = 2 (K+ K- - s^4) / (2 a1 a2 sin theta2)^3
        x' = cos b / (a1 sin theta2),   b' = -cos x / (a2 sin theta2),   theta2' = -s / (a1 a2 sin theta2)
        x'' = (2 e - f theta2') s/q^2 - theta2'' (q - f)/(2 q),   b'' = ... + theta2'' (q + f)/(2 q)

    ``sign``: of sin(theta2). Lengths within a few powers of two of one. At s = 0 of a change point the
    values are those for s -> 0 from above.
    """
    def triangle(s, sign=sign, e=e, ee=e * e, f=(a1 - a2) * (a1 + a2), two_e=2.0 * e, two_1=2.0 * a1,
                 two_2=2.0 * a2, outer=difference_of_squares(a1, a2, e, 0.0),
                 inner=difference_of_squares(a1, -a2, e, 0.0),
                 product=difference_of_squares(a1, a2, e, 0.0) * difference_of_squares(a1, -a2, e, 0.0),
                 total=4.0 * a1 * a2, per=0.25 / (a1 * a2), half_1=0.5 / a1, half_2=0.5 / a2):
        s = s + INFINITESIMAL
        square = s * s
        q = square + ee
        u, w = outer - square, square - inner
        # their sum is given: so the rounding of one is that of the other, as in the shape of a triangle
        u, w = where(u.real < w.real, (u, total - u), (total - w, w))
        root = sign * sqrt(u * w)
        cos_2, sin_2 = (w - u) * per + 0.0 * root, 2.0 * root * per
        per_q, scale = 1.0 / q, 1.0 / root
        more, less = (q + f) * per_q, (q - f) * per_q
        turn = root * per_q
        cos_x, sin_x = (s * more + e * turn) * half_1, (e * more - s * turn) * half_1
        cos_b, sin_b = (s * less - e * turn) * half_2, (e * less + s * turn) * half_2
        dx, db, d2 = two_2 * cos_b * scale, -two_1 * cos_x * scale, -2.0 * s * scale
        dd2 = 2.0 * (product - square * square) * scale * scale * scale
        common, half = (two_e - f * d2) * s * per_q * per_q, 0.5 * dd2
        return (cos_x, sin_x, cos_b, sin_b, cos_2, sin_2, dx, db, d2,
                common - half * less, common + half * more, dd2, scale)
    return triangle


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


@dialects
def make_loads(a1, a2, e, is_crank, bodies, gravity, external):
    """
    Return the function (fields of the motion) -> fields of :class:`SliderLoads`: Newton-Euler in closed form.

    The force at B from the moment of the coupler and, for a driven crank, the slider's own equation along
    the guide, for a driven slider the moment of the crank; the drive from virtual power.
    """
    unit = ldexp(1.0, frexp(max(a1, a2, fabs(e)))[1])
    crank, coupler, slider = bodies

    def loads(motion, a1=a1 / unit, a2=a2 / unit, e=e / unit, unit=unit, per_unit=1.0 / unit, is_crank=is_crank,
              mass2=coupler.mass * unit, mass3=slider.mass * unit,
              crank=_about_first_joint(crank, unit, gravity),
              coupler=_about_first_joint(coupler, unit, gravity, external.coupler),
              slider=_about_first_joint(slider, unit, gravity, external.output)):
        (_, omega, alpha, _, _, _, _, _, _, slide, _, slide_acceleration, _, omega_b, alpha_b, _, dx, db, ds, _,
         cos_x, sin_x, cos_b, sin_b, _, sin_2) = motion
        f1_x, f1_y, moment1 = link_needs(crank, 0.0, cos_x, sin_x, omega, alpha, 0.0, 0.0)
        at_x, at_y, square = a1 * cos_x, a1 * sin_x, omega * omega     # A
        f2_x, f2_y, moment2 = link_needs(coupler, mass2, cos_b, sin_b, omega_b, alpha_b,
                                         -alpha * at_y - square * at_x, alpha * at_x - square * at_y)
        f3_x, f3_y, moment3 = link_needs(slider, mass3, 1.0, 0.0, 0.0, 0.0, slide_acceleration * per_unit, 0.0)
        carried = moment1 + at_x * f2_y - at_y * f2_x
        drive = unit * (carried * dx + moment2 * db) + f3_x * ds
        along_b, along_x = carried / a1, -moment2 / a2
        f32_x, f32_y = where(is_crank, (-f3_x, (-along_x - sin_b * f3_x) / cos_b),
                             ((along_b * cos_b + along_x * cos_x) / sin_2,
                              (along_b * sin_b + along_x * sin_x) / sin_2))
        f21_x, f21_y = f32_x - f2_x, f32_y - f2_y
        torque, force = where(is_crank, (drive, 0.0), (0.0, drive))
        f43_x, f43_y = force, f3_y + f32_y
        f41_x, f41_y = f1_x - f21_x, f1_y - f21_y
        shaking_x, shaking_y = -(f1_x + f2_x + f3_x), -(f1_y + f2_y + f3_y)
        moment = -(carried + moment2 + moment3 + (slide * per_unit) * f3_y - e * f3_x)
        return (f41_x, f41_y, f21_x, f21_y, f32_x, f32_y, f43_x, f43_y,
                hypot(f41_x, f41_y), hypot(f21_x, f21_y), hypot(f32_x, f32_y), hypot(f43_x, f43_y),
                f43_y, unit * moment3, torque, force, shaking_x, shaking_y, hypot(shaking_x, shaking_y),
                unit * moment)
    return loads


def reach(p, r, e):
    """Return (inner, outer) distances squared, minus e^2: (p - r)^2 - e^2 and (p + r)^2 - e^2 [m^2]."""
    return difference_of_squares(p, -r, e, 0.0), difference_of_squares(p, r, e, 0.0)


def slide_ranges(p, r, e):
    """Return the ranges of s in which the triangle of :func:`make_triangle` closes, from below [m]."""
    inner, outer = reach(p, r, e)
    far = sqrt(outer)
    return ((-far, far),) if inner <= 0.0 else ((-far, -sqrt(inner)), (sqrt(inner), far))


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
        'crank' or 'slider': what theta1 or slide is given for.
    bodies : Bodies, optional
        Crank from O1, coupler from A, slider (``output``) from B along x.
    gravity : tuple of 2 floats
        Field of gravity (x, y) [m/s^2].
    external : External
        Forces and couples on coupler and slider (``output``), as gas forces.

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

    INPUTS = {CRANK: ('theta1', 'omega1', 'alpha1'), SLIDER: ('slide', 'slide_velocity', 'slide_acceleration')}
    MOTION, LOADS = SliderCrankMotion, SliderLoads

    def __post_init__(self):
        self._check(('a1', 'a2'), ('offset',))
        if reach(*self.lengths)[1] <= 0.0:
            raise InvalidParameter('offset', self.offset, 'the links cannot close: it must be shorter than '
                                   f'crank and coupler together ({self.a1 + self.a2!r})')

    @property
    def lengths(self):
        """Return (a1, a2, offset) [m]."""
        return (self.a1, self.a2, self.offset)

    @cached_property
    def _margins(self):
        aside = abs(self.offset)
        return fsum((self.a2, -self.a1, -aside)), fsum((self.a1, -self.a2, -aside))

    @property
    def change_point_margin(self):
        """Return the smaller of |a2 - a1 - |e|| and |a1 - a2 - |e|| over a1 + a2 + |e|; zero: change point."""
        return min(map(abs, self._margins)) / fsum((self.a1, self.a2, abs(self.offset)))

    @property
    def classification(self):
        """Return the type: whose full turns there are, the crank's, the coupler's or nobody's."""
        if 0.0 in self._margins:
            return 'change point'
        crank, coupler = self._margins
        return ('Grashof crank-slider' if crank > 0.0 else
                'Grashof rocker-slider' if coupler > 0.0 else 'non-Grashof rocker-slider')

    @cached_property
    def input_ranges(self):
        """
        Return the ranges of the input in which the links close, from low to high: theta1 [rad] or slide [m].

        For a crank that turns fully (-pi, pi). At an end that is no full turn the coupler is square to
        the guide (crank input), or in line with the crank (slider input): a toggle.
        """
        a1, a2, e = self.lengths
        if self.input == SLIDER:
            return slide_ranges(a1, a2, e)
        below, above = fsum((a2, -e, -a1)), fsum((a2, e, -a1))      # of a2 -+ n at x = -+ pi/2
        low = atan2(e - a2, sqrt(-below * fsum((a2, -e, a1)))) if below < 0.0 else None
        high = atan2(e + a2, sqrt(-above * fsum((a2, e, a1)))) if above < 0.0 else None
        if low is None:
            return ((-pi, pi),) if high is None else ((-pi - high, high),)
        return ((low, pi - low),) if high is None else ((low, high), (pi - high, pi - low))

    @property
    def dead_points(self):
        """Return where the slider of a driven crank turns back in this mode: up to two SliderDeadPoint."""
        points = []
        for stretched, r, k in zip((True, False), (self.a1 + self.a2, self.a1 - self.a2), reach(*self.lengths)[::-1]):
            if k > 0.0 and self.input == CRANK:
                ahead = self.sign * sqrt(k) if stretched else -self.sign * sqrt(k)     # of A, along x
                behind = -1.0 if r < 0.0 else 1.0                                      # B as seen from O1
                points.append(SliderDeadPoint(atan2(behind * self.offset, ahead), behind * ahead, stretched))
        return tuple(sorted(points))

    @cached_property
    def _motion(self):
        if self.input == CRANK:
            return [make(*self.lengths, self.sign) for make in make_crank_motion]
        unit = ldexp(1.0, frexp(max(map(abs, self.lengths)))[1])
        scaled = [length / unit for length in self.lengths]
        return [make(*scaled, unit, triangle(*scaled, self.sign))
                for make, triangle in zip(make_slider_motion, make_triangle)]

    @cached_property
    def _loads(self):
        return [make(*self.lengths, self.input == CRANK, self.bodies, self.gravity, self.external)
                for make in make_loads]
