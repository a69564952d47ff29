# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The picture of the collineation axis: its lines go through joints and poles, and turn square."""
from math import degrees, hypot

from fourbar_lab.drawing.axis import axis_angle, axis_parts
from fourbar_ros import find_extrema, FourBar, InvertedSlider, SliderCrank
from fourbar_ros.cli.main import main
from fourbar_ros.mechanisms.picture import diagram_of
import numpy as np
import pytest

THROUGH = {'ground': ('O_1', 'O_4'), 'coupler': ('A', 'B'), 'crank': ('O_1', 'A'),
           'output': ('O_4', 'B'), 'axis': ()}
POLES = {'P_{13}': ('ground', 'coupler', 'axis'), 'P_{24}': ('crank', 'output', 'axis')}


def off(ends, place):
    """Return the distance of a place from the line through two ends."""
    (x, y), (u, v) = ends[1] - ends[0], place - ends[0]
    return abs(x * v - y * u) / hypot(x, y)


@pytest.mark.parametrize('linkage', [
    FourBar(0.4, 1.2, 0.8, 1.0), FourBar(2.0, 6.0, 7.0, 5.0, mode=1), SliderCrank(0.3, 0.8, 0.1),
    InvertedSlider(0.3, 0.8, 0.1)], ids=str)
def test_lines_in_a_window_go_through_joints_and_poles(linkage):
    for theta1 in (-2.0, 0.7, 2.3):
        motion = linkage.motion(theta1, 1.0)
        joints, size = diagram_of(linkage, motion).joints, max(map(abs, linkage.lengths))
        low, high = np.array([-1.7, -1.6]) * size, np.array([2.9, 2.0]) * size
        lines, poles = axis_parts(linkage, motion, low, high)
        for name, ends in lines.items():
            # both ends beyond the window, or on its edge
            assert ((ends <= low + 1e-12 * size) | (ends >= high - 1e-12 * size)).any(axis=1).all()
            assert all(off(ends, joints[joint]) <= 1e-12 * size for joint in THROUGH[name]
                       if joint in joints and (isinstance(linkage, FourBar) or name == 'crank'))
        for letter, place in poles.items():
            assert all(off(lines[name], place) <= 1e-11 * size for name in POLES[letter])


def test_a_line_beside_the_window_is_not_shown():
    linkage = FourBar(0.4, 1.2, 0.8, 1.0)
    lines, poles = axis_parts(linkage, linkage.motion(1.0), np.array([5.0, 1.0]),
                              np.array([6.0, 1.5]))
    assert 'ground' not in lines and not poles and len(lines) < 5


def test_the_angle_passes_90_degrees_at_the_extrema_alone():
    linkage = FourBar(2.0, 6.0, 7.0, 5.0)
    theta1 = np.radians(np.arange(0.0, 360.0, 0.25))
    angle = axis_angle(linkage, linkage.motion(theta1))
    crossings = theta1[1:][np.diff(np.sign(angle - 90.0)) * 0.0 + np.diff(angle > 90.0) > 0.0]
    extrema = [extremum.theta1 for extremum in find_extrema(linkage, ('omega4',), 1.0)]
    np.testing.assert_allclose(crossings, extrema, atol=np.radians(0.25))
    assert sorted(map(degrees, extrema)) == pytest.approx([2.6810, 138.9638], abs=5e-5)


def test_the_command_draws_it(tmp_path):
    pytest.importorskip('matplotlib')
    out = tmp_path / 'axis.svg'
    assert not main(['draw', 'slides_7_7', '--over', 'axis', '-o', str(out)])
    assert out.read_text().startswith('<?xml')
