# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
All that rclpy's node and its EventsExecutor do not survive, or do not do (rclpy 7.1, Jazzy).

* A time below zero on /clock, an empty list in a parameter file, a parameter without a name, and
  an exception in a service's callback end the node: GuardedNode.
* An integer, a text with a unit or an empty list is refused for a parameter of doubles:
  as_declared.
* The executor knows no callback groups, so a slow service holds up the stream (ros2/rclpy#1473):
  GuardedNode.create_service.
* An event of a publisher that is gone ends the process, and publishing takes twice the time that
  it must: TopicPublisher.
* The executor passes a message and its info as one argument: entities.counted_subscription.
* It waits by the system clock, for hours if that is set back: spin.
"""
from __future__ import annotations

from collections.abc import Callable, Sequence
import threading
import time
from traceback import format_exc
from typing import Any, TYPE_CHECKING

from fourbar_ros.errors import InvalidParameter
from fourbar_ros.ros.messages import Message
from fourbar_ros.ros.node import entities
from fourbar_ros.scene import settings, topics
from fourbar_ros.scene.parameters import check_value, find_parameter
from rcl_interfaces.msg import SetParametersResult
from rcl_interfaces.srv import SetParameters, SetParametersAtomically
from rclpy.event_handler import PublisherEventCallbacks, UnsupportedEventTypeError
from rclpy.exceptions import ParameterNotDeclaredException
from rclpy.experimental import EventsExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter as RosParameter
from rclpy.qos import QoSProfile
from rosgraph_msgs.msg import Clock

if TYPE_CHECKING:      # stream imports this file
    from fourbar_ros.ros.node.stream import Stream

CHANGES = 'changes'    # name of the thread that changes parameters, beside the stream
REQUESTS = 1000        # that may arrive at once: as many as of parameters
SPIN = 0.2             # [s] so often at least the executor sees signals and timers


class GuardedNode(Node):
    """A node that survives what is listed above; ``workers`` has a thread named CHANGES."""

    troubles: entities.Troubles
    workers: dict[str, entities.Worker]
    stream: Stream

    def declare_parameters(self, namespace: str, parameters: Any,
                           ignore_override: bool = False) -> list[RosParameter]:
        """Declare (name, value, ...); an empty list in a file comes as None, refused by rclpy."""
        return list(super().declare_parameters(
            namespace, [(name, [] if value is None else value, *rest)
                        for name, value, *rest in parameters], ignore_override))

    def set_parameters_atomically(self, parameter_list: Sequence[RosParameter]
                                  ) -> SetParametersResult:
        """Set parameters; take 3 and 40mm for a double, an empty list for one of any type."""
        for parameter in parameter_list:
            if not self.has_parameter(parameter.name):   # rclpy overlooks an empty name
                raise ParameterNotDeclaredException(parameter.name)
        values = self.stream.scene.values
        try:
            converted = [as_declared(parameter, values) for parameter in parameter_list]
        except InvalidParameter as error:
            return SetParametersResult(reason=str(error))
        return super().set_parameters_atomically(converted)

    def create_subscription(self, msg_type: type[Any], topic: str,
                            callback: Callable[..., object], *qos: Any, **options: Any) -> Any:
        """Create a subscription; of /clock it ignores times below zero."""
        def guarded(message: Message) -> None:
            if message.clock.sec < 0:
                self.troubles.log('clock', f'/clock: {message.clock.sec} s is no time: ignored')
            else:
                callback(message)
        return super().create_subscription(
            msg_type, topic, guarded if msg_type is Clock else callback, *qos, **options)

    def create_service(self, srv_type: type[Any], srv_name: str,
                       callback: Callable[[Message, Message], Message],
                       worker_for: Callable[[Message], entities.Worker] | None = None,
                       **options: Any) -> Any:
        """
        Create a service; an exception in its callback is logged and does not end the node.

        If that takes long, ``worker_for(request)`` returns the thread to answer in. Its queue is
        deep, so that each request of a burst is answered, if only with RESULT_BUSY.
        """
        options.setdefault('qos_profile', QoSProfile(depth=REQUESTS))

        def answer(request: Message, response: Message) -> Message:
            try:
                return callback(request, response)
            except Exception as error:
                self.get_logger().error(f'a fault in {srv_name}: {format_exc()}')
                return _without_answer(request, response, 'RESULT_INVALID_REQUEST',
                                       f'a fault in the node, see its log: {error!r}')
        if srv_type in (SetParameters, SetParametersAtomically):
            worker_for = lambda _: self.workers[CHANGES]    # noqa: E731  rclpy asks before threads
        if worker_for is None:
            return super().create_service(srv_type, srv_name, answer, **options)
        find_worker = worker_for

        def queue(arguments: tuple[Message, Message], header: Message) -> None:
            """Have a worker answer a request, or say at once that too many wait."""
            if not find_worker(arguments[0]).do(lambda: send(answer(*arguments), header)):
                send(_without_answer(*arguments, 'RESULT_BUSY', f'{entities.WAITING} requests '
                                     'wait for an answer already: ask again later'), header)
        # The executor passes what the callback returns, the request and its response, to
        # send_response. That is replaced: it queues the answer.
        service = super().create_service(srv_type, srv_name, lambda *both: both, **options)
        send, service.send_response = service.send_response, queue
        return service


def _without_answer(request: Message, response: Message, result: str, why: str) -> Message:
    """Fill the response of any service with a reason; ``result``: its constant, if it has one."""
    refused = SetParametersResult(reason=why)
    if isinstance(response, SetParameters.Response):
        response.results = [refused] * len(request.parameters)
    elif isinstance(response, SetParametersAtomically.Response):
        response.result = refused
    elif hasattr(response, 'message'):
        response.message = why
        if hasattr(response, 'result'):
            response.result = getattr(response, result)
    return response


def as_declared(parameter: RosParameter, values: settings.ParameterValues) -> RosParameter:
    """
    Return a parameter in the type that the table declares, if its value can be converted.

    A client sends 3 as an integer, 40mm as a string, and an empty list as one of bytes; rclpy
    refuses them for a parameter of doubles. ``values``: of the scene. InvalidParameter for a text
    that is no number, and for a number beyond the limits.
    """
    declared, types = find_parameter(parameter.name), RosParameter.Type
    if not declared or not declared.live:       # rclpy refuses what is fixed
        return parameter
    kind = declared.type
    is_empty = parameter.type_.name.endswith('_ARRAY') and not len(parameter.value)
    if kind == 'double' and parameter.type_ in (types.DOUBLE, types.INTEGER, types.STRING):
        return RosParameter(parameter.name, types.DOUBLE,
                            check_value(declared, parameter.value, values))
    if kind == 'integer' and parameter.type_ is types.INTEGER:      # says more than rclpy's range
        check_value(declared, parameter.value, values)
    if kind == 'doubles' and (
            is_empty or parameter.type_ in (types.INTEGER_ARRAY, types.STRING_ARRAY)):
        checked = check_value(declared, list(parameter.value), values)
        return RosParameter(parameter.name, types.STRING_ARRAY if str in map(type, checked)
                            else types.DOUBLE_ARRAY, checked)
    if kind == 'strings' and is_empty:
        return RosParameter(parameter.name, types.STRING_ARRAY, [])
    return parameter


class TopicPublisher:
    """
    A published topic; ``is_subscribed`` tells whether it has subscribers.

    ``changed()`` is called when the first subscriber has come or the last one has left. Where the
    middleware has no event for that, the topic counts as subscribed. The publisher must be kept
    when a scene no longer names its topic: an event of one that is gone, as when its last
    subscriber leaves, ends the process.
    """

    def __init__(self, node: Node, topic: topics.Topic, changed: Callable[[], None]) -> None:
        self._changed, self.is_subscribed = changed, False
        try:
            self._publisher = entities.publisher(
                node, topic, event_callbacks=PublisherEventCallbacks(matched=self._matched))
        except UnsupportedEventTypeError:
            self.is_subscribed, self._publisher = True, entities.publisher(node, topic)
        self.topic = str(self._publisher.topic_name)     # the full name
        # This takes half the time of Publisher.publish, which also guards against its destruction
        # meanwhile.
        self.publish: Callable[[bytes], None] = self._publisher.handle.publish_raw

    def _matched(self, info: Any) -> None:
        is_subscribed = info.current_count > 0
        if is_subscribed != self.is_subscribed:
            self.is_subscribed = is_subscribed
            self._changed()


def spin(nodes: Sequence[Node], signals: Sequence[int]) -> None:
    """Run the callbacks of nodes until ``signals``, a list that a handler fills, has one."""
    executor, ended = EventsExecutor(), False
    for node in nodes:
        executor.add_node(node)

    def wake() -> None:      # that of the wheels waits by the system clock, also if set back
        while not ended:
            time.sleep(SPIN)
            executor.create_task(lambda: None)
    waker = threading.Thread(target=wake, name='waker', daemon=True)
    waker.start()
    try:
        while not signals:
            executor.spin_once(timeout_sec=SPIN)
    finally:
        ended = True
        waker.join()
        executor.shutdown()
