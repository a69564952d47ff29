# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Arrays of serialised messages against the decoder of rosbags, message by message."""
from fourbar_ros.bag.layout import arrays, misfits
from fourbar_ros.errors import BagError
from hypothesis import given
from hypothesis import strategies as st
import numpy as np
import pytest
from rosbags.interfaces import Nodetype
from rosbags.typesys import get_types_from_msg, get_typestore, Stores
from support import bags
from support.strategies import definitions, messages

TYPES = ['fourbar_msgs/msg/LinkageState', 'std_msgs/msg/String', 'sensor_msgs/msg/JointState',
         'std_msgs/msg/Empty', 'diagnostic_msgs/msg/DiagnosticArray', 'tf2_msgs/msg/TFMessage',
         'sensor_msgs/msg/PointCloud2']


def flat(store, type_name, message, path=''):
    """Yield (path, value) of all fields, as Layout names them."""
    for name, (kind, what) in store.fielddefs[type_name][1]:
        yield from flat_of(store, kind, what, getattr(message, name), path + name)


def flat_of(store, kind, what, value, path):
    if kind == Nodetype.NAME:
        yield from flat(store, what, value, f'{path}.')
    elif kind == Nodetype.BASE:
        yield path, value
    elif what[0][0] == Nodetype.BASE and what[0][1][0] != 'string':
        yield path, np.asarray(value)
    else:
        for place, each in enumerate(value):
            yield from flat_of(store, *what[0], each, f'{path}[{place}]')


def check(store, type_name, messages, little):
    encoded = [bytes(store.serialize_cdr(message, type_name, little_endian=little))
               for message in messages]
    rows_seen = []
    for rows, records in arrays(store, type_name, encoded, []):
        assert rows.tolist() == sorted(rows.tolist()) and records.shape == rows.shape
        rows_seen += rows.tolist()
        for row, record in zip(rows.tolist(), records):
            decoded = store.deserialize_cdr(encoded[row], type_name)
            expected = dict(flat(store, type_name, decoded))
            assert list(records.dtype.names or ()) == list(expected)
            for name, value in expected.items():
                if isinstance(value, str):
                    assert record[name].decode() == value
                else:
                    assert np.array_equal(record[name], value), name
    assert sorted(rows_seen) == list(range(len(messages)))


@pytest.mark.parametrize('type_name', TYPES)
@given(st.data(), st.booleans())
def test_messages_are_read_as_rosbags_decodes_them(type_name, data, little):
    check(bags.STORE, type_name,
          data.draw(st.lists(messages(bags.STORE, type_name), max_size=6)), little)


@given(definitions, st.booleans(), st.data())
def test_types_of_any_shape_are_read_as_rosbags_decodes_them(definition, little, data):
    store = get_typestore(Stores.EMPTY)
    store.register(get_types_from_msg(definition, 'a/msg/Outer'))
    check(store, 'a/msg/Outer', data.draw(st.lists(messages(store, 'a/msg/Outer'), max_size=6)),
          little)


def test_a_message_that_is_shorter_than_its_type_is_an_error_not_a_number():
    data = bags.motion(1)
    for length in range(len(data)):
        with pytest.raises(BagError, match='fit its definition|not a CDR message'):
            list(arrays(bags.STORE, 'fourbar_msgs/msg/Motion', [data, data[:length]], []))
    cut = [data[:length] for length in range(len(data))]
    for those in (cut, [data, *cut, data], [data + bytes(100)] * 2):
        assert misfits(bags.STORE, 'fourbar_msgs/msg/Motion', those) == sum(
            each is not data for each in those)


def test_the_bytes_between_fields_do_not_matter():
    """Fast CDR leaves old memory there."""
    values = {'header': bags.stamp(1, 'abcde'), 'name': ['a', 'bc', 'def'],
              'position': np.arange(3.0), 'velocity': np.arange(3.0), 'effort': np.zeros(0)}
    data = bags.encode('sensor_msgs/msg/JointState', **values)
    rng = np.random.default_rng(1)
    dirty = bags.with_old_memory(data, ['abcde', 'a', 'bc', 'def'], rng)
    assert dirty != data
    (rows, records), = arrays(bags.STORE, 'sensor_msgs/msg/JointState', [data, dirty], [])
    assert rows.tolist() == [0, 1]
    assert all(np.array_equal(records[name][0], records[name][1]) for name in records.dtype.names)


@pytest.mark.parametrize('full', [(), ('position',), ('position', 'velocity'), ('effort',)])
def test_joint_states_without_rates_fit_as_rclpy_sends_them(full):
    """Its sizes count padding behind each empty sequence of doubles."""
    sensor_msgs = pytest.importorskip('sensor_msgs.msg')
    serialization = pytest.importorskip('rclpy.serialization')
    for names in (['a'], ['a', 'b'], ['abc', 'de'], ['abcd', 'efghi', 'j']):
        data = serialization.serialize_message(sensor_msgs.JointState(
            name=names, **{field: [1.0] * len(names) for field in full}))
        (rows, records), = arrays(bags.STORE, 'sensor_msgs/msg/JointState', [data], [])
        assert rows.tolist() == [0]
        assert all((records[field] == 1.0).all() for field in full)
