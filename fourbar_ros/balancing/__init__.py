# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Balancing: counterweights that take shaking force, moment, torque or reactions away."""
from __future__ import annotations

from fourbar_ros.errors import FourBarError


class BalanceError(FourBarError, ValueError):
    """A mechanism cannot be balanced as asked; the message gives the reason."""
