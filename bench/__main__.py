# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Run measurements and print their tables; ``--write`` puts them into docs/bench.

A page there has a section for each of its measurements: the first table and figure are in sight,
all else is folded. The text around it is written by hand.
"""
import argparse
import contextlib
import importlib
import inspect
import io
from pathlib import Path
import platform
import re
import subprocess
import sys
import time

from . import pages, ROOT

MODULES = {file.stem: file for file in sorted(Path(__file__).parent.glob('[a-z]*.py'))
           if 'def main(' in file.read_text()}


class Tee(io.StringIO):
    """Print while keeping."""

    def write(self, text):
        sys.__stdout__.write(text)
        sys.__stdout__.flush()
        return super().write(text)


def machine():
    """Return one line about where the figures come from."""
    import numpy
    commit = subprocess.run(['git', 'rev-parse', '--short=7', 'HEAD'], cwd=ROOT, check=False,
                            capture_output=True, text=True).stdout.strip() or 'unknown'
    return (f'{time.strftime("%Y-%m-%d")}, commit {commit}, Python {platform.python_version()}, '
            f'numpy {numpy.__version__}, {platform.system()} {platform.machine()}')


def section(about, how, text):
    """Return the Markdown of a measurement: its first table and figure, the rest folded."""
    blocks = re.sub('^#', '##', text.strip(), flags=re.M).split('\n\n')
    table, figure = (next((place for place, block in enumerate(blocks) if block.startswith(mark)),
                          -1) for mark in ('|', '!['))
    shown = [*blocks[:table + 1], *([blocks[figure]] if figure > table else [])]
    rest = [block for block in blocks[table + 1:] if block not in shown]
    folded = ['<details markdown="1"><summary>more</summary>', *rest, '</details>'] if rest else []
    return '\n\n'.join([f'## {about}', how, *shown, *folded])


def write(name, about, how, text):
    """Write the section of a measurement on the page of docs that has one."""
    new = f'<!-- {name} -->\n{section(about, how, text)}\n<!-- end -->'
    for page in (ROOT / 'docs' / 'robots.md', *(ROOT / 'docs' / 'bench').glob('*.md')):
        before = page.read_text(encoding='utf-8')
        if f'<!-- {name} -->' in before:
            page.write_text(re.sub(rf'<!-- {name} -->\n.*?<!-- end -->', lambda _: new, before,
                                   flags=re.S), encoding='utf-8')


def main():
    """Parse arguments and run."""
    about = {name: importlib.import_module(f'bench.{name}').__doc__.strip().splitlines()[0]
             for name in MODULES}
    parser = argparse.ArgumentParser(
        prog='make bench ARGS="..."', description='Measure. Ratios of one run can be trusted, '
                                                  'absolute times not.',
        epilog='\n'.join(f'{name:12} {text}' for name, text in about.items()),
        formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('names', nargs='*', metavar='NAME', help='which (default: all)')
    parser.add_argument('--write', action='store_true', help='also write docs/bench')
    parser.add_argument('--samples', type=int, metavar='N',
                        help='how many, where a measurement takes samples')
    parser.add_argument('--against', metavar='COMMIT',
                        help='which version, where one is measured beside an earlier one')
    parser.add_argument('--scene', metavar='SCENE', help='of which, where one is measured')
    parser.add_argument('--folder', metavar='DIR',
                        help='where the files are, of a measurement of files of others')
    arguments = parser.parse_args()
    if unknown := [name for name in arguments.names if name not in MODULES]:
        parser.error(f'{unknown[0]!r}: choose from {", ".join(MODULES)}')
    pages.is_written = arguments.write
    for name in arguments.names or MODULES:
        print(f'\n# {about[name]}\n\n{machine()}\n')
        with contextlib.redirect_stdout(Tee()) as kept:
            run = importlib.import_module(f'bench.{name}').main
            known = inspect.signature(run).parameters
            run(**{option: value for option in ('samples', 'against', 'folder', 'scene')
                   if option in known
                   and (value := getattr(arguments, option)) is not None})
        if arguments.write:
            asked = name + (f' --samples {arguments.samples}' if arguments.samples else '') + (
                ' --folder DIR' if 'folder' in known else '')
            write(name, about[name], f'Written by `make bench ARGS="{asked} --write"`: '
                  f'{machine()}.', kept.getvalue())


if __name__ == '__main__':
    main()
