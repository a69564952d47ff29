# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Studies: many designs of one scene, drawn, computed on an executor, kept as Parquet."""
from __future__ import annotations

from fourbar_ros.errors import FourBarError


class StudyError(FourBarError, ValueError):
    """A study cannot be run, continued or read; the message gives the reason."""
