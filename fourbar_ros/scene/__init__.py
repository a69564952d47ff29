# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Scenes: the parameters of a node as one linkage with its drive, outputs and recording.

>>> from fourbar_ros.scene import find, load
>>> scene = load(find('paper'))
>>> scene.linkage.classification, scene.drive.speed
('Grashof crank-rocker', 25.0)
"""
from __future__ import annotations

from typing import TYPE_CHECKING

from fourbar_ros.optional import lazily

if TYPE_CHECKING:
    from fourbar_ros.scene.files import find, read_values, SceneError
    from fourbar_ros.scene.scene import from_values, load, Scene
    from fourbar_ros.scene.simulated import simulate_scene
    from fourbar_ros.scene.units import quantity

__getattr__, __dir__, __all__ = lazily(__name__)
