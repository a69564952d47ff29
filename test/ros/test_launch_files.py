# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The launch files start what they say; machines split over their nodes move as whole ones.

Real nodes, where launch itself is no wheel: stand-ins record what the file in Python asks of
launch; the others are read as YAML.
"""
import os
from pathlib import Path
import runpy
import subprocess
import sys
from types import ModuleType, SimpleNamespace

from builtin_interfaces.msg import Time
from fourbar_msgs.msg import Motion
from fourbar_ros.scene.files import read_values
from fourbar_ros.scene.scene import load
import pytest
from rcl_interfaces.srv import GetParameters
from support import ROOT
from support.harness import PATIENCE
from support.power import power
import yaml

EXAMPLES = ROOT / 'examples' / 'nodes'
LAUNCHED = {
    'launch/fourbar.launch.py': ({'scene': 'motor', 'name': 'arm', 'namespace': '/left'},
                                 ['/left/arm']),
    'examples/nodes/watt.launch.yaml': ({}, ['/four_bar', '/dyad']),
    'examples/nodes/arm.launch.yaml': ({'namespace': '/right'}, ['/right/boom', '/right/stick'])}


class Configuration:
    """An argument of a launch file, by name."""

    def __init__(self, name):
        self.name = name

    def perform(self, context):
        """Return its value."""
        return context[self.name]


def stand_ins():
    """Return {name: module} with what the launch file imports."""
    def record(**fields):
        return SimpleNamespace(**fields)
    names = {
        'launch': {'LaunchDescription': lambda entities: entities},
        'launch.actions': {
            'DeclareLaunchArgument': lambda name, **more: record(name=name, **more),
            'OpaqueFunction': lambda function: record(function=function)},
        'launch.substitutions': {'LaunchConfiguration': Configuration},
        'launch_ros': {}, 'launch_ros.actions': {'Node': record},
        'launch_ros.parameter_descriptions': {
            'ParameterValue': lambda value, value_type: value}}
    modules = {}
    for name, members in names.items():
        modules[name] = ModuleType(name)
        modules[name].__dict__.update(members)
    return modules


def of_python(file, given):
    """Return the command lines of a launch file in Python, as launch_ros makes them."""
    described = runpy.run_path(str(file))['generate_launch_description']()
    context = {one.name: one.default_value for one in described if hasattr(one, 'name')} | given
    started, = (one.function(context) for one in described if hasattr(one, 'function'))

    def text(value):
        return value.perform(context) if isinstance(value, Configuration) else value
    for node in started:
        *files, others = node.parameters
        assert node.respawn == (given.get('respawn') == 'true')
        yield [*map(text, node.arguments), '--ros-args', '-r', f'__ns:={text(node.namespace)}',
               '-r', f'__node:={text(node.name)}',
               *(word for file in files for word in ('--params-file', str(file))),
               *(part for name, value in others.items() for part in ('-p',
                                                                     f'{name}:={text(value)}'))]


def nodes_of(file):
    """Return the nodes of a launch file in YAML."""
    return [entry['node'] for entry in yaml.safe_load(file.read_text())['launch']
            if 'node' in entry]


def of_yaml(file, given):
    """Return the command lines of a launch file in YAML."""
    for node in nodes_of(file):
        rules = [f'{rule["from"]}:={rule["to"]}' for rule in node['remap']]
        rules += [f'__ns:={given["namespace"]}'] if given else []
        rules += [f'__node:={node["name"]}'] if 'name' in node else []
        parameters, = node['param']
        yield [*node.get('args', '').split(), '--ros-args',
               *(part for rule in rules for part in ('-r', rule)), '--params-file',
               parameters['from'].replace('$(dirname)', str(file.parent))]


def test_further_parameter_files_replace_what_the_scene_gives(client, monkeypatch, tmp_path):
    for module, made in stand_ins().items():
        monkeypatch.setitem(sys.modules, module, made)
    for name, value in ('first', 2.0), ('second', 3.0):
        (tmp_path / f'{name}.yaml').write_text(
            f'/**: {{ros__parameters: {{drive: {{speed: {value}}}}}}}')
    command, = of_python(ROOT / 'launch/fourbar.launch.py', {
        'params_file': f'{tmp_path}/first.yaml,{tmp_path}/second.yaml', 'respawn': 'true',
        'namespace': '/'})
    process = subprocess.Popen([sys.executable, '-m', 'fourbar_ros.ros.node.start', *command],
                               cwd=tmp_path)
    try:
        (speed,) = client.ask(GetParameters, names=['drive.speed']).values
        assert speed.double_value == 3.0
    finally:
        process.terminate()
        assert process.wait(PATIENCE) == 0


@pytest.mark.parametrize('name', LAUNCHED)
def test_it_starts_its_nodes(name, client, monkeypatch, tmp_path):
    for module, made in stand_ins().items():
        monkeypatch.setitem(sys.modules, module, made)
    given, wanted = LAUNCHED[name]
    commands = (of_yaml if name.endswith('yaml') else of_python)(ROOT / name, given)
    log = Path(tmp_path / 'log')
    with log.open('w') as out:
        running = [subprocess.Popen([sys.executable, '-m', 'fourbar_ros.ros.node.start', *command],
                                    cwd=tmp_path, env=os.environ, stdout=out,
                                    stderr=subprocess.STDOUT) for command in commands]
    try:
        client.until(lambda: {f'{space.rstrip("/")}/{node}' for node, space in
                              client.node.get_node_names_and_namespaces()} >= set(wanted)
                     or any(process.poll() is not None for process in running), 'the nodes')
        for node in wanted:
            assert client.call('evaluate', node=node.lstrip('/'), position=1.5).result == 0
    finally:
        for process in running:
            process.terminate()
        codes = [process.wait(PATIENCE) for process in running]
    assert set(codes) == {0}, log.read_text()


MACHINES = 'watt', 'quick_return'
INPUTS = [(0.4, 2.0, 1.0), (2.9, -3.0, 5.0), (-1.2, 4.0, 0.0)]


@pytest.fixture(params=MACHINES)
def chain(request, run_node, client):
    """Return (machine, inboxes of the first node's loads and of the last one's output, send)."""
    machine = request.param
    nodes = nodes_of(EXAMPLES / f'{machine}.launch.yaml')
    for node in nodes:
        values = read_values(f'{EXAMPLES / machine}.yaml:{node["name"]}')
        run_node(values | {'drive.source': 'motion', 'external.timeout': 0.0}, name=node['name'],
                 remaps=[f'{rule["from"]}:={rule["to"]}' for rule in node['remap']])
    first, last = nodes[0]['name'], nodes[-1]['name']
    client.listen(['loads'], node=first)
    client.listen(['output'], node=last)
    publisher = client.publisher(node=first)
    return machine, client.received, publisher.publish


def newest(messages, stamp):
    return [message for message in messages if message.header.stamp.sec == stamp]


def test_a_split_machine_is_the_whole_one(chain, client):
    machine, received, publish = chain
    whole = load(machine).linkage
    coordinate = whole.outputs[0].coordinate
    for stamp, given in enumerate(INPUTS, 1):
        message = Motion(position=given[0], velocity=given[1], acceleration=given[2])
        message.header.stamp = Time(sec=stamp)
        motion, loads = whole.step(*given)
        bound = 1e-12 * max(1.0, motion.condition)
        allowed = bound * power(whole, *given)[1] / abs(given[1])

        def settled(stamp=stamp, message=message, loads=loads, allowed=allowed):
            """Send a pose until the wrench that it causes acts, a step later at the earliest."""
            publish(message)
            client.executor.spin_once(timeout_sec=0.05)
            return newest(received['output'], stamp) and any(
                abs(m.driving_torque - loads.driving_torque) <= allowed
                for m in newest(received['loads'], stamp))
        client.until(settled, 'the torque of the whole machine')
        output = newest(received['output'], stamp)[-1]
        for field, name in zip(('position', 'velocity', 'acceleration'), coordinate):
            want = getattr(motion, name)
            assert abs(getattr(output, field) - want) <= bound * max(1.0, abs(want))
