"""
Position, velocity and acceleration of the 4R linkage, stable in the last bits.

Notation of this module: x = theta1, y = theta4, b = beta (all absolute), mu = y - b, primes are
derivatives with respect to x. Loop: a1 e^{ix} + a2 e^{ib} = a4 + a3 e^{iy}.

Every angle comes from its own homogeneous half-angle quadratic p t^2 - 2 m t + r = 0 (slides,
Eqs. (16), (17) and their rotations), with t = n/d kept as a pair, so that no angle is special
(t = tan(pi/2) is just d = 0), and of the two forms of a root the one without cancellation is taken.
The quadratics share one discriminant T = (2 a2 a3 sin mu)^2, which is a product of two sums of
bilinear factors: it keeps its digits near toggles and change points, where coordinates lose them.
"""
from __future__ import annotations

from math import atan2, cos, fabs, frexp, ldexp, pi, sin, sqrt
from typing import NamedTuple

from .dialects import dialects, where
from .factors import difference_of_squares, half_angle_coefficients

# Added to sin(x/2): nothing, except at x = 0 exactly, where an exact change point (0/0) thereby takes
# its one-sided value for x -> 0+. Its square is still a normal number.
INFINITESIMAL = 2.0**-500


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

    def motion(x, omega, alpha, sign=sign, a1=a1, a2=a2, a3=a3, a4=a4,
               s1=difference_of_squares(a2, a3, a1, a4), s2=difference_of_squares(a1, -a4, a2, -a3),
               k=4.0 * a1 * a4, r12=a1 / a2, r13=a1 / a3,
               sine_scale=0.5 / (a2 * a3), cosine_scale=0.25 / (a2 * a3),
               absolute_y=half_angle_coefficients(a1, a2, a3, a4),
               relative_y=half_angle_coefficients(-a4, a2, a3, -a1),
               relative_b=half_angle_coefficients(-a4, a3, -a2, -a1)):
        sh, ch = sin(0.5 * x) + INFINITESIMAL, cos(0.5 * x)
        ss, cc, sc = sh * sh, ch * ch, sh * ch
        u = s1 + k * cc                # (a2 + a3)^2 - |A O4|^2 = 4 a2 a3 cos^2(mu/2)
        w = s2 + k * ss                # |A O4|^2 - (a2 - a3)^2 = 4 a2 a3 sin^2(mu/2)
        root = sign * sqrt(u * w)      # 2 a2 a3 sin mu; not real where the linkage cannot close

        A, B, C, D, M = absolute_y
        m = M * sc
        n, d = where((m * root).real > 0.0, (B * ss + D * cc, m + root), (m - root, A * ss + C * cc))
        theta4 = atan2(2.0 * n * d, (d - n) * (d + n))

        A, B, C, D, M = relative_y     # y - x: seen from the crank, the ground turns by -x
        m = -M * sc
        n, d = where((m * root).real > 0.0, (B * ss + D * cc, m + root), (m - root, A * ss + C * cc))
        scale = 1.0 / (n * n + d * d)
        cos_yx, sin_yx = (d - n) * (d + n) * scale, 2.0 * n * d * scale

        A, B, C, D, M = relative_b     # b - x: the other root of its quadratic
        m = -M * sc
        n, d = where((m * root).real < 0.0, (B * ss + D * cc, m - root), (m + root, A * ss + C * cc))
        scale = 1.0 / (n * n + d * d)
        cos_bx, sin_bx = (d - n) * (d + n) * scale, 2.0 * n * d * scale
        theta2 = atan2(sin_bx, cos_bx)

        cos_x, sin_x = (ch - sh) * (ch + sh), 2.0 * sc
        cos_b, sin_b = cos_x * cos_bx - sin_x * sin_bx, sin_x * cos_bx + cos_x * sin_bx
        cos_y, sin_y = cos_x * cos_yx - sin_x * sin_yx, sin_x * cos_yx + cos_x * sin_yx
        cos_mu, sin_mu = (u - w) * cosine_scale, root * sine_scale
        mu = atan2(sin_mu, cos_mu)

        dy = -r13 * sin_bx / sin_mu
        db = -r12 * sin_yx / sin_mu
        turn = cos_mu * (dy - db)
        ddy = (r13 * cos_bx * (1.0 - db) - dy * turn) / sin_mu
        ddb = (r12 * cos_yx * (1.0 - dy) - db * turn) / sin_mu

        omega4, omega_b, square = dy * omega, db * omega, omega * omega
        alpha4, alpha_b = dy * alpha + ddy * square, db * alpha + ddb * square
        condition = (fabs(a1 * cos_bx) + a2 + fabs(a3 * cos_mu) + fabs(a4 * cos_b)) / (a3 * fabs(sin_mu))
        return (x, omega, alpha, theta2, omega_b - omega, alpha_b - alpha,
                mu - sign * pi, omega4 - omega_b, alpha4 - alpha_b, theta4, omega4, alpha4,
                atan2(sin_b, cos_b), omega_b, alpha_b, fabs(mu), dy, condition,
                cos_x, sin_x, cos_b, sin_b, cos_y, sin_y, cos_mu, sin_mu)
    return motion
