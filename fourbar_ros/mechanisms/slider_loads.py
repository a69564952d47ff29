"""
Loads of both slider mechanisms: Newton-Euler in closed form, one system per mechanism solved by hand.

Assumed as for the 4R (:mod:`fourbar_ros.mechanisms.four_bar.loads`); a guide transmits, without friction, a force square to it and a
couple. The drive is a pure torque on the crank, or a force along the slide.
"""
from __future__ import annotations

from math import fabs, frexp, hypot, ldexp
from typing import NamedTuple

from fourbar_ros.numerics.dialects import dialects, where
from fourbar_ros.mechanisms.four_bar.loads import (
    about_first_joint,
    crank_with_pin,
    needs_of_crank_and_carried,
    needs_of_pivoted,
)


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


@dialects
def make_slider_crank_loads(a1, a2, e, is_crank, bodies, gravity, external):
    """
    Return the function (fields of SliderCrankMotion) -> fields of :class:`SliderLoads`.

    The force at B from the moment of the coupler and, for a driven crank, the slider's own equation along
    the guide, for a driven slider the moment of the crank; the drive from virtual power.
    """
    unit = ldexp(1.0, frexp(max(a1, a2, fabs(e)))[1])
    a1, a2, e = a1 / unit, a2 / unit, e / unit
    crank, coupler, slider = bodies
    mass2, carried = coupler.mass * unit, about_first_joint(coupler, unit, gravity, external.coupler)
    _, across, _, hold_x, hold_y, couple, by_cosine, _ = about_first_joint(slider, unit, gravity, external.output)

    def loads(motion, a1=a1, a2=a2, e=e, unit=unit, per_unit=1.0 / unit, is_crank=is_crank,
              mass2=mass2, mass3=slider.mass * unit, crank=crank_with_pin(crank, carried, mass2, a1, unit, gravity),
              coupler=carried,
              across=across, hold_x=hold_x, hold_y=hold_y, at_rest=by_cosine + couple):
        (_, omega, alpha, _, omega2, _, _, _, _, slide, _, slide_acceleration, _, omega_b, alpha_b, _, dx, db, ds, _,
         cos_x, sin_x, cos_b, sin_b, _, sin_2) = motion
        square, square_b = omega * omega, omega_b * omega_b
        f1_x, f1_y, f2_x, f2_y, moment1, about_a, aside = needs_of_crank_and_carried(
            crank, coupler, mass2, a1, cos_x, sin_x, square, alpha, cos_b, sin_b, square_b, alpha_b)
        growth = slide_acceleration * per_unit
        f3_x, f3_y, moment3 = mass3 * growth + hold_x, hold_y, at_rest - across * growth

        moment2 = about_a + aside * square
        drive = unit * (moment1 * dx + about_a * db - aside * (omega_b * omega2) * dx) + f3_x * ds
        carried = moment1 - aside * square_b
        along_b, along_x = carried / a1, -moment2 / a2
        f32_x = where(is_crank, -f3_x, along_b * cos_b + along_x * cos_x) / where(is_crank, 1.0, sin_2)
        f32_y = where(is_crank, -along_x - sin_b * f3_x, along_b * sin_b + along_x * sin_x) / where(is_crank, cos_b, sin_2)
        f21_x, f21_y = f32_x - f2_x, f32_y - f2_y
        torque, force = where(is_crank, (drive, 0.0), (0.0, drive))
        f43_x, f43_y = force, f3_y + f32_y
        f41_x, f41_y = f1_x - f21_x, f1_y - f21_y
        shaking_x, shaking_y = -(f1_x + f2_x + f3_x), -(f1_y + f2_y + f3_y)
        moment = (aside * (omega2 * (omega + omega_b))
                  - (moment1 + about_a + moment3 + (slide * per_unit) * f3_y - e * f3_x))
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
    a1, a4, h = a1 / unit, a4 / unit, h / unit
    crank, block, bar = bodies
    mass2, carried = block.mass * unit, about_first_joint(block, unit, gravity, external.coupler)

    def loads(motion, a1=a1, a4=a4, h=h, unit=unit, per_unit=1.0 / unit, is_crank=is_crank,
              mass2=mass2, crank=crank_with_pin(crank, carried, mass2, a1, unit, gravity), block=carried,
              bar=about_first_joint(bar, unit, gravity, external.output)):
        (_, omega, alpha, _, omega2, _, _, omega4, alpha4, slide, _, _, _, dx, dy, _, _,
         cos_x, sin_x, cos_y, sin_y, _, sin_2) = motion
        square, square_4 = omega * omega, omega4 * omega4
        f1_x, f1_y, f2_x, f2_y, moment1, about_a, aside = needs_of_crank_and_carried(
            crank, block, mass2, a1, cos_x, sin_x, square, alpha, cos_y, sin_y, square_4, alpha4)
        f3_x, f3_y, moment3 = needs_of_pivoted(bar, cos_y, sin_y, square_4, alpha4)

        moment2 = about_a + aside * square
        drive = unit * (moment1 * dx + (about_a + moment3) * dy - aside * (omega4 * omega2) * dx)
        carried, turning = moment1 - aside * square_4, moment2 + moment3
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
                unit * (aside * (omega2 * (omega + omega4)) - (moment1 + about_a + moment3 + a4 * f3_y)))
    return loads
