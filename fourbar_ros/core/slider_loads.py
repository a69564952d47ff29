"""
Loads of both slider mechanisms: Newton-Euler in closed form, one system per mechanism solved by hand.

Assumed as for the 4R (:mod:`.loads`); a guide transmits, without friction, a force square to it and a
couple. The drive is a pure torque on the crank, or a force along the slide.
"""
from __future__ import annotations

from math import fabs, frexp, hypot, ldexp
from typing import NamedTuple

from .dialects import dialects, where
from .loads import about_first_joint


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


def link_needs(link, mass, cosine, sine, omega, alpha, a_x, a_y):
    """
    Return what the joint forces of a link add up to and their moment about its first joint: Newton-Euler.

    Plain arithmetic, so that the functions of every dialect can call it.

    Parameters
    ----------
    link : tuple
        Of :func:`.loads.about_first_joint`, in its unit of length.
    mass : float
        [kg unit]
    cosine, sine, omega, alpha : float
        Direction of the link and its rate and acceleration.
    a_x, a_y : float
        Acceleration of the first joint [unit/s^2]: mass times it is a force.

    """
    along, across, inertia, hold_x, hold_y, couple, by_cosine, by_sine = link
    x, y = along * cosine - across * sine, along * sine + across * cosine
    square = omega * omega
    return (mass * a_x + hold_x - alpha * y - square * x, mass * a_y + hold_y + alpha * x - square * y,
            inertia * alpha + x * a_y - y * a_x + by_cosine * cosine + by_sine * sine + couple)


@dialects
def make_slider_crank_loads(a1, a2, e, is_crank, bodies, gravity, external):
    """
    Return the function (fields of SliderCrankMotion) -> fields of :class:`SliderLoads`.

    The force at B from the moment of the coupler and, for a driven crank, the slider's own equation along
    the guide, for a driven slider the moment of the crank; the drive from virtual power.
    """
    unit = ldexp(1.0, frexp(max(a1, a2, fabs(e)))[1])
    crank, coupler, slider = bodies

    def loads(motion, a1=a1 / unit, a2=a2 / unit, e=e / unit, unit=unit, per_unit=1.0 / unit, is_crank=is_crank,
              mass2=coupler.mass * unit, mass3=slider.mass * unit,
              crank=about_first_joint(crank, unit, gravity),
              coupler=about_first_joint(coupler, unit, gravity, external.coupler),
              slider=about_first_joint(slider, unit, gravity, external.output)):
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
        f32_x = where(is_crank, -f3_x, along_b * cos_b + along_x * cos_x) / where(is_crank, 1.0, sin_2)
        f32_y = where(is_crank, -along_x - sin_b * f3_x, along_b * sin_b + along_x * sin_x) / where(is_crank, cos_b, sin_2)
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


@dialects
def make_inverted_loads(a1, a4, h, is_crank, bodies, gravity, external):
    """
    Return the function (fields of InvertedSliderMotion) -> fields of :class:`SliderLoads`.

    The force between block and bar from the moments of both about O4 and,
    for a driven slide, of the crank; the drive from virtual power.
    """
    unit = ldexp(1.0, frexp(max(a1, a4, fabs(h)))[1])
    crank, block, bar = bodies

    def loads(motion, a1=a1 / unit, a4=a4 / unit, h=h / unit, unit=unit, per_unit=1.0 / unit, is_crank=is_crank,
              mass2=block.mass * unit, crank=about_first_joint(crank, unit, gravity),
              block=about_first_joint(block, unit, gravity, external.coupler),
              bar=about_first_joint(bar, unit, gravity, external.output)):
        (_, omega, alpha, _, _, _, _, omega4, alpha4, slide, _, _, _, dx, dy, _, _,
         cos_x, sin_x, cos_y, sin_y, _, sin_2) = motion
        f1_x, f1_y, moment1 = link_needs(crank, 0.0, cos_x, sin_x, omega, alpha, 0.0, 0.0)
        at_x, at_y, square = a1 * cos_x, a1 * sin_x, omega * omega     # A
        f2_x, f2_y, moment2 = link_needs(block, mass2, cos_y, sin_y, omega4, alpha4,
                                         -alpha * at_y - square * at_x, alpha * at_x - square * at_y)
        f3_x, f3_y, moment3 = link_needs(bar, 0.0, cos_y, sin_y, omega4, alpha4, 0.0, 0.0)
        carried, turning = moment1 + at_x * f2_y - at_y * f2_x, moment2 + moment3
        drive = unit * (carried * dx + turning * dy)
        normal = (where(is_crank, -turning, h * carried / a1 - turning * sin_2)
                  / where(is_crank, slide * per_unit, a4 * sin_x))
        torque, force = where(is_crank, (drive, 0.0), (0.0, drive))
        f32_x, f32_y = force * cos_y - normal * sin_y, force * sin_y + normal * cos_y
        f21_x, f21_y = f32_x - f2_x, f32_y - f2_y
        f43_x, f43_y = f3_x + f32_x, f3_y + f32_y
        f41_x, f41_y = f1_x - f21_x, f1_y - f21_y
        shaking_x, shaking_y = -(f1_x + f2_x + f3_x), -(f1_y + f2_y + f3_y)
        return (f41_x, f41_y, f21_x, f21_y, f32_x, f32_y, f43_x, f43_y,
                hypot(f41_x, f41_y), hypot(f21_x, f21_y), hypot(f32_x, f32_y), hypot(f43_x, f43_y),
                normal, unit * moment2, torque, force, shaking_x, shaking_y, hypot(shaking_x, shaking_y),
                -unit * (carried + turning + a4 * f3_y))
    return loads
