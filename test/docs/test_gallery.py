# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The gallery shows every shipped scene as it is now."""
import sys

from fourbar_ros.scene.files import folder
import pytest
from support import ROOT
from support.samples import more

sys.path.insert(0, str(ROOT / 'docs'))

import gallery  # noqa: E402, I100

NAMES = [name for entries in gallery.ENTRIES.values() for name in entries]
AGAIN = 'run python docs/gallery.py'


def test_every_shipped_scene_is_in_it_once():
    shipped = [file.stem for below in ('.', 'classics')
               for file in (folder() / below).glob('*.yaml')]
    assert sorted(NAMES) == sorted(shipped)


def test_the_page_is_up_to_date():
    assert gallery.PAGE.read_text(encoding='utf-8') == gallery.page(), AGAIN


def test_pictures_are_of_these_scenes():
    files = {file.stem: file for file in gallery.PICTURES.iterdir()}
    assert sorted(files) == sorted(NAMES), AGAIN
    for name, file in files.items():
        assert gallery.digest(name) in file.read_text(encoding='utf-8'), f'{name}: {AGAIN}'


@pytest.mark.parametrize('name', more(('gripper', 'klann', 'engine'), NAMES[::3]))
def test_no_label_lies_on_another_or_is_cropped(name):
    """Boxes of the texts as matplotlib's own renderer sets them."""
    import matplotlib
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    pose = next(entries[name][1] for entries in gallery.ENTRIES.values() if name in entries)
    figure = gallery.draw(name, pose)
    with matplotlib.rc_context(figure.style):
        renderer = FigureCanvasAgg(figure).get_renderer()
        axes, = figure.axes
        boxes = [text.get_window_extent(renderer) for text in axes.texts if text.get_text()]
    width, height = figure.bbox.size
    assert len(boxes) >= 3
    for i, box in enumerate(boxes):
        assert box.x0 >= 0 and box.y0 >= 0 and box.x1 <= width and box.y1 <= height
        assert not any(box.overlaps(other) for other in boxes[:i])
