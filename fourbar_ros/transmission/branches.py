# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Where the output of a mechanism follows its input one to one.

Between two places at which the output turns back (or the range of the input ends), the output
rises or falls all the way, so that each of its positions belongs to one input.
"""
from __future__ import annotations

from math import inf, pi
from typing import Any, NamedTuple

from fourbar_ros.errors import InvalidParameter, OutOfRange
from fourbar_ros.numerics.arrays import Array
import numpy as np

SAMPLES = 4097         # over a range of the input, to see where the output turns back
HALVINGS = 64          # of an interval, down to neighbouring floats


class End(NamedTuple):
    """
    An end of a branch: the input there, the output, and why it ends.

    ``why``: 'the output turns back' (a toggle of the mechanism driven by its output), or 'the
    range of the input ends'.
    """

    input: float
    output: float
    why: str


class Branch(NamedTuple):
    """
    A branch, as samples from which roots start.

    Parameters
    ----------
    inputs, outputs : numpy.ndarray
        Rising inputs, and the continuous output at each [rad or m].
    ends : tuple of 2 End, optional
        None: the input turns on and on, and the output with it.

    """

    inputs: Array
    outputs: Array
    ends: tuple[End, End] | None

    @property
    def sense(self) -> float:
        """Return 1 if the output rises with the input, else -1."""
        return 1.0 if self.outputs[-1] > self.outputs[0] else -1.0


def ratio_of(mechanism: Any, inputs: Any) -> Any:
    """Return d output / d input at inputs."""
    coordinate = mechanism.outputs[0].coordinate
    return mechanism.motion(inputs, 1.0, 0.0, fields=(coordinate.rate,))[0]


def output_of(mechanism: Any, inputs: Any) -> Any:
    """Return the position of the output at inputs, angles in [-pi, pi]."""
    return mechanism.motion(inputs, fields=(mechanism.outputs[0].coordinate.position,))[0]


def branch_of(mechanism: Any, start: float) -> Branch:
    """
    Return the :class:`Branch` with an input in it.

    Raises
    ------
    OutOfRange
        The mechanism does not close at ``start``.
    InvalidParameter
        The output turns back just there.

    """
    coordinate = mechanism.input_coordinate
    low, high = _range(mechanism, start)
    if low is None:
        raise OutOfRange(coordinate.position, start, mechanism.input_ranges, coordinate.unit)
    # From the start on, so that a full turn has no seam in the branch.
    inputs = np.linspace(low, high, SAMPLES)
    ratios = ratio_of(mechanism, inputs)
    turning = [_turn(mechanism, *pair) for pair in _changes(inputs, ratios)]
    if mechanism.turns_fully and not turning:
        return Branch(inputs, _continuous(mechanism, inputs), None)
    if mechanism.turns_fully:
        turning = sorted(turn + k * 2.0 * pi for turn in turning for k in (-1, 0, 1))
    below = max((turn for turn in turning if turn < start), default=-inf)
    above = min((turn for turn in turning if turn > start), default=inf)
    if start in turning:
        raise InvalidParameter(coordinate.position, start,
                               'the output turns back there: start on one side of it')
    inside = np.linspace(max(below, low if not mechanism.turns_fully else -inf),
                         min(above, high if not mechanism.turns_fully else inf), SAMPLES)
    outputs = _continuous(mechanism, inside)
    good = ~np.isnan(outputs)
    inside, outputs = inside[good], outputs[good]
    ends = [End(float(at), float(out), 'the output turns back' if at in turning else
                'the range of the input ends')
            for at, out in ((inside[0], outputs[0]), (inside[-1], outputs[-1]))]
    return Branch(inside, outputs, (ends[0], ends[1]))


def _range(mechanism: Any, start: float) -> tuple[Any, Any]:
    """Return the range of the input around a start; a whole turn has the start in its middle."""
    if mechanism.turns_fully:
        return start - pi, start + pi
    for low, high in mechanism.input_ranges:
        for turn in (0.0,) if mechanism.is_driven_by_slide else (0.0, 2.0 * pi, -2.0 * pi):
            if low + turn <= start <= high + turn:
                return low + turn, high + turn
    return None, None


def _changes(inputs: Array, ratios: Array) -> list[tuple[float, float]]:
    """Return the intervals in which the ratio changes its sign, where it exists."""
    known = np.flatnonzero(~np.isnan(ratios) & np.isfinite(ratios))
    one, other = known[:-1], known[1:]
    found = np.flatnonzero((ratios[one] < 0.0) != (ratios[other] < 0.0))
    return [(float(inputs[one[i]]), float(inputs[other[i]])) for i in found]


def _turn(mechanism: Any, low: float, high: float) -> float:
    """Return where the ratio is zero between two inputs, by halving."""
    is_negative = ratio_of(mechanism, low) < 0.0
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        if not low < middle < high:
            break
        if (ratio_of(mechanism, middle) < 0.0) == is_negative:
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)


def _continuous(mechanism: Any, inputs: Array) -> Array:
    """Return the output along rising inputs, an angle without jumps of a turn."""
    outputs = np.array(output_of(mechanism, inputs))
    if mechanism.outputs[0].coordinate.unit == 'rad':
        good = ~np.isnan(outputs)
        outputs[good] = np.unwrap(outputs[good])
    return outputs
