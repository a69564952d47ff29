# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Loops of MJCF: one small file for each way of stating one, beside MuJoCo; all refusals."""
import re

from fourbar_ros.importing.files import import_file, Wishes
from fourbar_ros.importing.robots import Refused
from fourbar_ros.scene.base import rotation_of
from fourbar_ros.scene.scene import load
import numpy as np
import pytest

pytest.importorskip('mujoco', reason='mujoco is not installed')

# A four-bar O1 (0, 0), A (0, 0.4), B (0.9, 0.7), O4 (1, 0) in the x-y plane of its frame.
ARM = """
      <body name="arm">
        <joint name="shoulder" axis="0 0 1"/>
        <inertial mass="2" pos="0.03 0.2 0" diaginertia="0.02 0.03 0.04"/>
        <body name="link" pos="0 0.4 0">
          <joint name="elbow" axis="0 0 1"/>
          <inertial mass="1" pos="0.4 0.1 0.01" diaginertia="0.03 0.03 0.05"/>{on_link}
        </body>
      </body>"""
LEVER = """
      <body name="lever" pos="1 0 0">
        <joint name="pivot" axis="{axis}"/>
        <inertial mass="3" pos="-0.1 0.3 0" diaginertia="0.05 0.05 0.1"/>{on_lever}
      </body>"""
ROBOT = """
<mujoco>
  <compiler angle="radian"/>
  <option gravity="0 0 -9.81"/>
  <worldbody>
    <body name="frame" pos="0.2 -0.3 0.5" euler="{euler}">""" + ARM + LEVER + """
    </body>{more}
  </worldbody>
  <equality>{equality}</equality>
  <actuator>{motor}</actuator>
</mujoco>"""
CONNECT = '<connect name="tip" body1="link" body2="lever" anchor="0.9 0.3 0"/>'
MOTOR = '<motor joint="shoulder"/>'
STANDING = '1.5707963267948966 0 0'                       # the frame's y is up
EXACT, DRIVE = 1e-12, 1e-9                                # [rad or m], share of the peak


def robot(**changes):
    """Return the MJCF of the four-bar, with changes."""
    return ROBOT.format(**{
        'euler': STANDING, 'axis': '0 0 1', 'on_link': '', 'on_lever': '', 'more': '',
        'equality': CONNECT, 'motor': MOTOR} | changes)


def read(tmp_path, text, **wishes):
    path = tmp_path / 'robot.xml'
    path.write_text(text)
    return import_file(path, Wishes(**wishes))


def good(tmp_path, text, **wishes):
    """Return the only loop, with the report, after it agreed with MuJoCo."""
    result = read(tmp_path, text, check=True, **wishes)
    report = '\n'.join(result.report)
    assert result.is_good and len(result.loops) == 1, report
    (checked,) = result.checks
    assert checked.joint < EXACT and checked.drive < DRIVE and checked.peak > 1.0, report
    return result.loops[0], report


def test_a_connect_closes_a_four_bar(tmp_path):
    loop, report = good(tmp_path, robot())
    scene = loop.scene
    assert 'base frame, driven shoulder, dyads RRR' in report
    assert 'masses on 3 of 3 links' in report and 'axes parallel within 0 degrees' in report
    assert scene.joint_names == ('shoulder', 'elbow', 'tip', 'pivot')
    assert scene.joint_states.leave_out == ['tip'] and scene.joint_states.only_passive
    sizes = scene.values
    assert sizes['dyads.d1.length_1'] == pytest.approx(np.hypot(0.9, 0.3), rel=1e-15)
    assert sizes['dyads.d1.length_2'] == pytest.approx(np.hypot(0.1, 0.7), rel=1e-15)
    assert sizes['gravity.y'] == pytest.approx(-9.81, rel=1e-15)
    assert abs(sizes['gravity.x']) < 1e-14


def test_bodies_and_joints_need_no_names(tmp_path):
    """Beside MuJoCo it was a KeyError."""
    named, _ = good(tmp_path, robot())
    loop, _ = good(tmp_path, robot().replace(' name="elbow"', ''))
    assert loop.scene.joint_names == ('shoulder', 'joint_1', 'tip', 'pivot')
    assert loop.scene.linkage == named.scene.linkage
    text = robot().replace(' name="elbow"', '').replace('"shoulder"', '"joint_1"')
    loop, _ = good(tmp_path, text)
    assert loop.scene.joint_names == ('joint_1', 'joint_2', 'tip', 'pivot')


def test_a_file_may_be_in_the_utf_16_of_powershell(tmp_path):
    plain, path = read(tmp_path, robot()).text, tmp_path / 'robot.xml'
    path.write_bytes(('<?xml version="1.0" encoding="utf-8"?>\n' + robot()).encode('utf-16'))
    assert 'linkage' in plain and import_file(path).text == plain


@pytest.mark.parametrize('encoding', ['utf-8', 'utf-16'])
def test_what_a_file_includes_may_be_in_any_encoding(encoding, tmp_path):
    plain, head = read(tmp_path, robot()), '<?xml version="1.0" encoding="utf-8"?>\n'
    begin, world, end = re.split('(<worldbody>.*</worldbody>)', robot(), flags=re.DOTALL)
    (tmp_path / 'parts').mkdir()
    for name, text in (('robot.xml', f'{begin}<include file="parts/outer.xml"/>{end}'),
                       ('parts/outer.xml', '<mujoco><include file="parts/world.xml"/></mujoco>'),
                       ('parts/world.xml', f'<mujocoinclude>{world}</mujocoinclude>')):
        (tmp_path / name).write_bytes((head + text).encode(encoding))
    assert import_file(tmp_path / 'robot.xml').text == plain.text and plain.loops
    (tmp_path / 'parts/world.xml').write_text('<mujoco><include file="parts/outer.xml"/></mujoco>')
    with pytest.raises(Refused, match='outer.xml is included twice'):
        import_file(tmp_path / 'robot.xml')


@pytest.mark.parametrize('euler', ('0 0 0', '0.3 -1.1 2.0', '1.5707963267948966 0 0', '0 1 0'))
def test_the_plane_lies_wherever_it_is(euler, tmp_path):
    import mujoco
    text = robot(euler=euler)
    result = read(tmp_path, text, check=True)
    assert result.is_good and result.checks[0].joint < EXACT
    scene = result.loops[0].scene
    # A in the frame of the robot, by MuJoCo and by the scene with its frame
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    assert scene.frame.parent == 'frame'
    turned = data.body('frame').xmat.reshape(3, 3)
    there = turned.T @ (data.body('link').xpos - data.body('frame').xpos)
    angle = scene.linkage.motion(scene.drive.start, 0.0, 0.0).theta_crank
    ours = scene.frame.xyz + np.array(rotation_of(scene.frame.rpy)).T @ [
        0.4 * np.cos(angle), 0.4 * np.sin(angle), 0.0]
    assert np.max(np.abs(ours - there)) < 1e-15
    square = abs(9.81 * (turned.T @ [0, 0, 1])[2])
    said = 'square to the plane, which the pins bear' in '\n'.join(result.report)
    assert said == (square > 1e-6)


def test_an_equality_may_have_the_name_of_a_joint(tmp_path):
    loop, report = good(tmp_path, robot(equality=CONNECT.replace('tip', 'elbow')))
    assert loop.scene.joint_names == ('shoulder', 'elbow', 'elbow_equality', 'pivot')
    with pytest.raises(Refused, match='no closed loop in the file'):
        read(tmp_path, robot(equality=CONNECT.replace('tip', 'elbow')), cut=['elbow_equality'])


def flagged(name, **changes):
    return robot(**changes).replace('gravity="0 0 -9.81"/>', f'gravity="0 0 -9.81"><flag {name}='
                                    '"disable"/></option>')


def test_what_the_flags_of_a_file_switch_off_is_off(tmp_path):
    loop, _ = good(tmp_path, flagged('gravity'))
    assert loop.scene.linkage.gravity in (None, (0.0, 0.0))
    loop, _ = good(tmp_path, flagged('gravity'), gravity=(0.0, 0.0, -3.7))
    assert loop.scene.linkage.gravity == pytest.approx((0.0, -3.7), abs=1e-15)
    for flag in ('equality', 'constraint'):
        with pytest.raises(Refused, match='in the file; equality tip is not active: left out$'):
            read(tmp_path, flagged(flag))


def test_what_holds_weight_and_couples_joints_in_other_ways_is_a_note(tmp_path):
    _, report = good(tmp_path, robot(
        equality=CONNECT + '<joint joint1="elbow" joint2="shoulder" polycoef="0 1 1 0 0"/>'
    ).replace('<body name="link"', '<body name="link" gravcomp="1"'))
    assert ' note: left out of the scenes: gravcomp of bodies, which have their weight' in report
    assert ' note: equality elbow~shoulder is of another type: left out' in report


def test_a_negative_axis_is_a_ratio_of_minus_one(tmp_path):
    loop, _ = good(tmp_path, robot(axis='0 0 -1'))
    assert loop.scene.joint_states.ratios == [1.0, 1.0, 1.0, -1.0]


@pytest.mark.parametrize('degrees, said', [(2e-4, ''), (0.02, 'note'), (0.29, 'warning')])
def test_axes_that_are_not_parallel_are_measured_unasked(degrees, said, tmp_path):
    """A drive that was off by 27 % beside a toggle was a note; 1.5708 for pi / 2 is 2e-4."""
    x, z = map(float, (np.sin(np.radians(degrees)), np.cos(np.radians(degrees))))
    text = robot(axis=f'{x!r} 0 {z!r}')
    plain, asked = (read(tmp_path, text, check=check) for check in (False, True))
    assert len(plain.checks) == bool(said) and plain.is_good == asked.is_good == (degrees < 0.1)
    (checked,) = asked.checks
    line = (f'{said}: the axes, which are not parallel, are taken as parallel: {checked}'
            + ('' if asked.is_good else ': BAD'))
    assert (f'  {line}' in plain.report) == (f'# {line}' in plain.text) == bool(said)
    # of a pin that is off by e, what it moves in the plane is off by 1 - cos(e), about e^2 / 2
    tilt = np.radians(degrees)
    assert checked.joint < EXACT + 2.0 * tilt**2


INERTIAL = '<inertial mass="1" pos="0.4 0.1 0.01" diaginertia="0.03 0.03 0.05"/>'
MESH = '<asset><mesh name="m" vertex="0 0 0  0.3 0 0  0 0.3 0  0 0 0.3"/></asset>'
SHAPES = ('<geom type="mesh" mesh="m" {}/>'
          '<geom type="capsule" size="0.02" fromto="0 0 0 0.9 0.3 0" group="3"/>')


@pytest.mark.parametrize('inertial, mesh, compiler, lacking', [
    ('', '', '', 'link'), (INERTIAL, '', '', ''), ('', 'mass="0"', '', ''),
    ('', 'density="0"', '', ''), ('', '', 'inertiagrouprange="3 5"', ''),
    (INERTIAL, '', 'inertiafromgeom="true"', 'link'),
    ('', '', 'settotalmass="5"', 'arm, link, lever')])
def test_a_link_that_lacks_the_mass_of_a_mesh_is_said(inertial, mesh, compiler, lacking, tmp_path):
    import mujoco
    text = robot(on_link=SHAPES.format(mesh)).replace(INERTIAL, inertial, 1).replace(
        '<worldbody>', f'{MESH}<worldbody>').replace('"radian"', f'"radian" {compiler}')
    result, whole = read(tmp_path, text), mujoco.MjModel.from_xml_string(text)
    is_whole = all(
        body.mass == pytest.approx(float(whole.body(name).mass[0]), rel=1e-14)
        for name, body in zip(('arm', 'link', 'lever'), result.loops[0].scene.linkage.bodies))
    report = '\n'.join(result.report)
    assert result.is_good == is_whole == (not lacking)
    assert f'masses on {3 - len(lacking.split())} of 3 links' in report
    assert (f'warning: loads are without the mass of meshes, which are not read, of {lacking}: '
            in report) == bool(lacking)


def test_the_least_mass_and_inertia_of_a_file_are_those_of_its_links(tmp_path):
    loop, _ = good(tmp_path, robot().replace(
        '"radian"', '"radian" boundmass="2.5" boundinertia="0.06"'))
    assert [(body.mass, body.inertia) for body in loop.scene.linkage.bodies] == [
        (2.5, 0.06), (2.5, 0.06), (3.0, 0.1)]


def test_a_connect_that_is_there_twice_is_one(tmp_path):
    """Its axis was that of nothing: a warning of numpy, and refused as not planar."""
    loop, report = good(tmp_path, robot(equality=CONNECT + CONNECT.replace('tip', 'tip2')))
    assert 'loop 1: shoulder, elbow, pivot, tip\n' in report
    assert loop.scene.linkage == good(tmp_path, robot())[0].scene.linkage


@pytest.mark.parametrize('second', ('0.9 0.3 0.1', '0.9 0.3 -0.05'))
def test_two_connects_on_one_axis_are_a_pin(second, tmp_path):
    both = CONNECT + CONNECT.replace('tip', 'tip_z').replace('0.9 0.3 0', second)
    _, report = good(tmp_path, robot(equality=both))
    assert 'loop 1: shoulder, elbow, pivot, tip\n' in report


def test_a_site_and_a_fixed_body_are_points_but_not_the_sites_of_a_connect(tmp_path):
    loop, report = good(tmp_path, robot(
        on_link='<site name="one" pos="0.9 0.3 0"/><site name="2nd tool" pos="0.7 0.5 0.1"/>'
                '<body name="pad" pos="0.5 0.4 0"/><site pos="1 1 0"/>',
        on_lever='<site name="other" pos="-0.1 0.7 0"/>',
        equality='<connect name="tip" site1="one" site2="other"/>'))
    assert loop.scene.points.keys() == {'pad', 'point_2nd_tool'}
    assert ('point point_2nd_tool on link, the frame 2nd tool of the file: 0.1 m beside the plane '
            'of the driven joint, laid into it') in report
    assert 'point pad on link\n' in report
    # from the elbow, along the link to (0.9, 0.3)
    point = loop.scene.points['point_2nd_tool']
    turned = complex(0.7, 0.5) / complex(0.9, 0.3) * abs(complex(0.9, 0.3))
    assert complex(point.along, point.across) == pytest.approx(turned, abs=1e-15)


def test_sites_and_welds_close_loops_too(tmp_path):
    sites = {'on_link': '<site name="one" pos="0.9 0.3 0"/>',
             'on_lever': '<site name="two" pos="-0.1 0.7 0"/>'}
    good(tmp_path, robot(**sites, equality='<connect name="tip" site1="one" site2="two"/>'))
    end = ('<body name="end" pos="0.9 0.3 0"><joint name="wrist" axis="0 0 1"/>'
           '<inertial mass="0.1" pos="0 0 0" diaginertia="1e-3 1e-3 1e-3"/></body>')
    weld = '<weld name="glue" body1="end" body2="lever"/>'
    loop, _ = good(tmp_path, robot(on_link=end, equality=weld))
    assert loop.scene.joint_names == ('shoulder', 'elbow', 'wrist', 'pivot')
    assert loop.scene.joint_states.leave_out == []
    assert loop.scene.linkage.bodies.lever.mass == pytest.approx(3.1)


def test_what_hangs_on_a_link_is_part_of_its_mass(tmp_path):
    pad = ('<body name="pad" pos="0.2 0.7 0"><joint name="flap" axis="1 0 0"/>'
           '<inertial mass="0.5" pos="0 0.1 0" diaginertia="1e-2 1e-2 1e-2"/></body>')
    loop, report = good(tmp_path, robot(on_lever=pad))
    assert 'lever carries, held as in the file: pad' in report
    assert loop.scene.linkage.bodies.lever.mass == pytest.approx(3.5)


KNOB = '<body name="knob"><joint name="knob"/><geom size="0.1"/></body>'


@pytest.mark.parametrize('gear, ratio, offset', [
    ('<joint joint1="shoulder" joint2="knob" polycoef="0.2 -3 0 0 0"/>', -3.0, 0.2),
    ('<joint joint1="knob" joint2="shoulder" polycoef="0.2 -3 0 0 0"/>', -1 / 3, 0.2 / 3)])
def test_a_gear_from_another_motor_drives_the_loop(gear, ratio, offset, tmp_path):
    text = robot(more=KNOB, equality=CONNECT + gear, motor='<motor joint="knob"/>')
    loop, report = good(tmp_path, text)
    assert 'shoulder is geared to knob, which drives the scene' in report
    drive, at_joint = loop.scene.drive, 0.7
    knob = drive.joint_ratio * at_joint + drive.joint_offset
    shoulder = loop.drive.ratio * at_joint + loop.drive.offset
    assert shoulder == pytest.approx(offset + ratio * knob, rel=1e-14)
    assert drive.joint == 'knob' and not loop.scene.joint_states.only_passive


def test_a_gear_counts_from_the_ref_of_its_joints(tmp_path):
    """Beside the residual of MuJoCo's equality: the motor was 1.45 rad off."""
    import mujoco
    gear = '<joint joint1="shoulder" joint2="knob" polycoef="0.2 -3 0 0 0"/>'
    text = robot(more=KNOB.replace('name="knob"/>', 'name="knob" ref="0.4"/>'), equality=gear +
                 CONNECT, motor='<motor joint="knob"/>').replace('r" axis', 'r" ref="0.25" axis')
    loop, _ = good(tmp_path, text)
    model = mujoco.MjModel.from_xml_string(text)
    data, drive, at = mujoco.MjData(model), loop.scene.drive, 0.7
    for name, position in (('knob', drive.joint_ratio * at + drive.joint_offset),
                           ('shoulder', loop.drive.ratio * at + loop.drive.offset)):
        data.qpos[model.joint(name).qposadr] = position
    mujoco.mj_fwdPosition(model, data)
    (residual,) = data.efc_pos[data.efc_id == 0]
    assert abs(residual) < 1e-15


def test_limits_of_the_drive_are_its_range(tmp_path):
    text = robot().replace('"shoulder" axis', '"shoulder" range="-0.3 0.5" limited="true" axis')
    result = read(tmp_path, text, check=True)
    (checked,) = result.checks
    assert result.is_good and (checked.low, checked.high) == pytest.approx((-0.292, 0.492))
    low, high = result.loops[0].values['linkage.range']
    assert (low, high) == pytest.approx((0.5 * np.pi - 0.3, 0.5 * np.pi + 0.5))


@pytest.mark.parametrize('limits', ('0.2 0.5', '-0.5 -0.2'))
def test_a_pose_outside_the_limits_says_the_mode_and_the_limits_the_range(limits, tmp_path):
    text = robot().replace('"shoulder" axis', f'"shoulder" range="{limits}" limited="true" axis')
    loop, report = good(tmp_path, text)
    low, high = loop.values['linkage.range']
    assert loop.scene.drive.start == 0.5 * (low + high)
    assert "note: the file's pose has shoulder outside its limits: drive.start is in" in report
    inside, _ = good(tmp_path, robot())
    assert loop.values['dyads.d1.mode'] == inside.values['dyads.d1.mode']


def test_a_tendon_drives_its_joints(tmp_path):
    text = robot(motor='<motor tendon="cord"/>').replace(
        '<actuator>', '<tendon><fixed name="cord"><joint joint="pivot" coef="1"/></fixed>'
        '</tendon><actuator>')
    result = read(tmp_path, text, check=True)       # the drive peaks at a toggle
    assert result.checks[0].joint < EXACT and result.checks[0].drive < 1e-7
    assert result.loops[0].scene.drive.joint == 'pivot'


@pytest.mark.parametrize('euler', (STANDING, '0.3 -1.1 2.0'))
def test_a_motor_may_be_between_moving_links(euler, tmp_path):
    loop, report = good(tmp_path, robot(motor='<motor joint="elbow"/>', euler=euler))
    assert 'base frame, driven elbow against arm, dyads RRR' in report
    assert loop.values['linkage.carrier'] == 'arm' and loop.scene.frame.parent == 'frame'


def test_a_pose_a_base_and_a_mode_can_be_given(tmp_path):
    folded = robot().replace('</mujoco>', '<keyframe><key name="down" qpos="-1.2 0.8 -0.5"/>'
                             '</keyframe></mujoco>')
    with pytest.raises(AssertionError, match='refused: link, lever: .* too far to read the mode'):
        good(tmp_path, folded, key='down')
    one, two = (good(tmp_path, folded, key='down', mode={'d1': mode})[0] for mode in (1, 2))
    assert one.values['dyads.d1.mode'] == 1 and two.values['dyads.d1.mode'] == 2
    here, _ = good(tmp_path, robot(), at={'shoulder': '5', 'elbow': '-0.08rad', 'pivot': '2.6deg'})
    assert here.scene.drive.start == pytest.approx(np.radians(95.0), rel=1e-14)
    seen = read(tmp_path, robot(), base='lever', drive=['pivot'])
    report = '\n'.join(seen.report)
    assert 'base lever, driven pivot' in report and seen.loops[0].scene.frame.parent == 'lever'
    assert ('the root of the robot hangs on crank: that is not counted as its mass, and loads are '
            'right only while lever stands still') in report


@pytest.mark.parametrize('names, nodes', [
    (('left', 'right'), ('left', 'right')), (('a/b', 'a_b'), ('a_b', 'a_b_2'))])
def test_several_loops_are_sections_of_one_file(names, nodes, tmp_path):
    text = robot()
    body = text[text.index('<body name="frame"'):text.index('</worldbody>')]
    for name in ('frame', 'arm', 'link', 'lever', 'shoulder', 'elbow', 'pivot'):
        body = body.replace(f'"{name}"', f'"{name}2"')
    text = text.replace('</worldbody>', body + '</worldbody>').replace(
        '</equality>', CONNECT.replace('link', 'link2').replace('lever', 'lever2').replace(
            'tip', 'tip2') + '</equality>').replace(
        '</actuator>', MOTOR.replace('shoulder', 'shoulder2') + '</actuator>')
    for drive, name in zip(('"shoulder"', '"shoulder2"'), names):
        text = text.replace(drive, f'"{name}"')
    result = read(tmp_path, text)
    path = tmp_path / 'both.yaml'
    path.write_text(result.text)
    first, second = (load(f'{path}:{node}') for node in nodes)
    assert (first.drive.joint, second.drive.joint) == names
    assert first.frame_id != second.frame_id
    assert first.linkage.lengths == second.linkage.lengths
    assert len(read(tmp_path, text, loop='lever2').loops) == 1
    with pytest.raises(Refused, match='--mode is of one of 2 loops'):
        read(tmp_path, text, mode={'d1': 1})


FLAT = '<connect name="tip" body1="link" body2="lever" anchor="0.5 -0.2 0"/>'
TWO_LINKS = ('<body name="end" pos="0.9 0.3 0"><joint name="wrist" axis="0 0 1"/>'
             '<inertial mass="0.1" pos="0 0 0" diaginertia="1e-3 1e-3 1e-3"/></body>')
SECOND_ROD = ('<connect name="tip2" body1="arm" body2="lever" anchor="0 0.1 0"/>')
REFUSED = [
    ({'equality': ''}, {}, 'no closed loop in the file$'),
    ({'equality': '<joint joint1="elbow" joint2="shoulder"/>'}, {},
     r'no closed loop in the file; it has 1 mimic or gear joints \(elbow\), which are none'),
    ({'equality': '', 'on_link': '<site name="pin"/>', 'on_lever': '<site name="slot"/>',
      'motor': '<motor cranksite="pin" slidersite="slot" cranklength="1"/>'}, {},
     'no closed loop in the file; actuator actuator_0 is a slider-crank without bodies: left out'),
    ({'equality': CONNECT.replace('0.9 0.3', '0 0')}, {}, 'link has its joints in one point'),
    ({'axis': '0 0 1"/><joint name="tilt" axis="1 0 0'}, {}, 'not planar: tilt is 90 degrees off '
     'the plane square to shoulder; with pivot it is a ball or universal joint$'),
    ({'axis': '0 0.1 1'}, {}, 'not planar: pivot is 5.71 degrees off the plane square to shoul'),
    ({'equality': CONNECT.replace('0.3 0"', '0.3 0"').replace('link', 'end'),
      'on_link': TWO_LINKS}, {}, '5 links and 5 joints have 2 degrees of freedom: hold 1 of the '
     'joints by --lock, as elbow, wrist, pivot'),
    ({'equality': CONNECT + SECOND_ROD}, {}, '4 links and 5 joints have -1 degrees of freedom: '
     'more joints than motion needs, as of the second rod .* by --cut, of tip, tip2'),
    ({'motor': ''}, {}, 'the file does not say which joint of this loop is driven: give --drive, '
     'as of shoulder, pivot'),
    ({'motor': MOTOR + '<motor joint="pivot"/>'}, {},
     '2 joints of this loop are driven, shoulder, pivot: hold all but one by --lock'),
    ({'motor': '<motor joint="pivot"/>', 'axis': '0 0 1" range="2.5 2.7" limited="true'}, {},
     "the loop opens between the file's pose and the limits of pivot"),
    ({}, {'at': {'shoulder': '-40'}}, 'the loop is open in the pose of --at, links .* degrees to '
     'close it, above 20, too far to read the mode; give a pose by --at, of elbow, pivot too, or '
     '--key, or the mode by --mode d1=1 or d1=2$'),
    ({'on_link': '<body name="nut"><inertial pos="0 0 0" mass="-1" diaginertia="1 1 1"/></body>'},
     {}, 'nut has a negative mass or moment of inertia$'),
    ({'equality': FLAT}, {}, "link, lever: flat in the file's pose, the modes are .* degrees "
     'apart, too near to read which; give a pose by --at, of shoulder, elbow, pivot, or --key, or '
     'the mode by --mode d1=1 or d1=2$'),
    ({}, {'drive': ['lever']}, '--drive lever: is a link, not a joint; known: .*shoulder'),
    ({}, {'drive': ['elbw']}, '--drive elbw: no loop has it; did you mean elbow?'),
    ({'axis': '0 0 1" type="ball', 'equality': CONNECT + CONNECT.replace('tip', 'tip_z').replace(
        '0.3 0"', '0.3 0.1"')}, {}, 'pivot is a ball joint, whose position is not one number$'),
    ({}, {'drive': ['tip']}, 'tip closes the loop, so the file gives it no position: drive one of '
     'shoulder, elbow, pivot, or cut the loop elsewhere in the file$'),
    ({}, {'base': 'lever2'}, '--base lever2: the file has no such link; did you mean lever?'),
    ({}, {'loop': 'tips'}, '--loop tips: no loop has it; did you mean tip?'),
    ({}, {'lock': ['pivo']}, '--lock pivo: the file has no such joint; did you mean pivot?'),
    ({}, {'cut': ['pivot']}, '--cut pivot: no joint that closes a loop; known: tip'),
    ({}, {'key': 'home'}, '--key home: the file has no such key'),
    ({}, {'at': {'knee': '1'}}, '--at knee: the file has no such joint'),
    ({}, {'at': {'elbow': '3mm'}}, '--at elbow=3mm: must be a number in deg, or'),
    ({}, {'mode': {'d2': 1}}, '--mode d2: no dyad, which are d1'),
    ({}, {'close': ['a,b']}, '--close: the loops of MJCF are its equality constraints'),
    ({'equality': '<weld name="glue" body1="link" body2="lever" relpose="0.5 0 0 1 0 0 0"/>'}, {},
     'the weld glue is open by .* m and 0 degrees: give a pose'),
]


@pytest.mark.parametrize('changes, wishes, words', REFUSED)
def test_a_refusal_is_a_line_that_says_what_would_help(changes, wishes, words, tmp_path):
    try:
        line = read(tmp_path, robot(**changes), **wishes).report[-1]
    except Refused as error:
        line = str(error)
    assert re.search(words, line), line
    assert '\n' not in line


def test_a_drive_that_is_no_number_beside_mujoco_is_not_good(tmp_path, monkeypatch):
    import mujoco
    monkeypatch.setattr(mujoco, 'mj_rne', lambda *arguments: arguments[-1].fill(np.nan))
    assert not read(tmp_path, robot(), check=True).is_good


def test_links_may_turn_by_twenty_degrees_to_close_a_loop(tmp_path):
    result = read(tmp_path, robot(), at={'elbow': '20'})
    assert result.is_good
    assert '  note: open in the pose: links turn by up to 20 degrees to close' in result.report
    assert not read(tmp_path, robot(), at={'elbow': '20.001'}).is_good


def test_the_report_says_at_which_joints_the_loads_of_a_dyad_are(tmp_path):
    assert ('  loads of d1: d1_first is at elbow, d1_inner is at tip, d1_second is at pivot'
            in read(tmp_path, robot()).report)


def test_the_table_of_a_folder_has_each_file_or_says_that_it_is_not_there(
        tmp_path, capsys, monkeypatch):
    from bench import robot_files
    (tmp_path / 'robot.xml').write_text(robot())
    (tmp_path / 'held.xml').write_text(robot(motor=''))
    monkeypatch.setattr(robot_files, 'FILES', [
        robot_files.RobotFile('robot.xml', 'us: here'),
        robot_files.RobotFile('held.xml', 'us: here'),
        robot_files.RobotFile('held.xml', '', '--drive pivot'),
        robot_files.RobotFile('robot.urdf', 'us: there')])
    robot_files.main(str(tmp_path))
    lines = capsys.readouterr().out.splitlines()
    assert re.match(r'\| `robot.xml`, us \|  \| 1 \| \de-1[5-9] \| \de-1\d \|  \|$', lines[2])
    assert '| 0 |  |  | the file does not say which joint' in lines[3]
    assert lines[4].startswith('| `held.xml` | `--drive pivot` | 1 |')
    assert lines[6] == 'Not in the folder (--folder): robot.urdf (us: there)'
