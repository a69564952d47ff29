# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Labels of the pictures of shipped scenes lie beside each other, as matplotlib measures them."""
from itertools import combinations, cycle

from fourbar_ros.scene.files import shipped
from fourbar_ros.scene.scene import load
import pytest
from support.samples import some

QUICK = 'klann', 'paper'
SCENES = [*QUICK, *sorted(shipped().keys() - set(QUICK))]
SHARES = 0.13, 0.41, 0.77           # poses, of the range of the input, in turn
PIXEL = 1.0


@some('name, share', zip(SCENES, cycle(SHARES)), len(QUICK))
def test_labels_lie_beside_each_other(name, share):
    pytest.importorskip('matplotlib')
    from fourbar_lab.drawing.figure import make_figure
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    scene = load(name)
    if not scene.linkage.bodies:
        pytest.skip('has no arrows to label')
    low, high = max(scene.linkage.input_ranges, key=lambda ends: ends[1] - ends[0])
    at = low + share * (high - low)
    linkage = scene.linkage_at(at, scene.drive.speed)
    motion, loads = linkage.step(at, scene.drive.speed)
    points = {point: tuple(its) for point, its in scene.points.items()}
    figure = make_figure(linkage, motion, loads, name, points)
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    found = []
    for axes in figure.axes:
        titles = [axes._left_title]
        labels = [text for text in axes.texts if text.get_text() and text.get_zorder() == 8]
        boxes = {text: text.get_window_extent(canvas.get_renderer()) for text in titles + labels}
        for one, other in combinations(boxes, 2):
            a, b = boxes[one], boxes[other]
            wide = min(a.x1, b.x1) - max(a.x0, b.x0)
            high = min(a.y1, b.y1) - max(a.y0, b.y0)
            if min(wide, high) > PIXEL:
                found.append((one.get_text(), other.get_text(), wide, high))
    assert not found
