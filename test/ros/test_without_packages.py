# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
A node in an environment without the packages that rosdep has no key for.

It streams on and says what is missing.
"""
import os

import pytest
from support.samples import some
from support.scenes import PAPER


@pytest.fixture
def without(tmp_path, monkeypatch):
    """Return the function that hides packages from the nodes that start."""
    def hide(*names):
        for name in names:
            (tmp_path / 'hidden' / name).mkdir(parents=True)
            (tmp_path / 'hidden' / name / '__init__.py').write_text(
                f'raise ModuleNotFoundError("No module named {name!r}", name={name!r})\n')
        monkeypatch.setenv('PYTHONPATH',
                           f'{tmp_path / "hidden"}:{os.environ.get("PYTHONPATH", "")}')
    return hide


@some('names', [('mcap',), ('zstandard',),
                ('mcap', 'lz4', 'zstandard', 'flint', 'scipy',
                 'matplotlib', 'mpmath', 'pyarrow', 'rich')], (('mcap',),))
def test_the_stream_goes_on_and_one_line_says_what_to_install(run_node, client, without, names):
    without(*names)
    node = run_node({**PAPER, 'outputs': ['state'], 'recording.start': True})
    client.listen(['state'])
    client.until(lambda: len(client.received['state']) > 10, 'the stream')
    answer = client.call('start_recording', name='later')
    assert (not answer.success and 'pip install mcap' in answer.message
            and '\n' not in answer.message)
    lines = [line for line in node.said.splitlines() if 'pip install mcap' in line]
    assert len(lines) == 1 and 'not recording' in lines[0]
    assert client.call('find_extrema', quantities=['omega4'], velocity=25.0).extrema
    assert node.stop() == 0
