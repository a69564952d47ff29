"""Python and commands of the pages run as they are written, in a scratch folder with a bag."""

import contextlib
import io
import re
import shlex

from fourbar_ros.cli.main import main
import pytest
from support import bags, ROOT
from support.scenes import PAPER, RODS

PAGES = [ROOT / 'README.md', *sorted((ROOT / 'docs').glob('*.md'))]
PYTHON = re.compile(r'(?<=```python\n)(.*?)```', re.S)
BLOCK = re.compile(r'^```(?:bash|sh|shell|console)?\n(.*?)^```', re.S | re.M)
# verbs that need a running node, or serve a page until they are interrupted
NEEDS_ROS = {'record', 'replay', 'run', 'live'}


def commands(page):
    """Return the commands ``fourbar ...`` of a page that need no ROS, as lists of words."""
    found = []
    for block in BLOCK.findall(page.read_text(encoding='utf-8')):
        for line in block.splitlines():
            words = shlex.split(line, comments=True) if line.startswith('fourbar ') else ()
            if words and words[1] not in NEEDS_ROS:
                found.append(words[1:])
    return found


def code_of(words):
    """Return the exit code of a command, run in this process."""
    try:
        return main(words)
    except SystemExit as end:  # --help
        return end.code


WITH_PYTHON = [page for page in PAGES if PYTHON.search(page.read_text(encoding='utf-8'))]
WITH_COMMANDS = [page for page in PAGES if commands(page)]


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """Change to a folder in which the pages' file names exist."""
    monkeypatch.chdir(tmp_path)
    values = {
        **PAPER,
        **RODS,
        'outputs': ['state', 'output', 'loads', 'joint_states', 'shaking_wrench'],
    }
    for name in ('run', 'NAME', 'other'):
        bags.run(tmp_path / 'bags', name, values, [(0.01 * k, 25.0, 0.0) for k in range(1, 20)])
    for name in ('my.yaml', 'scene.yaml'):
        (tmp_path / name).write_text((ROOT / 'config' / 'paper.yaml').read_text())
    (tmp_path / 'config').symlink_to(ROOT / 'config')
    return tmp_path


def test_pages_have_examples():
    assert len(WITH_PYTHON) >= 4 and len(WITH_COMMANDS) >= 2


@pytest.mark.parametrize('page', WITH_PYTHON, ids=lambda page: page.stem)
def test_python_of_a_page_runs_in_order(page, folder):
    names = {}
    for block in PYTHON.findall(page.read_text(encoding='utf-8')):
        exec(compile(block, page.name, 'exec'), names)


@pytest.mark.parametrize('page', WITH_COMMANDS, ids=lambda page: page.stem)
def test_commands_of_a_page_run(page, folder):
    for words in commands(page):
        target = None
        if '>' in words:
            words, target = words[: words.index('>')], words[words.index('>') + 1]
        out = io.StringIO()
        with contextlib.redirect_stdout(out):
            assert not code_of(words), words
        if target:
            (folder / target).write_text(out.getvalue())
