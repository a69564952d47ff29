# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``fourbar describe``: formats by name and by file, and errors in one line."""
from xml.etree import ElementTree

from fourbar_ros.cli.main import main
import pytest


@pytest.mark.parametrize('words, root', [
    ([], 'robot'), (['--as', 'sdf'], 'sdf'), (['--as', 'mjcf'], 'mujoco')])
def test_it_prints_the_format_that_is_asked_for(words, root, capsys):
    assert main(['describe', 'paper', *words]) == 0
    assert ElementTree.fromstring(capsys.readouterr().out).tag == root


@pytest.mark.parametrize('name, root', [
    ('a.urdf', 'robot'), ('a.sdf', 'sdf'), ('a.mjcf', 'mujoco'), ('a.xml', 'mujoco')])
def test_the_file_name_chooses_the_format(name, root, tmp_path, capsys):
    assert main(['describe', 'cylinder', '-o', str(tmp_path / name)]) == 0
    assert ElementTree.parse(tmp_path / name).getroot().tag == root
    assert capsys.readouterr().out.strip() == str(tmp_path / name)
