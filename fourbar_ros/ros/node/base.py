# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The node as its parts see it that are made first: rclpy's, and what all parts share."""
from __future__ import annotations

from collections.abc import Callable, Sequence
from traceback import format_exc
from typing import Any, TYPE_CHECKING

from fourbar_ros.ros.messages import Message
from fourbar_ros.ros.node.circles import Circles
from fourbar_ros.ros.node.quiet_log import QuietLog
from fourbar_ros.ros.node.steady import SteadyTimers
from fourbar_ros.ros.node.worker import Worker
from fourbar_ros.scene.parameters import find
from rcl_interfaces.msg import SetParametersResult
from rclpy.exceptions import ParameterNotDeclaredException
from rclpy.node import Node
from rclpy.parameter import Parameter

if TYPE_CHECKING:      # these parts import this file
    from fourbar_ros.ros.node.drives import Drive
    from fourbar_ros.ros.node.recording import Recording
    from fourbar_ros.ros.node.stream import Stream
    from fourbar_ros.ros.node.trajectories import Trajectories
    from fourbar_ros.ros.node.wrenches import WrenchInputs


class Base(Node):
    """
    What the parts of a node may use of it; and what rclpy's own would not survive.

    Attributes
    ----------
    circles : Circles
    failure : Exception or None
        A fault in any thread, which main raises.
    log : QuietLog
    steady_timers : SteadyTimers
    workers : dict
        {name: Worker}.

    """

    circles: Circles
    failure: Exception | None
    log: QuietLog
    steady_timers: SteadyTimers
    workers: dict[str, Worker]

    def declare_parameters(self, namespace: str, parameters: Any,
                           ignore_override: bool = False) -> list[Parameter]:
        """Declare parameters; an empty list of a file reaches rclpy without type and value."""
        found: list[Parameter] = super().declare_parameters(
            namespace, [(name, [] if value is None else value, *rest)
                        for name, value, *rest in parameters], ignore_override)
        return found

    def set_parameters_atomically(self, parameter_list: Sequence[Parameter]
                                  ) -> SetParametersResult:
        """Set parameters; whole numbers are good for doubles, empty lists for any list."""
        for parameter in parameter_list:
            if not self.has_parameter(parameter.name):   # rclpy overlooks an empty name
                raise ParameterNotDeclaredException(parameter.name)
        return super().set_parameters_atomically(list(map(_as_declared, parameter_list)))

    def create_service(self, srv_type: type[Any], srv_name: str,
                       callback: Callable[[Message, Message], Message], **options: Any) -> Any:
        """Create a service; a fault in it, as by a request that cannot be, is logged."""
        def guarded(request: Message, response: Message) -> Message:
            try:
                return callback(request, response)
            except Exception:                # whatever a foreign client asks, the node goes on
                self.get_logger().error(f'a fault in {srv_name}: {format_exc()}')
                return response
        return super().create_service(srv_type, srv_name, guarded, **options)


def _as_declared(given: Parameter) -> Parameter:
    """Return a parameter in the type of the table, where its value is good for that."""
    declared, types = find(given.name), Parameter.Type
    kind = declared.type if declared else ''
    is_empty = given.type_.name.endswith('_ARRAY') and not len(given.value)
    if kind == 'double' and given.type_ == types.INTEGER:
        return Parameter(given.name, types.DOUBLE, float(given.value))
    if kind == 'doubles' and (is_empty or given.type_ == types.INTEGER_ARRAY):
        return Parameter(given.name, types.DOUBLE_ARRAY, list(map(float, given.value)))
    if kind == 'strings' and is_empty:
        return Parameter(given.name, types.STRING_ARRAY, [])
    return given


class Running(Base):
    """
    The node with all its parts, as parameters, services and diagnostics ask them.

    None for those that its scene does not need.
    """

    recording: Recording
    stream: Stream
    drive: Drive
    wrenches: WrenchInputs | None
    trajectories: Trajectories | None
