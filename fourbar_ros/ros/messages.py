# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Turn numbers into messages: each message is made once, filled many times, serialised once."""
from __future__ import annotations

from collections.abc import Callable, Sequence
from importlib import import_module
from math import nan
from typing import Any

from builtin_interfaces.msg import Time
from fourbar_ros.scene.message_fields import FieldMap, PASSIVE_EFFORT
from fourbar_ros.scene.scene import Scene

Message = Any                   # a ROS message of whatever type
Stamp = tuple[int, int]         # as in a message, without making one: seconds, nanoseconds


def sec_nanosec(nanoseconds: int) -> Stamp:
    """Return the stamp of a time [ns]."""
    return divmod(nanoseconds, 10**9)


def to_stamp(nanoseconds: int) -> Time:
    """Return the Time message of a time [ns]."""
    sec, nanosec = sec_nanosec(nanoseconds)
    return Time(sec=sec, nanosec=nanosec)


def resolve(type_name: str) -> Any:
    """Return the class of a message or service, 'package/msg/Name'; only used ones are loaded."""
    package, kind, name = type_name.split('/')
    try:
        return getattr(import_module(f'{package}.{kind}'), name)
    except ModuleNotFoundError:
        if package != 'fourbar_msgs':
            raise
        raise ModuleNotFoundError('fourbar_msgs is not built: colcon needs both folders, '
                                  'colcon build --base-paths . msg_defs') from None


def set_constants(output: str, message: Message, scene: Scene) -> None:
    """
    Fill the fields of an output message that are the same in every step of a scene.

    These are its frame, the joint names, the change-point margin, and NaN in fields that only
    other mechanisms have. The message is made once and filled again in each step.
    """
    message.header.frame_id = scene.frame_id
    for field in scene.layout.absent.get(output, ()):
        setattr(message, field, nan)
    if hasattr(message, 'change_point_margin'):
        message.change_point_margin = float(scene.linkage.change_point_margin)
    if hasattr(message, 'effort'):           # a JointState; efforts are filled in where known
        message.name, message.effort = scene.names_shown, []


def filler(output: str, message: Message, layout: FieldMap
           ) -> Callable[[Stamp, int, int, Sequence[float]], None]:
    """
    Return the function (stamp, status, mode, values) that fills the fields of ``message``.

    ``values``: the floats of a step in the order of ``layout.place``. Where each of them goes
    (``wrench.force.x``, say) is looked up once, here, not in every step.
    """
    scalars, arrays = [], []        # (message or part of it, attribute, index or indices)
    for field, source in layout.fields[output].items():
        *path, attribute = field.split('.')
        target = message
        for step in path:
            target = getattr(target, step)
        if isinstance(source, tuple):
            arrays.append((target, attribute,
                           [None if name is None else layout.place[name] for name in source]))
        else:
            scalars.append((target, attribute, layout.place[source]))
    has_status = hasattr(message, 'status')

    def fill(stamp: Stamp, status: int, mode: int, values: Sequence[float]) -> None:
        """Fill the message; an effort of a passive joint, without a source, is PASSIVE_EFFORT."""
        message.header.stamp.sec, message.header.stamp.nanosec = stamp
        if has_status:
            message.status, message.mode = status, mode
        for target, attribute, place in scalars:
            setattr(target, attribute, values[place])
        for target, attribute, places in arrays:
            setattr(target, attribute, [PASSIVE_EFFORT if place is None else values[place]
                                        for place in places])
    return fill
