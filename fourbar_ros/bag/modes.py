# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""In which assembly mode each motion of a bag is: through toggles it changes."""
from __future__ import annotations

from collections.abc import Collection

from fourbar_ros.bag.records import Columns
from fourbar_ros.numerics.arrays import Array
import numpy as np


class Modes:
    """Modes that states of a drive tell by their stamps; without one, that of the scene."""

    def __init__(self) -> None:
        self._others: dict[int, int] = {}      # by the stamps of motions to come

    def take(self, states: Columns, own: int, known: Collection[int]) -> None:
        """Take states of the drive; ``own``: the mode of the scene, one of the known ones."""
        modes = states.records['mode']
        there = (modes != own) & np.isin(modes, list(known))
        self._others.update(zip(states.headed[there].tolist(), modes[there].tolist()))

    def of(self, stamps: Array, own: int) -> Array:
        """Return the modes of motions with these stamps."""
        if not self._others:
            return np.full(len(stamps), own)
        return np.array([self._others.pop(stamp, own) for stamp in stamps.tolist()])
