# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Record runs to bags; read, repair, recompute, export, compare them; no ROS needed.

>>> from fourbar_ros.bag import Bag, info, recompute
>>> info('bags/run').topics[0].topic
'/fourbar/input'
>>> recompute('bags/run').largest           # 0: every output is the same
0.0
"""
from __future__ import annotations

from typing import TYPE_CHECKING

from fourbar_ros.optional import lazily

if TYPE_CHECKING:
    from fourbar_ros.bag.comparison import diff, TopicDiff
    from fourbar_ros.bag.metadata import Channel
    from fourbar_ros.bag.overview import Info, info
    from fourbar_ros.bag.reader import Bag, records
    from fourbar_ros.bag.recomputation import Difference, recompute, Recomputed
    from fourbar_ros.bag.recorder import BagWriter
    from fourbar_ros.bag.recovery import recover, Recovered
    from fourbar_ros.bag.tables import export
    from fourbar_ros.errors import BagError

__getattr__, __dir__, __all__ = lazily(__name__)
