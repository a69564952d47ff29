# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""One's own linkage on the command line: new, list, table, plot, describe, units; no ROS."""
from cmath import rect
from contextlib import suppress
import csv
import io
from math import degrees, pi, radians
import os
from pathlib import Path
import shlex
import subprocess
import sys
from xml.etree import ElementTree

from fourbar_lab.drawing.labels import as_written, labels_of, plain
from fourbar_ros import Bodies, flat_bar, FourBar, load_scene
from fourbar_ros.cli.main import main
from fourbar_ros.mechanisms.kinds import KINDS
from fourbar_ros.mechanisms.picture import diagram_of
from fourbar_ros.mechanisms.points import point_motion
from fourbar_ros.scene.units import of
from fourbar_ros.terminal import PlainConsole
from hypothesis import assume, given
from hypothesis import strategies as st
from mechanisms.machine.test_from_points import PUBLIC
import numpy as np
import pytest

GIVEN = ('--a1', '50mm', '--a2', '150mm', '--a3', '100mm', '--a4', '125mm')


@pytest.fixture(autouse=True)
def in_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def rows_of(path):
    with open(path, newline='', encoding='utf-8') as file:
        heads, *rows = csv.reader(file)
    return heads, np.array(rows, float)


def test_a_new_scene_of_flat_bars_is_the_linkage_made_by_hand(capsys):
    assert main(['new', 'my.yaml', *GIVEN, '--speed', '300rpm', '--bar', '20x5mm']) == 0
    assert 'fourbar show my.yaml' in capsys.readouterr().out
    scene = load_scene('my.yaml')
    bars = Bodies(*(flat_bar(length, 7850.0, 0.02, 0.005) for length in (0.05, 0.15, 0.1)))
    by_hand = FourBar(0.05, 0.15, 0.1, 0.125, bodies=bars)
    assert scene.linkage.lengths == by_hand.lengths
    assert scene.drive.speed == pytest.approx(10.0 * pi, rel=1e-9)      # ten digits in the file
    ours, theirs = (linkage.loads(1.0, 30.0).shaking_force for linkage in (scene.linkage, by_hand))
    assert ours == pytest.approx(theirs, rel=1e-8)


@pytest.mark.parametrize(('points', 'options', 'kind', 'said'), [
    (['O1 0 0', 'A 10mm 20mm', 'B 60mm 30mm', 'O4 50mm 0', 'P 40mm 50mm'],
     ['--links', 'O1-A', 'A-B-P', 'B-O4'], 'four_bar', 'Grashof crank-rocker'),
    (['O1 1 1', 'A 1.02 1.01', 'B 1.1 1.02 slide 0deg'], [], 'slider_crank', 'slider-crank'),
    (['O1 0 0', 'A 0 1', 'B 2 1.001 mode 2', 'O4 3 1'], [], 'machine', 'RRR'),
    (['O1 0 0', 'A 0 -10mm', 'B 50mm -30mm', 'O4 60mm 10mm'], [], 'machine', 'RRR'),
    (['P 0 0 ground', 'Q 10mm 20mm', 'R_top 60mm 30mm', 'S 50mm 0 ground'], [], 'four_bar',
     'Grashof crank-rocker'),
    (['O1 0 0', 'B 10mm 20mm', 'A 60mm 30mm', 'O4 50mm 0'], [], 'four_bar',  # letters exchanged
     'Grashof crank-rocker'),
    (['P 0 0 ground', 'Q 10mm 20mm', 'R 90mm 5mm slide 0'], [], 'slider_crank', 'slider-crank'),
    (['X 0 0 ground', 'A 10mm 20mm', 'C 0 90mm slide 90deg'], [], 'machine', 'RRP'),
    (['A -3.7 -2.4 ground', 'B -2.7 0.9', 'C 1.6 0.4', 'D -0.2 4', 'E 5 5.3', 'F 8.1 3.3',
      'G 7.3 -3.5 ground'], ['--links', 'A-B', 'B-C-D', 'C-G-F', 'D-E', 'E-F'], 'machine',
     'RRR + RRR'),
    (['O1 0 0', 'P 10mm 0', 'A 10mm 20mm', 'B 60mm 30mm', 'O4 50mm 0'],    # it lost A's height
     ['--links', 'O1-P-A', 'A-B', 'B-O4'], 'machine', 'RRR'),
    *[(*public.options, '', '') for public in PUBLIC.values()]])
def test_a_scene_of_points_is_the_drawing(points, options, kind, said, capsys):
    """All joints that move, at drive.start, where they were drawn, by the names given there."""
    assert main(['new', 'my', '--points', *points, *options, '--rod', '8mm']) == 0
    assert said in capsys.readouterr().out
    scene, places = load_scene('my.yaml'), {}
    for text in points:
        name, x, y, *_ = text.split()
        places[name] = np.array([of('m')(x), of('m')(y)])
    origin, linkage = places[points[0][:points[0].index(' ')]], scene.linkage
    motion = linkage.motion(scene.drive.start)
    pose = diagram_of(linkage, motion)
    drawn = np.array([place - origin for name, place in places.items()
                      if name not in scene.points])
    found = np.array([*pose.joints.values()])
    for place in drawn:
        assert np.hypot(*(found - place).T).min() < 1e-12
    letters = {plain(as_written(letter)): place
               for letter, place in labels_of(pose).joints.items()}
    assert {*letters} == {*places} - {*scene.points}
    for name, place in letters.items():
        assert np.hypot(*(place - (places[name] - origin))) < 1e-12, name
    for name, point in scene.points.items():
        place = point_motion(linkage, motion, *point).place
        assert np.hypot(*(place - (places[name] - origin))) < 1e-12
    assert kind in ('', scene.kind) and linkage.loads(scene.drive.start, 1.0).driving_torque
    assert main(['scene', 'check', 'my.yaml']) == 0


@given(st.integers(-180, 180).flatmap(lambda angle: st.sampled_from([
    (f'{angle}deg', radians(angle)), (f'{angle}', radians(angle)),
    (f'{radians(angle)!r}rad', radians(angle)), (f'{angle / 360.0!r}turn', radians(angle))])))
def test_the_block_of_points_slides_in_the_direction_that_is_asked_for(tmp_path_factory, asked):
    """By its way from where it is drawn: no part across, within the rounding of the pose."""
    text, angle = asked
    along, pin = rect(1.0, angle), 0.25 - 0.2j
    assume(abs((along.conjugate() * (pin - 0.045j)).real) > 0.05)       # else its mode is asked
    file = tmp_path_factory.mktemp('drawn') / 'my.yaml'
    assert main(['new', str(file), '--points', 'O 0 0', 'A 0 45mm',
                 f'B 250mm -200mm slide {text}']) == 0
    scene = load_scene(file)
    for ahead in (0.0, 0.02, 0.05):
        pose = diagram_of(scene.linkage, scene.linkage.motion(scene.drive.start + ahead))
        away = along.conjugate() * (complex(*[*pose.joints.values()][-1]) - pin)
        assert abs(away.imag) < 1e-14 and (abs(away) < 1e-14) == (ahead == 0.0)


@pytest.mark.parametrize('mark', ['', '\ufeff'])
@pytest.mark.parametrize('encoding', ['utf-8', 'utf-16-le', 'utf-16-be'])
def test_a_scene_is_read_as_windows_writes_it(encoding, mark, capsys):
    """> of PowerShell 5 writes UTF-16 with a mark; without one it is no text that we know."""
    assert main(['scene', 'print', 'watt', '-o', 'mine']) == 0
    text = Path('mine.yaml').read_text(encoding='utf-8')
    assert capsys.readouterr().out == 'mine.yaml\n'
    assert main(['scene', 'print', 'watt']) == 0 and capsys.readouterr().out == text
    assert main(['scene', 'print', 'watt', '-o', 'mine']) == 1      # it is there
    text = f'{mark}# Größe\n{text}'.replace('\n', '\r\n')
    Path('mine.yaml').write_bytes(text.encode(encoding))
    if encoding == 'utf-8' or mark:
        assert load_scene('mine.yaml').as_text == load_scene('watt').as_text
    else:
        assert main(['show', 'mine.yaml']) == 1


@pytest.mark.parametrize('name', ['engine', 'lift_table'])      # of tables in a file
def test_a_printed_scene_loads_wherever_it_lies(name, capsys):
    assert main(['scene', 'print', name, '-o', 'mine.yaml']) == 0
    mine, shipped = load_scene('mine.yaml'), load_scene(name)
    assert mine.values == pytest.approx(shipped.values, nan_ok=True, abs=0.0, rel=0.0)
    assert Path('mine.yaml').read_text().startswith('# ')


TWO_NODES = """# Two fingers.
{node}left: {{ros__parameters: {{linkage: {{a1: 40mm, a2: 0.12, a3: 0.08, a4: 0.1}}}}}}
{node}right: {{ros__parameters: {{linkage: {{a1: 0.05, a2: 0.12, a3: 0.08, a4: 0.1}}}}}}
"""


@pytest.mark.parametrize('node', ['', 'hand/'])
def test_two_scenes_of_one_file_have_names_and_texts_of_their_own(node, capsys):
    Path('fingers.yaml').write_text(TWO_NODES.format(node=node))
    names = []
    for side in ('left', 'right'):
        scene = load_scene(f'fingers.yaml:{node}{side}')
        names.append(scene.name)
        assert main(['scene', 'print', f'fingers.yaml:{node}{side}', '-o', f'{side}.yaml']) == 0
        assert load_scene(f'{side}.yaml').linkage == scene.linkage
        assert main(['generate', f'fingers.yaml:{node}{side}', '-o', 'code']) == 0
        assert main(['live', f'fingers.yaml:{node}{side}', '-o', f'{side}.html']) == 0
        assert f'<title>{names[-1]}' in Path(f'{side}.html').read_text()
    prefix = node.replace('/', '_')
    assert names == [f'fingers_{prefix}left', f'fingers_{prefix}right']
    assert {path.name for path in Path('code').iterdir()} == {
        f'{name}.{ending}' for name in names for ending in 'ch'}
    assert 'a1: 40mm' in Path('left.yaml').read_text()
    assert load_scene('paper').name == 'paper'


def test_a_text_in_ansi_says_how_to_save_it(capsys):
    Path('mine.yaml').write_bytes('# Größe\n'.encode('cp1252'))
    Path('table.csv').write_bytes('Größe [mm]; Kraft [N]\n0; 1\n1; 2\n'.encode('cp1252'))
    Path('my.yaml').write_text('/**: {ros__parameters: {forces: {f: {table: table.csv}}}}')
    for words, file in ((['show', 'mine.yaml'], 'mine.yaml'), (['show', 'my.yaml'], 'table.csv'),
                        (['scene', 'print', 'mine.yaml'], 'mine.yaml')):
        assert main(words) == 1
        assert capsys.readouterr().err.startswith(
            f'fourbar: {file}: is no text in UTF-8; if it is a text, save it in UTF-8: in Notepad')


def test_weight_of_points_waits_behind_a_hash_as_that_of_a_kind(capsys):
    points = ['--points', 'O 0 0', 'A 0 45mm', 'Q 250mm 120mm ground', 'K 240mm -40mm',
              'R 250mm -246mm slide -90deg', '--links', 'O-A', 'A-K', 'Q-K', 'K-R']
    assert main(['new', 'my.yaml', *points, '--bar', '30x12mm']) == 0
    out, err = capsys.readouterr()
    assert 'without mass: Rblock; give bodies.Rblock.mass\n' in out and not err
    text = Path('my.yaml').read_text()
    Path('my.yaml').write_text(text.replace('# gravity:', 'gravity:'))
    assert load_scene('my.yaml').linkage.gravity == (0.0, -9.81)
    assert main(['scene', 'check', 'my.yaml']) == 0
    assert 'bodies: Rblock without mass' in capsys.readouterr().err
    assert main(['new', 'bare.yaml', *points]) == 0
    assert 'gravity' not in Path('bare.yaml').read_text()


@pytest.mark.parametrize(('line', 'text'), [
    ('--points "O1 0"', 'must be "NAME X Y"'), ('--points "O1 0 0 slid 3deg"', 'must be "NAME'),
    *((f'--points "O1 0 0" "{name} 1 1" "B 2 0" "O4 3 0"', f"'{name}' must be a name: letters")
      for name in ('2', 'A.x', 'A#1', 'Ä')),
    ('--points "O1 0 0" "A 1 1" "B 2 0" --links O1-A A-B', 'form no dyads'),
    ('--points "O1 0 0" "A 1 1" "B 3 2" "O4 3 0" --links O1-A A-B B-O4 O4-O1',
     'joins two points of the ground, so it does not move: leave it out'),
    ('--points "O 0 0 ground" "A 45mm 0"', 'is the crank alone'),
    ('--points "O1 0 0" "A 0 1" "B 2 1" "O4 3 1"', 'modes.B: must be given, 1 or 2'),
    ('--points "O1 0 0" "A 0 1" "B 2 1 mode 3" "O4 3 1"', 'mode'),
    ('--links O1-A --a1 3', '--points'), ('--points "O1 0 0" --a1 3', '--points'),
    ('--points "O1 0 0" "A 1 1" "B 3 2" "O4 3 0" "A 1 2" --links O1-A A-B B-O4',
     "--points = 'A': must be given once"),
    ('--points "O1 0 0" --mode 1', 'in place of kind, lengths and mode'),
    ('--points "O1 0 0" --kind slider_crank', 'in place of kind, lengths and mode'),
    ('--a1 1 --a2 3 --a3 2 --a4 2.5 --material pla', 'is that of --bar or --rod')])
def test_points_that_are_none_are_said(line, text, capsys):
    try:
        assert main(['new', 'my.yaml', *shlex.split(line)])
    except SystemExit as end:
        assert end.code
    assert text in ' '.join(capsys.readouterr().err.split())


def test_numbers_without_a_point_are_numbers_as_ros_reads_them():
    lengths = [word.replace('mm', 'um') for word in GIVEN]
    assert main(['new', 'my.yaml', *lengths, '--rod', '1um']) == 0
    assert 'a1: 5e-05 ' in Path('my.yaml').read_text()
    assert load_scene('my.yaml').linkage.a1 == 5e-5
    points = ['O1 0 0', 'A 1mm 2mm', 'B 6mm 3mm', 'O4 5mm 1mm']         # by a machine
    assert main(['new', 'thin', '--points', *points, '--rod', '10um']) == 0
    assert load_scene('thin.yaml').values['bodies.rods.radius'] == 5e-6


def test_the_mode_that_is_printed_can_be_asked_for(capsys):
    for mode in ([], ['--mode', '4']):
        assert main(['show', 'watt', *mode]) == 0
        assert 'one 2, two 2' in capsys.readouterr().out


@pytest.mark.parametrize('kind', KINDS)
def test_every_kind_has_a_scene_that_has_loads_and_a_table(kind):
    given = [word for length in KINDS[kind].LENGTHS if not length.signed
             for word in (f'--{length.name}', {'a2': '90mm', 'a3': '80mm', 'a4': '70mm'}.get(
                 length.name, '30mm'))]
    assert main(['new', 'my', '--kind', kind, *given, '--bar', '20x5mm', '--speed=-300rpm']) == 0
    assert main(['table', 'my.yaml', 'shaking_force', '-o', 'x.csv']) == 0
    _, rows = rows_of('x.csv')
    assert np.isfinite(rows).all() and rows[:, 1].min() > 0.0


def test_a_change_point_says_that_it_stays_in_its_branch(capsys):
    lengths = '--a1', '100mm', '--a2', '500mm', '--a3', '200mm', '--a4', '400mm'
    for line in (['new', 'kite', *lengths], ['scene', 'check', 'kite.yaml'],
                 ['show', 'kite.yaml']):
        assert main(line) == 0
        said = capsys.readouterr().out
        assert 'flat at theta1 0 deg, where the motion stays in mode 2' in said
        assert 'repeats after two turns' in said
    assert main(['table', 'kite.yaml', 'theta4', '-o', 'kite.csv']) == 0
    _, rows = rows_of('kite.csv')
    assert rows[-1, 0] == 720.0 and np.isfinite(rows).all()
    assert main(['scene', 'check', 'paper']) == 0
    assert 'where the motion stays' not in capsys.readouterr().out


@pytest.mark.parametrize('verb', ['', 'new', 'list', 'table', 'plot', 'show', 'draw', 'scene',
                                  'simulate', 'bag', 'replay', 'describe', 'study',
                                  'balance', 'live', 'reproduce'])
def test_help_fits_eighty_columns_without_a_lost_word(verb, capsys, monkeypatch):
    words = {}
    for columns in ('80', '300'):
        monkeypatch.setenv('COLUMNS', columns)
        with pytest.raises(SystemExit):
            main([*verb.split(), '--help'])
        text = capsys.readouterr().out
        assert columns != '80' or max(len(line) for line in text.splitlines()
                                      if line[:1] != ' ') <= 80
        words[columns] = sorted(text.split())
    assert words['80'] == words['300'] and (verb or 'examples:' in text)


@pytest.mark.parametrize(('line', 'file'), [
    ('new there ' + ' '.join(GIVEN), 'there.yaml'), ('table paper theta4 -o there', 'there.csv'),
    ('plot paper theta4 -o there.svg', 'there.svg'), ('draw paper --at 60 -o there', 'there.png'),
    ('draw jansen --animate -o there.gif', 'there.gif'),
    ('describe paper -o there.urdf', 'there.urdf'), ('generate paper -o .', 'paper.c'),
    ('generate paper -o . --as fmu2', 'paper.fmu'), ('balance paper -o there', 'there.yaml'),
    ('balance paper --plot there.svg', 'there.svg'),
    ('balance paper --minimize moment --mass 1 --front there.svg', 'there.svg'),
    ('study pick nosuch best -o there.yaml', 'there.yaml'),
    ('reproduce --html there', 'there.html'),
    ('bag plot nosuch state.theta4 -o there', 'there.png')])
def test_a_file_that_is_there_is_not_written_over_without_force(line, file, capsys):
    Path(file).write_text('mine')
    assert main(line.split()) == 1
    assert capsys.readouterr() == ('', f'fourbar: {file}: exists already; --force overwrites it\n')
    assert Path(file).read_text() == 'mine'
    if line.split()[0] in ('new', 'table', 'describe'):
        assert main([*line.split(), '--force']) == 0
        assert Path(file).read_text() != 'mine'
    with pytest.raises(SystemExit):
        main([*line.split()[:1 + (line.split()[0] in ('study', 'bag'))], '--help'])
    assert '--force' in capsys.readouterr().out


@pytest.mark.parametrize('name', ['paper', 'slider_crank', 'cylinder', 'watt', 'engine'])
def test_a_table_holds_what_step_returns(name):
    assert main(['table', name, '-o', 'all.csv', '--samples', '25']) == 0
    heads, rows = rows_of('all.csv')
    scene = load_scene(name)
    linkage, speed = scene.linkage, scene.drive.speed
    for row in rows[3:20:4]:
        at = row[0] if heads[0].endswith('[m]') else np.radians(row[0])
        motion, loads = linkage.motion(at, speed), scene.linkage.loads(at, speed)
        for head, value in zip(heads[1:], row[1:]):
            field, _, unit = head.partition(' [')
            if '.' in field:
                continue
            want = getattr(loads if field in linkage.LOADS._fields else motion, field)
            if unit == 'deg]':
                want = np.degrees(want)
            # the input went through degrees and back: two roundings times the condition
            assert value == pytest.approx(want, rel=1e-10, abs=1e-10 * max(1.0, abs(want)))


@pytest.mark.parametrize(('suffix', 'begins'), [('png', b'\x89PNG'), ('pdf', b'%PDF'),
                                                ('svg', b'<?xml')])
def test_a_plot_is_what_its_suffix_says(suffix, begins, tmp_path):
    pytest.importorskip('matplotlib')
    assert main(['plot', 'paper', 'f41', 'omega4', '-o', f'x.{suffix}']) == 0
    assert (tmp_path / f'x.{suffix}').read_bytes().startswith(begins)


@pytest.mark.parametrize(('given', 'same'), [
    (('--at', '60deg'), ('--at', '60')), (('--at', '1.5rad'), ('--at', repr(degrees(1.5)))),
    (('--at', '60', '--speed', '300rpm'), ('--at', '60', '--speed', repr(10.0 * pi))),
    (('--at', '60', '--mode', 'crossed'), ('--at', '60', '--mode', '1'))])
def test_units_mean_what_they_say(given, same, capsys):
    texts = []
    for arguments in (given, same):
        assert main(['show', 'paper', *arguments]) == 0
        texts.append(capsys.readouterr().out)
    assert texts[0] == texts[1]


def test_the_list_has_every_scene_that_a_verb_takes(capsys):
    from fourbar_ros.scene.files import folder
    assert main(['list']) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines == [line.rstrip() for line in lines]       # no blanks that fill a column
    listed = {line.split()[0] for line in lines if line}
    names = {path.stem for below in ('.', 'classics', 'robots')
             for path in (folder() / below).glob('*.yaml')}
    assert names <= listed
    assert main(['list', 'robots']) == 0
    robots = capsys.readouterr().out
    assert all(path.stem in robots for path in (folder() / 'robots').glob('*.yaml'))
    assert 'jansen' not in robots


def test_a_reader_that_ends_early_is_no_error():
    with subprocess.Popen([sys.executable, '-m', 'fourbar_ros', 'list'], stdout=subprocess.PIPE,
                          stderr=subprocess.PIPE) as process:
        process.stdout.close()
        assert process.stderr.read() == b''
    assert process.returncode == 0


def test_a_reader_that_ends_while_a_table_is_printed_is_no_error():
    """Rich meets the closed pipe in a flush of its own, and exits with 1."""
    reader, writer = os.pipe()
    with suppress(BrokenPipeError), open(writer, 'w', encoding='utf-8') as file:
        console = PlainConsole(file=file)
        console.print('one')
        os.close(reader)
        with pytest.raises(BrokenPipeError):
            console.print('two')


@pytest.mark.parametrize('words, root', [
    ([], 'robot'), (['--as', 'mjcf'], 'mujoco')])
def test_it_prints_the_format_that_is_asked_for(words, root, capsys):
    assert main(['describe', 'paper', *words]) == 0
    assert ElementTree.fromstring(capsys.readouterr().out).tag == root


def test_letters_that_the_output_does_not_have_are_an_error_in_a_line(monkeypatch, capsys):
    monkeypatch.setattr(sys, 'stdout', io.TextIOWrapper(io.BytesIO(), encoding='cp1252'))
    monkeypatch.setattr('fourbar_ros.description.formats.describe', lambda *_: '\u010c')
    assert main(['describe', 'paper']) == 1
    assert capsys.readouterr().err == (
        "fourbar: '\\u010c' cannot be written in cp1252; PYTHONUTF8=1 in the environment writes "
        'UTF-8\n')


@pytest.mark.parametrize('name', ['.', '..', '', 'new/', 'a.'])
def test_a_file_to_write_has_a_name(name, tmp_path, monkeypatch, capsys):
    """'.' made a file ..yaml, which ls does not show."""
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SystemExit):
        main(['scene', 'print', 'paper', '-o', name])
    assert f'{name!r} names no file' in capsys.readouterr().err and not list(tmp_path.iterdir())


def test_a_description_is_not_called_like_another_format(tmp_path, capsys):
    """URDF was written as a.sdf."""
    assert main(['describe', 'paper', '-o', str(tmp_path / 'a.sdf')]) == 1
    assert 'must end in .urdf, .mjcf, .xml, unless --as is given' in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize('name, root', [
    ('a.urdf', 'robot'), ('a.mjcf', 'mujoco'), ('a.xml', 'mujoco')])
def test_the_file_name_chooses_the_format(name, root, tmp_path, capsys):
    assert main(['describe', 'cylinder', '-o', str(tmp_path / name)]) == 0
    assert ElementTree.parse(tmp_path / name).getroot().tag == root
    assert capsys.readouterr().out.strip() == str(tmp_path / name)
