# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Run measurements and print their tables; ``--write`` puts them into docs/."""
import argparse
import contextlib
import importlib
import inspect
import io
from pathlib import Path
import platform
import sys
import time

from . import ROOT

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
    return (f'{time.strftime("%Y-%m-%d")}, Python {platform.python_version()}, numpy '
            f'{numpy.__version__}, {platform.system()} {platform.machine()}')


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
    parser.add_argument('--write', action='store_true', help='also write docs/bench/NAME.md')
    parser.add_argument('--samples', type=int, metavar='N',
                        help='how many, where a measurement takes samples')
    parser.add_argument('--against', metavar='COMMIT',
                        help='which version, where one is measured beside an earlier one')
    arguments = parser.parse_args()
    if unknown := [name for name in arguments.names if name not in MODULES]:
        parser.error(f'{unknown[0]!r}: choose from {", ".join(MODULES)}')
    for name in arguments.names or MODULES:
        print(f'\n# {about[name]}\n\n{machine()}\n')
        with contextlib.redirect_stdout(Tee()) as kept:
            run = importlib.import_module(f'bench.{name}').main
            known = inspect.signature(run).parameters
            run(**{option: value for option in ('samples', 'against') if option in known
                   and (value := getattr(arguments, option)) is not None})
        if arguments.write:
            page = ROOT / 'docs' / 'bench' / f'{name}.md'
            page.parent.mkdir(exist_ok=True)
            asked = f'{name} --samples {arguments.samples}' if arguments.samples else name
            page.write_text(f'# {about[name]}\n\nWritten by `make bench ARGS="{asked} --write"`: '
                            f'{machine()}.\n\n'
                            + kept.getvalue())


if __name__ == '__main__':
    main()
