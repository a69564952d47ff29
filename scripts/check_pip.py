# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Prove the ways of installing without ROS, for each Python and each extra: ``make check-pip``.

Builds sdist and wheel, which ``twine check`` must take, and installs the wheel into bare virtual
environments in a temporary folder: alone, then with each extra. There each verb of ``fourbar``
must work, or end in one line with the command that mends it. Without an extra that command is then
typed, until all work; with all extras the short tests of the unpacked sdist run.

  make check-pip PYTHON="python3.11 python3.14"     with each of these; by uv, if it is installed,
                                                    those that this machine lacks
  make check-pip ARGS="--only bag,plot all"         these environments; '' is the wheel alone
  make check-pip ARGS=--write                       also writes the tables of docs and README
  make check-pip ARGS=--quick                       the wheel alone, and one command

Packages come from the registry once for each Python, as wheels; then nothing but the disk is
asked. Seconds are pip's of the processor, from there; MB are all that it wrote, with bytecode.
"""
import argparse
import json
import os
from pathlib import Path
import platform
import re
import runpy
import shutil
import subprocess
import sys
import tarfile
import tempfile
import time
from types import SimpleNamespace
from typing import NamedTuple
import urllib.request

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / 'docs/bench/install.md'
BIN = 'Scripts' if os.name == 'nt' else 'bin'
OF_DEVELOPERS = 'test', 'docs', 'lint', 'ros'
SHOWN = ('numpy', 'scipy', 'rich', 'matplotlib', 'pandas', 'pyarrow', 'mujoco', 'mcap')
IN_README = '', 'bag,dynamics,plot', 'all'
TESTS = ('balancing', 'cli', 'dynamics', 'extrema', 'mechanics', 'mechanisms', 'numerics',
         'scene', 'transmission')
BAG, STUDIES = 'SDIST/test/support/data/paper', 'SDIST/config/studies'
# {command: packages without which it ends in one line}; they run in this order in one folder
COMMANDS = {
    'python -m fourbar_ros --version': '',
    'fourbar list': '',
    'fourbar new rocker.yaml --a1 50mm --a2 130mm --a3 100mm --a4 120mm --bar 20x5mm': '',
    'fourbar show rocker.yaml --at 60': '',
    'fourbar show press --hold 30 --fluctuation 5%': '',
    'fourbar show paper --certify': 'python-flint',
    'fourbar scene check cylinder --error': '',
    'fourbar scene print paper': '',
    'fourbar table engine f41 -o engine.csv': '',
    'fourbar plot paper f41 -o plot.png': 'matplotlib',
    'fourbar draw paper --at 60 -o draw.svg': 'matplotlib',
    'fourbar describe paper -o paper.urdf': '',
    'fourbar describe paper -o paper.xml': '',
    'fourbar import paper.xml -o imported.yaml': 'mujoco',
    'fourbar import paper.xml --check': 'mujoco',
    'fourbar generate paper -o code': '',
    'fourbar generate paper --as js -o js': '',
    'fourbar generate paper --as fmu2 -o fmu': '',
    'fourbar live paper -o live.html': '',
    'fourbar live paper --no-browser': 'starlette uvicorn',
    'fourbar reproduce': '',
    'fourbar reproduce --html reproduced.html': 'matplotlib',
    'fourbar simulate motor --until 0.2': 'scipy',
    'fourbar simulate motor --until 0.1 -o bag': 'scipy mcap zstandard rosbags rclpy',
    'fourbar balance paper': 'clarabel scipy',
    'fourbar balance paper --minimize torque --mass 5': 'clarabel scipy',
    'fourbar balance paper --plot balance.png': 'clarabel scipy matplotlib',
    f'fourbar study run {STUDIES}/crank_rockers.yaml -o study --workers 1': 'scipy pyarrow',
    'fourbar study show study': 'scipy pyarrow',
    'fourbar study pick study best': 'scipy pyarrow',
    f'fourbar study tolerances {STUDIES}/tolerances.yaml --rows 64': 'scipy',
    f'fourbar bag info {BAG}': 'mcap zstandard rosbags',
    f'fourbar bag recover {BAG} -o recovered': 'mcap zstandard rosbags',
    f'fourbar bag recompute {BAG} --tolerance 1e-9': 'mcap zstandard rosbags',
    f'fourbar bag export {BAG} -o exported': 'mcap zstandard rosbags',
    f'fourbar bag export {BAG} --format parquet -o tables': 'mcap zstandard rosbags pyarrow',
    f'fourbar bag plot {BAG} state.theta4 -o field.png': 'mcap zstandard rosbags matplotlib',
    f'fourbar bag diff {BAG} {BAG}': 'mcap zstandard rosbags',
    f'fourbar bag scene {BAG}': 'mcap zstandard rosbags',
    f'fourbar replay {BAG}': 'mcap zstandard rosbags rclpy',
    'fourbar record start': 'rclpy',
    'fourbar_node': 'rclpy',
    'fourbar_demo paper': 'rclpy',
}
OF_README = """
import contextlib, io
text = open('SDIST/README.md', encoding='utf-8').read()
out = io.StringIO()
with contextlib.redirect_stdout(out):
    exec(text.split('```python\\n')[1].split('```')[0])
assert out.getvalue() == text.split('```text\\n')[1].split('```')[0], out.getvalue()
from importlib.metadata import metadata
about = metadata('fourbar_ros')
assert about['Summary'] and about.get_all('Classifier') and 'fourbar_ros' in (
    about.get_payload() or about['Description'])
from importlib.resources import files
assert (files('fourbar_ros') / 'py.typed').is_file()
"""


class Check(NamedTuple):
    """What an environment took and holds, and what mends each command; empty: it works."""

    megabytes: float
    seconds: float
    versions: dict[str, str]
    mends: dict[str, str]

    def working(self):
        """Return of how many of the commands nothing is missing."""
        return [*self.mends.values()].count('')


FAULTS = []         # texts of commands that neither work nor say in one line what is missing


def fail(text):
    sys.exit(f'check-pip: {text}')


def fault(text):
    print(f'check-pip: {text}', flush=True)
    FAULTS.append(text)


def must(*words, **options):
    """Run a program that must succeed; return what it prints."""
    done = subprocess.run([str(word) for word in words], text=True, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, check=False, **options)
    if done.returncode:
        fail(f'{" ".join(map(str, words))[:200]} ended with {done.returncode}\n'
             + '\n'.join(done.stdout.splitlines()[-30:]))
    return done.stdout


def interpreter(name):
    """Return the path of a Python, as python3.14 or a path; uv brings what is missing."""
    path = shutil.which(name)
    if path and not subprocess.run([path, '-c', ''], capture_output=True, check=False).returncode:
        return path                         # a shim of another version manager may not run
    if not shutil.which('uv'):
        fail(f'no {name} here: install it, or uv, which brings it')
    find = 'uv', 'python', 'find', '--no-project', name.removeprefix('python')
    if subprocess.run(find, capture_output=True, check=False).returncode:
        must('uv', 'python', 'install', name.removeprefix('python'))
    return must(*find).strip()


def user_extras():
    """Return the extras of setup.py that are for users; setuptools need not be installed."""
    arguments = {}
    sys.modules['setuptools'] = SimpleNamespace(find_packages=lambda **_: [],
                                                setup=arguments.update)
    runpy.run_path(str(ROOT / 'setup.py'))
    return [extra for extra in arguments['extras_require'] if extra not in OF_DEVELOPERS]


def build(python, folder):
    """Return the paths of the wheel and the sdist of a copy of this tree, which twine takes."""
    def left_out(at, names):
        return [name for name in names if name.startswith(('.venv', '__pycache__')) or name in (
            '.git', 'build', 'install', 'log', 'bags', 'dist') and Path(at) == ROOT]
    shutil.copytree(ROOT, folder / 'source', ignore=left_out)
    must(python, '-m', 'venv', folder / 'builder')
    tool = folder / 'builder' / BIN / 'python'
    must(tool, '-m', 'pip', '-q', 'install', 'build', 'twine')
    must(tool, '-m', 'build', '--outdir', folder / 'dist', folder / 'source')
    must(tool, '-m', 'twine', 'check', '--strict', *(folder / 'dist').iterdir())
    return next((folder / 'dist').glob('*.whl')), next((folder / 'dist').glob('*.tar.gz'))


class Environment:
    """A bare virtual environment in a folder, with what its pip has installed."""

    def __init__(self, python, folder, sdist):
        must(python, '-m', 'venv', folder)
        self.folder, self.sdist = folder, sdist
        self.python = folder / BIN / 'python'
        self.site = Path(must(self.python, '-c', 'import sysconfig\n'
                              'print(sysconfig.get_path("purelib"), end="")'))
        (folder / 'work').mkdir()

    def pip(self, *words):
        return must(self.python, '-m', 'pip', '--disable-pip-version-check', *words)

    def size(self):
        """Return the bytes of what is installed."""
        return sum(file.stat().st_size for file in self.site.rglob('*') if file.is_file())

    def versions(self):
        """Return {name of a package in small letters: version}."""
        return {each['name'].lower(): each['version']
                for each in json.loads(self.pip('list', '--format', 'json'))}

    def run(self, command):
        """Return (exit code, output, errors) of a command; a page that it serves is read once."""
        words = [word.replace('SDIST', str(self.sdist)) for word in command.split()]
        words[0] = str(self.folder / BIN / words[0])
        options = {'cwd': self.folder / 'work', 'text': True, 'encoding': 'utf-8',
                   'stdout': subprocess.PIPE, 'stderr': subprocess.PIPE}
        if '--no-browser' not in words:
            done = subprocess.run(words, check=False, timeout=600, **options)
            return done.returncode, done.stdout, done.stderr
        with subprocess.Popen(words, **options) as server:
            address = re.search(r'http://[\w.:]+', server.stdout.readline())
            if not address:
                out, err = server.communicate()
                return server.returncode, out, err
            try:
                with urllib.request.urlopen(address[0], timeout=60) as page:
                    is_ours = b'fourbar live' in page.read()
            finally:
                server.terminate()
                server.communicate()
            return int(not is_ours), '', f'{address[0]} is no page of ours'

    def what_mends(self, command, needed, versions):
        """Return the command that the line of a failing one names; '' if it works."""
        missing = [name for name in needed.split() if name not in versions]
        code, out, err = self.run(command)
        if not missing:
            if code or 'Traceback' in err:
                fault(f'{command} ended with {code}\n{out[-2000:]}{err}')
            return ''
        lines = err.splitlines() if code else [line for line in out.splitlines() if 'pip ' in line]
        mends = re.search(r'pip install [\w .-]*\w|source a ROS 2', lines[0] if lines else '')
        if not mends or code not in (0, 1) or code == 1 and len(lines) > 1:
            fault(f'{command} without {", ".join(missing)} ended with {code} and says not in one '
                  f'line what to install\n{out[-2000:]}{err}')
        elif not {*mends[0].split()} & {*missing, 'ROS' if 'rclpy' in missing else ''}:
            fault(f'{command} lacks {", ".join(missing)} and says {mends[0]}')
        return mends[0] if mends else 'a fault'

    def mend(self, mends):
        """Type what mends each command until none is left that does not need ROS."""
        for command, line in mends.items():
            for _ in range(4):          # each package may lack another
                if not line.startswith('pip'):
                    break
                self.pip(*line.split()[1:])
                line = self.what_mends(command, COMMANDS[command], self.versions())
            else:
                fault(f'{command} still says, after {line}, to type it')

    def test(self):
        """Run short tests of the sdist; return what pytest says last."""
        return must(self.python, '-m', 'pytest', '-n', '2', '--dist', 'loadfile', '-m',
                    'unit and not slow', *(f'test/{name}' for name in TESTS), cwd=self.sdist
                    ).splitlines()[-1]


def check(python, extra, wheel, sdist, folder, commands):
    """Return the Check of an environment that has an extra, or several with commas."""
    wheels = folder / 'wheels'
    environment = Environment(python, folder / 'environment', sdist)
    wanted = f'{wheel}[{extra}]' if extra else wheel
    environment.pip('download', '-q', '--only-binary', ':all:', '-d', wheels, '--find-links',
                    wheels, wanted)
    bytes_before, before = environment.size(), os.times()
    environment.pip('install', '-q', '--no-index', '--find-links', wheels, wanted)
    after = os.times()          # of processes that have ended; a busy machine does not change it
    seconds = (after.children_user + after.children_system
               - before.children_user - before.children_system)
    megabytes = (environment.size() - bytes_before) / 1e6
    versions = environment.versions()
    mends = {command: environment.what_mends(command, needed, versions)
             for command, needed in commands.items()}
    checked = Check(megabytes, seconds, versions, mends)
    print(f'  {extra or "no extra"}: {megabytes:.0f} MB, {seconds:.0f} s, '
          f'{checked.working()} of {len(mends)} commands work', flush=True)
    if not extra and len(commands) == len(COMMANDS):
        must(environment.python, '-c', OF_README.replace('SDIST', str(sdist)))
        environment.mend(mends)
        print('    what the others say was typed: all work but those that need ROS', flush=True)
    if extra == 'all':
        environment.pip('install', '-q', 'pytest', 'pytest-xdist', 'hypothesis', 'mpmath')
        print(f'    {environment.test()}', flush=True)
    shutil.rmtree(environment.folder)
    return checked


def table(head, rows):
    """Return a table of Markdown."""
    return '\n'.join('| ' + ' | '.join(row) + ' |' for row in (head, ['---'] * len(head), *rows))


def tables(checks):
    """Return the Markdown of {version of Python: {extra: Check}}."""
    first = next(iter(checks.values()))
    head = ['', *(f'Python {version}' for version in checks)]
    sizes = table([*head, f'work, of {len(COMMANDS)} commands'], [
        [f'`pip install {typed(extra)}`',
         *(f'{of[extra].megabytes:.0f} MB, {of[extra].seconds:.0f} s' for of in checks.values()),
         str(first[extra].working())] for extra in first])
    names = [name for name in SHOWN if any(name in each.versions for each in first.values())]
    newest = table(head, [
        [name, *(next((each.versions[name] for each in of.values() if name in each.versions), '')
                 for of in checks.values())] for name in names])
    lines = table(['command', 'its line without an extra'], [
        [f'`{command.replace(BAG, "BAG").replace(f"{STUDIES}/", "")}`', f'`{line}`']
        for command, line in first[''].mends.items() if line])
    return f'{sizes}\n\n{newest}\n\n{lines}'


def typed(extra):
    """Return what pip is told in the folder of the source, in the quotes of every shell."""
    return f'".[{extra}]"' if extra else '.'


def write(checks):
    """Write the tables of docs/bench/install.md and the sizes of README."""
    commit = must('git', 'rev-parse', '--short=7', 'HEAD', cwd=ROOT).strip()
    text = (f'Written by `make check-pip ARGS=--write`: {time.strftime("%Y-%m-%d")}, '
            f'commit {commit}, {platform.system()} {platform.machine()}.\n\n{tables(checks)}')
    PAGE.write_text(re.sub('(<!-- install -->\n).*?(<!-- end -->)',
                           lambda mark: f'{mark[1]}{text}\n{mark[2]}',
                           PAGE.read_text(encoding='utf-8'), flags=re.S), encoding='utf-8')
    readme = (ROOT / 'README.md').read_text(encoding='utf-8')
    for extra in IN_README:
        largest = max((of[extra] for of in checks.values()), key=lambda each: each.megabytes)
        row = re.escape(f'| `pip install {typed(extra)}` |')
        readme = re.sub(f'({row}.*\\| ).*( \\|)\n', lambda mark, largest=largest: (
            f'{mark[1]}{largest.megabytes:.0f} MB, {largest.seconds:.0f} s{mark[2]}\n'), readme)
    (ROOT / 'README.md').write_text(readme, encoding='utf-8')


def main():
    """Parse arguments and run."""
    parser = argparse.ArgumentParser(prog='check_pip.py', description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('--only', nargs='+', metavar='EXTRAS', help='these environments')
    parser.add_argument('--quick', action='store_true', help='the wheel alone, and one command')
    parser.add_argument('--write', action='store_true', help='write the tables of the docs')
    parser.add_argument('--dist', type=Path, help='folder for sdist and wheel, once they are good')
    arguments = parser.parse_args()
    for name in ('PYTHONPATH', 'PYTHONHOME', 'VIRTUAL_ENV', 'AMENT_PREFIX_PATH'):
        os.environ.pop(name, None)
    pythons = [interpreter(name) for name in os.environ.get('PYTHON', '').split() or ['python3']]
    extras = [''] if arguments.quick else arguments.only or [
        '', *sorted({*user_extras(), *IN_README} - {'', 'all'}), 'all']
    commands = dict([*COMMANDS.items()][:4]) if arguments.quick else COMMANDS
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        os.environ['MPLCONFIGDIR'] = temporary      # the cache of fonts, made once
        print('check-pip: building', flush=True)
        wheel, archive = build(pythons[0], folder)
        with tarfile.open(archive) as members:
            members.extractall(folder / 'sdist')
        sdist, = (folder / 'sdist').iterdir()
        documented = re.findall(r'^\| `(fourbar [\w ]+)` \|',
                                (sdist / 'docs/command_line.md').read_text(encoding='utf-8'), re.M)
        if untried := [verb for verb in documented
                       if not any(command.startswith(verb + ' ') or command == verb
                                  for command in COMMANDS)]:
            fail(f'no command here tries {", ".join(untried)}')
        checks = {}
        for python in pythons:
            version = must(python, '-c', 'import platform; print(platform.python_version())')
            print(f'check-pip: Python {version}', end='', flush=True)
            checks[version.strip()] = {extra: check(python, extra, wheel, sdist, folder, commands)
                                       for extra in extras}
            shutil.rmtree(folder / 'wheels')
        if FAULTS:
            fail(f'{len(FAULTS)} faults, see above')
        if arguments.dist:
            arguments.dist.mkdir(parents=True, exist_ok=True)
            shutil.copy(wheel, arguments.dist)
            shutil.copy(archive, arguments.dist)
    if arguments.write:
        write(checks)
    elif not arguments.quick and '' in extras:
        print(tables(checks))
    print('check-pip: good')


if __name__ == '__main__':
    main()
