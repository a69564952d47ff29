# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
What hypothesis draws: linkages, machines, inputs, parameters, messages and where bytes are hit.

Profiles are in test/conftest.py: ``quick`` in ``make test``, ``long`` in ``make test-all``.
"""
from math import inf, nan

from fourbar_ros.scene.parameters import of_name
from fourbar_ros.scene.topics import OUTPUTS, PICTURES
from hypothesis import strategies as st
import numpy as np
from rosbags.interfaces import Nodetype
from support import contract

seeds = st.integers(0, 2**32 - 1)
rates = st.floats(-30.0, 30.0)
inputs = st.tuples(st.floats(-9.0, 9.0), rates, st.floats(-90.0, 90.0))
wrenches = st.tuples(*[st.floats(-50.0, 50.0)] * 3)

# --- linkages and machines -----------------------------------------------------------------------


def mechanisms(case):
    """Draw (mechanism, input) of a case, or of machines of dyads, as the tests of kinds do."""
    return seeds.map(lambda seed: next(contract.ordinary(case, seed, 1)))


# --- values that a parameter should not have -----------------------------------------------------

DOUBLES = [0.0, -0.0, 1.0, -1.0, 1e-9, 1e9, -1e9, 5e-324, 1e-300, -1e-300, 1e154, 1e300, -1e300,
           1.7976931348623157e308, inf, -inf, nan]
HOSTILE = {
    'double': [*DOUBLES, 0, 3, 2**63 - 1],
    'integer': [0, 1, 2, 3, -1, 50, 2**31, 2**63 - 1, -2**63],
    'string': ['', 'x' * 100_000, '\n', 'ä\0', '../..', 'ground', 'crank', 'hold', 'dc'],
    'bool': [True, False],
    'strings': [[], [''], ['x'] * 1000, ['state', 'state'], [*OUTPUTS, *PICTURES],
                ['robot_description'], ['markers', 'traces', 'tf'],
                ['loads', 'links', 'reactions'], ['state']],
    'doubles': [[], [0.0], DOUBLES, [1] * 1000],
}


def hostile(rng, name):
    """Return a value that a parameter should not have, now and then of another type."""
    kind = of_name(name).type if rng.random() < 0.8 else rng.choice([*HOSTILE])
    if kind == 'double' and rng.random() < 0.3:
        return rng.choice([-1.0, 1.0]) * 10.0**rng.uniform(-20.0, 20.0)
    return rng.choice(HOSTILE[kind])


hostile_lengths = st.one_of(
    st.sampled_from(DOUBLES), st.floats(-20.0, 20.0).map(lambda power: 10.0**power),
    st.floats(0.1, 1.0))


def parameters(names):
    """Draw (parameter, hostile value), one of these names."""
    return st.sampled_from(names).flatmap(lambda name: st.tuples(
        st.just(name), st.randoms(use_true_random=False).map(lambda rng: hostile(rng, name))))


# --- messages ------------------------------------------------------------------------------------

BASES = ('bool', 'int8', 'uint8', 'int16', 'uint16', 'int32', 'uint32', 'int64', 'uint64',
         'float32', 'float64', 'string')


def _fields(kinds, most):
    one = st.tuples(st.sampled_from(kinds), st.sampled_from(('', '', '[]', '[3]', '[<=4]')))
    return st.lists(one, min_size=1, max_size=most).map(lambda found: ''.join(
        f'{kind}{many} f{k}\n' for k, (kind, many) in enumerate(found)))


definitions = st.tuples(_fields([*BASES, *['a/Inner'] * 3], 7), _fields(BASES, 4)).map(
    lambda found: f'{found[0]}{"=" * 80}\nMSG: a/Inner\n{found[1]}')


def _numbers(kind, count):
    kind = {'byte': 'uint8', 'octet': 'uint8', 'char': 'uint8'}.get(kind, kind)
    each = (st.booleans() if kind == 'bool' else st.integers(0, 100) if 'int' in kind
            else st.floats(-9.0, 9.0, width=32))
    return st.lists(each, min_size=count, max_size=count).map(
        lambda found: np.array(found, kind))


def _value(store, kind, what):
    if kind == Nodetype.NAME:
        return messages(store, what)
    if kind == Nodetype.BASE:
        return (st.text('abcä/ ', max_size=5) if what[0] == 'string'
                else _numbers(what[0], 1).map(lambda found: found[0].item()))
    (inner, its), count = what
    counts = st.just(count) if kind == Nodetype.ARRAY else st.integers(0, 3)
    if inner == Nodetype.BASE and its[0] != 'string':
        return counts.flatmap(lambda n: _numbers(its[0], n))
    return counts.flatmap(lambda n: st.lists(_value(store, inner, its), min_size=n, max_size=n))


def messages(store, type_name):
    """Draw a message of a type of rosbags; texts and sequences are of any small length."""
    return st.fixed_dictionaries({name: _value(store, *kind) for name, kind in store.fielddefs[
        type_name][1]}).map(lambda values: store.types[type_name](**values))
