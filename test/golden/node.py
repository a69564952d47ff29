# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Parts of the golden file that need ROS: what a running node shows to others, and messages."""
import json
from pathlib import Path
import re
import tempfile
import time

from ament_index_python.packages import get_package_share_directory
from fourbar_ros.scene import read_values
from rcl_interfaces.srv import DescribeParameters, GetParameters, ListParameters
from rclpy.action import get_action_server_names_and_types_by_node
from rclpy.node import NodeNameNonExistentError
from rclpy.parameter import parameter_value_to_python
from support import ROOT
from support.harness import Client, NodeProcess

NODE = 'fourbar'


class Messages:
    """Fields and constants of all messages, services and actions, in order, and their hashes."""

    @staticmethod
    def files():
        """Return {pkg/msg/NAME: file}."""
        share = Path(get_package_share_directory('fourbar_msgs'))
        return {f'fourbar_msgs/{kind}/{path.stem}': path for kind in ('msg', 'srv', 'action')
                for path in sorted((share / kind).glob(f'*.{kind}'))}

    def cases(self):
        """Return their names."""
        return list(self.files())

    def columns(self, key):
        """Return the hash, and the lines of the definition without comments."""
        file = self.files()[key]
        lines = [' '.join(line.partition('#')[0].split()) if '"' not in line else line.strip()
                 for line in file.read_text(encoding='utf-8').splitlines()]
        hashes = json.loads(file.with_suffix('.json').read_text())['type_hashes']
        own = [one['hash_string'] for one in hashes if one['type_name'] == key]
        return {'hash': own, 'lines': list(filter(None, lines))}


class Running:
    """Names, types, QoS and hashes of all topics, services and parameters of a running node."""

    scenes = {'paper': {}, 'engine': {}, 'bucket': {}, 'watt': {},
              'cylinder': {'external.crank.from_topic': True, 'trajectories': True,
                           'points.tip.link': 'crank', 'points.tip.along': 2.0,
                           'outputs': ['state', 'output', 'joint_states', 'loads',
                                       'shaking_wrench', 'points', 'links', 'reactions', 'tf',
                                       'robot_description', 'markers', 'traces']}}

    def cases(self):
        """Return the names of the scenes."""
        return list(self.scenes)

    def columns(self, key, expected=None):
        """
        Return a column of texts for each topic, service and parameter.

        Discovery takes a while: ask until it is ``expected``, or has not changed for 3 s.
        """
        values = {name: value for name, value in
                  read_values(ROOT / 'config' / f'{key}.yaml').items()
                  if value == value} | self.scenes[key]
        with tempfile.TemporaryDirectory() as folder:
            process, client = NodeProcess(values, Path(folder)), Client()
            try:
                found = {**settled(lambda: graph(client.node), expected, client),
                         **parameters(client)}
            finally:
                client.close()
                process.stop()
        assert process.process.returncode == 0, process.said
        return found


def settled(ask, expected, client):
    """Return what ``ask`` finds once it is as expected, or has not changed for three seconds."""
    found, since = ask(), time.monotonic()
    end = since + (client.patience if expected is None else 30.0)
    while time.monotonic() < end:
        client.executor.spin_once(timeout_sec=0.05)
        now = ask()
        if now != found:
            found, since = now, time.monotonic()
        if expected is None:
            if found and time.monotonic() - since > 3.0:
                break
        elif all(expected.get(name) == column for name, column in found.items()) and all(
                name in found for name in expected if not name.startswith('parameter')):
            break
    return found


def graph(node):
    """Return topics with their endpoints, services and actions of the node."""
    found = {}
    try:
        topics = {
            'published': (node.get_publisher_names_and_types_by_node(NODE, '/'),
                          node.get_publishers_info_by_topic),
            'received': (node.get_subscriber_names_and_types_by_node(NODE, '/'),
                         node.get_subscriptions_info_by_topic)}
        services = node.get_service_names_and_types_by_node(NODE, '/')
    except NodeNameNonExistentError:
        return {}
    for how, (names, ask) in topics.items():
        for name, types in names:
            for one in ask(name):
                if one.node_name == NODE:
                    qos = one.qos_profile
                    found[f'{how} {name}'] = [
                        *types, str(one.topic_type_hash), qos.reliability.name,
                        qos.durability.name, qos.liveliness.name,
                        f'deadline {qos.deadline.nanoseconds}',
                        f'lifespan {qos.lifespan.nanoseconds}']
    actions = get_action_server_names_and_types_by_node(node, NODE, '/')
    for how, names in (('service', services), ('action', actions)):
        found |= {f'{how} {name}': types for name, types in names}
    return dict(sorted(found.items()))


def parameters(client):
    """Return {'parameter NAME': [type, value, unit and text, limits, live or not]}."""
    names = sorted(client.ask(ListParameters).result.names)
    described = client.ask(DescribeParameters, names=names)
    values = client.ask(GetParameters, names=names).values
    found = {}
    for value, one in zip(values, described.descriptors):
        shown = repr(parameter_value_to_python(value))
        limits = [f'{low.from_value!r} to {low.to_value!r} by {low.step!r}'
                  for low in (*one.floating_point_range, *one.integer_range)]
        found[f'parameter {one.name}'] = [
            one.type, one.description, one.additional_constraints, *limits,
            'read only' if one.read_only else 'live', re.sub(r'/tmp/\S+', 'FOLDER', shown)]
    return found


PARTS = {'messages': Messages(), 'node': Running()}
