# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""C of a formula: what it refuses is what Python's floats refuse; numbers to the last bit."""
import ctypes
from math import inf, isnan, nan, sqrt

from fourbar_lab.export.fmu import build
from fourbar_lab.export.statements import literal, Statements
from fourbar_ros.numerics.trace import Trace
import pytest

HEAD = '#include <math.h>\n'


def compiled(folder, text):
    """Return the library of a C text."""
    (folder / 'its.c').write_text(HEAD + text)
    build(folder / 'its.c', folder / 'its.so')
    return ctypes.CDLL(str(folder / 'its.so'))


@pytest.fixture(scope='module')
def quotient_and_root(tmp_path_factory):
    """Return the C function of (x, y) -> (x / y, sqrt(x), 2 where x > y else 3)."""
    trace = Trace(lambda n, _: lambda x, y: (x / y, n.sqrt(x), n.where(x > y, 2.0, 3.0)), 2)
    text = Statements().function('of', trace).replace('static int', 'int')
    return compiled(tmp_path_factory.mktemp('c'), text).of


@pytest.mark.parametrize('given', [(4.0, 2.0), (2.0, 4.0), (-4.0, 2.0), (4.0, 0.0), (-4.0, 0.0)])
def test_it_refuses_what_floats_refuse(quotient_and_root, given):
    x, y = given
    to = (ctypes.c_double * 3)()
    refused = quotient_and_root((ctypes.c_double * 2)(*given), to)
    expected = 0
    try:
        assert x / y == to[0] or refused
    except ZeroDivisionError:
        expected = 1
    try:
        assert sqrt(x) == to[1]
    except ValueError:
        expected = 1
    assert refused == expected
    assert to[2] == (2.0 if x > y else 3.0)


def test_literals_are_the_same_numbers_in_c(tmp_path):
    values = [0.1, -0.1, -0.0, 1e-320, -1.7976931348623157e308, inf, -inf, nan, 3.0]
    text = f'double its[] = {{{", ".join(map(literal, values))}, 1.0 -{literal(-2.0)}}};\n'
    found = list((ctypes.c_double * 10).in_dll(compiled(tmp_path, text), 'its'))
    assert found[-1] == 3.0
    for value, one in zip(values, found):
        assert repr(one) == repr(value) or (isnan(value) and isnan(one))
