# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""What the shipped scenes give, recorded by one command and compared by a test."""
