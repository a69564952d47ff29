"""Definitions and type hashes of messages, from the packages that define them."""
from __future__ import annotations

import json
import re
from pathlib import Path

from ament_index_python.packages import get_package_share_directory

from fourbar_ros.scene import topics as interfaces
from fourbar_ros.bag.rosbag2 import Channel

_BUILT_IN = {'bool', 'byte', 'char', 'float32', 'float64', 'int8', 'uint8', 'int16', 'uint16', 'int32',
             'uint32', 'int64', 'uint64', 'string', 'wstring'}
_FIELD = re.compile(r'^([A-Za-z][\w/]*)(?:<=\d+)?(?:\[[^\]]*\])?\s+\w')


def channel(topic, name):
    """Return the bag's Channel of a :class:`~fourbar_ros.scene.topics.Topic` under its resolved name."""
    is_input = topic in interfaces.INPUTS.values() or topic in interfaces.WRENCHES.values()
    depth = 1 if topic.latched else interfaces.INPUT_DEPTH if is_input else interfaces.QUEUE_DEPTH
    return Channel(name, topic.type, definition(topic.type), type_hash(topic.type), depth, topic.latched)


def type_hash(type_name):
    """Return the RIHS01 hash of 'package/msg/Name'."""
    hashes = json.loads(_share(type_name, 'json').read_text())['type_hashes']
    return next(item['hash_string'] for item in hashes if item['type_name'] == type_name)


def definition(type_name):
    """Return the definition followed by those of all messages in it, as bags hold them."""
    text = _share(type_name, 'msg').read_text()
    parts, done, todo = [text], {type_name}, _dependencies(type_name, text)
    while todo:
        name = todo.pop(0)
        if name in done:
            continue
        done.add(name)
        text = _share(name, 'msg').read_text()
        package, _, short = name.split('/')
        parts.append(f'{"=" * 80}\nMSG: {package}/{short}\n{text}')
        todo += _dependencies(name, text)
    return '\n'.join(parts)


def _dependencies(type_name, text):
    package = type_name.split('/')[0]
    found = []
    for line in text.splitlines():
        match = _FIELD.match(line.strip())
        if match and match[1] not in _BUILT_IN:
            *where, name = match[1].split('/')
            found.append(f'{where[0] if where else package}/msg/{name}')
    return found


def _share(type_name, suffix):
    package, kind, name = type_name.split('/')
    return Path(get_package_share_directory(package)) / kind / f'{name}.{suffix}'
