# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""URDF, TF and markers over the wire: right poses, right arrows, in the bag, and not too often."""
from math import atan2, hypot

from builtin_interfaces.msg import Time
from fourbar_msgs.msg import Motion
from fourbar_ros.bag.reader import Bag
from fourbar_ros.bag.recomputation import recompute
from fourbar_ros.description.formats import describe
from fourbar_ros.mechanisms.picture import diagram_of
from fourbar_ros.mechanisms.points import point_motion
from fourbar_ros.ros.node import markers as made
from fourbar_ros.ros.schemas import type_hash
from fourbar_ros.scene.files import read_values
from fourbar_ros.scene.scene import from_values, load
from fourbar_ros.scene.topics import PICTURES
import numpy as np
import pytest
from support import ROOT
from support.scenes import file_of, PAPER, RODS, TIP
from visualization_msgs.msg import Marker

EPS = 2.0**-52
SCENES = {name: {**read_values(name), 'drive.source': 'motion', 'pictures.rate': 0.0,
                 'outputs': ['state', *PICTURES]}
          for name in ('paper', 'cylinder', 'jansen', 'lift_table')}
# of geometry2's tf2_msgs, as `ros2 topic info -v /tf` shows it from Iron to Lyrical
OFFICIAL = 'RIHS01_e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087'


def motion(position, stamp):
    message = Motion(position=position, velocity=1.0)
    message.header.stamp = Time(sec=stamp)
    return message


def inputs(scene, count=9):
    low, high = scene.linkage.input_ranges[0]
    return [low + (high - low) * (k + 0.5) / count for k in range(count)]


def poses(message):
    """Return {frame: (place, direction) in the root} of a TFMessage, as complex numbers."""
    found = {}
    for one in message.transforms:
        at, turn = found.get(one.header.frame_id, (0j, 1.0 + 0j))
        t, r = one.transform.translation, one.transform.rotation
        assert (t.z, r.x, r.y) == (0.0, 0.0, 0.0)
        assert abs(hypot(r.z, r.w) - 1.0) <= 4.0 * EPS
        found[one.child_frame_id] = (at + turn * complex(t.x, t.y),
                                     turn * complex(r.w, r.z)**2)
    return found


def test_the_type_hash_of_tf_messages_is_the_official_one():
    assert type_hash('tf2_msgs/msg/TFMessage') == OFFICIAL


@pytest.mark.parametrize('name', ['jansen', 'lift_table'])
def test_frames_are_where_the_links_are(run_node, client, name):
    run_node(SCENES[name])
    scene = from_values(SCENES[name])
    client.listen(['state', 'tf', 'markers'])
    send = client.driving(position=inputs(scene)[0])
    for number, position in enumerate(inputs(scene)):
        send(motion(position, number + 2))
        client.until(lambda n=number: all(
            len(client.received[what]) > n for what in ('tf', 'markers')), 'the pictures')
        its = client.received['tf'][number]
        assert {one.header.stamp.sec for one in its.transforms} == {number + 2}
        found, moved = poses(its), scene.linkage.motion(position, 1.0)
        bound = 32.0 * EPS * max(1.0, *map(abs, scene.linkage.lengths)) * (1.0 + moved.condition)
        for link in scene.linkage.LINKS:
            want = scene.linkage.link_motion(moved, link.name)
            at, direction = found[f'{link.name}_link']
            assert abs(at - complex(want.x, want.y)) <= bound
            assert abs(direction - complex(want.cosine, want.sine)) <= bound
        for point, place in scene.points.items():
            want = point_motion(scene.linkage, moved, *place)
            assert abs(found[point][0] - complex(want.x, want.y)) <= bound
        check_arrows(scene, position, client.received['markers'][number].markers)


def check_arrows(scene, position, markers):
    """Force arrows start at their joints and are parallel and in proportion to the forces."""
    moved, loads = scene.linkage.step(position, 1.0, 0.0)
    diagram = diagram_of(scene.linkage, moved)
    scales = []
    for name, joint in diagram.forces.items():
        arrow = next(m for m in markers if m.ns == f'force {name}')
        start, end = ((p.x, p.y) for p in arrow.points)
        assert start == pytest.approx(tuple(diagram.joints[joint]), abs=1e-15)
        force = np.array([getattr(loads, f'{name}_x'), getattr(loads, f'{name}_y')])
        if hypot(*force) > 1e-9 * max(getattr(loads, other) for other in diagram.forces):
            along = np.subtract(end, start)
            turn = atan2(along[1], along[0]) - atan2(force[1], force[0])
            assert abs(np.sin(turn)) <= 1e-9 and np.cos(turn) > 0.0
            scales.append(hypot(*along) / hypot(*force))
    assert scales and max(scales) <= min(scales) * (1.0 + 1e-9)


def test_the_bag_alone_shows_the_machine(run_node, client, tmp_path):
    values = {**PAPER, **RODS, **TIP, 'outputs': ['state', 'joint_states', 'points', *PICTURES],
              'drive.source': 'motion', 'recording.directory': str(tmp_path / 'bags'),
              'pictures.rate': 0.0}
    node = run_node(values)
    client.listen(['state'])
    send = client.driving()
    path = client.call('start_recording', name='seen').path
    for k in range(20):
        send(motion(0.1 + 0.1 * k, 2 + k))
    client.until(lambda: len(client.received['state']) >= 20, 'the states')
    client.call('stop_recording')
    assert node.stop() == 0
    by_topic = {}
    for record in Bag(path).records():
        by_topic.setdefault(record.topic, []).append(record.message)
    scene = from_values(values)
    assert by_topic['/robot_description'][0].data == describe(scene)
    assert len(by_topic['/tf']) == len(by_topic['/fourbar/markers']) == 20
    markers = by_topic['/fourbar/traces'].pop().markers          # and no other
    assert not by_topic['/fourbar/traces']
    assert markers[0].action == Marker.DELETEALL        # of the scene before
    assert {marker.ns for marker in markers[1:]} == {'path of tip', 'dead points', 'extrema'}
    path_of_tip = np.array([(p.x, p.y) for m in markers if m.ns == 'path of tip'
                            for p in m.points])
    motions = scene.linkage.motion(np.linspace(-np.pi, np.pi, len(path_of_tip)))
    want = point_motion(scene.linkage, motions, *scene.points['tip']).place
    assert np.abs(path_of_tip - want).max() <= 1e-12
    found = recompute(path)
    assert found.inputs == 20 and found.largest == 0.0


def test_what_no_message_moves_any_more_is_taken_away():
    """Arrows of the sample before stood beside a pose at a toggle, toggles of a scene before."""
    scene = from_values({**PAPER, **RODS})
    make, groups = made.maker(scene), scene.layout.groups
    values = list(scene.layout.unknown)                 # loads of a toggle are NaN
    values[groups['motion']], loads = scene.linkage.step(1.0, 1.0, 0.0)
    at_toggle = make((2, 0), values)                    # begins with a clean sheet
    values[groups['loads']] = loads
    first, then = make((1, 0), values), at_toggle

    def of(message, action):
        return {(marker.ns, marker.id) for marker in message.markers if marker.action == action}
    gone = of(then, Marker.DELETE)
    assert gone <= of(first, Marker.ADD) and not of(first, Marker.DELETE)
    assert len(gone) == len(diagram_of(scene.linkage, scene.linkage.motion(1.0)).forces) + 3
    assert of(first, Marker.ADD) - gone == of(then, Marker.ADD)
    assert len(of(then, Marker.DELETEALL)) == 1 and not of(first, Marker.DELETEALL)
    assert made.traces(scene).markers[0].action == Marker.DELETEALL


@pytest.mark.parametrize('name', ['paper', 'jansen', 'slider_crank'])
def test_labels_of_extrema_stand_apart_beside_the_mechanism(name):
    scene = load(ROOT / f'config/{name}.yaml')
    markers = [marker for marker in made.traces(scene).markers if marker.ns == 'extrema']
    assert len({marker.id for marker in markers}) == len(markers)
    labels = [marker for marker in markers if marker.text]
    dots = [marker for marker in markers if marker.type == Marker.SPHERE_LIST]
    leads = [marker for marker in markers if marker.type == Marker.LINE_LIST]
    assert len(labels) == len(dots) == len(leads) >= 4
    right = max(dot.points[0].x for dot in dots)
    heights = sorted(label.pose.position.y for label in labels)
    assert min(np.diff(heights)) >= 1.2 * labels[0].scale.z
    for label, dot, lead in zip(labels, dots, leads):
        assert lead.points[0] == dot.points[0] and lead.points[1].y == label.pose.position.y
        assert right < lead.points[1].x < label.pose.position.x


def test_frames_follow_each_input_and_markers_come_as_often_as_eyes_need(run_node, client):
    run_node({**PAPER, 'drive.source': 'motion', 'outputs': ['state', 'tf', 'markers']})
    client.listen(['state', 'tf', 'markers'])
    send = client.driving()
    for k in range(101):                     # 100 Hz for one second of stamps
        message = motion(0.1 + 0.01 * k, 100 + k // 100)
        message.header.stamp.nanosec = k % 100 * 10**7
        send(message)               # one by one: a burst may outrun a queue of ten
        client.until(lambda k=k: min(map(len, (client.received['state'],
                                               client.received['tf']))) > k, 'the frames')
    assert len(client.received['tf']) == 101
    client.until(lambda: len(client.received['markers']) >= 26, 'the markers')
    last = [m.markers[0].header.stamp for m in client.received['markers']]
    assert len(last) == 26, last             # every fourth sample: 40 ms, for at most 30 Hz


def test_scene_check_says_so_too(tmp_path, capsys):
    from fourbar_ros.cli.main import main
    values = {**PAPER, 'outputs': ['robot_description'],
              'joint_states.ratios': [1.0, 2.0, 1.0, 1.0]}
    assert main(['scene', 'check', str(file_of(values, tmp_path))]) == 1
    assert 'ratio of coupler must be 1 or -1' in capsys.readouterr().err
