# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""A mechanism as a transmission: motion and effort of its output from those of its drive, back."""
