# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Lock step with a node, from a simulator's own loop: publish, wait for the answer of that stamp.

    lockstep = LockStep(outputs=('shaking_wrench', 'equation'))
    answer = lockstep(0.001, position=0.3, rate=25.0, acceleration=0.0)
    force = answer.shaking_wrench.wrench.force

The order is settled here: the base is in effect before the input is sent, and a torque is sent
before the clock. Stamps rise strictly, so that no answer is taken for that to another question:
one at the time of the last question, or before it, is stamped a nanosecond after the last.
"""
from collections.abc import Callable, Sequence
from math import inf, isnan, nan
import time as clock
from types import SimpleNamespace
from typing import Any

from fourbar_ros.errors import FourBarError, InvalidParameter, one_of
from fourbar_ros.mechanics.bodies import Base
from fourbar_ros.numerics.arguments import finite
from fourbar_ros.ros.messages import Message, resolve, to_stamp
from fourbar_ros.ros.node.clock_input import CATCH_UP
from fourbar_ros.scene import topics
import rclpy
from rclpy.context import Context
from rclpy.executors import ExternalShutdownException
from rclpy.experimental import EventsExecutor
from rclpy.qos import DurabilityPolicy, QoSProfile
from rosgraph_msgs.msg import Clock

__all__ = ['Late', 'LockStep']

FIRST = 30.0         # [s] to find the node
AGAIN = 0.1          # [s] after which a first message is sent again, until both have met
DEPTH = 100


class Late(FourBarError):
    """An answer of a step did not come, or is not of this step."""


class LockStep:
    """
    Steps a node from a simulator's loop.

    ``node``: name with namespace; ``outputs``: topics to wait for, by their names in ``outputs``;
    ``patience``: how long an answer may take [s].
    """

    def __init__(self, node: str = 'fourbar', outputs: Sequence[str] = ('shaking_wrench',),
                 patience: float = 5.0) -> None:
        """Make a node of this process that subscribes to the outputs of the other one."""
        known = [name for name in topics.OUTPUTS if name not in topics.FAMILIES]
        self._outputs = (outputs,) if isinstance(outputs, str) else tuple(outputs)
        for output in self._outputs:
            if output not in known:
                raise InvalidParameter('outputs', output, one_of(known, output))
        self._context = Context()            # whatever else uses ROS in this process
        self._context.init()
        name = f'{node.strip("/").replace("/", "_")}_lock_step'
        self._client = rclpy.create_node(name, context=self._context)
        self._node, self._patience = node, patience
        self._executor = EventsExecutor(context=self._context)
        self._executor.add_node(self._client)
        self._newest: dict[str, Message] = {}        # of each topic, by their short names
        self._publishers: dict[str, Any] = {}
        self._heard: list[Any] = []          # subscriptions
        self._clock: Any = None              # publisher of /clock
        self._met: set[str] = set()          # topics that have answered once
        self._asked = 0                      # [ns] newest stamp that was sent
        for output in self._outputs:
            self._listen(topics.OUTPUTS[output])

    def __call__(self, time: float, position: float, rate: float = nan, acceleration: float = nan,
                 base: Base | Message | None = None) -> SimpleNamespace:
        """
        Return the answer to an input at a time [s]: a message for each output, by its name.

        For a node with ``drive.source: motion``; rates that are NaN are estimated. ``base``: a
        Base for one with ``base.topic: motion_of_base``, a sensor_msgs/Imu for ``imu``; the input
        is sent when it is in effect. A time may come again or go back, as in the stages of a
        Runge-Kutta step, unless rates come from the stamps: then InvalidParameter. Raises Late,
        also if somebody else sends inputs to the node.
        """
        is_estimated = (isnan(rate) or isnan(acceleration)
                        or base is not None and not isinstance(base, Base))
        stamp = self._stamp(time, 'rates are estimated from the stamps' if is_estimated else '')
        if base is not None:
            topic = topics.BASES['motion_of_base' if isinstance(base, Base) else 'imu']
            if topic.name not in self._publishers:
                self._listen(topics.BASE, QoSProfile(
                    depth=DEPTH, durability=DurabilityPolicy.TRANSIENT_LOCAL))
            fields = (base._asdict() if isinstance(base, Base) else
                      {'linear_acceleration': base.linear_acceleration,
                       'angular_velocity': base.angular_velocity})
            try:
                self._ask(topic, (topics.BASE.name,), stamp, **fields)
            except Late as error:
                raise Late(f'{error}; does its scene have base.topic: {topic.name}?') from None
        return self._ask(topics.INPUTS['motion'], self._outputs, stamp, position=position,
                         velocity=rate, acceleration=acceleration)

    def push(self, time: float, torque: float) -> SimpleNamespace:
        """
        Return the answer to a torque [N m], or force [N], up to a time [s] of the simulation.

        For a node with ``drive.source: torque`` and ``use_sim_time``: sends the torque, then the
        clock. Raises Late, also if the step was made with another torque; InvalidParameter for a
        time that does not rise, or by so much that the node would skip steps.
        """
        send = self._publisher(topics.TORQUE)
        stamp = self._stamp(time, 'the clock of a simulation only goes on', CATCH_UP)
        if self._clock is None:
            self._clock = self._client.create_publisher(Clock, '/clock', DEPTH)
            self._listen(topics.DRIVE_STATE)
            # a clock cannot be sent again: first all must have found each other
            end = clock.monotonic() + FIRST
            while not (self._clock.get_subscription_count() and send.get_subscription_count()
                       and all(each.get_publisher_count() for each in self._heard)):
                if clock.monotonic() > end:
                    raise Late(f'{self._node}: not found, or it takes no torque and clock')
                self._executor.spin_once(timeout_sec=AGAIN)
            clock.sleep(AGAIN)
        self._be_alone(send)
        message = send.msg_type()
        message.wrench.torque.z = message.wrench.force.x = float(torque)
        send.publish(message)
        answer = self._wait((*self._outputs, topics.DRIVE_STATE.name), stamp,
                            lambda: self._clock.publish(Clock(clock=stamp)))
        if answer.drive_state.step and answer.drive_state.command != torque:
            raise Late(f'{self._name(topics.TORQUE)}: the step to {time:g} s was made with '
                       f'{answer.drive_state.command:g}, not {torque:g}')
        return answer

    def close(self) -> None:
        self._executor.shutdown()
        self._client.destroy_node()
        self._context.try_shutdown()

    def _name(self, topic: topics.Topic) -> str:
        return topics.full_name(topic.topic, self._node)

    def _listen(self, topic: topics.Topic, qos: QoSProfile | int = DEPTH) -> None:
        def keep(message: Message) -> None:
            self._newest[topic.name] = message
        self._heard.append(self._client.create_subscription(
            resolve(topic.type), self._name(topic), keep, qos))

    def _publisher(self, topic: topics.Topic) -> Any:
        if topic.name not in self._publishers:
            self._publishers[topic.name] = self._client.create_publisher(
                resolve(topic.type), self._name(topic), DEPTH)
        return self._publishers[topic.name]

    def _stamp(self, time: float, why_it_must_rise: str, longest: float = inf) -> Any:
        """
        Return a stamp above that of the last question: of a time [s], or 1 ns later.

        ``why_it_must_rise``: '' where the time may also stand still or go back. A pause longer
        than ``longest`` [s] is refused.
        """
        stamp = round(finite('time', time, 'must be above zero: a stamp of 0 is none',
                             above=0.0) * 1e9)
        last = f'the last one, {self._asked * 1e-9:.9g}'
        if why_it_must_rise and stamp <= self._asked:
            raise InvalidParameter('time', time, f'must be above {last}: {why_it_must_rise}')
        if self._asked and stamp - self._asked > longest * 1e9:
            raise InvalidParameter('time', time, f'must be at most {longest:g} s above {last}: '
                                   'the node skips the steps of a longer pause')
        self._asked = max(stamp, self._asked + 1)
        return to_stamp(self._asked)

    def _be_alone(self, publisher: Any) -> None:
        """Raise Late if others send on a topic too: answers could be to their messages."""
        end = clock.monotonic() + self._patience
        while (publishers := self._client.count_publishers(publisher.topic_name) - 1) > 0:
            if clock.monotonic() > end:
                raise Late(f'{publisher.topic_name} has {publishers} other publisher'
                           f'{"s" if publishers > 1 else ""}: one LockStep alone can step a node')
            self._executor.spin_once(timeout_sec=AGAIN)

    def _ask(self, topic: topics.Topic, names: Sequence[str], stamp: Any, **fields: Any
             ) -> SimpleNamespace:
        message = resolve(topic.type)(**fields)
        message.header.stamp = stamp
        publisher = self._publisher(topic)
        self._be_alone(publisher)
        return self._wait(names, stamp, lambda: publisher.publish(message))

    def _wait(self, names: Sequence[str], stamp: Any, send: Callable[[], None]
              ) -> SimpleNamespace:
        """Send a question until all topics have an answer of its stamp; return these, or Late."""
        missing, is_first = set(names), not self._met.issuperset(names)
        end = clock.monotonic() + (FIRST if is_first else self._patience)
        again = 0.0
        while missing:
            now = clock.monotonic()
            if now > end:
                raise Late(f'no answer of {stamp.sec}.{stamp.nanosec:09d} s on '
                           f'{", ".join(sorted(missing))} from {self._node}')
            if now >= again:
                send()
                again = now + AGAIN if is_first else end + 1.0
            try:
                self._executor.spin_once(timeout_sec=AGAIN)
            except ExternalShutdownException:
                raise Late('ROS was shut down') from None
            missing = {name for name in missing if name not in self._newest
                       or self._newest[name].header.stamp != stamp}
        self._met.update(names)
        return SimpleNamespace(**{name: self._newest[name] for name in names})
