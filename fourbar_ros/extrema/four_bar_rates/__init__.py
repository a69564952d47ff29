# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Rate and acceleration of the output of a 4R at constant input rate."""
