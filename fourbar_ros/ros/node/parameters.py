# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The parameters of a node: declared as the table says, read as a scene, checked when they change.

For a parameter given twice with unlike types, rcl keeps a bool rather than an integer, that rather
than a double, and that rather than a text, whatever came last: ``-p drive.speed:=3.5`` would be
ignored where a file says ``25``. :func:`asked_outside` finds the last one.
"""
from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from math import inf
from pathlib import Path
from traceback import format_exc
from typing import Any, NamedTuple

from fourbar_ros.errors import FourBarError, InvalidParameter
from fourbar_ros.ros.node import qos
from fourbar_ros.ros.node.base import Running
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

    Every parameter that has a meaning in it is declared as in the table.

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
    asked = asked_outside(list(arguments), node.get_fully_qualified_name())
    for name, (value, where) in asked.items():
        if name in given and is_ignored(value, given[name]):
            node.get_logger().warning(f'{name} = {value!r} ({where}), though ROS 2 would keep '
                                      f'{given[name]!r}, which is of another type')
            given[name] = value
    wanted = dict(given)
    for name in table_files(given):
        where = asked[name].where if name in asked else ''
        if Path(where).is_file():
            wanted |= beside({name: given[name]}, Path(where))
    checked = from_values(wanted)
    qos.check(node, checked)
    for name in given:
        node.undeclare_parameter(name)
    for name in meant(checked.values, given):
        node.declare_parameter(name, checked.values[name], descriptor(of_name(name)),
                               ignore_override=True)
    return checked


def watch(node: Running, current: Callable[[], Scene], apply: Callable[[Scene], None]) -> None:
    """
    Check every change of parameters as a whole scene; call ``apply(scene)`` with a good one.

    A refused change says why and changes nothing, also one that only ``apply`` finds bad, or that
    is a fault of ours. ``current()`` returns the scene in force.
    """
    def take(given: Sequence[Given]) -> None:
        changes = {}
        for parameter in given:
            name, value = parameter.name, parameter.value
            if find(name):
                changes[name] = value
            elif value != node.get_parameter(name).value:        # of rclpy itself
                raise InvalidParameter(name, value, 'only at start')
        if changes:
            scene = from_values({**current().values, **changes})
            if node.recording.active and scene.outputs != current().outputs:
                raise InvalidParameter('outputs', changes['outputs'], 'not while recording')
            apply(scene)

    def taken(given: Sequence[Given]) -> SetParametersResult:
        before = current()
        try:
            take(given)
            return SetParametersResult(successful=True)
        except FourBarError as error:
            why = str(error)
        except Exception as error:
            node.get_logger().error(f'a fault in a change of parameters: {format_exc()}')
            why = f'a fault in the node, see its log: {error!r}'
        if current() is not before:
            apply(before)
        return SetParametersResult(successful=False, reason=why)

    # Taken over while it is checked: a callback after rclpy has set it could refuse nothing. No
    # other callback has a say in these parameters.
    node.add_on_set_parameters_callback(taken)


def descriptor(parameter: Parameter) -> ParameterDescriptor:
    """Return the ROS descriptor of a parameter of the table."""
    unit = f' [{parameter.unit}]' if parameter.unit else ''
    found = ParameterDescriptor(name=parameter.name, type=_ROS_TYPES[parameter.type],
                                read_only=not parameter.live,
                                description=parameter.text + unit,
                                # to rclpy an empty list is one of bytes
                                dynamic_typing=parameter.type in ('strings', 'doubles'),
                                additional_constraints=parameter.allowed)
    if parameter.type == 'integer' and parameter.high < inf:
        found.integer_range = [IntegerRange(from_value=int(parameter.low),
                                            to_value=int(parameter.high))]
    return found


class Asked(NamedTuple):
    """A value and where it was asked for."""

    value: Any
    where: str


def asked_outside(arguments: list[str], node: str) -> dict[str, Asked]:
    """
    Return what a command line asks of the parameters of a node, by name, in ROS's order.

    Parameters
    ----------
    arguments : list of str
        Those of the command line; only what stands behind ``--ros-args`` counts.
    node : str
        Full name of the node.

    Raises
    ------
    SceneError
        A file cannot be read.

    """
    by_key: dict[str, dict[str, Asked]] = {}
    for option, argument in _of_ros(arguments):
        if option == '--params-file':
            for key, tree in sections(argument).items():
                for name, value in flatten(tree, argument).items():
                    by_key.setdefault(key, {})[name] = Asked(value, argument)
        elif option in ('-p', '--param') and ':=' in argument:
            target, text = argument.split(':=', 1)
            key, _, name = target.rpartition(':')
            key = key if key.startswith('/') else f'/{key or "**"}'
            by_key.setdefault(key, {})[name] = Asked(parse(text), f'-p {argument}')
    mine = [key for key in by_key if is_for(key, node)]
    found: dict[str, Asked] = {}
    for key in sorted(mine, key=lambda key: '*' not in key):         # the node's own name last
        found |= by_key[key]
    return found


def is_ignored(wanted: Any, kept: Any) -> bool:
    """Return whether rcl has kept a value of another type than the one that was asked for last."""
    return None not in (wanted, kept) and _kind(wanted) != _kind(kept)


def _kind(value: Any) -> Any:
    if isinstance(value, bool | int | float | str):
        return type(value)
    return 'list', *(type(item) for item in list(value)[:1])


def _of_ros(arguments: list[str]) -> Iterator[tuple[str, str]]:
    """Yield (option, argument) of all that is meant for ROS."""
    is_inside = False
    for option, argument in zip(arguments, [*arguments[1:], '']):
        if option in ('--ros-args', '--'):
            is_inside = option == '--ros-args'
        elif is_inside:
            yield option, argument
