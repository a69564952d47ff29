# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""A scene as C, C++ or an FMU, with the bits of the node."""
from __future__ import annotations

from typing import TYPE_CHECKING

from fourbar_ros.optional import lazily

if TYPE_CHECKING:
    from fourbar_ros.generated.compiled import Compiled
    from fourbar_ros.generated.files import generate, Generated

__all__ = ['Compiled', 'Generated', 'generate']

__getattr__, __dir__ = lazily(__name__, {
    'fourbar_ros.generated.compiled': 'Compiled',
    'fourbar_ros.generated.files': 'generate, Generated',
})
