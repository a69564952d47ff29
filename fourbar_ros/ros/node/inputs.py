# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The motion of the driven joint from the bytes of an input message.

ROS reads the first message of a layout; later ones are read at the byte offsets learned from it.
Messages have one layout if all their texts and sequences have equal lengths and the joint names
are equal. That takes 1 us for a Motion and 3 us for a JointState of six joints, where rclpy's
``deserialize_message`` takes 23 us, a tenth of a step of the node (measured together on a loaded
machine).
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

LAYOUTS = 32           # most layouts kept: a sender with ever new names must not fill the memory
_CODES = {'i4': ('i', 4), 'u4': ('I', 4), 'f8': ('d', 8)}    # {numpy: struct's code, bytes}
Given = tuple[float, float, float]      # position, velocity, acceleration; NaN where not given
Read = Callable[[bytes], tuple[Stamp, Union[Given, None]]]


class Reader:
    """Reads input messages of a type; ``joint``: name of the driven joint in a JointState."""

    def __init__(self, type_name: str, joint: str = ''):
        self._type, self._joint = resolve(type_name), joint
        self._definition = Definition(type_name, definition(type_name))
        # {bytes of a message: layouts of that length, each with its reader}
        self._known: dict[int, list[tuple[Layout, Read]]] = {}
        self._room = LAYOUTS         # layouts that may still be learned

    def __call__(self, data: bytes) -> tuple[Stamp, Given | None]:
        """
        Return stamp and motion of a serialised message; no motion (None) if it lacks the joint.

        Raises what ROS raises for bytes that are no message of this type.
        """
        for layout, read in self._known.get(len(data), ()):
            if layout.matches(data):
                return read(data)
        message = deserialize_message(data, self._type)
        stamp = message.header.stamp.sec, message.header.stamp.nanosec
        motion = driven_of(message, self._joint)
        if self._room:
            self._room -= 1
            self._learn(data, repr((stamp, motion)))
        return stamp, motion

    def _learn(self, data: bytes, expected: str) -> None:
        """Keep a reader for the layout of a message if it reads the same as ROS (``expected``)."""
        try:
            layout = Layout(self._definition, data)
            read = _reader(layout, self._joint)
        except (BagError, KeyError, StructError):        # ROS can read it and we cannot
            return
        if repr(read(data)) == expected:                 # NaN is NaN here
            self._known.setdefault(len(data), []).append((layout, read))


def _reader(layout: Layout, joint: str) -> Read:
    """
    Return the function that reads stamp and motion from messages of one layout.

    It unpacks all at once by a format as '<4xi0xI37xd0xd': pad bytes before each number.
    """
    leaves = {leaf.name: leaf for leaf in layout.leaves}
    names = layout.texts.get('name', [joint])            # of a JointState; a Motion has no names
    i = names.index(joint) if joint in names else 0
    fields = ['header.stamp.sec', 'header.stamp.nanosec']
    has_joint = joint in names and i < (leaves['position'].shape or (1,))[0]
    if has_joint:
        fields += [name for name in ('position', 'velocity', 'acceleration')
                   if name in leaves and i < (leaves[name].shape or (1,))[0]]
    missing = (nan,) * (5 - len(fields))
    parts, end = [leaves['header.stamp.sec'].format[0]], 0       # begins with the byte order
    for name in fields:                                  # in their order in the message
        code, size = _CODES[leaves[name].format[1:]]
        begin = leaves[name].offset + size * (i if leaves[name].shape else 0)
        parts.append(f'{begin - end}x{code}')
        end = begin + size
    unpack = Struct(''.join(parts)).unpack_from

    def read(data: bytes) -> tuple[Stamp, Given | None]:
        values = unpack(data)
        return values[:2], values[2:] + missing if has_joint else None
    return read
