# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Words that a shell completes, asked for as bash asks: by the protocol of argcomplete."""
import os
import subprocess
import sys

import pytest

pytest.importorskip('argcomplete')


def words(line, folder):
    """Return the words offered at the end of a command line."""
    answer = folder / 'answer.txt'
    done = subprocess.run(
        [sys.executable, '-m', 'fourbar_ros.cli.main'], cwd=folder, capture_output=True, text=True,
        env={**os.environ, '_ARGCOMPLETE': '1', '_ARGCOMPLETE_IFS': '\n', 'COMP_TYPE': '9',
             'COMP_LINE': line, 'COMP_POINT': str(len(line)), '_ARGCOMPLETE_SHELL': 'bash',
             '_ARGCOMPLETE_STDOUT_FILENAME': str(answer)}, check=False)
    assert (done.stdout, done.stderr) == ('', '')
    return {word.strip() for word in answer.read_text().split('\n')}


@pytest.mark.parametrize(('line', 'offered', 'not_offered'), [
    ('fourbar sh', {'show'}, {'table'}),
    ('fourbar scene check pa', {'paper', 'parallelogram', 'part.yaml'}, {'jansen', 'other.txt'})])
def test_a_shell_is_offered_verbs_options_and_scenes(line, offered, not_offered, tmp_path):
    for name in ('part.yaml', 'other.txt'):
        (tmp_path / name).write_text('')
    found = words(line, tmp_path)
    assert offered <= found
    assert not not_offered & found


def test_a_shell_finds_the_mark_in_the_entry_point():
    from fourbar_ros.cli import main
    with open(main.__file__, 'rb') as file:
        assert b'PYTHON_ARGCOMPLETE_OK' in file.read(1024)
