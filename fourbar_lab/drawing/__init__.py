# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Tables and drawings of a linkage, its curves and recorded runs; the collineation axis.

>>> from fourbar_ros import FourBar
>>> from fourbar_lab.drawing import collineation_axis
>>> linkage = FourBar(2.0, 6.0, 7.0, 5.0)
>>> f'{collineation_axis(linkage, linkage.motion(1.0)).angle:.6f} rad'
'-0.047195 rad'
"""
from __future__ import annotations

from typing import TYPE_CHECKING

from fourbar_ros.optional import lazily

if TYPE_CHECKING:
    from fourbar_lab.drawing.collineation import collineation_axis, CollineationAxis

__getattr__, __dir__, __all__ = lazily(__name__)
