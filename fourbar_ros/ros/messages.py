# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Turn values into messages: each is made once, filled many times, serialised once.

Packing writes only the values of a step into bytes that ROS serialised once: serialising anew
takes twice as long (docs/bench/node.md). The byte offset of each value is found by having ROS
serialise known values, so little here depends on the wire format. Test messages must then read
back through ROS unchanged, else ROS serialises every message.
"""
from collections.abc import Callable, Collection, Sequence
from importlib import import_module
from math import nan
from operator import itemgetter
from struct import Struct
from typing import Any

from builtin_interfaces.msg import Time
from fourbar_ros.scene.message_fields import FieldMap, PASSIVE_EFFORT
from fourbar_ros.scene.scene import Scene
from rclpy.serialization import deserialize_message, serialize_message

Message = Any                   # a ROS message of whatever type
Stamp = tuple[int, int]         # as in a message, without making one: seconds, nanoseconds
Pack = Callable[[Stamp, int, int, Sequence[float]], bytes]     # (stamp, status, mode, values)
_STAMP, _STATUS, _DOUBLE = Struct('<iI'), Struct('<BB'), Struct('<d')
_EXTREME = nan, -1.7976931348623157e308


def sec_nanosec(nanoseconds: int) -> Stamp:
    return divmod(nanoseconds, 10**9)


def to_stamp(nanoseconds: int) -> Time:
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
    """Fill the fields of an output message that are the same in every step of a scene."""
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

    ``values``: the floats of a step in the order of ``layout.index_of``. Where each of them goes
    (``wrench.force.x``, say) is looked up once, here, not in every step.
    """
    scalars, arrays = [], []        # (message inside it, attribute, index or indices)
    for field, source in layout.fields[output].items():
        *path, attribute = field.split('.')
        target = message
        for name in path:
            target = getattr(target, name)
        if not hasattr(target, attribute):
            continue                         # messages of an older version are installed
        if isinstance(source, tuple):
            arrays.append((target, attribute,
                           [None if name is None else layout.index_of[name] for name in source]))
        else:
            scalars.append((target, attribute, layout.index_of[source]))
    has_status = hasattr(message, 'status')

    def fill(stamp: Stamp, status: int, mode: int, values: Sequence[float]) -> None:
        message.header.stamp.sec, message.header.stamp.nanosec = stamp
        if has_status:
            message.status, message.mode = status, mode
        for target, attribute, index in scalars:
            setattr(target, attribute, values[index])
        for target, attribute, indices in arrays:
            setattr(target, attribute, [PASSIVE_EFFORT if index is None else values[index]
                                        for index in indices])
    return fill


# --- packed --------------------------------------------------------------------------------------

def packer(output: str, message: Message, layout: FieldMap) -> Pack:
    """
    Return the function (stamp, status, mode, values) -> bytes of a message.

    ``output`` names the message in the layout. The constants of the message (see
    :func:`set_constants`) must be set: they are in the bytes. Where packed bytes do not read back
    unchanged, the function has ROS serialise each message.
    """
    fill, kind = filler(output, message, layout), type(message)

    def serialise(stamp: Stamp, status: int, mode: int, values: Sequence[float]) -> bytes:
        fill(stamp, status, mode, values)
        return bytes(serialize_message(message))

    count = len(layout.index_of)
    pack = _packing(serialise, hasattr(message, 'status'), layout.in_use(output), count)
    for k, extreme in enumerate(_EXTREME):
        stamp = (2**31 - 1) * (k % 2), 999_999_999 * (k % 3) // 2
        values = [extreme if (i + k) % 3 else i / 3.0 for i in range(count)]
        contents = stamp, k % 6, 1 + k % 2, values
        expected = repr(deserialize_message(serialise(*contents), kind))    # 'nan' == 'nan'
        try:
            if pack and repr(deserialize_message(pack(*contents), kind)) != expected:
                pack = None
        except Exception:        # whatever a middleware raises for bytes that it cannot read
            pack = None
    return pack or serialise


def _packing(serialise: Pack, has_status: bool, used: Collection[int], count: int) -> Pack | None:
    """Return the packing function, None if the bytes of a value of ``used`` are not found."""
    # values unlike each other, which hardly occur elsewhere in a message
    stamp, status, mode = (0x1B2D3F41, 0x25374959), 0xA7, 0x5C
    values = [-k - 0.7 for k in range(count)]
    # a message whose constants stay; each step overwrites the values, at these offsets
    buffer = bytearray(serialise(stamp, status, mode, values))
    stamp_offset = buffer.find(_STAMP.pack(*stamp))
    status_offset = buffer.find(_STATUS.pack(status, mode), stamp_offset) if has_status else None
    doubles = []                             # (offset, index of the value)
    for index in used:
        data = _DOUBLE.pack(values[index])
        offset = buffer.find(data)
        while offset >= 0:
            doubles.append((offset, index))
            offset = buffer.find(data, offset + 1)
    if -1 in (stamp_offset, status_offset) or {index for _, index in doubles} != set(used):
        return None
    # (pack_into, offset, function that picks values): one call writes a run of adjacent doubles
    runs: list[tuple[Callable[..., None], int, Callable[[Sequence[float]], Any]]] = []
    doubles, begin = sorted(doubles), 0
    for end in range(1, len(doubles) + 1):
        if end == len(doubles) or doubles[end][0] != doubles[end - 1][0] + _DOUBLE.size:
            indices = [index for _, index in doubles[begin:end]]
            pick = (itemgetter(*indices) if len(indices) > 1
                    else lambda values, index=indices[0]: (values[index],))
            runs.append((Struct(f'<{len(indices)}d').pack_into, doubles[begin][0], pick))
            begin = end
    put_stamp, put_status = _STAMP.pack_into, _STATUS.pack_into

    def pack(stamp: Stamp, status: int, mode: int, values: Sequence[float]) -> bytes:
        put_stamp(buffer, stamp_offset, *stamp)
        if status_offset is not None:
            put_status(buffer, status_offset, status, mode)
        for put, offset, pick in runs:
            put(buffer, offset, *pick(values))
        return bytes(buffer)
    return pack
