# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The steps of a node: from one input to all outputs that a subscriber or a bag wants."""
from __future__ import annotations

from collections.abc import Callable
from math import nan, sin
from pathlib import Path
import threading
from typing import NamedTuple, TYPE_CHECKING

from builtin_interfaces.msg import Time
from fourbar_ros.errors import FourBarError, InvalidParameter, OutOfRange
from fourbar_ros.pipeline.status import INPUT_TIMEOUT, OK, OUT_OF_RANGE, STATUS_NAMES
from fourbar_ros.pipeline.stepper import InModes
from fourbar_ros.pipeline.wrenches import Wrench
from fourbar_ros.ros.messages import Stamp
from fourbar_ros.ros.node import qos
from fourbar_ros.ros.node.base import Base
from fourbar_ros.ros.node.outputs import Outputs, Wanted, Writer
from fourbar_ros.ros.node.pictures import Drawn, drawn_of, Pictures
from fourbar_ros.ros.node.recording import Recording
from fourbar_ros.scene.scene import Scene
from fourbar_ros.scene.topics import applied_topic, SCENE
from geometry_msgs.msg import WrenchStamped
from rclpy.serialization import serialize_message
from std_msgs.msg import String

if TYPE_CHECKING:
    from fourbar_ros.dynamics.step.mover import DriveValues


class Prepared(NamedTuple):
    """A scene with what it needs, made while the steps of the scene before it go on."""

    scene: Scene
    drawn: Drawn
    writers: dict[str, Writer]
    data: bytes                              # the message of the scene


class Stream:
    """
    The steps of a node: each evaluates one pose of the input and sends the outputs.

    Steps run one at a time; a scene, a wrench and a recording change between two of them.
    """

    scene: Scene                             # in force

    def __init__(self, node: Base, scene: Scene, recording: Recording) -> None:
        self._recording, self._log = recording, node.log
        self._lock = threading.Lock()        # held in a step, and while anything changes
        self.steps, self.bad_steps = 0, 0    # since the start; bad: the status was not OK
        self.status = OK                     # of the last step that was computed
        self.outputs, self.pictures = Outputs(node, recording), Pictures(node, recording)
        self._scene_publisher = qos.publisher(node, SCENE)
        self._stepper = InModes(scene)
        # {link: the topic that tells its wrench}
        self._applied = {link: Applied(node, link) for link in scene.wrenches.links}
        self.apply(self.prepare(scene))
        for link, wrench in self._stepper.wrenches.items():
            self.act(link, wrench, node.get_clock().now().to_msg())

    # --- changes --------------------------------------------------------------------------------

    def prepare(self, scene: Scene) -> Prepared:
        """Make ready for a scene; raise FourBarError for one whose pictures cannot be drawn."""
        return Prepared(scene, drawn_of(scene), self.outputs.prepare(scene), _scene_bytes(scene))

    def apply(self, prepared: Prepared) -> None:
        """
        Take over a scene: linkage and outputs; publish and record it.

        Raises InvalidParameter, and changes nothing, for other outputs than those of an open bag.
        """
        scene = prepared.scene
        with self._lock:
            if self._recording.active and scene.outputs != self.scene.outputs:
                raise InvalidParameter('outputs', list(scene.outputs), 'not while recording')
            self.scene, self._layout = scene, scene.layout
            self._renew_stepper()
            self._values = self._unknown = (nan,) * len(self._layout.place)
            self._input_places = [self._layout.place[name]
                                  for name in scene.linkage.input_coordinate]
            self.outputs.apply(scene, prepared.writers)
            self.pictures.apply(scene, prepared.drawn)
            self._scene_publisher.publish(prepared.data)
            self._recording.write(SCENE.name, prepared.data)
            self._recording.note(SCENE.name, scene.as_json)

    def act(self, link: str, wrench: Wrench, stamp: Time) -> None:
        """Apply a Wrench [N, N m] to a link from the next step on; publish and record it."""
        with self._lock:
            self._stepper.act(link, wrench)
            self._applied[link].send(stamp, wrench, self.scene.frame_id, self._recording)

    def start_recording(self, name: str = '') -> Path:
        """Start a bag whose first message is the scene; return its path; raises FourBarError."""
        scene = self.scene
        bag = self._recording.open(scene, name)          # before the lock: the disk may be slow
        with self._lock:
            if (self.scene.topics, self.scene.pictures) == (scene.topics, scene.pictures):
                path = self._recording.attach(bag)
                self._renew_stepper()        # a value held from before could not be recomputed
                self._recording.write(SCENE.name, _scene_bytes(self.scene))
                self.pictures.record_latched()
                for applied in self._applied.values():
                    self._recording.write(applied.name, applied.data)
                return path
        bag.writer.close()
        raise FourBarError('the outputs changed in the meantime: try again')

    def stop_recording(self, why: str) -> Path | None:
        """Close the bag after a whole step, note ``why`` in it; return its path, None if none."""
        with self._lock:
            writer = self._recording.detach()
        return self._recording.close(writer, why) if writer else None    # it waits for the disk

    @property
    def is_heard(self) -> bool:
        """Return whether any message of a step has a subscriber or goes into a bag."""
        return self.outputs.are_heard or self._recording.active or self.pictures.are_seen

    def _renew_stepper(self) -> None:
        """Evaluate the scene from now on, without values held from before."""
        self._stepper = InModes(self.scene, self._stepper.wrenches)
        self._mode = self._stepper.own_mode
        if self.scene.dynamics:
            self._stepper.prepare(self.scene.dynamics.modes_passed(self.scene.linkage))

    # --- steps ----------------------------------------------------------------------------------

    def step(self, stamp: Stamp, position: float, rate: float, acceleration: float) -> None:
        """Evaluate the input [rad or m, /s, /s^2] at a stamp and send the outputs."""
        with self._lock:
            status = self._step(stamp, position, rate, acceleration, self.outputs.wanted())
        self._note(status, position)

    def step_by(self, stamp: Stamp, move: Callable[[], tuple[int, int, DriveValues]]) -> None:
        """
        Move by a torque drive and evaluate its new state.

        ``move()`` returns the drive's status, the assembly mode, and the DriveValues. The lock is
        held from before it until the outputs are sent: a bag has a step after all torques and
        wrenches that influenced it.
        """
        with self._lock:
            wanted, (drive_status, mode, values) = self.outputs.wanted(), move()
            self._mode = self.outputs.mode = mode
            if wanted.drive_state:
                self.outputs.send_drive_state(stamp, drive_status, values)
            status = self._step(stamp, values.position, values.velocity, values.acceleration,
                                wanted)
        self._note(status, values.position)

    def between_steps(self, topic: str, data: bytes, take: Callable[[], None]) -> None:
        """Record a message of an input and let ``take()`` use it, between two steps."""
        with self._lock:
            self._recording.write(topic, data)
            take()

    def _step(self, stamp: Stamp, position: float, rate: float, acceleration: float, wanted: Wanted
              ) -> int | None:
        """Compute and send the wanted outputs; return the status, None if there are none."""
        self.steps += 1
        if wanted.driven:
            # the input as it came; the evaluation's input may be held or clamped
            driven = list(self._unknown)
            for place, value in zip(self._input_places, (position, rate, acceleration)):
                driven[place] = value
            self.outputs.send_driven(stamp, driven)
        drawn = self.pictures.due(stamp)
        if not wanted.outputs and not drawn:
            self.outputs.record()
            return None
        status, self._values = self._stepper.step(
            self._mode, position, rate, acceleration,
            wanted.with_loads or 'markers' in drawn and self.pictures.of_loads, wanted.parts)
        self.outputs.send(stamp, status, self._values, wanted.outputs)
        if drawn:
            self.pictures.send(drawn, stamp, self._values)
        return status

    def _note(self, status: int | None, position: float) -> None:
        """
        Count a bad step; log a status (None: not computed) that differs from that of the last one.

        ``position`` of the input [rad or m] is for the text.
        """
        if status is None:
            return
        self.bad_steps += status != OK
        if status == self.status:
            return
        self.status, linkage = status, self.scene.linkage
        name, unit = linkage.input_coordinate.position, linkage.input_coordinate.unit
        if status == OK:
            self._log.info(status, 'input good again')
        elif status == OUT_OF_RANGE:
            self._log.warning(status, str(OutOfRange(name, position, linkage.input_ranges, unit)))
        else:
            self._log.warning(status, f'{name} = {position!r} {unit}: {STATUS_NAMES[status]}')

    def timeout(self, stamp: Stamp, seconds: float) -> None:
        """Send one message on every output with the status that the input has stopped."""
        with self._lock:
            self.status, self._values = INPUT_TIMEOUT, self._stepper.silence()
            self.outputs.send(stamp, INPUT_TIMEOUT, self._values)
        self._log.warning('timeout', f'no input for {seconds:g} s')

    def transmission_sine(self) -> float:
        """Return |sin| of the transmission angle of the latest step that was computed, or NaN."""
        return abs(sin(self._values[self._layout.place['transmission_angle']]))


def _scene_bytes(scene: Scene) -> bytes:
    return bytes(serialize_message(String(data=scene.as_json)))


class Applied:
    """The latched topic that tells which wrench the node applies to a link."""

    def __init__(self, node: Base, link: str) -> None:
        topic = applied_topic(link)
        self.name, self.data = topic.name, b''
        self._publish = node.circles.sender(qos.publisher(node, topic), topic)

    def send(self, stamp: Time, wrench: Wrench, frame_id: str, recording: Recording) -> None:
        """Publish and record a wrench; keep its bytes in ``data`` for the next bag."""
        message = WrenchStamped()
        message.header.stamp, message.header.frame_id = stamp, frame_id
        message.wrench.force.x, message.wrench.force.y, message.wrench.torque.z = wrench
        self.data = serialize_message(message)
        self._publish(self.data)
        recording.write(self.name, self.data)
