# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
A scene as URDF; with fourbar_lab as MJCF too.

>>> from fourbar_ros import load_scene
>>> from fourbar_ros.description import describe
>>> describe(load_scene('paper'), 'urdf').splitlines()[1]
'<robot name="fourbar">'
"""
from __future__ import annotations

from typing import TYPE_CHECKING

from fourbar_ros.optional import lazily

if TYPE_CHECKING:
    from fourbar_ros.description.formats import describe

__getattr__, __dir__, __all__ = lazily(__name__)
