# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The pictures of what RViz shows are drawn from a bag that a node has just recorded."""
from importlib.util import module_from_spec, spec_from_file_location

import pytest
from support import ROOT


@pytest.fixture
def rviz():
    """Return docs/rviz.py as a module."""
    pytest.importorskip('yourdfpy')
    spec = spec_from_file_location('rviz', ROOT / 'docs' / 'rviz.py')
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.slow
def test_description_and_markers_are_drawn(rviz, tmp_path):
    from matplotlib.image import imread
    path = rviz.draw('slider_crank', tmp_path)
    picture = imread(path)[..., :3]
    height, width, _ = picture.shape
    for half in (picture[:, :width // 3], picture[:, width // 2:]):
        ink = (half.min(axis=2) < 0.9).mean()
        assert 0.01 < ink < 0.5


@pytest.mark.slow
def test_every_picture_of_the_pages_has_its_scene(rviz):
    drawn = {path.stem.removeprefix('rviz_') for path in (ROOT / 'docs/images').glob('rviz_*.png')}
    assert drawn == set(rviz.SHOWN)
