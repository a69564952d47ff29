# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Pictures over cycles and moving ones: their curves are the core's, mistakes are refused."""
from fourbar_lab.drawing import cycles
from fourbar_lab.drawing.animation import animate
from fourbar_ros.mechanisms.points import point_motion
from fourbar_ros.scene.files import find
from fourbar_ros.scene.scene import load
import numpy as np
import pytest

SCENES = ['paper', 'slider_crank', 'scotch_yoke', 'cylinder']


def lines_of(figure):
    return [line.get_xydata() for line in figure.axes[0].get_lines() if len(line.get_xdata()) > 2]


@pytest.mark.parametrize('name', SCENES)
def test_curves_lie_on_those_of_single_poses(name):
    linkage = load(find(name)).linkage
    points = cycles.usual_points(linkage, {}) or {'at': (linkage.LINKS[0].name, 0.1, 0.05)}
    low, high = linkage.input_ranges[0]
    size = max(map(abs, linkage.lengths))
    curve = lines_of(cycles.make_linkage_figure(
        linkage, linkage.motion(cycles.usual_input(linkage)), points,
        cycles.paths_of(linkage, points)))[0]
    for share in (0.25, 0.5, 0.75):
        motion = linkage.motion(low + share * (high - low))
        place = point_motion(linkage, motion, *next(iter(points.values()))).place
        nearest = np.nanmin(np.hypot(*(curve - place).T))
        assert nearest <= 1e-2 * max(size, np.hypot(*place))       # spacing of the samples


def test_the_polar_diagram_of_forces_reaches_the_peak_of_the_shaking_force():
    scene = load(find('paper'))
    linkage = scene.linkage
    curve = lines_of(cycles.make_forces_figure(linkage, 25.0))[0]
    angles = np.linspace(-np.pi, np.pi, 20001)
    peak = linkage.loads(angles, 25.0).shaking_force.max()
    assert np.hypot(*curve.T).max() == pytest.approx(peak, rel=1e-4)


@pytest.mark.slow
def test_an_animation_has_its_frames_and_they_differ(tmp_path):
    from PIL import Image
    scene = load(find('slider_crank'))
    path = animate(scene.linkage, scene.drive.speed, {}, tmp_path / 'moving.gif')
    with Image.open(path) as film:
        assert film.n_frames >= 40
        film.seek(0)
        first = np.asarray(film.convert('L'), int)
        film.seek(film.n_frames // 2)
        assert abs(np.asarray(film.convert('L'), int) - first).max() > 100
