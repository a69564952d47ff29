"""From one crank input to everything that is heard or recorded."""
from __future__ import annotations

import threading
from math import nan

from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.serialization import serialize_message
from std_msgs.msg import String

from .. import interfaces
from ..core.status import INPUT_TIMEOUT, OK, OUT_OF_RANGE, STATUS_NAMES
from ..records import PLACE
from ..stepper import Stepper
from .outputs import Output

UNKNOWN = (nan,) * len(PLACE)


class Stream:
    """
    The outputs of a node. :meth:`step` comes from the drive, :meth:`apply` from changed parameters.

    Parameters
    ----------
    node : rclpy.node.Node
    scene : Scene
    recording : Recording

    """

    def __init__(self, node, scene, recording):
        self._node, self._recording = node, recording
        self._lock = threading.Lock()                    # a change happens between two steps
        recording.between_steps = self._lock
        self.steps, self.bad_steps, self.status = 0, 0, OK
        self.values = UNKNOWN                            # of the newest step that was computed
        self._crank, self._outputs = Output(node, interfaces.CRANK), []
        self._scene_publisher = node.create_publisher(
            String, interfaces.SCENE.topic, QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL))
        self.apply(scene)

    def apply(self, scene):
        """Take over a scene: linkage, outputs; publish and record it."""
        with self._lock:
            self.scene = scene
            self._stepper = Stepper(scene.linkage, scene.drive.out_of_range)
            there = {output.name: output for output in self._outputs}
            for name in there.keys() - set(scene.outputs):
                there[name].destroy()
            self._outputs = [there.get(name) or Output(self._node, interfaces.OUTPUTS[name])
                             for name in scene.outputs]
            for output in (self._crank, *self._outputs):
                output.apply(scene)
            self._send_scene()

    def start_recording(self, name=''):
        """Start a bag whose first message is the scene; returns its path; raises BagError."""
        with self._lock:
            path = self._recording.start(self.scene, name)
            self._recording.write(interfaces.SCENE.name, self._scene_bytes())
            return path

    def _scene_bytes(self):
        return serialize_message(String(data=self.scene.as_json))

    def _send_scene(self):
        data = self._scene_bytes()
        self._scene_publisher.publish(data)
        self._recording.write(interfaces.SCENE.name, data)

    def step(self, stamp, theta1, omega1, alpha1):
        """Evaluate one input and send what is heard or recorded."""
        with self._lock:
            self.steps += 1
            recorded = self._recording.active
            crank = (theta1, omega1, alpha1)             # as it came: values may be held or clamped
            if recorded or self._crank.is_heard:
                self._crank.send(stamp, OK, 0, crank, self._recording)
            wanted = [output for output in self._outputs if recorded or output.is_heard]
            if not wanted:
                return
            with_loads = any(output.needs_loads for output in wanted)
            status, self.values = self._stepper.step(*crank, with_loads)
            for output in wanted:
                output.send(stamp, status, self.scene.linkage.mode, self.values, self._recording)
        if status != OK:
            self.bad_steps += 1
        if status != self.status:                        # once per change, not per sample
            self._log(status, theta1)

    def timeout(self, stamp, seconds):
        """Say once on every output that the input has stopped."""
        with self._lock:
            self.status, self.values = INPUT_TIMEOUT, UNKNOWN
            for output in self._outputs:
                output.send(stamp, INPUT_TIMEOUT, self.scene.linkage.mode, UNKNOWN, self._recording)
        self._node.get_logger().warning(f'no input for {seconds:g} s')

    def _log(self, status, theta1):
        self.status = status
        say = self._node.get_logger()
        if status == OK:
            say.info('input good again')
        else:
            ranges = f', input range {self.scene.linkage.input_ranges} rad' if status == OUT_OF_RANGE else ''
            say.warning(f'theta1 = {theta1!r} rad: {STATUS_NAMES[status]}{ranges}')
