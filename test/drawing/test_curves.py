# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Curves over the input with their extrema."""
from fourbar_lab.drawing.curves import curves_of, make_figure
from fourbar_lab.drawing.tables import input_of
from fourbar_ros import find_extrema
from fourbar_ros.mechanisms.quantities import select
from fourbar_ros.scene.scene import load
import numpy as np
import pytest


@pytest.mark.parametrize('name', ['paper', 'slider_crank', 'cylinder', 'jansen'])
def test_marks_of_extrema_lie_on_their_curves(name):
    """To half the largest second difference: what a polygon leaves at the kink of an amount."""
    scene = load(name)
    linkage, speed = scene.linkage, scene.drive.speed
    curves = curves_of(scene, linkage, [one.name for one in select((), linkage)], speed)
    unit = np.degrees(1.0) if curves.units[0] == 'deg' else 1.0
    marks = [(found.quantity, unit * input_of(linkage, found), found.value)
             for found in find_extrema(linkage, rate=speed)
             if found.kind != 'constant' and found.place == 'interior']
    figure, seen = make_figure(curves, marks), 0
    for axis in figure.axes:
        lines = [line for line in axis.lines if line.get_marker() != 'o']
        for marked in set(axis.lines) - set(lines):
            off = [np.abs(marked.get_ydata() - np.interp(marked.get_xdata(), *line.get_data()))
                   / np.nanmax(np.abs(np.diff(line.get_ydata(), 2))) for line in lines
                   if line.get_color() == marked.get_color()]      # ten colours for more curves
            assert min(np.max(one) for one in off) <= 0.5
            seen += len(marked.get_xdata())
    assert seen == len(marks) > 0
