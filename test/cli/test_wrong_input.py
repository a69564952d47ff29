# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Wrong scene files and wrong command lines: each is answered by one line that names the cause."""
from fourbar_ros.cli.main import main
import pytest

LONGEST = 200           # characters of an answer, the path of the scene not counted
HEAD = '/**:\n  ros__parameters:\n'
GOOD = HEAD + ''.join(f'    linkage.a{k}: {length}\n' for k, length in enumerate(
    (0.4, 1.2, 0.8, 1.0), 1))

# (text of the whole file, what the answer names)
WRONG_FILES = [
    ('', 'not a scene'),
    ('a1: 0.4\n', 'expected "/**:" with "ros__parameters:"'),
    ('/**:\n  ros_parameters:\n    linkage.a1: 0.4\n', "there is 'ros_parameters'"),
    ('/**:\n  ros__parameters:\n    linkage:\n      a1:0.4\n      a2: 1.2\n',
     'line 4: not YAML that ROS reads: a blank is missing behind the colon: a1: 0.4'),
    ('/**:\n  ros__parameters:\n    linkage: {a1:0.4, a2: 1.2}\n', 'a blank is missing'),
    (GOOD.replace('a1: 0.4', 'a1: .nan'), 'linkage.a1 = nan: NaN is not a number in m'),
    (GOOD + '    drive.speed: .nan\n', 'drive.speed = nan: NaN is not a number in rad/s'),
    ('/**:\n  ros__parameters:\n    linkage: {a1: 0,4, a2: 1.2}\n',
     'line 3: not YAML that ROS reads: 0,4 must be written 0.4: a comma is no decimal point'),
    ('/**:\n  ros__parameters:\n    linkage: {a1: 1,200mm, a2: 1.2}\n',
     '1,200mm must be written 1200mm or 1.200mm, without a comma'),
    (GOOD + '    frame_id:\n', 'line 7: not YAML that ROS reads: frame_id has no value'),
    (GOOD + '    joint_states.offsets: [0, 0.5, 0, 0]\n',
     'line 7: not YAML that ROS reads: a list must be of one type: write 0.0 for 0'),
    (GOOD + '    forces.cut.values: [0kN, -1,8kN]\n',
     "-1 is not of that of '0kN'; -1,8kN must be written -1.8kN: a comma is no decimal"),
    (GOOD + '    forces.cut.values: [1kN, 1,200kN]\n', '1,200kN must be written 1200kN or'),
    (GOOD + '    forces.cut.places: [[0, 1],[1, 2]]\n', 'line 7: not YAML that ROS reads: a list '
     'holds numbers or texts, no lists'),
    (GOOD + '    drive.start: 045\n', 'line 7: not YAML that ROS reads: 045 is octal for ROS, 37: '
     'write 45'),
    (GOOD + '    forces.cut.places: [000, 030, 060]\n', '030 is octal for ROS, 24: write 30'),
    (GOOD + '    linkage.joints: [O1, N, B, O4]\n', "False is not of that of 'O1'; names as N"),
    (GOOD + '    frame_id: n\n', 'frame_id = False: must be a text: names as N, y, on need '
     'quotes'),
    (GOOD + '    linkage.kind: [four_bar]\n', "linkage.kind = ['four_bar']: must be a text"),
    (GOOD + '    gravity: &down {y: -9.81}\n    base.carried: *down\n',
     'line 8: not YAML that ROS reads: ROS takes no alias: write out *down'),
    (GOOD + '    forces.cut.values: [0kN, -1, 8kN]\n', "-1 is not of that of '0kN'; give all"),
    ('<?xml version="1.0"?>\n<robot name="r"/>', 'a robot description, URDF; fourbar import'),
    ('<!-- a -->\n<mujoco/>', 'MJCF'), ('<sdf version="1.7"/>', 'SDF'),
    ('/**:\n  ros__parameters:\n    linkage:\n      a1:0.4\n', 'a blank is missing'),
    ('/**:\n  ros__parameters:\n\tlinkage:\n', 'line 3: not YAML that ROS reads: a tab'),
    ('/**:\n  ros__parameters:\n    linkage: {a1: 0.4\n',
     'a bracket is open'),
    ('/**:\n  ros__parameters:\n    linkage:\n      a1: 0.4\n     a2: 1.2\n',
     'line 5: not YAML that ROS reads: it is indented unlike the lines above'),
    (GOOD + '    linkage.a1: 0.5\n', 'line 7: not YAML that ROS reads: linkage.a1 is '
     'given twice'),
    (GOOD + '    drive: {speed: 1.0}\n    drive: {rate: 2.0}\n', 'is given twice'),
    (GOOD + '    gravity: {x: 0.0}\n    gravity.x: 1.0\n', 'is given twice'),
    (GOOD.replace('/**', 'other'), 'contains nothing for the node'),
    ('/**:\n  ros__parameters: {outputs: [state]}\n' + GOOD.replace('/**', 'left'),
     'has the nodes /left; name one: '),
    ('\x00', 'not YAML'), ('"open', 'line 1: not YAML that ROS reads: a quote is open')]


def answer(capsys, *arguments):
    """Return (exit code, the only line on stderr); nothing else may be printed."""
    try:
        code = main(list(arguments))
    except SystemExit as done:
        code = done.code
    out, err = capsys.readouterr()
    assert (out, err.count('\n'), 'Traceback' in err) == ('', 1, False), (out, err)
    return code, err


@pytest.mark.parametrize(('text', 'cause'), WRONG_FILES)
def test_a_wrong_file_is_one_line(text, cause, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / 'my.yaml').write_text(text)
    code, err = answer(capsys, 'scene', 'check', 'my.yaml')
    assert cause in err
    assert (code, len(err) <= LONGEST) == (1, True), err


# (command line, exit code, what the answer names)
WRONG_LINES = [
    ('shwo paper', 2, 'did you mean show?'),
    ('xyzzy', 2, "'xyzzy' is unknown"),
    ('', 2, 'VERB'),
    ('--versoin', 2, 'did you mean --version?'),
    ('show', 2, 'SCENE'),
    ('show papr', 1, 'did you mean paper?'),
    ('show xyzzy', 1, 'neither a file nor the name of a scene; fourbar list shows'),
    ('show nosuch.yaml', 1, 'nosuch.yaml: No such file'),
    ('show .', 1, '.: Is a directory'),
    *((f'{line} b.yaml', 2, f"'b.yaml' is one word too many: this verb takes {takes} (")
      for line, takes in (
        ('show paper', 'SCENE; fourbar live draws two, fourbar study compares many'),
        ('reproduce', 'options only'), ('live paper jansen', 'SCENE SECOND'),
        ('study s.yaml -o out', 'STUDY'), ('study pick out best', 'DIR WHICH'),
        ('bag info a', 'BAG'), ('bag diff a b', 'BAG OTHER'), ('new a.yaml', 'FILE'))),
    ('show paper --at 60 deg', 2, "'deg' is one word too many"),
    ('show paper --at 60 -x', 2, "'-x' is not understood"),
    ('show paper --at 5kg', 2, 'must be a number in deg or m, or with one of the units rad'),
    ('show paper --sped 3', 2, 'did you mean --speed?'),
    ('table paper theta4 --samples 3 f41 -o - --sped 3', 2, 'did you mean --speed?'),
    ('show paper --speed', 2, '--speed: expected one argument'),
    ('show paper --speed fast', 2, "--speed: 'fast' must be a number"),
    ('show paper --speed 3,5', 2, 'must be written 3.5: a comma is no'),
    ('show paper --fluctuation 5,0%', 2, "'5,0%' must be written 5.0: a comma is no"),
    ('show paper --speed 300rpn', 2, 'rpm'),
    ('show paper --speed 1m/s', 1, 'takes rad/s'),
    ('show paper --speed nan', 2, 'must be a'),
    ('show paper --at inf', 2, "'inf' must be"),
    ('show paper --acceleration nan', 2, "'nan' must be"),
    ('show paper --at 50mm', 1, 'takes rad, deg'),
    ('show cylinder --at 60deg', 1, 'takes'),
    ('show slides_7_6 --at 200', 1,
     'theta1 = 200 deg is outside the input range -130.3202 to 130.3202 deg'),
    ('show slides_7_6 --at -200°', 1, 'theta1 = -200 deg is outside the input range'),
    ('show cylinder --at 9', 1, 'slide = 9 m is outside'),
    ('show paper --mode opne', 2, 'must be 1 or crossed, 2 or open'),
    ('show paper --mode 3', 1, 'mode = 3: must be 1 or 2'),
    ('show paper --mode 0', 2, 'must be 1 or crossed, 2 or open'),
    ('show watt --mode 2', 1, 'must be 4: machine of dyads'),
    ('show paper --hold 50mm', 1, '--hold has a unit of the kind m; this mechanism takes rad'),
    ('show cylinder --hold 60deg', 1, '--hold has a unit of the kind rad; this mechanism takes m'),
    ('show slides_7_6 --hold 30', 1, 'loads need masses'),
    ('show paper --from 350 --to 10', 1,
     '--from = 350.0: must be below --to; across 0 degrees: --from -10 --to 10'),
    ('show cylinder --from 1.4 --to 1.2', 1, '--from = 1.4: must be below --to'),
    ('show cylinder --fluctuation 5%', 1, 'fluctuation = 0.05: is of a crank that turns fully'),
    ('show paper --seconds -1', 2, 'must be a positive number'),
    ('new x.yaml --a1 50mm', 1, 'linkage.a2: must be given'),
    ('new x.yaml --a1 50mmm', 2, "'50mmm' must be a number"),
    ('new x.txt --a1 1 --a2 1 --a3 1 --a4 1', 1, 'must end in .yaml'),
    ('new x.yaml --kind fourbar', 2, 'did you mean four_bar?'),
    ('new x.yaml --material gold', 2, "'gold' must be steel, stainless, aluminium, brass"),
    ('new x.yaml --bar 20mm', 2, 'must be WIDTHxTHICKNESS'),
    ('new x.yaml --bar 30,5x12mm', 2, 'must be written 30.5x12mm: a comma is no decimal'),
    ('new x.yaml --bar 20x5mm --rod 8mm', 2, 'not allowed with'),
    ('replay bags/run --inputs-only --topics /a', 2, 'not allowed with'),
    ('new x.yaml --a1 1 --a2 9 --a3 1 --a4 1', 1, 'cannot close'),
    ('new x.yaml --a1=-5mm --a2 150mm --a3 100mm --a4 125mm', 1, 'linkage.a1 = -0.005'),
    ('new x.yaml --kind scotch_yoke --a1 1 --a2 1', 1, 'scotch_yoke has a1, offset only'),
    ('new nowhere/x.yaml --a1 1 --a2 2 --a3 2 --a4 2', 1, 'nowhere/x.yaml: No such file'),
    *((f'{line} -o x.png', 1, 'is the input, over which all else is given: name a quantity')
      for line in ('table paper theta1', 'plot watt theta_crank', 'table cylinder slide')),
    ('table paper f4 -o x.csv', 1, 'did you mean f4'),
    ('table paper xyzzy -o x.csv', 1, "unknown quantity 'xyzzy'"),
    ('table slides_7_6 driving_torque -o x.csv', 1, 'loads need masses'),
    ('plot slides_7_6 driving_torque -o x.png', 1, 'loads need masses'),
    ('table paper torque -o x.csv', 1, 'there is driving_torque'),
    ('table paper --speed 1m/s -o x.csv', 1, 'takes'),
    ('table paper --speed 1e308 -o x.csv', 1, 'overflows'),
    ('table paper -o x.xlsx', 1, 'must end in .csv, which --excel writes for Excel'),
    ('table press slide --units kN -o -', 1, "units = 'kN': is of no column: they are in rad, m"),
    ('plot press slide --units kN -o x.png', 1, "units = 'kN': is of no column"),
    ('table press --speeds 1 2 --units mm -o -', 1, 'is of no column'),
    *((f'table paper --speeds 1 2 -o - {option}', 1,
       '--speeds: stands in place of --speed and --samples')
      for option in ('--speed 3', '--samples 5')),
    *((f'{line} -', 2, "'-' names no file") for line in (
        'describe paper -o', 'scene print paper -o', 'live paper -o', 'balance paper -o')),
    ('table paper --units rpmm -o -', 2, "'rpmm' is no unit; did you mean rpm"),
    ('table paper --units mm,cm -o -', 2, 'mm and cm measure the same'),
    ('table paper --digits 0 -o -', 2, "'0' is unknown; known: 1, 2"),
    ('table paper -o x.csv --samples 0', 2, '--samples'),
    ('table paper theta4 --samples 100000000000000 -o -', 1, 'table: not enough memory'),
    ('table paper -o nowhere/x.csv', 1, 'nowhere/x.csv'),
    ('plot paper -o x.csv', 1, 'must end in .png, .svg, .pdf'),
    ('draw paper --at x -o x.png', 2, "'x' must be a number"),
    ('draw paper --speed 1m/s --over paths -o x.png', 1, 'takes rad/s'),
    ('draw paper -o x.png', 1, '--at: must be given'),
    ('draw slides_7_6 --at 200 -o x.png', 1, 'theta1 = 200 deg is outside the input range'),
    ('draw paper --at 60 -o x.xyz', 1, 'xyz'),
    ('draw paper --at 60 -o nowhere/x.svg', 1, 'nowhere/x.svg: No such file'),
    *((f'draw paper --animate -o x.gif --{option}', 1, f'--animate: has no --{option.split()[0]}')
      for option in ('at 60', 'over paths', 'acceleration 3', 'width 88mm', 'title T')),
    ('draw paper --animate -o x.png', 1, 'is a .gif'),
    ('draw paper --animate -o nowhere/x.gif', 1, 'nowhere/x.gif'),
    ('draw slides_7_6 --over forces -o x.png', 1, 'masses'),
    ('draw paper --over forces --at 60 -o x.png', 1, 'at = 60.0: is one input, and the forces'),
    ('draw jansen --over axis -o x.svg', 1, 'its crank drives'),
    ('scene', 2, 'ACTION'),
    ('scene chekc paper', 2, 'did you mean check?'),
    ('scene check', 2, 'SCENE'),
    ('simulate paper --until 1', 1, 'drive.source'),
    ('simulate motor', 2, '--until'),
    ('simulate motor --until 0', 2, 'must be a positive number'),
    ('simulate motor --until 1 --method rk', 2, "'rk' is unknown"),
    ('simulate motor --until 1 --torque 3', 1, 'drive.source: torque'),
    ('simulate motor --until 0.0001', 1, 'less than one sample'),
    ('simulate motor --until 1e12', 1, 'until = 1000000000000.0: is more than 10000000 samples'),
    ('simulate motor --until 1 --tolerance 2', 1, 'tolerance'),
    ('bag', 2, 'ACTION'),
    ('bag inf x', 2, 'did you mean info?'),
    ('bag info nosuch', 1, 'nosuch'),
    ('bag info x --chek', 2, 'did you mean --check?'),
    ('bag recompute nosuch --tolerance -1', 2, "'-1' must be"),
    ('bag diff x y --tolerance nan', 2, "'nan' must be"),
    ('replay x --start -1e-9', 2, "'-1e-9' must be"),
    ('replay x --rate 0', 2, "'0' must be"),
    ('describe paper --as udrf', 2, 'did you mean urdf?'),
    ('describe papr', 1, 'did you mean paper?'),
    ('describe paper -o nowhere/x.urdf', 1, 'No such file'),
    ('generate paper -o x --outputs f14', 1, 'did you mean f4'),
    ('study nosuch.yaml -o x', 1, 'nosuch.yaml'),
    ('reproduce --html nowhere/x.html', 1, 'No such file'),
    ('balance papr', 1, 'did you mean paper?'),
]


@pytest.mark.parametrize(('line', 'code', 'cause'), WRONG_LINES)
def test_a_wrong_command_line_is_one_line(line, code, cause, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    found, err = answer(capsys, *line.split())
    assert cause in err
    assert (found, len(err) <= LONGEST) == (code, True), err
    assert not list(tmp_path.iterdir())
