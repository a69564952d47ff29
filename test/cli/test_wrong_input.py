# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Wrong scenes and wrong command lines: each is answered by one line that names the cause."""
from fourbar_ros.cli.main import main
import pytest

LONGEST = 200           # characters of an answer, the path of the scene not counted
HEAD = '/**:\n  ros__parameters:\n'
LINKAGE = {'linkage.a1': '0.4', 'linkage.a2': '1.2', 'linkage.a3': '0.8', 'linkage.a4': '1.0'}


def scene_of(changes):
    """Return the text of a four-bar with changed parameters; None leaves one out."""
    values = {**LINKAGE, **changes}
    return HEAD + ''.join(f'    {name}: {value}\n' for name, value in values.items()
                          if value is not None)


MACHINE = {**dict.fromkeys(LINKAGE), 'linkage.kind': 'machine', 'linkage.dyads': '[one]',
           'dyads.one.kind': 'RRR', 'dyads.one.first.link': 'crank',
           'dyads.one.first.along': '0.4', 'dyads.one.second.link': 'ground',
           'dyads.one.second.along': '1.0', 'dyads.one.links': '[coupler, rocker]',
           'dyads.one.length_1': '1.2', 'dyads.one.length_2': '0.8'}

# (parameters that are changed, what the answer names)
WRONG_VALUES = [
    ({'linkage.a1': '50mm'}, "linkage.a1 = '50mm': must be a number in m: 0.05"),
    ({'linkage.a1': '"0,05"'}, 'must be a number in m: 0.05'),
    ({'linkage.a1': 'long'}, "linkage.a1 = 'long': must be a number in m"),
    ({'linkage.a1': '-0.4'}, 'linkage.a1 = -0.4: must be positive'),
    ({'linkage.a1': '0'}, 'must be positive'),
    ({'linkage.a1': '.inf'}, 'must be a finite number'),
    ({'linkage.a1': '[0.4]'}, 'linkage.a1 = [0.4]: must be a number in m'),
    ({'linkage.a1': 'true'}, 'must be a number in m'),
    ({'linkage.a1': None}, 'linkage.a1: must be given'),
    ({'linkage.a2': '9.0'}, 'cannot close'),
    ({'linkage.al': '0.4'}, 'unknown parameter; linkage has kind, input, a1, a2'),
    ({'linkage.a1_mm': '50'}, 'did you mean linkage.a1 [m]? 50 mm = 0.05'),
    ({'linkage.mode': 'opne'}, 'must be one of 1 or crossed, 2 or open'),
    ({'linkage.mode': '3'}, 'linkage.mode = 3: must lie in [1, 2]'),
    ({'linkage.mode': '1.0'}, 'linkage.mode = 1.0'),
    ({'linkage.kind': 'fourbar'}, 'four_bar'),
    ({'linkage.kind': 'slider_crank'}, 'linkage.a3'),
    ({'linkage.input': 'slide'}, 'is driven at its crank'),
    ({'linkage.input': 'rocker'}, 'must be one of crank, slide, A, B, cylinder'),
    ({'linkage.range': '[0.1, 0.2]'}, 'only a driven slide has a stroke'),
    ({'linkage.dyads': '[one]'}, 'linkage.kind machine alone has it'),
    ({'linkages.a1': '0.4'}, 'did you mean linkage.a1'),
    ({'geometry.crank': '0.4'}, 'unknown parameter'),
    ({'drive.rpm': '300'}, 'drive.speed [rad/s]? 300 rpm = 31.416'),
    ({'drive.speed_rpm': '300'}, 'drive.speed [rad/s]? 300 rpm = 31.416'),
    ({'drive.speed': '300rpm'}, 'must be a number in rad/s or m/s: 31.416'),
    ({'drive.speed': 'fast'}, "drive.speed = 'fast': must be a number in rad/s or m/s"),
    ({'drive.sped': '3.0'}, 'did you mean drive.speed?'),
    ({'drive.start': '90deg'}, 'must be a number in rad or m: 1.5708'),
    ({'drive.start_deg': '90'}, 'drive.start [rad]? 90 deg = 1.5708'),
    ({'drive.rate': '1e9'}, 'must lie in [0.001, 5000]'),
    ({'drive.source': 'clock'}, 'must be one of timer, motion, joint_state, torque, motor'),
    ({'drive.source': 'joint_state'}, 'drive.joint'),
    ({'drive.source': 'motor'}, 'needs masses'),
    ({'drive.window': '2'}, 'must lie in [3, 50]'),
    ({'drive': '3.0'}, 'is a group of parameters, not a value'),
    ({'gravity': '-9.81'}, 'not a value; known: x, y'),
    ({'gravity.z': '-9.81'}, 'gravity has x, y'),
    ({'gravity.y': '9.81 m/s2'}, 'must be a number in m/s^2'),
    ({'bodies.rods.density': '7850'}, 'bodies.rods.radius: must be given'),
    ({'bodies.rods.radius': '0.01'}, 'bodies.rods.density: must be given'),
    ({'bodies.rods.density': 'steel', 'bodies.rods.radius': '0.01'}, 'must be a number in kg/m^3'),
    ({'bodies.rods.density': '7.85g/cm^3', 'bodies.rods.radius': '0.01'}, 'in kg/m^3: 7850'),
    ({'bodies.rods.density': '7850', 'bodies.rods.radius': '0.01', 'bodies.rods.width': '0.02'},
     'either the radius of round rods or width and thickness'),
    ({'bodies.rods.density': '7850', 'bodies.rods.width': '0.02'}, 'bodies.rods.thickness'),
    ({'bodies.rods.diameter': '0.02'}, 'bodies.rods has density, radius'),
    ({'bodies.crank.mass': '-1.0'}, 'bodies.crank.mass = -1.0: must be >= 0'),
    ({'bodies.crank.mass': '1.0'}, 'bodies.crank.inertia: must be given'),
    ({'bodies.handle.mass': '1.0'}, 'bodies.handle.mass'),
    ({'outputs': 'state'}, "outputs = 'state': must be a list of texts"),
    ({'outputs': '[stat]'}, 'did you mean state?'),
    ({'outputs': '[xyzzy]'}, 'nearest: '),
    ({'outputs': '[state, state]'}, 'names an output twice'),
    ({'outputs': '[loads]'}, 'bodies.crank.mass: must be given (or bodies.rods)'),
    ({'outputs': '[points]'}, 'points.NAME.link'),
    ({'points.P.link': 'cuopler'}, 'must be one of crank, coupler, output'),
    ({'points.P.x': '0.4'}, 'points.P has link, along, across'),
    ({'points.P-1.along': '0.4'}, 'not a valid point name: use letters, digits and _'),
    ({'frame_id': '""'}, 'frame_id'),
    ({'joint_names': '[a, b]'}, 'different names, one for each joint'),
    ({'services': '[find]'}, 'must be some of'),
    ({'recording.start': 'maybe'}, 'must be true or false'),
    ({'forces.F.link': 'crank'}, 'forces.F.acts: must be given'),
    ({'springs.s.first.link': 'crank'}, 'drive.source: torque or motor'),
    ({**MACHINE, 'linkage.dyads': '[two]'}, 'dyads.two'),
    ({**MACHINE, 'dyads.one.kind': 'RRX'}, 'must be one of RRR'),
    ({**MACHINE, 'dyads.one.first.link': 'krank'}, 'did you mean crank?'),
    ({**MACHINE, 'dyads.one.length_1': '9.0'}, 'cannot'),
]
# (text of the whole file, what the answer names)
WRONG_FILES = [
    ('', 'not a scene'),
    ('a1: 0.4\n', 'expected "/**:" with "ros__parameters:"'),
    ('/**:\n  ros_parameters:\n    linkage.a1: 0.4\n', "there is 'ros_parameters'"),
    ('/**:\n  ros__parameters:\n    linkage:\n      a1:0.4\n      a2: 1.2\n',
     'line 4: not YAML that ROS reads: a blank is missing behind the colon: a1: 0.4'),
    ('/**:\n  ros__parameters:\n    linkage: {a1:0.4, a2: 1.2}\n',
     'line 3: not YAML that ROS reads: a blank is missing behind the colon: a1: 0.4'),
    ('/**:\n  ros__parameters:\n    linkage:\n      a1:0.4\n', 'a blank is missing'),
    ('/**:\n  ros__parameters:\n\tlinkage:\n', 'line 3: not YAML that ROS reads: a tab'),
    ('/**:\n  ros__parameters:\n    linkage: {a1: 0.4\n', 'a bracket is open'),
    ('/**:\n  ros__parameters:\n    linkage:\n      a1: 0.4\n     a2: 1.2\n',
     'line 5: not YAML that ROS reads: it is indented unlike the lines above'),
    ('/**:\n  ros__parameters:\n    linkage.a1:\n', 'a key without a value'),
    (scene_of({}) + '    linkage.a1: 0.5\n', 'line 7: not YAML that ROS reads: linkage.a1 is '
     'given twice'),
    (scene_of({}) + '    drive: {speed: 1.0}\n    drive: {rate: 2.0}\n', 'is given twice'),
    (scene_of({}) + '    gravity: {x: 0.0}\n    gravity.x: 1.0\n', 'is given twice'),
    (scene_of({}).replace('/**', 'other'), 'contains nothing for the node'),
    ('/**:\n  ros__parameters: {outputs: [state]}\n' + scene_of({}).replace('/**', 'left'),
     'has the nodes /left; name one: '),
    ('/**:\n  ros__parameters:\n    linkage: &l {a1: 0.4}\n    drive: *l\n', 'no aliases'),
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


@pytest.mark.parametrize(('text', 'cause'), [
    *((scene_of(changes), cause) for changes, cause in WRONG_VALUES), *WRONG_FILES])
def test_a_wrong_scene_is_one_line(text, cause, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / 'my.yaml').write_text(text)
    code, err = answer(capsys, 'scene', 'check', 'my.yaml')
    assert cause in err
    assert (code, len(err) <= LONGEST) == (1, True), err


# (command line, exit code, what the answer names)
WRONG_LINES = [
    ('shwo paper', 2, 'did you mean show?'),
    ('xyzzy', 2, "'xyzzy' is unknown; "),
    ('', 2, 'VERB'),
    ('--versoin', 2, 'did you mean --version?'),
    ('show', 2, 'SCENE'),
    ('show papr', 1, 'did you mean paper?'),
    ('show xyzzy', 1, 'neither a file nor the name of a scene; nearest: '),
    ('show nosuch.yaml', 1, 'nosuch.yaml: No such file'),
    ('show .', 1, '.: Is a directory'),
    ('show paper paper', 2, "'paper' is not understood"),
    ('show paper --sped 3', 2, 'did you mean --speed?'),
    ('show paper --speed', 2, '--speed: expected one argument'),
    ('show paper --speed fast', 2, "--speed: 'fast' must be a number"),
    ('show paper --speed 3,5', 2, 'must be a number with a point: 3.5'),
    ('show paper --speed 300rpn', 2, 'rpm'),
    ('show paper --speed 1m/s', 1, 'takes angular speed'),
    ('show paper --speed nan', 2, 'must be a'),
    ('show paper --at inf', 2, "'inf' must be"),
    ('show paper --acceleration nan', 2, "'nan' must be"),
    ('show paper --at 50mm', 1, 'takes angle'),
    ('show slides_7_6 --at 200', 1, 'outside the input range'),
    ('show paper --mode opne', 2, 'must be 1 or crossed, 2 or open'),
    ('show paper --mode 3', 2, 'must be 1 or crossed, 2 or open'),
    ('show paper --seconds -1', 2, 'must be a positive number'),
    ('new x.yaml --a1 50mm', 1, '--a2: must be given'),
    ('new x.yaml --a1 50mmm', 2, "'50mmm' must be a number"),
    ('new x.txt --a1 1 --a2 1 --a3 1 --a4 1', 1, 'must end in .yaml'),
    ('new x.yaml --kind fourbar', 2, 'did you mean four_bar?'),
    ('new x.yaml --material gold', 2, 'known: steel'),
    ('new x.yaml --bar 20mm', 2, 'must be WIDTHxTHICKNESS'),
    ('new x.yaml --bar 20x5mm --rod 8mm', 2, 'not allowed with'),
    ('new x.yaml --a1 1 --a2 9 --a3 1 --a4 1', 1, 'cannot close'),
    ('new nowhere/x.yaml --a1 1 --a2 2 --a3 2 --a4 2', 1, 'nowhere/x.yaml: No such file'),
    ('table paper f4 -o x.csv', 1, 'did you mean f4'),
    ('table paper xyzzy -o x.csv', 1, 'nearest: '),
    ('table paper -o x.xls', 1, 'must end in'),
    ('table paper -o x.csv --samples 0', 2, '--samples'),
    ('table paper -o nowhere/x.csv', 1, 'nowhere/x.csv'),
    ('plot paper -o x.csv', 1, 'must end in'),
    ('draw paper --at x -o x.png', 2, "'x' must be a number"),
    ('draw paper --speed 1m/s --over paths -o x.png', 1, 'takes angular speed'),
    ('draw paper -o x.png', 1, '--at: must be given'),
    ('scene', 2, 'ACTION'),
    ('scene chekc paper', 2, 'did you mean check?'),
    ('scene check', 2, 'SCENE'),
    ('simulate paper --until 1', 1, 'drive.source'),
    ('simulate motor', 2, '--until'),
    ('simulate motor --until 0', 2, 'must be a positive number'),
    ('simulate motor --until 1 --method rk', 2, "'rk' is unknown"),
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
    ('study nosuch.yaml -o x', 1, 'nosuch.yaml'),
    ('balance papr', 1, 'did you mean paper?'),
]


@pytest.mark.parametrize(('line', 'code', 'cause'), WRONG_LINES)
def test_a_wrong_command_line_is_one_line(line, code, cause, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    found, err = answer(capsys, *line.split())
    assert cause in err
    assert (found, len(err) <= LONGEST) == (code, True), err
    assert not list(tmp_path.iterdir())
