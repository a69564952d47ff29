# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The collineation axis of a linkage as a picture, and its angle to the coupler.

It passes through the poles P13 and P24; where it is square to the coupler, the output is fastest
or slowest. Only the functions that draw import matplotlib.
"""
from __future__ import annotations

from math import degrees, hypot, inf
from typing import Any, TYPE_CHECKING

from fourbar_lab.drawing.collineation import collineation_axis
from fourbar_lab.drawing.cycles import cycles
from fourbar_lab.drawing.figure import BESIDE, CannotDraw, new_figure, Paper
from fourbar_lab.drawing.mechanism_panel import draw_mechanism
from fourbar_lab.drawing.record import counted
from fourbar_ros import Mechanism
from fourbar_ros.extrema.find import find_extrema, INTERIOR
from fourbar_ros.extrema.over_input import most_extreme
from fourbar_ros.mechanisms import parts, picture
from fourbar_ros.numerics.arrays import Array
import numpy as np

if TYPE_CHECKING:      # drawings alone need it
    from fourbar_lab.drawing.paper import PaperFigure as Figure
    from matplotlib.axes import Axes

NEAR = 1.6       # sizes of the mechanism from its middle: farther poles are left out
AXIS = '#1f4e8c'        # colour


def axis_parts(linkage: Mechanism, motion: parts.NamedFields, low: Array, high: Array
               ) -> tuple[dict[str, Array], dict[str, Array]]:
    """Return {line: its ends, shape (2, 2)} and {letter: pole} of a pose in a window [m]."""
    axis, unit = collineation_axis(linkage, motion), max(map(abs, linkage.lengths))
    middle, reach = 0.5 * (low + high), 0.5 * hypot(*(high - low))
    lines = {}
    for name, (a, b, c) in axis.lines.items():
        size = hypot(a, b)
        distance = (a * middle[0] + b * middle[1] + c * unit) / size if size > 0.0 else inf
        if abs(distance) < reach:       # not at infinity, nor NaN
            normal, along = np.array([[a, b], [-b, a]]) / size
            lines[name] = middle - distance * normal + np.outer([-reach, reach], along)
    with np.errstate(divide='ignore', invalid='ignore'):
        poles = {letter: unit * pole[:2] / pole[2]
                 for letter, pole in (('P_{13}', axis.p13), ('P_{24}', axis.p24))}
    return lines, {letter: pole for letter, pole in poles.items()
                   if (low <= pole).all() and (pole <= high).all()}


def axis_angle(linkage: Mechanism, motion: parts.NamedFields) -> Array:
    """Return the angle from coupler to axis, 0 to 180 deg; NaN: no axis, or of n poses a jump."""
    angles = np.asarray(np.degrees(collineation_axis(linkage, motion).angle) % 180.0)
    if angles.ndim:
        angles[np.abs(np.diff(angles, prepend=angles[0])) > 90.0] = np.nan
    return angles


def draw_axis(axes: Axes, linkage: Mechanism, motion: parts.NamedFields, title: str = '') -> None:
    """Draw a linkage in a pose with its collineation axis, in blue, and the lines that make it."""
    joints = np.array(list(picture.diagram_of(linkage, motion).joints.values()))
    size, middle = max(np.ptp(joints, axis=0)), 0.5 * (joints.min(axis=0) + joints.max(axis=0))
    reach = NEAR * np.array([size, size])
    # twice: poles near enough make room on the sheet, whose window then clips the lines
    _, poles = axis_parts(linkage, motion, middle - reach, middle + reach)
    sheet = draw_mechanism(axes, linkage, motion, {}, (), list(poles.values()), title=title)
    lines, poles = axis_parts(linkage, motion, sheet.low, sheet.high)
    for name, ends in lines.items():
        style: dict[str, Any] = ({'color': AXIS, 'lw': 1.8} if name == 'axis' else
                                 {'color': '0.55', 'lw': 0.8, 'ls': (0, (5, 3))})
        sheet.line(*ends, zorder=1, **style)
    for letter, pole in poles.items():
        axes.plot(*pole, 'o', ms=5, color=AXIS, zorder=7)
        sheet.label(letter, pole, (0.0, 1.0), AXIS)
    sheet.scale('m')
    sheet.finish()
    axes.annotate(f'axis at {axis_angle(linkage, motion):.4f}\N{DEGREE SIGN} to the coupler',
                  (0.98, 0.01), (0, 16 * sheet.zoom), ha='right', xycoords='axes fraction',
                  textcoords='offset points', color=AXIS, fontsize=11 * sheet.zoom, zorder=8,
                  bbox={'fc': 'w', 'ec': 'none', 'pad': 1.0})      # above the scale


def make_axis_figure(linkage: Mechanism, rate: float, position: float | None = None,
                     paper: Paper = Paper()) -> Figure:
    """
    Return a matplotlib Figure: the axis in a pose; the output's rate and the angle over the input.

    ``rate`` is the crank's [rad/s], ``position`` its angle in the pose [rad], by default where the
    output is fastest. InvalidParameter unless it is a four-bar or a slider-crank that its crank
    drives.
    """
    coordinate = linkage.outputs[0].coordinate
    collineation_axis(linkage, linkage.motion(cycles(linkage)[0][1], rate))     # refuses others
    extrema = [extremum for extremum in find_extrema(linkage, coordinate.rate, rate)
               if extremum.place == INTERIOR]
    if position is None:
        fastest = most_extreme(extrema, 1, abs)
        if fastest is None:
            raise CannotDraw(f'{coordinate.rate} has no extremum inside a range: give at')
        position = fastest.theta1
    title = f'{linkage.description}, theta1 {degrees(position):.4f} deg'
    with new_figure(12.6, 5.6, paper) as figure:
        boxes = (0.01, 0.02, 0.5, 0.9), (0.6, 0.56, 0.38, 0.38), (0.6, 0.1, 0.38, 0.38)
        if figure.get_figwidth() < BESIDE:          # below each other
            figure.set_figheight(1.45 * figure.get_figwidth())
            boxes = (0.01, 0.5, 0.98, 0.45), (0.17, 0.29, 0.8, 0.18), (0.17, 0.07, 0.8, 0.18)
        left, upper, lower = [figure.add_axes(box) for box in boxes]
        draw_axis(left, linkage, linkage.motion(position, rate),
                  figure.title_of(title, paper.title))
        for inputs in cycles(linkage, from_zero=True):
            motion = linkage.motion(inputs, rate)
            upper.plot(np.degrees(inputs), getattr(motion, coordinate.rate), color=AXIS)
            lower.plot(np.degrees(inputs), axis_angle(linkage, motion), color=AXIS)
        for extremum in extrema:
            x = degrees(counted(linkage, extremum.theta1))
            upper.plot(x, extremum.value, 'o', ms=6, mfc='none', mec='k')
            lower.plot(x, 90.0, 'o', ms=6, mfc='none', mec='k')
        unit = 'm/s' if coordinate.unit == 'm' else 'rad/s'
        upper.tick_params(labelbottom=False)
        upper.set(ylabel=f'{coordinate.rate} [{unit}]')
        lower.set(ylabel='coupler to axis [deg]', xlabel='theta1 [deg]', ylim=(0.0, 180.0),
                  yticks=(0, 45, 90, 135, 180))
        for axes in (upper, lower):
            axes.grid(alpha=0.3)
            axes.axvline(degrees(counted(linkage, position)), color='0.6', lw=0.8)
    return figure
