# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Verbs of the ``fourbar`` command that a desk needs: an entry point for each in setup.py."""
