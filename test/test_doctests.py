# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The examples in docstrings run."""

import doctest
import importlib

import pytest
from support import bags, ROOT
from support.scenes import PAPER, RODS

MODULES = [
    '.'.join(path.relative_to(ROOT).with_suffix('').parts).removesuffix('.__init__')
    for package in ('fourbar_ros', 'fourbar_lab')
    for path in sorted((ROOT / package).rglob('*.py'))
    if '>>>' in path.read_text(encoding='utf-8')
]


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
    done = doctest.testmod(module)
    assert done.attempted and not done.failed
