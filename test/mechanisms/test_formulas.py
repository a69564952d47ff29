# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The code of the formulas.

Results by name, every tag of an equation in the docstring it belongs to.
"""
import ast
import inspect
import re
import textwrap

from fourbar_ros.mechanisms.kinds import KINDS
import pytest

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


def names(node):
    return [getattr(item, 'id', None) for item in node.elts]


@every_formula
def test_results_are_listed_by_the_names_of_their_fields(kind, what):
    _, trees = factories(kind, what)
    assert trees
    for tree in trees:
        inner = next(node for node in tree.body if isinstance(node, ast.FunctionDef))
        assert names(inner.body[-1].value) == list(getattr(kind, what)._fields), tree.name


@pytest.mark.parametrize('kind', KINDS.values(), ids=lambda kind: kind.__name__)
def test_loads_take_a_motion_apart_by_the_names_of_its_fields(kind):
    _, trees = factories(kind, 'LOADS')
    for tree in trees:
        inner = next(node for node in tree.body if isinstance(node, ast.FunctionDef))
        taken = names(inner.body[0].targets[0])
        assert len(taken) == len(kind.MOTION._fields)
        assert all(one in ('_', other) for one, other in zip(taken, kind.MOTION._fields)), taken


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
    assert count >= 3
