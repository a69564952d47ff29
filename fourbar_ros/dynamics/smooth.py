# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The smooth motion of a mechanism through its change points.

At the flat position of an exact change point both assembly modes meet. A linkage that moves
through it keeps the velocities of its links, and the side of the dyad changes: the motion goes on
in the mode beyond, as the contract's ``mode_beyond`` says. So the mode is a function of the input.
It is the given mode in the interval between flat positions in which the input starts, and
alternates from one interval to the next.
"""
from __future__ import annotations

from math import floor, tau

from fourbar_ros.mechanisms.mechanism import DrivenLinks
from fourbar_ros.numerics.number_types import Function
import numpy as np


def flat_positions(mechanism: DrivenLinks) -> tuple[float, ...]:
    """
    Return the inputs inside the range where an exact change point lies flat, in order.

    There all links lie in line, both assembly modes meet, and a motion goes on in the other one.
    Angles [rad] in [0, 2 pi), slides [m]. Without an exact change point there are none.
    """
    if mechanism.change_point_margin != 0.0:
        return ()
    is_angle = not mechanism.is_driven_by_slide
    ranges = () if mechanism.turns_fully else mechanism.input_ranges
    ends = {end for bounds in ranges for end in bounds}
    inside = [value for value in set(map(float, mechanism.flat_inputs))
              if all(abs(mechanism.distance(value, end)) > 1e-12 for end in ends)]
    return tuple(sorted({value % tau if is_angle else value for value in inside}))


def beyond(mechanism: DrivenLinks) -> DrivenLinks:
    """Return a mechanism in the mode into which it goes on at its flat positions."""
    return mechanism.in_mode(mechanism.mode_beyond(flat_positions(mechanism)[0]))


def make_interval_of(mechanism: DrivenLinks) -> Function:
    """
    Return the function input -> number of the interval between flat positions that it is in.

    An angle counts on over whole turns: with one flat position at 2 rad, 1 rad is in interval -1,
    3 rad in interval 0 and 3 + 2 pi in interval 1. A flat position counts to the interval above.
    """
    places = flat_positions(mechanism)
    if mechanism.is_driven_by_slide:
        return lambda position: sum(position >= place for place in places)
    return lambda position: sum((floor if isinstance(position, float) else np.floor)(
        (position - place) / tau) for place in places)


def make_is_alternate(mechanism: DrivenLinks, start: float) -> Function | None:
    """
    Return the function input -> whether a smooth motion is in the other mode there.

    The mechanism is in its own mode in the interval of ``start``, in the other one in the next,
    and so on in turn. Returns None where there are no flat positions.
    """
    if not flat_positions(mechanism):
        return None
    interval_of = make_interval_of(mechanism)
    first = interval_of(start) % 2
    return lambda position: interval_of(position) % 2 != first
