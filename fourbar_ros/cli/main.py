# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
# PYTHON_ARGCOMPLETE_OK
"""
The ``fourbar`` command: a verb is a module of :mod:`fourbar_ros.cli`, or comes from fourbar_lab.

An entry point of the group ``fourbar.verbs`` names a module with ``add(verbs)``.
"""
import argparse
from collections.abc import Iterator, Sequence
import contextlib
from importlib import import_module
import os
import signal
import sys
import threading
from typing import NoReturn
import warnings

from fourbar_ros import __version__, optional
from fourbar_ros.cli.common import HelpFormatter, Parser, refuse_overwriting
from fourbar_ros.errors import FourBarError, SceneWarning

GROUP = 'fourbar.verbs'
MODULES = {'import': 'import_robot', **{name: name for name in (
    'bag', 'describe', 'replay', 'scene', 'simulate')}}
DESCRIPTION = """\
Motion, loads and extrema of planar linkages, and tools for recorded runs: four-bars,
slider-cranks, inverted slider-cranks, Scotch yokes and machines of dyads. Works without ROS,
except for record and replay, which talk to a node.

A scene is a ROS 2 parameter file or the name of a shipped one, e.g. paper. The same file starts
the node:
  fourbar_node --ros-args --params-file SCENE
"""
EPILOG = """\
examples:
  fourbar show paper                           class, limits, extrema and loads of a shipped scene
  fourbar show paper --mode 1                  the same in the other assembly mode
  fourbar show my.yaml --at 60                 your own scene, with its state at 60 degrees
  fourbar show slides_7_6 --at 60 --acceleration 100
  fourbar show cylinder --at 1.5               a boom and its cylinder, 1.5 m long
  fourbar new my.yaml --a1 50mm --a2 150mm --a3 100mm --a4 125mm --bar 20x5mm
  fourbar table paper f41 -o paper.csv         a load over the crank angle, for a spreadsheet
  fourbar plot paper f41 -o paper.png          the same as a picture
  fourbar scene check paper                    what a node with this scene does, and what it costs
  fourbar simulate motor --until 2             a motor starts a linkage: extrema at samples
  fourbar bag info bags/run                    what a bag contains
  fourbar bag recompute bags/run               recompute every recorded output and compare
  fourbar describe paper -o paper.urdf         the scene as URDF; or --as mjcf
  fourbar import robot.xml -o robot.yaml       closed loops of a robot's MJCF or URDF as scenes
  fourbar generate paper -o code               the scene as C; or --as fmu2
  fourbar replay bags/run --rate 2             publish a run again, twice as fast
  fourbar study STUDY.yaml -o DIR              compute many designs of a scene
  fourbar balance paper                        counterweights for a scene

exit codes: 0 good; 1 an error, reported in one line; 2 bad arguments; 3 done, but the result
is not good (see the help of the verb)
"""


def parser(wanted: str = '') -> argparse.ArgumentParser:
    """
    Return the argument parser; every verb sets ``run``, which returns an exit code or None.

    It has the verb ``wanted`` alone, if there is such a verb, or all, which takes longer.
    """
    top = Parser(prog='fourbar', description=DESCRIPTION, epilog=EPILOG,
                 formatter_class=HelpFormatter)
    top.add_argument('--version', action='version', version=f'fourbar {__version__}')
    verbs = top.add_subparsers(dest='verb', required=True, metavar='VERB')
    modules = {name: f'fourbar_ros.cli.{module}' for name, module in MODULES.items()}
    if wanted not in modules:
        from importlib.metadata import entry_points  # 28 ms, for verbs of fourbar_lab
        modules |= {entry.name: entry.value for entry in entry_points(group=GROUP)}
    if wanted in modules:
        modules = {wanted: modules[wanted]}
    missing: dict[str, list[str]] = {}      # {why: verbs}
    for module in sorted(set(modules.values()), key=lambda module: module.rpartition('.')[2]):
        try:
            import_module(module).add(verbs)
        except ImportError as error:
            missing.setdefault(str(error), []).extend(
                name for name in modules if modules[name] == module)
    for why, names in missing.items():
        print(f'fourbar: no verb {", ".join(names)}: {why}', file=sys.stderr)
    return top


def main(args: Sequence[str] | None = None) -> int:
    """
    Run one verb and return its exit code: 1 for an error, in one line on stderr, 130 for Ctrl-C.

    A fault of ours is not caught: Python prints its traceback.
    """
    words = sys.argv[1:] if args is None else args
    completes = '_ARGCOMPLETE' in os.environ        # a shell asks for words
    command = parser('' if completes or not words else words[0])
    if completes:
        with contextlib.suppress(ModuleNotFoundError):
            from argcomplete import autocomplete
            autocomplete(command)
    arguments = command.parse_args(words)
    try:
        with terminable(), _warnings_at_the_end():
            outputs = [getattr(arguments, name) for name in getattr(arguments, 'written', ())]
            refuse_overwriting(filter(None, outputs), getattr(arguments, 'force', False))
            return arguments.run(arguments) or 0
    except FourBarError as error:
        print(f'fourbar: {error}', file=sys.stderr)
        return 1
    except ModuleNotFoundError as error:
        if not optional.MissingPackage.explains(error):
            raise
        print(f'fourbar: {optional.MissingPackage(arguments.verb, error)}', file=sys.stderr)
        return 1
    except UnicodeEncodeError as error:     # into a file or pipe of Windows
        letters = error.object[error.start:error.end]
        print(f'fourbar: {letters!a} cannot be written in {sys.stdout.encoding}; PYTHONUTF8=1 in '
              'the environment writes UTF-8', file=sys.stderr)
        return 1
    except MemoryError:
        print(f'fourbar: {arguments.verb}: not enough memory', file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        return 130
    except BrokenPipeError:                 # the reader of our output is gone: head, less
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    except OSError as error:
        print(f'fourbar: {error.filename or arguments.verb}: {error.strerror or error}',
              file=sys.stderr)
        return 1
    return 0


@contextlib.contextmanager
def _warnings_at_the_end() -> Iterator[None]:
    """Print warnings on stderr, those of scenes in a line each, after all other output."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter('always', SceneWarning)
        try:
            yield
        finally:
            sys.stdout.flush()
            lines = [f'fourbar: warning: {each.message}\n' if each.category is SceneWarning else
                     warnings.formatwarning(each.message, each.category, each.filename,
                                            each.lineno, each.line) for each in caught]
            sys.stderr.write(''.join(dict.fromkeys(lines)))


# Windows has no SIGHUP
_ENDING = [signal.Signals[name] for name in ('SIGTERM', 'SIGHUP') if hasattr(signal, name)]


@contextlib.contextmanager
def terminable() -> Iterator[None]:
    """Let SIGTERM and SIGHUP end a verb by an exception: it leaves no partial output, no node."""
    def end(signal_number: int, _: object) -> NoReturn:
        raise SystemExit(128 + signal_number)

    before = {}
    if threading.current_thread() is threading.main_thread():
        before = {ending: signal.signal(ending, end) for ending in _ENDING
                  if signal.getsignal(ending) is signal.SIG_DFL}    # nohup ignores SIGHUP
    try:
        yield
    finally:
        for ending, handler in before.items():
            signal.signal(ending, handler)


if __name__ == '__main__':
    sys.exit(main())
