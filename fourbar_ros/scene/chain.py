# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Topics that connect the nodes of a chain: each drives the next, and is loaded by it.

Imports no ROS: the launch file and the tests make the same chain of it.
"""
from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from fourbar_ros.errors import InvalidParameter
from fourbar_ros.scene.scene import load, Scene
from fourbar_ros.scene.topics import INPUTS, OUTPUTS, wrench_topic

MOTION, OUTPUT, LOAD = INPUTS['motion'], OUTPUTS['output'], OUTPUTS['drive_wrench']
Rules = list[tuple[str, str]]


def remappings(file: str | Path, names: Sequence[str]) -> dict[str, Rules]:
    """
    Return {node: its remappings (from, to)} of a chain, nodes of one file in their order.

    The output of each node is the input of the next. The drive wrench of the next acts as external
    wrench on the node before, on its link with ``from_topic`` true. Names are relative, so that
    the chain can be in any namespace.

    Raises InvalidParameter, which names the node, for a scene that cannot be part of a chain.
    Raises FourBarError for a scene that cannot be read.
    """
    scenes = [load(f'{file}:{name}') for name in names]
    rules: dict[str, Rules] = {name: [] for name in names}
    for (name, scene), (next_name, next_scene) in zip(zip(names, scenes),
                                                      zip(names[1:], scenes[1:])):
        _check(name, scene, next_name, next_scene)
        rules[next_name].append((MOTION.topic, OUTPUT.topic.replace('~', name)))
        rules[name] += [(wrench_topic(link).topic, LOAD.topic.replace('~', next_name))
                        for link in scene.wrenches.links]
    return rules


def _check(name: str, scene: Scene, next_name: str, next_scene: Scene) -> None:
    """Refuse two scenes if the first cannot drive the second, or be loaded by it."""
    links = tuple(scene.wrenches.links)
    if OUTPUT.name not in scene.outputs:
        raise InvalidParameter(f'{name}: outputs', list(scene.outputs),
                               f'must contain {OUTPUT.name}, which drives {next_name}')
    if next_scene.drive.source != MOTION.name:
        raise InvalidParameter(f'{next_name}: drive.source', next_scene.drive.source,
                               f'must be {MOTION.name}, to be driven by {name}')
    if len(links) > 1:
        raise InvalidParameter(f'{name}: external', list(links),
                               f'from_topic must be true of one link, the one that {next_name} '
                               'loads')
    if links and LOAD.name not in next_scene.outputs:
        raise InvalidParameter(f'{next_name}: outputs', list(next_scene.outputs),
                               f'must contain {LOAD.name}, which loads {name}')
