# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The motion of the driven joint from the bytes of an input message.

ROS reads the first message of a layout; later ones are read at the places learned from it. A
layout is one length of all texts and sequences and one list of joint names. That takes 1 us for a
Motion and 3 us for a JointState of six joints, where rclpy's ``deserialize_message`` takes 23 us,
a tenth of a step of the node (measured together on a loaded machine).
"""
from __future__ import annotations

from collections.abc import Callable
from math import nan
from struct import error as StructError  # noqa: N812, it is a class
from struct import Struct
from typing import Union

from fourbar_ros.bag.cdr import Definition, Layout
from fourbar_ros.errors import BagError
from fourbar_ros.ros.messages import resolve, Stamp
from fourbar_ros.ros.schemas import definition
from fourbar_ros.scene.message_fields import driven_of
from rclpy.serialization import deserialize_message

LAYOUTS = 32           # so many are kept: senders with ever new names are read by ROS alone
_CODES = {'i4': ('i', 4), 'u4': ('I', 4), 'f8': ('d', 8)}
# position, velocity, acceleration; NaN for what is not given
Given = tuple[float, float, float]
Read = Callable[[bytes], tuple[Stamp, Union[Given, None]]]


class Reader:
    """
    Reads the messages of an input.

    Parameters
    ----------
    type_name : str
        Type of the input, ``package/msg/Name``.
    joint : str
        Name of the driven joint in a JointState.

    """

    def __init__(self, type_name: str, joint: str = ''):
        self._type, self._joint = resolve(type_name), joint
        self._definition = Definition(type_name, definition(type_name))
        self._known: dict[int, list[tuple[Layout, Read]]] = {}      # by length
        self._room = LAYOUTS

    def __call__(self, data: bytes) -> tuple[Stamp, Given | None]:
        """
        Return stamp and motion of a serialised message.

        None for the motion if the message does not have the joint.

        Raises what ROS raises for bytes that are no message of this type.
        """
        for layout, read in self._known.get(len(data), ()):
            if layout.matches(data):
                return read(data)
        message = deserialize_message(data, self._type)
        found = (message.header.stamp.sec,
                 message.header.stamp.nanosec), driven_of(message, self._joint)
        if self._room:
            self._room -= 1
            self._learn(data, repr(found))
        return found

    def _learn(self, data: bytes, expected: str) -> None:
        try:
            layout = Layout(self._definition, data)
            read = _reader(layout, self._joint)
        except (BagError, KeyError, StructError):        # ROS can read it and we cannot
            return
        if repr(read(data)) == expected:                 # NaN is NaN here
            self._known.setdefault(len(data), []).append((layout, read))


def _reader(layout: Layout, joint: str) -> Read:
    """Return the function that reads messages of one layout."""
    leaves = {leaf.name: leaf for leaf in layout.leaves}
    fields, names = ['header.stamp.sec', 'header.stamp.nanosec'], layout.texts.get('name', [joint])
    i = names.index(joint) if joint in names else 0
    has_joint = joint in names and i < (leaves['position'].shape or (1,))[0]
    if has_joint:
        fields += [name for name in ('position', 'velocity', 'acceleration')
                   if name in leaves and i < (leaves[name].shape or (1,))[0]]
    missing = (nan,) * (5 - len(fields))
    parts, end = [leaves['header.stamp.sec'].format[0]], 0
    for name in fields:                                  # in the order in which they lie there
        code, size = _CODES[leaves[name].format[1:]]
        begin = leaves[name].offset + size * (i if leaves[name].shape else 0)
        parts.append(f'{begin - end}x{code}')
        end = begin + size
    unpack = Struct(''.join(parts)).unpack_from

    def read(data: bytes) -> tuple[Stamp, Given | None]:
        values = unpack(data)
        return values[:2], values[2:] + missing if has_joint else None
    return read
