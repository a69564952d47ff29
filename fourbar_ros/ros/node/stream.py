# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The steps of a node: from one input to all outputs that a subscriber or a bag wants.

Each message is serialised once: the same bytes go to the subscribers and to the bag.
"""
from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from math import isnan, sin
from pathlib import Path
import threading
from typing import NamedTuple, TYPE_CHECKING

from builtin_interfaces.msg import Time
from fourbar_ros.errors import FourBarError, InvalidParameter, OutOfRange
from fourbar_ros.mechanics.bodies import Base
from fourbar_ros.mechanisms.parts import mode_number
from fourbar_ros.pipeline import stepper as pipeline
from fourbar_ros.pipeline.stepper import OK, Wanted
from fourbar_ros.ros import messages
from fourbar_ros.ros.messages import Message, resolve, Stamp
from fourbar_ros.ros.node.entities import Troubles
from fourbar_ros.ros.node.rclpy_guard import TopicPublisher
from fourbar_ros.ros.node.recording import Recording
from fourbar_ros.scene.message_fields import FieldMap
from fourbar_ros.scene.scene import no_pause, Scene
from fourbar_ros.scene.topics import applied_topic, DRIVE_STATE, DRIVEN, SCENE, Topic
from rclpy.node import Node
from rclpy.serialization import serialize_message
from std_msgs.msg import String

if TYPE_CHECKING:      # imported where a scene needs them
    from fourbar_ros.dynamics.node_step import DriveValues
    from fourbar_ros.pipeline.wrenches import ActingInput

Make = Callable[[Stamp, Sequence[float]], Message]      # None where the pose is not known


class Stream:
    """The steps of a node, one at a time; what is in force changes between two of them."""

    def __init__(self, node: Node, run: RunningScene, recording: Recording,
                 troubles: Troubles) -> None:
        """Publish what a scene in force publishes; steps come by :meth:`step`."""
        self._node, self.run, self._recording, self._log = node, run, recording, troubles.log
        self._lock = threading.Lock()        # held in a step, and while anything changes
        self.steps, self.bad_steps = 0, 0    # since the start; bad: the status was not OK
        self.status = OK                     # of the last step that was computed
        self._values = run.unknown           # of that step
        self._publishers: dict[str, TopicPublisher] = {}     # of all runs so far, by short names
        self._sent: list[tuple[str, bytes]] = []     # (topic, bytes) to record at the step's end
        self._latched: dict[str, bytes] = {}     # newest messages of these topics, for a new bag
        self._markers_at: int | None = None      # [ns] stamp of the last markers
        self.swap(run)
        for name, acting in run.stepper.acting.items():
            self.act(name, acting, node.get_clock().now().to_msg())

    @property
    def scene(self) -> Scene:
        return self.run.scene

    @property
    def is_recording(self) -> bool:
        return self._recording.active

    def now(self) -> Stamp:
        return messages.sec_nanosec(self._node.get_clock().now().nanoseconds)

    def topics(self) -> list[str]:
        return [self._publishers[name].topic for name in self.run.topics]

    # --- changes --------------------------------------------------------------------------------

    def swap(self, run: RunningScene) -> None:
        """Let another run be in force; InvalidParameter for other outputs than an open bag has."""
        outputs = run.scene.outputs
        with self._lock:
            if self.is_recording and outputs != self.scene.outputs:
                raise InvalidParameter('outputs', list(outputs), 'not while recording')
            for name, topic in run.topics.items():
                if name not in self._publishers:
                    self._publishers[name] = TopicPublisher(self._node, topic, self._update)
            for name, acting in self.run.stepper.acting.items():
                if acting is not run.stepper.acting[name]:   # it came while the run was made
                    run.act(name, acting)
            if self.run.stepper.joints and run.stepper.joints:   # they moved meanwhile
                run.stepper.joints.angles = self.run.stepper.joints.angles
            self.run, self._values, self._markers_at = run, run.unknown, None
            self._update()
            for name, data in run.latched.items():
                self._latch(name, data)
            self._recording.note(SCENE.name, run.scene.as_json)

    def _update(self) -> None:
        """Note what steps have to compute: in every step that would take too long."""
        self._all = Wanted.of(self.scene)
        self._subscribed = Wanted.of(self.scene, [
            name for name in self.run.topics if self._publishers[name].is_subscribed])

    def act(self, name: str, acting: ActingInput, stamp: Time) -> None:
        """Let a wrench act on a link, or the base move, from the next step on; say so."""
        topic = applied_topic(name)
        message = resolve(topic.type)()
        message.header.stamp, message.header.frame_id = stamp, self.scene.frame_id
        if isinstance(acting, Base):
            message.force_x, message.force_y, message.rate, message.acceleration = acting
        else:
            message.wrench.force.x, message.wrench.force.y, message.wrench.torque.z = acting
        data = serialize_message(message)
        with self._lock:
            self.run.act(name, acting)
            self._latch(topic.name, data)

    def _latch(self, name: str, data: bytes) -> None:
        """Publish and record a message of a latched topic; each new bag begins with it."""
        self._latched[name] = data
        self._publishers[name].publish(data)
        self.record(name, data)

    def start_recording(self, name: str = '') -> Path:
        """Start a bag whose first message is the scene; return its path; raises FourBarError."""
        before = self.run
        bag = self._recording.open(before.scene, name)   # before the lock: the disk may be slow
        with self._lock:
            run = self.run
            if run.topics == before.topics:
                path = self._recording.attach(bag)
                run.renew(run.stepper.acting, run)     # a held value could not be recomputed
                for topic, data in self._latched.items():
                    self.record(topic, data)
                return path
        bag[0].close()
        raise FourBarError('the outputs changed in the meantime: try again')

    def stop_recording(self, why: str) -> Path | None:
        """Close the bag after a whole step, note ``why`` in it; return its path, None if none."""
        with self._lock:
            writer = self._recording.detach()
        return self._recording.close(writer, why) if writer else None    # it waits for the disk

    def record(self, topic: str, data: bytes) -> None:
        self._recording.write([(topic, data)])

    def record_input(self, topic: str, message: Message) -> None:
        """Record an input as ROS has read it, which takes bytes that others refuse."""
        if self.is_recording:
            self.record(topic, bytes(serialize_message(message)))

    # --- steps ----------------------------------------------------------------------------------

    def step(self, stamp: Stamp, position: float, rate: float, acceleration: float) -> None:
        """Evaluate the input [rad or m, /s, /s^2] at a stamp and send the outputs."""
        with self._lock:
            status = self._step(stamp, self.run.mode, position, rate, acceleration,
                                self._wanted())
        self._note(status, position)

    def step_by(self, stamp: Stamp, move: Callable[[], tuple[int, int, DriveValues]]) -> None:
        """
        Move by a torque and evaluate the new state.

        ``move()`` returns the drive's status, the assembly mode, and the DriveValues. The lock is
        held from before it until the outputs are sent: a bag has a step after all torques and
        wrenches that influenced it.
        """
        with self._lock:
            wanted, (drive_status, mode, values) = self._wanted(), move()
            if wanted.drive_state:
                self._send([DRIVE_STATE.name], stamp, drive_status, mode, values)
            status = self._step(stamp, mode, values.position, values.velocity,
                                values.acceleration, wanted)
        self._note(status, values.position)

    def timeout(self, seconds: float) -> None:
        """Send one message on every output with the status that the input has stopped."""
        with self._lock:
            self.status, self._values = pipeline.INPUT_TIMEOUT, self.run.stepper.silence()
            self._send(self._known(self.run.outputs), self.now(), self.status, self.run.mode,
                       self._values)
            self._record()
        self._log('timeout', f'no input for {seconds:g} s')

    def transmission_sine(self) -> float:
        """Return |sin| of the transmission angle of the latest step that was computed, or NaN."""
        return abs(sin(self._values[self.run.layout.index_of['transmission_angle']]))

    def _wanted(self) -> Wanted:
        return self._all if self.is_recording else self._subscribed

    def _step(self, stamp: Stamp, mode: int, position: float, rate: float, acceleration: float,
              wanted: Wanted) -> int | None:
        """Compute and send the wanted outputs; return the status, None if there are none."""
        self.steps += 1
        run = self.run
        if wanted.driven:
            # the input as it came; the evaluation's input may be held or clamped
            driven = list(run.unknown)
            for index, value in zip(run.inputs, (position, rate, acceleration)):
                driven[index] = value
            self._send([DRIVEN.name], stamp, OK, mode, driven)
        drawn = wanted.pictures
        if 'markers' in drawn:
            # pictures.rate limits them, not tf, which must not be older than the joint states
            # 0.99: jitter of stamps must not turn every third sample into every fourth
            now, last, most = stamp[0] * 10**9 + stamp[1], self._markers_at, run.markers_rate
            if most != 0.0 and last is not None and 0 <= now - last < 0.99e9 / most:
                drawn = tuple(name for name in drawn if name != 'markers')
            else:
                self._markers_at = now
        if not wanted.outputs and not drawn:
            self._record()
            return None
        if 'markers' in drawn and run.scene.linkage.bodies is not None:
            wanted = wanted._replace(with_loads=True)
        status, self._values = run.stepper.step(position, rate, acceleration, wanted, mode)
        outputs: Iterable[str] = (wanted.outputs if status == OK
                                  else self._known(wanted.outputs))
        self._send(outputs, stamp, status, mode, self._values)
        for name in drawn:
            message = run.makers[name](stamp, self._values)
            if message is not None:
                self._publish([(name, serialize_message(message))])
        self._record()
        return status

    def _known(self, outputs: Iterable[str]) -> list[str]:
        """Return the outputs without those that must not send NaN but would, as joint_states."""
        return [name for name in outputs
                if not any(isnan(self._values[index]) for index in self.run.needed[name])]

    def _send(self, names: Iterable[str], stamp: Stamp, status: int, mode: int,
              values: Sequence[float]) -> None:
        """Pack all messages, then publish them together: so the middleware wakes up less often."""
        writers = self.run.writers
        self._publish([(name, writers[name].pack(stamp, status, mode, values)) for name in names])

    def _publish(self, sent: list[tuple[str, bytes]]) -> None:
        for name, data in sent:
            publisher = self._publishers[name]
            if publisher.is_subscribed:                  # else the message is for the bag alone
                publisher.publish(data)
        if self.is_recording:
            self._sent += sent

    def _record(self) -> None:
        if self._sent:
            sent, self._sent = self._sent, []
            self._recording.write(sent)

    def _note(self, status: int | None, position: float) -> None:
        """Count a bad step; log a status, None: not computed, that differs from the last one."""
        self.bad_steps += status not in (OK, None)
        if status in (self.status, None):
            return
        self.status, linkage = status, self.scene.linkage
        name, unit = linkage.input_coordinate.position, linkage.input_coordinate.unit
        if status == OK:
            self._log('good', 'input good again', 'info')
        elif status == pipeline.OUT_OF_RANGE:
            self._log('out_of_range', str(OutOfRange(name, position, linkage.input_ranges, unit)))
        else:
            self._log(f'status_{status}',
                      f'{name} = {position!r} {unit}: {pipeline.STATUS_NAMES[status]}')


# --- a scene with all that its steps need --------------------------------------------------------

class Writer(NamedTuple):
    """Makes the messages of a topic; ``key``: all of the scene that is in their bytes."""

    key: object
    pack: messages.Pack


class RunningScene:
    """
    A scene in force: its steppers, its messages, its pictures, its equation of motion.

    ``topics`` are all that it publishes. Each step is answered on those of ``writers``, and drawn
    by ``makers``; ``latched`` are messages that do not change. ``mover`` integrates the motion
    where it follows from torque. ``acting``: what acts from the first step on. ``before`` is the
    run whose writers are used again where nothing in their bytes has changed; ``pause()`` is
    called between two pieces of the work. FourBarError for a scene whose pictures cannot be drawn.
    """

    def __init__(self, scene: Scene, before: RunningScene | None = None,
                 acting: Mapping[str, ActingInput] | None = None,
                 pause: Callable[[], None] = no_pause) -> None:
        """Make all that a step of the scene needs, so that no step has to wait for it."""
        self.scene, self.layout = scene, scene.layout
        if before and before.layout == scene.layout:
            self.layout = before.layout      # writers compare it: as the same object at once
        self.mode = mode_number(scene.linkage.mode)
        self.unknown = self.layout.unknown
        self.inputs = [self.layout.index_of[name] for name in scene.linkage.input_coordinate]
        of_drive = [DRIVEN, DRIVE_STATE] if scene.dynamics else [DRIVEN]
        self.outputs = scene.topics
        answers = {topic.name: topic for topic in of_drive} | self.outputs
        latched = [SCENE, *map(applied_topic, scene.acting)]
        self.topics = answers | scene.pictures | {topic.name: topic for topic in latched}
        known: Mapping[str, Writer] = before.writers if before else {}
        self.writers: dict[str, Writer] = {}
        for name, topic in answers.items():
            layout = drive_layout() if topic is DRIVE_STATE else self.layout
            self.writers[name] = writer_of(topic, scene, layout, known.get(name))
        # indices of the values without which a message of an output is not sent
        self.needed = {name: scene.needed_for(name) for name in self.outputs}
        self.makers: dict[str, Make] = {}        # of pictures
        self.latched = {SCENE.name: bytes(serialize_message(String(data=scene.as_json)))}
        if scene.pictures:
            from fourbar_ros.ros.node.pictures import drawn_of  # and their messages
            self.makers, pictures = drawn_of(scene)
            self.latched |= pictures
            self.markers_rate: float = scene.values['pictures.rate']
        self.mover = scene.mover if scene.dynamics else None
        if self.mover:
            self.mover.prepare()             # now, not in the first step
        self.conversion = None
        if scene.values['trajectories']:
            from fourbar_ros.ros.node.trajectories import Conversion  # and its messages
            self.conversion = Conversion(scene)
        pause()
        self.renew(acting, before)

    def renew(self, acting: Mapping[str, ActingInput] | None = None,
              before: RunningScene | None = None) -> None:
        """Evaluate the scene from now on without values held from before; its joints go on."""
        joints = before.stepper.joints if before else None
        self.stepper: pipeline.Stepper = pipeline.Stepper(self.scene, acting, pipeline.joints_of(
            self.scene, joints.angles if joints else None))
        if self.mover:
            self.stepper.prepare(self.mover.modes)
            for name, value in self.stepper.acting.items():
                self.mover.act(name, value)

    def act(self, name: str, acting: ActingInput) -> None:
        """Let a wrench act on a link, or the base move, from the next step on."""
        self.stepper.act(name, acting)
        if self.mover:
            self.mover.act(name, acting)


def writer_of(topic: Topic, scene: Scene, layout: FieldMap, known: Writer | None = None
              ) -> Writer:
    """Return the Writer of a topic: the known one, unless more than values has changed."""
    kind = resolve(topic.type)
    key = (layout, scene.frame_id, scene.names_shown,
           scene.linkage.change_point_margin if hasattr(kind, 'change_point_margin') else None)
    if known and known.key == key:
        return known
    message = kind()                         # one for all steps
    messages.set_constants(topic.name, message, scene)
    return Writer(key, messages.packer(topic.name, message, layout))


def drive_layout() -> FieldMap:
    """Return which value of DriveValues goes into which field of DriveState: names are equal."""
    from fourbar_ros.dynamics.node_step import DriveValues  # only these scenes need it
    names = DriveValues._fields
    return FieldMap({DRIVE_STATE.name: dict(zip(names, names))}, {},
                    {name: i for i, name in enumerate(names)}, (), {})
