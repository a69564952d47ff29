# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Planar loops of a robot's file, MJCF or URDF, as scenes."""
