# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Every topic and field of every layout is in a bag that a node has just recorded."""
import json
from operator import attrgetter
from xml.etree import ElementTree

from builtin_interfaces.msg import Time
from fourbar_msgs.msg import Motion
from fourbar_ros.bag.reader import Bag
from fourbar_ros.cli.main import main
from fourbar_ros.scene.scene import load
from fourbar_ros.scene.topics import PICTURES
import pytest
from support import ROOT
import yaml

SCENES = ('paper', 'slider_crank', 'cylinder', 'scotch_yoke', 'jansen', 'bucket')


@pytest.fixture(params=[pytest.param(name, marks=[pytest.mark.slow] * (name != 'paper'))
                        for name in SCENES])
def recorded(request, run_node, client, tmp_path):
    """Return (scene file, {topic: message}) of a fresh bag of a scene with pictures."""
    values = load(ROOT / f'config/{request.param}.yaml').values
    scene = load(ROOT / f'config/{request.param}.yaml')
    families = ['links', 'reactions', *(['points'] if scene.points else [])]
    outputs = [*dict.fromkeys([*values['outputs'], 'state', 'loads', 'output', *families,
                               *PICTURES])]
    values = {name: value for name, value in values.items() if value == value and value != []}
    values |= {'drive.source': 'motion', 'outputs': outputs, 'pictures.rate': 0.0,
               'recording.directory': str(tmp_path / 'bags')}
    node = run_node(values)
    file = tmp_path / 'scene.yaml'
    file.write_text(json.dumps({'/**': {'ros__parameters': values}}))
    client.listen(['state'])
    drive, (low, high) = client.publisher(), scene.linkage.input_ranges[0]

    def send(k):
        message = Motion(position=low + (high - low) * (0.3 + 0.01 * k), velocity=1.0)
        message.header.stamp = Time(sec=1 + k)
        drive.publish(message)
    client.handshake(lambda: send(0))
    path = client.call('start_recording', name='layouts').path
    for k in range(1, 6):
        send(k)
    client.until(lambda: len(client.received['state']) >= 5, 'the states')
    client.call('stop_recording')
    assert node.stop() == 0
    return str(file), {record.topic: record.message for record in Bag(path).records()}


def written(file, tool, capsys):
    capsys.readouterr()
    assert main(['layout', file, '--for', tool]) == 0
    return capsys.readouterr().out


def test_layouts_name_what_is_there(recorded, capsys):
    file, messages = recorded
    check_foxglove(json.loads(written(file, 'foxglove', capsys)), messages)
    check_plotjuggler(ElementTree.fromstring(written(file, 'plotjuggler', capsys)), messages)
    check_rviz(yaml.safe_load(written(file, 'rviz', capsys)), messages)


def is_number(messages, topic, field):
    return isinstance(attrgetter(field)(messages[topic]), float)


def check_foxglove(layout, messages):
    panels = layout['configById']
    plots = [panel for name, panel in panels.items() if name.startswith('Plot!')]
    paths = [path['value'] for plot in plots for path in plot['paths']]
    labels = [path['label'] for plot in plots for path in plot['paths']]
    assert len(plots) >= 5 and len(paths) == len(set(paths))
    assert {'foot angular_velocity', 'leg_inner force.x'} <= set(labels) or (
        '/fourbar/links/foot' not in messages)
    for path in paths:
        topic, _, field = path.partition('.')
        assert is_number(messages, topic, field), path
    machine = panels['3D!machine']
    named = [*machine['topics'], machine['layers']['urdf']['topic']]
    assert set(named) <= set(messages) and len(named) == 3
    assert machine['followTf'] in {t.header.frame_id for t in messages['/tf'].transforms}

    def leaves(node):
        return ([node] if isinstance(node, str)
                else [*leaves(node['first']), *leaves(node['second'])])
    assert sorted(leaves(layout['layout'])) == sorted(panels)


def check_plotjuggler(root, messages):
    curves = [curve.get('name') for curve in root.iter('curve')]
    assert len(curves) >= 8 and len(curves) == len(set(curves))
    for curve in curves:
        topic = next(topic for topic in messages if curve.startswith(f'{topic}/'))
        field = curve.removeprefix(f'{topic}/').replace('/', '.')
        assert is_number(messages, topic, field), curve
    for splitter in root.iter('DockSplitter'):
        assert len(splitter) == int(splitter.get('count')) == len(
            splitter.get('sizes').split(';'))


def check_rviz(config, messages):
    manager = config['Visualization Manager']
    topics = [display[entry]['Value'] for display in manager['Displays']
              for entry in ('Topic', 'Description Topic') if entry in display]
    assert len(topics) == 3 and set(topics) <= set(messages)
    assert manager['Global Options']['Fixed Frame'] == messages[
        '/tf'].transforms[0].header.frame_id


def test_the_node_has_another_name(capsys):
    assert main(['layout', 'paper', '--for', 'plotjuggler', '--node', '/left/leg']) == 0
    names = [curve.get('name') for curve in ElementTree.fromstring(
        capsys.readouterr().out).iter('curve')]
    assert names and all(name.startswith('/left/leg/') for name in names)


def test_rviz_has_nothing_to_show_of_a_scene_without_pictures(capsys):
    assert main(['layout', 'paper', '--for', 'rviz']) == 1
    assert 'RViz shows robot_description, tf, markers and traces' in capsys.readouterr().err
