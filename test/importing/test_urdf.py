# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Loops of URDF: one small file for each way of saying where it is cut, beside MuJoCo."""
import io
import re
import sys

from fourbar_ros.cli.main import main
from fourbar_ros.description import describe
from fourbar_ros.importing.files import import_file, Wishes
from fourbar_ros.importing.robots import Refused
from fourbar_ros.mechanisms.curves import point_of
from fourbar_ros.scene.base import rotation_of
from fourbar_ros.scene.files import read_values
from fourbar_ros.scene.scene import from_values
import numpy as np
import pytest

# A four-bar O1 (0, 0), A (0, 0.4), B (0.9, 0.7), O4 (1, 0) in x-z of its base, y along -z.
LINK = """
  <link name="{name}"><inertial><origin xyz="{cg}" rpy="0 0.3 0"/><mass value="{mass}"/>
    <inertia ixx="0.04" iyy="0.05" izz="0.03" ixy="0.001" ixz="0.002" iyz="0"/></inertial>
  </link>"""
JOINT = """
  <joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>
    <origin xyz="{xyz}" rpy="{rpy}"/><axis xyz="{axis}"/></joint>"""
MOTOR = '<transmission name="t"><joint name="shoulder"/></transmission>'
FRAMES = '<link name="{0}"/><link name="{1}"/>' + JOINT.format(
    name='of_{0}', kind='fixed', parent='link', child='{0}', xyz='0.9 0 0.3', rpy='0 0 0',
    axis='0 0 0') + JOINT.format(name='of_{1}', kind='fixed', parent='lever', child='{1}',
                                 xyz='-0.1 0 0.7', rpy='0 0 0', axis='0 0 0')
CONSTRAINT = """
  <constraint name="tip" type="revolute"><parent link="link"/><parent_origin xyz="0.9 0 0.3"/>
    <parent_axis xyz="0 1 0"/><child link="lever"/><child_origin xyz="-0.1 0 0.7"/>
    <child_axis xyz="0 1 0"/></constraint>"""
GAZEBO = """
  <gazebo><joint name="tip" type="revolute"><parent>link</parent><child>lever</child>
    <pose>-0.1 0 0.7 0.2 0.1 0</pose><axis><xyz>{axis}</xyz>{frame}</axis></joint></gazebo>"""


def robot(closing=CONSTRAINT, motor=MOTOR, pivot='0 1 0', more=''):
    """Return the URDF of the four-bar, its pivot's link turned about y."""
    def joint(name, parent, child, xyz, axis='0 1 0'):
        return JOINT.format(name=name, kind='continuous', parent=parent, child=child, xyz=xyz,
                            rpy='0 0 0', axis=axis)
    return ('<robot name="robot"><link name="frame"/>'
            + ''.join(LINK.format(name=name, cg=cg, mass=mass) for name, cg, mass in (
                ('arm', '0.03 0 0.2', 2), ('link', '0.4 0.02 0.1', 1), ('lever', '-0.1 0 0.3', 3)))
            + joint('shoulder', 'frame', 'arm', '0 0 0') + joint('elbow', 'arm', 'link', '0 0 0.4')
            + joint('pivot', 'frame', 'lever', '1 0 0', pivot) + closing + motor + more
            + '</robot>')


def read(tmp_path, text, **wishes):
    path = tmp_path / 'urdf' / 'robot.urdf'
    path.parent.mkdir(exist_ok=True)
    path.write_text(text)
    return import_file(path, Wishes(**wishes))


def good(tmp_path, text, **wishes):
    """Return the only loop, with the report, after it agreed with MuJoCo."""
    pytest.importorskip('mujoco', reason='mujoco is not installed')
    result = read(tmp_path, text, check=True, **wishes)
    report = '\n'.join(result.report)
    assert result.is_good and len(result.loops) == 1, report
    (checked,) = result.checks
    assert checked.joint < 1e-12 and checked.drive < 1e-9 and checked.peak > 1.0, report
    values = result.loops[0].values
    assert [values['dyads.d1.length_1'], values['dyads.d1.length_2']] == pytest.approx(
        [np.hypot(0.9, 0.3), np.hypot(0.1, 0.7)], rel=1e-14)
    return result.loops[0], report


@pytest.mark.parametrize('closing, wishes', [
    (CONSTRAINT, {}),
    (GAZEBO.format(axis='0 1 0', frame='<use_parent_model_frame>1</use_parent_model_frame>'), {}),
    (FRAMES.format('closing_tip_1', 'closing_tip_2'), {}),
    (FRAMES.format('closedloop1_A', 'closedloop1_B'), {}),
    (FRAMES.format('rod_end', 'ball'), {'close': ['rod_end,ball']}),
    ('', {'close': ['link@0.9/0/0.3,lever@-0.1/0/0.7']}),
], ids=['constraint', 'gazebo', 'ours', "Gepetto's", 'frames', 'points'])
def test_a_loop_is_read_however_it_is_stated(closing, wishes, tmp_path):
    loop, report = good(tmp_path, robot(closing), **wishes)
    assert 'base frame, driven shoulder, dyads RRR' in report
    assert 'URDF has no gravity: taken as 9.80665' in report
    assert len(loop.scene.joint_states.leave_out) == 1


def test_axes_that_are_not_parallel_are_said_without_mujoco_too(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, 'mujoco', None)
    assert read(tmp_path, robot()).is_good
    result = read(tmp_path, robot(pivot='0 1 0.005'))
    assert not result.is_good and result.report[-1] == (
        '  warning: the axes, which are not parallel, are taken as parallel: not compared: '
        'import --check requires mujoco: pip install mujoco')


@pytest.mark.parametrize('gravity', [(9.8, 0.0, 0.0), (-9.8, 0.0, 0.0), (-9.8, 1.0, 1e-9),
                                     (0.0, 0.0, 9.8), (3.0, 0.0, -4.0)])
def test_the_frame_is_right_where_x_of_the_scene_is_z_of_the_robot(gravity, tmp_path):
    """Pitch 90 degrees: roll and yaw were those of rounding, the plane a quarter turn off."""
    scene = read(tmp_path, robot(), gravity=gravity).loops[0].scene
    motion = scene.linkage.motion(scene.drive.start, 0.0, 0.0)
    turned = np.array(rotation_of(scene.frame.rpy)).T
    elbow = 0.4 * np.cos(motion.theta_crank), 0.4 * np.sin(motion.theta_crank)
    pivot = scene.values['dyads.d1.second.along'], scene.values['dyads.d1.second.across']
    for point, there in ((elbow, (0.0, 0.0, 0.4)), (pivot, (1.0, 0.0, 0.0))):
        assert scene.frame.xyz + turned @ [*point, 0.0] == pytest.approx(there, abs=1e-15)


def test_scenes_are_written_before_a_report_that_the_output_cannot_take(tmp_path, monkeypatch):
    read(tmp_path, robot().replace('"elbow"', '"\u010c"'))
    monkeypatch.setattr(sys, 'stdout', io.TextIOWrapper(io.BytesIO(), encoding='cp1252'))
    assert main(['import', str(tmp_path / 'urdf' / 'robot.urdf'), '-o',
                 str(tmp_path / 'scene.yaml')]) == 1
    assert '\u010c' in read_values(tmp_path / 'scene.yaml')['joint_names']


def test_gravity_is_three_finite_numbers_in_any_unit(tmp_path, capsys):
    read(tmp_path, robot())
    command = ['import', str(tmp_path / 'urdf' / 'robot.urdf'), '--gravity']
    out = ['-o', str(tmp_path / 'scene.yaml')]
    assert main([*command, '-9810mm/s^2,0,0.5', *out]) == 0
    gravity = from_values(read_values(tmp_path / 'scene.yaml')).linkage.gravity
    assert np.hypot(*gravity) == pytest.approx(np.hypot(9.81, 0.5), rel=1e-15)
    capsys.readouterr()
    for wrong in ('0,0', '0,0,nan', '0,0,inf', '1,2,3kg'):
        with pytest.raises(SystemExit):
            main([*command, wrong])
        assert capsys.readouterr().err.count('\n') == 1


def test_a_loop_closed_at_points_is_described_and_read_again(tmp_path):
    """The frames of its cut, called after the point, were taken for points of a link."""
    points = 'link@0.9/0/0.3,lever@-0.1/0/0.7'
    loop, _ = good(tmp_path, robot(''), close=[points])
    again, _ = good(tmp_path, describe(loop.scene, 'urdf'))
    assert again.scene.joint_states.leave_out == loop.scene.joint_states.leave_out
    assert again.values['dyads.d1.length_1'] == pytest.approx(loop.values['dyads.d1.length_1'])


def test_an_inertia_in_turned_axes_is_as_in_mjcf(tmp_path):
    """The rpy of a URDF is left out by MuJoCo up to 3.12: --check was BAD by 4e-4 of the peak."""
    import mujoco
    turned, about = (0.4, -0.3, 1.2), (0.5, 0.9, -1.0)
    pad = LINK.format(name='pad', cg='0.1 0.02 0.05', mass=0.7).replace(
        'rpy="0 0.3 0"', 'rpy="{} {} {}"'.format(*about)) + JOINT.format(
            name='pad_joint', kind='fixed', parent='lever', child='pad', xyz='0.2 0.1 0.3',
            rpy='{} {} {}'.format(*turned), axis='0 0 0')
    loop, _ = good(tmp_path, robot(more=pad))
    # the same by MuJoCo's MJCF, which states principal moments and euler angles
    moments, axes = np.linalg.eigh([[0.04, 0.001, 0.002], [0.001, 0.05, 0.0], [0.002, 0.0, 0.03]])
    axes[:, 0] *= np.sign(np.linalg.det(axes))
    quaternion = np.zeros(4)
    mujoco.mju_mat2Quat(quaternion, (np.array(rotation_of(about)).T @ axes).ravel())
    model = mujoco.MjModel.from_xml_string(
        '<mujoco><compiler angle="radian" eulerseq="XYZ"/><worldbody><body euler="{} {} {}">'
        '<freejoint/><inertial mass="0.7" pos="0 0 0" quat="{} {} {} {}" diaginertia="{} {} {}"/>'
        '</body></worldbody></mujoco>'.format(*turned, *quaternion, *moments))
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    to_root = data.ximat[1].reshape(3, 3)
    expected = to_root @ np.diag(model.body_inertia[1]) @ to_root.T
    assert loop.loop.robot.inertials['pad'].inertia == pytest.approx(expected, abs=1e-15)


def test_moments_of_inertia_of_no_body_and_lengths_in_millimetres_are_said(tmp_path):
    """Of the first, and of a rod without a moment about its axis, MuJoCo takes none."""
    assert 'moments' not in good(tmp_path, robot())[1]
    wrong = read(tmp_path, robot().replace('izz="0.03"', 'izz="0.1"'), check=True)
    assert 'moments of inertia of arm, link, lever: the largest' in wrong.report[1]
    assert wrong.is_good and wrong.checks[0].drive < 1e-10
    rods = re.sub('ixx=.* iyz="0"', 'ixx="0.03" iyy="0.03" izz="0" ixy="0" ixz="0" iyz="0"',
                  robot())
    assert read(tmp_path, rods, check=True).is_good
    in_mm = read(tmp_path, re.sub('xyz="(?!0 1 0)([^"]*)"', lambda xyz: 'xyz="{} {} {}"'.format(
        *(1000.0 * float(value) for value in xyz[1].split())), robot()))
    assert 'm: did you mean' in in_mm.report[-1], in_mm.report


@pytest.mark.parametrize('text, words', [
    ('', 'must be "independent", a list of joints, and "closures"'), ('a: [', 'must be "indep'),
    ('closures: [{link_a: link, link_b: lever, point: [0, 0, 0]}]', 'must be "independent"'),
    ('closures: [{link_a: link, link_b: lever, point: [0.9, 0], axis: [0, 1, 0]}]',
     "'0.9 0' for point in .*loop_closures.yaml: must be 3 numbers$")])
def test_loop_closures_that_are_none_are_refused_in_a_line(text, words, tmp_path):
    (tmp_path / 'urdf').mkdir()
    (tmp_path / 'urdf' / 'loop_closures.yaml').write_text(text)
    with pytest.raises(Refused, match=words):
        read(tmp_path, robot(''))


def test_loop_closures_of_jsk_are_read_beside_the_file(tmp_path):
    (tmp_path / 'config').mkdir()
    (tmp_path / 'config' / 'loop_closures.yaml').write_text(
        'independent: [shoulder]\ndependent: [elbow, pivot]\nclosures:\n'
        '- {link_a: link, link_b: lever, point: [0.9, 0.0, 0.7], axis: [0.0, 1.0, 0.0]}\n')
    _, report = good(tmp_path, robot('', motor=''), at={'shoulder': '10', 'elbow': '-10'})
    assert 'closed at link~lever' in report and 'driven shoulder' in report


@pytest.mark.parametrize('encoding', ['utf-16', 'utf-8-sig'])
def test_files_may_be_in_the_utf_16_of_powershell(encoding, tmp_path):
    head = '<?xml version="1.0" encoding="utf-8"?>\n'
    files = {'robot.urdf': head + robot(), 'loop_closures.yaml': 'independent: []\nclosures: []\n'}
    texts = []
    for folder, codec in (('plain', 'utf-8'), ('windows', encoding)):
        for name, text in files.items():
            (tmp_path / folder).mkdir(exist_ok=True)
            (tmp_path / folder / name).write_bytes(text.replace('\n', '\r\n').encode(codec))
        texts.append(import_file(tmp_path / folder / 'robot.urdf').text)
    assert 'linkage' in texts[0] and texts[0] == texts[1]


def test_a_fixed_pair_of_frames_joins_two_parts(tmp_path):
    end = LINK.format(name='end', cg='0 0 0', mass=0.1) + JOINT.format(
        name='wrist', kind='continuous', parent='link', child='end', xyz='0.9 0 0.3',
        rpy='0 0 0', axis='0 1 0')
    loop, _ = good(tmp_path, robot('', more=end), close=['end,lever@-0.1/0/0.7:fixed'])
    assert loop.scene.joint_names == ('shoulder', 'elbow', 'wrist', 'pivot')


def test_the_drive_may_stand_in_ros2_control_and_the_pose_in_a_group_state(tmp_path):
    motor = ('<ros2_control name="r" type="system"><joint name="elbow"><state_interface '
             'name="position"/></joint><joint name="shoulder"><command_interface '
             'name="position"/></joint></ros2_control>')
    pose = ('<group_state name="up"><joint name="shoulder" value="0.1"/>'
            '<joint name="elbow" value="-0.1"/></group_state>')
    loop, _ = good(tmp_path, robot(motor=motor, more=pose), key='up')
    assert loop.drive.position == 0.1


def test_a_negative_axis_is_a_ratio_of_minus_one(tmp_path):
    loop, _ = good(tmp_path, robot(pivot='0 -1 0'))
    assert loop.scene.joint_states.ratios == [1.0, 1.0, 1.0, -1.0]


TIP = (LINK.format(name='tip-1', cg='0 0 0', mass=0.25) + JOINT.format(
    name='mount', kind='fixed', parent='link', child='tip-1', xyz='0.5 0.1 0.6', rpy='0 0 0',
    axis='0 0 0'))
SECOND = JOINT.format(name='elbow', kind='continuous', parent='arm', child='link', xyz='0 0 0.5',
                      rpy='0 0 0', axis='0 1 0')
MIMIC = JOINT.format(name='pad', kind='revolute', parent='lever', child='foot', xyz='0 0 0',
                     rpy='0 0 0', axis='0 1 0').replace('</joint>',
                                                        '<mimic joint="pivot"/></joint>')


@pytest.mark.parametrize('text, wishes, words', [
    (robot(''), {}, 'no closed loop in the file; name the frames that coincide by --close A,B$'),
    (robot('', more='<link name="foot"/>' + MIMIC), {}, 'it has 1 mimic or gear joints .pad., '
     'which are none; name the frames'),
    (robot(motor=''), {}, 'does not say which joint of this loop is driven: give --drive, as of '
     'shoulder, pivot'),
    (robot().replace('<robot', '<robot xmlns:xacro="http://ros.org/wiki/xacro"'), {},
     'is xacro: write its URDF first'),
    (robot(more='<link name="lost"/>'), {}, 'has 2 roots, frame, lost'),
    ('<robot name="none"/>', {}, 'robot.urdf: has no <link>$'),
    (robot(''), {'close': ['rod,ball']}, '--close rod: the file has no such link'),
    (robot(''), {'close': ['link:fixed']}, 'must be FRAME,FRAME or FRAME,FRAME:fixed'),
    (robot(''), {'close': ['link@0.9/0.1/0.3,lever@-0.1/0/0.7']}, 'not planar: the points of .* '
     "are 0.1 m apart square to the plane, above 0.001 m, 0.001 of the loop's size$"),
    (robot('', more=TIP), {'close': ['link@0/0/0.1,tip-1']}, 'no closed loop in the file; '
     'link@0/0/0.1 closes no loop: link and tip-1 are one link; name the frames'),
    (robot(GAZEBO.format(axis='1 0 0', frame='')), {}, 'not planar: tip is .* degrees off'),
    (robot('', more=LINK.format(name='end', cg='0 0 0', mass=0.1) + JOINT.format(
        name='wrist', kind='continuous', parent='link', child='end', xyz='0.9 0 0.3', rpy='0 0 0',
        axis='0 1 0')), {'close': ['end,lever:fixed']},
     'the weld end is open by .* m and 0 degrees: give a pose that closes it by --at or --key'),
    (robot('', more=LINK.format(name='rod', cg='0 0 0', mass=0.1) + JOINT.format(
        name='ball', kind='ball', parent='link', child='rod', xyz='0.9 0 0.3', rpy='0 0 0',
        axis='0 1 0')), {'close': ['rod@0/0/0.1,lever@-0.1/0/0.8']}, 'rod is a rod on balls'),
    (robot(), {'key': 'up'}, '--key up: the file has no such group_state'),
    (robot(), {'at': {'knee': '1'}}, '--at knee: the file has no such joint'),
    (robot().replace('"0 0 0.4"', '"0 O 0.4"'), {}, "'0 O 0.4' in the URDF: must be 3 numbers$"),
    (robot(CONSTRAINT.replace('"link"', '"lnk"')), {},
     'constraint tip: its parent lnk is no link of the file; did you mean link[?]$'),
    (robot(CONSTRAINT.replace('<child link="lever"/>', '')), {}, 'constraint tip has no child; '),
    (robot(GAZEBO.replace('>lever<', '>levr<').format(axis='0 1 0', frame='')), {},
     'joint tip in gazebo: its child levr is no link of the file; did you mean lever[?]$'),
    (robot().replace('<child link="arm"/>', '<child link="arms"/>'), {},
     'joint shoulder: its child arms is no link of the file; did you mean arm[?]$'),
    (robot().replace('"0 0 0.4"', '"0 0.4"'), {}, "'0 0.4' in the URDF: must be 3 numbers$"),
    (robot().replace('"0 0 0.4"', '"0 nan 0.4"'), {}, 'must be 3 numbers$'),
    (robot().replace('mass value="2"', 'mass value=""'), {},
     "'' for value of mass in arm: must be 1 number$"),
    (robot().replace('ixx="0.04"', '', 1), {},
     "'' for ixx of inertia in arm: must be 1 number$"),
    (robot(more=LINK.format(name='arm', cg='0 0 0', mass=9)), {}, "two links are called 'arm'$"),
    (robot(CONSTRAINT.replace('tip', 'elbow')), {}, "two joints are called 'elbow'$"),
    (robot(more=SECOND), {}, "two joints are called 'elbow'$"),
    (robot(more=SECOND.replace('elbow', 'knee')), {}, 'link is the child of elbow and of knee, '
     'and URDF is a tree: close the loop by frames that coincide .--close.$'),
    (robot().replace('name="pivot" type="continuous"', 'name="pivot" type="continous"'), {},
     "joint pivot: type 'continous'; did you mean continuous[?]$"),
    (robot(CONSTRAINT.replace('revolute', 'prismatc')), {},
     "joint tip: type 'prismatc'; did you mean prismatic[?]$"),
    (robot().replace('name="pivot" type="continuous"', 'name="pivot" type="planar"'), {},
     'pivot is a free joint inside the loop$'),
    (robot(pivot='0 0 0'), {}, 'pivot: its axis is 0 0 0$'),
    (robot(GAZEBO.format(axis='0 0 0', frame='')), {}, 'tip: its axis is 0 0 0$'),
    (robot().replace('name="shoulder" type="continuous">', 'name="shoulder" type="revolute">'
                     '<limit lower="1" upper="-1"/>'), {},
     'shoulder: its lower limit, 1, is above the upper, -1$'),
    (robot(''), {'close': ['link,lever@0/0.004']},
     "'0 0.004' of --close lever@0/0.004: must be 3 numbers$"),
    (robot().replace('mass value="2"', 'mass value="-2"'), {}, 'arm has a negative mass, -2 kg$'),
    (robot().replace('iyy="0.05"', 'iyy="-0.05"', 1), {}, 'arm has a negative moment of inertia, '
     '-0.05.* kg m.2 about a principal axis$'),
    (robot(more='<group_state name="up"><joint name="elbo" value="1"/></group_state>'),
     {'key': 'up'}, 'group_state up: joint elbo: .* no such joint; did you mean elbow[?]$'),
    (robot()[:-9], {}, 'is no XML'),
    ('<sdf/>', {}, 'is SDF, which is not read: take the URDF or MJCF of the robot'),
    ('#usda 1.0', {}, 'is neither MJCF nor URDF'),
])
def test_a_refusal_is_a_line_that_says_what_would_help(text, wishes, words, tmp_path):
    try:
        line = read(tmp_path, text, **wishes).report[-1]
    except Refused as error:
        line = str(error)
    assert re.search(words, line), line
    assert '\n' not in line


@pytest.mark.parametrize('kind', ['fixed', 'continuous', 'revolute'])
def test_what_no_scene_follows_from_may_be_wrong_or_lack(kind, tmp_path):
    """Limits of other joints than the drive; products of inertia, which are 0."""
    end = LINK.format(name='end', cg='0 0 0', mass=1) + JOINT.format(
        name='wrist', kind=kind, parent='frame', child='end', xyz='0 0 0', rpy='0 0 0',
        axis='0 1 0')
    turned = end.replace('</joint>', '<limit lower="1" upper="-1"/></joint>')
    text = robot(more=turned).replace(' iyz="0"', '')
    assert read(tmp_path, text, check=True).is_good
    assert read(tmp_path, text).text == read(tmp_path, robot(more=end)).text


def test_a_frame_that_closes_a_loop_may_be_called_as_its_joint(tmp_path):
    frames = FRAMES.format('near', 'far').replace('of_near', 'near')
    loop, _ = good(tmp_path, robot('', more=frames), close=['near,far'])
    assert list(loop.scene.joint_states.leave_out) == ['near_closing']


@pytest.mark.parametrize('kind', ['screw', 'gearbox'])
def test_a_screw_in_gazebo_beside_a_loop_is_a_note(kind, tmp_path):
    screw = ('<gazebo><joint name="nut" type="KIND"><parent>arm</parent><child>lever</child>'
             '<thread_pitch>3141.6</thread_pitch></joint></gazebo>').replace('KIND', kind)
    result = read(tmp_path, robot(more=screw), check=True)
    assert result.is_good and f' note: joint nut in gazebo is a {kind}: left out' in result.report


def test_motors_and_mimics_of_joints_that_are_not_there_are_notes(tmp_path):
    result = read(tmp_path, robot(motor=MOTOR.replace('shoulder', 'shoulde')).replace(
        'name="pivot" type="continuous">', 'name="pivot" type="continuous"><mimic joint="elbo"/>'))
    assert (' note: transmission of shoulde: the file has no such joint; did you mean shoulder?'
            in result.report)
    assert (' note: mimic of pivot: the file has no joint elbo; did you mean elbow?: left out'
            in result.report)


def test_a_light_robot_is_as_good_beside_mujoco(tmp_path):
    """Frames without mass have 2e-15 kg in MuJoCo: nothing beside links of milligrams."""
    pytest.importorskip('mujoco', reason='mujoco is not installed')
    text = robot(FRAMES.format('closing_tip_1', 'closing_tip_2'))
    for mass in '123':
        text = text.replace(f'mass value="{mass}"', f'mass value="{mass}e-6"')
    # principal ones, as MuJoCo leaves others of less than 1e-12 kg m^2 in its axes
    text = re.sub('(i..)="(0.0[345])"', r'\1="\2e-6"', text)
    text = re.sub('(i..)="0.00[12]"', r'\1="0"', text)
    (checked,) = read(tmp_path, text, check=True).checks
    assert checked.is_good and checked.peak < 1e-4
    # the weight of both frames at the arm of the lever [N m], and differences of fourth order
    assert checked.drive * checked.peak < 2 * 2e-15 * 9.80665 * 1.0 + 1e-9 * checked.peak


@pytest.mark.parametrize('turn', (0.0, 0.1))
def test_a_fixed_frame_is_a_point_and_a_payload_there_is_its_weight(turn, tmp_path):
    loop, report = good(tmp_path, robot(FRAMES.format('closing_a_1', 'closing_a_2'), more=TIP),
                        at={'shoulder': f'{turn}rad', 'elbow': f'{-turn}rad',
                            'pivot': f'{turn * 0.4}rad'})
    scene, robot_ = loop.scene, loop.loop.robot
    assert [*scene.points] == ['tip_1'] and 'points' in scene.outputs
    assert 'tip-1 is part of link' in report and 'arm is called crank' in report
    assert 'point tip_1 on link, the frame tip-1 of the file' in report
    assert 'x of the scene is -x of frame, y is +z' in report
    # the link's frame, from the scene's joints and by trigonometry: the tip is where both say
    point = scene.points['tip_1']
    motion = scene.linkage.motion(scene.drive.start, 0.0, 0.0)
    x, y = point_of(scene.linkage.link_motion(motion, 'link'), point.along, point.across)[:2]
    angles = {name: ratio * getattr(motion, joint.coordinate.position) + offset
              for name, joint, ratio, offset in zip(
                  scene.joint_names, scene.linkage.JOINTS, scene.joint_states.ratios,
                  scene.joint_states.offsets)}
    arm, link = angles['shoulder'], angles['shoulder'] + angles['elbow']
    there = (0.4 * np.sin(arm) + 0.5 * np.cos(link) + 0.6 * np.sin(link),
             0.4 * np.cos(arm) - 0.5 * np.sin(link) + 0.6 * np.cos(link))
    assert (-x, y) == pytest.approx(there, abs=1e-14)
    assert robot_.frames.keys() == {'tip-1'}
    # 0.25 kg at the tip more: as a force there, and as a mass in the file; both at rest
    weight = from_values({**loop.values, 'external.link.along': point.along,
                          'external.link.across': point.across,
                          'external.link.force_y': -0.25 * 9.80665})
    (heavier,) = read(tmp_path, robot(FRAMES.format('closing_a_1', 'closing_a_2'),
                                      more=TIP.replace('"0.25"', '"0.5"')),
                      at={'shoulder': f'{turn}rad', 'elbow': f'{-turn}rad',
                          'pivot': f'{turn * 0.4}rad'}).loops
    position = scene.drive.start - 0.5          # where the tip is far from its highest
    held = weight.linkage.step(position, 0.0, 0.0)[1].driving_torque
    assert held == pytest.approx(
        heavier.scene.linkage.step(position, 0.0, 0.0)[1].driving_torque, rel=1e-12)
    assert abs(held - scene.linkage.step(position, 0.0, 0.0)[1].driving_torque) > 0.1


@pytest.mark.parametrize('ends', (('is_closed_by', 'closes'), ('closing_finger', 'closing_arm'),
                                  ('pin', 'hole')))
def test_without_a_loop_the_frames_that_coincide_are_proposed(ends, tmp_path):
    with pytest.raises(Refused, match=f'of {ends[0]}, {ends[1]}: --close {",".join(ends)} are '
                                      r"\S+ m apart in the file's pose$"):
        read(tmp_path, robot(FRAMES.format(*ends), more=TIP))


def test_a_mode_against_the_pose_is_a_warning_with_both_openings(tmp_path):
    result = read(tmp_path, robot(), mode={'d1': 2})
    line = next(line for line in result.report if 'warning' in line)
    assert re.search('--mode d1=2 turns links by 1[0-9][0-9] degrees from the file.s pose, '
                     'mode 1 by [0-9.e-]+$', line), line
    assert not any('warning' in line for line in read(tmp_path, robot(), mode={'d1': 1}).report)


def test_a_check_says_the_drive_with_its_unit_and_where_its_peak_is(tmp_path):
    _, report = good(tmp_path, robot())
    assert re.search(r'drive within \S+ N m, \S+ of its peak \S+ N m at shoulder = \S+ rad$',
                     report), report


def test_a_pose_outside_the_range_says_how_the_joint_counts(tmp_path, capsys):
    result = read(tmp_path, robot().replace(
        'name="shoulder" type="continuous">', 'name="shoulder" type="revolute">'
        '<limit lower="-0.1" upper="0.1"/>', 1))
    path = tmp_path / 'scene.yaml'
    path.write_text(result.text)
    assert main(['show', str(path), '--at', '-60']) == 1
    said = ' '.join(capsys.readouterr().err.split())
    offset = np.degrees(result.loops[0].scene.drive.joint_offset)
    assert f'; joint shoulder = 1 * theta_crank + ({offset:.4f} deg)' in said, said
