# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Recompute every recorded output from the recorded driven motion and the scene, and compare.

Both are in the bag: the motion as messages, the scene as its first message and again after every
change. If the input as it came is in the bag, the driven motion is recomputed from it too.
"""
from __future__ import annotations

import json
from math import inf
from pathlib import Path

from fourbar_ros.bag.acting import UNSETTLED
from fourbar_ros.bag.comparison import Comparison
from fourbar_ros.bag.difference import Difference, distance, Recomputed
from fourbar_ros.bag.origin import origin_of, scene_of
from fourbar_ros.bag.reader import Bag
from fourbar_ros.bag.records import Progress, Record
from fourbar_ros.scene.scene import from_values

__all__ = ['Difference', 'Recomputed', 'compare', 'distance', 'recompute', 'scene_of']


def recompute(path: str | Path) -> list[Difference]:
    """Return the list of :class:`Difference` of a bag, by topic and field; see :func:`compare`."""
    return compare(path).differences


def compare(path: str | Path, progress: Progress | None = None, node: str | None = None
            ) -> Recomputed:
    """
    Return the :class:`Recomputed` of a bag.

    Each output is compared, with all its fields, with what the driven joint's motion of the same
    stamp gives: the last one before it in the bag, in bags of rosbag2 also one that comes later.
    Differences are absolute; NaN against NaN is none, NaN against a number infinite. Memory does
    not grow with the bag.

    Parameters
    ----------
    path : str or Path
    progress : callable, optional
        Called with the number of bytes read.
    node : str, optional
        Which node, if a bag of rosbag2 has several.

    """
    bag = Bag(path)
    origin = origin_of(bag, node)
    work = Comparison(origin, bag.about())
    # a change of the scene has a say in what came before it
    waiting = None
    for block in bag.blocks(topics=list(origin.topics.values()), apart=origin.topics.get('scene'),
                            progress=progress):
        scene = None
        if isinstance(block, Record):
            scene = from_values(json.loads(block.message.data))
            is_new = work.is_new(scene)
        if waiting:
            work.block(waiting, block.time - UNSETTLED if scene and is_new and not origin.in_order
                       else inf)
        waiting = None if scene else block
        if scene and is_new:
            work.change(scene, block.time)
    if waiting:
        work.block(waiting)
    return work.finished(bool(bag.cut))
