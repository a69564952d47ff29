# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The parameters of a node: declared as the table says, read as a scene, checked when they change.

The last value should count. But if two values have different types, rcl prefers a bool to an
integer, an integer to a double, and a double to a text. It would ignore ``-p drive.speed:=3.5``
where a file says ``25``. :func:`asked_outside` finds the last one.
"""
from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from math import inf
from pathlib import Path
from traceback import format_exc
from typing import Any, NamedTuple

from fourbar_ros.errors import FourBarError, InvalidParameter
from fourbar_ros.ros.node import qos
from fourbar_ros.ros.node.base import Base
from fourbar_ros.scene.files import beside, flatten, is_for, parse, sections, table_files
from fourbar_ros.scene.parameter_table import Parameter
from fourbar_ros.scene.parameters import find, meant, of_name
from fourbar_ros.scene.scene import from_values, Scene
from rcl_interfaces.msg import (
    IntegerRange,
    ParameterDescriptor,
    ParameterType,
    SetParametersResult,
)
from rclpy.parameter import Parameter as RosParameter

# Parameters that rclpy itself owns.
SWITCHES = ('use_sim_time', 'start_type_description_service')
BUILT_IN = (*SWITCHES, qos.PREFIX)

_ROS_TYPES = {'double': ParameterType.PARAMETER_DOUBLE, 'integer': ParameterType.PARAMETER_INTEGER,
              'string': ParameterType.PARAMETER_STRING, 'bool': ParameterType.PARAMETER_BOOL,
              'strings': ParameterType.PARAMETER_STRING_ARRAY,
              'doubles': ParameterType.PARAMETER_DOUBLE_ARRAY}


def scene(node: Base, arguments: Sequence[str] = ()) -> Scene:
    """
    Return the Scene of a node, from the parameters that files and command line gave it.

    rclpy has declared them as they came. They are read and declared again with type and text from
    the table: so an unknown name is an error instead of being ignored, and ``3`` is good for a
    double. ``arguments``: the command line, for the values that rcl ignores.

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
    asked = asked_outside(list(arguments), node.get_fully_qualified_name())
    for name, (value, where) in asked.items():
        if name in given and is_ignored(value, given[name]):
            node.get_logger().warning(f'{name} = {value!r} ({where}), though ROS 2 would keep '
                                      f'{given[name]!r}, which is of another type')
            given[name] = value
    resolved = dict(given)
    for name in table_files(given):          # paths of tables count from the file that names them
        where = asked[name].where if name in asked else ''
        if Path(where).is_file():
            resolved |= beside({name: given[name]}, Path(where))
    scene = from_values(resolved)
    qos.check(node, scene)
    for name in given:
        node.undeclare_parameter(name)
    for name in meant(scene.values, given):
        node.declare_parameter(name, scene.values[name], descriptor(of_name(name)),
                               ignore_override=True)
    return scene


def watch(node: Base, current: Callable[[], Scene], apply: Callable[[Scene], None]) -> None:
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


class Asked(NamedTuple):
    """A value of a parameter and the file or option, as '-p a1:=0.5', that asked for it."""

    value: Any
    where: str


def asked_outside(arguments: list[str], node: str) -> dict[str, Asked]:
    """
    Return the values that a command line gives to parameters of a node, the last of each name.

    It reads files and ``-p`` options behind ``--ros-args`` in ROS's order: what is for the full
    name of the node overrides what is for a pattern as ``/**``.

    Raises
    ------
    SceneError
        A file cannot be read.

    """
    by_pattern: dict[str, dict[str, Asked]] = {}
    for option, argument in _ros_options(arguments):
        if option == '--params-file':
            for pattern, tree in sections(argument).items():
                for name, value in flatten(tree, argument).items():
                    by_pattern.setdefault(pattern, {})[name] = Asked(value, argument)
        elif option in ('-p', '--param') and ':=' in argument:
            target, text = argument.split(':=', 1)
            pattern, _, name = target.rpartition(':')
            pattern = pattern if pattern.startswith('/') else f'/{pattern or "**"}'
            by_pattern.setdefault(pattern, {})[name] = Asked(parse(text), f'-p {argument}')
    asked: dict[str, Asked] = {}
    for pattern in sorted(by_pattern, key=lambda pattern: '*' not in pattern):
        if is_for(pattern, node):
            asked |= by_pattern[pattern]
    return asked


def is_ignored(wanted: Any, kept: Any) -> bool:
    """Return whether rcl has kept a value of another type than the last one asked for."""
    return None not in (wanted, kept) and _type_of(wanted) != _type_of(kept)


def _type_of(value: Any) -> Any:
    """Return a value that is equal for values of one ROS type; lists by their first item."""
    if isinstance(value, bool | int | float | str):
        return type(value)
    return 'list', *(type(item) for item in list(value)[:1])


def _ros_options(arguments: list[str]) -> Iterator[tuple[str, str]]:
    """Yield each argument after ``--ros-args`` with the next one: (option, its value)."""
    is_inside = False
    for option, argument in zip(arguments, [*arguments[1:], '']):
        if option in ('--ros-args', '--'):
            is_inside = option == '--ros-args'
        elif is_inside:
            yield option, argument
