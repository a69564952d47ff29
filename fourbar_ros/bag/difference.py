# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Differences between recorded and recomputed messages, and their summary."""
from __future__ import annotations

from math import inf, isnan
from typing import NamedTuple

from fourbar_ros.bag.rounding import LIMIT
from fourbar_ros.numerics.arrays import Array
import numpy as np


class Difference(NamedTuple):
    """
    Largest difference of one field of one topic over all its messages; of texts infinite.

    ``units``: the largest one in eps times the condition of the value, infinite if not known.
    """

    topic: str
    field: str
    messages: int
    largest: float
    units: float = inf

    @property
    def is_rounding(self) -> bool:
        """Return whether two versions of the software may differ so by rounding."""
        return self.largest == 0.0 or self.units <= LIMIT


class Recomputed(NamedTuple):
    """
    The result of recomputing a bag.

    Attributes
    ----------
    differences : list of Difference
    inputs, compared : int
        Driven motions, and outputs that were recomputed from them.
    unmatched : int
        Outputs whose motion is not in the bag.
    missing, doubled : int
        Outputs that a motion should have and has not, or has once more.
    silent, uncertain : int
        Outputs that say that the input had stopped; outputs that depend on what the bag cannot
        tell: values held from before a part of a split bag, the order around a change of the scene
        in a bag of rosbag2.
    driven : str
        How the motion of the driven joint itself was checked.
    cut : bool
        The bag ends without an end.

    """

    differences: list[Difference]
    inputs: int
    compared: int
    unmatched: int
    missing: int
    doubled: int
    silent: int
    uncertain: int
    driven: str
    cut: bool

    @property
    def largest(self) -> float:
        """Return the largest of all differences."""
        return max((difference.largest for difference in self.differences), default=0.0)

    @property
    def units(self) -> float:
        """Return the largest of all differences in eps times condition."""
        return max((difference.units for difference in self.differences if difference.largest),
                   default=0.0)

    @property
    def is_rounding(self) -> bool:
        """Return whether there are differences, and rounding explains all of them."""
        return self.largest > 0.0 and all(d.is_rounding for d in self.differences)

    def verdict(self) -> str:
        """Return what the differences are, in one line; empty if there are none."""
        if not self.largest:
            return ''
        real = [difference for difference in self.differences if not difference.is_rounding]
        if not real:
            return (f'differences by rounding only: at most {self.units:.2g} eps times the '
                    f'condition of the value; two versions may differ by {LIMIT:g}')
        worst = max(real, key=lambda difference: difference.units)
        size = (f'{worst.units:.2g} eps times the condition of the value; rounding explains '
                f'{LIMIT:g}' if worst.units < inf else 'which rounding does not explain')
        return f'real differences: {worst.topic} {worst.field} by {worst.largest:g}, {size}'

    def problems(self, tolerance: float = 0.0, accept_rounding: bool = False) -> list[str]:
        """
        Return the problems as a list of texts; empty for a good bag.

        ``tolerance``: differences up to this count as none; ``accept_rounding``: so do those that
        rounding explains.
        """
        counts = ((self.unmatched, 'outputs without their motion'),
                  (self.missing, 'outputs missing'),
                  (self.doubled, 'outputs more than once'))
        found = [f'{count} {text}' for count, text in counts if count]
        if self.largest > tolerance and not (accept_rounding and self.is_rounding):
            found.insert(0, f'differences up to {self.largest:g}')
        return found if self.compared else ['nothing could be compared', *found]


def distance(a: Array, b: Array) -> float:
    """
    Return the largest difference of two arrays.

    NaN equals NaN; NaN against a number is infinite.
    """
    with np.errstate(invalid='ignore'):
        distance = np.abs(a - b)
    unknown = np.isnan(distance)
    if unknown.any():           # inf - inf, or NaN on one side or both
        distance = np.where(unknown, np.where((a == b) | (np.isnan(a) & np.isnan(b)), 0.0, inf),
                            distance)
    return float(distance.max())


def apart(a: float, b: float) -> float:
    """Return the difference of two numbers, by the same rules."""
    if a == b or (isnan(a) and isnan(b)):
        return 0.0
    return inf if isnan(a - b) else abs(a - b)
