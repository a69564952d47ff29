# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Several mechanisms of one robot in one process, as relays on joint_states.

``ros2 launch fourbar_ros robot.launch.py file:=arm nodes:=boom,stick``; ``--show-args`` lists what
can be given.
"""
from pathlib import Path

from ament_index_python.packages import get_package_share_directory
from fourbar_ros.scene import find
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

ROBOTS = Path(get_package_share_directory('fourbar_ros')) / 'config' / 'robots'


def process(context):
    """Return the process with all nodes."""
    given = {name: LaunchConfiguration(name).perform(context)
             for name in ('file', 'nodes', 'namespace', 'joint_states', 'use_sim_time',
                          'log_level')}
    # Without a name of its own: a name would rename every node in the process.
    return [Node(
        package='fourbar_ros', executable='fourbar_node', output='screen',
        namespace=given['namespace'],
        remappings=[('~/input_joint_states', given['joint_states']),
                    ('joint_states', given['joint_states'])],
        arguments=[*given['nodes'].replace(',', ' ').split(), '--ros-args',
                   '--params-file', str(find(given['file'], ROBOTS)),
                   '-p', f'use_sim_time:={given["use_sim_time"]}',
                   '--log-level', given['log_level']])]


def generate_launch_description():
    """Return what is launched."""
    names = ', '.join(sorted(file.stem for file in ROBOTS.glob('*.yaml')))
    return LaunchDescription([
        DeclareLaunchArgument('file', description='parameter file with a section for each node, '
                                                  f'or {names}'),
        DeclareLaunchArgument('nodes', description='names of the nodes, as boom,stick'),
        DeclareLaunchArgument('namespace', default_value='',
                              description='namespace of the nodes and their topics'),
        DeclareLaunchArgument('joint_states', default_value='joint_states',
                              description='topic of the driven joints and of the answers'),
        DeclareLaunchArgument('use_sim_time', default_value='false', choices=['true', 'false'],
                              description='follow /clock'),
        DeclareLaunchArgument('log_level', default_value='info',
                              choices=['debug', 'info', 'warn', 'error', 'fatal'],
                              description='least severity that is logged'),
        OpaqueFunction(function=process),
    ])
