# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Wrong scenes at the doors of Python and the command line: refused in one line that names what.

test/ros/test_start.py gives some of them to the node.
"""
from math import inf, nan

from fourbar_ros import InvalidParameter
from fourbar_ros.cli.main import main
from fourbar_ros.scene import scene
from fourbar_ros.scene.files import read_values
import pytest
from support.scenes import file_of, PAPER, PUSH, RODS

BARS = {**PAPER, 'bodies.rods.density': 7850.0, 'bodies.rods.width': 0.02,
        'bodies.rods.thickness': 0.005}
MOTOR = {**PAPER, **RODS, 'drive.source': 'motor', 'motor.stall_torque': 400.0,
         'motor.free_speed': 26.0}
DC = {**PAPER, **RODS, 'drive.source': 'motor', 'motor.kind': 'dc', 'motor.voltage': 48.0,
      'motor.resistance': 0.5, 'motor.torque_constant': 0.3}
CYLINDER = {'linkage.kind': 'inverted_slider', 'linkage.input': 'slide', 'linkage.a1': 1.2,
            'linkage.a4': 1.6}
JOINT = {'drive.source': 'joint_state', 'drive.joint': 'motor'}
LONGEST = 200           # characters of an answer
# A good scene, then for each wrong one: parameter and value (or several), what the answer says,
# and which parameter it names, if another. None leaves a parameter out.
TABLE = [
    (PAPER, [
        ('linkage.a1', '50kg', 'must be a number in m'),
        ('linkage.a1', '0,05', 'must be written 0.05: a comma is no decimal point'),
        ('linkage.a1', -0.4, 'must be positive'),
        ('linkage.a1', 0, 'must be positive'),
        ('linkage.a1', inf, 'must be a finite number'),
        ('linkage.a1', [0.4], 'must be a number in m'),
        ('linkage.a1', None, 'must be given'),
        ('linkage.al', 0.4, 'unknown parameter of linkage'),
        ('linkage.a1_mm', 50, 'unknown parameter of linkage'),
        ('linkage.mode', 'opne', 'must be one of 1 or crossed, 2 or open'),
        ('linkage.mode', 3, 'must lie in [1, 2]'),
        ('linkage.mode', 1.0, 'must be one of 1'),
        ('linkage.kind', 'fourbar', 'four_bar'),
        ('linkage.kind', 'slider_crank', 'has a1, a2, offset only', 'linkage.a3'),
        ('linkage.input', 'slide', 'is driven at its crank'),
        ('linkage.input', 'rocker', 'must be one of crank, slide, A, B, cylinder'),
        ('linkages.a1', 0.4, 'did you mean linkage.a1'),
        ('Joint_States', 4, 'did you mean joint_states?'),
        ('Joint_States.prefix', 3, 'did you mean joint_states.prefix?'),
        ('geometry.crank', 0.4, 'unknown parameter'),
        ('drive.speed_rpm', 300, 'there is speed'),
        ('drive.speed', '300mm', 'must be a number in rad/s'),
        ('drive.sped', 3.0, 'of drive; did you mean speed?'),
        ('drive.start', '90mm', 'must be a number in rad'),
        ('drive.start_deg', 90, 'there is start'),
        ('drive.rate', 1e9, 'must lie in [0.001, 5000]'),
        ('drive.source', 'clock', 'must be one of timer, motion, joint_state, torque, motor'),
        ('drive.source', 'joint_state', 'must name the joint', 'drive.joint'),
        ('drive.source', 'motor', 'needs masses', 'bodies.crank.mass'),
        ('drive.window', 2, 'must lie in [3, 50]'),
        ('drive', 3.0, 'is a group of parameters, not a value'),
        ('gravity', -9.81, 'not a value; known: x, y'),
        ('gravity.z', -9.81, 'of gravity; known: x, y'),
        ('gravity.y', '9.81 m/s', 'must be a number in m/s^2'),
        ('bodies.rods.density', 7850, 'must be given', 'bodies.rods.radius'),
        ('bodies.rods.radius', 0.01, 'must be given', 'bodies.rods.density'),
        ({'bodies.rods.density': 7850, 'bodies.rods.width': 0.02}, 'must be given',
         'bodies.rods.thickness'),
        ('bodies.rods.diameter', 0.02, 'of bodies.rods'),
        ('bodies.crank.mass', -1.0, 'must be >= 0'),
        ('bodies.crank.mass', 1.0, 'must be given', 'bodies.crank.inertia'),
        ('bodies.handle.mass', 1.0, 'there is no such link here', 'bodies.handle'),
        ('outputs', 'state', 'must be a list of texts'),
        ('outputs', ['stat'], 'did you mean state?'),
        ('outputs', ['xyzzy'], 'must be some of '),
        ('gears.one.ratio', 2.0, 'fourbar_ros has no gears or cams'),
        ('friction.A', 0.1, 'unknown parameter'),
        ('wheels.A.radius', 0.1, 'docs/reference_desk.md lists those of a scene'),
        ('ram.mass', '14kg', 'did you mean bodies.ram.mass?'),
        ('outputs', ['state', 'state'], 'names an output twice'),
        ('outputs', ['loads'], 'must be given (or bodies.rods)', 'bodies.crank.mass'),
        ('outputs', ['points'], 'points.NAME.link'),
        ('points.P.link', 'cuopler', 'must be one of crank, coupler, output'),
        ('points.P.x', 0.4, 'of points.P; known: link, along, across'),
        ('points.P-1.along', 0.4, 'not a valid point name: use letters, digits and _'),
        ('frame_id', '', 'must not be empty'),
        ('frame_id', '/base', 'must not begin with a slash'),
        ('joint_names', ['a', 'b'], 'different names, one for each joint'),
        ('linkage.joints', ['P', 'Q', 'R'], 'must be 4 different names, of O1, A, B, O4'),
        ('linkage.joints', ['P', 'Q', 'P', 'R'], 'must be 4 different names'),
        ('linkage.joints', ['P', '', 'Q', 'R'], 'must be 4 different names'),
        ('services', ['find'], 'must be some of'),
        ('recording.start', 'maybe', 'must be true or false'),
        ('recording.split_size', 0.001, 'must be 0 or >= 0.01'),
        ('recording.split_duration', 0.099, 'must be 0 or >= 0.1'),
        ('recording.split_duration', -1.0, 'must be 0 or >= 0.1'),
        ('drive.speed', -1e300, 'must lie in [-1e+100, 1e+100]'),
        ('joint_states.ratios', [1.0, 0.0, 1.0, 1.0], 'must not be zero'),
        ('joint_states.ratios', [1.0, 1.0], '4 numbers'),
        ('joint_states.ratios', [1.0, inf, 1.0, 1.0], 'finite'),
        ('joint_states.ratios', 2.0, 'a list of numbers'),
        ('joint_states.offsets', ['a', 'b', 'c', 'd'], 'must be a number in rad or m'),
        ('joint_states.offsets', [0.0] * 5, '4 numbers'),
        ('joint_states.when_unknown', 'nan', 'skip, hold, send_nan'),
        ('drive.joint_ratio', 0.0, 'must not be zero'),
        ({**JOINT, 'drive.joint_ratio': -60.0, 'drive.top_speed': 10.0},
         'with a drive.joint_ratio other than 1 and -1', 'drive.top_speed'),
        ({**JOINT, 'drive.top_speed': 0.0}, 'must be', 'drive.top_speed'),
        ('base.topic', 'imu', 'without masses'),
        ('base.carried.mass', 1.0, 'without masses'),
        ('base.carrid', 1.0, 'of base; did you mean carried?'),
        ('forces.F.link', 'crank', 'must be given', 'forces.F.acts'),
        ('springs.s.first.link', 'crank', 'springs.s needs masses', 'bodies.crank.mass'),
        ('linkage.a4', 99.0, 'the links cannot close'),
        ('frame.xyz', [0.0, 0.0, 1.0], 'has no effect without frame.parent'),
        ('frame.rpy', [0.0, 0.0, 0.0], 'has no effect without frame.parent'),
        ({'frame.parent': 'shin', 'frame.xyz': [0.0, 1.0]}, 'must be 3 numbers: x, y, z',
         'frame.xyz'),
        ({'frame.parent': 'shin', 'frame.rpy': [0.0]}, 'roll, pitch, yaw', 'frame.rpy'),
        ({'frame.parent': 'shin', 'frame.rpy': ['30mm', '0deg', '0deg']},
         'must be a number in rad', 'frame.rpy'),
        ('frame.parent', 'fourbar', 'must be another frame than frame_id'),
        ('frame.parent', '/shin', 'must not begin with a slash'),
        ('joint_states.leave_out', ['couppler'], 'must be some of crank, coupler'),
        ('joint_states.leave_out', ['crank', 'coupler', 'coupler_output', 'output'],
         'leaves no joint'),
        ('linkage.a1', nan, ''),
    ]),
    ({**PAPER, **RODS}, [
        ('bodies.rods.density', 'steel', 'must be a number in kg/m^3'),
        ({'bodies.rods.density': 7850, 'bodies.rods.width': 0.02},
         'either the radius of round rods or width and thickness', 'bodies.rods.radius'),
        ({'drive.source': 'torque', 'drive.start_speed': -1e300}, 'must lie in [-1e+100, 1e+100]',
         'drive.start_speed'),
        ('base.topic', 'gps', 'motion_of_base'),
        ({'base.topic': 'imu', 'gravity.y': -9.81}, 'weight counts twice', 'base.topic'),
        ({'base.topic': 'imu', 'base.rotation': [1.0, 2.0]}, 'quaternion', 'base.rotation'),
        ({'base.topic': 'imu', 'trajectories': True}, 'their effort would be wrong',
         'trajectories'),
        ({'base.carried.mass': 1.0, 'base.carried.mean': True}, 'exclude each other',
         'base.carried.mean'),
        ('linkage.dyads', ['one'], 'alone has it'),
        ('dyads.one.kind', 'RRR', 'alone has dyads'),
        ('drive.source', 'motor', 'must be given', 'motor.stall_torque'),
        ('springs.s.preload', inf, 'finite'),
        ('torsion_springs.s.preload', 1.0, 'of torsion_springs.s'),
    ]),
    ({**PAPER, **RODS, **PUSH}, [
        ('forces.push.link', 'rocker', 'must be one of crank, coupler'),
        ('forces.push.link', 'ground', 'must be one of crank, coupler'),
        ('forces.push.acts', 'up', 'must be one of x, y, along'),
        ('forces.push.over', 'thetta4', 'did you mean theta4?'),
        ('forces.push.over', 'tip.x', 'no such coordinate'),
        ('forces.push.values', [], 'must be as many as places'),
        ('forces.push.places', [], 'must be given', 'forces.push.table'),
        ('forces.push.place_unit', 'mm', 'a unit of an angle'),
        ('forces.push.value_unit', 'N m', 'a force or pressure'),
        ({'forces.push.acts': 'couple', 'forces.push.value_unit': 'N'}, 'a unit of a couple',
         'forces.push.value_unit'),
        ('forces.push.value_unit', 'bar', 'must be the area', 'forces.push.factor'),
        ({'forces.push.values': [5.0, 1.0, 2.0, 3.0], 'forces.push.periodic': False},
         'turns fully', 'forces.push.values'),
        ('forces.push.values', [5.0, 1.0, 2.0, 3.0], 'must be the first value again',
         'forces.push.values[4]'),
        ('forces.push.places', [0.0, 1.0, 2.0, 3.0], 'period must be'),
        ('forces.push.factor', inf, 'finite'),
        ('forces.push.table', 7, 'must be a text'),
        ('forces.push.curve', 'x', 'unknown parameter'),
        ({'bodies.rods.density': None, 'bodies.rods.radius': None, 'outputs': None},
         'forces.push needs masses', 'bodies.crank.mass'),
    ]),
    (read_values('watt'), [
        ('linkage.dyads', [], 'must be given'),
        ('linkage.dyads', ['one', 'two', 'one'], "'one': stands twice"),
        ('linkage.dyads', ['one'], 'is not listed in linkage.dyads', 'dyads.two'),
        ('linkage.dyads', ['one', 'two', 'three'], 'must be given', 'dyads.three.kind'),
        ('linkage.dyads', ['two', 'one'], 'is a link of dyad one', 'dyads.two.first.link'),
        ({'linkage.dyads': ['one', 'tow'], 'dyads.tow.kind': 'RRR'}, 'must be given',
         'dyads.tow.first.link'),
        ('dyads.one.kind', None, 'must be given'),
        ('dyads.one.links', None, 'must be given'),
        ('dyads.one.second.link', None, 'must be given'),
        ('dyads.one.length_2', None, 'a dyad RRR needs it'),
        ('dyads.one.kind', 'RRX', 'must be one of RRR, RRP'),
        ('dyads.one.kind', 'RRP', 'a dyad RRP has', 'dyads.one.length_2'),
        ('dyads.one.first.link', 'crnak', 'did you mean crank?'),
        ('dyads.one.first.link', 'coupler', 'its own link'),
        ('dyads.two.links', ['coupler', 'output'], 'of dyad one already'),
        ('dyads.two.links', ['crank', 'output'], 'is the driven link already'),
        ('dyads.two.links', ['output'], 'two links'),
        ('dyads.two.links', ['a b', 'output'], 'must be a name'),
        ('dyads.two.links', ['rods', 'output'], 'another name'),
        ('dyads.one.length_1', -1.0, 'must be positive'),
        ('dyads.one.length_1', 9.0, 'cannot close at any input', 'dyads.one'),
        ('dyads.two.length_1', 9.0, 'at which those before it do', 'dyads.two'),
        ('dyads.one.mode', 3, 'must lie in [1, 2]'),
        ('dyads.one.lenght_1', 1.0, 'did you mean length_1'),
        ('dyads.1.kind', 'RRR', 'not a valid dyad name'),
        ('linkage.mode', 1, 'dyads.NAME.mode'),
        ('linkage.a1', 0.4, 'has dyads'),
        ('linkage.output', 'otput', 'did you mean output?'),
        ('linkage.range', ['1mm', '2mm'], 'must be a number in rad'),
        ('bodies.rcoker.mass', 1.0, 'did you mean rocker?', 'bodies.rcoker'),
        ('bodies.output.mass', 1.0, 'must be given', 'bodies.output.inertia'),
        ('external.crnak.couple', 1.0, 'did you mean crank?', 'external.crnak'),
        ('points.tip.link', 'coupelr', 'must be one of crank, coupler'),
        ('joint_names', ['a'], '7 different names'),
        ('linkage.joints', ['a'], 'a machine has linkage.pivot'),
        ({'trajectories': True, 'linkage.output': 'coupler'},
         'the output theta_coupler is of no joint', 'trajectories'),
    ]),
    (read_values('bucket'), [
        ('cylinder.pin.along', 0.0, 'away from O1', 'cylinder.pin'),
        ('cylinder.links', ['rod'], 'two links'),
        ('linkage.range', [9.0, 10.0], 'cannot close anywhere in it'),
    ]),
    (CYLINDER, [
        ('linkage.range', [1.5, 0.9], '(1.5, 0.9): must be [lowest, highest]'),
        ('linkage.range', [1.0], '(1.0,): must be [lowest, highest]'),
        ('linkage.range', [3.0, 4.0], 'cannot close anywhere in it: they do in [-2.8'),
        ('linkage.range', ['a', 'b'], 'must be a number in m'),
        ({**JOINT, 'drive.top_speed': 10.0}, 'a slide has none', 'drive.top_speed'),
    ]),
    (MOTOR, [
        ('motor.free_speed', 0.0, 'must not be zero'),
        ('motor.free_speed', -26.0, 'must have the sign of'),
        ('motor.gear', 0.0, 'must not be zero'),
        ('motor.gear', -1e200, 'must be finite'),
        ('motor.kind', 'stepper', 'must be one of line, dc, '),
        ('motor.kind', 'controller', 'must be given', 'motor.speed'),
        ('shaft.stiffness', 1e5, 'elastic shaft', 'motor.rotor_inertia'),
        ('shaft.damping', 1.0, 'needs shaft.stiffness'),
        ('springs.s.first.link', 'slider', 'must be one of'),
        ('springs.s.stiffness', 1.0, 'must be given', 'springs.s.second.link'),
        ('springs.2s.stiffness', 1.0, 'not a valid spring name'),
        ('springs.s.stifness', 1.0, 'of springs.s; did you mean stiffness?'),
        ('torsion_springs.s.second', 'ground', 'another'),
        ({'linkage.a1': 1.2, 'linkage.a2': 0.4, 'drive.start': 3.1}, 'no motion can start',
         'drive.start'),
        ('drive.budget', 3, 'must lie in [12, 10000]'),
    ]),
    (DC, [
        ('motor.resistance', 0.0, 'must be positive'),
        ('motor.inductance', -1.0, 'must be >= 0'),
    ]),
    (BARS, [
        ('bodies.rods.radius', 0.01, ''),
        ('bodies.rods.width', nan, ''),
        ('bodies.rods.thickness', nan, ''),
        ('bodies.rods.density', nan, ''),
        ('bodies.crank.mass', 1.0, 'must be given', 'bodies.crank.inertia'),
    ]),
]


def refused():
    """Return [(values, name, why)] of all wrong scenes."""
    rows = []
    for good, wrong in TABLE:
        for row in wrong:
            changes, (why, *names) = ((row[0], row[1:]) if isinstance(row[0], dict)
                                      else ({row[0]: row[1]}, row[2:]))
            values = {key: value for key, value in {**good, **changes}.items()
                      if value is not None}
            rows.append((values, (names or list(changes))[0], why))
    return rows


REFUSED = refused()
every = pytest.mark.parametrize('values, name, why', REFUSED, ids=[
    f'{name}-{k}' for k, (_, name, _) in enumerate(REFUSED)])


@every
def test_by_from_values(values, name, why):
    with pytest.raises(InvalidParameter) as caught:
        scene.from_values(values)
    said = str(caught.value)
    assert caught.value.name == name and said.startswith(name) and why in said
    assert '\n' not in said and len(said) <= LONGEST, said


@every
def test_by_scene_check(values, name, why, tmp_path, capsys):
    assert main(['scene', 'check', str(file_of(values, tmp_path))]) == 1
    out, err = capsys.readouterr()
    assert (out, err.count('\n')) == ('', 1)
    assert err.startswith(f'fourbar: {name}') and why in err
