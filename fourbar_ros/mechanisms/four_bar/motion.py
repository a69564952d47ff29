"""
Position, velocity and acceleration of the 4R linkage, stable in the last bits.

Notation of this module: x = theta1, y = theta4, b = beta (all absolute), mu = y - b, q = |A O4|^2,
primes are derivatives with respect to x. Loop: a1 e^{ix} + a2 e^{ib} = a4 + a3 e^{iy}.

Positions. Every angle comes from its own homogeneous half-angle quadratic p t^2 - 2 m t + r = 0
(slides, Eqs. (16), (17) and their rotations), with t = n/d kept as a pair, so that no angle is special
(t = tan(pi/2) is just d = 0), and of the two forms of a root, (m + root)/p and r/(m - root), the one
without cancellation is taken. The quadratics share one discriminant T = (2 a2 a3 sin mu)^2 = u w,

    u = 4 a2 a3 cos^2(mu/2) = s1 sin^2(x/2) + c1 cos^2(x/2)
    w = 4 a2 a3 sin^2(mu/2) = c2 sin^2(x/2) + s2 cos^2(x/2)

whose coefficients are products of two bilinear factors each: they keep their digits near toggles and
change points, where coordinates lose them.

Rates. The relative rates at the four joints are as the areas of the triangles of the other three
joints, so each is a product, without a difference of rates:

    y' = a1 sin(x - b) / (a3 sin mu)        b' - 1 = -a4 sin y / (a2 sin mu)
    b' = a1 sin(x - y) / (a2 sin mu)        y' - b' = a1 a4 sin x / (a2 a3 sin mu)

Accelerations. mu is a function of q alone, and y and b are the direction of the diagonal A-O4 plus or
minus an angle of the triangle A-B-O4. With e = a1^2 - a4^2, f = a2^2 - a3^2:

    mu'' = 2 a1 a4 (s2 cos^2(x/2) u - s1 sin^2(x/2) w) / T^(3/2)
    y'' = ((f + q) mu'' - 2 a1 a4 sin x rho) / (2 q)     rho = y' + b' - 1 = (e + f mu')/q
    b'' = ((f - q) mu'' - 2 a1 a4 sin x rho) / (2 q)

where the second form of rho is for large q, so for all where a1 = a4. Every difference in these is one
that the data make: the error stays within a few eps times the condition at any link ratio.

Change points. Where a sum of lengths is zero (parallelogram, kite, ...), so is s1 or s2 exactly; u or
w is then one term, which the divisions cancel: no other path is needed. At the flat position both modes
meet; each mode keeps its sign of sin mu on either side of it, so that its rates jump there, and the
values returned at theta1 = 0 itself are the limits for theta1 -> 0 from above (y'' = b'' = 0). At
theta1 = pi there is no such case: no float is pi, each is on one side.
"""
from __future__ import annotations

from math import atan2, cos, fabs, frexp, ldexp, pi, sin, sqrt
from typing import NamedTuple

from fourbar_ros.numerics.dialects import dialects, where
from fourbar_ros.mechanisms.four_bar.half_angle import (
    difference_of_squares,
    half_angle_coefficients,
)

# Added to sin(x/2): nothing, except at x = 0 exactly, where an exact change point (0/0) thereby takes
# its one-sided value for x -> 0+. Its third power is still a normal number.
INFINITESIMAL = 2.0**-250


class Motion(NamedTuple):
    """
    Pose, rates and accelerations for one input; each field a float, or an array of the input's shape.

    Angles in [rad], rates in [rad/s], accelerations in [rad/s^2]; angles other than theta1 lie in
    [-pi, pi]. theta2 and theta3 are relative (coupler to crank, output link to coupler): theta1 +
    theta2 + theta3 = theta4 + pi.
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
    theta4: float
    omega4: float
    alpha4: float
    beta: float                  # absolute coupler angle
    omega_beta: float
    alpha_beta: float
    transmission_angle: float    # [rad] |theta4 - beta|, in [0, pi]
    velocity_ratio: float        # d theta4 / d theta1
    coupler_ratio: float         # d beta / d theta1
    condition: float             # relative error of the lengths -> error of theta4 [rad]
    cos_x: float                 # directions of crank, coupler, output link and of mu = theta4 - beta
    sin_x: float
    cos_b: float
    sin_b: float
    cos_y: float
    sin_y: float
    cos_mu: float
    sin_mu: float


@dialects
def make_motion(a1, a2, a3, a4, sign):
    """
    Return the function (theta1, omega1, alpha1) -> fields of :class:`Motion` for fixed lengths.

    ``sign`` is the sign of sin(theta4 - beta): +1 for mode 2 (open), -1 for mode 1 (crossed).
    Constants are bound as default arguments: local names are what makes the scalar dialect fast.
    """
    exponent = frexp(max(a1, a2, a3, a4))[1]     # scaling by a power of two is exact
    a1, a2, a3, a4 = ldexp(a1, -exponent), ldexp(a2, -exponent), ldexp(a3, -exponent), ldexp(a4, -exponent)
    Ay, By, Cy, Dy, My = half_angle_coefficients(a1, a2, a3, a4)        # y
    Ar, Br, Cr, Dr, Mr = half_angle_coefficients(-a4, a2, a3, -a1)      # y - x: seen from the crank the
    Ab, Bb, Cb, Db, Mb = half_angle_coefficients(-a4, a3, -a2, -a1)     # ground turns by -x; b - x
    e, f = (a1 - a4) * (a1 + a4), (a2 - a3) * (a2 + a3)
    # Of three squares the odd one is paired with the larger of the others: what cancels then is what the data make.
    y_near = where(fabs(a1 - a4) > a2, difference_of_squares(a1, -a4, a3, 0.0) + a2 * a2, f + (a1 - a4)**2)
    y_far = where(a1 + a4 > a2, difference_of_squares(a1, a4, a3, 0.0) + a2 * a2, f + (a1 + a4)**2)
    b_near = where(fabs(a1 - a4) > a3, difference_of_squares(a2, 0.0, a1, -a4) - a3 * a3, f - (a1 - a4)**2)
    b_far = where(a1 + a4 > a3, difference_of_squares(a2, 0.0, a1, a4) - a3 * a3, f - (a1 + a4)**2)

    def motion(x, omega, alpha, sign=sign, straight=sign * pi,
               s1=difference_of_squares(a2, a3, a1, a4), c1=difference_of_squares(a2, a3, a1, -a4),
               s2=difference_of_squares(a1, -a4, a2, -a3), c2=difference_of_squares(a1, a4, a2, -a3),
               upper=(By, Dy, Br, Dr, Bb, Db, 1.0), lower=(Ay, Cy, Ar, Cr, Ab, Cb, -1.0),
               My=My, Mr=-Mr, Mb=-Mb, r2=-a4 / a2, r3=a1 * a4 / (a2 * a3), r4=-a1 / a3, rb=-a1 / a2,
               j1=2.0 * a1 * a4 * difference_of_squares(a2, a3, a1, a4),
               j2=2.0 * a1 * a4 * difference_of_squares(a1, -a4, a2, -a3),
               e=e, f=f, least_q=fabs(e), k=4.0 * a1 * a4, near=(a1 - a4)**2, half_k=a1 * a4,
               y_near=0.5 * y_near, y_far=0.5 * y_far, b_near=0.5 * b_near, b_far=0.5 * b_far,
               n1=sign * a1 / a3, n2=sign * a2 / a3, n4=sign * a4 / a3):
        half = 0.5 * x
        sh, ch = sin(half) + INFINITESIMAL, cos(half)
        ss, cc, sc = sh * sh, ch * ch, sh * ch
        cos_x, sin_x = cc - ss, sc + sc
        u, w = s1 * ss + c1 * cc, c2 * ss + s2 * cc
        square = u * w
        root = sign * sqrt(square)     # 2 a2 a3 sin mu; not real where the linkage cannot close
        # 1/(4 a2 a3) with the roundings of u and w; the root makes cos_mu NaN where nothing is real
        scale = 1.0 / (u + w + 0.0 * root)
        cos_mu, sin_mu = (u - w) * scale, (root + root) * scale
        mu = atan2(sin_mu, cos_mu)

        # Of (m + root)/p and r/(m - root) the first is h/g, the second g/h, so that the sine is that of
        # either, the cosine has the sign "side". What adds for one angle adds for all three.
        same = (sc * root).real > 0.0
        B, D, E, F, G, H, side = where(same, upper, lower)
        signed = side * root
        g, h = B * ss + D * cc, My * sc + signed
        hh = h * h
        scale = 2.0 / (g * g + hh)
        cos_y, sin_y = side * (hh * scale - 1.0), g * h * scale
        g, h = E * ss + F * cc, Mr * sc + signed
        sin_yx = 2.0 * g * h / (g * g + h * h)
        g, h = G * ss + H * cc, Mb * sc - signed
        hh = h * h
        scale = 2.0 / (g * g + hh)
        cos_bx, sin_bx = side * (hh * scale - 1.0), g * h * scale
        cos_b, sin_b = cos_x * cos_bx - sin_x * sin_bx, sin_x * cos_bx + cos_x * sin_bx

        scale = 1.0 / sin_mu
        d2, d3, dy, db = r2 * sin_y * scale, r3 * sin_x * scale, r4 * sin_bx * scale, rb * sin_yx * scale
        condition = (n1 * fabs(cos_bx) + n2 + sign * fabs(cos_mu) + n4 * fabs(cos_b)) * scale

        q = near + k * ss
        scale = 1.0 / q
        turn = half_k * sin_x * where(q.real > least_q, (e + f * d3) * scale, dy + d2)
        dd3 = (j2 * cc * u - j1 * ss * w) / (square * root)
        ddy = ((y_near * cc + y_far * ss) * dd3 - turn) * scale
        ddb = ((b_near * cc + b_far * ss) * dd3 - turn) * scale

        omega4, omega_b, square = dy * omega, db * omega, omega * omega
        return (x, omega, alpha,
                atan2(sin_bx, cos_bx), d2 * omega, d2 * alpha + ddb * square,
                mu - straight, d3 * omega, d3 * alpha + dd3 * square,
                atan2(sin_y, cos_y), omega4, dy * alpha + ddy * square,
                atan2(sin_b, cos_b), omega_b, db * alpha + ddb * square,
                sign * mu, dy, db, condition,
                cos_x, sin_x, cos_b, sin_b, cos_y, sin_y, cos_mu, sin_mu)
    return motion
