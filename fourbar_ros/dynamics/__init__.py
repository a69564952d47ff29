# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Motion that follows from torque: the equation of motion, drives, statics, integration."""
