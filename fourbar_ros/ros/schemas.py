# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Definitions and type hashes of messages, from the packages that define them."""
from __future__ import annotations

import json
from pathlib import Path

from ament_index_python.packages import get_package_share_directory
from fourbar_ros.bag.cdr import types_in
from fourbar_ros.bag.rosbag2 import Channel
from fourbar_ros.scene.topics import INPUT_DEPTH, INPUTS, QUEUE_DEPTH, Topic, TORQUE, WRENCH


def channel(topic: Topic, name: str) -> Channel:
    """Return the bag's Channel of a :class:`.Topic` under its resolved name."""
    is_input = topic in (*INPUTS.values(), TORQUE) or topic.name.startswith(WRENCH)
    depth = 1 if topic.latched else INPUT_DEPTH if is_input else QUEUE_DEPTH
    return Channel(name, topic.type, definition(topic.type), type_hash(topic.type), depth,
                   topic.latched)


def type_hash(type_name: str) -> str:
    """Return the RIHS01 hash of 'package/msg/Name'."""
    hashes = json.loads(_share(type_name, 'json').read_text(encoding='utf-8'))['type_hashes']
    found: str = next(item['hash_string'] for item in hashes if item['type_name'] == type_name)
    return found


def definition(type_name: str) -> str:
    """Return the definition followed by those of all messages in it, as bags hold them."""
    text = _share(type_name, 'msg').read_text(encoding='utf-8')
    parts, done, todo = [text], {type_name}, types_in(type_name, text)
    while todo:
        name = todo.pop(0)
        if name in done:
            continue
        done.add(name)
        text = _share(name, 'msg').read_text(encoding='utf-8')
        package, _, short = name.split('/')
        parts.append(f'{"=" * 80}\nMSG: {package}/{short}\n{text}')
        todo += types_in(name, text)
    return '\n'.join(parts)


def _share(type_name: str, suffix: str) -> Path:
    package, kind, name = type_name.split('/')
    return Path(get_package_share_directory(package)) / kind / f'{name}.{suffix}'
