# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""External forces on links, from topics of WrenchStamped."""
from __future__ import annotations

from functools import partial

from fourbar_ros.pipeline.wrenches import a_step_later, in_silence, Wrench
from fourbar_ros.ros.node import entities
from fourbar_ros.ros.node.stream import Stream
from fourbar_ros.scene.topics import wrench_topic
from geometry_msgs.msg import WrenchStamped
from rclpy.node import Node
from rclpy.serialization import deserialize_message

PERIOD = 0.1           # [s] how often silence is looked for


class WrenchInputs:
    """
    The wrench topics of a scene, one for each loaded link.

    When a topic is silent for ``wrenches.timeout``, its link gets what the scene says: the last
    wrench or another. ``counts`` are for the diagnostics.
    """

    COUNTED = ('wrenches_malformed', 'wrenches_of_another_frame', 'wrench_silences')

    def __init__(self, node: Node, stream: Stream) -> None:
        self._node, self._stream = node, stream
        self.counts = dict.fromkeys(self.COUNTED, 0)
        # {link: arrival of its newest wrench [s] by the clock of silences}, without silent links
        self._received: dict[str, float] = {}
        self._last: dict[str, Wrench] = {}      # the last wrench of each link
        for link in stream.scene.wrenches.links:
            entities.subscription(node, wrench_topic(link), partial(self._take, link))
        self._clock = entities.clock_of(node)
        node.create_timer(PERIOD, self._watch, clock=self._clock)

    def renew(self) -> None:
        """Let act on silent links what the scene in force has for a silence."""
        for link in self._stream.scene.wrenches.links:
            if link not in self._received:
                self._be_silent(link)

    def _now(self) -> float:
        return float(self._clock.now().nanoseconds * 1e-9)

    def _take(self, link: str, data: bytes) -> None:
        """Apply the wrench of a message to a link; record it, unless ROS cannot read it."""
        topic = wrench_topic(link)
        try:
            message = deserialize_message(data, WrenchStamped)
        except Exception:
            self._count('wrenches_malformed', link, 'a message that is no WrenchStamped')
            return
        self._stream.record(topic.name, data)
        force, torque = message.wrench.force, message.wrench.torque
        frame, ours = message.header.frame_id, self._stream.scene.frame_id
        if frame not in ('', ours) and (force.x or force.y):   # a couple is equal in all frames
            self._count('wrenches_of_another_frame', link,
                        f'a force in the frame {frame!r}, this one is {ours!r}')
            return
        wrench = Wrench(force.x, force.y, torque.z)
        before = self._last.get(link) if link in self._received else None    # none in a silence
        self._received[link], self._last[link] = self._now(), wrench
        if self._stream.scene.wrenches.extrapolated:
            wrench = a_step_later(wrench, before)
        self._stream.act(link, wrench, message.header.stamp)

    def _count(self, counter: str, link: str, text: str) -> None:
        """Count a bad message, and log the first one."""
        self.counts[counter] += 1
        if self.counts[counter] == 1:
            self._node.get_logger().warning(
                f'{wrench_topic(link).topic}: {text} (logged once; counted in the diagnostics)')

    def _watch(self) -> None:
        """Look for topics that have become silent: called every PERIOD."""
        limit, now = self._stream.scene.wrenches.timeout, self._now()
        for link, last in list(self._received.items()):
            if last == 0.0 or now < last:    # simulated time has begun, or gone back
                self._received[link] = now
            elif limit and now - last > limit:
                del self._received[link]
                self.counts['wrench_silences'] += 1
                self._be_silent(link)
                self._node.get_logger().warning(
                    f'{wrench_topic(link).topic}: no wrench for {limit:g} s')

    def _be_silent(self, link: str) -> None:
        """Apply to a link the wrench that the scene has for a silence."""
        wrench = in_silence(self._stream.scene, link, self._last.get(link))
        self._stream.act(link, wrench, self._node.get_clock().now().to_msg())
