# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""What a scene does not name is not created, not computed, not imported."""
import json
import subprocess
import sys

import pytest
from support.scenes import PAPER, RODS

SCRIPT = """
import json, sys
import rclpy
from rclpy.parameter import Parameter
import fourbar_ros.mechanisms.four_bars as linkage
from fourbar_ros.ros.node.node import FourBarNode
from fourbar_ros.ros.messages import sec_nanosec

calls = []
original = linkage.FourBar.loads, linkage.FourBar.step
linkage.FourBar.loads = lambda self, *a: calls.append('loads') or original[0](self, *a)
linkage.FourBar.step = lambda self, *a: calls.append('step') or original[1](self, *a)
motion = linkage.FourBar.motion
linkage.FourBar.motion = lambda self, *a: calls.append('motion') or motion(self, *a)

rclpy.init()
node = FourBarNode(parameter_overrides=[Parameter(k, value=v)
                                        for k, v in json.loads(sys.argv[1]).items()])
listener = rclpy.create_node('listener')
from fourbar_msgs.msg import LinkageState
def until(expected):
    while node.stream._publishers['state'].is_subscribed != expected:
        rclpy.spin_once(listener, timeout_sec=0.02)
        rclpy.spin_once(node, timeout_sec=0.02)

if sys.argv[2] != 'none':
    subscription = listener.create_subscription(LinkageState, '/fourbar/state',
                                                lambda message: None, 10)
    until(True)
if sys.argv[2] == 'left':
    listener.destroy_subscription(subscription)
    until(False)
for k in range(5):
    node.stream.step(sec_nanosec(k), 0.1 * k, 1.0, 0.0)
topics = sorted(name for name, _ in node.get_publisher_names_and_types_by_node('fourbar', '/'))
print(json.dumps({'calls': calls, 'topics': topics,
                  'bag': [m for m in sys.modules
                          if m.startswith(('fourbar_ros.bag', 'fourbar_ros.formats',
                                           'fourbar_ros.ros.node.topic_input'))],
                  'imported': [m for m in ('scipy', 'mcap', 'matplotlib', 'rich',
                                        'fourbar_ros.extrema.find',
                                        'fourbar_ros.mechanisms.machine.machine',
                                        'fourbar_ros.dynamics.system',
                                        'fourbar_ros.bag.recorder')
                               if m in sys.modules]}))
node.close()
listener.destroy_node()
rclpy.try_shutdown()
"""


def run(parameters, readers='subscribed'):
    done = subprocess.run([sys.executable, '-c', SCRIPT, json.dumps(parameters), readers],
                          capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout.splitlines()[-1])


def test_a_kinematics_only_scene_has_no_loads_and_no_heavy_imports():
    found = run({**PAPER, **RODS, 'drive.source': 'motion', 'outputs': ['state', 'output']})
    assert set(found['calls']) == {'motion'}
    assert found['imported'] == []
    assert '/fourbar/state' in found['topics'] and '/fourbar/output' in found['topics']
    assert not {'/fourbar/loads', '/fourbar/shaking_wrench',
                '/joint_states'} & set(found['topics'])


@pytest.mark.slow
def test_outputs_without_subscribers_are_not_computed():
    everything = {**PAPER, **RODS, 'drive.source': 'motion', 'outputs': ['state', 'loads']}
    assert set(run(everything)['calls']) == {'motion'}          # only state has a subscriber
    assert run(everything, readers='none')['calls'] == []
    assert run(everything, readers='left')['calls'] == []         # the reader has gone again


def test_a_scene_on_the_clock_that_is_not_recorded_needs_nothing_of_bags_and_inputs():
    found = run({**PAPER, 'outputs': ['state'], 'drive.rate': 1.0})
    assert (found['bag'], found['imported']) == ([], [])
