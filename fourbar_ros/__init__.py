# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Planar linkages: exact motion, loads and extrema, computed with numpy alone.

>>> from fourbar_ros import Bodies, find_extrema, FourBar, round_rod
>>> rods = Bodies(*(round_rod(length, 7750.0, 0.01) for length in (0.4, 1.2, 0.8)))
>>> linkage = FourBar(0.4, 1.2, 0.8, 1.0, bodies=rods)      # a1 to a4 [m]
>>> motion, loads = linkage.step(1.0, 25.0)                 # theta1 [rad], omega1 [rad/s]
>>> f'{motion.omega4:.6f} rad/s, {loads.shaking_force:.3f} N'
'11.032049 rad/s, 874.370 N'
>>> for extremum in find_extrema(linkage, ('omega4',), rate=25.0):
...     print(f'{extremum.kind} {extremum.value:.6f} rad/s at {extremum.theta1:.6f} rad')
maximum 13.513437 rad/s at 1.667165 rad
minimum -23.959382 rad/s at 5.913850 rad

Names are imported when they are first used: the node catches signals before numpy loads.
"""
from __future__ import annotations

from typing import TYPE_CHECKING

from fourbar_ros.optional import lazily

if TYPE_CHECKING:
    from fourbar_ros.errors import (
        FourBarError,
        InvalidParameter,
        Locked,
        MissingBodies,
        OutOfRange,
        Toggle,
    )
    from fourbar_ros.extrema.find import find_extrema
    from fourbar_ros.mechanics.bodies import (
        Applied,
        Base,
        Bodies,
        Body,
        External,
        flat_bar,
        round_rod,
    )
    from fourbar_ros.mechanisms.four_bars import FourBar, Loads, Motion, MovingJointFourBar
    from fourbar_ros.mechanisms.friction import DriveFriction, JointFriction
    from fourbar_ros.mechanisms.mechanism import Mechanism
    from fourbar_ros.mechanisms.parts import CROSSED, OPEN
    from fourbar_ros.mechanisms.points import point_motion
    from fourbar_ros.mechanisms.sliders import InvertedSlider, ScotchYoke, SliderCrank
    from fourbar_ros.scene.scene import load as load_scene

__version__ = '2.0.0'

__getattr__, __dir__, __all__ = lazily(__name__)
