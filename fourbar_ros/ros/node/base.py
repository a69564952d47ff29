# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The node as its parts see it that are made first: rclpy's, and what all parts share."""
from __future__ import annotations

from fourbar_ros.ros.node.quiet_log import QuietLog
from fourbar_ros.ros.node.steady import SteadyTimers
from fourbar_ros.ros.node.worker import Worker
from rclpy.node import Node


class Base(Node):
    """
    What the parts of a node may use of it.

    Attributes
    ----------
    failure : Exception or None
        A fault in any thread, which main raises.
    log : QuietLog
    steady_timers : SteadyTimers
    workers : dict
        {name: Worker}.

    """

    failure: Exception | None
    log: QuietLog
    steady_timers: SteadyTimers
    workers: dict[str, Worker]
