# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The node as its parts see it: rclpy's node, the shared objects, and the parts themselves."""
from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import Future, wait
from traceback import format_exc
from typing import Any, TYPE_CHECKING

from fourbar_ros.ros.messages import Message
from fourbar_ros.ros.node.circles import Circles
from fourbar_ros.ros.node.quiet_log import QuietLog
from fourbar_ros.ros.node.steady import SteadyTimers
from fourbar_ros.ros.node.worker import answer_beside, WAITING, Worker
from fourbar_ros.scene.parameters import find
from rcl_interfaces.msg import SetParametersResult
from rcl_interfaces.srv import SetParameters, SetParametersAtomically
from rclpy.exceptions import ParameterNotDeclaredException
from rclpy.node import Node
from rclpy.parameter import Parameter
from rosgraph_msgs.msg import Clock

if TYPE_CHECKING:      # these parts import this file
    from fourbar_ros.ros.node.drives import Drive
    from fourbar_ros.ros.node.recording import Recording
    from fourbar_ros.ros.node.stream import Stream
    from fourbar_ros.ros.node.trajectories import Trajectories
    from fourbar_ros.ros.node.wrenches import WrenchInputs

CHANGES = 'changes'    # name of the thread that changes parameters, beside the stream
PATIENCE = 0.1         # [s] between two looks whether the node stops


class Base(Node):
    """
    An rclpy node with parts, which survives requests that an rclpy node does not.

    ``failure`` is a fault in any thread, which main raises. ``wrenches`` and ``trajectories`` are
    None for a scene without them.
    """

    circles: Circles
    failure: Exception | None
    log: QuietLog
    steady_timers: SteadyTimers
    workers: dict[str, Worker]          # by name
    recording: Recording
    stream: Stream
    drive: Drive
    wrenches: WrenchInputs | None
    trajectories: Trajectories | None

    def declare_parameters(self, namespace: str, parameters: Any,
                           ignore_override: bool = False) -> list[Parameter]:
        """Declare (name, value, ...); an empty list in a file comes as None, refused by rclpy."""
        return list(super().declare_parameters(
            namespace, [(name, [] if value is None else value, *rest)
                        for name, value, *rest in parameters], ignore_override))

    def set_parameters_atomically(self, parameter_list: Sequence[Parameter]
                                  ) -> SetParametersResult:
        """Set parameters; take 3 for a double, and an empty list for one of any type."""
        for parameter in parameter_list:
            if not self.has_parameter(parameter.name):   # rclpy overlooks an empty name
                raise ParameterNotDeclaredException(parameter.name)
        return super().set_parameters_atomically(list(map(_as_declared, parameter_list)))

    def create_subscription(self, msg_type: type[Any], topic: str,
                            callback: Callable[..., object], *qos: Any, **options: Any) -> Any:
        """Create a subscription; of /clock it ignores times below zero, which end rclpy's node."""
        def guarded(message: Message) -> None:
            if message.clock.sec < 0:
                self.log.warning('clock', f'/clock: {message.clock.sec} s is no time: ignored')
            else:
                callback(message)
        return super().create_subscription(
            msg_type, topic, guarded if msg_type is Clock else callback, *qos, **options)

    def create_service(self, srv_type: type[Any], srv_name: str,
                       callback: Callable[[Message, Message], Message], **options: Any) -> Any:
        """Create a service; an exception in its callback is logged and does not end the node."""
        def guarded(request: Message, response: Message) -> Message:
            try:
                return callback(request, response)
            except Exception:
                self.get_logger().error(f'a fault in {srv_name}: {format_exc()}')
                return response
        if srv_type not in (SetParameters, SetParametersAtomically):
            return super().create_service(srv_type, srv_name, guarded, **options)
        service = super().create_service(srv_type, srv_name, lambda *both: both, **options)
        answer_beside(service, guarded, _busy, lambda _: self.workers[CHANGES])
        return service

    def between_callbacks(self, job: Callable[[], None]) -> None:
        """Do a job of the thread CHANGES between two callbacks of the executor; wait for it."""
        worker, done = self.workers[CHANGES], Future[None]()
        if self.executor is None or not worker.is_this_thread:
            job()
            return

        def run() -> None:
            try:
                job()
                done.set_result(None)
            except Exception as error:
                done.set_exception(error)
        self.executor.create_task(run)
        while not wait([done], PATIENCE).done:
            worker.check()
        done.result()


def _busy(request: Message, response: Message) -> Message:
    """Refuse to set parameters: too many changes wait."""
    refused = SetParametersResult(reason=f'{WAITING} changes wait already: try again later')
    if hasattr(response, 'results'):
        response.results = [refused] * len(request.parameters)
    else:
        response.result = refused
    return response


def _as_declared(parameter: Parameter) -> Parameter:
    """
    Return a parameter in the type that the table declares, if its value can be converted.

    A client sends 3 as an integer, and an empty list as one of bytes; rclpy refuses both for a
    parameter of doubles.
    """
    declared, types = find(parameter.name), Parameter.Type
    kind = declared.type if declared else ''
    is_empty = parameter.type_.name.endswith('_ARRAY') and not len(parameter.value)
    if kind == 'double' and parameter.type_ == types.INTEGER:
        return Parameter(parameter.name, types.DOUBLE, float(parameter.value))
    if kind == 'doubles' and (is_empty or parameter.type_ == types.INTEGER_ARRAY):
        return Parameter(parameter.name, types.DOUBLE_ARRAY, list(map(float, parameter.value)))
    if kind == 'strings' and is_empty:
        return Parameter(parameter.name, types.STRING_ARRAY, [])
    return parameter
