# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
All that the shipped scenes give is as it was recorded, within the tolerance of each part.

What is meant to change is recorded again by ``python test/golden/record.py PART``.
"""
from functools import cache
import json

from golden import library, record
import numpy as np
import pytest
from support.samples import some

recorded = cache(record.read)


def every(parts):
    """Return (name, key) of all scenes of all parts, with the slow ones marked."""
    return [pytest.param(name, key, marks=[pytest.mark.slow]
                         if key.partition(' mode ')[0] in getattr(part, 'slow', ()) else [])
            for name, part in parts.items() for key in part.cases()]


@pytest.mark.parametrize(('name', 'key'), every(library.PARTS))
def test_it_is_as_recorded(name, key):
    part, old = library.PARTS[name], recorded(name)[key]
    if name == 'balances':
        pytest.importorskip('clarabel')
    if name == 'batch':
        near(key)
        if not library.are_bits_comparable(arrays=True):
            pytest.skip('numpy has other sines here than where the bits of arrays were recorded')
    found = record.failures(part, key, old, part.columns(key))
    assert not found, f'{len(found)} values of {name}:\n' + '\n'.join(found[:20])


def near(key):
    """Compare arrays with the single values: 64 eps of condition and size."""
    old, new = recorded('motion')[key], library.PARTS['batch'].together(key)
    for name, allowed in library.loose(old).items():
        error = np.abs(np.array(new[name]) - old[name])
        if name.startswith('theta'):        # pi and -pi are one angle
            error = np.minimum(error, np.abs(error - 2.0 * np.pi))
        assert (error <= allowed).all() or name == 'input', name


@pytest.mark.parametrize('name', library.PARTS)
def test_every_scene_is_recorded_and_no_other(name):
    assert list(recorded(name)) == list(library.PARTS[name].cases())


def test_a_changed_bit_of_the_record_is_found():
    key, part = 'paper mode 2', library.PARTS['motion']
    old = {name: list(column) for name, column in recorded('motion')[key].items()}
    old['alpha4'][3] *= 1.0 + 1e-9
    found, = record.failures(part, key, old, part.columns(key))
    assert found.startswith(f'{key}: alpha4 at 3, input {old["input"][3]!r}: recorded')
    assert '1 of ' in record.summary(part, key, old, part.columns(key))


def ros_parts():
    node = pytest.importorskip('golden.node', reason='needs ROS', exc_type=ImportError)
    return node.PARTS


def test_messages_are_as_recorded():
    part = ros_parts()['messages']
    assert list(recorded('messages')) == part.cases()
    for key in part.cases():
        assert part.columns(key) == recorded('messages')[key], key


@some('key', recorded('node'), ['paper'])
def test_a_node_shows_what_was_recorded(key):
    part, old = ros_parts()['node'], recorded('node')[key]
    new = json.loads(json.dumps(part.columns(key, old)))
    found = record.failures(part, key, old, new)
    assert not found, '\n'.join(found[:20])
