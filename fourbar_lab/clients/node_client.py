# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""A client of a running node: finds it, listens to it, drives it, calls its services."""
from collections.abc import Callable, Iterator
from contextlib import contextmanager
import time
from typing import Any, TypeVar

from fourbar_ros.errors import FourBarError
from fourbar_ros.ros.messages import Message, resolve
from fourbar_ros.ros.node.start import caught_signals, Signals
from fourbar_ros.ros.refusals import in_one_line, init
from fourbar_ros.scene.files import NODE
from fourbar_ros.scene.topics import full_name, INPUT_DEPTH, INPUTS, SERVICES, Topic
import rclpy
import rclpy.client
from rclpy.experimental import EventsExecutor
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import QoSProfile
from rclpy.signals import SignalHandlerOptions
from rclpy.subscription import Subscription

PATIENCE = 10.0             # [s] to find a node or get an answer; discovery may take 4 s
POLL = 0.02                 # [s] between two looks at a condition


class NoAnswer(FourBarError):
    """A node was not found, did not answer, or refused."""


class NodeClient:
    """
    Talks to nodes through an rclpy node of its own, which the caller makes and destroys.

    ``patience``: how long to wait for anything by default [s].
    """

    def __init__(self, node: Node, patience: float = PATIENCE) -> None:
        self.node, self.patience = node, patience
        self.executor = EventsExecutor()
        self.executor.add_node(node)
        self._services: dict[str, rclpy.client.Client] = {}
        self.signals: Signals = []           # that have come and end the program

    def spin(self, seconds: float) -> None:
        end = time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0.0:
            self._spin_once(left)

    def _spin_once(self, seconds: float) -> None:
        self.executor.spin_once(timeout_sec=seconds)
        if self.signals:        # the executor survives no exception of their handlers
            raise SystemExit(128 + self.signals[0])

    def until(self, condition: Callable[[], bool], failure: str,
              patience: float | None = None) -> None:
        """Handle messages until the condition holds; NoAnswer(failure) after ``patience`` [s]."""
        patience = self.patience if patience is None else patience
        end = time.monotonic() + patience
        while not condition():
            if time.monotonic() > end:
                raise NoAnswer(f'{failure} (waited {patience:g} s)')
            self._spin_once(POLL)

    def subscribe(self, topic: Topic, take: Callable[[Message], None], node: str = NODE,
                  depth: int = INPUT_DEPTH) -> Subscription:
        """Return a subscription that calls ``take(message)``."""
        return self.node.create_subscription(
            resolve(topic.type), full_name(topic.topic, node), take, QoSProfile(depth=depth))

    def publisher(self, source: str, node: str = NODE) -> Publisher:
        """Return a publisher on an input topic of a node: ``motion`` or ``joint_state``."""
        topic = INPUTS[source]
        return self.node.create_publisher(
            resolve(topic.type), full_name(topic.topic, node), INPUT_DEPTH)

    def call(self, service_name: str, /, node: str = NODE, **request: Any) -> Message:
        """Call a service of a node with the fields of its request; return the response."""
        service = self.service(service_name, node)
        answer = service.call_async(service.srv_type.Request(**request))
        self.until(answer.done, f'{service.service_name}: no answer')
        return answer.result()

    def service(self, service_name: str, node: str = NODE) -> rclpy.client.Client:
        """Return the rclpy client of a service, once its server is found."""
        name = full_name(SERVICES[service_name].service, node)
        if name not in self._services:
            service = self.node.create_client(resolve(SERVICES[service_name].type), name)
            self.until(service.service_is_ready, f'{name}: not found; is the node running?')
            self._services[name] = service
        return self._services[name]

    def close(self) -> None:
        self.executor.shutdown()


AnyClient = TypeVar('AnyClient', bound=NodeClient)


@contextmanager
def opened(make: Callable[[Node], AnyClient], name: str) -> Iterator[AnyClient]:
    """Initialise ROS for a ``with`` block; give ``make(a new node of this name)``, close all."""
    init(signal_handler_options=SignalHandlerOptions.NO)
    try:
        with in_one_line(), caught_signals() as signals:
            client = make(rclpy.create_node(name))
            client.signals = signals
            try:
                yield client
            finally:
                client.close()
                client.node.destroy_node()
    finally:
        rclpy.try_shutdown()


def record(action: str, name: str, node: str, patience: float = PATIENCE) -> str:
    """Start or stop (``action``) recording in a node; return the path of the bag."""
    with opened(lambda ros_node: NodeClient(ros_node, patience), 'fourbar_record') as client:
        if action == 'start':
            answer = client.call('start_recording', node, name=name)
        else:
            answer = client.call('stop_recording', node)
    if not answer.success:
        raise NoAnswer(answer.message)
    return str(answer.path if action == 'start' else answer.message)
