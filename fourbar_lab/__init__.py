# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Beside the node, at a desk: drawing, generated code, studies, balancing, page, reproduction.

It imports :mod:`fourbar_ros`, never the other way round: a robot needs none of it. ``fourbar``
finds its verbs and tools by entry points.
"""
