# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Messages as bytes that ROS serialised once: afterwards only their numbers are written.

Where a number stands is not known from the format of the wire but found in what ROS made of known
numbers, and what was packed must read back through ROS as the message that was meant.
"""
from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Sequence
from math import inf, nan
from operator import itemgetter
from struct import Struct
from typing import Any, NamedTuple

from fourbar_ros.ros.messages import filler, Message, Stamp
from fourbar_ros.scene.message_fields import FieldMap
from rclpy.serialization import deserialize_message, serialize_message

_STAMP, _STATUS, _NUMBER = Struct('<iI'), Struct('<BB'), Struct('<d')
_HARD = (nan, -0.0, inf, -inf, 5e-324, -1.7976931348623157e308, 0.1)


Pack = Callable[[Stamp, int, int, Sequence[float]], bytes]     # status and mode as numbers


class _Given(NamedTuple):
    """What a message is made of."""

    stamp: Stamp
    status: int
    mode: int
    values: Sequence[float]


def writer(output: str, message: Message, layout: FieldMap) -> tuple[Pack, bool]:
    """
    Return the function (stamp, status, mode, values) -> bytes of a message, and whether it packs.

    Parameters
    ----------
    output : str
        Name of the output in the layout.
    message : ROS message
        With its constants set; what is written depends on them, so on the scene.
    layout : fourbar_ros.scene.message_fields.FieldMap

    """
    fill = filler(output, message, layout)

    def serialised(stamp: Stamp, status: int, mode: int, values: Sequence[float]) -> bytes:
        fill(stamp, status, mode, values)
        found: bytes = serialize_message(message)
        return found

    pack = _packer(serialised, hasattr(message, 'status'), layout.in_use(output),
                   len(layout.place))
    if pack and all(_same(message, serialised, pack, given)
                    for given in _trials(len(layout.place))):
        return pack, True
    return serialised, False


def _packer(serialised: Pack, has_status: bool, used: Collection[int], count: int) -> Pack | None:
    """Return the function that writes numbers into a message's bytes, None if not found."""
    probes = [_Given((0x1B2D3F41, 0x25374959), 0xA7, 0x5C, [k + 0.1 for k in range(count)]),
              _Given((0x6E5D4C3B, 0x2A190817), 0x39, 0xE2, [-k - 0.7 for k in range(count)])]
    made = [serialised(*probe) for probe in probes]
    stamps = list(_places(made, [_STAMP.pack(*probe.stamp) for probe in probes]))
    statuses = list(_places(made, [_STATUS.pack(probe.status, probe.mode) for probe in probes]))
    numbers = sorted((at, place) for place in used
                     for at in _places(made, [_NUMBER.pack(probe.values[place])
                                              for probe in probes]))
    if (len(stamps) != 1 or len(statuses) != has_status or {place for _, place in numbers}
            != set(used)):
        return None

    buffer, at_stamp, at_status = (bytearray(made[0]), stamps[0], statuses[0] if has_status
                                   else None)
    put_stamp, put_status, runs = _STAMP.pack_into, _STATUS.pack_into, list(_runs(numbers))

    def pack(stamp: Stamp, status: int, mode: int, values: Sequence[float]) -> bytes:
        put_stamp(buffer, at_stamp, *stamp)
        if at_status is not None:
            put_status(buffer, at_status, status, mode)
        for put, at, pick in runs:
            put(buffer, at, *pick(values))
        return bytes(buffer)
    return pack


def _places(made: Sequence[bytes], parts: Sequence[bytes]) -> Iterator[int]:
    """
    Yield where the first of two messages has the first part and the second the second.

    No constant does.
    """
    at = made[0].find(parts[0])
    while at >= 0:
        if made[1].startswith(parts[1], at):
            yield at
        at = made[0].find(parts[0], at + 1)


def _runs(numbers: Sequence[tuple[int, int]]
          ) -> Iterator[tuple[Callable[..., None], int, Callable[[Sequence[float]], Any]]]:
    """Yield (pack_into, offset, picker of the values) for runs of adjacent doubles."""
    size, begin = _NUMBER.size, 0
    for end in range(1, len(numbers) + 1):
        if end == len(numbers) or numbers[end][0] != numbers[end - 1][0] + size:
            places = [place for _, place in numbers[begin:end]]
            pick = (itemgetter(*places) if len(places) > 1
                    else lambda values, place=places[0]: (values[place],))
            yield Struct(f'<{len(places)}d').pack_into, numbers[begin][0], pick
            begin = end


def _trials(count: int) -> Iterator[_Given]:
    """Yield extreme contents: packed, each must have the bytes that rclpy gives it."""
    for k, hard in enumerate(_HARD):
        yield _Given(((2**31 - 1) * (k % 2), 999_999_999 * (k % 3) // 2), k % 6, 1 + k % 2,
                     [hard if (place + k) % 3 else place / 3.0 for place in range(count)])


def _same(message: Message, serialised: Pack, pack: Pack, given: _Given) -> bool:
    """Return whether ROS reads the same from both."""
    meant = repr(deserialize_message(serialised(*given), type(message)))         # NaN is NaN here
    try:
        return repr(deserialize_message(pack(*given), type(message))) == meant
    # whatever a middleware raises for bytes that it cannot read
    except Exception:
        return False
