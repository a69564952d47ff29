"""The examples in docstrings run."""

import doctest
import importlib
import pkgutil

import fourbar_ros
import pytest
from support import bags
from support.scenes import PAPER, RODS

MODULES = [
    module.name
    for module in pkgutil.walk_packages(fourbar_ros.__path__, 'fourbar_ros.')
    if '.ros' not in module.name and not module.name.endswith('__main__')
]


def test_there_are_examples():
    assert len(MODULES) > 50
    finder = doctest.DocTestFinder(exclude_empty=True)
    assert (
        sum(
            bool(test.examples)
            for name in MODULES
            for test in finder.find(importlib.import_module(name))
        )
        >= 4
    )


@pytest.fixture(scope='module')
def folder(tmp_path_factory):
    """Return a folder with the bag that examples read."""
    made = tmp_path_factory.mktemp('examples')
    bags.run(
        made / 'bags',
        'run',
        {**PAPER, **RODS, 'outputs': ['state', 'loads']},
        [(0.1 * k, 25.0, 0.0) for k in range(5)],
    )
    return made


@pytest.mark.parametrize('name', MODULES)
def test_examples_of_a_module(name, folder, monkeypatch):
    monkeypatch.chdir(folder)
    module = importlib.import_module(name)
    if 'bags/run' in (module.__doc__ or ''):  # prints what is in the bag: it must run
        examples = doctest.DocTestParser().get_examples(module.__doc__)
        exec(''.join(example.source for example in examples), dict(vars(module)))
        assert examples
        return
    assert doctest.testmod(module).failed == 0
