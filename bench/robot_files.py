# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Files of public robots: their loops beside MuJoCo, or why they are refused."""
from pathlib import Path
import shlex
from typing import NamedTuple

from fourbar_ros.cli import import_robot
from fourbar_ros.cli.main import parser
from fourbar_ros.importing.files import import_file
from fourbar_ros.importing.robots import Refused

from .pages import table

KNUCKLE = 'robotiq_85_left_inner_knuckle_link@0.0371575/0/0.04342168'
TIP = 'robotiq_85_left_finger_tip_link@-0.01790114/0/0.00651548'
SHINS = 'lower_leg_front_rightR_link@0/0.005/0.2,lower_leg_front_rightL_link@0/0.01/0.2'


class RobotFile(NamedTuple):
    """A file of a folder, the path where it is public, and the options that it needs."""

    name: str
    source: str
    options: str = ''


GEPETTO = 'Gepetto/example-parallel-robots: robots/{}/robot.urdf'
FILES = (
    RobotFile('xarm_hand.xml', 'google-deepmind/mujoco_menagerie: ufactory_xarm7/hand.xml'),
    RobotFile('panda2f85.xml', 'google-deepmind/mujoco_playground: '
              'mujoco_playground/_src/manipulation/franka_emika_panda_robotiq/xmls/'
              'panda_updated_robotiq_2f85.xml'),
    RobotFile('2f85.xml', 'google-deepmind/mujoco_menagerie: robotiq_2f85/2f85.xml'),
    RobotFile('2f85.xml', '', '--lock right_coupler_joint --lock left_coupler_joint'),
    RobotFile('cassie.xml', 'osudrl/cassie-mujoco-sim: model/cassie.xml',
              '--at left-foot-crank=-1.5244rad --at left-plantar-rod=1.5244rad '
              '--at left-foot=-1.5968rad'),
    RobotFile('cassie.xml', '', '--loop left-knee --lock left-shin --lock left-heel-spring'),
    RobotFile('toddlerbot.xml', 'hshi74/toddlerbot: '
              'toddlerbot/descriptions/toddlerbot/toddlerbot.xml'),
    RobotFile('toddlerbot.xml', 'the same file',
              '--cut neck_rod_2~bearing_683_2 --cut knee_rod_2~bearing_683_4 '
              '--cut knee_rod_4~bearing_683_6'),
    RobotFile('planar-2dof.xml', 'Rhoban/onshape-to-robot-examples: planar-2dof/robot.xml',
              '--lock motor2'),
    RobotFile('gz_split.urdf', 'osrf/gazebo_tutorials: '
              'kinematic_loop/four_bar_split_fixed_urdf/model.urdf', '--drive joint_A'),
    RobotFile('2bt.urdf', 'by xacro from 2b-t/closed_loop: urdf/closed_loop.urdf.xacro',
              '--drive 2_to_1'),
    RobotFile('5bar_linkage.urdf', GEPETTO.format('5bar_linkage'),
              '--close sphere,sphere_2 --drive mot1 --lock mot2 --lock closedloop1_A '
              '--lock closedloop1_B'),
    RobotFile('minitaur.urdf', 'bulletphysics/bullet3: data/quadruped/minitaur.urdf',
              f'--close {SHINS} --lock motor_front_rightL_joint --drive motor_front_rightR_joint '
              '--at motor_front_rightR_joint=90 --at motor_front_rightL_joint=90 '
              '--at knee_front_rightR_link=-2.1834rad --at knee_front_rightL_link=-2.1834rad'),
    RobotFile('picknik_2f85.urdf', 'by xacro from PickNikRobotics/ros2_robotiq_gripper: '
              'robotiq_description/urdf/robotiq_2f_85_gripper.urdf.xacro'),
    RobotFile('picknik_2f85.urdf', '', f'--close {KNUCKLE},{TIP}'),
    RobotFile('robotiq_2f_85_gripper.urdf.xacro', 'before xacro'),
    RobotFile('slider_crank.xml', 'google-deepmind/mujoco: model/slider_crank/slider_crank.xml'),
    RobotFile('four_bar.sdf', 'RobotLocomotion/drake: examples/multibody/four_bar/four_bar.sdf'),
    RobotFile('gz_four_bar.sdf', 'osrf/gazebo_tutorials: kinematic_loop/four_bar_sdf/model.sdf'),
    RobotFile('orbita_mujoco.xml',
              'Rhoban/onshape-to-robot-examples: orbita_mujoco/robot.xml'),
    RobotFile('reachy_mini.xml', 'pollen-robotics/reachy_mini: '
              'src/reachy_mini/descriptions/reachy_mini/mjcf/reachy_mini.xml'),
    *(RobotFile(f'{name}.urdf', GEPETTO.format(name)) for name in (
        'talos_like', 'cassie_like', 'digit_like', 'wl16_like', 'kangaroo_like', 'disney_like')),
    RobotFile('digit_model.urdf', 'adubredu/DigitRobot.jl: urdf/digit_model.urdf'),
    RobotFile('boxes_fourbar.usda', 'newton-physics/newton: '
              'newton/examples/assets/boxes_fourbar.usda'))


def row_of(file, path):
    """Return the row of a file: its loops with their differences, and what was refused."""
    command = ['import', str(path), '--check', *shlex.split(file.options)]
    cells = [f'`{file.name}`, {file.source.split(":")[0]}'.removesuffix(', '),
             f'`{file.options}`' if file.options else '']
    try:
        result = import_file(path, import_robot.wishes_of(parser().parse_args(command)))
    except Refused as error:
        return [*cells, 0, '', '', str(error).replace(str(path), path.name)]
    refusals = [line.strip().removeprefix('refused: ') for line in result.report
                if line.startswith('  refused: ')]
    more = f', and {len(refusals) - 1} more' if refusals[1:] else ''
    drives = [check.drive for check in result.checks if check.drive is not None]
    return [*cells, len(result.loops),
            f'{max(check.joint for check in result.checks):.0e}' if result.checks else '',
            f'{max(drives):.0e}' if drives else '', ''.join(refusals[:1]) + more]


def main(folder=''):
    """Print the table of the files in a folder, ``--folder``: none is shipped."""
    paths = [(file, Path(folder) / file.name) for file in FILES]
    table(('file', 'options', 'loops', 'joints [rad]', 'drive [of its peak]', 'refused'),
          [row_of(file, path) for file, path in paths if folder and path.is_file()])
    missing = dict.fromkeys(f'{file.name} ({file.source})' for file, path in paths
                            if not folder or not path.is_file())
    if missing:
        print(f'Not in the folder (--folder): {"; ".join(missing)}\n')
    print('No file is shipped: fetch them into a folder under these names, from the paths in '
          'bench/robot_files.py; meshes are not needed. Differences are the largest of all loops '
          'over the range of their drives, beside the constraints of MuJoCo solved by Newton and '
          'its inverse dynamics. Minitaur: axes in its file are 0.006 degrees apart, and its leg '
          'passes flat poses.\n')
