# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
All extrema of any quantity over the input, with proofs on demand.

>>> from fourbar_ros import load_scene
>>> from fourbar_ros.extrema import find_extrema, point_speed
>>> linkage = load_scene('paper').linkage
>>> speed = point_speed(linkage, 'coupler', along=0.5, across=0.2)      # of a point on it [m/s]
>>> for extremum in find_extrema(linkage, (speed,), rate=25.0):
...     print(f'{extremum.kind} {extremum.value:.6f} m/s at {extremum.theta1:.6f} rad')
minimum 5.856317 m/s at 0.331828 rad
maximum 10.699145 m/s at 1.839019 rad
minimum 5.950376 m/s at 4.208323 rad
maximum 14.069959 m/s at 5.798952 rad
"""
from __future__ import annotations

from typing import TYPE_CHECKING

from fourbar_ros.optional import lazily

if TYPE_CHECKING:
    from fourbar_ros.extrema.find import Extremum, find_extrema
    from fourbar_ros.extrema.over_input import output_ranges, OutputRange, OverInput
    from fourbar_ros.mechanisms.quantities import Function as Quantity
    from fourbar_ros.mechanisms.quantities import (
        known_quantities,
        point_acceleration,
        point_speed,
        point_x,
        point_y,
        UnknownQuantity,
    )

__getattr__, __dir__, __all__ = lazily(__name__)
