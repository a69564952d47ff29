# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Names that a package imports when they are first used."""
from __future__ import annotations

from collections.abc import Callable, Mapping
from importlib import import_module
import sys
from typing import Any


def lazily(package: str, where: Mapping[str, str]
           ) -> tuple[Callable[[str], Any], Callable[[], list[str]]]:
    """
    Return the functions ``__getattr__`` and ``__dir__`` of a package (PEP 562).

    Parameters
    ----------
    package : str
        Its full name.
    where : mapping
        {module: its public names as an import writes them: ``'Bag, load as load_scene'``}.

    """
    found = {}
    for module, names in where.items():
        for name, _, public in (entry.partition(' as ') for entry in names.split(', ')):
            found[public or name] = module, name

    def get(name: str) -> Any:
        if name not in found:
            raise AttributeError(f'module {package!r} has no attribute {name!r}')
        module, its_name = found[name]
        return getattr(import_module(module), its_name)

    def list_names() -> list[str]:
        return sorted({*vars(sys.modules[package]), *found})

    return get, list_names
