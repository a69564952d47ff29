# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The gripper of docs/tutorial_gripper.md on real topics: the numbers that its page names."""
from math import isfinite, radians, sin
import re
import subprocess
import sys

from fourbar_msgs.msg import LinkageLoads, PointMotion
from fourbar_ros.scene.files import read_values
import pytest
from sensor_msgs.msg import JointState
from support import ROOT
from tf2_msgs.msg import TFMessage

PAGE = (ROOT / 'docs' / 'tutorial_gripper.md').read_text(encoding='utf-8')
ANGLE = radians(70.0)


def test_the_node_and_the_script_of_the_page_give_its_numbers(run_node, client, tmp_path):
    scene = tmp_path / 'gripper.yaml'
    scene.write_text(re.search(r'```yaml\n(.*?)```', PAGE, re.S)[1])
    run_node(read_values(scene), remaps=(re.search(r"fourbar_node .* -r '(\S+)'", PAGE)[1],))
    script = re.search(r'```python\n(import rclpy\n.*?)```', PAGE, re.S)[1]
    with subprocess.Popen([sys.executable, '-u', '-c', script], text=True,
                          stdout=subprocess.PIPE) as hand:
        try:
            torques = map(float, hand.stdout)       # NaN before the rates are known, says the page
            assert next(filter(isfinite, torques)) == pytest.approx(-0.8457, abs=1e-4)
        finally:
            hand.kill()
    check(heard_by(client))


def heard_by(client):
    """Speak as the robot; return the newest message of each topic of the page."""
    messages = {}
    for topic, kind in (('/joint_states', JointState), ('/fourbar/loads', LinkageLoads),
                        ('/fourbar/points/pad', PointMotion), ('/tf', TFMessage)):
        client.node.create_subscription(
            kind, topic, lambda message, topic=topic: messages.update({topic: message})
            if 'finger_joint' not in getattr(message, 'name', ()) else None, 100)
    publisher = client.node.create_publisher(JointState, '/joint_states', 100)

    def speak():
        message = JointState(name=['finger_joint'], position=[ANGLE])
        message.header.stamp = client.node.get_clock().now().to_msg()
        publisher.publish(message)
    timer = client.node.create_timer(0.02, speak)
    client.until(lambda: len(messages) == 4 and messages['/fourbar/loads'].status == 0, 'loads')
    client.node.destroy_timer(timer)
    return messages


def check(heard):
    """Compare with the numbers of the page."""
    joints = dict(zip(heard['/joint_states'].name, heard['/joint_states'].position))
    assert set(joints) == {'finger_pad', 'finger_pin', 'finger_follower'}
    assert joints['finger_follower'] == pytest.approx(ANGLE, abs=1e-12)     # of a parallelogram
    torque = -20.0 * 0.045 * sin(ANGLE)
    assert heard['/fourbar/loads'].driving_torque == pytest.approx(torque, abs=1e-6)
    assert f'{torque:.4f}' in PAGE and f'{heard["/fourbar/points/pad"].x:.4f}' in PAGE
    assert 'pad' in {frame.child_frame_id for frame in heard['/tf'].transforms}
    assert heard['/tf'].transforms[0].header.frame_id == 'gripper_base'
