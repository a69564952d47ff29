# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Where a linkage lies in a robot: the static frame over the wire, in the bag, in descriptions."""
from io import StringIO
from math import cos, pi, sin

from fourbar_msgs.msg import Motion
from fourbar_ros.bag.reader import Bag
from fourbar_ros.description.formats import describe
from fourbar_ros.description.model import model_of
from fourbar_ros.mechanisms.points import point_motion
from fourbar_ros.ros.node.pictures import frames_of
from fourbar_ros.scene.files import read_values
from fourbar_ros.scene.scene import from_values
import numpy as np
import pytest
from support.harness import LATCHED, recomputed, set_parameters
from support.scenes import PAPER, RODS, TIP
from tf2_msgs.msg import TFMessage

EPS = 2.0**-52
XYZ, RPY = [0.1, -0.2, 0.3], [-0.5 * pi, 0.4, 1.1]
FRAME = {'frame.parent': 'left_shin', 'frame.xyz': XYZ, 'frame.rpy': RPY}
VALUES = {**PAPER, **RODS, **TIP, 'gravity.y': 9.80665, **FRAME, 'drive.source': 'motion'}


def turned(rpy):
    """Return the rotation of roll, pitch and yaw about fixed axes, one matrix after the other."""
    (r, p, y) = rpy
    about_x = np.array([[1, 0, 0], [0, cos(r), -sin(r)], [0, sin(r), cos(r)]])
    about_y = np.array([[cos(p), 0, sin(p)], [0, 1, 0], [-sin(p), 0, cos(p)]])
    about_z = np.array([[cos(y), -sin(y), 0], [sin(y), cos(y), 0], [0, 0, 1]])
    return about_z @ about_y @ about_x


def rotated(q, v):
    """Return a vector turned by a unit quaternion: v + 2 u x (u x v + w v)."""
    u = np.array([q.x, q.y, q.z])
    return v + 2.0 * np.cross(u, np.cross(u, v) + q.w * v)


def in_parent(message, root, point):
    """Return a point (x, y) of the frame ``root`` in the parent that a TFMessage says."""
    frame, = message.transforms
    assert (frame.header.frame_id, frame.child_frame_id) == ('left_shin', root)
    shift, turn = frame.transform.translation, frame.transform.rotation
    assert abs(turn.x**2 + turn.y**2 + turn.z**2 + turn.w**2 - 1.0) <= 8.0 * EPS
    return np.array([shift.x, shift.y, shift.z]) + rotated(turn, np.array([*point, 0.0]))


def test_a_point_of_the_linkage_is_where_the_static_frame_says(run_node, client, tmp_path):
    node = run_node({**VALUES, 'outputs': ['state', 'points'],
                     'recording.directory': str(tmp_path / 'bags')})
    client.listen(['state'])
    send = client.driving(position=0.7)
    heard = []          # it subscribes long after the node has published
    client.node.create_subscription(TFMessage, '/tf_static', heard.append, LATCHED)
    client.until(lambda: heard, 'the static frame')
    linkage = from_values(VALUES).linkage
    tip = point_motion(linkage, linkage.motion(0.7), 'coupler', 0.5, 0.2).place
    want = np.array(XYZ) + turned(RPY) @ [*tip, 0.0]
    assert np.abs(in_parent(heard[0], 'fourbar', tip) - want).max() <= 16.0 * EPS
    path = client.call('start_recording', name='framed').path
    send(Motion(position=0.8, velocity=1.0))
    assert set_parameters(client, {'frame.xyz': [1.0, 2.0, 3.0]})[0].successful
    client.until(lambda: len(heard) > 1, 'the new frame')
    moved = want - XYZ + [1.0, 2.0, 3.0]
    assert np.abs(in_parent(heard[-1], 'fourbar', tip) - moved).max() <= 16.0 * EPS
    assert not set_parameters(client, {'frame.parent': 'right_shin'})[0].successful
    client.until(lambda: client.received['state'], 'the state')
    client.call('stop_recording')
    assert node.stop() == 0
    recomputed(path)
    in_the_bag = [in_parent(record.message, 'fourbar', tip)
                  for record in Bag(path).records(['/tf_static'])]
    assert np.array_equal(in_the_bag, [in_parent(message, 'fourbar', tip)
                                       for message in (heard[0], heard[-1])])


def test_a_scene_without_a_frame_publishes_none(run_node, client):
    run_node({**VALUES, **dict.fromkeys(('frame.xyz', 'frame.rpy'), []), 'frame.parent': '',
              'outputs': ['state']},
             first='import sys\n'
                   'class Refused:\n'
                   '    def find_spec(self, name, path=None, target=None):\n'
                   "        if name.startswith(('tf2_msgs', 'fourbar_ros.ros.node.pictures')):\n"
                   "            raise AssertionError(f'{name} is imported')\n"
                   'sys.meta_path.insert(0, Refused())')
    client.listen(['state'])
    client.driving(position=0.7)
    assert not client.node.count_publishers('/tf_static')


@pytest.mark.parametrize('name', ['paper', 'bucket', 'slider_crank'])
def test_descriptions_have_the_frame_too(name):
    yourdfpy, mujoco = pytest.importorskip('yourdfpy'), pytest.importorskip('mujoco')
    values = {**read_values(name), 'gravity.x': 1.5, 'gravity.y': -9.0}
    scene = from_values({**values, **FRAME, 'points.tip.link': 'crank', 'points.tip.along': 0.3})
    model, motion = model_of(scene), scene.linkage.motion(model_of(scene).position)
    want = np.array(XYZ) + turned(RPY) @ [*point_motion(scene.linkage, motion, 'crank', 0.3, 0.0)
                                          .place, 0.0]
    robot = yourdfpy.URDF.load(StringIO(describe(scene)), load_meshes=False)
    robot.update_cfg({joint.name: joint.start for joint in model.joints})
    assert robot.base_link == 'left_shin'
    assert np.abs(robot.get_transform('tip', 'left_shin')[:3, 3] - want).max() <= 1e-14
    for parent in ('left_shin', 'world'):
        framed = from_values({**scene.values, 'frame.parent': parent})
        loaded = mujoco.MjModel.from_xml_string(describe(framed, 'mjcf'))
        data = mujoco.MjData(loaded)
        mujoco.mj_resetDataKeyframe(loaded, data, loaded.key('start').id)
        mujoco.mj_kinematics(loaded, data)
        assert np.abs(data.site('tip').xpos - want).max() <= 1e-14
        assert loaded.opt.gravity == pytest.approx(turned(RPY) @ [1.5, -9.0, 0.0], abs=1e-14)
    plain = from_values(values)
    assert describe(plain) == describe(from_values({**values, 'frame.xyz': []}))
    assert 'left_shin' not in describe(plain) + describe(plain, 'mjcf')


def test_the_static_frame_is_one_of_those_that_no_two_nodes_may_have():
    scene = from_values({**VALUES, 'outputs': ['state']})
    assert frames_of(scene) == {'fourbar'}
    assert frames_of(from_values({**VALUES, 'outputs': ['tf']})) == {
        'fourbar', 'crank_link', 'coupler_link', 'output_link', 'tip'}
