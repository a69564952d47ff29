# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""What a command line asks for last, whatever type rcl prefers."""
from fourbar_ros.ros.node.parameters import Asked, asked_outside, is_ignored
import pytest


@pytest.fixture
def file(tmp_path):
    """Return the function that writes a parameter file."""
    def write(text, name='scene.yaml', key='/**'):
        path = tmp_path / name
        path.write_text(f'{key}:\n  ros__parameters:\n    drive:\n      speed: {text}\n')
        return str(path)
    return write


def values(arguments, node='/fourbar'):
    return {name: found.value for name, found in asked_outside(arguments, node).items()}


def test_the_last_of_files_and_parameters_is_what_was_asked(file):
    first, second = file('25'), file('1.5', 'other.yaml')
    assert values(['--ros-args', '--params-file', first]) == {'drive.speed': 25}
    assert values(['--ros-args', '--params-file', first, '-p',
                   'drive.speed:=3.5']) == {'drive.speed': 3.5}
    assert values(['--ros-args', '-p', 'drive.speed:=3.5', '--params-file',
                   first]) == {'drive.speed': 25}
    assert values(['--ros-args', '--params-file', first, '--params-file',
                   second]) == {'drive.speed': 1.5}
    assert values(['-p', 'drive.speed:=3.5', '--ros-args', '--params-file', first, '--', '-p',
                   'drive.speed:=2.0']
                  ) == {'drive.speed': 25}
    assert asked_outside(['--ros-args', '--param', 'a:=b:=c'],
                         '/fourbar') == {'a': Asked('b:=c', '-p a:=b:=c')}


def test_only_what_is_for_the_node_counts_and_its_own_name_more_than_a_pattern(file):
    own, every = file('2', 'own.yaml', 'fourbar'), file('3.0')
    assert values(['--ros-args', '--params-file', own, '--params-file',
                   every]) == {'drive.speed': 2}
    assert values(['--ros-args', '--params-file', own, '--params-file', every],
                  '/mine') == {'drive.speed': 3.0}
    assert values(['--ros-args', '-p', 'fourbar:x:=1', '-p', 'other:x:=2']) == {'x': 1}
    assert values(['--ros-args', '-p', '/cell/fourbar:x:=1', '-p', 'x:=2'],
                  '/cell/fourbar') == {'x': 1}


@pytest.mark.parametrize('text, value', [('3.5', 3.5), ('3', 3), ('true', True), ('abc', 'abc'),
                                         ('4e-1', 0.4),
                                         ('[a, b]', ['a', 'b']), ('[1.0]', [1.0]), ('"7"', '7')])
def test_values_are_read_as_ros_reads_them(text, value):
    found, = values(['--ros-args', '-p', f'x:={text}']).values()
    assert found == value and type(found) is type(value)


@pytest.mark.parametrize('wanted, kept, ignored', [
    (3.5, 25, True), ('abc', 0.4, True), (1.0, 2, True), (1, True, True), (['a'], 'a', True),
    ([1], [1.0], True),
    (3.5, 2.5, False), (3, 2, False), (['a'], ['b'], False), (None, 2, False), ([], [], False)])
def test_another_type_is_ignored_by_rcl(wanted, kept, ignored):
    assert is_ignored(wanted, kept) is ignored
