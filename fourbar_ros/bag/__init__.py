# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Bags in the layout of rosbag2: written, read, repaired, recomputed; no ROS needed.

Downward: container and scan (the MCAP file), rosbag2 (what lies around it), cdr (bytes to
numbers), reader and writer, then what is done with a bag: recover, recompute, export, diff, plot,
replay.
"""
from fourbar_ros.errors import FourBarError


class BagError(FourBarError):
    """A bag cannot be written or read; the message says which and why."""
