# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The parameters of a node: declared as the table says, read as a scene, checked on a change."""
from __future__ import annotations

from collections.abc import Callable, Sequence
from math import inf
from pathlib import Path
from traceback import format_exc

from fourbar_ros.errors import FourBarError, InvalidParameter
from fourbar_ros.ros.node.entities import OVERRIDES
from fourbar_ros.scene.parameters import find, meant, of_name
from fourbar_ros.scene.scene import from_values, Scene
from fourbar_ros.scene.settings import Parameter
from rcl_interfaces.msg import (
    IntegerRange,
    ParameterDescriptor,
    ParameterType,
    SetParametersResult,
)
from rclpy.node import Node
from rclpy.parameter import Parameter as RosParameter

# Parameters that rclpy itself owns.
SWITCHES = ('use_sim_time', 'start_type_description_service')
BUILT_IN = (*SWITCHES, OVERRIDES)

_ROS_TYPES = {'double': ParameterType.PARAMETER_DOUBLE, 'integer': ParameterType.PARAMETER_INTEGER,
              'string': ParameterType.PARAMETER_STRING, 'bool': ParameterType.PARAMETER_BOOL,
              'strings': ParameterType.PARAMETER_STRING_ARRAY,
              'doubles': ParameterType.PARAMETER_DOUBLE_ARRAY}


def scene(node: Node, files: Sequence[str] = ()) -> Scene:
    """
    Return the Scene of a node, from the parameters that files and command line gave it.

    rclpy has declared them as they came. They are read and declared again with type and text from
    the table: so an unknown name is an error instead of being ignored, and ``3`` is good for a
    double. ``files``: the parameter files, beside which the tables of forces stand.

    Raises
    ------
    InvalidParameter
        A value is not allowed; the message names the parameter, its value and the allowed ones.

    """
    every = {name: parameter.value
             for name, parameter in node.get_parameters_by_prefix('').items()}
    for name in SWITCHES:
        if type(every.get(name, True)) is not bool:
            raise InvalidParameter(name, every[name], 'must be a bool')
    given = {name: value for name, value in every.items() if not name.startswith(BUILT_IN)}
    tables = {}
    if any(name.startswith('forces.') for name in given):
        from fourbar_ros.scene.files import table_files  # other scenes do without
        tables = {name: str(path) for name in table_files(given) for file in files
              if (path := Path(file).parent / given[name]).exists()}
    scene = from_values(given | tables)
    for name in given:
        node.undeclare_parameter(name)
    for name in meant(scene.values, given):
        node.declare_parameter(name, scene.values[name], descriptor(of_name(name)),
                               ignore_override=True)
    return scene


def watch(node: Node, current: Callable[[], Scene], apply: Callable[[Scene], None]) -> None:
    """
    Check every change of parameters as a whole scene; call ``apply(scene)`` with a good one.

    A refused change says why and changes nothing, even if only ``apply`` finds out, or if an error
    is ours. ``current()`` returns the scene in force.
    """
    def change(given: Sequence[RosParameter]) -> None:
        """Apply the scene with these changes; raise FourBarError if it may not be."""
        changes = {}
        for parameter in given:
            name, value = parameter.name, parameter.value
            if find(name):
                changes[name] = value
            elif value != node.get_parameter(name).value:        # of rclpy itself
                raise InvalidParameter(name, value, 'only at start')
        if changes:
            apply(from_values({**current().values, **changes}))

    def answer(given: Sequence[RosParameter]) -> SetParametersResult:
        """Change the scene and return success, or the reason why it is as before."""
        before = current()
        try:
            change(given)
            return SetParametersResult(successful=True)
        except FourBarError as error:
            why = str(error)
        except Exception as error:
            node.get_logger().error(f'a fault in a change of parameters: {format_exc()}')
            why = f'a fault in the node, see its log: {error!r}'
        if current() is not before:
            apply(before)
        return SetParametersResult(successful=False, reason=why)

    # The scene changes while rclpy asks whether it may: the callback after rclpy has set the
    # parameters cannot refuse any more. No other callback can refuse these parameters.
    node.add_on_set_parameters_callback(answer)


def descriptor(parameter: Parameter) -> ParameterDescriptor:
    """Return the ROS descriptor of a parameter: type, text with unit, limits, whether fixed."""
    unit = f' [{parameter.unit}]' if parameter.unit else ''
    ranges = []
    if parameter.type == 'integer' and parameter.high < inf:
        ranges = [IntegerRange(from_value=int(parameter.low), to_value=int(parameter.high))]
    return ParameterDescriptor(name=parameter.name, type=_ROS_TYPES[parameter.type],
                               read_only=not parameter.live, integer_range=ranges,
                               description=parameter.text + unit,
                               # to rclpy an empty list is one of bytes
                               dynamic_typing=parameter.type in ('strings', 'doubles'),
                               additional_constraints=parameter.allowed)


def as_declared(parameter: RosParameter) -> RosParameter:
    """
    Return a parameter in the type that the table declares, if its value can be converted.

    A client sends 3 as an integer, and an empty list as one of bytes; rclpy refuses both for a
    parameter of doubles.
    """
    declared, types = find(parameter.name), RosParameter.Type
    kind = declared.type if declared else ''
    is_empty = parameter.type_.name.endswith('_ARRAY') and not len(parameter.value)
    if kind == 'double' and parameter.type_ == types.INTEGER:
        return RosParameter(parameter.name, types.DOUBLE, float(parameter.value))
    if kind == 'doubles' and (is_empty or parameter.type_ == types.INTEGER_ARRAY):
        return RosParameter(parameter.name, types.DOUBLE_ARRAY, list(map(float, parameter.value)))
    if kind == 'strings' and is_empty:
        return RosParameter(parameter.name, types.STRING_ARRAY, [])
    return parameter
