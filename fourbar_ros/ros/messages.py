# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Turn numbers into messages: each is made once, filled many times, serialised once.

Packing writes only the numbers of a step into bytes that ROS serialised once: serialising anew
takes twice as long (docs/bench/node.md). The byte offset of each number is found by having ROS
serialise known numbers, so nothing here depends on the wire format. Test messages must then read
back through ROS unchanged, else ROS serialises every message.
"""
from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Sequence
from importlib import import_module
from math import inf, nan
from operator import itemgetter
from struct import Struct
from typing import Any, NamedTuple

from builtin_interfaces.msg import Time
from fourbar_ros.scene.message_fields import FieldMap, PASSIVE_EFFORT
from fourbar_ros.scene.scene import Scene
from rclpy.serialization import deserialize_message, serialize_message

Message = Any                   # a ROS message of whatever type
Stamp = tuple[int, int]         # as in a message, without making one: seconds, nanoseconds
Pack = Callable[[Stamp, int, int, Sequence[float]], bytes]     # (stamp, status, mode, values)
_STAMP, _STATUS, _NUMBER = Struct('<iI'), Struct('<BB'), Struct('<d')
_EXTREME = (nan, -0.0, inf, -inf, 5e-324, -1.7976931348623157e308, 0.1)


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
        if not hasattr(target, attribute):
            continue                         # messages of an older version are installed
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


# --- packed --------------------------------------------------------------------------------------

class _Contents(NamedTuple):
    """The contents of a message."""

    stamp: Stamp
    status: int
    mode: int
    values: Sequence[float]


def packer(output: str, message: Message, layout: FieldMap) -> tuple[Pack, bool]:
    """
    Return the function (stamp, status, mode, values) -> bytes of a message, and whether it packs.

    ``output`` names the message in the layout. The constants of the message (see
    :func:`set_constants`) must be set: they are in the bytes. If no
    packing is found, the function has ROS serialise each message.
    """
    fill = filler(output, message, layout)

    def serialise(stamp: Stamp, status: int, mode: int, values: Sequence[float]) -> bytes:
        fill(stamp, status, mode, values)
        return bytes(serialize_message(message))

    count = len(layout.place)
    pack = _packing(serialise, hasattr(message, 'status'), layout.in_use(output), count)
    if pack and all(_read_alike(message, serialise, pack, contents)
                    for contents in _trials(count)):
        return pack, True
    return serialise, False


def _packing(serialise: Pack, has_status: bool, used: Collection[int], count: int) -> Pack | None:
    """
    Return the function that writes the numbers of a step into a message's bytes.

    None if an offset is not found, or a stamp or status at several. ``used``: indices of the
    ``count`` values that the message holds. Two messages with different contents are serialised; a
    value's offset is where each message has its own content.
    """
    # unlike numbers, which hardly occur elsewhere in a message
    probes = [_Contents((0x1B2D3F41, 0x25374959), 0xA7, 0x5C, [k + 0.1 for k in range(count)]),
              _Contents((0x6E5D4C3B, 0x2A190817), 0x39, 0xE2, [-k - 0.7 for k in range(count)])]
    messages = [serialise(*probe) for probe in probes]
    stamps = list(_offsets(messages, [_STAMP.pack(*probe.stamp) for probe in probes]))
    statuses = list(_offsets(messages,
                             [_STATUS.pack(probe.status, probe.mode) for probe in probes]))
    numbers = sorted((offset, place) for place in used
                     for offset in _offsets(messages, [_NUMBER.pack(probe.values[place])
                                                       for probe in probes]))
    if (len(stamps) != 1 or len(statuses) != has_status
            or {place for _, place in numbers} != set(used)):
        return None

    # a message whose constants stay; each step overwrites its numbers, at these offsets
    buffer, at_stamp = bytearray(messages[0]), stamps[0]
    at_status = statuses[0] if has_status else None
    put_stamp, put_status, runs = _STAMP.pack_into, _STATUS.pack_into, list(_runs(numbers))

    def pack(stamp: Stamp, status: int, mode: int, values: Sequence[float]) -> bytes:
        put_stamp(buffer, at_stamp, *stamp)
        if at_status is not None:
            put_status(buffer, at_status, status, mode)
        for put, at, pick in runs:
            put(buffer, at, *pick(values))
        return bytes(buffer)
    return pack


def _offsets(messages: Sequence[bytes], parts: Sequence[bytes]) -> Iterator[int]:
    """
    Yield the offsets at which message 0 has part 0 and message 1 has part 1.

    A constant that looks like part 0 is the same in both messages, so it does not count.
    """
    at = messages[0].find(parts[0])
    while at >= 0:
        if messages[1].startswith(parts[1], at):
            yield at
        at = messages[0].find(parts[0], at + 1)


def _runs(numbers: Sequence[tuple[int, int]]
          ) -> Iterator[tuple[Callable[..., None], int, Callable[[Sequence[float]], Any]]]:
    """
    Yield (pack_into, offset, function that picks the values) for each run of adjacent doubles.

    One call writes a run. ``numbers``: (offset, index of the value), sorted.
    """
    size, begin = _NUMBER.size, 0
    for end in range(1, len(numbers) + 1):
        if end == len(numbers) or numbers[end][0] != numbers[end - 1][0] + size:
            places = [place for _, place in numbers[begin:end]]
            pick = (itemgetter(*places) if len(places) > 1
                    else lambda values, place=places[0]: (values[place],))
            yield Struct(f'<{len(places)}d').pack_into, numbers[begin][0], pick
            begin = end


def _trials(count: int) -> Iterator[_Contents]:
    """Yield contents with extreme numbers, stamps and states, to try a packer with."""
    for k, extreme in enumerate(_EXTREME):
        yield _Contents(((2**31 - 1) * (k % 2), 999_999_999 * (k % 3) // 2), k % 6, 1 + k % 2,
                        [extreme if (i + k) % 3 else i / 3.0 for i in range(count)])


def _read_alike(message: Message, serialise: Pack, pack: Pack, contents: _Contents) -> bool:
    """Return whether ROS reads one message from packed and serialised contents."""
    expected = repr(deserialize_message(serialise(*contents), type(message)))    # 'nan' == 'nan'
    try:
        return repr(deserialize_message(pack(*contents), type(message))) == expected
    except Exception:        # whatever a middleware raises for bytes that it cannot read
        return False
