# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The launch file with real launch and launch_ros, where they are: they are no wheels."""
import signal
import subprocess
import sys

import pytest
from support import ROOT
from support.harness import PATIENCE

pytest.importorskip('launch_ros.actions')

FILE = ROOT / 'launch' / 'fourbar.launch.py'
LAUNCH = """
import sys
from launch import LaunchDescription, LaunchService
from launch.actions import IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource
service = LaunchService()
service.include_launch_description(LaunchDescription([IncludeLaunchDescription(
    PythonLaunchDescriptionSource(sys.argv[1]),
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

    def start(*arguments):
        running.append(subprocess.Popen([sys.executable, '-c', LAUNCH, str(FILE), *arguments],
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


def test_a_file_is_found_before_a_name(launched, client, tmp_path):
    (tmp_path / 'paper').write_text('/**: {ros__parameters: {linkage.a1: 0.4, linkage.a2: 1.2, '
                                    'linkage.a3: 0.8, linkage.a4: 1.2, frame_id: mine, '
                                    'drive.source: motion}}')
    launched('scene:=paper')
    answer = client.call('evaluate', position=0.3)
    assert answer.state.header.frame_id == 'mine'


@pytest.mark.parametrize('arguments, reason', [(['scene:=papr'], 'known: cylinder, paper'),
                                               (['use_sim_time:=maybe'], 'use_sim_time')])
def test_what_cannot_be_is_one_line(launched, arguments, reason):
    process = launched(*arguments)
    said, _ = process.communicate(timeout=PATIENCE)
    assert process.returncode == 1 and reason in said
