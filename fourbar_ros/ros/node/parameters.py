# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Declare the parameters of the table in a node and read its scene."""
from __future__ import annotations

from collections.abc import Callable, Sequence
from math import inf
from typing import Any

from fourbar_ros.errors import FourBarError, InvalidParameter
from fourbar_ros.ros.node import qos
from fourbar_ros.ros.node.running import Running
from fourbar_ros.scene import overrides
from fourbar_ros.scene.parameter import Parameter
from fourbar_ros.scene.parameters import find, of_name
from fourbar_ros.scene.scene import from_values, Scene
from rcl_interfaces.msg import (
    IntegerRange,
    ParameterDescriptor,
    ParameterType,
    SetParametersResult,
)
from rclpy.parameter import Parameter as Given

# Parameters that rclpy itself owns.
SWITCHES = ('use_sim_time', 'start_type_description_service')
BUILT_IN = (*SWITCHES, qos.PREFIX)

_ROS_TYPES = {'double': ParameterType.PARAMETER_DOUBLE, 'integer': ParameterType.PARAMETER_INTEGER,
              'string': ParameterType.PARAMETER_STRING, 'bool': ParameterType.PARAMETER_BOOL,
              'strings': ParameterType.PARAMETER_STRING_ARRAY,
              'doubles': ParameterType.PARAMETER_DOUBLE_ARRAY}


def scene(node: Running, arguments: Sequence[str] = ()) -> Scene:
    """
    Return the Scene of a node that has declared its overrides.

    Every parameter declared as in the table.

    The overrides are read as they came and declared again with type and text: so an unknown name
    is an error instead of being ignored, and ``3`` is good for a double. ``arguments``: the
    command line, for what rcl ignores of it.

    Raises
    ------
    InvalidParameter
        Naming the parameter, what was given and what is allowed.

    """
    every = {name: parameter.value
             for name, parameter in node.get_parameters_by_prefix('').items()}
    for name in SWITCHES:
        if type(every.get(name, True)) is not bool:
            raise InvalidParameter(name, every[name], 'must be a bool')
    given = {name: value for name, value in every.items() if not name.startswith(BUILT_IN)}
    asked = overrides.asked(list(arguments), node.get_fully_qualified_name())
    for name, (value, where) in asked.items():
        if name in given and overrides.is_ignored(value, given[name]):
            node.get_logger().warning(f'{name} = {value!r} ({where}), though ROS 2 would keep '
                                      f'{given[name]!r}, which is of another type')
            given[name] = value
    checked = from_values(given)
    qos.check(node, checked)
    for name in given:
        node.undeclare_parameter(name)
    for name, value in checked.values.items():
        node.declare_parameter(name, value, descriptor(of_name(name)), ignore_override=True)
    return checked


def watch(node: Running, current: Callable[[], Scene], apply: Callable[[Scene], None]) -> None:
    """
    Check every change of parameters as a whole scene; call ``apply(scene)`` with a good one.

    A refused change says why and changes nothing. ``current()`` returns the scene in force.
    """
    checked: list[Scene] = []

    def changed(given: Sequence[Given]) -> dict[str, Any]:
        return {parameter.name: parameter.value for parameter in given if find(parameter.name)}

    def check(given: Sequence[Given]) -> SetParametersResult:
        checked.clear()
        for parameter in given:
            if (parameter.name == 'use_sim_time' or parameter.name.startswith(qos.PREFIX)) \
                    and parameter.value != node.get_parameter_or(parameter.name, parameter).value:
                return SetParametersResult(successful=False,
                                           reason=f'{parameter.name}: only at start')
        try:
            if changes := changed(given):
                scene = from_values({**current().values, **changes})
                if node.recording.active and scene.outputs != current().outputs:
                    return SetParametersResult(successful=False,
                                               reason='outputs: not while recording')
                checked.append(scene)
        except FourBarError as error:
            return SetParametersResult(successful=False, reason=str(error))
        return SetParametersResult(successful=True)

    def accept(given: Sequence[Given]) -> None:
        if checked and changed(given):
            apply(checked.pop())

    node.add_on_set_parameters_callback(check)
    node.add_post_set_parameters_callback(accept)


def descriptor(parameter: Parameter) -> ParameterDescriptor:
    """Return the ROS descriptor of a parameter of the table."""
    unit = f' [{parameter.unit}]' if parameter.unit else ''
    found = ParameterDescriptor(name=parameter.name, type=_ROS_TYPES[parameter.type],
                                read_only=not parameter.live,
                                description=parameter.text + unit,
                                additional_constraints=parameter.allowed)
    if parameter.type == 'integer' and parameter.high < inf:
        found.integer_range = [IntegerRange(from_value=int(parameter.low),
                                            to_value=int(parameter.high))]
    return found
