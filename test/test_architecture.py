# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
What import-linter cannot say of who may import whom: no circles of modules, nothing private.

The layers and who may name a kind are contracts in pyproject.toml, which ``make lint`` checks.
"""
import ast
from functools import cache
import re

import pytest
from support import ROOT

PACKAGES = 'fourbar_ros', 'fourbar_lab'
MODULES = {'.'.join(path.relative_to(ROOT).with_suffix('').parts).removesuffix('.__init__'): path
           for package in PACKAGES
           for path in sorted((ROOT / package).rglob('*.py'))}

# Third-party packages, and the lowest folders that may import them.
THIRD_PARTY = {'yaml': ('scene', 'bag', 'reproduction', 'studies', 'ros',
                        'cli', 'description'),
               'mcap': ('bag',),
               'rich': ('report', 'cli', 'ros', 'reproduction', 'lab'),
               'matplotlib': ('report', 'bag', 'reproduction', 'studies', 'balancing', 'cli',
                              'dynamics'),
               'nicegui': ('live',),
               'flint': ('numerics', 'extrema', 'studies'),
               'scipy': ('dynamics', 'studies', 'balancing', 'reproduction'),
               'pyarrow': ('bag', 'report', 'studies'),
               'distributed': ('studies',), 'openpyxl': ('report',)}


@cache
def nodes_of(path):
    """Return all nodes of a file's syntax tree."""
    return list(ast.walk(ast.parse(path.read_text())))


@cache
def imports_of(path):
    """Return (module, name or None, line) of everything a file imports."""
    found = []
    for node in nodes_of(path):
        if isinstance(node, ast.Import):
            found += [(alias.name, None, node.lineno) for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f'{path}:{node.lineno}: relative import'
            found += [(node.module, alias.name, node.lineno) for alias in node.names]
    return found


def edges():
    """Yield (importing module, imported module of the package, line)."""
    for module, path in MODULES.items():
        for imported, name, line in imports_of(path):
            if imported.split('.')[0] in PACKAGES:
                full = f'{imported}.{name}'
                yield module, full if full in MODULES else imported, line


def folder_of(module):
    """Return the top folder (or module) of a module; '' for the package itself."""
    package, _, rest = module.partition('.')
    folder = rest.partition('.')[0]
    return 'lab' if package == 'fourbar_lab' and folder in ('', 'cli') else folder


def lines_for_type_checkers(path):
    """Return the lines below ``if TYPE_CHECKING:``, which are never run."""
    return {line for node in nodes_of(path) if isinstance(node, ast.If)
            and getattr(node.test, 'id', '') == 'TYPE_CHECKING'
            for line in range(node.lineno, node.end_lineno + 1)}


def test_there_is_no_circle():
    # in annotations alone two files of one folder may name each other
    unseen = {module: lines_for_type_checkers(path) for module, path in MODULES.items()}
    graph = {module: set() for module in MODULES}
    for module, imported, line in edges():
        if line not in unseen[module] or folder_of(module) != folder_of(imported):
            graph[module].add(imported)
    done, path = set(), []

    def visit(module):
        if module in path:
            pytest.fail(' -> '.join([*path[path.index(module):], module]))
        if module not in done:
            path.append(module)
            for other in sorted(graph[module] - {'fourbar_ros'}):
                visit(other)
            done.add(path.pop())

    for module in MODULES:
        visit(module)


def test_nothing_private_crosses_modules():
    wrong = [f'{module}:{line} imports {name}' for module, path in MODULES.items()
             for imported, name, line in imports_of(path)
             if name and name.startswith('_') and not name.startswith('__')
             and imported.startswith(PACKAGES)]
    for module, path in MODULES.items():
        nodes = nodes_of(path)
        own = {node.attr for node in nodes if isinstance(node, ast.Attribute)
               and isinstance(node.ctx, ast.Store)}
        own |= {node.name for node in nodes if isinstance(node, (ast.FunctionDef, ast.ClassDef))}
        own |= {node.id for node in nodes if isinstance(node, ast.Name)}
        for node in nodes:
            if (isinstance(node, ast.Attribute) and node.attr.startswith('_')
                and not node.attr.startswith('__')
                    # of its own base class
                    and getattr(node.value, 'id', '') not in ('self', 'cls')
                    and node.attr not in own and node.attr not in ('_fields', '_asdict',
                                                                   '_replace', '_make')):
                wrong.append(f'{module}:{node.lineno} uses .{node.attr}')
    assert not wrong, '\n'.join(wrong)


def test_third_party_packages_stay_in_their_folders():
    wrong = []
    for module, path in MODULES.items():
        for imported, _, line in imports_of(path):
            allowed = THIRD_PARTY.get(imported.split('.')[0])
            if allowed and folder_of(module) not in allowed:
                wrong.append(f'{module}:{line} imports {imported}')
    assert not wrong, '\n'.join(wrong)


def test_no_type_test_of_a_kind():
    wrong = []
    for module, path in MODULES.items():
        if module == 'fourbar_ros.extrema.methods':
            continue
        for node in nodes_of(path):
            if (isinstance(node, ast.Call) and getattr(node.func, 'id', '') in ('isinstance',
                                                                                'issubclass')):
                names = {n.id for n in ast.walk(node.args[1]) if isinstance(n, ast.Name)}
                if names & {'FourBar', 'SliderCrank', 'InvertedSlider', 'ScotchYoke'}:
                    wrong.append(f'{module}:{node.lineno}')
    assert not wrong, '\n'.join(wrong)


def bodies():
    """Yield (where, lines of the body without the docstring) of every function."""
    for module, path in MODULES.items():
        for node in nodes_of(path):
            if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)):
                body = node.body[1:] if ast.get_docstring(node) is not None else node.body
                yield (f'{module}:{node.lineno} {node.name}',
                       body[-1].end_lineno - body[0].lineno + 1 if body else 0)


def test_functions_fit_on_a_screen():
    longest = [f'{where}: {size}' for where, size in bodies() if size > 45]
    assert not longest, '\n'.join(longest)


def is_typed(function):
    """Return whether all arguments and the result of a function are annotated."""
    given = function.args
    arguments = [*given.posonlyargs, *given.args, *given.kwonlyargs,
                 *filter(None, (given.vararg, given.kwarg))]
    return ((function.returns is not None or function.name == '__init__')
            and all(a.annotation is not None or a.arg in ('self', 'cls') for a in arguments))


def test_as_many_functions_are_typed_as_the_architecture_says():
    every = {f'{module}:{node.lineno} {node.name}': is_typed(node)
             for module, path in MODULES.items() for node in nodes_of(path)
             if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef))}
    text = (ROOT / 'docs' / 'architecture.md').read_text()
    stated = int(re.search(r'(\d+) % of all functions are annotated', text)[1])
    untyped = [where for where, typed in every.items() if not typed]
    assert stated >= 88
    assert 100 * len(untyped) <= (100 - stated) * len(every), '\n'.join(untyped)
