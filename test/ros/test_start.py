# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The start of the node: what is asked for is done, or refused in one line."""
import subprocess
import sys

from fourbar_ros.errors import BagError, FourBarError
from fourbar_ros.ros.node.recording import directory_of
from fourbar_ros.ros.node.start import asked
from fourbar_ros.scene import scene
from fourbar_ros.scene.files import folder
import pytest
from rclpy.qos import DurabilityPolicy, ReliabilityPolicy
from scene.test_refused import REFUSED as SCENES
from support import ROOT
from support.harness import PATIENCE, set_parameters
from support.samples import some
from support.scenes import file_of, PAPER


def start(tmp_path, *arguments):
    """Run the node until it refuses; return (exit code, the line of its own)."""
    done = subprocess.run([sys.executable, '-m', 'fourbar_ros.ros.node.start', *arguments],
                          cwd=tmp_path, text=True,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=2 * PATIENCE,
                          check=False)
    assert 'Traceback' not in done.stdout
    line, = (line for line in done.stdout.splitlines() if line.startswith('fourbar_node:'))
    return done.returncode, line


@pytest.fixture
def paper(tmp_path):
    return str(file_of({**PAPER, 'drive.speed': 25}, tmp_path))


QOS = 'qos_overrides./fourbar/'
REFUSED = [
    ('use_sim_time:=maybe', "use_sim_time = 'maybe': must be a bool"),
    ('drive.torque_limit:=abc', "drive.torque_limit = 'abc': must be a number in N m, or"),
    ('drive.speed:=300rpn', "drive.speed = '300rpn': must be a number in rad/s"),   # file: 25
    ('linkage.a1:=0,4', "linkage.a1 = '0,4': must be written 0.4"),                 # file: 0.4
    (QOS + 'state.publisher.reliability:=maybe', 'QoS override for policy `reliability`: `maybe`'),
    (QOS + 'state.publisher.depth:=three', "{'publisher.depth': 'three'}"),
    (QOS + 'stat.publisher.depth:=3', 'qos_overrides./fourbar/stat.publisher.depth = 3: no such '
     'quality of service; did you mean /fourbar/state.publisher.depth?'),
    (QOS + 'state.publisher.dept:=3', 'did you mean /fourbar/state.publisher.depth?'),
    (QOS + 'state.subscription.depth:=3', 'no such quality of service'),
    (QOS + 'input.subscription.depth:=3', 'no such quality of service'),    # driven by the timer
    ('start_type_description_service:=3', 'start_type_description_service = 3: must be a bool'),
]


@some('values, name, why', SCENES[::40], 2, ids=str)
def test_a_wrong_scene_is_refused_in_one_line(tmp_path, values, name, why):
    code, line = start(tmp_path, '--ros-args', '--params-file', str(file_of(values, tmp_path)))
    assert code == 2 and line.startswith(f'fourbar_node: {name}') and why in line


@some('given, why', REFUSED, 2, ids=str)
def test_bad_parameters_are_refused_in_one_line(tmp_path, paper, given, why):
    code, line = start(tmp_path, '--ros-args', '--params-file', paper, '-p', 'outputs:=[state]',
                       '-p', given)
    assert code == 2 and why in line


@some('arguments, why', [
    (['--ros-args', '--params-fle', 'x'], '--params-fle'), (['--ros-args', '-r', 'a:b'], 'remap'),
    (['--ros-args', '-r', '__node:=a/b'], 'remap'), (['--ros-args', '--log-level', 'foo'],
                                                     'log level'),
    (['scene.yaml'], 'scene.yaml')], 1, ids=str)
def test_arguments_that_nobody_understands_are_refused_in_one_line(tmp_path, arguments, why):
    code, line = start(tmp_path, *arguments)
    assert code == 2 and why in line


def test_a_file_for_another_node_is_named(tmp_path, paper):
    other = tmp_path / 'other.yaml'
    other.write_text('/left/fourbar: {ros__parameters: {linkage.a1: 0.4}}')
    code, line = start(tmp_path, '--ros-args', '--params-file', str(other))
    assert code == 2 and 'other.yaml: contains nothing for the node /fourbar, only /left/' in line


def test_a_log_that_cannot_be_written_is_one_line(tmp_path, paper, monkeypatch):
    monkeypatch.setenv('ROS_LOG_DIR', '/proc')           # not even by root
    code, line = start(tmp_path, '--ros-args', '--params-file', paper)
    assert code == 2 and 'ROS_LOG_DIR' in line


def test_a_tilde_is_the_home_and_a_removed_directory_no_place_for_bags(tmp_path, monkeypatch):
    gone = tmp_path / 'gone'
    gone.mkdir()
    monkeypatch.chdir(gone)
    gone.rmdir()
    with pytest.raises(BagError, match="recording.directory = 'bags': the working directory has"):
        directory_of(scene.from_values(PAPER))
    monkeypatch.setenv('HOME', str(tmp_path))
    there = scene.from_values({**PAPER, 'recording.directory': '~/bags'})
    assert directory_of(there) == tmp_path / 'bags'


EMPTY = ('joint_names', 'linkage.range', 'linkage.dyads', 'joint_states.ratios', 'outputs',
         'services')


def test_empty_lists_of_a_file_are_empty(run_node, client):
    """As ``ros2 param dump`` writes them."""
    run_node({**PAPER, **dict.fromkeys(EMPTY, [])})
    client.until(lambda: 'fourbar' in client.node.get_node_names(), 'the node')
    client.until(lambda: client.node.count_publishers('/fourbar/scene'), 'its topics')
    assert set_parameters(client, {'outputs': ['state']})[0].successful
    client.listen(['state'])
    client.until(lambda: client.received['state'], 'the stream')


def test_what_is_hardly_meant_is_in_the_log_at_start_and_after_a_change(run_node, client):
    node = run_node({**PAPER, 'drive.start': 90.0})
    client.until(lambda: 'drive.start = 90 rad is more than a turn' in node.said, 'the warning')
    far = {'linkage.a1': '40m', 'linkage.a2': 120.0, 'linkage.a3': 80.0, 'linkage.a4': 100.0}
    assert set_parameters(client, far, atomically=True)[0].successful
    client.until(lambda: 'linkage.a1 = 40 m: did you mean 0.04?' in node.said, 'the other')
    assert node.said.count('more than a turn') == 1


@some('arguments, where', [
    (['left/boom', 'right/boom', '--ros-args', '-r', '__ns:=/cell'], '/cell'),
    (['left/boom', 'right/boom', '--ros-args', '-r', '__ns:=/'], '')], 1)
def test_names_in_namespaces_stay_distinct(client, tmp_path, arguments, where):
    process = subprocess.Popen(
        [sys.executable, '-m', 'fourbar_ros.ros.node.start', *arguments, '--params-file',
         str(ROOT / 'examples/nodes/arm.yaml')], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
        text=True, cwd=tmp_path)
    try:
        client.until(lambda: {('boom', f'{where}/left'), ('boom', f'{where}/right')} <= set(
            client.node.get_node_names_and_namespaces()), 'both nodes')
    finally:
        process.terminate()
        said, _ = process.communicate(timeout=PATIENCE)
    assert process.returncode == 0, said


def test_names_of_a_command_line():
    rest = ['--ros-args', '-r', '__ns:=/cell', '--params-file', str(folder() / 'paper.yaml')]
    assert asked(['left/boom', 'stick', *rest]) == (['left/boom', 'stick'], '/cell')
    with pytest.raises(FourBarError, match='two nodes of one name'):
        asked(['boom', 'boom', *rest])


@pytest.mark.slow
def test_the_quality_of_service_can_be_overridden(run_node, client):
    given = {'/fourbar/state.publisher.reliability': 'best_effort',
             '/fourbar/state.publisher.depth': 3,
             '/fourbar/loads.publisher.depth': 5,                  # an output that may come later
             '/fourbar/input.subscription.reliability': 'reliable',
             '/moved.publisher.durability': 'transient_local'}
    run_node({**PAPER, 'drive.source': 'motion', 'outputs': ['state', 'output'],
              **{f'qos_overrides.{name}': value for name, value in given.items()}},
             remaps=['~/output:=/moved'])

    def publishers(topic):
        return client.node.get_publishers_info_by_topic(topic)
    client.until(lambda: publishers('/fourbar/state') and publishers('/moved')
                 and client.node.get_subscriptions_info_by_topic('/fourbar/input'), 'its topics')
    state, moved = publishers('/fourbar/state')[0].qos_profile, publishers('/moved')[0].qos_profile
    assert (state.reliability == ReliabilityPolicy.BEST_EFFORT and moved.reliability
            == ReliabilityPolicy.RELIABLE)
    assert moved.durability == DurabilityPolicy.TRANSIENT_LOCAL
    listener = client.node.get_subscriptions_info_by_topic('/fourbar/input')[0].qos_profile
    assert listener.reliability == ReliabilityPolicy.RELIABLE
    refused, = set_parameters(client, {'qos_overrides./fourbar/state.publisher.depth': 30})
    assert not refused.successful and 'at start' in refused.reason
    assert (client.call('evaluate', position=0.5).state.theta4
            == scene.from_values(PAPER).linkage.motion(0.5).theta4)
