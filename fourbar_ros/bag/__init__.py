# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Record runs to bags; read, repair, recompute, export, plot, replay them; no ROS needed.

>>> from fourbar_ros.bag import Bag, info, recompute
>>> info('bags/run').topics[0].topic
'/fourbar/input'
>>> max(found.largest for found in recompute('bags/run'))           # 0: every output is the same
0.0
"""
from __future__ import annotations

from typing import TYPE_CHECKING

from fourbar_ros.errors import BagError
from fourbar_ros.optional import lazily

if TYPE_CHECKING:
    from fourbar_ros.bag.comparison.diff import diff, TopicDiff
    from fourbar_ros.bag.comparison.difference import Difference, Recomputed
    from fourbar_ros.bag.comparison.recompute import compare, recompute
    from fourbar_ros.bag.exports.export import export
    from fourbar_ros.bag.exports.plot import plot, series
    from fourbar_ros.bag.read.info import Info, info
    from fourbar_ros.bag.read.playback import play
    from fourbar_ros.bag.read.reader import Bag, records
    from fourbar_ros.bag.repair import recover, Recovered
    from fourbar_ros.bag.write.parts import Split
    from fourbar_ros.bag.write.recorder import BagWriter

__all__ = [
    'Bag', 'BagError', 'BagWriter', 'Difference', 'Info', 'Recomputed', 'Recovered', 'Split',
    'TopicDiff', 'compare', 'diff', 'export', 'info', 'play', 'plot', 'recompute', 'records',
    'recover', 'series',
]

__getattr__, __dir__ = lazily(__name__, {
    'fourbar_ros.bag.comparison.diff': 'diff, TopicDiff',
    'fourbar_ros.bag.comparison.difference': 'Difference, Recomputed',
    'fourbar_ros.bag.comparison.recompute': 'compare, recompute',
    'fourbar_ros.bag.exports.export': 'export',
    'fourbar_ros.bag.exports.plot': 'plot, series',
    'fourbar_ros.bag.read.info': 'Info, info',
    'fourbar_ros.bag.read.playback': 'play',
    'fourbar_ros.bag.read.reader': 'Bag, records',
    'fourbar_ros.bag.repair': 'recover, Recovered',
    'fourbar_ros.bag.write.parts': 'Split',
    'fourbar_ros.bag.write.recorder': 'BagWriter',
})
