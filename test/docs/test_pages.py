# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The pages: their Python and commands run and print what they show, links lead somewhere.

Workflows call targets of the Makefile; the paper takes its figures from the pages it names.
"""
import contextlib
import io
import re
import shlex

from fourbar_ros.cli.main import main
import pytest
from support import bags, ROOT
from support.scenes import PAPER, RODS
import yaml

PAGES = [ROOT / 'README.md', *sorted((ROOT / 'docs').glob('*.md'))]
EVERY_PAGE = [*PAGES, *sorted(ROOT.glob('[A-Z]*.md')),
              *sorted((ROOT / '.github').glob('[A-Z]*.md')),
              *sorted((ROOT / 'docs').glob('*/*.md'))]
FENCE = re.compile(r'^```(\w*)\n(.*?)^```$\n?', re.S | re.M)
SHELL = ('', 'bash', 'sh', 'shell', 'console')
SLOW = {'studies', 'gallery'}      # several seconds of processor time each
ALONE = {'extrema'}         # a reader may copy any example of these pages alone
# verbs that need a running node, or serve a page until they are interrupted
NEEDS_ROS = {'record', 'replay', 'run', 'live'}


def blocks(page):
    """Return [(language, text, whether a block with its output follows)] of a page."""
    text = page.read_text(encoding='utf-8')
    return [(found[1], found[2], text[found.end():].lstrip('\n').startswith('```text'))
            for found in FENCE.finditer(text)]


def commands(block):
    """Return the commands ``fourbar ...`` of a block that need no ROS, as lists of words."""
    lines = [shlex.split(line, comments=True) for line in block.splitlines()
             if line.startswith('fourbar ')]
    return [words[1:] for words in lines if words[1] not in NEEDS_ROS]


def runs(page):
    """Return whether there is something to run on a page."""
    return any(language == 'python' or (language in SHELL and commands(text))
               for language, text, _ in blocks(page))


def output_of(words):
    """Return what a command prints, run in this process; it must succeed."""
    out = io.StringIO()
    with contextlib.redirect_stdout(out):
        try:
            code = main(words)
        except SystemExit as end:  # --help
            code = end.code
    assert not code, words
    return out.getvalue()


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """Change to a folder in which the pages' file names exist."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv('MPLBACKEND', 'agg')
    monkeypatch.setattr('fourbar_lab.drawing.animation.FRAMES', 8)       # of 90
    values = {
        **PAPER,
        **RODS,
        'outputs': ['state', 'output', 'loads', 'joint_states', 'shaking_wrench'],
    }
    for name in ('run', 'NAME', 'other', 'again', 'grip'):
        bags.run(tmp_path / 'bags', name, values, [(0.01 * k, 25.0, 0.0) for k in range(1, 20)])
    for name in ('my.yaml', 'scene.yaml'):
        (tmp_path / name).write_text((ROOT / 'config' / 'paper.yaml').read_text())
    for name in ('config', 'examples'):
        (tmp_path / name).symlink_to(ROOT / name)
    return tmp_path


@pytest.mark.parametrize('page', [
    pytest.param(page, id=page.stem, marks=[pytest.mark.slow] * (page.stem in SLOW))
    for page in PAGES if runs(page)])
def test_a_page_runs_as_it_is_written(page, folder):
    names, printed, exact = {}, '', False
    for language, text, shows in blocks(page):
        if page.stem in ALONE:
            names = {}
        if language == 'text' and printed:
            found = [line.split() for line in printed.splitlines()]
            for words in map(str.split, text.splitlines()):         # how lines of it begin
                assert words in [line[:len(words)] for line in found], (words, printed)
            assert not exact or text == printed
        printed, exact = '', language == 'python'
        if language == 'yaml' and (name := re.match(r'# (\S+\.yaml)\n', text)):
            (folder / name[1]).write_text(text)
        if language == 'python':
            out = io.StringIO()
            with contextlib.redirect_stdout(out):
                exec(compile(text, page.name, 'exec'), names)
            printed = out.getvalue() if shows else ''
        for words in commands(text) if language in SHELL else ():
            found = output_of(words[:words.index('>')] if '>' in words else words)
            if '>' in words:
                (folder / words[-1]).write_text(found)
            printed += found


@pytest.mark.parametrize('page', ['README.md', 'docs/python.md', 'docs/tutorial.md'])
def test_these_pages_show_what_their_python_prints(page):
    found = [shows for language, _, shows in blocks(ROOT / page) if language == 'python']
    assert found and (all(found) or page != 'docs/python.md')


def anchors(page):
    """Return the anchors of the headings of a page, as GitHub makes them."""
    heads = re.findall(r'^#+ (.*)$', FENCE.sub('', page.read_text(encoding='utf-8')), re.M)
    return {re.sub(r'[^\w\- ]', '', head.lower()).replace(' ', '-') for head in heads}


@pytest.mark.parametrize('page', EVERY_PAGE, ids=lambda page: page.stem)
def test_every_link_of_a_page_leads_somewhere(page):
    text = FENCE.sub('', page.read_text(encoding='utf-8'))
    for link in re.findall(r'\]\(([^)\s]+)\)', text):
        if '://' in link:
            continue
        name, _, anchor = link.partition('#')
        target = page.parent / name if name else page
        assert target.exists(), f'{page.name}: {link}'
        assert not anchor or anchor in anchors(target), f'{page.name}: {link}'


def test_every_measurement_says_of_which_commit_it_is():
    for page in (ROOT / 'docs' / 'bench').glob('*.md'):
        for line in page.read_text(encoding='utf-8').splitlines():
            if line.startswith('Written by `make bench'):
                assert re.search(r', commit [0-9a-f]{7}', line), f'{page.name}: {line}'


def test_a_bench_writes_no_picture_unless_asked(monkeypatch, tmp_path):
    monkeypatch.syspath_prepend(str(ROOT))
    from bench import pages
    monkeypatch.setattr(pages, 'ROOT', tmp_path)
    (tmp_path / 'docs/bench').mkdir(parents=True)
    for is_written in (False, True):
        monkeypatch.setattr(pages, 'is_written', is_written)
        drawing, _ = pages.figure()
        pages.save(drawing, 'one')
        assert len(list((tmp_path / 'docs/bench').iterdir())) == is_written


def test_workflows_call_targets_that_there_are():
    targets = set(re.findall(r'^([\w-]+):', (ROOT / 'Makefile').read_text(), re.M))
    called = set()
    for file in (ROOT / '.github/workflows').glob('*.yml'):
        for job in yaml.safe_load(file.read_text())['jobs'].values():
            called |= {step['run'] for step in job['steps'] if 'run' in step}
    assert {command.split()[1] for command in called} <= targets
