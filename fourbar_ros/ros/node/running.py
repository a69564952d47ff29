# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The node as those see it that ask all its parts: parameters, services, diagnostics."""
from __future__ import annotations

from typing import TYPE_CHECKING

from fourbar_ros.ros.node.base import Base
from fourbar_ros.ros.node.drives import Drive
from fourbar_ros.ros.node.recording import Recording
from fourbar_ros.ros.node.stream import Stream

if TYPE_CHECKING:      # only some scenes have them
    from fourbar_ros.ros.node.trajectories import Trajectories
    from fourbar_ros.ros.node.wrenches import WrenchInputs


class Running(Base):
    """A node with all its parts; None for those that its scene does not need."""

    recording: Recording
    stream: Stream
    drive: Drive
    wrenches: WrenchInputs | None
    trajectories: Trajectories | None
