# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The two source documents: printed values beside computed ones, and their equations.

>>> from fourbar_lab.reproduction import reproduce
>>> row = reproduce()[0].rows[1]
>>> row.what, row.printed, f'{row.ours:.6g}', row.verdict
('crank speed', '188.5', '188.496', 'agrees')
"""
from __future__ import annotations

from typing import TYPE_CHECKING

from fourbar_ros.optional import lazily

if TYPE_CHECKING:
    from fourbar_lab.reproduction.paper import reproduce

__getattr__, __dir__, __all__ = lazily(__name__)
