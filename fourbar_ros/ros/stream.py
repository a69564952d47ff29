"""From one input to everything that is heard or recorded."""
from __future__ import annotations

import threading
from math import nan, sin

from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.serialization import serialize_message
from std_msgs.msg import String

from .. import interfaces
from ..core.errors import UNITS, OutOfRange
from ..core.status import INPUT_TIMEOUT, OK, OUT_OF_RANGE, STATUS_NAMES
from ..stepper import Stepper
from .outputs import Output


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
        self._driven, self._outputs = Output(node, interfaces.DRIVEN), []
        self._scene_publisher = node.create_publisher(
            String, interfaces.SCENE.topic, QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL))
        self.apply(scene)

    def apply(self, scene):
        """Take over a scene: linkage, outputs; publish and record it."""
        with self._lock:
            self.scene, self._layout = scene, scene.layout
            self._stepper = Stepper(scene)
            self._values = self._unknown = (nan,) * len(self._layout.place)
            self._given = [self._layout.place[name] for name in scene.linkage.input_coordinate]
            there = {output.name: output for output in self._outputs}
            for name in there.keys() - scene.topics.keys():
                there[name].destroy()
            self._outputs = [there.get(name) or Output(self._node, topic) for name, topic in scene.topics.items()]
            for output in (self._driven, *self._outputs):
                output.apply(scene)
            self._send_scene()

    def start_recording(self, name=''):
        """Start a bag whose first message is the scene; returns its path; raises BagError."""
        with self._lock:
            path = self._recording.start(self.scene, name)
            self._stepper = Stepper(self.scene)          # nothing is held from before: the bag computes again alone
            self._recording.write(interfaces.SCENE.name, self._scene_bytes())
            return path

    def _scene_bytes(self):
        return serialize_message(String(data=self.scene.as_json))

    def _send_scene(self):
        data = self._scene_bytes()
        self._scene_publisher.publish(data)
        self._recording.write(interfaces.SCENE.name, data)

    def transmission_sine(self):
        """Return |sin| of the transmission angle of the newest step that was computed, or NaN."""
        return abs(sin(self._values[self._layout.place['transmission_angle']]))

    def step(self, stamp, position, rate, acceleration):
        """Evaluate one input and send what is heard or recorded."""
        with self._lock:
            self.steps += 1
            recorded = self._recording.active
            if recorded or self._driven.is_heard:
                self._driven.send(stamp, OK, 0, self._as_it_came(position, rate, acceleration), self._recording)
            wanted = [output for output in self._outputs if recorded or output.is_heard]
            if not wanted:
                return
            with_loads = any(output.needs_loads for output in wanted)
            with_points = any(output.is_point for output in wanted)
            status, self._values = self._stepper.step(position, rate, acceleration, with_loads, with_points)
            for output in wanted:
                if status == OK or output.has_something(self._values):
                    output.send(stamp, status, self.scene.linkage.mode, self._values, self._recording)
        if status != OK:
            self.bad_steps += 1
        if status != self.status:                        # once per change, not per sample
            self._log(status, position)

    def _as_it_came(self, *given):
        """Return values of which only the input is known: those of a step may be held or clamped."""
        values = list(self._unknown)
        for place, value in zip(self._given, given):
            values[place] = value
        return values

    def timeout(self, stamp, seconds):
        """Say once on every output that the input has stopped."""
        with self._lock:
            self.status, self._values = INPUT_TIMEOUT, self._stepper.silence()
            for output in self._outputs:
                if output.has_something(self._values):
                    output.send(stamp, INPUT_TIMEOUT, self.scene.linkage.mode, self._values, self._recording)
        self._node.get_logger().warning(f'no input for {seconds:g} s')

    def _log(self, status, position):
        self.status = status
        say = self._node.get_logger()
        if status == OK:
            say.info('input good again')
        else:
            name, ranges = self.scene.linkage.input_coordinate.position, self.scene.linkage.input_ranges
            say.warning(str(OutOfRange(name, position, ranges)) if status == OUT_OF_RANGE
                        else f'{name} = {position!r} {UNITS[name]}: {STATUS_NAMES[status]}')
