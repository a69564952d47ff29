# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Definitions and type hashes of messages, from the packages that define them."""
import json
from pathlib import Path
import re

from ament_index_python.packages import get_package_share_directory
from fourbar_ros.bag.metadata import Channel
from fourbar_ros.ros.messages import resolve
from fourbar_ros.scene import topics


def channel(topic: topics.Topic, name: str) -> Channel:
    """Return the channel of a topic in a bag: full name, type, definition, hash and QoS."""
    is_input = (topic in (*topics.INPUTS.values(), *topics.BASES.values(), topics.TORQUE)
                or topic.name.startswith(topics.WRENCH))
    depth = 1 if topic.latched else topics.INPUT_DEPTH if is_input else topics.QUEUE_DEPTH
    return Channel(name, topic.type, definition(topic.type), type_hash(topic.type), depth,
                   topic.latched)


def type_hash(type_name: str) -> str:
    """Return the RIHS01 hash (REP 2011) of the installed definition of a package/msg/Name."""
    hashes = json.loads(_installed_file(type_name, 'json'))['type_hashes']
    return str(next(item['hash_string'] for item in hashes if item['type_name'] == type_name))


def definition(type_name: str) -> str:
    """Return the .msg file of a type, followed by the files of all types that it contains."""
    text = _installed_file(type_name, 'msg')
    texts, done, todo = [text], {type_name}, types_in(type_name)
    while todo:
        name = todo.pop(0)
        if name in done:
            continue
        done.add(name)
        text = _installed_file(name, 'msg')
        package, _, short = name.split('/')
        # MCAP asks for this form
        texts.append(f'{"=" * 80}\nMSG: {package}/{short}\n{text}')
        todo += types_in(name)
    return '\n'.join(texts)


def types_in(type_name: str) -> list[str]:
    """Return the message types, ``package/msg/Name``, of the fields of a type."""
    return [f'{package}/msg/{name}'
            for field in resolve(type_name).get_fields_and_field_types().values()
            for package, name in re.findall(r'(\w+)/(\w+)', field)]


def _installed_file(type_name: str, suffix: str) -> str:
    package, kind, name = type_name.split('/')
    folder = Path(get_package_share_directory(package)) / kind
    return (folder / f'{name}.{suffix}').read_text(encoding='utf-8')
