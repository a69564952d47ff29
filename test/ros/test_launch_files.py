# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Every launch file starts what it says, with real nodes, where launch itself is no wheel.

Stand-ins record what a file asks of launch; the nodes start as launch_ros would start them.
``test_launch.py`` does the same with launch where it is.
"""
import os
from pathlib import Path
import runpy
import subprocess
import sys
from types import ModuleType, SimpleNamespace

import pytest
from support import ROOT
from support.harness import PATIENCE

LAUNCHED = {
    'fourbar': ({'scene': 'motor', 'name': 'arm', 'namespace': '/left'}, ['/left/arm']),
    'chain': ({'file': 'watt'}, ['/four_bar', '/dyad']),
    'robot': ({'file': 'arm', 'nodes': 'boom,stick', 'namespace': '/right'},
              ['/right/boom', '/right/stick'])}


class Configuration:
    """An argument of a launch file, by name."""

    def __init__(self, name):
        self.name = name

    def perform(self, context):
        """Return its value."""
        return context[self.name]


def stand_ins():
    """Return {name: module} with what the launch files import."""
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


def command_of(node, context):
    """Return the command line of a node as launch_ros makes it."""
    def text(value):
        return value.perform(context) if isinstance(value, Configuration) else value
    rules = [f'__ns:={text(node.namespace)}'] if text(node.namespace) else []
    rules += [f'__node:={text(node.name)}'] if hasattr(node, 'name') else []
    rules += [':='.join(rule) for rule in getattr(node, 'remappings', ())]
    given = []
    for one in getattr(node, 'parameters', ()):
        given += (['--params-file', one] if isinstance(one, str) else
                  [part for name, value in one.items()
                   for part in ('-p', f'{name}:={text(value)}')])
    assert (node.package, node.executable) == ('fourbar_ros', 'fourbar_node')
    return [sys.executable, '-m', 'fourbar_ros.ros.node.start', *map(text, node.arguments),
            '--ros-args', *(part for rule in rules for part in ('-r', rule)), *given]


@pytest.mark.parametrize('name', LAUNCHED)
def test_it_starts_its_nodes(name, client, monkeypatch, tmp_path):
    for module, made in stand_ins().items():
        monkeypatch.setitem(sys.modules, module, made)
    given, wanted = LAUNCHED[name]
    described = runpy.run_path(str(ROOT / 'launch' / f'{name}.launch.py'))[
        'generate_launch_description']()
    declared = {one.name: getattr(one, 'default_value', None) for one in described
                if hasattr(one, 'name')}
    context = {**declared, **given}
    assert set(given) <= set(declared) and None not in context.values()
    log = Path(tmp_path / 'log')
    with log.open('w') as out:
        running = [subprocess.Popen(command_of(node, context), cwd=tmp_path, env=os.environ,
                                    stdout=out, stderr=subprocess.STDOUT)
                   for one in described if hasattr(one, 'function')
                   for node in one.function(context)]
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
