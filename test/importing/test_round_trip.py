# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""What describe writes of every shipped scene, import reads: the same joints, the same drive."""
from math import pi, tau

from fourbar_ros.description.connections import connections_of
from fourbar_ros.description.formats import describe
from fourbar_ros.errors import MissingBodies
from fourbar_ros.importing.files import import_file, Wishes
from fourbar_ros.mechanics.bodies import field_of
from fourbar_ros.mechanisms.curves import point_of
from fourbar_ros.mechanisms.parts import GROUND
from fourbar_ros.scene.base import rotation_of
from fourbar_ros.scene.files import shipped
from fourbar_ros.scene.scene import from_values, load
import numpy as np
import pytest

# a start pose in which both modes are alike
FLAT = {'coupling_rod', 'parallelogram', 'antiparallelogram'}


def joints_of(scene, position, rate=1.0, acceleration=0.5):
    """Return ({joint: position}, driving torque or force at the driven joint or None)."""
    mechanism, shown = scene.linkage, scene.joint_states
    try:
        motion, loads = mechanism.step(position, rate, acceleration)
    except MissingBodies:
        motion, loads = mechanism.motion(position, rate, acceleration), None
    joints = {name: ratio * getattr(motion, joint.coordinate.position) + offset
              for name, joint, ratio, offset in zip(scene.joint_names, mechanism.JOINTS,
                                                    shown.ratios, shown.offsets)}
    if loads is None:
        return joints, None
    return joints, (loads.driving_force if mechanism.is_driven_by_slide
                    else loads.driving_torque) / ratio_of(scene)[0]


def ratio_of(scene):
    """Return ratio and offset of the driven joint, which is positive or negative."""
    index = [joint.coordinate for joint in scene.linkage.JOINTS].index(
        scene.linkage.input_coordinate)
    return scene.joint_states.ratios[index], scene.joint_states.offsets[index]


def unloaded(scene):
    """Return a scene without what no robot's file can say: forces, springs, friction."""
    return from_values({name: value for name, value in scene.values.items() if not name.startswith(
        ('external.', 'forces', 'springs', 'torsion_springs', 'friction'))})


def worst_of(source, read):
    """Return the largest difference of joints [rad, m] and of the drive, as share of its peak."""
    low, high = source.linkage.input_ranges[0]
    (ratio, offset), (of_read, off_read) = ratio_of(source), ratio_of(read)
    worst, far, peak = 0.0, 0.0, 0.0
    turns = {name for name, joint in zip(source.joint_names, source.linkage.JOINTS)
             if joint.coordinate.unit == 'rad'}
    for position in np.linspace(low + 0.02 * (high - low), high - 0.02 * (high - low), 23):
        ours, drive = joints_of(source, float(position))
        there = (ratio * float(position) + offset - off_read) / of_read
        theirs, read_drive = joints_of(read, there, ratio / of_read, 0.5 * ratio / of_read)
        assert ours.keys() == theirs.keys()
        for name in ours.keys() - {*read.joint_states.leave_out}:      # which have no zero
            away = ours[name] - theirs[name]
            away = (away + pi) % tau - pi if name in turns else away
            worst = max(worst, abs(away))
        if drive is not None:
            far, peak = max(far, abs(drive - read_drive)), max(peak, abs(drive))
    return worst, far / peak if peak else 0.0


@pytest.mark.parametrize('name', shipped())
@pytest.mark.parametrize('format_', ('mjcf', 'urdf'))
def test_what_describe_writes_import_reads_without_options(format_, name, tmp_path):
    pytest.importorskip('mujoco', reason='mujoco is not installed')
    source = unloaded(load(name))
    path = tmp_path / f'robot.{format_}'
    path.write_text(describe(source, format_))
    # a URDF has no gravity: the scene's, in the axes of the frame's parent
    weight = np.array([*field_of(source.linkage.gravity), 0.0])
    turned = np.array(rotation_of(source.frame.rpy)).T @ weight
    gravity = tuple(turned) if format_ == 'urdf' else ()
    result = import_file(path, Wishes(gravity=gravity))
    report = '\n'.join(result.report)
    if name in FLAT:
        assert not result.loops and "flat in the file's pose" in report
        return
    assert result.is_good and len(result.loops) == 1, report
    read = result.loops[0].scene
    assert {*read.points} == {name for name, point in source.points.items()
                              if point.link != 'ground'}
    joints, drive = worst_of(source, read)
    assert joints < 1e-12 and drive < 1e-9, (joints, drive, report)


@pytest.mark.parametrize('format_', ('mjcf', 'urdf'))
def test_an_imported_scene_is_described_and_imported_again(format_, tmp_path):
    pytest.importorskip('mujoco', reason='mujoco is not installed')
    scene, frames = unloaded(load('paper')), []
    for count in range(3):
        path = tmp_path / f'robot_{count}.{format_}'
        path.write_text(describe(scene, format_))
        result = import_file(path, Wishes())
        assert result.is_good, result.report
        scene = result.loops[0].scene
        frames.append(scene.frame_id)
    assert len({*frames}) == 3


@pytest.mark.parametrize('name', ['paper', 'cylinder', 'jansen', 'gripper', 'lift_table'])
def test_pins_are_where_mujoco_has_them_in_the_world(name, tmp_path):
    """By frame.xyz and frame.rpy, on a base that stands askew."""
    mujoco = pytest.importorskip('mujoco', reason='mujoco is not installed')
    text = describe(unloaded(load(name)), 'mjcf').replace(
        '<worldbody>', '<worldbody><body pos="0.3 -0.2 0.5" euler="0.7 -1.1 2.3">', 1).replace(
        '</worldbody>', '</body></worldbody>')
    path = tmp_path / 'robot.xml'
    path.write_text(text)
    (loop,) = import_file(path).loops
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_kinematics(model, data)
    scene, base = loop.scene, data.body(loop.scene.frame.parent)
    to_world = base.xmat.reshape(3, 3)
    turned = to_world @ np.array(rotation_of(scene.frame.rpy)).T
    motion = scene.linkage.motion(loop.drive.coordinate, 0.0, 0.0)
    pins = [(joint, connection) for joint, connection in zip(
        loop.joints.values(), connections_of(scene.linkage))
        if connection.axis is None and not joint.closes]
    for joint, connection in pins:
        x, y = connection.on_parent if connection.parent == GROUND else point_of(
            scene.linkage.link_motion(motion, connection.parent), *connection.on_parent)[:2]
        away = turned.T @ (data.joint(joint.name).xanchor - base.xpos
                           - to_world @ scene.frame.xyz) - [x, y, 0.0]
        assert np.hypot(*away[:2]) < 2.0**6 * np.finfo(float).eps * loop.loop.size(), joint.name
    assert len(pins) > 1
