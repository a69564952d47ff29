# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""A scene as C or an FMU, with the bits of the node; as JavaScript, as MJCF."""
from __future__ import annotations

from typing import TYPE_CHECKING

from fourbar_ros.optional import lazily

if TYPE_CHECKING:
    from fourbar_lab.export.files import generate, Generated

__getattr__, __dir__, __all__ = lazily(__name__)
