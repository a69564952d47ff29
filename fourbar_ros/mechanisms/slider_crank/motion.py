# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Position, velocity and acceleration of the slider-crank RRRP with offset, stable in the last bits.

O1 = (0, 0); crank O1-A of length a1, coupler A-B of length a2; B slides along y = offset, the
guide, parallel to x. Loop (slides, before Eq. (7)): a1 e^{ix} + a2 e^{ib} = s + i e with x =
theta1, b = beta, s = slide, e = offset; primes are derivatives with respect to the input.

Crank input. B is where a circle meets the guide; with n = e - a1 sin x:

    (M1)  u w = (a2 cos b)^2 = root^2,   u = a2 - n,   w = a2 + n,   a2 sin b = n
    (M2)  s = a1 cos x + root = gap / (root - a1 cos x),   gap = a2^2 - a1^2 - e^2 + 2 a1 e sin x
    (M3)  b' = -a1 cos x / root
    (M4)  theta2' = b' - 1 = -s / root
    (M5)  s' = a1 (e cos x - s sin x) / root
    (M6)  b'' = a1 ((a2^2 - a1^2 - e^2) sin x + a1 e (1 + sin^2 x)) / root^3
    (M7)  s'' = a1 cos x theta2' - n b''
    (M8)  condition = (a1 |cos theta2| + a2 + |e sin b|) a2 / |root|

where all is expanded about sin x = 0, 1 or -1, whichever is nearest: sin x = start + d, and near
+-1 d =
-+(1 - |sin x|) = -+cos^2 x / (1 + |sin x|), so that limits and change points keep their digits:

    (M9)  u = u(start) + a1 d,   w = w(start) - a1 d,   gap = gap(start) + 2 a1 e d
          b'' root^3 / a1 = gap(start) sin x + a1 e (1 + d^2 about 0, d^2 about +-1)

s' and s'' are as small as s and e where crank and coupler are nearly equal. A long crank (a1 > 2
a2) with its pin A near the level of the guide, |n| < a2/2, is treated by n alone,

    (M10)  u w = (a2 - n)(a2 + n),   b'' = a1 (u w sin x + a1 n cos^2 x) / root^3

because n is there rounded by up to eps a1, which is much beside a2, and all must be rounded by the
same.

Slider input: the triangle of :mod:`fourbar_ros.mechanisms.slide_dyad`, (T1) to (T8). Every
difference in these is one that the data make.
"""
from __future__ import annotations

from typing import Any, NamedTuple

from fourbar_ros.mechanisms.slide_dyad import make_triangle
from fourbar_ros.numerics.exact_sums import difference_of_squares
from fourbar_ros.numerics.number_types import Function, NumberType


class SliderCrankMotion(NamedTuple):
    """
    Pose, rates and accelerations for one input.

    Each field a float, or an array of the input's shape.

    Angles [rad], in [-pi, pi] but for a theta1 that is the input; theta2 is relative (coupler to
    crank), theta3 = -beta (slider to coupler): theta1 + theta2 + theta3 = 0.
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
    # [rad] in [0, pi]: of coupler and normal of the guide (slider input: crank)
    transmission_angle: float
    crank_ratio: float             # d theta1, d beta, d slide over d input
    coupler_ratio: float
    slide_ratio: float
    # relative error of the lengths -> error of slide [m] (of theta1 [rad])
    condition: float
    cos_x: float                   # directions of crank and coupler, and of theta2
    sin_x: float
    cos_b: float
    sin_b: float
    cos_2: float
    sin_2: float


class _Start(NamedTuple):
    """What is expanded about one value of sin x, and that value: (M9)."""

    u: Any
    w: Any
    gap: Any
    start: float


def _starts(n: NumberType, a1: Any, a2: Any, e: Any) -> tuple[_Start, _Start, _Start]:
    """Return the :class:`_Start` of sin x = 0, 1 and -1."""
    def squares(a: Any, b: Any, c: Any, d: Any) -> Any:
        return difference_of_squares(a, b, c, d, n.exact_sum)

    return (_Start(a2 - e, a2 + e, squares(a2, 0.0, a1, 0.0) - e * e, 0.0),
            _Start(n.exact_sum((a2, -e, a1)), n.exact_sum((a2, e, -a1)), squares(a2, 0.0, e, -a1),
                   1.0),
            _Start(n.exact_sum((a2, -e, -a1)), n.exact_sum((a2, e, a1)), squares(a2, 0.0, e, a1),
                   -1.0))


def make_crank_motion(n: NumberType, a1: Any, a2: Any, e: Any, sign: Any,
                      is_long: bool) -> Function:
    """
    Return the function (theta1, omega1, alpha1) -> fields of :class:`SliderCrankMotion`.

    ``is_long``: whether the crank is, so that (M10) may hold.
    """
    sin, cos, sqrt, atan2, fabs, where = n.sin, n.cos, n.sqrt, n.atan2, n.fabs, n.where
    unit = n.power_of_two(a1, a2, e)
    a1, a2, e = a1 / unit, a2 / unit, e / unit
    about_0, about_up, about_down = map(tuple, _starts(n, a1, a2, e))
    per_a2, a1_e, two_a1_e, level_square = 1.0 / a2, a1 * e, 2.0 * a1 * e, 0.25 * a2 * a2

    def motion(theta1: Any, omega1: Any, alpha1: Any) -> tuple[Any, ...]:
        cos_x, sin_x = cos(theta1), sin(theta1)
        low, is_about_0 = cos_x * cos_x / (1.0 + fabs(sin_x)), fabs(sin_x).real < 0.5
        u, w, gap, start = where(is_about_0, about_0,
                                 where(sin_x.real > 0.0, about_up, about_down))
        bulge = a1_e * (1.0 + sin_x * sin_x)
        d, curve = where(is_about_0, (sin_x, bulge), (-start * low, a1_e * low * low))
        at_x, step, nn = a1 * cos_x, a1 * d, e - a1 * sin_x
        u, w, by_sine, sine = u + step, w - step, gap, start + d                        # (M9)
        if is_long:                                                                     # (M10)
            up, down = a2 - nn, a2 + nn
            u, w, by_sine, sine, curve = where(
                (nn * nn).real < level_square, (up, down, up * down, sin_x, at_x * nn * cos_x),
                (u, w, by_sine, sine, curve))
        root = sign * sqrt(u * w)                                                       # (M1)
        cos_b, sin_b = root * per_a2, nn * per_a2 + 0.0 * root     # NaN too where nothing is real
        cos_2, sin_2 = cos_b * cos_x + sin_b * sin_x, sin_b * cos_x - cos_b * sin_x
        over, under = where((root * cos_x).real > 0.0, (at_x + root, 1.0),
                            (gap + two_a1_e * d, root - at_x))
        s, per = over / under, 1.0 / root                                               # (M2)
        coupler_ratio, d_theta2 = -at_x * per, -s * per                     # (M3), (M4)
        d_s = a1 * (e * cos_x - s * sin_x) * per                                        # (M5)
        dd_b = a1 * (by_sine * sine + curve) * per * per * per                          # (M6)
        dd_s = at_x * d_theta2 - nn * dd_b                                              # (M7)
        condition = unit * ((a1 * fabs(cos_2) + a2 + fabs(e * sin_b)) * a2 * fabs(per))     # (M8)
        square = omega1 * omega1
        theta2, omega2 = atan2(sin_2, cos_2), d_theta2 * omega1
        beta, omega_beta = atan2(sin_b, cos_b), coupler_ratio * omega1
        bent = dd_b * square
        alpha2, alpha_beta = d_theta2 * alpha1 + bent, coupler_ratio * alpha1 + bent
        theta3, omega3, alpha3 = -beta, -omega_beta, -alpha_beta
        slide, slide_velocity, slide_acceleration = (unit * s, unit * (d_s * omega1),
                                                     unit * (d_s * alpha1 + dd_s * square))
        crank_ratio, slide_ratio, transmission_angle = 1.0, unit * d_s, atan2(fabs(cos_b), sin_b)
        return (theta1, omega1, alpha1, theta2, omega2, alpha2, theta3, omega3, alpha3,
                slide, slide_velocity, slide_acceleration, beta, omega_beta, alpha_beta,
                transmission_angle, crank_ratio, coupler_ratio, slide_ratio, condition,
                cos_x, sin_x, cos_b, sin_b, cos_2, sin_2)
    return motion


def make_slider_motion(n: NumberType, a1: Any, a2: Any, e: Any, sign: Any) -> Function:
    """Return (slide, velocity, acceleration) -> fields of :class:`SliderCrankMotion`."""
    atan2, fabs = n.atan2, n.fabs
    unit = n.power_of_two(a1, a2, e)
    a1, a2, e, per_unit = a1 / unit, a2 / unit, e / unit, 1.0 / unit
    triangle = make_triangle(n, a1, a2, e, sign)

    def motion(slide: Any, slide_velocity: Any, slide_acceleration: Any) -> tuple[Any, ...]:
        (cos_x, sin_x, cos_b, sin_b, cos_2, sin_2, d_x, d_b, d_theta2, dd_x, dd_b, dd_theta2,
         per_root) = triangle(slide * per_unit)
        v, a = slide_velocity * per_unit, slide_acceleration * per_unit
        square = v * v
        theta1, omega1, alpha1 = atan2(sin_x, cos_x), d_x * v, d_x * a + dd_x * square
        theta2, omega2, alpha2 = (atan2(sin_2, cos_2), d_theta2 * v,
                                  d_theta2 * a + dd_theta2 * square)
        beta, omega_beta, alpha_beta = atan2(sin_b, cos_b), d_b * v, d_b * a + dd_b * square
        theta3, omega3, alpha3 = -beta, -omega_beta, -alpha_beta
        crank_ratio, coupler_ratio, slide_ratio = d_x * per_unit, d_b * per_unit, 1.0
        transmission_angle = fabs(theta2)
        condition = 2.0 * a2 * (a1 * fabs(cos_2) + a2 + fabs(e * sin_b)) * fabs(per_root)
        return (theta1, omega1, alpha1, theta2, omega2, alpha2, theta3, omega3, alpha3,
                slide, slide_velocity, slide_acceleration, beta, omega_beta, alpha_beta,
                transmission_angle, crank_ratio, coupler_ratio, slide_ratio, condition,
                cos_x, sin_x, cos_b, sin_b, cos_2, sin_2)
    return motion
