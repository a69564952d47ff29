# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Modes in bags from before a mode was a branch: there it is the side on which a dyad closes.

At the flat position of a change point a prescribed motion kept its mode and so jumped to the other
branch; motion by torque went on smoothly, and its mode changed.
"""
from contextlib import suppress
from typing import Any

from fourbar_ros.errors import FourBarError
from fourbar_ros.mechanisms.kind import Kind
from fourbar_ros.mechanisms.machine.structure import CYLINDER, OF_ONE_MODE

KEY, BRANCHES = 'modes', 'branches'     # in a bag whose modes are
AT_FLAT = 'are at a flat position, where loads are no longer given'


def modes_of(mechanism: Any) -> range | None:
    """Return all modes if a branch can be on the other side than its mode says, else None."""
    stages = mechanism.layout.stages
    may_differ = (mechanism.change_point_margin == 0.0 if isinstance(mechanism, Kind) else
                  any(stage.pair or stage.name == CYLINDER for stage in stages))
    return range(1, 1 + 2**len(stages)) if may_differ else None


def branch_at(mechanism: Any, mode: int, position: float) -> int:
    """
    Return the mode, as of today, of the pose that an old bag names by a ``mode`` of sides.

    Both count dyads in bits: bit k of mode - 1 is 1 where dyad k is in its mode 2. The old mode is
    returned where the mechanism has no pose at ``position``, the input [rad or m].
    """
    branch = mode
    with suppress(FourBarError):
        for dyad in range(len(mechanism.layout.stages)):
            wanted_side = 1.0 if mode - 1 >> dyad & 1 else -1.0
            if wanted_side * _side(mechanism.in_mode(branch), dyad, position) < 0.0:
                branch = 1 + (branch - 1 ^ 1 << dyad)       # the dyad in its other mode
        return branch
    return mode


def _side(mechanism: Any, dyad: int, position: float) -> float:
    """
    Return a number that is positive where a dyad is on the side of mode 2, negative on the other.

    It is the slide of a block, the sine of the angle between the links of another dyad, and 0.0
    for a dyad of one mode. ``position``: the input [rad or m].
    """
    stage = mechanism.layout.stages[dyad]
    if stage.kind in OF_ONE_MODE:
        return 0.0
    is_block, sign = stage.kind == 'RPR' and stage.name != CYLINDER, 1.0
    field = f'slide_{stage.slides()[0]}' if is_block else f'sine_{stage.name}'
    if isinstance(mechanism, Kind):         # of one dyad, which may have the sign of the other
        field, sign = field.partition('_')[0], mechanism.drive.sign
    return sign * float(getattr(mechanism.motion(position, 0.0, 0.0), field))
