# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Inputs read from their bytes.

What ROS reads, whoever wrote them, and whatever became of them on the way.
"""
import itertools
import math
import struct

from builtin_interfaces.msg import Time
from fourbar_msgs.msg import Motion
from fourbar_ros.ros.node import inputs
from fourbar_ros.ros.node.inputs import Reader
from fourbar_ros.scene import message_fields as records
import pytest
from rclpy.serialization import deserialize_message, serialize_message
from sensor_msgs.msg import JointState
from std_msgs.msg import Header

MOTION, JOINTS = 'fourbar_msgs/msg/Motion', 'sensor_msgs/msg/JointState'
STAMPS = Time(), Time(sec=2**31 - 1, nanosec=999_999_999), Time(sec=-1, nanosec=2**32 - 1)
FRAMES = '', 'f', 'base_link', 'Größe', 'x' * 300
NUMBERS = 0.0, -0.0, math.nan, math.inf, 5e-324, -1.7976931348623157e308, math.pi


def motions():
    numbers = itertools.cycle(NUMBERS)
    for stamp, frame in itertools.product(STAMPS, FRAMES):
        yield Motion(header=Header(stamp=stamp, frame_id=frame), position=next(numbers),
                     velocity=next(numbers),
                     acceleration=next(numbers))


def joint_states():
    numbers = itertools.cycle(NUMBERS)
    for stamp, frame in itertools.product(STAMPS, FRAMES):
        for names in ([], ['motor'], ['a', 'motor'], ['motor', 'a'], ['motor', 'motor', 'b'],
                      ['a', 'b'], ['Größe', 'motor']):
            for lengths in ((0, 0, 0), (1, 1, 1), (2, 2, 2), (3, 3, 3), (2, 1, 0), (3, 0, 3),
                            (1, 0, 0), (2, 0, 0)):
                arrays = [[next(numbers) for _ in range(length)] for length in lengths]
                yield JointState(header=Header(stamp=stamp, frame_id=frame), name=names,
                                 position=arrays[0],
                                 velocity=arrays[1], effort=arrays[2])


def by_ros(data, kind, joint=''):
    """Return what ROS reads, as text: NaN is NaN there."""
    message = deserialize_message(data, kind)
    return repr(((message.header.stamp.sec, message.header.stamp.nanosec),
                 records.driven_of(message, joint)))


def or_error(function, *args):
    try:
        return function(*args)
    except Exception as error:
        return type(error)


@pytest.mark.parametrize('type_name, messages', [(MOTION, motions), (JOINTS, joint_states)],
                         ids=['Motion', 'JointState'])
def test_what_is_read_is_what_ros_reads(type_name, messages, monkeypatch):
    monkeypatch.setattr(inputs, 'LAYOUTS', 10_000)
    reader, asked = Reader(type_name, 'motor'), []
    monkeypatch.setattr(inputs, 'deserialize_message', lambda *a: asked.append(1)
                        or deserialize_message(*a))
    sent = [(serialize_message(message), type(message)) for message in messages()]
    for data, kind in sent:
        assert repr(reader(data)) == by_ros(data, kind, 'motor')
    asked.clear()
    for data, kind in sent:
        assert repr(reader(data)) == by_ros(data, kind, 'motor')
    # the second time without ROS, every one of them
    assert not asked


@pytest.mark.parametrize('message', [
    Motion(header=Header(frame_id='abc'), position=1.0, velocity=2.0, acceleration=3.0),
    JointState(header=Header(frame_id='abc'), name=['a', 'motor'], position=[1.0, 2.0],
               velocity=[3.0, 4.0]),
], ids=['Motion', 'JointState'])
def test_damaged_bytes_are_read_as_ros_reads_them_or_refused_as_ros_does(message):
    """
    Every byte changed, every length.

    A reader that knows the layout does not take what ROS refuses.
    """
    kind, data = type(message), serialize_message(message)
    type_name = MOTION if kind is Motion else JOINTS
    damaged = [data[:at] + bytes([value]) + data[at + 1:] for at in range(len(data))
               for value in (0, 7, 255)]
    damaged += [data[:end] for end in range(len(data))] + [data + b'\x00' * k for k in range(1, 9)]
    for bad in damaged:
        reader = Reader(type_name, 'motor')
        reader(data)
        assert or_error(lambda: repr(reader(bad))) == or_error(by_ros, bad, kind,
                                                               'motor')       # noqa: B023
        assert repr(reader(data)) == by_ros(data, kind, 'motor')


def test_the_other_order_of_bytes():
    data = b'\x00\x00\x00\x00' + struct.pack('>iII4s3d', 5, 6, 4, b'abc\x00', 0.1, math.nan, -3.0)
    reader = Reader(MOTION)
    for _ in range(2):
        assert repr(reader(data)) == by_ros(data, Motion) == repr(((5, 6), (0.1, math.nan, -3.0)))


def test_senders_with_ever_new_names_cost_no_memory():
    reader = Reader(JOINTS, 'motor')
    for k in range(20 * inputs.LAYOUTS):
        data = serialize_message(JointState(name=[f'joint{k}', 'motor'], position=[0.0, k + 0.5]))
        assert reader(data)[1][0] == k + 0.5
    assert sum(map(len, reader._known.values())) <= inputs.LAYOUTS


@pytest.mark.parametrize('theirs, ours', [
    ('float64 velocity', 'int64 velocity'), ('float64 velocity', 'float64 speed'),
    ('float64 position', 'float64[2] position'),
    ('float64 acceleration', 'float32[2] acceleration'),
    ('std_msgs/Header header', 'std_msgs/Header head')])
def test_a_layout_that_does_not_read_what_ros_reads_is_not_used(theirs, ours, monkeypatch):
    """The check that guards it: a definition on disk that is not the one ROS was built with."""
    text = inputs.definition(MOTION)
    assert theirs in text
    monkeypatch.setattr(inputs, 'definition', lambda name: text.replace(theirs, ours))
    data = serialize_message(Motion(position=1.0, velocity=2.0, acceleration=3.0))
    reader = Reader(MOTION)
    assert [reader(data)[1] for _ in range(3)] == [(1.0, 2.0, 3.0)] * 3
    assert not reader._known
