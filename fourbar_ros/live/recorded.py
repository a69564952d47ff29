# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Recorded runs for a page: the scene of a bag and the motion of its input."""
from __future__ import annotations

from pathlib import Path

from fourbar_ros.bag.origin import origin_of
from fourbar_ros.bag.reader import Bag
from fourbar_ros.errors import FourBarError
from fourbar_ros.live.over_time import Run
from fourbar_ros.pipeline.message_fields import driven_of
from fourbar_ros.scene.scene import Scene
from fourbar_ros.scene.topics import DRIVEN
import numpy as np


class NoRun(FourBarError, ValueError):
    """A bag has no recorded motion to show."""


def read_run(path: str | Path, node: str | None = None) -> tuple[Scene, Run]:
    """
    Return the scene of a bag at its start, and the run.

    Raises
    ------
    BagError
        It cannot be read, or holds no scene.
    NoRun
        It holds no sample of the motion of the input.

    """
    bag = Bag(path)
    origin = origin_of(bag, node)
    topic = origin.topics.get(DRIVEN.name)
    stamps, states = [], []
    for block in bag.blocks(topics=[topic] if topic else []):
        for found in block:
            stamps.append(found.stamps)
            states.append(np.stack(driven_of(found.tree)))
    if not stamps:
        raise NoRun(f'{path}: no motion of the input in it ({DRIVEN.topic})')
    times = np.concatenate(stamps)
    order = np.argsort(times, kind='stable')
    return origin.scene, Run((times[order] - times[order[0]]) * 1e-9,
                             np.concatenate(states, axis=1)[:, order])
