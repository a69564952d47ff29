# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Optional packages: one line tells how to install a missing one."""
from __future__ import annotations

import ast
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
import sys
from typing import Any

from fourbar_ros.errors import FourBarError

# {module: how to install it}
INSTALL = {**{name: f'pip install {name}' for name in (
               'clarabel', 'distributed', 'matplotlib', 'mujoco', 'pandas', 'pyarrow', 'rich',
               'scipy')},
           **dict.fromkeys(('mcap', 'rosbags', 'lz4', 'zstandard'), 'pip install mcap rosbags'),
           **dict.fromkeys(('starlette', 'uvicorn'), 'pip install starlette uvicorn'),
           'flint': 'pip install python-flint', 'yaml': 'pip install pyyaml',
           'fourbar_lab': 'pip install .  in the source of fourbar_ros installs it too'}
# what needs several names them all at once
OF_VERB = {'study': 'pip install scipy pyarrow'}
ROS = ('rclpy', 'rcl_interfaces', 'rosidl_runtime_py', 'rpyutils', 'ament_index_python')
ROS_HINT = 'source a ROS 2 workspace that contains fourbar_ros, or run  make run  in its source'


class MissingPackage(FourBarError):
    """An optional package is missing; the message tells how to install it."""

    def __init__(self, what: str, error: ModuleNotFoundError):
        name = (error.name or '').partition('.')[0]
        all_of_verb = OF_VERB.get(what, '')
        hint = all_of_verb if name in all_of_verb.split() else INSTALL.get(name) or ROS_HINT
        super().__init__(f'{what} requires {name if name in INSTALL else "ROS 2"}: {hint}'
                         + ('' if name in INSTALL else f' ({error})'))

    @staticmethod
    def explains(error: ModuleNotFoundError) -> bool:
        """Return whether an import error is one of a package that may be missing."""
        name = (error.name or '').partition('.')[0]
        return name in INSTALL or name in ROS or name.endswith(('_msgs', '_srvs', '_interfaces'))


def lab(tool: str) -> Any:
    """Return a tool of fourbar_lab by its entry point; raises ModuleNotFoundError without it."""
    from importlib.metadata import entry_points  # four fifths of a bare import

    for entry in entry_points(group='fourbar.lab', name=tool):
        return entry.load()
    raise ModuleNotFoundError(f'no entry point {tool} of fourbar_lab', name='fourbar_lab')


def _command(name: str, module: str) -> int:
    """
    Return the exit code of a module's ``main``; 1 if a package that it imports is missing.

    ``name`` of the command begins the one-line message, which tells how to install the package.
    """
    try:
        return int(import_module(module).main())
    except ModuleNotFoundError as error:
        if not MissingPackage.explains(error):
            raise
        print(MissingPackage(name, error), file=sys.stderr)
        return 1


def node() -> int:
    """``fourbar_node``."""
    return _command('fourbar_node', 'fourbar_ros.ros.node.start')


def demo() -> int:
    """``fourbar_demo``."""
    return _command('fourbar_demo', 'fourbar_lab.clients.demo')


# --- names of a public face, imported when they are asked for ------------------------------------

def lazily(package: str) -> tuple[Callable[[str], Any], Callable[[], list[str]], list[str]]:
    """
    Return ``__getattr__``, ``__dir__`` and ``__all__`` of a package (PEP 562).

    Its public names are those that it imports for type checkers, ``if TYPE_CHECKING``: editors
    find them there, and a program loads numpy and others only with the first name that needs them.
    """
    text = Path(str(sys.modules[package].__file__)).read_text(encoding='utf-8')
    guarded = next(node for node in ast.parse(text).body if isinstance(node, ast.If))
    origins = {alias.asname or alias.name: (str(line.module), alias.name)
               for line in guarded.body if isinstance(line, ast.ImportFrom)
               for alias in line.names}

    def get_attribute(name: str) -> Any:
        if name not in origins:
            raise AttributeError(f'module {package!r} has no attribute {name!r}')
        module, name_there = origins[name]
        return getattr(import_module(module), name_there)

    def list_names() -> list[str]:
        return sorted({*vars(sys.modules[package]), *origins})

    return get_attribute, list_names, sorted(origins)
