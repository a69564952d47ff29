# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Scene files are read as rcl itself reads them: usual scalars, sections, wildcards."""
from math import pi

from fourbar_ros.cli.main import main
from fourbar_ros.ros.node.node import scene_of
from fourbar_ros.scene import load
from fourbar_ros.scene.files import as_text, read_values, SceneError
import pytest
import rclpy
from rclpy.node import Node

SCALARS = r"""
    4e-1 1 0x10 0X1F 07 08 0b11 0o17 1_000 1. .5 +1 -2 +1.5 1e5 1E+5 .nan nan .inf -.inf inf
    Infinity yes on On True TRUE No off OFF y Y n N yEs oN tRUE null ~ 1:30 2020-01-01 "4e-1" '1'
    1.e3 NaN -inf .Inf .INF 1e
    4e1x 1f 0x -0 1__0 text [a,b] [yes,no] 9223372036854775807 -9223372036854775808 = <<
""".split()


def asked(file, name='fourbar', namespace=''):
    """Return what a node reads from a parameter file."""
    rclpy.init(args=['--ros-args', '--params-file', str(file)])
    try:
        node = Node(name, namespace=namespace,
                    automatically_declare_parameters_from_overrides=True,
                    start_parameter_services=False)
        values = {key: parameter.value
                  for key, parameter in node.get_parameters_by_prefix('').items()
                  if key not in ('use_sim_time', 'start_type_description_service')}
        node.destroy_node()
        return values
    finally:
        rclpy.try_shutdown()


def test_scalars(tmp_path):
    file = tmp_path / 'scene.yaml'
    file.write_text('/**:\n  ros__parameters:\n' + ''.join(f'    x{i}: {text}\n'
                                                           for i, text in enumerate(SCALARS)))
    ros, ours = asked(file), read_values(file)
    for i, text in enumerate(SCALARS):
        assert repr(ros[f'x{i}']) == repr(ours[f'x{i}']), text


def test_names_are_texts(tmp_path):
    """As a point that is called no, whatever it would be as a value."""
    file = tmp_path / 'scene.yaml'
    file.write_text('/**:\n  ros__parameters:\n    points:\n' + ''.join(
        f'      {name}: {{along: 1.0}}\n' for name in ('no', 'On', 'y', '1e3', '010', '1', '~')))
    assert read_values(file) == asked(file)
    assert 'points.no.along' in read_values(file)


def test_ros_reads_the_texts_of_scenes_that_are_written(tmp_path):
    """Those that would be other values have quotes, and no list stands for another."""
    file, places = tmp_path / 'scene.yaml', [1.0, 5e-05]
    words = ['N', 'y', 'no', 'off', 'yEs', '4e-1', '010', '1_0', '08', 'Infinity', '.nan', '~', '',
             'null', 'a: b', '1:30', '-']
    values = {'joint_names': words, 'a': places, 'b': places, 'c': False, 'd': 3,
              **{f'x{i}': word for i, word in enumerate(words)}}
    file.write_text(as_text(values))
    assert read_values(file) == values
    assert {name: list(value) if name in 'ab' else value
            for name, value in asked(file).items()} == values


def test_ros_reads_a_scene_of_points_whatever_they_are_called(tmp_path):
    file = tmp_path / 'scene.yaml'
    assert main(['new', str(file), '--points', 'O1 0 0', 'N 10mm 20mm', 'y 60mm 30mm',
                 'O4 50mm 0']) == 0
    assert asked(file)['linkage.joints'] == ['O1', 'N', 'y', 'O4'] == read_values(file)[
        'linkage.joints']


def test_units_and_an_override_of_another_type_reach_the_node(tmp_path):
    """Of a double in the file and a string of -p the rcl layer takes the double."""
    file = tmp_path / 'scene.yaml'
    file.write_text('/**:\n  ros__parameters:\n'
                    '    linkage: {a1: 40cm, a2: 1.2, a3: 0.8 m, a4: 1.0}\n'
                    '    drive: {speed: 3.0, start: 90deg, rate: 200}\n'
                    '    joint_states: {offsets: [90deg, 0deg, 0deg, 1 rad]}\n')
    arguments = ['--ros-args', '--params-file', str(file), '-p', 'drive.speed:=300rpm',
                 '-p', 'linkage.a2:=1300mm', '-p', 'other:linkage.a4:=9.0',
                 '-p', 'drive.rate:=9.5']
    rclpy.init(args=arguments)
    try:
        node = Node('fourbar', automatically_declare_parameters_from_overrides=True,
                    start_parameter_services=False)
        values = scene_of(node, arguments).values
        declared = {name: node.get_parameter(name).value for name in values}
        node.destroy_node()
    finally:
        rclpy.try_shutdown()
    wanted = {'linkage.a1': 0.4, 'linkage.a2': 1.3, 'linkage.a3': 0.8, 'linkage.a4': 1.0,
              'drive.speed': 10.0 * pi, 'drive.start': 0.5 * pi, 'drive.rate': 9.5,
              'joint_states.offsets': [0.5 * pi, 0.0, 0.0, 1.0]}
    assert {name: values[name] for name in wanted} == wanted
    assert {name: list(value) if type(value) is not float else value
            for name, value in declared.items() if name in wanted} == wanted
    assert load(file).values['drive.start'] == 0.5 * pi


@pytest.mark.parametrize('key', ['/**', '/*', 'fourbar', '/fourbar', 'other', '/**/fourbar',
                                 '/cell/fourbar', '/*/fourbar',
                                 '/cell/*', '/cell/**'])
@pytest.mark.parametrize('namespace', ['', '/cell', '/hall/cell'])
def test_sections(key, namespace, tmp_path):
    file = tmp_path / 'scene.yaml'
    file.write_text(f'"{key}":\n  ros__parameters:\n    x: 1\nnobody:\n  ros__parameters:\n    x: '
                    '2\n')
    try:
        ours = read_values(f'{file}:{namespace}/fourbar')
    except SceneError:
        ours = {}
    assert ours == asked(file, namespace=namespace)
