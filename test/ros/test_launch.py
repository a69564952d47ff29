# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The launch files with real launch and launch_ros, where they are: they are no wheels."""
import signal
import subprocess
import sys

from fourbar_msgs.msg import LinkageState
from fourbar_ros.scene.scene import load
import pytest
from ros.test_relay import FILE as ARM
from ros.test_relay import Robot
from support import ROOT
from support.harness import PATIENCE

pytest.importorskip('launch_ros.actions')

LAUNCH = """
import sys
from launch import LaunchDescription, LaunchService
from launch.actions import IncludeLaunchDescription
from launch.launch_description_sources import AnyLaunchDescriptionSource
service = LaunchService()
service.include_launch_description(LaunchDescription([IncludeLaunchDescription(
    AnyLaunchDescriptionSource(sys.argv[1]),
    launch_arguments=[each.split(':=') for each in sys.argv[2:]])]))
sys.exit(service.run())
"""


@pytest.fixture
def launched(tmp_path):
    """
    Return the function that launches with arguments, in a folder of its own.

    All are stopped afterwards.
    """
    running = []

    def start(*arguments, file='launch/fourbar.launch.py'):
        running.append(subprocess.Popen([sys.executable, '-c', LAUNCH, str(ROOT / file),
                                         *arguments],
                                        cwd=tmp_path,
                                        stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                        text=True))
        return running[-1]
    yield start
    for process in running:
        if process.poll() is None:
            process.send_signal(signal.SIGINT)
        said, _ = process.communicate(timeout=PATIENCE)
        assert 'Traceback' not in said and 'exit code' not in said, said


def test_every_argument_reaches_the_node(launched, client):
    from rcl_interfaces.srv import GetParameters
    launched('scene:=cylinder', 'namespace:=left', 'name:=arm', 'use_sim_time:=true',
             'log_level:=warn')
    client.until(lambda: ('arm', '/left') in client.node.get_node_names_and_namespaces(),
                 'the node')
    caller = client.node.create_client(GetParameters, '/left/arm/get_parameters')
    client.until(caller.service_is_ready, 'its parameters')
    answer = None
    while not (answer and answer.done()):
        answer = caller.call_async(GetParameters.Request(names=['linkage.kind', 'use_sim_time']))
        for _ in range(40):
            client.executor.spin_once(timeout_sec=0.05)
            if answer.done():
                break
    kind, use_sim_time = answer.result().values
    assert (kind.string_value, use_sim_time.bool_value) == ('inverted_slider', True)


@pytest.mark.slow
def test_a_file_is_found_before_a_name(launched, client, tmp_path):
    (tmp_path / 'paper').write_text('/**: {ros__parameters: {linkage.a1: 0.4, linkage.a2: 1.2, '
                                    'linkage.a3: 0.8, linkage.a4: 1.2, frame_id: mine, '
                                    'drive.source: motion}}')
    launched('scene:=paper')
    answer = client.call('evaluate', position=0.3)
    assert answer.state.header.frame_id == 'mine'


@pytest.mark.slow
@pytest.mark.parametrize('arguments, reason', [
    (['scene:=papr'], 'nor the name of a scene; did you mean paper?'),
    (['use_sim_time:=maybe'], 'use_sim_time')])
def test_what_cannot_be_is_one_line(launched, arguments, reason):
    process = launched(*arguments)
    said, _ = process.communicate(timeout=PATIENCE)
    assert process.returncode == 1 and reason in said


@pytest.mark.slow
def test_a_robot_of_several_relays_in_one_process(launched, client):
    launched(file='examples/nodes/arm.launch.yaml')
    robot = Robot(client, 'boom')
    for name, position in (('boom', 1.4), ('stick', 1.5)):
        robot.move(f'{name}_cylinder', position, 0.1, lambda r, n=name: any(
            f'{n}_pivot' in m.name and m.header.stamp.sec == r.stamp for m in r.answers))
        answer = next(m for m in reversed(robot.answers) if f'{name}_pivot' in m.name)
        motion = load(f'{ARM}:{name}').linkage.motion(position, 0.1)
        assert list(answer.position) == [motion.theta1, motion.theta2, motion.theta4]
    assert {'boom', 'stick'} <= set(client.node.get_node_names())


@pytest.mark.slow
@pytest.mark.parametrize('machine, nodes', [('watt', ('four_bar', 'dyad')),
                                            ('quick_return', ('lever', 'ram'))])
def test_a_machine_of_nodes(launched, client, machine, nodes):
    launched('namespace:=cell', file=f'examples/nodes/{machine}.launch.yaml')
    first, last = (f'cell/{node}' for node in nodes)
    client.listen(['loads', 'driven'], node=first)
    client.listen(['output'], node=last)
    # the torque of the second loads the first, else its loads would be unknown
    client.until(lambda: any(m.status == LinkageState.STATUS_OK
                             for m in client.received['loads']), 'the closed chain')
    client.received['output'].clear()
    client.until(lambda: len(client.received['output']) > 20, 'the output')
    whole, driven = load(machine).linkage, {(m.header.stamp.sec, m.header.stamp.nanosec): m
                                            for m in client.received['driven']}
    compared = 0
    for output in client.received['output']:
        given = driven.get((output.header.stamp.sec, output.header.stamp.nanosec))
        if given:
            motion = whole.motion(given.position, given.velocity, given.acceleration)
            bound = 1e-12 * max(1.0, motion.condition)
            want = getattr(motion, whole.outputs[0].coordinate.rate)
            assert abs(output.velocity - want) <= bound * max(1.0, abs(want))
            compared += 1
    assert compared > 10
