# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The pages: their Python and commands run and print what they show, links lead somewhere.

Workflows call targets of the Makefile; the paper takes its figures from the pages it names.
"""
import contextlib
import io
import os
import re
import shlex
import signal
import subprocess
import sys
import time

from fourbar_lab.studies.study import read as read_study
from fourbar_ros.cli.main import main
from fourbar_ros.scene.scene import load
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
NEEDS_ROS = 'record', 'replay', 'live'
PATIENCE = 120.0        # [s] a machine may be slow
# how the lines begin that no test runs as they are typed, and why
NOT_RUN = {
    'ros2 ': 'ROS 2 from PyPI has no ros2 command; test/ros asks and changes the same by rclpy',
    'colcon build ': 'scripts/setup.sh builds this tree with colcon before any test',
    'rosdep install ': 'installs packages of the system',
    '. install/setup.bash': 'scripts/env.sh reads it before any test',
    'make ': 'would run the tests within themselves; the targets are looked up here',
    'pip install ': 'needs the registry: scripts/check_pip.py installs; here the extras are known',
    'python3 -m venv ': 'as pip install',
    '. .venv/bin/activate': 'as pip install',
    'dask ': 'machines of their own; test/studies starts a scheduler and workers here',
    '$ fourbar study ': 'as dask',
}


def blocks(page):
    """Return [(language, text, whether a block with its output follows)] of a page."""
    text = page.read_text(encoding='utf-8')
    return [(found[1], found[2], text[found.end():].lstrip('\n').startswith('```text'))
            for found in FENCE.finditer(text)]


def lines_of(block):
    """Return the lines of a block for the shell, without comments."""
    return [line for line in re.sub(r'\s+# .*', '', block).splitlines() if line.strip()]


def goes_on(line):
    """Return whether a line of a page goes on until it is interrupted."""
    return (line.startswith(('fourbar_node ', 'fourbar live ')) and ' -o ' not in line
            or '--loop' in line)


def needs_ros(line):
    """Return whether a line of a page needs ROS, or goes on until it is interrupted."""
    return line.startswith(('fourbar_node ', *(f'fourbar {verb} ' for verb in NEEDS_ROS)))


def is_run(line):
    """Return whether a test runs a line of a page: all but those of NOT_RUN."""
    return not line.startswith(tuple(NOT_RUN))


def python_of_ros(language, text):
    """Return whether a block is Python that needs ROS: it runs in a process of its own."""
    return language == 'python' and bool(re.search('rclpy|fourbar_ros.clients', text))


def runs(page, ros=False):
    """Return whether there is something to run on a page; ``ros``: something that needs ROS."""
    return any(python_of_ros(language, text) >= ros if language == 'python' else any(
        is_run(line) and needs_ros(line) >= ros for line in lines_of(text))
        for language, text, _ in blocks(page) if language in ('python', *SHELL))


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
    monkeypatch.setenv('BROWSER', 'true')           # the command that opens nothing
    monkeypatch.setattr('fourbar_lab.drawing.animation.FRAMES', 8)       # of 90
    for name in ('my.yaml', 'scene.yaml', 'one.yaml', 'two.yaml'):
        (tmp_path / name).write_text((ROOT / 'config' / 'paper.yaml').read_text())
    for name in ('config', 'examples'):
        (tmp_path / name).symlink_to(ROOT / name)
    return tmp_path


def record(folder, seconds, *names):
    """Write bags of a run in a folder."""
    values = {**PAPER, **RODS,
              'outputs': ['state', 'output', 'loads', 'joint_states', 'shaking_wrench']}
    for name in names:
        bags.run(folder / 'bags', name, values,
                 [(0.01 * k, 25.0, 0.0) for k in range(1, round(100.0 * seconds))],
                 step_ns=10 ** 7, paced=True)


def run_page(page, folder, start=None):
    """
    Run the blocks of a page one after the other and compare what they print with what it shows.

    ``start(words)`` runs what needs ROS: a command, or Python; without it that is left out.
    """
    names, printed, exact = {}, '', False
    for language, text, shows in blocks(page):
        if language == 'yaml' and (name := re.match(r'# (\S+\.yaml)\n', text)):
            (folder / name[1]).write_text(text)
    for language, text, shows in blocks(page):
        if page.stem in ALONE:
            names = {}
        if language == 'text' and printed:
            found = [line.split() for line in printed.splitlines()]
            for words in map(str.split, text.splitlines()):         # how lines of it begin
                assert words in [line[:len(words)] for line in found], (words, printed)
            assert not exact or text == printed
        printed, exact = '', language == 'python'
        if python_of_ros(language, text):
            if start:
                start(f'{sys.executable} -u -c {shlex.quote(text)}', 'spin(' in text)
        elif language == 'python':
            out = io.StringIO()
            with contextlib.redirect_stdout(out):
                exec(compile(text, page.name, 'exec'), names)
            printed = out.getvalue() if shows else ''
        for line in lines_of(text) if language in SHELL else ():
            if needs_ros(line):
                if start and is_run(line):
                    start(line, goes_on(line))
            elif is_run(line):
                words = shlex.split(line)[1:]
                found = output_of(words[:words.index('>')] if '>' in words else words)
                if '>' in words:
                    (folder / words[-1]).write_text(found)
                printed += found


def pages_with(ros):
    """Return the pages that have something to run, the slow ones marked."""
    return [pytest.param(page, id=page.stem, marks=[pytest.mark.slow] * (
        ros or page.stem in SLOW)) for page in PAGES if runs(page, ros)]


@pytest.mark.parametrize('page', pages_with(ros=False))
def test_a_page_runs_as_it_is_written(page, folder):
    record(folder, 0.2, 'run', 'NAME', 'other', 'again', 'grip')
    run_page(page, folder)


@pytest.fixture
def start(folder):
    """
    Return a function that runs a command line: to its end, or, if it goes on, to the page's end.

    Then it must still run, and end well.
    """
    running, environment = [], {name: value for name, value in os.environ.items()
                                if not name.startswith('PYTEST')}   # they are no tests of ours

    def start(line, keeps_going):
        command, ampersand, _ = line.partition(' &')
        if not keeps_going:
            return subprocess.run(command, shell=True, check=True, timeout=PATIENCE)
        file = folder / f'said_{len(running)}'
        process = subprocess.Popen(f'exec {command}', shell=True, stdout=file.open('w'),
                                   stderr=subprocess.STDOUT, env=environment)
        running.append((process, file))
        end = time.monotonic() + PATIENCE
        while not (ampersand or '--loop' in line or file.stat().st_size):   # a loop is silent
            assert process.poll() is None and time.monotonic() < end, f'{line}: says nothing'
            time.sleep(0.1)
        return None
    yield start
    early = [process.args for process, _ in running if process.poll() is not None]
    for process, _ in running:
        process.send_signal(signal.SIGINT)
    codes = [process.wait(PATIENCE) for process, _ in running]
    assert not early
    for (process, file), code in zip(running, codes):
        is_server = any(name in process.args for name in ('fourbar_node', 'fourbar live'))
        text, wanted = file.read_text(), 0 if is_server else 130
        assert ' -c ' in process.args or (      # Python of a page ends with KeyboardInterrupt
            code == wanted and 'Traceback' not in text), text


@pytest.mark.parametrize('page', pages_with(ros=True))
def test_a_page_runs_with_its_nodes_and_servers(page, folder, start):
    pytest.importorskip('rclpy')
    record(folder, 4.0, 'run')
    run_page(page, folder, start)


def test_scenes_studies_and_forces_of_the_pages_are_accepted(folder):
    (folder / 'engine.csv').write_text((ROOT / 'config' / 'engine.csv').read_text())
    engine, = yaml.safe_load((ROOT / 'config' / 'engine.yaml').read_text()).values()
    heads = set()
    for text in (text for page in PAGES for language, text, _ in blocks(page)
                 if language == 'yaml' and '.yaml\n' not in text):    # named ones are run
        tree = yaml.safe_load(text)
        heads.add(head := next(iter(tree)))
        if head == 'forces':        # of a scene
            text = yaml.dump({'/**': {'ros__parameters': engine['ros__parameters'] | tree}})
        (folder / 'page.yaml').write_text(text)
        (read_study if head == 'scene' else load)(folder / 'page.yaml')
    assert heads == {'/**', 'scene', 'forces'}


def test_the_mass_of_the_balanced_linkage_is_that_of_its_page():
    mass = sum(body.mass for body in load('paper').linkage.bodies)
    assert f'({mass:.3g} kg of moving steel' in (ROOT / 'docs/studies.md').read_text()


def test_every_text_of_a_page_is_what_a_block_before_it_prints():
    for page in PAGES:
        before = ''
        if page.stem == 'reference_robot':          # its texts are messages
            continue
        for language, text, _ in blocks(page):
            assert language != 'text' or before == 'python' or any(
                is_run(line) and not needs_ros(line) for line in lines_of(before)), text
            before = language if language == 'python' else text if language in SHELL else ''


def test_every_line_of_a_page_is_run_or_is_in_the_list_of_those_that_are_not():
    shell = [line for page in EVERY_PAGE for language, text, _ in blocks(page)
             if language in SHELL for line in lines_of(text)]
    assert not [line for line in shell if is_run(line)
                and not line.startswith(('fourbar ', 'fourbar_node '))]
    assert not [start for start in NOT_RUN if not any(line.startswith(start) for line in shell)]
    assert {language for page in EVERY_PAGE for language, _, _ in blocks(page)} <= {
        'python', 'yaml', 'text', *SHELL}
    targets = set(re.findall(r'^([\w-]+):', (ROOT / 'Makefile').read_text(), re.M))
    assert {line.split()[1] for line in shell if line.startswith('make ')} <= targets


def test_what_is_installed_is_published_or_this_folder_in_the_quotes_of_every_shell():
    extras = ''
    for name in ('fourbar_ros', 'fourbar_lab', 'docs', 'examples', 'scripts', '.github', 'test'):
        for file in (*(ROOT / name).rglob('*'), *ROOT.glob('*.*')):
            if file.suffix in ('.py', '.md', '.sh', '.yaml', '.cff') and 'build' not in file.parts:
                text = file.read_text(encoding='utf-8')
                assert not re.search(r"pip install (['][.]|[^\w\n]*fourbar_ros)", text), file
                extras += ','.join(['', *re.findall(r'pip install "\.\[([\w,]+)\]"', text)])
    named, known = set(extras.split(',')) - {''}, (ROOT / 'setup.py').read_text()
    assert named >= {'plot', 'live', 'study', 'balance'}
    assert all(f"'{extra}': " in known for extra in named), named


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
    for page in (ROOT / 'docs' / 'robots.md', *(ROOT / 'docs' / 'bench').glob('*.md')):
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
