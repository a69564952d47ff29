# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The smallest scene beside a bare rclpy node and the fullest scene: a table of docs/node.md."""
import json
import os
from statistics import median
import subprocess
import sys
import tempfile

from bench.pages import table
from fourbar_ros.scene.topics import OUTPUTS, PICTURES
from support.scenes import PAPER, RODS

ROUNDS, STEPS = 3, 2000
SMALLEST = {**PAPER, 'outputs': ['state'], 'services': []}
FULLEST = {**PAPER, **RODS, 'points.tip.link': 'coupler', 'external.output.from_topic': True,
           'trajectories': True, 'drive.source': 'joint_state', 'drive.joint': 'motor',
           'recording.start': True, 'outputs': [*OUTPUTS, *PICTURES]}
# prints time to import [ms], own modules, whether scipy is there, memory [MB], CPU a step [us]
CODE = """
import json, os, sys, time
began = time.perf_counter()
import rclpy
from rclpy.parameter import Parameter
from rclpy.experimental import EventsExecutor
values = json.loads(sys.argv[1])
if values:
    from fourbar_ros.ros.node.node import FourBarNode
else:
    from fourbar_msgs.msg import LinkageState
took = time.perf_counter() - began
rclpy.init()
if values:
    node = FourBarNode(parameter_overrides=[Parameter(k, value=v) for k, v in values.items()])
else:
    node = rclpy.create_node('bare')
    message, publisher = LinkageState(), node.create_publisher(LinkageState, '~/state', 10)
listener = rclpy.create_node('listener')
from fourbar_msgs.msg import LinkageState
listener.create_subscription(LinkageState, '/' + node.get_name() + '/state',
                             lambda data: None, 10, raw=True)
executor = EventsExecutor()
executor.add_node(node)
end = time.monotonic() + 2.0
while time.monotonic() < end:
    executor.spin_once(timeout_sec=0.1)
used = time.process_time()
for k in range(int(sys.argv[2])):
    if values:
        node.stream.step((k + 1, 0), 1e-3 * k, 1.0, 0.0)
    else:
        message.header.stamp.sec = k
        publisher.publish(message)
used = time.process_time() - used
with open('/proc/self/statm') as file:
    memory = int(file.read().split()[1]) * os.sysconf('SC_PAGE_SIZE') / 1e6
own = [name for name in sys.modules if name.partition('.')[0] == 'fourbar_ros']
print(json.dumps([1e3 * took, len(own), 'scipy' in sys.modules, memory,
                  1e6 * used / int(sys.argv[2])]), file=sys.stderr)
os._exit(0)
"""


def measured(values):
    """Return what CODE prints of a scene; of a bare node without values."""
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run([sys.executable, '-c', CODE, json.dumps(values), str(STEPS)],
                              cwd=folder, env={**os.environ, 'ROS_LOG_DIR': folder},
                              capture_output=True, text=True, check=True)
    return json.loads(done.stderr.splitlines()[-1])


def main():
    """Print a table, medians of some runs in turn."""
    scenes = {'bare rclpy node': {}, 'smallest scene': SMALLEST, 'fullest scene': FULLEST}
    found = {name: [] for name in scenes}
    for _ in range(ROUNDS):
        for name, values in scenes.items():
            found[name].append(measured(values))
    rows = []
    for name, runs in found.items():
        took, own, with_scipy, memory, used = map(median, zip(*runs))
        rows.append((name, f'{own:.0f}', 'yes' if with_scipy else 'no', f'{took:.0f}',
                     f'{memory:.0f}', f'{used:.0f}'))
    table(('node', 'our modules', 'scipy', 'import [ms]', 'memory [MB]', 'CPU a step [us]'), rows)


if __name__ == '__main__':
    main()
