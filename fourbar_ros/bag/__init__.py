# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Record runs to bags; read, repair, recompute, export, plot, replay them; no ROS needed.

The bytes are the subject of :mod:`fourbar_ros.formats`; here are reader and recorder, and then
what is done with a bag: info, recover, recompute, export, diff, plot, playback.
"""
from fourbar_ros.errors import BagError

__all__ = ['BagError']
