"""Start the node with a scene: ``ros2 launch fourbar_ros fourbar.launch.py scene:=FILE``."""
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.substitutions import FindPackageShare


def generate_launch_description():
    default = PathJoinSubstitution([FindPackageShare('fourbar_ros'), 'config', 'paper.yaml'])
    return LaunchDescription([
        DeclareLaunchArgument('scene', default_value=default, description='parameter file of the scene'),
        DeclareLaunchArgument('name', default_value='fourbar', description='name of the node'),
        Node(package='fourbar_ros', executable='fourbar_node', name=LaunchConfiguration('name'),
             parameters=[LaunchConfiguration('scene')], output='screen'),
    ])
