# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
A machine split over nodes, each a process: the output of each drives the next, which loads it.

``ros2 launch fourbar_ros chain.launch.py file:=quick_return nodes:=lever,ram``; ``--show-args``
lists what can be given.
"""
from pathlib import Path

from ament_index_python.packages import get_package_share_directory
from fourbar_ros.scene import find, remappings
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

CHAINS = Path(get_package_share_directory('fourbar_ros')) / 'config' / 'chains'


def nodes(context):
    """Return the nodes, each with its remappings."""
    given = {name: LaunchConfiguration(name).perform(context)
             for name in ('file', 'nodes', 'namespace', 'use_sim_time', 'log_level')}
    file, names = find(given['file'], CHAINS), given['nodes'].replace(',', ' ').split()
    return [Node(
        package='fourbar_ros', executable='fourbar_node', output='screen',
        name=name, namespace=given['namespace'], remappings=rules,
        arguments=['--ros-args', '--params-file', str(file),
                   '-p', f'use_sim_time:={given["use_sim_time"]}',
                   '--log-level', given['log_level']])
            for name, rules in remappings(file, names).items()]


def generate_launch_description():
    """Return what is launched."""
    names = ', '.join(sorted(file.stem for file in CHAINS.glob('*.yaml')))
    return LaunchDescription([
        DeclareLaunchArgument('file', default_value='watt',
                              description='parameter file with a section for each node, or '
                                          f'{names}'),
        DeclareLaunchArgument('nodes', default_value='four_bar,dyad',
                              description='names of the nodes from the driven one on'),
        DeclareLaunchArgument('namespace', default_value='',
                              description='namespace of the nodes and their topics'),
        DeclareLaunchArgument('use_sim_time', default_value='false', choices=['true', 'false'],
                              description='follow /clock'),
        DeclareLaunchArgument('log_level', default_value='info',
                              choices=['debug', 'info', 'warn', 'error', 'fatal'],
                              description='least severity that is logged'),
        OpaqueFunction(function=nodes),
    ])
