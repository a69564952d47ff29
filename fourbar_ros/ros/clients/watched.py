# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""A running node behind a page: its scene and the motion of its input, parameters set back."""
from __future__ import annotations

from contextlib import ExitStack
import json
import queue
import threading
from typing import Any

from fourbar_ros.ros.clients.client import Client, NoAnswer, opened
from fourbar_ros.scene.parameters import check
from fourbar_ros.scene.topics import DRIVEN, SCENE
from rcl_interfaces.srv import SetParameters
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String

POLL = 0.02         # [s]


class Watched:
    """
    A node, listened to by a thread of its own until :meth:`close`.

    Attributes
    ----------
    values : dict
        Parameters of its scene, by name.
    version : int
        Grows with each new scene of the node.

    """

    def __init__(self, node: str, patience: float = 10.0):
        self.node, self.version = '/' + node.strip('/'), 0
        self.values: dict[str, Any] = {}
        self._latest: tuple[float, float, float] | None = None
        self._asked: queue.Queue[tuple[str, Any, queue.Queue[str]]] = queue.Queue()
        self._stack = ExitStack()
        self._client = self._stack.enter_context(opened(Client, 'fourbar_live'))
        self._client.node.create_subscription(
            String, SCENE.topic.replace('~', self.node), self._take_scene,
            QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL))
        self._client.subscribe(DRIVEN, self._take, self.node)
        try:
            self._client.until(lambda: self.version > 0, f'{self.node}: no scene; is the node '
                                                         'running?', patience)
        except NoAnswer:
            self._stack.close()
            raise
        self._setter = self._client.node.create_client(SetParameters,
                                                       f'{self.node}/set_parameters')
        self._ends = threading.Event()
        self._thread = threading.Thread(target=self._listen, name='fourbar_live', daemon=True)
        self._thread.start()

    def latest(self) -> tuple[float, float, float] | None:
        """Return the newest (position, rate, acceleration) of the input; None before it."""
        return self._latest

    def set(self, name: str, value: Any) -> str:
        """Ask the node for a parameter; return why not, or ''."""
        answer: queue.Queue[str] = queue.Queue()
        self._asked.put((name, value, answer))
        try:
            return str(answer.get(timeout=self._client.patience))
        except queue.Empty:
            return f'{self.node}: no answer'

    def close(self) -> None:
        """Stop listening."""
        self._ends.set()
        self._thread.join()
        self._stack.close()

    def _take_scene(self, message: Any) -> None:
        self.values = check(json.loads(message.data))
        self.version += 1

    def _take(self, message: Any) -> None:
        self._latest = message.position, message.velocity, message.acceleration

    def _listen(self) -> None:
        while not self._ends.is_set():
            self._client.spin(POLL)
            while not self._asked.empty():
                self._ask(*self._asked.get())

    def _ask(self, name: str, value: Any, answer: queue.Queue[str]) -> None:
        request = SetParameters.Request(
            parameters=[Parameter(name, value=value).to_parameter_msg()])
        try:
            result = self._client.result_of(self._setter.call_async(request), name).results[0]
            answer.put('' if result.successful else result.reason)
        except NoAnswer as error:
            answer.put(str(error))
