# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""A scene as a description for other programs: URDF, SDF, MJCF."""
