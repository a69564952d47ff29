# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""What the commands answer to what people type: names, ranges, units, wrong words."""
from math import degrees
import os
import re
import subprocess
import sys

from fourbar_ros import FourBar
from fourbar_ros.cli.main import main
from fourbar_ros.extrema import output_ranges
from fourbar_ros.scene import files as scene_file
from fourbar_ros.scene import scene
import numpy as np
import pytest
from support import ROOT

LENGTHS = 'linkage: {a1: 0.4, a2: 1.2, a3: 0.8, a4: 1.0}'


def scene_with(tmp_path, text, key='/**'):
    file = tmp_path / 'scene.yaml'
    file.write_text(f'{key}:\n  ros__parameters:\n    {LENGTHS}\n{text}')
    return str(file)


def said(capsys, *arguments):
    """Return (exit code, output without blanks at the ends of lines, errors) of a command."""
    try:
        code = main(list(arguments))
    except SystemExit as done:
        code = done.code
    out, err = capsys.readouterr()
    return code, re.sub(' +$', '', out, flags=re.M), err


# --- scene files ---------------------------------------------------------------------------------

@pytest.mark.parametrize('key, is_good', [('/**', True), ('fourbar', True), ('/fourbar', True),
                                          ('/cell/fourbar', True),
                                          ('"/*"', True), ('/**/fourbar', True), ('other', False),
                                          ('/cell/other', False)])
def test_a_scene_for_another_node_is_refused(key, is_good, tmp_path, capsys):
    code, _, err = said(capsys, 'scene', 'check', scene_with(tmp_path, '', key))
    assert (code == 0) == is_good
    if not is_good:
        assert ('/other' in err or '/cell/other' in err and 'write "/**:"' in err
                and len(err.splitlines()) == 1)


def test_scenes_are_found_by_name_anywhere(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert {file.stem for file in scene_file.folder().glob('*.yaml')} >= {'paper', 'cylinder',
                                                                          'slides_7_6'}
    assert said(capsys, 'scene', 'check', 'paper')[0] == 0
    code, _, err = said(capsys, 'show', 'papr')
    assert code == 1 and 'did you mean paper?' in err
    (tmp_path / 'paper').write_text('')                  # a file comes first
    assert 'not a scene' in said(capsys, 'show', 'paper')[2]


# --- words and numbers ---------------------------------------------------------------------------


def test_show_tells_the_whole_of_example_7_6(capsys):
    """The slides' numbers for 60 deg, 10 rad/s, 100 rad/s^2."""
    _, out, _ = said(capsys, 'show', 'slides_7_6', '--at', '60', '--acceleration', '100')
    rows = {line.split()[0]: line.split()
            for line in out.partition('at theta1 = 60.0000 deg')[2].splitlines()[2:]}
    for name, expected in (('theta2', (-51.6570, -12.4463, -103.5916)),
                           ('theta4', (84.5689, 7.1781, 125.5109)),
                           ('beta', (8.3430, -2.4463, -3.5916))):
        assert [float(rows[name][i]) for i in (1, 3, 4)] == pytest.approx(expected, abs=5e-5), name


@pytest.mark.parametrize('name', ['paper', 'slider_crank', 'cylinder'])
def test_show_gives_all_components_of_forces_and_points(name, capsys):
    its = scene.load(name)
    at = 1.5 if its.linkage.is_driven_by_slide else 60.0
    _, out, _ = said(capsys, 'show', name, '--at', str(at))
    motion, loads = its.linkage.step(at if its.linkage.is_driven_by_slide else np.radians(at),
                                     its.drive.speed)
    lines = out.partition('\nloads\n')[2].splitlines()
    for text, field in (('F41', 'f41'), ('F21', 'f21'), ('F32', 'f32'), ('F43', 'f43'),
                        ('shaking force', 'shaking_force')):
        line, = (line for line in lines if line.startswith(text + ' '))
        numbers = [float(word) for word in line.removeprefix(text).split()[:3]]
        expected = [getattr(loads, f'{field}{end}') for end in ('_x', '_y', '')]
        assert numbers == pytest.approx(expected, rel=1e-9, abs=1e-9), text
    for point in its.points:
        assert any(line.startswith(point) for line in lines)


def test_zeros_are_not_printed_as_rounding(capsys):
    _, out, _ = said(capsys, 'show', 'slider_crank')
    rows = out.partition('\nf43 ')[2].partition('\n\n')[0].splitlines()
    values = [next(word for word in row.split() if word.lstrip('-')[0].isdigit()) for row in rows]
    assert values.count('0') == 4 and not any('e-' in value for value in values)


# --- ranges --------------------------------------------------------------------------------------

@pytest.mark.parametrize('lengths', [(0.4, 1.2, 0.8, 1.0), (8.0, 14.0, 9.0, 17.0),
                                     (4.0, 3.0, 2.0, 8.0),
                                     (5.0, 2.0, 7.0, 6.0), (6.0, 7.0, 5.0, 2.0),
                                     (2.0, 6.0, 7.0, 5.0)])
@pytest.mark.parametrize('mode', [1, 2])
def test_the_output_range_is_that_of_the_mode(lengths, mode):
    """Against a fine grid of poses of this mode; both modes together are those of the linkage."""
    linkage = FourBar(*lengths, mode=mode)
    for low, high in linkage.input_ranges:
        theta4 = np.unwrap(linkage.motion(np.linspace(low, high, 20001)[1:-1]).theta4)
        swept, = [swept for swept in output_ranges(linkage) if swept.inputs == (low, high)]
        assert abs(np.ptp(theta4) - swept.width) < 4e-2
        assert swept.turns_fully or abs(np.exp(1j * theta4.min()) - np.exp(1j * swept.low)) < 2e-2
    both = [end % (2.0 * np.pi) for m in (1, 2) for swept in output_ranges(linkage.in_mode(m))
            for end in (swept.low, swept.high)]
    for low, high in linkage.output_ranges:
        if high - low < 6.28:
            for end in (low, high):
                assert min(abs((end - e + np.pi) % (2.0 * np.pi) - np.pi)
                           for e in both) < 1e-9, degrees(end)


def test_the_output_does_not_change_from_run_to_run():
    def text(seed):
        done = subprocess.run([sys.executable, '-c', 'from fourbar_ros.cli import main, scene\n'
                               'scene.step_cost = lambda scene: 1e-5\n'
                               'for words in ("scene check slides_7_6", "show cylinder --at 1", '
                               '"show nosuch"):\n    main.main(words.split())'],
                              capture_output=True, text=True,
                              env={**os.environ, 'PYTHONHASHSEED': str(seed)}, check=False)
        assert 'Traceback' not in done.stderr, done.stderr
        return done.stdout + done.stderr
    assert text(1) == text(2) != ''


@pytest.mark.parametrize('given, written', [('a', 'a.png'), ('a.svg', 'a.svg'),
                                            ('a.pdf', 'a.pdf')])
def test_a_picture_is_where_the_output_says(given, written, tmp_path, capsys):
    pytest.importorskip('matplotlib')
    assert said(capsys, 'draw', 'paper', '--at', '60', '-o', str(tmp_path / given)) == (
        0, f'{tmp_path / written}\n', '')
    assert (tmp_path / written).stat().st_size > 10_000


# --- without what is optional --------------------------------------------------------------------

@pytest.mark.parametrize('call, blocked, code, line', [
    ('main("bag info x".split())', 'mcap', 1,
     'fourbar: bag requires mcap: pip install mcap rosbags'),
    ('main("study show x".split())', 'scipy', 1,
     'fourbar: study requires scipy: pip install scipy pyarrow'),
    ('main("replay x".split())', 'rclpy', 1, 'fourbar: replay requires ROS 2: source a ROS 2'),
    ('main("draw paper --at 60 -o x.svg".split())', 'matplotlib', 1,
     'fourbar: draw requires matplotlib: pip install matplotlib'),
    ('main("reproduce --html x.html".split())', 'matplotlib', 1,
     'fourbar: reproduce requires matplotlib: pip install matplotlib'),
    ('main(["--help"])', 'fourbar_lab', 0,
     'fourbar: no verb balance, draw, generate'),
    ('main("describe paper --as mjcf".split())', 'fourbar_lab', 1,
     'fourbar: describe requires fourbar_lab: pip'),
    ('optional.node()', 'rclpy', 1, 'fourbar_node requires ROS 2: source'),
    ('optional.demo()', 'rclpy', 1, 'fourbar_demo requires ROS 2: source')])
def test_what_is_missing_is_one_line(call, blocked, code, line):
    done = subprocess.run([sys.executable, '-c', f'import sys; sys.modules[{blocked!r}] = None\n'
                           'from fourbar_ros import optional\n'
                           f'from fourbar_ros.cli.main import main; sys.exit({call})'],
                          capture_output=True, text=True, cwd=ROOT, check=False)
    lines = done.stderr.splitlines()
    assert done.returncode == code and lines[-1].startswith(line), done.stderr
    assert len(lines) == 1 or blocked == 'fourbar_lab', done.stderr


def test_an_error_of_ours_is_not_taken_for_a_missing_package():
    from fourbar_ros.optional import MissingPackage
    assert not MissingPackage.explains(ModuleNotFoundError("No module named 'fourbar_ros.typo'",
                                                           name='fourbar_ros.typo'))
    assert MissingPackage.explains(ModuleNotFoundError('', name='mcap.opcode'))


def test_a_verb_imports_no_other_and_help_knows_all():
    def loaded(*words):
        done = subprocess.run([sys.executable, '-c', f"""
import sys
from fourbar_ros.cli.main import main
try:
    main({list(words)!r})
except SystemExit:
    pass
print(sorted(name for name in sys.modules if name.count('.') == 2
             and name.split('.')[1] in ('cli', 'pipeline')))
"""], capture_output=True, text=True, check=True)
        return done.stdout.splitlines()[-1]
    assert loaded('scene', 'print', 'paper') == (
        "['fourbar_ros.cli.common', 'fourbar_ros.cli.main', 'fourbar_ros.cli.scene']")
    assert 'fourbar_lab.cli.study' not in loaded('list')
    for words in (['--help'], ['nosuch'], []):
        assert 'fourbar_lab.cli.study' in loaded(*words), words
