# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Single entries of a study, checked: InvalidParameter names the entry and what is allowed.

``entry`` is how the study names it, ``given`` what YAML read.
"""
from __future__ import annotations

from math import isfinite
from typing import Any

from fourbar_ros.errors import InvalidParameter


def list_of(entry: str, given: Any) -> list[Any]:
    """Return a list."""
    if not isinstance(given, list):
        raise InvalidParameter(entry, given, 'must be a list, as [shaking_force, swing]')
    return given


def choice_of(entry: str, given: Any, choices: tuple[str, ...]) -> str:
    """Return one of some texts."""
    if given not in choices:
        raise InvalidParameter(entry, given, f'must be one of {", ".join(choices)}')
    return str(given)


def integer_of(entry: str, given: Any, low: int, high: int) -> int:
    """Return an integer within limits; 1e7 may be a float or a text in YAML."""
    if isinstance(given, float) and given.is_integer():      # 1e7 is a float in YAML 1.2
        given = int(given)
    if isinstance(given, str) and given.replace('e', '', 1).replace('.', '', 1).isdigit():
        return integer_of(entry, float(given), low, high)      # and a text in YAML 1.1
    if isinstance(given, bool) or not isinstance(given, int) or not low <= given <= high:
        raise InvalidParameter(entry, given, f'must be an integer from {low} to {high}')
    return given


def number_of(entry: str, given: Any, unbounded: float = 0.0) -> float:
    """Return a finite number; ``unbounded`` itself, an infinity, passes."""
    if given is unbounded:
        return unbounded
    if isinstance(given, bool) or not isinstance(given, (int, float)) or not isfinite(given):
        raise InvalidParameter(entry, given, 'must be a finite number')
    return float(given)
