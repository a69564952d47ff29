# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Layouts of config/ name topics and fields of a node named fourbar; the pictures of RViz."""
from importlib.util import module_from_spec, spec_from_file_location
import json
import re
from xml.etree import ElementTree

from fourbar_ros.ros.messages import resolve
from fourbar_ros.scene.scene import from_values
from fourbar_ros.scene.topics import PICTURES
import pytest
from support import ROOT
from support.scenes import PAPER, RODS
import yaml

CONFIG = ROOT / 'config'
SCENE = from_values({**PAPER, **RODS, 'outputs': ['state', 'loads', *PICTURES]})
TOPICS = {topic.topic.replace('~', '/fourbar'): topic for topic in SCENE.topics.values()}
SHOWN = {topic.topic.replace('~', '/fourbar') for topic in SCENE.pictures.values()}


def check(curves):
    assert len(curves) == len(set(curves)) == 26
    for topic, field in curves:
        types = resolve(TOPICS[topic].type).get_fields_and_field_types()
        assert types[field] == 'double', field


def test_foxglove():
    panels = json.loads((CONFIG / 'foxglove.json').read_text())['configById']
    check([tuple(path['value'].rsplit('.', 1))
           for panel in panels.values() for path in panel.get('paths', ())])
    machine = panels['3D!machine']
    assert {*machine['topics'], '/' + machine['layers']['urdf']['topic'].strip('/')} <= {
        '/' + topic.strip('/') for topic in SHOWN}
    assert machine['followTf'] == SCENE.frame_id


def test_plotjuggler():
    root = ElementTree.fromstring((CONFIG / 'plotjuggler.xml').read_text())
    check([tuple(curve.get('name').rsplit('/', 1)) for curve in root.iter('curve')])


def test_rviz():
    text = (CONFIG / 'fourbar.rviz').read_text()
    topics = re.findall('Value: (/.*)', text)
    assert len(topics) == 3 and set(topics) <= {'/' + topic.strip('/') for topic in SHOWN}
    options = yaml.safe_load(text)['Visualization Manager']['Global Options']
    assert options['Fixed Frame'] == SCENE.frame_id


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
