# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Which scene a bag was made with, and which topic is which output.

Bags of our recorder name it in their metadata; in bags of rosbag2 the topics are searched.
"""
from __future__ import annotations

from collections.abc import Mapping
import json
from pathlib import Path
from typing import NamedTuple

from fourbar_ros.bag import rosbag2
from fourbar_ros.bag.read.reader import Bag
from fourbar_ros.errors import BagError, FourBarError
from fourbar_ros.scene.scene import from_values, Scene
from fourbar_ros.scene.topics import DRIVEN, INPUTS, SCENE

SCENE_TYPE = SCENE.type


class Origin(NamedTuple):
    """
    Where a bag comes from.

    Attributes
    ----------
    scene : Scene
        What was run at its start.
    topics : dict
        {short name of an input or output: topic in the bag}.
    node : str
        Full name of the node.
    in_order : bool
        Our recorder keeps the order in which things happened; others note messages as they come
        in.

    """

    scene: Scene
    topics: dict[str, str]
    node: str
    in_order: bool


def origin_of(path: str | Path | Bag, node: str | None = None) -> Origin:
    """
    Return the Origin of a bag: from its metadata, or, of a bag of ``ros2 bag``, from its topics.

    Parameters
    ----------
    path : str, Path or Bag
    node : str, optional
        Which one, if a bag of ``ros2 bag record`` has several.

    Raises
    ------
    BagError
        The bag holds no scene, or several.

    """
    bag = path if isinstance(path, Bag) else Bag(path)
    about = bag.about()
    try:
        topics = json.loads(about['topics'])
        is_ours = isinstance(topics, dict) and DRIVEN.name in topics and 'scene' in about
    except (KeyError, TypeError, ValueError, RecursionError):
        is_ours = False
    if is_ours:
        scene = about['scene']
        # a later part of a split bag: it may have changed since
        if rosbag2.REPEATS in about:
            scene = next((record.message.data for record in bag.records([topics.get('scene')])),
                         scene)
        return Origin(_scene(bag, scene), topics, about.get('node', '/fourbar'), True)
    return _from_topics(bag, node)


def scene_of(path: str | Path | Bag, node: str | None = None) -> tuple[Scene, dict[str, str]]:
    """Return (Scene, topics) of a bag: what was run at its start, and {output name: topic}."""
    origin = origin_of(path, node)
    return origin.scene, origin.topics


def _from_topics(bag: Bag, wanted: str | None) -> Origin:
    types = topic_types(bag)
    nodes = sorted(topic.removesuffix('/scene') for topic, type_name in types.items()
                   if type_name == SCENE_TYPE
                   and topic.endswith('/scene')
                   and f'{topic.removesuffix("/scene")}/driven' in types)
    if wanted:
        nodes = [node for node in nodes if node == wanted]
    if not nodes:
        raise BagError(f'{bag.path}: holds no run of {wanted or "a fourbar_node"}: no scene in '
                       'its metadata, no topics ~/scene and ~/driven')
    if len(nodes) > 1:
        raise BagError(f'{bag.path}: holds runs of {", ".join(nodes)}; say which with --node')
    node = nodes[0]
    first = next(bag.records([f'{node}/scene']), None)
    if first is None:
        raise BagError(f'{bag.path}: has no message on {node}/scene')
    scene = _scene(bag, first.message.data)
    return Origin(scene, _resolved(scene, node, types), node, False)


def topic_types(bag: Bag) -> dict[str, str]:
    """Return {topic: type} of all topics of a bag."""
    found: dict[str, str] = {}
    for part in bag.parts:
        summary = part.summary()
        if summary and summary.channels:
            names = {number: schema.name for number, schema in summary.schemas.items()}
            found |= {channel.topic: names.get(channel.schema_id, '')
                      for channel in summary.channels.values()}
        else:
            for _ in part.chunks():
                pass
            found |= {channel.topic: part.type_of(channel.topic)
                      for channel in part.channels.values()}
    return found


def _resolved(scene: Scene, node: str, types: Mapping[str, str]) -> dict[str, str]:
    """
    Return {name: topic} by the rules of ROS.

    One that was remapped is found if it is the only one of its type.
    """
    namespace = node.rpartition('/')[0]
    wanted = {topic.name: topic for topic in (DRIVEN, SCENE, *scene.topics.values(),
                                              *scene.wrench_topics, *scene.drive_topics,
                                              *INPUTS.values())}
    topics = {}
    for name, topic in wanted.items():
        full = (topic.topic.replace('~', node, 1) if topic.topic.startswith('~')
                else f'{namespace}/{topic.topic}')
        same = [there for there, type_name in types.items() if type_name == topic.type]
        if full in types:
            topics[name] = full
        elif len(same) == 1 and name == 'joint_states':
            topics[name] = same[0]
    return topics


def _scene(bag: Bag, text: str) -> Scene:
    try:
        values = json.loads(text)
        return from_values(values)
    except (ValueError, TypeError, AttributeError, RecursionError, FourBarError) as error:
        raise BagError(f'{bag.path}: its scene cannot be read: {error}') from None
