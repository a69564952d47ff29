# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Why a rate is extreme where it is: the collineation axis of a loop of four links.

The pole P13 lies where the ground line meets the coupler line, P24 where the crank line meets the
output line. The line through both is the collineation axis; l is the angle to it from the coupler
line. With R the rate of the output over that of the crank, at constant rate of the crank

    (Y1)  R' = R (1 - R) cot(l),    d(tan l)/d(theta1) = 1 - 2 R - R (1 - R) R''/R'^2

so omega4 is extreme where the axis is square to the coupler, alpha4 where the last term is zero
but R is not 0 or 1. The first is Freudenstein's (1956).
Joints are homogeneous, (x w, y w, w): a slide is a joint at infinity, and for a slide that a crank
drives

    (Y2)  R' = R cot(l),    d(tan l)/d(theta1) = 1 - R R''/R'^2

docs/extrema.md derives both.

>>> from math import degrees
>>> from fourbar_ros import FourBar, find_extrema
>>> linkage = FourBar(2.0, 6.0, 7.0, 5.0)
>>> for extremum in find_extrema(linkage, ('omega4',), 10.0):
...     axis = collineation_axis(linkage, linkage.motion(extremum.theta1, 10.0))
...     print(f'{degrees(extremum.theta1):.4f} deg: {abs(degrees(axis.angle)):.6f} deg')
2.6810 deg: 90.000000 deg
138.9638 deg: 90.000000 deg
"""
from functools import partial
from typing import Any, NamedTuple

from fourbar_ros import FourBar, InvalidParameter, InvertedSlider, Mechanism, SliderCrank
from fourbar_ros.mechanisms.parts import NamedFields
from fourbar_ros.notebook import short_repr
from fourbar_ros.numerics.arrays import Array
import numpy as np


class CollineationAxis(NamedTuple):
    """
    The collineation axis in one pose, or in n.

    The poles are homogeneous, shape (3,) or (3, n): the place over the longest link is
    (x/w, y/w), at infinity for w = 0. Lines (a, b, c), of the points a x + b y + c w = 0 over the
    longest link, have the same shape.
    """

    p13: Array
    p24: Array
    along: Array                # the axis along the coupler line and square to it, in one unit
    across: Array
    lines: dict[str, Array]     # 'ground', 'coupler', 'crank', 'output' and the 'axis'

    def __repr__(self) -> str:
        return short_repr('CollineationAxis', self._asdict())

    @property
    def angle(self) -> Array:
        """Return the angle l from coupler line to axis, (-pi/2, pi/2] [rad]; NaN without axis."""
        sense = np.where(self.along < 0.0, -1.0, 1.0)
        is_none = (np.asarray(self.along) == 0.0) & (np.asarray(self.across) == 0.0)
        return np.where(is_none, np.nan, np.arctan2(sense * self.across, sense * self.along))[()]


def collineation_axis(linkage: Mechanism, motion: NamedFields) -> CollineationAxis:
    """Return the collineation axis of a four-bar or slider-crank; InvalidParameter of others."""
    if linkage.is_driven_by_slide or not isinstance(
            linkage, (FourBar, SliderCrank, InvertedSlider)):
        raise InvalidParameter('linkage', type(linkage).__name__, 'must be a four-bar or a '
                               'slider-crank that its crank drives')
    unit, a1 = max(map(abs, linkage.lengths)), linkage.lengths[0]
    fields: Any = motion
    # (x w, y w, w) of the joints; O1, A, and beside the output B, O4
    if isinstance(linkage, SliderCrank):        # O4 is at infinity, square to the guide
        of_output = (fields.slide, linkage.offset, 1.0), (0.0, 1.0, 0.0)
    else:
        sine, cosine = np.sin(fields.theta4), np.cos(fields.theta4)
        if isinstance(linkage, InvertedSlider):     # B is at infinity, square to the bar
            of_output = (-sine, cosine, 0.0), (linkage.a4, 0.0, 1.0)
        else:
            _, _, a3, a4 = linkage.lengths
            of_output = (a4 + a3 * cosine, a3 * sine, 1.0), (a4, 0.0, 1.0)
    corners = ((0.0, 0.0, 1.0), (a1 * np.cos(fields.theta1), a1 * np.sin(fields.theta1), 1.0),
               *of_output)
    scales = [unit if w > 0.0 else 1.0 for *_, w in corners]     # a direction has no unit
    o1, a, b, o4 = (np.stack(np.broadcast_arrays(x / scale, y / scale, w, motion.theta1)[:-1])
                    for (x, y, w), scale in zip(corners, scales))
    cross = partial(np.cross, axis=0)        # the line through two points, the point on two lines
    lines = {'ground': cross(o1, o4), 'coupler': cross(a, b), 'crank': cross(o1, a),
             'output': cross(o4, b)}
    p13 = cross(lines['ground'], coupler := lines['coupler'])
    p24 = cross(lines['crank'], lines['output'])
    lines['axis'] = axis = cross(p13, p24)
    return CollineationAxis(p13, p24, coupler[0] * axis[0] + coupler[1] * axis[1],
                            coupler[0] * axis[1] - coupler[1] * axis[0], lines)
