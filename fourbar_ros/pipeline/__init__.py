# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Samples one by one, without ROS: shared by the node and the recomputation of bags."""
