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
    from fourbar_ros.scene.linkage import warnings_of
    from fourbar_ros.scene.scene import from_values, load, Scene
    from fourbar_ros.scene.simulated import simulate_scene

__all__ = [
    'Scene', 'SceneError', 'find', 'from_values', 'load', 'read_values', 'simulate_scene',
    'warnings_of',
]

__getattr__, __dir__ = lazily(__name__, {
    'fourbar_ros.scene.files': 'find, read_values, SceneError',
    'fourbar_ros.scene.linkage': 'warnings_of',
    'fourbar_ros.scene.scene': 'from_values, load, Scene',
    'fourbar_ros.scene.simulated': 'simulate_scene',
})
