# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Balancing: counterweights that take shaking force, moment, torque or reactions away.

>>> from fourbar_lab.balancing import least_rms, Loads, Places
>>> from fourbar_ros import load_scene
>>> scene = load_scene('paper')
>>> places = Places(Loads(scene.linkage, scene.drive.speed), {'crank': 0.6, 'output': 0.6})
>>> for weight in least_rms(places, ['force'], mass=2.0).counterweights:
...     print(f'{weight.mass:.3f} kg on the {weight.link}, {weight.along:.3f} m along it')
0.702 kg on the crank, -0.587 m along it
1.298 kg on the output, -0.598 m along it
"""
from __future__ import annotations

from typing import TYPE_CHECKING

from fourbar_ros.optional import lazily

if TYPE_CHECKING:
    from fourbar_lab.balancing.cone import (
        Balance,
        Counterweight,
        front,
        full_force_balance,
        least_peak,
        least_rms,
        Places,
    )
    from fourbar_lab.balancing.loads import BalanceError, Loads
    from fourbar_lab.balancing.result import Change, changes, scene_text

__getattr__, __dir__, __all__ = lazily(__name__)
