# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Beside the node: studies of many designs, balancing, a live page, two documents reproduced.

It imports :mod:`fourbar_ros`, never the other way round: a robot needs none of it.
"""
