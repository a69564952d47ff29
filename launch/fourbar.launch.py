# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
Start the node with a scene: ``ros2 launch fourbar_ros fourbar.launch.py scene:=paper``.

``--show-args`` lists what can be given.
"""
from fourbar_ros.scene import find
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue


def node(context):
    """Return the node, its scene found."""
    further = LaunchConfiguration('params_file').perform(context)
    return [Node(
        package='fourbar_ros', executable='fourbar_node', output='screen',
        name=LaunchConfiguration('name'), namespace=LaunchConfiguration('namespace'),
        respawn=LaunchConfiguration('respawn').perform(context) == 'true', respawn_delay=1.0,
        parameters=[str(find(LaunchConfiguration('scene').perform(context))), *filter(
            None, further.split(',')), {
            'use_sim_time': ParameterValue(LaunchConfiguration('use_sim_time'), value_type=bool)}],
        arguments=['--ros-args', '--log-level', LaunchConfiguration('log_level')])]


def generate_launch_description():
    """Return what is launched."""
    return LaunchDescription([
        DeclareLaunchArgument('scene', default_value='paper',
                              description='a parameter file, or a name of fourbar list'),
        DeclareLaunchArgument('params_file', default_value='',
                              description='further parameter files, divided by commas: what they '
                                          'give replaces that of the scene'),
        DeclareLaunchArgument('name', default_value='fourbar', description='name of the node'),
        DeclareLaunchArgument('namespace', default_value='',
                              description='namespace of the node and its topics'),
        DeclareLaunchArgument('use_sim_time', default_value='false', choices=['true', 'false'],
                              description='follow /clock'),
        DeclareLaunchArgument('respawn', default_value='false', choices=['true', 'false'],
                              description='start the node again if it ends'),
        DeclareLaunchArgument('log_level', default_value='info',
                              choices=['debug', 'info', 'warn', 'error', 'fatal'],
                              description='least severity that is logged'),
        OpaqueFunction(function=node),
    ])
