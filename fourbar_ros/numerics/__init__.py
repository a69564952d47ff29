# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Numbers, roots and enclosures; nothing here knows a mechanism."""
