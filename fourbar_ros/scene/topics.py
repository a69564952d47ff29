# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""
The single table of topics and services of the node: names, types, quality of service.

Names starting with ``~/`` are below the node's name; the others are relative to its namespace.
Imports no ROS.
"""
from collections.abc import Iterable, Mapping
from typing import NamedTuple

QUEUE_DEPTH = 10          # reliable, keep last: matches reliable and best-effort subscribers
INPUT_DEPTH = 100         # best effort matches every publisher; deep enough for a burst


class Topic(NamedTuple):
    """A topic: its short name, its name in ROS, message type, text for the manual."""

    name: str
    topic: str
    type: str
    text: str
    needs_loads: bool = False       # only for scenes with masses
    latched: bool = False           # late subscribers get the last message


class Service(NamedTuple):
    """A service; ``workers``: threads that answer what takes long, the second one proofs."""

    name: str
    service: str
    type: str
    text: str
    workers: tuple[str, ...] = ()


def full_name(name: str, node: str) -> str:
    """Return the full name of a topic or service: /left/boom/state, /left/joint_states."""
    node = f'/{node.strip("/")}'
    if name.startswith('~'):
        return name.replace('~', node, 1)
    return name if name.startswith('/') else f'{node.rpartition("/")[0]}/{name}'


INPUTS = {topic.name: topic for topic in (
    Topic('motion', '~/input', 'fourbar_msgs/msg/Motion',
          'motion of the driven joint; NaN rates and accelerations are estimated'),
    Topic('joint_state', '~/input_joint_states', 'sensor_msgs/msg/JointState',
          'joint states; the joint named by `drive.joint` is the driven one'),
)}

# With drive.source torque or motor: the torque on the input, and the state that follows from it.
TORQUE = Topic('torque', '~/torque', 'geometry_msgs/msg/WrenchStamped',
               'torque of the drive on the input: `torque.z` [N m], counter-clockwise positive; '
               'of a driven slide `force.x` [N] along the slide, where it grows')
DRIVE_STATE = Topic('drive_state', '~/drive_state', 'fourbar_msgs/msg/DriveState',
                    'state of drive and input after every step, torques, current, effort of the '
                    'integration')

# Motion of the base, with base.topic: as the node receives it, and as it is in effect.
BASES = {topic.name: topic for topic in (
    Topic('imu', '~/imu', 'sensor_msgs/msg/Imu',
          'specific force and rate of the base at O1, turned by `base.rotation`; the angular '
          'acceleration comes from the rates'),
    Topic('motion_of_base', '~/input_base', 'fourbar_msgs/msg/Base',
          'specific force, rate and angular acceleration of the base along the axes of the '
          'linkage'),
)}
BASE = Topic('base', '~/base', 'fourbar_msgs/msg/Base',
             'motion of the base in effect; NaN: unknown; latched, sent on every change',
             latched=True)

# External wrenches on links with external.LINK.from_topic. Short names: external_LINK for the
# topic that the node receives, applied_LINK for the wrench in effect.
WRENCH, ON_LINK = 'external_', 'applied_'


def wrench_topic(link: str) -> Topic:
    """Return the topic from which a node takes the external wrench on a link."""
    return Topic(f'{WRENCH}{link}', f'~/external/{link}', 'geometry_msgs/msg/WrenchStamped',
                 f'external force on the {link} at the point external.{link}.along, .across, and '
                 'couple')


def applied_topic(link: str) -> Topic:
    """Return the topic on which a node says what is in effect on a link, or as its base."""
    if link == BASE.name:
        return BASE
    return Topic(f'{ON_LINK}{link}', f'~/applied/{link}', 'geometry_msgs/msg/WrenchStamped',
                 f'external wrench in effect on the {link}; NaN: unknown; latched, sent on every '
                 'change', latched=True)


# Always present; without subscribers or a recorder they cost nothing.
DRIVEN = Topic('driven', '~/driven', 'fourbar_msgs/msg/Motion',
               'motion of the driven joint behind the outputs: from the clock, or the input with '
               'estimated rates')
SCENE = Topic('scene', '~/scene', 'std_msgs/msg/String',
              'all parameters as JSON; latched, sent on every change', latched=True)

OUTPUTS = {topic.name: topic for topic in (
    Topic('state', '~/state', 'fourbar_msgs/msg/LinkageState',
          'angles, rates and accelerations of all joints, transmission angle, condition'),
    Topic('output', '~/output', 'fourbar_msgs/msg/Motion',
          'motion of the output joint; can be the input of another node'),
    Topic('joint_states', 'joint_states', 'sensor_msgs/msg/JointState',
          'all joints for robot_state_publisher, RViz and Foxglove; with loads also the '
          'effort of the driven joint'),
    Topic('loads', '~/loads', 'fourbar_msgs/msg/LinkageLoads',
          'joint reactions, driving torque or force, shaking force and moment', True),
    Topic('shaking_wrench', '~/shaking_wrench', 'geometry_msgs/msg/WrenchStamped',
          'force of the linkage on the ground, and its moment about O1, the origin of the frame',
          True),
    Topic('drive_wrench', '~/drive_wrench', 'geometry_msgs/msg/WrenchStamped',
          'force and torque of the linkage on its drive, at the driven joint: the negative '
          'driving force and torque', True),
    Topic('equation', '~/equation', 'fourbar_msgs/msg/Equation',
          'inertia and bias at the driven joint, for simulators that integrate the drive', True),
    Topic('inertia', '~/inertia', 'geometry_msgs/msg/InertiaStamped',
          'the linkage held rigid in its pose: mass, centre of gravity from O1, `izz` about that '
          'centre; the other moments are not filled', True),
    Topic('points', '~/points/NAME', 'fourbar_msgs/msg/PointMotion',
          'position, velocity and acceleration of a point of the scene (one topic for each '
          'points.NAME)'),
    Topic('links', '~/links/NAME', 'fourbar_msgs/msg/LinkMotion',
          'direction and first joint of a link, with their rates and accelerations (one topic for '
          'each moving link)'),
    Topic('reactions', '~/reactions/NAME', 'geometry_msgs/msg/WrenchStamped',
          'force at a joint along the axes of the frame, and the couple of a guide (one topic for '
          'each joint)', True),
)}
FAMILIES = tuple(name for name, topic in OUTPUTS.items() if topic.topic.endswith('/NAME'))

# These are for people to look at, markers at most at pictures.rate; not recomputed from a bag.
PICTURES = {topic.name: topic for topic in (
    Topic('robot_description', 'robot_description', 'std_msgs/msg/String',
          'the scene as URDF; latched, sent on every change', latched=True),
    Topic('tf', '/tf', 'tf2_msgs/msg/TFMessage',
          'frames of all links and points, as in the URDF'),
    Topic('markers', '~/markers', 'visualization_msgs/msg/MarkerArray',
          'links, joints, points, and with masses forces at the joints, drive and shaking force '
          'as arrows, to scale'),
    Topic('traces', '~/traces', 'visualization_msgs/msg/MarkerArray',
          'paths of points, toggles, dead points, extrema of the rate and acceleration of the '
          'output; latched, sent on every change', latched=True),
)}

# Sent where `frame.parent` is given, without a name in `outputs`.
FRAME = Topic('tf_static', '/tf_static', 'tf2_msgs/msg/TFMessage',
              'with `frame.parent`: pose of `frame_id` in that frame; latched, sent on every '
              'change', latched=True)

# If `trajectories` is set: requests, answers, and reasons for no answer.
_TRAJECTORY = 'trajectory_msgs/msg/JointTrajectory'
TRAJECTORIES = {topic.name: topic for topic in (
    Topic('output_trajectory', '~/output_trajectory', _TRAJECTORY,
          'wanted trajectory of the output joint, its effort on what it moves'),
    Topic('drive_trajectory', '~/output_trajectory/drive', _TRAJECTORY,
          'answer: the trajectory of the driven joint, with the effort that the drive must give'),
    Topic('input_trajectory', '~/input_trajectory', _TRAJECTORY,
          'trajectory of the driven joint, with the effort of the drive'),
    Topic('followed_trajectory', '~/input_trajectory/output', _TRAJECTORY,
          'answer: the trajectory of the output joint, with its effort on what it moves'),
    Topic('trajectory_refused', '~/trajectory_refused', 'std_msgs/msg/String',
          'why a trajectory was not answered, e.g. which toggle it would pass'),
)}

# {request: (answer, method of the Transmission that makes it)}
ANSWERS = {'output_trajectory': ('drive_trajectory', 'to_input'),
           'input_trajectory': ('followed_trajectory', 'to_output')}


def topics_of(outputs: Iterable[str], members: Mapping[str, Mapping[str, str]]
              ) -> dict[str, Topic]:
    """Return {name: Topic} of outputs that hold numbers; ``members``: {family: {name: text}}."""
    topics: dict[str, Topic] = {}
    for output in outputs:
        if output in PICTURES:
            continue
        topic = OUTPUTS[output]
        if output not in FAMILIES:
            topics[output] = topic
            continue
        for name, text in members[output].items():
            short = f'{output}/{name}'
            topics[short] = topic._replace(name=short, text=text,
                                           topic=topic.topic.replace('NAME', name))
    return topics


SERVICES = {service.name: service for service in (
    Service('find_extrema', '~/find_extrema', 'fourbar_msgs/srv/FindExtrema',
            'all extrema of motion and loads over the input', ('search', 'proof')),
    Service('evaluate', '~/evaluate', 'fourbar_msgs/srv/Evaluate',
            'state and loads for one input'),
    Service('start_recording', '~/start_recording', 'fourbar_msgs/srv/StartRecording',
            'start a bag of the input and all outputs', ('bag',)),
    Service('stop_recording', '~/stop_recording', 'std_srvs/srv/Trigger',
            'close the bag; message contains its path', ('bag',)),
)}
