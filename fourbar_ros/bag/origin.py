# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Which scene a bag was made with, and which topic is which output.

Bags of our recorder have the scene in the metadata; in bags of rosbag2 the topics are searched.
"""
from collections.abc import Mapping
import json
from pathlib import Path
from typing import Any, NamedTuple

from fourbar_ros.bag import metadata, reader
from fourbar_ros.errors import BagError, FourBarError
from fourbar_ros.scene.parameters import member_of
from fourbar_ros.scene.scene import from_values, Scene
from fourbar_ros.scene.topics import DRIVEN, full_name, INPUTS, SCENE

GONE = ('recording.keep',)      # parameters of version 1 on which no value depends
MOST_TEXT = 2**24       # characters of a scene in a bag: 40 tables of forces of 10 000 inputs
MOST_NAMES = 1000       # of points, springs, forces, dyads, links in a scene; 100 dyads have 800


class Origin(NamedTuple):
    """The scene that was run at the start of a bag, and the full name of its node."""

    scene: Scene
    topics: dict[str, str]      # {short name of an input or output: topic in the bag}
    node: str
    in_order: bool              # as things happened; rosbag2 records messages as they come in
    is_later: bool              # the bag is a later file of a split bag, alone


def origin_of(path: str | Path | reader.Bag, node: str | None = None) -> Origin:
    """
    Return the Origin of a bag, from the metadata or, of a bag of ``ros2 bag``, from the topics.

    ``node``: its name, if the bag has several nodes. Raises BagError if the bag has no
    readable scene, not this node, or several nodes and ``node`` is None.
    """
    bag = path if isinstance(path, reader.Bag) else reader.Bag(path)
    about = bag.about
    try:
        topics = json.loads(about['topics'])
        is_ours = (isinstance(topics, dict) and DRIVEN.name in topics and 'scene' in about
                   and all(isinstance(topic, str) for topic in topics.values()))
    except (KeyError, TypeError, ValueError, RecursionError):
        is_ours = False
    if is_ours:
        scene = about['scene']
        # a later file of a split bag of version 1 begins with the scene in force, its metadata
        # hold that of the start
        if 'repeats' in about:
            scene = next((record.message.data for record in bag.records([topics.get('scene')])),
                         scene)
        name = about.get('node', '/fourbar')
        if node not in (None, name):
            raise BagError(f'{bag.path}: holds no run of {node}, but of {name}')
        return Origin(scene_of(bag, scene), topics, name, in_order=True,
                      is_later=metadata.number_of(bag.files[0]) > 0)
    types = bag.types
    nodes = sorted(topic.removesuffix('/scene') for topic, type_name in types.items()
                   if type_name == SCENE.type and topic.endswith('/scene')
                   and f'{topic.removesuffix("/scene")}/driven' in types)
    nodes = [name for name in nodes if node in ('', None, name)]
    if not nodes:
        raise BagError(f'{bag.path}: holds no run of {node or "a fourbar_node"}: no scene in '
                       'its metadata, no topics ~/scene and ~/driven')
    if len(nodes) > 1:
        raise BagError(f'{bag.path}: holds runs of {", ".join(nodes)}; say which with --node')
    first = next(bag.records([f'{nodes[0]}/scene']), None)
    if first is None:
        raise BagError(f'{bag.path}: has no message on {nodes[0]}/scene')
    run = scene_of(bag, first.message.data)
    return Origin(run, _resolved(run, nodes[0], types), nodes[0], in_order=False, is_later=False)


def _resolved(scene: Scene, node: str, types: Mapping[str, str]) -> dict[str, str]:
    """Return {short name: topic in the bag}; joint_states is known by its type if it is alone."""
    topics = {}
    for topic in (*scene.recorded, *INPUTS.values()):
        full = full_name(topic.topic, node)
        of_its_type = [name for name, type_name in types.items() if type_name == topic.type]
        if full in types:
            topics[topic.name] = full
        elif topic.name == 'joint_states' and len(of_its_type) == 1:
            topics[topic.name] = of_its_type[0]
    return topics


def bounded(text: str) -> dict[str, Any]:
    """Return the parameters of a scene as JSON; raises BagError for more than a bag may have."""
    # anybody may have made the bag: the scene must not fill the memory
    if len(text) > MOST_TEXT:
        raise BagError(f'a scene of {len(text)} characters: a bag may have {MOST_TEXT}')
    values: dict[str, Any] = json.loads(text)
    members = {member[:2] for member in map(member_of, values) if member}
    lists = [value for value in values.values() if isinstance(value, list)]
    names = len(members) + sum(isinstance(item, str) for value in lists for item in value)
    if names > MOST_NAMES:
        raise BagError(f'a scene with {names} names of points, forces, dyads, links, joints: '
                       f'a bag may have {MOST_NAMES}')
    return values


def scene_of(bag: reader.Bag, text: str) -> Scene:
    """Return the Scene of a JSON text in a bag; raises BagError if the text is not a scene."""
    try:
        values = bounded(text)
        for name in GONE:
            values.pop(name, None)
        return from_values(values)
    except (ValueError, TypeError, AttributeError, RecursionError, FourBarError) as error:
        raise BagError(f'{bag.path}: its scene cannot be read: {error}') from None
