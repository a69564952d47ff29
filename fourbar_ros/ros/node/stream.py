"""From one input to everything that is heard or recorded."""
from __future__ import annotations

import threading
from math import nan, sin
from typing import NamedTuple

from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.serialization import serialize_message
from std_msgs.msg import String

from fourbar_ros.scene.topics import DRIVEN, SCENE
from fourbar_ros.errors import UNITS, FourBarError, OutOfRange
from fourbar_ros.pipeline.status import INPUT_TIMEOUT, OK, OUT_OF_RANGE, STATUS_NAMES
from fourbar_ros.pipeline.stepper import Stepper
from fourbar_ros.ros.node import qos
from fourbar_ros.ros.node.publishers import Output


class Wanted(NamedTuple):
    """What a step is for: outputs, and what has to be computed for them."""

    driven: bool
    outputs: list
    with_loads: bool
    with_points: bool


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
        self._driven, self._outputs = self._output(DRIVEN), []
        self._scene_publisher = qos.create(
            node, 'publisher', String, SCENE.topic, QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL))
        self._stepper, self._applied = Stepper(scene), {}
        if scene.wrenches.links:
            from fourbar_ros.ros.node.wrenches import Applied  # only scenes that are loaded from outside need its messages
            self._applied = {link: Applied(node, link) for link in scene.wrenches.links}
        self.apply(scene)
        for link, wrench in self._stepper.acting.items():
            self.act(link, wrench, node.get_clock().now().to_msg())

    def apply(self, scene):
        """Take over a scene: linkage, outputs; publish and record it."""
        with self._lock:
            self.scene, self._layout = scene, scene.layout
            self._stepper, self._mode = Stepper(scene, self._stepper.acting), scene.linkage.mode
            self._values = self._unknown = (nan,) * len(self._layout.place)
            self._given = [self._layout.place[name] for name in scene.linkage.input_coordinate]
            there = {output.name: output for output in self._outputs}
            for name in there.keys() - scene.topics.keys():
                there[name].destroy()
            self._outputs = [there.get(name) or self._output(topic) for name, topic in scene.topics.items()]
            for output in (self._driven, *self._outputs):
                output.apply(scene)
            self._look_who_listens()
            self._send_scene()

    def _output(self, topic):
        return Output(self._node, topic, self._look_who_listens)

    def _look_who_listens(self):
        """Note what a step is for: asked when a reader comes or leaves, not in every step."""
        def wanted(those):
            outputs = [output for output in self._outputs if output in those]
            return Wanted(self._driven in those, outputs, any(output.needs_loads for output in outputs),
                          any(output.is_point for output in outputs))

        every = [self._driven, *self._outputs]
        self._all, self._heard = wanted(every), wanted([output for output in every if output.is_heard])

    def start_recording(self, name=''):
        """Start a bag whose first message is the scene; returns its path; raises FourBarError."""
        scene = self.scene
        bag = self._recording.open(scene, name)          # outside of the lock: the disk may be slow
        with self._lock:
            if self.scene.topics == scene.topics:
                path = self._recording.attach(bag)
                # Nothing is held from before: the bag computes again alone.
                self._stepper = Stepper(self.scene, self._stepper.acting)
                self._recording.write(SCENE.name, self._scene_bytes())
                for applied in self._applied.values():
                    self._recording.write(applied.name, applied.data)
                return path
        bag.writer.close()
        raise FourBarError('the outputs were changed meanwhile: ask again')

    def act(self, link, wrench, stamp):
        """Have a Wrench act on a link from the next step on; publish and record it."""
        with self._lock:
            self._stepper.act(link, wrench)
            self._applied[link].send(stamp, wrench, self.scene.frame_id, self._recording)

    def _scene_bytes(self):
        return serialize_message(String(data=self.scene.as_json))

    def _send_scene(self):
        data = self._scene_bytes()
        self._scene_publisher.publish(data)
        self._recording.write(SCENE.name, data)

    def transmission_sine(self):
        """Return |sin| of the transmission angle of the newest step that was computed, or NaN."""
        return abs(sin(self._values[self._layout.place['transmission_angle']]))

    def step(self, stamp, position, rate, acceleration):
        """Evaluate one input and send what is heard or recorded; ``stamp``: (seconds, nanoseconds)."""
        with self._lock:
            self.steps += 1
            wanted = self._all if self._recording.active else self._heard
            if wanted.driven:
                self._send([self._driven], stamp, OK, self._as_it_came(position, rate, acceleration))
            if not wanted.outputs:
                return
            status, self._values = self._stepper.step(position, rate, acceleration,
                                                      wanted.with_loads, wanted.with_points)
            self._send(wanted.outputs, stamp, status, self._values)
        if status != OK:
            self.bad_steps += 1
        if status != self.status:                        # once per change, not per sample
            self._log(status, position)

    def _send(self, outputs, stamp, status, values):
        """Send and record; first all is packed, then sent at one go: so the middleware wakes up less often."""
        mode, recording = self._mode, self._recording
        if status != OK:
            outputs = [output for output in outputs if output.has_something(values)]
        packed = [(output, output.pack(stamp, status, mode, values)) for output in outputs]
        for output, data in packed:
            if output.is_heard:                          # it may be wanted for the bag alone
                output.publish(data)
        if recording.active:
            for output, data in packed:
                recording.write(output.name, data)

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
            self._send(self._outputs, stamp, INPUT_TIMEOUT, self._values)
        self._node.log.warning('timeout', f'no input for {seconds:g} s')

    def _log(self, status, position):
        self.status = status
        if status == OK:
            self._node.log.info(status, 'input good again')
        else:
            name, ranges = self.scene.linkage.input_coordinate.position, self.scene.linkage.input_ranges
            self._node.log.warning(status, str(OutOfRange(name, position, ranges)) if status == OUT_OF_RANGE
                                   else f'{name} = {position!r} {UNITS[name]}: {STATUS_NAMES[status]}')
