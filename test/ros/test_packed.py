# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Messages as packed bytes.

Those that ROS makes, for every output of every mechanism, in every status.
"""
from dataclasses import replace
import itertools
import math
import zlib

from fourbar_msgs.msg import LinkageState
from fourbar_ros.bag.layout import arrays
from fourbar_ros.pipeline.stepper import STATUS_NAMES, Stepper, Wanted
from fourbar_ros.ros import messages
from fourbar_ros.ros.messages import filler, packer, resolve, set_constants
from fourbar_ros.scene import scene
from fourbar_ros.scene.files import read_values
from fourbar_ros.scene.topics import DRIVEN, OUTPUTS
import pytest
from rclpy.serialization import deserialize_message, serialize_message
from support.bags import STORE
from support.samples import more
from support.scenes import TIP

NAMES = 'paper', 'cylinder', 'jansen', 'slider_crank', 'scotch_yoke', 'bucket', 'wiper'
STAMPS = (0, 0), (1, 999_999_999), (2**31 - 1, 0), (-1, 5)
FRAMES = 'a', 'abcdefg', 'x' * 61, 'Größe', '\x00'.join('ab'), ''


def scene_of(name):
    values = {**read_values(name), **TIP} if name == 'paper' else read_values(name)
    return scene.from_values({**values, 'drive.source': 'motion', 'outputs': list(OUTPUTS)})


def packed(pack, monkeypatch, *contents):
    """Return the bytes of a packer, which has ROS serialise nothing for them."""
    with monkeypatch.context() as patch:
        patch.setattr(messages, 'serialize_message', None)
        return pack(*contents)


def topics_of(its):
    return [DRIVEN, *its.topics.values()]


def message_of(topic, its):
    message = resolve(topic.type)()
    set_constants(topic.name, message, its)
    return message


def steps_of(its):
    """Yield (status, values) of good and bad inputs, then what no mechanism would give."""
    stepper = Stepper(its)
    for given in ((0.31, 2.0, -3.0), (0.31, math.nan, math.nan), (math.inf, 0.0, 0.0),
                  (99.0, 1e300, 1.0)):
        yield stepper.step(*given, Wanted(True, its.topics))
    count = len(its.layout.index_of)
    for status, hard in itertools.product(range(len(STATUS_NAMES)),
                                          (math.nan, math.inf, -0.0, 5e-324)):
        yield status, tuple(hard if k % 2 else -k * math.pi for k in range(count))


@pytest.mark.parametrize('name', more(NAMES[:3], NAMES))
def test_packed_bytes_are_what_ros_serialises(name, monkeypatch):
    its = scene_of(name)
    for topic in topics_of(its):
        filled = message_of(topic, its)
        fill = filler(topic.name, filled, its.layout)
        pack = packer(topic.name, message_of(topic, its), its.layout)
        for stamp, (status, values) in zip(itertools.cycle(STAMPS), steps_of(its)):
            fill(stamp, status, its.linkage.mode, values)
            data = packed(pack, monkeypatch, stamp, status, its.linkage.mode, values)
            assert type(data) is bytes
            same_but_for_padding(topic.type, data, serialize_message(filled))
            # NaN is NaN here
            assert repr(deserialize_message(data, type(filled))) == repr(filled)


def same_but_for_padding(type_name, data, expected):
    """Compare without padding, which holds old memory: that of ROS too."""
    (rows, records), = arrays(STORE, type_name, [expected, data], [])
    assert rows.tolist() == [0, 1]
    for name in records.dtype.names:
        assert records[name][0].tobytes() == records[name][1].tobytes(), name


@pytest.mark.parametrize('frame', FRAMES)
def test_any_frame_and_joint_names(frame, monkeypatch):
    """Texts move the numbers; no text is taken for one."""
    its = replace(scene_of('paper'), frame_id=frame,
                  joint_names=tuple(frame + str(k) for k in range(4)))
    for topic in topics_of(its):
        message = message_of(topic, its)
        pack = packer(topic.name, message, its.layout)
        status, values = Stepper(its).step(0.7, 25.0, 1.0, Wanted(True, its.topics))
        data = packed(pack, monkeypatch, (7, 8), status, 2, values)
        found = deserialize_message(data, type(message))
        filler(topic.name, message, its.layout)((7, 8), status, 2, values)
        assert repr(found) == repr(deserialize_message(serialize_message(message), type(message)))


def swapped():
    """Return a middleware with another order of bytes."""
    return (lambda message: serialize_message(message)[::-1],
            lambda data, kind: deserialize_message(data[::-1], kind))


def sealed():
    """Return a middleware that reads only what its checksum fits."""
    def read(data, kind):
        if zlib.crc32(data[:-4]) != int.from_bytes(data[-4:], 'little'):
            raise ValueError('checksum')
        return deserialize_message(data[:-4], kind)

    def write(message):
        data = serialize_message(message)
        return data + zlib.crc32(data).to_bytes(4, 'little')
    return write, read


@pytest.mark.parametrize('middleware', [swapped, sealed], ids=lambda made: made.__name__)
def test_where_bytes_do_not_read_back_ros_serialises_every_message(middleware, monkeypatch):
    write, read = middleware()
    monkeypatch.setattr(messages, 'serialize_message', write)
    monkeypatch.setattr(messages, 'deserialize_message', read)
    its = scene_of('paper')
    message = message_of(OUTPUTS['state'], its)
    put = packer('state', message, its.layout)
    status, values = Stepper(its).step(0.7, 25.0, 1.0, Wanted(True, its.topics))
    assert repr(read(put((7, 8), status, 2, values), LinkageState)) == repr(message)
    assert (message.theta4 == its.linkage.motion(0.7, 25.0, 1.0).theta4
            and message.header.stamp.nanosec == 8)
