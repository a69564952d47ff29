# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""A running node behind a page: its scene and the motion of its input, parameters set back."""
from __future__ import annotations

from contextlib import ExitStack, suppress
import json
import queue
import threading
import time
from typing import Any

from fourbar_lab.clients.node_client import NoAnswer, NodeClient, opened, PATIENCE
from fourbar_ros.ros.messages import Message
from fourbar_ros.scene.parameters import check
from fourbar_ros.scene.topics import DRIVEN, SCENE
from rcl_interfaces.srv import SetParameters
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String

POLL = 0.02         # [s]
AGAIN = 3.0         # [s] after which a request without answer is repeated


class Watched:
    """
    A running node by name; a thread of its own listens to it until :meth:`close`.

    ``values`` are the parameters of its scene by name, ``version`` counts its scenes. It waits up
    to ``patience`` [s] for the scene, and for each answer.
    """

    def __init__(self, node: str, patience: float = PATIENCE):
        self.node, self.patience, self.version = '/' + node.strip('/'), patience, 0
        self.values: dict[str, Any] = {}
        self._latest: tuple[float, float, float] | None = None       # see latest()
        # requests: name and value of a parameter, and where to put the answer
        self._asked: queue.Queue[tuple[str, Any, queue.Queue[str]]] = queue.Queue()
        self._stack = ExitStack()
        self._client = self._stack.enter_context(opened(NodeClient, 'fourbar_live'))
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
        """Set a parameter of the node, from any thread; return '', or why it was refused."""
        answer: queue.Queue[str] = queue.Queue()
        self._asked.put((name, value, answer))
        while not self._ends.is_set():
            with suppress(queue.Empty):
                return answer.get(timeout=1.0)
        return f'{self.node}: no answer'

    def close(self) -> None:
        """Stop listening."""
        self._ends.set()
        self._thread.join()
        self._stack.close()

    def _take_scene(self, message: Message) -> None:
        self.values = check(json.loads(message.data))
        self.version += 1

    def _take(self, message: Message) -> None:
        self._latest = message.position, message.velocity, message.acceleration

    def _listen(self) -> None:
        while not self._ends.is_set():
            self._client.spin(POLL)
            while not self._asked.empty():
                self._ask(*self._asked.get())

    def _ask(self, name: str, value: Any, answer: queue.Queue[str]) -> None:
        """
        Send a request to set a parameter, and again every AGAIN seconds; pass on the answer.

        The first answer is lost if the node has not discovered us yet.
        """
        request = SetParameters.Request(
            parameters=[Parameter(name, value=value).to_parameter_msg()])
        end = time.monotonic() + self.patience
        while time.monotonic() < end and not self._ends.is_set():
            future = self._setter.call_async(request)
            try:
                result = self._client.result_of(future, name, AGAIN).results[0]
            except NoAnswer:
                self._setter.remove_pending_request(future)
                continue
            answer.put('' if result.successful else result.reason)
            return
        answer.put(f'{self.node}: no answer (waited {self.patience:g} s)')
