# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""What acts as topics say: external wrenches on links, and the motion of the base."""
from functools import partial
from math import hypot
from typing import Any

from fourbar_ros.pipeline.rate_estimator import gap_of
from fourbar_ros.pipeline.wrenches import a_step_later, acting_of, ActingInput, in_silence, Wrench
from fourbar_ros.ros.messages import Message
from fourbar_ros.ros.node import entities
from fourbar_ros.ros.node.stream import Stream
from fourbar_ros.scene.message_fields import nanoseconds
from fourbar_ros.scene.topics import BASE, BASES, Topic, wrench_topic
from rclpy.node import Node

PERIOD = 0.1           # [s] how often silence is looked for
OUT_OF_PLANE = 0.1     # share of a base's motion out of the linkage's plane that is worth a line


class ActingInputs:
    """The topics of wrenches and base of a scene, which says what acts when one is silent."""

    def __init__(self, node: Node, stream: Stream, troubles: entities.Troubles) -> None:
        """Subscribe to the topics of a scene that tell what acts; a timer looks for silence."""
        self._node, self._stream, self._troubles = node, stream, troubles
        # {name: arrival of its newest message [ns] by the clock of silences}, without silent ones
        self._received: dict[str, int] = {}
        self._last: dict[str, ActingInput] = {}      # the last of each
        self._topics: dict[str, Topic] = {link: wrench_topic(link)
                                          for link in stream.scene.wrenches.links}
        if self._topics:
            troubles.expect('wrenches_malformed', 'wrenches_of_another_frame', 'wrench_silences')
        if stream.scene.base.topic:
            self._topics[BASE.name] = BASES[stream.scene.base.topic]
            troubles.expect('base_malformed', 'base_of_another_frame', 'base_late',
                            'base_silences')
        self._imu_settings: tuple[Any, ...] = ()
        self._newest = 0                        # stamp of the newest message of the base [ns]
        self._read_settings()
        for name, topic in self._topics.items():
            cause = 'base_malformed' if name == BASE.name else 'wrenches_malformed'
            entities.subscription(node, topic, entities.reader(
                topic, partial(self._take, name), partial(troubles.count, cause)), troubles)
        clock, self._time = entities.clock_of(node)
        node.create_timer(PERIOD, self._watch, clock=clock)

    def _read_settings(self) -> None:
        base = self._stream.scene.base
        settings = base.rotation, base.window, gap_of(base.timeout)
        if base.topic == 'imu' and settings != self._imu_settings:    # else it keeps its rates
            from fourbar_ros.pipeline.wrenches import Imu  # imported where a scene needs it
            self._imu, self._imu_settings = Imu(*settings), settings

    def renew(self) -> None:
        """Let act in a silence what the scene in force has for one."""
        self._read_settings()
        for name in self._topics:
            if name not in self._received:
                self._be_silent(name)

    def _take(self, name: str, message: Message) -> None:
        """Record a wrench on the link ``name``, or a motion of the base, and let it act."""
        # From the next step of the stream on. Refused, and counted: a force in another frame.
        topic, is_base = self._topics[name], name == BASE.name
        self._stream.record_input(topic.name, message)
        frame, scene = message.header.frame_id, self._stream.scene
        ours = is_base and scene.base.frame_id or scene.frame_id
        has_direction = is_base or (              # a couple has none
            message.wrench.force.x != 0.0 or message.wrench.force.y != 0.0)
        if frame not in ('', ours) and has_direction:
            kind, text = ('base', 'the motion of a base') if is_base else ('wrenches', 'a force')
            self._troubles.count(f'{kind}_of_another_frame', f'{topic.topic}: {text} in the frame '
                                 f'{frame!r}, this one is {ours!r}')
            return
        acting = self._base(message) if is_base else acting_of(message)
        if acting is None:      # a motion of the base that came late
            return
        # _last: of each topic the last message, _received: when it came, but in a silence
        before = self._last.get(name) if name in self._received else None
        self._last[name] = acting
        if isinstance(acting, Wrench) and scene.wrenches.extrapolated:
            # a chain of nodes delays wrenches by a step: the line through two is followed by one
            acting = a_step_later(acting, before)      # type: ignore[arg-type]  # of a link
        self._received[name] = self._time()
        self._stream.act(name, acting, message.header.stamp)

    def _base(self, message: Message) -> ActingInput | None:
        """Return the motion of the base from a message on; None for one that comes late."""
        stamp, settings = message.header.stamp, self._stream.scene.base
        time = stamp.sec * 10**9 + stamp.nanosec
        if self._newest != 0 and 0 <= self._newest - time < nanoseconds(gap_of(settings.timeout)):
            self._troubles.count('base_late', f'{self._topics[BASE.name].topic}: a stamp that is '
                                 'not newer than the one before')
            return None
        self._newest = time
        if settings.topic != 'imu':
            return acting_of(message)
        force, rate = message.linear_acceleration, message.angular_velocity
        base = self._imu.update(time, (force.x, force.y, force.z), (rate.x, rate.y, rate.z))
        across, tilting = self._imu.out_of_plane
        if (across > OUT_OF_PLANE * hypot(base.force_x, base.force_y)
                or tilting > OUT_OF_PLANE * abs(base.rate)):
            self._troubles.log('base', f'{BASES["imu"].topic}: {across:.3g} m/s^2 and '
                               f"{tilting:.3g} rad/s lie out of the linkage's plane: they are "
                               'left out', 'info')
        return base

    def _watch(self) -> None:
        """Look which topics are silent for longer than their scene allows; let others act then."""
        now, scene = self._time(), self._stream.scene
        for name, last in list(self._received.items()):
            is_base = name == BASE.name
            limit = scene.base.timeout if is_base else scene.wrenches.timeout
            if last == 0 or now < last:    # simulated time has begun, or gone back
                self._received[name] = now
            elif limit != 0.0 and now - last > nanoseconds(limit):
                del self._received[name]
                self._troubles.count('base_silences' if is_base else 'wrench_silences')
                self._be_silent(name)
                self._troubles.log(f'silence of {name}', f'{self._topics[name].topic}: no '
                                   f'{"message" if is_base else "wrench"} for {limit:g} s')

    def _be_silent(self, name: str) -> None:
        acting = in_silence(self._stream.scene, name, self._last.get(name))
        self._stream.act(name, acting, self._node.get_clock().now().to_msg())
