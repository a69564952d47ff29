# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Tables and drawings of a linkage, its curves and recorded runs."""
