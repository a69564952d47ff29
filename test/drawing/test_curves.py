# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Curves over the input with their extrema."""
from fourbar_lab.drawing.curves import curves_of, make_figure, marks_of
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
    marks = marks_of(linkage, [found for found in find_extrema(linkage, rate=speed)
                               if found.place == 'interior'])
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


@pytest.mark.parametrize('name', ['paper', 'cylinder', 'engine', 'jansen'])
def test_inertia_and_bias_are_the_drive_less_its_acceleration(name):
    """Of T = J alpha + b, with the forces of the scene."""
    scene = load(name)
    linkage = scene.linkage
    curves = curves_of(scene, linkage, ('inertia', 'bias', linkage.drive_load), 2.0, 3.0, 50)
    _, inertia, bias, drive = curves.values
    inside = np.isfinite(drive)
    assert inside.sum() > 40
    assert np.allclose((3.0 * inertia + bias)[inside], drive[inside], rtol=1e-9, atol=1e-9)
