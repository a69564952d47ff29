# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""NamedTuple types that are made at run time, and whose values pass from process to process."""
from __future__ import annotations

from collections import namedtuple
from functools import cache
from typing import Any


@cache
def record_type(name: str, fields: tuple[str, ...]) -> Any:
    """Return the type of this name with these fields, the same one each time."""
    base: Any = namedtuple(name, fields)       # type: ignore[misc]  # noqa: PYI024

    def reduce(self: Any) -> tuple[Any, ...]:
        return restored, (name, fields, tuple(self))

    return type(name, (base,), {'__slots__': (), '__reduce__': reduce, '__module__': __name__})


def restored(name: str, fields: tuple[str, ...], values: tuple[Any, ...]) -> Any:
    """Return a record that was taken apart."""
    return record_type(name, fields)._make(values)
