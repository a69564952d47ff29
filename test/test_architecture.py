# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Who may import whom: layers, no circles, one place naming kinds, nothing private."""
import ast
import re

import pytest
from support import ROOT

PACKAGE = ROOT / 'fourbar_ros'
MODULES = {'.'.join(path.relative_to(ROOT).with_suffix('').parts).removesuffix('.__init__'): path
           for path in sorted(PACKAGE.rglob('*.py'))}

# From the bottom up; a folder may import from its own layer's folders only where LATERAL says so.
LAYERS = (('errors',), ('optional',), ('numerics',), ('mechanics',), ('mechanisms',),
          ('extrema', 'pipeline', 'dynamics'),
          ('formats', 'scene', 'report', 'transmission'),
          ('bag', 'reproduction', 'description', 'studies', 'balancing'),
          ('ros',), ('live',), ('cli',))
LEVEL = {folder: level for level, folders in enumerate(LAYERS) for folder in folders}
LATERAL = {('report', 'scene'), ('reproduction', 'bag'), ('scene', 'report')}

KINDS = tuple(path.parent.name for path in sorted(PACKAGE.glob('mechanisms/*/__init__.py')))
# Where one kind may be named: the registry, the searches that are for the four-bar alone, its
# public face, and the reproduction of documents about it.
MAY_NAME_KINDS = ('fourbar_ros', 'fourbar_ros.mechanisms.kinds', 'fourbar_ros.extrema.methods',
                  'fourbar_ros.extrema.batch', 'fourbar_ros.extrema.four_bar_rates',
                  'fourbar_ros.reproduction', 'fourbar_ros.scene.families',
                  'fourbar_ros.scene.machines')
# Third-party packages, and the lowest folders that may import them.
THIRD_PARTY = {'yaml': ('scene', 'formats', 'bag', 'reproduction', 'studies', 'ros',
                        'cli', 'description'),
               'mcap': ('formats', 'bag'),
               'rich': ('report', 'cli', 'ros', 'reproduction'),
               'matplotlib': ('report', 'bag', 'reproduction', 'studies', 'balancing', 'cli'),
               'nicegui': ('live',),
               'flint': ('numerics', 'extrema'),
               'scipy': ('dynamics', 'studies', 'balancing'), 'pyarrow': ('bag', 'studies'),
               'distributed': ('studies',)}


def imports_of(path):
    """Yield (module, name or None, line) of everything a file imports."""
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            for alias in node.names:
                yield alias.name, None, node.lineno
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f'{path}:{node.lineno}: relative import'
            for alias in node.names:
                yield node.module, alias.name, node.lineno


def edges():
    """Yield (importing module, imported module of the package, line)."""
    for module, path in MODULES.items():
        for imported, name, line in imports_of(path):
            if imported.split('.')[0] == 'fourbar_ros':
                full = f'{imported}.{name}'
                yield module, full if full in MODULES else imported, line


def folder_of(module):
    """Return the top folder (or module) of a module; '' for the package itself."""
    return module.partition('.')[2].partition('.')[0]


def test_no_import_runs_upward():
    wrong = []
    for module, imported, line in edges():
        one, other = folder_of(module), folder_of(imported)
        if not one or not other or one == other or one == '__main__':
            continue
        if LEVEL[other] > LEVEL[one] or LEVEL[other] == LEVEL[one] and (one, other) not in LATERAL:
            wrong.append(f'{module}:{line} imports {imported}')
    assert not wrong, '\n'.join(wrong)


def test_there_is_no_circle():
    graph = {module: set() for module in MODULES}
    for module, imported, _ in edges():
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


def test_a_kind_imports_no_other_kind_and_few_name_one():
    wrong = []
    for module, imported, line in edges():
        kind = next((k for k in KINDS if imported.startswith(f'fourbar_ros.mechanisms.{k}')), None)
        own = module.startswith(f'fourbar_ros.mechanisms.{kind}')
        may = any(module == place or module.startswith(place + '.')
                  for place in MAY_NAME_KINDS[1:])
        if kind and not own and not may and module != 'fourbar_ros':
            wrong.append(f'{module}:{line} imports {imported}')
    assert not wrong, '\n'.join(wrong)


def test_nothing_private_crosses_modules():
    wrong = [f'{module}:{line} imports {name}' for module, path in MODULES.items()
             for imported, name, line in imports_of(path)
             if name and name.startswith('_') and not name.startswith('__')
             and imported.startswith('fourbar_ros')]
    for module, path in MODULES.items():
        tree = ast.parse(path.read_text())
        own = {node.attr for node in ast.walk(tree) if isinstance(node, ast.Attribute)
               and isinstance(node.ctx, ast.Store)}
        own |= {node.name for node in ast.walk(tree)
                if isinstance(node, (ast.FunctionDef, ast.ClassDef))}
        own |= {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)}
        for node in ast.walk(tree):
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
        for node in ast.walk(ast.parse(path.read_text())):
            if (isinstance(node, ast.Call) and getattr(node.func, 'id', '') in ('isinstance',
                                                                                'issubclass')):
                names = {n.id for n in ast.walk(node.args[1]) if isinstance(n, ast.Name)}
                if names & {'FourBar', 'SliderCrank', 'InvertedSlider', 'ScotchYoke'}:
                    wrong.append(f'{module}:{node.lineno}')
    assert not wrong, '\n'.join(wrong)


def bodies():
    """Yield (where, lines of the body without the docstring) of every function."""
    for module, path in MODULES.items():
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)):
                body = node.body[1:] if ast.get_docstring(node) is not None else node.body
                yield (f'{module}:{node.lineno} {node.name}',
                       body[-1].end_lineno - body[0].lineno + 1 if body else 0)


def test_functions_fit_on_a_screen():
    sizes = dict(bodies())
    longest = [f'{where}: {size}' for where, size in sizes.items() if size > 45]
    assert not longest, '\n'.join(longest)
    assert sorted(sizes.values())[len(sizes) // 2] <= 6


def test_no_folder_is_large():
    """A kind of mechanism is a folder of its own, beside what all kinds share."""
    lines = {}
    for module, path in MODULES.items():
        kind = next((k for k in KINDS if module.startswith(f'fourbar_ros.mechanisms.{k}')), None)
        folder = kind or folder_of(module)
        lines[folder] = lines.get(folder, 0) + len(path.read_text().splitlines())
    assert max(lines.values()) <= 0.2 * sum(lines.values()), lines


def is_typed(function):
    """Return whether all arguments and the result of a function are annotated."""
    given = function.args
    arguments = [*given.posonlyargs, *given.args, *given.kwonlyargs,
                 *filter(None, (given.vararg, given.kwarg))]
    return ((function.returns is not None or function.name == '__init__')
            and all(a.annotation is not None or a.arg in ('self', 'cls') for a in arguments))


def test_as_many_functions_are_typed_as_the_architecture_says():
    every = {f'{module}:{node.lineno} {node.name}': is_typed(node)
             for module, path in MODULES.items() for node in ast.walk(ast.parse(path.read_text()))
             if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef))}
    text = (ROOT / 'docs' / 'architecture.md').read_text()
    stated = int(re.search(r'(\d+) % of all functions are annotated', text)[1])
    untyped = [where for where, typed in every.items() if not typed]
    assert stated >= 88
    assert 100 * len(untyped) <= (100 - stated) * len(every), '\n'.join(untyped)
