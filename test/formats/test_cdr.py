# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Messages decoded as an independent codec encodes them; odd definitions end in one line."""
import math

from fourbar_ros.bag.cdr import Decoder
from fourbar_ros.errors import BagError
import numpy as np
import pytest
from support import bags

TYPES = ['fourbar_msgs/msg/Motion', 'fourbar_msgs/msg/LinkageState',
         'fourbar_msgs/msg/LinkageLoads',
         'sensor_msgs/msg/JointState', 'geometry_msgs/msg/WrenchStamped', 'std_msgs/msg/String',
         'visualization_msgs/msg/MarkerArray', 'diagnostic_msgs/msg/DiagnosticArray',
         'sensor_msgs/msg/Imu',
         'sensor_msgs/msg/PointCloud2', 'tf2_msgs/msg/TFMessage', 'std_msgs/msg/Empty']


def filled(type_name, rng, depth=0):
    """Return a message of random content, sequences of random length."""
    values = {}
    for name, (kind, what) in bags.STORE.fielddefs[type_name][1]:
        if kind in (3, 4):
            (inner, inner_type), size = what
            count = size if kind == 3 else int(rng.integers(0, 4))
            if inner == 1 and inner_type[0] != 'string':
                values[name] = number(inner_type[0], rng, count)
            else:
                values[name] = [single(inner, inner_type, rng, depth) for _ in range(count)]
        else:
            values[name] = single(kind, what, rng, depth)
    return bags.STORE.types[type_name](**values)


def single(kind, what, rng, depth):
    if kind == 2:
        return filled(what, rng, depth + 1)
    if what[0] == 'string':
        return ''.join(rng.choice(list('abcäß_/ '), int(rng.integers(0, 7))))
    return number(what[0], rng, 1)[0].item()


def number(kind, rng, count):
    if kind == 'bool':
        return rng.integers(0, 2, count).astype(bool)
    if kind.startswith('float'):
        values = rng.normal(size=count).astype(kind)
        values[rng.random(count) < 0.1] = np.nan
        return values
    if kind in ('byte', 'octet', 'char'):
        # whose sign the two codecs see differently
        return rng.integers(0, 127, count, dtype=np.uint8)
    info = np.iinfo(kind)
    return rng.integers(info.min, info.max, count, dtype=kind, endpoint=True)


def plain(value):
    """Return nested plain values, NaN as text."""
    if hasattr(value, '__dict__'):
        return {k: plain(v) for k, v in vars(value).items() if k != '__msgtype__'
                and not k.isupper()
                and k != 'structure_needs_at_least_one_member'}
    if hasattr(value, '__len__') and not isinstance(value, str):
        return [plain(v) for v in value]
    value = value.item() if hasattr(value, 'item') else value
    return 'NaN' if isinstance(value, float) and math.isnan(value) else value


@pytest.mark.parametrize('type_name', TYPES)
def test_messages_are_decoded_as_an_independent_codec_encoded_them(type_name):
    rng = np.random.default_rng(7)
    decoder = Decoder(type_name, bags.text_of(type_name))
    messages = [filled(type_name, rng) for _ in range(40)]
    for little in (True, False):
        encoded = [bytes(bags.STORE.serialize_cdr(m, type_name, little_endian=little))
                   for m in messages]
        for message, data in zip(messages, encoded):
            assert plain(decoder.message(data)) == plain(message)
        rows_seen = []
        for layout, rows, found in decoder.arrays(encoded):
            rows_seen += rows.tolist()
            for row, record in zip(rows, found):
                assert layout.matches(encoded[row]) and record.tobytes() == encoded[row]
        assert sorted(rows_seen) == list(range(40))


def test_a_message_that_is_shorter_than_its_type_is_an_error_not_a_number():
    decoder = Decoder('fourbar_msgs/msg/LinkageState',
                      bags.text_of('fourbar_msgs/msg/LinkageState'))
    data = bags.motion(1)
    for length in range(4, len(data)):
        with pytest.raises(BagError, match='shorter than its definition'):
            decoder.message(data[:length])


HUGE = 'a/A[100000000] x\n' + '=' * 80 + '\nMSG: a/A\nuint8[0] y\n'


def test_a_definition_within_itself_is_named():
    for definition, said in (('a/T x\n', 'within itself'), (HUGE, 'more fields'),
                             ('int8 x\nint8 x\n', 'name already used')):
        with pytest.raises(BagError, match=said):
            Decoder('a/msg/T', definition).message(b'\0\1\0\0' + bytes(40))
