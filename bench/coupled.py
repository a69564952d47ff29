# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
A plant of another maker moves two linkages, whose load brakes it: FMUs in FMPy, nodes in ROS.

The plant is StateSpace, an FMU of the Modelica association, here a flywheel with a motor: it turns
the paper's linkage, whose output link turns the slider-crank. The torque of both on the crank is
the plant's load in the next step. In ROS the plant is a node that waits for both linkages.
"""
from contextlib import ExitStack
import json
import os
from pathlib import Path
from statistics import median
import tempfile
import time
from typing import NamedTuple

from fourbar_ros import load_scene
from fourbar_ros.generated import generate
from fourbar_ros.scene.scene import from_values
import numpy as np

from .pages import table
from .processes import Child, PATIENCE, percentile

STEP = 1e-3                                     # [s]; the plant's own step is the same
NAMES = 'paper', 'slider_crank'
SCENES = [from_values({**load_scene(name).values, 'drive.source': 'motion', 'drive.timeout': 0.0,
                       'outputs': ['output', 'loads']}) for name in NAMES]
FOLDER = 'FOURBAR_REFERENCE_FMUS'
WHERE = (f'{FOLDER} names no folder with StateSpace.fmu: unpack a release of '
         'https://github.com/modelica/Reference-FMUs/releases')
INERTIA, SLOPE, SPEED = 20.0, 2.0, 25.0         # [kg m^2], [N m s], free speed [rad/s]


class Motion(NamedTuple):
    """Of a joint; rates [rad/s] or [m/s]."""

    position: float
    rate: float
    acceleration: float


class Answer(NamedTuple):
    """Of a linkage: motion of its output, torque of its drive [N m]."""

    position: float
    rate: float
    acceleration: float
    torque: float


def reference_fmu():
    """Return the path of StateSpace.fmu below the folder in the environment, or None."""
    folder = os.environ.get(FOLDER)
    return next(Path(folder).rglob('StateSpace.fmu'), None) if folder else None


# --- FMUs ----------------------------------------------------------------------------------------

class Unit:
    """An FMU of FMI 3.0 for co-simulation, in FMPy."""

    def __init__(self, path, folder, **parameters):
        from fmpy import extract, read_model_description
        from fmpy.fmi3 import FMU3Slave
        about = read_model_description(str(path))
        self.of = {one.name: one.valueReference for one in about.modelVariables}
        self._fmu = FMU3Slave(guid=about.guid, instanceName=path.stem,
                              modelIdentifier=about.coSimulation.modelIdentifier,
                              unzipDirectory=extract(str(path), str(folder / path.stem)))
        self._fmu.instantiate()
        self._steps, self.get, self.set = 0, self._fmu.getFloat64, self._fmu.setFloat64
        for name, value in parameters.items():
            self.set([self.of[name]], value)
        self._fmu.enterInitializationMode(startTime=0.0)
        self._fmu.exitInitializationMode()

    def step(self):
        """Go a step further."""
        self._fmu.doStep(STEP * self._steps, STEP)
        self._steps += 1

    def close(self):
        """Unload it."""
        self._fmu.terminate()
        self._fmu.freeInstance()


class Plant(Unit):
    """
    StateSpace as a flywheel with a motor whose torque falls along a line, to 0 at its free speed.

    States, which start at 0: angle, speed above the free speed. Inputs: load, 1.
    """

    def __init__(self, folder):
        super().__init__(reference_fmu(), folder,
                         A=[0.0, 1.0, 0.0, 0.0, -SLOPE / INERTIA, *[0.0] * 4],
                         B=[0.0, SPEED, 0.0, -1.0 / INERTIA, *[0.0] * 5],
                         C=[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, -SLOPE / INERTIA, 0.0],
                         D=[*[0.0] * 4, SPEED, 0.0, -1.0 / INERTIA, 0.0, 0.0], u=[0.0, 1.0, 0.0])

    def motion(self):
        """Return its motion now."""
        return Motion(*self.get([self.of['y']], 3))

    def brake(self, torque):
        """Go a step further under a load [N m]."""
        self.set([self.of['u']], [torque, 1.0, 0.0])
        self.step()


class Linkage(Unit):
    """A generated FMU."""

    def __init__(self, scene, name, folder):
        linkage = scene.linkage
        fields = [*linkage.outputs[0].coordinate, 'driving_torque']
        super().__init__(generate(scene, folder, 'fmu3', fields, (), name).files[0], folder)
        self._given = [self.of[name] for name in linkage.input_coordinate]
        self._fields = [self.of[name] for name in fields]

    def __call__(self, motion):
        """Return the Answer to a Motion."""
        self.set(self._given, motion)
        self.step()
        return Answer(*self.get(self._fields))


class Units:
    """Both linkages as FMUs."""

    def __init__(self, folder):
        self.linkages = [Linkage(scene, name, folder) for scene, name in zip(SCENES, NAMES)]

    def __call__(self, motion):
        """Return the Answers of both; the second moves as the first one's output does."""
        first = self.linkages[0](motion)
        return first, self.linkages[1](first[:3])

    def close(self):
        """Unload them."""
        for linkage in self.linkages:
            linkage.close()


# --- ROS -----------------------------------------------------------------------------------------

class Nodes:
    """Both linkages as nodes, each a process; this one has the plant's node."""

    def __init__(self, folder):
        from fourbar_msgs.msg import LinkageLoads
        from fourbar_msgs.msg import Motion as MotionMessage
        import rclpy
        from rclpy.experimental import EventsExecutor
        rclpy.init()
        self._node, self._executor = rclpy.create_node('plant'), EventsExecutor()
        self._executor.add_node(self._node)
        self._message, self._heard, self._sent = MotionMessage(), {}, 0
        self._publisher = self._node.create_publisher(MotionMessage, 'motion', 10)
        self._children = []
        for scene, name, topic in zip(SCENES, NAMES, ('/motion', f'/{NAMES[0]}/output')):
            file = folder / f'{name}.json'
            file.write_text(json.dumps({'/**': {'ros__parameters': scene.values}}))
            self._children.append(Child(
                name, '-m', 'fourbar_ros.ros.node.start', '--ros-args', '--params-file', str(file),
                '-r', f'__node:={name}', '-r', f'~/input:={topic}'))
            for output, kind in (('output', MotionMessage), ('loads', LinkageLoads)):
                self._node.create_subscription(
                    kind, f'/{name}/{output}',
                    lambda message, key=(name, output): self._hear(key, message), 100)
        end = time.monotonic() + PATIENCE
        while not self._answered(Motion(0.0, SPEED, 0.0), 0.2):
            if time.monotonic() > end:
                raise RuntimeError('the nodes are silent')

    def _hear(self, key, message):
        stamp = message.header.stamp
        if 1000 * stamp.sec + stamp.nanosec // 10**6 == self._sent:
            self._heard[key] = message

    def _answered(self, motion, patience):
        """Send a motion, stamped with its number in ms; return whether all outputs came."""
        self._sent, message = max(self._sent + 1, 1000), self._message
        message.header.stamp.sec, millis = divmod(self._sent, 1000)
        message.header.stamp.nanosec = 10**6 * millis
        message.position, message.velocity, message.acceleration = motion
        self._heard.clear()
        self._publisher.publish(message)
        end = time.monotonic() + patience
        while len(self._heard) < 2 * len(NAMES) and (left := end - time.monotonic()) > 0.0:
            self._executor.spin_once(timeout_sec=left)
        return len(self._heard) == 2 * len(NAMES)

    def __call__(self, motion):
        """Return the Answers of both."""
        if not self._answered(motion, PATIENCE):
            raise RuntimeError(f'step {self._sent}: only {sorted(self._heard)} came')
        found = []
        for name in NAMES:
            output = self._heard[name, 'output']
            found.append(Answer(output.position, output.velocity, output.acceleration,
                                self._heard[name, 'loads'].driving_torque))
        return found

    def close(self):
        """End the nodes."""
        import rclpy
        for child in self._children:
            child.stop()
        self._executor.shutdown()
        self._node.destroy_node()
        rclpy.try_shutdown()


# --- both ----------------------------------------------------------------------------------------

def in_python(motion):
    """Return the Answers of both by ``step`` of Python."""
    found = []
    for scene in SCENES:
        linkage = scene.linkage
        state, loads = linkage.step(*motion)
        found.append(Answer(*(getattr(state, name) for name in linkage.outputs[0].coordinate),
                            loads.driving_torque))
        motion = found[-1][:3]
    return found


def coupled(linkages, folder, count):
    """Return the motion of the plant with both Answers, a row a step, and times of steps [s]."""
    plant, rows, times = Plant(folder), [], []
    for _ in range(count):
        began = time.perf_counter()
        motion = plant.motion()
        first, second = linkages(motion)
        plant.brake(first.torque + second.torque * first.rate / motion.rate)
        times.append(time.perf_counter() - began)
        rows.append((*motion, *first, *second))
    plant.close()
    return np.array(rows), times


def main(samples=5000):
    """Print the table, or one line where something is missing."""
    try:
        import fmpy
    except ImportError:
        print('FMPy is not installed here: pip install fmpy')
        return
    if reference_fmu() is None:
        print(WHERE)
        return
    found = {}
    with tempfile.TemporaryDirectory() as folder, ExitStack() as stack:
        folder = Path(folder)
        found['Python, `step`'] = coupled(in_python, folder, samples)
        for what, kind in (('C, FMUs in FMPy', Units), ('ROS, a node each', Nodes)):
            linkages = kind(folder)
            stack.callback(linkages.close)
            found[what] = coupled(linkages, folder, samples)
    reference, _ = next(iter(found.values()))
    print(f'{samples} steps of {1e3 * STEP:g} ms, {reference.shape[1]} values each: motion of the '
          'plant, motion and torque of both linkages; the speed of the flywheel varies from '
          f'{reference[:, 1].min():.1f} to {reference[:, 1].max():.1f} rad/s. '
          f'FMPy {fmpy.__version__}; times with the plant.\n')
    rows = []
    for what, (values, times) in found.items():
        rows.append((what, f'{np.count_nonzero(values != reference)} of {values.size}',
                     f'{abs(values - reference).max():g}', f'{1e6 * median(times):.0f}',
                     f'{1e6 * percentile(times, 0.99):.0f}', f'{STEP * samples / sum(times):.2g}'))
    table(('linkages', 'values that differ', 'largest difference', 'step p50 [us]', 'p99 [us]',
           'simulated over elapsed time'), rows)
