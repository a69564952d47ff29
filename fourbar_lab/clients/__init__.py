# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Programs that talk to a running node: a client, the demonstration."""
