# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""A range of the crank at every verb: nothing beyond it is shown, drawn or simulated."""
import csv
import json

from fourbar_ros.cli.main import main
import numpy as np
import pytest
from support.scenes import file_of, PAPER, RODS

VALUES = {**PAPER, **RODS, 'linkage.range': ['0deg', '48deg'], 'drive.start': '20deg'}


@pytest.fixture
def said(tmp_path, capsys):
    """Return a function: verb and options -> what it prints for the scene with a range."""
    file = file_of(VALUES, tmp_path)

    def said(verb, *options, status=0):
        assert main([verb, str(file), *options]) == status
        return ''.join(capsys.readouterr())
    return said


def test_it_is_shown_and_nothing_beyond_it(said):
    text = said('show')
    assert 'theta1: 0.0000 to 48.0000 deg' in text and 'none within the range' in text
    record = json.loads(said('show', '--json'))
    inside = [extremum['theta1'] for extremum in record['extrema'] if 'theta1' in extremum]
    assert inside and 0.0 <= min(inside) and max(inside) <= np.radians(48.0) + 1e-15
    assert 'outside the input range 0.0000 to 48.0000 deg' in said('show', '--at', '60', status=1)


def test_a_table_begins_and_ends_with_it(said):
    head, *rows = csv.reader(said('table', 'omega4', '-o', '-').splitlines())
    assert head[0] == 'theta1 [deg]'
    assert [float(rows[i][0]) for i in (0, -1)] == pytest.approx([0.0, 48.0], rel=1e-15)


@pytest.mark.parametrize('verb, options, name', [
    ('plot', ('omega4',), 'curves.svg'), ('draw', ('--at', '30'), 'pose.svg'),
    ('draw', ('--over', 'paths'), 'paths.svg')])
def test_pictures_are_of_it(verb, options, name, said, tmp_path):
    said(verb, *options, '-o', str(tmp_path / name))
    assert (tmp_path / name).stat().st_size > 1000


def test_a_pose_beyond_it_is_not_drawn(said, tmp_path):
    out = str(tmp_path / 'pose.svg')
    assert 'outside the input range' in said('draw', '--at', '60', '-o', out, status=1)
