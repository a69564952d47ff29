# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The code of the formulas.

Records in and out, every tag of an equation in the docstring it belongs to.
"""
import ast
import inspect
import re
import textwrap

from fourbar_ros.mechanisms.kinds import KINDS
from fourbar_ros.numerics.number_types import ARRAY, REAL
import numpy as np
import pytest
from support import contract

FORMULAS = [(kind, what) for kind in KINDS.values() for what in ('MOTION', 'LOADS')]
every_formula = pytest.mark.parametrize('kind, what', FORMULAS,
                                        ids=lambda v: getattr(v, '__name__', v))


def factories(kind, what):
    """Return the module of a kind's motion or loads, and the trees of its factories."""
    module = inspect.getmodule(kind)
    name = f'{module.__name__.rpartition(".")[0]}.{what.lower()}'
    formulas = __import__(name, fromlist=['x'])
    functions = [f for n, f in vars(formulas).items() if re.fullmatch(r'make_(.+_)?(motion|loads)',
                                                                      n)
                 and inspect.getmodule(f) is formulas]
    return formulas, [ast.parse(textwrap.dedent(inspect.getsource(f))).body[0] for f in functions]


@pytest.mark.parametrize('case', contract.CASES, ids=contract.name_of)
def test_formulas_give_and_take_records(case):
    """Of any numbers, also where a part is out of range: a motion goes into the loads as it is."""
    for mechanism, given in contract.ordinary(case, 604, 1):
        for numbers, x in ((REAL, given[0]), (ARRAY, given[0] + np.linspace(-3.0, 3.0, 50))):
            with np.errstate(all='ignore'):
                motion = mechanism.make_motion(numbers)(x, *given[1:])
                loads = mechanism.make_loads(numbers)(motion)
            assert type(motion) is mechanism.MOTION and type(loads) is mechanism.LOADS


def with_what_it_is_made_of(module):
    """Return a module of formulas and those whose factories it calls."""
    made_of = {inspect.getmodule(function) for name, function in vars(module).items()
               if name.startswith('make_')}
    return [module, *(made_of - {module})]


@every_formula
def test_equations_are_numbered_in_the_docstring_and_tagged_in_the_code(kind, what):
    module, _ = factories(kind, what)
    count = 0
    for one in with_what_it_is_made_of(module):
        tags = set(re.findall(r'# (?:.*?)(\([ML]\d+\))', inspect.getsource(one)))
        numbered = re.findall(r'^ +(\([ML]\d+\))  ', one.__doc__, re.MULTILINE)
        count += len(numbered)
        assert len(numbered) == len(set(numbered))
        assert tags <= set(numbered) and len(tags) >= 0.5 * len(numbered), (tags, numbered)
    assert count >= 1
