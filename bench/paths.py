# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""How much code four things pass through: functions, files, classes, deepest call."""
import os
from pathlib import Path
import sys
import tempfile
import threading
import time

import yaml

OURS = str(Path(__file__).resolve().parent.parent / 'fourbar_ros') + os.sep
MATHEMATICS = 'mechanisms', 'mechanics', 'numerics', 'dynamics', 'extrema'
BEFORE = {'input to loads': (40, 14, 16, 10), 'scene to node': (258, 40, 39, 25),
          'bag to differences': (245, 24, 28, 17), 'live change': (127, 21, 20, 15)}
SCENE = {'linkage.a1': 0.4, 'linkage.a2': 1.2, 'linkage.a3': 0.8, 'linkage.a4': 1.0,
         'bodies.rods.density': 7750.0, 'bodies.rods.radius': 0.01, 'drive.source': 'motion',
         'drive.timeout': 0.0, 'outputs': ['state', 'output', 'joint_states', 'loads',
                                           'shaking_wrench'],
         'recording.start': True, 'recording.name': 'run'}
STEPS = 5


class Counter:
    """Notes each call of ours outside the mathematics while it ``counts``, in all threads."""

    def __init__(self):
        self.counts = False
        threading.setprofile(self._hook)
        sys.setprofile(self._hook)

    def begin(self):
        """Count from now on."""
        self.functions, self.classes, self.deepest, self.counts = set(), set(), 0, True

    def end(self):
        """Return (functions, files, classes, deepest call) since the begin."""
        time.sleep(0.3)                      # the recorder's thread
        self.counts = False
        files = {file for file, _, _ in self.functions}
        return len(self.functions), len(files), len(self.classes), self.deepest

    def _hook(self, frame, event, _):
        if not self.counts or event != 'call' or not _is_ours(frame):
            return
        code, own = frame.f_code, frame.f_locals.get('self', frame.f_locals.get('cls'))
        self.functions.add((code.co_filename, code.co_firstlineno, code.co_name))
        kind = own if isinstance(own, type) else type(own)
        if kind.__module__.startswith('fourbar_ros'):
            self.classes.add(kind)
        depth = 0
        while frame:
            depth, frame = depth + _is_ours(frame), frame.f_back
        self.deepest = max(self.deepest, depth)


def _is_ours(frame):
    """Return whether a frame is of a function of the package, and not of its mathematics."""
    code = frame.f_code
    return (code.co_filename.startswith(OURS) and not code.co_name.startswith('<')
            and code.co_filename[len(OURS):].split(os.sep)[0] not in MATHEMATICS)


def measured(folder):
    """Return {path: (functions, files, classes, deepest call)}; writes a bag into a folder."""
    from fourbar_msgs.msg import Motion
    from fourbar_ros.bag import recompute
    from fourbar_ros.ros.node import start
    from rclpy.parameter import Parameter
    from rclpy.serialization import serialize_message

    file, counter, found = Path(folder) / 'scene.yaml', Counter(), {}
    file.write_text(yaml.safe_dump({'/**': {'ros__parameters': SCENE}}))

    def inside(nodes, _):
        """Stand for the executor: by then the node runs."""
        found['scene to node'] = counter.end()
        node, = nodes
        for k in range(STEPS):
            message = Motion(position=0.1 * k, velocity=1.0, acceleration=0.0)
            message.header.stamp.sec = k + 1
            data = bytes(serialize_message(message))
            counter.begin()
            node.input._subscription.callback(data, {'publication_sequence_number': k})
            found['input to loads'] = counter.end()
        counter.begin()
        done = node.set_parameters_atomically([Parameter('linkage.a1', value=0.41)])
        found['live change'] = counter.end()
        assert done.successful, done.reason

    start.spin = inside
    counter.begin()
    start.run(['--ros-args', '--params-file', str(file)], [])
    counter.begin()
    recompute('bags/run')
    found['bag to differences'] = counter.end()
    return found


def main():
    """Print the table, with the counts of commit 3b58381 in brackets."""
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        os.environ['ROS_LOG_DIR'] = folder
        found = measured(folder)
    print('| path | functions | files | classes | deepest call |')
    print('| --- | --- | --- | --- | --- |')
    for path, before in BEFORE.items():
        print(f'| {path} | ' + ' | '.join(f'{now} ({then})' for now, then
                                          in zip(found[path], before)) + ' |')
    sys.stdout.flush()
    os._exit(0)


if __name__ == '__main__':
    main()
