# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Descriptions of a scene: the forward kinematics of other programs close its loops."""
from dataclasses import replace
from io import StringIO
import json
from math import pi
import shutil
import subprocess
from xml.etree import ElementTree

from fourbar_ros import InvalidParameter
from fourbar_ros.description.formats import describe
from fourbar_ros.description.model import model_of, NoDescription, note_of, tree_of
from fourbar_ros.mechanisms.kinds import KINDS
from fourbar_ros.mechanisms.points import point_motion
from fourbar_ros.scene.files import sections, shipped
from fourbar_ros.scene.scene import from_values, load
import numpy as np
import pytest
from support import contract, ROOT
from support.random_machines import random_machines
from support.samples import some
from support.scenes import PAPER, RODS, TIP, values_of

EPS = 2.0**-52
SIGNS = [-1.0, 1.0, -1.0, 1.0]
OFFSETS = [0.3, -0.2, 0.1, 0.05]
# not at B: there the driven joint is cut
CASES = [case for case in contract.CASES if case.driven != 'B']
every_case = pytest.mark.parametrize('case', CASES, ids=contract.name_of)


def scene_of(case, seed=3, **others):
    """Return a scene of a case with masses and a point, and its mechanism."""
    mechanism, _ = next(contract.ordinary(case, seed, 1))
    mechanism = replace(mechanism, external=type(mechanism.external)())
    low, high = mechanism.input_ranges[0]
    values = values_of(mechanism, case.name, **TIP, **others)
    return from_values(values | {'drive.start': 0.5 * (low + high)})


def inputs(mechanism, count=73):
    """Return inputs over its range, away from toggles."""
    return np.concatenate([low + (high - low) * np.linspace(0.02, 0.98, count)
                           for low, high in mechanism.input_ranges])


def joint_positions(scene, motion):
    """Return {joint: position} as joint_states has them."""
    shown = scene.joint_states
    return {name: ratio * getattr(motion, joint.coordinate.position) + offset
            for name, joint, ratio, offset in zip(scene.joint_names, scene.linkage.JOINTS,
                                                  shown.ratios, shown.offsets)}


def loaded(text):
    """Return a URDF as yourdfpy loads it, without geometry."""
    pytest.importorskip('yourdfpy', reason='yourdfpy is not installed')
    from yourdfpy import URDF
    return URDF.load(StringIO(text), load_meshes=False, build_scene_graph=True)


def posed(scene, positions):
    """Yield (motion, robot of yourdfpy in that pose) for positions of the input."""
    robot, joints = loaded(describe(scene)), model_of(scene).joints
    for position in positions:
        motion = scene.linkage.motion(float(position))
        places = joint_positions(scene, motion)
        robot.update_cfg({joint.name: places[joint.name] for joint in joints})
        yield motion, robot


@every_case
@pytest.mark.parametrize('turned', [False, True], ids=['plain', 'turned'])
def test_forward_kinematics_of_the_urdf_close_the_cut_joints(case, turned):
    others = {'joint_states.ratios': SIGNS, 'joint_states.offsets': OFFSETS} if turned else {}
    scene = scene_of(case, **others)
    model, worst = model_of(scene), 0.0
    size = max(1.0, *map(abs, scene.linkage.lengths))
    for motion, robot in posed(scene, inputs(scene.linkage)):
        for closure in model.closures:
            first, second = (robot.get_transform(frame) for frame in closure.closing_frames)
            gap = np.linalg.norm(first[:3, 3] - second[:3, 3])
            assert gap <= max(1e-12, 16.0 * EPS * motion.condition * size)
            worst = max(worst, gap)
        for link in model.links:
            pose = robot.get_transform(link.joint.child, model.root)
            moved = scene.linkage.link_motion(motion, link.joint.connection.child)
            assert np.hypot(pose[0, 3] - moved.x, pose[1, 3] - moved.y) <= 1e-12 * size
            assert abs(pose[0, 0] - moved.cosine) <= 1e-12
            assert abs(pose[1, 0] - moved.sine) <= 1e-12
        place = point_motion(scene.linkage, motion, *scene.points['tip']).place
        assert np.abs(robot.get_transform('tip', 'fourbar')[:2, 3] - place).max() <= 1e-12 * size
    assert model.closures and worst > 0.0 or case.kind.TITLE == 'Scotch yoke'


@every_case
def test_mujoco_keeps_the_loops_of_its_own_simulation_where_we_have_them(case):
    simulated_in_mujoco(scene_of(case))


@some('name', ['jansen', 'watt', 'bucket'], 1)
def test_so_it_does_with_machines_of_dyads(name):
    simulated_in_mujoco(load(name))


def simulated_in_mujoco(scene):
    """
    Let MuJoCo move freely from our pose; its passive joints follow ours within its softness.

    How far a loop gapes is measured in MuJoCo; an angle can be wrong by the gap over the links,
    times the condition of the pose.
    """
    mujoco = pytest.importorskip('mujoco', reason='mujoco is not installed')
    model = mujoco.MjModel.from_xml_string(describe(scene, 'mjcf'))
    data, ours = mujoco.MjData(model), model_of(scene)
    mujoco.mj_resetDataKeyframe(model, data, model.key('start').id)
    joints = {joint.name: data.joint(joint.name) for joint in ours.joints}
    driven = next(joint for joint in ours.joints if joint.is_driven)
    least, size = min(filter(None, map(abs, scene.linkage.lengths))), ours.size
    start, speed = joints[driven.name].qpos[0], 1.0
    _at_speed(scene, joints, start, speed)
    worst = moved = 0.0
    for _ in range(200):
        mujoco.mj_step(model, data)
        mujoco.mj_kinematics(model, data)        # of where the step has ended
        q = float(joints[driven.name].qpos[0])
        motion = scene.linkage.motion(q)
        gap = max(np.linalg.norm(np.subtract(*(
            data.site(frame).xpos for frame in closure.closing_frames)))
            for closure in ours.closures)
        positions = joint_positions(scene, motion)
        for name, joint in joints.items():
            error = joint.qpos[0] - positions[name]
            error = error if _slides(ours, name) else abs((error + pi) % (2.0 * pi) - pi) * least
            assert abs(error) <= 4.0 * (1.0 + motion.condition) * (gap + EPS * size)
        worst, moved = max(worst, gap), max(moved, abs(q - start))
    assert moved > 1e-3 * size or moved > 1e-3
    assert worst <= 0.02 * size


def _slides(model, name):
    return any(joint.slides for joint in model.joints if joint.name == name)


def _at_speed(scene, joints, position, speed):
    """Set MuJoCo's joints to a motion of ours."""
    motion = scene.linkage.motion(float(position), speed)
    for name, joint in zip(scene.joint_names, scene.linkage.JOINTS):
        if name in joints:
            joints[name].qvel[0] = getattr(motion, joint.coordinate.rate)


@every_case
def test_mujoco_reads_the_urdf_with_its_masses(case):
    mujoco = pytest.importorskip('mujoco', reason='mujoco is not installed')
    scene = scene_of(case)
    model = mujoco.MjModel.from_xml_string(describe(scene))
    names = {model.joint(i).name for i in range(model.njnt)}
    assert names == {joint.name for joint in model_of(scene).joints}
    total = sum(body.mass for body in scene.linkage.bodies)
    assert model.body_mass.sum() == pytest.approx(total, rel=1e-12)


def accepted_by_check_urdf(text, file):
    if not shutil.which('check_urdf'):
        pytest.skip('check_urdf is not installed: apt install liburdfdom-tools')
    file.write_text(text)
    done = subprocess.run(['check_urdf', str(file)], capture_output=True, text=True, check=False)
    assert done.returncode == 0 and 'Successfully Parsed' in done.stdout, done.stdout + done.stderr


LIFT_TABLE = ROOT / 'config' / 'lift_table.yaml'
SUPPLIED = [*sorted((ROOT / 'config').glob('*.yaml')),
            *(f'{file}:{node.strip("/*")}'
              for file in sorted((ROOT / 'examples' / 'nodes').glob('*.yaml'))
              if not file.match('*.launch.yaml') for node in sections(file))]


@some('name', SUPPLIED, 4, ids=lambda name: str(name).rpartition('/')[2])
def test_check_urdf_and_mujoco_load_every_scene_of_the_tree(name, tmp_path):
    mujoco, scene = pytest.importorskip('mujoco'), load(name)
    texts = [describe(scene)] * (scene.linkage.bodies is not None) + [describe(scene, 'mjcf')]
    for text in texts:               # of a URDF without masses MuJoCo makes nothing
        assert mujoco.MjModel.from_xml_string(text).njnt == len(model_of(scene).joints)
    assert mujoco.MjModel.from_xml_string(describe(scene, 'mjcf')).neq > 0
    accepted_by_check_urdf(describe(scene), tmp_path / 'scene.urdf')


# It closes for the crank from 53 to 307 deg, and starts a turn lower, at -143 deg.
A_TURN_LOWER = {**PAPER, 'linkage.a1': 0.68, 'linkage.a2': 0.35, 'linkage.a3': 0.9,
                'linkage.a4': 0.49, 'linkage.mode': 1, 'drive.start': -2.5}
# It closes in two ranges, and the links cannot get from one to the other.
TWO_RANGES = {**PAPER, 'linkage.a1': 0.97, 'linkage.a2': 0.23, 'linkage.a3': 0.91,
              'linkage.a4': 0.57, 'drive.start': -1.2}


@pytest.mark.parametrize('values', [
    *shipped(), A_TURN_LOWER, A_TURN_LOWER | {'drive.start': 2.5},
    A_TURN_LOWER | {'joint_states.ratios': SIGNS, 'joint_states.offsets': OFFSETS}, TWO_RANGES,
    {**PAPER, 'linkage.range': [0.0, 0.85]}, {**PAPER, 'linkage.range': [-3.0, -2.0],
                                              'drive.start': 4.0}],
    ids=lambda values: values if isinstance(values, str) else '')
def test_the_start_lies_within_the_limits_of_every_format(values):
    scene = load(values) if isinstance(values, str) else from_values(values)
    try:
        joints = {joint.name: joint for joint in model_of(scene).joints}
    except NoDescription:
        pytest.skip('no tree')
    urdf = ElementTree.fromstring(describe(scene))
    motion, limits = scene.linkage.motion(float(model_of(scene).position)), {}
    starts = joint_positions(scene, motion)
    for element in urdf.findall('joint'):
        for limit in element.findall('limit'):
            limits[element.get('name')] = float(limit.get('lower')), float(limit.get('upper'))
    for name, (low, high) in limits.items():
        assert joints[name].start == starts[name] and low <= starts[name] <= high
    driven, = [joint for joint in joints.values() if joint.is_driven]
    assert (driven.name in limits) != scene.linkage.turns_fully
    ends = scene.linkage.input_ranges
    if driven.name in limits:
        low, high = limits[driven.name]
        assert any(abs(high - low - (end - begin)) <= 1e-12 for begin, end in ends)
    _starts_within_mujocos_limits(scene)


def _starts_within_mujocos_limits(scene):
    """No limit of a joint acts on the pose of the key."""
    mujoco = pytest.importorskip('mujoco', reason='mujoco is not installed')
    try:
        text = describe(scene, 'mjcf')
    except NoDescription:
        return
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key('start').id)
    mujoco.mj_forward(model, data)
    assert mujoco.mjtConstraint.mjCNSTR_LIMIT_JOINT not in data.efc_type.tolist()


def test_a_passive_slide_stays_within_its_limits_up_to_the_toggles():
    """At a toggle it moves as the root of the distance of the input from there."""
    scene = from_values({'linkage.kind': 'slider_crank', 'linkage.a1': 0.3, 'linkage.a2': 0.2,
                         'linkage.offset': 0.25, 'drive.start': 1.5})
    slide = next(joint for joint in model_of(scene).joints if joint.slides)
    low, high = scene.linkage.input_ranges[0]
    near = low + (high - low) * np.array([0.0, 1e-9, 1e-6, 1.0 - 1e-6, 1.0 - 1e-9])[1:]
    positions, = scene.linkage.motion(near, fields=(slide.coordinate.position,))
    assert slide.limits[0] <= positions.min() and positions.max() <= slide.limits[1]


@pytest.mark.parametrize('ends', [[0.0, 0.85], [3.0, 4.0], [-1.0, 9.0]])
def test_the_range_of_a_crank_is_that_of_its_joint(ends):
    scene = from_values({**PAPER, 'linkage.range': ends, 'drive.start': ends[0] + 0.1})
    element = next(joint for joint in ElementTree.fromstring(describe(scene)).findall('joint')
                   if joint.get('name') == 'crank')
    limit = element.find('limit')
    assert element.get('type') == 'revolute'
    assert [float(limit.get('lower')), float(limit.get('upper'))] == ends
    mujoco = pytest.importorskip('mujoco', reason='mujoco is not installed')
    model = mujoco.MjModel.from_xml_string(describe(scene, 'mjcf'))
    assert model.joint('crank').range.tolist() == ends and model.joint('crank').limited


def test_only_links_with_a_body_weigh_in_mujoco():
    mujoco = pytest.importorskip('mujoco', reason='mujoco is not installed')
    scene = from_values({**PAPER, **RODS, **TIP})
    model = mujoco.MjModel.from_xml_string(describe(scene, 'mjcf'))
    total = sum(body.mass for body in scene.linkage.bodies)
    assert model.body_mass.sum() == pytest.approx(total, rel=1e-12)


def test_a_machine_that_is_solved_from_a_moving_link_hangs_beside_its_first_joint():
    scene = load(LIFT_TABLE)
    model = model_of(scene)
    (beside,) = [link for link in model.links if any(link.joint.connection.on_child)]
    for motion, robot in posed(scene, inputs(scene.linkage, 9)):
        for link in model.links:
            pose = robot.get_transform(link.joint.child, model.root)
            moved = scene.linkage.link_motion(motion, link.joint.connection.child)
            assert [pose[0, 3], pose[1, 3], pose[0, 0], pose[1, 0]] == pytest.approx(
                [moved.x, moved.y, moved.cosine, moved.sine], abs=1e-13)
        for closure in model.closures:
            first, second = (robot.get_transform(frame) for frame in closure.closing_frames)
            assert np.linalg.norm(first[:3, 3] - second[:3, 3]) < 1e-13
        assert robot.get_transform(f'{beside.joint.child}_hinge', model.root) is not None


@pytest.mark.parametrize('name', ['paper', 'bucket', 'jansen', 'scotch_yoke'])
def test_the_note_makes_a_description_that_is_closed_where_all_joints_are_zero(name):
    scene = load(name)
    note = note_of(scene)
    model = model_of(scene)
    assert model.open_at_zero > 1e-3 * model.size and 'joint_state_publisher_gui' in note
    offsets = json.loads(note.partition('joint_states.offsets: ')[2])
    scene = from_values({**scene.values, 'joint_states.offsets': offsets})
    assert note_of(scene) == ''
    robot = loaded(describe(scene))
    robot.update_cfg({joint.name: 0.0 for joint in model_of(scene).joints})
    for closure in model.closures:
        first, second = (robot.get_transform(frame) for frame in closure.closing_frames)
        assert np.linalg.norm(first[:3, 3] - second[:3, 3]) < 1e-9 * model.size


def test_the_note_moves_no_zero_of_a_motor(capsys):
    from fourbar_ros.cli.main import main
    assert main(['describe', 'cassie_foot']) == 0       # open where its motor is at zero
    output = capsys.readouterr()
    assert output.out.endswith('</robot>\n') and output.err.count('\n') == 1
    assert 'open where all joints are 0' in output.err and 'offsets' not in output.err
    assert main(['describe', 'xarm_hand']) == 0 and not capsys.readouterr().err


def test_what_acts_and_is_not_in_an_mjcf_is_named(tmp_path, capsys):
    from fourbar_ros.cli.main import main
    for name, says in (
            ('press', 'springs.back, forces.cut, friction.O1, friction.A, friction.B, '
                      'friction.guide\n'), ('bucket', 'external.bucket\n'), ('paper', '')):
        assert main(['describe', name, '--as', 'mjcf', '-o', str(tmp_path / f'{name}.xml')]) == 0
        assert capsys.readouterr().err.partition('note: not in the file: ')[2] == says


def test_the_driven_joint_is_never_cut():
    for case in CASES:
        scene = scene_of(case)
        driven = [joint.coordinate for joint in scene.linkage.JOINTS].index(
            scene.linkage.input_coordinate)
        assert driven in tree_of(scene.linkage)[0].values()


def test_without_masses_there_are_no_inertials_and_mujoco_takes_the_shapes():
    scene = from_values(PAPER)
    assert '<inertial>' not in describe(scene)
    mujoco = pytest.importorskip('mujoco', reason='mujoco is not installed')
    assert mujoco.MjModel.from_xml_string(describe(scene, 'mjcf')).body_mass.sum() > 0.0


@pytest.mark.parametrize('wrong, why', [
    ({'joint_states.ratios': [1.0, 2.0, 1.0, 1.0]}, 'ratio of coupler must be 1 or -1, not 2'),
    ({'frame_id': 'tip', **TIP}, "two frames would be named 'tip'"),
    ({'linkage.input': 'B', 'drive.start': 1.5}, 'cut at joint coupler_output, which is driven'),
])
def test_what_no_description_can_hold_is_refused_in_one_line(wrong, why):
    with pytest.raises(NoDescription, match=why):
        describe(from_values({**PAPER, **wrong}), 'mjcf')


def test_an_unknown_format_is_refused():
    with pytest.raises(InvalidParameter, match='must be one of urdf, mjcf'):
        describe(from_values(PAPER), 'obj')


def test_no_number_loses_digits():
    """The lengths stand in the URDF as they stand in the scene."""
    text = describe(from_values({**PAPER, 'linkage.a1': 0.1 + 0.2}))
    assert '0.30000000000000004 0 0' in text
    assert set(KINDS) == {case.name for case in CASES}


# --- machines of dyads ---------------------------------------------------------------------------

def scene_with(machine):
    """Return a scene of a machine, its joints named as its own."""
    scene, count = from_values(PAPER), len(machine.JOINTS)
    return replace(
        scene, linkage=machine, joint_names=tuple(joint.place for joint in machine.JOINTS),
        joint_states=scene.joint_states._replace(ratios=[1.0] * count, offsets=[0.0] * count))


def test_random_machines_close():
    for machine, given in random_machines(17, 12, dyads=(1, 5)):
        scene, size = scene_with(machine), max(1.0, *map(abs, machine.lengths))
        (motion, robot), = posed(scene, given[:1])
        for closure in model_of(scene).closures:
            first, second = (robot.get_transform(frame) for frame in closure.closing_frames)
            way = second[:3, 3] - first[:3, 3]
            if closure.connection.axis is not None:  # along the slide they may be apart
                along = first[:3, :3] @ np.array([*closure.connection.axis, 0.0])
                way = way - along * (along @ way)
            assert np.linalg.norm(way) <= 1e-12 * size * max(1.0, np.max(motion.condition))
