# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Optional packages: one line tells how to install a missing one."""
from __future__ import annotations

from collections.abc import Callable, Mapping
from importlib import import_module
from importlib.metadata import entry_points
import sys
from typing import Any

from fourbar_ros.errors import FourBarError

BAGS = 'pip install mcap rosbags'
INSTALL = {**dict.fromkeys(('mcap', 'rosbags', 'lz4', 'zstandard'), BAGS),
           'matplotlib': 'pip install matplotlib',
           'pyarrow': 'pip install pyarrow',
           'flint': 'pip install python-flint',
           'scipy': 'pip install scipy', 'distributed': 'pip install distributed',
           'nicegui': 'pip install nicegui', 'clarabel': 'pip install clarabel',
           'rich': 'pip install rich', 'yaml': 'pip install pyyaml',
           'fourbar_lab': 'pip install .  in the source of fourbar_ros installs it too'}
ROS = ('rclpy', 'rcl_interfaces', 'rosidl_runtime_py', 'rpyutils', 'ament_index_python')
ROS_HINT = 'source a ROS 2 workspace that contains fourbar_ros, or run  make run  in its source'


class MissingPackage(FourBarError):
    """An optional package is missing; the message tells how to install it."""

    def __init__(self, what: str, error: ModuleNotFoundError):
        name = (error.name or '').partition('.')[0]
        hint = INSTALL.get(name) or ROS_HINT
        super().__init__(f'{what} requires {name if name in INSTALL else "ROS 2"}: {hint}'
                         + ('' if name in INSTALL else f' ({error})'))

    @staticmethod
    def explains(error: ModuleNotFoundError) -> bool:
        """Return whether an import error is one of a package that may be missing."""
        name = (error.name or '').partition('.')[0]
        return name in INSTALL or name in ROS or name.endswith(('_msgs', '_srvs', '_interfaces'))


def lab(tool: str) -> Any:
    """Return a tool of fourbar_lab by its entry point; raises ModuleNotFoundError without it."""
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

def lazily(package: str, where: Mapping[str, str]
           ) -> tuple[Callable[[str], Any], Callable[[], list[str]]]:
    """
    Return ``__getattr__`` and ``__dir__`` for a package that imports names on first use (PEP 562).

    ``where`` gives the public names of each module as an import statement writes them:
    ``{'package.scene': 'Scene, load as load_scene'}``. So ``import fourbar_ros`` takes no time,
    and only what a program uses loads numpy and others.
    """
    homes = {}      # {public name: (module, its name there)}
    for module, names in where.items():
        for name, _, public in (entry.partition(' as ') for entry in names.split(', ')):
            homes[public or name] = module, name

    def get_attribute(name: str) -> Any:
        if name not in homes:
            raise AttributeError(f'module {package!r} has no attribute {name!r}')
        module, its_name = homes[name]
        return getattr(import_module(module), its_name)

    def list_names() -> list[str]:
        return sorted({*vars(sys.modules[package]), *homes})

    return get_attribute, list_names
